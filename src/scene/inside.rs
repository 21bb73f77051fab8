//! The insides of objects, which light that scatters beneath surfaces walks in.

use super::{Interaction, RayCone, Scene};
use crate::bvh::Hit;
use crate::math::Ray;

impl Scene {
    /// Where `ray`, from within the inside of `instance`, meets its surface next, whatever else is in the way;
    /// `None` where it does not, and for an instance of a material that nothing goes beneath.
    pub fn way_out(&self, instance: u32, ray: &Ray) -> Option<Hit> {
        let inside = self.insides.get(instance as usize)?.as_ref()?;
        inside.closest_hit(ray, u64::MAX).map(|hit| Hit { instance, ..hit })
    }

    /// The geometry at `hit`, where `ray` leaves an inside, as if seen from outside: `wo` goes on along the ray. The
    /// width of what is seen is that of `cone`.
    pub fn coming_out(&self, ray: &Ray, hit: &Hit, cone: RayCone) -> Interaction {
        self.interaction(&Ray { d: -ray.d, ..*ray }, hit, RayCone { spread: 0.0, ..cone })
    }
}
