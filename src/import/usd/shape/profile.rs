//! Solids: outlines turned about an axis, the cube, the plane. Normals are those of the true surface.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::math::DVec3;

/// Segments around. The chord of a circle is off by 1 − cos(π/96) = 0.05 % of its radius.
const AROUND: u32 = 96;
/// Segments along a quarter of a meridian.
const QUARTER: f64 = AROUND as f64 / 4.0;

/// The faces of a cube by its eight points, of a plane by its four, as UsdImaging's meshes have them: that is
/// what the values of `uniform`, `vertex` and `faceVarying` primvars count.
pub(super) const CUBE: [[u32; 4]; 6] =
    [[0, 1, 2, 3], [4, 5, 6, 7], [0, 6, 5, 1], [4, 7, 3, 2], [0, 3, 7, 6], [4, 2, 1, 5]];
pub(super) const PLANE: [[u32; 4]; 1] = [[0, 1, 2, 3]];

/// A mesh with smooth normals, about the z axis.
#[derive(Default)]
pub(super) struct Solid {
    pub points: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
}

/// A point of an outline: distance from the axis, height, and the normal in the same terms.
#[derive(Clone, Copy)]
struct Knot {
    r: f64,
    z: f64,
    nr: f64,
    nz: f64,
}

/// An arc of a circle about height `z`, between two angles above the equator.
fn arc(radius: f64, z: f64, [from, to]: [f64; 2]) -> Vec<Knot> {
    let steps = ((to - from) / FRAC_PI_2 * QUARTER).ceil().max(1.0) as u32;
    let knot = |i: u32| {
        let (sin, cos) = (from + (to - from) * f64::from(i) / f64::from(steps)).sin_cos();
        // On the axis itself, whatever the cosine of π/2 is.
        let nr = if cos.abs() < 1e-12 { 0.0 } else { cos };
        Knot { r: radius * nr, z: z + radius * sin, nr, nz: sin }
    };
    (0..=steps).map(knot).collect()
}

/// A straight line between two circles.
fn line([r0, z0]: [f64; 2], [r1, z1]: [f64; 2]) -> Vec<Knot> {
    let length = (r1 - r0).hypot(z1 - z0);
    let (nr, nz) = ((z1 - z0) / length, (r0 - r1) / length);
    vec![Knot { r: r0, z: z0, nr, nz }, Knot { r: r1, z: z1, nr, nz }]
}

impl Solid {
    pub fn sphere(radius: f64) -> Self {
        Self::turned(&[arc(radius, 0.0, [-FRAC_PI_2, FRAC_PI_2])])
    }

    /// A cylinder, or a cone where one radius is 0, with its caps; centred.
    pub fn cylinder(bottom: f64, top: f64, height: f64) -> Self {
        let h = height / 2.0;
        let mut parts = Vec::new();
        if bottom > 0.0 {
            parts.push(line([0.0, -h], [bottom, -h]));
        }
        parts.push(line([bottom, -h], [top, h]));
        if top > 0.0 {
            parts.push(line([top, h], [0.0, h]));
        }
        Self::turned(&parts)
    }

    /// A cylinder or cone between two spheres that it touches all around; where it does, at the ends of
    /// `height`, it has the radii (which is what UsdGeomCapsule_1's extent says). Needs a height unless the
    /// radii are the same.
    pub fn capsule(bottom: f64, top: f64, height: f64) -> Self {
        let h = height / 2.0;
        // The angle at which the side faces upwards.
        let tilt = (bottom - top).atan2(height);
        let sphere = |r: f64, z: f64, angles| arc(r / tilt.cos(), z - r * tilt.tan(), angles);
        let mut outline = sphere(bottom, -h, [-FRAC_PI_2, tilt]);
        let mut above = sphere(top, h, [tilt, FRAC_PI_2]);
        if height <= 0.0 {
            above.remove(0);
        }
        outline.append(&mut above);
        Self::turned(&[outline])
    }

    /// Turns outlines, which run upwards on the outside, about z. Parts share no normals.
    fn turned(parts: &[Vec<Knot>]) -> Self {
        let mut solid = Self::default();
        for outline in parts {
            let first = solid.points.len() as u32;
            for knot in outline {
                for i in 0..AROUND {
                    // On a cone's tip each segment has the normal of its middle.
                    let shift = if knot.r == 0.0 { 0.5 } else { 0.0 };
                    let (sin, cos) = (TAU * (f64::from(i) + shift) / f64::from(AROUND)).sin_cos();
                    solid.points.push([knot.r * cos, knot.r * sin, knot.z].map(|v| v as f32));
                    solid.normals.push([knot.nr * cos, knot.nr * sin, knot.nz].map(|v| v as f32));
                }
            }
            for (ring, pair) in outline.windows(2).enumerate() {
                let row = first + ring as u32 * AROUND;
                for i in 0..AROUND {
                    let j = (i + 1) % AROUND;
                    let [a, b, c, d] = [row + i, row + j, row + AROUND + j, row + AROUND + i];
                    if pair[0].r > 0.0 {
                        solid.triangles.push(if pair[1].r > 0.0 { [a, b, c] } else { [a, b, d] });
                    }
                    if pair[1].r > 0.0 {
                        solid.triangles.push([a, c, d]);
                    }
                }
            }
        }
        solid
    }

    /// Its faces are [`CUBE`]; each has its own points, in the order of the face's corners.
    pub fn cube(size: f64) -> Self {
        let corner = |[x, y, z]: [f64; 3]| DVec3::new(x, y, z) * (size / 2.0);
        let points = [
            [1.0, 1.0, 1.0],
            [-1.0, 1.0, 1.0],
            [-1.0, -1.0, 1.0],
            [1.0, -1.0, 1.0],
            [-1.0, -1.0, -1.0],
            [-1.0, 1.0, -1.0],
            [1.0, 1.0, -1.0],
            [1.0, -1.0, -1.0],
        ];
        let mut solid = Self::default();
        CUBE.iter().for_each(|face| solid.quad(face.map(|i| corner(points[i as usize]))));
        solid
    }

    /// A rectangle that faces `axis`. Its width is along x, its length along y, or what is left of these.
    pub fn plane(width: f64, length: f64, axis: Axis) -> Self {
        let (w, l) = (width / 2.0, length / 2.0);
        // Corner by corner as UsdImaging has them.
        let corner = |[u, v]: [f64; 2]| match axis {
            Axis::X => DVec3::new(0.0, v * l, u * w),
            Axis::Y => DVec3::new(-u * w, 0.0, v * l),
            Axis::Z => DVec3::new(u * w, v * l, 0.0),
        };
        let corners = match axis {
            Axis::X => [[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]],
            Axis::Y => [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]],
            Axis::Z => [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]],
        };
        let mut solid = Self::default();
        solid.quad(corners.map(corner));
        solid
    }

    /// Adds a rectangle with points of its own, counter-clockwise.
    fn quad(&mut self, corners: [DVec3; 4]) {
        let first = self.points.len() as u32;
        let [a, b, c, _] = corners;
        let n = (b - a).cross(c - b).normalize_or_zero();
        self.points.extend(corners.map(|corner| -> [f32; 3] { corner.as_vec3().into() }));
        self.normals.extend([n.as_vec3().to_array(); 4]);
        self.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t: [u32; 3]| t.map(|i| first + i)));
    }

    /// Turns z to `axis` by renaming the axes in a circle, as USD does.
    pub fn along(mut self, axis: Axis) -> Self {
        let turn = |[x, y, z]: [f32; 3]| match axis {
            Axis::X => [z, x, y],
            Axis::Y => [y, z, x],
            Axis::Z => [x, y, z],
        };
        self.points.iter_mut().chain(&mut self.normals).for_each(|v| *v = turn(*v));
        self
    }
}

/// The axis of a solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Axis {
    X,
    Y,
    Z,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    /// The volume inside, by the divergence theorem: positive where triangles face outwards.
    fn volume(solid: &Solid) -> f64 {
        let p = |i: u32| DVec3::from(solid.points[i as usize].map(f64::from));
        solid.triangles.iter().map(|&[a, b, c]| p(a).dot(p(b).cross(p(c))) / 6.0).sum()
    }

    fn normals_agree(solid: &Solid) {
        for &triangle in &solid.triangles {
            let [a, b, c] = triangle.map(|i| Vec3::from(solid.points[i as usize]));
            let n = (b - a).cross(c - a);
            assert!(n.length() > 0.0, "{triangle:?}");
            for i in triangle {
                let normal = Vec3::from(solid.normals[i as usize]);
                assert!((normal.length() - 1.0).abs() < 1e-6);
                assert!(normal.dot(n.normalize()) > 0.99, "{normal} {n}");
            }
        }
    }

    #[test]
    fn solids_are_closed_and_face_outwards() {
        let pi = std::f64::consts::PI;
        let cases = [
            (Solid::sphere(2.0), 4.0 / 3.0 * pi * 8.0),
            (Solid::cylinder(1.0, 1.0, 3.0), 3.0 * pi),
            (Solid::cylinder(2.0, 0.0, 3.0), 4.0 * pi),
            (Solid::cylinder(2.0, 1.0, 3.0), pi * (4.0 + 2.0 + 1.0)),
            (Solid::capsule(1.0, 1.0, 2.0), pi * (2.0 + 4.0 / 3.0)),
            (Solid::cube(2.0), 8.0),
        ];
        for (solid, expected) in cases {
            normals_agree(&solid);
            let share = volume(&solid) / expected;
            assert!((0.998..1.000_001).contains(&share), "{share}");
            for axis in [Axis::X, Axis::Y] {
                let turned = Solid {
                    points: solid.points.clone(),
                    normals: solid.normals.clone(),
                    triangles: solid.triangles.clone(),
                };
                assert!((volume(&turned.along(axis)) / volume(&solid) - 1.0).abs() < 1e-6);
            }
        }
    }

    fn extent(solid: &Solid) -> (Vec3, Vec3) {
        let points = solid.points.iter().map(|&p| Vec3::from(p));
        points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
    }

    #[test]
    fn extents_are_those_that_usd_computes() {
        // UsdGeom.Boundable.ComputeExtentFromPlugins of usd-core 26.11.
        let close = |solid: &Solid, lo: [f32; 3], hi: [f32; 3]| {
            let (min, max) = extent(solid);
            assert!((min - Vec3::from(lo)).abs().max_element() < 2e-3, "{min} {lo:?}");
            assert!((max - Vec3::from(hi)).abs().max_element() < 2e-3, "{max} {hi:?}");
            normals_agree(solid);
        };
        let (r, below, above) = (1.017_426_3, -3.204_926_3, 2.207_481_6);
        close(&Solid::capsule(1.0, 0.25, 4.0), [-r, -r, below], [r, r, above]);
        close(&Solid::capsule(1.0, 0.25, 4.0).along(Axis::X), [below, -r, -r], [above, r, r]);
        close(&Solid::capsule(1.0, 0.25, 4.0).along(Axis::Y), [-r, below, -r], [r, above, r]);
        close(&Solid::cylinder(1.0, 0.25, 4.0).along(Axis::Y), [-1.0, -2.0, -1.0], [1.0, 2.0, 1.0]);
        close(&Solid::plane(2.0, 6.0, Axis::X), [0.0, -3.0, -1.0], [0.0, 3.0, 1.0]);
        close(&Solid::plane(2.0, 6.0, Axis::Y), [-1.0, 0.0, -3.0], [1.0, 0.0, 3.0]);
        close(&Solid::plane(2.0, 6.0, Axis::Z), [-1.0, -3.0, 0.0], [1.0, 3.0, 0.0]);
    }
}
