//! What emissive meshes cost by the number of their triangles.

use std::sync::Arc;
use std::time::Instant;

use penumbra::light::{Emission, Emitter, MeshEmitters, MeshLight, Receiver};
use penumbra::math::{Affine3A, Rgb, Vec3};
use penumbra::shape::Mesh;

use crate::clock::thread_seconds;
use crate::scenes::Random;

#[derive(Debug)]
struct White;

impl Emission for White {
    fn radiance(&self, _triangle: u32, _uv: [f32; 2]) -> Rgb {
        Rgb::WHITE
    }
    fn mean(&self, _triangle: u32) -> Rgb {
        Rgb::WHITE
    }
}

/// A wavy square of 20 m, of `2 n²` triangles.
fn mesh(n: u32) -> Mesh {
    let at = |i: u32| 20.0 * i as f32 / n as f32 - 10.0;
    let height = |x: f32, z: f32| 1.5 + 0.5 * (1.3 * x).sin() * (1.7 * z).sin();
    let points = (0..=n).flat_map(|i| (0..=n).map(move |j| (at(i), at(j))));
    let corner = |i: u32, j: u32| i * (n + 1) + j;
    let triangles = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).flat_map(|(i, j)| {
        let [a, b, c, d] = [corner(i, j), corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j)];
        [[a, b, c], [a, c, d]]
    });
    Mesh {
        points: points.map(|(x, z)| Vec3::new(x, height(x, z), z)).collect(),
        triangles: triangles.collect(),
        ..Mesh::default()
    }
}

pub fn run() {
    println!("emissive meshes over a floor");
    for n in [22, 707] {
        let mesh = Arc::new(mesh(n));
        let count = mesh.triangles.len();
        let start = Instant::now();
        let emitters = Arc::new(MeshEmitters::new(mesh, Arc::new(White)).expect("it shines"));
        let built = start.elapsed().as_secs_f64();
        let light = MeshLight::new(emitters.clone(), Affine3A::IDENTITY).expect("it is not singular");
        let mut random = Random(4);
        let asked: Vec<(Receiver, [f32; 3])> = (0..200_000)
            .map(|_| {
                let p = Vec3::new(random.range(-10.0, 10.0), 0.0, random.range(-10.0, 10.0));
                let at = Receiver { n: Some(Vec3::Y), ..Receiver::everywhere(p) };
                (at, [random.unit(), random.unit(), random.unit()])
            })
            .collect();
        let once = || {
            let start = thread_seconds();
            let found = asked.iter().filter(|(at, [uc, u, v])| light.sample_li(at, *uc, [*u, *v]).is_some()).count();
            (thread_seconds() - start, found)
        };
        let (seconds, found) = (0..5).map(|_| once()).min_by(|a, b| a.0.total_cmp(&b.0)).expect("one");
        println!(
            "  {count:>8} triangles: built in {built:.4} s, {:.1} MiB, {:.0} ns a sample, {:.1} % of which find light",
            emitters.bytes() as f64 / 1048576.0,
            1e9 * seconds / asked.len() as f64,
            100.0 * found as f64 / asked.len() as f64
        );
    }
}
