//! Any shape: the one place that knows which kinds there are.

use std::sync::Arc;

use super::{Mesh, Rounds};
use crate::math::{Affine3A, DAffine3, DVec3, Mat3A, Vec2, Vec3, Vec3A, center_of, place_point, traced};

/// A shape in its own space, shared by its instances. A point on it is a primitive, which is a triangle,
/// a segment or a ball, with the two coordinates on that which a hit gives.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Triangles.
    Mesh(Arc<Mesh>),
    /// Strands and balls.
    Rounds(Arc<Rounds>),
}

/// Where a shape stands.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// From the shape's space to render space.
    pub to_render: Affine3A,
    /// Inverse transpose of its linear part, up to a factor: carries normals.
    pub normals: Mat3A,
    /// True where the transform mirrors, which turns the winding around.
    pub mirrored: bool,
}

impl Placement {
    /// By `to_render`; `None` where that can't be undone or leaves the range of `f32`.
    pub fn new(to_render: &DAffine3) -> Option<Self> {
        // Only the direction of normals matters: scaled so that tiny and huge objects stay in range.
        let normals = to_render.matrix3.inverse().transpose();
        let largest = normals.to_cols_array().into_iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let mirrored = to_render.matrix3.determinant() < 0.0;
        let to_render = traced(to_render);
        if !(largest.is_finite() && largest > 0.0 && to_render.is_finite()) {
            return None;
        }
        let normals = normals * (1.0 / largest);
        let [x, y, z] = [normals.x_axis, normals.y_axis, normals.z_axis].map(|axis| axis.as_vec3a());
        Some(Self { to_render, normals: Mat3A::from_cols(x, y, z), mirrored })
    }
}

/// Geometry at a point of a placed shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceGeometry {
    /// The point.
    pub p: Vec3,
    /// Half-width of the box in which rounding has left `p`.
    pub p_err: Vec3,
    /// Unit geometric normal, outward; `None` on a triangle without area.
    pub ng: Option<Vec3>,
    /// Shading normal, of any length; `None` where it is the geometric one.
    pub ns: Option<Vec3>,
    /// What [`Shape::uv_size`] is to be held against: twice the area of a triangle, the square of a
    /// segment's length.
    pub size: f32,
}

impl Shape {
    /// What was taken off every point to bring the middle of the box to the origin.
    pub fn center(&self) -> DVec3 {
        match self {
            Self::Mesh(mesh) => mesh.center,
            Self::Rounds(rounds) => rounds.center,
        }
    }

    /// True where there is nothing to hit.
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Mesh(mesh) => mesh.triangles.is_empty(),
            Self::Rounds(rounds) => rounds.is_empty(),
        }
    }

    /// The geometry at a point at `time`, which is 0 to 1 within the shutter.
    pub fn geometry(&self, primitive: u32, at: [f32; 2], placement: &Placement, time: f32) -> SurfaceGeometry {
        let Placement { to_render: transform, normals, mirrored } = placement;
        let carried = |n: Vec3| Vec3::from(*normals * Vec3A::from(n));
        match self {
            Self::Mesh(mesh) => {
                let local = mesh.point(primitive, at, time);
                let (p, p_err) = place_point(transform, local.p, local.p_err);
                // In f64, where the squares of neither huge nor tiny triangles leave the range.
                let [e1, e2] = local.edges.map(|e| transform.transform_vector3(e).as_dvec3());
                let cross = e1.cross(e2);
                let double_area = cross.length();
                let wound = if *mirrored { -cross } else { cross };
                SurfaceGeometry {
                    p,
                    p_err,
                    ng: (double_area > 0.0).then(|| (wound / double_area).as_vec3()),
                    ns: mesh.normal(primitive, at, time).map(carried),
                    size: double_area as f32,
                }
            }
            Self::Rounds(rounds) => {
                let local = rounds.point(primitive, at, time);
                let (p, p_err) = place_point(transform, local.p, local.p_err);
                SurfaceGeometry {
                    p,
                    p_err,
                    ng: carried(local.ng).as_dvec3().try_normalize().map(|n| n.as_vec3()),
                    ns: Some(carried(local.ns)),
                    size: transform.transform_vector3(local.axis).length_squared(),
                }
            }
        }
    }

    /// The points between which the point at `at` of `primitive` lies, and the share that each has in it: of a strand
    /// it is one on the axis.
    pub fn anchors(&self, primitive: u32, [u, v]: [f32; 2]) -> [(u32, f32); 3] {
        match self {
            Self::Mesh(mesh) => {
                let [a, b, c] = mesh.triangles[primitive as usize];
                [(a, 1.0 - u - v), (b, u), (c, v)]
            }
            Self::Rounds(rounds) => rounds.anchors(primitive, u),
        }
    }

    /// Point `i` as modelled, of a strand or ball its centre.
    pub fn anchor(&self, i: u32) -> Vec3 {
        match self {
            Self::Mesh(mesh) => mesh.points[i as usize],
            Self::Rounds(rounds) => center_of(rounds.balls[i as usize]).as_vec3(),
        }
    }

    /// Corners and shading normals of a triangle at `time` in the shape's space; `None` where it has none.
    pub fn smooth_triangle(&self, primitive: u32, time: f32) -> Option<([Vec3; 3], [Vec3; 3])> {
        match self {
            Self::Mesh(mesh) => Some((mesh.corners_at(primitive, time), mesh.corner_normals(primitive, time)?)),
            Self::Rounds(_) => None,
        }
    }

    /// Material slot of `primitive`.
    pub fn slot(&self, primitive: u32) -> usize {
        match self {
            Self::Mesh(mesh) => mesh.slot(primitive),
            Self::Rounds(rounds) => rounds.slot(primitive),
        }
    }

    /// UV of set `set`; `None` where the shape has no such set.
    pub fn uv(&self, set: u32, primitive: u32, at: [f32; 2]) -> Option<Vec2> {
        match self {
            Self::Mesh(mesh) => mesh.uv(set, primitive, at),
            Self::Rounds(rounds) => rounds.uv(set, primitive, at),
        }
    }

    /// Size of `primitive` in UV set `set`; see [`SurfaceGeometry::size`].
    pub fn uv_size(&self, set: u32, primitive: u32) -> f32 {
        match self {
            Self::Mesh(mesh) => mesh.uv_area(set, primitive),
            Self::Rounds(rounds) => rounds.uv_size(set, primitive),
        }
    }

    /// Tangent in the shape's space at `time`, not unit, and the bitangent's sign: along u, or along a strand.
    pub fn tangent(&self, primitive: u32, at: [f32; 2], time: f32) -> Option<(Vec3, f32)> {
        match self {
            Self::Mesh(mesh) => mesh.tangent(primitive, at, time),
            Self::Rounds(rounds) => rounds.tangent(primitive, at, time).map(|tangent| (tangent, 1.0)),
        }
    }

    /// Vertex colour with alpha.
    pub fn color(&self, primitive: u32, at: [f32; 2]) -> Option<[f32; 4]> {
        match self {
            Self::Mesh(mesh) => mesh.color(primitive, at),
            Self::Rounds(rounds) => rounds.color(primitive, at),
        }
    }

    /// True where it has vertex colours.
    pub fn has_colors(&self) -> bool {
        match self {
            Self::Mesh(mesh) => mesh.colors.is_some(),
            Self::Rounds(rounds) => rounds.colors.is_some(),
        }
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Mesh(mesh) => mesh.bytes(),
            Self::Rounds(rounds) => rounds.bytes(),
        }
    }
}
