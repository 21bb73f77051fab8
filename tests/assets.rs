//! Real scenes by other people, where they are: the folder `shared/assets` beside the checkout, or
//! the one that `PENUMBRA_ASSETS` names.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use penumbra::desc::{ColorSpace, LightDesc, LightKind};
use penumbra::error::Warnings;
use penumbra::film::PassSet;
use penumbra::import::{self, ImportOptions};
use penumbra::math::DAffine3;
use penumbra::output::exr;
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

/// The files below `folder` whose names end in one of `extensions`.
fn scenes(folder: &Path, extensions: &[&str], found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            scenes(&path, extensions, found);
        } else if path.extension().is_some_and(|e| extensions.iter().any(|known| e == *known)) {
            found.push(path);
        }
    }
}

#[test]
fn every_gltf_renders() {
    let Some(folder) = assets() else { return };
    let mut found = Vec::new();
    scenes(&folder.join("gltf"), &["gltf", "glb"], &mut found);
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

/// The whole program, since much of what a stage may lack is told outside of the USD door. Layers that are parts of
/// other stages are stages as well.
#[test]
fn every_usd_stage_renders_or_says_what_it_lacks() {
    let Some(folder) = assets() else { return };
    let mut found = Vec::new();
    scenes(&folder.join("usd"), &["usd", "usda", "usdc", "usdz"], &mut found);
    assert!(found.len() >= 120, "only {} stages", found.len());
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out.exr");
    for path in found {
        let name = path.display();
        let mut render = Command::new(env!("CARGO_BIN_EXE_penumbra"));
        render.arg("render").arg(&path).arg("-o").arg(&out).stdin(Stdio::null());
        // Some of them are framed so wide that a cube is smaller than a pixel.
        render.args("--size 48x27 --spp 32 --max-bounces 2 --integrator path --progress none".split(' '));
        let done = render.output().unwrap();
        let said = String::from_utf8(done.stderr).unwrap();
        assert!(done.status.success(), "{name}: {said}");
        let mut lines: Vec<&str> = said.lines().collect();
        let summary = lines.pop().unwrap_or_default();
        assert!(summary.starts_with(&format!("{}: 48x27", out.display())), "{name}: {said}");
        assert!(lines.iter().all(|line| line.starts_with("warning: ") && line.len() > 20), "{name}: {said}");
        let picture = exr::read(&out).unwrap();
        let mut values = picture.layers.iter().flat_map(|layer| &layer.data);
        assert!(values.all(|value| value.is_finite()), "{name} has values that are not finite");
        let combined = &picture.layer("Combined").unwrap().data;
        let lit = combined.chunks_exact(4).filter(|p| p[3] > 0.0 && p[0] + p[1] + p[2] > 0.0).count();
        // A camera or light of its own is what most of them lack; to say so does not explain a black picture.
        let stood_in = |line: &&&str| line.contains("no camera in the scene") || line.contains("no light in the scene");
        let explained = lines.iter().any(|line| !stood_in(&line));
        assert!(lit > 0 || explained, "{name} is black: {said}");
        std::fs::remove_file(&out).unwrap();
    }
}
