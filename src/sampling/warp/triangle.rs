//! Uniform points of a triangle with low distortion.
//!
//! Eric Heitz, *A Low-Distortion Map Between Triangle and Square*, 2019.

/// Barycentric coordinates (b0, b1, b2), which sum to 1, of a uniform point. The density in area is
/// one over the triangle's area.
#[inline]
pub fn sample_triangle(u: [f32; 2]) -> [f32; 3] {
    let [mut b0, mut b1] = u;
    if b1 > b0 {
        b0 *= 0.5;
        b1 -= b0;
    } else {
        b1 *= 0.5;
        b0 -= b1;
    }
    [b0, b1, (1.0 - b0 - b1).max(0.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_stay_in_the_triangle() {
        for i in 0..=50 {
            for j in 0..=50 {
                let b = sample_triangle([i as f32 / 50.0, j as f32 / 50.0]);
                assert!(b.iter().all(|&b| (0.0..=1.0).contains(&b)), "{b:?}");
                assert!((b.iter().sum::<f32>() - 1.0).abs() < 1e-6);
            }
        }
        assert_eq!(sample_triangle([0.0, 0.0]), [0.0, 0.0, 1.0]);
    }
}
