//! The acceleration structure against brute force, on ordinary and degenerate geometry, for every
//! instruction set of this machine.

use std::sync::Arc;

use penumbra::bvh::{Blas, Bvh, Hit, Instance, Isa};
use penumbra::math::{Affine3A, DVec3, Ray, Vec3};
use proptest::prelude::*;

/// A small generator of numbers (PCG-XSH-RR of M. O'Neill), so that tests depend on nothing else.
struct Rng(u64);

impl Rng {
    fn u32(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let x = (((self.0 >> 18) ^ self.0) >> 27) as u32;
        x.rotate_right((self.0 >> 59) as u32)
    }
    /// In [-1, 1).
    fn f(&mut self) -> f32 {
        (self.u32() >> 8) as f32 / (1 << 23) as f32 - 1.0
    }
    fn vec(&mut self) -> Vec3 {
        Vec3::new(self.f(), self.f(), self.f())
    }
    fn dir(&mut self) -> Vec3 {
        loop {
            let v = self.vec();
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }
    fn below(&mut self, n: usize) -> usize {
        ((u64::from(self.u32()) * n as u64) >> 32) as usize
    }
}

#[derive(Clone, Default)]
struct Mesh {
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Mesh {
    fn push(&mut self, corners: [Vec3; 3]) {
        let n = self.points.len() as u32;
        self.points.extend(corners);
        self.triangles.push([n, n + 1, n + 2]);
    }
    fn corners(&self, i: usize) -> [Vec3; 3] {
        self.triangles[i].map(|v| self.points[v as usize])
    }
    fn blas(&self) -> Arc<Blas> {
        Arc::new(Blas::build(&self.points, &self.triangles))
    }
    fn soup(rng: &mut Rng, n: usize, size: f32) -> Self {
        let mut mesh = Self::default();
        for _ in 0..n {
            let c = rng.vec();
            mesh.push([c + rng.vec() * size, c + rng.vec() * size, c + rng.vec() * size]);
        }
        mesh
    }
    /// A closed sphere of `2 n` by `n` patches, displaced by `bump`.
    fn sphere(n: usize, bump: f32) -> Self {
        let mut mesh = Self::default();
        let (rows, columns) = (n, 2 * n);
        let point = |i: usize, j: usize| {
            let (theta, phi) = (
                std::f32::consts::PI * i as f32 / rows as f32,
                std::f32::consts::TAU * (j % columns) as f32 / columns as f32,
            );
            let r = 1.0 + bump * (5.0 * theta).sin() * (7.0 * phi).sin();
            Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()) * r
        };
        mesh.points.push(Vec3::Z);
        mesh.points.push(Vec3::NEG_Z);
        for i in 1..rows {
            mesh.points.extend((0..columns).map(|j| point(i, j)));
        }
        let id = |i: usize, j: usize| match i {
            0 => 0,
            i if i == rows => 1,
            _ => (2 + (i - 1) * columns + j % columns) as u32,
        };
        for i in 0..rows {
            for j in 0..columns {
                if i > 0 {
                    mesh.triangles.push([id(i, j), id(i + 1, j), id(i, j + 1)]);
                }
                if i + 1 < rows {
                    mesh.triangles.push([id(i, j + 1), id(i + 1, j), id(i + 1, j + 1)]);
                }
            }
        }
        mesh
    }
}

fn single(mesh: &Mesh) -> Vec<Bvh> {
    placed(&[mesh.blas()], &[Instance { blas: 0, object_to_render: Affine3A::IDENTITY, motion: None, mask: u64::MAX }])
}

/// One structure for each instruction set.
fn placed(blases: &[Arc<Blas>], instances: &[Instance]) -> Vec<Bvh> {
    let build = || Bvh::build(blases.to_vec(), instances.to_vec());
    Isa::available().iter().map(|&isa| build().with_isa(isa).expect("available")).collect()
}

/// All agree bit for bit, and with `any_hit`; the common answer.
fn shoot(bvhs: &[Bvh], ray: &Ray, mask: u64) -> Option<Hit> {
    let bits = |hit: &Option<Hit>| hit.map(|h| (h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.instance, h.primitive));
    let hit = bvhs[0].closest_hit(ray, mask);
    for bvh in bvhs {
        let other = bvh.closest_hit(ray, mask);
        assert_eq!(bits(&other), bits(&hit), "{} differs on {ray:?}", bvh.isa().name());
        assert_eq!(bvh.any_hit(ray, mask), hit.is_some(), "any_hit of {} differs on {ray:?}", bvh.isa().name());
    }
    hit
}

/// Signed distances in units of the ray, and the weights, of the plane hit in `f64`: how far inside
/// (all weights above) or outside (any below) of the triangle the ray passes.
struct Exact {
    t: f64,
    weights: [f64; 3],
    /// |cos| between ray and normal: where it is small, nothing is certain.
    facing: f64,
}

fn exact(corners: [Vec3; 3], ray: &Ray) -> Option<Exact> {
    let [a, b, c] = corners.map(DVec3::from);
    let (o, d) = (DVec3::from(ray.o), DVec3::from(ray.d));
    let n = (b - a).cross(c - a);
    let det = n.dot(d);
    if det == 0.0 || !det.is_finite() {
        return None;
    }
    let t = n.dot(a - o) / det;
    let p = o + d * t;
    let area = n.length_squared();
    let weight = |p0: DVec3, p1: DVec3| (p1 - p0).cross(p - p0).dot(n) / area;
    Some(Exact {
        t,
        weights: [weight(b, c), weight(c, a), weight(a, b)],
        facing: det.abs() / (n.length() * d.length()),
    })
}

/// Compares with the brute-force answer wherever rounding cannot have decided.
fn check_against_brute_force(mesh: &Mesh, bvhs: &[Bvh], ray: &Ray) -> bool {
    let hit = shoot(bvhs, ray, u64::MAX);
    let margin = 1e-3;
    let mut nearest = f64::INFINITY;
    for i in 0..mesh.triangles.len() {
        if let Some(e) = exact(mesh.corners(i), ray)
            && e.facing > 1e-3
            && e.weights.iter().all(|&w| w > margin)
            && e.t > 1e-4
            && e.t < f64::from(ray.t_max) * (1.0 - 1e-5)
        {
            nearest = nearest.min(e.t);
        }
    }
    match hit {
        None => assert!(nearest.is_infinite(), "missed a sure hit at {nearest} on {ray:?}"),
        Some(hit) => {
            assert!(hit.t >= 0.0 && hit.t < ray.t_max);
            assert!(f64::from(hit.t) <= nearest * (1.0 + 1e-5) + 1e-6, "{hit:?} behind {nearest} on {ray:?}");
            let [a, b, c] = mesh.corners(hit.primitive as usize);
            let p = a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v;
            let scale = a.abs().max(b.abs()).max(c.abs()).max_element().max(ray.o.abs().max_element());
            if exact([a, b, c], ray).is_some_and(|e| e.facing > 1e-2) {
                let off = (p - ray.at(hit.t)).length();
                assert!(off <= 1e-4 * scale.max(1e-30), "hit point off by {off} on {ray:?}");
            }
        }
    }
    hit.is_some()
}

#[test]
fn random_soups_agree_with_brute_force() {
    let mut rng = Rng(1);
    for (n, size) in [(1, 1.0), (2, 0.5), (3, 1.0), (5, 0.7), (9, 0.4), (33, 0.5), (100, 0.3), (1000, 0.1)] {
        let mesh = Mesh::soup(&mut rng, n, size);
        let bvhs = single(&mesh);
        let mut hits = 0;
        for _ in 0..3000 {
            let mut ray = Ray::new(rng.vec() * 2.0, rng.dir());
            if rng.below(3) == 0 {
                ray.t_max = 2.0 * rng.f().abs();
            }
            hits += usize::from(check_against_brute_force(&mesh, &bvhs, &ray));
        }
        assert!(hits > 20, "{n} triangles: {hits} hits");
    }
}

#[test]
fn nothing_escapes_from_a_closed_mesh() {
    let mut rng = Rng(2);
    for (n, bump, squash) in [
        (4, 0.0, Vec3::ONE),
        (24, 0.2, Vec3::ONE),
        (60, 0.1, Vec3::new(1.0, 300.0, 0.01)),
        (40, 0.3, Vec3::splat(1e-6)),
    ] {
        let mut mesh = Mesh::sphere(n, bump);
        let shift = if bump == 0.3 { Vec3::new(0.0, 3e-6, -2e-6) } else { Vec3::new(0.1, 0.0, -1.0) };
        mesh.points.iter_mut().for_each(|p| *p = *p * squash + shift);
        let bvhs = single(&mesh);
        let mut targets = mesh.points.clone();
        for t in &mesh.triangles {
            for k in 0..3 {
                targets.push(0.5 * (mesh.points[t[k] as usize] + mesh.points[t[(k + 1) % 3] as usize]));
            }
        }
        let inside = |rng: &mut Rng| shift + rng.vec() * squash * 0.2;
        let step = |rng: &mut Rng, v: f32| match rng.below(3) {
            0 => v,
            1 => v.next_up(),
            _ => v.next_down(),
        };
        for (i, &target) in targets.iter().enumerate() {
            for k in 0..4 {
                let o = if k == 0 { shift } else { inside(&mut rng) };
                let nudged = Vec3::new(step(&mut rng, target.x), step(&mut rng, target.y), step(&mut rng, target.z));
                for p in [target, nudged] {
                    assert!(shoot(&bvhs, &Ray::new(o, p - o), u64::MAX).is_some(), "target {i} of sphere {n} escaped");
                }
            }
        }
        for _ in 0..20_000 {
            let ray = Ray::new(inside(&mut rng), rng.dir() * squash);
            assert!(shoot(&bvhs, &ray, u64::MAX).is_some(), "escaped from sphere {n}: {ray:?}");
        }
    }
}

#[test]
fn millions_of_rays_stay_inside() {
    let mesh = Mesh::sphere(100, 0.15);
    let bvh = Bvh::build(
        vec![mesh.blas()],
        vec![Instance { blas: 0, object_to_render: Affine3A::IDENTITY, motion: None, mask: 1 }],
    );
    let mut rng = Rng(3);
    for _ in 0..2_000_000 {
        let ray = Ray::new(rng.vec() * 0.3, rng.dir());
        assert!(bvh.closest_hit(&ray, 1).is_some(), "escaped: {ray:?}");
    }
}

/// At its vertices and edges, from within: the numbers of docs/hard-cases.md. `PENUMBRA_RAYS` says how many.
#[test]
#[ignore = "minutes: cargo test --test bvh -- --ignored --nocapture a_hundred_million"]
fn a_hundred_million_rays_at_vertices_and_edges_stay_inside() {
    let rays: u64 = std::env::var("PENUMBRA_RAYS").ok().map_or(100_000_000, |text| text.parse().unwrap());
    let mut mesh = Mesh::sphere(100, 0.15);
    mesh.points.iter_mut().for_each(|p| *p = *p * Vec3::new(1.0, 30.0, 0.1) + Vec3::new(0.1, 0.0, -1.0));
    let place = Instance { blas: 0, object_to_render: Affine3A::IDENTITY, motion: None, mask: 1 };
    let bvh = Bvh::build(vec![mesh.blas()], vec![place]);
    let mut rng = Rng(4);
    let mut escaped = 0_u64;
    for _ in 0..rays {
        let corners = mesh.corners(rng.below(mesh.triangles.len()));
        let target = match rng.below(3) {
            0 => corners[0],
            1 => 0.5 * (corners[0] + corners[1]),
            _ => corners[0].lerp(corners[1], rng.f()),
        };
        let o = Vec3::new(0.1, 0.0, -1.0) + rng.vec() * Vec3::new(0.3, 9.0, 0.03);
        escaped += u64::from(bvh.closest_hit(&Ray::new(o, target - o), 1).is_none());
    }
    println!("{rays} rays at vertices and edges, {escaped} escaped");
    assert_eq!(escaped, 0);
}

#[test]
fn every_edge_of_a_flat_grid_is_closed() {
    // Axis-aligned and flat: boxes without thickness, rays along axes and diagonals, through vertices.
    for (axis, n) in [(0, 8_u32), (1, 13), (2, 16)] {
        let place = |x: f32, y: f32, z: f32| {
            let mut p = [x, y, z];
            p.rotate_right((axis + 1) % 3);
            Vec3::from_array(p)
        };
        let mut mesh = Mesh::default();
        for j in 0..=n {
            mesh.points.extend((0..=n).map(|i| place(i as f32, j as f32, 2.0)));
        }
        let id = |i: u32, j: u32| j * (n + 1) + i;
        for j in 0..n {
            for i in 0..n {
                mesh.triangles.push([id(i, j), id(i + 1, j), id(i + 1, j + 1)]);
                mesh.triangles.push([id(i, j), id(i + 1, j + 1), id(i, j + 1)]);
            }
        }
        let bvhs = single(&mesh);
        for j in 0..=4 * n {
            for i in 0..=4 * n {
                let (x, y) = (i as f32 / 4.0, j as f32 / 4.0);
                for d in [1.0, 3.0] {
                    let hit =
                        shoot(&bvhs, &Ray::new(place(x, y, -1.0), place(0.0, -0.0, d)), 1).expect("through the grid");
                    assert_eq!(hit.t, 3.0 / d);
                }
                let from_above = Ray::new(place(x, y, 4.0), place(0.0, 0.0, -1.0));
                assert_eq!(shoot(&bvhs, &from_above, 1).expect("from above").t, 2.0);
            }
        }
        // In the plane itself: edge on, so a miss, and no endless walk.
        assert_eq!(shoot(&bvhs, &Ray::new(place(-1.0, 0.5, 2.0), place(1.0, 0.0, 0.0)), 1), None);
        // From the plane nothing of it is hit.
        for d in [1.0, -1.0] {
            assert_eq!(shoot(&bvhs, &Ray::new(place(0.5, 0.25, 2.0), place(0.0, 0.0, d)), 1), None);
        }
        let just_above = 2.0_f32 + 1e-5;
        let hit = shoot(&bvhs, &Ray::new(place(0.5, 0.25, just_above), place(0.0, 0.0, -1.0)), 1);
        assert_eq!(hit.expect("just above").t, just_above - 2.0);
    }
}

#[test]
fn degenerate_input_neither_hits_nor_disturbs() {
    let mut rng = Rng(4);
    let clean = Mesh::soup(&mut rng, 300, 0.3);
    let mut dirty = Mesh { points: clean.points.clone(), triangles: Vec::new() };
    dirty.points.extend([Vec3::NAN, Vec3::INFINITY, Vec3::new(0.0, f32::NEG_INFINITY, 0.0), Vec3::splat(2e18)]);
    dirty.points.extend([Vec3::ZERO, Vec3::X, Vec3::X * 3.0]);
    let bad = clean.points.len() as u32;
    let mut original = Vec::new();
    for (i, &t) in clean.triangles.iter().enumerate() {
        for k in 0..4 {
            dirty.triangles.push([t[0], bad + k, t[1]]);
            original.push(u32::MAX);
        }
        dirty.triangles.extend([[t[0]; 3], [t[0], t[1], t[1]], [bad + 4, bad + 5, bad + 6], t]);
        original.extend([u32::MAX, u32::MAX, u32::MAX, i as u32]);
    }
    assert_eq!(dirty.blas().len(), clean.triangles.len());
    let (bvhs, reference) = (single(&dirty), single(&clean));
    let mut hits = 0;
    for _ in 0..5000 {
        let ray = Ray::new(rng.vec() * 1.5, rng.dir());
        let hit = shoot(&bvhs, &ray, 1).map(|h| Hit { primitive: original[h.primitive as usize], ..h });
        assert_eq!(hit, shoot(&reference, &ray, 1));
        hits += usize::from(hit.is_some());
    }
    assert!(hits > 1000);
}

#[test]
fn nothing_to_hit() {
    let nan = Mesh { points: vec![Vec3::NAN; 3], triangles: vec![[0, 1, 2]] };
    let point = Mesh { points: vec![Vec3::ONE], triangles: vec![[0, 0, 0]; 100] };
    for mesh in [Mesh::default(), nan, point] {
        assert!(mesh.blas().is_empty() && mesh.blas().bounds().is_empty());
        for bvhs in [single(&mesh), placed(&[mesh.blas()], &[]), placed(&[], &[])] {
            assert_eq!(shoot(&bvhs, &Ray::new(Vec3::ZERO, Vec3::ONE), u64::MAX), None);
            assert!(bvhs[0].bounds().is_empty());
        }
    }
}

#[test]
fn rays_without_sense_hit_nothing() {
    let bvhs = single(&Mesh::sphere(8, 0.0));
    let good = Ray::new(Vec3::ZERO, Vec3::X);
    assert!(shoot(&bvhs, &good, 1).is_some());
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let (mut o, mut d) = (Vec3::ZERO, Vec3::X);
            o[axis] = bad;
            d[axis] = bad;
            assert_eq!(shoot(&bvhs, &Ray { o, ..good }, 1), None);
            assert_eq!(shoot(&bvhs, &Ray { d, ..good }, 1), None);
        }
    }
    for t_max in [f32::NAN, 0.0, -0.0, -1.0, f32::NEG_INFINITY] {
        assert_eq!(shoot(&bvhs, &Ray { t_max, ..good }, 1), None);
    }
    assert_eq!(shoot(&bvhs, &Ray { d: Vec3::ZERO, ..good }, 1), None);
    assert_eq!(shoot(&bvhs, &good, 0), None);
}

#[test]
fn direction_lengths_scale_t() {
    let bvhs = single(&Mesh::sphere(8, 0.0));
    let unit = shoot(&bvhs, &Ray::new(Vec3::ZERO, Vec3::new(0.5, 0.25, -0.125)), 1).unwrap();
    for exponent in [-126, -90, -30, -3, 5, 40, 100] {
        let s = 2.0_f32.powi(exponent);
        let ray = Ray::new(Vec3::ZERO, Vec3::new(0.5, 0.25, -0.125) * s);
        let hit = shoot(&bvhs, &ray, 1).unwrap();
        assert_eq!((hit.primitive, hit.u, hit.v, hit.t), (unit.primitive, unit.u, unit.v, unit.t / s));
        assert!(shoot(&bvhs, &Ray { t_max: hit.t * 1.001, ..ray }, 1).is_some());
        assert!(shoot(&bvhs, &Ray { t_max: hit.t * 0.999, ..ray }, 1).is_none());
    }
}

#[test]
fn equal_distances_choose_the_lowest_instance_then_triangle() {
    let mut mesh = Mesh::default();
    for _ in 0..100 {
        mesh.push([Vec3::ZERO, Vec3::X, Vec3::Y]);
    }
    let blas = mesh.blas();
    let instance = Instance { blas: 0, object_to_render: Affine3A::IDENTITY, motion: None, mask: 1 };
    let bvhs =
        placed(&[blas], &[Instance { mask: 2, ..instance.clone() }, instance.clone(), instance.clone(), instance]);
    let ray = Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z);
    let hit = shoot(&bvhs, &ray, 1).unwrap();
    assert_eq!((hit.instance, hit.primitive, hit.t), (1, 0, 1.0));
    assert_eq!(shoot(&bvhs, &ray, 3).unwrap().instance, 0);
}

#[test]
fn huge_ranges_of_size_in_one_mesh() {
    let mut rng = Rng(5);
    let mut mesh = Mesh::default();
    for i in 0..400 {
        let s = 10.0_f32.powi(i % 25 - 12);
        let c = rng.vec() * s * 10.0;
        mesh.push([c + rng.vec() * s, c + rng.vec() * s, c + rng.vec() * s]);
    }
    let bvhs = single(&mesh);
    for i in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(i);
        let scale = (b - a).length();
        let middle = (a + b + c) / 3.0;
        let ray = Ray { o: middle + rng.dir() * scale, d: Vec3::ZERO, t_max: f32::INFINITY, time: 0.0 };
        let ray = Ray { d: middle - ray.o, ..ray };
        let e = exact([a, b, c], &ray);
        if e.is_some_and(|e| e.facing > 0.05 && e.weights.iter().all(|&w| w > 0.05)) {
            let hit = shoot(&bvhs, &ray, 1).expect("aimed at a triangle");
            assert!(hit.t <= 1.001, "{hit:?}");
        }
    }
}

fn transforms(rng: &mut Rng) -> Vec<Affine3A> {
    let mut list = vec![Affine3A::IDENTITY];
    for k in 0..40 {
        let scale = 10.0_f32.powi(k % 13 - 6);
        let mut m = Affine3A::from_quat(glam::Quat::from_axis_angle(rng.dir(), 3.0 * rng.f()));
        match k % 4 {
            0 => {}
            1 => m.matrix3.x_axis = -m.matrix3.x_axis,
            2 => m.matrix3.y_axis += 2.0 * m.matrix3.z_axis,
            _ => m.matrix3.z_axis *= 0.05,
        }
        let m = Affine3A::from_scale(Vec3::splat(scale)) * m;
        list.push(Affine3A::from_translation(rng.vec() * 3.0 * scale) * m);
    }
    list
}

#[test]
fn instances_agree_with_the_transformed_mesh() {
    let mut rng = Rng(6);
    let meshes = [Mesh::soup(&mut rng, 60, 0.5), Mesh::soup(&mut rng, 1, 1.0), Mesh::sphere(6, 0.0)];
    let blases: Vec<_> = meshes.iter().map(Mesh::blas).collect();
    for (k, transform) in transforms(&mut rng).into_iter().enumerate() {
        let mesh = &meshes[k % 3];
        let mut moved = mesh.clone();
        moved.points.iter_mut().for_each(|p| *p = transform.transform_point3(*p));
        let instance = Instance { blas: (k % 3) as u32, object_to_render: transform, motion: None, mask: 1 };
        let bvhs = placed(&blases, &[instance]);
        let reference = single(&moved);
        let bounds = reference[0].bounds();
        let (mut hits, mut differ) = (0, 0);
        for _ in 0..1000 {
            let target = bounds.center() + 0.5 * bounds.extent() * rng.vec();
            let o = bounds.center() + bounds.extent() * rng.vec() * 1.5;
            let ray = Ray::new(o, target - o);
            let (a, b) = (shoot(&bvhs, &ray, 1), shoot(&reference, &ray, 1));
            hits += usize::from(b.is_some());
            let same = match (a, b) {
                (Some(a), Some(b)) => a.primitive == b.primitive && (a.t - b.t).abs() <= 1e-3 * b.t.max(0.1),
                (a, b) => a == b,
            };
            differ += usize::from(!same);
        }
        assert!(hits > 50, "{k}: {hits} hits");
        assert!(differ <= 4, "{differ} of {hits} differ under transform {k}");
    }
}

#[test]
fn many_overlapping_instances() {
    let mut rng = Rng(7);
    let mesh = Mesh::soup(&mut rng, 4, 1.0);
    let instances: Vec<_> = (0..20_000)
        .map(|i| Instance {
            blas: 0,
            object_to_render: Affine3A::from_translation(if i % 2 == 0 { Vec3::ZERO } else { rng.vec() * 0.01 }),
            motion: None,
            mask: 1 << (i % 3),
        })
        .collect();
    let bvhs = placed(&[mesh.blas()], &instances);
    let alone: Vec<_> = instances.iter().step_by(2000).map(|i| (i, placed(&[mesh.blas()], &[(*i).clone()]))).collect();
    for _ in 0..50 {
        let ray = Ray::new(rng.dir() * 3.0, rng.dir());
        for mask in [1, 2, 4, 7] {
            let nearest = shoot(&bvhs, &ray, mask).map_or(f32::INFINITY, |h| h.t);
            for (_, one) in &alone {
                assert!(shoot(one, &ray, mask).map_or(f32::INFINITY, |h| h.t) >= nearest);
            }
        }
    }
}

#[test]
fn singular_and_infinite_transforms_never_hit() {
    let mesh = Mesh::sphere(6, 0.0);
    let flat = Affine3A::from_scale(Vec3::new(1.0, 1.0, 0.0));
    let nan = Affine3A::from_translation(Vec3::NAN);
    let infinite = Affine3A::from_scale(Vec3::INFINITY);
    let good = Affine3A::from_translation(Vec3::X * 10.0);
    let of = |object_to_render| Instance { blas: 0, object_to_render, motion: None, mask: 1 };
    let missing = Instance { blas: 7, ..of(good) };
    let bvhs = placed(&[mesh.blas()], &[of(flat), of(nan), of(infinite), missing, of(good)]);
    let mut rng = Rng(8);
    for _ in 0..2000 {
        let ray = Ray::new(rng.vec() * 3.0, rng.dir());
        assert!(shoot(&bvhs, &ray, 1).is_none_or(|h| h.instance == 4));
    }
    assert_eq!(shoot(&bvhs, &Ray::new(Vec3::ZERO, Vec3::X), 1).map(|h| h.instance), Some(4));
}

#[test]
fn the_build_does_not_depend_on_the_number_of_threads() {
    let mesh = Mesh::sphere(150, 0.2);
    let digest = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| mesh.blas().digest())
    };
    let one = digest(1);
    assert!([2, 3, 8].into_iter().all(|threads| digest(threads) == one));
    assert_ne!(one, Mesh::sphere(150, 0.21).blas().digest());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// Coordinates from a small lattice: shared planes, coincident triangles, rays in planes and
    /// through vertices, zeros of both signs.
    #[test]
    fn lattice_geometry_agrees_with_brute_force(
        corners in prop::collection::vec(prop::array::uniform9(-2_i8..=2), 1..40),
        rays in prop::collection::vec((prop::array::uniform3(-6_i8..=6), prop::array::uniform3(-2_i8..=2)), 1..20),
    ) {
        let mut mesh = Mesh::default();
        for c in &corners {
            let p = |k: usize| Vec3::new(f32::from(c[k]), f32::from(c[k + 1]), f32::from(c[k + 2]));
            mesh.push([p(0), p(3), p(6)]);
        }
        let bvhs = single(&mesh);
        for (o, d) in rays {
            let d = Vec3::from_array(d.map(|v| if v == 0 { -0.0 } else { f32::from(v) }));
            let ray = Ray::new(Vec3::from_array(o.map(|v| 0.5 * f32::from(v))), d);
            if d != Vec3::ZERO {
                check_against_brute_force(&mesh, &bvhs, &ray);
                check_lattice(&mesh, &bvhs, &ray);
            }
        }
    }
}

/// On a lattice all products of the triangle test are exact, so that the nearest hit is known to the
/// last edge, inclusive. (No weight lies between -1e-9 and 0.)
fn check_lattice(mesh: &Mesh, bvhs: &[Bvh], ray: &Ray) {
    let nearest = (0..mesh.triangles.len())
        .filter_map(|i| exact(mesh.corners(i), ray))
        // A ray that starts in a triangle's plane does not hit it.
        .filter(|e| e.t > 0.0 && e.weights.iter().all(|&w| w >= -1e-9))
        .map(|e| e.t)
        .fold(f64::INFINITY, f64::min);
    let hit = shoot(bvhs, ray, 1).map_or(f64::INFINITY, |h| f64::from(h.t));
    // Where the direction is no lattice vector after the shear, an edge may fall on either side.
    if ray.d.abs().max_element() != 0.0 && is_exact_shear(ray.d) {
        assert!(hit == nearest || (hit - nearest).abs() <= 1e-6 * nearest, "{hit} instead of {nearest} on {ray:?}");
    }
}

/// True where the components over the largest are exact in binary.
fn is_exact_shear(d: Vec3) -> bool {
    let largest = d.abs().max_element();
    largest.log2().fract() == 0.0
}
