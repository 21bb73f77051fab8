//! Nodes of MaterialX that are noise of several numbers, slopes of heights, and pictures over each other.

use super::super::super::images::tests::png;
use super::*;
use crate::desc::graph::{Noise, Op as GraphOp, Procedural, Relief, Value};

const OPEN_PBR: &str = "ND_open_pbr_surface_surfaceshader";

/// A material whose color is that of a node, and what the graph makes of it where procedural textures are what `made`
/// says of them and their arguments.
fn color_of(node: &str, made: impl Fn(&Procedural, &[Value]) -> Value) -> Value {
    let nodes = format!("def Shader \"c\" {{ uniform token info:id = {node}\ncolor3f outputs:out }}");
    let read = mtlx(OPEN_PBR, "color3f inputs:base_color.connect = </m/c.outputs:out>", &nodes);
    assert_eq!(read.warnings, "", "{node}");
    let m = read.material();
    let Some(id) = m.base_color.graph else {
        let [r, g, b] = m.base_color.factor;
        return [r, g, b, 1.0];
    };
    let mut values: Vec<Value> = Vec::new();
    for op in m.graph.ops() {
        let args: Vec<Value> = op.args().map(|arg| values[arg.index()]).collect();
        values.push(match op {
            GraphOp::Constant(value) => *value,
            GraphOp::Leaf(_) => [0.5, 0.25, 0.0, 1.0],
            GraphOp::Apply(function, _) => function.eval(&args),
            GraphOp::Procedural(texture, _) => made(texture, &args),
            other => panic!("{other:?}"),
        });
    }
    values[id.index()]
}

/// A vector of which three places are told apart from a number, by where they are taken.
fn noise(texture: &Procedural, args: &[Value]) -> Value {
    match texture {
        Procedural::VectorNoise { .. } => [0.1, 0.2, 0.3, 0.1],
        Procedural::Noise(Noise { normalize: false, .. }) => [args[0][0] / 100.0; 4],
        Procedural::Worley { solid: false, .. } => [1.0, 2.0, 3.0, 4.0],
        Procedural::Worley { solid: true, .. } => [5.0, 6.0, 7.0, 8.0],
        Procedural::Cell { .. } => [0.75; 4],
        other => panic!("{other:?}"),
    }
}

#[test]
fn noise_of_several_numbers_has_an_amplitude_for_each() {
    let color = color_of(
        "\"ND_noise3d_color3\"
            float3 inputs:amplitude = (1, 2, 3)
            float inputs:pivot = 0.5",
        noise,
    );
    same(&color[..3], &[0.6, 0.9, 1.4]);
    let color = color_of("\"ND_noise2d_vector3FA\" float inputs:amplitude = 2", noise);
    same(&color[..3], &[0.2, 0.4, 0.6]);
    // The fourth number is noise elsewhere: of fractals (19, 193) away, as is the second one of two.
    let color = color_of("\"ND_fractal3d_vector4\" float4 inputs:amplitude = (1, 1, 1, 2)", noise);
    same(&color, &[0.1, 0.2, 0.3, 2.0 * 0.195]);
    let color = color_of("\"ND_fractal2d_vector2\"", noise);
    same(&color[..2], &[0.005, 0.195]);
}

#[test]
fn worley_noise_has_distances_or_cells() {
    same(&color_of("\"ND_worleynoise2d_vector3\"", noise)[..3], &[1.0, 2.0, 3.0]);
    same(&color_of("\"ND_worleynoise3d_float\" float inputs:jitter = 0.5", noise)[..3], &[4.0; 3]);
    same(&color_of("\"ND_worleynoise2d_vector3\" int inputs:style = 1", noise)[..3], &[5.0, 6.0, 7.0]);
    same(&color_of("\"ND_worleynoise2d_float\" int inputs:style = 1", noise)[..3], &[8.0; 3]);
}

#[test]
fn unified_noise_is_one_of_four() {
    let of = |lines: &str| color_of(&format!("\"ND_unifiednoise2d_float\" {lines}"), noise)[0];
    // 0.5 + 0.5 of the noise at (0.5, 0.25) · 2 + 3.
    let place = "float2 inputs:freq = (2, 2) float2 inputs:offset = (3, 0)".replace(" float2", "\nfloat2");
    same(&[of(&place)], &[0.5 + 0.5 * 0.04]);
    same(&[of("int inputs:type = 1\nfloat inputs:outmin = 1\nfloat inputs:outmax = 3")], &[2.5]);
    same(&[of("int inputs:type = 2")], &[1.0]);
    same(&[of("int inputs:type = 2\nbool inputs:clampoutput = 0")], &[4.0]);
    same(&[of("int inputs:type = 3")], &[0.005]);
}

#[test]
fn heights_bend_the_normal_by_their_slope() {
    let folder = tempfile::tempdir().unwrap();
    png(folder.path(), "h.png", 1, &[[255, 0, 0], [0, 0, 0]]);
    let of = |node: &str| {
        let nodes = format!(
            "def Shader \"n\" {{ uniform token info:id = {node}
                vector3f outputs:out }}
             def Shader \"h\" {{ uniform token info:id = \"ND_image_float\"
                asset inputs:file = @h.png@
                float outputs:out }}
             def Shader \"x\" {{ uniform token info:id = \"ND_noise3d_float\"
                float outputs:out }}"
        );
        let read =
            mtlx_in(folder.path(), OPEN_PBR, "normal3f inputs:geometry_normal.connect = </m/n.outputs:out>", &nodes);
        assert_eq!(read.warnings, "", "{node}");
        let m = read.material();
        let reliefs: Vec<Relief> = m
            .graph
            .ops()
            .iter()
            .filter_map(|op| match op {
                GraphOp::Relief(relief) => Some(*relief),
                _ => None,
            })
            .collect();
        let known = |id| m.graph.known(id).map(|value| value[0]);
        let scales: Vec<_> = reliefs.iter().map(|relief| known(relief.scale)).collect();
        (m.normal.is_some(), scales)
    };
    let height = "float inputs:height.connect = </m/h.outputs:out>";
    assert_eq!(of(&format!("\"ND_bump_vector3\" {height}")), (true, vec![Some(1.0)]));
    // A height that goes by the place is as good as an image.
    let noise = "float inputs:in.connect = </m/x.outputs:out>\nfloat inputs:scale = 4";
    let map = format!(
        "\"ND_normalmap_float\" vector3f inputs:in.connect = </m/g.outputs:out>
            vector3f outputs:out }}
         def Shader \"g\" {{ uniform token info:id = \"ND_heighttonormal_vector3\" {noise}"
    );
    assert_eq!(of(&map), (true, vec![Some(4.0)]));
    // What is level everywhere bends nothing.
    assert_eq!(of("\"ND_bump_vector3\" float inputs:height = 0.5"), (false, vec![]));
}

#[test]
fn the_time_is_that_of_the_frame() {
    let of = |node: &str, frame| {
        let lines = "float inputs:base_metalness.connect = </m/c.outputs:out>";
        let nodes = format!("def Shader \"c\" {{ uniform token info:id = \"{node}\"\nfloat outputs:out }}");
        let folder = tempfile::tempdir().unwrap();
        let options = ImportOptions { frame, ..ImportOptions::default() };
        let read = read_with(folder.path(), &material_of("mtlx:", OPEN_PBR, lines, &nodes), "/m", &options);
        read.material().metallic.factor
    };
    // 24 time codes a second; of a stage without time the defaults of the nodes.
    same(&[of("ND_frame_float", Some(6.0)), of("ND_time_float", Some(6.0))], &[6.0, 0.25]);
    same(&[of("ND_frame_float", None), of("ND_time_float", None)], &[1.0, 0.0]);
}

#[test]
fn pictures_lie_over_each_other() {
    let none = |texture: &Procedural, _: &[Value]| -> Value { panic!("{texture:?}") };
    let of = |node: &str, fg: &str, bg: &str| {
        let lines = format!("color4f inputs:fg = {fg}\ncolor4f inputs:bg = {bg}\nfloat inputs:mix = 0.5");
        color_of(&format!("\"ND_{node}_color4\" {lines}"), none)
    };
    let (fg, bg) = ("(0.25, 0, 0.5, 0.5)", "(1, 0.5, 0.5, 0.75)");
    // Half of what MaterialX's own expressions give, and half of the background.
    for (node, whole) in [
        ("over", [0.75, 0.25, 0.75]),
        ("in", [0.1875, 0.0, 0.375]),
        ("out", [0.0625, 0.0, 0.125]),
        ("mask", [0.5, 0.25, 0.25]),
        ("matte", [0.625, 0.25, 0.5]),
        ("disjointover", [0.25 + 2.0 / 3.0, 1.0 / 3.0, 0.5 + 1.0 / 3.0]),
    ] {
        let half: Vec<f64> = whole.iter().zip([1.0, 0.5, 0.5]).map(|(a, b)| 0.5 * a + 0.5 * b).collect();
        same(&of(node, fg, bg)[..3], &half);
    }
    // Together they cover no more than all.
    same(&of("disjointover", "(0.25, 0, 0, 0.25)", "(0.5, 0, 0, 0.5)")[..3], &[0.625, 0.0, 0.0]);
    let one = |node: &str, lines: &str| color_of(&format!("\"ND_{node}\" {lines}"), none)[0];
    same(&[one("outside_float", "float inputs:in = 4\nfloat inputs:mask = 0.25")], &[3.0]);
    same(&[one("trianglewave_float", "float inputs:in = -2.25")], &[0.25]);
    same(&[one("logical_xor", "bool inputs:in1 = 1\nbool inputs:in2 = 1")], &[0.0]);
    same(&[one("logical_not", "bool inputs:in = 0")], &[1.0]);
    same(&[one("distance_vector3", "vector3f inputs:in1 = (1, 2, 3)\nvector3f inputs:in2 = (1, 5, 7)")], &[5.0]);
    same(&[one("maxcomponent_vector3", "vector3f inputs:in = (1, 2, 3)")], &[3.0]);
    same(&[one("mincomponent_color4", "color4f inputs:in = (1, 2, 3, 0.5)")], &[0.5]);
}
