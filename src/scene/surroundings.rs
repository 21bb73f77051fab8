//! What surrounds everything, by a graph: the unit sphere as graphs see it.

use std::sync::Arc;

use crate::camera::Camera;
use crate::desc::graph::{Leaf, Quantity, Space, Value};
use crate::math::{DVec3, Rgb, Vec3};
use crate::texture::graph::{Beside, Hit, Program, of_no_object};
use crate::texture::{Texture, TextureRef};

/// A graph of a dome or of the background, and what it goes by.
pub struct Surroundings {
    /// Of a dome it gives the radiance alone.
    pub program: Program,
    /// All textures.
    pub textures: Arc<Vec<Texture>>,
    /// The camera, for coordinates of the picture.
    pub camera: Camera,
    /// World position of render space's origin.
    pub origin: DVec3,
}

impl Surroundings {
    /// Radiance that arrives from the unit direction `wi`, finite and not negative.
    pub fn radiance(&self, wi: Vec3) -> Rgb {
        let mut values = [[0.0; 4]];
        self.run(wi, &mut values);
        let [r, g, b] = std::array::from_fn(|i| values[0][i].clamp(0.0, f64::from(f32::MAX)) as f32);
        Rgb::new(r, g, b)
    }

    /// All that the program gives for the unit direction `wi`.
    pub fn run(&self, wi: Vec3, values: &mut [Value]) {
        self.program.run(&Towards { direction: wi.as_dvec3(), around: self }, &self.textures, values);
    }
}

/// A direction, as a point of the unit sphere that is seen from its centre.
struct Towards<'a> {
    direction: DVec3,
    around: &'a Surroundings,
}

impl Towards<'_> {
    fn as_the_camera_sees(&self, v: DVec3) -> DVec3 {
        let view = self.around.camera.view();
        DVec3::new(v.dot(view.right.as_dvec3()), v.dot(view.up.as_dvec3()), v.dot(view.forward.as_dvec3()))
    }
}

fn vector(v: DVec3) -> Value {
    [v.x, v.y, v.z, 0.0]
}

impl Hit for Towards<'_> {
    fn leaf(&self, leaf: &Leaf, _: Beside) -> Value {
        match leaf {
            Leaf::Position | Leaf::ObjectPosition | Leaf::Generated => vector(self.direction),
            Leaf::Normal | Leaf::TrueNormal | Leaf::ObjectNormal | Leaf::SmoothNormal | Leaf::Incoming => {
                vector(-self.direction)
            }
            Leaf::CameraPosition => vector(self.as_the_camera_sees(self.direction)),
            Leaf::Window => {
                let camera = &self.around.camera;
                let [x, y] = camera.window(camera.view().origin + self.direction.as_vec3());
                [f64::from(x), f64::from(y), 0.0, 0.0]
            }
            leaf => of_no_object(leaf),
        }
    }

    fn attribute(&self, _: u16, _: Beside) -> Option<Value> {
        None
    }

    fn texture(&self, texture: &TextureRef, _: Beside) -> [f32; 4] {
        texture.lookup(&self.around.textures, [0.0; 2], 0.0)
    }

    fn transform(&self, quantity: Quantity, from: Space, to: Space, [x, y, z, w]: Value) -> Value {
        let view = self.around.camera.view();
        let eye = if quantity == Quantity::Point { view.origin.as_dvec3() + self.around.origin } else { DVec3::ZERO };
        let v = DVec3::new(x, y, z);
        let world = match from {
            Space::Camera => {
                let [right, up, forward] = [view.right, view.up, view.forward].map(|axis| axis.as_dvec3());
                right * v.x + up * v.y + forward * v.z + eye
            }
            Space::World | Space::Object => v,
        };
        let there = if to == Space::Camera { self.as_the_camera_sees(world - eye) } else { world };
        let unit = if quantity == Quantity::Normal { there.normalize_or_zero() } else { there };
        [unit.x, unit.y, unit.z, w]
    }

    fn footprint(&self) -> [Value; 2] {
        [[0.0; 4]; 2]
    }
}
