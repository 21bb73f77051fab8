//! Gauss-Legendre quadrature, for what lights know of themselves before they shine.

/// Nodes and weights of the eight point rule on −1 to 1, positive half (Abramowitz and Stegun, 25.4.30).
const RULE: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Nodes from `from` to `to` with their weights: sums over them are integrals, exact to rounding for
/// what is smooth there.
pub fn nodes(from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> {
    let (mid, half) = (0.5 * (from + to), 0.5 * (to - from));
    RULE.into_iter().flat_map(move |(x, weight)| [(mid - half * x, half * weight), (mid + half * x, half * weight)])
}

/// The integral of `f` from `from` to `to`.
pub fn gauss(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    nodes(from, to).map(|(x, weight)| weight * f(x)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_exact() {
        assert!((gauss(0.0, 2.0, |x| x.powi(15)) / (65_536.0 / 16.0) - 1.0).abs() < 1e-13);
        assert!((gauss(0.0, std::f64::consts::PI, f64::sin) - 2.0).abs() < 1e-12);
    }
}
