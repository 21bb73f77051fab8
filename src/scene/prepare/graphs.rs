//! What graphs need: their programs, and what these ask of meshes and objects.

use std::sync::Arc;

use super::geometry::Geometry;
use super::materials::Textures;
use crate::desc::graph::{Graph, Leaf, Op, Space, Value, ValueId};
use crate::desc::{self, InstanceDesc, MaterialDesc, MeshDesc, RoundsDesc, SceneDesc, TextureTransform};
use crate::math::DVec3;
use crate::scene::Material;
use crate::scene::asked::{Asked, Names, OfMesh, OfObject};
use crate::shape::Attribute;
use crate::texture::graph::{Compiler, Program, Resolve, Resolved};

/// Where the indices and names of one material's graph lead.
struct Ends<'t, 'd> {
    textures: &'t mut Textures<'d>,
    names: &'t mut Names,
    material_index: u32,
}

impl Resolve for Ends<'_, '_> {
    fn texture(&mut self, texture: u32) -> Resolved {
        let plain = desc::TextureRef { texture, uv_set: 0, transform: TextureTransform::IDENTITY };
        match self.textures.constant(&plain) {
            Some(texel) => Resolved::Constant(texel.map(f64::from)),
            None => match self.textures.input(&plain) {
                Some(input) => Resolved::Texture(input.texture),
                None => Resolved::Constant([1.0; 4]),
            },
        }
    }

    fn attribute(&mut self, name: &Arc<str>) -> u16 {
        self.names.slot(name)
    }

    fn material_index(&self) -> u32 {
        self.material_index
    }
}

/// A program for `values` of a material's `graph`.
pub fn program(
    material: &MaterialDesc,
    graph: &Graph,
    values: &[ValueId],
    textures: &mut Textures<'_>,
    names: &mut Names,
) -> Program {
    let mut ends = Ends { textures, names, material_index: material.material_index };
    Compiler::new(graph, &mut ends).program(values)
}

/// A value that is the same everywhere.
pub fn constant(
    material: &MaterialDesc,
    graph: &Graph,
    value: ValueId,
    textures: &mut Textures<'_>,
    names: &mut Names,
) -> Option<Value> {
    let mut ends = Ends { textures, names, material_index: material.material_index };
    Compiler::new(graph, &mut ends).constant(value)
}

/// Textures that values of a material's graph look up.
pub fn textures(material: &MaterialDesc) -> Vec<u32> {
    looked_up(&material.graph, material.graph_values())
}

/// Textures that `values` of a graph look up.
pub fn looked_up(graph: &Graph, values: impl IntoIterator<Item = ValueId>) -> Vec<u32> {
    let needed = graph.needed(values);
    let looked_up = graph.ops().iter().zip(needed).filter_map(|(op, needed)| match op {
        Op::Image { texture, .. } if needed => Some(*texture),
        _ => None,
    });
    looked_up.collect()
}

/// True where one of `values` of a graph goes by the camera or by where in the picture something is seen.
pub fn follows_camera(graph: &Graph, values: impl IntoIterator<Item = ValueId>) -> bool {
    let needed = graph.needed(values);
    graph.ops().iter().zip(needed).any(|(op, needed)| {
        let follows = match op {
            Op::Leaf(leaf) => matches!(leaf, Leaf::CameraPosition | Leaf::Window),
            Op::Transform { from, to, .. } => [*from, *to].contains(&Space::Camera),
            _ => false,
        };
        needed && follows
    })
}

/// What the programs ask of the meshes and objects of `geometry`; nothing where there is none.
pub fn asked(desc: &SceneDesc, geometry: &Geometry, materials: &[Material], names: Names) -> Asked {
    if materials.iter().all(|material| material.programs.is_none()) {
        return Asked::default();
    }
    let names = names.with_generated();
    let meshes = desc.meshes.iter().map(|mesh| of_mesh(mesh, &names));
    let rounds = desc.rounds.iter().map(|rounds| of_rounds(rounds, &names));
    let shapes = meshes.chain(rounds).collect();
    let objects = geometry.placed.iter().map(|&i| of_object(&desc.instances[i as usize], &names)).collect();
    Asked { shapes, objects }
}

fn of_mesh(desc: &MeshDesc, names: &Names) -> OfMesh {
    let find = |name: &Arc<str>| {
        let found = desc.attributes.iter().find(|attribute| attribute.name == *name)?;
        Some(super::geometry::convert(&found.values, |v| v.map(|x| if x.is_finite() { x } else { 0.0 })))
    };
    let attributes: Vec<_> = names.iter().map(find).collect();
    let corners = desc.generated.map_or_else(|| corners_of(&desc.points), |corners| corners.map(DVec3::from));
    let generated = names.generated().filter(|slot| attributes[usize::from(*slot)].is_some());
    OfMesh { attributes, generated: (generated, unit_box(corners)) }
}

fn of_rounds(desc: &RoundsDesc, names: &Names) -> OfMesh {
    let find = |name: &Arc<str>| {
        let (_, values) = desc.attributes.iter().find(|(of, _)| of == name)?;
        let finite = |v: &[f32; 4]| v.map(|x| if x.is_finite() { x } else { 0.0 });
        Some(Attribute::Point(values.iter().map(finite).collect()))
    };
    let attributes = names.iter().map(find).collect();
    OfMesh { attributes, generated: (None, unit_box(corners_of(&desc.points))) }
}

/// Least and largest corner of the box of all points that are finite.
fn corners_of(points: &[[f32; 3]]) -> [DVec3; 2] {
    let finite = points.iter().map(|p| DVec3::from(p.map(f64::from))).filter(|p| p.is_finite());
    finite.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[least, largest], p| [least.min(p), largest.max(p)])
}

/// The least corner of a box, and one by its size.
fn unit_box([least, largest]: [DVec3; 2]) -> [DVec3; 2] {
    let inverse = (largest - least).map(|size| if size.is_finite() && size != 0.0 { size.recip() } else { 0.0 });
    [least.map(|x| if x.is_finite() { x } else { 0.0 }), inverse]
}

fn of_object(desc: &InstanceDesc, names: &Names) -> OfObject {
    let finite = |x: f64| if x.is_finite() { x } else { 0.0 };
    let find = |name: &Arc<str>| {
        let found = desc.info.attributes.iter().find(|(of, _)| of == name)?;
        Some(found.1.map(finite))
    };
    OfObject {
        location: desc.transform.translation.map(finite),
        color: desc.info.color.map(finite),
        random: finite(desc.info.random),
        index: f64::from(desc.object_index),
        attributes: names.iter().map(find).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::graph::{Function, Math};

    #[test]
    fn a_graph_follows_the_camera_where_what_is_needed_of_it_does() {
        let mut graph = Graph::default();
        let position = graph.leaf(Leaf::Position);
        let window = graph.leaf(Leaf::Window);
        let (quantity, from, to) = (crate::desc::graph::Quantity::Vector, Space::World, Space::Camera);
        let turned = graph.push(Op::Transform { quantity, from, to, value: position });
        let sum = graph.apply(Function::Math(Math::Add), &[position, window]);
        assert!(!follows_camera(&graph, [position]));
        assert!([window, turned, sum].iter().all(|&value| follows_camera(&graph, [value])));
    }
}
