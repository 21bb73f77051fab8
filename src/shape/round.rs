//! Strands and balls in their own space, moved so that the middle of their box is the origin.

use crate::math::{Ball, DVec3, RoundCone, RoundPoint, Times, Vec2, Vec3, center_of, gamma, share_of};

/// Round cones between balls, in object space less `center`.
#[derive(Clone, Debug, Default)]
pub struct Rounds {
    /// What was taken off every point.
    pub center: DVec3,
    /// Centres and radii.
    pub balls: Vec<Ball>,
    /// Balls before, at both ends and after each segment; the one before or after an open end is the end
    /// itself. `None` where every ball stands alone.
    pub segments: Option<Vec<[u32; 4]>>,
    /// UV sets, by ball.
    pub uvs: Vec<Vec<Vec2>>,
    /// Linear colours with straight alpha, by ball.
    pub colors: Option<Vec<[f32; 4]>>,
    /// Material slot of each segment, or ball; `None` for 0.
    pub material_slots: Option<Vec<u16>>,
    /// Balls at other times; `None` for what keeps its shape.
    pub motion: Option<Box<RoundMotion>>,
}

/// Balls at keys of time; between two each goes straight on.
#[derive(Clone, Debug)]
pub struct RoundMotion {
    /// When.
    pub times: Times,
    /// For each key all balls.
    pub keys: Vec<Vec<Ball>>,
}

/// A point on a round cone, in its space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundSurface {
    /// The point.
    pub p: Vec3,
    /// Half-width of the box in which rounding has left `p`.
    pub p_err: Vec3,
    /// Unit, outward.
    pub ng: Vec3,
    /// Unit; it turns evenly along the strand, so that joints do not show.
    pub ns: Vec3,
    /// From the first centre of the segment to the second.
    pub axis: Vec3,
}

/// How a strand runs at one place.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// Unit, towards the tip.
    direction: DVec3,
    /// Sine of the angle by which normals lean along it.
    slope: f64,
}

/// How a strand runs along a segment.
struct Bend {
    ends: [Run; 2],
    /// Whether the strand goes on smoothly there.
    is_smooth: [bool; 2],
}

impl Run {
    /// The mean with that of the next segment; `None` where they form a corner, which is to be seen.
    fn joined(&self, other: &Self) -> Option<Self> {
        let is_smooth = self.direction.dot(other.direction) > 0.9 && (self.slope - other.slope).abs() < 0.4;
        let direction = (self.direction + other.direction).normalize_or(self.direction);
        is_smooth.then_some(Self { direction, slope: 0.5 * (self.slope + other.slope) })
    }
}

impl Bend {
    /// Unit direction and slope at share `s`.
    fn at(&self, s: f64) -> (DVec3, f64) {
        let [a, b] = self.ends;
        let direction = a.direction * (1.0 - s) + b.direction * s;
        (direction.normalize_or(a.direction), a.slope * (1.0 - s) + b.slope * s)
    }
}

impl Rounds {
    /// How many segments, or balls, there are.
    pub fn len(&self) -> usize {
        self.segments.as_ref().map_or(self.balls.len(), Vec::len)
    }

    /// True where there is nothing.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Balls before, at both ends and after `segment`.
    fn around(&self, segment: u32) -> [usize; 4] {
        self.segments.as_ref().map_or([segment; 4], |segments| segments[segment as usize]).map(|i| i as usize)
    }

    /// Ball `i` at `time`, moved by the same products and sums as in the acceleration structure.
    fn ball(&self, i: usize, time: f32) -> Ball {
        let Some(motion) = &self.motion else { return self.balls[i] };
        let (stretch, share) = motion.times.at(time);
        let (from, to) = (motion.keys[stretch][i], motion.keys[stretch + 1][i]);
        std::array::from_fn(|k| from[k] + (to[k] - from[k]) * share)
    }

    /// The round cone of `segment` at `time`, and the centre that it is relative to.
    pub fn cone(&self, segment: u32, time: f32) -> (RoundCone, DVec3) {
        let [_, first, last, _] = self.around(segment);
        let [first, last] = [first, last].map(|i| self.ball(i, time));
        (RoundCone::new(first, last), center_of(first))
    }

    /// Ends of `segment` at each key of time, or as they are.
    pub fn keys(&self, segment: u32) -> impl Iterator<Item = [Ball; 2]> {
        let [_, first, last, _] = self.around(segment);
        let keys = self.motion.as_ref().map_or(std::slice::from_ref(&self.balls), |motion| &motion.keys);
        keys.iter().map(move |balls| [balls[first], balls[last]])
    }

    /// Both ends of `segment`, and the share that each has in the point of the axis at `u`.
    pub fn anchors(&self, segment: u32, u: f32) -> [(u32, f32); 3] {
        let ([_, first, last, _], s) = (self.around(segment).map(|i| i as u32), share_of(u) as f32);
        [(first, 1.0 - s), (last, s), (last, 0.0)]
    }

    /// Material slot of `segment`.
    pub fn slot(&self, segment: u32) -> usize {
        self.material_slots.as_ref().map_or(0, |slots| usize::from(slots[segment as usize]))
    }

    /// The point at coordinates `uv` of `segment`: on the surface but for its own rounding, however far
    /// off the ray came.
    pub fn point(&self, segment: u32, uv: [f32; 2], time: f32) -> RoundSurface {
        let (cone, origin) = self.cone(segment, time);
        let point = cone.point(uv);
        let p = (origin + point.p).as_vec3();
        let ns = self.smooth_normal(segment, uv[0], &point, time).unwrap_or(point.normal);
        let (ng, ns, axis) = (point.normal.as_vec3(), ns.as_vec3(), cone.axis.as_vec3());
        RoundSurface { p, p_err: p.abs() * gamma(2), ng, ns, axis }
    }

    /// `None` where the true normal is to be used: on balls and on caps that no smooth joint covers.
    fn smooth_normal(&self, segment: u32, u: f32, point: &RoundPoint, time: f32) -> Option<DVec3> {
        let bend = self.bend(segment, time)?;
        if (u < 0.0 && !bend.is_smooth[0]) || (u > 1.0 && !bend.is_smooth[1]) {
            return None;
        }
        let (tangent, slope) = bend.at(point.s);
        let across = (point.normal - tangent * point.normal.dot(tangent)).try_normalize()?;
        Some(across * (1.0 - slope * slope).max(0.0).sqrt() + tangent * slope)
    }

    /// How the strand runs at both ends of `segment`; `None` for a ball.
    fn bend(&self, segment: u32, time: f32) -> Option<Bend> {
        let [before, first, last, after] = self.around(segment).map(|i| self.ball(i, time));
        let own = run(first, last)?;
        let joint = |other: Option<Run>| other.and_then(|other| own.joined(&other));
        let joints = [joint(run(before, first)), joint(run(last, after))];
        Some(Bend { ends: joints.map(|joint| joint.unwrap_or(own)), is_smooth: joints.map(|joint| joint.is_some()) })
    }

    /// Direction of the strand, towards its tip; `None` for a ball.
    pub fn tangent(&self, segment: u32, [u, _]: [f32; 2], time: f32) -> Option<Vec3> {
        self.bend(segment, time).map(|bend| bend.at(share_of(u)).0.as_vec3())
    }

    /// UV of set `set` at a point; `None` where there is no such set.
    pub fn uv(&self, set: u32, segment: u32, [u, _]: [f32; 2]) -> Option<Vec2> {
        let values = self.uvs.get(set as usize)?;
        let ([_, first, last, _], s) = (self.around(segment), share_of(u) as f32);
        Some(values[first] * (1.0 - s) + values[last] * s)
    }

    /// Square of the length of `segment` in UV set `set`.
    pub fn uv_size(&self, set: u32, segment: u32) -> f32 {
        let [_, first, last, _] = self.around(segment);
        self.uvs.get(set as usize).map_or(0.0, |values| (values[last] - values[first]).length_squared())
    }

    /// Colour with alpha.
    pub fn color(&self, segment: u32, [u, _]: [f32; 2]) -> Option<[f32; 4]> {
        Some(self.along(self.colors.as_ref()?, segment, u))
    }

    /// Of values of the points, that at the share `u` of `segment`.
    pub fn along(&self, values: &[[f32; 4]], segment: u32, u: f32) -> [f32; 4] {
        let ([_, first, last, _], s) = (self.around(segment), share_of(u) as f32);
        std::array::from_fn(|k| values[first][k] * (1.0 - s) + values[last][k] * s)
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        use std::mem::size_of_val;
        size_of_val(self.balls.as_slice())
            + self.segments.as_deref().map_or(0, size_of_val)
            + self.uvs.iter().map(|values| size_of_val(values.as_slice())).sum::<usize>()
            + self.colors.as_deref().map_or(0, size_of_val)
            + self.material_slots.as_deref().map_or(0, size_of_val)
            + self
                .motion
                .iter()
                .flat_map(|motion| &motion.keys)
                .map(|balls| size_of_val(balls.as_slice()))
                .sum::<usize>()
    }
}

/// `None` where one ball is within the other.
fn run(first: Ball, last: Ball) -> Option<Run> {
    let cone = RoundCone::new(first, last);
    (!cone.is_ball()).then(|| Run { direction: cone.axis.normalize(), slope: cone.slope() })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter of a circle about the origin, in twelve pieces.
    fn bow(radius: impl Fn(usize) -> f32) -> Rounds {
        let ball = |i: usize| {
            let (sin, cos) = (0.13 * i as f32).sin_cos();
            [cos, sin, 0.0, radius(i)]
        };
        let segments = (0..12).map(|i: u32| [i.saturating_sub(1), i, i + 1, (i + 2).min(12)]).collect();
        Rounds { balls: (0..=12).map(ball).collect(), segments: Some(segments), ..Rounds::default() }
    }

    #[test]
    fn smooth_normals_run_over_the_joints_and_true_ones_do_not() {
        for taper in [0.0, 0.005] {
            let rounds = bow(|i| 0.1 - taper * i as f32);
            let mut steps = [0.0_f32; 2];
            let mut last: Option<RoundSurface> = None;
            // Along the outside, by the direction from the circle's centre.
            for i in 0..1000 {
                let (sin, cos) = (1.4 * f64::from(i) / 1000.0 + 0.05).sin_cos();
                let far = DVec3::new(cos, sin, 0.2) * 1.2;
                let height = |k: u32| {
                    let (cone, origin) = rounds.cone(k, 0.0);
                    cone.foot(far - origin).distance
                };
                let segment = (0..12).min_by(|&a, &b| height(a).total_cmp(&height(b))).unwrap();
                let (cone, origin) = rounds.cone(segment, 0.0);
                let at = rounds.point(segment, cone.coordinates(far - origin), 0.0);
                if let Some(last) = last.replace(at) {
                    steps[0] = steps[0].max(at.ng.distance(last.ng));
                    steps[1] = steps[1].max(at.ns.distance(last.ns));
                }
                assert!(at.ng.dot(at.ns) > 0.99 && (at.ns.length() - 1.0).abs() < 1e-5);
            }
            // Each step turns by 0.0014.
            assert!(steps[1] < 0.002, "taper {taper}: {steps:?}");
            // The true normal turns on the balls alone, by far more at a time.
            assert!(steps[0] > 3.0 * steps[1], "taper {taper}: {steps:?}");
        }
    }

    #[test]
    fn ends_and_corners_keep_their_true_normals() {
        let rounds = bow(|_| 0.1);
        let tip = rounds.point(11, [2.0, 0.0], 0.0);
        assert!(tip.ng == tip.ns && tip.ng.dot(rounds.tangent(11, [1.0, 0.0], 0.0).unwrap()) > 0.99, "{tip:?}");
        let balls = vec![[0.0, 0.0, 0.0, 0.1], [1.0, 0.0, 0.0, 0.1], [1.0, 1.0, 0.0, 0.1]];
        let corner = Rounds { balls, segments: Some(vec![[0, 0, 1, 2], [0, 1, 2, 2]]), ..Rounds::default() };
        for (segment, u) in [(0, 0.9), (0, 1.0), (0, 2.5), (1, -2.5), (1, 0.1)] {
            let at = corner.point(segment, [u, 0.7], 0.0);
            assert!(at.ng.distance(at.ns) < 1e-6, "{segment} {u}: {at:?}");
        }
    }

    #[test]
    fn values_run_along_segments() {
        let uvs = (0..=12).map(|i| Vec2::new(i as f32, 0.5)).collect();
        let colors = (0..=12).map(|i| [i as f32, 0.0, 0.0, 1.0]).collect();
        let rounds = Rounds { uvs: vec![uvs], colors: Some(colors), ..bow(|_| 0.1) };
        for (u, along) in [(-2.0, 3.0), (0.25, 3.25), (1.0, 4.0), (3.0, 4.0)] {
            assert_eq!(rounds.uv(0, 3, [u, 0.1]), Some(Vec2::new(along, 0.5)));
            assert_eq!(rounds.color(3, [u, 0.1]), Some([along, 0.0, 0.0, 1.0]));
        }
        assert_eq!((rounds.uv_size(0, 3), rounds.uv(1, 3, [0.5, 0.0])), (1.0, None));
    }
}
