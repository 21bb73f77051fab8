//! Thin lenses: where on the aperture a ray starts.

use std::f32::consts::{PI, TAU};

/// A thin lens (Cook, Porter, Carpenter: *Distributed Ray Tracing*, SIGGRAPH 1984).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Of the circle around the aperture.
    pub radius: f32,
    /// Distance along the axis at which the picture is sharp; may be infinite.
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

    /// Samples on a grid: whole rows for each side of every polygon of 3 to 8 corners.
    fn samples(lens: &Lens) -> impl ExactSizeIterator<Item = [f32; 2]> {
        let (columns, rows) = (840, 120);
        let at = |i: u32, n: u32| (i as f32 + 0.5) / n as f32;
        (0..columns * rows).map(move |i| lens.sample([at(i % columns, columns), at(i / columns, rows)]))
    }

    /// Mean of f over them.
    fn mean(lens: &Lens, f: impl Fn([f32; 2]) -> f32) -> f32 {
        let samples = samples(lens);
        let n = samples.len() as f64;
        (samples.map(|p| f64::from(f(p))).sum::<f64>() / n) as f32
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

    /// The mean of z^k over the lens, z = x + i y; f64, as powers of all samples are added.
    fn power(lens: &Lens, k: u32) -> [f64; 2] {
        let times = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a * c - b * d, a * d + b * c];
        let mut sum = [0.0; 2];
        let samples = samples(lens);
        let n = samples.len() as f64;
        for z in samples.map(|z| z.map(f64::from)) {
            let z_k = (0..k).fold([1.0, 0.0], |power, _| times(power, z));
            sum = [sum[0] + z_k[0], sum[1] + z_k[1]];
        }
        sum.map(|x| x / n)
    }

    /// Over the triangle of the middle and the corners a, b the mean of z^n is 2 Σ a^k b^(n−k) / ((n + 1) (n + 2)). Summed
    /// over the sides of a polygon of n corners that is −2 Rⁿ e^(i n rotation) / ((n + 1) (n + 2)), and 0 for lower powers:
    /// which way it is turned, and that its sides are straight.
    #[test]
    fn the_first_power_that_is_not_even_is_that_of_a_polygon() {
        for blades in 3..=8_u32 {
            for rotation in [0.0, 0.3, -0.7, 2.0] {
                let lens = lens(blades, rotation, 1.0);
                let n = f64::from(blades);
                let size = 2.0_f64.powi(blades as i32) * 2.0 / ((n + 1.0) * (n + 2.0));
                let (sin, cos) = (n * f64::from(rotation)).sin_cos();
                let [x, y] = power(&lens, blades);
                let off = (x + size * cos).hypot(y + size * sin);
                assert!(off < 4e-3 * size, "{blades} {rotation}: {x} {y} for {size} at {sin} {cos}");
                for k in 1..blades {
                    let [x, y] = power(&lens, k);
                    assert!(x.hypot(y) < 4e-3 * 2.0_f64.powi(k as i32), "{blades} {rotation} {k}: {x} {y}");
                }
            }
        }
    }

    /// A name, what it is the mean of, and that mean.
    type Moment<'a> = (&'static str, &'a dyn Fn([f32; 2]) -> f32, f32);

    /// With the apothem h and t = tan π/n: ⟨r²⟩ = h² (1 + t²/3) / 2, ⟨r⁴⟩ = h⁴ (1 + 2 t²/3 + t⁴/5) / 3; for five corners or
    /// more but 6 ⟨x²y²⟩ = 2 ⟨x⁴⟩ = ¾ ⟨r⁴⟩ as on a disk, where ⟨r⁴⟩ = R⁴/3. A ratio q divides each x by q.
    #[test]
    fn second_and_fourth_moments_are_those_of_polygons_made_narrower() {
        for blades in [0, 5, 6, 7, 8] {
            let (h, t) = match blades {
                0 => (2.0, 0.0),
                n => (2.0 * (PI / n as f32).cos(), (PI / n as f32).tan()),
            };
            let second = 0.5 * h.powi(2) * (1.0 + t * t / 3.0);
            let fourth = h.powi(4) * (1.0 + 2.0 * t * t / 3.0 + t.powi(4) / 5.0) / 3.0;
            for (rotation, q) in [(0.0, 1.0), (0.4, 2.0), (1.1, 0.5)] {
                let lens = lens(blades, rotation, q);
                let moments: [Moment<'_>; 6] = [
                    ("x²", &|[x, _]| x * x, 0.5 * second / (q * q)),
                    ("y²", &|[_, y]| y * y, 0.5 * second),
                    ("xy", &|[x, y]| x * y, 0.0),
                    ("x⁴", &|[x, _]| x.powi(4), 0.375 * fourth / q.powi(4)),
                    ("y⁴", &|[_, y]| y.powi(4), 0.375 * fourth),
                    ("x²y²", &|[x, y]| (x * y).powi(2), 0.125 * fourth / (q * q)),
                ];
                for (what, f, expected) in moments {
                    let found = mean(&lens, f);
                    let scale = if expected == 0.0 { 0.5 * second / q } else { expected };
                    assert!(
                        (found - expected).abs() < 6e-3 * scale,
                        "{blades} {rotation} {q} {what}: {found} {expected}"
                    );
                }
            }
        }
    }

    /// No sample is outside, and some are in every corner: the largest distance from the middle along each corner and each
    /// side.
    #[test]
    fn samples_reach_the_corners_and_no_farther() {
        for (blades, rotation) in [(3, 0.0), (5, 0.4), (8, -1.0)] {
            let lens = lens(blades, rotation, 1.0);
            let samples: Vec<[f32; 2]> = samples(&lens).collect();
            for side in 0..blades {
                for (half, reach) in [(0.0, 2.0 * (PI / blades as f32).cos()), (0.5, 2.0)] {
                    let (sin, cos) = (rotation + (side as f32 + half) * TAU / blades as f32).sin_cos();
                    let farthest = samples.iter().map(|[x, y]| x * cos + y * sin).fold(0.0, f32::max);
                    assert!(farthest <= reach * (1.0 + 1e-6) && farthest > 0.98 * reach, "{blades} {side}: {farthest}");
                }
            }
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
