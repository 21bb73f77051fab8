//! Transforms and points between keys of time.
//!
//! A transform is taken apart into translation, rotation and stretch, and these are blended, as Cycles does
//! it: a wheel that turns stays round on the way. Ken Shoemake, Tom Duff: *Matrix Animation and Polar
//! Decomposition*, Graphics Interface 1992.

use super::{Affine3A, Bounds, DAffine3, DMat3, DQuat, DVec3};

/// Angle of the arc, in radians, that boxes of turning things are made for at a time.
const ARC: f64 = std::f64::consts::PI / 16.0;

/// Keys of time, growing, at least two.
#[derive(Clone, Debug, PartialEq)]
pub struct Times(Box<[f32]>);

impl Times {
    /// `None` unless there are two or more and each lies after the one before.
    pub fn new(times: Vec<f32>) -> Option<Self> {
        (times.len() > 1 && times.windows(2).all(|pair| pair[0] < pair[1])).then(|| Self(times.into()))
    }

    /// Stretches between two keys.
    pub fn stretches(&self) -> usize {
        self.0.len() - 1
    }

    /// The stretch that holds `time`, and the share of it that has passed; before the first and after the last
    /// key all stands still.
    pub fn at(&self, time: f32) -> (usize, f32) {
        let after = self.0.partition_point(|&key| key <= time);
        let stretch = after.clamp(1, self.0.len() - 1) - 1;
        let (from, to) = (self.0[stretch], self.0[stretch + 1]);
        (stretch, ((time - from) / (to - from)).clamp(0.0, 1.0))
    }
}

/// A transform taken apart: stretched, then turned, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Parts {
    translation: DVec3,
    rotation: DQuat,
    stretch: DMat3,
}

/// The rotation in `m`; `None` where it can't be told, of what is squeezed flat.
fn rotation(m: DMat3) -> Option<DQuat> {
    let mut r = m;
    for _ in 0..100 {
        let next = (r + r.inverse().transpose()) * 0.5;
        let change = (next - r).to_cols_array().into_iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        r = next;
        if change < 1e-15 {
            break;
        }
    }
    // A mirror is part of the stretch.
    let r = if r.determinant() < 0.0 { -r } else { r };
    (r.is_finite() && m.determinant() != 0.0).then(|| DQuat::from_mat3(&r).normalize())
}

/// How the parts change from one key to the next.
#[derive(Clone, Debug)]
struct Stretch {
    from: Parts,
    moved: DVec3,
    /// The other axis of the plane in which the rotation turns as a quaternion, and by which angle.
    beside: DQuat,
    angle: f64,
    stretched: DMat3,
}

impl Stretch {
    fn new(from: Parts, to: Parts) -> Self {
        let beside = to.rotation + from.rotation * -from.rotation.dot(to.rotation);
        let sin = beside.length();
        // Rounding turns nothing.
        let turns = sin > 1e-12;
        let beside = if turns { beside * (1.0 / sin) } else { beside };
        Self {
            from,
            moved: to.translation - from.translation,
            beside,
            angle: if turns { sin.atan2(from.rotation.dot(to.rotation)) } else { 0.0 },
            stretched: to.stretch - from.stretch,
        }
    }

    fn stretch_at(&self, share: f64) -> DMat3 {
        self.from.stretch + self.stretched * share
    }

    fn at(&self, share: f64) -> DAffine3 {
        let rotation = if self.angle == 0.0 {
            self.from.rotation
        } else {
            let (sin, cos) = (self.angle * share).sin_cos();
            self.from.rotation * cos + self.beside * sin
        };
        let translation = self.from.translation + self.moved * share;
        DAffine3 { matrix3: DMat3::from_quat(rotation.normalize()) * self.stretch_at(share), translation }
    }
}

/// A transform that changes over time.
#[derive(Clone, Debug)]
pub struct MovingTransform {
    times: Times,
    stretches: Box<[Stretch]>,
    /// Where points begin that are transformed: added to them before.
    center: DVec3,
}

impl MovingTransform {
    /// The transform that is `keys` at their times, which grow; of two keys or more. A key that squeezes all flat is
    /// turned as the one before, or after. `None` where all do, and where one is not finite.
    pub fn new(keys: &[(f32, DAffine3)]) -> Option<Self> {
        let times = Times::new(keys.iter().map(|key| key.0).collect())?;
        if !keys.iter().all(|(_, key)| key.is_finite()) {
            return None;
        }
        let found: Vec<Option<DQuat>> = keys.iter().map(|(_, key)| rotation(key.matrix3)).collect();
        let mut last = found.iter().flatten().next().copied()?;
        let parts = keys.iter().zip(found).map(|((_, key), found)| {
            let found = found.unwrap_or(last);
            // The same rotation, by the shorter way.
            last = if last.dot(found) < 0.0 { -found } else { found };
            let stretch = DMat3::from_quat(last).transpose() * key.matrix3;
            Parts { translation: key.translation, rotation: last, stretch }
        });
        let parts: Vec<Parts> = parts.collect();
        let stretches = parts.windows(2).map(|pair| Stretch::new(pair[0], pair[1])).collect();
        Some(Self { times, stretches, center: DVec3::ZERO })
    }

    /// The same from points of which `center` was taken off, to points of which `origin` is taken off.
    pub fn rebased(mut self, center: DVec3, origin: DVec3) -> Self {
        self.stretches.iter_mut().for_each(|stretch| stretch.from.translation -= origin);
        self.center += center;
        self
    }

    /// The transform at `time`.
    pub fn at(&self, time: f32) -> DAffine3 {
        let (stretch, share) = self.times.at(time);
        self.centered(self.stretches[stretch].at(share.into()))
    }

    fn centered(&self, mut transform: DAffine3) -> DAffine3 {
        transform.translation += transform.matrix3 * self.center;
        transform
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.stretches.len() * (size_of::<Stretch>() + size_of::<f32>())
    }

    /// True where lengths and directions stay as they are.
    pub fn is_translation(&self) -> bool {
        self.stretches.iter().all(|stretch| stretch.angle == 0.0 && stretch.stretched == DMat3::ZERO)
    }

    /// A box of all that `boxes` hold, at any time.
    pub fn bounds(&self, boxes: &[Bounds]) -> Bounds {
        let corners: Vec<DVec3> = boxes.iter().flat_map(|b| b.corners()).map(|p| p.as_dvec3()).collect();
        self.stretches.iter().map(|stretch| self.swept(stretch, &corners)).fold(Bounds::EMPTY, Bounds::union)
    }

    /// The box of `points`, and of what is between them, on the way of `stretch`. Between two moments that are
    /// `h` apart no point is farther from its chord than `h²/8` times its greatest acceleration, which is
    /// `ω² |Sp| + 2 ω |S'p|` for what turns by ω in the whole.
    fn swept(&self, stretch: &Stretch, points: &[DVec3]) -> Bounds {
        // Of the rotation; that of the quaternion is half of it.
        let turn = 2.0 * stretch.angle;
        let steps = (turn / ARC).ceil().max(1.0);
        let length =
            |m: DMat3| points.iter().map(|&p| (m * (p + self.center)).length_squared()).fold(0.0, f64::max).sqrt();
        let arm = length(stretch.from.stretch).max(length(stretch.stretch_at(1.0)));
        let bulge = (turn * turn * arm + 2.0 * turn * length(stretch.stretched)) / (8.0 * steps * steps);
        let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for step in 0..=steps as u32 {
            let transform = self.centered(stretch.at(f64::from(step) / steps));
            for &point in points {
                let p = transform.transform_point3(point);
                bounds = [bounds[0].min(p), bounds[1].max(p)];
            }
        }
        let grown = Bounds { min: (bounds[0] - bulge).as_vec3(), max: (bounds[1] + bulge).as_vec3() };
        // For the rounding to `f32`.
        let margin = f32::EPSILON * grown.min.abs().max(grown.max.abs());
        Bounds { min: grown.min - margin, max: grown.max + margin }
    }
}

/// `transform` as it is traced.
pub fn traced(transform: &DAffine3) -> Affine3A {
    let DAffine3 { matrix3: m, translation } = transform;
    Affine3A::from_cols(m.x_axis.as_vec3a(), m.y_axis.as_vec3a(), m.z_axis.as_vec3a(), translation.as_vec3a())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    fn turned(angle: f64, scale: f64, x: f64) -> DAffine3 {
        let scale = DVec3::new(scale, 1.0, 2.0);
        DAffine3::from_scale_rotation_translation(scale, DQuat::from_rotation_z(angle), DVec3::new(x, 0.0, 0.0))
    }

    #[test]
    fn keys_come_back_as_they_are_and_between_them_turns_are_even() {
        for mirror in [1.0, -1.0] {
            let keys = [
                (0.0, turned(0.0, mirror, 0.0)),
                (0.25, turned(2.0, mirror, 1.0)),
                (1.0, turned(4.5, 3.0 * mirror, 2.0)),
            ];
            let moving = MovingTransform::new(&keys).unwrap();
            for (time, key) in keys {
                assert!(moving.at(time).abs_diff_eq(key, 1e-12), "{:?} {key:?}", moving.at(time));
            }
            assert_eq!((moving.at(-3.0), moving.at(7.0)), (moving.at(0.0), moving.at(1.0)));
            for (time, key) in [(0.125, turned(1.0, mirror, 0.5)), (0.625, turned(3.25, 2.0 * mirror, 1.5))] {
                assert!(moving.at(time).abs_diff_eq(key, 1e-12), "{:?} {key:?}", moving.at(time));
            }
        }
    }

    #[test]
    fn spaces_of_other_origins_see_the_same_motion() {
        let (center, origin) = (DVec3::new(1e3, 2.0, -5.0), DVec3::new(7.0, 1e6, 0.0));
        let keys = [(0.0, turned(0.2, 1.0, 1e6)), (1.0, turned(1.4, 2.0, 1e6 + 3.0))];
        let moving = MovingTransform::new(&keys).unwrap();
        let rebased = moving.clone().rebased(center, origin);
        let p = DVec3::new(0.3, -0.4, 0.5);
        for time in [0.0, 0.3, 0.9] {
            let there = moving.at(time).transform_point3(p + center) - origin;
            assert!(rebased.at(time).transform_point3(p).abs_diff_eq(there, 1e-8));
        }
    }

    #[test]
    fn boxes_hold_all_points_at_all_times_and_little_more() {
        let keys = [(0.0, turned(0.0, 1.0, 0.0)), (0.5, turned(3.0, 1.5, 0.5)), (1.0, turned(5.5, 0.2, -4.0))];
        let moving = MovingTransform::new(&keys).unwrap().rebased(DVec3::new(0.5, 0.0, 0.0), DVec3::ZERO);
        let shape = Bounds { min: Vec3::new(-1.0, -0.2, 0.1), max: Vec3::new(2.0, 0.4, 0.5) };
        let (swept, mut tight) = (moving.bounds(&[shape]), Bounds::EMPTY);
        for i in 0..=4000 {
            let transform = traced(&moving.at(i as f32 / 4000.0));
            tight = shape.corners().into_iter().map(|p| transform.transform_point3(p)).fold(tight, Bounds::with_point);
        }
        assert_eq!(swept.union(tight), swept);
        let excess = (swept.extent() - tight.extent()).max_element();
        assert!(excess > 0.0 && excess < 0.1, "{excess}: {swept:?} {tight:?}");
    }

    #[test]
    fn what_does_not_turn_is_a_translation() {
        let along = [(0.0, turned(1.0, 2.0, 0.0)), (1.0, turned(1.0, 2.0, 5.0))];
        assert!(MovingTransform::new(&along).unwrap().is_translation());
        assert!(!MovingTransform::new(&[along[0], (1.0, turned(1.1, 2.0, 5.0))]).unwrap().is_translation());
        let lost = DAffine3::from_translation(DVec3::NAN);
        assert!(MovingTransform::new(&[along[0], (1.0, lost)]).is_none());
        assert!(MovingTransform::new(&along[..1]).is_none());
    }

    #[test]
    fn what_grows_from_nothing_has_the_rotation_that_it_gets() {
        let grown = turned(1.0, 2.0, 4.0);
        let nothing = DAffine3 { matrix3: DMat3::ZERO, translation: DVec3::ZERO };
        let moving = MovingTransform::new(&[(0.0, nothing), (1.0, grown)]).unwrap();
        let half = DAffine3 { matrix3: grown.matrix3 * 0.5, translation: grown.translation * 0.5 };
        assert!(moving.at(0.5).abs_diff_eq(half, 1e-12));
        assert!(MovingTransform::new(&[(0.0, nothing), (1.0, nothing)]).is_none());
    }

    #[test]
    fn times_find_their_stretch() {
        let times = Times::new(vec![0.0, 0.25, 1.0]).unwrap();
        for (time, at) in
            [(-1.0, (0, 0.0)), (0.125, (0, 0.5)), (0.25, (1, 0.0)), (0.625, (1, 0.5)), (1.0, (1, 1.0)), (2.0, (1, 1.0))]
        {
            assert_eq!(times.at(time), at, "{time}");
        }
        assert_eq!((times.stretches(), Times::new(vec![0.0, 0.0]), Times::new(vec![0.0])), (2, None, None));
    }
}
