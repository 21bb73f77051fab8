//! The edge of an object's own shadow where its triangles are smooth by their normals alone.
//!
//! Seen from such a triangle a light may be above the smooth surface and below the triangle, or behind its neighbor.
//! Rays to lights begin a little above it there, on the surface that the normals mean, as Cycles does it: its parabola
//! through the corners, or, where that is lower, half of what the tangent planes leave. After Johannes Hanika, *Hacking
//! the Shadow Terminator*, Ray Tracing Gems II, 2021, chapter 4.

use super::{Interaction, Scene};
use crate::desc::TerminatorDesc;
use crate::math::{Ray, Vec3, offset_ray_origin};

/// What an object does about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terminator {
    /// Cosine to a light up to which its rays are moved; 0 for nowhere.
    pub reach: f32,
    /// Factor of the angle to the normal by which light is dimmed; 1 for none.
    pub frequency: f32,
}

impl From<TerminatorDesc> for Terminator {
    fn from(desc: TerminatorDesc) -> Self {
        let within = |x: f64| if x > 0.0 { x.min(1.0) as f32 } else { 0.0 };
        Self { reach: within(desc.geometry), frequency: 1.0 / (1.0 - 0.5 * within(desc.shading)) }
    }
}

impl Scene {
    /// The ray from the surface at `it` along the unit direction `w`, which asks whether something is in the way, up
    /// to `end`, a point off any surface by more than rounding; without one it has no end.
    pub fn shadow_ray(&self, it: &Interaction, w: Vec3, end: Option<Vec3>) -> Ray {
        let ray = end.map_or_else(|| it.spawn(w), |end| it.spawn_to(end));
        // Facets are what they look like.
        if it.ns == it.ng {
            return ray;
        }
        match (self.lifted(it, w), end) {
            (None, _) => ray,
            (Some(o), None) => Ray { o, ..ray },
            (Some(o), Some(end)) => Ray { o, d: end - o, ..ray },
        }
    }

    /// Where a ray along `w` begins in place of the triangle; `None` where that is on it.
    fn lifted(&self, it: &Interaction, w: Vec3) -> Option<Vec3> {
        let instance = self.instance(it.instance);
        let reach = instance.terminator.reach;
        let side = if it.front { 1.0 } else { -1.0 };
        let cos = side * it.ns.dot(w);
        // On the side that `w` is on by the smooth normal.
        let ng = it.ng * if cos < 0.0 { -side } else { side };
        let (cos, cos_g) = (cos.abs(), ng.dot(w));
        let amount = if cos < reach { 2.0 - (cos_g + cos) / reach } else { 1.0 - cos_g / reach };
        if reach <= 0.0 || amount <= 0.0 {
            return None;
        }
        let (corners, normals) = self.shape(instance).smooth_triangle(it.primitive, it.time)?;
        let n = blend(normals, it.at);
        let mut moved = None;
        let up = instance.placement_at(it.time, &mut moved).to_render.transform_vector3(n);
        let height = height(corners, normals, it.at, up.dot(ng) > 0.0);
        Some(offset_ray_origin(it.p + up * (height * amount.min(1.0)), it.p_err, ng, ng))
    }
}

fn blend([a, b, c]: [Vec3; 3], [v, w]: [f32; 2]) -> Vec3 {
    a * (1.0 - v - w) + b * v + c * w
}

/// How high the rounded surface is over a point of the triangle of `corners`, along the normal that its `normals` have
/// there; below it, where `outside` is false.
fn height(corners: [Vec3; 3], normals: [Vec3; 3], at: [f32; 2], outside: bool) -> f32 {
    let ([p0, p1, p2], [n0, n1, n2]) = (corners, normals);
    let (u, v) = (1.0 - at[0] - at[1], at[0]);
    let a = (n2 - n0).dot(p0 - p2);
    let b = (n2 - n1).dot(p1 - p2);
    let c = (n1 - n0).dot(p1 - p0);
    let parabola = a * u * (u - 1.0) + (a + b + c) * u * v + b * v * (v - 1.0);
    let p = blend(corners, at);
    let sign = if outside { 1.0 } else { -1.0 };
    // Of each corner: how far its tangent plane is above the point, and above the other corners.
    let above = |from: Vec3, n: Vec3, others: [Vec3; 2]| {
        let over = others.map(|other| sign * (other - from).dot(n));
        (sign * (from - p).dot(n) + over[0].max(over[1]).max(0.0)).max(0.0)
    };
    let envelope = above(p0, n0, [p1, p2]).min(above(p1, n1, [p0, p2])).min(above(p2, n2, [p0, p1]));
    sign * envelope.max(sign * 0.5 * parabola)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners on a unit sphere: the surface meets them, and in between lies near the sphere.
    #[test]
    fn a_triangle_of_a_sphere_is_rounded_to_about_it() {
        let corners = [[0.95, 0.2, 0.1], [0.9, -0.2, 0.2], [0.9, 0.1, -0.3]].map(|p| Vec3::from(p).normalize());
        for at in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] {
            assert!(height(corners, corners, at, true).abs() < 1e-6);
        }
        let at = [1.0 / 3.0; 2];
        let p = blend(corners, at);
        let sagitta = 1.0 - p.length();
        let found = height(corners, corners, at, true) * p.length();
        assert!(found > 0.5 * sagitta && found < 2.5 * sagitta, "{found} of {sagitta}");
    }

    /// From within a ball the same triangle is hollow: nothing has to be moved but as far as the parabola says.
    #[test]
    fn a_hollow_triangle_stays_below_its_tangent_planes() {
        let corners = [[0.95, 0.2, 0.1], [0.9, -0.2, 0.2], [0.9, 0.1, -0.3]].map(|p| Vec3::from(p).normalize());
        let inward = corners.map(|p| -p);
        let at = [0.3, 0.3];
        assert!(height(corners, corners, at, false) <= 0.0);
        assert!(height(corners, inward, at, true) >= 0.0);
    }
}
