//! Cameras as authored.

use std::sync::Arc;

use super::Motion;
use crate::error::Place;
use crate::math::DAffine3;

/// A camera that looks along its local −z, with +y up and +x to the right.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraDesc {
    /// Name, for `--camera`.
    pub name: Arc<str>,
    /// Where it stands in the file; the node path is accepted by `--camera` too.
    pub place: Place,
    /// Camera to world; its scale is ignored.
    pub transform: DAffine3,
    /// How it projects.
    pub projection: ProjectionDesc,
    /// Nothing nearer than this along the axis is seen, in metres.
    pub clip_near: f64,
    /// Nothing farther than this along the axis is seen; may be infinite.
    pub clip_far: f64,
    /// How far the picture's centre is from the axis, in widths and heights of the authored frame.
    pub shift: [f64; 2],
    /// Its lens; `None` for a pinhole.
    pub lens: Option<LensDesc>,
    /// When the shutter opens and closes, in frames after the frame itself; both 0 for an instant.
    pub shutter: [f64; 2],
    /// How far it is open at even steps of that time, on straight lines in between; empty where it is wide open.
    pub shutter_curve: Vec<f64>,
    /// Rows of the picture are exposed one after the other, from the top, each for this share of that time; `None`
    /// where all are at once.
    pub rolling_shutter: Option<f64>,
    /// Factor of the picture's radiance.
    pub exposure: f64,
    /// The transform at other times of the shutter, in the order of time.
    pub motion: Vec<Motion<DAffine3>>,
    /// How it projects at other times, where it zooms: while the shutter is open, or for the vector pass at the frames
    /// before and after.
    pub zoom: Vec<Motion<ProjectionDesc>>,
}

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensDesc {
    /// Radius of the aperture, metres.
    pub aperture_radius: f64,
    /// Distance along the axis at which the picture is sharp, metres; may be infinite.
    pub focus_distance: f64,
    /// Blades of the aperture; fewer than 3 make it round.
    pub blades: u32,
    /// How far the blades are turned, radians counter-clockwise as the camera sees.
    pub rotation: f64,
    /// Height of the aperture over its width: an anamorphic lens has more than 1.
    pub ratio: f64,
}

impl LensDesc {
    /// A round aperture.
    pub const fn round(aperture_radius: f64, focus_distance: f64) -> Self {
        Self { aperture_radius, focus_distance, blades: 0, rotation: 0.0, ratio: 1.0 }
    }
}

/// How a camera projects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ProjectionDesc {
    /// Straight lines through one point.
    Perspective {
        /// Full vertical field of view in radians, at the authored aspect.
        fov_y: f64,
        /// Width over height that the author framed for; `None` for that of the picture. A picture
        /// of another aspect shows at least this frame.
        aspect: Option<f64>,
    },
    /// Parallel rays.
    Orthographic {
        /// Half of the width that is seen, in metres.
        half_width: f64,
        /// Half of the height that is seen, in metres.
        half_height: f64,
    },
    /// All around: longitude across the picture, latitude up, Cycles' equirectangular panorama.
    Equirectangular {
        /// Longitudes of the left and right edge, radians; 0 is ahead, to the right is positive.
        longitude: [f64; 2],
        /// Latitudes of the lower and upper edge, radians; up is positive.
        latitude: [f64; 2],
    },
}
