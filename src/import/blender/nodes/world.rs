//! Worlds: a constant radiance, a lat-long image turned, or what any graph says.

use super::super::world::{Seen, WorldEmission, WorldPart};
use super::closure;
use super::flow::Flow;
use super::lamp::emission;
use crate::desc::DomeShader;
use crate::desc::graph::{Function, Leaf, Mapping, Math, Op, PathInfo, ValueId};
use crate::math::{DMat3, DVec3};

/// What the nodes of a world emit: a part for each kind of ray that sees another thing.
pub fn world(flow: &mut Flow<'_, '_>) -> Vec<WorldPart> {
    flow.is_world = true;
    let Some(output) = flow.output_node("ShaderNodeOutputWorld") else { return Vec::new() };
    let Some(surface) = output.node.input("Surface") else { return Vec::new() };
    if flow.is_linked(output, "Volume") {
        flow.warn("the world's volume is not supported; it is left out");
    }
    let mut sum = flow.graph.number(0.0);
    for part in closure::parts(flow, output, surface) {
        if !part.emits() {
            let (name, kind) = (&part.at.node.name, &part.at.node.r#type);
            flow.warn(format!("the shader \"{name}\" ({kind}) of a world is not supported; it is left out"));
            continue;
        }
        let emitted = emission(flow, part);
        sum = flow.graph.add(sum, emitted);
    }
    let mut parts = Vec::new();
    for (value, seen) in by_rays(flow, sum) {
        parts.push(WorldPart { emission: dome(flow, value), seen });
    }
    parts
}

/// What each kind of ray sees. Light sampling and rays that surfaces sample find the same: that a world is
/// seen from a diffuse surface is a matter of the surface, not of how light was found.
fn by_rays(flow: &mut Flow<'_, '_>, sum: ValueId) -> Vec<(ValueId, Seen)> {
    use PathInfo as P;
    let needed = flow.graph.needed([sum]);
    let path = |(op, needed): (&Op, bool)| match op {
        Op::Leaf(Leaf::Path(info)) if needed => Some(*info),
        _ => None,
    };
    let asked: Vec<PathInfo> = flow.graph.ops().iter().zip(needed).filter_map(path).collect();
    let exact = [P::IsCamera, P::IsShadow, P::IsDiffuse, P::IsGlossy, P::IsReflection, P::IsTransmission];
    if asked.is_empty() {
        return vec![(sum, Seen::ALL)];
    }
    if asked.iter().any(|info| !exact.contains(info)) {
        flow.warn("the world goes by lengths or depths of paths, or by mirrors: taken as at the first, rough bounce");
    }
    let none = Seen { camera: false, diffuse: false, glossy: false, transmission: false };
    let kinds: [(Seen, &[PathInfo]); 4] = [
        (Seen { camera: true, ..none }, &[P::IsCamera]),
        (Seen { diffuse: true, ..none }, &[P::IsDiffuse, P::IsReflection, P::Depth, P::DiffuseDepth]),
        (Seen { glossy: true, ..none }, &[P::IsGlossy, P::IsReflection, P::Depth, P::GlossyDepth]),
        (Seen { transmission: true, ..none }, &[P::IsGlossy, P::IsTransmission, P::Depth, P::TransmissionDepth]),
    ];
    let mut parts: Vec<(ValueId, Seen)> = Vec::new();
    for (seen, yes) in kinds {
        let value = flow.graph.replaced(sum, |_, op| match op {
            Op::Leaf(Leaf::Path(info)) => Some([f64::from(u8::from(yes.contains(info))); 4]),
            _ => None,
        });
        match parts.iter_mut().find(|(known, _)| *known == value) {
            Some((_, all)) => {
                all.camera |= seen.camera;
                all.diffuse |= seen.diffuse;
                all.glossy |= seen.glossy;
                all.transmission |= seen.transmission;
            }
            None => parts.push((value, seen)),
        }
    }
    parts
}

/// What one kind of ray sees.
fn dome(flow: &mut Flow<'_, '_>, value: ValueId) -> WorldEmission {
    let mut factor = [1.0; 3];
    let rest = factored(flow, value, &mut factor);
    if let Some([r, g, b, _]) = flow.graph.known(rest) {
        return WorldEmission::Constant([r * factor[0], g * factor[1], b * factor[2]]);
    }
    if let Some((texture, turn)) = equirectangular(flow, rest) {
        return WorldEmission::Image { factor, image: flow.images.image_of(texture), turn };
    }
    let needed = flow.graph.needed([value]);
    let suns = flow.suns.iter().copied().filter(|sun| needed[sun.sky.index()]).collect();
    WorldEmission::Graph(DomeShader { graph: flow.graph.clone(), radiance: value, suns })
}

/// Takes constant factors off a product.
fn factored(flow: &Flow<'_, '_>, value: ValueId, factor: &mut [f64; 3]) -> ValueId {
    let mut value = value;
    loop {
        let Op::Apply(Function::Math(math), args) = flow.graph.op(value) else { return value };
        let (constant, other) = match (flow.graph.known(args[0]), flow.graph.known(args[1])) {
            (Some(constant), None) => (constant, args[1]),
            (None, Some(constant)) => (constant, args[0]),
            _ => return value,
        };
        match math {
            Math::Multiply => (0..3).for_each(|i| factor[i] *= constant[i]),
            Math::Add if constant[..3] == [0.0; 3] => {}
            _ => return value,
        }
        value = other;
    }
}

/// An image looked up at a turned direction: the texture, and from the direction to what it is looked up
/// at.
fn equirectangular(flow: &Flow<'_, '_>, value: ValueId) -> Option<(u32, DMat3)> {
    let graph = &flow.graph;
    let Op::Image { texture, uv } = graph.op(value) else { return None };
    let (texture, uv) = (*texture, *uv);
    let Op::Apply(Function::Affine(_), args) = graph.op(uv) else { return None };
    let Op::Apply(Function::Equirectangular, args) = graph.op(args[0]) else { return None };
    let direction = args[0];
    let turn = match graph.op(direction) {
        Op::Leaf(Leaf::Position | Leaf::Generated) => DMat3::IDENTITY,
        Op::Apply(Function::Mapping(mapping), args) => {
            if !matches!(graph.op(args[0]), Op::Leaf(Leaf::Position | Leaf::Generated)) {
                return None;
            }
            let [location, rotation, scale] = [1, 2, 3].map(|i| graph.known(args[i]));
            let (location, rotation, scale) = (location?, rotation?, scale?);
            let moves = location[..3] != [0.0; 3] || scale[..3] != [1.0; 3];
            let euler = DMat3::from_rotation_z(rotation[2])
                * DMat3::from_rotation_y(rotation[1])
                * DMat3::from_rotation_x(rotation[0]);
            match mapping {
                _ if moves => return None,
                Mapping::Texture => euler.transpose(),
                _ => euler,
            }
        }
        _ => return None,
    };
    (turn * DVec3::X).is_finite().then_some((texture, turn))
}
