//! Procedural textures: their settings and sockets as the engine's graph takes them.

use super::flow::{At, Flow};
use crate::desc::graph::{
    Brick, Gradient, Leaf, Metric, Noise, NoiseKind, Op, Procedural, Scatter, ValueId, Voronoi, VoronoiFeature,
    VoronoiOutput, Wave, WaveDirection, WaveProfile,
};

/// The coordinates of a texture: those linked, or generated ones.
fn coordinates<'a>(flow: &mut Flow<'a, '_>, at: At<'a>) -> ValueId {
    flow.linked_or(at, "Vector", |flow| flow.graph.leaf(Leaf::Generated))
}

/// The texture's value; its number for an output that is one.
fn push<'a>(flow: &mut Flow<'a, '_>, procedural: Procedural, args: Vec<ValueId>, number: bool) -> ValueId {
    let value = flow.graph.push(Op::Procedural(procedural, args));
    if number { flow.graph.place(value, 3) } else { value }
}

fn args<'a, const N: usize>(flow: &mut Flow<'a, '_>, at: At<'a>, names: [&str; N]) -> Vec<ValueId> {
    std::iter::once(coordinates(flow, at)).chain(names.map(|name| flow.input(at, name))).collect::<Vec<_>>()
}

fn dimensions(text: &str) -> u8 {
    match text {
        "1D" => 1,
        "2D" => 2,
        "4D" => 4,
        _ => 3,
    }
}

/// Noise Texture.
pub fn noise<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let kind = match at.node.text("noise_type") {
        "MULTIFRACTAL" => NoiseKind::Multifractal,
        "HYBRID_MULTIFRACTAL" => NoiseKind::HybridMultifractal,
        "RIDGED_MULTIFRACTAL" => NoiseKind::RidgedMultifractal,
        "HETERO_TERRAIN" => NoiseKind::HeteroTerrain,
        _ => NoiseKind::Fbm,
    };
    let color = output == "Color";
    let noise = Noise {
        dimensions: dimensions(at.node.text("noise_dimensions")),
        kind,
        normalize: at.node.flag("normalize"),
        color,
    };
    let names = ["W", "Scale", "Detail", "Roughness", "Lacunarity", "Offset", "Gain", "Distortion"];
    let args = args(flow, at, names);
    push(flow, Procedural::Noise(noise), args, !color)
}

/// Voronoi Texture.
pub fn voronoi<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let feature = match at.node.text("feature") {
        "F2" => VoronoiFeature::F2,
        "SMOOTH_F1" => VoronoiFeature::SmoothF1,
        "DISTANCE_TO_EDGE" => VoronoiFeature::DistanceToEdge,
        "N_SPHERE_RADIUS" => VoronoiFeature::NSphereRadius,
        _ => VoronoiFeature::F1,
    };
    let metric = match at.node.text("distance") {
        "MANHATTAN" => Metric::Manhattan,
        "CHEBYCHEV" => Metric::Chebychev,
        "MINKOWSKI" => Metric::Minkowski,
        _ => Metric::Euclidean,
    };
    let output_kind = match output {
        "Position" | "W" => VoronoiOutput::Position,
        "Color" => VoronoiOutput::Color,
        _ => VoronoiOutput::Distance,
    };
    // 5.0 draws the points by other random numbers.
    let scatter = if flow.version[0] >= 5 { Scatter::Pcg } else { Scatter::Jenkins };
    let voronoi = Voronoi {
        dimensions: dimensions(at.node.text("voronoi_dimensions")),
        feature,
        metric,
        normalize: at.node.flag("normalize"),
        output: output_kind,
        scatter,
    };
    let names = ["W", "Scale", "Detail", "Roughness", "Lacunarity", "Smoothness", "Exponent", "Randomness"];
    let args = args(flow, at, names);
    push(flow, Procedural::Voronoi(voronoi), args, !matches!(output, "Color" | "Position"))
}

/// Wave Texture.
pub fn wave<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let rings = at.node.text("wave_type") == "RINGS";
    let direction = match at.node.text(if rings { "rings_direction" } else { "bands_direction" }) {
        "X" => WaveDirection::X,
        "Y" => WaveDirection::Y,
        "Z" => WaveDirection::Z,
        _ => WaveDirection::Whole,
    };
    let profile = match at.node.text("wave_profile") {
        "SAW" => WaveProfile::Saw,
        "TRI" => WaveProfile::Triangle,
        _ => WaveProfile::Sine,
    };
    let names = ["Scale", "Distortion", "Detail", "Detail Scale", "Detail Roughness", "Phase Offset"];
    let args = args(flow, at, names);
    push(flow, Procedural::Wave(Wave { rings, direction, profile }), args, output != "Color")
}

/// Magic Texture.
pub fn magic<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let depth = at.node.number("turbulence_depth").unwrap_or(2.0).clamp(0.0, 10.0) as u8;
    let args = args(flow, at, ["Scale", "Distortion"]);
    push(flow, Procedural::Magic { depth }, args, output != "Color")
}

/// Brick Texture.
pub fn brick<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let number = |name: &str, default: f64| at.node.number(name).unwrap_or(default);
    let brick = Brick {
        offset: number("offset", 0.5),
        offset_frequency: number("offset_frequency", 2.0).max(0.0) as u32,
        squash: number("squash", 1.0),
        squash_frequency: number("squash_frequency", 2.0).max(0.0) as u32,
    };
    let names =
        ["Color1", "Color2", "Mortar", "Scale", "Mortar Size", "Mortar Smooth", "Bias", "Brick Width", "Row Height"];
    let args = args(flow, at, names);
    push(flow, Procedural::Brick(brick), args, output != "Color")
}

/// Checker Texture.
pub fn checker<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let args = args(flow, at, ["Color1", "Color2", "Scale"]);
    push(flow, Procedural::Checker, args, output != "Color")
}

/// Gradient Texture.
pub fn gradient<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let gradient = match at.node.text("gradient_type") {
        "QUADRATIC" => Gradient::Quadratic,
        "EASING" => Gradient::Easing,
        "DIAGONAL" => Gradient::Diagonal,
        "RADIAL" => Gradient::Radial,
        "QUADRATIC_SPHERE" => Gradient::QuadraticSphere,
        "SPHERICAL" => Gradient::Spherical,
        _ => Gradient::Linear,
    };
    let args = args(flow, at, []);
    push(flow, Procedural::Gradient(gradient), args, true)
}

/// White Noise Texture.
pub fn white_noise<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let dimensions = dimensions(at.node.text("noise_dimensions"));
    // Unlike other textures it has coordinates of its own where nothing is linked.
    let args = vec![flow.input(at, "Vector"), flow.input(at, "W")];
    push(flow, Procedural::WhiteNoise { dimensions }, args, output != "Color")
}

/// Gabor Texture.
pub fn gabor<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let flat = at.node.text("gabor_type") != "3D";
    let orientation = if flat { "Orientation 2D" } else { "Orientation 3D" };
    let args = args(flow, at, ["Scale", "Frequency", "Anisotropy", orientation]);
    let value = flow.graph.push(Op::Procedural(Procedural::Gabor { flat }, args));
    flow.graph.place(value, super::math::place(output, ["Value", "Phase", "Intensity"]))
}
