//! The UV Map node.

use super::flow::{At, Flow};
use super::input;
use crate::desc::graph::ValueId;

/// UV Map: (0, 0, 0) for a map that nothing in the scene has, as in Cycles.
pub fn uv_map<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    if flow.uv_sets.set(at.node.text("uv_map")).is_none() {
        return flow.graph.number(0.0);
    }
    input::uv_map(flow, at, output)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::super::super::{BlenderScene, Ends, LayerArray, MeshArrays};
    use crate::desc::ColorInput;
    use crate::error::Warnings;

    /// What the UV map `asked` for is, in a scene whose mesh and strands (none where empty) have these.
    fn color(of_mesh: &str, of_rounds: &str, asked: &str) -> ColorInput {
        let aov = json!({
            "name": "A", "type": "ShaderNodeOutputAOV", "properties": {"aov_name": "a"},
            "inputs": [
                {"id": "Color", "name": "Color", "type": "RGBA", "enabled": true, "link": [1, 0]},
                {"id": "Value", "name": "Value", "type": "VALUE", "enabled": true, "value": 0.0},
            ],
        });
        let uv = json!({
            "name": "UV", "type": "ShaderNodeUVMap", "inputs": [], "properties": {"uv_map": asked},
            "outputs": [{"id": "UV", "type": "VECTOR"}],
        });
        let mut scene = BlenderScene::default();
        let document = json!({"version": [5, 0, 1], "render": {"aovs": [["a", "COLOR"]]}});
        scene.set_document(&document.to_string()).unwrap();
        scene.set_material(1, &json!({"name": "M", "nodes": {"nodes": [aov, uv]}}).to_string()).unwrap();
        scene.set_materials(&[1]).unwrap();
        let arrays = MeshArrays {
            positions: &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0],
            corner_verts: &[0, 1, 2],
            triangles: &[0, 1, 2],
            ..MeshArrays::default()
        };
        scene.set_mesh(1, "mesh", &arrays, &[LayerArray { name: of_mesh, values: &[0.5; 6] }], [&[], &[]]).unwrap();
        if !of_rounds.is_empty() {
            let uvs = [LayerArray { name: of_rounds, values: &[0.5; 2] }];
            scene.set_rounds(2, "hair", &[0.0; 6], &[1.0; 2], Ends { points: &[2], ..Ends::default() }, &uvs).unwrap();
        }
        let desc = scene.scene(&mut Warnings::new()).unwrap();
        desc.materials[0].aovs[0].color
    }

    #[test]
    fn a_map_that_nothing_has_is_zero() {
        let zero = ColorInput::constant([0.0; 3]);
        assert_eq!(color("UVMap", "", "Other"), zero);
        assert_ne!(color("UVMap", "", "UVMap"), zero);
        assert_ne!(color("UVMap", "", ""), zero);
        assert_ne!(color("UVMap", "Other", "Other"), zero);
    }
}
