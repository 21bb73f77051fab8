//! Cube, Sphere, Cylinder, Cone, Capsule, Plane.

use std::mem::Discriminant;

use openusd::tf::Token;
use openusd::usd::{Prim, TimeCode};
use openusd_schemas::geom::Primvar;

use super::super::retime;
use super::super::stage::Reading;
use super::finish::{Channels, Surface};
use super::polygons::Triangles;
use super::primvar::{self, Channel, Counts, Primvars};
use super::profile::{Axis, CUBE, PLANE, Solid};
use super::{Built, Wants};
use crate::desc::Motion;
use crate::error::{Place, Warnings};
use openusd_schemas::geom::Interpolation;

/// A shape that is told by a few numbers.
pub(in super::super) struct Primitive {
    shape: Shape,
    axis: Axis,
    motion: Vec<Motion<Shape>>,
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

/// The primitive `prim` of schema `kind`, and its sizes while the shutter is open; `None` for other kinds, and,
/// with a warning, for one without extent.
pub(super) fn read(reading: &Reading<'_>, prim: &Prim, inherited: &[Primvar], kind: &str) -> Option<Primitive> {
    let (mut lacking, mut negative, mut flat) = (Vec::new(), Vec::new(), Vec::new());
    let shape = shape(kind, |name| match reading.value::<f64>(prim, name).filter(|v| v.is_finite()) {
        Some(size) => {
            if size < 0.0 {
                negative.push(name);
            } else if size == 0.0 {
                flat.push(name);
            }
            size.abs()
        }
        None => {
            lacking.push(name);
            0.0
        }
    })?;
    if !lacking.is_empty() {
        // Blocked, of another type, or not finite.
        let what = format!("there is no number in its {}; the shape is left out", lacking.join(" and "));
        reading.warn(prim.path(), what);
        return None;
    }
    if !negative.is_empty() {
        // It means nothing in the schema; Hydra draws the shape inside out.
        let what = format!("its {} is negative; taken without the sign", negative.join(" and "));
        reading.warn(prim.path(), what);
    }
    if !shape.has_extent() {
        reading.warn(prim.path(), format!("its {} is 0; the shape is left out", flat.join(" and ")));
        return None;
    }
    let axis = match shape {
        Shape::Cube { .. } | Shape::Sphere { .. } => Axis::Z,
        _ => axis(reading, prim),
    };
    let motion = motion(reading, prim, kind);
    Some(Primitive { shape, axis, motion, primvars: primvar::read(reading, prim, inherited) })
}

/// The shape of schema `kind` whose numbers `size` gives by name; `None` for other kinds.
fn shape(kind: &str, mut size: impl FnMut(&'static str) -> f64) -> Option<Shape> {
    Some(match kind {
        "Cube" => Shape::Cube { size: size("size") },
        "Sphere" => Shape::Sphere { radius: size("radius") },
        "Cylinder" | "Cylinder_1" | "Cone" | "Capsule" | "Capsule_1" => {
            let [bottom, top] = match kind {
                "Cone" => [size("radius"), 0.0],
                "Cylinder_1" | "Capsule_1" => [size("radiusBottom"), size("radiusTop")],
                _ => [size("radius"); 2],
            };
            let height = size("height");
            match kind.starts_with("Capsule") {
                true => Shape::Capsule { bottom, top, height },
                false => Shape::Cylinder { bottom, top, height },
            }
        }
        "Plane" => Shape::Plane { width: size("width"), length: size("length") },
        _ => return None,
    })
}

/// The shape at the ends of the shutter and at the samples between them, in frames after the one that is read;
/// empty for one that keeps its size.
fn motion(reading: &Reading<'_>, prim: &Prim, kind: &str) -> Vec<Motion<Shape>> {
    let Some(shutter) = reading.shutter.get() else { return Vec::new() };
    let mut sizes = Vec::new();
    shape(kind, |name| {
        sizes.push(prim.attribute(name));
        0.0
    });
    sizes.retain(|size| size.value_might_be_time_varying().unwrap_or(false));
    if sizes.is_empty() {
        return Vec::new();
    }
    let now = reading.time.value();
    let [open, close] = shutter.map(|frame| now + frame);
    let mut times = retime::samples(reading, &sizes, open, close);
    times.extend([open, close]);
    times.sort_by(f64::total_cmp);
    times.dedup();
    let at = |time: f64| {
        let moved = |name: &str| reading.value_of::<f64>(&prim.attribute(name), TimeCode::new(time));
        let size = |name| moved(name).or_else(|| reading.value(prim, name)).unwrap_or(f64::NAN).abs();
        let value = shape(kind, size).filter(Shape::has_extent)?;
        Some(Motion { time: time - now, value })
    };
    let motion: Option<Vec<_>> = times.into_iter().map(at).collect();
    motion.unwrap_or_else(|| {
        reading.warn(prim.path(), "it has no extent for a part of the shutter; it keeps its size");
        Vec::new()
    })
}

impl Shape {
    fn has_extent(&self) -> bool {
        match *self {
            Self::Cube { size } => size > 0.0,
            Self::Sphere { radius } => radius > 0.0,
            Self::Cylinder { bottom, top, height } => height > 0.0 && bottom.max(top) > 0.0,
            Self::Capsule { bottom, top, height } => bottom.max(top) > 0.0 && (height > 0.0 || bottom == top),
            Self::Plane { width, length } => width > 0.0 && length > 0.0,
        }
    }

    fn solid(&self, axis: Axis) -> Solid {
        match *self {
            Self::Cube { size } => Solid::cube(size),
            Self::Sphere { radius } => Solid::sphere(radius).along(axis),
            Self::Cylinder { bottom, top, height } => Solid::cylinder(bottom, top, height).along(axis),
            Self::Capsule { bottom, top, height } => Solid::capsule(bottom, top, height).along(axis),
            Self::Plane { width, length } => Solid::plane(width, length, axis),
        }
    }
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
        (self.motion.is_empty() && self.primvars.is_empty()).then_some(likeness)
    }

    pub fn build(self, wants: &Wants, place: &Place, warnings: &mut Warnings) -> Option<Built> {
        let Self { shape, axis, motion, primvars } = self;
        let solid = shape.solid(axis);
        let moved = |&Motion { time, ref value }: &Motion<Shape>| Motion { time, value: value.solid(axis).points };
        let mut motion: Vec<_> = motion.iter().map(moved).collect();
        if motion.iter().any(|moved| moved.value.len() != solid.points.len()) {
            warnings.push(place, "an end of it comes to a point within the shutter; it keeps its size");
            motion.clear();
        }
        let mut channels = match shape {
            Shape::Cube { .. } => at_corners(&CUBE, 8, primvars, wants, place, warnings),
            Shape::Plane { .. } => at_corners(&PLANE, 4, primvars, wants, place, warnings),
            // What has one value for the whole shape; others count faces and points that only Hydra knows.
            _ => {
                let counts = Counts { faces: 1, joints: 1, points: 1, corners: 1 };
                Channels::new(primvars, &counts, wants, place, warnings)
            }
        };
        if !matches!(shape, Shape::Cube { .. } | Shape::Plane { .. }) {
            channels.make_constant();
        }
        let surface = Surface { motion, ..solid_surface(solid, channels) };
        let mesh = surface.finish(wants, place, warnings)?;
        Some(Built::Mesh(mesh))
    }
}

/// The values of a shape of `faces` with `points`, one for each of its faces' corners, each of which is a point
/// of the solid.
fn at_corners(
    faces: &[[u32; 4]],
    points: usize,
    primvars: Primvars,
    wants: &Wants,
    place: &Place,
    warnings: &mut Warnings,
) -> Channels {
    let counts = Counts { faces: faces.len(), joints: points, points, corners: 4 * faces.len() };
    let mut channels = Channels::new(primvars, &counts, wants, place, warnings);
    channels.uvs.iter_mut().for_each(|(_, channel)| *channel = by_corner(channel, faces));
    channels.color = channels.color.as_ref().map(|channel| by_corner(channel, faces));
    channels.opacity = channels.opacity.as_ref().map(|channel| by_corner(channel, faces));
    channels
}

fn by_corner<const N: usize>(channel: &Channel<N>, faces: &[[u32; 4]]) -> Channel<N> {
    let value = |(corner, &point): (usize, &u32)| {
        channel.at(match channel.interpolation {
            Interpolation::Constant => 0,
            Interpolation::Uniform => corner / 4,
            Interpolation::Varying | Interpolation::Vertex => point as usize,
            Interpolation::FaceVarying => corner,
        })
    };
    let values = faces.as_flattened().iter().enumerate().map(value).collect();
    Channel { interpolation: Interpolation::Vertex, values, indices: None }
}

/// The surface of a solid.
pub(super) fn solid_surface(solid: Solid, mut channels: Channels) -> Surface {
    let Solid { points, normals, triangles } = solid;
    channels.normals = Some(Channel { interpolation: Interpolation::Vertex, values: normals, indices: None });
    let triangles = Triangles { points: triangles, corners: None, faces: None };
    Surface { points, triangles, channels, slots: None, motion: Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::super::super::light::testing::Stage;
    use super::super::testing::built;
    use super::*;
    use crate::desc::{Attribute, MeshDesc};
    use crate::math::Vec3;

    fn shape(kind: &str, primvar: &str) -> (MeshDesc, Vec<String>) {
        let wants = Wants { display_color: true, ..Wants::default() };
        let (built, told) = built(&format!("def {kind} \"S\" {{ {primvar} }}"), "/S", &wants, 0);
        (built.unwrap().into_mesh(), told)
    }

    /// Colours of as many greys as there are elements.
    fn greys(count: usize, interpolation: &str) -> String {
        let colors: Vec<String> = (0..count).map(|i| format!("({i}, {i}, {i})")).collect();
        format!("color3f[] primvars:displayColor = [{}] (interpolation = \"{interpolation}\")", colors.join(", "))
    }

    /// At each corner of each triangle: where it is, which way it faces, and its grey.
    fn corners(mesh: &MeshDesc) -> Vec<(Vec3, Vec3, usize)> {
        let Some(Attribute::Point(colors)) = &mesh.colors else { panic!("no colours at points") };
        let corner = |triangle: [u32; 3], i: u32| {
            let [a, b, c] = triangle.map(|i| Vec3::from(mesh.points[i as usize]));
            let normal = (b - a).cross(c - a).normalize();
            (Vec3::from(mesh.points[i as usize]), normal, colors[i as usize][0] as usize)
        };
        mesh.triangles.iter().flat_map(|&triangle| triangle.map(|i| corner(triangle, i))).collect()
    }

    /// The faces and points of UsdImaging's cube (GeomUtilCuboidMeshGenerator).
    #[test]
    fn a_cube_has_the_colors_of_its_faces_points_and_corners() {
        let faces = [Vec3::Z, -Vec3::Z, Vec3::Y, -Vec3::Y, Vec3::X, -Vec3::X];
        let points =
            [(1, 1, 1), (-1, 1, 1), (-1, -1, 1), (1, -1, 1), (-1, -1, -1), (-1, 1, -1), (1, 1, -1), (1, -1, -1)];
        let points = points.map(|(x, y, z)| Vec3::new(x as f32, y as f32, z as f32));
        let (mesh, told) = shape("Cube", &greys(6, "uniform"));
        assert_eq!(told, [""; 0]);
        for (_, normal, grey) in corners(&mesh) {
            assert_eq!(normal, faces[grey]);
        }
        for interpolation in ["vertex", "varying"] {
            let (mesh, told) = shape("Cube", &greys(8, interpolation));
            assert_eq!(told, [""; 0]);
            for (point, _, grey) in corners(&mesh) {
                assert_eq!(point, points[grey]);
            }
        }
        let (mesh, told) = shape("Cube", &greys(24, "faceVarying"));
        assert_eq!(told, [""; 0]);
        for (point, normal, grey) in corners(&mesh) {
            assert_eq!((point, normal), (points[CUBE[grey / 4][grey % 4] as usize], faces[grey / 4]));
        }
    }

    #[test]
    fn a_plane_has_four_points() {
        for (axis, normal, first) in [
            ("X", Vec3::X, Vec3::new(0.0, 1.0, 1.0)),
            ("Y", Vec3::Y, Vec3::new(-1.0, 0.0, 1.0)),
            ("Z", Vec3::Z, Vec3::new(1.0, 1.0, 0.0)),
        ] {
            let (mesh, told) = shape("Plane", &format!("uniform token axis = \"{axis}\"\n{}", greys(4, "vertex")));
            assert_eq!(told, [""; 0]);
            for (point, facing, grey) in corners(&mesh) {
                assert_eq!(facing, normal);
                assert!(grey != 0 || point == first, "{axis}: {point}");
            }
        }
    }

    #[test]
    fn a_size_that_changes_within_the_shutter_is_motion() {
        let moving = |kind: &str, sizes: &str, shutter| {
            let stage = Stage::new("startTimeCode = 0\nendTimeCode = 1", &format!("def {kind} \"S\" {{ {sizes} }}"));
            stage.with("/S", |reading, placed| {
                reading.shutter.set(shutter);
                let shape = read(reading, &placed.prim, &[], kind).unwrap();
                let Built::Mesh(mesh) =
                    shape.build(&Wants::default(), &Place::default(), &mut reading.warnings.borrow_mut()).unwrap()
                else {
                    panic!("a solid is a mesh")
                };
                mesh
            })
        };
        let radius = "double radius.timeSamples = { 0: 1, 0.25: 2, 1: 3 }";
        assert!(moving("Sphere", radius, None).motion.is_empty());
        assert!(moving("Sphere", "double radius = 2", Some([0.0, 0.5])).motion.is_empty());
        for kind in ["Sphere", "Cylinder", "Cone"] {
            let mesh = moving(kind, radius, Some([0.0, 0.5]));
            let wide = |points: &[[f32; 3]]| points.iter().map(|p| p[0]).fold(0.0, f32::max);
            let found: Vec<_> = mesh.motion.iter().map(|m| (m.time, wide(&m.value) / wide(&mesh.points))).collect();
            let expected = [(0.0, 1.0), (0.25, 2.0), (0.5, 7.0 / 3.0)];
            assert_eq!(found.len(), 3);
            for (found, expected) in found.iter().zip(expected) {
                assert!(found.0 == expected.0 && (found.1 - expected.1).abs() < 1e-6, "{kind}: {found:?}");
            }
        }
    }

    #[test]
    fn a_negative_size_is_told() {
        let (mesh, told) = shape("Sphere", "double radius = -2");
        assert_eq!(mesh.points.iter().map(|p| p[2]).fold(0.0, f32::max), 2.0);
        assert!(told.iter().any(|told| told.contains("radius is negative")), "{told:?}");
    }

    /// Hydra's spheres have a number of faces that nothing but Hydra tells.
    #[test]
    fn what_other_shapes_can_t_show_is_told() {
        let (_, told) = shape("Sphere", &greys(100, "uniform"));
        assert!(told.iter().any(|told| told.contains("displayColor has 100 values")), "{told:?}");
    }
}
