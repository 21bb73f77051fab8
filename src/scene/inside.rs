//! The insides of objects, which light that scatters beneath surfaces walks in.

use std::sync::Arc;

use super::{Instance, Interaction, RayCone, Scene};
use crate::bvh::{self, Blas, Bvh, Hit};
use crate::math::{DVec3, Ray, Vec3A};

/// An object alone, about its middle: render space less the place of that. Walks may be far shorter than `f32` can tell
/// apart where the object stands.
pub struct Inside {
    /// Index of the instance.
    index: u32,
    /// The instance, moved.
    about_middle: Instance,
    tree: Bvh,
}

impl Inside {
    /// That of the instance number `index`, whose shape has the tree `blas`.
    pub(super) fn new(index: u32, instance: &Instance, blas: Arc<Blas>) -> Self {
        let mut about_middle = instance.clone();
        let middle = DVec3::from(instance.placement.to_render.translation.to_array().map(f64::from));
        about_middle.placement.to_render.translation = Vec3A::ZERO;
        about_middle.motion =
            instance.motion.as_ref().map(|motion| Arc::new(motion.as_ref().clone().rebased(DVec3::ZERO, middle)));
        let alone = bvh::Instance {
            blas: 0,
            object_to_render: about_middle.placement.to_render,
            motion: about_middle.motion.clone(),
            mask: u64::MAX,
        };
        Self { index, tree: Bvh::build(vec![blas], vec![alone]), about_middle }
    }

    /// Where `ray`, in the space of this inside, meets the surface next; `None` where it does not.
    pub fn way_out(&self, ray: &Ray) -> Option<Hit> {
        self.tree.closest_hit(ray, u64::MAX).map(|hit| Hit { instance: self.index, ..hit })
    }

    /// The geometry at `hit` of `ray`, in the space of this inside.
    pub fn interaction(&self, scene: &Scene, ray: &Ray, hit: &Hit) -> Interaction {
        let shape = scene.shape(&self.about_middle);
        Interaction::on(shape, &self.about_middle, hit.primitive, [hit.u, hit.v], -ray.d, ray.time)
    }
}

impl Scene {
    /// The inside of the object that `it` lies on, whatever else is in there, and the point in its space; `None` for an
    /// object of a material that nothing goes beneath.
    pub fn inside(&self, it: &Interaction) -> Option<(&Inside, Interaction)> {
        let inside = self.insides.get(it.instance as usize)?.as_ref()?;
        let instance = &inside.about_middle;
        let Interaction { p, p_err, .. } =
            Interaction::on(self.shape(instance), instance, it.primitive, it.at, it.wo, it.time);
        Some((inside, Interaction { p, p_err, ..*it }))
    }

    /// The geometry in render space at `hit`, where `ray` leaves an inside, as if seen from outside: `wo` goes on along
    /// the ray. The width of what is seen is that of `cone`.
    pub fn coming_out(&self, ray: &Ray, hit: &Hit, cone: RayCone) -> Interaction {
        self.interaction_by(&Ray { d: -ray.d, ..*ray }, hit, RayCone { spread: 0.0, ..cone })
    }
}
