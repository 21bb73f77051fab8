//! Strands and balls in their own space, moved so that the middle of their box is the origin.

use crate::math::{Ball, DVec3, RoundCone, RoundPoint, Vec2, Vec3, center_of, gamma, share_of};

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

    /// The round cone of `segment`, and the centre that it is relative to.
    pub fn cone(&self, segment: u32) -> (RoundCone, DVec3) {
        let [_, first, last, _] = self.around(segment);
        (RoundCone::new(self.balls[first], self.balls[last]), center_of(self.balls[first]))
    }

    /// Material slot of `segment`.
    pub fn slot(&self, segment: u32) -> usize {
        self.material_slots.as_ref().map_or(0, |slots| usize::from(slots[segment as usize]))
    }

    /// The point at coordinates `uv` of `segment`: on the surface but for its own rounding, however far
    /// off the ray came.
    pub fn point(&self, segment: u32, uv: [f32; 2]) -> RoundSurface {
        let (cone, origin) = self.cone(segment);
        let point = cone.point(uv);
        let p = (origin + point.p).as_vec3();
        let ns = self.smooth_normal(segment, uv[0], &point).unwrap_or(point.normal);
        RoundSurface { p, p_err: p.abs() * gamma(2), ng: point.normal.as_vec3(), ns: ns.as_vec3() }
    }

    /// `None` where the true normal is to be used: on balls and on caps that no smooth joint covers.
    fn smooth_normal(&self, segment: u32, u: f32, point: &RoundPoint) -> Option<DVec3> {
        let bend = self.bend(segment)?;
        if (u < 0.0 && !bend.is_smooth[0]) || (u > 1.0 && !bend.is_smooth[1]) {
            return None;
        }
        let (tangent, slope) = bend.at(point.s);
        let across = (point.normal - tangent * point.normal.dot(tangent)).try_normalize()?;
        Some(across * (1.0 - slope * slope).max(0.0).sqrt() + tangent * slope)
    }

    /// How the strand runs at both ends of `segment`; `None` for a ball.
    fn bend(&self, segment: u32) -> Option<Bend> {
        let [before, first, last, after] = self.around(segment);
        let own = self.run(first, last)?;
        let joint = |other: Option<Run>| other.and_then(|other| own.joined(&other));
        let joints = [joint(self.run(before, first)), joint(self.run(last, after))];
        Some(Bend { ends: joints.map(|joint| joint.unwrap_or(own)), is_smooth: joints.map(|joint| joint.is_some()) })
    }

    /// `None` where one ball is within the other.
    fn run(&self, first: usize, last: usize) -> Option<Run> {
        let cone = RoundCone::new(self.balls[first], self.balls[last]);
        (!cone.is_ball()).then(|| Run { direction: cone.axis.normalize(), slope: cone.slope() })
    }

    /// Direction of the strand, towards its tip; `None` for a ball.
    pub fn tangent(&self, segment: u32, [u, _]: [f32; 2]) -> Option<Vec3> {
        self.bend(segment).map(|bend| bend.at(share_of(u)).0.as_vec3())
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
        let values = self.colors.as_ref()?;
        let ([_, first, last, _], s) = (self.around(segment), share_of(u) as f32);
        Some(std::array::from_fn(|k| values[first][k] * (1.0 - s) + values[last][k] * s))
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        use std::mem::size_of_val;
        size_of_val(self.balls.as_slice())
            + self.segments.as_deref().map_or(0, size_of_val)
            + self.uvs.iter().map(|values| size_of_val(values.as_slice())).sum::<usize>()
            + self.colors.as_deref().map_or(0, size_of_val)
            + self.material_slots.as_deref().map_or(0, size_of_val)
    }
}
