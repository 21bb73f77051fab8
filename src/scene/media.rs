//! What fills the insides of objects, and which of them a ray is in.

use super::{Interaction, Scene, mask};
use crate::math::{Ray, Rgb, Vec3};
use crate::scene::RayCone;

/// Insides within insides that are told apart; those entered beyond that do not count.
const DEPTH: usize = 8;

/// What fills the inside of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interior {
    /// Absorption per metre; black for none.
    pub sigma: Rgb,
    /// True where it is there beside what it lies in (Blender's volumes) instead of in its place (KHR_materials_volume).
    pub adds: bool,
}

/// An inside that was entered and not left.
#[derive(Clone, Copy, Debug)]
struct Entered {
    instance: u32,
    interior: Interior,
}

/// The insides around a ray, the one entered last at the end.
#[derive(Clone, Copy, Debug)]
pub struct Media {
    entered: [Entered; DEPTH],
    depth: usize,
    /// Absorption per metre of all of them together.
    sigma: Rgb,
}

impl Media {
    /// In the open.
    pub const NONE: Self = {
        let interior = Interior { sigma: Rgb::BLACK, adds: true };
        Self { entered: [Entered { instance: 0, interior }; DEPTH], depth: 0, sigma: Rgb::BLACK }
    };

    /// Share of light that is left after `dist` metres. Without end it is lost where something absorbs, but in solids
    /// that stand in the place of others: thin sheets are modelled as one of their two sides.
    pub fn transmitted(&self, dist: f32) -> Rgb {
        if self.sigma.is_black() || (dist.is_infinite() && !self.entered[self.depth - 1].interior.adds) {
            return Rgb::WHITE;
        }
        self.sigma.map(|sigma| if sigma > 0.0 { (-sigma * dist).exp() } else { 1.0 })
    }

    /// Crosses the boundary of `interior` of an instance, into it or out of it.
    pub fn cross(&mut self, instance: u32, interior: Interior, entering: bool) {
        if entering {
            if self.depth < DEPTH {
                self.entered[self.depth] = Entered { instance, interior };
                self.depth += 1;
            }
        } else {
            let own = self.entered[..self.depth].iter().rposition(|entered| entered.instance == instance);
            // Solids may be made of two objects, one with its normals turned inwards.
            let Some(left) = own.or_else(|| (self.depth > 0 && !interior.adds).then(|| self.depth - 1)) else { return };
            self.entered.copy_within(left + 1..self.depth, left);
            self.depth -= 1;
        }
        self.sigma = self.total();
    }

    /// From the inside outwards, up to the first that stands in the place of what is around it.
    fn total(&self) -> Rgb {
        let entered = &self.entered[..self.depth];
        let mut sum = Rgb::BLACK;
        for (i, Entered { instance, interior }) in entered.iter().enumerate().rev() {
            // What overlaps itself is there once.
            if !entered[i + 1..].iter().any(|inner| inner.instance == *instance) {
                sum += interior.sigma;
            }
            if !interior.adds {
                break;
            }
        }
        sum
    }
}

impl Scene {
    /// Takes a path that goes on from `it` along `w` to the other side of its surface, if it goes there.
    pub fn pass_boundary(&self, media: &mut Media, it: &Interaction, w: Vec3) {
        if let Some(interior) = self.material(it).interior
            && (it.ng.dot(w) >= 0.0) != it.front
        {
            media.cross(it.instance, interior, it.front);
        }
    }

    /// What is around the origin of `ray`, which the camera sends. As in Cycles that is what a ray upwards meets from
    /// inside.
    pub fn media_around(&self, ray: &Ray) -> Media {
        let mut media = Media::NONE;
        let Some((bvh, instances)) = &self.absorbing else { return media };
        let mut up = Ray { time: ray.time, ..Ray::new(ray.o, Vec3::Y) };
        let (mut around, mut seen) = (Vec::new(), Vec::new());
        for _ in 0..4 * DEPTH {
            let Some(mut hit) = bvh.closest_hit(&up, mask::CAMERA) else { break };
            let t = hit.t;
            hit.instance = instances[hit.instance as usize];
            let it = self.interaction(&up, &hit, RayCone { width: 0.0, spread: 0.0 });
            if let Some(interior) = self.material(&it).interior
                && !seen.contains(&hit.instance)
            {
                seen.push(hit.instance);
                if !it.front {
                    around.push((hit.instance, interior));
                }
            }
            up = it.continued(&up, t);
        }
        for (instance, interior) in around.into_iter().rev() {
            media.cross(instance, interior, true);
        }
        media
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solid(sigma: f32, adds: bool) -> Interior {
        Interior { sigma: Rgb::splat(sigma), adds }
    }

    #[test]
    fn leaving_brings_back_what_was_outside() {
        let (water, glass) = (solid(0.1, false), solid(2.0, false));
        let mut media = Media::NONE;
        media.cross(0, water, true);
        media.cross(1, glass, true);
        assert_eq!(media.sigma, glass.sigma);
        media.cross(1, glass, false);
        assert_eq!(media.sigma, water.sigma);
        media.cross(0, water, false);
        media.cross(0, water, false);
        assert_eq!((media.sigma, media.transmitted(3.0)), (Rgb::BLACK, Rgb::WHITE));
        for _ in 0..19 {
            media.cross(1, glass, true);
        }
        assert_eq!(media.sigma, glass.sigma);
    }

    #[test]
    fn volumes_add_up_and_are_left_in_any_order() {
        let (fog, smoke, glass) = (solid(0.5, true), solid(1.5, true), solid(0.0, false));
        let mut media = Media::NONE;
        media.cross(0, fog, true);
        media.cross(1, smoke, true);
        media.cross(1, smoke, true);
        assert_eq!(media.sigma, Rgb::splat(2.0));
        assert_eq!(media.transmitted(0.5), Rgb::splat((-1.0_f32).exp()));
        assert_eq!(media.transmitted(f32::INFINITY), Rgb::BLACK);
        media.cross(0, fog, false);
        assert_eq!(media.sigma, smoke.sigma);
        media.cross(2, glass, true);
        assert_eq!(media.transmitted(1.0), Rgb::WHITE);
        media.cross(2, glass, false);
        media.cross(1, smoke, false);
        media.cross(1, smoke, false);
        assert_eq!(media.sigma, Rgb::BLACK);
        // What was never entered is not left.
        media.cross(0, fog, true);
        media.cross(1, smoke, false);
        assert_eq!(media.sigma, fog.sigma);
    }

    #[test]
    fn a_solid_in_the_place_of_others_absorbs_no_light_from_infinity() {
        let mut media = Media::NONE;
        media.cross(0, solid(2.0, false), true);
        assert_eq!(media.transmitted(f32::INFINITY), Rgb::WHITE);
    }
}
