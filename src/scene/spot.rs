//! A hit as graphs see it: world and object space in `f64`, worked out as far as a program asks.

use smallvec::SmallVec;

use super::asked::{OfMesh, OfObject};
use super::interaction::Interaction;
use super::{Asked, Instance};
use crate::bsdf;
use crate::camera::Camera;
use crate::desc::graph::{Layer, Leaf, Quantity, Space, Value};
use crate::math::{DMat3, DVec3};
use crate::shape::{Attribute, Mesh, Placement, Shape};
use crate::texture::graph::{Beside, HERE, Hit, Program};
use crate::texture::{Texture, TextureRef};

/// What a program gives.
pub type Values = SmallVec<[Value; 8]>;

/// What surrounds hits on one object.
#[derive(Clone, Copy)]
pub struct Around<'a> {
    /// The shape.
    pub shape: &'a Shape,
    /// Where it is placed.
    pub instance: &'a Instance,
    /// Index of the instance.
    pub index: u32,
    /// What graphs ask of meshes and objects.
    pub asked: &'a Asked,
    /// All textures.
    pub textures: &'a [Texture],
    /// The camera.
    pub camera: &'a Camera,
    /// World position of render space's origin.
    pub origin: DVec3,
    /// True where the colours of the instance stand in for those that its shape lacks.
    pub tinted: bool,
}

/// A hit and what surrounds it.
pub struct Spot<'a> {
    /// The object.
    pub around: Around<'a>,
    /// The hit.
    pub it: &'a Interaction,
}

/// A point beside the hit.
struct Place {
    /// Barycentrics of the second and third corner.
    uv: [f64; 2],
    /// How far it is from the hit, render space.
    away: DVec3,
}

impl Spot<'_> {
    /// The values of `program` here.
    pub fn run(&self, program: &Program) -> Values {
        let mut values = Values::from_elem([0.0; 4], program.outputs());
        program.run(self, self.around.textures, &mut values);
        values
    }

    /// The mesh and the triangle; strands and balls have no corners to blend between.
    fn mesh(&self) -> Option<(&Mesh, u32)> {
        match self.around.shape {
            Shape::Mesh(mesh) => Some((mesh, self.it.primitive)),
            Shape::Rounds(_) => None,
        }
    }

    fn of_mesh(&self) -> Option<&OfMesh> {
        self.around.asked.shapes.get(self.around.instance.shape as usize)
    }

    fn of_object(&self) -> Option<&OfObject> {
        self.around.asked.objects.get(self.around.index as usize)
    }

    /// 1 towards the side of whoever looks.
    fn side(&self) -> f64 {
        if self.it.front { 1.0 } else { -1.0 }
    }

    fn placement(&self) -> Placement {
        *self.around.instance.placement_at(self.it.time, &mut None)
    }

    /// Columns of mesh space to render space.
    fn to_render(&self) -> DMat3 {
        let m = self.placement().to_render.matrix3;
        let column = |v: crate::math::Vec3A| crate::math::Vec3::from(v).as_dvec3();
        DMat3::from_cols(column(m.x_axis), column(m.y_axis), column(m.z_axis))
    }

    /// Where mesh space's origin is in world space, and which point of object space it is.
    fn origins(&self) -> [DVec3; 2] {
        let translation = crate::math::Vec3::from(self.placement().to_render.translation).as_dvec3();
        [translation + self.around.origin, self.around.shape.center()]
    }

    /// Edges of the triangle in render space.
    fn edges(&self) -> Option<[DVec3; 2]> {
        let (mesh, triangle) = self.mesh()?;
        let [a, b, c] = mesh.corners_at(triangle, self.it.time).map(|p| p.as_dvec3());
        let m = self.to_render();
        Some([m * (b - a), m * (c - a)])
    }

    /// Two unit directions of the tangent plane that are square to each other.
    fn directions(&self) -> [DVec3; 2] {
        let ng = self.it.ng.as_dvec3();
        let along = self.edges().map_or_else(|| ng.any_orthonormal_vector(), |[e1, _]| e1.normalize_or_zero());
        [along, ng.cross(along).normalize_or_zero()]
    }

    fn beside(&self, at: Beside) -> Place {
        let [u, v] = self.it.at.map(f64::from);
        if at == HERE {
            return Place { uv: [u, v], away: DVec3::ZERO };
        }
        let [along, across] = self.directions();
        let away = (along * f64::from(at[0]) + across * f64::from(at[1])) * f64::from(self.it.footprint);
        let Some([e1, e2]) = self.edges() else { return Place { uv: [u, v], away } };
        // away = du e1 + dv e2; e1 is along `along`.
        let (height, length) = (e2.dot(across), e1.dot(along));
        if height == 0.0 || length == 0.0 {
            return Place { uv: [u, v], away: DVec3::ZERO };
        }
        let dv = away.dot(across) / height;
        let du = (away.dot(along) - dv * e2.dot(along)) / length;
        Place { uv: [u + du, v + dv], away }
    }

    fn blend<const N: usize>(&self, corners: [[f32; N]; 3], [u, v]: [f64; 2]) -> [f64; N] {
        let [a, b, c] = corners;
        std::array::from_fn(|i| f64::from(a[i]) * (1.0 - u - v) + f64::from(b[i]) * u + f64::from(c[i]) * v)
    }

    fn object_position(&self, at: Beside) -> DVec3 {
        match self.mesh() {
            Some((mesh, triangle)) => {
                let corners = mesh.corners_at(triangle, self.it.time).map(|p| p.to_array());
                DVec3::from(self.blend(corners, self.beside(at).uv)) + mesh.center
            }
            None => self.world_to(Quantity::Point, Space::Object, self.world_position(at)),
        }
    }

    /// The same on the shape as modelled, whatever deforms it while the shutter is open.
    fn modelled_position(&self, at: Beside) -> DVec3 {
        match self.mesh() {
            Some((mesh, triangle)) if mesh.motion.is_some() => {
                let corners = mesh.corners(triangle).map(|p| p.to_array());
                DVec3::from(self.blend(corners, self.beside(at).uv)) + mesh.center
            }
            _ => self.object_position(at),
        }
    }

    fn world_position(&self, at: Beside) -> DVec3 {
        self.it.p.as_dvec3() + self.around.origin + self.beside(at).away
    }

    /// Interpolated normal in object space as wound, on the side of the geometric one; not unit.
    fn smooth_normal(&self, at: Beside) -> DVec3 {
        let Some((mesh, triangle)) = self.mesh() else {
            return (self.to_render().transpose() * self.it.ns.as_dvec3()).normalize_or_zero();
        };
        let [a, b, c] = mesh.corners_at(triangle, self.it.time).map(|p| p.as_dvec3());
        let flat = (b - a).cross(c - a);
        let Some(corners) = mesh.corner_normals(triangle, self.it.time) else { return flat.normalize_or_zero() };
        let n = DVec3::from(self.blend(corners.map(|n| n.to_array()), self.beside(at).uv));
        if n == DVec3::ZERO {
            return flat.normalize_or_zero();
        }
        if n.dot(flat) < 0.0 { -n } else { n }
    }

    fn uv(&self, set: u32, at: Beside) -> Option<[f64; 2]> {
        match self.mesh() {
            Some((mesh, triangle)) => {
                let corners = mesh.corner_uvs(set, triangle)?;
                Some(self.blend(corners.map(|uv| uv.to_array()), self.beside(at).uv))
            }
            None => {
                let uv = self.around.shape.uv(set, self.it.primitive, self.it.at)?;
                Some(uv.to_array().map(f64::from))
            }
        }
    }

    fn vertex_color(&self, at: Beside) -> Option<Value> {
        match self.mesh() {
            Some((mesh, triangle)) => {
                mesh.corner_colors(triangle).map(|corners| self.blend(corners, self.beside(at).uv))
            }
            None => self.around.shape.color(self.it.primitive, self.it.at).map(|color| color.map(f64::from)),
        }
        .or_else(|| self.around.instance.color.filter(|_| self.around.tinted).map(|color| color.map(f64::from)))
    }

    fn generated(&self, at: Beside) -> DVec3 {
        let Some(mesh) = self.of_mesh() else { return DVec3::ZERO };
        let (slot, [least, inverse]) = &mesh.generated;
        if let Some([x, y, z, _]) = slot.and_then(|slot| self.of_mesh_attribute(slot, at)) {
            return DVec3::new(x, y, z);
        }
        let share = (self.modelled_position(at) - *least) * *inverse;
        // A flat box has its middle along that axis.
        DVec3::select(inverse.cmpeq(DVec3::ZERO), DVec3::splat(0.5), share)
    }

    fn of_mesh_attribute(&self, slot: u16, at: Beside) -> Option<Value> {
        let attribute = self.of_mesh()?.attributes.get(usize::from(slot))?.as_ref()?;
        let (mesh, triangle) = match self.around.shape {
            Shape::Rounds(rounds) => {
                let Attribute::Point(values) = attribute else { return None };
                return Some(rounds.along(values, self.it.primitive, self.it.at[0]).map(f64::from));
            }
            Shape::Mesh(_) => self.mesh()?,
        };
        let corners = attribute.at(triangle, mesh.triangles[triangle as usize]);
        Some(self.blend(corners, self.beside(at).uv))
    }

    fn radial_tangent(&self) -> DVec3 {
        let g = self.generated(HERE) - DVec3::splat(0.5);
        let around = self.normal_to_world(DVec3::new(-g.y, g.x, 0.0));
        let n = self.it.ns.as_dvec3() * self.side();
        n.cross(around.cross(n).normalize_or_zero())
    }

    fn normal_to_world(&self, n: DVec3) -> DVec3 {
        let m = self.placement().normals;
        (m * crate::math::Vec3A::from(n.as_vec3())).as_dvec3().normalize_or_zero()
    }

    fn world_from(&self, quantity: Quantity, from: Space, v: DVec3) -> DVec3 {
        match (from, quantity) {
            (Space::World, _) => v,
            (Space::Object, Quantity::Normal) => self.normal_to_world(v),
            (Space::Object, Quantity::Vector) => self.to_render() * v,
            (Space::Object, Quantity::Point) => {
                let [world, object] = self.origins();
                self.to_render() * (v - object) + world
            }
            (Space::Camera, _) => {
                let view = self.around.camera.view();
                let [right, up, ahead] = [view.right, view.up, view.forward].map(|v| v.as_dvec3());
                let turned = right * v.x + up * v.y + ahead * v.z;
                if quantity == Quantity::Point { turned + view.origin.as_dvec3() + self.around.origin } else { turned }
            }
        }
    }

    fn world_to(&self, quantity: Quantity, to: Space, v: DVec3) -> DVec3 {
        match (to, quantity) {
            (Space::World, _) => v,
            (Space::Object, Quantity::Normal) => (self.to_render().transpose() * v).normalize_or_zero(),
            (Space::Object, Quantity::Vector) => self.to_render().inverse() * v,
            (Space::Object, Quantity::Point) => {
                let [world, object] = self.origins();
                self.to_render().inverse() * (v - world) + object
            }
            (Space::Camera, _) => {
                let view = self.around.camera.view();
                let moved = match quantity {
                    Quantity::Point => v - self.around.origin - view.origin.as_dvec3(),
                    _ => v,
                };
                DVec3::from([view.right, view.up, view.forward].map(|axis| axis.as_dvec3().dot(moved)))
            }
        }
    }
}

fn vector(v: DVec3) -> Value {
    [v.x, v.y, v.z, 0.0]
}

impl Hit for Spot<'_> {
    fn leaf(&self, leaf: &Leaf, at: Beside) -> Value {
        let it = self.it;
        match leaf {
            Leaf::Position => vector(self.world_position(at)),
            Leaf::Normal => vector(it.ns.as_dvec3() * self.side()),
            Leaf::TrueNormal => vector(it.ng.as_dvec3() * self.side()),
            Leaf::Incoming => vector(it.wo.as_dvec3()),
            Leaf::RadialTangent => vector(self.radial_tangent()),
            Leaf::Parametric => {
                let [u, v] = self.beside(at).uv;
                [1.0 - u - v, u, 0.0, 0.0]
            }
            Leaf::Backfacing => [f64::from(u8::from(!it.front)); 4],
            Leaf::ObjectPosition => vector(self.object_position(at)),
            Leaf::ObjectNormal => vector(self.smooth_normal(at).normalize_or_zero() * self.side()),
            Leaf::Generated => vector(self.generated(at)),
            Leaf::CameraPosition => vector(self.world_to(Quantity::Point, Space::Camera, self.world_position(at))),
            Leaf::Window => {
                let [x, y] = self.around.camera.window((it.p.as_dvec3() + self.beside(at).away).as_vec3());
                [f64::from(x), f64::from(y), 0.0, 0.0]
            }
            Leaf::Uv(set) => {
                let [u, v] = self.uv(*set, at).unwrap_or_default();
                [u, v, 0.0, 1.0]
            }
            Leaf::Attribute { fallback, .. } => *fallback,
            Leaf::VertexColor => self.vertex_color(at).unwrap_or([1.0; 4]),
            Leaf::SmoothNormal => vector(self.smooth_normal(at)),
            Leaf::Tangent => match self.around.shape.tangent(it.primitive, it.at, it.time) {
                Some((tangent, sign)) => {
                    let t = tangent.as_dvec3();
                    [t.x, t.y, t.z, f64::from(sign)]
                }
                None => [0.0; 4],
            },
            Leaf::ObjectLocation if self.around.instance.motion.is_some() => {
                vector(self.world_from(Quantity::Point, Space::Object, DVec3::ZERO))
            }
            Leaf::ObjectLocation => self.of_object().map_or([0.0; 4], |object| vector(object.location)),
            Leaf::ObjectColor => self.of_object().map_or([1.0; 4], |object| object.color),
            Leaf::ObjectIndex => [self.of_object().map_or(0.0, |object| object.index); 4],
            Leaf::ObjectRandom => [self.of_object().map_or(0.0, |object| object.random); 4],
            // Known when the graph was compiled.
            Leaf::MaterialIndex => [0.0; 4],
            Leaf::Path(info) => [it.path.get(*info); 4],
        }
    }

    fn attribute(&self, slot: u16, at: Beside) -> Option<Value> {
        let of_object = || *self.of_object()?.attributes.get(usize::from(slot))?;
        self.of_mesh_attribute(slot, at).or_else(of_object)
    }

    fn texture(&self, texture: &TextureRef, at: Beside) -> [f32; 4] {
        let (shape, it) = (self.around.shape, self.it);
        let width = it.uv_footprint(shape, texture.uv_set);
        let uv = match at {
            HERE => shape.uv(texture.uv_set, it.primitive, it.at).map(|uv| uv.to_array()),
            _ => self.uv(texture.uv_set, at).map(|uv| uv.map(|x| x as f32)),
        };
        // Without the UV set its coordinates are those of `Leaf::Uv`.
        texture.lookup(self.around.textures, uv.unwrap_or_default(), width)
    }

    fn transform(&self, quantity: Quantity, from: Space, to: Space, [x, y, z, w]: Value) -> Value {
        let world = self.world_from(quantity, from, DVec3::new(x, y, z));
        let there = self.world_to(quantity, to, world);
        [there.x, there.y, there.z, w]
    }

    fn albedo(&self, layer: Layer, roughness: f64, ior: f64, normal: Value) -> f64 {
        let n = DVec3::new(normal[0], normal[1], normal[2]);
        let cos = self.it.wo.as_dvec3().dot(n) as f32;
        f64::from(match layer {
            Layer::Sheen => bsdf::sheen_albedo(roughness as f32, cos),
            Layer::Coat => bsdf::coat_albedo(roughness as f32, ior as f32, cos),
        })
    }

    fn footprint(&self) -> [Value; 2] {
        self.directions().map(|d| vector(d * f64::from(self.it.footprint)))
    }
}
