//! Every material of the assets in `../shared/assets/usd`, where they are. Values beside a path are what
//! usd-core 26.11 reads there, or what the MaterialX documents say.

use std::path::{Path, PathBuf};

use super::super::*;
use super::same;
use crate::desc::{AlphaMode, Channel, ColorSpace, TextureTransform, Wrap};
use crate::import::ImportOptions;

fn assets() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets/usd");
    if !folder.exists() {
        println!("{} is not there: nothing to read", folder.display());
    }
    folder.exists().then_some(folder)
}

/// The materials at `paths` of a stage, with its tables, and what was told.
fn read(file: &str, paths: &[&str]) -> Option<(Vec<Option<MaterialDesc>>, SceneDesc, String)> {
    let options = ImportOptions::default();
    let reading = Reading::open(&assets()?.join(file), &options).unwrap();
    let paths: Vec<sdf::Path> = paths.iter().map(|path| sdf::Path::new(path).unwrap()).collect();
    let mut materials = Materials::new(&reading, Images::default(), BTreeSet::new(), Vec::new());
    materials.preload(&paths);
    let found: Vec<Option<u32>> = paths.iter().map(|path| materials.at(path)).collect();
    let found = found.into_iter().map(|index| index.and_then(|index| materials.get(index).cloned())).collect();
    let mut scene = SceneDesc::default();
    materials.finish(&mut scene);
    crate::desc::check(&scene).unwrap();
    let warnings: Vec<String> = reading.warnings.take().iter().map(ToString::to_string).collect();
    let warnings = warnings.join("\n");
    println!("{file}:\n{warnings}");
    Some((found, scene, warnings))
}

#[test]
fn cornell_boxes_are_the_same_in_three_languages() {
    let names = ["white", "green", "red", "light"];
    for (file, scope) in [
        ("cornell-box/usdpreviewsurface/cornell-box.usda", "/cornell_box/materials"),
        ("cornell-box/mtlx-usdshade/cornell-box.usda", "/cornell_box/materials"),
        ("cornell-box/mtlx-ref/cornell-box.usda", "/cornell_box/MaterialX/Materials"),
    ] {
        let paths = names.map(|name| format!("{scope}/{name}"));
        let Some((found, _, warnings)) = read(file, &paths.each_ref().map(String::as_str)) else { return };
        let colors = [[0.725, 0.71, 0.68], [0.14, 0.45, 0.091], [0.63, 0.065, 0.05]];
        for (material, color) in found.iter().zip(colors) {
            let material = material.as_ref().unwrap();
            same(&material.base_color.factor, &color);
            same(&[material.roughness.factor, material.ior.factor], &[1.0, 1.5]);
            assert_eq!(material.alpha_mode, AlphaMode::Opaque);
        }
        let light = found[3].as_ref().unwrap();
        same(&light.emission.factor, &[17.0, 12.0, 4.0]);
        same(&light.base_color.factor, &[0.18; 3]);
        assert_eq!(warnings, "");
    }
    let mdl = read("cornell-box/mdl/cornell-box.usda", &["/cornell_box/materials/white"]).unwrap();
    assert!(mdl.0[0].is_none() && mdl.2.contains("mdl alone"), "{}", mdl.2);
}

#[test]
fn the_shader_ball_has_documents_and_networks() {
    let root = "/standard_shader_ball_scene/materials";
    let paths = [
        "examples/mtlx/plastic",
        "examples/mtlx/gold",
        "examples/mtlx/glass",
        "examples/mtlx/bubblegum",
        "neutral",
        "uvgrid",
        "sss_bars",
        "box_base",
        "back",
        "ground",
    ]
    .map(|name| format!("{root}/{name}"));
    let Some((found, scene, warnings)) =
        read("standard_shader_ball/standard_shader_ball_scene.usda", &paths.each_ref().map(String::as_str))
    else {
        return;
    };
    let [plastic, gold, glass, gum, neutral, grid, bars, base, back, ground] =
        <[Option<MaterialDesc>; 10]>::try_from(found).unwrap().map(|material| material.unwrap());
    // The stage's choice is OpenPBR: plastic_openpbr.mtlx and its siblings.
    same(&plastic.base_color.factor, &[0.209884, 0.562091, 0.766]);
    same(&[plastic.roughness.factor, plastic.metallic.factor], &[0.15, 0.0]);
    same(&gold.base_color.factor, &[0.910751, 0.793992, 0.405919]);
    same(&[gold.roughness.factor, gold.metallic.factor], &[0.01, 1.0]);
    same(&glass.base_color.factor, &[0.942, 1.0, 0.9884]);
    same(&[glass.ior.factor, glass.roughness.factor, glass.transmission.factor], &[1.54107, 0.01625, 1.0]);
    assert!(glass.volume.is_some());
    same(&gum.subsurface.unwrap().color.factor, &[1.0, 0.22, 0.493]);
    same(&[gum.specular_level.factor, gum.ior.factor], &[0.383, 1.584]);
    assert!(!warnings.contains("subsurface"), "{warnings}");
    // open_pbr_surface1: nothing drives its base color, the emission image is not named.
    same(&neutral.base_color.factor, &[0.8; 3]);
    same(&[neutral.specular_level.factor, neutral.roughness.factor], &[0.0, 0.0]);
    for textured in [&grid, &bars] {
        let texture = textured.base_color.texture.unwrap();
        let texture = &scene.textures[texture.texture as usize];
        assert_eq!((texture.wrap_u, texture.wrap_v), (Wrap::Repeat, Wrap::Repeat));
        assert_eq!(scene.images[texture.image as usize].color_space, ColorSpace::Linear);
    }
    for material in [&base, &back, &ground] {
        assert!(material.base_color.factor.iter().all(|c| c.is_finite()));
    }
}

#[test]
fn textures_of_a_package_are_read() {
    let names = ["Tex000", "Tex033", "Tex066", "Const000", "Const033", "Const066"];
    let paths = names.map(|name| format!("/Roughness/Materials/{name}"));
    let file = "usd-wg-tests/RoughnessTest/RoughnessTest.usdz";
    let Some((found, scene, warnings)) = read(file, &paths.each_ref().map(String::as_str)) else { return };
    let first = found[0].as_ref().unwrap();
    // float inputs:metallic = 0.6, ior = 1.45; roughness from r of roughness.tga, which is marked sRGB.
    same(&[first.metallic.factor, first.ior.factor], &[0.6, 1.45]);
    let (texture, channel) = first.roughness.texture.unwrap();
    let image = &scene.images[scene.textures[texture.texture as usize].image as usize];
    assert_eq!((&*image.name, image.color_space, channel), ("roughness.tga", ColorSpace::Srgb, Channel::R));
    let second = found[1].as_ref().unwrap();
    let (texture, channel) = second.roughness.texture.unwrap();
    let image = &scene.images[scene.textures[texture.texture as usize].image as usize];
    assert_eq!((image.color_space, channel), (ColorSpace::Linear, Channel::G));
    assert!(found.iter().all(Option::is_some), "{warnings}");
}

#[test]
fn texture_transforms_are_usd_cores() {
    let root = "/TextureTransformTest/Materials";
    let paths = ["Offset_V_53152", "Rotation_53154", "All_53140"].map(|name| format!("{root}/{name}"));
    let file = "usd-wg-tests/TextureTransformTest/TextureTransformTest.usd";
    let Some((found, scene, _)) = read(file, &paths.each_ref().map(String::as_str)) else { return };
    // rotation in degrees, scale, translation as usd-core reads them.
    let placed = [
        (0.0, 1.0, [0.0, -0.5]),
        (22.5, 1.0, [0.382_683_426_141_738_9, 0.076_120_495_796_203_61]),
        (17.188_734_054_565_43, 1.5, [0.243_280_336_260_795_6, -0.333_004_623_651_504_5]),
    ];
    for (material, (degrees, scale, [tx, ty])) in found.iter().zip(placed) {
        let texture = material.as_ref().unwrap().base_color.texture.unwrap();
        let TextureTransform([u, v]) = texture.transform;
        assert_eq!(scene.textures[texture.texture as usize].wrap_u, Wrap::Clamp);
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let (s, t) = (0.3, 0.6);
        let expected = [scale * (cos * s - sin * t) + tx, scale * (sin * s + cos * t) + ty];
        let at = |row: [f64; 3]| row[0] * s + row[1] * (1.0 - t) + row[2];
        same(&[at(u), 1.0 - at(v)], &expected);
    }
}

#[test]
fn file_formats_are_read_or_told_of() {
    for (name, channels, space) in [
        ("png_rgb_8-bit", 4, ColorSpace::Srgb),
        ("png_rgb_16-bit", 4, ColorSpace::Linear),
        ("png_grayscale_8-bit", 2, ColorSpace::Linear),
        ("png_grayscale_16-bit", 2, ColorSpace::Linear),
        ("jpeg_rgb_8-bit", 3, ColorSpace::Srgb),
        ("jpeg_grayscale_8-bit", 1, ColorSpace::Linear),
        ("jpeg_cmyk_8-bit", 3, ColorSpace::Srgb),
        ("png_rgb_32-bit", 4, ColorSpace::Linear),
    ] {
        let file = format!("usd-wg-tests/TextureFileFormatTests/{name}.usda");
        let paths = ["/Scene/Looks/MainMaterial", "/Scene/Looks/MainMaterialWithOpacity"];
        let Some((found, scene, warnings)) = read(&file, &paths) else { return };
        let texture = found[0].as_ref().unwrap().base_color.texture;
        let texture = texture.unwrap_or_else(|| panic!("{name}: {warnings}"));
        let image = &scene.images[scene.textures[texture.texture as usize].image as usize];
        println!("{name}: {} channels, {:?}, {:?}", image.channels, image.color_space, image.pixels);
        assert_eq!((image.channels, image.color_space), (channels, space), "{name}");
        // Those with alpha have some that is not 1, or may have.
        let material = found[1].as_ref().unwrap();
        let opaque = material.alpha_mode == AlphaMode::Opaque && material.transparency.graph.is_none();
        assert_eq!(opaque, channels % 2 == 1, "{name}");
    }
}
