//! Rays into the scene: what they hit, and how much light a segment lets through.

use super::{Interaction, Media, PathState, Scene, mask};
use crate::bvh::Hit;
use crate::light::{Emitter, Light, Rules, Shadow, ShadowLook};
use crate::math::{Ray, Rgb, Vec3, offset_ray_origin};

/// The footprint of a ray: a cone of width `width + spread · t`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayCone {
    /// Width at the origin.
    pub width: f32,
    /// Growth per unit of distance.
    pub spread: f32,
}

impl RayCone {
    /// Width at distance `t`.
    pub fn at(&self, t: f32) -> f32 {
        self.width + self.spread * t
    }
}

impl Scene {
    /// The nearest surface along `ray` that `mask` sees.
    pub fn closest_hit(&self, ray: &Ray, mask: u64) -> Option<Hit> {
        self.bvh.closest_hit(ray, mask)
    }

    /// Share of the light of an emitter with `rules` that arrives where `ray` begins, within `media`, from as far as it
    /// goes, on a path that has passed so many surfaces unscattered.
    pub fn arriving(&self, ray: &Ray, rules: &Rules, media: &Media, passed: u16) -> Rgb {
        match &rules.look {
            None => self.transmittance(ray, rules.shadow, media, passed),
            Some(look) => self.arriving_beside(ray, rules.shadow, look, media, passed),
        }
    }

    /// Share of light that passes along `ray`, which begins within `media`: black behind an opaque surface, the product
    /// of what passes through cut-outs and blends, of which it may pass fewer by `passed` than a path; only what `shadow` names stops it.
    pub fn transmittance(&self, ray: &Ray, shadow: Shadow, media: &Media, passed: u16) -> Rgb {
        let Some([opaque, cutout]) = blockers(shadow) else { return Rgb::WHITE };
        if self.bvh.any_hit(ray, opaque) {
            return Rgb::BLACK;
        }
        let passes = self.effects.cutouts || self.effects.absorption;
        if passes { self.passed(ray, cutout, |_| 1.0, media, passed) } else { Rgb::WHITE }
    }

    /// [`Self::arriving`] beside shadows that look as `look` says.
    // Out of line, so that other lights have no part in it.
    #[cold]
    fn arriving_beside(&self, ray: &Ray, shadow: Shadow, look: &ShadowLook, media: &Media, passed: u16) -> Rgb {
        let Some([opaque, cutout]) = blockers(shadow) else { return Rgb::WHITE };
        let length = ray.d.length();
        let ray = Ray { t_max: ray.t_max.min(look.distance() / length), ..*ray };
        look.arriving(match look.fades() {
            // Which opaque blocker is the nearest matters.
            true => self.passed(&ray, opaque | cutout, |t| look.strength(t * length), media, passed),
            false => self.transmittance(&ray, shadow, media, passed),
        })
    }

    /// What passes the surfaces that `mask` sees, up to the first opaque one; one at `t` along `ray` counts for the
    /// share `strength(t)`.
    fn passed(&self, ray: &Ray, mask: u64, strength: impl Fn(f32) -> f32, media: &Media, before: u16) -> Rgb {
        let mut left = Rgb::WHITE;
        let (mut rest, mut t) = (*ray, 0.0);
        let mut within = self.effects.absorption.then(|| (*media, ray.d.length()));
        for _ in u32::from(before)..=self.max_transparent_shadow.max(u32::from(before)) {
            let hit = self.closest_hit(&rest, mask);
            if let Some((media, length)) = &within {
                left *= media.transmitted(hit.map_or(rest.t_max, |hit| hit.t) * length);
            }
            let Some(hit) = hit else { return left };
            let mut it = self.interaction(&rest, &hit, RayCone { width: 0.0, spread: 0.0 });
            if self.effects.light_path {
                it.path = PathState { length: hit.t, ..PathState::SHADOW };
            }
            t += hit.t;
            let passes = self.coverage(&it).passes;
            left *= Rgb::WHITE.lerp(passes, strength(t));
            if passes.is_black() || left.is_black() {
                return left;
            }
            if let Some((media, _)) = &mut within {
                self.pass_boundary(media, &it, rest.d);
            }
            rest = it.continued(&rest, hit.t);
        }
        // Too many layers stop like an opaque one.
        left * (1.0 - strength(t))
    }

    /// True where a shadow catcher is in the way.
    pub fn is_caught(&self, ray: &Ray) -> bool {
        self.bvh.any_hit(ray, mask::CATCHER)
    }

    /// The background lights that shine along the unit direction `d`, with their index and radiance.
    pub fn background(&self, d: Vec3) -> impl Iterator<Item = (u32, &Light, Rgb)> {
        self.lights
            .background()
            .map(move |(i, light)| (i, light, light.emitter.le(d, None)))
            .filter(|(.., le)| !le.is_black())
    }
}

/// Masks of what stops a light whole and of what must be asked; `None` where nothing does.
fn blockers(shadow: Shadow) -> Option<[u64; 2]> {
    match shadow {
        Shadow::Cast => Some([mask::SHADOW, mask::SHADOW_CUTOUT]),
        Shadow::Off => None,
        Shadow::Only(classes) => Some([mask::linked(classes), mask::linked_cutout(classes)]),
    }
}

impl Interaction {
    /// A ray that leaves this point towards the unit direction `w`.
    pub fn spawn(&self, w: Vec3) -> Ray {
        Ray { time: self.time, ..Ray::new(offset_ray_origin(self.p, self.p_err, self.ng, w), w) }
    }

    /// The segment from this point to `end`, a point off any surface by more than rounding; its
    /// direction is not unit.
    pub fn spawn_to(&self, end: Vec3) -> Ray {
        let o = offset_ray_origin(self.p, self.p_err, self.ng, end - self.p);
        Ray { o, d: end - o, t_max: 1.0, time: self.time }
    }

    /// What is left of `ray` behind this point, which it met at `t`.
    pub fn continued(&self, ray: &Ray, t: f32) -> Ray {
        Ray { t_max: ray.t_max - t, ..self.spawn(ray.d) }
    }
}
