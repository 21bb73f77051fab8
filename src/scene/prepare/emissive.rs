//! Emissive meshes as lights.

use std::collections::HashMap;
use std::sync::Arc;

use crate::light::{Emission, MeshEmitters, MeshLight};
use crate::math::Rgb;
use crate::scene::material::ColorInput;
use crate::scene::{Instance, Material};
use crate::shape::Mesh;
use crate::texture::{Texture, TextureRef};

/// Share of the mean of a whole texture that every triangle with it counts for at least: what the few
/// points of its own mean have missed is still found now and then.
const OF_TEXTURE: f32 = 1e-4;

/// What the mean of a texture with any light counts for at least: coarse levels of eight bits lose it.
const LEAST_MEAN: f32 = 1e-3;

/// Emitted radiance of a mesh.
#[derive(Debug)]
struct MaterialEmission {
    mesh: Arc<Mesh>,
    textures: Arc<Vec<Texture>>,
    /// By material slot.
    slots: Box<[Slot]>,
}

/// Emission of a material.
#[derive(Clone, Copy, Debug)]
struct Slot {
    factor: Rgb,
    texture: Option<TextureRef>,
    /// Least mean radiance of a triangle.
    least: Rgb,
}

impl MaterialEmission {
    fn slot(&self, triangle: u32) -> Slot {
        self.slots[self.mesh.slot(triangle).min(self.slots.len() - 1)]
    }

    fn look_up(&self, triangle: u32, barycentrics: [f32; 2], footprint: f32) -> Rgb {
        let Slot { factor, texture, .. } = self.slot(triangle);
        let Some(input) = texture else { return factor };
        let Some(uv) = self.mesh.uv(input.uv_set, triangle, barycentrics) else { return factor };
        let [r, g, b, _] = input.lookup(&self.textures, uv.to_array(), footprint);
        factor * Rgb::new(r, g, b)
    }
}

impl Emission for MaterialEmission {
    fn radiance(&self, triangle: u32, uv: [f32; 2]) -> Rgb {
        self.look_up(triangle, uv, 0.0)
    }

    /// The mip level that the triangle's size in UV calls for, and points around it.
    fn mean(&self, triangle: u32) -> Rgb {
        let Slot { factor, texture, least } = self.slot(triangle);
        let Some(input) = texture else { return factor };
        if least.is_black() {
            return least;
        }
        let footprint = (0.5 * self.mesh.uv_area(input.uv_set, triangle)).sqrt();
        let third = 1.0 / 3.0;
        let mean = self.look_up(triangle, [third, third], footprint);
        let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5], [0.5, 0.0], [0.0, 0.5]];
        let around: Rgb = points.iter().map(|&uv| self.look_up(triangle, uv, 0.5 * footprint)).sum();
        mean * 0.7 + around * (0.3 / points.len() as f32) + least
    }
}

/// The emitters of a mesh under a list of materials; `None` where nothing is emitted.
type Known = HashMap<(u32, Box<[u32]>), Option<Arc<MeshEmitters>>>;

/// Emissive meshes as lights, one by one: instances of the same mesh with the same materials share
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

    /// The light that the emissive triangles of `instance` form; `None` where it has none.
    pub fn light(&mut self, instance: &Instance, mesh: &Arc<Mesh>) -> Option<MeshLight> {
        let (materials, textures) = (self.materials, self.textures);
        let emitters = self.known.entry((instance.mesh, instance.materials.clone())).or_insert_with(|| {
            let slots = instance.materials.iter().map(|&m| slot(&materials[m as usize], textures)).collect();
            let emission = MaterialEmission { mesh: mesh.clone(), textures: textures.clone(), slots };
            MeshEmitters::new(mesh.clone(), Arc::new(emission)).map(Arc::new)
        });
        MeshLight::new(emitters.clone()?, instance.object_to_render)
    }
}

fn slot(material: &Material, textures: &[Texture]) -> Slot {
    let ColorInput { factor, texture } = material.emission;
    // Light from a surface that is partly open is found by the paths that hit it.
    let factor = if material.emits() && !material.is_cutout() { factor } else { Rgb::BLACK };
    let texture = texture.map(|i| material.inputs[usize::from(i)]);
    let whole = texture.map_or(Rgb::BLACK, |input| mean_of(&textures[input.texture as usize]));
    Slot { factor, texture, least: factor * whole * OF_TEXTURE }
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
