//! UsdPreviewSurface, its textures and primvars, and materials that can't be read.

use super::super::super::images::tests::{png, stage};
use super::*;
use crate::desc::{AlphaMode, Channel, ColorSpace, NormalInput, TextureTransform, Wrap};

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

#[test]
fn preview_surface_has_its_defaults() {
    let read = preview("", "");
    let m = read.material();
    assert_eq!(&*m.name, "m");
    same(&m.base_color.factor, &[0.18; 3]);
    same(&[m.metallic.factor, m.roughness.factor, m.ior.factor, m.specular.factor], &[0.0, 0.5, 1.5, 1.0]);
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
         token inputs:opacityMode = \"presence\"
         float inputs:displacement = 0.1",
        "",
    );
    let m = read.material();
    same(&m.base_color.factor, &[0.1, 0.2, 0.3]);
    same(&m.emission.factor, &[4.0, 5.0, 6.0]);
    same(&[m.metallic.factor, m.roughness.factor, m.ior.factor, m.alpha.factor], &[0.7, 0.25, 1.75, 0.5]);
    assert_eq!(m.alpha_mode, AlphaMode::Blend);
    let coat = m.coat.unwrap();
    same(&[coat.weight.factor, coat.roughness.factor, coat.ior.factor], &[0.5, 0.125, 1.75]);
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
    same(&[m.metallic.factor, m.ior.factor], &[0.0, 1.5]);
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
    assert_eq!(m.occlusion.unwrap(), ScalarInput::textured(1.0, Some((roughness, Channel::R))));
    let NormalInput::Map { scale, .. } = m.normal.unwrap() else { panic!() };
    assert!(close(scale, 0.7));
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
         token inputs:opacityMode = \"presence\"
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
         token inputs:opacityMode = \"presence\"
         float inputs:roughness.connect = </m/r.outputs:result>",
        nodes,
    );
    let m = read.material();
    same(&m.base_color.factor, &[1.0; 3]);
    let rough = m.graph.op(m.roughness.graph.unwrap());
    assert_eq!(rough, &Op::Leaf(Leaf::Attribute { name: "rough".into(), fallback: [f64::from(0.35_f32); 4] }));
    assert_eq!(m.alpha_mode, AlphaMode::Blend);
    assert_eq!(read.colors.color.as_deref(), Some("displayColor"));
    assert_eq!(read.colors.opacity.as_deref(), Some("displayOpacity"));
    assert_eq!(read.warnings, "");
}

#[test]
fn a_bias_is_a_value_of_the_graph() {
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
    let Some(Op::Image { texture, .. }) = m.graph.ops().iter().find(|op| matches!(op, Op::Image { .. })) else {
        panic!()
    };
    let (desc, image) = read.texture(*texture);
    assert_eq!((image.width, image.channels, desc.wrap_u), (2, 3, Wrap::Repeat));
    let texels = [(*texture, [0.0, 0.2, 0.4, 1.0])];
    same(&value_of(m, m.base_color.graph.unwrap(), &texels)[..3], &[0.25, 0.35, 0.45]);
    same(&value_of(m, m.roughness.graph.unwrap(), &texels)[..1], &[0.45]);
}

/// Blender's Principled with every layer, exported by bpy 5.0.1.
/// Glass, diffuse, emission and glossy as bpy 5.0.1 writes them, in a layer that says so.
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
    let mut materials = Materials::new(&reading, Images::default(), BTreeSet::new(), Vec::new());
    let index = materials.unbound();
    assert_eq!(materials.unbound(), index);
    let colors = materials.vertex_colors(index);
    assert_eq!((colors.color.as_deref(), colors.opacity.as_deref()), (Some("displayColor"), Some("displayOpacity")));
    assert_eq!(materials.get(index).unwrap().base_color, ColorInput::constant([1.0; 3]));
    assert_eq!(materials.tangent_uv_set(index), None);
}

#[test]
fn connections_to_what_is_not_there_are_told() {
    let read = preview("color3f inputs:diffuseColor.connect = </m/gone.outputs:rgb>", "");
    same(&read.material().base_color.factor, &[0.18, 0.18, 0.18]);
    assert!(read.warnings.contains("it is connected to /m/gone.outputs:rgb, which gives nothing"), "{}", read.warnings);
}
