//! AOV Output nodes: what a material or a world gives under names of the view layer's.

use super::flow::Flow;
use super::surface::{color, scalar};
use crate::desc::graph::{Leaf, Op, PathInfo, ValueId};
use crate::desc::{AovOutput, BackgroundAovs};

/// What the AOV Output nodes of a material give.
pub fn outputs(flow: &mut Flow<'_, '_>) -> Vec<AovOutput> {
    let sums = given(flow);
    let output = |(name, [of_color, of_value]): (&str, [ValueId; 2])| AovOutput {
        name: name.into(),
        color: color(flow, of_color),
        value: scalar(flow, of_value),
    };
    sums.into_iter().map(output).collect()
}

/// What those of a world give to the camera.
pub fn background(mut flow: Flow<'_, '_>) -> BackgroundAovs {
    flow.is_world = true;
    let outputs = given(&mut flow);
    let mut graph = flow.graph;
    let mut of_camera = |value| {
        graph.replaced(value, |_, op| match op {
            Op::Leaf(Leaf::Path(info)) => Some([f64::from(u8::from(*info == PathInfo::IsCamera)); 4]),
            _ => None,
        })
    };
    let outputs = outputs.into_iter().map(|(name, values)| (name.into(), values.map(&mut of_camera))).collect();
    BackgroundAovs { graph, outputs }
}

/// Name, color and number of each AOV Output of the tree and its groups; where several have one name their sums,
/// as in Cycles.
fn given<'a>(flow: &mut Flow<'a, '_>) -> Vec<(&'a str, [ValueId; 2])> {
    let mut sums: Vec<(&str, [ValueId; 2])> = Vec::new();
    for at in flow.all_of("ShaderNodeOutputAOV") {
        let name = at.node.text("aov_name");
        // Until 4.5 Cycles leaves muted ones out, since 5.0 it does not.
        if name.is_empty() || (at.node.mute && (1..5).contains(&flow.version[0])) {
            continue;
        }
        let given = ["Color", "Value"].map(|input| flow.input(at, input));
        match sums.iter_mut().find(|(known, _)| *known == name) {
            Some((_, sum)) => *sum = [0, 1].map(|i| flow.graph.add(sum[i], given[i])),
            None => sums.push((name, given)),
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::super::super::BlenderScene;
    use crate::desc::{AovDesc, AovKind, ColorInput, ScalarInput, SceneDesc};
    use crate::error::Warnings;

    fn output(name: &str, color: f64, value: f64, mute: bool) -> Value {
        json!({
            "name": name, "type": "ShaderNodeOutputAOV", "mute": mute, "properties": {"aov_name": name},
            "inputs": [
                {"id": "Color", "name": "Color", "type": "RGBA", "enabled": true, "value": [color, 0.0, 0.0, 1.0]},
                {"id": "Value", "name": "Value", "type": "VALUE", "enabled": true, "value": value},
            ],
        })
    }

    /// A material and a world of these nodes.
    fn scene(version: [u32; 3], nodes: &[Value]) -> (SceneDesc, Warnings) {
        let tree = json!({"nodes": nodes});
        let document = json!({
            "version": version, "world": {"name": "World", "nodes": tree},
            "render": {"aovs": [["wet", "VALUE"], ["raw", "COLOR"]]},
        });
        let mut scene = BlenderScene::default();
        scene.set_document(&document.to_string()).unwrap();
        scene.set_material(1, &json!({"name": "M", "nodes": tree}).to_string()).unwrap();
        scene.set_materials(&[1]).unwrap();
        let mut warnings = Warnings::new();
        (scene.scene(&mut warnings).unwrap(), warnings)
    }

    #[test]
    fn nodes_of_one_name_are_summed_those_in_groups_included() {
        let inner = json!({"nodes": [output("wet", 1.0, 10.0, false), output("raw", 2.0, 20.0, false)]});
        let group = |name: &str, mute: bool| {
            let tree = inner.clone();
            json!({"name": name, "type": "ShaderNodeGroup", "mute": mute, "tree": tree, "inputs": [], "outputs": []})
        };
        let nodes = [output("wet", 0.5, 3.0, false), group("a", false), group("b", false), group("c", true)];
        let (desc, warnings) = scene([5, 0, 1], &nodes);
        assert!(warnings.is_empty());
        let kinds = [("wet", AovKind::Value), ("raw", AovKind::Color)];
        assert_eq!(desc.render.aovs, kinds.map(|(name, kind)| AovDesc { name: name.into(), kind }));
        let [wet, raw] = &desc.materials[0].aovs[..] else { panic!("{:?}", desc.materials[0].aovs) };
        assert_eq!((&*wet.name, wet.value), ("wet", ScalarInput::constant(23.0)));
        assert_eq!((&*raw.name, raw.color), ("raw", ColorInput::constant([4.0, 0.0, 0.0])));
        let background = &desc.background_aovs;
        let [(wet, [_, value]), _] = &background.outputs[..] else { panic!("{background:?}") };
        assert_eq!((&**wet, background.graph.known(*value)), ("wet", Some([23.0; 4])));
    }

    #[test]
    fn muted_ones_give_nothing_before_blender_5() {
        let nodes = [output("wet", 0.5, 3.0, true), output("", 1.0, 1.0, false)];
        for (version, count) in [([4, 2, 0], 0), ([4, 5, 3], 0), ([5, 0, 1], 1)] {
            assert_eq!(scene(version, &nodes).0.materials[0].aovs.len(), count, "{version:?}");
        }
    }
}
