//! What a surface gets of light from far away, by its normal: a table over the octahedron.
//!
//! Zina Cigolle, Sam Donow, Daniel Evangelakos, Michael Mara, Morgan McGuire, Quirin Meyer: *A Survey of
//! Efficient Representations for Independent Unit Vectors*, JCGT 3(2), 2014.

use rayon::prelude::*;

use crate::math::{DVec3, Vec3};

/// Cells along each side of the octahedral map; a cell reaches 5 degrees from its centre.
const SIDE: usize = 32;

/// Widens every bound by more than rounding, radians.
const SLACK: f64 = 1e-3;

/// Flux per area that comes from about one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Unit direction of its middle.
    pub w: DVec3,
    /// Radiance times solid angle.
    pub flux: f64,
}

/// Upper bound of the unoccluded irradiance on a surface, little above it: 0 only where none arrives.
#[derive(Clone, Debug, PartialEq)]
pub struct IrradianceMap {
    /// Of light from all sides.
    fluence: f32,
    /// For the normals of each cell of the map, row by row.
    cells: Box<[f32]>,
}

impl IrradianceMap {
    /// The map of `parts`, none of which reaches farther than the angle `radius` from its middle.
    pub fn new(parts: &[Part], radius: f64) -> Self {
        let parts: Vec<Part> = parts.iter().copied().filter(|part| part.flux > 0.0).collect();
        let fluence = parts.iter().map(|part| part.flux).sum();
        let cell = |i: usize| {
            let corner = |x: f64, y: f64| direction([(i % SIDE) as f64 + x, (i / SIDE) as f64 + y]);
            let n = corner(0.5, 0.5);
            let corners = [corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0), corner(1.0, 1.0)];
            let cell_radius = corners.iter().map(|c| c.angle_between(n)).fold(0.0, f64::max);
            // The largest cosine between a normal of the cell and a direction of the part.
            let within = (radius + cell_radius + SLACK).min(std::f64::consts::PI);
            let (sin, cos) = within.sin_cos();
            let received = |part: &Part| {
                let c = n.dot(part.w);
                let largest = if c >= cos { 1.0 } else { c * cos + (1.0 - c * c).max(0.0).sqrt() * sin };
                part.flux * largest.max(0.0)
            };
            to_f32(parts.iter().map(received).sum())
        };
        Self { fluence: to_f32(fluence), cells: (0..SIDE * SIDE).into_par_iter().map(cell).collect() }
    }

    /// Irradiance for the unit normal `n`, or that of light from all sides.
    pub fn at(&self, n: Option<Vec3>) -> f32 {
        n.map_or(self.fluence, |n| self.cells[cell_of(n)])
    }
}

/// Neither infinite nor, where there is anything, 0.
fn to_f32(v: f64) -> f32 {
    if v > 0.0 { v.clamp(f64::from(f32::MIN_POSITIVE), f64::from(f32::MAX)) as f32 } else { 0.0 }
}

/// The direction at a point of the map, in cells.
fn direction(cell: [f64; 2]) -> DVec3 {
    let [x, y] = cell.map(|c| 2.0 * c / SIDE as f64 - 1.0);
    let z = 1.0 - x.abs() - y.abs();
    let fold = (-z).max(0.0);
    DVec3::new(x - fold.copysign(x), y - fold.copysign(y), z).normalize()
}

fn cell_of(n: Vec3) -> usize {
    let n = n / (n.x.abs() + n.y.abs() + n.z.abs());
    let fold = |a: f32, b: f32| if n.z >= 0.0 { a } else { (1.0 - b.abs()).copysign(a) };
    let index = |a: f32| ((0.5 * (a + 1.0) * SIDE as f32) as usize).min(SIDE - 1);
    index(fold(n.y, n.x)) * SIDE + index(fold(n.x, n.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spread(count: usize) -> impl Iterator<Item = DVec3> {
        (0..count).map(move |i| {
            let z = 1.0 - 2.0 * (i as f64 + 0.5) / count as f64;
            let (sin, cos) = (2.399_963_229_728_653 * i as f64).sin_cos();
            let r = (1.0 - z * z).sqrt();
            DVec3::new(r * cos, r * sin, z)
        })
    }

    #[test]
    fn cells_hold_their_directions() {
        for n in spread(20_000).chain([DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z]) {
            let cell = cell_of(n.as_vec3());
            let middle = direction([(cell % SIDE) as f64 + 0.5, (cell / SIDE) as f64 + 0.5]);
            assert!(middle.angle_between(n).to_degrees() < 5.5, "{n}: {middle}");
        }
    }

    #[test]
    fn is_a_bound_that_is_near() {
        let sun = Part { w: DVec3::new(0.6, 0.0, 0.8), flux: 3.0 };
        let map = IrradianceMap::new(&[sun], 0.02);
        assert!((map.at(None) - 3.0).abs() < 1e-6);
        for n in spread(5_000) {
            let (exact, bound) = (3.0 * n.dot(sun.w).max(0.0), f64::from(map.at(Some(n.as_vec3()))));
            assert!(bound >= exact && bound < exact + 3.0 * 0.2, "{n}: {bound} for {exact}");
            assert!(n.dot(sun.w) > -0.2 || bound == 0.0);
        }
        // A sky of radiance 1: π all around.
        let sky: Vec<Part> = spread(5_000).map(|w| Part { w, flux: 4.0 * std::f64::consts::PI / 5_000.0 }).collect();
        let map = IrradianceMap::new(&sky, 0.03);
        for n in spread(100) {
            let irradiance = f64::from(map.at(Some(n.as_vec3()))) / std::f64::consts::PI;
            assert!((1.0..1.25).contains(&irradiance), "{n}: {irradiance}");
        }
    }
}
