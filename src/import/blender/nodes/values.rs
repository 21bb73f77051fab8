//! The table of nodes that make values: `bl_idname` and what its outputs are.

use super::flow::{At, Flow};
use super::{color, displacement, ies, input, lamp, math, procedural, sky, texture, vector};
use crate::desc::graph::ValueId;

/// What the output of this identifier of a node is.
type Make = for<'a> fn(&mut Flow<'a, '_>, At<'a>, &str) -> ValueId;

/// Every node that makes values; a new one is a line here.
#[rustfmt::skip]
const NODES: &[(&str, Make)] = &[
    ("ShaderNodeValue", input::constant),
    ("ShaderNodeRGB", input::constant),
    ("ShaderNodeTexCoord", input::texture_coordinate),
    ("ShaderNodeUVMap", input::uv_map),
    ("ShaderNodeNewGeometry", input::geometry),
    ("ShaderNodeAttribute", input::attribute),
    ("ShaderNodeVertexColor", input::color_attribute),
    ("ShaderNodeObjectInfo", input::object_info),
    ("ShaderNodeLightPath", input::light_path),
    ("ShaderNodeCameraData", input::camera_data),
    ("ShaderNodeTangent", input::tangent),
    ("ShaderNodeFresnel", input::fresnel),
    ("ShaderNodeLightFalloff", lamp::falloff),
    ("ShaderNodeLayerWeight", input::layer_weight),
    ("ShaderNodeMath", math::math),
    ("ShaderNodeVectorMath", math::vector_math),
    ("ShaderNodeMapRange", math::map_range),
    ("ShaderNodeClamp", math::clamp),
    ("ShaderNodeMix", math::mix),
    ("ShaderNodeFloatCurve", math::float_curve),
    ("ShaderNodeSqueeze", math::squeeze),
    ("ShaderNodeCombineXYZ", math::combine_xyz),
    ("ShaderNodeSeparateXYZ", math::separate_xyz),
    ("ShaderNodeMixRGB", color::mix),
    ("ShaderNodeValToRGB", color::ramp),
    ("ShaderNodeRGBCurve", color::curves),
    ("ShaderNodeCombineColor", color::combine),
    ("ShaderNodeSeparateColor", color::separate),
    ("ShaderNodeHueSaturation", color::hue_saturation),
    ("ShaderNodeBrightContrast", color::bright_contrast),
    ("ShaderNodeGamma", color::gamma),
    ("ShaderNodeInvert", color::invert),
    ("ShaderNodeRGBToBW", color::to_bw),
    ("ShaderNodeBlackbody", color::blackbody),
    ("ShaderNodeWavelength", color::wavelength),
    ("ShaderNodeTexImage", texture::image),
    ("ShaderNodeTexIES", ies::ies),
    ("ShaderNodeTexEnvironment", texture::environment),
    ("ShaderNodeTexNoise", procedural::noise),
    ("ShaderNodeTexVoronoi", procedural::voronoi),
    ("ShaderNodeTexWave", procedural::wave),
    ("ShaderNodeTexMagic", procedural::magic),
    ("ShaderNodeTexBrick", procedural::brick),
    ("ShaderNodeTexChecker", procedural::checker),
    ("ShaderNodeTexGradient", procedural::gradient),
    ("ShaderNodeTexWhiteNoise", procedural::white_noise),
    ("ShaderNodeTexGabor", procedural::gabor),
    ("ShaderNodeTexSky", sky::sky),
    ("ShaderNodeMapping", vector::mapping),
    ("ShaderNodeNormal", vector::normal),
    ("ShaderNodeNormalMap", vector::normal_map),
    ("ShaderNodeBump", vector::bump),
    ("ShaderNodeDisplacement", displacement::displacement),
    ("ShaderNodeVectorDisplacement", displacement::vector),
    ("ShaderNodeVectorRotate", vector::rotate),
    ("ShaderNodeVectorTransform", vector::transform),
    ("ShaderNodeVectorCurve", vector::curves),
];

/// The value of an output. A node that is not in the table is told once; its own default stands for it.
pub fn output<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: usize) -> ValueId {
    let Some(socket) = at.node.outputs.get(output) else { return flow.graph.number(0.0) };
    match NODES.iter().find(|(name, _)| *name == at.node.r#type) {
        Some((_, make)) => make(flow, at, &socket.id),
        None => {
            flow.warn(format!(
                "the node \"{}\" ({}) is not supported; its default stands for it",
                at.node.name, at.node.r#type
            ));
            flow.graph.constant(socket.value.places())
        }
    }
}
