//! Hair as Cycles draws it: Catmull-Rom splines through the points, in straight pieces fine enough for their radius.

/// How far, in radii, the straight pieces may be off the spline.
const TOLERANCE: f32 = 0.05;

/// Pieces between two points, at most.
const MOST: f32 = 16.0;

/// Appends the strand through `points` with `radii`, which spline, too, to `to` and `to_radii`. Beyond its ends the
/// strand's first and last point are repeated, as in Cycles.
pub fn flatten(points: &[[f32; 3]], radii: &[f32], to: &mut Vec<[f32; 3]>, to_radii: &mut Vec<f32>) {
    flatten_like(points, points, radii, to, to_radii);
}

/// The same in as many pieces as the strand through `model`, which has as many points.
pub fn flatten_like(
    model: &[[f32; 3]],
    points: &[[f32; 3]],
    radii: &[f32],
    to: &mut Vec<[f32; 3]>,
    to_radii: &mut Vec<f32>,
) {
    let Some(last) = points.len().checked_sub(1) else { return };
    for k in 0..last {
        let four = four_of(points, radii, k);
        let pieces = pieces(&four_of(model, radii, k));
        for piece in 0..pieces {
            let [x, y, z, radius] = at(&four, piece as f32 / pieces as f32);
            to.push([x, y, z]);
            to_radii.push(radius.max(0.0));
        }
    }
    to.push(points[last]);
    to_radii.push(radii[last].max(0.0));
}

/// Appends `values` of the points of the strand through `points` with `radii` at the points that [`flatten`] makes of it:
/// straight between two, as Cycles has them.
pub fn spread(points: &[[f32; 3]], radii: &[f32], values: &[[f32; 4]], to: &mut Vec<[f32; 4]>) {
    let Some(last) = points.len().checked_sub(1) else { return };
    for k in 0..last {
        let pieces = pieces(&four_of(points, radii, k));
        let (a, b) = (values[k], values[k + 1]);
        to.extend((0..pieces).map(|piece| {
            let share = piece as f32 / pieces as f32;
            std::array::from_fn(|i| a[i] + share * (b[i] - a[i]))
        }));
    }
    to.push(values[last]);
}

/// The balls around the stretch from point `k` to the next.
fn four_of(points: &[[f32; 3]], radii: &[f32], k: usize) -> [[f32; 4]; 4] {
    let ball = |i: usize| [points[i][0], points[i][1], points[i][2], radii[i]];
    [k.saturating_sub(1), k, k + 1, (k + 2).min(points.len() - 1)].map(ball)
}

/// The spline between the second and the third ball, at `t` from 0 to 1.
fn at([a, b, c, d]: &[[f32; 4]; 4], t: f32) -> [f32; 4] {
    let weights = [
        -0.5 * t + t * t - 0.5 * t * t * t,
        1.0 - 2.5 * t * t + 1.5 * t * t * t,
        0.5 * t + 2.0 * t * t - 1.5 * t * t * t,
        -0.5 * t * t + 0.5 * t * t * t,
    ];
    std::array::from_fn(|i| weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i] + weights[3] * d[i])
}

/// How many straight pieces stay within the tolerance: the chord of a piece of length 1/n is off by at most
/// max |second derivative| / (8 n²), and that derivative is linear in t.
fn pieces([a, b, c, d]: &[[f32; 4]; 4]) -> usize {
    let radius = b[3].max(c[3]);
    let second = |at: [f32; 4]| {
        let component = |i: usize| at[0] * a[i] + at[1] * b[i] + at[2] * c[i] + at[3] * d[i];
        (0..3).map(|i| component(i) * component(i)).sum::<f32>().sqrt()
    };
    let bend = second([2.0, -5.0, 4.0, -1.0]).max(second([-1.0, 4.0, -5.0, 2.0]));
    let pieces = (bend / (8.0 * TOLERANCE * radius)).sqrt().ceil();
    // A strand without radius is not seen.
    if pieces.is_finite() { pieces.clamp(1.0, MOST) as usize } else { 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(points: &[[f32; 3]], radius: f32) -> Vec<[f32; 3]> {
        let (mut to, mut radii) = (Vec::new(), Vec::new());
        flatten(points, &vec![radius; points.len()], &mut to, &mut radii);
        assert!(to.len() == radii.len() && radii.iter().all(|r| (r - radius).abs() < 1e-6));
        to
    }

    #[test]
    fn a_straight_strand_stays_as_it_is() {
        let evenly = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]];
        let found = flat(&evenly, 10.0);
        assert_eq!(found, evenly);
        assert_eq!(flat(&evenly[..1], 1.0), evenly[..1]);
        assert!(flat(&[], 1.0).is_empty());
    }

    #[test]
    fn a_bend_is_a_spline_within_the_tolerance() {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 1.0, 0.0]];
        let (coarse, fine) = (flat(&points, 0.5), flat(&points, 0.05));
        assert!(points.iter().all(|p| coarse.contains(p) && fine.contains(p)));
        assert!(fine.len() > 2 * coarse.len(), "{} {}", fine.len(), coarse.len());
        // Half way between the middle points: (−a + 9 b + 9 c − d) / 16.
        let middle = [1.0, 0.5, 0.0];
        let nearest = fine.iter().map(|p| (p[0] - middle[0]).hypot(p[1] - middle[1])).fold(f32::INFINITY, f32::min);
        assert!(nearest < 0.06, "{nearest}");
        let radius = 0.05;
        let four = points.map(|[x, y, z]| [x, y, z, radius]);
        for i in 0..=100 {
            let [x, y, ..] = at(&four, i as f32 / 100.0);
            let off = fine.windows(2).map(|pair| distance([x, y], pair)).fold(f32::INFINITY, f32::min);
            assert!(off <= TOLERANCE * radius, "{off} at {i}");
        }
    }

    #[test]
    fn values_go_straight_from_point_to_point() {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
        let (radii, values) = ([0.05; 3], [[0.0; 4], [1.0, 2.0, 0.0, 1.0], [3.0, 0.0, 0.0, 1.0]]);
        let mut to = Vec::new();
        spread(&points, &radii, &values, &mut to);
        let flat = flat(&points, 0.05);
        assert!(to.len() == flat.len() && to.len() > 6);
        let of_point = |p: &[f32; 3]| to[flat.iter().position(|q| q == p).unwrap()];
        assert!(points.iter().zip(&values).all(|(p, value)| of_point(p) == *value));
        // Even steps within each stretch.
        let bend = flat.iter().position(|p| *p == points[1]).unwrap();
        for (i, value) in to.iter().enumerate().take(bend) {
            assert!((value[1] - 2.0 * i as f32 / bend as f32).abs() < 1e-5, "{to:?}");
        }
        spread(&[], &[], &[], &mut to);
        assert_eq!(to.len(), flat.len());
    }

    /// Distance of a point of the plane from a piece.
    fn distance(p: [f32; 2], pair: &[[f32; 3]]) -> f32 {
        let [a, b] = [pair[0], pair[1]];
        let along = [b[0] - a[0], b[1] - a[1]];
        let square = along[0] * along[0] + along[1] * along[1];
        let t = (((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / square).clamp(0.0, 1.0);
        (p[0] - a[0] - t * along[0]).hypot(p[1] - a[1] - t * along[1])
    }
}
