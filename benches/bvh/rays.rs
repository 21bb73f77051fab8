//! The ray sets of the benchmark.

use penumbra::bvh::{Bvh, Hit};
use penumbra::math::{Frame, Ray, Vec3};

use super::meshes::Scene;
use super::rng::Rng;

/// Rays of one kind.
pub struct RaySet {
    /// Its name in the table.
    pub name: &'static str,
    /// Whether any hit will do.
    pub any: bool,
    /// The rays.
    pub rays: Vec<Ray>,
}

/// As many primary, diffuse, short, shadow and shuffled diffuse rays as the camera has pixels; the nearest hits come from `bvh`.
pub fn ray_sets(scene: &Scene, bvh: &Bvh) -> Vec<RaySet> {
    let primary = primary(scene);
    let count = primary.len();
    let points: Vec<(Vec3, Vec3)> = primary
        .iter()
        .filter_map(|ray| bvh.closest_hit(ray, u64::MAX).map(|hit| surface_point(scene, ray, &hit)))
        .collect();
    assert!(!points.is_empty(), "the camera sees nothing");
    let mut rng = Rng::new(5);
    let mut cosine = |n: Vec3| {
        let d = n + rng.unit();
        if d.length_squared() > 1e-6 { d.normalize() } else { n }
    };
    // Where the camera sees little, its points serve several times, still in order.
    let origins: Vec<_> = (0..count).map(|i| points[i * points.len() / count]).collect();
    let diffuse: Vec<_> = origins.iter().map(|&(p, n)| Ray::new(p, cosine(n))).collect();
    let ao = origins.iter().map(|&(p, n)| Ray { t_max: scene.ao_distance, ..Ray::new(p, cosine(n)) }).collect();
    let mut rng = Rng::new(6);
    let shadow = origins
        .iter()
        .map(|&(p, _)| {
            let [corner, a, b] = scene.light;
            let on_light = corner + a * rng.unit_interval() + b * rng.unit_interval();
            Ray { t_max: 0.9999, ..Ray::new(p, on_light - p) }
        })
        .collect();
    let mut shuffled = diffuse.clone();
    for i in (1..shuffled.len()).rev() {
        shuffled.swap(i, ((u64::from(rng.bits()) * (i as u64 + 1)) >> 32) as usize);
    }
    vec![
        RaySet { name: "primary", any: false, rays: primary },
        RaySet { name: "diffuse", any: false, rays: diffuse },
        RaySet { name: "ao", any: true, rays: ao },
        RaySet { name: "shadow", any: true, rays: shadow },
        RaySet { name: "diffuse_shuf", any: false, rays: shuffled },
    ]
}

fn primary(scene: &Scene) -> Vec<Ray> {
    let forward = (scene.target - scene.eye).normalize();
    let right = forward.cross(Vec3::Z).normalize();
    let up = right.cross(forward);
    let side = scene.side;
    let at = |i: usize| (i as f32 + 0.5) / side as f32 - 0.5;
    let ray = |i: usize| Ray::new(scene.eye, (forward + right * at(i % side) - up * at(i / side)).normalize());
    (0..side * side).map(ray).collect()
}

/// The point hit, a little above the surface, and the normal on the ray's side.
fn surface_point(scene: &Scene, ray: &Ray, hit: &Hit) -> (Vec3, Vec3) {
    let (mesh, transform) = scene.instances[hit.instance as usize];
    let mesh = &scene.meshes[mesh as usize];
    let [a, b, c] = mesh.triangles[hit.primitive as usize].map(|v| transform.transform_point3(mesh.points[v as usize]));
    let normal = (b - a).cross(c - a).normalize();
    let normal = if normal.dot(ray.d) > 0.0 { -normal } else { normal };
    let n = if normal.is_finite() { Frame::from_z(normal).n } else { -ray.d };
    let p = ray.at(hit.t);
    (p + n * 1e-4 * p.abs().max_element().max(1.0), n)
}
