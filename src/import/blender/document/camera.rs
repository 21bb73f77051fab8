//! The camera and its lens.

use std::f64::consts::PI;

use serde::Deserialize;

use super::IDENTITY;

/// A camera object with its data.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct CameraData {
    /// Name of the object.
    pub name: String,
    /// `matrix_world`, by rows.
    pub matrix: [[f64; 4]; 4],
    /// `PERSP`, `ORTHO` or `PANO`.
    pub r#type: String,
    /// Focal length, millimetres.
    pub lens: f64,
    /// Millimetres.
    pub sensor_width: f64,
    /// Millimetres.
    pub sensor_height: f64,
    /// `AUTO`, `HORIZONTAL` or `VERTICAL`.
    pub sensor_fit: String,
    /// In sizes of the fitted side.
    pub shift_x: f64,
    /// In sizes of the fitted side.
    pub shift_y: f64,
    /// Nearest distance that is seen.
    pub clip_start: f64,
    /// Farthest distance that is seen.
    pub clip_end: f64,
    /// Size of the fitted side of what an orthographic camera sees.
    pub ortho_scale: f64,
    /// Depth of field; `None` where it is off.
    pub dof: Option<DofData>,
    /// What panoramic cameras have.
    pub panorama: PanoramaData,
    /// Where it is at other times of the shutter: frames after the frame, and `matrix_world`.
    pub motion: Vec<(f64, [[f64; 4]; 4])>,
    /// How it projects at other times of the shutter, or at the frames before and after, where it zooms: frames after the
    /// frame, and the same fields.
    pub zoom: Vec<(f64, Self)>,
}

impl Default for CameraData {
    fn default() -> Self {
        Self {
            name: String::new(),
            matrix: IDENTITY,
            r#type: "PERSP".into(),
            lens: 50.0,
            sensor_width: 36.0,
            sensor_height: 24.0,
            sensor_fit: "AUTO".into(),
            shift_x: 0.0,
            shift_y: 0.0,
            clip_start: 0.1,
            clip_end: 1000.0,
            ortho_scale: 6.0,
            dof: None,
            panorama: PanoramaData::default(),
            motion: Vec::new(),
            zoom: Vec::new(),
        }
    }
}

/// A camera's depth of field.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default)]
pub struct DofData {
    /// Metres along the axis, that of the focus object where there is one.
    pub distance: f64,
    /// `aperture_fstop`.
    pub fstop: f64,
    /// `aperture_blades`; fewer than 3 are round.
    pub blades: u32,
    /// `aperture_ratio`.
    pub ratio: f64,
    /// `aperture_rotation`, radians.
    pub rotation: f64,
}

impl Default for DofData {
    fn default() -> Self {
        Self { distance: 10.0, fstop: 2.8, blades: 0, ratio: 1.0, rotation: 0.0 }
    }
}

/// A panoramic camera's own settings.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct PanoramaData {
    /// `EQUIRECTANGULAR` and others.
    pub panorama_type: String,
    /// Radians.
    pub latitude_min: f64,
    /// Radians.
    pub latitude_max: f64,
    /// Radians.
    pub longitude_min: f64,
    /// Radians.
    pub longitude_max: f64,
}

impl Default for PanoramaData {
    fn default() -> Self {
        Self {
            panorama_type: "EQUIRECTANGULAR".into(),
            latitude_min: -0.5 * PI,
            latitude_max: 0.5 * PI,
            longitude_min: -PI,
            longitude_max: PI,
        }
    }
}
