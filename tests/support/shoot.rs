//! One ray by the code of every instruction set.

use penumbra::bvh::{Bvh, Hit};
use penumbra::math::Ray;

/// The hit that all of `bvhs` agree on bit for bit, and with `any_hit`.
pub fn shoot(bvhs: &[Bvh], ray: &Ray) -> Option<Hit> {
    let bits = |hit: &Option<Hit>| hit.map(|h| (h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.instance, h.primitive));
    let hit = bvhs[0].closest_hit(ray, 1);
    for bvh in bvhs {
        let other = bvh.closest_hit(ray, 1);
        assert_eq!(bits(&other), bits(&hit), "{} differs on {ray:?}", bvh.isa().name());
        assert_eq!(bvh.any_hit(ray, 1), hit.is_some(), "any_hit of {} differs on {ray:?}", bvh.isa().name());
    }
    hit
}
