//! Rays and the offset of their origins.

use super::Vec3;

/// A half-open segment: points `o + t d` with `0 <= t < t_max`. `d` need not be unit, and stays as
/// it is when a ray moves to object space, so that `t` means the same in every space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Origin.
    pub o: Vec3,
    /// Direction.
    pub d: Vec3,
    /// End of the segment, exclusive.
    pub t_max: f32,
    /// When it sees the scene: 0 where the camera's shutter opens, 1 where it closes.
    pub time: f32,
}

impl Ray {
    /// A ray without end, where the shutter opens.
    pub fn new(o: Vec3, d: Vec3) -> Self {
        Self { o, d, t_max: f32::INFINITY, time: 0.0 }
    }

    /// The point at `t`.
    pub fn at(&self, t: f32) -> Vec3 {
        self.o + self.d * t
    }
}

/// The origin of a ray that leaves a surface point `p` towards `w`: moved along the geometric
/// normal `ng` to the side of `w`, just beyond the box of half-width `p_err` in which rounding has
/// left `p`, and rounded away from the surface.
///
/// Matt Pharr, Wenzel Jakob, Greg Humphreys: *Physically Based Rendering*, 4th edition, 6.8.6.
pub fn offset_ray_origin(p: Vec3, p_err: Vec3, ng: Vec3, w: Vec3) -> Vec3 {
    let d = ng.abs().dot(p_err);
    let offset = if w.dot(ng) < 0.0 { -ng * d } else { ng * d };
    let moved = p + offset;
    let round_away = |v: f32, o: f32| {
        if o > 0.0 {
            v.next_up()
        } else if o < 0.0 {
            v.next_down()
        } else {
            v
        }
    };
    Vec3::new(round_away(moved.x, offset.x), round_away(moved.y, offset.y), round_away(moved.z, offset.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_offset_leaves_the_error_box_on_the_side_of_w() {
        let (p, e) = (Vec3::new(1.0e6, -3.0, 0.0), Vec3::new(0.25, 1e-6, 1e-7));
        let n = Vec3::new(0.6, 0.0, 0.8);
        let above = offset_ray_origin(p, e, n, n);
        let below = offset_ray_origin(p, e, n, -n);
        assert!((above - p).dot(n) >= n.abs().dot(e) && (below - p).dot(n) <= -n.abs().dot(e));
    }
}
