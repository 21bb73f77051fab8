//! Thin films as the versions of Blender have them.

use penumbra::bsdf::{Bsdf, Surface, ThinFilm};
use penumbra::error::Warnings;
use penumbra::import::blender::BlenderScene;
use penumbra::math::Vec3;
use serde_json::{Value, json};

/// Up to 4.5 the Principled BSDF's film is one of its dielectric alone.
#[test]
fn films_are_on_metal_from_5_on() {
    let value = |name: &str, value: f64| -> Value {
        json!({"id": name, "name": name, "type": "VALUE", "enabled": true, "value": value})
    };
    let inputs = [value("Metallic", 0.5), value("Thin Film Thickness", 400.0), value("Thin Film IOR", 1.6)];
    let nodes = json!({"nodes": [
        {"name": "P", "type": "ShaderNodeBsdfPrincipled", "inputs": inputs,
         "outputs": [{"id": "BSDF", "name": "BSDF", "type": "SHADER", "enabled": true}]},
        {"name": "O", "type": "ShaderNodeOutputMaterial", "properties": {"is_active_output": true}, "outputs": [],
         "inputs": [{"id": "Surface", "name": "Surface", "type": "SHADER", "enabled": true, "link": [0, 0]}]},
    ]});
    for (version, on_metal) in [([4, 2, 0], false), ([4, 5, 3], false), ([5, 0, 1], true)] {
        let mut scene = BlenderScene::default();
        scene.set_document(&json!({"version": version}).to_string()).unwrap();
        scene.set_material(1, &json!({"name": "M", "nodes": nodes}).to_string()).unwrap();
        scene.set_materials(&[1]).unwrap();
        let desc = scene.scene(&mut Warnings::new()).unwrap();
        let film = desc.materials[0].iridescence.unwrap();
        assert_eq!((film.on_metal, film.ior.factor), (on_metal, 1.6), "{version:?}");
    }
}

/// A film that is not on metal leaves it as it is, and a dielectric as it was.
#[test]
fn metal_without_its_film_is_metal() {
    let seen = |surface: &Surface| Bsdf::new(surface, Vec3::Z, true).albedo().sum().to_array();
    let film = |on_metal| Some(ThinFilm { thickness: 400.0, ior: 1.6, weight: 1.0, on_metal });
    for (metallic, roughness) in [(1.0, 0.0), (1.0, 0.5), (0.0, 0.5)] {
        let plain = Surface { metallic, roughness, base_color: penumbra::math::Rgb::splat(0.7), ..Surface::default() };
        let [with, without] = [true, false].map(|on_metal| seen(&Surface { film: film(on_metal), ..plain }));
        assert_eq!(without == seen(&plain), metallic == 1.0);
        assert_eq!(without == with, metallic == 0.0);
    }
}
