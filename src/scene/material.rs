//! Materials as they are traced: constants, texture lookups and values of graphs, evaluated at a point.

use std::cell::Cell;
use std::sync::Arc;

use super::shading::Bends;
use super::spot::{Around, Spot, Values};
use super::{Interaction, Interior, Scene};
use crate::bsdf::Closure;
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
    /// Normals and tangents of single lobes, world space.
    pub bends: Option<Program>,
    /// Baked occlusion.
    pub occlusion: Option<Program>,
    /// AOVs.
    pub aovs: Option<Program>,
}

impl Programs {
    /// True where there is one at all.
    pub fn any(&self) -> bool {
        let Self { opacity, emission, surface, normal, bends, occlusion, aovs } = self;
        [opacity, emission, surface, normal, bends, occlusion, aovs].iter().any(|program| program.is_some())
    }
}

/// What a surface gives as an AOV.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AovInput {
    /// Nothing: 0.
    No,
    /// A color.
    Color(ColorInput),
    /// A number.
    Value(ScalarInput),
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

/// One term of what scatters.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its share.
    pub weight: ScalarInput,
    /// What it is.
    pub closure: Closure<ColorInput, ScalarInput>,
    /// The same where it is that everywhere.
    pub fixed: Option<Closure>,
    /// Normals and tangents of its own.
    pub bends: Option<Box<Bends>>,
}

/// A surface.
#[derive(Clone, Debug)]
pub struct Material {
    /// Every distinct texture that the material looks up, but for normal maps.
    pub inputs: Vec<TextureRef>,
    /// What scatters.
    pub parts: Vec<Part>,
    /// Alpha.
    pub alpha: ScalarInput,
    /// How alpha is read.
    pub opacity: Opacity,
    /// What passes unscattered on top of what the surface does; `None` for nothing.
    pub transparency: Option<ColorInput>,
    /// What fills the inside; `None` where there is none and light passes straight on.
    pub interior: Option<Interior>,
    /// Emitted radiance; of an unlit material its color.
    pub emission: ColorInput,
    /// True where nothing scatters and the emission is what is seen.
    pub unlit: bool,
    /// True where emission may be below 0.
    pub unbounded: bool,
    /// The normal of the whole is that of the surface itself.
    pub relief: bool,
    /// Colours of shapes and instances multiply the base colour and alpha.
    pub tinted: bool,
    /// The camera sees a hole in the picture instead.
    pub holdout: bool,
    /// Normal map.
    pub normal: Option<NormalInput>,
    /// True where diffuse light fades towards the smooth surface, as its normals or those of a part are bent from it.
    pub bumps: bool,
    /// True where interfaces lean so that they mirror what is above the geometry.
    pub upright: bool,
    /// Baked occlusion; the factor is its strength.
    pub occlusion: Option<ScalarInput>,
    /// What it gives as the AOVs of the render's passes, in their order; empty where it gives nothing.
    pub aovs: Box<[AovInput]>,
    /// Where some input is a value of a graph.
    pub programs: Option<Arc<Programs>>,
}

/// How much of a surface is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage {
    /// Factor of what it emits and scatters.
    pub opacity: f32,
    /// What passes unscattered.
    pub passes: Rgb,
    /// Probability with which paths stop at it.
    pub p_stop: f32,
}

impl Coverage {
    /// Nothing passes.
    pub const OPAQUE: Self = Self { opacity: 1.0, passes: Rgb::BLACK, p_stop: 1.0 };

    /// Its part of the picture's alpha.
    pub fn alpha(&self) -> f32 {
        1.0 - self.passes.mean().clamp(0.0, 1.0)
    }
}

/// A material's lookups at one point, each texture read at most once.
pub(super) struct Lookups<'a> {
    scene: &'a Scene,
    material: &'a Material,
    it: &'a Interaction,
    last: Cell<Option<(u8, [f32; 4])>>,
    /// Values of the program that answers for these inputs.
    values: &'a [Value],
}

impl Lookups<'_> {
    pub fn texel(&self, input: u8) -> [f32; 4] {
        if let Some((last, texel)) = self.last.get()
            && last == input
        {
            return texel;
        }
        let texel = self.scene.look_up(self.material.inputs[usize::from(input)], self.it);
        self.last.set(Some((input, texel)));
        texel
    }

    pub fn color(&self, input: &ColorInput) -> Rgb {
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

    pub fn scalar(&self, input: &ScalarInput) -> f32 {
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
            tinted: self.material(it).tinted,
        };
        Spot { around, it }
    }

    /// `program` says which of the material's answers for the inputs that are looked up, `values` is where
    /// what it gives is kept.
    pub(super) fn lookups<'a>(
        &'a self,
        it: &'a Interaction,
        program: fn(&Programs) -> Option<&Program>,
        values: &'a mut Option<Values>,
    ) -> Lookups<'a> {
        let material = self.material(it);
        let values = match &material.programs {
            None => &[],
            Some(programs) => self.run(it, program(programs), values),
        };
        Lookups { scene: self, material, it, last: Cell::new(None), values }
    }

    // Out of line, so that materials without graphs have no part in it.
    #[cold]
    pub(super) fn run<'a>(
        &self,
        it: &Interaction,
        program: Option<&Program>,
        values: &'a mut Option<Values>,
    ) -> &'a [Value] {
        match program {
            Some(program) => values.insert(self.spot(it).run(program)),
            None => &[],
        }
    }

    /// The colour that tints the surface at `it`.
    pub(super) fn vertex_color(&self, it: &Interaction) -> Option<[f32; 4]> {
        if !self.material(it).tinted {
            return None;
        }
        let instance = &self.instances[it.instance as usize];
        self.shape(instance).color(it.primitive, it.at).or(instance.color)
    }

    /// How much of the surface is there at `it`.
    pub fn coverage(&self, it: &Interaction) -> Coverage {
        let material = self.material(it);
        let footprint = match (material.opacity, &material.transparency) {
            (Opacity::Opaque, None) => return Coverage::OPAQUE,
            // The threshold of a mean is not the mean of the thresholds: always the finest level.
            (Opacity::Mask(_), _) => 0.0,
            _ => it.footprint,
        };
        let (it, mut values) = (&Interaction { footprint, ..*it }, None);
        let lookups = self.lookups(it, |programs| programs.opacity.as_ref(), &mut values);
        let opacity = match material.opacity {
            Opacity::Opaque => 1.0,
            by => by.of(lookups.scalar(&material.alpha) * self.vertex_color(it).map_or(1.0, |c| c[3])),
        };
        let Some(transparency) = &material.transparency else {
            return Coverage { opacity, passes: Rgb::splat(1.0 - opacity), p_stop: opacity };
        };
        let passes = lookups.color(transparency).map(|c| c.max(0.0)) * opacity + Rgb::splat(1.0 - opacity);
        let p_stop = (1.0 - passes.mean()).clamp(0.0, 1.0);
        // What is added to something that lets all light pass is still there.
        let p_stop = match material.scatters() {
            true if p_stop == 0.0 && opacity > 0.0 => 0.5,
            true => p_stop,
            false if passes.is_black() => 1.0,
            false => 0.0,
        };
        Coverage { opacity, passes, p_stop }
    }

    /// Share of the surface that is there at `it`; see [`Coverage::alpha`].
    pub fn alpha(&self, it: &Interaction) -> f32 {
        self.coverage(it).alpha()
    }

    /// Radiance that the surface emits at `it`.
    pub fn emission(&self, it: &Interaction) -> Rgb {
        let material = self.material(it);
        let mut values = None;
        let lookups = self.lookups(it, |programs| programs.emission.as_ref(), &mut values);
        let mut le = lookups.color(&material.emission);
        if self.effects.shaped_emission
            && !material.unlit
            && let Some(profile) = &self.instances[it.instance as usize].profile
        {
            le *= profile.factor(it.wo, 1.0);
        }
        match self.vertex_color(it) {
            Some([r, g, b, _]) if material.unlit => le * Rgb::new(r, g, b),
            _ if material.programs.is_some() && !material.unbounded => le.map(|c| c.max(0.0)),
            _ => le,
        }
    }

    /// Baked occlusion of bounced diffuse light at `it`; 1 for none.
    pub fn occlusion(&self, it: &Interaction) -> f32 {
        let Some(occlusion) = &self.material(it).occlusion else { return 1.0 };
        let mut values = None;
        let lookups = self.lookups(it, |programs| programs.occlusion.as_ref(), &mut values);
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
        self.opacity != Opacity::Opaque || self.transparency.is_some()
    }

    /// True where its inside absorbs light.
    pub fn absorbs(&self) -> bool {
        self.interior.is_some_and(|interior| !interior.sigma.is_black())
    }

    /// True where light may go beneath it and come out elsewhere.
    pub fn has_inside(&self) -> bool {
        self.parts.iter().any(|part| match &part.closure {
            Closure::Layered(surface) => surface.subsurface.is_some(),
            closure => matches!(closure, Closure::Beneath { .. }),
        })
    }

    /// True where some part of it scatters.
    fn scatters(&self) -> bool {
        !self.parts.is_empty()
    }
}
