//! What single scattering at GGX microfacets keeps, tabulated: albedos for layering, and the factors
//! that give back what scatters more than once.
//!
//! With w = G2/G1 of a visible normal, averaged over the normals that `wo` sees, and s going from 0
//! at normal incidence to 1 at grazing as Fresnel's reflectance does (`Dielectric::blend`):
//!
//! E = ⟨w⟩ over reflections, C = ⟨w (1 − cos)⁵⟩, S = ⟨w s⟩; W = ⟨w⟩ over refractions, V = ⟨w s⟩.
//!
//! Albedos are linear in these for any tint. The lost energy is given back by scaling, as in
//! Emmanuel Turquin, *Practical Multiple Scattering Compensation for Microfacet Models*, 2019, with
//! the color of several bounces by Kulla and Conty 2017. The tables are made once, on first use, by
//! a midpoint rule over the visible normals.

use std::sync::LazyLock;

use super::fresnel::{Dielectric, refract, schlick};
use super::ggx::{Ggx, MIN_ALPHA};
use super::reflection::reflect;
use crate::math::{Rgb, Vec3, safe_sqrt, sqr};

/// Nodes in √cos θ, so that they are dense at grazing angles.
const COS_NODES: usize = 24;
/// Nodes in roughness.
const ROUGHNESS_NODES: usize = 16;
/// Nodes in ∜F0, each for an index and for its inverse.
const ETA_NODES: usize = 16;
/// ∜F0 of the last node: an index near 20.
const LAST_ETA: f32 = 0.95;
/// Normals per node: azimuths of half a turn, then heights.
const AZIMUTHS: usize = 12;
const HEIGHTS: usize = 16;

static TABLES: LazyLock<Tables> = LazyLock::new(Tables::new);

/// Averages that don't depend on the index of refraction.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Plain {
    /// E of the file's head.
    pub reflected: f32,
    /// C.
    pub reflected_schlick: f32,
    /// 2 ∫ E(μ) μ dμ.
    pub reflected_average: f32,
}

/// Averages for an index of refraction.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Refractive {
    /// S of the file's head.
    pub reflected_blend: f32,
    /// W.
    pub refracted: f32,
    /// V.
    pub refracted_blend: f32,
}

struct Tables {
    plain: Vec<[Plain; COS_NODES]>,
    /// First indices above 1, then their inverses.
    refractive: [Vec<[[Refractive; COS_NODES]; ROUGHNESS_NODES]>; 2],
}

/// The tables at one roughness and angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Energy {
    cos: (usize, f32),
    roughness: (usize, f32),
}

impl Energy {
    /// For `cos` of the angle to the camera and for roughness √α.
    pub fn at(cos: f32, alpha: f32) -> Self {
        Self { cos: split(cos.sqrt(), COS_NODES), roughness: split(alpha.sqrt(), ROUGHNESS_NODES) }
    }

    pub fn plain(&self) -> Plain {
        let (j, v) = self.roughness;
        let (i, u) = self.cos;
        let row = |j: usize| TABLES.plain[j][i].lerp(TABLES.plain[j][i + 1], u);
        row(j).lerp(row(j + 1), v)
    }

    pub fn refractive(&self, eta: f32) -> Refractive {
        let table = &TABLES.refractive[usize::from(eta < 1.0)];
        let fourth_root = ((eta - 1.0) / (eta + 1.0)).abs().sqrt();
        let (k, w) = split(fourth_root / LAST_ETA, ETA_NODES);
        let (j, v) = self.roughness;
        let (i, u) = self.cos;
        let row = |k: usize, j: usize| table[k][j][i].lerp(table[k][j][i + 1], u);
        let slice = |k: usize| row(k, j).lerp(row(k, j + 1), v);
        slice(k).lerp(slice(k + 1), w)
    }
}

/// Factor for a reflection whose mean Fresnel reflectance is `fresnel_average`: 1/E for white.
pub(super) fn compensation(plain: Plain, fresnel_average: Rgb) -> Rgb {
    let (e, average) = (plain.reflected, plain.reflected_average);
    fresnel_average.map(|f| 1.0 + f * average / (1.0 - f * (1.0 - average)) * (1.0 - e) / e)
}

/// The cell of `x` in 0 to 1 between `nodes` nodes, and where in it.
fn split(x: f32, nodes: usize) -> (usize, f32) {
    let scaled = x.clamp(0.0, 1.0) * (nodes - 1) as f32;
    let cell = (scaled as usize).min(nodes - 2);
    (cell, scaled - cell as f32)
}

impl Plain {
    fn lerp(self, o: Self, t: f32) -> Self {
        let mix = |a: f32, b: f32| a + t * (b - a);
        Self {
            reflected: mix(self.reflected, o.reflected),
            reflected_schlick: mix(self.reflected_schlick, o.reflected_schlick),
            reflected_average: mix(self.reflected_average, o.reflected_average),
        }
    }
}

impl Refractive {
    fn lerp(self, o: Self, t: f32) -> Self {
        let mix = |a: f32, b: f32| a + t * (b - a);
        Self {
            reflected_blend: mix(self.reflected_blend, o.reflected_blend),
            refracted: mix(self.refracted, o.refracted),
            refracted_blend: mix(self.refracted_blend, o.refracted_blend),
        }
    }
}

fn cos_node(i: usize) -> f32 {
    sqr(i as f32 / (COS_NODES - 1) as f32).max(1e-5)
}

fn eta_node(k: usize) -> f32 {
    let root = sqr(LAST_ETA * k as f32 / (ETA_NODES - 1) as f32);
    (1.0 + root) / (1.0 - root)
}

impl Tables {
    fn new() -> Self {
        let mut plain = vec![[Plain::default(); COS_NODES]; ROUGHNESS_NODES];
        let empty = vec![[[Refractive::default(); COS_NODES]; ROUGHNESS_NODES]; ETA_NODES];
        let mut refractive = [empty.clone(), empty];
        for j in 0..ROUGHNESS_NODES {
            let ggx = Ggx { alpha: sqr(j as f32 / (ROUGHNESS_NODES - 1) as f32).max(MIN_ALPHA) };
            for i in 0..COS_NODES {
                let normals = visible_normals(ggx, cos_node(i));
                plain[j][i] = plain_averages(&normals);
                for k in 0..ETA_NODES {
                    refractive[0][k][j][i] = refractive_averages(ggx, &normals, eta_node(k));
                    refractive[1][k][j][i] = refractive_averages(ggx, &normals, 1.0 / eta_node(k));
                }
            }
            let average = cosine_average(&plain[j]);
            plain[j].iter_mut().for_each(|p| p.reflected_average = average);
        }
        Self { plain, refractive }
    }
}

/// 2 ∫ E(μ) μ dμ for E linear in √μ between the nodes: with t = √μ, 4 ∫ E t³ dt.
fn cosine_average(row: &[Plain; COS_NODES]) -> f32 {
    let h = 1.0 / (COS_NODES - 1) as f32;
    let mut sum = 0.0;
    for (i, pair) in row.windows(2).enumerate() {
        let (a, b) = (i as f32 * h, (i + 1) as f32 * h);
        let slope = (pair[1].reflected - pair[0].reflected) / h;
        let fourth = b.powi(4) - a.powi(4);
        let fifth = b.powi(5) - a.powi(5);
        sum += (pair[0].reflected - slope * a) * fourth + 0.8 * slope * fifth;
    }
    sum
}

/// The view and the microfacet normals it sees, each of the same weight.
struct Normals {
    wo: Vec3,
    list: Vec<Normal>,
}

struct Normal {
    h: Vec3,
    cos: f32,
    /// G2/G1 of the reflection, 0 where it points below.
    weight: f32,
}

fn visible_normals(ggx: Ggx, cos: f32) -> Normals {
    let wo = Vec3::new(safe_sqrt(1.0 - cos * cos), 0.0, cos);
    let grid = (0..HEIGHTS).flat_map(|v| (0..AZIMUTHS).map(move |u| (u, v)));
    let list = grid
        .map(|(u, v)| {
            let u = [0.5 * (u as f32 + 0.5) / AZIMUTHS as f32, (v as f32 + 0.5) / HEIGHTS as f32];
            let h = ggx.sample_visible(wo, u);
            let wi = reflect(wo, h);
            Normal { h, cos: wo.dot(h).max(0.0), weight: if wi.z > 0.0 { shadowing(ggx, wo, wi) } else { 0.0 } }
        })
        .collect();
    Normals { wo, list }
}

/// G2/G1(wo).
fn shadowing(ggx: Ggx, wo: Vec3, wi: Vec3) -> f32 {
    2.0 * wi.z.abs() * ggx.visibility(wo, wi) * (wo.z + ggx.slant(wo))
}

fn plain_averages(normals: &Normals) -> Plain {
    let scale = 1.0 / normals.list.len() as f32;
    let sum = |f: &dyn Fn(&Normal) -> f32| normals.list.iter().map(f).sum::<f32>() * scale;
    Plain {
        reflected: sum(&|n| n.weight),
        reflected_schlick: sum(&|n| n.weight * schlick(n.cos)),
        reflected_average: 0.0,
    }
}

fn refractive_averages(ggx: Ggx, normals: &Normals, eta: f32) -> Refractive {
    let dielectric = Dielectric { eta, f0: Rgb::BLACK, f90: 1.0 };
    let scale = 1.0 / normals.list.len() as f32;
    let mut sum = Refractive::default();
    for n in &normals.list {
        let blend = dielectric.blend(n.cos);
        sum.reflected_blend += scale * n.weight * blend;
        if let Some(wi) = refract(normals.wo, n.h, eta).filter(|wi| wi.z < 0.0) {
            let weight = scale * shadowing(ggx, normals.wo, wi);
            sum.refracted += weight;
            sum.refracted_blend += weight * blend;
        }
    }
    sum
}
