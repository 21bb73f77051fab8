//! Irradiance from flat lights in f64: Lambert's formula for polygons, and quadrature.

use std::f64::consts::TAU;

use penumbra::light::Flat;
use penumbra::math::{DMat3, DQuat, DVec2, DVec3, Rgb, Vec3};

/// Where a flat light is, and how it is seen from a point.
pub struct Pose {
    pub center: DVec3,
    pub axes: DMat3,
}

impl Pose {
    /// Facing down from `center`, local x along x.
    pub fn down(center: DVec3) -> Self {
        Self { center, axes: DMat3::from_cols(DVec3::X, -DVec3::Z, DVec3::Y) }
    }

    /// Turned all ways.
    pub fn turned(center: DVec3, turn: DQuat) -> Self {
        let down = Self::down(center);
        Self { center, axes: DMat3::from_quat(turn) * down.axes }
    }

    pub fn flat(&self, radiance: f32) -> Flat {
        Flat::new(self.center, self.axes, Rgb::splat(radiance))
    }

    pub fn at(&self, q: DVec2) -> DVec3 {
        self.center + self.axes * q.extend(0.0)
    }

    /// Corners of a rectangle with these half sizes.
    pub fn corners(&self, half: [f64; 2]) -> Vec<DVec3> {
        let [x, y] = half;
        [[-x, -y], [x, -y], [x, y], [-x, y]].map(|q| self.at(q.into())).to_vec()
    }

    /// An ellipse as a polygon of the same area.
    pub fn ellipse(&self, half: [f64; 2], n: u32) -> Vec<DVec3> {
        let step = TAU / f64::from(n);
        let grow = (step / step.sin()).sqrt();
        let corner = |i: u32| DVec2::from_angle(step * f64::from(i)) * grow * DVec2::from(half);
        (0..n).map(|i| self.at(corner(i))).collect()
    }
}

/// The part of a polygon above the horizon of a surface at `p` with normal `n`, relative to `p`.
fn above(polygon: &[DVec3], p: Vec3, n: DVec3) -> Vec<DVec3> {
    let seen: Vec<DVec3> = polygon.iter().map(|v| *v - p.as_dvec3()).collect();
    let mut above = Vec::new();
    for (i, &a) in seen.iter().enumerate() {
        let b = seen[(i + 1) % seen.len()];
        let (ha, hb) = (a.dot(n), b.dot(n));
        if ha >= 0.0 {
            above.push(a);
        }
        if (ha < 0.0) != (hb < 0.0) {
            above.push(a + (b - a) * (ha / (ha - hb)));
        }
    }
    above
}

/// Irradiance of a polygon of radiance 1 on a surface at `p` with normal `n`: Johann Heinrich Lambert:
/// *Photometria*, 1760, half the sum over the edges of their angles times `cos` of their planes'
/// normals, of the part above the horizon.
pub fn lambert(polygon: &[DVec3], p: Vec3, n: Vec3) -> f64 {
    let n = n.as_dvec3();
    let above = above(polygon, p, n);
    let edge = |a: DVec3, b: DVec3| {
        let cross = a.cross(b);
        let sin = cross.length();
        if sin == 0.0 { 0.0 } else { sin.atan2(a.dot(b)) * cross.dot(n) / sin }
    };
    let sum: f64 = above.iter().enumerate().map(|(i, &a)| edge(a, above[(i + 1) % above.len()])).sum();
    0.5 * sum.abs()
}

/// The same from anywhere: Lambert's sum cancels where the polygon is small in its distance. There
/// the integrand is all but a product of two linear functions of the place, for which the mean of the
/// middles of a triangle's edges is exact.
pub fn irradiance(polygon: &[DVec3], p: Vec3, n: Vec3) -> f64 {
    let size = polygon.iter().map(|v| v.distance(polygon[0])).fold(0.0, f64::max);
    if size * 1e3 > polygon[0].distance(p.as_dvec3()) {
        return lambert(polygon, p, n);
    }
    let n = n.as_dvec3();
    let above = above(polygon, p, n);
    let triangle = |a: DVec3, b: DVec3, c: DVec3| {
        let cross = (b - a).cross(c - a);
        let at = |v: DVec3| v.dot(n) * v.dot(cross).abs() / v.length_squared().powi(2);
        0.5 * (at(0.5 * (a + b)) + at(0.5 * (b + c)) + at(0.5 * (c + a))) / 3.0
    };
    above.windows(2).skip(1).map(|edge| triangle(above[0], edge[0], edge[1])).sum()
}

/// Irradiance at `p` by the midpoint rule over the rectangle of the light's plane from `low` to `high`,
/// where `radiance` is that of a point of the light in a direction whose angle to the axis has the
/// tangent given.
pub fn quadrature(
    pose: &Pose,
    [low, high]: [DVec2; 2],
    steps: u32,
    p: Vec3,
    n: Vec3,
    radiance: &dyn Fn(DVec2, f64) -> f64,
) -> f64 {
    let (p, n) = (p.as_dvec3(), n.as_dvec3());
    let local = pose.axes.transpose() * (p - pose.center);
    let step = (high - low) / f64::from(steps);
    let mut sum = 0.0;
    for i in 0..steps {
        for j in 0..steps {
            let q = low + step * DVec2::new(f64::from(i) + 0.5, f64::from(j) + 0.5);
            let way = q.extend(0.0) - local;
            let d2 = way.length_squared();
            let cos = (pose.axes * way).dot(n) / d2.sqrt();
            let tan = way.truncate().length() / way.z.abs();
            sum += radiance(q, tan) * cos.max(0.0) * way.z.abs() / (d2 * d2.sqrt());
        }
    }
    sum * step.x * step.y
}

/// Part of the rectangle with half sizes `half` in which a spread of half angle `a` lets `p` see.
pub fn window(pose: &Pose, half: [f64; 2], p: Vec3, a: f64) -> [DVec2; 2] {
    let local = pose.axes.transpose() * (p.as_dvec3() - pose.center);
    let (foot, radius, half) = (local.truncate(), local.z.abs() * a.tan(), DVec2::from(half));
    [(foot - radius).max(-half), (foot + radius).min(half)]
}

/// Cycles' factor for the full angle `s`.
pub fn spread_factor(s: f64, tan: f64) -> f64 {
    let a = 0.5 * s;
    ((a.tan() - tan) / (a.tan() - a)).max(0.0)
}

/// Axis and half angle of a cone from `p` around the points.
pub fn cone_around(points: &[DVec3], p: Vec3) -> (Vec3, f64) {
    let ways: Vec<DVec3> = points.iter().map(|v| (*v - p.as_dvec3()).normalize()).collect();
    let axis = ways.iter().sum::<DVec3>().normalize();
    let angle = ways.iter().map(|w| w.cross(axis).length().atan2(w.dot(axis))).fold(0.0, f64::max);
    (axis.as_vec3(), 1.01 * angle + 1e-9)
}

#[test]
fn lambert_and_quadrature_agree() {
    let pose = Pose::turned(DVec3::new(0.3, 1.0, -0.2), DQuat::from_rotation_x(0.4));
    let half = [0.5, 0.3];
    for n in [Vec3::Y, Vec3::new(0.6, 0.8, 0.0), Vec3::X, Vec3::new(-0.8, -0.6, 0.0)] {
        let exact = lambert(&pose.corners(half), Vec3::ZERO, n);
        let half = DVec2::from(half);
        let sum = quadrature(&pose, [-half, half], 1000, Vec3::ZERO, n, &|_, _| 1.0);
        assert!((sum - exact).abs() < 1e-5 * exact.max(0.01), "{n}: {sum} and {exact}");
    }
    // Where the one way ends and the other begins.
    for n in [Vec3::Y, Vec3::new(0.6, 0.8, 0.0), Vec3::new(1.0, -3e-5, 0.0)] {
        let corners = Pose::down(DVec3::new(0.03, 1.2e3, 0.02)).corners([0.5, 0.3]);
        let [near, far] = [lambert, irradiance].map(|way| way(&corners, Vec3::ZERO, n));
        assert!((near / far - 1.0).abs() < 1e-5, "{n}: {near} and {far}");
    }
    // A disk that faces the point: π r² / (r² + d²).
    let disk = Pose::down(DVec3::Y * 2.0).ellipse([1.0, 1.0], 20_000);
    assert!((lambert(&disk, Vec3::ZERO, Vec3::Y) / (std::f64::consts::PI / 5.0) - 1.0).abs() < 1e-7);
}
