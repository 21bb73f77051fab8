//! Cube, Sphere, Cylinder, Cone, Capsule, Plane.

use std::mem::Discriminant;

use openusd::tf::Token;
use openusd::usd::Prim;
use openusd_schemas::geom::Primvar;

use super::super::stage::Reading;
use super::finish::{Channels, Surface};
use super::polygons::Triangles;
use super::primvar::{self, Channel, Counts, Primvars};
use super::profile::{Axis, Solid};
use super::{Built, Wants};
use crate::error::{Place, Warnings};
use openusd_schemas::geom::Interpolation;

/// A shape that is told by a few numbers.
pub(in super::super) struct Primitive {
    shape: Shape,
    axis: Axis,
    pub(super) primvars: Primvars,
}

#[derive(Debug)]
enum Shape {
    Cube { size: f64 },
    Sphere { radius: f64 },
    Cylinder { bottom: f64, top: f64, height: f64 },
    Capsule { bottom: f64, top: f64, height: f64 },
    Plane { width: f64, length: f64 },
}

/// The kind of a primitive, its axis and its numbers.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(in super::super) struct Likeness(Discriminant<Shape>, Axis, [u64; 3]);

/// The primitive `prim` of schema `kind`; `None` for other kinds, and, with a warning, for one without
/// extent.
pub(super) fn read(reading: &Reading<'_>, prim: &Prim, inherited: &[Primvar], kind: &str) -> Option<Primitive> {
    let lacking = std::cell::RefCell::new(Vec::new());
    // A size below 0 means nothing in the schema; Hydra draws the shape inside out.
    let size = |name: &'static str| {
        reading.value::<f64>(prim, name).filter(|v| v.is_finite()).map_or_else(
            || {
                lacking.borrow_mut().push(name);
                0.0
            },
            f64::abs,
        )
    };
    let (shape, has_extent) = match kind {
        "Cube" => {
            let size = size("size");
            (Shape::Cube { size }, size > 0.0)
        }
        "Sphere" => {
            let radius = size("radius");
            (Shape::Sphere { radius }, radius > 0.0)
        }
        "Cylinder" | "Cylinder_1" | "Cone" => {
            let [bottom, top] = match kind {
                "Cylinder" => [size("radius"); 2],
                "Cone" => [size("radius"), 0.0],
                _ => [size("radiusBottom"), size("radiusTop")],
            };
            let height = size("height");
            (Shape::Cylinder { bottom, top, height }, height > 0.0 && bottom.max(top) > 0.0)
        }
        "Capsule" | "Capsule_1" => {
            let [bottom, top] = match kind {
                "Capsule" => [size("radius"); 2],
                _ => [size("radiusBottom"), size("radiusTop")],
            };
            let height = size("height");
            let has_extent = bottom.max(top) > 0.0 && (height > 0.0 || bottom == top);
            (Shape::Capsule { bottom, top, height }, has_extent)
        }
        "Plane" => {
            let (width, length) = (size("width"), size("length"));
            (Shape::Plane { width, length }, width > 0.0 && length > 0.0)
        }
        _ => return None,
    };
    let mut lacking = lacking.into_inner();
    lacking.dedup();
    if !lacking.is_empty() {
        // Blocked, of another type, or not finite.
        let what = format!("there is no number in its {}; the shape is left out", lacking.join(" and "));
        reading.warn(prim.path(), what);
        return None;
    }
    if !has_extent {
        reading.warn(prim.path(), "the shape has no extent; it is left out");
        return None;
    }
    let axis = match shape {
        Shape::Cube { .. } | Shape::Sphere { .. } => Axis::Z,
        _ => axis(reading, prim),
    };
    Some(Primitive { shape, axis, primvars: primvar::read(reading, prim, inherited) })
}

fn axis(reading: &Reading<'_>, prim: &Prim) -> Axis {
    match reading.value::<Token>(prim, "axis") {
        Some(axis) if axis == "X" => Axis::X,
        Some(axis) if axis == "Y" => Axis::Y,
        Some(axis) if axis != "Z" => {
            reading.warn(prim.path(), format!("there is no axis \"{axis}\"; Z is used"));
            Axis::Z
        }
        _ => Axis::Z,
    }
}

impl Primitive {
    /// What makes two primitives the same; `None` for one that has values of its own.
    pub fn likeness(&self) -> Option<Likeness> {
        let sizes = match self.shape {
            Shape::Cube { size } => [size, 0.0, 0.0],
            Shape::Sphere { radius } => [radius, 0.0, 0.0],
            Shape::Cylinder { bottom, top, height } | Shape::Capsule { bottom, top, height } => [bottom, top, height],
            Shape::Plane { width, length } => [width, length, 0.0],
        };
        let likeness = Likeness(std::mem::discriminant(&self.shape), self.axis, sizes.map(f64::to_bits));
        self.primvars.is_empty().then_some(likeness)
    }

    pub fn build(self, wants: &Wants, place: &Place, warnings: &mut Warnings) -> Option<Built> {
        let Self { shape, axis, primvars } = self;
        let solid = match shape {
            Shape::Cube { size } => Solid::cube(size),
            Shape::Sphere { radius } => Solid::sphere(radius).along(axis),
            Shape::Cylinder { bottom, top, height } => Solid::cylinder(bottom, top, height).along(axis),
            Shape::Capsule { bottom, top, height } => Solid::capsule(bottom, top, height).along(axis),
            Shape::Plane { width, length } => Solid::plane(width, length, axis),
        };
        // What has one value for the whole shape; others count faces and points that only Hydra knows.
        let counts = Counts { faces: 1, joints: 1, points: 1, corners: 1 };
        let mut channels = Channels::new(primvars, &counts, wants, place, warnings);
        channels.make_constant();
        let mesh = solid_surface(solid, channels).finish(wants, place, warnings)?;
        Some(Built::Mesh(mesh))
    }
}

/// The surface of a solid.
pub(super) fn solid_surface(solid: Solid, mut channels: Channels) -> Surface {
    let Solid { points, normals, triangles } = solid;
    channels.normals = Some(Channel { interpolation: Interpolation::Vertex, values: normals, indices: None });
    let triangles = Triangles { points: triangles, corners: None, faces: None };
    Surface { points, triangles, channels, slots: None, motion: Vec::new() }
}
