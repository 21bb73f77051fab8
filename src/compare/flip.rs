//! FLIP: how different two pictures look when one flips between them, 0 the same to 1.
//!
//! P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild: *FLIP: A Difference
//! Evaluator for Alternating Images*, HPG 2020; radiance over all exposures that show something, by the worst of
//! them: P. Andersson, J. Nilsson, P. Shirley, T. Akenine-Möller: *Visualizing Errors in Rendered High Dynamic Range
//! Images*, Eurographics 2021. Seen from 0.7 m on a display 0.7 m and 3840 pixels wide, as both have it.

use rayon::prelude::*;

/// Pixels per degree of the field of view.
const PIXELS_PER_DEGREE: f32 = 0.7 * 3840.0 / 0.7 * std::f32::consts::PI / 180.0;

/// Exponent of color differences, equation 11 of the first paper.
const COLOR_EXPONENT: f32 = 0.7;
/// Differences below this share of the largest are spread over [`SPREAD`] of the range.
const KNEE: f32 = 0.4;
const SPREAD: f32 = 0.95;
/// Width of the filters that find features, in degrees.
const FEATURE_WIDTH: f32 = 0.082;

/// Luminance that the tone curve turns into this value bounds the exposures.
const TONE_BOUND: f32 = 0.85;

/// Radiance or colors, red, green and blue by pixel.
type Rgb = [f32; 3];

/// Linear RGB of Rec. 709 to XYZ over that of its white.
const TO_XYZ: [[f32; 3]; 3] = [
    [0.433_895_39, 0.376_242_37, 0.189_862_24],
    [0.212_636_82, 0.715_182_98, 0.072_180_2],
    [0.017_752_423, 0.109_465_63, 0.872_781_95],
];

/// Mean of a map.
pub fn mean(map: &[f32]) -> f64 {
    if map.is_empty() { 0.0 } else { map.iter().map(|v| f64::from(*v)).sum::<f64>() / map.len() as f64 }
}

/// LDR-FLIP by pixel of linear colors, clipped to 0 to 1; rows of `width` pixels.
pub fn of_display(reference: &[Rgb], test: &[Rgb], width: usize) -> Vec<f32> {
    let clipped = |rgb: &[Rgb]| -> Vec<Rgb> { rgb.iter().map(|p| p.map(|v| v.clamp(0.0, 1.0))).collect() };
    of_clipped(&clipped(reference), &clipped(test), width)
}

/// HDR-FLIP by pixel of radiance.
pub fn of_scene(reference: &[Rgb], test: &[Rgb], width: usize) -> Vec<f32> {
    let mut worst = vec![0.0_f32; reference.len()];
    for exposure in exposures(reference) {
        let gain = exposure.exp2();
        let shown = |rgb: &[Rgb]| -> Vec<Rgb> { rgb.par_iter().map(|p| p.map(|v| tone(v * gain))).collect() };
        let map = of_clipped(&shown(reference), &shown(test), width);
        worst.iter_mut().zip(map).for_each(|(worst, value)| *worst = worst.max(value));
    }
    worst
}

/// Coefficients of the curve that K. Narkowicz fitted to ACES (2016), for values that are exposed by 0.6.
const CURVE: [f32; 5] = [0.36 * 2.51, 0.6 * 0.03, 0.36 * 2.43, 0.6 * 0.59, 0.14];

fn tone(v: f32) -> f32 {
    let [a, b, c, d, e] = CURVE;
    // The quotient of infinities has a limit of its own.
    let v = v.min(1e15);
    ((v * (a * v + b)) / (v * (c * v + d) + e)).clamp(0.0, 1.0)
}

/// Exposures in stops, from that at which the brightest pixel reaches the bound to that at which the median does.
fn exposures(reference: &[Rgb]) -> Vec<f32> {
    let mut luminances: Vec<f32> = reference.iter().map(|p| dot(TO_XYZ[1], *p)).collect();
    if luminances.is_empty() {
        return Vec::new();
    }
    let middle = luminances.len() / 2;
    let brightest = luminances.iter().fold(0.0_f32, |most, y| most.max(*y));
    let median = *luminances.select_nth_unstable_by(middle, f32::total_cmp).1;
    let [a, b, c, d, e] = CURVE;
    // Where the curve is at the bound: the positive root of a quadratic equation.
    let (p, q, r) = (a - TONE_BOUND * c, b - TONE_BOUND * d, -TONE_BOUND * e);
    let bound = (-q + (q * q - 4.0 * p * r).sqrt()) / (2.0 * p);
    // A black picture, or one that is mostly black, has no exposure of its own.
    let start = if brightest > 0.0 { (bound / brightest).log2() } else { 0.0 };
    let stop = (bound / median.max(f32::EPSILON)).log2().max(start);
    let count = ((stop - start).ceil() as usize).max(2);
    (0..count).map(|i| start + (stop - start) * i as f32 / (count - 1) as f32).collect()
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Planes of an opponent color space, Y Cx Cz.
fn to_opponent(rgb: &[Rgb]) -> [Vec<f32>; 3] {
    let xyz = |p: &Rgb| TO_XYZ.map(|row| dot(row, *p));
    let plane = |of: fn([f32; 3]) -> f32| rgb.par_iter().map(|p| of(xyz(p))).collect();
    [plane(|[_, y, _]| 116.0 * y - 16.0), plane(|[x, y, _]| 500.0 * (x - y)), plane(|[_, y, z]| 200.0 * (y - z))]
}

/// Inverse of [`TO_XYZ`].
const FROM_XYZ: [[f32; 3]; 3] = [
    [3.080_342, -1.537_399, -0.542_943],
    [-0.921_178_4, 1.875_93, 0.045_248_41],
    [0.052_881_293, -0.204_011_2, 1.151_129_9],
];

/// L*a*b* of what is left within the display's colors, a* and b* the less the darker (Hunt's effect).
fn to_perceived([y, cx, cz]: [f32; 3]) -> [f32; 3] {
    let white = (y + 16.0) / 116.0;
    let xyz = [cx / 500.0 + white, white, white - cz / 200.0];
    let rgb = FROM_XYZ.map(|row| dot(row, xyz).clamp(0.0, 1.0));
    perceived(rgb)
}

fn perceived(rgb: Rgb) -> [f32; 3] {
    /// (6 / 29)³ and the slope below it.
    const LOW: f32 = 216.0 / 24389.0;
    let root = |v: f32| if v > LOW { v.cbrt() } else { v * (841.0 / 108.0) + 4.0 / 29.0 };
    let [x, y, z] = TO_XYZ.map(|row| root(dot(row, rgb)));
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    [lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)]
}

/// HyAB: city blocks between lightness and color, straight lines within colors.
fn hyab(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

fn of_clipped(reference: &[Rgb], test: &[Rgb], width: usize) -> Vec<f32> {
    let [reference, test] = [to_opponent(reference), to_opponent(test)];
    let most = hyab(perceived([0.0, 1.0, 0.0]), perceived([0.0, 0.0, 1.0])).powf(COLOR_EXPONENT);
    let [seen_reference, seen_test] = [&reference, &test].map(|planes| seen(planes, width));
    let [reference, test] = [&reference[0], &test[0]].map(|plane| features(plane, width));
    (0..seen_reference.len())
        .into_par_iter()
        .map(|i| {
            let color = hyab(seen_reference[i], seen_test[i]).powf(COLOR_EXPONENT);
            let knee = KNEE * most;
            let color = if color < knee {
                color * SPREAD / knee
            } else {
                SPREAD + (color - knee) / (most - knee) * (1.0 - SPREAD)
            };
            let feature = (0..2).map(|k| (reference[i][k] - test[i][k]).abs()).fold(0.0, f32::max);
            let feature = (feature * std::f32::consts::FRAC_1_SQRT_2).sqrt();
            color.min(1.0).powf(1.0 - feature.min(1.0))
        })
        .collect()
}

/// What the eye makes of the planes: blurred by its contrast sensitivity, then perceived.
fn seen(planes: &[Vec<f32>; 3], width: usize) -> Vec<[f32; 3]> {
    /// Weights and squared widths of Gaussians, table 1 of the first paper: achromatic, red-green, blue-yellow.
    const SENSITIVITY: [&[(f32, f32)]; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
    /// Of the widest.
    const WIDEST: f32 = 0.04;
    let pi = std::f32::consts::PI;
    let radius = (3.0 * (WIDEST / (2.0 * pi * pi)).sqrt() * PIXELS_PER_DEGREE).ceil() as i32;
    let blurred = |(plane, terms): (&Vec<f32>, &[(f32, f32)])| -> Vec<f32> {
        let (mut sum, mut total) = (vec![0.0; plane.len()], 0.0);
        for &(weight, squared) in terms {
            let kernel: Vec<f32> =
                (-radius..=radius).map(|i| (-(pi * i as f32 / PIXELS_PER_DEGREE).powi(2) / squared).exp()).collect();
            let area: f32 = kernel.iter().sum();
            let weight = weight * (pi / squared).sqrt() * area * area;
            let kernel: Vec<f32> = kernel.iter().map(|k| k / area).collect();
            let part = columns(&rows(plane, &kernel, width), &kernel, width);
            sum.par_iter_mut().zip(&part).for_each(|(sum, part)| *sum += weight * part);
            total += weight;
        }
        sum.iter_mut().for_each(|v| *v /= total);
        sum
    };
    let [a, b, c]: [Vec<f32>; 3] = std::array::from_fn(|k| blurred((&planes[k], SENSITIVITY[k])));
    (0..a.len()).into_par_iter().map(|i| to_perceived([a[i], b[i], c[i]])).collect()
}

/// How strong edges and points are in a plane Y of [`to_opponent`].
fn features(plane: &[f32], width: usize) -> Vec<[f32; 2]> {
    let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let radius = (3.0 * deviation).ceil() as i32;
    let at = |of: fn(f32) -> f32| -> Vec<f32> {
        (-radius..=radius).map(|i| i as f32 / deviation).map(|x| of(x) * (-0.5 * x * x).exp()).collect()
    };
    let (smooth, edge, point) = (balanced(at(|_| 1.0)), balanced(at(|x| -x)), balanced(at(|x| x * x - 1.0)));
    let luminance: Vec<f32> = plane.par_iter().map(|y| (y + 16.0) / 116.0).collect();
    let strength = |kernel: &[f32]| -> Vec<f32> {
        let across = columns(&rows(&luminance, kernel, width), &smooth, width);
        let down = columns(&rows(&luminance, &smooth, width), kernel, width);
        across.par_iter().zip(&down).map(|(x, y)| x.hypot(*y)).collect()
    };
    strength(&edge).into_iter().zip(strength(&point)).map(|(edge, point)| [edge, point]).collect()
}

/// What is positive sums to 1, and what is negative to -1.
fn balanced(kernel: Vec<f32>) -> Vec<f32> {
    let above: f32 = kernel.iter().filter(|v| **v > 0.0).sum();
    let below: f32 = -kernel.iter().filter(|v| **v < 0.0).sum::<f32>();
    kernel
        .into_iter()
        .map(|v| {
            if v > 0.0 {
                v / above
            } else if v < 0.0 {
                v / below
            } else {
                0.0
            }
        })
        .collect()
}

/// Correlation along rows; beyond the borders is what is at them.
fn rows(plane: &[f32], kernel: &[f32], width: usize) -> Vec<f32> {
    let radius = kernel.len() / 2;
    let mut result = vec![0.0; plane.len()];
    result.par_chunks_mut(width).zip(plane.par_chunks(width)).for_each(|(result, row)| {
        let mut padded = vec![row[0]; radius];
        padded.extend_from_slice(row);
        padded.extend(std::iter::repeat_n(row[width - 1], radius));
        for (value, window) in result.iter_mut().zip(padded.windows(kernel.len())) {
            *value = window.iter().zip(kernel).map(|(v, k)| v * k).sum();
        }
    });
    result
}

/// Likewise along columns.
fn columns(plane: &[f32], kernel: &[f32], width: usize) -> Vec<f32> {
    let (radius, height) = (kernel.len() / 2, plane.len() / width);
    let mut result = vec![0.0; plane.len()];
    result.par_chunks_mut(width).enumerate().for_each(|(y, result)| {
        for (i, k) in kernel.iter().enumerate() {
            let source = (y + i).saturating_sub(radius).min(height - 1) * width;
            result.iter_mut().zip(&plane[source..source + width]).for_each(|(sum, v)| *sum += v * k);
        }
    });
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_is_0_and_the_opposite_nearly_1() {
        let picture: Vec<Rgb> = (0..400).map(|i| [i as f32 / 400.0, 0.5, 0.2]).collect();
        assert!(of_display(&picture, &picture, 20).iter().all(|v| *v == 0.0));
        assert!(of_scene(&picture, &picture, 20).iter().all(|v| *v == 0.0));
        let (black, white) = (vec![[0.0; 3]; 400], vec![[1.0; 3]; 400]);
        let flip = mean(&of_display(&black, &white, 20));
        assert!((0.9..=1.0).contains(&flip), "{flip}");
        // Black pictures have no exposure.
        assert!(of_scene(&black, &white, 20).iter().all(|v| v.is_finite() && *v > 0.5));
    }

    #[test]
    fn matrices_are_inverse() {
        for rgb in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]] {
            let xyz = TO_XYZ.map(|row| dot(row, rgb));
            let back = FROM_XYZ.map(|row| dot(row, xyz));
            assert!(back.iter().zip(rgb).all(|(a, b)| (a - b).abs() < 1e-4), "{back:?}");
        }
        assert!(TO_XYZ.iter().all(|row| (row.iter().sum::<f32>() - 1.0).abs() < 1e-4), "white is 1");
    }

    /// More exposure shows what is dark: a difference there counts although it is a thousandth of the light beside it.
    #[test]
    fn differences_in_the_dark_count() {
        let a: Vec<Rgb> = (0..400).map(|i| if i < 100 { [100.0; 3] } else { [0.001; 3] }).collect();
        let mut b = a.clone();
        b[250] = [0.004; 3];
        let (display, scene) = (of_display(&a, &b, 20)[250], of_scene(&a, &b, 20)[250]);
        assert!(scene > 3.0 * display, "{display} {scene}");
    }
}
