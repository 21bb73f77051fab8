//! Closed forms, in `f64`.

use std::f64::consts::PI;

use penumbra::math::DVec3;

/// Lambert's form factor of a polygon, all of it above a point whose normal is `n`: irradiance over π and radiance.
pub fn polygon(corners: &[DVec3], p: DVec3, n: DVec3) -> f64 {
    let rays: Vec<DVec3> = corners.iter().map(|corner| (*corner - p).normalize()).collect();
    let edges = rays.iter().zip(rays.iter().cycle().skip(1));
    let sum: f64 = edges
        .map(|(a, b)| {
            let across = a.cross(*b);
            let sine = across.length();
            if sine == 0.0 { 0.0 } else { sine.atan2(a.dot(*b)) * across.dot(n) / sine }
        })
        .sum();
    sum.abs() / (2.0 * PI)
}

/// The share of a disk of radius 1 that lies beyond a line at a distance from its middle, from −1 to 1.
pub fn beyond(line: f64) -> f64 {
    let line = line.clamp(-1.0, 1.0);
    (line.acos() - line * (1.0 - line * line).sqrt()) / PI
}
