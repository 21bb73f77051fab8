//! What an earlier preparation has built and a later one can use: shapes with their trees, images with
//! their pyramids; and whether the one that is under way is still wanted.

use std::collections::HashMap;
use std::sync::Arc;

use crate::bvh::Blas;
use crate::desc::{DomeShader, ImageDesc, MeshDesc, RoundsDesc, SceneDesc, TextureDesc};
use crate::error::{Stop, Warnings};
use crate::light::Dome;
use crate::math::DAffine3;
use crate::scene::shutter::Shutter;
use crate::shape::Shape;
use crate::texture::Image;

/// A shape with its tree.
pub(super) type Ready = (Shape, Arc<Blas>);
/// An image, if its texels make one, and what was told of them.
pub(super) type ReadyImage = (Option<Arc<Image>>, Warnings);

/// What a dome with a graph is made of; equal ones are the same dome.
#[derive(Clone)]
pub(super) struct DomeParts {
    pub shader: DomeShader,
    pub transform: DAffine3,
    /// What the graph looks up.
    pub textures: Vec<(TextureDesc, Arc<ImageDesc>)>,
}

impl DomeParts {
    fn same(&self, other: &Self) -> bool {
        let same = |(a, of_a): &(TextureDesc, Arc<ImageDesc>), (b, of_b): &(TextureDesc, Arc<ImageDesc>)| {
            a == b && Arc::ptr_eq(of_a, of_b)
        };
        self.transform == other.transform
            && self.textures.len() == other.textures.len()
            && self.textures.iter().zip(&other.textures).all(|(a, b)| same(a, b))
            && self.shader == other.shader
    }
}

/// Keeps what was built for each description, as long as one scene after the other has that very one:
/// a viewport in which an object moves builds nothing but the tree over the objects.
#[derive(Default)]
pub struct Cache {
    on: bool,
    /// Asked before each mesh, image and tree.
    pub(super) stop: Stop,
    /// That of what is kept of shapes that move.
    shutter: Option<Shutter>,
    /// By address, which is that of the description that the entry holds.
    meshes: HashMap<usize, (Arc<MeshDesc>, Ready)>,
    rounds: HashMap<usize, (Arc<RoundsDesc>, Ready)>,
    images: HashMap<usize, (Arc<ImageDesc>, ReadyImage)>,
    /// The one with a graph, of which a scene of Blender's has one at most.
    dome: Option<(DomeParts, Option<Dome>)>,
}

impl Cache {
    /// One that keeps things; the default keeps nothing, so that a single render holds no memory longer.
    pub fn new() -> Self {
        Self { on: true, ..Self::default() }
    }

    /// The same, for preparations that `stop` ends.
    pub fn stopped_by(self, stop: &Stop) -> Self {
        Self { stop: stop.clone(), ..self }
    }

    /// Forgets shapes that move where what was kept of them is for another shutter.
    pub(super) fn forget_motion_of_other(&mut self, shutter: Option<Shutter>) {
        if self.shutter != shutter {
            self.shutter = shutter;
            self.meshes.retain(|_, (desc, _)| desc.motion.is_empty());
            self.rounds.retain(|_, (desc, _)| desc.motion.is_empty());
        }
    }

    pub(super) fn mesh(&self, desc: &Arc<MeshDesc>) -> Option<Ready> {
        self.meshes.get(&address(desc)).map(|(_, ready)| ready.clone())
    }

    pub(super) fn rounds(&self, desc: &Arc<RoundsDesc>) -> Option<Ready> {
        self.rounds.get(&address(desc)).map(|(_, ready)| ready.clone())
    }

    /// The dome of these parts: as it was, or as `make` makes it.
    pub(super) fn dome(
        &mut self,
        parts: impl FnOnce() -> DomeParts,
        make: impl FnOnce() -> Option<Dome>,
    ) -> Option<Dome> {
        if !self.on {
            return make();
        }
        let parts = parts();
        if let Some((_, dome)) = self.dome.as_ref().filter(|(known, _)| known.same(&parts)) {
            return dome.clone();
        }
        let dome = make();
        self.dome = Some((parts, dome.clone()));
        dome
    }

    pub(super) fn image(&self, desc: &Arc<ImageDesc>) -> Option<ReadyImage> {
        self.images.get(&address(desc)).map(|(_, ready)| ready.clone())
    }

    /// Keeps those images of `desc` that are wanted and forgets all others.
    pub(super) fn keep_images(&mut self, desc: &SceneDesc, wanted: &[bool], ready: &[ReadyImage]) {
        if !self.on || self.stop.is_wished() {
            return;
        }
        let wanted = desc.images.iter().zip(ready).zip(wanted).filter(|(_, wanted)| **wanted);
        self.images = wanted.map(|((desc, ready), _)| (address(desc), (desc.clone(), ready.clone()))).collect();
    }

    /// Keeps what is used of `ready`, which is that of the meshes, then of the strands and balls of `desc`,
    /// and forgets all else.
    pub(super) fn keep(&mut self, desc: &SceneDesc, used: &[bool], ready: &[Ready]) {
        if !self.on || self.stop.is_wished() {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::graph::{Graph, Op};
    use crate::desc::{Blending, ColorSpace, Filter, PixelData, Wrap};
    use crate::error::Place;
    use crate::math::{DVec3, Rgb};

    fn image() -> Arc<ImageDesc> {
        let pixels = PixelData::U8(vec![10, 20, 30]);
        let (name, place) = ("sky".into(), Place::default());
        let (color_space, blending) = (ColorSpace::Linear, Blending::default());
        ImageDesc { name, place, width: 1, height: 1, channels: 3, color_space, blending, pixels }.into()
    }

    fn parts(image: &Arc<ImageDesc>, strength: f64, x: f64) -> DomeParts {
        let mut graph = Graph::default();
        let radiance = graph.push(Op::Constant([strength; 4]));
        let (wrap_u, wrap_v) = (Wrap::Repeat, Wrap::Repeat);
        let texture = TextureDesc { place: Place::default(), image: 0, wrap_u, wrap_v, filter: Filter::Linear };
        DomeParts {
            shader: DomeShader { graph, radiance, suns: Vec::new() },
            transform: DAffine3::from_translation(DVec3::new(x, 0.0, 0.0)),
            textures: vec![(texture, image.clone())],
        }
    }

    /// How often a dome is made of these parts one after the other.
    fn made(mut cache: Cache, all: &[DomeParts]) -> usize {
        let mut made = 0;
        for parts in all {
            let dome = cache.dome(
                || parts.clone(),
                || {
                    made += 1;
                    Some(Dome::new(Rgb::splat(1.0), None))
                },
            );
            assert!(dome.is_some());
        }
        made
    }

    #[test]
    fn a_dome_is_made_again_where_one_of_its_parts_is_another() {
        let (one, other) = (image(), image());
        let same = parts(&one, 1.0, 0.0);
        assert_eq!(made(Cache::new(), &[same.clone(), same.clone(), same.clone()]), 1);
        for changed in [parts(&other, 1.0, 0.0), parts(&one, 2.0, 0.0), parts(&one, 1.0, 3.0)] {
            assert_eq!(made(Cache::new(), &[same.clone(), changed]), 2);
        }
        assert_eq!(made(Cache::default(), &[same.clone(), same]), 2, "a single render keeps nothing");
    }

    #[test]
    fn images_are_kept_while_a_scene_has_them() {
        let (kept, other) = (image(), image());
        let ready = (Image::new(ImageDesc::clone(&kept), &mut Warnings::new()).ok().map(Arc::new), Warnings::new());
        let desc = |images: Vec<Arc<ImageDesc>>| SceneDesc { images, ..SceneDesc::default() };
        let mut cache = Cache::new();
        cache.keep_images(&desc(vec![kept.clone(), other.clone()]), &[true, false], &[ready.clone(), ready.clone()]);
        let found = cache.image(&kept).and_then(|(image, _)| image).unwrap();
        assert!(Arc::ptr_eq(&found, ready.0.as_ref().unwrap()));
        assert!(cache.image(&other).is_none());
        cache.keep_images(&desc(vec![other]), &[true], &[ready]);
        assert!(cache.image(&kept).is_none());
    }
}
