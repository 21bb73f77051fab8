//! How far what is seen moves in the picture from one frame to the next, as Cycles' Vector pass has it: what is behind
//! another camera is projected all the same, and a panorama's seam is not looked across.

use super::{Interaction, Scene};
use crate::camera::Camera;
use crate::math::{DAffine3, DVec3, Vec3, Vec3A};

/// Where things are at the frame before and at the frame after.
#[derive(Debug)]
pub struct Vectors {
    /// The camera.
    pub cameras: [Camera; 2],
    /// By instance, from its shape's space to render space; `None` for what stays where it is.
    pub placed: Vec<Option<[DAffine3; 2]>>,
    /// By shape, the points in its space; `None` for what keeps its shape.
    pub shapes: Vec<Option<[Vec<Vec3>; 2]>>,
}

impl Vectors {
    /// The point at `it` in the picture: where it was less where it is, and where it is less where it will be, in
    /// pixels to the right and up. Of strands it is the axis that moves.
    pub fn at(&self, scene: &Scene, it: &Interaction) -> [f32; 4] {
        let instance = scene.instance(it.instance);
        let shape = scene.shape(instance);
        let anchors = shape.anchors(it.primitive, it.at);
        let between =
            |point: &dyn Fn(u32) -> Vec3| -> Vec3 { anchors.iter().map(|&(i, share)| point(i) * share).sum() };
        let local = between(&|i| shape.anchor(i));
        let moved = self.shapes[instance.shape as usize].as_ref();
        let placed = self.placed[it.instance as usize].as_ref();
        let here = Vec3::from(instance.placement.to_render.transform_point3a(Vec3A::from(local)));
        let then = |k: usize| {
            let local = moved.map_or(local, |points| between(&|i| points[k][i as usize]));
            match (placed, moved) {
                (None, None) => here,
                (None, Some(_)) => Vec3::from(instance.placement.to_render.transform_point3a(Vec3A::from(local))),
                (Some(placed), _) => placed[k].transform_point3(DVec3::from(local)).as_vec3(),
            }
        };
        let [x, y] = scene.camera.raster(here);
        let [[x_before, y_before], [x_after, y_after]] = [0, 1].map(|k| self.cameras[k].raster(then(k)));
        [x_before - x, y_before - y, x - x_after, y - y_after]
    }
}
