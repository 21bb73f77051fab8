//! Materials with their constants folded, and the textures and programs that are left.

mod aovs;
mod parts;
mod textures;

pub use textures::Textures;

use std::borrow::Cow;
use std::sync::Arc;

use super::cache::Cache;
use super::graphs;
use super::mend::Mended;
use crate::desc::graph::{Function, Graph, Leaf, Value, ValueId};
use crate::desc::{self, AlphaMode, Channel, MaterialDesc, SceneDesc, TextureTransform};
use crate::error::Warnings;
use crate::film::Aov;
use crate::math::Rgb;
use crate::scene::asked::Names;
use crate::scene::effects;
use crate::scene::material::{ColorInput, NormalInput, Opacity, Part, Programs, ScalarInput, Varying, rgb_of, single};
use crate::scene::{Interior, Material};
use crate::settings::Settings;
use crate::texture::graph::Program;
use crate::texture::{Texture, TextureRef};

/// Materials, and what they share.
pub struct Materials {
    /// As in the `SceneDesc`, with the default one added at the end.
    pub list: Vec<Material>,
    /// Every texture that one of them looks up.
    pub textures: Vec<Texture>,
    /// Attributes that their programs ask for.
    pub names: Names,
    /// Programs of the radiance of `SceneDesc::dome_shaders`.
    pub domes: Vec<Program>,
    /// Programs of the factors of `SceneDesc::lamp_shaders`.
    pub lamps: Vec<Program>,
    /// Program of what the background gives as AOVs, and which AOV each of its values is.
    pub background: Option<(Program, Vec<usize>)>,
}

/// The materials of `desc`, which give `aovs`. Texels move out of `desc` into the textures.
pub fn prepare(
    desc: &mut SceneDesc,
    settings: &Settings,
    aovs: &[Aov],
    cache: &mut Cache,
    warnings: &mut Warnings,
) -> Materials {
    let mut used = vec![false; desc.materials.len()];
    for &material in desc.instances.iter().flat_map(|i| i.materials.iter().flatten()) {
        used[material as usize] = true;
    }
    let images = textures::images(desc, &used, cache, warnings);
    let textures = Textures::new(desc, images);
    let mut builder = Builder { desc, settings, aovs, textures, names: Names::default() };
    let fallback = MaterialDesc::default();
    let materials = desc.materials.iter().zip(&used).map(|(material, used)| (material, *used));
    let list = materials
        .chain([(&fallback, true)])
        // A material that nothing uses keeps its index, and none of its textures.
        .map(|(material, used)| builder.material(if used { material } else { &fallback }, warnings))
        .collect();
    let mut program = |graph: &Graph, value: ValueId| {
        graphs::program(&fallback, graph, &[value], &mut builder.textures, &mut builder.names)
    };
    let domes = desc.dome_shaders.iter().map(|shader| program(&shader.graph, shader.radiance)).collect();
    let lamps = desc.lamp_shaders.iter().map(|shader| program(&shader.graph, shader.factor)).collect();
    let background = aovs::background(&mut builder);
    Materials { list, textures: builder.textures.list, names: builder.names, domes, lamps, background }
}

struct Builder<'a> {
    desc: &'a SceneDesc,
    settings: &'a Settings,
    aovs: &'a [Aov],
    textures: Textures<'a>,
    names: Names,
}

/// The inputs of one material in the making.
struct Inputs<'m> {
    desc: &'m MaterialDesc,
    /// The material's graph, with what plain textures on top of its values make of them.
    graph: Cow<'m, Graph>,
    textures: Vec<TextureRef>,
    /// Values that the program in the making has to give.
    values: Vec<ValueId>,
    /// Values that the program for normals and tangents has to give.
    bends: Vec<ValueId>,
}

impl Inputs<'_> {
    /// `value` times `texture`, as a value.
    fn textured(&mut self, value: ValueId, texture: &desc::TextureRef, place: Option<u8>) -> ValueId {
        let graph = self.graph.to_mut();
        let TextureTransform([u, v]) = texture.transform;
        let rows = [[u[0], u[1], 0.0, u[2]], [v[0], v[1], 0.0, v[2]], [0.0; 4]];
        let uv = graph.leaf(Leaf::Uv(texture.uv_set));
        let uv = graph.apply(Function::Affine(Box::new(rows)), &[uv]);
        let texel = graph.image(texture.texture, uv);
        let texel = place.map_or(texel, |place| graph.place(texel, place));
        graph.multiply(value, texel)
    }
}

/// Where a channel is in a texel.
fn place(channel: Channel) -> u8 {
    match channel {
        Channel::R => 0,
        Channel::G => 1,
        Channel::B => 2,
        Channel::A => 3,
    }
}

impl Builder<'_> {
    fn plain(&mut self, inputs: &mut Inputs<'_>, texture: &desc::TextureRef) -> Option<u8> {
        let input = self.textures.input(texture)?;
        let list = &mut inputs.textures;
        let index = list.iter().position(|known| *known == input).unwrap_or_else(|| {
            list.push(input);
            list.len() - 1
        });
        Some(index as u8)
    }

    /// What the program in the making will give as `value`, or what it is everywhere.
    fn value(&mut self, inputs: &mut Inputs<'_>, value: ValueId) -> Result<Varying, Value> {
        let known = graphs::constant(inputs.desc, &inputs.graph, value, &mut self.textures, &mut self.names);
        if let Some(known) = known {
            return Err(known);
        }
        inputs.values.push(value);
        Ok(Varying::Graph(inputs.values.len() as u8 - 1))
    }

    fn color(&mut self, inputs: &mut Inputs<'_>, input: &desc::ColorInput) -> ColorInput {
        let factor = Rgb::from(input.factor);
        let constant = |factor: Rgb| ColorInput { factor, varying: Varying::No };
        if factor.is_black() {
            return constant(factor);
        }
        let known = input.texture.map(|texture| (texture, self.textures.constant(&texture)));
        let (factor, texture) = match known {
            Some((_, Some([r, g, b, _]))) => (factor * Rgb::new(r, g, b), None),
            Some((texture, None)) => (factor, Some(texture)),
            None => (factor, None),
        };
        let value = input.graph.map(|value| match texture {
            Some(texture) => inputs.textured(value, &texture, None),
            None => value,
        });
        match (value, texture) {
            (Some(value), _) => match self.value(inputs, value) {
                Ok(varying) => ColorInput { factor, varying },
                Err([r, g, b, _]) => constant(factor * rgb_of([r, g, b])),
            },
            (None, Some(texture)) => {
                let varying = self.plain(inputs, &texture).map_or(Varying::No, |i| Varying::Texture(i, 0));
                ColorInput { factor, varying }
            }
            (None, None) => constant(factor),
        }
    }

    fn scalar(&mut self, inputs: &mut Inputs<'_>, input: &desc::ScalarInput) -> ScalarInput {
        let factor = input.factor as f32;
        let constant = |factor: f32| ScalarInput { factor, varying: Varying::No };
        if factor == 0.0 {
            return constant(factor);
        }
        let known = input.texture.map(|(texture, channel)| (texture, place(channel), self.textures.constant(&texture)));
        let (factor, texture) = match known {
            Some((_, place, Some(texel))) => (factor * texel[usize::from(place)], None),
            Some((texture, place, None)) => (factor, Some((texture, place))),
            None => (factor, None),
        };
        let value = input.graph.map(|value| match texture {
            Some((texture, place)) => inputs.textured(value, &texture, Some(place)),
            None => value,
        });
        match (value, texture) {
            (Some(value), _) => match self.value(inputs, value) {
                Ok(varying) => ScalarInput { factor, varying },
                Err(known) => constant(factor * single(known[0])),
            },
            (None, Some((texture, place))) => {
                let varying = self.plain(inputs, &texture).map_or(Varying::No, |i| Varying::Texture(i, place));
                ScalarInput { factor, varying }
            }
            (None, None) => constant(factor),
        }
    }

    /// The program for the values that inputs have asked for since the last one.
    fn program(&mut self, inputs: &mut Inputs<'_>) -> Option<Program> {
        let values = std::mem::take(&mut inputs.values);
        if values.is_empty() {
            return None;
        }
        Some(graphs::program(inputs.desc, &inputs.graph, &values, &mut self.textures, &mut self.names))
    }

    /// A normal map; of a graph its program follows.
    fn normal(&mut self, inputs: &mut Inputs<'_>, normal: desc::NormalInput) -> Option<NormalInput> {
        match normal {
            desc::NormalInput::Map { texture, scale } => {
                if scale == 0.0 || self.textures.constant(&texture).is_some() {
                    return None;
                }
                Some(NormalInput { input: self.textures.input(&texture)?, scale: scale as f32 })
            }
            desc::NormalInput::Graph(value) => {
                inputs.values.push(value);
                None
            }
        }
    }

    fn material(&mut self, desc: &MaterialDesc, warnings: &mut Warnings) -> Material {
        warn_of_effects_to_come(desc, warnings);
        let mut mended = Mended::default();
        let emission =
            desc::ColorInput { factor: emission(desc, &mut mended).to_array().map(f64::from), ..desc.emission };
        mended.tell_at(&desc.place, warnings);
        let volume = desc.volume.filter(|v| v.thickness.factor > 0.0);
        let graph = Cow::Borrowed(&desc.graph);
        let inputs = &mut Inputs { desc, graph, textures: Vec::new(), values: Vec::new(), bends: Vec::new() };
        // One question after the other; each has a program of its own. What scatters:
        let parts = if desc.unlit { Vec::new() } else { self.parts(inputs) };
        let surface = self.program(inputs);
        inputs.values = std::mem::take(&mut inputs.bends);
        let bends = self.program(inputs);
        // What passes:
        let alpha = self.scalar(inputs, &desc.alpha);
        let opaque = effects::is_opaque(self.desc, desc)
            || (alpha.varying == Varying::No
                && effects::is_opaque_at(self.desc, desc.alpha_mode, f64::from(alpha.factor)));
        if opaque {
            inputs.values.clear();
        }
        let transparency = Some(self.color(inputs, &desc.transparency)).filter(|t| !t.factor.is_black());
        let opacity = self.program(inputs);
        // What is emitted; of an unlit surface its color:
        let emission = self.color(inputs, if desc.unlit { &desc.base_color } else { &emission });
        let light = self.program(inputs);
        // Which way it faces:
        let normal_map = desc.normal.and_then(|normal| self.normal(inputs, normal));
        let normal = self.program(inputs);
        // What light reaches it at all:
        let occlusion = desc
            .occlusion
            .filter(|o| self.settings.occlusion_maps && o.factor != 0.0)
            .filter(|o| o.texture.is_some() || o.graph.is_some())
            .map(|o| self.scalar(inputs, &o));
        let occluded = self.program(inputs);
        // What it is called:
        let aovs = aovs::inputs(self, inputs);
        let programs = Programs {
            opacity,
            emission: light,
            surface,
            normal,
            bends,
            occlusion: occluded,
            aovs: self.program(inputs),
        };
        let of_part = |part: &Part| part.bends.as_ref().is_some_and(|bends| bends.normal.is_some());
        let of_whole = !desc.relief && (normal_map.is_some() || programs.normal.is_some());
        let bumps = desc.bump_correction && (of_whole || parts.iter().any(of_part));
        Material {
            parts,
            alpha,
            opacity: match desc.alpha_mode {
                _ if opaque => Opacity::Opaque,
                AlphaMode::Opaque => Opacity::Opaque,
                AlphaMode::Mask { cutoff } => Opacity::Mask(cutoff as f32),
                AlphaMode::Blend => Opacity::Blend,
            },
            transparency,
            interior: volume.map(|volume| Interior { sigma: absorption(&volume), adds: volume.adds }),
            emission,
            unlit: desc.unlit,
            unbounded: desc.unbounded,
            relief: desc.relief,
            tinted: desc.tinted,
            holdout: desc.holdout,
            normal: normal_map,
            bumps,
            upright: desc.bump_correction,
            occlusion,
            aovs,
            programs: programs.any().then(|| Arc::new(programs)),
            inputs: std::mem::take(&mut inputs.textures),
        }
    }
}

/// True where bad numbers are all that a material was to emit.
pub fn emission_is_lost(desc: &MaterialDesc) -> bool {
    effects::emits(desc) && emission(desc, &mut Mended::default()).is_black()
}

/// Emitted radiance, or the factor of its texture.
fn emission(desc: &MaterialDesc, mended: &mut Mended) -> Rgb {
    let strength = desc.emission_strength;
    if desc.unbounded {
        return mended.signed_color("emission", desc.emission.factor.map(|c| c * strength));
    }
    // Two negative factors make no light.
    let product = |c: f64| if strength < 0.0 { -(c * strength).abs() } else { c * strength };
    mended.color("emission", desc.emission.factor.map(product))
}

/// `σ = −ln(color) / distance`, KHR_materials_volume.
fn absorption(volume: &desc::VolumeDesc) -> Rgb {
    let distance = volume.attenuation_distance;
    if !(distance.is_finite() && distance > 0.0) {
        return Rgb::BLACK;
    }
    Rgb::from(volume.attenuation_color.map(|c| -c.clamp(1e-6, 1.0).ln() / distance))
}

/// One warning for what a material asks and the engine doesn't compute yet.
fn warn_of_effects_to_come(desc: &MaterialDesc, warnings: &mut Warnings) {
    if desc.dispersion > 0.0 {
        warnings.push(&desc.place, "rendered without its dispersion: not computed yet".to_string());
    }
}
