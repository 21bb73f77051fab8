//! Settings of the scene that shape the picture.

use serde::Deserialize;

use crate::desc::{AovDesc, AovKind, FramingDesc, RenderDesc};

/// Settings that are the scene's and not the engine's.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct RenderData {
    /// Pixels across and down, percentage applied.
    pub size: [u32; 2],
    /// `pixel_aspect_x`, `pixel_aspect_y`.
    pub pixel_aspect: [f64; 2],
    /// The border, in pixels from the lower left corner: left, lower, right and upper edge.
    pub border: Option<[u32; 4]>,
    /// Factor of the picture's radiance (`cycles.film_exposure`).
    pub exposure: f64,
    /// The world is not seen by the camera, alpha is 0 there.
    pub film_transparent: bool,
    /// Roughness up to which it is not seen through glass either (`cycles.film_transparent_glass` and `…_roughness`).
    pub transparent_glass: Option<f64>,
    /// How many surfaces fewer than a path a shadow ray passes.
    pub fewer_in_shadow: u32,
    /// The view layer's.
    pub pass_alpha_threshold: f64,
    /// When the shutter opens and closes, frames after the frame; both 0 without motion blur.
    pub shutter: [f64; 2],
    /// How far it is open at even steps of that time; empty for a flat curve.
    pub shutter_curve: Vec<f64>,
    /// Share of that time that each row of the picture is exposed, one after the other from the top; `None` for all at
    /// once.
    pub rolling_shutter: Option<f64>,
    /// The view layer's shader AOVs: name, and `COLOR` or `VALUE`.
    pub aovs: Vec<(String, String)>,
}

impl Default for RenderData {
    fn default() -> Self {
        Self {
            size: [1920, 1080],
            pixel_aspect: [1.0; 2],
            border: None,
            exposure: 1.0,
            film_transparent: false,
            transparent_glass: None,
            fewer_in_shadow: 0,
            pass_alpha_threshold: 0.5,
            shutter: [0.0; 2],
            shutter_curve: Vec::new(),
            rolling_shutter: None,
            aovs: Vec::new(),
        }
    }
}

impl RenderData {
    /// The same in the engine's terms.
    pub fn desc(&self) -> RenderDesc {
        let [x, y] = self.pixel_aspect;
        let aspect = x / y;
        RenderDesc {
            framing: FramingDesc {
                resolution: Some(self.size),
                pixel_aspect: if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 },
                ..FramingDesc::default()
            },
            crop: self.border.map(|[left, lower, right, upper]| {
                let height = self.size[1];
                [left, height.saturating_sub(upper), right.saturating_sub(left), upper.saturating_sub(lower)]
            }),
            film_transparent: Some(self.film_transparent),
            transparent_glass: self.transparent_glass,
            fewer_in_shadow: self.fewer_in_shadow,
            pass_alpha_threshold: self.pass_alpha_threshold,
            aovs: self.aovs.iter().map(aov).collect(),
            ..RenderDesc::default()
        }
    }
}

fn aov((name, kind): &(String, String)) -> AovDesc {
    let kind = if kind == "VALUE" { AovKind::Value } else { AovKind::Color };
    AovDesc { name: name.as_str().into(), kind }
}
