//! What moves while the shutter is open.
//!
//! Times of the description are frames after the frame itself; those of rays are 0 where the shutter opens and 1
//! where it closes. How likely each is in between says [`Exposure`](crate::camera::Exposure).

use super::effects::is_met;
use crate::desc::{CameraDesc, InstanceDesc, Motion, ProjectionDesc, SceneDesc, ShapeRef};
use crate::math::DAffine3;
use crate::settings::Settings;

/// When the shutter is open, in frames after the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shutter {
    open: f64,
    close: f64,
}

/// Something at keys of a ray's time, which grow.
pub type Keys<'a, T> = Vec<(f32, &'a T)>;

impl Shutter {
    /// That of `camera`; `None` where it is open for an instant alone, or blur is off.
    pub fn of(camera: &CameraDesc, settings: &Settings) -> Option<Self> {
        Self::between(camera.shutter).filter(|_| settings.motion_blur)
    }

    /// Open from one time to another.
    pub fn between([open, close]: [f64; 2]) -> Option<Self> {
        ((close - open).is_finite() && open < close).then_some(Self { open, close })
    }

    /// What is `now` at the frame and `motion` at other times, at keys within the shutter and next to it; `None`
    /// where it stays the same.
    pub fn keys<'a, T: PartialEq>(&self, now: &'a T, motion: &'a [Motion<T>]) -> Option<Keys<'a, T>> {
        if motion.iter().all(|m| m.value == *now) {
            return None;
        }
        let mut keys: Vec<(f64, &T)> = motion.iter().map(|m| (m.time, &m.value)).collect();
        keys.push((0.0, now));
        keys.retain(|(time, _)| time.is_finite());
        // At the frame itself a sample of the motion comes before.
        keys.sort_by(|a, b| a.0.total_cmp(&b.0));
        let ray_time = |time: f64| ((time - self.open) / (self.close - self.open)) as f32;
        let mut keys: Keys<'a, T> = keys.into_iter().map(|(time, value)| (ray_time(time), value)).collect();
        keys.dedup_by(|later, earlier| later.0 <= earlier.0);
        let first = keys.iter().rposition(|key| key.0 <= 0.0).unwrap_or(0);
        let last = keys.iter().position(|key| key.0 >= 1.0).unwrap_or(keys.len() - 1);
        let keys = &keys[first.min(last)..=last.max(first)];
        let moves = keys.windows(2).any(|pair| pair[0].1 != pair[1].1);
        moves.then(|| keys.to_vec())
    }

    /// The transform of `instance`, where it moves.
    pub fn transform<'a>(&self, instance: &'a InstanceDesc) -> Option<Keys<'a, DAffine3>> {
        self.keys(&instance.transform, &instance.motion)
    }

    /// How `camera` projects, where it is a perspective one that zooms; others are as at the frame, as in Cycles.
    pub fn zoom<'a>(&self, camera: &'a CameraDesc) -> Option<Keys<'a, ProjectionDesc>> {
        let usable = |projection: &ProjectionDesc| match projection {
            ProjectionDesc::Perspective { fov_y, .. } => *fov_y > 0.0 && *fov_y < std::f64::consts::PI,
            _ => false,
        };
        self.keys(&camera.projection, &camera.zoom).filter(|keys| keys.iter().all(|key| usable(key.1)))
    }

    /// True where a picture of `scene` by `camera` shows that something moves.
    pub fn shows_motion(&self, scene: &SceneDesc, camera: &CameraDesc) -> bool {
        let deforms = |shape: ShapeRef| match shape {
            ShapeRef::Mesh(i) => {
                let mesh = &scene.meshes[i as usize];
                !mesh.triangles.is_empty() && self.keys(&mesh.points, &mesh.motion).is_some()
            }
            ShapeRef::Rounds(i) => {
                let (now, motion) = scene.rounds[i as usize].keys();
                self.keys(&now, &motion).is_some()
            }
        };
        self.keys(&camera.transform, &camera.motion).is_some()
            || self.zoom(camera).is_some()
            || scene.instances.iter().any(|instance| {
                (self.transform(instance).is_some() || deforms(instance.shape)) && is_met(scene, instance)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(shutter: [f64; 2], motion: &[(f64, char)]) -> Option<Vec<(f32, char)>> {
        let motion: Vec<_> = motion.iter().map(|&(time, value)| Motion { time, value }).collect();
        let keys = Shutter::between(shutter)?.keys(&'n', &motion)?;
        Some(keys.into_iter().map(|(time, value)| (time, *value)).collect())
    }

    #[test]
    fn keys_are_those_within_the_shutter_and_next_to_it_with_the_frame() {
        assert_eq!(keys([-0.5, 0.5], &[(-0.5, 'a'), (0.5, 'b')]), Some(vec![(0.0, 'a'), (0.5, 'n'), (1.0, 'b')]));
        // A sample at the frame is as good as what is known of it.
        assert_eq!(keys([0.0, 2.0], &[(0.0, 'n'), (2.0, 'b')]), Some(vec![(0.0, 'n'), (1.0, 'b')]));
        let wide = [(-9.0, 'x'), (-1.0, 'a'), (1.0, 'b'), (9.0, 'y')];
        assert_eq!(keys([-0.5, 0.5], &wide), Some(vec![(-0.5, 'a'), (0.5, 'n'), (1.5, 'b')]));
        // The frame lies outside.
        assert_eq!(keys([1.0, 2.0], &[(1.0, 'a'), (2.0, 'b')]), Some(vec![(0.0, 'a'), (1.0, 'b')]));
        assert_eq!(keys([1.0, 2.0], &[(1.5, 'a'), (1.75, 'b')]), Some(vec![(-1.0, 'n'), (0.5, 'a'), (0.75, 'b')]));
    }

    #[test]
    fn what_stays_the_same_while_the_shutter_is_open_does_not_move() {
        assert_eq!(keys([-0.5, 0.5], &[]), None);
        assert_eq!(keys([-0.5, 0.5], &[(-0.5, 'n'), (0.5, 'n')]), None);
        assert_eq!(keys([-0.5, 0.5], &[(-2.0, 'a'), (-1.0, 'n'), (1.0, 'n'), (2.0, 'b')]), None);
        assert_eq!(keys([0.25, 0.25], &[(0.0, 'a'), (0.5, 'b')]), None);
        assert_eq!(keys([0.5, -0.5], &[(-0.5, 'a'), (0.5, 'b')]), None);
    }
}
