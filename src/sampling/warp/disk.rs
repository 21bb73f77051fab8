//! The unit disk by concentric squares.
//!
//! Peter Shirley and Kenneth Chiu, *A Low Distortion Map Between Disk and Square*, Journal of
//! Graphics Tools 2(3), 1997, in the form with one branch by Dave Cline.

use std::f32::consts::{FRAC_1_PI, FRAC_PI_4};

/// Density of [`sample_disk`] in area: 1/π.
pub const PDF_DISK: f32 = FRAC_1_PI;

/// A uniform point of the unit disk.
#[inline]
pub fn sample_disk(u: [f32; 2]) -> [f32; 2] {
    let a = 2.0 * u[0] - 1.0;
    let b = 2.0 * u[1] - 1.0;
    let wide = a.abs() > b.abs();
    let (r, other) = if wide { (a, b) } else { (b, a) };
    if r == 0.0 {
        return [0.0, 0.0];
    }
    let (sin, cos) = sin_cos_quarter(FRAC_PI_4 * (other / r));
    if wide { [r * cos, r * sin] } else { [r * sin, r * cos] }
}

/// Sine and cosine for |x| ≤ π/4 to 1 ulp, by the minimax polynomials of Cephes (Stephen Moshier,
/// *Methods and Programs for Mathematical Functions*, 1989). Cheaper than the C library's and the
/// same bits on every platform.
#[inline]
fn sin_cos_quarter(x: f32) -> (f32, f32) {
    let z = x * x;
    let sin = x + x * z * (-1.666_665_5e-1 + z * (8.332_161e-3 - z * 1.951_529_6e-4));
    let cos = 1.0 - 0.5 * z + z * z * (4.166_664_6e-2 + z * (-1.388_731_6e-3 + z * 2.443_315_7e-5));
    (sin, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_are_right() {
        for i in -1000..=1000 {
            let x = FRAC_PI_4 * i as f32 / 1000.0;
            let (sin, cos) = sin_cos_quarter(x);
            let (s, c) = f64::from(x).sin_cos();
            assert!((f64::from(sin) - s).abs() < 1e-7 && (f64::from(cos) - c).abs() < 1e-7, "{x}");
        }
    }

    #[test]
    fn corners_and_center() {
        assert_eq!(sample_disk([0.5, 0.5]), [0.0, 0.0]);
        for u in [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]] {
            let [x, y] = sample_disk(u);
            assert!((x * x + y * y - 1.0).abs() < 1e-6);
        }
    }
}
