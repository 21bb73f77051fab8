//! Small stages, read and compared with values worked out by hand.

use std::path::Path;

use super::super::images::tests::{png, stage};
use super::*;
use crate::desc::{AlphaMode, Channel, ColorSpace, PixelData, TextureTransform, Wrap};
use crate::import::ImportOptions;

/// A material, the tables that it points into, and what was told.
struct Read {
    material: Option<MaterialDesc>,
    colors: VertexColors,
    uv_sets: Vec<Arc<str>>,
    scene: SceneDesc,
    warnings: String,
}

impl Read {
    fn material(&self) -> &MaterialDesc {
        self.material.as_ref().unwrap_or_else(|| panic!("no material: {}", self.warnings))
    }

    fn texture(&self, index: u32) -> (&TextureDesc, &crate::desc::ImageDesc) {
        let texture = &self.scene.textures[index as usize];
        (texture, &self.scene.images[texture.image as usize])
    }
}

fn read_at(folder: &Path, text: &str, path: &str) -> Read {
    let options = ImportOptions::default();
    let reading = stage(folder, text, &options);
    let path = sdf::Path::new(path).unwrap();
    let mut materials = Materials::new(&reading, Images::default());
    materials.preload([&path]);
    let index = materials.at(&path);
    assert_eq!(materials.at(&path), index);
    let material = index.and_then(|index| materials.get(index).cloned());
    let colors = index.map(|index| materials.vertex_colors(index)).unwrap_or_default();
    let uv_sets = materials.uv_sets.clone();
    let mut scene = SceneDesc::default();
    materials.finish(&mut scene);
    crate::desc::check(&scene).unwrap();
    let warnings: Vec<String> = reading.warnings.take().iter().map(ToString::to_string).collect();
    Read { material, colors, uv_sets, scene, warnings: warnings.join("\n") }
}

/// `/m` with a surface of `id` and the given lines; `nodes` stand beside it.
fn material_of(context: &str, id: &str, lines: &str, nodes: &str) -> String {
    format!(
        "def Material \"m\" {{
            token outputs:{context}surface.connect = </m/s.outputs:surface>
            def Shader \"s\" {{ uniform token info:id = \"{id}\"
                {lines}
                token outputs:surface
            }}
            {nodes}
        }}"
    )
}

fn preview(lines: &str, nodes: &str) -> Read {
    let folder = tempfile::tempdir().unwrap();
    preview_in(folder.path(), lines, nodes)
}

fn preview_in(folder: &Path, lines: &str, nodes: &str) -> Read {
    read_at(folder, &material_of("", "UsdPreviewSurface", lines, nodes), "/m")
}

fn mtlx_in(folder: &Path, id: &str, lines: &str, nodes: &str) -> Read {
    read_at(folder, &material_of("mtlx:", id, lines, nodes), "/m")
}

fn mtlx(id: &str, lines: &str, nodes: &str) -> Read {
    let folder = tempfile::tempdir().unwrap();
    mtlx_in(folder.path(), id, lines, nodes)
}

const UV: &str = "def Shader \"uv\" { uniform token info:id = \"UsdPrimvarReader_float2\"
    string inputs:varname = \"st\"
    float2 outputs:result }";

fn texture(name: &str, lines: &str) -> String {
    format!(
        "def Shader \"{name}\" {{ uniform token info:id = \"UsdUVTexture\"
            float2 inputs:st.connect = </m/uv.outputs:result>
            {lines}
            float outputs:r
            float outputs:g
            float outputs:b
            float outputs:a
            float3 outputs:rgb }}"
    )
}

/// Values pass through USD's single precision.
fn close(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= 1e-6 * b.abs().max(1.0)
}

#[track_caller]
fn same(a: &[f64], b: &[f64]) {
    assert!(a.len() == b.len() && a.iter().zip(b).all(|(a, b)| close(*a, *b)), "{a:?} is not {b:?}");
}

#[test]
fn preview_surface_has_its_defaults() {
    let read = preview("", "");
    let m = read.material();
    assert_eq!(&*m.name, "m");
    same(&m.base_color.factor, &[0.18; 3]);
    same(&[m.metallic.factor, m.roughness.factor, m.ior, m.specular.factor], &[0.0, 0.5, 1.5, 1.0]);
    assert_eq!(m.alpha_mode, AlphaMode::Opaque);
    assert!(m.coat.is_none() && m.normal.is_none() && m.occlusion.is_none() && m.volume.is_none());
    assert_eq!(read.warnings, "");
}

#[test]
fn preview_surface_reads_every_input() {
    let read = preview(
        "color3f inputs:diffuseColor = (0.1, 0.2, 0.3)
         color3f inputs:emissiveColor = (4, 5, 6)
         float inputs:metallic = 0.7
         float inputs:roughness = 0.25
         float inputs:clearcoat = 0.5
         float inputs:clearcoatRoughness = 0.125
         float inputs:ior = 1.75
         float inputs:opacity = 0.5
         float inputs:displacement = 0.1",
        "",
    );
    let m = read.material();
    same(&m.base_color.factor, &[0.1, 0.2, 0.3]);
    same(&m.emission.factor, &[4.0, 5.0, 6.0]);
    same(&[m.metallic.factor, m.roughness.factor, m.ior, m.alpha.factor], &[0.7, 0.25, 1.75, 0.5]);
    assert_eq!(m.alpha_mode, AlphaMode::Blend);
    let coat = m.coat.unwrap();
    same(&[coat.weight.factor, coat.roughness.factor, coat.ior], &[0.5, 0.125, 1.75]);
    assert!(read.warnings.contains("displacement") && read.warnings.contains("/m/s"), "{}", read.warnings);
}

#[test]
fn the_specular_workflow_has_f0_for_its_color() {
    let read = preview(
        "int inputs:useSpecularWorkflow = 1
         color3f inputs:specularColor = (0.5, 0.02, 0.04)
         float inputs:metallic = 1
         float inputs:ior = 2",
        "",
    );
    let m = read.material();
    // F0 at index 1.5 is 0.04 times the tint.
    same(&m.specular_color.factor, &[12.5, 0.5, 1.0]);
    same(&[m.metallic.factor, m.ior], &[0.0, 1.5]);
}

#[test]
fn a_threshold_is_a_mask_in_both_modes() {
    for mode in ["transparent", "presence"] {
        let lines = format!(
            "float inputs:opacity = 0.4\nfloat inputs:opacityThreshold = 0.25\ntoken inputs:opacityMode = \"{mode}\""
        );
        let read = preview(&lines, "");
        let AlphaMode::Mask { cutoff } = read.material().alpha_mode else { panic!() };
        assert!(close(cutoff, 0.25));
    }
}

#[test]
fn textures_have_scale_wrap_space_and_channel() {
    let folder = tempfile::tempdir().unwrap();
    png(folder.path(), "a.png", 2, &[[255, 0, 0], [0, 255, 0], [0, 0, 255], [9, 9, 9]]);
    let nodes = [
        UV.to_string(),
        texture(
            "color",
            "asset inputs:file = @a.png@
             float4 inputs:scale = (0.5, 0.25, 1, 1)
             token inputs:wrapS = \"repeat\"
             token inputs:wrapT = \"mirror\"",
        ),
        texture(
            "raw",
            "asset inputs:file = @./a.png@\ntoken inputs:sourceColorSpace = \"raw\"\ntoken inputs:wrapS = \"clamp\"",
        ),
        texture(
            "bump",
            "asset inputs:file = @a.png@
             token inputs:sourceColorSpace = \"raw\"
             float4 inputs:scale = (1.4, 1.4, 2, 2)
             float4 inputs:bias = (-0.7, -0.7, -1, -1)",
        ),
    ]
    .join("\n");
    let read = preview_in(
        folder.path(),
        "color3f inputs:diffuseColor.connect = </m/color.outputs:rgb>
         float inputs:roughness.connect = </m/raw.outputs:g>
         float inputs:metallic.connect = </m/raw.outputs:b>
         float inputs:opacity.connect = </m/raw.outputs:a>
         float inputs:occlusion.connect = </m/raw.outputs:r>
         normal3f inputs:normal.connect = </m/bump.outputs:rgb>",
        &nodes,
    );
    let m = read.material();
    same(&m.base_color.factor, &[0.5, 0.25, 1.0]);
    let (texture, image) = read.texture(m.base_color.texture.unwrap().texture);
    assert_eq!((texture.wrap_u, texture.wrap_v, image.color_space), (Wrap::Repeat, Wrap::Mirror, ColorSpace::Srgb));
    let (roughness, channel) = m.roughness.texture.unwrap();
    assert_eq!(channel, Channel::G);
    assert_eq!(m.metallic.texture.unwrap(), (roughness, Channel::B));
    let (texture, image) = read.texture(roughness.texture);
    // "useMetadata", the default, is black without metadata.
    assert_eq!((texture.wrap_u, texture.wrap_v, image.color_space), (Wrap::Clamp, Wrap::Black, ColorSpace::Linear));
    // The alpha of an image without is 1.
    assert_eq!((m.alpha, m.alpha_mode), (ScalarInput::constant(1.0), AlphaMode::Opaque));
    assert_eq!(m.occlusion.unwrap(), ScalarInput { factor: 1.0, texture: Some((roughness, Channel::R)) });
    let normal = m.normal.unwrap();
    assert!(close(normal.scale, 0.7));
    assert_eq!((read.scene.images.len(), read.scene.textures.len()), (2, 3));
    assert_eq!(read.warnings, "");
}

#[test]
fn transforms_scale_then_turn_then_move() {
    let folder = tempfile::tempdir().unwrap();
    png(folder.path(), "a.png", 1, &[[1, 2, 3]]);
    let nodes = "
        def Shader \"uv\" { uniform token info:id = \"UsdPrimvarReader_float2\"
            token inputs:varname = \"map2\"
            float2 outputs:result }
        def Shader \"turn\" { uniform token info:id = \"UsdTransform2d\"
            float2 inputs:in.connect = </m/uv.outputs:result>
            float inputs:rotation = 90
            float2 inputs:scale = (2, 3)
            float2 inputs:translation = (0.25, 0.5)
            float2 outputs:result }
        def Shader \"t\" { uniform token info:id = \"UsdUVTexture\"
            asset inputs:file = @a.png@
            float2 inputs:st.connect = </m/turn.outputs:result>
            float3 outputs:rgb }";
    let read = preview_in(folder.path(), "color3f inputs:diffuseColor.connect = </m/t.outputs:rgb>", nodes);
    let texture = read.material().base_color.texture.unwrap();
    assert_eq!(&*read.uv_sets[texture.uv_set as usize], "map2");
    let TextureTransform([u, v]) = texture.transform;
    // st = (0.1, 0.2) of the shape: scaled (0.2, 0.6), turned (−0.6, 0.2), moved (−0.35, 0.7); in UVs that
    // grow downwards that is (0.1, 0.8) to (−0.35, 0.3).
    let at = [0.1, 0.8, 1.0];
    let dot = |row: [f64; 3]| row.iter().zip(at).map(|(a, b)| a * b).sum::<f64>();
    same(&[dot(u), dot(v)], &[-0.35, 0.3]);
}

#[test]
fn what_is_missing_has_its_fallback_and_a_warning() {
    let nodes = [
        UV.to_string(),
        texture("gone", "asset inputs:file = @gone.png@\nfloat4 inputs:fallback = (0.1, 0.2, 0.3, 0.4)"),
        texture("none", ""),
    ]
    .join("\n");
    let read = preview(
        "color3f inputs:diffuseColor.connect = </m/gone.outputs:rgb>
         float inputs:opacity.connect = </m/gone.outputs:a>
         color3f inputs:emissiveColor.connect = </m/none.outputs:rgb>",
        &nodes,
    );
    let m = read.material();
    same(&m.base_color.factor, &[0.1, 0.2, 0.3]);
    same(&[m.alpha.factor], &[0.4]);
    same(&m.emission.factor, &[0.0; 3]);
    for expected in ["gone.png", "/m/gone", "test.usda", "fallback (0.1", "/m/none"] {
        assert!(read.warnings.contains(expected), "{expected}: {}", read.warnings);
    }
}

#[test]
fn values_come_through_graphs_and_interfaces() {
    let folder = tempfile::tempdir().unwrap();
    png(folder.path(), "a.png", 1, &[[1, 2, 3]]);
    let text = "def Material \"m\" {
        float inputs:rough = 0.3
        asset inputs:map = @a.png@
        token outputs:surface.connect = </m/g.outputs:surface>
        def NodeGraph \"g\" {
            float inputs:rough.connect = </m.inputs:rough>
            asset inputs:map.connect = </m.inputs:map>
            token outputs:surface.connect = </m/g/s.outputs:surface>
            color3f outputs:color.connect = </m/g/t.outputs:rgb>
            def Shader \"s\" { uniform token info:id = \"UsdPreviewSurface\"
                float inputs:roughness.connect = </m/g.inputs:rough>
                color3f inputs:diffuseColor.connect = </m/g.outputs:color>
                token outputs:surface }
            def Shader \"t\" { uniform token info:id = \"UsdUVTexture\"
                asset inputs:file.connect = </m/g.inputs:map>
                float3 outputs:rgb }
        } }";
    let read = read_at(folder.path(), text, "/m");
    same(&[read.material().roughness.factor], &[0.3]);
    assert!(read.material().base_color.texture.is_some(), "{}", read.warnings);
    assert!(read.warnings.contains("st is not connected"));
}

#[test]
fn primvars_become_vertex_colors_or_fallbacks() {
    let nodes = "
        def Shader \"c\" { uniform token info:id = \"UsdPrimvarReader_float3\"
            string inputs:varname = \"displayColor\"
            float3 outputs:result }
        def Shader \"o\" { uniform token info:id = \"UsdPrimvarReader_float\"
            string inputs:varname = \"displayOpacity\"
            float outputs:result }
        def Shader \"r\" { uniform token info:id = \"UsdPrimvarReader_float\"
            string inputs:varname = \"rough\"
            float inputs:fallback = 0.35
            float outputs:result }";
    let read = preview(
        "color3f inputs:diffuseColor.connect = </m/c.outputs:result>
         float inputs:opacity.connect = </m/o.outputs:result>
         float inputs:roughness.connect = </m/r.outputs:result>",
        nodes,
    );
    let m = read.material();
    same(&m.base_color.factor, &[1.0; 3]);
    same(&[m.roughness.factor], &[0.35]);
    assert_eq!(m.alpha_mode, AlphaMode::Blend);
    assert_eq!(read.colors.color.as_deref(), Some("displayColor"));
    assert_eq!(read.colors.opacity.as_deref(), Some("displayOpacity"));
    assert!(read.warnings.contains("primvars:rough"), "{}", read.warnings);
}

#[test]
fn a_bias_is_computed_into_an_image() {
    let folder = tempfile::tempdir().unwrap();
    png(folder.path(), "a.png", 2, &[[0, 51, 102], [255, 204, 153]]);
    let nodes = [
        UV.to_string(),
        texture(
            "t",
            "asset inputs:file = @a.png@
             token inputs:sourceColorSpace = \"raw\"
             float4 inputs:scale = (0.5, 0.5, 0.5, 1)
             float4 inputs:bias = (0.25, 0.25, 0.25, 0)
             token inputs:wrapS = \"repeat\"
             token inputs:wrapT = \"repeat\"",
        ),
    ]
    .join("\n");
    let lines = "color3f inputs:diffuseColor.connect = </m/t.outputs:rgb>
        float inputs:roughness.connect = </m/t.outputs:b>";
    let read = preview_in(folder.path(), lines, &nodes);
    let m = read.material();
    let (texture, image) = read.texture(m.base_color.texture.unwrap().texture);
    assert_eq!((image.width, image.height, image.channels, texture.wrap_u), (2, 1, 3, Wrap::Repeat));
    let PixelData::F16(pixels) = &image.pixels else { panic!() };
    let expected = [0.25, 0.35, 0.45, 0.75, 0.65, 0.55];
    assert!(pixels.iter().zip(expected).all(|(a, b)| (a.to_f64() - b).abs() < 5e-4), "{pixels:?}");
    let (roughness, channel) = m.roughness.texture.unwrap();
    let (_, image) = read.texture(roughness.texture);
    assert_eq!((image.channels, channel), (1, Channel::R));
    assert!((f64::from(image.pixels.get(0)) - 0.45).abs() < 5e-4);
}

#[test]
fn standard_surface_folds_its_weights() {
    let read = mtlx(
        "ND_standard_surface_surfaceshader",
        "float inputs:base = 0.5
         color3f inputs:base_color = (0.2, 0.4, 0.6)
         float inputs:metalness = 0.25
         float inputs:specular = 0.75
         float inputs:specular_IOR = 1.4
         float inputs:coat = 0.5
         color3f inputs:coat_color = (0.5, 1, 1)
         float inputs:sheen = 0.5
         color3f inputs:sheen_color = (1, 0.5, 0)
         float inputs:thin_film_thickness = 400
         float inputs:emission = 3
         color3f inputs:emission_color = (1, 2, 3)
         color3f inputs:opacity = (0.5, 0.5, 0.5)",
        "",
    );
    let m = read.material();
    // Half the coat is half as red: (0.75, 1, 1).
    same(&m.base_color.factor, &[0.075, 0.2, 0.3]);
    same(&[m.metallic.factor, m.specular.factor, m.ior, m.roughness.factor], &[0.25, 0.75, 1.4, 0.2]);
    same(&[m.coat.unwrap().weight.factor, m.coat.unwrap().roughness.factor], &[0.5, 0.1]);
    same(&m.sheen.unwrap().color.factor, &[0.5, 0.25, 0.0]);
    same(&[m.iridescence.unwrap().thickness_max, m.iridescence.unwrap().ior], &[400.0, 1.5]);
    same(&m.emission.factor, &[3.0, 6.0, 9.0]);
    same(&[m.alpha.factor], &[0.5]);
    assert_eq!(m.alpha_mode, AlphaMode::Blend);
}

#[test]
fn transmission_has_an_inside_with_depth_in_metres() {
    let lines = "float inputs:transmission_weight = 1
        color3f inputs:transmission_color = (0.5, 0.6, 0.7)
        float inputs:transmission_depth = 2";
    let id = "ND_open_pbr_surface_surfaceshader";
    let volume = mtlx(id, lines, "").material().volume.unwrap();
    // Stages without metersPerUnit count centimetres.
    same(&[volume.attenuation_distance], &[0.02]);
    same(&volume.attenuation_color, &[0.5, 0.6, 0.7]);
    let thin = mtlx(id, &format!("{lines}\nbool inputs:geometry_thin_walled = 1"), "");
    assert!(thin.material().volume.is_none());
    let tinted = mtlx(id, &lines.replace("= 2", "= 0"), "");
    same(&tinted.material().base_color.factor, &[0.5, 0.6, 0.7]);
    assert_eq!(tinted.material().volume.unwrap().attenuation_distance, f64::INFINITY);
}

/// Blender's Principled with every layer, exported by bpy 5.0.1.
#[test]
fn open_pbr_of_blender() {
    let read = mtlx(
        "ND_open_pbr_surface_surfaceshader",
        "float inputs:coat_weight = 0.5
         float inputs:coat_ior = 1.5
         float inputs:coat_darkening
         float inputs:emission_luminance = 3
         float inputs:fuzz_weight = 0.4
         float inputs:geometry_opacity = 0.5
         float3 inputs:geometry_normal
         float inputs:specular_roughness_anisotropy = 0.21
         float3 inputs:geometry_tangent.connect = </m/turned.outputs:out>
         float inputs:subsurface_weight = 0.2
         float inputs:thin_film_thickness = 0.3
         float inputs:thin_film_weight = 1",
        "def Shader \"turned\" { uniform token info:id = \"ND_rotate3d_vector3\"
            float inputs:amount = -90
            float3 inputs:in.connect = </m/t.outputs:out>
            float3 outputs:out }
         def Shader \"t\" { uniform token info:id = \"ND_tangent_vector3\"
            float3 outputs:out }",
    );
    let m = read.material();
    same(&[m.emission.factor[0], m.sheen.unwrap().color.factor[0], m.alpha.factor], &[3.0, 0.4, 0.5]);
    same(&[m.iridescence.unwrap().thickness_max, m.coat.unwrap().ior], &[300.0, 1.5]);
    let anisotropy = m.anisotropy.unwrap();
    same(&[anisotropy.strength, anisotropy.rotation], &[0.21, std::f64::consts::FRAC_PI_2]);
    assert!(read.warnings.contains("subsurface") && read.warnings.lines().count() == 1, "{}", read.warnings);
}

#[test]
fn gltf_pbr_has_its_alpha_modes() {
    let lines = "color3f inputs:base_color = (1, 0.5, 0)
        float inputs:alpha = 0.5
        color3f inputs:emissive = (1, 1, 0)
        float inputs:emissive_strength = 5";
    let read = mtlx("ND_gltf_pbr_surfaceshader", lines, "");
    let m = read.material();
    assert_eq!((m.alpha_mode, m.alpha), (AlphaMode::Opaque, ScalarInput::constant(1.0)));
    same(&[m.metallic.factor, m.roughness.factor], &[1.0, 1.0]);
    same(&m.emission.factor, &[5.0, 5.0, 0.0]);
    let mask = mtlx("ND_gltf_pbr_surfaceshader", &format!("{lines}\nint inputs:alpha_mode = 1"), "");
    assert_eq!(mask.material().alpha_mode, AlphaMode::Mask { cutoff: 0.5 });
}

/// Glass, diffuse, emission and glossy as bpy 5.0.1 writes them, in a layer that says so.
#[test]
fn closures_of_blender() {
    let surface = |bsdf: &str| {
        let text = material_of("mtlx:", "ND_surface", "token inputs:bsdf.connect = </m/b.outputs:out>", bsdf);
        let folder = tempfile::tempdir().unwrap();
        read_at(folder.path(), &format!("(\n doc = \"Blender v5.0.1\"\n)\n{text}"), "/m").material.unwrap()
    };
    let glass = surface(
        "def Shader \"b\" { uniform token info:id = \"ND_dielectric_bsdf\"
            float2 inputs:roughness = (0.1, 0.1)
            string inputs:scatter_mode = \"RT\"
            color3f inputs:tint = (0.2, 0.5, 0.8)
            token outputs:out }",
    );
    same(&glass.base_color.factor, &[0.2, 0.5, 0.8]);
    same(&[glass.transmission.factor, glass.roughness.factor, glass.specular.factor], &[1.0, 0.1, 1.0]);
    assert!(glass.volume.is_some());
    let diffuse = surface(
        "def Shader \"b\" { uniform token info:id = \"ND_oren_nayar_diffuse_bsdf\"
            color3f inputs:color = (0.2, 0.5, 0.8)
            token outputs:out }",
    );
    same(&diffuse.base_color.factor, &[0.2, 0.5, 0.8]);
    same(&[diffuse.specular.factor, diffuse.metallic.factor], &[0.0, 0.0]);
    let glossy = surface(
        "def Shader \"b\" { uniform token info:id = \"ND_conductor_bsdf\"
            color3f inputs:ior.connect = </m/i.outputs:ior>
            float2 inputs:roughness = (0.5, 0.5)
            token outputs:out }
         def Shader \"i\" { uniform token info:id = \"ND_artistic_ior\"
            color3f inputs:reflectivity = (0.2, 0.5, 0.8)
            color3f outputs:ior }",
    );
    same(&[glossy.metallic.factor, glossy.roughness.factor, glossy.base_color.factor[1]], &[1.0, 0.5, 0.5]);
}

#[test]
fn closures_mix_and_emit() {
    let read = mtlx(
        "ND_surface",
        "token inputs:bsdf.connect = </m/mix.outputs:out>
         token inputs:edf.connect = </m/e.outputs:out>
         float inputs:opacity = 0.5",
        "def Shader \"mix\" { uniform token info:id = \"ND_mix_bsdf\"
            token inputs:bg.connect = </m/d.outputs:out>
            token inputs:fg.connect = </m/c.outputs:out>
            float inputs:mix = 0.25
            token outputs:out }
         def Shader \"d\" { uniform token info:id = \"ND_oren_nayar_diffuse_bsdf\"
            color3f inputs:color = (0.8, 0.8, 0.8)
            token outputs:out }
         def Shader \"c\" { uniform token info:id = \"ND_conductor_bsdf\"
            float2 inputs:roughness = (0.04, 0.04)
            token outputs:out }
         def Shader \"e\" { uniform token info:id = \"ND_uniform_edf\"
            color3f inputs:color = (1.4, 3.5, 5.6)
            token outputs:out }",
    );
    let m = read.material();
    // MaterialX's roughness is the width α: 0.2 squared.
    same(&[m.metallic.factor, m.roughness.factor, m.alpha.factor], &[0.25, 0.2, 0.5]);
    same(&m.emission.factor, &[1.4, 3.5, 5.6]);
    // Gold's reflectance in red from its index: ((n − 1)² + k²) / ((n + 1)² + k²).
    let gold = ((0.183_f64 - 1.0).powi(2) + 3.424_f64.powi(2)) / (1.183_f64.powi(2) + 3.424_f64.powi(2));
    same(&[m.base_color.factor[0]], &[0.75 * 0.8 + 0.25 * gold]);
}

#[test]
fn a_graph_of_images_is_computed_texel_by_texel() {
    let folder = tempfile::tempdir().unwrap();
    png(folder.path(), "a.png", 2, &[[0, 51, 102], [255, 204, 153]]);
    png(folder.path(), "b.png", 2, &[[255, 0, 0], [51, 0, 0]]);
    let image = |name: &str, file: &str, kind: &str, usd: &str| {
        format!(
            "def Shader \"{name}\" {{ uniform token info:id = \"ND_image_{kind}\"
                asset inputs:file = @{file}@ ( colorSpace = \"lin_rec709\" )
                string inputs:uaddressmode = \"clamp\"
                {usd} outputs:out }}"
        )
    };
    let nodes = [
        image("a", "a.png", "color3", "color3f"),
        image("b", "b.png", "float", "float"),
        "def Shader \"mix\" { uniform token info:id = \"ND_mix_color3\"
            color3f inputs:bg.connect = </m/a.outputs:out>
            color3f inputs:fg = (1, 1, 1)
            float inputs:mix.connect = </m/b.outputs:out>
            color3f outputs:out }"
            .to_string(),
    ]
    .join("\n");
    let lines = "color3f inputs:base_color.connect = </m/mix.outputs:out>
        float inputs:specular_roughness.connect = </m/b.outputs:out>";
    let read = mtlx_in(folder.path(), "ND_open_pbr_surface_surfaceshader", lines, &nodes);
    let m = read.material();
    let (texture, image) = read.texture(m.base_color.texture.unwrap().texture);
    assert_eq!((texture.wrap_u, texture.wrap_v), (Wrap::Clamp, Wrap::Repeat));
    // b is 1 at the first texel (white) and 0.2 at the second: a + 0.2 (1 − a).
    let expected = [1.0, 1.0, 1.0, 1.0, 0.84, 0.68];
    let PixelData::F16(pixels) = &image.pixels else { panic!() };
    assert!(pixels.iter().zip(expected).all(|(a, b)| (a.to_f64() - b).abs() < 5e-4), "{pixels:?}");
    let (_, channel) = m.roughness.texture.unwrap();
    assert_eq!(channel, Channel::R);
    assert_eq!(read.warnings, "");
}

#[test]
fn a_document_is_read_through_its_reference() {
    let folder = tempfile::tempdir().unwrap();
    png(folder.path(), "a.png", 1, &[[255, 128, 0]]);
    let document = r#"<?xml version="1.0"?>
<materialx version="1.39" colorspace="lin_rec709" fileprefix="./">
  <nodegraph name="g">
    <input name="gain" type="float" value="0.5" />
    <image name="t" type="color3">
      <input name="file" type="filename" value="a.png" colorspace="srgb_texture" />
      <input name="uaddressmode" type="string" value="mirror" />
    </image>
    <multiply name="dim" type="color3">
      <input name="in1" type="color3" nodename="t" />
      <input name="in2" type="float" interfacename="gain" />
    </multiply>
    <normalmap name="n" type="vector3">
      <input name="in" type="vector3" nodename="nt" />
      <input name="scale" type="float" value="0.25" />
    </normalmap>
    <tiledimage name="nt" type="vector3">
      <input name="file" type="filename" value="a.png" />
      <input name="uvtiling" type="vector2" value="4, 2" />
    </tiledimage>
    <output name="color" type="color3" nodename="dim" />
    <output name="normal" type="vector3" nodename="n" />
  </nodegraph>
  <standard_surface name="SR" type="surfaceshader">
    <input name="base_color" type="color3" nodegraph="g" output="color" />
    <input name="normal" type="vector3" nodegraph="g" output="normal" />
    <input name="thin_walled" type="boolean" value="true" />
  </standard_surface>
  <surfacematerial name="paint" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="SR" />
  </surfacematerial>
</materialx>"#;
    std::fs::write(folder.path().join("doc.mtlx"), document).unwrap();
    for (text, path) in [
        ("def Scope \"M\" (references = @./doc.mtlx@</MaterialX>) {}", "/M/Materials/paint"),
        ("def Scope \"M\" (prepend references = @doc.mtlx@</MaterialX/Materials>) {}", "/M/paint"),
        ("def Material \"other\" (references = @doc.mtlx@</MaterialX/Materials/paint>) {}", "/other"),
    ] {
        let read = read_at(folder.path(), text, path);
        let m = read.material();
        same(&m.base_color.factor, &[0.5; 3]);
        let (texture, image) = read.texture(m.base_color.texture.unwrap().texture);
        assert_eq!((texture.wrap_u, image.color_space), (Wrap::Mirror, ColorSpace::Srgb));
        let normal = m.normal.unwrap();
        same(&[normal.scale], &[0.25]);
        let TextureTransform([u, v]) = normal.texture.transform;
        same(&[u[0], v[1], v[2]], &[4.0, 2.0, -1.0]);
        assert_eq!(read.texture(normal.texture.texture).1.color_space, ColorSpace::Linear);
        assert_eq!(read.warnings, "");
    }
    let gone = read_at(folder.path(), "def Scope \"M\" (references = @no.mtlx@</MaterialX>) {}", "/M/Materials/paint");
    assert!(gone.material.is_none() && gone.warnings.contains("no.mtlx"), "{}", gone.warnings);
}

#[test]
fn what_cannot_be_read_is_told_and_is_not_a_material() {
    let folder = tempfile::tempdir().unwrap();
    let text = "def Material \"m\" {
        token outputs:mdl:surface.connect = </m/s.outputs:out>
        def Shader \"s\" { token outputs:out } }";
    let read = read_at(folder.path(), text, "/m");
    assert!(read.material.is_none() && read.warnings.contains("for mdl alone"), "{}", read.warnings);
    let read = read_at(folder.path(), &material_of("", "MyShader", "", ""), "/m");
    assert!(read.material.is_none() && read.warnings.contains("MyShader"), "{}", read.warnings);
    let read = read_at(folder.path(), "def Material \"m\" {}", "/m");
    assert!(read.material.is_none() && read.warnings.contains("no surface"), "{}", read.warnings);
    let read = read_at(folder.path(), "", "/m");
    assert!(read.material.is_none() && read.warnings.contains("/m"), "{}", read.warnings);
    // MaterialX that isn't known, with a UsdPreviewSurface beside it.
    let both = "def Material \"m\" {
        token outputs:surface.connect = </m/p.outputs:surface>
        token outputs:mtlx:surface.connect = </m/s.outputs:surface>
        def Shader \"p\" { uniform token info:id = \"UsdPreviewSurface\"
            token outputs:surface }
        def Shader \"s\" { uniform token info:id = \"ND_disney_surfaceshader\"
            token outputs:surface } }";
    same(&read_at(folder.path(), both, "/m").material().base_color.factor, &[0.18; 3]);
}

#[test]
fn circles_and_foreign_values_do_no_harm() {
    let nodes = "
        def Shader \"a\" { uniform token info:id = \"ND_add_float\"
            float inputs:in1.connect = </m/b.outputs:out>
            float outputs:out }
        def Shader \"b\" { uniform token info:id = \"ND_add_float\"
            float inputs:in1.connect = </m/a.outputs:out>
            float outputs:out }";
    let read = mtlx(
        "ND_open_pbr_surface_surfaceshader",
        "float inputs:specular_roughness.connect = </m/a.outputs:out>
         string inputs:base_metalness = \"yes\"
         float inputs:base_weight.connect = </m/nothing.outputs:out>
         float inputs:specular_ior = 1e40",
        nodes,
    );
    assert!(read.warnings.contains("circle"), "{}", read.warnings);
    same(&[read.material().metallic.factor], &[0.0]);
}

#[test]
fn udim_tiles_are_one_texture() {
    let folder = tempfile::tempdir().unwrap();
    png(folder.path(), "t.1001.png", 1, &[[255, 0, 0]]);
    png(folder.path(), "t.1012.png", 1, &[[0, 255, 0]]);
    let nodes = [UV.to_string(), texture("t", "asset inputs:file = @t.<UDIM>.png@")].join("\n");
    let read = preview_in(folder.path(), "color3f inputs:diffuseColor.connect = </m/t.outputs:rgb>", &nodes);
    let texture = read.material().base_color.texture.unwrap();
    let (_, image) = read.texture(texture.texture);
    assert_eq!((image.width, image.height, image.color_space), (2, 2, ColorSpace::Srgb));
    // st (1.5, 1.5), tile 1012, v down −0.5: the upper right quarter.
    let TextureTransform([u, v]) = texture.transform;
    same(&[u[0] * 1.5 + u[2], v[1] * -0.5 + v[2]], &[0.75, 0.25]);
    assert_eq!(read.warnings, "");
}

#[test]
fn unbound_shapes_show_their_display_color() {
    let folder = tempfile::tempdir().unwrap();
    let options = ImportOptions::default();
    let reading = stage(folder.path(), "", &options);
    let mut materials = Materials::new(&reading, Images::default());
    let index = materials.unbound();
    assert_eq!(materials.unbound(), index);
    let colors = materials.vertex_colors(index);
    assert_eq!((colors.color.as_deref(), colors.opacity.as_deref()), (Some("displayColor"), Some("displayOpacity")));
    assert_eq!(materials.get(index).unwrap().base_color, ColorInput::constant([1.0; 3]));
    assert_eq!(materials.tangent_uv_set(index), None);
}
