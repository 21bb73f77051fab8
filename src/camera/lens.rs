//! Thin lenses: where on the aperture a ray starts.

use std::f32::consts::{PI, TAU};

/// A thin lens (Cook, Porter, Carpenter: *Distributed Ray Tracing*, SIGGRAPH 1984).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Of the circle around the aperture.
    pub radius: f32,
    /// Distance along the axis at which the picture is sharp.
    pub focus: f32,
    /// Corners of the aperture; fewer than 3 make it round.
    pub blades: u32,
    /// Radians counter-clockwise.
    pub rotation: f32,
    /// Its width is divided by this.
    pub ratio: f32,
}

impl Lens {
    /// A point on the aperture, to the right and up, uniform over its area.
    pub fn sample(&self, u: [f32; 2]) -> [f32; 2] {
        let [x, y] = if self.blades < 3 { disk(u) } else { polygon(self.blades, self.rotation, u) };
        [x * self.radius / self.ratio, y * self.radius]
    }
}

/// Peter Shirley, Kenneth Chiu: *A Low Distortion Map Between Disk and Square*, JGT 2(3), 1997.
fn disk([u, v]: [f32; 2]) -> [f32; 2] {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return [0.0; 2];
    }
    let (r, phi) = if a.abs() > b.abs() { (a, 0.25 * PI * (b / a)) } else { (b, 0.5 * PI - 0.25 * PI * (a / b)) };
    let (sin, cos) = phi.sin_cos();
    [r * cos, r * sin]
}

/// A point of the regular polygon in the unit circle whose first corner lies half a side before the
/// rotation: one of its triangles about the middle, then a point of that.
fn polygon(corners: u32, rotation: f32, [u, v]: [f32; 2]) -> [f32; 2] {
    let n = corners as f32;
    let side = (u * n).floor().min(n - 1.0);
    let root = (u * n - side).clamp(0.0, 1.0).sqrt();
    // Weights of the side's two corners; the rest is the middle's.
    let (a, b) = (root * (1.0 - v), root * v);
    let half = PI / n;
    let (x, y) = ((a + b) * half.cos(), (b - a) * half.sin());
    let (sin, cos) = (rotation + side * TAU / n).sin_cos();
    [x * cos - y * sin, x * sin + y * cos]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lens(blades: u32, rotation: f32, ratio: f32) -> Lens {
        Lens { radius: 2.0, focus: 1.0, blades, rotation, ratio }
    }

    /// Mean of f over a grid of samples.
    fn mean(lens: &Lens, f: impl Fn([f32; 2]) -> f32) -> f32 {
        // Whole rows for each side of every polygon below.
        let n = 240;
        let at = |i: u32| (i as f32 + 0.5) / n as f32;
        (0..n * n).map(|i| f(lens.sample([at(i % n), at(i / n)]))).sum::<f32>() / (n * n) as f32
    }

    /// ∫ r² / area: R²/2 for a disk, R² (2 + cos 2π/n) / 6 for a regular polygon.
    #[test]
    fn apertures_are_covered_evenly() {
        let squared = |[x, y]: [f32; 2]| x * x + y * y;
        assert!((mean(&lens(0, 0.0, 1.0), squared) - 2.0).abs() < 1e-3);
        for blades in [3, 5, 8] {
            let expected = 4.0 * (2.0 + (TAU / blades as f32).cos()) / 6.0;
            let lens = lens(blades, 0.3, 1.0);
            assert!((mean(&lens, squared) - expected).abs() < 2e-3 * expected, "{blades}");
            assert!(mean(&lens, |[x, _]| x).abs() < 1e-3 && mean(&lens, |[_, y]| y).abs() < 1e-3);
        }
    }

    #[test]
    fn the_ratio_narrows_and_the_rotation_turns() {
        let narrow = lens(0, 0.0, 2.0);
        assert!((mean(&narrow, |[x, _]| x * x) - 0.25).abs() < 1e-3);
        assert!((mean(&narrow, |[_, y]| y * y) - 1.0).abs() < 1e-3);
        let (still, turned) = (lens(5, 0.0, 1.0), lens(5, 0.5, 1.0));
        let ([x, y], [tx, ty]) = (still.sample([0.37, 0.8]), turned.sample([0.37, 0.8]));
        let (sin, cos) = 0.5_f32.sin_cos();
        assert!((tx - (x * cos - y * sin)).abs() < 1e-5 && (ty - (x * sin + y * cos)).abs() < 1e-5);
    }
}
