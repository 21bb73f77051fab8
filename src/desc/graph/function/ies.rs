//! Blender's IES Texture: a measured distribution looked up by a direction, as Cycles' kernel interpolates it.

use std::f64::consts::PI;

use super::Value;

/// A distribution over the sphere.
#[derive(Clone, Debug, PartialEq)]
pub struct IesTable {
    /// Horizontal angles in radians, growing.
    pub horizontal: Vec<f64>,
    /// Vertical angles in radians, growing; 0 is −z.
    pub vertical: Vec<f64>,
    /// A row of `vertical.len()` values for each horizontal angle.
    pub values: Vec<f64>,
    /// True where the spline goes to 0 beyond the first and last angle, as in Cycles up to 4.5.
    pub fades: bool,
}

impl IesTable {
    /// The value towards `direction`, unit or not; 0 beyond the angles that were measured.
    pub fn at(&self, [x, y, z, _]: Value) -> f64 {
        let length = (x * x + y * y + z * z).sqrt();
        if length == 0.0 {
            return 0.0;
        }
        let vertical = (-z / length).clamp(-1.0, 1.0).acos();
        let horizontal = x.atan2(y) + PI;
        let (Some(h), Some(v)) = (Step::of(&self.horizontal, horizontal), Step::of(&self.vertical, vertical)) else {
            return 0.0;
        };
        let (b, c) = (self.row(h.index, v), self.row(h.index + 1, v));
        // Cycles means to go on around the circle here, and at the upper pole; its test for a whole circle never holds in
        // single precision.
        let beyond = if self.fades { 0.0 } else { b };
        let a = if h.index == 0 { beyond } else { self.row(h.index - 1, v) };
        let d = if h.index + 2 < self.horizontal.len() { self.row(h.index + 2, v) } else { beyond };
        cubic([a, b, c, d], h.share).max(0.0)
    }

    /// The value of a row. Below 0 it goes on as if the row were even about it.
    fn row(&self, row: usize, Step { index, share }: Step) -> f64 {
        let count = self.vertical.len();
        let at = |i: usize| self.values[row * count + i];
        let (b, c) = (at(index), at(index + 1));
        let a = match index {
            0 if self.vertical[0] < 1e-7 => at(1),
            0 if self.fades => 0.0,
            0 => b,
            i => at(i - 1),
        };
        let d = match index + 2 {
            i if i < count => at(i),
            _ if self.fades => 0.0,
            _ => c,
        };
        cubic([a, b, c, d], share)
    }
}

/// Between which angles a direction is.
#[derive(Clone, Copy)]
struct Step {
    index: usize,
    share: f64,
}

impl Step {
    fn of(angles: &[f64], angle: f64) -> Option<Self> {
        let (low, high) = (*angles.first()?, *angles.last()?);
        if angle < low || angle >= high {
            return None;
        }
        let index = angles.partition_point(|&known| known < angle).max(1) - 1;
        let share = (angle - angles[index]) / (angles[index + 1] - angles[index]);
        Some(Self { index, share })
    }
}

/// The spline of Catmull and Rom.
fn cubic([a, b, c, d]: [f64; 4], x: f64) -> f64 {
    0.5 * ((((d + 3.0 * (b - c) - a) * x + (2.0 * a - 5.0 * b + 4.0 * c - d)) * x + (c - a)) * x) + b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_those_of_the_file_where_it_has_some_and_smooth_between() {
        let degrees = |angles: &[f64]| angles.iter().map(|angle| angle.to_radians()).collect::<Vec<_>>();
        let table = IesTable {
            horizontal: degrees(&[0.0, 90.0, 180.0, 270.0, 360.0]),
            vertical: degrees(&[0.0, 45.0, 90.0]),
            values: vec![8.0, 4.0, 1.0, 8.0, 5.0, 2.0, 8.0, 6.0, 3.0, 8.0, 5.0, 2.0, 8.0, 4.0, 1.0],
            fades: false,
        };
        // Horizontal angle 0 is towards −y, 90 degrees towards −x.
        let at = |x: f64, y: f64, z: f64| table.at([x, y, z, 0.0]);
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
        near(at(0.0, 0.0, -1.0), 8.0);
        near(at(-1.0, 0.0, -1.0), 5.0);
        near(at(1.0, 0.0, -1.0), 5.0);
        near(at(0.0, 2.0, -2.0), 6.0);
        assert_eq!(at(0.3, 0.2, 0.1), 0.0, "nothing was measured above the horizon");
        let between = at(0.0, 0.4, -1.0);
        assert!(between > 6.0 && between < 8.0, "{between}");
        assert_eq!(table.at([0.0; 4]), 0.0);
        // Values between the last two angles go by what is beyond them.
        let fading = IesTable { fades: true, ..table.clone() };
        let low = [0.0, 1.0, -0.2, 0.0];
        assert!((fading.at([0.0, 2.0, -2.0, 0.0]) - 6.0).abs() < 1e-9 && fading.at(low) > table.at(low));
    }
}
