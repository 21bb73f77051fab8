//! Functions that place textures.

use std::f64::consts::{PI, TAU};

use super::Value;
use super::math::divide;
use super::vector::{add, affine, cross, dot, length, normalize, scale, sub};

/// What a mapping does to a vector, with a location, a rotation (Euler XYZ, radians) and a scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mapping {
    /// Scaled, turned, moved.
    Point,
    /// The other way round: what moves, turns and scales the texture.
    Texture,
    /// Scaled and turned.
    Vector,
    /// Divided by the scale, turned, unit.
    Normal,
}

impl Mapping {
    pub(super) fn eval(self, v: Value, location: Value, rotation: Value, by: Value) -> Value {
        let turn = euler(rotation);
        let times = |f: fn(f64, f64) -> f64, a: Value| [f(a[0], by[0]), f(a[1], by[1]), f(a[2], by[2]), a[3]];
        match self {
            Self::Point => add(affine(&turn, times(|a, b| a * b, v)), [location[0], location[1], location[2], 0.0]),
            Self::Texture => times(divide, affine(&transposed(&turn), sub(v, location))),
            Self::Vector => affine(&turn, times(|a, b| a * b, v)),
            Self::Normal => normalize(affine(&turn, times(divide, v)), 3),
        }
    }

    /// The same as an affine map of the vector: rows of a 3×4 matrix; `None` for normals.
    pub fn rows(self, location: Value, rotation: Value, by: Value) -> Option<[[f64; 4]; 3]> {
        if self == Self::Normal {
            return None;
        }
        let column = |k: usize| {
            let unit: Value = std::array::from_fn(|i| f64::from(u8::from(i == k)));
            let origin = self.eval([0.0; 4], location, rotation, by);
            sub(self.eval(unit, location, rotation, by), origin)
        };
        let (columns, origin) = ([0, 1, 2].map(column), self.eval([0.0; 4], location, rotation, by));
        Some(std::array::from_fn(|i| [columns[0][i], columns[1][i], columns[2][i], origin[i]]))
    }
}

/// Rotation about x, then y, then z, as rows of a matrix without translation.
fn euler([x, y, z, _]: Value) -> [[f64; 4]; 3] {
    let ((sx, cx), (sy, cy), (sz, cz)) = (x.sin_cos(), y.sin_cos(), z.sin_cos());
    [
        [cy * cz, sy * sx * cz - cx * sz, sy * cx * cz + sx * sz, 0.0],
        [cy * sz, sy * sx * sz + cx * cz, sy * cx * sz - sx * cz, 0.0],
        [-sy, cy * sx, cy * cx, 0.0],
    ]
}

fn transposed(m: &[[f64; 4]; 3]) -> [[f64; 4]; 3] {
    std::array::from_fn(|i| [m[0][i], m[1][i], m[2][i], 0.0])
}

/// Rodrigues' rotation of `v` about an axis through `center`; without an axis it stays.
pub(super) fn rotate_axis(v: Value, center: Value, axis: Value, angle: f64) -> Value {
    let axis = normalize(axis, 3);
    if length(axis) == 0.0 {
        return v;
    }
    let (sin, cos) = angle.sin_cos();
    let from = sub(v, center);
    let along = scale(axis, dot(axis, from, 3) * (1.0 - cos));
    add(add(add(scale(from, cos), scale(cross(axis, from), sin)), along), center)
}

pub(super) fn rotate_euler(v: Value, center: Value, rotation: Value, invert: bool) -> Value {
    let turn = euler(rotation);
    let turn = if invert { transposed(&turn) } else { turn };
    add(affine(&turn, sub(v, center)), center)
}

/// u around z, from −y on clockwise seen from above; v from below to above.
pub(super) fn sphere(v: Value) -> Value {
    let length = length(v);
    if length == 0.0 {
        return [0.0, 0.0, 0.0, 1.0];
    }
    let around = if v[0] == 0.0 && v[1] == 0.0 { 0.0 } else { 0.5 - v[0].atan2(v[1]) / TAU };
    [around, 1.0 - (v[2] / length).clamp(-1.0, 1.0).acos() / PI, 0.0, 1.0]
}

/// u as on a sphere; v is the height, −1 to 1 taken to 0 to 1.
pub(super) fn tube(v: Value) -> Value {
    if v[0] == 0.0 && v[1] == 0.0 {
        return [0.0, 0.0, 0.0, 1.0];
    }
    [0.5 - v[0].atan2(v[1]) / TAU, 0.5 * (v[2] + 1.0), 0.0, 1.0]
}

/// The middle of the picture is towards +x, its upper edge +z.
pub(super) fn equirectangular(v: Value) -> Value {
    let length = length(v);
    if length == 0.0 {
        return [0.0, 0.0, 0.0, 1.0];
    }
    let around = if v[0] == 0.0 && v[1] == 0.0 { 0.0 } else { v[1].atan2(v[0]) };
    [0.5 - around / TAU, 1.0 - (v[2] / length).clamp(-1.0, 1.0).acos() / PI, 0.0, 1.0]
}

/// The picture of a small mirror ball seen along +y: its normal is half-way between the direction and −y.
pub(super) fn mirror_ball(v: Value) -> Value {
    let d = normalize(v, 3);
    let half = [d[0], d[1] - 1.0, d[2], 0.0];
    let length = length(half);
    let [x, z] = if length > 0.0 { [half[0] / length, half[2] / length] } else { [0.0; 2] };
    [0.5 * (x + 1.0), 0.5 * (z + 1.0), 0.0, 1.0]
}

/// Shares of the projections along x, y and z. Seen as barycentrics of a triangle, whose corners are the
/// faces of a cube, they are 1 near the corners and linear across a strip of width `blend` between them.
pub(super) fn box_weights(normal: Value, blend: f64) -> Value {
    let sum = normal[0].abs() + normal[1].abs() + normal[2].abs();
    if sum == 0.0 {
        return [1.0, 0.0, 0.0, 1.0];
    }
    let n: [f64; 3] = std::array::from_fn(|i| normal[i].abs() / sum);
    let limit = 0.5 * (1.0 + blend);
    let others = |i: usize| [(i + 1) % 3, (i + 2) % 3];
    // One side, by more than the strip.
    if let Some(i) = (0..3).find(|&i| others(i).iter().all(|&j| n[i] > limit * (n[i] + n[j]))) {
        return std::array::from_fn(|k| f64::from(u8::from(k == i || k == 3)));
    }
    if blend <= 0.0 {
        return [1.0, 0.0, 0.0, 1.0];
    }
    // Two sides, the third one beyond the strip.
    for (first, second, third) in [(0, 1, 2), (1, 2, 0), (0, 2, 1)] {
        if n[third] < (1.0 - limit) * (n[first] + n[second]) {
            let share = n[first] / (n[first] + n[second]);
            let share = ((share - 0.5 * (1.0 - blend)) / blend).clamp(0.0, 1.0);
            let mut weights = [0.0, 0.0, 0.0, 1.0];
            (weights[first], weights[second]) = (share, 1.0 - share);
            return weights;
        }
    }
    let three = |n: f64| ((2.0 - limit) * n + (limit - 1.0)) / (2.0 * limit - 1.0);
    [three(n[0]), three(n[1]), three(n[2]), 1.0]
}

#[cfg(test)]
mod tests {
    use super::super::Function;
    use super::*;

    fn is(got: Value, expected: [f64; 3]) {
        assert!(got.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{got:?} is not {expected:?}");
    }

    #[test]
    fn mappings_undo_each_other() {
        let (location, turn, by) = ([1.0, 2.0, 3.0, 0.0], [0.3, -0.4, 0.5, 0.0], [2.0, 3.0, -4.0, 0.0]);
        let v = [0.1, 0.7, -0.3, 0.0];
        let point = Function::Mapping(Mapping::Point).eval(&[v, location, turn, by]);
        is(Function::Mapping(Mapping::Texture).eval(&[point, location, turn, by]), [v[0], v[1], v[2]]);
        let vector = Function::Mapping(Mapping::Vector).eval(&[v, location, turn, by]);
        is(sub(point, vector), [1.0, 2.0, 3.0]);
        // A normal stays square to the surface: n' · (turn (scale t)) = n · t.
        let (n, t) = ([0.6, 0.8, 0.0, 0.0], [-0.8, 0.6, 0.5, 0.0]);
        let normal = Function::Mapping(Mapping::Normal).eval(&[n, location, turn, by]);
        let tangent = Function::Mapping(Mapping::Vector).eval(&[t, location, turn, by]);
        assert!(dot(normal, tangent, 3).abs() < 1e-12 && (length(normal) - 1.0).abs() < 1e-12);
        for mapping in [Mapping::Point, Mapping::Texture, Mapping::Vector] {
            let rows = mapping.rows(location, turn, by).unwrap();
            let expected = mapping.eval(v, location, turn, by);
            is(affine(&rows, v), [expected[0], expected[1], expected[2]]);
        }
        // About z alone: x goes to y.
        let quarter = [0.0, 0.0, PI / 2.0, 0.0];
        is(Function::Mapping(Mapping::Vector).eval(&[[1.0, 0.0, 0.0, 0.0], v, quarter, [1.0; 4]]), [0.0, 1.0, 0.0]);
        // Nothing is divided by 0.
        is(Function::Mapping(Mapping::Texture).eval(&[v, v, turn, [0.0; 4]]), [0.0; 3]);
    }

    #[test]
    fn rotations() {
        let v = [2.0, 1.0, 1.0, 0.0];
        let (center, z) = ([1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 5.0, 0.0]);
        is(Function::RotateAxis.eval(&[v, center, z, [PI / 2.0; 4]]), [1.0, 2.0, 1.0]);
        is(Function::RotateAxis.eval(&[v, center, [0.0; 4], [1.0; 4]]), [2.0, 1.0, 1.0]);
        let quarter = [0.0, 0.0, PI / 2.0, 0.0];
        is(Function::RotateEuler { invert: false }.eval(&[v, center, quarter]), [1.0, 2.0, 1.0]);
        is(Function::RotateEuler { invert: true }.eval(&[v, center, quarter]), [1.0, 0.0, 1.0]);
        let turn = [0.3, -0.4, 0.5, 0.0];
        let there = Function::RotateEuler { invert: false }.eval(&[v, center, turn]);
        is(Function::RotateEuler { invert: true }.eval(&[there, center, turn]), [2.0, 1.0, 1.0]);
    }

    #[test]
    fn projections() {
        is(Function::SphereMap.eval(&[[0.0, -2.0, 0.0, 0.0]]), [0.0, 0.5, 0.0]);
        is(Function::SphereMap.eval(&[[0.0, 1.0, 1.0, 0.0]]), [0.5, 0.75, 0.0]);
        is(Function::SphereMap.eval(&[[0.0, 0.0, 1.0, 0.0]]), [0.0, 1.0, 0.0]);
        is(Function::TubeMap.eval(&[[3.0, 0.0, 0.5, 0.0]]), [0.25, 0.75, 0.0]);
        is(Function::Equirectangular.eval(&[[2.0, 0.0, 0.0, 0.0]]), [0.5, 0.5, 0.0]);
        is(Function::Equirectangular.eval(&[[0.0, 2.0, 2.0, 0.0]]), [0.25, 0.75, 0.0]);
        is(Function::MirrorBall.eval(&[[0.0, -1.0, 0.0, 0.0]]), [0.5, 0.5, 0.0]);
        let side = 0.5 * (1.0 + 0.5_f64.sqrt());
        is(Function::MirrorBall.eval(&[[1.0, 0.0, 0.0, 0.0]]), [side, 0.5, 0.0]);
        is(Function::MirrorBall.eval(&[[0.0, 1.0, 0.0, 0.0]]), [0.5, 0.5, 0.0]);
    }

    #[test]
    fn weights_of_a_box_sum_to_one_and_change_without_a_jump() {
        is(Function::BoxWeights(0.0).eval(&[[0.9, -1.0, 0.3, 0.0]]), [0.0, 1.0, 0.0]);
        is(Function::BoxWeights(0.5).eval(&[[1.0, -1.0, 0.0, 0.0]]), [0.5, 0.5, 0.0]);
        is(Function::BoxWeights(0.5).eval(&[[1.0, 1.0, -1.0, 0.0]]), [1.0 / 3.0; 3]);
        let mut last: Option<Value> = None;
        for i in 0..1000 {
            let n = [1.0, f64::from(i) / 1000.0, 0.4, 0.0];
            let weights = Function::BoxWeights(0.3).eval(&[n]);
            assert!((weights[0] + weights[1] + weights[2] - 1.0).abs() < 1e-9, "{weights:?}");
            if let Some(last) = last {
                assert!((0..3).all(|k| (last[k] - weights[k]).abs() < 0.01), "{n:?}: {last:?} to {weights:?}");
            }
            last = Some(weights);
        }
    }
}
