//! Real scenes by other people, where they are: the folder `shared/assets` beside the checkout, or
//! the one that `PENUMBRA_ASSETS` names.

use std::path::{Path, PathBuf};

use penumbra::desc::{ColorSpace, LightDesc, LightKind};
use penumbra::error::Warnings;
use penumbra::film::PassSet;
use penumbra::import::{self, ImportOptions};
use penumbra::math::DAffine3;
use penumbra::scene::{View, prepare};
use penumbra::settings::Settings;

fn assets() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets");
    let folder = std::env::var_os("PENUMBRA_ASSETS").map_or(beside, PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: no folder {} with other people's scenes", folder.display());
    None
}

fn scenes(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            scenes(&path, found);
        } else if path.extension().is_some_and(|e| e == "gltf" || e == "glb") {
            found.push(path);
        }
    }
}

#[test]
fn every_gltf_renders() {
    let Some(folder) = assets() else { return };
    let mut found = Vec::new();
    scenes(&folder.join("gltf"), &mut found);
    assert!(found.len() >= 13, "only {} scenes", found.len());
    let settings = Settings { spp: 2, passes: PassSet::all(), max_bounces: 4, ..Settings::default() };
    let view = View { camera: None, size: Some([40, 24]) };
    for path in found {
        let mut warnings = Warnings::new();
        let mut desc = import::scene(&path, &ImportOptions::default(), &mut warnings).unwrap();
        if path.to_string_lossy().contains("flight_helmet") {
            let image = import::load_image(&folder.join("hdri/chinese_garden_1k.hdr"), ColorSpace::Linear).unwrap();
            desc.images.push(image.into());
            let kind = LightKind::Dome { radiance: [1.0; 3], image: Some(desc.images.len() as u32 - 1) };
            desc.lights.push(LightDesc::new("garden", desc.place.clone(), DAffine3::IDENTITY, kind));
        }
        let prepared = prepare(desc, &view, &settings).unwrap();
        let rendered = penumbra::render::render(&prepared.scene, &settings, &()).unwrap();
        let name = path.display();
        assert_eq!(rendered.film.non_finite().count, 0, "{name}");
        let picture = rendered.film.develop();
        let covered = picture.layer("Depth").unwrap().data.iter().filter(|depth| **depth < 1e9).count();
        assert!(covered > 40, "{name}: only {covered} of 960 pixels hold something");
        if path.ends_with("24_animation_pointer.gltf") {
            // Its lamps are of a few lux and aimed away from the first camera.
            continue;
        }
        let combined = &picture.layer("Combined").unwrap().data;
        assert!(combined.chunks_exact(4).filter(|p| p[0] + p[1] + p[2] > 0.0).count() > 40, "{name} is black");
    }
}
