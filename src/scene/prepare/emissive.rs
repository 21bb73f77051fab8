//! Emissive meshes as lights.

use std::sync::Arc;

use crate::light::{Emission, EmissiveTriangle, MeshLight};
use crate::math::{Rgb, Vec3, gamma};
use crate::scene::material::ColorInput;
use crate::scene::{Instance, Material};
use crate::shape::Mesh;
use crate::texture::{Texture, TextureRef};

/// Emitted radiance of a mesh whose emission is a texture.
#[derive(Debug)]
struct TexturedEmission {
    mesh: Arc<Mesh>,
    textures: Arc<Vec<Texture>>,
    /// By material slot.
    slots: Vec<(Rgb, Option<TextureRef>)>,
}

impl TexturedEmission {
    fn slot(&self, triangle: u32) -> (Rgb, Option<TextureRef>) {
        self.slots[self.mesh.slot(triangle).min(self.slots.len() - 1)]
    }

    fn look_up(&self, triangle: u32, barycentrics: [f32; 2], footprint: f32) -> Rgb {
        let (factor, input) = self.slot(triangle);
        let Some(input) = input else { return factor };
        let Some(uv) = self.mesh.uv(input.uv_set, triangle, barycentrics) else { return factor };
        let [r, g, b, _] = input.lookup(&self.textures, uv.to_array(), footprint);
        factor * Rgb::new(r, g, b)
    }

    /// Mean over the triangle: the mip level that its size in UV calls for, and a little of the
    /// brightest corner so that a triangle with any light in it is chosen now and then.
    fn mean(&self, triangle: u32) -> Rgb {
        let (_, Some(input)) = self.slot(triangle) else { return self.slot(triangle).0 };
        let footprint = (0.5 * self.mesh.uv_area(input.uv_set, triangle)).sqrt();
        let third = 1.0 / 3.0;
        let mean = self.look_up(triangle, [third, third], footprint);
        let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5], [0.5, 0.0], [0.0, 0.5]];
        let around: Rgb = points.iter().map(|&uv| self.look_up(triangle, uv, 0.5 * footprint)).sum();
        mean * 0.7 + around * (0.3 / points.len() as f32)
    }
}

impl Emission for TexturedEmission {
    fn radiance(&self, triangle: u32, uv: [f32; 2]) -> Rgb {
        self.look_up(triangle, uv, 0.0)
    }
}

/// The light that the emissive triangles of `instance` form; `None` where it has none.
pub fn prepare(
    instance: &Instance,
    mesh: &Arc<Mesh>,
    materials: &[Material],
    textures: &Arc<Vec<Texture>>,
) -> Option<MeshLight> {
    let slot = |material: &u32| {
        let material = &materials[*material as usize];
        let ColorInput { factor, texture } = material.emission;
        // Light from a surface that is partly open is found by the paths that hit it.
        let factor = if material.emits() && !material.is_cutout() { factor } else { Rgb::BLACK };
        (factor, texture.map(|i| material.inputs[usize::from(i)]))
    };
    let emission = TexturedEmission {
        mesh: mesh.clone(),
        textures: textures.clone(),
        slots: instance.materials.iter().map(slot).collect(),
    };
    let triangles: Vec<EmissiveTriangle> = (0..mesh.triangles.len() as u32)
        .filter_map(|index| {
            // Blending the corners rounds as `Mesh::point` does.
            let corners = mesh.corners(index).map(|p| instance.point(p, p.abs() * gamma(7)));
            let p_err = corners.into_iter().fold(Vec3::ZERO, |largest, (_, p_err)| largest.max(p_err));
            let (p, mean) = (corners.map(|(p, _)| p), emission.mean(index));
            (!mean.is_black() && mean.is_finite()).then_some(EmissiveTriangle { p, mean, p_err, index })
        })
        .collect();
    let varies = emission.slots.iter().any(|(_, texture)| texture.is_some());
    let emission = varies.then(|| Arc::new(emission) as Arc<dyn Emission>);
    MeshLight::new(triangles, mesh.triangles.len(), emission)
}
