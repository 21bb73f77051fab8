//! Laws of the point patterns.

#[path = "support/chi2.rs"]
mod chi2;

use penumbra::sampling::{Decision, Dimension, PATTERNS, Pattern, Sampler};

const DIMENSIONS: [Dimension; 5] = [
    Dimension::PIXEL,
    Dimension::LENS,
    Dimension::at_bounce(0, Decision::LightPoint),
    Dimension::at_bounce(7, Decision::BsdfDirection),
    Dimension::at_bounce(0, Decision::Opacity).nth(3),
];

#[test]
fn same_question_same_answer_in_range() {
    for info in PATTERNS {
        let a = Sampler::new(info.pattern, 5);
        let b = Sampler::new(info.pattern, 5);
        for index in [0, 1, 63, 1 << 20, (1 << 32) - 1, 1 << 32, u64::MAX] {
            for dimension in DIMENSIONS {
                let (p, q) = (a.for_sample(9, 4, index), b.for_sample(9, 4, index));
                let _ = q.get_1d(Dimension::TIME);
                assert_eq!(p.get_2d(dimension), q.get_2d(dimension), "{}", info.name);
                assert_eq!(p.get_1d(dimension), q.get_1d(dimension), "{}", info.name);
                let [x, y] = p.get_2d(dimension);
                assert!([x, y, p.get_1d(dimension)].iter().all(|u| (0.0..1.0).contains(u)));
            }
        }
        assert_eq!(Pattern::from_name(info.name), Some(info.pattern));
    }
}

#[test]
fn seeds_pixels_decisions_and_runs_differ() {
    for info in PATTERNS {
        let draw = |seed, x, y, index, d| Sampler::new(info.pattern, seed).for_sample(x, y, index).get_2d(d);
        let first = draw(0, 0, 0, 0, Dimension::PIXEL);
        assert_ne!(first, draw(1, 0, 0, 0, Dimension::PIXEL));
        assert_ne!(first, draw(0, 1, 0, 0, Dimension::PIXEL));
        assert_ne!(first, draw(0, 0, 1, 0, Dimension::PIXEL));
        assert_ne!(first, draw(0, 0, 0, 1, Dimension::PIXEL));
        assert_ne!(first, draw(0, 0, 0, 0, Dimension::LENS));
        assert_ne!(first, draw(0, 0, 0, 1 << 32, Dimension::PIXEL));
    }
}

/// Each elementary interval of area 1/n holds one of n points, for each run of n = 2ᵐ aligned to n.
#[test]
fn sobol_points_are_nets() {
    for (seed, start) in [(0, 0u64), (1, 3), (2, (1 << 32) - 1), (3, 1 << 32)] {
        let base = Sampler::new(Pattern::Sobol, seed);
        for dimension in DIMENSIONS {
            for m in 0..=10u32 {
                let n = 1u64 << m;
                let run = if start < 10 { start * n } else { start / n * n };
                let draw = |i| base.for_sample(17, 3, run + i);
                let points: Vec<[f32; 2]> = (0..n).map(|i| draw(i).get_2d(dimension)).collect();
                for wide in 0..=m {
                    let (nx, ny) = (1u64 << wide, 1u64 << (m - wide));
                    let mut hit = vec![false; n as usize];
                    for [x, y] in &points {
                        let cell = (f64::from(*y) * ny as f64) as u64 * nx + (f64::from(*x) * nx as f64) as u64;
                        assert!(!std::mem::replace(&mut hit[cell as usize], true), "{dimension:?} {nx} × {ny}");
                    }
                }
                let mut hit = vec![false; n as usize];
                for i in 0..n {
                    let cell = (f64::from(draw(i).get_1d(dimension)) * n as f64) as usize;
                    assert!(!std::mem::replace(&mut hit[cell], true), "{dimension:?} {n} in 1D");
                }
            }
        }
    }
}

/// 16 samples of 4 parts each fill 64 cells.
#[test]
fn parts_of_samples_are_one_net() {
    let base = Sampler::new(Pattern::Sobol, 6);
    let dimension = Dimension::at_bounce(0, Decision::Ao);
    let mut hit = [false; 64];
    for i in 0..16 {
        let sample = base.for_sample(5, 5, i);
        for k in 0..4 {
            let [x, y] = sample.part(k, 4).get_2d(dimension);
            let cell = (y * 8.0) as usize * 8 + (x * 8.0) as usize;
            assert!(!std::mem::replace(&mut hit[cell], true));
        }
        assert_eq!(sample.part(0, 1).get_2d(dimension), sample.get_2d(dimension));
    }
    let far = base.for_sample(5, 5, (1 << 32) - 1).part(3, 4);
    assert_ne!(far.get_2d(dimension), base.for_sample(5, 5, (1 << 32) - 1).get_2d(dimension));
}

/// Coordinates of different decisions, and of different pixels, spread over the square as independent
/// ones do, over many short runs.
#[test]
fn decisions_and_pixels_are_independent() {
    type Draw = fn(&Sampler, u32, u64) -> f32;
    let draws: [(&str, Draw, Draw); 6] = [
        (
            "two decisions",
            |s, p, i| s.for_sample(p, 0, i).get_2d(DIMENSIONS[0])[0],
            |s, p, i| s.for_sample(p, 0, i).get_2d(DIMENSIONS[1])[0],
        ),
        (
            "x and y of two decisions",
            |s, p, i| s.for_sample(p, 0, i).get_2d(DIMENSIONS[2])[0],
            |s, p, i| s.for_sample(p, 0, i).get_2d(DIMENSIONS[3])[1],
        ),
        (
            "1D and 2D",
            |s, p, i| s.for_sample(p, 0, i).get_1d(Dimension::TIME),
            |s, p, i| s.for_sample(p, 0, i).get_2d(Dimension::LENS)[1],
        ),
        (
            "1D of two bounces",
            |s, p, i| s.for_sample(p, 0, i).get_1d(Dimension::at_bounce(0, Decision::BsdfLobe)),
            |s, p, i| s.for_sample(p, 0, i).get_1d(Dimension::at_bounce(1, Decision::BsdfLobe)),
        ),
        (
            "two pixels",
            |s, p, i| s.for_sample(p, 0, i).get_2d(DIMENSIONS[0])[0],
            |s, p, i| s.for_sample(p, 1, i).get_2d(DIMENSIONS[0])[0],
        ),
        (
            "two seeds",
            |s, p, i| s.for_sample(p, 0, i).get_2d(DIMENSIONS[0])[1],
            |_, p, i| Sampler::new(Pattern::Sobol, 99).for_sample(p, 0, i).get_2d(DIMENSIONS[0])[1],
        ),
    ];
    let grid = chi2::Grid { nx: 16, ny: 16 };
    let (pixels, samples) = (4096, 16);
    for info in PATTERNS {
        for (name, a, b) in draws {
            let sampler = Sampler::new(info.pattern, 3);
            let mut observed = vec![0.0; 256];
            for p in 0..pixels {
                for i in 0..samples {
                    observed[grid.cell([f64::from(a(&sampler, p, i)), f64::from(b(&sampler, p, i))])] += 1.0;
                }
            }
            let expected = vec![f64::from(pixels) * samples as f64 / 256.0; 256];
            let tests = draws.len() * PATTERNS.len();
            chi2::check(&observed, &expected, tests).unwrap_or_else(|e| panic!("{}, {name}: {e}", info.name));
        }
    }
}

/// Within one pixel: 4096 points of two decisions cover 32 × 32 cells as independent points would.
#[test]
fn decisions_are_independent_within_a_pixel() {
    let grid = chi2::Grid { nx: 32, ny: 32 };
    for info in PATTERNS {
        let sampler = Sampler::new(info.pattern, 8);
        let mut observed = vec![0.0; 1024];
        for i in 0..1 << 14 {
            let s = sampler.for_sample(2, 2, i);
            let x = s.get_2d(DIMENSIONS[2])[0];
            let y = s.get_2d(DIMENSIONS[3])[0];
            observed[grid.cell([f64::from(x), f64::from(y)])] += 1.0;
        }
        chi2::check(&observed, &vec![16.0; 1024], PATTERNS.len()).unwrap_or_else(|e| panic!("{}: {e}", info.name));
    }
}

/// Slope of log₂ RMSE against log₂ n over many pixels.
fn slope(pattern: Pattern, f: fn([f32; 2]) -> f64, exact: f64) -> f64 {
    let rmse = |n: u64| {
        let sampler = Sampler::new(pattern, 4);
        let pixels = 256;
        let error = |p: u32| {
            let sum: f64 = (0..n).map(|i| f(sampler.for_sample(p, 0, i).get_2d(Dimension::PIXEL))).sum();
            sum / n as f64 - exact
        };
        ((0..pixels).map(|p| error(p).powi(2)).sum::<f64>() / f64::from(pixels)).sqrt()
    };
    (rmse(1024).log2() - rmse(16).log2()) / 6.0
}

/// Theory: −1/2 for independent points; for Owen-scrambled nets −3/2 (Owen 1997) where the integrand
/// is smooth and −3/4 across a curved edge.
#[test]
fn error_falls_as_theory_says() {
    let smooth: fn([f32; 2]) -> f64 = |[x, y]| (f64::from(x) + 2.0 * f64::from(y)).exp();
    let smooth_exact = (1f64.exp() - 1.0) * (2f64.exp() - 1.0) / 2.0;
    let edge: fn([f32; 2]) -> f64 = |[x, y]| if x * x + y * y < 0.64 { 1.0 } else { 0.0 };
    let edge_exact = 0.64 * std::f64::consts::FRAC_PI_4;
    for (pattern, f, exact, low, high) in [
        (Pattern::Independent, smooth, smooth_exact, -0.56, -0.44),
        (Pattern::Independent, edge, edge_exact, -0.56, -0.44),
        (Pattern::Sobol, smooth, smooth_exact, -1.65, -1.35),
        (Pattern::Sobol, edge, edge_exact, -0.85, -0.65),
    ] {
        let slope = slope(pattern, f, exact);
        println!("{} {slope:.3}", pattern.name());
        assert!((low..high).contains(&slope), "{}: slope {slope}", pattern.name());
    }
}
