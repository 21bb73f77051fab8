//! Laws of the warps: one list, each line held to the same three.

#[path = "support/chi2.rs"]
mod chi2;

use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

use penumbra::math::{DVec2, DVec3, Vec3};
use penumbra::sampling::warp::*;
use penumbra::sampling::{AliasTable, BilinearImage, Dimension, Distribution2d, Pattern, Sampler};

/// What a warp maps to, as an area-preserving image of the unit square.
#[derive(Clone, Copy)]
enum Domain {
    /// Directions: (1 + z)/2 and the azimuth.
    Sphere,
    /// x and y in the unit disk: squared radius and azimuth.
    Disk,
    /// Barycentric coordinates: (b0 + b1)² and b0/(b0 + b1); area of the triangle 1.
    Triangle,
    /// x and y in the unit square.
    Square,
}

impl Domain {
    fn measure(self) -> f64 {
        match self {
            Self::Sphere => 4.0 * PI,
            Self::Disk => PI,
            Self::Triangle | Self::Square => 1.0,
        }
    }

    fn contains(self, p: Vec3) -> bool {
        match self {
            Self::Sphere => (p.length() - 1.0).abs() < 1e-5,
            Self::Disk => p.x * p.x + p.y * p.y <= 1.0 + 1e-6,
            Self::Triangle => p.min_element() >= 0.0 && (p.element_sum() - 1.0).abs() < 1e-6,
            Self::Square => p.x >= 0.0 && p.y >= 0.0 && p.x < 1.0 && p.y < 1.0,
        }
    }

    fn to_square(self, p: Vec3) -> [f64; 2] {
        let p = p.as_dvec3();
        let azimuth = p.y.atan2(p.x).rem_euclid(TAU) / TAU;
        match self {
            Self::Sphere => [0.5 * (1.0 + p.z), azimuth],
            Self::Disk => [p.x * p.x + p.y * p.y, azimuth],
            Self::Triangle => [(p.x + p.y) * (p.x + p.y), p.x / (p.x + p.y).max(1e-30)],
            Self::Square => [p.x, p.y],
        }
    }

    fn of_square(self, x: f64, y: f64) -> Vec3 {
        let (sin, cos) = (TAU * y).sin_cos();
        let p = match self {
            Self::Sphere => {
                let z = 2.0 * x - 1.0;
                let r = (1.0 - z * z).sqrt();
                [r * cos, r * sin, z]
            }
            Self::Disk => [x.sqrt() * cos, x.sqrt() * sin, 0.0],
            Self::Triangle => [x.sqrt() * y, x.sqrt() * (1.0 - y), 1.0 - x.sqrt()],
            Self::Square => [x, y, 0.0],
        };
        Vec3::from(p.map(|c| c as f32))
    }
}

struct Warp {
    name: &'static str,
    domain: Domain,
    sample: fn([f32; 2]) -> Vec3,
    pdf: fn(Vec3) -> f32,
}

/// A cone whose edge falls between the test's cells.
const CONE: f32 = 0.35;

static IMAGE: LazyLock<Distribution2d> =
    LazyLock::new(|| Distribution2d::new(17, 9, |x, y| if x == 3 { 0.0 } else { 1.0 + (x * y) as f64 }).unwrap());

/// Half axes of an ellipse about `AT`, or half sides of a rectangle.
const HALF: [f64; 2] = [1.3, 0.6];
const AT: DVec3 = DVec3::new(0.4, -0.3, 0.7);

static ELLIPSE: LazyLock<EllipticCone> = LazyLock::new(|| EllipticCone::new(AT, HALF).unwrap());

static RECT: LazyLock<SphericalRect> = LazyLock::new(|| {
    let range = |i: usize| [AT[i] - HALF[i], AT[i] + HALF[i]];
    SphericalRect::new(range(0), range(1), AT.z).unwrap()
});

/// Where `w` meets the plane of `AT`, from there in units of `HALF`.
fn on_plane(w: Vec3) -> Option<DVec2> {
    let w = w.as_dvec3();
    (w.z > 0.0).then(|| (w * (AT.z / w.z) - AT).truncate() / DVec2::from(HALF))
}

/// Weights of a bilinear image: zeros, and a texel that holds most of it.
fn bilinear_weight(x: usize, y: usize) -> f64 {
    match (x, y) {
        (5, 2) => 300.0,
        (9.., 4..) => 0.0,
        _ => 1.0 + (x * y) as f64,
    }
}

static BILINEAR: LazyLock<BilinearImage> = LazyLock::new(|| BilinearImage::new(13, 7, bilinear_weight).unwrap());

const WARPS: &[Warp] = &[
    Warp { name: "disk", domain: Domain::Disk, sample: |u| disk(sample_disk(u)), pdf: |_| PDF_DISK },
    Warp {
        name: "cosine hemisphere",
        domain: Domain::Sphere,
        sample: sample_cosine_hemisphere,
        pdf: |w| pdf_cosine_hemisphere(w.z),
    },
    Warp {
        name: "uniform hemisphere",
        domain: Domain::Sphere,
        sample: sample_uniform_hemisphere,
        pdf: |w| if w.z >= 0.0 { PDF_UNIFORM_HEMISPHERE } else { 0.0 },
    },
    Warp { name: "uniform sphere", domain: Domain::Sphere, sample: sample_uniform_sphere, pdf: |_| PDF_UNIFORM_SPHERE },
    Warp {
        name: "cone",
        domain: Domain::Sphere,
        sample: |u| sample_cone(u, CONE),
        pdf: |w| if 1.0 - w.z <= CONE { pdf_cone(CONE) } else { 0.0 },
    },
    Warp {
        name: "elliptic cone",
        domain: Domain::Sphere,
        sample: |u| ELLIPSE.sample(u).0.as_vec3(),
        pdf: |w| match on_plane(w) {
            Some(at) if at.length_squared() <= 1.0 => ELLIPSE.pdf(w.as_dvec3()) as f32,
            _ => 0.0,
        },
    },
    Warp {
        name: "spherical rectangle",
        domain: Domain::Sphere,
        sample: |u| DVec2::from(RECT.sample(u)).extend(AT.z).normalize().as_vec3(),
        pdf: |w| match on_plane(w) {
            Some(at) if at.abs().max_element() <= 1.0 => (1.0 / RECT.solid_angle()) as f32,
            _ => 0.0,
        },
    },
    Warp { name: "triangle", domain: Domain::Triangle, sample: |u| Vec3::from(sample_triangle(u)), pdf: |_| 1.0 },
    Warp {
        name: "bilinear image",
        domain: Domain::Square,
        sample: |u| {
            let p = BILINEAR.sample(u.map(|u| f64::from(u) + 2.0_f64.powi(-25)), bilinear_weight).p;
            disk(p.map(|p| (p as f32).min(1.0 - f32::EPSILON)))
        },
        pdf: |p| BILINEAR.pdf([p.x.into(), p.y.into()], bilinear_weight) as f32,
    },
    Warp { name: "image", domain: Domain::Square, sample: |u| disk(IMAGE.sample(u).p), pdf: |p| IMAGE.pdf([p.x, p.y]) },
];

fn disk([x, y]: [f32; 2]) -> Vec3 {
    Vec3::new(x, y, 0.0)
}

#[test]
fn samples_follow_the_density_and_it_integrates_to_one() {
    let grid = chi2::Grid { nx: 23, ny: 31 };
    let n = 300_000;
    for warp in WARPS {
        let density = |x, y| f64::from((warp.pdf)(warp.domain.of_square(x, y))) * warp.domain.measure();
        let mass = grid.integrals(&density, 1e-7);
        let total: f64 = mass.iter().sum();
        assert!((total - 1.0).abs() < 1e-4, "{}: density integrates to {total}", warp.name);

        let expected: Vec<f64> = mass.iter().map(|m| m * n as f64).collect();
        let mut observed = vec![0.0; expected.len()];
        let sampler = Sampler::new(Pattern::Independent, 1);
        for i in 0..n {
            let p = (warp.sample)(sampler.for_sample(0, 0, i).get_2d(Dimension::FREE));
            observed[grid.cell(warp.domain.to_square(p))] += 1.0;
        }
        chi2::check(&observed, &expected, WARPS.len()).unwrap_or_else(|e| panic!("{}: {e}", warp.name));
    }
}

#[test]
fn all_of_the_square_maps_into_the_domain_where_the_density_is_positive() {
    let last = 1.0 - 2.0_f32.powi(-24);
    let edge: Vec<f32> = [0.0, 2.0_f32.powi(-24), 0.25, 0.5 - 2.0_f32.powi(-24), 0.5, 0.75, last].into();
    let inner = (0..100).map(|i| (i as f32 * 0.618_034).fract());
    let all: Vec<f32> = edge.into_iter().chain(inner).collect();
    for warp in WARPS {
        for &u in &all {
            for &v in &all {
                let p = (warp.sample)([u, v]);
                assert!(warp.domain.contains(p), "{} {u} {v}: {p}", warp.name);
                // At a border rounding decides.
                let borders = ["cone", "elliptic cone", "spherical rectangle"].contains(&warp.name);
                assert!(borders || (warp.pdf)(p) > 0.0, "{} {u} {v}: {p}", warp.name);
            }
        }
    }
}

#[test]
fn alias_table_follows_its_weights() {
    let weights: Vec<f64> = (0..200).map(|i| if i % 7 == 0 { 0.0 } else { f64::from(i * i) }).collect();
    let table = AliasTable::new(&weights).unwrap();
    let n = 300_000;
    let sampler = Sampler::new(Pattern::Independent, 2);
    let mut observed = vec![0.0; weights.len()];
    for i in 0..n {
        observed[table.sample(sampler.for_sample(0, 0, i).get_1d(Dimension::FREE)).index] += 1.0;
    }
    let expected: Vec<f64> = (0..weights.len()).map(|i| f64::from(table.pmf(i)) * n as f64).collect();
    chi2::check(&observed, &expected, 1).unwrap();
}
