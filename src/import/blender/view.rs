//! The view of a 3D viewport: matrices instead of a camera.

use serde::Deserialize;

use super::camera::{ALL_AROUND, equirectangular, lens};
use super::document::{DofData, PanoramaData};
use super::transform::affine;
use crate::desc::{CameraDesc, ProjectionDesc};
use crate::error::{Error, Place, Result};
use crate::math::{DAffine3, DVec3};

/// What a viewport looks through.
#[derive(Clone, Debug, Deserialize)]
pub struct ViewData {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// From view to world space, by rows.
    pub matrix: [[f64; 4]; 4],
    /// `window_matrix`, by rows: OpenGL's projection.
    pub window: [[f64; 4]; 4],
    /// Parallel rays.
    pub orthographic: bool,
    /// Nearest distance that is seen; below 0 what lies behind the view is seen, too.
    pub clip_start: f64,
    /// Farthest distance that is seen.
    pub clip_end: f64,
    /// The part that is rendered, in pixels: left, top, width and height.
    #[serde(default)]
    pub border: Option<[u32; 4]>,
    /// Depth of field of the camera that it looks through, and its focal length.
    #[serde(default)]
    pub dof: Option<(DofData, f64)>,
    /// The panorama of the camera that it looks through, and where in the picture that is: left, lower, right and upper
    /// edge in pixels from the lower left corner.
    #[serde(default)]
    pub panorama: Option<(PanoramaData, [f64; 4])>,
}

impl ViewData {
    /// The view of a JSON text.
    ///
    /// # Errors
    /// JSON that is none.
    pub fn parse(json: &str) -> Result<Self> {
        serde_json::from_str(json)
            .map_err(|error| Error::invalid(&Place::default(), format!("the view doesn't parse: {error}")))
    }

    /// The camera that sees the same.
    pub fn camera(&self, exposure: f64, place: &Place) -> CameraDesc {
        // x' = (p₀₀ x + p₀₂ z) / −z in perspective, p₀₀ x + p₀₃ else.
        let [scale_x, scale_y] = [self.window[0][0], self.window[1][1]];
        let (projection, shift) = if let Some((panorama, frame)) = &self.panorama {
            (self.panoramic(panorama, *frame), [0.0; 2])
        } else if self.orthographic {
            let projection = ProjectionDesc::Orthographic { half_width: 1.0 / scale_x, half_height: 1.0 / scale_y };
            (projection, [-0.5 * self.window[0][3], -0.5 * self.window[1][3]])
        } else {
            let fov_y = 2.0 * (1.0 / scale_y).atan();
            let projection = ProjectionDesc::Perspective { fov_y, aspect: Some(scale_y / scale_x) };
            (projection, [0.5 * self.window[0][2], 0.5 * self.window[1][2]])
        };
        // Rays begin at the near plane, wherever it is.
        let behind = (-self.clip_start).max(0.0);
        CameraDesc {
            name: "view".into(),
            place: place.clone(),
            transform: affine(&self.matrix) * DAffine3::from_translation(DVec3::Z * behind),
            projection,
            clip_near: self.clip_start + behind,
            clip_far: self.clip_end + behind,
            shift,
            lens: self.dof.map(|(dof, focal)| lens(&dof, focal, self.orthographic)),
            shutter: [0.0; 2],
            shutter_curve: Vec::new(),
            rolling_shutter: None,
            zoom: Vec::new(),
            exposure,
            motion: Vec::new(),
        }
    }
}

impl ViewData {
    /// What all of the picture shows where the panorama fills its `frame`.
    fn panoramic(&self, data: &PanoramaData, [left, lower, right, upper]: [f64; 4]) -> ProjectionDesc {
        let edges = |[from, to]: [f64; 2], [first, last]: [f64; 2], size: u32| {
            [0.0, f64::from(size)].map(|pixel| from + (to - from) * (pixel - first) / (last - first))
        };
        let (longitude, latitude) = equirectangular(data).unwrap_or(ALL_AROUND);
        ProjectionDesc::Equirectangular {
            longitude: edges(longitude, [left, right], self.size[0]),
            latitude: edges(latitude, [lower, upper], self.size[1]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// The projection of a lens of 50 mm on a sensor of 36 by 20.25 mm, moved a tenth of the width.
    #[test]
    fn the_matrix_becomes_a_camera() {
        let window = [[1.0 / 0.36, 0.0, 0.2, 0.0], [0.0, 1.0 / 0.2025, 0.0, 0.0], [0.0; 4], [0.0, 0.0, -1.0, 0.0]];
        let identity = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
        let view = ViewData {
            size: [160, 90],
            matrix: identity,
            window,
            orthographic: false,
            clip_start: 0.1,
            clip_end: 100.0,
            border: None,
            dof: None,
            panorama: None,
        };
        let camera = view.camera(1.0, &Place::default());
        let ProjectionDesc::Perspective { fov_y, aspect } = camera.projection else { panic!() };
        assert!(((0.5 * fov_y).tan() - 0.2025).abs() < 1e-12);
        assert!((aspect.unwrap() - 16.0 / 9.0).abs() < 1e-12);
        assert_eq!(camera.shift, [0.1, 0.0]);
        let flat = ViewData {
            orthographic: true,
            window: [[0.5, 0.0, 0.0, 0.2], [0.0, 1.0, 0.0, 0.0], [0.0; 4], [0.0; 4]],
            ..view
        };
        let camera = flat.camera(1.0, &Place::default());
        assert_eq!(camera.projection, ProjectionDesc::Orthographic { half_width: 2.0, half_height: 1.0 });
        assert_eq!(camera.shift, [-0.1, 0.0]);
    }

    #[test]
    fn parallel_rays_begin_behind_a_view_that_has_no_camera() {
        let matrix = [[1.0, 0.0, 0.0, 2.0], [0.0, 0.0, -1.0, -3.0], [0.0, 1.0, 0.0, 5.0], [0.0, 0.0, 0.0, 1.0]];
        let window = [[0.5, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [0.0; 4], [0.0; 4]];
        let (size, border, dof, panorama) = ([16, 9], None, None, None);
        let (clip_start, clip_end) = (-500.0, 500.0);
        let view = ViewData { size, matrix, window, orthographic: true, clip_start, clip_end, border, dof, panorama };
        let camera = view.camera(1.0, &Place::default());
        assert_eq!(camera.transform.translation, DVec3::new(2.0, -503.0, 5.0));
        assert_eq!([camera.clip_near, camera.clip_far], [0.0, 1000.0]);
    }

    #[test]
    fn a_panorama_fills_its_frame() {
        let frame = [100.0, 50.0, 300.0, 150.0];
        let panorama = Some((PanoramaData::default(), frame));
        let (size, border, dof) = ([400, 200], None, None);
        let (matrix, window) = ([[0.0; 4]; 4], [[1.0; 4]; 4]);
        let (clip_start, clip_end) = (0.1, 100.0);
        let view = ViewData { size, matrix, window, orthographic: false, clip_start, clip_end, border, dof, panorama };
        let ProjectionDesc::Equirectangular { longitude, latitude } = view.camera(1.0, &Place::default()).projection
        else {
            panic!()
        };
        assert_eq!((longitude, latitude), ([-2.0 * PI, 2.0 * PI], [-PI, PI]));
    }
}
