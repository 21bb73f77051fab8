//! The scenes of the benchmark.

use penumbra::math::{Affine3A, Vec3};

use super::rng::Rng;

/// Triangles of one mesh.
#[derive(Default)]
pub struct Mesh {
    /// Vertices.
    pub points: Vec<Vec3>,
    /// Three vertices each.
    pub triangles: Vec<[u32; 3]>,
}

/// Meshes, their places, and where to look from.
pub struct Scene {
    /// Its name on the command line.
    pub name: &'static str,
    /// The meshes.
    pub meshes: Vec<Mesh>,
    /// Mesh and transform of each instance.
    pub instances: Vec<(u32, Affine3A)>,
    /// Camera position.
    pub eye: Vec3,
    /// What the camera looks at.
    pub target: Vec3,
    /// Corner and edges of a light in the form of a parallelogram.
    pub light: [Vec3; 3],
    /// Length of the short rays.
    pub ao_distance: f32,
    /// Side of the camera's picture in pixels.
    pub side: usize,
}

impl Scene {
    /// All scenes, by name.
    pub const NAMES: [&'static str; 4] = ["sphere1m", "stadium", "inst10m", "thin"];

    /// The scene called `name`.
    pub fn new(name: &str) -> Self {
        let mut scene = match name {
            "sphere1m" => sphere1m(),
            "stadium" => stadium(),
            "inst10m" => inst10m(),
            "thin" => thin(),
            _ => panic!("no scene called {name}; there are {:?}", Self::NAMES),
        };
        // Embree reads 16 bytes where the last vertex has 12.
        scene.meshes.iter_mut().for_each(|mesh| mesh.points.reserve(1));
        scene
    }

    /// Triangles of all instances together.
    pub fn triangles(&self) -> usize {
        self.instances.iter().map(|(mesh, _)| self.meshes[*mesh as usize].triangles.len()).sum()
    }
}

impl Mesh {
    fn append(&mut self, other: &Self, place: impl Fn(Vec3) -> Vec3) {
        let first = self.points.len() as u32;
        self.points.extend(other.points.iter().map(|&p| place(p)));
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
    }

    /// A surface `point(u, v)` over the unit square in `columns` times `rows` quads.
    fn surface(columns: u32, rows: u32, point: impl Fn(f32, f32) -> Vec3) -> Self {
        let mut mesh = Self::default();
        for j in 0..=rows {
            for i in 0..=columns {
                mesh.points.push(point(i as f32 / columns as f32, j as f32 / rows as f32));
            }
        }
        let id = |i: u32, j: u32| j * (columns + 1) + i;
        for j in 0..rows {
            for i in 0..columns {
                mesh.triangles.push([id(i, j), id(i + 1, j), id(i + 1, j + 1)]);
                mesh.triangles.push([id(i, j), id(i + 1, j + 1), id(i, j + 1)]);
            }
        }
        mesh
    }

    fn bumpy_sphere(columns: u32, rows: u32, bump: f32, frequency: f32) -> Self {
        Self::surface(columns, rows, |u, v| {
            let (phi, theta) = (u * std::f32::consts::TAU, v * std::f32::consts::PI);
            let wave = (frequency * theta).sin() * (frequency * phi).cos()
                + 0.5 * (2.7 * frequency * theta).cos() * (3.0 * frequency * phi).sin();
            let r = 1.0 + bump * wave;
            r * Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
        })
    }

    fn cube() -> Self {
        let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32) * 2.0 - 1.0;
        let quads = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        Self {
            points: (0..8).map(corner).collect(),
            triangles: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        }
    }
}

/// A displaced sphere of a million triangles in a closed box of twelve.
fn sphere1m() -> Scene {
    let mut mesh = Mesh::bumpy_sphere(1000, 500, 0.06, 13.0);
    mesh.append(&Mesh::cube(), |p| p * 2.5);
    Scene {
        name: "sphere1m",
        meshes: vec![mesh],
        instances: vec![(0, Affine3A::IDENTITY)],
        eye: Vec3::new(1.9, -1.6, 1.2),
        target: Vec3::ZERO,
        light: [Vec3::new(-0.5, -0.5, 2.45), Vec3::X, Vec3::Y],
        ao_distance: 0.5,
        side: 512,
    }
}

/// Large stands and a floor of few triangles around a small, finely divided object.
fn stadium() -> Scene {
    let mut mesh = Mesh::surface(4, 4, |u, v| Vec3::new(200.0 * u - 100.0, 200.0 * v - 100.0, 0.0));
    for k in 0..40 {
        let (low, high) = (40.0 + k as f32, 1.0 + 0.6 * k as f32);
        let step = Mesh::surface(60, 1, |u, v| {
            let phi = u * std::f32::consts::TAU;
            Vec3::new(1.4 * (low + v) * phi.cos(), (low + v) * phi.sin(), high - 0.3 * v)
        });
        mesh.append(&step, |p| p);
    }
    let object = Mesh::bumpy_sphere(300, 145, 0.12, 5.0);
    mesh.append(&object, |p| 0.5 * p + Vec3::new(0.0, 0.0, 0.6));
    let knob = Mesh::bumpy_sphere(60, 30, 0.02, 9.0);
    mesh.append(&knob, |p| 0.07 * p + Vec3::new(0.0, 0.0, 1.2));
    Scene {
        name: "stadium",
        meshes: vec![mesh],
        instances: vec![(0, Affine3A::IDENTITY)],
        eye: Vec3::new(1.6, -1.4, 1.3),
        target: Vec3::new(0.0, 0.0, 0.65),
        light: [Vec3::new(-10.0, -10.0, 30.0), Vec3::X * 20.0, Vec3::Y * 20.0],
        ao_distance: 1.0,
        side: 512,
    }
}

/// A thousand turned and scaled copies of a mesh of ten thousand triangles over a floor.
fn inst10m() -> Scene {
    let floor = Mesh::surface(1, 1, |u, v| Vec3::new(60.0 * u - 30.0, 60.0 * v - 30.0, -1.0));
    let mut rng = Rng::new(11);
    let mut instances = vec![(0, Affine3A::IDENTITY)];
    for i in 0..1000 {
        let grid = Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32);
        let place = (grid - Vec3::new(4.5, 4.5, 0.0)) * 2.0 + 0.5 * rng.vec();
        let turn = Affine3A::from_axis_angle(rng.unit(), 6.0 * rng.signed());
        let scale = Affine3A::from_scale(Vec3::splat(0.9 + 0.3 * rng.signed()));
        instances.push((1, Affine3A::from_translation(place) * turn * scale));
    }
    Scene {
        name: "inst10m",
        meshes: vec![floor, Mesh::bumpy_sphere(100, 50, 0.15, 6.0)],
        instances,
        eye: Vec3::new(18.0, -20.0, 16.0),
        target: Vec3::new(0.0, 0.0, 8.0),
        light: [Vec3::new(-5.0, -5.0, 40.0), Vec3::X * 10.0, Vec3::Y * 10.0],
        ao_distance: 2.0,
        side: 512,
    }
}

/// Long slivers in all directions, which boxes hold badly.
fn thin() -> Scene {
    let mut rng = Rng::new(12);
    let mut mesh = Mesh::default();
    for _ in 0..100_000 {
        let (middle, along, across) = (rng.vec() * 2.0, rng.unit(), rng.unit());
        let n = mesh.points.len() as u32;
        mesh.points.extend([middle - along, middle + along, middle + across * 2e-3]);
        mesh.triangles.push([n, n + 1, n + 2]);
    }
    Scene {
        name: "thin",
        meshes: vec![mesh],
        instances: vec![(0, Affine3A::IDENTITY)],
        eye: Vec3::new(5.0, -4.0, 3.0),
        target: Vec3::ZERO,
        light: [Vec3::new(-1.0, -1.0, 6.0), Vec3::X * 2.0, Vec3::Y * 2.0],
        ao_distance: 0.5,
        side: 64,
    }
}
