//! Axis-aligned boxes.

use super::Vec3;

/// An axis-aligned box. An empty box has `min > max`; the union with it is the identity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lower corner.
    pub min: Vec3,
    /// Upper corner.
    pub max: Vec3,
}

impl Bounds {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around the points of `points`.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with_point)
    }

    /// This box grown to hold `p`.
    pub fn with_point(self, p: Vec3) -> Self {
        Self { min: self.min.min(p), max: self.max.max(p) }
    }

    /// The smallest box around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The box that both share; empty if they are apart.
    pub fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// True where no point is inside.
    pub fn is_empty(self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Edge lengths; negative for an empty box.
    pub fn extent(self) -> Vec3 {
        self.max - self.min
    }

    /// The middle.
    pub fn center(self) -> Vec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// Half of the surface area, the quantity that the surface area heuristic needs; 0 if empty.
    pub fn half_area(self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        let e = self.extent();
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    /// Radius of the sphere around [`Bounds::center`] that holds the box; 0 if empty.
    pub fn radius(self) -> f32 {
        if self.is_empty() { 0.0 } else { 0.5 * self.extent().length() }
    }

    /// The eight corners.
    pub fn corners(self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            Vec3::new(pick(0), pick(1), pick(2))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_is_the_identity_of_union() {
        let b = Bounds::of_points([Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)]);
        assert_eq!(Bounds::EMPTY.union(b), b);
        assert!(Bounds::EMPTY.is_empty());
        assert_eq!(Bounds::EMPTY.half_area(), 0.0);
        assert_eq!(b.half_area(), 2.0 + 6.0 + 3.0);
        assert_eq!(Bounds::of_points(b.corners()), b);
    }
}
