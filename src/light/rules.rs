//! An emitter and the rules that say whom it reaches.

use std::sync::Arc;

use super::{AnyEmitter, ShadowLook};

/// Which kinds of ray see a light, and which kinds of scattering it lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen {
    /// Rays from the camera.
    pub camera: bool,
    /// Diffuse reflection.
    pub diffuse: bool,
    /// Glossy reflection.
    pub glossy: bool,
    /// Transmission.
    pub transmission: bool,
}

/// What stops the light of an emitter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shadow {
    /// Everything that casts shadows.
    Cast,
    /// Nothing.
    Off,
    /// Of what casts shadows, the classes of blockers whose bit is set.
    Only(u32),
}

/// Rules of one light.
#[derive(Clone, Debug, PartialEq)]
pub struct Rules {
    /// Index of its light group among those that the passes tell apart.
    pub group: Option<u16>,
    /// What sees it.
    pub seen: Seen,
    /// What stops it.
    pub shadow: Shadow,
    /// How the shadows look; `None` where they are black and without end.
    pub look: Option<ShadowLook>,
    /// For each class of receivers, whether it is lit; `None` where all are.
    pub receivers: Option<Arc<[bool]>>,
    /// Factors of what it lights by diffuse scattering, and by all other; `None` where both are 1.
    pub response: Option<[f32; 2]>,
    /// How often a path may have been scattered where it is lit.
    pub max_bounces: u32,
}

/// A light of the scene.
#[derive(Clone, Debug)]
pub struct Light {
    /// How it shines.
    pub emitter: AnyEmitter,
    /// On whom.
    pub rules: Rules,
}

impl Seen {
    /// By every ray.
    pub const ALL: Self = Self { camera: true, diffuse: true, glossy: true, transmission: true };
}

impl Rules {
    /// A light without any rule.
    pub const NONE: Self = Self {
        group: None,
        seen: Seen::ALL,
        shadow: Shadow::Cast,
        look: None,
        receivers: None,
        response: None,
        max_bounces: u32::MAX,
    };

    /// True where the light stops at whatever rays stop at: one that finds it counts it where it ends. Else, with
    /// shadows of its own, it is counted where the ray begins.
    pub fn stops_like_rays(&self) -> bool {
        self.shadow == Shadow::Cast && self.look.is_none()
    }

    /// True where the light reaches receivers of `class`.
    pub fn lights(&self, class: u16) -> bool {
        self.receivers.as_ref().is_none_or(|classes| classes[usize::from(class)])
    }
}

impl<E: Into<AnyEmitter>> From<E> for Light {
    fn from(emitter: E) -> Self {
        Self { emitter: emitter.into(), rules: Rules::NONE }
    }
}
