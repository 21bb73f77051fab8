//! What scatters: the layered surface of a material or the mixture that is there in its place.

use super::{Builder, Inputs};
use crate::bsdf::{Closure, Coat, Conductor, Method, Microfacets, Sheen, Subsurface, Surface, ThinFilm};
use crate::desc::graph::ValueId;
use crate::desc::{
    self, AnisotropyDesc, ClosureDesc, FacetsDesc, IridescenceDesc, MaterialDesc, SheenDesc, SubsurfaceDesc,
    SubsurfaceMethod,
};
use crate::math::Rgb;
use crate::scene::material::{ColorInput, Part, ScalarInput, Varying};
use crate::scene::shading::{Anisotropy, Bends, NormalSource};

/// A lobe with inputs, and its normals and tangents.
struct Bent {
    closure: Closure<ColorInput, ScalarInput>,
    bends: Bends,
}

impl From<Closure<ColorInput, ScalarInput>> for Bent {
    fn from(closure: Closure<ColorInput, ScalarInput>) -> Self {
        Self { closure, bends: Bends::default() }
    }
}

fn number(factor: f32) -> ScalarInput {
    ScalarInput { factor, varying: Varying::No }
}

impl Builder<'_> {
    /// The parts of what scatters; those of no weight are left out.
    pub(super) fn parts(&mut self, inputs: &mut Inputs<'_>) -> Vec<Part> {
        let desc = inputs.desc;
        if desc.parts.is_empty() && reflects_nothing(desc) {
            return Vec::new();
        }
        if desc.parts.is_empty() {
            let layers = self.layers(inputs, desc);
            return vec![part(number(1.0), layers)];
        }
        let mut parts = Vec::new();
        for desc in &desc.parts {
            let weight = self.scalar(inputs, &desc.weight);
            if weight.factor == 0.0 {
                continue;
            }
            let mut bent = self.closure(inputs, &desc.closure);
            bent.bends.normal = desc.normal.and_then(|normal| self.normal_source(inputs, normal));
            parts.push(part(weight, bent));
        }
        parts
    }

    fn closure(&mut self, inputs: &mut Inputs<'_>, desc: &ClosureDesc) -> Bent {
        match desc {
            ClosureDesc::Layered(layers) => self.layers(inputs, layers),
            ClosureDesc::Diffuse { color, roughness, multiscatter } => Bent::from(Closure::Diffuse {
                color: self.color(inputs, color),
                roughness: self.scalar(inputs, roughness),
                multiscatter: *multiscatter,
            }),
            ClosureDesc::Beneath { subsurface, alpha } => {
                let alpha = self.scalar(inputs, alpha);
                Bent::from(Closure::Beneath { subsurface: self.subsurface(inputs, subsurface), alpha })
            }
            ClosureDesc::Translucent { color } => Bent::from(Closure::Translucent { color: self.color(inputs, color) }),
            ClosureDesc::Glossy { color, facets } => {
                let color = self.color(inputs, color);
                let (facets, bends) = self.facets(inputs, facets);
                Bent { closure: Closure::Glossy { color, facets }, bends }
            }
            ClosureDesc::Metal { base, edge, facets, film } => {
                let (base, edge) = (self.color(inputs, base), self.color(inputs, edge));
                let (facets, bends) = self.facets(inputs, facets);
                let film = film.as_ref().and_then(|film| self.film(inputs, film));
                Bent { closure: Closure::Metal { base, edge, facets, film }, bends }
            }
            ClosureDesc::Conductor { eta, k, facets, film } => {
                let index = Conductor { eta: self.color(inputs, eta), k: self.color(inputs, k) };
                let (facets, bends) = self.facets(inputs, facets);
                let film = film.as_ref().and_then(|film| self.film(inputs, film));
                Bent { closure: Closure::Conductor { index, facets, film }, bends }
            }
            ClosureDesc::Glass { color, ior, facets, film } => {
                let (color, ior) = (self.color(inputs, color), self.scalar(inputs, ior));
                let (facets, bends) = self.facets(inputs, facets);
                let film = film.as_ref().and_then(|film| self.film(inputs, film));
                Bent { closure: Closure::Glass { color, ior, facets, film }, bends }
            }
            ClosureDesc::Refraction { color, ior, facets } => {
                let (color, ior) = (self.color(inputs, color), self.scalar(inputs, ior));
                let (facets, bends) = self.facets(inputs, facets);
                Bent { closure: Closure::Refraction { color, ior, facets }, bends }
            }
            ClosureDesc::Sheen(sheen) => Bent::from(Closure::Sheen(self.sheen(inputs, sheen))),
            ClosureDesc::Toon { color, size, smooth, glossy } => {
                let color = self.color(inputs, color);
                let size = [self.scalar(inputs, size), self.scalar(inputs, smooth)];
                Bent::from(Closure::Toon { color, size, glossy: *glossy })
            }
        }
    }

    fn layers(&mut self, inputs: &mut Inputs<'_>, desc: &MaterialDesc) -> Bent {
        let translucent = desc.translucent.as_ref();
        let ior = match desc.ior.factor {
            factor if factor.is_finite() && factor >= 0.0 => self.scalar(inputs, &desc.ior),
            _ => number(1.5),
        };
        let beneath = desc.subsurface.as_ref().filter(|beneath| beneath.weight.factor > 0.0);
        let coat = desc.coat.as_ref().filter(|coat| coat.weight.factor > 0.0);
        let sheen = desc.sheen.as_ref().filter(|sheen| sheen.color.factor.iter().any(|&c| c > 0.0));
        let surface = Surface {
            base_color: self.color(inputs, &desc.base_color),
            gains: desc.unbounded,
            metallic: self.scalar(inputs, &desc.metallic),
            metal_edge: self.color(inputs, &desc.metal_edge),
            diffuse_roughness: self.scalar(inputs, &desc.diffuse_roughness),
            roughness: self.scalar(inputs, &desc.roughness),
            stretched: None,
            multiscatter: desc.multiscatter,
            ior,
            specular: self.scalar(inputs, &desc.specular),
            specular_color: self.color(inputs, &desc.specular_color),
            specular_level: self.scalar(inputs, &desc.specular_level),
            transmission: self.scalar(inputs, &desc.transmission),
            thin: desc.volume.is_none_or(|volume| volume.thickness.factor <= 0.0),
            translucent: translucent.map_or(number(0.0), |t| self.scalar(inputs, &t.weight)),
            translucent_color: translucent.map_or(white(), |t| self.color(inputs, &t.color)),
            subsurface: beneath.map(|beneath| self.subsurface(inputs, beneath)),
            coat: coat.map(|coat| Coat {
                weight: self.scalar(inputs, &coat.weight),
                roughness: self.scalar(inputs, &coat.roughness),
                ior: self.scalar(inputs, &coat.ior),
                tint: self.color(inputs, &coat.tint),
                frame: None,
            }),
            sheen: sheen.map(|sheen| self.sheen(inputs, sheen)),
            film: desc.iridescence.as_ref().and_then(|film| self.film(inputs, film)),
        };
        let coat = coat.and_then(|coat| coat.normal).and_then(|normal| self.normal_source(inputs, normal));
        let anisotropy = desc.anisotropy.as_ref().and_then(|anisotropy| self.anisotropy(inputs, anisotropy));
        Bent { closure: Closure::Layered(surface), bends: Bends { normal: None, coat, anisotropy } }
    }

    fn facets(&mut self, inputs: &mut Inputs<'_>, desc: &FacetsDesc) -> (Microfacets<ScalarInput>, Bends) {
        let roughness = self.scalar(inputs, &desc.roughness);
        let anisotropy = desc.anisotropy.as_ref().and_then(|anisotropy| self.anisotropy(inputs, anisotropy));
        let facets = Microfacets { roughness, stretched: None, multiscatter: desc.multiscatter };
        (facets, Bends { anisotropy, ..Bends::default() })
    }

    fn subsurface(&mut self, inputs: &mut Inputs<'_>, desc: &SubsurfaceDesc) -> Subsurface<ColorInput, ScalarInput> {
        Subsurface {
            weight: self.scalar(inputs, &desc.weight),
            color: self.color(inputs, &desc.color),
            radius: self.color(inputs, &desc.radius),
            anisotropy: self.scalar(inputs, &desc.anisotropy),
            ior: self.scalar(inputs, &desc.ior),
            method: match desc.method {
                SubsurfaceMethod::RandomWalk => Method::Walk,
                SubsurfaceMethod::RandomWalkSkin => Method::Skin,
                SubsurfaceMethod::FreePath => Method::FreePath,
                SubsurfaceMethod::Burley => Method::Profile,
            },
            shallow: desc.shallow,
        }
    }

    fn sheen(&mut self, inputs: &mut Inputs<'_>, desc: &SheenDesc) -> Sheen<ColorInput, ScalarInput> {
        Sheen { color: self.color(inputs, &desc.color), roughness: self.scalar(inputs, &desc.roughness) }
    }

    fn film(&mut self, inputs: &mut Inputs<'_>, desc: &IridescenceDesc) -> Option<ThinFilm<ScalarInput>> {
        if desc.weight.factor <= 0.0 || desc.thickness_min.max(desc.thickness_max) <= 0.0 {
            return None;
        }
        let weight = self.scalar(inputs, &desc.weight);
        let (least, most) = (desc.thickness_min, desc.thickness_max);
        // Least where the input is 0, most where it is 1.
        let thickness = match desc.thickness {
            within if least == 0.0 => {
                self.scalar(inputs, &desc::ScalarInput { factor: within.factor * most, ..within })
            }
            within => {
                let within = self.as_value(inputs, &within);
                let graph = inputs.graph.to_mut();
                let range = graph.number(most - least);
                let scaled = graph.multiply(within, range);
                let base = graph.number(least);
                let value = graph.add(scaled, base);
                self.scalar(inputs, &desc::ScalarInput::graph(value))
            }
        };
        Some(ThinFilm { thickness, ior: self.scalar(inputs, &desc.ior), weight, on_metal: desc.on_metal })
    }

    /// An input as a value of the graph.
    fn as_value(&mut self, inputs: &mut Inputs<'_>, input: &desc::ScalarInput) -> ValueId {
        let factor = inputs.graph.to_mut().number(input.factor);
        let value = match input.graph {
            Some(value) => inputs.graph.to_mut().multiply(value, factor),
            None => factor,
        };
        match &input.texture {
            Some((texture, channel)) => inputs.textured(value, texture, Some(super::place(*channel))),
            None => value,
        }
    }

    fn anisotropy(&mut self, inputs: &mut Inputs<'_>, desc: &AnisotropyDesc) -> Option<Anisotropy> {
        let strength = self.scalar(inputs, &desc.strength);
        if strength.factor == 0.0 {
            return None;
        }
        Some(Anisotropy {
            strength,
            rotation: self.scalar(inputs, &desc.rotation),
            texture: desc.texture.as_ref().and_then(|texture| self.plain(inputs, texture)),
            tangent: desc.tangent.map(|value| inputs.bend(value)),
            law: desc.law,
        })
    }

    fn normal_source(&mut self, inputs: &mut Inputs<'_>, desc: desc::NormalInput) -> Option<NormalSource> {
        match desc {
            desc::NormalInput::Graph(value) => Some(NormalSource::Graph(inputs.bend(value))),
            map => self.normal(inputs, map).map(NormalSource::Map),
        }
    }
}

impl Inputs<'_> {
    /// Index of `value` in the program for normals and tangents.
    fn bend(&mut self, value: ValueId) -> u8 {
        self.bends.push(value);
        self.bends.len() as u8 - 1
    }
}

/// True for layers that are black everywhere.
fn reflects_nothing(desc: &MaterialDesc) -> bool {
    let MaterialDesc { coat, sheen, translucent, subsurface, .. } = desc;
    desc.base_color.factor == [0.0; 3]
        && [desc.specular, desc.metallic].iter().all(|input| input.factor == 0.0)
        && coat.is_none()
        && sheen.is_none()
        && translucent.is_none()
        && subsurface.is_none()
}

fn white() -> ColorInput {
    ColorInput { factor: Rgb::WHITE, varying: Varying::No }
}

fn part(weight: ScalarInput, Bent { closure, bends }: Bent) -> Part {
    let bent = bends.normal.is_some() || bends.coat.is_some() || bends.anisotropy.is_some();
    Part { weight, fixed: fixed(&closure), closure, bends: bent.then(|| Box::new(bends)) }
}

/// `closure` evaluated, where none of its inputs varies.
fn fixed(closure: &Closure<ColorInput, ScalarInput>) -> Option<Closure> {
    let varies = std::cell::Cell::new(false);
    let note = |varying: Varying| varies.set(varies.get() || varying != Varying::No);
    let evaluated = closure.map(
        |color| {
            note(color.varying);
            color.factor
        },
        |scalar| {
            note(scalar.varying);
            scalar.factor
        },
    );
    (!varies.get()).then_some(evaluated)
}
