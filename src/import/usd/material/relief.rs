//! Normals of MaterialX that are not the surface's own: maps, and the slope of heights. They are in tangent space.

use super::evaluate::Evaluator;
use super::expr::{Id, Op};
use crate::desc::graph::Function;

/// normalmap: a stored normal as a direction.
pub(super) fn normal_map(e: &mut Evaluator<'_, '_>, node: usize) -> Id {
    let map = e.input(node, "in", [0.5, 0.5, 1.0, 1.0]);
    scaled(e, node, map)
}

/// heighttonormal: the slope of a height over texture coordinates as a map stores it.
pub(super) fn height_to_normal(e: &mut Evaluator<'_, '_>, node: usize) -> Id {
    let (height, scale) = (e.scalar(node, "in", 0.0), e.scalar(node, "scale", 1.0));
    let uv = e.optional(node, "texcoord");
    relief(e, height, scale, uv)
}

/// bump: the normal of a relief, by its node graph.
pub(super) fn bump(e: &mut Evaluator<'_, '_>, node: usize) -> Id {
    let (height, one) = (e.scalar(node, "height", 0.0), e.exprs.number(1.0));
    let map = relief(e, height, one, None);
    scaled(e, node, map)
}

fn relief(e: &mut Evaluator<'_, '_>, height: Id, scale: Id, uv: Option<Id>) -> Id {
    if e.exprs.known(height).is_some() {
        return e.exprs.constant([0.5, 0.5, 1.0, 1.0]);
    }
    let uv = uv.unwrap_or_else(|| e.texcoord("st".into()));
    e.exprs.push(Op::Relief { height, scale, uv })
}

/// A stored normal from −1 to 1, tilted by the scale of the node: a number, or one along each axis.
fn scaled(e: &mut Evaluator<'_, '_>, node: usize, map: Id) -> Id {
    let double = e.exprs.scale(map, 2.0);
    let one = e.exprs.number(1.0);
    let normal = e.exprs.subtract(double, one);
    let scale = e.input(node, "scale", [1.0; 4]);
    let scale = match e.exprs.known(scale) {
        Some([x, y, ..]) => e.exprs.constant([x, y, 1.0, 1.0]),
        None => {
            let [x, y] = [0, 1].map(|place| e.exprs.extract(scale, place));
            e.exprs.apply(Function::Combine, &[x, y, one])
        }
    };
    for input in ["normal", "tangent", "bitangent"] {
        let source = e.node(node).inputs.get(input).and_then(|input| input.source.as_ref());
        if source.is_some_and(|source| e.node(source.node).category != input) {
            e.warn(node, format!("a {input} that is not the surface's own isn't read; that is used"));
        }
    }
    e.exprs.multiply(normal, scale)
}
