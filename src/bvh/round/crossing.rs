//! Where a line meets a round cone, in `f64`.
//!
//! A round cone is convex, so a line has one stretch within it. Its ends lie on the side, where a
//! quadratic gives them, or on one of the balls. All is computed relative to where the line passes the
//! axis closest by, since far away the squares of distances would swallow that of a hair's radius
//! (E. Haines, J. Günther, T. Akenine-Möller: *Precision Improvements for Ray/Sphere Intersection*, Ray
//! Tracing Gems, 2019, chapter 7). Of a side, with the point x relative to the axis, radius r there, axis
//! a from centre to centre and radii that shrink by k over its length,
//!
//! `(a² − k²) x² − (x·a)² + 2 r k (x·a) − r² a² = 0`, between the circles where it touches the balls.

use crate::math::{Ball, DVec3, RoundCone, center_of};

/// Depth, relative to the size of a segment, below which a point is not inside its neighbour: rounding.
const BURIED: f64 = 1e-9;

/// Depth that a ray must reach inside, relative to its way there, for not to be one that leaves: rounding
/// of its direction and of the normal.
const GRAZING: f64 = 1e-6;

/// A ray in the space of the balls.
pub(in crate::bvh) struct Line {
    pub o: DVec3,
    pub d: DVec3,
    /// Square of the direction's length, and the length.
    square: f64,
    length: f64,
    /// How far rounding may have moved the origin.
    o_err: f64,
}

/// The stretch of a line within a round cone.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    /// Where the line passes close by.
    t: f64,
    /// The point there, relative to the first centre.
    p: DVec3,
    /// Both ends, relative to `t`.
    ends: [f64; 2],
}

/// A segment, and the balls before and after it on the same strand, of NaN where there are none.
pub(in crate::bvh) struct Segment {
    pub ends: [Ball; 2],
    pub beyond: [Ball; 2],
}

impl Line {
    pub fn new(o: [f32; 3], d: [f32; 3], o_err: f32) -> Self {
        let [o, d] = [o, d].map(|v| DVec3::from(v.map(f64::from)));
        let square = d.length_squared();
        Self { o, d, square, length: square.sqrt(), o_err: o_err.into() }
    }

    /// `v` without its part along the line.
    fn across(&self, v: DVec3) -> DVec3 {
        v - self.d * (v.dot(self.d) / self.square)
    }

    /// The stretch within the ball of `radius` about `center`, for a line whose origin is `o`, both
    /// relative to the first centre.
    fn through_ball(&self, o: DVec3, center: DVec3, radius: f64) -> Option<Crossing> {
        let t = (center - o).dot(self.d) / self.square;
        let p = o + self.d * t;
        let rest = radius * radius - (p - center).length_squared();
        let half = (rest / self.square).sqrt();
        (rest >= 0.0).then_some(Crossing { t, p, ends: [-half, half] })
    }

    fn through(&self, [a, b]: [Ball; 2]) -> Option<Crossing> {
        let o = self.o - center_of(a);
        let axis = center_of(b) - center_of(a);
        let [ra, rb] = [a[3], b[3]].map(f64::from);
        let shrink = ra - rb;
        let axis_square = axis.length_squared();
        let lean = axis_square - shrink * shrink;
        if lean <= 0.0 {
            let (center, radius) = if shrink < 0.0 { (axis, rb) } else { (DVec3::ZERO, ra) };
            return self.through_ball(o, center, radius);
        }
        // The way from the axis to the line, and from the axis' point that is nearest to it.
        let (from_first, step) = (self.across(o), self.across(axis));
        let step_square = step.length_squared();
        let s = if step_square > 0.0 { (from_first.dot(step) / step_square).clamp(0.0, 1.0) } else { 0.0 };
        let x = from_first - step * s;
        let x_square = x.length_squared();
        if x_square > ra.max(rb) * ra.max(rb) {
            return None;
        }
        let r = ra - shrink * s;
        let t = (axis * s - o).dot(self.d) / self.square;
        let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
        let mut add = |end: f64| ends = [ends[0].min(end), ends[1].max(end)];
        let (along, speed) = (x.dot(axis), self.d.dot(axis));
        let range = [ra * shrink - s * axis_square, (1.0 - s) * axis_square + rb * shrink];
        let square = self.square * (step_square - shrink * shrink);
        let half = speed * (r * shrink - along);
        let rest = lean * x_square - along * along + 2.0 * r * shrink * along - r * r * axis_square;
        let discriminant = half * half - square * rest;
        let mut on_side = 0;
        if discriminant >= 0.0 {
            let q = -(half + discriminant.sqrt().copysign(half));
            for root in [q / square, rest / q] {
                if root.is_finite() && (range[0]..=range[1]).contains(&(along + root * speed)) {
                    add(root);
                    on_side += 1;
                }
            }
        }
        if on_side < 2 {
            let from_last = from_first - step;
            let balls = [(from_first, -s, ra), (from_last, 1.0 - s, rb)];
            for (x, share, radius) in balls {
                let rest = radius * radius - x.length_squared();
                if rest >= 0.0 {
                    let (middle, half) = (share * speed / self.square, (rest / self.square).sqrt());
                    add(middle - half);
                    add(middle + half);
                }
            }
        }
        (ends[0] <= ends[1]).then_some(Crossing { t, p: x + axis * s, ends })
    }

    /// The first point at which the line enters or leaves the strand's surface on `segment` where
    /// `accepts` allows it, with its place relative to the first centre.
    ///
    /// What lies within a neighbouring segment is no surface. A line that starts on the surface, within
    /// rounding, does not meet it there.
    pub fn hit(&self, segment: &Segment, accepts: impl Fn(f32) -> bool) -> Option<(f32, DVec3)> {
        let crossing = self.through(segment.ends)?;
        let skip = self.starts_on(segment, &crossing)?;
        crossing.ends.into_iter().skip(skip).find_map(|end| {
            let t = (crossing.t + end) as f32;
            if !(t >= 0.0 && accepts(t)) {
                return None;
            }
            let p = crossing.p + self.d * end;
            (!self.is_buried(segment, p)).then_some((t, p))
        })
    }

    /// How many of the crossing's ends are to be left out since the line starts there.
    fn starts_on(&self, segment: &Segment, crossing: &Crossing) -> Option<usize> {
        let [a, b] = segment.ends;
        let [enter, leave] = crossing.ends.map(|end| (crossing.t + end) * self.length);
        let o = self.o - center_of(a);
        let near = (center_of(b) - center_of(a)).length() + f64::from(a[3]) + f64::from(b[3]) + self.o_err;
        if enter > near || leave < -near {
            return Some(0);
        }
        let cone = RoundCone::new(a, b);
        let foot = cone.foot(o);
        if foot.distance.abs() > self.o_err {
            return Some(0);
        }
        if foot.normal.dot(self.d) >= 0.0 {
            return None;
        }
        // It goes inside unless it does so only because the foot, and with it the normal, is off.
        let radius = (o - foot.normal * foot.distance - cone.axis * foot.s).length();
        let bulge = self.o_err * (2.0 * self.o_err / radius).min(1.0) + GRAZING * (leave - enter.max(0.0));
        let middle = 0.5 * (enter.max(0.0) + leave) / self.length;
        (cone.foot(o + self.d * middle).distance < -bulge).then_some(1)
    }

    /// True where `p`, relative to the first centre of `segment`, lies within one of its neighbours.
    fn is_buried(&self, segment: &Segment, p: DVec3) -> bool {
        let ([a, b], [before, after]) = (segment.ends, segment.beyond);
        let origin = (self.o - center_of(a)).length();
        let within = |first: Ball, last: Ball, p: DVec3| {
            if first[3].is_nan() || last[3].is_nan() {
                return false;
            }
            let cone = RoundCone::new(first, last);
            let size = cone.axis.length() + cone.radii[0].max(cone.radii[1]);
            cone.foot(p).distance < -(BURIED * size + 64.0 * f64::EPSILON * origin)
        };
        within(a, before, p) || within(b, after, p - (center_of(b) - center_of(a)))
    }
}
