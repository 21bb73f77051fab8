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
    if let Some(tree) = data.nodes.as_ref().filter(|_| Visibility::from(data.visibility).camera) {
        desc.background_aovs = nodes::background_aovs(tree, images, place.clone(), warnings);
    }
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

#[cfg(test)]
mod tests {
    use super::super::BlenderScene;
    use super::*;
    use serde_json::{Value, json};

    /// A node whose inputs are (name, type, value or link).
    fn node(kind: &str, inputs: &[(&str, &str, Value)], properties: Value) -> Value {
        let input = |(name, of, value): &(&str, &str, Value)| match value.get("link") {
            Some(link) => json!({"id": name, "name": name, "type": of, "enabled": true, "link": link}),
            None => json!({"id": name, "name": name, "type": of, "enabled": true, "value": value}),
        };
        let outputs = match kind {
            "ShaderNodeLightPath" => json!([{"id": "Is Camera Ray", "type": "VALUE"}]),
            "ShaderNodeTexSky" | "ShaderNodeTexNoise" => json!([{"id": "Color", "type": "RGBA"}]),
            _ => json!([{"id": "Background", "type": "SHADER"}]),
        };
        let inputs: Vec<Value> = inputs.iter().map(input).collect();
        json!({"name": kind, "type": kind, "inputs": inputs, "outputs": outputs, "properties": properties})
    }

    fn world(nodes: &[Value]) -> (SceneDesc, Warnings) {
        let mut scene = BlenderScene::default();
        let document = json!({"version": [5, 0, 1], "world": {"name": "World", "nodes": {"nodes": nodes}}});
        scene.set_document(&document.to_string()).unwrap();
        let mut warnings = Warnings::new();
        let desc = scene.scene(&mut warnings).unwrap();
        (desc, warnings)
    }

    fn background(color: Value, strength: f64) -> Value {
        node("ShaderNodeBackground", &[("Color", "RGBA", color), ("Strength", "VALUE", json!(strength))], json!({}))
    }

    fn output() -> Value {
        node("ShaderNodeOutputWorld", &[("Surface", "SHADER", json!({"link": [1, 0]}))], json!({}))
    }

    #[test]
    fn the_camera_sees_one_background_and_all_else_another() {
        let mix = [
            ("Fac", "VALUE", json!({"link": [2, 0]})),
            ("Shader", "SHADER", json!({"link": [3, 0]})),
            ("Shader_001", "SHADER", json!({"link": [4, 0]})),
        ];
        let nodes = [
            output(),
            node("ShaderNodeMixShader", &mix, json!({})),
            node("ShaderNodeLightPath", &[], json!({})),
            background(json!([0.5, 0.25, 0.0, 1.0]), 2.0),
            background(json!([0.0, 0.0, 1.0, 1.0]), 1.0),
        ];
        let (desc, warnings) = world(&nodes);
        assert!(warnings.is_empty());
        let [seen, lit] = &desc.lights[..] else { panic!("{:?}", desc.lights) };
        assert_eq!((seen.kind.color(), lit.kind.color()), ([0.0, 0.0, 1.0], [1.0, 0.5, 0.0]));
        let rays = |v: Visibility| [v.camera, v.diffuse, v.glossy, v.transmission];
        assert_eq!(rays(seen.visibility), [true, false, false, false]);
        assert_eq!(rays(lit.visibility), [false, true, true, true]);
    }

    #[test]
    fn a_sky_is_a_graph_and_its_sun_stands_beside_it() {
        let sky = json!({"sky_type": "MULTIPLE_SCATTERING", "sun_disc": true, "sun_elevation": 0.4, "sun_size": 0.01});
        let nodes = [
            output(),
            background(json!({"link": [2, 0]}), 0.5),
            node("ShaderNodeTexSky", &[("Vector", "VECTOR", json!([0.0, 0.0, 0.0]))], sky),
        ];
        let (desc, warnings) = world(&nodes);
        assert!(warnings.is_empty());
        assert_eq!(desc.lights[0].kind, LightKind::ShadedDome { shader: 0 });
        let [sun] = &desc.dome_shaders[0].suns[..] else { panic!("{:?}", desc.dome_shaders) };
        assert_eq!(sun.atmosphere.sun_size, Some(0.01));
    }
}
