//! Materials, textures and variants.

use std::io::Cursor;

use base64::Engine;
use penumbra::desc::graph::{Layer, Op};
use penumbra::desc::{
    AlphaMode, Attribute, Channel, ColorSpace, Filter, MaterialDesc, NormalInput, PixelData, SceneDesc, Wrap,
};
use penumbra::error::{Place, Warnings};
use penumbra::import::{ImportOptions, gltf};
use serde_json::{Value, json};

use super::glb::Glb;
use super::{load, load_warned, load_with, read};

/// A PNG of one color.
fn png(color: [u8; 4]) -> Vec<u8> {
    let mut out = Cursor::new(Vec::new());
    image::RgbaImage::from_pixel(2, 2, image::Rgba(color)).write_to(&mut out, image::ImageFormat::Png).unwrap();
    out.into_inner()
}

/// A triangle with UVs, one texture and the material `material`.
fn with_material(material: Value) -> Glb {
    let mut glb = Glb::triangle();
    let uv = glb.floats("VEC2", &[0.0, 1.0, 1.0, 1.0, 0.0, 0.0]);
    glb.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(uv);
    glb.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let view = glb.view(&png([255, 128, 0, 64]));
    glb.push("images", json!({"name": "I", "bufferView": view, "mimeType": "image/png"}));
    glb.push("samplers", json!({"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}));
    glb.push("textures", json!({"source": 0, "sampler": 0}));
    glb.push("materials", material);
    glb
}

fn material(scene: &SceneDesc) -> &MaterialDesc {
    &scene.materials[scene.instances[0].materials[0].unwrap() as usize]
}

#[test]
fn every_field_of_the_core_model() {
    let scene = load(&with_material(json!({
        "name": "Skin",
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "baseColorTexture": {"index": 0},
            "metallicFactor": 0.5, "roughnessFactor": 0.6, "metallicRoughnessTexture": {"index": 0},
        },
        "emissiveFactor": [1, 0.5, 0], "emissiveTexture": {"index": 0},
        "occlusionTexture": {"index": 0, "strength": 0.7},
        "alphaMode": "MASK", "alphaCutoff": 0.3, "doubleSided": true,
    })));
    let m = material(&scene);
    assert_eq!((&*m.name, m.material_index, m.double_sided), ("Skin", 1, true));
    assert_eq!((m.base_color.factor, m.alpha.factor), ([0.1, 0.2, 0.3], 0.4));
    assert_eq!(m.alpha.texture.unwrap().1, Channel::A);
    assert_eq!((m.metallic.factor, m.metallic.texture.unwrap().1), (0.5, Channel::B));
    assert_eq!((m.roughness.factor, m.roughness.texture.unwrap().1), (0.6, Channel::G));
    assert_eq!((m.occlusion.unwrap().factor, m.occlusion.unwrap().texture.unwrap().1), (0.7, Channel::R));
    assert_eq!((m.emission.factor, m.emission_strength), ([1.0, 0.5, 0.0], 1.0));
    assert_eq!(m.alpha_mode, AlphaMode::Mask { cutoff: 0.3 });
    // One file image as colour and as data: two images of equal texels.
    assert_eq!(scene.images.len(), 2);
    let space = |texture: u32| scene.images[scene.textures[texture as usize].image as usize].color_space;
    assert_eq!(space(m.base_color.texture.unwrap().texture), ColorSpace::Srgb);
    assert_eq!(space(m.emission.texture.unwrap().texture), ColorSpace::Srgb);
    assert_eq!(space(m.roughness.texture.unwrap().0.texture), ColorSpace::Linear);
    assert_eq!(scene.images[0].pixels, PixelData::U8([255, 128, 0, 64].repeat(4)));
    let texture = &scene.textures[0];
    assert_eq!((texture.wrap_u, texture.wrap_v, texture.filter), (Wrap::Clamp, Wrap::Mirror, Filter::Nearest));
}

#[test]
fn every_material_extension() {
    let t = json!({"index": 0});
    let scene = load(&with_material(json!({"extensions": {
        "KHR_materials_transmission": {"transmissionFactor": 0.9, "transmissionTexture": t},
        "KHR_materials_ior": {"ior": 1.7},
        "KHR_materials_volume": {"thicknessFactor": 2, "thicknessTexture": t, "attenuationDistance": 3, "attenuationColor": [0.1, 0.2, 0.3]},
        "KHR_materials_specular": {"specularFactor": 0.8, "specularTexture": t, "specularColorFactor": [2, 1, 0.5], "specularColorTexture": t},
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.7, "clearcoatTexture": t, "clearcoatRoughnessFactor": 0.2, "clearcoatRoughnessTexture": t, "clearcoatNormalTexture": {"index": 0, "scale": 2}},
        "KHR_materials_sheen": {"sheenColorFactor": [0.3, 0.2, 0.1], "sheenColorTexture": t, "sheenRoughnessFactor": 0.4, "sheenRoughnessTexture": t},
        "KHR_materials_emissive_strength": {"emissiveStrength": 12},
        "KHR_materials_unlit": {},
        "KHR_materials_iridescence": {"iridescenceFactor": 0.6, "iridescenceTexture": t, "iridescenceIor": 1.4, "iridescenceThicknessMinimum": 50, "iridescenceThicknessMaximum": 500, "iridescenceThicknessTexture": t},
        "KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": 1.25, "anisotropyTexture": t},
        "KHR_materials_dispersion": {"dispersion": 0.33},
        "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.25, "diffuseTransmissionTexture": t, "diffuseTransmissionColorFactor": [0.4, 0.5, 0.6], "diffuseTransmissionColorTexture": t},
    }})));
    let m = material(&scene);
    let channel = |input: penumbra::desc::ScalarInput| (input.factor, input.texture.unwrap().1);
    assert_eq!(channel(m.transmission), (0.9, Channel::R));
    assert_eq!((m.ior.factor, m.dispersion, m.unlit, m.emission_strength), (1.7, 0.33, true, 12.0));
    let volume = m.volume.unwrap();
    assert_eq!((channel(volume.thickness), volume.attenuation_distance), ((2.0, Channel::G), 3.0));
    assert_eq!(volume.attenuation_color, [0.1, 0.2, 0.3]);
    assert_eq!((channel(m.specular), m.specular_color.factor), ((0.8, Channel::A), [2.0, 1.0, 0.5]));
    let coat = m.coat.unwrap();
    let NormalInput::Map { scale, .. } = coat.normal.unwrap() else { panic!() };
    assert_eq!((channel(coat.weight), channel(coat.roughness)), ((0.7, Channel::R), (0.2, Channel::G)));
    assert_eq!((scale, coat.ior.factor), (2.0, 1.5));
    let sheen = m.sheen.unwrap();
    assert_eq!((sheen.color.factor, channel(sheen.roughness)), ([0.3, 0.2, 0.1], (0.4, Channel::A)));
    let film = m.iridescence.unwrap();
    assert_eq!((channel(film.weight), film.ior.factor), ((0.6, Channel::R), 1.4));
    assert_eq!((film.thickness_min, film.thickness_max), (50.0, 500.0));
    assert_eq!(film.thickness.texture.unwrap().1, Channel::G);
    let anisotropy = m.anisotropy.unwrap();
    assert_eq!((anisotropy.strength.factor, anisotropy.rotation.factor), (0.5, 1.25));
    let translucent = m.translucent.unwrap();
    assert_eq!((channel(translucent.weight), translucent.color.factor), ((0.25, Channel::A), [0.4, 0.5, 0.6]));
    let space = |texture: u32| scene.images[scene.textures[texture as usize].image as usize].color_space;
    for texture in [sheen.color.texture, m.specular_color.texture, translucent.color.texture] {
        assert_eq!(space(texture.unwrap().texture), ColorSpace::Srgb);
    }
    assert_eq!(space(anisotropy.texture.unwrap().texture), ColorSpace::Linear);
    assert!(scene.meshes[0].tangents.is_some(), "anisotropy needs tangents");
}

/// The share alone: what passes is white.
#[test]
fn diffuse_transmission_is_no_reason_to_warn() {
    let extension = json!({"KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.25}});
    let mut glb = with_material(json!({"extensions": extension}));
    glb.json["extensionsUsed"] = json!(["KHR_materials_diffuse_transmission"]);
    glb.json["extensionsRequired"] = glb.json["extensionsUsed"].clone();
    let scene = load(&glb);
    let translucent = material(&scene).translucent.unwrap();
    assert_eq!((translucent.weight.factor, translucent.color.factor), (0.25, [1.0; 3]));
}

/// Sheen and clearcoat dim it; without emission there is nothing to dim.
#[test]
fn emission_is_below_the_layers() {
    let t = json!({"index": 0});
    let layers = |emissive: [f64; 3]| {
        load(&with_material(json!({"emissiveFactor": emissive, "extensions": {
            "KHR_materials_clearcoat": {"clearcoatFactor": 0.7, "clearcoatTexture": t, "clearcoatRoughnessFactor": 0.2, "clearcoatNormalTexture": {"index": 0, "scale": 2}},
            "KHR_materials_sheen": {"sheenColorFactor": [0.3, 0.2, 0.1], "sheenRoughnessFactor": 0.4},
        }})))
    };
    let glowing = layers([0.5, 1.0, 2.0]);
    let m = material(&glowing);
    assert_eq!(m.emission.factor, [0.5, 1.0, 2.0]);
    let below = m.emission.graph.unwrap();
    let found: Vec<Layer> = (0..=below.index())
        .filter_map(|i| match m.graph.ops()[i] {
            Op::Albedo { layer, .. } => Some(layer),
            _ => None,
        })
        .collect();
    assert_eq!(found, [Layer::Coat, Layer::Sheen]);
    assert_eq!(material(&layers([0.0; 3])).emission.graph, None);
}

#[test]
fn specular_glossiness_keeps_its_reflectance() {
    let scene = load(&with_material(json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor": [0.5, 0.4, 0.3, 0.2], "specularFactor": [0.2, 0.1, 0.04], "glossinessFactor": 0.75,
    }}})));
    let m = material(&scene);
    assert_eq!((m.base_color.factor, m.alpha.factor, m.metallic.factor), ([0.5, 0.4, 0.3], 0.2, 0.0));
    assert_eq!((m.roughness.factor, m.ior.factor), (0.25, 1.5));
    for (color, expected) in m.specular_color.factor.iter().zip([0.2, 0.1, 0.04]) {
        assert!((0.04 * color - expected).abs() < 1e-12);
    }
}

#[test]
fn texture_transforms_and_uv_sets_are_per_use() {
    let transform =
        json!({"offset": [0.5, 0.25], "rotation": std::f64::consts::FRAC_PI_2, "scale": [2, 4], "texCoord": 0});
    let scene = load(&with_material(json!({"normalTexture": {
        "index": 0, "texCoord": 3, "scale": 0.5, "extensions": {"KHR_texture_transform": transform},
    }})));
    let NormalInput::Map { texture, scale } = material(&scene).normal.unwrap() else { panic!() };
    assert_eq!((texture.uv_set, scale), (0, 0.5));
    let [u, v] = texture.transform.0;
    for (value, expected) in u.iter().chain(&v).zip([0.0, 4.0, 0.5, -2.0, 0.0, 0.25]) {
        assert!((value - expected).abs() < 1e-12, "{u:?} {v:?}");
    }
    let Some(Attribute::Corner(tangents)) = &scene.meshes[0].tangents else { panic!("no tangents") };
    assert_eq!(tangents.len(), 3);
}

#[test]
fn variants_by_name() {
    let mut glb = with_material(json!({"name": "plain"}));
    glb.push("materials", json!({"name": "red"}));
    glb.json["extensions"] = json!({"KHR_materials_variants": {"variants": [{"name": "Day"}, {"name": "Night"}]}});
    let mappings = json!([{"material": 1, "variants": [1]}]);
    glb.set("/meshes/0/primitives/0/extensions", json!({"KHR_materials_variants": {"mappings": mappings}}));
    let named = |name: &str| ImportOptions { variants: vec![name.into()], ..ImportOptions::default() };
    assert_eq!(load(&glb).variants, ["Day", "Night"]);
    assert_eq!(&*material(&load(&glb)).name, "plain");
    assert_eq!(&*material(&load_with(&glb, &named("Night"))).name, "red");
    assert_eq!(&*material(&load_with(&glb, &named("Day"))).name, "plain");
    let message = read(&glb.bytes(), &named("Dusk")).0.unwrap_err().to_string();
    assert!(message.contains("Dusk") && message.contains("Day, Night"), "{message}");
}

#[test]
fn images_from_data_uris_files_and_webp() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("my maps")).unwrap();
    std::fs::write(folder.path().join("my maps/ä.png"), png([1, 2, 3, 4])).unwrap();
    let mut glb = with_material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    let data = base64::engine::general_purpose::STANDARD.encode(png([5, 6, 7, 8]));
    let mut webp = Cursor::new(Vec::new());
    let pixel = image::RgbaImage::from_pixel(2, 2, image::Rgba([9, 10, 11, 12]));
    pixel.write_to(&mut webp, image::ImageFormat::WebP).unwrap();
    let webp = glb.view(webp.get_ref());
    glb.push("images", json!({"bufferView": webp, "mimeType": "image/webp"}));
    for (texture, image, first) in [
        (json!({"source": 0}), json!({"uri": "my%20maps/%C3%A4.png"}), 1),
        (json!({"source": 0}), json!({"uri": format!("data:image/png;base64,{data}")}), 5),
        (json!({"source": 0, "extensions": {"EXT_texture_webp": {"source": 1}}}), json!({"uri": "absent.png"}), 9),
    ] {
        glb.json["textures"][0] = texture;
        glb.json["images"][0] = image;
        let mut warnings = Warnings::new();
        let place = Place::file("test.glb");
        let options = ImportOptions::default();
        let scene = gltf::from_bytes(&glb.bytes(), Some(folder.path()), &place, &options, &mut warnings).unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!(scene.images[0].pixels.get(0), first as f32 / 255.0);
    }
}

#[test]
fn an_image_that_does_not_decode_leaves_the_factor() {
    for image in
        [json!({"name": "Bark", "uri": "data:image/png;base64,AAAA"}), json!({"name": "Bark", "uri": "no.png"})]
    {
        let mut glb = with_material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
        glb.json["images"][0] = image;
        let scene = load_warned(&glb, &["Bark"]);
        assert!(scene.images.is_empty() && material(&scene).base_color.texture.is_none());
    }
}

#[test]
fn what_nothing_uses_is_not_decoded() {
    let mut glb = with_material(json!({}));
    glb.json["images"][0] = json!({"uri": "absent.png"});
    glb.push("materials", json!({"name": "unused", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    assert_eq!(load(&glb).materials.len(), 1);
}

#[test]
fn factors_out_of_range_are_held_and_told() {
    let scene = load_warned(
        &with_material(json!({"name": "Odd", "pbrMetallicRoughness": {"metallicFactor": 3}})),
        &["Odd", "3"],
    );
    assert_eq!(material(&scene).metallic.factor, 1.0);
}

#[test]
fn ktx2_is_read_past_where_there_is_another_image_and_refused_by_name_where_not() {
    let mut glb = with_material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    glb.push("images", json!({"uri": "absent.ktx2"}));
    glb.json["extensionsRequired"] = json!(["KHR_texture_basisu"]);
    glb.json["textures"][0]["extensions"] = json!({"KHR_texture_basisu": {"source": 1}});
    assert!(material(&load(&glb)).base_color.texture.is_some());
    glb.json["textures"][0].as_object_mut().unwrap().remove("source");
    super::refused(&glb.bytes(), &["KHR_texture_basisu"]);
    glb.json.as_object_mut().unwrap().remove("extensionsRequired");
    load_warned(&glb, &["KHR_texture_basisu"]);
}
