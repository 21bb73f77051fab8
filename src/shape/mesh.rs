//! A triangle mesh in its own space, moved so that the middle of its box is the origin.

use super::MeshMotion;
use crate::math::{DVec3, Vec2, Vec3, gamma};

/// A mesh's data at one corner of a triangle: an index into each attribute, by point or corner.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute<T> {
    /// One value for each point.
    Point(Vec<T>),
    /// One value for each corner of each triangle.
    Corner(Vec<T>),
}

impl<T: Copy> Attribute<T> {
    /// The values at the three corners of `triangle`, whose points are `indices`.
    pub fn at(&self, triangle: u32, indices: [u32; 3]) -> [T; 3] {
        match self {
            Self::Point(values) => indices.map(|i| values[i as usize]),
            Self::Corner(values) => [0, 1, 2].map(|k| values[3 * triangle as usize + k]),
        }
    }
}

/// A mesh, in object space less `center`.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// What was taken off every point.
    pub center: DVec3,
    /// Points.
    pub points: Vec<Vec3>,
    /// Point indices.
    pub triangles: Vec<[u32; 3]>,
    /// Unit shading normals; `None` for facets.
    pub normals: Option<Attribute<Vec3>>,
    /// UV sets.
    pub uvs: Vec<Attribute<Vec2>>,
    /// Tangents with the bitangent's sign.
    pub tangents: Option<Attribute<[f32; 4]>>,
    /// Linear colours with straight alpha.
    pub colors: Option<Attribute<[f32; 4]>>,
    /// Material slot of each triangle; `None` for 0.
    pub material_slots: Option<Vec<u16>>,
    /// Points and normals at other times; `None` for a mesh that keeps its shape.
    pub motion: Option<Box<MeshMotion>>,
}

/// A point on a mesh, still in the mesh's space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The point.
    pub p: Vec3,
    /// Half-width of the box in which rounding has left `p`.
    pub p_err: Vec3,
    /// Edges of the triangle, `p1 − p0` and `p2 − p0`.
    pub edges: [Vec3; 2],
}

impl Mesh {
    /// Points of `triangle` as modelled: those of a mesh that keeps its shape.
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|i| self.points[i as usize])
    }

    /// Points of `triangle` at `time`.
    pub fn corners_at(&self, triangle: u32, time: f32) -> [Vec3; 3] {
        match &self.motion {
            None => self.corners(triangle),
            Some(motion) => motion.corners(self.triangles[triangle as usize], time),
        }
    }

    /// Material slot of `triangle`.
    pub fn slot(&self, triangle: u32) -> usize {
        self.material_slots.as_ref().map_or(0, |slots| usize::from(slots[triangle as usize]))
    }

    /// The point at barycentrics `(u, v)` of `triangle`, by interpolation, which is far more exact
    /// than `o + t d` (Pharr et al., *PBR* 4th edition, 6.8.4).
    pub fn point(&self, triangle: u32, [u, v]: [f32; 2], time: f32) -> SurfacePoint {
        let [a, b, c] = self.corners_at(triangle, time);
        let w = 1.0 - u - v;
        let p = a * w + b * u + c * v;
        let magnitude = (a * w).abs() + (b * u).abs() + (c * v).abs();
        SurfacePoint { p, p_err: magnitude * gamma(7), edges: [b - a, c - a] }
    }

    /// Shading normal, not yet unit; `None` for a faceted mesh.
    pub fn normal(&self, triangle: u32, uv: [f32; 2], time: f32) -> Option<Vec3> {
        Some(blend(self.corner_normals(triangle, time)?, uv))
    }

    /// Shading normals of the corners of `triangle`; `None` for a faceted mesh.
    pub fn corner_normals(&self, triangle: u32, time: f32) -> Option<[Vec3; 3]> {
        let (normals, indices) = (self.normals.as_ref()?, self.triangles[triangle as usize]);
        Some(match &self.motion {
            None => normals.at(triangle, indices),
            Some(motion) => motion.normals(triangle, indices, time)?,
        })
    }

    /// UV of set `set` at the corners of `triangle`; `None` where the mesh has no such set.
    pub fn corner_uvs(&self, set: u32, triangle: u32) -> Option<[Vec2; 3]> {
        Some(self.uvs.get(set as usize)?.at(triangle, self.triangles[triangle as usize]))
    }

    /// Vertex colours of the corners of `triangle`.
    pub fn corner_colors(&self, triangle: u32) -> Option<[[f32; 4]; 3]> {
        Some(self.colors.as_ref()?.at(triangle, self.triangles[triangle as usize]))
    }

    /// UV of set `set` at a point; `None` where the mesh has no such set.
    pub fn uv(&self, set: u32, triangle: u32, uv: [f32; 2]) -> Option<Vec2> {
        let values = self.uvs.get(set as usize)?.at(triangle, self.triangles[triangle as usize]);
        let w = 1.0 - uv[0] - uv[1];
        Some(values[0] * w + values[1] * uv[0] + values[2] * uv[1])
    }

    /// Twice the area of `triangle` in UV set `set`.
    pub fn uv_area(&self, set: u32, triangle: u32) -> f32 {
        self.uvs.get(set as usize).map_or(0.0, |values| {
            let [a, b, c] = values.at(triangle, self.triangles[triangle as usize]);
            (b - a).perp_dot(c - a).abs()
        })
    }

    /// Tangent, not unit, and the bitangent's sign.
    pub fn tangent(&self, triangle: u32, uv: [f32; 2], time: f32) -> Option<(Vec3, f32)> {
        let values = self.tangents.as_ref()?.at(triangle, self.triangles[triangle as usize]);
        let tangent = blend(values.map(|t| Vec3::new(t[0], t[1], t[2])), uv);
        let tangent = match &self.motion {
            None => tangent,
            Some(_) => carried(tangent, self.corners(triangle), self.corners_at(triangle, time)),
        };
        Some((tangent, values[0][3]))
    }

    /// Vertex colour with alpha.
    pub fn color(&self, triangle: u32, [u, v]: [f32; 2]) -> Option<[f32; 4]> {
        let [a, b, c] = self.colors.as_ref()?.at(triangle, self.triangles[triangle as usize]);
        Some(std::array::from_fn(|k| a[k] * (1.0 - u - v) + b[k] * u + c[k] * v))
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        fn size<T>(attribute: &Attribute<T>) -> usize {
            match attribute {
                Attribute::Point(values) | Attribute::Corner(values) => std::mem::size_of_val(values.as_slice()),
            }
        }
        std::mem::size_of_val(self.points.as_slice())
            + std::mem::size_of_val(self.triangles.as_slice())
            + self.normals.as_ref().map_or(0, size)
            + self.uvs.iter().map(size).sum::<usize>()
            + self.tangents.as_ref().map_or(0, size)
            + self.colors.as_ref().map_or(0, size)
            + self.motion.as_ref().map_or(0, |motion| motion.bytes())
    }
}

/// `along`, a direction in the plane of the triangle `from`, as the deformation to the triangle `to` carries it.
fn carried(along: Vec3, from: [Vec3; 3], to: [Vec3; 3]) -> Vec3 {
    let [e1, e2] = [from[1] - from[0], from[2] - from[0]].map(|e| e.as_dvec3());
    let (along, n) = (along.as_dvec3(), e1.cross(e2));
    let area = n.length_squared();
    if area == 0.0 {
        return along.as_vec3();
    }
    // along = a e1 + b e2, but for what lies along the normal.
    let (a, b) = (along.cross(e2).dot(n) / area, e1.cross(along).dot(n) / area);
    ((to[1] - to[0]).as_dvec3() * a + (to[2] - to[0]).as_dvec3() * b).as_vec3()
}

fn blend([a, b, c]: [Vec3; 3], [u, v]: [f32; 2]) -> Vec3 {
    a * (1.0 - u - v) + b * u + c * v
}
