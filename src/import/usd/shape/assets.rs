//! The shapes of the shared assets against what usd-core 26.11 reads of them.

use std::path::Path;

use openusd_schemas::geom::PrimvarsAPI;

use super::super::stage::Reading;
use super::{Wants, build, read};
use crate::error::Place;
use crate::import::ImportOptions;

/// File; meshes that have points and faces; their triangles, two fewer than each face has corners; the sum
/// of x + 2y + 3z over their points.
const KNOWN: &[(&str, usize, usize, f64)] = &[
    ("usd-wg-tests/schemaTests/usdGeom/extent/inverse_extent.usda", 1, 12, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/extent/no_extent.usda", 1, 12, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/extent/regular_extent.usda", 1, 12, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/extent/scaled_extent.usda", 2, 24, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/extent/zero_extent.usda", 1, 12, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/meshes/5_face/5_face.usda", 1, 13, 4.2000),
    ("usd-wg-tests/schemaTests/usdGeom/meshes/doubleSided/doubleSided_quad.usda", 2, 4, -48.0000),
    ("usd-wg-tests/schemaTests/usdGeom/meshes/empty_mesh/empty.usda", 0, 0, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/meshes/mixed_faceVertexCounts/mixed.usda", 1, 12, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/meshes/normals_types/normalsTypes.usda", 17, 204, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/meshes/points_types/pointsTypes.usda", 8, 96, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/meshes/quad_mesh/quads.usda", 1, 12, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/meshes/singleSided/singleSided.usda", 2, 4, -48.0000),
    ("usd-wg-tests/schemaTests/usdGeom/meshes/subdiv_bilinear/subdiv_bilinear.usda", 1, 12, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/meshes/subdiv_catmullClark/subdiv_catmullClark.usda", 1, 12, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/meshes/subdiv_loop_quads/subdiv_loop_quads.usda", 1, 12, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/meshes/subdiv_loop_triangles/subdiv_loop_triangles.usda", 1, 12, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/meshes/subdiv_none/subdiv_none.usda", 1, 12, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/meshes/triangled_mesh/triangles.usda", 1, 12, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/primitives/all_primitives.usda", 0, 0, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/primitives/capsule.usda", 0, 0, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/primitives/cone.usda", 0, 0, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/primitives/cube.usda", 0, 0, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/primitives/cylinder.usda", 0, 0, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/primitives/sphere.usda", 0, 0, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/transforms/complex_transform.usda", 1, 12, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/transforms/matrix_transform.usda", 1, 12, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/transforms/scopes_and_xforms_nested.usda", 0, 0, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/transforms/simple_transform.usda", 1, 12, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/transforms/weird_matrix_transform.usda", 1, 12, 0.0000),
    ("usd-wg-tests/schemaTests/usdGeom/transforms/xforms_nested.usda", 0, 0, 0.0000),
    ("usd-wg-tests/_common/teapot.usda", 1, 25200, 2765.0690),
    ("standard_shader_ball/standard_shader_ball_scene.usda", 12, 15980, 74152.4477),
    ("cornell-box/display-color/cornell-box.usda", 16, 32, 996.7300),
    ("cornell-box/mdl/cornell-box.usda", 16, 32, 996.7300),
    ("cornell-box/mtlx-ref/cornell-box.usda", 16, 32, 996.7300),
    ("cornell-box/mtlx-usdshade/cornell-box.usda", 16, 32, 996.7300),
    ("cornell-box/usdpreviewsurface/cornell-box.usda", 16, 32, 996.7300),
];

#[test]
fn meshes_of_the_assets_are_those_of_usd_core() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets/usd");
    if !root.exists() {
        eprintln!("skipped: {} is absent", root.display());
        return;
    }
    for &(file, meshes, triangles, sum) in KNOWN {
        let options = ImportOptions::default();
        let reading = Reading::open(&root.join(file), &options).unwrap();
        let mut stack = vec![reading.stage.prim("/").unwrap()];
        let (mut found, mut moment) = ([0, 0], 0.0);
        while let Some(prim) = stack.pop() {
            stack.extend(prim.children().unwrap());
            let kind = prim.type_name().unwrap();
            let inherited = match prim.parent() {
                Some(parent) => PrimvarsAPI::from_prim_unchecked(parent).find_inheritable_primvars().unwrap(),
                None => continue,
            };
            let Some(source) = read(&reading, &prim, &inherited, None) else { continue };
            let mut warnings = reading.warnings.borrow_mut();
            let place = Place::default().at(prim.path().as_str());
            let Some(built) = build(source, &Wants::default(), 0, &place, &mut warnings) else { continue };
            if kind.is_some_and(|kind| kind == "Mesh") {
                let mesh = built.into_mesh();
                found = [found[0] + 1, found[1] + mesh.triangles.len()];
                let points = mesh.points.iter().map(|p| p.map(f64::from));
                moment += points.map(|[x, y, z]| x + 2.0 * y + 3.0 * z).sum::<f64>();
            }
        }
        let told: Vec<String> = reading.warnings.borrow().iter().map(|w| w.to_string()).collect();
        assert_eq!(found, [meshes, triangles], "{file}: {told:#?}");
        assert!((moment - sum).abs() < 1e-3 + 1e-6 * sum.abs(), "{file}: {moment} is not {sum}");
    }
}
