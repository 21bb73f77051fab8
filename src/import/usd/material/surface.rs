//! What every shading model fills in, and how that becomes a `MaterialDesc`.

use std::sync::Arc;

use super::clear::{self, Clear};
use super::evaluate::Evaluator;
use super::expr::{Id, Lookup, Op};
use super::lower::Lowering;
use crate::desc::graph::{Function, Leaf, Math, Value as V};
use crate::desc::{
    AlphaMode, AnisotropyDesc, AnisotropyLaw, Channel, ClosureDesc, CoatDesc, ColorInput, IridescenceDesc,
    MaterialDesc, NormalInput, PartDesc, ScalarInput, SheenDesc, SubsurfaceDesc, SubsurfaceMethod, TranslucentDesc,
    VolumeDesc,
};

/// A surface whose inputs are expressions, in `MaterialDesc`'s sense. Normals are in tangent space.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    pub base_color: Id,
    pub metallic: Id,
    /// Of metal at grazing angles, over Schlick's curve.
    pub metal_edge: Id,
    /// 0 for Lambert's law.
    pub diffuse_roughness: Id,
    /// Share of the diffuse light that leaves on the other side, and its color.
    pub translucent: Option<(Id, Id)>,
    /// Light that scatters beneath, in place of diffuse light.
    pub beneath: Option<Beneath>,
    /// Perceptual.
    pub roughness: Id,
    pub ior: Id,
    pub specular: Id,
    pub specular_color: Id,
    /// Factor of the opaque dielectric's reflectance at normal incidence that changes its index with it.
    pub specular_level: Id,
    pub transmission: Id,
    /// No inside.
    pub thin_walled: bool,
    /// Metres and the color that white has there.
    pub attenuation: Option<(f64, Id)>,
    pub dispersion: f64,
    pub coat: Option<Coat>,
    /// Color and roughness.
    pub sheen: Option<(Id, Id)>,
    pub film: Option<Film>,
    pub anisotropy: Option<Anisotropy>,
    /// Radiance.
    pub emission: Id,
    pub opacity: Id,
    pub alpha: Alpha,
    pub normal: Option<Id>,
    pub occlusion: Option<Id>,
}

/// See [`SubsurfaceDesc`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Beneath {
    pub weight: Id,
    pub color: Id,
    /// Metres.
    pub radius: Id,
    pub anisotropy: Id,
    pub method: SubsurfaceMethod,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Coat {
    pub weight: Id,
    pub roughness: Id,
    pub ior: Id,
    /// What is left of light that goes straight down and up.
    pub tint: Id,
    pub normal: Option<Id>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Film {
    pub weight: Id,
    pub ior: Id,
    /// Nanometres.
    pub thickness: Id,
}

/// Highlights that are wider along a tangent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Anisotropy {
    pub strength: Id,
    /// Radians counter-clockwise from the tangent of the first texture coordinates.
    pub rotation: Id,
    pub law: AnisotropyLaw,
}

/// How opacity is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Alpha {
    /// It is not.
    Ignored,
    /// Where it reaches the value.
    Mask(f64),
    /// As a share; opaque where it is 1 everywhere.
    Blend,
    /// The same of what is beneath reflections, which stay.
    Clear,
}

/// A material and what it needs of the shapes that it is bound to.
#[derive(Clone, Debug)]
pub(super) struct Finished {
    pub material: MaterialDesc,
    pub colors: VertexColors,
}

/// What a shape's vertex colors hold for its material: displayColor multiplies the base color,
/// displayOpacity alpha.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in super::super) struct VertexColors {
    /// "displayColor", where the material shows it.
    pub color: Option<Arc<str>>,
    /// "displayOpacity", where the material shows it; never without the color.
    pub opacity: Option<Arc<str>>,
}

impl Surface {
    /// A white dielectric that does nothing else.
    pub fn new(e: &mut Evaluator<'_, '_>) -> Self {
        let x = &mut e.exprs;
        let (zero, one) = (x.number(0.0), x.number(1.0));
        Self {
            base_color: one,
            metallic: zero,
            metal_edge: one,
            diffuse_roughness: zero,
            translucent: None,
            beneath: None,
            roughness: x.number(0.5),
            ior: x.number(1.5),
            specular: one,
            specular_color: one,
            specular_level: one,
            transmission: zero,
            thin_walled: false,
            attenuation: None,
            dispersion: 0.0,
            coat: None,
            sheen: None,
            film: None,
            anisotropy: None,
            emission: zero,
            opacity: one,
            alpha: Alpha::Blend,
            normal: None,
            occlusion: None,
        }
    }
}

/// The surface as a material; `node` is where warnings are told.
pub(super) fn finish(e: &mut Evaluator<'_, '_>, node: usize, surface: Surface) -> Finished {
    let mut f = Finisher { e, node, lowering: Lowering::default() };
    let mut surface = surface;
    let mut colors = VertexColors::default();
    (colors.color, surface.base_color) = f.without_primvar("displayColor", surface.base_color);
    // Vertex colors hold both, and the color would tint.
    if colors.color.is_some() {
        (colors.opacity, surface.opacity) = f.without_primvar("displayOpacity", surface.opacity);
    }
    let of_shape = colors.opacity.is_some();
    let clear = (surface.alpha == Alpha::Clear).then(|| clear::split(&mut f.e.exprs, &mut surface, of_shape)).flatten();
    let mut material = MaterialDesc {
        base_color: f.color(surface.base_color),
        metallic: f.scalar(surface.metallic),
        metal_edge: f.color(surface.metal_edge),
        diffuse_roughness: f.scalar(surface.diffuse_roughness),
        roughness: f.scalar(surface.roughness),
        ior: f.scalar(surface.ior),
        specular: f.scalar(surface.specular),
        specular_color: f.color(surface.specular_color),
        specular_level: f.scalar(surface.specular_level),
        transmission: f.scalar(surface.transmission),
        dispersion: surface.dispersion.max(0.0),
        emission: f.color(surface.emission),
        alpha: f.scalar(surface.opacity),
        normal: surface.normal.and_then(|id| f.normal("normal", id)),
        occlusion: surface.occlusion.and_then(|id| f.occlusion(id)),
        ..MaterialDesc::default()
    };
    material.alpha_mode = match surface.alpha {
        Alpha::Ignored | Alpha::Clear => AlphaMode::Opaque,
        Alpha::Mask(cutoff) => AlphaMode::Mask { cutoff },
        Alpha::Blend if material.alpha == ScalarInput::constant(1.0) && colors.opacity.is_none() => AlphaMode::Opaque,
        Alpha::Blend => AlphaMode::Blend,
    };
    if material.alpha_mode == AlphaMode::Opaque {
        material.alpha = ScalarInput::constant(1.0);
        colors.opacity = colors.opacity.filter(|_| clear.is_some());
    }
    if material.transmission.factor > 0.0 && !surface.thin_walled {
        let (distance, color) = surface.attenuation.unwrap_or((f64::INFINITY, f.e.exprs.number(1.0)));
        material.volume = Some(VolumeDesc {
            // Any thickness: light is followed through the inside.
            thickness: ScalarInput::constant(1.0),
            attenuation_distance: distance,
            attenuation_color: f.rgb("transmission color", color),
            adds: false,
        });
    }
    material.coat = surface.coat.filter(|coat| !f.e.exprs.is(coat.weight, 0.0)).map(|coat| CoatDesc {
        weight: f.scalar(coat.weight),
        roughness: f.scalar(coat.roughness),
        ior: f.scalar(coat.ior),
        tint: f.color(coat.tint),
        normal: coat.normal.and_then(|id| f.normal("coat normal", id)),
    });
    let translucent = surface.translucent.filter(|(weight, _)| !f.e.exprs.is(*weight, 0.0));
    material.translucent =
        translucent.map(|(weight, color)| TranslucentDesc { weight: f.scalar(weight), color: f.color(color) });
    let ior = material.ior;
    material.subsurface = surface.beneath.map(|beneath| SubsurfaceDesc {
        weight: f.scalar(beneath.weight),
        color: f.color(beneath.color),
        radius: f.color(beneath.radius),
        anisotropy: f.scalar(beneath.anisotropy),
        ior,
        method: beneath.method,
        shallow: false,
    });
    material.sheen = surface
        .sheen
        .filter(|(color, _)| !f.e.exprs.is(*color, 0.0))
        .map(|(color, roughness)| SheenDesc { color: f.color(color), roughness: f.scalar(roughness) });
    material.iridescence =
        surface.film.filter(|film| !f.e.exprs.is(film.weight, 0.0) && !f.e.exprs.is(film.thickness, 0.0)).map(|film| {
            let thickness = f.scalar(film.thickness);
            IridescenceDesc {
                weight: f.scalar(film.weight),
                ior: f.scalar(film.ior),
                thickness_min: 0.0,
                thickness_max: 1.0,
                thickness,
                on_metal: true,
            }
        });
    let stretched = surface.anisotropy.filter(|anisotropy| !f.e.exprs.is(anisotropy.strength, 0.0));
    material.anisotropy = stretched.map(|Anisotropy { strength, rotation, law }| {
        let (strength, rotation) = (f.scalar(strength), f.scalar(rotation));
        AnisotropyDesc { strength, rotation, texture: None, tangent: None, law }
    });
    if let Some(clear) = clear {
        f.see_through(&mut material, clear);
    }
    material.graph = f.lowering.graph;
    Finished { material, colors }
}

struct Finisher<'e, 'm, 'a> {
    e: &'e mut Evaluator<'m, 'a>,
    node: usize,
    lowering: Lowering,
}

impl Finisher<'_, '_, '_> {
    /// What `clear` says besides the layers of `material`.
    fn see_through(&mut self, material: &mut MaterialDesc, clear: Clear) {
        material.transparency = self.color(clear.passes);
        let Some([opaque, rest, dielectric]) = clear.parts else { return };
        let layers = MaterialDesc {
            base_color: ColorInput::constant([0.0; 3]),
            metallic: ScalarInput::constant(0.0),
            specular: self.scalar(dielectric),
            ..material.clone()
        };
        material.parts = [(opaque, material.clone()), (rest, layers)]
            .map(|(weight, layers)| {
                let closure = ClosureDesc::Layered(Box::new(layers));
                PartDesc { weight: self.scalar(weight), normal: None, closure }
            })
            .into();
    }

    fn color(&mut self, id: Id) -> ColorInput {
        match self.e.exprs.op(id) {
            Op::Constant([r, g, b, _]) => ColorInput::constant([*r, *g, *b]),
            Op::Lookup(l) if l.bias[..3] == [0.0; 3] && is_color(l) => {
                ColorInput::textured([l.factor[0], l.factor[1], l.factor[2]], Some(l.texture))
            }
            _ => ColorInput::graph(self.lowering.value(&self.e.exprs, id)),
        }
    }

    fn scalar(&mut self, id: Id) -> ScalarInput {
        match self.e.exprs.op(id) {
            Op::Constant(value) => ScalarInput::constant(value[0]),
            Op::Lookup(l) if l.bias[0] == 0.0 => {
                ScalarInput::textured(l.factor[0], Some((l.texture, channel(l.swizzle[0]))))
            }
            _ => ScalarInput::graph(self.lowering.value(&self.e.exprs, id)),
        }
    }

    fn rgb(&mut self, what: &str, id: Id) -> [f64; 3] {
        let [r, g, b, _] = self.mean(what, id);
        [r, g, b]
    }

    fn mean(&mut self, what: &str, id: Id) -> V {
        if let Some(value) = self.e.exprs.known(id) {
            return value;
        }
        self.e.warn(self.node, format!("its {what} can't vary over the surface; the mean is used"));
        self.lowering.mean(&self.e.exprs, id, self.e.materials)
    }

    /// A tangent-space normal, −1 to 1.
    fn normal(&mut self, what: &str, id: Id) -> Option<NormalInput> {
        match self.e.exprs.op(id) {
            Op::Constant([x, y, ..]) if *x == 0.0 && *y == 0.0 => return None,
            _ if self.is_own_normal(id) => return None,
            _ if self.e.exprs.has_leaf(id) => {
                self.e.warn(self.node, format!("its {what} is computed of vectors, which isn't read; left out"));
                return None;
            }
            // 2 t − 1, the first two times a factor, which is how maps are stored.
            Op::Lookup(l) if is_color(l) && l.factor[2] == 2.0 && l.bias[2] == -1.0 => {
                let scale = l.factor[0] / 2.0;
                let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
                if close(l.factor[1], l.factor[0]) && close(l.bias[0], -scale) && close(l.bias[1], -scale) {
                    return Some(NormalInput::Map { texture: l.texture, scale });
                }
            }
            _ => {}
        }
        let tilt = self.lowering.value(&self.e.exprs, id);
        let graph = &mut self.lowering.graph;
        let (half, one, tangent) = (graph.number(0.5), graph.number(1.0), graph.leaf(Leaf::Tangent));
        let stored = graph.math(Math::MultiplyAdd, &[tilt, half, half]);
        Some(NormalInput::Graph(graph.normal_map(stored, one, tangent)))
    }

    /// True for the surface's own normal, in whatever space.
    fn is_own_normal(&self, id: Id) -> bool {
        match self.e.exprs.op(id) {
            Op::Leaf(leaf) => matches!(leaf, Leaf::Normal | Leaf::ObjectNormal),
            Op::Apply(Function::Affine(_) | Function::Normalize(_), args) => self.is_own_normal(args[0]),
            _ => false,
        }
    }

    /// The factor of an occlusion is its strength.
    fn occlusion(&mut self, id: Id) -> Option<ScalarInput> {
        if self.e.exprs.known(id).is_some() {
            return None;
        }
        let input = self.scalar(id);
        if input.factor == 1.0 {
            return Some(input);
        }
        Some(ScalarInput::graph(self.lowering.value(&self.e.exprs, id)))
    }

    /// The primvar `wanted`, where it multiplies all the rest, and the rest.
    fn without_primvar(&mut self, wanted: &str, id: Id) -> (Option<Arc<str>>, Id) {
        let primvar = |id: Id| {
            let id = match self.e.exprs.op(id) {
                Op::Apply(Function::Swizzle(_), args) => args[0],
                _ => id,
            };
            match self.e.exprs.op(id) {
                Op::Primvar { name, .. } if **name == *wanted => Some(name.clone()),
                _ => None,
            }
        };
        if let Some(name) = primvar(id) {
            return (Some(name), self.e.exprs.number(1.0));
        }
        if let Op::Apply(Function::Math(Math::Multiply), args) = self.e.exprs.op(id)
            && let [a, b] = args[..]
        {
            for (one, other) in [(a, b), (b, a)] {
                if let Some(name) = primvar(one) {
                    return (Some(name), other);
                }
            }
        }
        (None, id)
    }
}

/// Whether a lookup reads red, green and blue as they stand; all three are the same in grey images.
fn is_color(lookup: &Lookup) -> bool {
    lookup.swizzle[..3] == [0, 1, 2] || (lookup.channels <= 2 && lookup.swizzle[..3].iter().all(|place| *place < 3))
}

fn channel(place: u8) -> Channel {
    match place {
        0 => Channel::R,
        1 => Channel::G,
        2 => Channel::B,
        _ => Channel::A,
    }
}
