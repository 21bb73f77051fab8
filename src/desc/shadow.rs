//! How the shadows of a light look (UsdLux ShadowAPI).

/// Lengths are metres of the world from the point that is shaded towards the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowDesc {
    /// Share of the light that arrives in full shadow, linear RGB.
    pub color: [f64; 3],
    /// Blockers that are further away cast no shadow; infinite where all do.
    pub distance: f64,
    /// The last stretch of `distance`, over which shadows fade; 0 for none.
    pub falloff: f64,
    /// What fades is the power of this of the share that is left of the stretch.
    pub gamma: f64,
}

impl Default for ShadowDesc {
    /// Black, and without end.
    fn default() -> Self {
        Self { color: [0.0; 3], distance: f64::INFINITY, falloff: 0.0, gamma: 1.0 }
    }
}
