//! What single scattering at GGX microfacets keeps, tabulated: albedos for layering, and the factors
//! that give back what scatters more than once.
//!
//! With w = G2/G1 of a visible normal, averaged over the normals that `wo` sees, and s going from 0
//! at normal incidence to 1 at grazing as Fresnel's reflectance does (`Dielectric::blend`):
//!
//! E = ⟨w⟩ over reflections, C = ⟨w (1 − cos)⁵⟩, D = ⟨w cos (1 − cos)⁶⟩, S = ⟨w s⟩; W = ⟨w⟩ over
//! refractions, V = ⟨w s⟩.
//!
//! Albedos are linear in these for any tint.
//!
//! Approximation: lost energy is given back by scaling, which keeps the shape of single scattering
//! and gives up reciprocity: Emmanuel Turquin, *Practical Multiple Scattering Compensation for
//! Microfacet Models*, 2019, with the color of several bounces by Kulla and Conty 2017.
//!
//! The tables are `energy.bin`, 16 bits per value; the test `write_tables` of `tabulate.rs` makes them anew:
//! `cargo test --release --ignore-rust-version --lib write_tables -- --ignored`.

use crate::math::Rgb;

/// Nodes in √cos θ, so that they are dense at grazing angles.
pub(super) const COS_NODES: usize = 64;
/// Nodes in roughness.
pub(super) const ROUGHNESS_NODES: usize = 64;
/// Nodes in ∜F0, each for an index and for its inverse.
pub(super) const ETA_NODES: usize = 20;
/// ∜F0 of the last node, an index near 6, beyond which the shape of Fresnel's curve stays. The 10th
/// node is at ∜0.04, the index 1.5 of nearly all surfaces.
pub(super) const LAST_ETA: f32 = 0.447_213_6 * 1.9;

/// First E and C by roughness and angle, then the averages of E by roughness, then S by side
/// (indices above 1 first), index, roughness and angle, W and V in the same order, D by roughness and
/// angle, times [`EDGE_SCALE`], and the averages of what untinted glass keeps by side, index and roughness.
pub(super) static TABLES: &[u8; 2 * VALUES] = include_bytes!("energy.bin");

/// D is small.
pub(super) const EDGE_SCALE: f32 = 16.0;

/// What rounding takes for 0 may be this large.
pub(super) const LEAST: f32 = 1e-4;

const SLICE: usize = COS_NODES * ROUGHNESS_NODES;
const AVERAGES: usize = 2 * SLICE;
const BLENDS: usize = AVERAGES + ROUGHNESS_NODES;
const REFRACTED: usize = BLENDS + 2 * ETA_NODES * SLICE;
const EDGES: usize = REFRACTED + 2 * 2 * ETA_NODES * SLICE;
const GLASS_AVERAGES: usize = EDGES + SLICE;
const VALUES: usize = GLASS_AVERAGES + 2 * ETA_NODES * ROUGHNESS_NODES;

/// Averages that don't depend on the index of refraction.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Plain {
    /// E of the file's head.
    pub reflected: f32,
    /// C.
    pub reflected_schlick: f32,
    /// D.
    pub reflected_edge: f32,
}

/// Averages for an index of refraction.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Refractive {
    /// S of the file's head.
    pub reflected_blend: f32,
    /// W.
    pub refracted: f32,
    /// V.
    pub refracted_blend: f32,
}

/// A place between two of evenly spaced nodes.
#[derive(Clone, Copy, Debug)]
struct Place {
    node: usize,
    within: f32,
}

/// A roughness in the tables.
#[derive(Clone, Copy, Debug)]
pub(super) struct RoughnessPlace(Place);

/// A relative index of refraction in the tables.
#[derive(Clone, Copy, Debug)]
pub(super) struct EtaPlace {
    place: Place,
    side: usize,
}

/// The tables at one roughness and angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Energy {
    roughness: Place,
    cos: Place,
}

impl RoughnessPlace {
    /// For roughness √α.
    pub fn of(alpha: f32) -> Self {
        Self(Place::of(alpha.sqrt(), ROUGHNESS_NODES))
    }

    /// 2 ∫ E(μ) μ dμ.
    pub fn reflected_average(self) -> f32 {
        let first = AVERAGES + self.0.node;
        self.0.mix([value(first)], [value(first + 1)])[0]
    }

    /// The same for what untinted glass keeps of reflection and passage.
    pub fn glass_average(self, eta: EtaPlace) -> f32 {
        let row = |k: usize| {
            let first = GLASS_AVERAGES + (eta.side * ETA_NODES + k) * ROUGHNESS_NODES + self.0.node;
            self.0.mix([value(first)], [value(first + 1)])
        };
        eta.place.mix(row(eta.place.node), row(eta.place.node + 1))[0]
    }

    /// With `cos` of the angle to the camera.
    pub fn at(self, cos: f32) -> Energy {
        Energy { roughness: self.0, cos: Place::of(cos.sqrt(), COS_NODES) }
    }
}

impl EtaPlace {
    pub fn of(eta: f32) -> Self {
        let fourth_root = ((eta - 1.0) / (eta + 1.0)).abs().sqrt();
        Self { place: Place::of(fourth_root / LAST_ETA, ETA_NODES), side: usize::from(eta < 1.0) }
    }
}

impl Energy {
    pub fn plain(&self) -> Plain {
        let [reflected, reflected_schlick] = self.in_slice(0);
        let [edge] = self.in_slice(EDGES);
        Plain { reflected, reflected_schlick, reflected_edge: edge * (1.0 / EDGE_SCALE) }
    }

    /// S alone. It doesn't become 0, so that what has a value has a chance to be drawn.
    pub fn reflected_blend(&self, eta: EtaPlace) -> f32 {
        let [blend] = self.in_slices(BLENDS, eta);
        blend.max(LEAST)
    }

    pub fn refractive(&self, eta: EtaPlace) -> Refractive {
        let [refracted, refracted_blend] = self.in_slices(REFRACTED, eta);
        Refractive { reflected_blend: self.reflected_blend(eta), refracted, refracted_blend }
    }

    /// Interpolates `N` values by index of refraction, roughness and angle in the table at `start`.
    #[inline]
    fn in_slices<const N: usize>(&self, start: usize, eta: EtaPlace) -> [f32; N] {
        let first = start + N * SLICE * (eta.side * ETA_NODES + eta.place.node);
        eta.place.mix(self.in_slice(first), self.in_slice(first + N * SLICE))
    }

    /// Interpolates `N` values by roughness and angle in the table at `start`.
    #[inline]
    fn in_slice<const N: usize>(&self, start: usize) -> [f32; N] {
        let row = |j: usize| {
            let node = start + N * (j * COS_NODES + self.cos.node);
            self.cos.mix(std::array::from_fn(|k| value(node + k)), std::array::from_fn(|k| value(node + N + k)))
        };
        self.roughness.mix(row(self.roughness.node), row(self.roughness.node + 1))
    }
}

/// The color of what scatters more than once, per lost energy, for a reflection of mean Fresnel
/// reflectance `fresnel_average` and mean albedo `average` = 2 ∫ E(μ) μ dμ: 1 for white.
pub(super) fn several_bounces(fresnel_average: Rgb, average: f32) -> Rgb {
    fresnel_average.map(|f| f * average / (1.0 - f * (1.0 - average)))
}

/// The factor that gives it back: 1/E for white.
#[inline]
pub(super) fn compensation(several_bounces: Rgb, reflected: f32) -> Rgb {
    let missing = (1.0 - reflected) / reflected;
    several_bounces.map(|f| 1.0 + missing * f)
}

#[inline]
fn value(index: usize) -> f32 {
    f32::from(u16::from_le_bytes([TABLES[2 * index], TABLES[2 * index + 1]])) * (1.0 / 65535.0)
}

impl Place {
    /// The place of `x` in 0 to 1 among `nodes` nodes.
    fn of(x: f32, nodes: usize) -> Self {
        let scaled = x.clamp(0.0, 1.0) * (nodes - 1) as f32;
        let node = (scaled as usize).min(nodes - 2);
        Self { node, within: scaled - node as f32 }
    }

    #[inline]
    fn mix<const N: usize>(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        std::array::from_fn(|k| a[k] + self.within * (b[k] - a[k]))
    }
}

#[cfg(test)]
mod tests {
    use super::super::quadrature::Seen;
    use super::*;
    use crate::math::sqr;

    /// What glass without tints keeps of the light, by reflection and by refraction.
    fn glass(eta: f32, p: Plain, r: Refractive) -> f32 {
        let f0 = sqr((eta - 1.0) / (eta + 1.0));
        let reflected = f0 * (p.reflected - r.reflected_blend) + r.reflected_blend;
        reflected + r.refracted - f0 * (r.refracted - r.refracted_blend) - r.refracted_blend
    }

    #[test]
    fn tables_agree_with_dense_quadrature_between_nodes() {
        for r in [0.02, 0.07, 0.15, 0.3, 0.45, 0.52, 0.77, 0.93] {
            for cos in [0.03, 0.087, 0.17, 0.3, 0.45, 0.6, 0.78, 0.99] {
                let seen = Seen::new(sqr(r), cos);
                let energy = RoughnessPlace::of(sqr(r)).at(cos);
                let (a, b) = (energy.plain(), seen.plain());
                assert!((a.reflected - b.reflected).abs() < 5e-3, "{r} {cos}");
                assert!((a.reflected_schlick - b.reflected_schlick).abs() < 6e-3, "{r} {cos}");
                assert!((a.reflected_edge - b.reflected_edge).abs() < 1e-3, "{r} {cos}");
                for eta in [1.01, 1.1, 1.33, 1.5, 2.4, 4.0, 1.0 / 1.1, 1.0 / 1.5, 1.0 / 2.4] {
                    let (ra, rb) = (energy.refractive(EtaPlace::of(eta)), seen.refractive(eta));
                    // Below 1 the critical angle is a step, which only the sum doesn't have.
                    let error = if eta > 1.0 { ra.reflected_blend - rb.reflected_blend } else { 0.0 };
                    assert!(error.abs() < if cos < 0.05 { 2.5e-2 } else { 1.2e-2 }, "{r} {cos} {eta}: {error}");
                    let error = glass(eta, a, ra) - glass(eta, b, rb);
                    assert!(error.abs() < if cos < 0.05 { 1e-2 } else { 8e-3 }, "{r} {cos} {eta}: {error}");
                }
            }
        }
    }

    /// Heitz, Hanika, d'Eon and Dachsbacher, *Multiple-Scattering Microfacet BSDFs with the Smith
    /// Model*, 2016: single scattering at α = 1 loses more than half at normal incidence.
    #[test]
    fn known_losses() {
        let e = |cos, r: f32| RoughnessPlace::of(sqr(r)).at(cos).plain().reflected;
        // Measured with Cycles at roughness 1 and 0.5.
        for (degrees, rough, smoother) in [
            (0.0_f32, 0.3069, 0.9158),
            (45.0, 0.3768, 0.8862),
            (60.0, 0.4507, 0.8572),
            (75.0, 0.5906, 0.8393),
            (85.0, 0.7800, 0.9007),
        ] {
            let cos = degrees.to_radians().cos();
            assert!((e(cos, 1.0) - rough).abs() < 2e-3 && (e(cos, 0.5) - smoother).abs() < 2e-3, "{degrees}");
        }
    }
}
