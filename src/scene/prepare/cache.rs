//! What an earlier preparation has built and a later one can use: shapes with their trees, images with
//! their pyramids.

use std::collections::HashMap;
use std::sync::Arc;

use crate::bvh::Blas;
use crate::desc::{ImageDesc, MeshDesc, RoundsDesc, SceneDesc};
use crate::error::Warnings;
use crate::shape::Shape;
use crate::texture::Image;

/// A shape with its tree.
pub(super) type Ready = (Shape, Arc<Blas>);
/// An image, if its texels make one, and what was told of them.
pub(super) type ReadyImage = (Option<Arc<Image>>, Warnings);

/// Keeps what was built for each description, as long as one scene after the other has that very one:
/// a viewport in which an object moves builds nothing but the tree over the objects.
#[derive(Default)]
pub struct Cache {
    on: bool,
    /// By address, which is that of the description that the entry holds.
    meshes: HashMap<usize, (Arc<MeshDesc>, Ready)>,
    rounds: HashMap<usize, (Arc<RoundsDesc>, Ready)>,
    images: HashMap<usize, (Arc<ImageDesc>, ReadyImage)>,
}

impl Cache {
    /// One that keeps things; the default keeps nothing, so that a single render holds no memory longer.
    pub fn new() -> Self {
        Self { on: true, ..Self::default() }
    }

    pub(super) fn mesh(&self, desc: &Arc<MeshDesc>) -> Option<Ready> {
        self.meshes.get(&address(desc)).map(|(_, ready)| ready.clone())
    }

    pub(super) fn rounds(&self, desc: &Arc<RoundsDesc>) -> Option<Ready> {
        self.rounds.get(&address(desc)).map(|(_, ready)| ready.clone())
    }

    pub(super) fn image(&self, desc: &Arc<ImageDesc>) -> Option<ReadyImage> {
        self.images.get(&address(desc)).map(|(_, ready)| ready.clone())
    }

    /// Keeps those images of `desc` that are wanted and forgets all others.
    pub(super) fn keep_images(&mut self, desc: &SceneDesc, wanted: &[bool], ready: &[ReadyImage]) {
        if !self.on {
            return;
        }
        let wanted = desc.images.iter().zip(ready).zip(wanted).filter(|(_, wanted)| **wanted);
        self.images = wanted.map(|((desc, ready), _)| (address(desc), (desc.clone(), ready.clone()))).collect();
    }

    /// Keeps what is used of `ready`, which is that of the meshes, then of the strands and balls of `desc`,
    /// and forgets all else.
    pub(super) fn keep(&mut self, desc: &SceneDesc, used: &[bool], ready: &[Ready]) {
        if !self.on {
            return;
        }
        let used = used.iter().zip(ready).map(|(used, ready)| used.then(|| ready.clone()));
        let mut used = used.collect::<Vec<_>>().into_iter();
        let meshes = desc.meshes.iter().zip(used.by_ref());
        self.meshes = meshes.filter_map(|(desc, ready)| Some((address(desc), (desc.clone(), ready?)))).collect();
        let rounds = desc.rounds.iter().zip(used);
        self.rounds = rounds.filter_map(|(desc, ready)| Some((address(desc), (desc.clone(), ready?)))).collect();
    }
}

fn address<T>(of: &Arc<T>) -> usize {
    Arc::as_ptr(of).addr()
}
