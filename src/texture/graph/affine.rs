//! Which values are affine maps of one UV set: rows of a 4×3 matrix, `value[i] = rows[i] · (u, v, 1)`.

use crate::desc::TextureTransform;
use crate::desc::graph::{Function, Math, Value};

/// A value that is an affine map of a UV set, or of none: a constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    set: Option<u32>,
    rows: [[f64; 3]; 4],
}

impl Affine {
    /// The UV set itself.
    pub fn uv(set: u32) -> Self {
        Self { set: Some(set), rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3], [0.0, 0.0, 1.0]] }
    }

    /// A constant.
    pub fn constant(value: Value) -> Self {
        Self { set: None, rows: value.map(|x| [0.0, 0.0, x]) }
    }

    fn known(&self) -> Option<Value> {
        self.set.is_none().then(|| self.rows.map(|row| row[2]))
    }

    /// Which set, and how the first two places come from it; `None` for constants.
    pub fn placement(&self) -> Option<(u32, TextureTransform)> {
        Some((self.set?, TextureTransform([self.rows[0], self.rows[1]])))
    }

    /// `function` of `args`; `None` where that is no affine map of one set.
    pub fn apply(function: &Function, args: &[Self]) -> Option<Self> {
        let arg = |i: usize| args.get(i).copied().unwrap_or(Self::constant([0.0; 4]));
        let (a, b, c) = (arg(0), arg(1), arg(2));
        match function {
            Function::Math(Math::Add) => a.plus(&b, 1.0),
            Function::Math(Math::Subtract) => a.plus(&b, -1.0),
            Function::Math(Math::Multiply) => a.times(&b),
            Function::Math(Math::MultiplyAdd) => a.times(&b)?.plus(&c, 1.0),
            Function::Math(Math::Divide) => {
                let by = b.known().filter(|by| by.iter().all(|x| *x != 0.0))?;
                Some(Self { rows: std::array::from_fn(|i| a.rows[i].map(|x| x / by[i])), ..a })
            }
            Function::Swizzle(places) => {
                Some(Self { rows: places.map(|place| a.rows[usize::from(place.min(3))]), ..a })
            }
            Function::Combine => {
                let d = args.get(3).copied().unwrap_or(Self::constant([1.0; 4]));
                let set = [a, b, c, d].iter().try_fold(None, |set, part| one_set(set, part.set))?;
                Some(Self { set, rows: [a.rows[0], b.rows[0], c.rows[0], d.rows[0]] })
            }
            Function::Affine(rows) => Some(a.mapped(rows)),
            Function::Mapping(mapping) => Some(a.mapped(&mapping.rows(b.known()?, c.known()?, arg(3).known()?)?)),
            _ => None,
        }
    }

    fn plus(self, other: &Self, times: f64) -> Option<Self> {
        let rows = std::array::from_fn(|i| std::array::from_fn(|k| self.rows[i][k] + times * other.rows[i][k]));
        Some(Self { set: one_set(self.set, other.set)?, rows })
    }

    fn times(self, other: &Self) -> Option<Self> {
        let (by, map) = match (self.known(), other.known()) {
            (Some(by), _) => (by, other),
            (None, Some(by)) => (by, &self),
            _ => return None,
        };
        Some(Self { rows: std::array::from_fn(|i| map.rows[i].map(|x| x * by[i])), ..*map })
    }

    /// The first three places mapped by rows of a 3×4 matrix.
    fn mapped(self, rows: &[[f64; 4]; 3]) -> Self {
        let row = |r: &[f64; 4]| -> [f64; 3] {
            let sum = |k: usize| r[0] * self.rows[0][k] + r[1] * self.rows[1][k] + r[2] * self.rows[2][k];
            [sum(0), sum(1), sum(2) + r[3]]
        };
        Self { rows: [row(&rows[0]), row(&rows[1]), row(&rows[2]), self.rows[3]], ..self }
    }
}

/// The set of two parts; outer `None` where they go by different ones.
fn one_set(a: Option<u32>, b: Option<u32>) -> Option<Option<u32>> {
    match (a, b) {
        (Some(a), Some(b)) if a != b => None,
        _ => Some(a.or(b)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::graph::Mapping;

    #[test]
    fn maps_of_one_set_are_found() {
        let uv = Affine::uv(3);
        let three = Affine::constant([3.0; 4]);
        let scaled = Affine::apply(&Function::Math(Math::Multiply), &[three, uv]).unwrap();
        let moved = Affine::apply(&Function::Math(Math::Subtract), &[scaled, Affine::constant([1.0, 2.0, 0.0, 0.0])]);
        let swapped = Affine::apply(&Function::Swizzle([1, 0, 2, 3]), &[moved.unwrap()]).unwrap();
        let (set, TextureTransform(rows)) = swapped.placement().unwrap();
        assert_eq!((set, rows), (3, [[0.0, 3.0, -2.0], [3.0, 0.0, -1.0]]));
        // Turned a quarter about z: u to v.
        let args =
            [uv, Affine::constant([5.0, 0.0, 0.0, 0.0]), Affine::constant([0.0, 0.0, 0.5 * std::f64::consts::PI, 0.0])];
        let args = [args[0], args[1], args[2], Affine::constant([2.0; 4])];
        let mapped = Affine::apply(&Function::Mapping(Mapping::Point), &args).unwrap();
        let (_, TextureTransform([u, v])) = mapped.placement().unwrap();
        for (got, expected) in u.iter().chain(&v).zip([0.0, -2.0, 5.0, 2.0, 0.0, 0.0]) {
            assert!((got - expected).abs() < 1e-12, "{u:?} {v:?}");
        }
    }

    #[test]
    fn what_is_none_is_none() {
        let (uv, other) = (Affine::uv(0), Affine::uv(1));
        assert_eq!(Affine::apply(&Function::Math(Math::Add), &[uv, other]), None);
        assert_eq!(Affine::apply(&Function::Math(Math::Multiply), &[uv, uv]), None);
        assert_eq!(Affine::apply(&Function::Math(Math::Sine), &[uv]), None);
        assert_eq!(Affine::apply(&Function::Math(Math::Divide), &[uv, Affine::constant([1.0, 0.0, 1.0, 1.0])]), None);
        assert_eq!(Affine::constant([1.0; 4]).placement(), None);
    }
}
