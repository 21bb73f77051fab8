//! Shading networks to `MaterialDesc`.

use std::sync::Arc;

use openusd::sdf;

use super::images::Images;
use super::stage::Reading;
use crate::desc::SceneDesc;

/// Materials read so far.
pub(super) struct Materials<'a> {
    pub reading: &'a Reading<'a>,
    pub images: Images,
    /// Names of the primvars that textures are looked up by; the index is that of the UV set. `st` comes
    /// first.
    pub uv_sets: Vec<Arc<str>>,
}

impl<'a> Materials<'a> {
    pub fn new(reading: &'a Reading<'a>, images: Images) -> Self {
        Self { reading, images, uv_sets: vec!["st".into()] }
    }

    /// Index of the material at `path`; `None`, with a warning, where there is none that can be read.
    pub fn at(&mut self, _path: &sdf::Path) -> Option<u32> {
        None
    }

    /// Index of the material of shapes that none is bound to: white times their displayColor.
    pub fn unbound(&mut self) -> u32 {
        0
    }

    /// Moves everything into `scene`.
    pub fn finish(self, scene: &mut SceneDesc) {
        scene.images = self.images.images;
    }
}
