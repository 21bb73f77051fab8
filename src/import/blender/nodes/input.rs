//! Nodes of the Input menu.

use super::super::mesh::tangents_of;
use super::flow::{At, Flow};
use crate::desc::graph::{Function, Leaf, PathInfo, Quantity, Space, ValueId};

/// Value and RGB.
pub fn constant<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let value = at.node.outputs.first().map(|socket| socket.value.places()).unwrap_or_default();
    flow.graph.constant(value)
}

/// Texture Coordinate.
pub fn texture_coordinate<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    match output {
        "Generated" => flow.graph.leaf(Leaf::Generated),
        "Normal" => flow.object_normal(),
        "UV" => flow.graph.uv_upwards(0),
        "Object" => object_coordinates(flow, at),
        "Camera" => flow.graph.leaf(Leaf::CameraPosition),
        "Window" => flow.graph.leaf(Leaf::Window),
        _ => {
            let normal = flow.normal();
            flow.graph.reflection(normal)
        }
    }
}

/// The point in the space of the object that the node names, or of its own.
fn object_coordinates<'a>(flow: &mut Flow<'a, '_>, at: At<'a>) -> ValueId {
    let matrix: Option<[[f64; 4]; 4]> =
        at.node.properties.get("object").and_then(|json| serde_json::from_value(json.clone()).ok());
    let Some(matrix) = matrix else { return flow.graph.leaf(Leaf::ObjectPosition) };
    let inverse = super::super::transform::affine(&matrix).inverse();
    let [x, y, z] = [inverse.matrix3.x_axis, inverse.matrix3.y_axis, inverse.matrix3.z_axis];
    let row = |i: usize| [x[i], y[i], z[i], inverse.translation[i]];
    let position = flow.graph.leaf(Leaf::Position);
    flow.graph.affine([row(0), row(1), row(2)], position)
}

/// UV Map: (0, 0, 0) for a map that nothing in the scene has, as in Cycles.
pub fn uv_map<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    uv_set(flow, at.node.text("uv_map"))
}

/// The UV map of a name, v upwards; 0 where nothing has it.
pub fn uv_set(flow: &mut Flow<'_, '_>, name: &str) -> ValueId {
    match flow.uv_sets.set(name) {
        Some(set) => flow.graph.uv_upwards(set),
        None => flow.graph.number(0.0),
    }
}

/// The attribute of meshes that Random Per Island reads.
const RANDOM_PER_ISLAND: &str = "random per island";

/// The attribute of meshes that Pointiness reads.
const POINTINESS: &str = "pointiness of the mesh";

/// Geometry.
pub fn geometry<'a>(flow: &mut Flow<'a, '_>, _: At<'a>, output: &str) -> ValueId {
    let of_mesh = |name: &str| Leaf::Attribute { name: name.into(), fallback: [0.0; 4] };
    let leaf = match output {
        "Position" => Leaf::Position,
        "Normal" => return flow.normal(),
        "Tangent" => Leaf::RadialTangent,
        "True Normal" => Leaf::TrueNormal,
        "Incoming" => Leaf::Incoming,
        "Parametric" => Leaf::Parametric,
        "Backfacing" => Leaf::Backfacing,
        "Random Per Island" => of_mesh(RANDOM_PER_ISLAND),
        "Pointiness" => of_mesh(POINTINESS),
        _ => {
            flow.warn(format!("the output {output} of the Geometry node is not supported; 0 is taken for it"));
            return flow.graph.number(0.0);
        }
    };
    flow.graph.leaf(leaf)
}

/// Attribute.
pub fn attribute<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let (name, of) = (at.node.text("attribute_name"), at.node.text("attribute_type"));
    if of != "GEOMETRY" {
        // The add-on sends those that are asked for with the objects.
        let name = format!("{of} {name}");
        let value = flow.graph.leaf(Leaf::Attribute { name: name.into(), fallback: [0.0; 4] });
        return match output {
            "Fac" => flow.graph.average(value),
            "Alpha" => flow.graph.place(value, 3),
            _ => value,
        };
    }
    if flow.uv_sets.set(name).is_some() && !name.is_empty() {
        let uv = uv_set(flow, name);
        return match output {
            // Of two numbers it is the first one, of three or four their mean.
            "Fac" => flow.graph.place(uv, 0),
            "Alpha" => flow.graph.number(1.0),
            _ => uv,
        };
    }
    let value = flow.graph.leaf(Leaf::Attribute { name: name.into(), fallback: [0.0; 4] });
    match output {
        "Fac" => flow.graph.average(value),
        "Alpha" => flow.graph.place(value, 3),
        _ => value,
    }
}

/// Color Attribute.
pub fn color_attribute<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let name = at.node.text("layer_name");
    let value = flow.graph.leaf(Leaf::Attribute { name: name.into(), fallback: [0.0; 4] });
    if output == "Alpha" { flow.graph.place(value, 3) } else { value }
}

/// Object Info.
pub fn object_info<'a>(flow: &mut Flow<'a, '_>, _: At<'a>, output: &str) -> ValueId {
    let leaf = match output {
        "Location" => Leaf::ObjectLocation,
        "Color" => Leaf::ObjectColor,
        "Alpha" => {
            let color = flow.graph.leaf(Leaf::ObjectColor);
            return flow.graph.place(color, 3);
        }
        "Object Index" => Leaf::ObjectIndex,
        "Material Index" => Leaf::MaterialIndex,
        _ => Leaf::ObjectRandom,
    };
    flow.graph.leaf(leaf)
}

/// Light Path.
pub fn light_path<'a>(flow: &mut Flow<'a, '_>, _: At<'a>, output: &str) -> ValueId {
    let info = match output {
        "Is Camera Ray" => PathInfo::IsCamera,
        "Is Shadow Ray" => PathInfo::IsShadow,
        "Is Diffuse Ray" => PathInfo::IsDiffuse,
        "Is Glossy Ray" => PathInfo::IsGlossy,
        "Is Singular Ray" => PathInfo::IsSingular,
        "Is Reflection Ray" => PathInfo::IsReflection,
        "Is Transmission Ray" => PathInfo::IsTransmission,
        "Ray Length" => PathInfo::Length,
        "Ray Depth" => PathInfo::Depth,
        "Diffuse Depth" => PathInfo::DiffuseDepth,
        "Glossy Depth" => PathInfo::GlossyDepth,
        "Transmission Depth" => PathInfo::TransmissionDepth,
        "Transparent Depth" => PathInfo::TransparentDepth,
        // There are no volumes that scatter, and no portals.
        _ => return flow.graph.number(0.0),
    };
    flow.graph.leaf(Leaf::Path(info))
}

/// Camera Data.
pub fn camera_data<'a>(flow: &mut Flow<'a, '_>, _: At<'a>, output: &str) -> ValueId {
    let position = flow.graph.leaf(Leaf::CameraPosition);
    match output {
        "View Z Depth" => {
            let z = flow.graph.place(position, 2);
            flow.graph.math(crate::desc::graph::Math::Absolute, &[z])
        }
        "View Distance" => flow.graph.apply(Function::Length(3), &[position]),
        _ => flow.graph.apply(Function::Normalize(3), &[position]),
    }
}

/// Tangent; world space.
pub fn tangent<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    if at.node.text("direction_type") == "UV_MAP" {
        let tangent = tangent_of_map(flow, at.node.text("uv_map"));
        return flow.graph.transform(Quantity::Vector, Space::Object, Space::World, tangent);
    }
    // Around the axis through the middle of the generated coordinates; rows of what the place there makes of it.
    let rows = match at.node.text("axis") {
        "X" => [[0.0; 4], [0.0, 0.0, -1.0, 0.5], [0.0, 1.0, 0.0, -0.5]],
        "Y" => [[0.0, 0.0, -1.0, 0.5], [0.0; 4], [1.0, 0.0, 0.0, -0.5]],
        _ => return flow.graph.leaf(Leaf::RadialTangent),
    };
    let place = flow.graph.leaf(Leaf::Generated);
    let around = flow.graph.affine(rows, place);
    let around = flow.graph.transform(Quantity::Normal, Space::Object, Space::World, around);
    let normal = flow.normal();
    let across = flow.graph.apply(Function::Cross, &[around, normal]);
    let across = flow.graph.apply(Function::Normalize(3), &[across]);
    flow.graph.apply(Function::Cross, &[normal, across])
}

/// The tangent of the UV map of a name, object space, with the sign of the bitangent.
pub fn tangent_of_map(flow: &mut Flow<'_, '_>, name: &str) -> ValueId {
    let leaf = match flow.uv_sets.set(name) {
        Some(set) if set != 0 => Leaf::Attribute { name: tangents_of(name).into(), fallback: [0.0; 4] },
        _ => Leaf::Tangent,
    };
    flow.graph.leaf(leaf)
}

/// Fresnel.
pub fn fresnel<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let ior = flow.input(at, "IOR");
    let normal = flow.linked_or(at, "Normal", |flow| flow.normal());
    flow.graph.fresnel(ior, normal)
}

/// Layer Weight.
pub fn layer_weight<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let blend = flow.input(at, "Blend");
    let normal = flow.linked_or(at, "Normal", |flow| flow.normal());
    if output == "Fresnel" { flow.graph.layer_fresnel(blend, normal) } else { flow.graph.layer_facing(blend, normal) }
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
            let ends = Ends { points: &[2], ..Ends::default() };
            scene.set_rounds(2, "hair", &[0.0; 6], &[1.0; 2], ends, [&uvs, &[]]).unwrap();
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
