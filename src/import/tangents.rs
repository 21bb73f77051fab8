//! Tangents where a file has none: MikkTSpace (M. S. Mikkelsen, "Simulation of Wrinkled Surfaces
//! Revisited", 2008), which glTF 2.0 asks for in section 3.7.2.1.

use bevy_mikktspace::{Geometry, TangentSpace};

use crate::desc::Attribute;
use crate::math::Vec3;

struct Corners<'a> {
    points: &'a [[f32; 3]],
    normals: Option<&'a Attribute<[f32; 3]>>,
    uvs: &'a Attribute<[f32; 2]>,
    triangles: &'a [[u32; 3]],
    tangents: Vec<[f32; 4]>,
}

impl Corners<'_> {
    fn point(&self, face: usize, corner: usize) -> Vec3 {
        self.points[self.triangles[face][corner] as usize].into()
    }

    fn value<T: Copy>(&self, values: &Attribute<T>, face: usize, corner: usize) -> T {
        match values {
            Attribute::Point(values) => values[self.triangles[face][corner] as usize],
            Attribute::Corner(values) => values[3 * face + corner],
        }
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, vert: usize) -> [f32; 3] {
        self.points[self.triangles[face][vert] as usize]
    }

    fn normal(&self, face: usize, vert: usize) -> [f32; 3] {
        match self.normals {
            Some(normals) => self.value(normals, face, vert),
            None => {
                let p = self.point(face, 0);
                (self.point(face, 1) - p).cross(self.point(face, 2) - p).normalize_or(Vec3::Z).into()
            }
        }
    }

    /// MikkTSpace's bitangent points to growing v; a normal map's green to the image's top, where
    /// glTF's v is 0: hence 1 − v.
    fn tex_coord(&self, face: usize, vert: usize) -> [f32; 2] {
        let [u, v] = self.value(self.uvs, face, vert);
        [u, 1.0 - v]
    }

    fn set_tangent(&mut self, tangent_space: Option<TangentSpace>, face: usize, vert: usize) {
        if let Some(space) = tangent_space {
            self.tangents[3 * face + vert] = space.tangent_encoded();
        }
    }
}

/// A tangent for each corner; the sign of the bitangent is `w`. `None` where the mesh is degenerate
/// beyond what the algorithm takes.
pub(super) fn generate(
    points: &[[f32; 3]],
    normals: Option<&Attribute<[f32; 3]>>,
    uvs: &Attribute<[f32; 2]>,
    triangles: &[[u32; 3]],
) -> Option<Attribute<[f32; 4]>> {
    let tangents = vec![[1.0, 0.0, 0.0, 1.0]; 3 * triangles.len()];
    let mut corners = Corners { points, normals, uvs, triangles, tangents };
    bevy_mikktspace::generate_tangents(&mut corners).ok()?;
    let finite = corners.tangents.iter().flatten().all(|v| v.is_finite());
    finite.then_some(Attribute::Corner(corners.tangents))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quad_seen_from_the_front_has_its_bitangent_up() {
        // The image's top left (uv 0 0) at the quad's top left: tangent +x, bitangent +y.
        let points = [[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
        let uvs = Attribute::Point(vec![[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]);
        let triangles = [[0, 1, 2], [0, 2, 3]];
        let Some(Attribute::Corner(tangents)) = generate(&points, None, &uvs, &triangles) else { panic!() };
        for t in tangents {
            let tangent = Vec3::new(t[0], t[1], t[2]);
            assert!(tangent.distance(Vec3::X) < 1e-6, "{t:?}");
            assert!((Vec3::Z.cross(tangent) * t[3]).distance(Vec3::Y) < 1e-6, "{t:?}");
        }
    }
}
