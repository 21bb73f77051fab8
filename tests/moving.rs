//! What moves in the acceleration structure: at every time it is hit as if it stood where it is then, bit for bit,
//! by every instruction set. That what stands still is hit rightly is held by `bvh.rs` and `rounds.rs`.

#[path = "support/rng.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod rng;
#[path = "support/shoot.rs"]
mod shoot;

use std::sync::Arc;

use penumbra::bvh::{Blas, Bvh, Instance, Isa};
use penumbra::math::{Affine3A, Ball, DAffine3, DMat3, DQuat, DVec3, MovingTransform, Ray, Times, Vec3, traced};
use rng::Rng;
use shoot::shoot;

/// Triangles, or segments between balls.
#[derive(Clone)]
enum Shape {
    Mesh(Vec<Vec<Vec3>>, Vec<[u32; 3]>),
    Rounds(Vec<Vec<Ball>>, Option<Vec<[u32; 4]>>),
}

impl Shape {
    /// The shape whose keys stand at `times`.
    fn moving(&self, times: &Times) -> Arc<Blas> {
        Arc::new(match self {
            Self::Mesh(keys, triangles) => Blas::moving(times.clone(), keys, triangles),
            Self::Rounds(keys, segments) => Blas::moving_rounds(times.clone(), keys, segments.as_deref()),
        })
    }

    /// The shape as it is at `time`.
    fn still(&self, times: &Times, time: f32) -> Arc<Blas> {
        let (i, share) = times.at(time);
        Arc::new(match self {
            Self::Mesh(keys, triangles) => {
                let points: Vec<_> = keys[i].iter().zip(&keys[i + 1]).map(|(&a, &b)| a + (b - a) * share).collect();
                Blas::build(&points, triangles)
            }
            Self::Rounds(keys, segments) => {
                let lerp = |(a, b): (&Ball, &Ball)| std::array::from_fn(|k| a[k] + (b[k] - a[k]) * share);
                let balls: Vec<Ball> = keys[i].iter().zip(&keys[i + 1]).map(lerp).collect();
                Blas::rounds(&balls, segments.as_deref())
            }
        })
    }
}

/// In [-1, 1).
fn number(rng: &mut Rng) -> f32 {
    (rng.next() >> 40) as f32 / (1 << 23) as f32 - 1.0
}

fn vector(rng: &mut Rng) -> Vec3 {
    Vec3::new(number(rng), number(rng), number(rng))
}

fn direction(rng: &mut Rng) -> Vec3 {
    loop {
        let v = vector(rng);
        if (0.01..1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

fn soup(rng: &mut Rng, count: usize, keys: usize) -> Shape {
    let mut points = vec![Vec::new(); keys];
    for _ in 0..count {
        let (center, across) = (vector(rng), [vector(rng), vector(rng), vector(rng)]);
        let going = vector(rng) * 1.5;
        for (key, points) in points.iter_mut().enumerate() {
            points.extend(across.map(|v| center + going * key as f32 + v * 0.3 + vector(rng) * 0.1));
        }
    }
    Shape::Mesh(points, (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// A closed sphere that bulges, shrinks and turns.
fn sphere(n: u32) -> Shape {
    let point = |i: u32, j: u32, key: u32| {
        let (theta, phi) = (i as f32 / n as f32, (j as f32 + 1.5 * key as f32) / n as f32);
        let (theta, phi) = (theta * std::f32::consts::PI, phi * std::f32::consts::PI);
        let r = 1.0 + 0.2 * key as f32 * (3.0 * theta).sin() * (2.0 * phi).sin();
        Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()) * r
    };
    let at = |i: u32, j: u32| match i {
        0 => 0,
        i if i == n => 1,
        i => 2 + (i - 1) * 2 * n + j % (2 * n),
    };
    let key = |key: u32| {
        let mut points = vec![point(0, 0, key), point(n, 0, key)];
        points.extend((1..n).flat_map(|i| (0..2 * n).map(move |j| (i, j))).map(|(i, j)| point(i, j, key)));
        points
    };
    let patches = (0..n).flat_map(|i| (0..2 * n).map(move |j| (i, j)));
    let triangles = patches.flat_map(|(i, j)| {
        let upper = (i > 0).then(|| [at(i, j), at(i + 1, j), at(i, j + 1)]);
        let lower = (i + 1 < n).then(|| [at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)]);
        upper.into_iter().chain(lower)
    });
    Shape::Mesh((0..3).map(key).collect(), triangles.collect())
}

/// Strands that sway, or balls that fly apart.
fn rounds(rng: &mut Rng, strands: bool, keys: usize) -> Shape {
    let mut balls = vec![Vec::new(); keys];
    let mut segments = Vec::new();
    for strand in 0..12_u32 {
        let (start, along, sway) = (vector(rng), vector(rng) * 0.3, vector(rng) * 0.4);
        for k in 0..5_u32 {
            let radius = 0.02 + 0.03 * number(rng).abs();
            for (key, balls) in balls.iter_mut().enumerate() {
                let p = start + along * k as f32 + sway * (key as u32 * k) as f32 * 0.3 + sway * key as f32;
                balls.push([p.x, p.y, p.z, radius]);
            }
        }
        let at = |k: u32| 5 * strand + k.min(4);
        segments.extend((0..4).map(|k: u32| [at(k.saturating_sub(1)), at(k), at(k + 1), at(k + 2)]));
    }
    Shape::Rounds(balls, strands.then_some(segments))
}

/// One structure for each instruction set.
fn placed(blases: &[Arc<Blas>], instances: &[Instance]) -> Vec<Bvh> {
    let build = || Bvh::build(blases.to_vec(), instances.to_vec());
    Isa::available().iter().map(|&isa| build().with_isa(isa).expect("available")).collect()
}

fn instance(blas: u32, object_to_render: Affine3A, motion: Option<Arc<MovingTransform>>) -> Instance {
    Instance { blas, object_to_render, motion, mask: 1 }
}

/// Times in and around the shutter.
fn moments(rng: &mut Rng, count: usize) -> Vec<f32> {
    let within = (0..count).map(|_| 0.5 + 0.5 * number(rng));
    [0.0, 1.0, 0.5, f32::EPSILON, 1.0_f32.next_down(), -0.5, 1.5].into_iter().chain(within).collect()
}

/// Shoots at both at `time`, from near and far; how often something was hit.
fn compare(rng: &mut Rng, moving: &[Bvh], still: &[Bvh], time: f32, rays: usize) -> usize {
    let bounds = still[0].bounds();
    let mut hits = 0;
    for _ in 0..rays {
        let target = bounds.center() + 0.5 * bounds.extent() * vector(rng);
        let o = bounds.center() + bounds.extent() * vector(rng) * 1.5;
        let mut ray = Ray { time, ..Ray::new(o, target - o) };
        if rng.below(3) == 0 {
            ray.t_max = number(rng).abs() * 2.0;
        }
        let hit = shoot(moving, &ray);
        assert_eq!(hit, shoot(still, &ray), "at {time}: {ray:?}");
        hits += usize::from(hit.is_some());
    }
    hits
}

fn times(rng: &mut Rng, keys: usize) -> Times {
    let mut times: Vec<f32> = (0..keys).map(|k| (k as f32 + 0.3 * number(rng)) / (keys - 1) as f32).collect();
    (times[0], times[keys - 1]) = (0.0, 1.0);
    Times::new(times).unwrap()
}

#[test]
fn shapes_that_deform_are_hit_where_they_are() {
    let mut rng = Rng(0x1234_5678);
    for keys in [2, 3, 5] {
        let times = times(&mut rng, keys);
        let mut shapes = vec![rounds(&mut rng, true, keys), rounds(&mut rng, false, keys)];
        shapes.extend([1, 3, 9, 200].map(|count| soup(&mut rng, count, keys)));
        for (kind, shape) in shapes.iter().enumerate() {
            let moving = placed(&[shape.moving(&times)], &[instance(0, Affine3A::IDENTITY, None)]);
            let mut hits = 0;
            for time in moments(&mut rng, 12) {
                let still = placed(&[shape.still(&times, time)], &[instance(0, Affine3A::IDENTITY, None)]);
                hits += compare(&mut rng, &moving, &still, time, 400);
            }
            assert!(hits > 60, "{keys} keys, kind {kind}: {hits} hits");
        }
    }
}

#[test]
fn nothing_escapes_from_a_closed_mesh_that_deforms() {
    let mut rng = Rng(77);
    let shape = sphere(24);
    let times = Times::new(vec![0.0, 0.4, 1.0]).unwrap();
    let bvhs = placed(&[shape.moving(&times)], &[instance(0, Affine3A::IDENTITY, None)]);
    let Shape::Mesh(keys, triangles) = &shape else { panic!("a mesh") };
    for i in 0..30_000 {
        let time = 0.5 + 0.5 * number(&mut rng);
        let (key, share) = times.at(time);
        let at = |i: u32| keys[key][i as usize] + (keys[key + 1][i as usize] - keys[key][i as usize]) * share;
        let [a, b, _] = triangles[i % triangles.len()];
        // Vertices and edges, and anywhere.
        let target = match i % 3 {
            0 => at(a),
            1 => at(a).lerp(at(b), 0.5),
            _ => direction(&mut rng),
        };
        let o = vector(&mut rng) * 0.1;
        let ray = Ray { time, ..Ray::new(o, target - o) };
        assert!(shoot(&bvhs, &ray).is_some(), "escaped at {time}: {ray:?}");
    }
}

/// Motions of every kind: along, around, mirrored, sheared, growing, far from the origin.
fn motions(rng: &mut Rng) -> Vec<MovingTransform> {
    let mut list = Vec::new();
    for k in 0..14 {
        let count = 2 + k % 3;
        let axis = direction(rng).as_dvec3();
        let far = if k % 5 == 4 { 1e4 } else { 0.0 };
        let keys = (0..count).map(|i| {
            let turn = if k % 2 == 0 { 0.0 } else { 1.9 * i as f64 };
            let scale = if k % 4 < 2 { 1.0 } else { 0.3 + 0.7 * i as f64 };
            let mut m = DMat3::from_quat(DQuat::from_axis_angle(axis, turn)) * scale;
            match k % 7 {
                3 => m.x_axis = -m.x_axis,
                5 => m.y_axis += m.z_axis * 1.5,
                _ => {}
            }
            let translation = vector(rng).as_dvec3() * 2.0 + far;
            (i as f32 / (count - 1) as f32, DAffine3 { matrix3: m, translation })
        });
        let keys: Vec<_> = keys.collect();
        let center = if k % 3 == 1 { vector(rng).as_dvec3() } else { DVec3::ZERO };
        list.push(MovingTransform::new(&keys).unwrap().rebased(center, DVec3::splat(0.9 * far)));
    }
    list
}

#[test]
fn instances_that_move_are_hit_where_they_are() {
    let mut rng = Rng(0xabcdef);
    let still_times = Times::new(vec![0.0, 1.0]).unwrap();
    let shapes = [soup(&mut rng, 60, 2), rounds(&mut rng, true, 2), sphere(6)];
    for (k, motion) in motions(&mut rng).into_iter().enumerate() {
        let (shape, motion) = (&shapes[k % 3], Arc::new(motion));
        // Of every other the shape deforms, too.
        let deforms = k % 2 == 1;
        let times = if k % 3 == 2 { Times::new(vec![0.0, 0.5, 1.0]).unwrap() } else { still_times.clone() };
        let blas = if deforms { shape.moving(&times) } else { shape.still(&times, 0.3) };
        let at_frame = traced(&motion.at(0.5));
        let moving = placed(std::slice::from_ref(&blas), &[instance(0, at_frame, Some(motion.clone()))]);
        let mut hits = 0;
        for time in moments(&mut rng, 10) {
            let blas = if deforms { shape.still(&times, time) } else { blas.clone() };
            let still = placed(&[blas], &[instance(0, traced(&motion.at(time)), None)]);
            hits += compare(&mut rng, &moving, &still, time, 150);
        }
        assert!(hits > 100, "{k}: {hits} hits");
    }
}

#[test]
fn among_many_each_stands_where_it_is() {
    let mut rng = Rng(0x5eed);
    let times = Times::new(vec![0.0, 1.0]).unwrap();
    let shapes = [soup(&mut rng, 20, 2), rounds(&mut rng, true, 2), rounds(&mut rng, false, 2)];
    // Each shape as it moves, then as it stands at the opening.
    let moving: Vec<_> =
        shapes.iter().map(|s| s.moving(&times)).chain(shapes.iter().map(|s| s.still(&times, 0.0))).collect();
    let mut instances = Vec::new();
    // But for those that are far away.
    let list: Vec<_> = motions(&mut rng).into_iter().enumerate().filter(|(k, _)| k % 5 != 4).map(|(_, m)| m).collect();
    for (k, motion) in list.into_iter().cycle().take(120).enumerate() {
        let offset = DVec3::from(vector(&mut rng)) * 2.0;
        let motion = motion.rebased(DVec3::ZERO, offset);
        let at_frame = traced(&motion.at(0.5));
        instances.push(instance((k % 6) as u32, at_frame, (k % 4 > 0).then(|| Arc::new(motion))));
    }
    let all = placed(&moving, &instances);
    for time in moments(&mut rng, 4) {
        let blases: Vec<_> =
            [time, 0.0].iter().flat_map(|&at| shapes.iter().map(|s| s.still(&times, at)).collect::<Vec<_>>()).collect();
        let stand = |i: &Instance| {
            instance(i.blas, i.motion.as_ref().map_or(i.object_to_render, |m| traced(&m.at(time))), None)
        };
        let still = placed(&blases, &instances.iter().map(stand).collect::<Vec<_>>());
        assert!(compare(&mut rng, &all, &still, time, 400) > 100);
    }
}

#[test]
fn the_build_does_not_depend_on_the_number_of_threads() {
    let mut rng = Rng(9);
    for shape in [soup(&mut rng, 20_000, 3), rounds(&mut rng, true, 3)] {
        let times = Times::new(vec![0.0, 0.5, 1.0]).unwrap();
        let digest = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| shape.moving(&times).digest())
        };
        assert_eq!(digest(1), digest(2));
        let blas = shape.moving(&times);
        assert!(blas.bytes() > 1000 && !blas.is_empty() && !blas.bounds().is_empty());
    }
}

#[test]
fn points_that_are_nowhere_at_a_key_are_hit_between_the_others() {
    let here = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let lost = vec![Vec3::NAN, Vec3::X, Vec3::Y];
    let flat = vec![Vec3::ZERO; 3];
    let shape = Shape::Mesh(vec![flat, here.clone(), here, lost], vec![[0, 1, 2]]);
    let times = Times::new(vec![0.0, 0.25, 0.75, 1.0]).unwrap();
    let bvhs = placed(&[shape.moving(&times)], &[instance(0, Affine3A::IDENTITY, None)]);
    let at = |time: f32| shoot(&bvhs, &Ray { time, ..Ray::new(Vec3::new(0.1, 0.1, 1.0), Vec3::NEG_Z) }).is_some();
    assert_eq!([0.0, 0.2, 0.25, 0.5, 0.74, 0.8, 1.0].map(at), [false, true, true, true, true, false, false]);
}
