//! The world, as domes.

use super::document::WorldData;
use super::image::Images;
use super::nodes;
use crate::desc::{DomeShader, LightDesc, LightKind, LightLinks, SceneDesc, Visibility};
use crate::error::Warnings;
use crate::math::{DAffine3, DMat3, DVec3};

/// What some kinds of rays see of a world.
#[derive(Clone, Debug)]
pub struct WorldPart {
    /// What it emits.
    pub emission: WorldEmission,
    /// Which rays see it.
    pub seen: Seen,
}

/// Kinds of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen {
    /// From the camera.
    pub camera: bool,
    /// From diffuse lobes.
    pub diffuse: bool,
    /// From glossy lobes.
    pub glossy: bool,
    /// Through surfaces.
    pub transmission: bool,
}

/// What a world emits.
#[derive(Clone, Debug)]
pub enum WorldEmission {
    /// The same from everywhere.
    Constant([f64; 3]),
    /// A lat-long image.
    Image {
        /// Its factor.
        factor: [f64; 3],
        /// Index into `SceneDesc::images`.
        image: u32,
        /// From the direction of a ray to the coordinates that the image is looked up at.
        turn: DMat3,
    },
    /// By a graph.
    Graph(DomeShader),
}

impl Seen {
    /// By every ray.
    pub const ALL: Self = Self { camera: true, diffuse: true, glossy: true, transmission: true };
}

/// Adds the domes and suns that `data` is; none for a black world.
pub fn add(data: &WorldData, images: &mut Images<'_>, desc: &mut SceneDesc, warnings: &mut Warnings) {
    let place = desc.place.at(&data.name);
    let parts = match &data.nodes {
        Some(tree) => nodes::world(tree, images, place.clone(), warnings),
        None => vec![WorldPart { emission: WorldEmission::Constant(data.color), seen: Seen::ALL }],
    };
    // A dome's space has y up and the image's centre at +x; Blender's has z up.
    let upright = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y);
    for WorldPart { emission, seen } in parts {
        let (kind, turn) = match emission {
            WorldEmission::Constant(radiance) => (LightKind::Dome { radiance, image: None }, upright),
            WorldEmission::Image { factor, image, turn } => {
                (LightKind::Dome { radiance: factor, image: Some(image) }, turn.transpose() * upright)
            }
            WorldEmission::Graph(shader) => {
                desc.dome_shaders.push(shader);
                (LightKind::ShadedDome { shader: desc.dome_shaders.len() as u32 - 1 }, upright)
            }
        };
        if kind.color() == [0.0; 3] {
            continue;
        }
        let mut light = LightDesc::new(data.name.as_str(), place.clone(), DAffine3::from_mat3(turn), kind);
        let of_world: Visibility = data.visibility.into();
        light.visibility = Visibility {
            camera: of_world.camera && seen.camera,
            diffuse: of_world.diffuse && seen.diffuse,
            glossy: of_world.glossy && seen.glossy,
            transmission: of_world.transmission && seen.transmission,
            ..of_world
        };
        light.links = LightLinks {
            group: (!data.lightgroup.is_empty()).then(|| data.lightgroup.as_str().into()),
            ..LightLinks::default()
        };
        desc.lights.push(light);
    }
}
