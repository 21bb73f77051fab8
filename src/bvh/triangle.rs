//! Watertight ray/triangle test, four triangles at once.
//!
//! In a space that is moved to the ray's origin and sheared so that the ray runs along z', the
//! three edge functions `U = C.x B.y - C.y B.x` and so on tell on which side of each edge the ray
//! passes. Both triangles at an edge compute the same two rounded products (no fused
//! multiply-add), so the rounded sign is either that of the exact determinant or 0, never wrong:
//! an inclusive test leaves no gap. Where a sign is 0, exact products in `f64` decide.
//!
//! Sven Woop, Carsten Benthin, Ingo Wald: *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013.

use super::node::{BLOCK, Block};
use super::ray::RaySetup;
use super::simd::Lanes;

/// Rounding of the distance of a point from the plane of a triangle, in units of a coordinate of a
/// vertex relative to the point: a subtraction, a cross and a dot product.
const PLANE_ROUNDING: f32 = 3.0 * f32::EPSILON;

/// The nearest hit so far. `primitive` is [`Best::NONE`] as long as there is none, and `t` the end
/// of the ray then.
#[derive(Clone, Copy)]
pub(super) struct Best {
    pub t: f32,
    pub u: f32,
    pub v: f32,
    pub instance: u32,
    pub primitive: u32,
}

impl Best {
    /// No primitive.
    pub const NONE: u32 = u32::MAX;

    /// No hit yet on a ray that ends at `t_max`.
    #[inline(always)]
    pub fn none(t_max: f32) -> Self {
        Self { t: t_max, u: 0.0, v: 0.0, instance: Self::NONE, primitive: Self::NONE }
    }

    /// Of hits at equal `t` the one with the lower instance, then primitive, is kept, whatever the
    /// order in which they were found.
    #[inline(always)]
    pub fn accepts(&self, t: f32, instance: u32, primitive: u32) -> bool {
        t < self.t
            || (t == self.t && self.primitive != Self::NONE && (instance, primitive) < (self.instance, self.primitive))
    }
}

/// What the vector code found out about a block.
struct Candidates<F> {
    /// Lanes that the ray passes through, from either side.
    inside: u32,
    t: F,
    u: F,
    v: F,
}

/// Lanes of `block` that the line of the ray hits, with `t` and the weights of the second and
/// third vertex; `None` where there is none.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn candidates<F: Lanes<BLOCK>>(block: &Block, ray: &RaySetup) -> Option<Candidates<F>> {
    unsafe {
        let [x, y, z] = ray.axes;
        let origin = ray.permuted_o.map(|v| F::splat(v));
        let shear = [F::splat(ray.shear[0]), F::splat(ray.shear[1])];
        let vertex = |k: usize| {
            let vertex = &block.vertices[k];
            [x, y, z].map(|axis| F::load(vertex.get_unchecked(axis)))
        };
        let from_origin = |v: [F; 3]| [v[0].sub(origin[0]), v[1].sub(origin[1]), v[2].sub(origin[2])];
        let sheared = |v: [F; 3]| [v[0].sub(shear[0].mul(v[2])), v[1].sub(shear[1].mul(v[2])), v[2]];
        let a = sheared(from_origin(vertex(0)));
        let b = sheared(from_origin(vertex(1)));
        let c = sheared(from_origin(vertex(2)));
        let u = c[0].mul(b[1]).sub(c[1].mul(b[0]));
        let v = a[0].mul(c[1]).sub(a[1].mul(c[0]));
        let w = b[0].mul(a[1]).sub(b[1].mul(a[0]));
        let zero = F::splat(0.0);
        let low = u.min(v).min(w);
        let high = u.max(v).max(w);
        let mut inside = zero.le(low) | high.le(zero);
        if inside == 0 {
            return None;
        }
        let unsure = inside & (low.eq(zero) | high.eq(zero));
        let det = u.add(v).add(w);
        let rcp = F::splat(1.0).div(det);
        let vertices = [vertex(0), vertex(1), vertex(2)];
        let (mut t, mut on_plane) = distance(vertices, origin, ray);
        if on_plane & inside != 0 {
            let (mut corners, mut times) = ([[[0.0; BLOCK]; 3]; 3], [0.0; BLOCK]);
            for (lanes, v) in corners.iter_mut().flatten().zip(vertices.iter().flatten()) {
                v.store(lanes);
            }
            t.store(&mut times);
            on_plane = begins_on(on_plane, inside, &corners, ray, &mut times);
            t = F::load(&times);
        }
        let mut found = Candidates { inside: 0, t, u: v.mul(rcp), v: w.mul(rcp) };
        inside &= !det.eq(zero);
        if unsure != 0 {
            let mut vertices = [[[0.0; BLOCK]; 3]; 3];
            for (lanes, vertex) in vertices.iter_mut().zip([a, b, c]) {
                lanes.iter_mut().zip(vertex).for_each(|(lanes, v)| v.store(lanes));
            }
            let (mut t, mut u, mut v) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
            found.t.store(&mut t);
            found.u.store(&mut u);
            found.v.store(&mut v);
            inside = exact(unsure, inside, &vertices, ray.shear[2], [&mut t, &mut u, &mut v]);
            (found.t, found.u, found.v) = (F::load(&t), F::load(&u), F::load(&v));
        }
        found.inside = inside & !on_plane;
        Some(found)
    }
}

/// Where the line of the ray meets the planes of the triangles, and the lanes whose plane holds the
/// ray's origin to within rounding.
///
/// By the plane and not by blending the vertices' depths with `U`, `V`, `W`: in a long triangle
/// those cancel, and `t` would be off by thousandths of its length. Rays that start on a surface do
/// not hit it, nor one that coincides with it, whatever their direction.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn distance<F: Lanes<BLOCK>>(vertices: [[F; 3]; 3], origin: [F; 3], ray: &RaySetup) -> (F, u32) {
    unsafe {
        let [a, b, c] = vertices;
        let e = [b[0].sub(a[0]), b[1].sub(a[1]), b[2].sub(a[2])];
        let f = [c[0].sub(a[0]), c[1].sub(a[1]), c[2].sub(a[2])];
        let n = [
            e[1].mul(f[2]).sub(e[2].mul(f[1])),
            e[2].mul(f[0]).sub(e[0].mul(f[2])),
            e[0].mul(f[1]).sub(e[1].mul(f[0])),
        ];
        let abs = |v: F| v.max(F::splat(0.0).sub(v));
        let a = [a[0].sub(origin[0]), a[1].sub(origin[1]), a[2].sub(origin[2])];
        let height = a[0].mul(n[0]).add(a[1].mul(n[1])).add(a[2].mul(n[2]));
        let slope = n[0].mul(F::splat(ray.shear[0])).add(n[1].mul(F::splat(ray.shear[1]))).add(n[2]);
        let t = height.div(slope).mul(F::splat(ray.shear[2]));
        let reach = abs(a[0]).max(abs(a[1])).max(abs(a[2]));
        let size = abs(n[0]).add(abs(n[1])).add(abs(n[2]));
        let limit = reach.mul(size).mul(F::splat(PLANE_ROUNDING));
        // A triangle so small that its normal underflows is no plane to start on.
        (t, abs(height).le(limit) & !size.eq(F::splat(0.0)))
    }
}

/// Which of the lanes of `near`, whose planes seem to hold the ray's origin, are triangles that the ray begins on; of
/// those among `inside` that lie ahead of it `t` is made one of theirs.
///
/// [`distance`] goes by the largest coordinate, which is far too much for a wall along the axes, kilometres wide, that
/// begins a hair aside: there no product is large that does not cancel exactly. And a triangle that is seen along its
/// plane is ahead: the ray passes it by the signs of its edges and would leak without it, though where is all but
/// undefined.
#[cold]
#[inline(never)]
fn begins_on(near: u32, inside: u32, corners: &[[[f32; BLOCK]; 3]; 3], ray: &RaySetup, t: &mut [f32; BLOCK]) -> u32 {
    let o = ray.permuted_o.map(f64::from);
    let mut on = near & !inside;
    for i in (0..BLOCK).filter(|i| (near & inside) >> i & 1 != 0) {
        let [a, b, c] = corners.map(|corner| [0, 1, 2].map(|k| f64::from(corner[k][i])));
        let sub = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
        let (e, f, a) = (sub(b, a), sub(c, a), sub(a, o));
        let (mut height, mut rounding, mut reach) = (0.0, 0.0, 0.0_f64);
        for k in 0..3 {
            let (p, q) = (e[(k + 1) % 3] * f[(k + 2) % 3], e[(k + 2) % 3] * f[(k + 1) % 3]);
            height += a[k] * (p - q);
            rounding += (a[k].abs() + o[k].abs()) * (p.abs() + q.abs());
            reach = reach.max(a[k].abs());
        }
        if height.abs() > f64::from(PLANE_ROUNDING) * rounding {
            continue;
        }
        let per_t = f64::from(ray.shear[2]);
        let depths = [a[2], b[2] - o[2], c[2] - o[2]].map(|depth| depth * per_t);
        let (first, last) = (depths[0].min(depths[1]).min(depths[2]), depths[0].max(depths[1]).max(depths[2]));
        if first > f64::from(PLANE_ROUNDING) * reach * per_t.abs() {
            // NaN becomes the first.
            t[i] = t[i].max(first as f32).min(last as f32);
        } else {
            on |= 1 << i;
        }
    }
    on
}

/// Decides the lanes of `unsure` by exact products and returns the new `inside`.
#[cold]
#[inline(never)]
fn exact(
    unsure: u32,
    inside: u32,
    vertices: &[[[f32; BLOCK]; 3]; 3],
    shear_z: f32,
    [t, u, v]: [&mut [f32; BLOCK]; 3],
) -> u32 {
    let mut inside = inside & !unsure;
    for i in (0..BLOCK).filter(|i| unsure >> i & 1 != 0) {
        if let Some(hit) = exact_lane(vertices.map(|vertex| vertex.map(|axis| axis[i])), shear_z) {
            [t[i], u[i], v[i]] = hit;
            inside |= 1 << i;
        }
    }
    inside
}

/// The test of one triangle with edge functions in `f64`, where products of `f32` are exact.
fn exact_lane(vertices: [[f32; 3]; 3], shear_z: f32) -> Option<[f32; 3]> {
    let [a, b, c] = vertices.map(|vertex| vertex.map(f64::from));
    let u = c[0] * b[1] - c[1] * b[0];
    let v = a[0] * c[1] - a[1] * c[0];
    let w = b[0] * a[1] - b[1] * a[0];
    let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    let det = u + v + w;
    (inside && det != 0.0).then(|| {
        let depth = (u * a[2] + v * b[2] + w * c[2]) / det * f64::from(shear_z);
        [depth as f32, (v / det) as f32, (w / det) as f32]
    })
}

/// Updates `best` with the triangles of `block`.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
pub(super) unsafe fn closest<F: Lanes<BLOCK>>(block: &Block, ray: &RaySetup, instance: u32, best: &mut Best) {
    unsafe {
        let Some(found) = candidates::<F>(block, ray) else { return };
        let mut hits = found.inside & F::splat(0.0).le(found.t) & found.t.le(F::splat(best.t));
        if hits == 0 {
            return;
        }
        let (mut t, mut u, mut v) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        found.t.store(&mut t);
        found.u.store(&mut u);
        found.v.store(&mut v);
        while hits != 0 {
            let i = hits.trailing_zeros() as usize & (BLOCK - 1);
            hits &= hits - 1;
            let primitive = block.triangles[i];
            if best.accepts(t[i], instance, primitive) {
                *best = Best { t: t[i], u: u[i], v: v[i], instance, primitive };
            }
        }
    }
}

/// True where a triangle of `block` is hit before `t_max`.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
pub(super) unsafe fn any<F: Lanes<BLOCK>>(block: &Block, ray: &RaySetup, t_max: f32) -> bool {
    unsafe {
        candidates::<F>(block, ray)
            .is_some_and(|found| found.inside & F::splat(0.0).le(found.t) & !F::splat(t_max).le(found.t) != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::simd::{Scalar, Simd};
    use super::*;

    fn block(triangle: [[f32; 3]; 3]) -> Block {
        let mut block = Block::EMPTY;
        for (vertex, p) in block.vertices.iter_mut().zip(triangle) {
            for (lanes, v) in vertex.iter_mut().zip(p) {
                lanes[2] = v;
            }
        }
        block.triangles[2] = 9;
        block
    }

    fn shoot(triangle: [[f32; 3]; 3], o: [f32; 3], d: [f32; 3], t_max: f32) -> Best {
        let mut best = Best::none(t_max);
        let (block, ray) = (block(triangle), RaySetup::new(o, d));
        // SAFETY: the scalar twin needs nothing.
        unsafe { closest::<<Scalar as Simd>::F4>(&block, &ray, 4, &mut best) };
        // SAFETY: as above.
        assert_eq!(best.primitive != Best::NONE, unsafe { any::<<Scalar as Simd>::F4>(&block, &ray, t_max) });
        best
    }

    const T: [[f32; 3]; 3] = [[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 2.0]];

    #[test]
    fn returns_distance_and_weights_of_the_second_and_third_vertex() {
        let hit = shoot(T, [0.25, 0.5, 0.0], [0.0, 0.0, 2.0], f32::INFINITY);
        assert_eq!((hit.t, hit.u, hit.v, hit.instance, hit.primitive), (1.0, 0.25, 0.5, 4, 9));
        let from_behind = shoot(T, [0.25, 0.5, 4.0], [0.0, 0.0, -1.0], f32::INFINITY);
        assert_eq!((from_behind.t, from_behind.u, from_behind.v), (2.0, 0.25, 0.5));
    }

    #[test]
    fn respects_the_segment() {
        for (t_max, hits) in [(1.0, false), (1.0_f32.next_up(), true), (0.5, false)] {
            assert_eq!(shoot(T, [0.25, 0.5, 0.0], [0.0, 0.0, 2.0], t_max).primitive != Best::NONE, hits);
        }
        assert_eq!(shoot(T, [0.25, 0.5, 3.0], [0.0, 0.0, 1.0], f32::INFINITY).primitive, Best::NONE);
        let near = shoot(T, [0.25, 0.5, 2.0 - 1e-5], [0.0, 0.0, 1.0], f32::INFINITY);
        assert_eq!((near.primitive, near.t), (9, 2.0 - (2.0_f32 - 1e-5)));
    }

    #[test]
    fn a_ray_that_starts_in_the_plane_leaves_it() {
        for d in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 1e-6], [-0.3, 0.9, -1e-3]] {
            assert_eq!(shoot(T, [0.25, 0.5, 2.0], d, f32::INFINITY).primitive, Best::NONE);
        }
    }

    #[test]
    fn vertices_edges_and_tiny_triangles_are_hit() {
        for [x, y] in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5], [0.5, 0.0], [0.0, 0.25]] {
            assert_eq!(shoot(T, [x, y, 0.0], [0.0, 0.0, 1.0], f32::INFINITY).primitive, 9);
        }
        // Products of these underflow in f32.
        let tiny = T.map(|p| [p[0] * 1e-30, p[1] * 1e-30, p[2]]);
        let hit = shoot(tiny, [0.25e-30, 0.5e-30, 0.0], [0.0, 0.0, 1.0], f32::INFINITY);
        assert!(hit.primitive == 9 && (hit.u - 0.25).abs() < 1e-5 && (hit.v - 0.5).abs() < 1e-5);
        assert_eq!(shoot(tiny, [1e-30, 1e-30, 0.0], [0.0, 0.0, 1.0], f32::INFINITY).primitive, Best::NONE);
    }

    #[test]
    fn degenerate_triangles_and_edge_on_rays_miss() {
        for t in [[T[0]; 3], [T[0], T[1], T[1]], [[f32::NAN; 3], T[1], T[2]], [[f32::INFINITY; 3], T[1], T[2]]] {
            assert_eq!(shoot(t, [0.25, 0.0, 0.0], [0.0, 0.0, 1.0], f32::INFINITY).primitive, Best::NONE);
        }
        assert_eq!(shoot(T, [-1.0, 0.25, 2.0], [1.0, 0.0, 0.0], f32::INFINITY).primitive, Best::NONE);
    }
}
