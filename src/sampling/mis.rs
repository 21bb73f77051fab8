//! Weights of multiple importance sampling (Veach, *Robust Monte Carlo Methods*, 1997, section 9.2)
//! for one sample from each of two techniques, in a form that neither overflows nor divides 0 by 0.

/// p / (p + q) for densities p, q ≥ 0 of the technique in use and of the other; 0 where p is 0 and
/// 1 where p is infinite.
pub fn balance_heuristic(p: f32, q: f32) -> f32 {
    weight(p, q, |ratio| ratio)
}

/// p² / (p² + q²), Veach's power heuristic with exponent 2, under the same rules.
pub fn power_heuristic(p: f32, q: f32) -> f32 {
    weight(p, q, |ratio| ratio * ratio)
}

/// 1 / (1 + power(q / p)): the ratio may become infinite and the weight is then 0.
fn weight(p: f32, q: f32, power: impl Fn(f32) -> f32) -> f32 {
    if p <= 0.0 {
        0.0
    } else if p.is_infinite() {
        1.0
    } else {
        1.0 / (1.0 + power(q / p))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_one() {
        for p in [1e-38, 1e-20, 0.3, 1.0, 7.0, 1e25, 3e38] {
            for q in [1e-38, 1e-20, 0.3, 1.0, 7.0, 1e25, 3e38] {
                for heuristic in [balance_heuristic, power_heuristic] {
                    assert!((heuristic(p, q) + heuristic(q, p) - 1.0).abs() < 1e-6, "{p} {q}");
                }
            }
        }
        assert!((power_heuristic(1.0, 3.0) - 0.1).abs() < 1e-7);
        assert!((balance_heuristic(1.0, 3.0) - 0.25).abs() < 1e-7);
    }

    #[test]
    fn extremes() {
        assert_eq!(power_heuristic(1e25, 1.0), 1.0);
        assert_eq!(power_heuristic(1.0, 1e25), 0.0);
        assert_eq!(power_heuristic(0.0, 0.0), 0.0);
        assert_eq!(power_heuristic(f32::INFINITY, f32::INFINITY), 1.0);
        assert_eq!(power_heuristic(1.0, 0.0), 1.0);
    }
}
