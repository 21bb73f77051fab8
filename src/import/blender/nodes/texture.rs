//! Image textures.

use super::super::blending::AlphaUse;
use super::super::document::ImageData;
use super::super::image::Look;
use super::flow::{At, Flow};
use crate::desc::graph::{Function, Leaf, Math, ValueId};
use crate::desc::{Filter, Wrap};

/// Image Texture.
pub fn image<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let coordinates = flow.linked_or(at, "Vector", |flow| flow.graph.uv_upwards(0));
    let texel = match at.node.text("projection") {
        "BOX" => {
            let normal = flow.object_normal();
            let blend = at.node.number("projection_blend").unwrap_or(0.0);
            texture(flow, at, None).map(|texture| flow.graph.box_image(texture, coordinates, normal, blend))
        }
        round @ ("SPHERE" | "TUBE") => {
            // From 0 to 1 to −1 to 1.
            let rows = [[2.0, 0.0, 0.0, -1.0], [0.0, 2.0, 0.0, -1.0], [0.0, 0.0, 2.0, -1.0]];
            let centered = flow.graph.affine(rows, coordinates);
            let function = if round == "TUBE" { Function::TubeMap } else { Function::SphereMap };
            let uv = flow.graph.apply(function, &[centered]);
            lookup(flow, at, uv)
        }
        _ => lookup(flow, at, coordinates),
    };
    of_texel(flow, at, texel, output)
}

/// Environment Texture; directions where nothing is linked.
pub fn environment<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let direction = flow.linked_or(at, "Vector", |flow| flow.graph.leaf(Leaf::Position));
    let ball = at.node.text("projection") == "MIRROR_BALL";
    let function = if ball { Function::MirrorBall } else { Function::Equirectangular };
    let uv = flow.graph.apply(function, &[direction]);
    let texel = lookup(flow, at, uv);
    of_texel(flow, at, texel, output)
}

/// The texels at coordinates with v upwards, magenta where a tile is missing; `None` for a node without an image.
fn lookup<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, uv: ValueId) -> Option<ValueId> {
    let tiles = flow.images.data(at.node.text("image")).map(|data| data.tiles.clone()).unwrap_or_default();
    if tiles.is_empty() {
        let texture = texture(flow, at, None)?;
        let uv = flow.graph.upside_down(uv);
        return Some(flow.graph.image(texture, uv));
    }
    // Tile 1001 + i + 10 j covers the unit square at (i, j); as in Cycles, the first ones go on to -1.
    let floor = flow.graph.math(Math::Floor, &[uv]);
    let within = flow.graph.subtract(uv, floor);
    let within = flow.graph.upside_down(within);
    let whole = flow.graph.math(Math::Truncate, &[uv]);
    let (i, j) = (flow.graph.place(whole, 0), flow.graph.place(whole, 1));
    let rows = flow.graph.scale(j, 10.0);
    let here = flow.graph.add(i, rows);
    let missing = flow.graph.constant([1.0, 0.0, 1.0, 1.0]);
    let mut value = missing;
    for tile in tiles {
        let Some(texture) = texture(flow, at, Some(tile)) else { continue };
        let texel = flow.graph.image(texture, within);
        let number = flow.graph.number(f64::from(tile) - 1001.0);
        value = flow.graph.apply(Function::IfEqual, &[here, number, texel, value]);
    }
    // There are ten in a row.
    let [first, last] = [0.0, 9.0].map(|number| flow.graph.number(number));
    let within_row = flow.graph.math(Math::Clamp, &[i, first, last]);
    Some(flow.graph.apply(Function::IfEqual, &[i, within_row, value, missing]))
}

/// The texture of a node's image, or of a tile of it.
fn texture<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, tile: Option<u32>) -> Option<u32> {
    let wrap = match at.node.text("extension") {
        "EXTEND" => Wrap::Clamp,
        "CLIP" => Wrap::Black,
        "MIRROR" => Wrap::Mirror,
        _ => Wrap::Repeat,
    };
    // Cycles' Smart is Cubic, unless shaders are written in OSL.
    let filter = match at.node.text("interpolation") {
        "Closest" => Filter::Nearest,
        "Cubic" | "Smart" => Filter::Cubic,
        _ => Filter::Linear,
    };
    let alpha = alpha_use(flow, at);
    flow.images.texture(at.node.text("image"), tile, Look { wrap, filter, alpha })
}

/// The output of an image node.
fn of_texel<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, texel: Option<ValueId>, output: &str) -> ValueId {
    let Some(texel) = texel else {
        // Magenta, as Cycles shows a node without an image.
        return if output == "Alpha" { flow.graph.number(1.0) } else { flow.graph.constant([1.0, 0.0, 1.0, 1.0]) };
    };
    if output != "Alpha" {
        return texel;
    }
    let ignored = flow.images.data(at.node.text("image")).is_some_and(|data| data.alpha_mode == "NONE");
    if ignored { flow.graph.number(1.0) } else { flow.graph.place(texel, 3) }
}

/// Cycles keeps colours multiplied by alpha, and divides again only where an Image Texture's alpha is used, too.
fn alpha_use<'a>(flow: &Flow<'a, '_>, at: At<'a>) -> AlphaUse {
    let apart = |data: &ImageData| {
        data.colorspace == "Non-Color" || matches!(data.alpha_mode.as_str(), "NONE" | "CHANNEL_PACKED")
    };
    let used = || at.node.output("Alpha").is_none_or(|alpha| flow.is_used(at, alpha));
    match flow.images.data(at.node.text("image")) {
        Some(data) if apart(data) => AlphaUse::Apart,
        _ if at.node.r#type == "ShaderNodeTexImage" && used() => AlphaUse::Divided,
        _ => AlphaUse::Multiplied,
    }
}
