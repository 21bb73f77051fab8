//! What many lights are together: their bounds, and what it costs to choose by those.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

use crate::light::LightBounds;
use crate::light::bounds::{Lobe, round_down};
use crate::math::{Bounds, Vec3};

/// Sums over some lights that say how widely their normals are spread, without any angle: the mean
/// of unit vectors uniform in a cone of half angle θ has the length (1 + cos θ) / 2.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cluster {
    /// Box of the lights.
    pub bounds: Bounds,
    /// Box of their middles.
    pub centers: Bounds,
    /// Sum of intensities.
    intensity: f64,
    /// Of that, the intensity without a cosine.
    isotropic: f64,
    /// Sum of normals times intensity.
    axis: [f64; 3],
    /// Cosine of the widest emission about a normal.
    cos_emission: f32,
    two_sided: bool,
}

impl Cluster {
    pub const EMPTY: Self = Self {
        bounds: Bounds::EMPTY,
        centers: Bounds::EMPTY,
        intensity: 0.0,
        isotropic: 0.0,
        axis: [0.0; 3],
        cos_emission: 1.0,
        two_sided: false,
    };

    /// With one light more. Lights that emit on both sides are taken on that of `side`.
    pub fn with(mut self, light: &LightBounds, side: Vec3) -> Self {
        let intensity = f64::from(light.intensity);
        let directed = intensity * 0.5 * (1.0 + f64::from(light.cos_normals));
        let flip = light.two_sided && light.axis.dot(side) < 0.0;
        let signed = if flip { -directed } else { directed };
        for (sum, v) in self.axis.iter_mut().zip(light.axis.to_array()) {
            *sum += signed * f64::from(v);
        }
        self.bounds = self.bounds.union(light.bounds);
        self.centers = self.centers.with_point(light.bounds.center());
        self.intensity += intensity;
        self.isotropic += if light.is_even() { intensity } else { intensity - directed };
        self.cos_emission = self.cos_emission.min(light.cos_emission);
        self.two_sided |= light.two_sided;
        self
    }

    /// Both together.
    pub fn union(mut self, other: &Self) -> Self {
        for (sum, v) in self.axis.iter_mut().zip(other.axis) {
            *sum += v;
        }
        self.bounds = self.bounds.union(other.bounds);
        self.centers = self.centers.union(other.centers);
        self.intensity += other.intensity;
        self.isotropic += other.isotropic;
        self.cos_emission = self.cos_emission.min(other.cos_emission);
        self.two_sided |= other.two_sided;
        self
    }

    /// Direction of most light, unit.
    pub fn axis(&self) -> Vec3 {
        let [x, y, z] = self.axis;
        let length = (x * x + y * y + z * z).sqrt();
        let scale = if length > 0.0 { 1.0 / length } else { return Vec3::Z };
        Vec3::new((x * scale) as f32, (y * scale) as f32, (z * scale) as f32).normalize_or(Vec3::Z)
    }

    /// Length of the mean normal, 0 to 1.
    fn concentration(&self) -> f64 {
        let [x, y, z] = self.axis;
        if self.intensity > 0.0 { ((x * x + y * y + z * z).sqrt() / self.intensity).min(1.0) } else { 0.0 }
    }

    /// The surface area orientation heuristic of Conty Estevez and Kulla: intensity × orientation ×
    /// area. Lights in a line have no area, but are seen under an angle, too: a little of the squared
    /// diagonal goes with it.
    pub fn cost(&self) -> f64 {
        let area = f64::from(self.bounds.half_area()) + 0.05 * f64::from(self.bounds.extent().length_squared());
        self.intensity * orientation(self.concentration(), self.cos_emission) * area
    }

    /// Bounds of the cluster, whose lights face within `cos_normals` about its axis. Their largest
    /// intensity together is less than the sum where they face apart: for normals uniform in a cone of
    /// more than a hemisphere, of which R is the length of the mean, it is 1 / (4 (1 − R)) of that.
    pub fn light_bounds(&self, cos_normals: f32) -> LightBounds {
        let r = self.concentration();
        let peak = if r > 0.5 { r } else { 0.25 / (1.0 - r) };
        let isotropic = self.isotropic_share();
        LightBounds {
            bounds: self.bounds,
            axis: self.axis(),
            cos_normals,
            cos_emission: self.cos_emission,
            intensity: to_f32(self.intensity * (isotropic + (1.0 - isotropic) * peak)),
            two_sided: self.two_sided,
        }
    }

    /// The same for the importance.
    pub fn lobe(&self, bounds: &LightBounds) -> Lobe {
        let isotropic = self.isotropic_share();
        let mean_normal = (1.0 - isotropic) * self.concentration();
        bounds.lobe_of(to_f32(self.intensity), mean_normal as f32, isotropic as f32)
    }

    fn isotropic_share(&self) -> f64 {
        if self.intensity > 0.0 { (self.isotropic / self.intensity).clamp(0.0, 1.0) } else { 0.0 }
    }
}

/// A positive number stays one.
fn to_f32(v: f64) -> f32 {
    if v > 0.0 { (v as f32).clamp(f32::MIN_POSITIVE, f32::MAX) } else { 0.0 }
}

/// Cosine of the half angle of a cone about `axis` that holds the cone of normals of `light`; `side`
/// where the cluster emits on both sides.
pub(super) fn cos_of_cone(axis: Vec3, two_sided: bool, light: &LightBounds) -> f32 {
    if light.cos_normals <= -1.0 {
        return -1.0;
    }
    let cos = axis.dot(light.axis);
    let cos = if two_sided { cos.abs() } else { cos };
    // Rounding of unit vectors is worth 1e-7 in the cosine.
    let narrow = cos - 3e-7;
    if light.cos_normals >= 1.0 {
        return narrow.clamp(-1.0, 1.0);
    }
    let angle = f64::from(narrow.clamp(-1.0, 1.0)).acos() + f64::from(light.cos_normals).acos();
    if angle < PI { round_down(angle.cos()) } else { -1.0 }
}

/// Entries of the table along each side.
const TABLE: usize = 33;

/// M_Ω of section 4.1 by the concentration of normals and the cosine of emission, both over their
/// range in `TABLE − 1` steps.
static ORIENTATION: LazyLock<Vec<[f32; TABLE]>> = LazyLock::new(|| {
    let step = |i: usize| i as f64 / (TABLE - 1) as f64;
    let row = |i| std::array::from_fn(|j| orientation_measure(2.0 * step(i) - 1.0, 2.0 * step(j) - 1.0) as f32);
    (0..TABLE).map(row).collect()
});

/// Solid angle into which normals of a cone emit, the part beyond the cone weighed by the cosine.
fn orientation_measure(cos_normals: f64, cos_emission: f64) -> f64 {
    let theta_o = cos_normals.acos();
    let theta_w = (theta_o + cos_emission.acos().min(FRAC_PI_2)).min(PI);
    let (sin_o, cos_o) = theta_o.sin_cos();
    2.0 * PI * (1.0 - cos_o)
        + FRAC_PI_2 * (2.0 * theta_w * sin_o - (theta_o - 2.0 * theta_w).cos() - 2.0 * theta_o * sin_o + cos_o)
}

/// M_Ω of normals of the given concentration, between the entries of the table.
fn orientation(concentration: f64, cos_emission: f32) -> f64 {
    let place = |share: f64| {
        let scaled = share.clamp(0.0, 1.0) * (TABLE - 1) as f64;
        let i = (scaled as usize).min(TABLE - 2);
        (i, scaled - i as f64)
    };
    let ((i, s), (j, t)) = (place(concentration), place(0.5 + 0.5 * f64::from(cos_emission)));
    let at = |i: usize, j: usize| f64::from(ORIENTATION[i][j]);
    let row = |i: usize| at(i, j) * (1.0 - t) + at(i, j + 1) * t;
    row(i) * (1.0 - s) + row(i + 1) * s
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_measure_has_its_known_values() {
        // One direction, emitting as a Lambertian or not at all beside it; and every direction.
        assert!((orientation_measure(1.0, 0.0) - PI).abs() < 1e-12);
        assert!(orientation_measure(1.0, 1.0).abs() < 1e-12);
        assert!((orientation_measure(-1.0, 0.0) - 4.0 * PI).abs() < 1e-12);
        // By quadrature: 2π ∫ sin θ min(1, cos(θ − θo)) dθ up to θo + θe.
        let (theta_o, theta_e) = (0.7_f64, 1.1_f64);
        let n = 100_000;
        let end = theta_o + theta_e;
        let integral: f64 = (0..n)
            .map(|i| end * (f64::from(i) + 0.5) / f64::from(n))
            .map(|t| 2.0 * PI * t.sin() * (t - theta_o).max(0.0).cos() * end / f64::from(n))
            .sum();
        assert!((orientation_measure(theta_o.cos(), theta_e.cos()) / integral - 1.0).abs() < 1e-6);
    }

    #[test]
    fn lights_that_face_apart_do_not_add_up() {
        let one = |axis: Vec3, two_sided| LightBounds {
            bounds: Bounds { min: Vec3::ZERO, max: Vec3::ONE },
            axis,
            cos_normals: 1.0,
            cos_emission: 0.0,
            intensity: 1.0,
            two_sided,
        };
        let sum = |axes: &[Vec3], two_sided| {
            let cluster = axes.iter().fold(Cluster::EMPTY, |c, &a| c.with(&one(a, two_sided), axes[0]));
            cluster.light_bounds(-1.0).intensity
        };
        assert!((sum(&[Vec3::X; 4], false) - 4.0).abs() < 1e-6);
        assert!((sum(&[Vec3::X, -Vec3::X, Vec3::X, -Vec3::X], true) - 4.0).abs() < 1e-6);
        // A cube seen from far along its edge axes shows one face; the mean over directions is 6/4.
        let cube = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
        assert!((sum(&cube, false) - 1.5).abs() < 1e-6);
    }
}
