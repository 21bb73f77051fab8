//! Emissive shapes as lights.

use std::collections::HashMap;
use std::sync::Arc;

use crate::light::{AnyEmitter, Emission, MeshEmitters, MeshLight, RoundEmitters, RoundLight};
use crate::math::Rgb;
use crate::scene::material::Opacity;
use crate::scene::{Instance, Material};
use crate::shape::Shape;
use crate::texture::{Texture, TextureRef};

/// Share of the mean of a whole texture that every triangle with it counts for at least: what the few
/// points of its own mean have missed is still found now and then.
const OF_TEXTURE: f32 = 1e-4;

/// What the mean of a texture with any light counts for at least: coarse levels of eight bits lose it.
const LEAST_MEAN: f32 = 1e-3;

/// Emitted radiance of a shape: of a surface that is partly open what its rays get on the mean.
#[derive(Debug)]
struct MaterialEmission {
    shape: Shape,
    textures: Arc<Vec<Texture>>,
    /// By material slot.
    slots: Box<[Slot]>,
    /// Of the instance's colour, where the mesh has none.
    alpha: f32,
}

/// Emission of a material.
#[derive(Clone, Copy, Debug)]
struct Slot {
    factor: Rgb,
    texture: Option<TextureRef>,
    opacity: Opacity,
    alpha: f32,
    /// Times this channel.
    alpha_texture: Option<(TextureRef, u8)>,
    /// Least mean radiance of a triangle whose emission varies.
    least: Rgb,
}

impl MaterialEmission {
    fn slot(&self, triangle: u32) -> &Slot {
        &self.slots[self.shape.slot(triangle).min(self.slots.len() - 1)]
    }

    /// The texture behind `input`, averaged over `share` of the width of the triangle.
    fn look_up(&self, input: TextureRef, triangle: u32, barycentrics: [f32; 2], share: f32) -> [f32; 4] {
        let Some(uv) = self.shape.uv(input.uv_set, triangle, barycentrics) else { return [1.0; 4] };
        let width = if share > 0.0 { (0.5 * self.shape.uv_size(input.uv_set, triangle)).sqrt() } else { 0.0 };
        input.lookup(&self.textures, uv.to_array(), share * width)
    }

    fn emitted(&self, triangle: u32, barycentrics: [f32; 2], share: f32) -> Rgb {
        let Slot { factor, texture, .. } = *self.slot(triangle);
        let Some(input) = texture else { return factor };
        let [r, g, b, _] = self.look_up(input, triangle, barycentrics, share);
        factor * Rgb::new(r, g, b)
    }

    fn alpha(&self, triangle: u32, barycentrics: [f32; 2], share: f32) -> f32 {
        let Slot { alpha, alpha_texture, .. } = *self.slot(triangle);
        let texel = alpha_texture
            .map_or(1.0, |(input, channel)| self.look_up(input, triangle, barycentrics, share)[usize::from(channel)]);
        alpha * texel * self.shape.color(triangle, barycentrics).map_or(self.alpha, |color| color[3])
    }

    fn is_constant(&self, triangle: u32) -> bool {
        let Slot { texture, opacity, alpha_texture, .. } = self.slot(triangle);
        let is_evenly_open = alpha_texture.is_none() && !self.shape.has_colors();
        texture.is_none() && (*opacity == Opacity::Opaque || is_evenly_open)
    }
}

impl Emission for MaterialEmission {
    fn radiance(&self, triangle: u32, uv: [f32; 2]) -> Rgb {
        let emitted = self.emitted(triangle, uv, 0.0);
        match self.slot(triangle).opacity {
            Opacity::Opaque => emitted,
            opacity => emitted * opacity.of(self.alpha(triangle, uv, 0.0)),
        }
    }

    /// The mip level that the triangle's size in UV calls for, and points around it. Seen from so far a
    /// mask is as open as a blend of its alpha.
    fn mean(&self, triangle: u32) -> Rgb {
        let third = 1.0 / 3.0;
        let &Slot { opacity, least, .. } = self.slot(triangle);
        if self.is_constant(triangle) {
            return self.radiance(triangle, [third, third]);
        }
        if least.is_black() {
            return least;
        }
        let at = |uv: [f32; 2], share: f32| match opacity {
            Opacity::Opaque => self.emitted(triangle, uv, share),
            _ => self.emitted(triangle, uv, share) * self.alpha(triangle, uv, share).clamp(0.0, 1.0),
        };
        let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5], [0.5, 0.0], [0.0, 0.5]];
        let around: Rgb = points.iter().map(|&uv| at(uv, 0.5)).sum();
        at([third, third], 1.0) * 0.7 + around * (0.3 / points.len() as f32) + least
    }
}

/// The emitters of a shape.
#[derive(Clone)]
enum Emitters {
    Mesh(Arc<MeshEmitters>),
    Rounds(Arc<RoundEmitters>),
}

/// The emitters of a shape under a list of materials and the bits of an alpha; `None` where nothing is emitted.
type Known = HashMap<(u32, Box<[u32]>, u32), Option<Emitters>>;

/// Emissive shapes as lights, one by one: instances of the same shape with the same materials share
/// their emitters.
pub struct Emissive<'a> {
    materials: &'a [Material],
    textures: &'a Arc<Vec<Texture>>,
    known: Known,
}

impl<'a> Emissive<'a> {
    /// For instances with `materials`, textured by `textures`.
    pub fn new(materials: &'a [Material], textures: &'a Arc<Vec<Texture>>) -> Self {
        Self { materials, textures, known: HashMap::new() }
    }

    /// The light that the emissive primitives of `instance` form; `None` where it has none.
    pub fn light(&mut self, instance: &Instance, shape: &Shape) -> Option<AnyEmitter> {
        let (materials, textures) = (self.materials, self.textures);
        let alpha = instance.color.map_or(1.0, |color| color[3]);
        let key = (instance.shape, instance.materials.clone(), alpha.to_bits());
        let emitters = self.known.entry(key).or_insert_with(|| {
            let slots = instance.materials.iter().map(|&m| slot(&materials[m as usize], textures)).collect();
            let emission =
                Arc::new(MaterialEmission { shape: shape.clone(), textures: textures.clone(), slots, alpha });
            match shape {
                Shape::Mesh(mesh) => MeshEmitters::new(mesh.clone(), emission).map(|e| Emitters::Mesh(Arc::new(e))),
                Shape::Rounds(rounds) => {
                    RoundEmitters::new(rounds.clone(), emission).map(|e| Emitters::Rounds(Arc::new(e)))
                }
            }
        });
        match emitters.clone()? {
            Emitters::Mesh(emitters) => MeshLight::new(emitters, instance.object_to_render).map(AnyEmitter::from),
            Emitters::Rounds(emitters) => RoundLight::new(emitters, instance.object_to_render).map(AnyEmitter::from),
        }
    }
}

fn slot(material: &Material, textures: &[Texture]) -> Slot {
    let factor = if material.emits() { material.emission.factor } else { Rgb::BLACK };
    let input = |i: u8| material.inputs[usize::from(i)];
    let texture = material.emission.texture.map(input);
    let whole = texture.map_or(Rgb::WHITE, |input| mean_of(&textures[input.texture as usize]));
    Slot {
        factor,
        texture,
        opacity: material.opacity,
        alpha: material.alpha.factor,
        alpha_texture: material.alpha.texture.map(|(i, channel)| (input(i), channel)),
        least: factor * whole * OF_TEXTURE,
    }
}

/// Mean of a texture, above 0 unless it is black all over.
fn mean_of(texture: &Texture) -> Rgb {
    let image = texture.image();
    let color = |[r, g, b, _]: [f32; 4]| Rgb::new(r, g, b);
    let mut texels = (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y)));
    if !texels.any(|(x, y)| !color(image.texel(x, y)).is_black()) {
        return Rgb::BLACK;
    }
    color(image.level_texel(image.level_count() - 1, 0, 0)).map(|v| v.max(LEAST_MEAN))
}
