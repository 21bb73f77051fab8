//! What a lamp emits by a graph: the lamp as graphs see it, from where its light goes.

use std::sync::Arc;

use crate::camera::Camera;
use crate::desc::graph::{Function, Leaf, PathInfo, Quantity, Space, Value};
use crate::math::{DAffine3, DVec2, DVec3, Rgb};
use crate::texture::graph::{Beside, Hit, Program, of_no_object};
use crate::texture::{Texture, TextureRef};

/// What a lamp's parametric coordinates are spread over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Parameters {
    /// The sphere of directions: longitude and latitude.
    Sphere,
    /// The square around a cone about −z; half the cotangent of its half angle.
    Cone(f64),
    /// The disk of a sun about +z; half the inverse of the sine of a quarter of its diameter, 0 for a sun without size.
    Disk(f64),
    /// A rectangle in the xy plane of this size.
    Area(DVec2),
}

/// The graph of a lamp, and what it goes by.
#[derive(Debug)]
pub struct LampShading {
    /// It gives the factor alone.
    pub program: Program,
    /// All textures.
    pub textures: Arc<Vec<Texture>>,
    /// The camera, for coordinates of the picture.
    pub camera: Camera,
    /// World position of render space's origin.
    pub origin: DVec3,
    /// The lamp to world.
    pub to_world: DAffine3,
    /// Its parametric coordinates.
    pub parameters: Parameters,
}

impl LampShading {
    /// The factor of what leaves the lamp along the unit direction `w` (world and render space) and arrives after `dist`
    /// metres; finite and not negative. `place` is where on the lamp, in the coordinates of its xy plane, metres.
    pub fn factor(&self, w: DVec3, dist: f64, place: DVec2) -> Rgb {
        let mut values = [[0.0; 4]];
        self.program.run(&From { lamp: self, w, dist, place }, &self.textures, &mut values);
        let [r, g, b] = std::array::from_fn(|i| values[0][i].clamp(0.0, f64::from(f32::MAX)) as f32);
        Rgb::new(r, g, b)
    }
}

/// A point of a lamp, seen from where its light goes.
struct From<'a> {
    lamp: &'a LampShading,
    w: DVec3,
    dist: f64,
    place: DVec2,
}

impl From<'_> {
    /// World space.
    fn normal(&self) -> DVec3 {
        match self.lamp.parameters {
            Parameters::Area(_) => -self.lamp.to_world.matrix3.z_axis.normalize_or(DVec3::Z),
            _ => self.w,
        }
    }

    /// World space; of a sun the direction, as in Cycles.
    fn position(&self) -> DVec3 {
        let to_world = &self.lamp.to_world;
        match self.lamp.parameters {
            Parameters::Disk(_) => self.w,
            Parameters::Area(_) => {
                let [x, y] = [to_world.matrix3.x_axis, to_world.matrix3.y_axis].map(|axis| axis.normalize_or_zero());
                to_world.translation + x * self.place.x + y * self.place.y
            }
            _ => to_world.translation,
        }
    }

    fn parametric(&self) -> [f64; 2] {
        let local = || self.lamp.to_world.matrix3.inverse() * self.w;
        match self.lamp.parameters {
            Parameters::Sphere => {
                let [u, v, ..] = Function::SphereMap.eval(&[vector(local())]);
                [u, v]
            }
            Parameters::Cone(half_cotangent) => {
                let local = local();
                let factor = half_cotangent / -local.z;
                [0.5 + local.x * factor, 0.5 + local.y * factor]
            }
            Parameters::Disk(factor) => {
                let local = local();
                // From the direction to the sun to that in which its middle is.
                let axis = self.lamp.to_world.matrix3.z_axis.normalize_or(DVec3::Z);
                let factor = factor / (self.w + axis).length();
                [0.5 - local.x * factor, 0.5 - local.y * factor]
            }
            Parameters::Area(size) => (self.place / size + 0.5).to_array(),
        }
    }

    fn as_the_camera_sees(&self, v: DVec3) -> DVec3 {
        let view = self.lamp.camera.view();
        DVec3::new(v.dot(view.right.as_dvec3()), v.dot(view.up.as_dvec3()), v.dot(view.forward.as_dvec3()))
    }
}

fn vector(v: DVec3) -> Value {
    [v.x, v.y, v.z, 0.0]
}

impl Hit for From<'_> {
    fn leaf(&self, leaf: &Leaf, _: Beside) -> Value {
        let lamp = self.lamp;
        match leaf {
            Leaf::Position => vector(self.position()),
            Leaf::ObjectPosition => vector(lamp.to_world.inverse().transform_point3(self.position())),
            Leaf::Normal | Leaf::TrueNormal => vector(self.normal()),
            Leaf::ObjectNormal | Leaf::SmoothNormal => {
                vector((lamp.to_world.matrix3.transpose() * self.normal()).normalize_or_zero())
            }
            Leaf::Incoming => vector(self.w),
            Leaf::Parametric => {
                let [x, y] = self.parametric();
                [x, y, 0.0, 0.0]
            }
            Leaf::CameraPosition => {
                let eye = lamp.camera.view().origin.as_dvec3() + lamp.origin;
                vector(self.as_the_camera_sees(self.position() - eye))
            }
            Leaf::Window => {
                let [x, y] = lamp.camera.window((self.position() - lamp.origin).as_vec3());
                [f64::from(x), f64::from(y), 0.0, 0.0]
            }
            Leaf::ObjectLocation => vector(lamp.to_world.translation),
            Leaf::Path(PathInfo::Length) => [self.dist; 4],
            leaf => of_no_object(leaf),
        }
    }

    fn attribute(&self, _: u16, _: Beside) -> Option<Value> {
        None
    }

    fn texture(&self, texture: &TextureRef, _: Beside) -> [f32; 4] {
        texture.lookup(&self.lamp.textures, [0.0; 2], 0.0)
    }

    fn transform(&self, quantity: Quantity, from: Space, to: Space, [x, y, z, w]: Value) -> Value {
        let LampShading { camera, origin, to_world, .. } = self.lamp;
        let view = camera.view();
        let eye = view.origin.as_dvec3() + *origin;
        let point = quantity == Quantity::Point;
        let v = DVec3::new(x, y, z);
        let world = match from {
            Space::World => v,
            Space::Object if point => to_world.transform_point3(v),
            Space::Object if quantity == Quantity::Normal => to_world.matrix3.inverse().transpose() * v,
            Space::Object => to_world.matrix3 * v,
            Space::Camera => {
                let [right, up, forward] = [view.right, view.up, view.forward].map(|axis| axis.as_dvec3());
                right * v.x + up * v.y + forward * v.z + if point { eye } else { DVec3::ZERO }
            }
        };
        let there = match to {
            Space::World => world,
            Space::Object if point => to_world.inverse().transform_point3(world),
            Space::Object if quantity == Quantity::Normal => to_world.matrix3.transpose() * world,
            Space::Object => to_world.matrix3.inverse() * world,
            Space::Camera => self.as_the_camera_sees(world - if point { eye } else { DVec3::ZERO }),
        };
        let unit = if quantity == Quantity::Normal { there.normalize_or_zero() } else { there };
        [unit.x, unit.y, unit.z, w]
    }

    fn footprint(&self) -> [Value; 2] {
        [[0.0; 4]; 2]
    }
}
