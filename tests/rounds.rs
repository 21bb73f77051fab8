//! Round cones and balls in the acceleration structure, against an independent distance function in `f64`,
//! for every instruction set of this machine.

#[path = "support/shoot.rs"]
mod shoot;

use std::sync::Arc;

use penumbra::bvh::{Blas, Bvh, Hit, Instance, Isa};
use penumbra::math::{Affine3A, Ball, DVec3, Mat3A, Ray, RoundCone, Vec3, center_of, offset_ray_origin, place_point};
use shoot::shoot;

/// A small generator of numbers (PCG-XSH-RR of M. O'Neill).
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
}

/// Balls, and the segments between them: before, both ends, after.
#[derive(Clone, Default)]
struct Strands {
    balls: Vec<Ball>,
    segments: Vec<[u32; 4]>,
}

impl Strands {
    /// Adds a strand through `balls`.
    fn push(&mut self, balls: &[Ball]) {
        let (first, count) = (self.balls.len() as u32, balls.len() as u32);
        self.balls.extend_from_slice(balls);
        let at = |k: u32| first + k.min(count - 1);
        self.segments.extend((0..(count - 1).max(1)).map(|k| [at(k.saturating_sub(1)), at(k), at(k + 1), at(k + 2)]));
    }

    /// A strand that bends by less than its radius allows.
    fn wave(rng: &mut Rng, count: usize, radius: impl Fn(usize) -> f32) -> Self {
        let (start, across, side) = (rng.vec(), rng.dir(), rng.dir());
        let ball = |i: usize| {
            let t = i as f32 / count as f32;
            let p = start + across * 2.0 * t + side * 0.3 * (5.0 * t).sin();
            [p.x, p.y, p.z, radius(i)]
        };
        let mut strands = Self::default();
        strands.push(&(0..count).map(ball).collect::<Vec<_>>());
        strands
    }

    fn ends(&self, segment: u32) -> [Ball; 2] {
        let [_, first, last, _] = self.segments[segment as usize];
        [self.balls[first as usize], self.balls[last as usize]]
    }

    fn blas(&self) -> Arc<Blas> {
        Arc::new(Blas::rounds(&self.balls, Some(&self.segments)))
    }

    /// Distance of `p` from the surface, negative inside.
    fn distance(&self, p: DVec3) -> f64 {
        (0..self.segments.len() as u32).map(|i| distance(self.ends(i), p)).fold(f64::INFINITY, f64::min)
    }
}

/// Distance of `p` from a round cone: I. Quilez, *Distance functions*, sdRoundCone, in its own terms.
fn distance([a, b]: [Ball; 2], p: DVec3) -> f64 {
    let (pa, ba) = (p - center_of(a), center_of(b) - center_of(a));
    let (r1, r2) = (f64::from(a[3]), f64::from(b[3]));
    let l2 = ba.length_squared();
    let rr = r1 - r2;
    let a2 = l2 - rr * rr;
    if a2 <= 0.0 {
        return (pa.length() - r1).min((p - center_of(b)).length() - r2);
    }
    let il2 = 1.0 / l2;
    let y = pa.dot(ba);
    let z = y - l2;
    let x2 = (pa * l2 - ba * y).length_squared();
    let (y2, z2) = (y * y * l2, z * z * l2);
    let k = rr.signum() * rr * rr * x2;
    if z.signum() * a2 * z2 > k {
        (x2 + z2).sqrt() * il2 - r2
    } else if y.signum() * a2 * y2 < k {
        (x2 + y2).sqrt() * il2 - r1
    } else {
        ((x2 * a2 * il2).sqrt() + y * rr) * il2 - r1
    }
}

/// Where a ray that starts off the surface first meets it, by steps of the distance; NaN where it passes so
/// close that rounding decides.
fn reference(strands: &Strands, ray: &Ray) -> Option<f64> {
    let (o, d) = (DVec3::from(ray.o), DVec3::from(ray.d).normalize());
    let sign = strands.distance(o).signum();
    let (mut t, mut closest) = (0.0, f64::INFINITY);
    for _ in 0..20_000 {
        let distance = sign * strands.distance(o + d * t);
        if distance < 1e-10 {
            return Some(t / DVec3::from(ray.d).length());
        }
        closest = closest.min(distance);
        t += distance;
        if t > 20.0 {
            return (closest < 1e-6).then_some(f64::NAN);
        }
    }
    Some(f64::NAN)
}

fn identity(blas: Arc<Blas>) -> Vec<Bvh> {
    placed(blas, Affine3A::IDENTITY)
}

/// One structure for each instruction set.
fn placed(blas: Arc<Blas>, object_to_render: Affine3A) -> Vec<Bvh> {
    let instance = Instance { blas: 0, object_to_render, motion: None, mask: 1 };
    let build = || Bvh::build(vec![blas.clone()], vec![instance.clone()]);
    Isa::available().iter().map(|&isa| build().with_isa(isa).expect("available")).collect()
}

/// The point and the normal that `hit` stands for, relative to the origin of the balls.
fn point(strands: &Strands, hit: &Hit) -> (DVec3, DVec3) {
    let [a, b] = strands.ends(hit.primitive);
    let point = RoundCone::new(a, b).point([hit.u, hit.v]);
    (center_of(a) + point.p, point.normal)
}

/// Strands of every kind: even, tapered, pointed, of beads, with balls within balls and points that repeat.
fn every_kind(rng: &mut Rng) -> Vec<Strands> {
    let mut all = vec![
        Strands::wave(rng, 12, |_| 0.1),
        Strands::wave(rng, 9, |i| 0.2 - 0.02 * i as f32),
        Strands::wave(rng, 9, |i| 0.025 * (8 - i) as f32),
        Strands::wave(rng, 7, |i| if i % 2 == 0 { 0.05 } else { 0.2 }),
        Strands::wave(rng, 40, |_| 0.15),
        Strands::wave(rng, 1, |_| 0.5),
        Strands::wave(rng, 2, |i| [0.7, 0.1][i]),
    ];
    let mut odd = Strands::default();
    odd.push(&[[0.0, 0.0, 0.0, 0.6], [0.1, 0.1, 0.0, 0.3]]);
    odd.push(&[[-1.5, 0.0, 0.0, 0.2], [-1.5, 0.0, 0.0, 0.2]]);
    odd.push(&[[1.5, 0.0, 0.0, 0.0], [1.5, 1.0, 0.0, 0.3]]);
    odd.push(&[[0.0, 1.5, 0.0, 0.1], [0.3, 1.5, 0.0, 0.5], [0.4, 1.5, 0.0, 0.1]]);
    all.push(odd);
    all
}

#[test]
fn hits_are_those_of_the_distance_function() {
    let mut rng = Rng(1);
    for (kind, strands) in every_kind(&mut rng).into_iter().enumerate() {
        let bvhs = identity(strands.blas());
        let (mut hits, mut sure) = (0, 0);
        for i in 0..4000 {
            let target = strands.balls[i % strands.balls.len()];
            let target = center_of(target).as_vec3() + rng.vec() * (1.5 * target[3] + 0.05);
            let o = target + rng.dir() * (3.0 + rng.f());
            let ray = Ray::new(o, (target - o) * (1.0 + 0.5 * rng.f()));
            let hit = shoot(&bvhs, &ray);
            let expected = reference(&strands, &ray);
            if expected.is_some_and(f64::is_nan) {
                continue;
            }
            sure += 1;
            assert_eq!(hit.is_some(), expected.is_some(), "kind {kind}: {hit:?} {expected:?} {ray:?}");
            let (Some(hit), Some(t)) = (hit, expected) else { continue };
            hits += 1;
            assert!((f64::from(hit.t) - t).abs() < 1e-5, "kind {kind}: {hit:?} {t} {ray:?}");
            let (p, normal) = point(&strands, &hit);
            let at = DVec3::from(ray.o) + DVec3::from(ray.d) * f64::from(hit.t);
            // The coordinates of a point on a thin tip are coarse along it.
            assert!(p.distance(at) < 2e-5, "kind {kind}: {p} {at} {hit:?}");
            assert!(strands.distance(p).abs() < 1e-6, "kind {kind}: {}", strands.distance(p));
            let facing = normal.dot(DVec3::from(ray.d)) * strands.distance(ray.o.into());
            assert!(facing < 1e-3, "kind {kind}: the wrong side, {hit:?}");
        }
        assert!(hits > 1000 && sure > 3900, "kind {kind}: {hits} hits of {sure}");
    }
}

#[test]
fn from_inside_the_way_out_has_no_inner_walls() {
    let mut rng = Rng(2);
    for (kind, strands) in every_kind(&mut rng).into_iter().enumerate() {
        let bvhs = identity(strands.blas());
        let mut crossed = 0;
        for i in 0..4000 {
            let ball = strands.balls[i % strands.balls.len()];
            let o = center_of(ball).as_vec3() + rng.vec() * 0.5 * ball[3];
            if strands.distance(o.into()) > -1e-3 {
                continue;
            }
            let ray = Ray::new(o, rng.dir());
            let expected = reference(&strands, &ray).unwrap();
            let hit = shoot(&bvhs, &ray).unwrap_or_else(|| panic!("kind {kind}: no way out for {ray:?}"));
            // Where the ray touches a crease from inside the steps of the reference stop short.
            if expected.is_nan() {
                continue;
            }
            assert!((f64::from(hit.t) - expected).abs() < 1e-5, "kind {kind}: {hit:?} {expected} {ray:?}");
            let own = strands.segments[hit.primitive as usize];
            crossed += usize::from(own[1] as usize != i % strands.balls.len());
        }
        assert!(strands.segments.len() < 5 || crossed > 500, "kind {kind}: {crossed}");
    }
}

#[test]
fn thin_hairs_are_hit_as_wide_as_they_are_however_far() {
    let mut rng = Rng(3);
    for (distance, radius, shift) in
        [(1e3, 1e-5, 0.0), (10.0, 1e-6, 0.0), (1e3, 1e-4, 1e3), (50.0, 1e-3, 1e5), (2.0, 0.1, 1e6)]
    {
        let origin = Vec3::new(shift, -0.5 * shift, 0.25 * shift);
        let (a, b) = (origin + Vec3::new(-1.0, 0.2, 0.1), origin + Vec3::new(1.0, -0.3, 0.4));
        let mut hair = Strands::default();
        hair.push(&[[a.x, a.y, a.z, radius], [b.x, b.y, b.z, radius]]);
        let bvhs = identity(hair.blas());
        let axis = DVec3::from(b) - DVec3::from(a);
        let mut counts = [0; 2];
        for _ in 0..20_000 {
            let o = origin + Vec3::new(0.1 * rng.f(), rng.f(), 1.0).normalize() * distance;
            let target = a.lerp(b, 0.5 + 0.4 * rng.f());
            let ray = Ray::new(o, (target - o).normalize());
            // From line to line: their nearest points lie well within the segment.
            let (o, d) = (DVec3::from(ray.o), DVec3::from(ray.d));
            let n = axis.cross(d);
            let gap = ((o - DVec3::from(a)).dot(n) / n.length()).abs() / f64::from(radius);
            if (gap - 1.0).abs() < 1e-3 {
                continue;
            }
            let hit = shoot(&bvhs, &ray);
            assert_eq!(hit.is_some(), gap < 1.0, "{gap} radii off at {distance}: {ray:?}");
            counts[usize::from(hit.is_some())] += 1;
            if let Some(hit) = hit {
                // The normal is that of the very line, not of a point that has lost its digits.
                let (_, normal) = point(&hair, &hit);
                let sine = normal.dot(n.normalize()).abs();
                assert!((sine - gap).abs() < 1e-3, "{sine} instead of {gap}");
            }
        }
        assert!(counts[1] > 100, "{distance} {radius}: {counts:?}");
    }
}

#[test]
fn rays_leave_the_surface_that_they_start_on() {
    let mut rng = Rng(4);
    let turned = Mat3A::from_axis_angle(Vec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    let transforms = [
        Affine3A::IDENTITY,
        Affine3A::from_translation(Vec3::new(1000.0, -300.0, 20.0)),
        Affine3A::from_mat3_translation((turned * 1e-3).into(), Vec3::new(0.1, 0.2, 5.0)),
        Affine3A::from_mat3_translation((turned * 50.0).into(), Vec3::new(-7.0, 1.0, 0.0)),
        Affine3A::from_mat3_translation(
            (turned * Mat3A::from_diagonal(Vec3::new(1.0, 2.5, -0.5))).into(),
            Vec3::new(4.0, 0.0, 9.0),
        ),
    ];
    for ends in [
        [[0.0, 0.0, 0.0, 0.3], [1.0, 0.5, -0.2, 0.3]],
        [[0.0, 0.0, 0.0, 0.4], [1.0, 0.5, -0.2, 0.05]],
        [[0.2, 0.0, 0.0, 0.5], [0.2, 0.0, 0.0, 0.5]],
        [[0.0, 0.0, 0.0, 0.002], [1.0, 0.5, -0.2, 0.001]],
        [[0.0, 0.0, 0.0, 0.01], [0.01, 0.0, 0.0, 0.002]],
    ] {
        let mut strand = Strands::default();
        strand.push(&ends);
        for transform in transforms {
            let bvhs = placed(strand.blas(), transform);
            let normals = transform.matrix3.inverse().transpose();
            let surface = |hit: &Hit| {
                let (p, normal) = point(&strand, hit);
                let p = p.as_vec3();
                let (p, p_err) = place_point(&transform, p, p.abs() * penumbra::math::gamma(2));
                (p, p_err, Vec3::from(normals * penumbra::math::Vec3A::from(normal.as_vec3())).normalize())
            };
            // In render space; where rounding is as large as that, rays may pass the other wall.
            let thinnest = ends[0][3].min(ends[1][3]) * transform.matrix3.determinant().abs().cbrt();
            let mut seen = 0;
            for _ in 0..1500 {
                let target = center_of(ends[0]).lerp(center_of(ends[1]), 0.5 + 0.5 * f64::from(rng.f())).as_vec3();
                let (from, target) =
                    (transform.transform_point3(target + 3.0 * rng.dir()), transform.transform_point3(target));
                let Some(hit) = shoot(&bvhs, &Ray::new(from, target - from)) else { continue };
                let (p, p_err, ng) = surface(&hit);
                seen += 1;
                for _ in 0..4 {
                    let w = rng.dir();
                    let away = Ray::new(offset_ray_origin(p, p_err, ng, w), w);
                    let out = shoot(&bvhs, &away);
                    if w.dot(ng) > 0.0 {
                        assert_eq!(out, None, "hits the convex shape that it leaves: {ends:?} {away:?} {ng}");
                    } else if w.dot(ng) < -0.3 && (away.o - p).length() < 0.02 * thinnest {
                        let out = out.unwrap_or_else(|| panic!("no way out: {ends:?} {transform:?} {away:?} {ng}"));
                        let (p, p_err, ng) = surface(&out);
                        assert!(w.dot(ng) > -1e-3, "the way out is the way in: {out:?}");
                        let on = Ray::new(offset_ray_origin(p, p_err, ng, w), w);
                        assert!(w.dot(ng) < 1e-3 || shoot(&bvhs, &on).is_none(), "hits again behind: {out:?}");
                    }
                }
            }
            assert!(seen > 400, "{ends:?}: {seen}");
        }
    }
}

#[test]
fn what_has_no_size_or_no_place_neither_hits_nor_disturbs() {
    let mut rng = Rng(5);
    let clean = Strands::wave(&mut rng, 30, |_| 0.1);
    let mut dirty = clean.clone();
    for bad in [
        [f32::NAN, 0.0, 0.0, 1.0],
        [0.0, f32::INFINITY, 0.0, 1.0],
        [0.0, 0.0, 0.0, f32::NAN],
        [0.0, 0.0, 0.0, -1.0],
        [0.0, 0.0, 0.0, f32::INFINITY],
        [3e18, 0.0, 0.0, 1.0],
        [0.0, 0.0, 0.0, 0.0],
    ] {
        dirty.push(&[bad, bad]);
        if bad[3] != 0.0 {
            dirty.push(&[[0.0, 0.0, 0.0, 0.5], bad, [1.0, 0.0, 0.0, 0.5]]);
        }
    }
    assert_eq!(dirty.blas().len(), clean.segments.len());
    let (bvhs, reference) = (identity(dirty.blas()), identity(clean.blas()));
    for _ in 0..5000 {
        let ray = Ray::new(rng.vec() * 3.0, rng.dir());
        assert_eq!(shoot(&bvhs, &ray), shoot(&reference, &ray));
    }
    for empty in [Blas::rounds(&[], None), Blas::rounds(&[[0.0; 4]; 9], None)] {
        assert!(empty.is_empty() && empty.bounds().is_empty());
        let bvhs = identity(Arc::new(empty));
        assert_eq!(shoot(&bvhs, &Ray::new(Vec3::ZERO, Vec3::X)), None);
    }
}

#[test]
fn balls_alone_are_spheres_and_their_tree_is_the_same_on_any_number_of_threads() {
    let mut rng = Rng(6);
    let balls: Vec<Ball> = (0..5000)
        .map(|_| {
            let p = rng.vec();
            [p.x, p.y, p.z, 0.02 + 0.03 * rng.f().abs()]
        })
        .collect();
    let build = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Blas::rounds(&balls, None))
    };
    let digest = build(1).digest();
    assert!([2, 5].into_iter().all(|threads| build(threads).digest() == digest));
    let bvhs = identity(Arc::new(build(2)));
    let mut hits = 0;
    for _ in 0..2000 {
        let ray = Ray::new(rng.vec() * 1.2, rng.dir());
        let (o, d) = (DVec3::from(ray.o), DVec3::from(ray.d));
        let of_ball = |ball: &Ball| {
            let (m, r) = (o - center_of(*ball), f64::from(ball[3]));
            let (b, c) = (m.dot(d), m.length_squared() - r * r);
            let root = (b * b - d.length_squared() * c).sqrt();
            let roots = [(-b - root) / d.length_squared(), (-b + root) / d.length_squared()];
            roots.into_iter().find(|&t| t > 0.0)
        };
        let nearest = balls.iter().filter_map(of_ball).fold(f64::INFINITY, f64::min);
        let t = shoot(&bvhs, &ray).map_or(f64::INFINITY, |hit| f64::from(hit.t));
        assert!(t == nearest || (t - nearest).abs() < 1e-6, "{t} {nearest}");
        hits += usize::from(t.is_finite());
    }
    assert!(hits > 500);
}
