//! Pearson's chi-square test of samples against a density, and the quadrature that it needs.
//!
//! Cells expected to hold few samples are pooled, and the significance level is corrected for the
//! number of tests in a list (Šidák 1967), so that a whole list fails by chance at the level of one.
#![allow(dead_code, reason = "each test binary uses a part")]

/// Level at which a whole list of tests fails by chance; seeds are fixed, so chance was tried once.
pub const SIGNIFICANCE: f64 = 0.01;

/// Cells expected to hold fewer samples than this are pooled.
const FEWEST: f64 = 5.0;

/// Tells whether `observed` counts can come from `expected` ones, in one of `tests` tests. The error
/// says by how much not.
pub fn check(observed: &[f64], expected: &[f64], tests: usize) -> Result<(), String> {
    assert_eq!(observed.len(), expected.len());
    let mut cells: Vec<(f64, f64)> = expected.iter().copied().zip(observed.iter().copied()).collect();
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut statistic, mut degrees) = (0.0, -1.0);
    let (mut pooled_expected, mut pooled_observed) = (0.0, 0.0);
    for (expected, observed) in cells {
        if expected < FEWEST || (pooled_expected > 0.0 && pooled_expected < FEWEST) {
            pooled_expected += expected;
            pooled_observed += observed;
        } else {
            statistic += (observed - expected).powi(2) / expected;
            degrees += 1.0;
        }
    }
    if pooled_expected >= FEWEST {
        statistic += (pooled_observed - pooled_expected).powi(2) / pooled_expected;
        degrees += 1.0;
    } else if pooled_observed > pooled_expected + 25.0 {
        return Err(format!("{pooled_observed} samples where {pooled_expected:.2} are expected"));
    }
    if degrees < 1.0 {
        return Ok(());
    }
    let p = p_value(statistic, degrees);
    let level = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / tests as f64);
    if p < level {
        return Err(format!("chi² {statistic:.1} with {degrees} degrees of freedom: p {p:.2e} below {level:.2e}"));
    }
    Ok(())
}

/// Probability of a chi-square statistic at least this large: Q(degrees/2, statistic/2).
pub fn p_value(statistic: f64, degrees: f64) -> f64 {
    upper_gamma(0.5 * degrees, 0.5 * statistic)
}

/// Regularized upper incomplete gamma function, by its series or Lentz's continued fraction (Press et
/// al., *Numerical Recipes*, section 6.2).
fn upper_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > sum * 1e-15 {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        return 1.0 - front * sum;
    }
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1e300, 1.0 / b);
    let mut h = d;
    for i in 1..10_000 {
        let an = -f64::from(i) * (f64::from(i) - a);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        h *= d * c;
        if (d * c - 1.0).abs() < 1e-14 {
            break;
        }
    }
    front * h
}

/// Stirling's series, shifted to where it is exact to 1e-13.
fn ln_gamma(x: f64) -> f64 {
    let mut shift = 0.0;
    let mut y = x;
    while y < 15.0 {
        shift += y.ln();
        y += 1.0;
    }
    let r = 1.0 / (y * y);
    let series = (1.0 / 12.0 - r * (1.0 / 360.0 - r * (1.0 / 1260.0 - r / 1680.0))) / y;
    (y - 0.5) * y.ln() - y + 0.5 * std::f64::consts::TAU.ln() + series - shift
}

/// Integral of `f` over a rectangle: Gauss-Legendre with 4 × 4 points, halved until it is steady.
pub fn integrate(f: &dyn Fn(f64, f64) -> f64, [x0, x1]: [f64; 2], [y0, y1]: [f64; 2], tolerance: f64) -> f64 {
    refine(f, [x0, x1], [y0, y1], tolerance, 0)
}

fn refine(f: &dyn Fn(f64, f64) -> f64, x: [f64; 2], y: [f64; 2], tolerance: f64, depth: u32) -> f64 {
    let (mx, my) = (0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]));
    let quarters =
        [([x[0], mx], [y[0], my]), ([mx, x[1]], [y[0], my]), ([x[0], mx], [my, y[1]]), ([mx, x[1]], [my, y[1]])];
    let coarse = gauss(f, x, y);
    let fine: f64 = quarters.iter().map(|&(x, y)| gauss(f, x, y)).sum();
    if depth >= 9 || (depth >= 1 && (fine - coarse).abs() < tolerance) {
        return fine;
    }
    quarters.iter().map(|&(x, y)| refine(f, x, y, 0.5 * tolerance, depth + 1)).sum()
}

fn gauss(f: &dyn Fn(f64, f64) -> f64, [x0, x1]: [f64; 2], [y0, y1]: [f64; 2]) -> f64 {
    const NODES: [(f64, f64); 4] = [
        (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
        (-0.339_981_043_584_856_3, 0.652_145_154_862_546_2),
        (0.339_981_043_584_856_3, 0.652_145_154_862_546_2),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    ];
    let mut sum = 0.0;
    for (a, wa) in NODES {
        for (b, wb) in NODES {
            sum += wa * wb * f(0.5 * (x0 + x1 + a * (x1 - x0)), 0.5 * (y0 + y1 + b * (y1 - y0)));
        }
    }
    0.25 * sum * (x1 - x0) * (y1 - y0)
}

/// The unit square in `nx` × `ny` cells: counts of samples and integrals of a density over them.
pub struct Grid {
    /// Cells along x.
    pub nx: usize,
    /// Cells along y.
    pub ny: usize,
}

impl Grid {
    /// The cell of a point; the border counts as inside.
    pub fn cell(&self, [x, y]: [f64; 2]) -> usize {
        let along = |v: f64, n: usize| ((v * n as f64) as usize).min(n - 1);
        along(y, self.ny) * self.nx + along(x, self.nx)
    }

    /// The integral of `density` over each cell, to `tolerance` each.
    pub fn integrals(&self, density: &dyn Fn(f64, f64) -> f64, tolerance: f64) -> Vec<f64> {
        let edges = |i: usize, n: usize| [i as f64 / n as f64, (i + 1) as f64 / n as f64];
        let cells = (0..self.ny).flat_map(|j| (0..self.nx).map(move |i| (i, j)));
        cells.map(|(i, j)| integrate(density, edges(i, self.nx), edges(j, self.ny), tolerance)).collect()
    }
}

#[test]
fn p_values_are_those_of_the_tables() {
    for (statistic, degrees, p) in [(3.841_459, 1.0, 0.05), (18.307_04, 10.0, 0.05), (135.806_7, 100.0, 0.01)] {
        assert!((p_value(statistic, degrees) - p).abs() < 1e-6 * p.max(1.0), "{degrees}");
    }
    assert!((p_value(2.0, 2.0) - (-1.0_f64).exp()).abs() < 1e-13);
}

#[test]
fn a_wrong_density_is_found() {
    let expected = vec![100.0; 50];
    let mut observed = expected.clone();
    assert!(check(&observed, &expected, 1000).is_ok());
    observed[3] = 180.0;
    observed[4] = 20.0;
    assert!(check(&observed, &expected, 1000).is_err());
    assert!(check(&[50.0, 1000.0], &[0.0, 1050.0], 1).is_err());
}
