//! Files of other people: what is in them is known. They live beside the project
//! (`../shared/assets`, or `PENUMBRA_ASSETS`); without them these tests say so and pass.

use std::path::PathBuf;

use penumbra::desc::{AlphaMode, LightKind, SceneDesc, check};
use penumbra::error::Warnings;
use penumbra::import::{ImportOptions, scene};

/// Loads a file of the collection; `None` where there is no collection.
fn asset(path: &str, options: &ImportOptions) -> Option<SceneDesc> {
    let folder = std::env::var_os("PENUMBRA_ASSETS").map(PathBuf::from);
    let folder = folder.unwrap_or_else(|| [env!("CARGO_MANIFEST_DIR"), "..", "shared", "assets"].iter().collect());
    if !folder.is_dir() {
        eprintln!("skipped: no assets at {}", folder.display());
        return None;
    }
    let mut warnings = Warnings::new();
    let scene = scene(&folder.join("gltf").join(path), options, &mut warnings).unwrap();
    check(&scene).unwrap();
    // What Blender's own exporter loses is told, and nothing else.
    assert!(warnings.iter().all(|w| w.what.starts_with("was exported by Blender alone")), "{warnings:?}");
    Some(scene)
}

fn triangles(scene: &SceneDesc) -> usize {
    scene.instances.iter().map(|i| scene.mesh(i).unwrap().triangles.len()).sum()
}

#[test]
fn counts_of_every_file() {
    // Instances, triangles in all of them, materials, images, cameras, lights.
    for (path, expected) in [
        ("flight_helmet/FlightHelmet.gltf", [6, 94_722, 6, 15, 0, 0]),
        ("mixed_lighting/MixedLightingExample.gltf", [6, 40_898, 6, 5, 0, 1]),
        ("palm_tree/PalmTree.gltf", [10, 10_124, 4, 1, 0, 0]),
        ("teapots_galore/teapots_galore.gltf", [1900, 7_656_770, 2, 0, 1, 0]),
        ("chess/B_Bishop.glb", [1, 74_764, 1, 3, 0, 0]),
        ("chess/B_Pawn.glb", [2, 49_440, 2, 3, 0, 0]),
        ("blender-io-roundtrip/01_alpha_blend/01_alpha_blend.gltf", [2, 14, 2, 1, 0, 0]),
        ("blender-io-roundtrip/01_alpha_mask/01_alpha_mask.gltf", [1, 2, 1, 1, 0, 0]),
        ("blender-io-roundtrip/10_custom_normals/10_custom_normals.gltf", [2, 88, 1, 0, 0, 0]),
        ("blender-io-roundtrip/14_emission_strength/14_emission_strength.gltf", [18, 17_280, 18, 1, 0, 0]),
        ("blender-io-roundtrip/15_transmission/15_transmission.gltf", [5, 4800, 5, 1, 0, 0]),
        ("blender-io-roundtrip/16_volume/16_volume.gltf", [25, 296, 20, 3, 0, 0]),
        ("blender-io-roundtrip/17_ior/17_ior.gltf", [5, 60, 5, 0, 0, 0]),
        ("blender-io-roundtrip/24_animation_pointer/24_animation_pointer.gltf", [37, 13_986, 15, 7, 4, 4]),
    ] {
        let Some(s) = asset(path, &ImportOptions::default()) else { return };
        let found =
            [s.instances.len(), triangles(&s), s.materials.len(), s.images.len(), s.cameras.len(), s.lights.len()];
        assert_eq!(found, expected, "{path}");
    }
}

#[test]
fn values_of_the_roundtrip_files() {
    let load = |name: &str| asset(&format!("blender-io-roundtrip/{name}/{name}.gltf"), &ImportOptions::default());
    let Some(emission) = load("14_emission_strength") else { return };
    let named = |scene: &SceneDesc, name: &str| scene.materials.iter().find(|m| &*m.name == name).unwrap().clone();
    let m = named(&emission, "pbrEmissiveStrengthTexture");
    assert_eq!((m.emission.factor, m.emission_strength, m.emission.texture.is_some()), ([0.9, 0.8, 0.7], 5.0, true));
    let m = named(&emission, "SpecGloss");
    assert_eq!((m.metallic.factor, m.roughness.factor, m.specular_color.factor), (0.0, 1.0, [25.0; 3]));
    let m = named(&load("15_transmission").unwrap(), "transmissionFactorTexture");
    assert!(m.transmission.factor == 0.7 && m.transmission.texture.is_some());
    let volume = load("16_volume").unwrap();
    let v = named(&volume, "R5_Attenuation_1.5").volume.unwrap();
    assert_eq!((v.attenuation_color, v.attenuation_distance), ([0.1, 0.5, 0.9], 0.666_666_666_7));
    let v = named(&volume, "NoThickness").volume.unwrap();
    assert_eq!((v.thickness.factor, v.attenuation_distance), (0.0, f64::INFINITY));
    assert_eq!(named(&load("17_ior").unwrap(), "ior_1.45").ior.factor, 1.45);
    assert_eq!(load("01_alpha_mask").unwrap().materials[0].alpha_mode, AlphaMode::Mask { cutoff: 0.42 });
    assert_eq!(named(&load("01_alpha_blend").unwrap(), "Transparent_Plane").alpha_mode, AlphaMode::Blend);
}

#[test]
fn variants_and_the_sun_of_the_sheen_chair() {
    let path = "mixed_lighting/MixedLightingExample.gltf";
    let Some(plain) = asset(path, &ImportOptions::default()) else { return };
    assert_eq!(plain.variants, ["Mango Velvet", "Peacock Velvet"]);
    let LightKind::Distant { irradiance, .. } = plain.lights[0].kind else { panic!("a sun") };
    assert_eq!(irradiance, [3.0; 3]);
    let peacock = ImportOptions { variants: vec!["Peacock Velvet".into()], ..ImportOptions::default() };
    let names = |s: &SceneDesc| s.materials.iter().map(|m| m.name.to_string()).collect::<Vec<_>>();
    assert_ne!(names(&plain), names(&asset(path, &peacock).unwrap()));
}

#[test]
fn animation_pointers_change_what_they_name() {
    let path = "blender-io-roundtrip/24_animation_pointer/24_animation_pointer.gltf";
    let at = |frame| asset(path, &ImportOptions { frame, ..ImportOptions::default() });
    let (Some(rest), Some(later)) = (at(None), at(Some(30.0))) else { return };
    assert_ne!(rest.lights, later.lights);
    assert_ne!(rest.cameras, later.cameras);
    assert_ne!(rest.materials, later.materials);
    assert_eq!(rest.meshes.len(), later.meshes.len());
}
