//! Vertices so far out that nothing can be computed with them.

use rayon::prelude::*;

/// About where `f32` can't hold squares any more.
const REACH: f32 = 1e18;

/// The positions with NaN for each number beyond reach, so that they are left out with those that are not finite;
/// `None` where all are within.
pub fn within(positions: &[f32]) -> Option<Vec<f32>> {
    let beyond = |x: f32| x.abs() > REACH;
    if !positions.par_iter().any(|&x| beyond(x)) {
        return None;
    }
    Some(positions.par_iter().map(|&x| if beyond(x) { f32::NAN } else { x }).collect())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::super::{BlenderScene, MeshArrays};
    use crate::error::Warnings;

    #[test]
    fn triangles_at_a_vertex_beyond_reach_are_left_out_and_told() {
        for (x, left) in [(1e30, 1), (-1e30, 1), (f32::INFINITY, 1), (1e17, 2)] {
            let positions = [0.0, 0.0, 0.0, x, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
            let arrays = MeshArrays {
                positions: &positions,
                corner_verts: &[0, 1, 2, 3],
                triangles: &[0, 1, 2, 0, 2, 3],
                ..MeshArrays::default()
            };
            let mut scene = BlenderScene::default();
            scene.set_document(&json!({"objects": [{"name": "O", "mesh": 1}]}).to_string()).unwrap();
            scene.set_mesh(1, "quad", &arrays, &[], [&[], &[]]).unwrap();
            let matrix = glam::Mat4::IDENTITY.to_cols_array();
            scene.set_instances(&[0], &matrix, &[0]).unwrap();
            let mut warnings = Warnings::new();
            let desc = scene.scene(&mut warnings).unwrap();
            assert_eq!(desc.meshes[0].triangles.len(), left, "{x}");
            let said: Vec<&str> = warnings.iter().map(|w| &*w.what).collect();
            let told = ["the mesh \"quad\" has 1 vertices that are not finite; 1 triangles are left out"];
            assert_eq!(said, told[..2 - left], "{x}");
        }
    }
}
