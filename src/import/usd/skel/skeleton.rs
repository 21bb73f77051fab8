//! Skeleton: joints, how they were bound, how they stand at a time.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use openusd::gf::Matrix4d;
use openusd::sdf::Path;
use openusd::tf::Token;
use openusd::usd::TimeCode;

use super::super::stage::Reading;
use super::super::xform::affine;
use super::animation::Animation;
use crate::math::DAffine3;

/// The skeletons that were met, each with where its poses come from; `None` for those that are broken.
#[derive(Default)]
pub(in super::super) struct Skeletons(RefCell<HashMap<Posed, Option<Rc<Skeleton>>>>);

/// A skeleton and the animation that poses it.
type Posed = (Path, Option<Path>);

impl Skeletons {
    /// The skeleton at `path`, moved by `animation`; `None`, with a warning, where it can't be used.
    pub(super) fn of(&self, reading: &Reading<'_>, path: &Path, animation: Option<&Path>) -> Option<Rc<Skeleton>> {
        let key = (path.clone(), animation.cloned());
        if let Some(known) = self.0.borrow().get(&key) {
            return known.clone();
        }
        let read = Skeleton::read(reading, path, animation).map(Rc::new);
        self.0.borrow_mut().insert(key, read.clone());
        read
    }
}

/// A skeleton and its animation.
pub(super) struct Skeleton {
    path: Path,
    pub joints: Vec<Token>,
    /// Index of each joint's parent, which comes before it.
    parents: Vec<Option<usize>>,
    /// World to joint where it was bound.
    from_bind: Vec<DAffine3>,
    /// Joint to parent where nothing moves it.
    rest: Option<Vec<DAffine3>>,
    pub animation: Option<Animation>,
    /// Which joint of the animation moves each.
    moved_by: Vec<Option<usize>>,
    poses: RefCell<HashMap<u64, Option<Rc<[DAffine3]>>>>,
}

impl Skeleton {
    fn read(reading: &Reading<'_>, path: &Path, animation: Option<&Path>) -> Option<Self> {
        let prim = reading.stage.prim(path).ok()?;
        let joints: Vec<Token> = reading.value(&prim, "joints").unwrap_or_default();
        let count = joints.len();
        let transforms = |name: &str| {
            let values: Vec<Matrix4d> = reading.value(&prim, name).unwrap_or_default();
            values.iter().map(|m| affine(&m.0)).collect::<Vec<_>>()
        };
        let parents = match parents(&joints) {
            Ok(parents) => parents,
            Err(joint) => {
                let what = format!("joint {joint} comes before its parent; what follows the skeleton is as modelled");
                reading.warn(path, what);
                return None;
            }
        };
        let bind = transforms("bindTransforms");
        if bind.len() != count {
            let have = bind.len();
            let what =
                format!("has {have} bindTransforms for {count} joints; what follows the skeleton is as modelled");
            reading.warn(path, what);
            return None;
        }
        let from_bind: Vec<DAffine3> = bind.iter().map(DAffine3::inverse).collect();
        if let Some(bad) = from_bind.iter().position(|inverse| !inverse.is_finite()) {
            let joint = &joints[bad];
            let what =
                format!("the bindTransform of joint {joint} is singular; what follows the skeleton is as modelled");
            reading.warn(path, what);
            return None;
        }
        let rest = transforms("restTransforms");
        if rest.len() != count && !rest.is_empty() {
            let have = rest.len();
            reading.warn(path, format!("has {have} restTransforms for {count} joints; they are left out"));
        }
        let rest = Some(rest).filter(|rest| rest.len() == count);
        let animation = animation.and_then(|animation| Animation::read(reading, animation));
        let moved_by: Vec<Option<usize>> = match &animation {
            Some(animation) => mapped(&joints, &animation.joints),
            None => vec![None; count],
        };
        if let Some(animation) = &animation
            && !animation.joints.is_empty()
            && moved_by.iter().all(Option::is_none)
        {
            let what = format!("moves none of the joints of {path}; the rest pose is used");
            reading.warn(animation.path(), what);
        }
        let poses = RefCell::default();
        Some(Self { path: path.clone(), joints, parents, from_bind, rest, animation, moved_by, poses })
    }

    /// What each joint does to points that were modelled where it was bound, in the skeleton's space at
    /// `time` (UsdSkelSkeletonQuery::ComputeSkinningTransforms). `None`, with a warning, where the joints
    /// have no place.
    pub fn pose(&self, reading: &Reading<'_>, time: TimeCode) -> Option<Rc<[DAffine3]>> {
        let key = time.value().to_bits();
        if let Some(known) = self.poses.borrow().get(&key) {
            return known.clone();
        }
        let local = self.local(reading, time);
        if local.is_none() {
            let what = format!(
                "needs restTransforms for its {} joints, which are not all animated; what follows it is as modelled",
                self.joints.len()
            );
            reading.warn(&self.path, what);
        }
        let pose = local.map(|mut joints| {
            for i in 0..joints.len() {
                if let Some(parent) = self.parents[i] {
                    joints[i] = joints[parent] * joints[i];
                }
            }
            joints.iter().zip(&self.from_bind).map(|(&joint, &from_bind)| joint * from_bind).collect::<Rc<[_]>>()
        });
        self.poses.borrow_mut().insert(key, pose.clone());
        pose
    }

    /// Joint to parent of each.
    fn local(&self, reading: &Reading<'_>, time: TimeCode) -> Option<Vec<DAffine3>> {
        let moves = self.moved_by.iter().any(Option::is_some);
        let animation = self.animation.as_ref().filter(|_| moves);
        let Some(moved) = animation.and_then(|animation| animation.transforms(reading, time)) else {
            return self.rest.clone();
        };
        let joint = |(i, by): (usize, &Option<usize>)| match by {
            Some(by) => Some(moved[*by]),
            None => self.rest.as_ref().map(|rest| rest[i]),
        };
        self.moved_by.iter().enumerate().map(joint).collect()
    }
}

/// Where each of `wanted` is in `order`.
pub(super) fn mapped(wanted: &[Token], order: &[Token]) -> Vec<Option<usize>> {
    let places: HashMap<&Token, usize> = order.iter().enumerate().map(|(i, name)| (name, i)).collect();
    wanted.iter().map(|name| places.get(name).copied()).collect()
}

/// The nearest joint above each of `joints`, which are paths; as an error one that stands before it.
fn parents(joints: &[Token]) -> Result<Vec<Option<usize>>, &Token> {
    let places: HashMap<&str, usize> = joints.iter().enumerate().map(|(i, name)| (name.as_str(), i)).collect();
    let parent = |(i, name): (usize, &'_ Token)| {
        let above = name.as_str().rmatch_indices('/').find_map(|(end, _)| places.get(&name.as_str()[..end]).copied());
        if above.is_some_and(|above| above >= i) { Err(i) } else { Ok(above) }
    };
    joints.iter().enumerate().map(parent).collect::<Result<_, _>>().map_err(|i| &joints[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(names: &[&str]) -> Vec<Token> {
        names.iter().map(|name| Token::from(*name)).collect()
    }

    #[test]
    fn parents_are_the_nearest_joints_above() {
        let joints = tokens(&["a", "a/b", "a/x/c", "y/d", "a/b/e"]);
        assert_eq!(parents(&joints), Ok(vec![None, Some(0), Some(0), None, Some(1)]));
        let joints = tokens(&["a/b", "a"]);
        assert_eq!(parents(&joints), Err(&joints[0]));
    }

    #[test]
    fn joints_are_found_by_name() {
        assert_eq!(mapped(&tokens(&["a", "b", "c"]), &tokens(&["c", "a", "z"])), [Some(1), None, Some(0)]);
    }
}
