//! MaterialX's surfaces and nodes, in networks and in documents.

use super::super::super::images::tests::png;
use super::*;
use crate::desc::{AlphaMode, AnisotropyLaw, Channel, ColorSpace, NormalInput, TextureTransform, Wrap};

/// Fresnel's reflectance of what `value_of` sees: the cosine is that of two vectors of halves, 3/4.
pub(super) fn reflected(ior: f64) -> f64 {
    let cos: f64 = 0.75;
    let within = (1.0 - (1.0 - cos * cos) / (ior * ior)).sqrt();
    let across = (cos - ior * within) / (cos + ior * within);
    let along = (ior * cos - within) / (ior * cos + within);
    0.5 * (across * across + along * along)
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
    same(&m.base_color.factor, &[0.1, 0.2, 0.3]);
    same(&[m.metallic.factor, m.specular.factor, m.ior.factor, m.roughness.factor], &[0.25, 0.75, 1.4, 0.2]);
    same(&[m.coat.unwrap().weight.factor, m.coat.unwrap().roughness.factor], &[0.5, 0.1]);
    same(&m.sheen.unwrap().color.factor, &[0.5, 0.25, 0.0]);
    same(&[m.iridescence.unwrap().thickness.factor, m.iridescence.unwrap().ior.factor], &[400.0, 1.5]);
    let [red, rest] = [0.5, 1.0].map(|tint| 1.0 + 0.5 * (tint * (1.0 - reflected(1.5)) - 1.0));
    let emission = value_of(m, m.emission.graph.unwrap(), &[]);
    same(&emission[..3], &[3.0 * red, 6.0 * rest, 9.0 * rest]);
    same(&[m.alpha.factor], &[0.5]);
    assert_eq!(m.alpha_mode, AlphaMode::Blend);
}

#[test]
fn standard_surface_of_blender_is_its_principled() {
    let lines = "float inputs:specular = 0.3
        color3f inputs:specular_color = (1, 0.5, 0.2)
        float inputs:specular_roughness = 0.4
        float inputs:specular_anisotropy = 0.5
        float inputs:diffuse_roughness = 0.4
        float inputs:transmission = 0.5
        float inputs:transmission_extra_roughness = 0.4";
    let text = material_of("mtlx:", "ND_standard_surface_surfaceshader", lines, "");
    let folder = tempfile::tempdir().unwrap();
    let read = |head: &str| read_at(folder.path(), &format!("{head}{text}"), "/m");
    let blender = read("(\n doc = \"Blender v4.2.23 LTS\"\n)\n");
    assert_eq!(blender.warnings, "");
    let m = blender.material();
    same(&[m.specular.factor, m.roughness.factor, m.diffuse_roughness.factor], &[1.0, 0.4, 0.0]);
    same(&m.specular_color.factor, &[0.6, 0.3, 0.12]);
    same(&[m.anisotropy.as_ref().unwrap().strength.factor], &[0.5]);
    let others = read("");
    let others = others.material();
    same(&[others.specular.factor, others.diffuse_roughness.factor], &[0.3, 0.4]);
    same(&[others.anisotropy.as_ref().unwrap().strength.factor], &[0.5]);
    let laws = [m, others].map(|m| m.anisotropy.unwrap().law);
    assert_eq!(laws, [AnisotropyLaw::Aspect, AnisotropyLaw::RoughnessAnisotropy]);
}

/// The tangent is turned by what it is connected to, and by specular_rotation as rotate3d turns: clockwise.
#[test]
fn standard_surface_is_stretched_along_its_tangent() {
    let folder = tempfile::tempdir().unwrap();
    png(folder.path(), "a.png", 2, &[[0, 51, 102], [255, 204, 153]]);
    let nodes = "def Shader \"turned\" { uniform token info:id = \"ND_rotate3d_vector3\"
            float inputs:amount = -90
            float3 inputs:in.connect = </m/t.outputs:out>
            float3 outputs:out }
        def Shader \"t\" { uniform token info:id = \"ND_tangent_vector3\"
            float3 outputs:out }
        def Shader \"how\" { uniform token info:id = \"ND_image_float\"
            asset inputs:file = @a.png@ ( colorSpace = \"lin_rec709\" )
            float outputs:out }";
    let lines = "float inputs:specular_anisotropy.connect = </m/how.outputs:out>
        float inputs:specular_rotation = 0.125
        float3 inputs:tangent.connect = </m/turned.outputs:out>";
    let read = mtlx_in(folder.path(), "ND_standard_surface_surfaceshader", lines, nodes);
    assert_eq!(read.warnings, "");
    let anisotropy = read.material().anisotropy.unwrap();
    assert!(anisotropy.strength.texture.is_some());
    same(&[anisotropy.strength.factor, anisotropy.rotation.factor], &[1.0, std::f64::consts::FRAC_PI_4]);
    let strong = mtlx("ND_standard_surface_surfaceshader", "float inputs:specular_anisotropy = 0.95", "");
    same(&[strong.material().anisotropy.unwrap().strength.factor], &[0.95]);
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
    let coated = mtlx("ND_gltf_pbr_surfaceshader", &format!("{lines}\nfloat inputs:clearcoat = 0.25"), "");
    let emission = value_of(coated.material(), coated.material().emission.graph.unwrap(), &[]);
    let left = 5.0 * (1.0 - 0.25 * reflected(1.5));
    same(&emission[..3], &[left, left, 0.0]);
    let mask = mtlx("ND_gltf_pbr_surfaceshader", &format!("{lines}\nint inputs:alpha_mode = 1"), "");
    assert_eq!(mask.material().alpha_mode, AlphaMode::Mask { cutoff: 0.5 });
}

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
fn subsurface_in_a_tree_is_a_random_walk() {
    let tree = |top: &str, nodes: &str| {
        mtlx("ND_surface", &format!("token inputs:bsdf.connect = </m/{top}.outputs:out>"), nodes)
    };
    let wax = "def Shader \"wax\" { uniform token info:id = \"ND_subsurface_bsdf\"
            float inputs:weight = 0.5
            color3f inputs:color = (0.8, 0.6, 0.4)
            color3f inputs:radius = (1, 0.5, 0.25)
            float inputs:anisotropy = 0.3
            token outputs:out }";
    let alone = tree("wax", wax);
    let m = alone.material();
    let beneath = m.subsurface.unwrap();
    same(&beneath.color.factor, &[0.8, 0.6, 0.4]);
    // Of the stage's units, centimetres.
    same(&beneath.radius.factor, &[0.01, 0.005, 0.0025]);
    same(&[beneath.weight.factor, beneath.anisotropy.factor, m.specular.factor], &[0.5, 0.3, 0.0]);
    same(&m.base_color.factor, &[0.0; 3]);
    assert_eq!(beneath.method, crate::desc::SubsurfaceMethod::FreePath);
    assert_eq!(alone.warnings, "");

    // A quarter of paint: of all light 0.375 walks, 0.25 is diffuse, the rest of the wax is black.
    let mixed = tree(
        "mix",
        &format!(
            "{wax} def Shader \"mix\" {{ uniform token info:id = \"ND_mix_bsdf\"
                token inputs:bg.connect = </m/wax.outputs:out>
                token inputs:fg.connect = </m/paint.outputs:out>
                float inputs:mix = 0.25
                token outputs:out }}
             def Shader \"paint\" {{ uniform token info:id = \"ND_oren_nayar_diffuse_bsdf\"
                color3f inputs:color = (0.2, 0.4, 0.5)
                token outputs:out }}"
        ),
    );
    let m = mixed.material();
    let beneath = m.subsurface.unwrap();
    same(&[beneath.weight.factor], &[0.375]);
    same(&beneath.color.factor, &[0.8, 0.6, 0.4]);
    same(&beneath.radius.factor, &[0.01, 0.005, 0.0025]);
    same(&m.base_color.factor.map(|c| c * 0.625), &[0.05, 0.1, 0.125]);

    let lacquered = tree(
        "layer",
        &format!(
            "{wax} def Shader \"layer\" {{ uniform token info:id = \"ND_layer_bsdf\"
                token inputs:top.connect = </m/shine.outputs:out>
                token inputs:base.connect = </m/wax.outputs:out>
                token outputs:out }}
             def Shader \"shine\" {{ uniform token info:id = \"ND_dielectric_bsdf\"
                float inputs:ior = 1.4
                token outputs:out }}"
        ),
    );
    let m = lacquered.material();
    same(&[m.subsurface.unwrap().weight.factor, m.specular.factor, m.ior.factor], &[0.5, 1.0, 1.4]);
}

#[test]
fn a_graph_of_images_is_handed_over_as_it_is() {
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
    let lookup = |index: usize| {
        let ops = m.graph.ops().iter().filter_map(|op| match op {
            Op::Image { texture, uv } => Some((*texture, *uv)),
            _ => None,
        });
        ops.collect::<Vec<_>>()[index]
    };
    let (texture, image) = read.texture(lookup(0).0);
    assert_eq!((texture.wrap_u, texture.wrap_v, &*image.name), (Wrap::Clamp, Wrap::Repeat, "a.png"));
    // b is 1 at the first texel (white) and 0.2 at the second: a + 0.2 (1 − a).
    for (a, b, expected) in [([0.0, 0.2, 0.4], 1.0, [1.0; 3]), ([1.0, 0.8, 0.6], 0.2, [1.0, 0.84, 0.68])] {
        let texels = [(lookup(0).0, [a[0], a[1], a[2], 1.0]), (lookup(1).0, [b, 0.0, 0.0, 1.0])];
        same(&value_of(m, m.base_color.graph.unwrap(), &texels)[..3], &expected);
    }
    assert_eq!(m.base_color, ColorInput::graph(m.base_color.graph.unwrap()));
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
        let NormalInput::Map { texture, scale } = m.normal.unwrap() else { panic!() };
        same(&[scale], &[0.25]);
        let TextureTransform([u, v]) = texture.transform;
        same(&[u[0], v[1], v[2]], &[4.0, 2.0, -1.0]);
        assert_eq!(read.texture(texture.texture).1.color_space, ColorSpace::Linear);
        assert_eq!(read.warnings, "");
    }
    let gone = read_at(folder.path(), "def Scope \"M\" (references = @no.mtlx@</MaterialX>) {}", "/M/Materials/paint");
    assert!(gone.material.is_none() && gone.warnings.contains("no.mtlx"), "{}", gone.warnings);
}

/// gltf_pbr's image nodes by the graphs of its library: `u' = o + s c u + …` is KHR_texture_transform.
#[test]
fn images_of_gltf_pbr_are_placed_as_its_graphs_have_it() {
    let folder = tempfile::tempdir().unwrap();
    png(folder.path(), "a.png", 1, &[[255, 128, 0]]);
    let placed = "asset inputs:file = @a.png@
        float2 inputs:scale = (2, 3)
        float inputs:rotate = 30
        float2 inputs:offset = (0.25, 0.5)";
    let nodes = format!(
        "def Shader \"c\" {{ uniform token info:id = \"ND_gltf_colorimage\"
            {placed}
            color4f inputs:color = (0.5, 0.25, 1, 0.5)
            color3f outputs:outcolor
            float outputs:outa }}
        def Shader \"r\" {{ uniform token info:id = \"ND_gltf_image_float_float_1_0\"
            {placed}
            float inputs:factor = 0.5
            float outputs:out }}
        def Shader \"n\" {{ uniform token info:id = \"ND_gltf_normalmap_vector3_1_0\"
            {placed}
            vector3f outputs:out }}"
    );
    let read = mtlx_in(
        folder.path(),
        "ND_gltf_pbr_surfaceshader",
        "color3f inputs:base_color.connect = </m/c.outputs:outcolor>
         float inputs:alpha.connect = </m/c.outputs:outa>
         int inputs:alpha_mode = 2
         float inputs:roughness.connect = </m/r.outputs:out>
         vector3f inputs:normal.connect = </m/n.outputs:out>",
        &nodes,
    );
    assert_eq!(read.warnings, "");
    let m = read.material();
    same(&m.base_color.factor, &[0.5, 0.25, 1.0]);
    same(&[m.alpha.factor, m.roughness.factor], &[0.5, 0.5]);
    let NormalInput::Map { texture: normal, scale } = m.normal.unwrap() else { panic!() };
    same(&[scale], &[1.0]);
    let (color, (rough, _)) = (m.base_color.texture.unwrap(), m.roughness.texture.unwrap());
    let (sin, cos) = 30.0_f64.to_radians().sin_cos();
    for (texture, space) in [(color, ColorSpace::Srgb), (rough, ColorSpace::Linear), (normal, ColorSpace::Linear)] {
        let TextureTransform([u, v]) = texture.transform;
        same(&u, &[2.0 * cos, 3.0 * sin, 0.25]);
        same(&v, &[-2.0 * sin, 3.0 * cos, 0.5]);
        assert_eq!(read.texture(texture.texture).1.color_space, space);
    }
}

/// MaterialX's own graph in numbers: without a turn of the hue each channel is a line of a few steps.
#[test]
fn colors_are_corrected_in_order() {
    let nodes = "def Shader \"c\" { uniform token info:id = \"ND_colorcorrect_color3\"
        color3f inputs:in = (0.5, 0.25, 0.125)
        float inputs:saturation = 0.5
        float inputs:gamma = 2
        float inputs:lift = 0.1
        float inputs:gain = 1.5
        float inputs:contrast = 0.8
        float inputs:contrastpivot = 0.4
        float inputs:exposure = -1
        color3f outputs:out }";
    let surface = "color3f inputs:base_color.connect = </m/c.outputs:out>";
    let read = mtlx("ND_gltf_pbr_surfaceshader", surface, nodes);
    assert_eq!(read.warnings, "");
    let color = [0.5, 0.25, 0.125];
    let grey: f64 = color.iter().zip([0.2722287, 0.6740818, 0.0536895]).map(|(c, w)| c * w).sum();
    let expected = color.map(|c| {
        let curved = (0.5 * (grey + c)).sqrt();
        let gained = 1.5 * (curved * 0.9 + 0.1);
        0.5 * (0.8 * (gained - 0.4) + 0.4)
    });
    same(&read.material().base_color.factor, &expected);
    // A third of the way around: red is green.
    let turned = nodes.replace("(0.5, 0.25, 0.125)", "(1, 0, 0)").replace("saturation = 0.5", "hue = 0.33333333");
    let plain = turned
        .lines()
        .filter(|line| !["gamma", "lift", "gain", "contrast", "exposure"].iter().any(|n| line.contains(n)));
    let turned = mtlx("ND_gltf_pbr_surfaceshader", surface, &plain.collect::<Vec<_>>().join("\n"));
    same(&turned.material().base_color.factor, &[0.0, 1.0, 0.0]);
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

/// Sixty mixes of the one before with itself would be 2⁶⁰ BSDFs.
#[test]
fn shared_nodes_are_worked_out_once() {
    let mut nodes = "def Shader \"m0\" { uniform token info:id = \"ND_oren_nayar_diffuse_bsdf\"
        token outputs:out }"
        .to_string();
    for i in 1..60 {
        let below = i - 1;
        nodes += &format!(
            "def Shader \"m{i}\" {{ uniform token info:id = \"ND_mix_bsdf\"
                token inputs:bg.connect = </m/m{below}.outputs:out>
                token inputs:fg.connect = </m/m{below}.outputs:out>
                float inputs:mix = 0.5
                token outputs:out }}"
        );
    }
    let read = mtlx("ND_surface", "token inputs:bsdf.connect = </m/m59.outputs:out>", &nodes);
    same(&read.material().base_color.factor, &[0.18; 3]);
}

#[test]
fn a_color_space_of_a_shader_or_what_it_stands_in_is_that_of_its_colors() {
    let lines = "color3f inputs:base_color = (0.5, 0.5, 0.5)\n float inputs:specular_roughness = 0.5";
    let text = material_of("mtlx:", "ND_standard_surface_surfaceshader", lines, "");
    let own =
        text.replace("uniform token info", "uniform token colorSpace:name = \"srgb_rec709_scene\"\nuniform token info");
    let above = format!(
        "def Scope \"l\" {{ uniform token colorSpace:name = \"srgb_rec709_scene\"\n{} }}",
        text.replace("/m/", "/l/m/")
    );
    let folder = tempfile::tempdir().unwrap();
    for (text, path) in [(own, "/m"), (above, "/l/m")] {
        let read = read_at(folder.path(), &text, path);
        same(&read.material().base_color.factor, &[0.214_041, 0.214_041, 0.214_041]);
        same(&[read.material().roughness.factor], &[0.5]);
    }
}

#[test]
fn displacement_and_volumes_beside_a_surface_are_told() {
    let nodes = "token outputs:mtlx:displacement.connect = </m/d.outputs:out>
        token outputs:volume.connect = </m/v.outputs:out>
        def Shader \"d\" { uniform token info:id = \"ND_displacement_float\"
            float inputs:displacement = 1
            token outputs:out }
        def Shader \"v\" { uniform token info:id = \"ND_volume\"
            token outputs:out }";
    let read = mtlx("ND_standard_surface_surfaceshader", "", nodes);
    assert!(read.warnings.contains("its displacement is left out") && read.warnings.contains("its volume is left out"));
    // UsdPreviewSurface is its own displacement, of which an input tells.
    let preview =
        preview("token outputs:displacement", "token outputs:displacement.connect = </m/s.outputs:displacement>");
    assert_eq!(preview.warnings, "");
}
