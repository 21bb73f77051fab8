//! What things are at other times of the shutter, as the add-on hands it over beside what they are at the frame.

use std::collections::HashMap;

use super::transform::affine_of_floats;
use crate::desc::Motion;
use crate::error::{Error, Place, Result, Warnings};
use crate::math::DAffine3;

/// Points of a shape at another time than the frame's.
#[derive(Clone, Copy, Debug)]
pub struct MovedPoints<'a> {
    /// Frames after the frame.
    pub time: f64,
    /// Three numbers for each point.
    pub positions: &'a [f32],
}

/// Keys at `others` and, at the frame itself, `now`: in the order of time. None where nothing moves, and none that a
/// time without number has.
pub(super) fn keys<T: Clone + PartialEq>(now: &T, others: impl IntoIterator<Item = (f64, T)>) -> Vec<Motion<T>> {
    let others = others.into_iter().filter(|(time, _)| time.is_finite() && *time != 0.0);
    let mut keys: Vec<_> = others.map(|(time, value)| Motion { time, value }).collect();
    if keys.iter().all(|key| key.value == *now) {
        return Vec::new();
    }
    keys.push(Motion { time: 0.0, value: now.clone() });
    keys.sort_by(|a, b| a.time.total_cmp(&b.time));
    keys
}

/// Tells of a shape whose points can't be followed, through the shutter or from frame to frame: their number changes,
/// or they are not finite.
pub(super) fn tell_of_still(name: &str, place: &Place, same_count: bool, blurred: bool, warnings: &mut Warnings) {
    let why = if same_count { "are not all finite" } else { "change in number" };
    let when = if blurred { "while the shutter is open" } else { "from frame to frame" };
    let what = format!("the points of \"{name}\" {why} {when}; it keeps the shape that it has at the frame");
    warnings.push(place, what);
}

/// Matrices of instances at other times than the frame's.
#[derive(Clone, Debug, Default)]
pub(super) struct MovedInstances {
    /// Frames after the frame, and the matrices then by the instance's index.
    times: Vec<(f64, HashMap<u32, [f32; 16]>)>,
}

impl MovedInstances {
    /// Takes in the matrices of `instances` at a time.
    ///
    /// # Errors
    /// Lists of different lengths, and instances beyond `count`.
    pub fn add(&mut self, time: f64, instances: &[u32], matrices: &[f32], count: usize, place: &Place) -> Result<()> {
        let (matrices, rest) = matrices.as_chunks::<16>();
        if !rest.is_empty() || matrices.len() != instances.len() {
            let what = format!("{} matrices for {} instances that move", matrices.len(), instances.len());
            return Err(Error::invalid(place, what));
        }
        if let Some(index) = instances.iter().find(|&&index| index as usize >= count) {
            return Err(Error::invalid(place, format!("instance {index} of {count} moves")));
        }
        self.times.push((time, instances.iter().copied().zip(matrices.iter().copied()).collect()));
        Ok(())
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.times.clear();
    }

    /// Where an instance is while the shutter is open that is at `now` at the frame.
    pub fn of(&self, instance: u32, now: &DAffine3) -> Vec<Motion<DAffine3>> {
        let at = |(time, matrices): &(f64, HashMap<u32, [f32; 16]>)| {
            let matrix = matrices.get(&instance)?;
            Some((*time, affine_of_floats(matrix)))
        };
        keys(now, self.times.iter().filter_map(at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_in_order_with_the_frame_among_them() {
        let found = keys(&0, [(0.25, 1), (-0.25, -1), (f64::NAN, 7)]);
        let found: Vec<_> = found.iter().map(|key| (key.time, key.value)).collect();
        assert_eq!(found, [(-0.25, -1), (0.0, 0), (0.25, 1)]);
        assert!(keys(&3, [(0.25, 3), (0.5, 3)]).is_empty());
        assert!(keys(&3, []).is_empty());
    }

    #[test]
    fn instances_that_are_not_there_are_errors() {
        let mut moved = MovedInstances::default();
        let identity = [1.0, 0.0, 0.0, 2.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        assert!(moved.add(0.5, &[1], &identity, 1, &Place::default()).is_err());
        assert!(moved.add(0.5, &[0], &identity[1..], 1, &Place::default()).is_err());
        assert!(moved.of(0, &DAffine3::IDENTITY).is_empty());
        moved.add(0.5, &[0], &identity, 1, &Place::default()).unwrap();
        let keys = moved.of(0, &DAffine3::IDENTITY);
        assert_eq!((keys.len(), keys[1].time, keys[1].value.translation.x), (2, 0.5, 2.0));
    }
}
