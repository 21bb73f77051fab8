//! Small stages, read and compared with values worked out by hand.

mod assets;
mod materialx;
mod nodes;
mod noise;
mod open_pbr;
mod preview;

use std::path::Path;

use super::super::images::tests::stage;
use super::*;
use crate::desc::graph::ValueId;
use crate::import::ImportOptions;

/// A material, the tables that it points into, and what was told.
struct Read {
    material: Option<MaterialDesc>,
    colors: VertexColors,
    uv_sets: Vec<Arc<str>>,
    scene: SceneDesc,
    warnings: String,
}

impl Read {
    fn material(&self) -> &MaterialDesc {
        self.material.as_ref().unwrap_or_else(|| panic!("no material: {}", self.warnings))
    }

    fn texture(&self, index: u32) -> (&TextureDesc, &crate::desc::ImageDesc) {
        let texture = &self.scene.textures[index as usize];
        (texture, &self.scene.images[texture.image as usize])
    }
}

fn read_at(folder: &Path, text: &str, path: &str) -> Read {
    read_with(folder, text, path, &ImportOptions::default())
}

fn read_with(folder: &Path, text: &str, path: &str, options: &ImportOptions) -> Read {
    let reading = stage(folder, text, options);
    let path = sdf::Path::new(path).unwrap();
    let mut materials = Materials::new(&reading, Images::default(), BTreeSet::new(), Vec::new());
    materials.preload([&path]);
    let index = materials.at(&path);
    assert_eq!(materials.at(&path), index);
    let material = index.and_then(|index| materials.get(index).cloned());
    let colors = index.map(|index| materials.vertex_colors(index)).unwrap_or_default();
    let uv_sets = materials.uv_sets.clone();
    let mut scene = SceneDesc::default();
    materials.finish(&mut scene);
    crate::desc::check(&scene).unwrap();
    let warnings: Vec<String> = reading.warnings.take().iter().map(ToString::to_string).collect();
    Read { material, colors, uv_sets, scene, warnings: warnings.join("\n") }
}

/// `/m` with a surface of `id` and the given lines; `nodes` stand beside it.
fn material_of(context: &str, id: &str, lines: &str, nodes: &str) -> String {
    format!(
        "def Material \"m\" {{
            token outputs:{context}surface.connect = </m/s.outputs:surface>
            def Shader \"s\" {{ uniform token info:id = \"{id}\"
                {lines}
                token outputs:surface
            }}
            {nodes}
        }}"
    )
}

fn preview(lines: &str, nodes: &str) -> Read {
    let folder = tempfile::tempdir().unwrap();
    preview_in(folder.path(), lines, nodes)
}

fn preview_in(folder: &Path, lines: &str, nodes: &str) -> Read {
    read_at(folder, &material_of("", "UsdPreviewSurface", lines, nodes), "/m")
}

fn mtlx_in(folder: &Path, id: &str, lines: &str, nodes: &str) -> Read {
    read_at(folder, &material_of("mtlx:", id, lines, nodes), "/m")
}

fn mtlx(id: &str, lines: &str, nodes: &str) -> Read {
    let folder = tempfile::tempdir().unwrap();
    mtlx_in(folder.path(), id, lines, nodes)
}

/// Values pass through USD's single precision.
/// A value of the graph of `m` where images have these texels.
fn value_of(m: &MaterialDesc, id: ValueId, texels: &[(u32, [f64; 4])]) -> [f64; 4] {
    let mut values: Vec<[f64; 4]> = Vec::new();
    for op in m.graph.ops() {
        values.push(match op {
            Op::Constant(value) => *value,
            Op::Leaf(_) => [0.5; 4],
            Op::Image { texture, .. } => texels.iter().find(|(of, _)| of == texture).unwrap().1,
            Op::Apply(function, args) => function.eval(&args.iter().map(|arg| values[arg.index()]).collect::<Vec<_>>()),
            // What any cell of noise may be.
            Op::Procedural(crate::desc::graph::Procedural::Cell { .. }, _) => [0.25; 4],
            other => panic!("{other:?}"),
        });
    }
    values[id.index()]
}

fn close(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= 1e-6 * b.abs().max(1.0)
}

#[track_caller]
fn same(a: &[f64], b: &[f64]) {
    assert!(a.len() == b.len() && a.iter().zip(b).all(|(a, b)| close(*a, *b)), "{a:?} is not {b:?}");
}
