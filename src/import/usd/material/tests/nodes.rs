//! Layers of MaterialX's surfaces, and nodes that go by where a surface is hit.

use super::*;
use crate::desc::graph::{Noise, NoiseKind, Procedural};

const STANDARD: &str = "ND_standard_surface_surfaceshader";
const OPEN_PBR: &str = "ND_open_pbr_surface_surfaceshader";

#[test]
fn layers_have_their_places() {
    for (id, base, coat) in
        [(STANDARD, "diffuse_roughness", "coat"), (OPEN_PBR, "base_diffuse_roughness", "coat_weight")]
    {
        let lines = format!(
            "float inputs:{base} = 0.75
             color3f inputs:specular_color = (0.25, 0.5, 1)
             float inputs:{coat} = 0.5
             color3f inputs:coat_color = (1, 0.5, 0.25)"
        );
        let read = mtlx(id, &lines, "");
        let m = read.material();
        same(&[m.diffuse_roughness.factor], &[0.75]);
        same(&m.metal_edge.factor, &[0.25, 0.5, 1.0]);
        same(&m.coat.unwrap().tint.factor, &[1.0, 0.5, 0.25]);
        assert_eq!(read.warnings, "");
    }
}

#[test]
fn thin_walls_let_diffuse_light_pass() {
    let standard = mtlx(
        STANDARD,
        "float inputs:subsurface = 0.25
         color3f inputs:base_color = (0.5, 0.5, 0.5)
         color3f inputs:subsurface_color = (1, 0, 0.5)
         bool inputs:thin_walled = 1",
        "",
    );
    let m = standard.material();
    let passes = m.translucent.unwrap();
    same(&[passes.weight.factor], &[0.25]);
    same(&passes.color.factor, &[1.0, 0.0, 0.5]);
    same(&m.base_color.factor, &[0.5; 3]);
    assert_eq!(standard.warnings, "");
    // Half of what enters comes back, by the mean of both: (0.5 × 0.5 + 0.25 × 1) / 0.75.
    let open_pbr = mtlx(
        OPEN_PBR,
        "float inputs:subsurface_weight = 0.5
         color3f inputs:base_color = (0.5, 0.5, 0.5)
         color3f inputs:subsurface_color = (1, 0, 0.5)
         bool inputs:geometry_thin_walled = 1",
        "",
    );
    let m = open_pbr.material();
    same(&[m.translucent.unwrap().weight.factor], &[0.25]);
    same(&m.base_color.factor, &[2.0 / 3.0, 1.0 / 3.0, 0.5]);
}

#[test]
fn translucent_bsdfs_are_mixed_side_by_side() {
    let read = mtlx(
        "ND_surface",
        "token inputs:bsdf.connect = </m/mix.outputs:out>",
        "def Shader \"mix\" { uniform token info:id = \"ND_mix_bsdf\"
            token inputs:bg.connect = </m/d.outputs:out>
            token inputs:fg.connect = </m/t.outputs:out>
            float inputs:mix = 0.25
            token outputs:out }
         def Shader \"d\" { uniform token info:id = \"ND_oren_nayar_diffuse_bsdf\"
            color3f inputs:color = (0.8, 0.8, 0.8)
            float inputs:roughness = 0.5
            token outputs:out }
         def Shader \"t\" { uniform token info:id = \"ND_translucent_bsdf\"
            color3f inputs:color = (0.25, 0.5, 1)
            token outputs:out }",
    );
    let m = read.material();
    let passes = m.translucent.unwrap();
    same(&[passes.weight.factor], &[0.25]);
    same(&passes.color.factor, &[0.25, 0.5, 1.0]);
    same(&m.base_color.factor, &[0.8; 3]);
    assert_eq!(read.warnings, "");
}

/// The base color of a surface by the node `c`; every leaf is 0.5.
fn color_by(nodes: &str) -> ([f64; 4], String) {
    let read = mtlx(OPEN_PBR, "color3f inputs:base_color.connect = </m/c.outputs:out>", nodes);
    let m = read.material();
    (value_of(m, m.base_color.graph.unwrap(), &[]), read.warnings.clone())
}

#[test]
fn checkers_are_those_of_the_node_graph() {
    let checker = |tiling: &str| {
        let nodes = format!(
            "def Shader \"c\" {{ uniform token info:id = \"ND_checkerboard_color3\"
                color3f inputs:color1 = (0.25, 0.5, 0.75)
                color3f inputs:color2 = (1, 0.5, 0)
                float2 inputs:uvtiling = {tiling}
                color3f outputs:out }}"
        );
        color_by(&nodes).0
    };
    // (0.5, 0.5) is in the square (1, 2): odd.
    same(&checker("(2, 4)")[..3], &[0.25, 0.5, 0.75]);
    same(&checker("(8, 8)")[..3], &[1.0, 0.5, 0.0]);
}

#[test]
fn vectors_turn_clockwise_around_any_axis_and_by_any_angle() {
    let (turned, said) = color_by(
        "def Shader \"c\" { uniform token info:id = \"ND_rotate3d_vector3\"
            vector3f inputs:in.connect = </m/p.outputs:out>
            float inputs:amount = 90
            vector3f inputs:axis = (0, 2, 0)
            vector3f outputs:out }
         def Shader \"p\" { uniform token info:id = \"ND_position_vector3\"
            string inputs:space = \"object\"
            vector3f outputs:out }",
    );
    // `mx_rotate_vector3`: x' = −z and z' = x.
    same(&turned[..3], &[-0.5, 0.5, 0.5]);
    assert_eq!(said, "");
    let (turned, said) = color_by(
        "def Shader \"c\" { uniform token info:id = \"ND_rotate2d_vector2\"
            float2 inputs:in = (1, 0)
            float inputs:amount.connect = </m/a.outputs:out>
            float2 outputs:out }
         def Shader \"a\" { uniform token info:id = \"ND_geompropvalue_float\"
            string inputs:geomprop = \"angle\"
            float outputs:out }",
    );
    // `mx_rotate_vector2`: (cos, −sin) of half a degree.
    let angle = 0.5_f64.to_radians();
    same(&turned[..2], &[angle.cos(), -angle.sin()]);
    assert_eq!(said, "");
}

#[test]
fn noise_is_that_of_open_shading_language() {
    let noises = |lines: &str| {
        let nodes = format!("def Shader \"c\" {{ uniform token info:id = {lines} float outputs:out }}");
        let read = mtlx(OPEN_PBR, "float inputs:base_weight.connect = </m/c.outputs:out>", &nodes);
        let m = read.material();
        let found = m.graph.ops().iter().find_map(|op| match op {
            Op::Procedural(Procedural::Noise(noise), args) => Some((*noise, m.graph.known(args[3]).unwrap()[0])),
            _ => None,
        });
        (found, read.warnings)
    };
    let plain = Noise { dimensions: 3, kind: NoiseKind::Fbm, normalize: false, color: false };
    assert_eq!(noises("\"ND_noise3d_float\""), (Some((plain, 0.0)), String::new()));
    let fractal = noises("\"ND_fractal3d_float\" int inputs:octaves = 5");
    assert_eq!(fractal, (Some((plain, 4.0)), String::new()));
    assert_eq!(noises("\"ND_noise2d_float\"").0, Some((Noise { dimensions: 2, ..plain }, 0.0)));
    // Cells go by another hash than ours.
    let (none, said) = noises("\"ND_cellnoise3d_float\"");
    assert!(none.is_none() && said.contains("node \"cellnoise3d\" isn't computed"), "{said}");
}

#[test]
fn the_normal_of_a_surface_bends_nothing() {
    let nodes = "def Shader \"n\" { uniform token info:id = \"ND_normal_vector3\"
        string inputs:space = \"world\"
        vector3f outputs:out }";
    let read = mtlx(OPEN_PBR, "vector3f inputs:geometry_normal.connect = </m/n.outputs:out>", nodes);
    assert_eq!((read.material().normal, read.warnings.as_str()), (None, ""));
}

#[test]
fn an_opacity_mode_that_is_not_obeyed_is_told() {
    let said = |lines: &str| preview(lines, "").warnings;
    let asked = "float inputs:opacity = 0.4\ntoken inputs:opacityMode = \"transparent\"";
    assert!(said(asked).contains("opacityMode \"transparent\" is rendered as \"presence\""));
    assert_eq!(said("float inputs:opacity = 0.4\ntoken inputs:opacityMode = \"presence\""), "");
    assert_eq!(said("token inputs:opacityMode = \"transparent\""), "");
}
