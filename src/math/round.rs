//! Round cones: what a ball covers that moves along a straight line while its radius changes evenly.
//!
//! A point of the surface has two coordinates `(u, v)`, which a hit carries. From `u` = 0 to 1 the ball
//! that touches the surface there moves from the first centre to the second. Below −1 the point lies on
//! the cap of the first ball, beyond 2 on that of the last. `v` goes around the axis, from −2 to 2. Both
//! are "diamond angles", which take no trigonometry: of a vector `(x, y)`, `y / (|x| + |y|)` in the
//! first quadrant and so on around.

use std::f64::consts::PI;

use super::{DVec3, orthonormal_pair};

/// A ball: centre, then radius.
pub type Ball = [f32; 4];

/// The hull of two balls, in `f64`, relative to the centre of the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundCone {
    /// From the first centre to the second.
    pub axis: DVec3,
    /// Radii of both balls.
    pub radii: [f64; 2],
    /// Unit direction of the axis; any direction where both centres are the same.
    dir: DVec3,
    length: f64,
    /// Sine and cosine of the angle by which normals of the side lean towards the second ball. One ball
    /// within the other has no side: ±1 and 0.
    lean: [f64; 2],
}

/// A point of a round cone's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundPoint {
    /// Relative to the first centre.
    pub p: DVec3,
    /// Unit, outward.
    pub normal: DVec3,
    /// Share of the way from the first centre to the second of the ball that touches there.
    pub s: f64,
}

/// What lies nearest on the surface of a round cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Distance from the surface, negative inside.
    pub distance: f64,
    /// Share of the way from the first centre to the second.
    pub s: f64,
    /// Unit direction outward.
    pub normal: DVec3,
}

/// The centre of a ball.
pub fn center_of(ball: Ball) -> DVec3 {
    DVec3::new(ball[0].into(), ball[1].into(), ball[2].into())
}

impl RoundCone {
    /// The hull of `first` and `last`.
    pub fn new(first: Ball, last: Ball) -> Self {
        let axis = center_of(last) - center_of(first);
        let radii = [f64::from(first[3]), f64::from(last[3])];
        let length = axis.length();
        let shrink = radii[0] - radii[1];
        let lean = if shrink.abs() < length {
            let sin = shrink / length;
            [sin, (1.0 - sin * sin).sqrt()]
        } else {
            [if shrink < 0.0 { -1.0 } else { 1.0 }, 0.0]
        };
        Self { axis, radii, dir: axis.try_normalize().unwrap_or(DVec3::Z), length, lean }
    }

    /// True where one ball lies within the other.
    pub fn is_ball(&self) -> bool {
        self.lean[1] == 0.0
    }

    /// Sine of the angle by which normals of the side lean towards the second ball.
    pub fn slope(&self) -> f64 {
        self.lean[0]
    }

    /// Along the axis, and across it.
    fn split(&self, x: DVec3) -> (f64, DVec3) {
        let along = x.dot(self.dir);
        (along, x - self.dir * along)
    }

    /// Share of the way along the axis at which the ball stands that is nearest to a point at these
    /// distances along the axis and from it.
    fn share(&self, along: f64, across: f64) -> f64 {
        let [sin, cos] = self.lean;
        if self.is_ball() {
            return f64::from(u8::from(sin < 0.0));
        }
        ((cos * along - sin * across) / (cos * self.length)).clamp(0.0, 1.0)
    }

    /// The foot of `x`, which is relative to the first centre.
    pub fn foot(&self, x: DVec3) -> Foot {
        let (along, across) = self.split(x);
        let s = self.share(along, across.length());
        let from_center = x - self.axis * s;
        let length = from_center.length();
        let distance = length - (self.radii[0] + (self.radii[1] - self.radii[0]) * s);
        let normal = if length > 0.0 { from_center / length } else { self.dir };
        // On the side the way to the nearest ball is that to the surface, for it is along the normal.
        Foot { distance, s, normal }
    }

    /// Coordinates of the point of the surface that is nearest to `x`.
    pub fn coordinates(&self, x: DVec3) -> [f32; 2] {
        let (along, across) = self.split(x);
        let s = self.share(along, across.length());
        let (b, c) = orthonormal_pair(self.dir);
        let v = diamond(across.dot(b), across.dot(c));
        let polar = |along: f64| diamond(along, across.length());
        let u = match s {
            0.0 => -1.0 - polar(along),
            1.0 => 2.0 + polar(along - self.length),
            s => s,
        };
        [u as f32, v as f32]
    }

    /// The point with coordinates `uv`, exactly on the surface but for rounding in `f64`.
    pub fn point(&self, [u, v]: [f32; 2]) -> RoundPoint {
        let [x, y] = undo_diamond(v.into());
        let (b, c) = orthonormal_pair(self.dir);
        let across = b * x + c * y;
        let (u, s) = (f64::from(u), share_of(u));
        let [sin, cos] = match u {
            u if u < 0.0 => undo_diamond(-1.0 - u),
            u if u > 1.0 => undo_diamond(u - 2.0),
            _ => self.lean,
        };
        let normal = self.dir * sin + across * cos;
        let radius = self.radii[0] + (self.radii[1] - self.radii[0]) * s;
        RoundPoint { p: self.axis * s + normal * radius, normal, s }
    }

    /// Coordinates of a point of the surface, which `u` chooses evenly by area.
    pub fn sample(&self, u: [f64; 2]) -> [f32; 2] {
        let ([start, side, end], [sin, _]) = (self.areas(), self.lean);
        let x = u[0] * (start + side + end);
        let polar = |z: f64| diamond(z, (1.0 - z * z).max(0.0).sqrt());
        let [a, b] = self.radii;
        let along = if x < start {
            -1.0 - polar(x / start * (1.0 + sin) - 1.0)
        } else if x < start + side {
            // Rings are as long as their radius, which grows evenly.
            let share = (x - start) / side;
            share * (a + b) / (a + (a * a + share * (b * b - a * a)).sqrt())
        } else {
            2.0 + polar(1.0 - (x - start - side) / end * (1.0 - sin))
        };
        let (y, x) = (2.0 * PI * u[1]).sin_cos();
        [along as f32, diamond(x, y) as f32]
    }

    /// Areas of the cap of the first ball, of the side and of the cap of the last ball.
    pub fn areas(&self) -> [f64; 3] {
        let ([a, b], [sin, cos]) = (self.radii, self.lean);
        // Caps of the heights r(1 ± sin), and a frustum whose slant is cos times the length.
        [2.0 * PI * a * a * (1.0 + sin), PI * (a + b) * cos * cos * self.length, 2.0 * PI * b * b * (1.0 - sin)]
    }
}

/// Share of the way along the axis at coordinate `u`.
pub fn share_of(u: f32) -> f64 {
    f64::from(u).clamp(0.0, 1.0)
}

/// The angle of `(x, y)` from the x axis, −2 to 2.
fn diamond(x: f64, y: f64) -> f64 {
    let sum = x.abs() + y.abs();
    if sum == 0.0 {
        return 0.0;
    }
    let t = y / sum;
    match (x >= 0.0, y >= 0.0) {
        (true, _) => t,
        (false, true) => 2.0 - t,
        (false, false) => -2.0 - t,
    }
}

/// The unit vector at a diamond angle.
fn undo_diamond(angle: f64) -> [f64; 2] {
    let y = if angle.abs() <= 1.0 { angle } else { (2.0 - angle.abs()) * angle.signum() };
    let x = 1.0 - angle.abs();
    let length = (x * x + y * y).sqrt();
    [x / length, y / length]
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONES: [[Ball; 2]; 6] = [
        [[1.0, 2.0, 3.0, 0.5], [2.0, 4.0, 2.5, 0.5]],
        [[0.0, 0.0, 0.0, 1.0], [3.0, 0.0, 0.0, 0.2]],
        [[0.0, 0.0, 0.0, 0.1], [0.0, 0.5, 0.0, 0.4]],
        [[5.0, 0.0, 0.0, 0.3], [5.0, 0.0, 0.0, 0.3]],
        [[0.0, 0.0, 0.0, 1.0], [0.1, 0.2, 0.0, 0.2]],
        [[0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 2.0, 0.7]],
    ];

    /// Points all around a cone.
    fn around() -> impl Iterator<Item = DVec3> {
        (0..2000).map(|i| {
            let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / 2000.0;
            let (sin, cos) = (2.399_963 * f64::from(i)).sin_cos();
            DVec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z) * (0.1 + f64::from(i % 7))
        })
    }

    #[test]
    fn distances_are_those_of_the_nearest_of_many_balls() {
        for [a, b] in CONES {
            let cone = RoundCone::new(a, b);
            for x in around() {
                let ball = |i: u32| {
                    let s = f64::from(i) / 4000.0;
                    (x - cone.axis * s).length() - (cone.radii[0] + (cone.radii[1] - cone.radii[0]) * s)
                };
                let brute = (0..=4000).map(ball).fold(f64::INFINITY, f64::min);
                let foot = cone.foot(x);
                assert!((foot.distance - brute).abs() < 1e-4, "{cone:?} {x}: {foot:?} {brute}");
                let on_surface = x - foot.normal * foot.distance;
                assert!(cone.foot(on_surface).distance.abs() < 1e-12);
            }
        }
    }

    #[test]
    fn coordinates_lead_back_to_the_point() {
        for [a, b] in CONES {
            let cone = RoundCone::new(a, b);
            for x in around() {
                let foot = cone.foot(x);
                let on_surface = x - foot.normal * foot.distance;
                let again = cone.point(cone.coordinates(x));
                let size = cone.axis.length() + cone.radii[0] + cone.radii[1];
                assert!(again.p.distance(on_surface) < 1e-6 * size, "{cone:?} {x}: {again:?} {on_surface}");
                assert!(cone.foot(again.p).distance.abs() < 1e-14 * size, "{cone:?} {x}");
                assert!((again.normal.length() - 1.0).abs() < 1e-14 && (again.s - foot.s).abs() < 1e-6);
                assert!(again.normal.distance(foot.normal) < 1e-6, "{cone:?} {x}");
            }
        }
    }

    #[test]
    fn samples_are_even_in_area() {
        for [a, b] in CONES {
            let cone = RoundCone::new(a, b);
            let areas = cone.areas();
            let total: f64 = areas.iter().sum();
            let (n, mut pieces, mut normals, mut volume) = (200, [0.0; 3], DVec3::ZERO, 0.0);
            for (i, k) in (0..n).flat_map(|i| (0..n).map(move |k| (i, k))) {
                let uv = cone.sample([(f64::from(i) + 0.5) / f64::from(n), (f64::from(k) + 0.5) / f64::from(n)]);
                let piece = if uv[0] < 0.0 {
                    0
                } else if uv[0] <= 1.0 {
                    1
                } else {
                    2
                };
                pieces[piece] += 1.0 / f64::from(n * n);
                let point = cone.point(uv);
                normals += point.normal / f64::from(n * n);
                volume += total * point.p.dot(point.normal) / f64::from(3 * n * n);
            }
            for (share, area) in pieces.into_iter().zip(areas) {
                assert!((share - area / total).abs() < 2.0 / f64::from(n), "{cone:?}: {pieces:?} {areas:?}");
            }
            // Over a closed surface normals sum to nothing, and along positions to thrice its volume.
            assert!(normals.length() < 1.0 / f64::from(n), "{cone:?}: {normals}");
            let ([a, b], [sin, cos]) = (cone.radii, cone.lean);
            let cap = |r: f64, h: f64| PI * h * h * (r - h / 3.0);
            let frustum = PI / 3.0 * cone.length * cos.powi(4) * (a * a + a * b + b * b);
            let expected = cap(a, a * (1.0 + sin)) + frustum + cap(b, b * (1.0 - sin));
            assert!((volume / expected - 1.0).abs() < 1e-2, "{cone:?}: {volume} {expected}");
        }
    }

    #[test]
    fn areas_are_those_of_many_rings() {
        for [a, b] in CONES {
            let cone = RoundCone::new(a, b);
            if cone.is_ball() {
                let r = cone.radii[0].max(cone.radii[1]);
                assert!((cone.areas().iter().sum::<f64>() / (4.0 * PI * r * r) - 1.0).abs() < 1e-12);
                continue;
            }
            // The surface turned about the axis, by its outline: cap, side, cap.
            let edge = diamond(cone.lean[0], cone.lean[1]);
            let pieces = [[-3.0, -1.0 - edge], [0.0, 1.0], [2.0 + edge, 2.0]];
            let steps = |[from, to]: [f64; 2]| (0..=5000).map(move |i| from + (to - from) * f64::from(i) / 5000.0);
            let outline: Vec<[f64; 2]> = pieces
                .into_iter()
                .flat_map(steps)
                .map(|u| {
                    let (along, across) = cone.split(cone.point([u as f32, 0.0]).p);
                    [along, across.length()]
                })
                .collect();
            let ring = |w: &[[f64; 2]]| {
                let slant = (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]);
                PI * (w[0][1] + w[1][1]) * slant
            };
            for (piece, area) in outline.chunks(5001).zip(cone.areas()) {
                let brute: f64 = piece.windows(2).map(ring).sum();
                assert!((area - brute).abs() < 1e-5 * (1.0 + area), "{cone:?}: {area} {brute}");
            }
        }
    }
}
