//! Shapes all of which follows the same joints: their place is changed, whatever they are.

use std::rc::Rc;

use openusd::usd::{Attribute, Prim, TimeCode};

use super::super::inherit::{Clock, Mover, Pose};
use super::super::stage::Reading;
use super::Bound;
use super::deformer::{Follows, bones};
use super::influences::Influences;
use super::skeleton::Skeleton;
use crate::math::DAffine3;

/// How a prim follows joints as a whole.
pub(in super::super) struct Rigid {
    skeleton: Rc<Skeleton>,
    follows: Follows,
    influences: Influences,
}

impl Rigid {
    /// That of `prim`; `None`, with a warning, where it is broken.
    fn read(reading: &Reading<'_>, prim: &Prim, bound: &Bound) -> Option<Self> {
        let skeleton = reading.skeletons.of(reading, &bound.skeleton, bound.animation.as_ref())?;
        let (follows, influences) = bones(reading, prim, bound, &skeleton, 1)?;
        Some(Self { skeleton, follows, influences })
    }

    /// What comes before the prim's own transform at `time`.
    fn at(&self, reading: &Reading<'_>, time: TimeCode) -> Option<DAffine3> {
        let (skin, to_prim) = self.follows.at(reading, &self.skeleton, time)?;
        Some(to_prim * skin.rigid(self.influences.of(0)))
    }
}

/// `pose`, that of `prim`, as the joints have it that all of it follows.
pub(in super::super) fn place(clock: &mut Clock<'_, '_>, prim: &Prim, bound: &Bound, pose: &Pose) -> Pose {
    let reading = clock.reading;
    let Some(rigid) = Rigid::read(reading, prim, bound) else { return pose.clone() };
    let Some(local) = rigid.at(reading, reading.time) else { return pose.clone() };
    let frame = reading.time.value();
    let attributes = rigid.skeleton.animation.as_ref().map(|animation| animation.attributes()).unwrap_or_default();
    let varies = |attribute: &Attribute| attribute.value_might_be_time_varying().unwrap_or(false);
    let moves = attributes.iter().any(varies) || rigid.follows.varying().next().is_some();
    let motion = (moves && !clock.times.is_empty()).then(|| {
        let at = |time: &f64| rigid.at(reading, TimeCode::new(frame + time)).unwrap_or(local);
        clock.times.iter().map(at).collect()
    });
    clock.note(|| Mover::Attributes(attributes, false));
    for xform in rigid.follows.varying() {
        clock.note(|| Mover::Transform(xform.clone()));
    }
    pose.place(&Pose { world: local, motion, absolute: false })
}
