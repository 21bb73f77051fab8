//! Shading networks to `MaterialDesc`.

use std::sync::Arc;

use openusd::sdf;

use super::images::Images;
use super::stage::Reading;
use crate::desc::{MaterialDesc, SceneDesc};

/// Stand-in.
#[derive(Default)]
pub(super) struct VertexColors {
    pub color: Option<Arc<str>>,
    pub opacity: Option<Arc<str>>,
}

/// Materials read so far.
pub(super) struct Materials<'a> {
    pub reading: &'a Reading<'a>,
    pub images: Images,
    /// Names of the primvars that textures are looked up by; the index is that of the UV set. `st` comes
    /// first.
    pub uv_sets: Vec<Arc<str>>,
    list: Vec<sdf::Path>,
}

impl<'a> Materials<'a> {
    pub fn new(reading: &'a Reading<'a>, images: Images) -> Self {
        Self { reading, images, uv_sets: vec!["st".into()], list: Vec::new() }
    }

    pub fn preload<'p>(&mut self, _paths: impl IntoIterator<Item = &'p sdf::Path>) {}

    /// Index of the material at `path`; `None`, with a warning, where there is none that can be read.
    pub fn at(&mut self, path: &sdf::Path) -> Option<u32> {
        let known = self.list.iter().position(|known| known == path);
        Some(known.unwrap_or_else(|| {
            self.list.push(path.clone());
            self.list.len() - 1
        }) as u32)
    }

    /// Index of the material of shapes that none is bound to: white times their displayColor.
    pub fn unbound(&mut self) -> u32 {
        self.at(&sdf::Path::abs_root()).unwrap_or_default()
    }

    pub fn used_uv_sets(&self, _index: u32) -> Vec<u32> {
        Vec::new()
    }

    pub fn tangent_uv_set(&self, _index: u32) -> Option<u32> {
        None
    }

    pub fn vertex_colors(&self, _index: u32) -> VertexColors {
        VertexColors::default()
    }

    /// Moves everything into `scene`.
    pub fn finish(self, scene: &mut SceneDesc) {
        scene.images = self.images.images;
        let material = |path: &sdf::Path| MaterialDesc { name: path.as_str().into(), ..MaterialDesc::default() };
        scene.materials = self.list.iter().map(material).collect();
    }
}
