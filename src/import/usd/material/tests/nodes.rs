//! Layers of MaterialX's surfaces, and nodes that go by where a surface is hit.

use super::super::super::images::tests::png;
use super::*;
use crate::desc::AlphaMode;
use crate::desc::graph::{Leaf, Noise, NoiseKind, Op as GraphOp, Procedural, Quantity, Space};

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
    let fractal = noises("\"ND_fractal2d_float\" int inputs:octaves = 2");
    assert_eq!(fractal, (Some((Noise { dimensions: 2, ..plain }, 1.0)), String::new()));
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
fn opacity_modes_have_their_fallback_and_what_is_none_is_told() {
    let clear = |read: &Read| read.material().transparency != ColorInput::constant([0.0; 3]);
    let is = |lines: &str| {
        let read = preview(lines, "");
        (clear(&read), read.material().alpha_mode, read.warnings)
    };
    let half = "float inputs:opacity = 0.5\ntoken inputs:opacityMode";
    assert_eq!(is("float inputs:opacity = 0.5"), (true, AlphaMode::Opaque, String::new()));
    assert_eq!(is(&format!("{half} = \"transparent\"")), (true, AlphaMode::Opaque, String::new()));
    assert_eq!(is(&format!("{half} = \"presence\"")), (false, AlphaMode::Blend, String::new()));
    assert_eq!(is("token inputs:opacityMode = \"transparent\""), (false, AlphaMode::Opaque, String::new()));
    let (is_clear, _, said) = is(&format!("{half} = \"odd\""));
    assert!(is_clear && said.contains("no opacityMode \"odd\""), "{said}");
    // MaterialX's is a number.
    let id = "ND_UsdPreviewSurface_surfaceshader";
    assert!(clear(&mtlx(id, "float inputs:opacity = 0.5", "")));
    assert!(!clear(&mtlx(id, "float inputs:opacity = 0.5\nint inputs:opacityMode = 1", "")));
    // Blender's exporter writes alpha, and no mode.
    let text = material_of("", "UsdPreviewSurface", "float inputs:opacity = 0.5", "");
    let folder = tempfile::tempdir().unwrap();
    assert!(clear(&read_at(folder.path(), &text, "/m")));
    let read = read_at(folder.path(), &format!("(\n doc = \"Blender v5.0.1\"\n)\n{text}"), "/m");
    assert_eq!((clear(&read), read.material().alpha_mode), (false, AlphaMode::Blend));
}

/// The nodes' definitions in numbers; every leaf is 0.5 and its alpha, too.
#[test]
fn coats_darken_what_is_beneath() {
    let lines = "color3f inputs:base_color = (0.8, 0.4, 0)
         float inputs:base_weight = 0.5
         float inputs:coat_weight = 0.5
         float inputs:coat_ior = 1.6";
    // K = 1 − (1 − F0) / η² of the coat, D = (1 − K) / (1 − E K), by half of which the color goes.
    let f0: f64 = (0.6 / 2.6) * (0.6 / 2.6);
    let leaves = (1.0 - f0) / (1.6 * 1.6);
    let darkened = |albedo: f64, amount: f64| 1.0 + amount * (leaves / (1.0 - albedo * (1.0 - leaves)) - 1.0);
    let read = mtlx(OPEN_PBR, lines, "");
    let m = read.material();
    let expected = [0.8, 0.4, 0.0].map(|c| 0.5 * c * darkened(c, 0.5));
    same(&m.base_color.factor, &expected);
    same(&m.specular_color.factor, &[0.8, 0.4, 0.0].map(|c| darkened(c, 0.5)));
    same(&m.coat.unwrap().tint.factor, &[1.0; 3]);
    assert_eq!(read.warnings, "");
    let half = mtlx(OPEN_PBR, &format!("{lines}\nfloat inputs:coat_darkening = 0.5"), "");
    same(&half.material().base_color.factor, &[0.8, 0.4, 0.0].map(|c| 0.5 * c * darkened(c, 0.25)));
    let metal =
        mtlx(OPEN_PBR, &format!("{lines}\nfloat inputs:base_metalness = 1\nfloat inputs:specular_weight = 0.5"), "");
    // The weight counts for what is darkened, and for what is left of it.
    same(&metal.material().base_color.factor, &[0.8, 0.4, 0.0].map(|c| 0.25 * c * darkened(0.5 * c, 0.5)));
    let none = mtlx(OPEN_PBR, &format!("{lines}\nfloat inputs:coat_darkening = 0"), "");
    same(&none.material().base_color.factor, &[0.4, 0.2, 0.0]);
}

#[test]
fn ramps_have_up_to_ten_colors() {
    let ramp = |more: &str| {
        color_by(&format!(
            "def Shader \"c\" {{ uniform token info:id = \"ND_ramp\"
                color4f inputs:color1 = (1, 0, 0, 1)
                color4f inputs:color2 = (0, 1, 0, 1)
                color4f inputs:color3 = (0, 0, 1, 1)
                float inputs:interval2 = 0.25
                int inputs:num_intervals = 3
                {more}
                color4f outputs:out }}"
        ))
    };
    // From green at 0.25 to blue at 1, a third of the way.
    let linear = ramp("int inputs:interpolation = 0");
    same(&linear.0[..3], &[0.0, 2.0 / 3.0, 1.0 / 3.0]);
    assert_eq!(linear.1, "");
    let share = (1.0 / 3.0) * (1.0 / 3.0) * (3.0 - 2.0 / 3.0);
    same(&ramp("").0[..3], &[0.0, 1.0 - share, share]);
    same(&ramp("int inputs:interpolation = 2").0[..3], &[0.0, 1.0, 0.0]);
    // In the middle the distance from there is 0, and so is that to the nearest side.
    same(&ramp("int inputs:type = 2").0[..3], &[1.0, 0.0, 0.0]);
    same(&ramp("int inputs:type = 3").0[..3], &[1.0, 0.0, 0.0]);
}

#[test]
fn colors_go_with_and_without_their_alpha() {
    let of = |node: &str| {
        color_by(&format!(
            "def Shader \"c\" {{ uniform token info:id = \"ND_{node}_color4\"
                color4f inputs:in.connect = </m/p.outputs:out>
                color4f outputs:out }}
             def Shader \"p\" {{ uniform token info:id = \"ND_combine4_color4\"
                float inputs:in1.connect = </m/q.outputs:outx>
                float inputs:in2 = 0.25
                float inputs:in3 = 0
                float inputs:in4 = 0.5
                color4f outputs:out }}
             def Shader \"q\" {{ uniform token info:id = \"ND_separate3_vector3\"
                vector3f inputs:in.connect = </m/r.outputs:out>
                float outputs:outx }}
             def Shader \"r\" {{ uniform token info:id = \"ND_position_vector3\"
                vector3f outputs:out }}"
        ))
    };
    same(&of("premult").0, &[0.25, 0.125, 0.0, 0.5]);
    same(&of("unpremult").0, &[1.0, 0.5, 0.0, 0.5]);
    assert_eq!(of("premult").1 + &of("unpremult").1, "");
}

/// A conductor of these reflects what was asked for: ((n − 1)² + k²) / ((n + 1)² + k²).
#[test]
fn artistic_indices_reflect_what_they_are_made_of() {
    let output = |name: &str| {
        color_by(&format!(
            "def Shader \"c\" {{ uniform token info:id = \"ND_multiply_color3\"
                color3f inputs:in1.connect = </m/a.outputs:{name}>
                color3f outputs:out }}
             def Shader \"a\" {{ uniform token info:id = \"ND_artistic_ior\"
                color3f inputs:reflectivity.connect = </m/r.outputs:out>
                color3f inputs:edge_color = (0.25, 0.5, 0.75)
                color3f outputs:ior
                color3f outputs:extinction }}
             def Shader \"r\" {{ uniform token info:id = \"ND_position_vector3\"
                vector3f outputs:out }}"
        ))
        .0
    };
    let (n, k) = (output("ior"), output("extinction"));
    for i in 0..3 {
        let k2 = k[i] * k[i];
        same(&[((n[i] - 1.0).powi(2) + k2) / ((n[i] + 1.0).powi(2) + k2)], &[0.5]);
    }
}

#[test]
fn facing_ratios_are_cosines() {
    let of = |more: &str| {
        let nodes = format!(
            "def Shader \"c\" {{ uniform token info:id = \"ND_facingratio_float\"
                vector3f inputs:normal = (0, 0.6, 0.8)
                vector3f inputs:viewdirection = (0, 0, -1)
                {more}
                float outputs:out }}"
        );
        let read = mtlx(OPEN_PBR, "float inputs:specular_roughness.connect = </m/c.outputs:out>", &nodes);
        read.material().roughness.factor
    };
    same(&[of(""), of("bool inputs:invert = 1"), of("bool inputs:faceforward = 0")], &[0.8, 0.2, 0.8]);
    // Of the hit itself: every leaf is 0.5 in all places.
    let (own, said) = color_by(
        "def Shader \"c\" { uniform token info:id = \"ND_facingratio_float\"
            float outputs:out }",
    );
    same(&own[..1], &[0.75]);
    assert_eq!(said, "");
}

/// Cells are 0.25 here; which cell it is are the arguments.
#[test]
fn random_values_are_cells_of_noise() {
    let (color, said) = color_by(
        "def Shader \"c\" { uniform token info:id = \"ND_randomcolor_float\"
            float inputs:in = 0.5
            float inputs:saturationlow = 0
            int inputs:seed = 3
            color3f outputs:out }",
    );
    // Hue and saturation of a quarter.
    same(&color[..3], &[0.875, 1.0, 0.75]);
    assert_eq!(said, "");
    let read = mtlx(
        OPEN_PBR,
        "float inputs:specular_roughness.connect = </m/c.outputs:out>",
        "def Shader \"c\" { uniform token info:id = \"ND_randomfloat_integer\"
            int inputs:in = 4
            int inputs:seed = 7
            float inputs:max = 2
            float outputs:out }",
    );
    let m = read.material();
    same(&value_of(m, m.roughness.graph.unwrap(), &[]), &[0.5; 4]);
    let cells: Vec<_> = m
        .graph
        .ops()
        .iter()
        .filter_map(|op| match op {
            GraphOp::Procedural(Procedural::Cell { dimensions: 2 }, args) => m.graph.known(args[0]),
            _ => None,
        })
        .collect();
    assert_eq!(cells, [[4.0, 7.0, 0.0, 1.0]]);
}

#[test]
fn values_go_between_the_spaces_of_the_object_and_the_stage() {
    let read = mtlx(
        OPEN_PBR,
        "color3f inputs:base_color.connect = </m/a.outputs:out>
         color3f inputs:specular_color.connect = </m/b.outputs:out>
         color3f inputs:coat_color.connect = </m/t.outputs:out>
         float inputs:coat_weight = 1
         float inputs:coat_darkening = 0",
        "def Shader \"a\" { uniform token info:id = \"ND_transformpoint_vector3\"
            vector3f inputs:in = (1, 2, 3)
            string inputs:fromspace = \"world\"
            string inputs:tospace = \"object\"
            vector3f outputs:out }
         def Shader \"b\" { uniform token info:id = \"ND_transformnormal_vector3\"
            string inputs:fromspace = \"object\"
            string inputs:tospace = \"world\"
            vector3f outputs:out }
         def Shader \"t\" { uniform token info:id = \"ND_bitangent_vector3\"
            vector3f outputs:out }",
    );
    assert_eq!(read.warnings, "");
    let m = read.material();
    let transforms: Vec<_> = m
        .graph
        .ops()
        .iter()
        .filter_map(|op| match op {
            GraphOp::Transform { quantity, from, to, value } => Some((*quantity, *from, *to, m.graph.known(*value))),
            _ => None,
        })
        .collect();
    // Of the stage's units, centimetres.
    let (point, normal) = (Some([0.01, 0.02, 0.03, 1.0]), Some([0.0, 0.0, 1.0, 1.0]));
    assert_eq!(transforms.len(), 2);
    for (found, expected) in transforms.iter().zip([
        (Quantity::Point, Space::World, Space::Object, point),
        (Quantity::Normal, Space::Object, Space::World, normal),
    ]) {
        assert_eq!((found.0, found.1, found.2), (expected.0, expected.1, expected.2));
        same(&found.3.unwrap()[..3], &expected.3.unwrap()[..3]);
    }
    assert!(m.graph.ops().contains(&GraphOp::Leaf(Leaf::Tangent)));
    let unknown = mtlx(
        OPEN_PBR,
        "color3f inputs:base_color.connect = </m/a.outputs:out>",
        "def Shader \"a\" { uniform token info:id = \"ND_transformpoint_vector3\"
            string inputs:fromspace = \"world\"
            string inputs:tospace = \"screen\"
            vector3f outputs:out }",
    );
    assert!(unknown.warnings.contains("from \"world\" to \"screen\" isn't computed"), "{}", unknown.warnings);
}

#[test]
fn three_images_are_projected_by_the_normal() {
    let folder = tempfile::tempdir().unwrap();
    png(folder.path(), "x.png", 1, &[[255, 0, 0]]);
    png(folder.path(), "y.png", 1, &[[0, 255, 0]]);
    png(folder.path(), "z.png", 1, &[[0, 0, 255]]);
    let read = mtlx_in(
        folder.path(),
        OPEN_PBR,
        "color3f inputs:base_color.connect = </m/c.outputs:out>",
        "def Shader \"c\" { uniform token info:id = \"ND_triplanarprojection_color3\"
            asset inputs:filex = @x.png@
            asset inputs:filey = @y.png@
            asset inputs:filez = @z.png@
            vector3f inputs:normal = (0.48, 0.6, -0.64)
            float inputs:blend = 0.5
            int inputs:upaxis = 1
            color3f outputs:out }",
    );
    assert_eq!(read.warnings, "");
    let m = read.material();
    let texels: Vec<(u32, [f64; 4])> = (0..3).map(|i| (i, std::array::from_fn(|k| f64::from(k as u32 == i)))).collect();
    // Squares of the shares, by their sum.
    let color = value_of(m, m.base_color.graph.unwrap(), &texels);
    same(&color[..3], &[0.2304, 0.36, 0.4096]);
    // Looked up by z y, x z and x y.
    let places: Vec<_> = m
        .graph
        .ops()
        .iter()
        .filter_map(|op| match op {
            GraphOp::Image { texture, uv } => Some((*texture, m.graph.op(*uv).clone())),
            _ => None,
        })
        .collect();
    assert_eq!(places.iter().map(|(texture, _)| *texture).collect::<Vec<_>>(), [0, 1, 2]);
    assert!(places.iter().all(|(_, uv)| matches!(uv, GraphOp::Apply(..))));
}
