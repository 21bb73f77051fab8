//! Round cones and balls as leaf items, four at once.
//!
//! Vector code leaves out those that the ray passes at a distance: across the ray, a segment is a line
//! between two points, and the ray a point. What remains, mostly hits, is decided in `f64`
//! (`crossing.rs`), by plain code that is the same for all instruction sets. Segments that follow each
//! other on a strand make one surface: a hit within a neighbour is none.

mod crossing;

use bytemuck::Zeroable;

use super::blas::LARGEST;
use super::node::BLOCK;
use super::simd::Lanes;
use super::triangle::Best;
use crate::math::{Ball, Bounds, DVec3, RoundCone, Vec3, orthonormal_pair};
use crossing::{Line, Segment};

/// Rounding of a segment's place across the ray, in units of its largest coordinate from the origin.
const SLACK: f32 = 16.0 * f32::EPSILON;

/// Up to four round cones, side by side. Unused lanes hold NaN, which no ray hits.
#[derive(Clone, Copy, Zeroable)]
#[repr(C, align(32))]
pub(super) struct RoundBlock {
    /// `balls[k][component][lane]`: centre, then radius, of both ends.
    pub balls: [[[f32; BLOCK]; 4]; 2],
    /// Index of each segment in the list that the caller gave.
    pub segments: [u32; BLOCK],
}

const _: () = assert!(size_of::<RoundBlock>() == 160);

impl RoundBlock {
    /// A block of segments with their ends, [`BLOCK`] of them at most.
    pub fn of(segments: impl Iterator<Item = (u32, [Ball; 2])>) -> Self {
        let mut block = Self { balls: [[[f32::NAN; BLOCK]; 4]; 2], segments: [u32::MAX; BLOCK] };
        for (lane, (index, ends)) in segments.enumerate() {
            for (ball, end) in block.balls.iter_mut().zip(ends) {
                ball.iter_mut().zip(end).for_each(|(lanes, v)| lanes[lane] = v);
            }
            block.segments[lane] = index;
        }
        block
    }

    fn ends(&self, lane: usize) -> [Ball; 2] {
        self.balls.map(|ball| ball.map(|component| component[lane]))
    }
}

/// The balls before and after each segment on its strand, of NaN where there are none.
pub(super) type Beyond = [Ball; 2];

/// No ball.
pub(super) const NONE: Ball = [f32::NAN; 4];

/// What continues a segment, given as balls before, at both ends and after.
pub(super) fn beyond(balls: &[Ball], [before, first, last, after]: [u32; 4]) -> Beyond {
    let ball = |i: u32, end: u32| if i == end { NONE } else { balls[i as usize] };
    [ball(before, first), ball(after, last)]
}

/// The box of the round cone between two balls; `None` for one that can't be hit. (Several boxes for one that
/// lies askew, up to eight where each halving leaves 0.5 to 0.7 of the area, took 1.6 to 6 times the memory for
/// 20,000 hairs and were slower but for hairs of a single piece.)
pub(super) fn bounds(ends: [Ball; 2]) -> Option<Bounds> {
    let in_range = |ball: Ball| ball.iter().all(|v| v.abs() <= LARGEST) && ball[3] >= 0.0;
    if !(ends.into_iter().all(in_range) && ends[0][3].max(ends[1][3]) > 0.0) {
        return None;
    }
    let [first, last] = ends.map(|[x, y, z, radius]| (Vec3::new(x, y, z), radius));
    let min = (first.0 - first.1).min(last.0 - last.1);
    let max = (first.0 + first.1).max(last.0 + last.1);
    // For the rounding of these sums.
    let margin = f32::EPSILON * min.abs().max(max.abs());
    Some(Bounds { min: min - margin, max: max + margin })
}

/// A ray in the space of the balls, as it is handed over.
pub(super) struct RoundStart {
    pub o: [f32; 3],
    pub d: [f32; 3],
    /// How far rounding may have moved the origin.
    pub o_err: f32,
}

/// What the tests of round cones keep of a ray.
pub(super) struct RoundRay {
    o: [f32; 3],
    /// Two unit vectors across the ray.
    across: [[f32; 3]; 2],
    line: Line,
}

impl RoundRay {
    /// The constants of `ray`.
    pub fn new(ray: &RoundStart) -> Self {
        let line = Line::new(ray.o, ray.d, ray.o_err);
        let (s, t) = orthonormal_pair(line.d.normalize_or(DVec3::Z));
        Self { o: ray.o, across: [s, t].map(|v| v.as_vec3().to_array()), line }
    }
}

/// Lanes of `block` that the ray passes near enough to hit.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn near<F: Lanes<BLOCK>>(block: &RoundBlock, ray: &RoundRay) -> u32 {
    unsafe {
        let zero = F::splat(0.0);
        let abs = |v: F| v.max(zero.sub(v));
        let load = |ball: usize, component: usize| F::load(&block.balls[ball][component]);
        let from_origin = |ball: usize| [0, 1, 2].map(|k| load(ball, k).sub(F::splat(ray.o[k])));
        let (a, b) = (from_origin(0), from_origin(1));
        let dot = |v: [F; 3], w: &[f32; 3]| {
            v[0].mul(F::splat(w[0])).add(v[1].mul(F::splat(w[1]))).add(v[2].mul(F::splat(w[2])))
        };
        let [ax, ay] = [dot(a, &ray.across[0]), dot(a, &ray.across[1])];
        let [bx, by] = [dot(b, &ray.across[0]), dot(b, &ray.across[1])];
        let largest = |v: [F; 3]| abs(v[0]).max(abs(v[1])).max(abs(v[2]));
        let slack = largest(a).max(largest(b)).mul(F::splat(SLACK));
        let reach = load(0, 3).max(load(1, 3)).add(slack);
        // No more than an eighth above the length, without squares that could underflow.
        let (ex, ey) = (abs(bx.sub(ax)), abs(by.sub(ay)));
        let length = ex.max(ey).add(ex.min(ey).mul(F::splat(0.5)));
        let area = abs(ax.mul(by).sub(ay.mul(bx)));
        let of_line = area.le(reach.mul(length.add(slack)).add(F::splat(f32::MIN_POSITIVE)));
        let of_box = |a: F, b: F| a.min(b).le(reach) & zero.sub(reach).le(a.max(b));
        of_line & of_box(ax, bx) & of_box(ay, by)
    }
}

/// Calls `visit` with the lane and segment of each that the ray may hit, until that says to stop.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn each<F: Lanes<BLOCK>>(
    block: &RoundBlock,
    beyond: impl Fn(u32) -> Beyond,
    ray: &RoundRay,
    mut visit: impl FnMut(u32, &Segment) -> bool,
) {
    let mut lanes = unsafe { near::<F>(block, ray) };
    while lanes != 0 {
        let i = lanes.trailing_zeros() as usize & (BLOCK - 1);
        lanes &= lanes - 1;
        let index = block.segments[i];
        if visit(index, &Segment { ends: block.ends(i), beyond: beyond(index) }) {
            return;
        }
    }
}

/// Updates `best` with the round cones of `block`.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
pub(super) unsafe fn closest<F: Lanes<BLOCK>>(
    block: &RoundBlock,
    beyond: impl Fn(u32) -> Beyond,
    ray: &RoundRay,
    instance: u32,
    best: &mut Best,
) {
    let visit = |index: u32, segment: &Segment| {
        if let Some((t, p)) = ray.line.hit(segment, |t| best.accepts(t, instance, index)) {
            let [u, v] = RoundCone::new(segment.ends[0], segment.ends[1]).coordinates(p);
            *best = Best { t, u, v, instance, primitive: index };
        }
        false
    };
    // SAFETY: by contract.
    unsafe { each::<F>(block, beyond, ray, visit) };
}

/// True where a round cone of `block` is hit before `t_max`.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
pub(super) unsafe fn any<F: Lanes<BLOCK>>(
    block: &RoundBlock,
    beyond: impl Fn(u32) -> Beyond,
    ray: &RoundRay,
    t_max: f32,
) -> bool {
    let mut found = false;
    let visit = |_: u32, segment: &Segment| {
        found = ray.line.hit(segment, |t| t < t_max).is_some();
        found
    };
    // SAFETY: by contract.
    unsafe { each::<F>(block, beyond, ray, visit) };
    found
}
