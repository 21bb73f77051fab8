//! A shape placed in render space.

use std::sync::Arc;

use super::Terminator;
use crate::light::{Profile, Rules};
use crate::math::MovingTransform;
use crate::shape::Placement;

/// Bits of an instance's ray mask; a ray sees an instance that shares a bit with its own mask.
pub mod mask {
    use crate::desc::Visibility;

    /// Rays from the camera.
    pub const CAMERA: u64 = 1;
    /// Diffuse bounces.
    pub const DIFFUSE: u64 = 2;
    /// Reflections.
    pub const GLOSSY: u64 = 4;
    /// Refractions.
    pub const TRANSMISSION: u64 = 8;
    /// Shadow and occlusion rays, for objects that stop them whole.
    pub const SHADOW: u64 = 16;
    /// Shadow and occlusion rays, for objects whose opacity must be asked.
    pub const SHADOW_CUTOUT: u64 = 32;
    /// Objects that emit or are unlit.
    pub const EMITTER: u64 = 64;
    /// Shadow catchers, which shadows on shadow catchers don't count.
    pub const CATCHER: u64 = 128;

    /// Classes of blockers that shadow linking can tell apart: two bits for each.
    pub const BLOCKER_CLASSES: u32 = 28;
    const FIRST_BLOCKER: u32 = 8;

    /// The mask of an object; `blocker` is its class where some light has shadow links.
    pub fn of(visibility: Visibility, cutout: bool, emits: bool, catcher: bool, blocker: Option<u32>) -> u64 {
        let bit = |on: bool, bit: u64| if on { bit } else { 0 };
        let linked = blocker.map_or(0, |class| if cutout { linked_cutout(1 << class) } else { linked(1 << class) });
        bit(visibility.camera, CAMERA)
            | bit(visibility.diffuse, DIFFUSE)
            | bit(visibility.glossy, GLOSSY)
            | bit(visibility.transmission, TRANSMISSION)
            | bit(visibility.shadow, if cutout { SHADOW_CUTOUT } else { SHADOW } | linked)
            | bit(emits, EMITTER)
            | bit(catcher, CATCHER)
    }

    /// Shadow rays that only the classes of blockers in `classes` stop whole.
    pub fn linked(classes: u32) -> u64 {
        u64::from(classes) << FIRST_BLOCKER
    }

    /// Shadow rays that only those classes stop, and whose opacity must be asked.
    pub fn linked_cutout(classes: u32) -> u64 {
        u64::from(classes) << (FIRST_BLOCKER + BLOCKER_CLASSES)
    }
}

/// A shape placed in render space.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Index of the shape.
    pub shape: u32,
    /// Where its shape, whose space is object space less its centre, stands at the frame.
    pub placement: Placement,
    /// From the shape's space to render space while the shutter is open; `None` for what does not move.
    pub motion: Option<Arc<MovingTransform>>,
    /// Material of each slot.
    pub materials: Box<[u32]>,
    /// Linear, straight alpha; in place of the vertex colours that its shape lacks.
    pub color: Option<[f32; 4]>,
    /// Index of the light that its emissive primitives form.
    pub light: Option<u32>,
    /// Its class among the receivers that light linking tells apart.
    pub receiver_class: u16,
    /// Rules of the light that it emits; `None` where it emits none.
    pub rules: Option<Box<Rules>>,
    /// How what it emits varies with direction; `None` where its materials alone say it.
    pub profile: Option<Arc<Profile>>,
    /// True where the camera sees a hole in the picture instead.
    pub holdout: bool,
    /// True where the camera sees nothing of it but the shadows of others on it.
    pub catcher: bool,
    /// How the edge of its own shadow is softened.
    pub terminator: Terminator,
}

impl Instance {
    /// The material of slot `slot`.
    pub fn material(&self, slot: usize) -> u32 {
        self.materials[slot.min(self.materials.len() - 1)]
    }

    /// Where its shape stands at `time`; `moved` holds that of one that moves.
    #[inline(always)]
    pub fn placement_at<'a>(&'a self, time: f32, moved: &'a mut Option<Placement>) -> &'a Placement {
        match &self.motion {
            None => &self.placement,
            Some(motion) => {
                *moved = on_the_way(motion, time);
                moved.as_ref().unwrap_or(&self.placement)
            }
        }
    }
}

// Out of line, so that what stands still has no part in it. `None` where it is squeezed flat on its way.
#[cold]
#[inline(never)]
fn on_the_way(motion: &MovingTransform, time: f32) -> Option<Placement> {
    Placement::new(&motion.at(time))
}
