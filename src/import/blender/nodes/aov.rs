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
