//! Holds the house to its plan: which room may use which, where `unsafe` may stand, how long files
//! may grow, that tables and documents agree.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Rooms and the rooms that they may use. Siblings do not know each other.
const MAY_USE: &[(&str, &[&str])] = &[
    ("error", &[]),
    ("math", &[]),
    ("desc", &["error", "math"]),
    ("import", &["desc", "error", "math"]),
    ("sampling", &["math"]),
    ("bvh", &["math"]),
    ("shape", &["math"]),
    // Texels stay in the storage in which they were decoded, which is the description's type.
    ("texture", &["desc", "error", "math"]),
    ("bsdf", &["math", "sampling"]),
    ("light", &["math", "sampling", "shape"]),
    ("camera", &["math"]),
    ("film", &["error", "math"]),
    ("denoise", &[]),
    ("compare", &["film", "math"]),
    ("output", &["compare", "converge", "error", "film", "math"]),
    ("settings", &["film", "sampling"]),
    (
        "scene",
        &[
            "bsdf", "bvh", "camera", "desc", "error", "film", "light", "math", "sampling", "settings", "shape",
            "texture",
        ],
    ),
    ("integrator", &["bsdf", "bvh", "film", "light", "math", "sampling", "scene", "settings"]),
    ("render", &["error", "film", "integrator", "sampling", "scene", "settings"]),
    ("plan", &["desc", "film", "render", "scene", "settings"]),
    ("converge", &["compare", "denoise", "error", "film", "render", "sampling", "scene", "settings"]),
    ("job", &["denoise", "desc", "error", "film", "output", "render", "scene", "settings"]),
];

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
    files
}

/// `src/light/dome.rs` is in room `light`, `src/render.rs` in `render`.
fn room(file: &Path) -> String {
    let inside = file.strip_prefix(source()).unwrap();
    inside.components().next().unwrap().as_os_str().to_str().unwrap().trim_end_matches(".rs").to_string()
}

/// What stands before the tests at the file's end.
fn code(file: &Path) -> String {
    let text = fs::read_to_string(file).unwrap();
    text.split("#[cfg(test)]").next().unwrap_or_default().to_string()
}

#[test]
fn rooms_use_only_the_rooms_below_them() {
    let mut wrong = Vec::new();
    for file in rust_files(&source()) {
        let room = room(&file);
        if matches!(room.as_str(), "lib" | "main" | "cli" | "python") {
            continue;
        }
        let (_, may_use) = MAY_USE.iter().find(|(name, _)| *name == room).unwrap_or_else(|| panic!("new room {room}"));
        let text = code(&file);
        let used: BTreeSet<&str> = text
            .lines()
            .filter(|line| !line.trim_start().starts_with("//"))
            .flat_map(|line| line.split("crate::").skip(1))
            .map(|rest| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default())
            .filter(|name| MAY_USE.iter().any(|(room, _)| room == name))
            .collect();
        for used in used {
            if used != room && !may_use.contains(&used) {
                wrong.push(format!("{} uses {used}", file.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn unsafe_stands_in_the_tree_and_at_the_denoiser_alone() {
    for file in rust_files(&source()) {
        let is_unsafe = code(&file).lines().any(|line| {
            let line = line.trim_start();
            !line.starts_with("//")
                && (line.contains("unsafe {") || line.contains("unsafe fn") || line.contains("unsafe impl"))
        });
        assert!(!is_unsafe || matches!(room(&file).as_str(), "bvh" | "denoise"), "unsafe in {}", file.display());
    }
}

#[test]
fn files_hold_one_idea() {
    let mut lengths: Vec<(usize, PathBuf)> =
        rust_files(&source()).into_iter().map(|file| (code(&file).lines().count(), file)).collect();
    lengths.sort();
    let (longest, file) = lengths.last().unwrap();
    assert!(*longest <= 600, "{} has {longest} lines", file.display());
    let median = lengths[lengths.len() / 2].0;
    assert!(median <= 200, "the median file has {median} lines");
}

#[test]
fn every_pass_and_setting_is_in_the_documents() {
    let docs = |name: &str| fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(name)).unwrap();
    let (passes, settings) = (docs("passes.md"), docs("settings.md"));
    for pass in penumbra::film::PASSES {
        assert!(passes.contains(&format!("`{}`", pass.name)) && passes.contains(pass.layer), "pass {}", pass.name);
    }
    for def in penumbra::settings::SETTINGS {
        let row = format!("| `--{}` | {} |", def.name.replace('_', "-"), def.help);
        assert!(settings.contains(&row), "docs/settings.md lacks: {row}");
    }
}
