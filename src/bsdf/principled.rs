//! The layered surface of Blender's Principled node, of glTF 2.0 with its extensions, of UsdPreviewSurface and of
//! MaterialX's standard_surface and open_pbr_surface: sheen over coat over metal over glass over the dielectric's
//! reflection over diffuse light, what is below scaled by what the layers above leave.

use super::closure::{beneath, unit};
use super::fresnel::{Dielectric, Metal, f0_from_eta};
use super::ggx::Ggx;
use super::glass::{Boundary, Glass};
use super::lobe::Scatter;
use super::mixture::{Builder, Class};
use super::reflection::{Fresnel, Reflection};
use super::sheen::SheenLobe;
use super::subsurface::{Method, Subsurface};
use super::surface::{Coat, Sheen, Surface};
use super::thin_film::Base;
use super::translucent::Translucent;
use crate::math::{Frame, Rgb, Vec3, safe_sqrt, sqr};

/// Stands for an infinite index of refraction; the reflectance is 0.996.
const LARGEST_IOR: f32 = 1e3;

/// Adds the layers of `surface`, together times `weight`.
pub(super) fn add(builder: &mut Builder<'_>, weight: Rgb, surface: &Surface) {
    let base = surface.base_color.map(unit);
    let ior = match surface.ior {
        0.0 => LARGEST_IOR,
        ior if ior > 0.0 => ior.clamp(1.0 / LARGEST_IOR, LARGEST_IOR),
        _ => 1.0,
    };
    // What reaches the layer in the making.
    let mut through = weight;
    if let Some(sheen) = &surface.sheen {
        through *= add_sheen(builder, through, sheen, surface.coat.as_ref());
    }
    if let Some(coat) = &surface.coat {
        through *= add_coat(builder, through, coat);
    }
    let metallic = unit(surface.metallic);
    if metallic > 0.0 {
        add_metal(builder, through * metallic, surface, base);
    }
    through *= 1.0 - metallic;
    let transmission = unit(surface.transmission);
    if metallic < 1.0 && transmission > 0.0 {
        add_glass(builder, through * transmission, surface, base, ior);
    }
    through *= 1.0 - transmission;
    if through.is_black() {
        return;
    }
    through *= add_specular(builder, through, surface, ior);
    let translucent = unit(surface.translucent);
    if translucent > 0.0 {
        let color = surface.translucent_color.map(unit);
        builder.push(through * color * translucent, Class::Diffuse, None, Translucent);
    }
    through *= 1.0 - translucent;
    if let Some(subsurface) = &surface.subsurface {
        let share = unit(subsurface.weight);
        let ior = if subsurface.method == Method::Walk { curve(surface, ior) } else { subsurface.ior };
        builder.add_beneath(through * share, &Subsurface { ior, ..*subsurface }, sqr(unit(surface.roughness)));
        through *= 1.0 - share;
    }
    let color = if surface.gains { surface.base_color.map(|c| c.max(0.0)) } else { base };
    builder.add_diffuse(through, color, surface.diffuse_roughness, true);
}

/// What is left of light below a layer of `albedo`.
fn left(albedo: Rgb) -> f32 {
    (1.0 - albedo.max_component()).clamp(0.0, 1.0)
}

fn add_sheen(builder: &mut Builder<'_>, weight: Rgb, sheen: &Sheen, coat: Option<&Coat>) -> f32 {
    // Fibers stand on whatever is on top.
    let frame = coat.and_then(|coat| {
        let share = unit(coat.weight);
        let n = coat.frame?.n * share + Vec3::Z * (1.0 - share);
        n.try_normalize().map(Frame::from_z)
    });
    let frame = builder.frame(frame);
    let Some(lobe) = SheenLobe::new(unit(sheen.roughness), builder.wo(frame)) else { return 1.0 };
    let color = sheen.color.map(|c| c.max(0.0));
    let albedo = color * lobe.albedo().above;
    builder.push(weight * color, Class::Diffuse, frame, lobe);
    left(albedo)
}

/// What is left for the layers below.
fn add_coat(builder: &mut Builder<'_>, weight: Rgb, coat: &Coat) -> Rgb {
    let share = unit(coat.weight);
    if share == 0.0 {
        return Rgb::WHITE;
    }
    let ior = coat_ior(coat.ior);
    let frame = builder.frame(coat.frame);
    let frame = builder.upright(frame);
    let wo = builder.wo(frame);
    let mut below = 1.0;
    if ior > 1.0 {
        let lobe = coat_lobe(builder.ggx([sqr(unit(coat.roughness)); 2]), ior, wo);
        below = left(lobe.taken() * share);
        builder.push(weight * share, Class::Interface, frame, lobe);
    }
    // Of thickness 1, so that light goes 1/cos of its way within: tint^(1/cos) is left.
    let within = 1.0 / safe_sqrt(1.0 - (1.0 - sqr(wo.z.min(1.0))) / sqr(ior)).max(1e-3);
    let tint = if coat.tint == Rgb::WHITE { Rgb::WHITE } else { coat.tint.map(|c| c.max(0.0).powf(within)) };
    Rgb::WHITE.lerp(tint, share) * below
}

fn coat_ior(ior: f32) -> f32 {
    if ior > 1.0 { ior.min(LARGEST_IOR) } else { 1.0 }
}

fn coat_lobe(ggx: Option<Ggx>, ior: f32, wo: Vec3) -> Reflection {
    let fresnel = Dielectric::new(ior, Rgb::splat(f0_from_eta(ior)), 1.0);
    // Cycles' coats keep what scatters more than once, whatever the distribution.
    Reflection::new(ggx, Fresnel::Dielectric(fresnel), true, wo)
}

/// Directional albedo of a whole coat of perceptual roughness and index of refraction, seen at `cos` to its
/// normal; that of the layer in a [`Surface`].
pub fn coat_albedo(roughness: f32, ior: f32, cos: f32) -> f32 {
    let ior = coat_ior(ior);
    if ior == 1.0 {
        return 0.0;
    }
    coat_lobe(Ggx::new([sqr(unit(roughness)); 2]), ior, seen_at(cos)).albedo().above.max_component()
}

/// Directional albedo of white sheen of a roughness, seen at `cos` to its normal; that of the layer in a
/// [`Surface`].
pub fn sheen_albedo(roughness: f32, cos: f32) -> f32 {
    SheenLobe::new(unit(roughness), seen_at(cos)).map_or(0.0, |lobe| lobe.albedo().above.max_component())
}

fn seen_at(cos: f32) -> Vec3 {
    let cos = unit(cos);
    Vec3::new(safe_sqrt(1.0 - sqr(cos)), 0.0, cos)
}

fn add_metal(builder: &mut Builder<'_>, weight: Rgb, surface: &Surface, base: Rgb) {
    let metal = Metal::new(base, surface.metal_edge.map(unit));
    let film = surface.film.filter(|film| film.on_metal);
    let fresnel = beneath(&film, Base::Metal(metal)).map_or(Fresnel::Metal(metal), Fresnel::Film);
    add_facets(builder, weight, surface, fresnel);
}

/// Reflection at the microfacets of the base; what it leaves.
fn add_facets(builder: &mut Builder<'_>, weight: Rgb, surface: &Surface, fresnel: Fresnel) -> f32 {
    let (ggx, frame) = builder.facets(surface.roughness, &surface.stretched);
    let frame = builder.frame(frame);
    let frame = builder.upright(frame);
    let lobe = Reflection::new(ggx, fresnel, surface.multiscatter, builder.wo(frame));
    let left = left(lobe.taken());
    builder.push(weight, Class::Interface, frame, lobe);
    left
}

fn add_glass(builder: &mut Builder<'_>, weight: Rgb, surface: &Surface, base: Rgb, ior: f32) {
    let eta = if builder.entering() || surface.thin { ior } else { 1.0 / ior };
    let fresnel = tinted(surface, f0_from_eta(ior), eta);
    let film = if surface.thin { surface.film } else { builder.film_seen(&surface.film, ior) };
    let boundary = Boundary {
        fresnel,
        film: beneath(&film, Base::Dielectric(fresnel)),
        reflects: true,
        tints: [Rgb::WHITE, if surface.thin { base } else { base.map(f32::sqrt) }],
        thin: surface.thin,
    };
    let ggx = builder.ggx([sqr(unit(surface.roughness)); 2]);
    let frame = builder.upright(None);
    let lobe = Glass::new(ggx, boundary, surface.multiscatter, builder.wo(frame));
    builder.push(weight, Class::Interface, frame, lobe);
}

/// The index that the specular level makes of `ior`.
fn curve(surface: &Surface, ior: f32) -> f32 {
    let level = surface.specular_level.max(0.0);
    if level == 1.0 {
        return ior;
    }
    let root = (f0_from_eta(ior) * level).min(0.99).sqrt();
    (1.0 + root) / (1.0 - root)
}

/// Reflection over the diffuse part; what it leaves.
fn add_specular(builder: &mut Builder<'_>, weight: Rgb, surface: &Surface, ior: f32) -> f32 {
    let level = surface.specular_level.max(0.0);
    let curve = curve(surface, ior);
    // Approximation: an opaque surface of an index below 1 has no critical angle, the step in
    // which the tables can't hold.
    let curve = curve.max(1.0 / curve);
    let fresnel = tinted(surface, f0_from_eta(ior) * level, curve);
    let film = beneath(&surface.film, Base::Dielectric(fresnel));
    if film.is_none() && (curve == 1.0 || (fresnel.f90 == 0.0 && fresnel.f0.is_black())) {
        return 1.0;
    }
    add_facets(builder, weight, surface, film.map_or(Fresnel::Dielectric(fresnel), Fresnel::Film))
}

/// The dielectric's reflectance: `f0` at normal incidence, tinted, along the curve of `eta`.
fn tinted(surface: &Surface, f0: f32, eta: f32) -> Dielectric {
    let weight = unit(surface.specular);
    let f0 = surface.specular_color.map(|c| (c.max(0.0) * f0).min(1.0) * weight);
    // Total reflection is total, whatever weight reflection has.
    let f90 = if eta < 1.0 { 1.0 } else { weight };
    Dielectric::new(eta, f0, f90)
}
