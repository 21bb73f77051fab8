//! The view of a 3D viewport: matrices instead of a camera.

use serde::Deserialize;

use super::camera::lens;
use super::document::DofData;
use super::transform::affine;
use crate::desc::{CameraDesc, ProjectionDesc};
use crate::error::{Error, Place, Result};

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
    /// Nearest distance that is seen.
    pub clip_start: f64,
    /// Farthest distance that is seen.
    pub clip_end: f64,
    /// The part that is rendered, in pixels: left, top, width and height.
    #[serde(default)]
    pub border: Option<[u32; 4]>,
    /// Depth of field of the camera that it looks through, and its focal length.
    #[serde(default)]
    pub dof: Option<(DofData, f64)>,
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
        let (projection, shift) = if self.orthographic {
            let projection = ProjectionDesc::Orthographic { half_width: 1.0 / scale_x, half_height: 1.0 / scale_y };
            (projection, [-0.5 * self.window[0][3], -0.5 * self.window[1][3]])
        } else {
            let fov_y = 2.0 * (1.0 / scale_y).atan();
            let projection = ProjectionDesc::Perspective { fov_y, aspect: Some(scale_y / scale_x) };
            (projection, [0.5 * self.window[0][2], 0.5 * self.window[1][2]])
        };
        CameraDesc {
            name: "view".into(),
            place: place.clone(),
            transform: affine(&self.matrix),
            projection,
            clip_near: if self.orthographic { 0.0 } else { self.clip_start },
            clip_far: self.clip_end,
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
