//! Materials as JSON: constants, and what they are multiplied by.

use penumbra::desc::{AlphaMode, ColorInput, MaterialDesc, NormalInput, ScalarInput, SceneDesc, TextureRef};
use serde_json::{Value, json};

/// The inputs that every shading model has in some way.
pub fn describe(material: &MaterialDesc, scene: &SceneDesc) -> Value {
    let color = |input: &ColorInput| json!({ "factor": input.factor, "texture": texture(input.texture, scene), "graph": input.graph.is_some() });
    let scalar = |input: &ScalarInput| {
        let of = input.texture.map(|(texture, _)| texture);
        json!({ "factor": input.factor, "texture": texture(of, scene), "graph": input.graph.is_some() })
    };
    let normal = material.normal.map(|normal| match normal {
        NormalInput::Map { texture: map, scale } => json!({ "scale": scale, "texture": texture(Some(map), scene) }),
        NormalInput::Graph(_) => json!({ "graph": true }),
    });
    json!({
        "name": &*material.name,
        "place": material.place.node.as_deref(),
        "base_color": color(&material.base_color),
        "metallic": scalar(&material.metallic),
        "roughness": scalar(&material.roughness),
        "ior": scalar(&material.ior),
        "specular_color": color(&material.specular_color),
        "emission": color(&material.emission),
        "alpha": scalar(&material.alpha),
        "alpha_mode": match material.alpha_mode {
            AlphaMode::Opaque => json!("opaque"),
            AlphaMode::Mask { cutoff } => json!({ "mask": cutoff }),
            AlphaMode::Blend => json!("blend"),
        },
        "coat": material.coat.map(|coat| {
            json!({ "weight": scalar(&coat.weight), "roughness": scalar(&coat.roughness), "tint": color(&coat.tint) })
        }),
        "normal": normal,
    })
}

/// Name of the image, and the UV set that it is looked up by.
fn texture(texture: Option<TextureRef>, scene: &SceneDesc) -> Option<Value> {
    let texture = texture?;
    let image = &scene.images[scene.textures[texture.texture as usize].image as usize];
    Some(json!({ "image": &*image.name, "uv_set": texture.uv_set }))
}
