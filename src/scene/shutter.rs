//! What moves while the shutter is open.
//!
//! Times of the description are frames after the frame itself; those of rays are 0 where the shutter opens and 1
//! where it closes. In between all times are as likely, as with Cycles' default shutter curve.

use super::effects::emits;
use crate::desc::{CameraDesc, InstanceDesc, Motion, SceneDesc, ShapeRef, Visibility};
use crate::math::DAffine3;
use crate::settings::Settings;

/// When the shutter is open, in frames after the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shutter {
    open: f64,
    close: f64,
}

/// Something at keys of time, which grow, of a ray's.
pub type Keys<T> = Vec<(f32, T)>;

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
    pub fn keys<T: Clone + PartialEq>(&self, now: &T, motion: &[Motion<T>]) -> Option<Keys<T>> {
        if motion.iter().all(|m| m.value == *now) {
            return None;
        }
        let mut keys: Vec<(f64, &T)> = motion.iter().map(|m| (m.time, &m.value)).collect();
        keys.push((0.0, now));
        keys.retain(|(time, _)| time.is_finite());
        // At the frame itself a sample of the motion comes before.
        keys.sort_by(|a, b| a.0.total_cmp(&b.0));
        let ray_time = |time: f64| ((time - self.open) / (self.close - self.open)) as f32;
        let mut keys: Keys<&T> = keys.into_iter().map(|(time, value)| (ray_time(time), value)).collect();
        keys.dedup_by(|later, earlier| later.0 <= earlier.0);
        let first = keys.iter().rposition(|key| key.0 <= 0.0).unwrap_or(0);
        let last = keys.iter().position(|key| key.0 >= 1.0).unwrap_or(keys.len() - 1);
        let keys = &keys[first.min(last)..=last.max(first)];
        let moves = keys.windows(2).any(|pair| pair[0].1 != pair[1].1);
        moves.then(|| keys.iter().map(|&(time, value)| (time, value.clone())).collect())
    }

    /// The transform of `instance`, where it moves.
    pub fn transform(&self, instance: &InstanceDesc) -> Option<Keys<DAffine3>> {
        self.keys(&instance.transform, &instance.motion)
    }

    /// True where a picture of `scene` by `camera` shows that something moves.
    pub fn shows_motion(&self, scene: &SceneDesc, camera: &CameraDesc) -> bool {
        let deforms = |shape: ShapeRef| match shape {
            ShapeRef::Mesh(i) => {
                let mesh = &scene.meshes[i as usize];
                !mesh.triangles.is_empty() && self.keys(&mesh.points, &mesh.motion).is_some()
            }
            ShapeRef::Rounds(i) => {
                let rounds = &scene.rounds[i as usize];
                self.keys(&rounds.points, &rounds.motion).is_some()
            }
        };
        let is_met = |instance: &InstanceDesc| {
            let Visibility { camera, diffuse, glossy, transmission, shadow } = instance.visibility;
            let mut materials = instance.materials.iter().flatten().map(|&m| &scene.materials[m as usize]);
            camera || diffuse || glossy || transmission || shadow || instance.catcher || materials.any(emits)
        };
        self.keys(&camera.transform, &camera.motion).is_some()
            || scene.instances.iter().any(|instance| {
                (!instance.motion.is_empty() && self.transform(instance).is_some() || deforms(instance.shape))
                    && is_met(instance)
            })
    }
}
