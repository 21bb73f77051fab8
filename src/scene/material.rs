//! Materials as they are traced: constants, texture lookups and values of graphs, evaluated at a point.

use std::sync::Arc;

use super::spot::{Around, MOST_OUTPUTS, Spot};
use super::{Interaction, Scene};
use crate::bsdf::Surface;
use crate::desc::graph::Value;
use crate::math::Rgb;
use crate::texture::TextureRef;
use crate::texture::graph::Program;

/// What an input varies by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Varying {
    /// Nothing.
    No,
    /// Index into `Material::inputs`, and the channel for a number.
    Texture(u8, u8),
    /// Index of a value of the program that answers for the input.
    Graph(u8),
}

/// A colour: `factor × what varies`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorInput {
    /// Constant part.
    pub factor: Rgb,
    /// The other.
    pub varying: Varying,
}

/// A number: `factor × what varies`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalarInput {
    /// Constant part.
    pub factor: f32,
    /// The other.
    pub varying: Varying,
}

/// Compiled graphs of a material, one for each question that is asked of it.
#[derive(Debug, Default)]
pub struct Programs {
    /// Alpha.
    pub opacity: Option<Program>,
    /// Emission; of an unlit material the base colour.
    pub emission: Option<Program>,
    /// What scatters.
    pub surface: Option<Program>,
    /// The shading normal, world space.
    pub normal: Option<Program>,
    /// Baked occlusion.
    pub occlusion: Option<Program>,
}

impl Programs {
    /// True where there is one at all.
    pub fn any(&self) -> bool {
        [&self.opacity, &self.emission, &self.surface, &self.normal, &self.occlusion].iter().any(|p| p.is_some())
    }
}

/// A tangent-space normal map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalInput {
    /// The map.
    pub input: TextureRef,
    /// Factor of its x and y.
    pub scale: f32,
}

/// How a surface lets light pass unscattered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Opacity {
    /// Not at all.
    Opaque,
    /// Wholly where alpha is below the cut-off.
    Mask(f32),
    /// By `1 − alpha`.
    Blend,
}

impl Opacity {
    /// Share of a surface that is there where its alpha is `alpha`.
    pub fn of(self, alpha: f32) -> f32 {
        match self {
            Self::Opaque => 1.0,
            Self::Mask(cutoff) => f32::from(u8::from(alpha >= cutoff)),
            Self::Blend => alpha.clamp(0.0, 1.0),
        }
    }
}

/// A surface.
#[derive(Clone, Debug)]
pub struct Material {
    /// Every distinct texture that the material looks up, but for normal maps.
    pub inputs: Vec<TextureRef>,
    /// Diffuse albedo or metallic reflectance.
    pub base_color: ColorInput,
    /// Alpha.
    pub alpha: ScalarInput,
    /// How alpha is read.
    pub opacity: Opacity,
    /// 0 dielectric, 1 metal.
    pub metallic: ScalarInput,
    /// Perceptual roughness.
    pub roughness: ScalarInput,
    /// Index of refraction.
    pub ior: f32,
    /// Weight of the dielectric's reflection.
    pub specular: ScalarInput,
    /// Its tint.
    pub specular_color: ColorInput,
    /// Share of what enters that is refracted.
    pub transmission: ScalarInput,
    /// No inside: light passes straight on.
    pub thin: bool,
    /// Absorption of the inside per metre; black for none.
    pub absorption: Rgb,
    /// Emitted radiance.
    pub emission: ColorInput,
    /// True where nothing scatters and the base colour is emitted.
    pub unlit: bool,
    /// The camera sees a hole in the picture instead.
    pub holdout: bool,
    /// Normal map.
    pub normal: Option<NormalInput>,
    /// Baked occlusion; the factor is its strength.
    pub occlusion: Option<ScalarInput>,
    /// Where some input is a value of a graph.
    pub programs: Option<Arc<Programs>>,
}

/// What a program gives at a hit, where it was run.
type Values = Option<[Value; MOST_OUTPUTS]>;

/// A material's lookups at one point, each texture read at most once.
struct Lookups<'a> {
    scene: &'a Scene,
    material: &'a Material,
    it: &'a Interaction,
    last: Option<(u8, [f32; 4])>,
    /// Values of the program that answers for these inputs.
    values: &'a [Value],
}

impl Lookups<'_> {
    fn texel(&mut self, input: u8) -> [f32; 4] {
        if let Some((last, texel)) = self.last
            && last == input
        {
            return texel;
        }
        let texel = self.scene.look_up(self.material.inputs[usize::from(input)], self.it);
        self.last = Some((input, texel));
        texel
    }

    fn color(&mut self, input: &ColorInput) -> Rgb {
        match input.varying {
            Varying::No => input.factor,
            Varying::Texture(texture, _) => {
                let [r, g, b, _] = self.texel(texture);
                input.factor * Rgb::new(r, g, b)
            }
            Varying::Graph(value) => {
                let [r, g, b, _] = self.value(value);
                input.factor * rgb_of([r, g, b])
            }
        }
    }

    fn scalar(&mut self, input: &ScalarInput) -> f32 {
        match input.varying {
            Varying::No => input.factor,
            Varying::Texture(texture, channel) => input.factor * self.texel(texture)[usize::from(channel)],
            Varying::Graph(value) => input.factor * single(self.value(value)[0]),
        }
    }

    fn value(&self, value: u8) -> Value {
        self.values.get(usize::from(value)).copied().unwrap_or_default()
    }
}

/// Within what sums over pixels can bear.
pub(super) fn single(x: f64) -> f32 {
    x.clamp(-LARGEST, LARGEST) as f32
}

pub(super) fn rgb_of(rgb: [f64; 3]) -> Rgb {
    Rgb::from(rgb.map(single))
}

/// No value of a graph counts for more.
const LARGEST: f64 = 1e30;

impl Scene {
    /// The material at `it`.
    pub fn material(&self, it: &Interaction) -> &Material {
        &self.materials[it.material as usize]
    }

    /// The texture behind `input` at `it`; white where the shape lacks the UV set.
    pub(super) fn look_up(&self, input: TextureRef, it: &Interaction) -> [f32; 4] {
        let shape = self.shape(&self.instances[it.instance as usize]);
        let Some(uv) = shape.uv(input.uv_set, it.primitive, it.at) else { return [1.0; 4] };
        input.lookup(&self.textures, uv.to_array(), it.uv_footprint(shape, input.uv_set))
    }

    /// `it` as graphs see it.
    pub(super) fn spot<'a>(&'a self, it: &'a Interaction) -> Spot<'a> {
        let instance = &self.instances[it.instance as usize];
        let around = Around {
            shape: self.shape(instance),
            instance,
            index: it.instance,
            asked: &self.asked,
            textures: &self.textures,
            camera: &self.camera,
            origin: self.origin,
        };
        Spot { around, it }
    }

    /// `program` says which of the material's answers for the inputs that are looked up, `values` is where
    /// what it gives is kept.
    fn lookups<'a>(
        &'a self,
        it: &'a Interaction,
        program: fn(&Programs) -> Option<&Program>,
        values: &'a mut Values,
    ) -> Lookups<'a> {
        let material = self.material(it);
        let values = match &material.programs {
            None => &[],
            Some(programs) => self.run(it, program(programs), values),
        };
        Lookups { scene: self, material, it, last: None, values }
    }

    // Out of line, so that materials without graphs have no part in it.
    #[cold]
    fn run<'a>(&self, it: &Interaction, program: Option<&Program>, values: &'a mut Values) -> &'a [Value] {
        match program {
            Some(program) => values.insert(self.spot(it).run(program)),
            None => &[],
        }
    }

    fn vertex_color(&self, it: &Interaction) -> Option<[f32; 4]> {
        let instance = &self.instances[it.instance as usize];
        self.shape(instance).color(it.primitive, it.at).or(instance.color)
    }

    /// Share of light that the surface stops or scatters at `it`; the rest passes.
    pub fn opacity(&self, it: &Interaction) -> f32 {
        let material = self.material(it);
        let footprint = match material.opacity {
            Opacity::Opaque => return 1.0,
            // The threshold of a mean is not the mean of the thresholds: always the finest level.
            Opacity::Mask(_) => 0.0,
            Opacity::Blend => it.footprint,
        };
        let (it, mut values) = (&Interaction { footprint, ..*it }, None);
        let alpha = self.lookups(it, |programs| programs.opacity.as_ref(), &mut values).scalar(&material.alpha);
        material.opacity.of(alpha * self.vertex_color(it).map_or(1.0, |c| c[3]))
    }

    /// Radiance that the surface emits at `it`.
    pub fn emission(&self, it: &Interaction) -> Rgb {
        let material = self.material(it);
        let mut values = None;
        let mut lookups = self.lookups(it, |programs| programs.emission.as_ref(), &mut values);
        if !material.unlit {
            let le = lookups.color(&material.emission);
            return if material.programs.is_some() { le.map(|c| c.max(0.0)) } else { le };
        }
        let color = lookups.color(&material.base_color);
        self.vertex_color(it).map_or(color, |[r, g, b, _]| color * Rgb::new(r, g, b))
    }

    /// What scatters at `it`.
    pub fn surface(&self, it: &Interaction) -> Surface {
        let material = self.material(it);
        let mut values = None;
        let mut lookups = self.lookups(it, |programs| programs.surface.as_ref(), &mut values);
        let tint = self.vertex_color(it).map_or(Rgb::WHITE, |[r, g, b, _]| Rgb::new(r, g, b));
        Surface {
            base_color: (lookups.color(&material.base_color) * tint).map(|c| c.clamp(0.0, 1.0)),
            metallic: lookups.scalar(&material.metallic).clamp(0.0, 1.0),
            roughness: lookups.scalar(&material.roughness).clamp(0.0, 1.0),
            ior: material.ior,
            specular: lookups.scalar(&material.specular).clamp(0.0, 1.0),
            specular_color: lookups.color(&material.specular_color).map(|c| c.max(0.0)),
            transmission: lookups.scalar(&material.transmission).clamp(0.0, 1.0),
            thin: material.thin,
        }
    }

    /// Baked occlusion of bounced diffuse light at `it`; 1 for none.
    pub fn occlusion(&self, it: &Interaction) -> f32 {
        let Some(occlusion) = &self.material(it).occlusion else { return 1.0 };
        let mut values = None;
        let mut lookups = self.lookups(it, |programs| programs.occlusion.as_ref(), &mut values);
        let value = lookups.scalar(&ScalarInput { factor: 1.0, ..*occlusion });
        1.0 + occlusion.factor * (value - 1.0)
    }
}

impl Scene {
    /// True where the camera sees a hole in the picture instead of the surface.
    pub fn is_holdout(&self, it: &Interaction) -> bool {
        self.effects.holdouts && (self.instance(it.instance).holdout || self.material(it).holdout)
    }
}

impl Material {
    /// True where it is a light source.
    pub fn emits(&self) -> bool {
        !self.unlit && !self.emission.factor.is_black()
    }

    /// True where some light may pass it unscattered.
    pub fn is_cutout(&self) -> bool {
        self.opacity != Opacity::Opaque
    }
}
