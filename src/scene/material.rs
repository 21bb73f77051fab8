//! Materials as they are traced: constants and texture lookups, evaluated at a point.

use super::{Interaction, Scene};
use crate::bsdf::Surface;
use crate::math::Rgb;
use crate::texture::TextureRef;

/// A colour: `factor × texture`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorInput {
    /// Constant part.
    pub factor: Rgb,
    /// Index into `Material::inputs`.
    pub texture: Option<u8>,
}

/// A number: `factor × texture[channel]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalarInput {
    /// Constant part.
    pub factor: f32,
    /// Index into `Material::inputs`, and the channel.
    pub texture: Option<(u8, u8)>,
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
    /// Normal map.
    pub normal: Option<NormalInput>,
    /// Baked occlusion; the factor is its strength.
    pub occlusion: Option<ScalarInput>,
}

/// A material's lookups at one point, each texture read at most once.
struct Lookups<'a> {
    scene: &'a Scene,
    material: &'a Material,
    it: &'a Interaction,
    last: Option<(u8, [f32; 4])>,
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
        match input.texture {
            None => input.factor,
            Some(texture) => {
                let [r, g, b, _] = self.texel(texture);
                input.factor * Rgb::new(r, g, b)
            }
        }
    }

    fn scalar(&mut self, input: &ScalarInput) -> f32 {
        match input.texture {
            None => input.factor,
            Some((texture, channel)) => input.factor * self.texel(texture)[usize::from(channel)],
        }
    }
}

impl Scene {
    /// The material at `it`.
    pub fn material(&self, it: &Interaction) -> &Material {
        &self.materials[it.material as usize]
    }

    /// The texture behind `input` at `it`; white where the shape lacks the UV set.
    pub(super) fn look_up(&self, input: TextureRef, it: &Interaction) -> [f32; 4] {
        let shape = self.shape(&self.instances[it.instance as usize]);
        let Some(uv) = shape.uv(input.uv_set, it.primitive, it.at) else { return [1.0; 4] };
        let uv_size = shape.uv_size(input.uv_set, it.primitive);
        let footprint = if it.size > 0.0 { it.footprint * (uv_size / it.size).sqrt() } else { 0.0 };
        input.lookup(&self.textures, uv.to_array(), footprint)
    }

    fn lookups<'a>(&'a self, it: &'a Interaction) -> Lookups<'a> {
        Lookups { scene: self, material: self.material(it), it, last: None }
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
        let alpha = self.lookups(&Interaction { footprint, ..*it }).scalar(&material.alpha);
        material.opacity.of(alpha * self.vertex_color(it).map_or(1.0, |c| c[3]))
    }

    /// Radiance that the surface emits at `it`.
    pub fn emission(&self, it: &Interaction) -> Rgb {
        let material = self.material(it);
        if material.unlit { self.base_color(it) } else { self.lookups(it).color(&material.emission) }
    }

    fn base_color(&self, it: &Interaction) -> Rgb {
        let color = self.lookups(it).color(&self.material(it).base_color);
        self.vertex_color(it).map_or(color, |[r, g, b, _]| color * Rgb::new(r, g, b))
    }

    /// What scatters at `it`.
    pub fn surface(&self, it: &Interaction) -> Surface {
        let material = self.material(it);
        let mut lookups = self.lookups(it);
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
        let value = self.lookups(it).scalar(&ScalarInput { factor: 1.0, ..*occlusion });
        1.0 + occlusion.factor * (value - 1.0)
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
