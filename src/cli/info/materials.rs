//! Materials as JSON: constants, and what they are multiplied by.

use penumbra::desc::graph::{Graph, Op, ValueId};
use penumbra::desc::{
    AlphaMode, ClosureDesc, ColorInput, MaterialDesc, NormalInput, PartDesc, ScalarInput, SceneDesc, TextureRef,
};
use serde_json::{Value, json};

/// The inputs that every shading model has in some way. A `graph` is the index of the value, in the list of the same
/// name, that comes on top of factor and texture; `null` for none.
pub fn describe(material: &MaterialDesc, scene: &SceneDesc) -> Value {
    let mut value = layers(material, scene);
    value["name"] = json!(&*material.name);
    value["place"] = json!(material.place.node.as_deref());
    value["emission"] = color(&material.emission, scene);
    value["emission_strength"] = json!(material.emission_strength);
    value["alpha"] = scalar(&material.alpha, scene);
    value["alpha_mode"] = match material.alpha_mode {
        AlphaMode::Opaque => json!("opaque"),
        AlphaMode::Mask { cutoff } => json!({ "mask": cutoff }),
        AlphaMode::Blend => json!("blend"),
    };
    value["transparency"] = color(&material.transparency, scene);
    value["occlusion"] = json!(material.occlusion.as_ref().map(|occlusion| scalar(occlusion, scene)));
    value["normal"] = json!(material.normal.map(|normal| match normal {
        NormalInput::Map { texture: map, scale } =>
            json!({ "scale": scale, "texture": texture(Some(map), scene), "graph": null }),
        NormalInput::Graph(value) => json!({ "graph": value.index() }),
    }));
    value["parts"] = json!(material.parts.iter().map(|desc| part(desc, scene)).collect::<Vec<_>>());
    value["graph"] = graph(&material.graph, scene);
    value
}

/// What scatters.
fn layers(material: &MaterialDesc, scene: &SceneDesc) -> Value {
    json!({
        "base_color": color(&material.base_color, scene),
        "metallic": scalar(&material.metallic, scene),
        "roughness": scalar(&material.roughness, scene),
        "ior": scalar(&material.ior, scene),
        "specular": scalar(&material.specular, scene),
        "specular_color": color(&material.specular_color, scene),
        "transmission": scalar(&material.transmission, scene),
        "coat": material.coat.map(|coat| json!({
            "weight": scalar(&coat.weight, scene),
            "roughness": scalar(&coat.roughness, scene),
            "ior": scalar(&coat.ior, scene),
            "tint": color(&coat.tint, scene),
        })),
    })
}

fn part(part: &PartDesc, scene: &SceneDesc) -> Value {
    let mut value = match &part.closure {
        ClosureDesc::Layered(material) => layers(material, scene),
        _ => json!({}),
    };
    value["weight"] = scalar(&part.weight, scene);
    value
}

fn color(input: &ColorInput, scene: &SceneDesc) -> Value {
    json!({ "factor": input.factor, "texture": texture(input.texture, scene), "graph": input.graph.map(ValueId::index) })
}

fn scalar(input: &ScalarInput, scene: &SceneDesc) -> Value {
    let mut map = texture(input.texture.map(|(texture, _)| texture), scene);
    if let (Some(map), Some((_, channel))) = (&mut map, input.texture) {
        map["channel"] = json!(format!("{channel:?}").to_lowercase());
    }
    json!({ "factor": input.factor, "texture": map, "graph": input.graph.map(ValueId::index) })
}

/// The image, how it is looked up, and by which UV set and what affine map of it (rows, v downwards).
fn texture(texture: Option<TextureRef>, scene: &SceneDesc) -> Option<Value> {
    let TextureRef { texture, uv_set, transform } = texture?;
    let mut value = image(texture, scene);
    value["uv_set"] = json!(uv_set);
    value["transform"] = json!(transform.0);
    Some(value)
}

fn image(texture: u32, scene: &SceneDesc) -> Value {
    let texture = &scene.textures[texture as usize];
    let image = &scene.images[texture.image as usize];
    let wrap = [texture.wrap_u, texture.wrap_v].map(|wrap| format!("{wrap:?}").to_lowercase());
    json!({
        "image": &*image.name,
        "space": format!("{:?}", image.color_space).to_lowercase(),
        "wrap": wrap,
    })
}

/// Each operation with the indices of its arguments, which come before it.
fn graph(graph: &Graph, scene: &SceneDesc) -> Value {
    let of = |op: &Op| match op {
        Op::Constant(value) => json!({ "op": "constant", "value": value }),
        Op::Image { texture, uv } => json!({ "op": "image", "texture": image(*texture, scene), "args": [uv.index()] }),
        Op::Leaf(leaf) => json!({ "op": "leaf", "what": format!("{leaf:?}") }),
        Op::Apply(function, args) => {
            let args: Vec<usize> = args.iter().map(|arg| arg.index()).collect();
            json!({ "op": "apply", "what": format!("{function:?}"), "args": args })
        }
        Op::Albedo { layer, roughness, ior, normal } => {
            let args = [roughness, ior, normal].map(|arg| arg.index());
            json!({ "op": "albedo", "what": format!("{layer:?}"), "args": args })
        }
        other => json!({ "op": "other", "what": format!("{other:?}") }),
    };
    json!(graph.ops().iter().map(of).collect::<Vec<_>>())
}
