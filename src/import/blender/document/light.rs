//! Lamps.

use std::f64::consts::PI;

use serde::Deserialize;

use super::{IDENTITY, LinkData, VisibilityData};
use crate::import::blender::nodes::TreeData;

/// A lamp, placed.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct LightData {
    /// Name of the object.
    pub name: String,
    /// `matrix_world`, by rows.
    pub matrix: [[f64; 4]; 4],
    /// `POINT`, `SPOT`, `SUN` or `AREA`.
    pub r#type: String,
    /// Watts; for a sun W/m².
    pub energy: f64,
    /// Stops (4.5 and later).
    pub exposure: f64,
    /// Linear.
    pub color: [f64; 3],
    /// `temperature_color` where `use_temperature` is on, else white.
    pub temperature_color: [f64; 3],
    /// Energy is independent of the size (4.5 and later; before, it always is).
    pub normalize: bool,
    /// Radius of points and spots (`shadow_soft_size`).
    pub radius: f64,
    /// Points and spots are disks that face whoever looks.
    pub use_soft_falloff: bool,
    /// Full diameter of a sun, radians.
    pub angle: f64,
    /// Full angle of a spot, radians.
    pub spot_size: f64,
    /// Softness of a spot's edge.
    pub spot_blend: f64,
    /// `SQUARE`, `RECTANGLE`, `DISK` or `ELLIPSE`.
    pub shape: String,
    /// Along x, or both.
    pub size: f64,
    /// Along y of rectangles and ellipses.
    pub size_y: f64,
    /// Full angle of an area lamp's spread, radians.
    pub spread: f64,
    /// A portal (`cycles.is_portal`): emits nothing.
    pub is_portal: bool,
    /// Its light is stopped by objects.
    pub use_shadow: bool,
    /// How often light was scattered before, at most, where it lights (`cycles.max_bounces`).
    pub max_bounces: Option<u32>,
    /// Its nodes; `None` where `use_nodes` is off.
    pub nodes: Option<TreeData>,
    /// Light group.
    pub lightgroup: String,
    /// Which rays see it; its shadow flag means nothing.
    pub visibility: VisibilityData,
    /// Whom it lights (light linking), as indices of objects.
    pub receivers: Option<LinkData>,
    /// What stops its light (shadow linking).
    pub blockers: Option<LinkData>,
}

impl Default for LightData {
    fn default() -> Self {
        Self {
            name: String::new(),
            matrix: IDENTITY,
            r#type: "POINT".into(),
            energy: 10.0,
            exposure: 0.0,
            color: [1.0; 3],
            temperature_color: [1.0; 3],
            normalize: true,
            radius: 0.0,
            use_soft_falloff: true,
            angle: 0.009_18,
            spot_size: 0.25 * PI,
            spot_blend: 0.15,
            shape: "SQUARE".into(),
            size: 0.25,
            size_y: 0.25,
            spread: PI,
            is_portal: false,
            use_shadow: true,
            max_bounces: None,
            nodes: None,
            lightgroup: String::new(),
            visibility: VisibilityData::default(),
            receivers: None,
            blockers: None,
        }
    }
}
