//! The image nodes that come with MaterialX's gltf_pbr, by the graphs in its `gltf_pbr.mtlx`: images placed as
//! KHR_texture_transform has it.

use super::evaluate::Evaluator;
use super::expr::Id;
use super::texture::{self, Placement};
use crate::desc::graph::Math;

/// The texture coordinates: scale and rotation are those of the coordinates, not of the image.
fn coordinates(e: &mut Evaluator<'_, '_>, node: usize, offset_first: bool) -> Id {
    let uv = e.optional(node, "texcoord").unwrap_or_else(|| e.texcoord("st".into()));
    let (one, sign) = (e.exprs.number(1.0), e.exprs.constant([-1.0, 1.0, 0.0, 0.0]));
    let (scale, offset) = (e.input(node, "scale", [1.0; 4]), e.input(node, "offset", [0.0; 4]));
    let angle = e.scalar(node, "rotate", 0.0);
    let placement = Placement {
        pivot: e.input(node, "pivot", [0.0, 1.0, 0.0, 0.0]),
        scale: e.exprs.math(Math::Divide, &[one, scale]),
        angle: e.exprs.scale(angle, -1.0),
        offset: e.exprs.multiply(offset, sign),
        offset_first,
    };
    placement.place(e, uv)
}

/// gltf_image, whose output is of the type `kind`.
pub(super) fn image(e: &mut Evaluator<'_, '_>, node: usize) -> Option<Id> {
    let offset_first = e.uniform(node, "operationorder", 0.0) != 0.0;
    let uv = coordinates(e, node, offset_first);
    let kind = e.node(node).kind.split('_').next().unwrap_or_default().to_string();
    let texel = texture::image_at(e, node, uv, &kind)?;
    let factor = e.input(node, "factor", [1.0; 4]);
    Some(e.exprs.multiply(texel, factor))
}

/// gltf_colorimage: color and opacity, times a color and that of the geometry.
pub(super) fn color_image(e: &mut Evaluator<'_, '_>, node: usize, output: &str) -> Option<Id> {
    // The graph hands its order of operations to nobody.
    let uv = coordinates(e, node, false);
    let mut color = texture::image_at(e, node, uv, "color4")?;
    for name in ["color", "geomcolor"] {
        let factor = e.input(node, name, [1.0; 4]);
        color = e.exprs.multiply(color, factor);
    }
    Some(if output == "outa" { e.exprs.extract(color, 3) } else { color })
}

/// gltf_normalmap: a vector in the space of the surface.
pub(super) fn normal_map(e: &mut Evaluator<'_, '_>, node: usize) -> Option<Id> {
    let offset_first = e.uniform(node, "operationorder", 0.0) != 0.0;
    let uv = coordinates(e, node, offset_first);
    let texel = texture::image_at(e, node, uv, "vector3")?;
    let double = e.exprs.scale(texel, 2.0);
    let one = e.exprs.number(1.0);
    Some(e.exprs.subtract(double, one))
}
