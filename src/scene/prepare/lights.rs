//! Lamps, the world and emissive meshes as emitters in render space.

use std::sync::Arc;

use super::geometry::Geometry;
use crate::desc::{ImageDesc, LightDesc, LightKind, SceneDesc, WorldDesc};
use crate::error::Warnings;
use crate::light::{Distant, Dome, DomeImage, Emission, EmissiveTriangle, Light, MeshLight, Point, Spot};
use crate::math::{DVec3, Rgb, Vec3, gamma};
use crate::scene::Material;
use crate::scene::material::ColorInput;
use crate::shape::Mesh;
use crate::texture::{Texture, TextureRef};

/// Every emitter of the scene; instances learn which light they are.
pub fn prepare(
    desc: &SceneDesc,
    world: Option<&WorldDesc>,
    origin: DVec3,
    geometry: &mut Geometry,
    materials: &[Material],
    textures: &Arc<Vec<Texture>>,
    warnings: &mut Warnings,
) -> Vec<Light> {
    let mut lights: Vec<Light> = desc.lights.iter().filter_map(|light| lamp(light, origin, warnings)).collect();
    lights.extend(world.and_then(|world| dome(world, desc, warnings)).map(Light::from));
    for instance in &mut geometry.instances {
        let mesh = &geometry.meshes[instance.mesh as usize];
        if let Some(light) = mesh_light(instance, mesh, materials, textures) {
            instance.light = Some(lights.len() as u32);
            lights.push(light.into());
        }
    }
    lights
}

fn lamp(desc: &LightDesc, origin: DVec3, warnings: &mut Warnings) -> Option<Light> {
    let finite = |rgb: &[f64; 3]| rgb.iter().all(|v| (*v as f32).is_finite() && *v >= 0.0);
    let (color, range) = match desc.kind {
        LightKind::Point { intensity, range } | LightKind::Spot { intensity, range, .. } => (intensity, range),
        LightKind::Distant { irradiance, .. } => (irradiance, f64::INFINITY),
    };
    if !desc.transform.is_finite() || !finite(&color) || range.is_nan() {
        warnings.push(&desc.place, "light with a negative or non-finite intensity or transform: left out");
        return None;
    }
    if color == [0.0; 3] {
        return None;
    }
    let point = |intensity: [f64; 3]| Point {
        p: (desc.transform.translation - origin).as_vec3(),
        intensity: Rgb::from(intensity),
        range: if range > 0.0 { range as f32 } else { f32::INFINITY },
    };
    let axis = (-desc.transform.matrix3.z_axis).normalize_or(DVec3::NEG_Z).as_vec3();
    Some(match desc.kind {
        LightKind::Point { intensity, .. } => point(intensity).into(),
        LightKind::Spot { intensity, inner, outer, .. } => {
            let outer = outer.clamp(0.0, std::f64::consts::PI);
            let inner = inner.clamp(0.0, outer);
            let (cos_inner, cos_outer) = (inner.cos() as f32, outer.cos() as f32);
            Spot { point: point(intensity), axis, cos_inner, cos_outer }.into()
        }
        LightKind::Distant { irradiance, angle } => Distant::new(-axis, angle as f32, Rgb::from(irradiance)).into(),
    })
}

fn dome(world: &WorldDesc, desc: &SceneDesc, warnings: &mut Warnings) -> Option<Dome> {
    let radiance = Rgb::from(world.radiance);
    if !radiance.is_finite() || world.radiance.iter().any(|&v| v < 0.0) {
        warnings.push(&world.place, "world with a negative or non-finite radiance: left out");
        return None;
    }
    if radiance.is_black() {
        return None;
    }
    let Some(image) = world.image else { return Some(Dome::new(radiance, None)) };
    let texels = radiance_texels(&desc.images[image.image as usize], warnings);
    let source = &desc.images[image.image as usize];
    let image = DomeImage::new(source.width as usize, source.height as usize, texels, image.rotation);
    if image.is_none() {
        warnings.push(&world.place, "the environment image is black: it lights nothing");
    }
    image.map(|image| Dome::new(radiance, Some(image)))
}

/// The texels of an environment image as linear radiance; what can't be radiance becomes 0.
fn radiance_texels(image: &ImageDesc, warnings: &mut Warnings) -> Vec<Rgb> {
    let channels = usize::from(image.channels);
    let linear = |v: f32| match image.color_space {
        crate::desc::ColorSpace::Srgb => crate::texture::srgb_to_linear(v),
        crate::desc::ColorSpace::Linear => v,
    };
    let mut bad = 0_usize;
    let texels = (0..image.width as usize * image.height as usize)
        .map(|i| {
            let at = |c: usize| linear(image.pixels.get(i * channels + if channels < 3 { 0 } else { c }));
            let rgb = Rgb::new(at(0), at(1), at(2));
            let clean = rgb.map(|v| if v.is_finite() && v >= 0.0 { v } else { 0.0 });
            bad += usize::from(clean != rgb);
            clean
        })
        .collect();
    if bad > 0 {
        warnings.push(
            &image.place,
            format!("{bad} pixels of image \"{}\" are negative, infinite or NaN: taken as 0", image.name),
        );
    }
    texels
}

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

fn mesh_light(
    instance: &crate::scene::Instance,
    mesh: &Arc<Mesh>,
    materials: &[Material],
    textures: &Arc<Vec<Texture>>,
) -> Option<MeshLight> {
    if !instance.materials.iter().any(|&m| materials[m as usize].emits()) {
        return None;
    }
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
