//! Makes `energy.bin`: averages at the nodes, raised where what is interpolated between them would fall short of
//! what is so. What counts as lost is then never more than is lost, and white surfaces do not shine.

use rayon::prelude::*;

use super::energy::{COS_NODES, EDGE_SCALE, ETA_NODES, LAST_ETA, Plain, ROUGHNESS_NODES, Refractive, TABLES};
use super::quadrature::Seen;
use crate::math::sqr;

/// Values at nodes and halfway between them, by side and index of refraction, roughness and angle; sides and indices
/// are one axis of length 1 where there are none.
struct Grid {
    /// Nodes along each axis.
    nodes: [usize; 3],
    fine: Vec<f32>,
}

/// How many places there are with those halfway.
fn halves(nodes: usize) -> usize {
    2 * nodes - 1
}

impl Grid {
    fn new(nodes: [usize; 3], value: impl Fn([usize; 3]) -> f32) -> Self {
        let [a, b, c] = nodes.map(halves);
        let fine = (0..a * b * c).map(|at| value([at / (b * c), at / c % b, at % c])).collect();
        Self { nodes, fine }
    }

    fn at(&self, [a, b, c]: [usize; 3]) -> f32 {
        let [_, y, z] = self.nodes.map(halves);
        self.fine[(a * y + b) * z + c]
    }

    fn places(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [a, b, c] = self.nodes.map(halves);
        (0..a * b * c).map(move |at| [at / (b * c), at / c % b, at % c])
    }

    /// The nodes around a place.
    fn corners(&self, place: [usize; 3]) -> Vec<usize> {
        let [_, y, z] = self.nodes;
        let ends = place.map(|at| [at / 2, at.div_ceil(2)]);
        let mut corners: Vec<usize> = (0..8)
            .map(|corner| {
                let [a, b, c] = std::array::from_fn(|axis| ends[axis][corner >> axis & 1]);
                (a * y + b) * z + c
            })
            .collect();
        corners.sort_unstable();
        corners.dedup();
        corners
    }

    /// The values at the nodes themselves.
    fn plain(&self) -> Vec<f32> {
        let even = |[a, b, c]: [usize; 3]| a % 2 == 0 && b % 2 == 0 && c % 2 == 0;
        self.places().filter(|place| even(*place)).map(|place| self.at(place)).collect()
    }

    /// `values` at the nodes, interpolated.
    fn between(&self, values: &[f32], place: [usize; 3]) -> f32 {
        let corners = self.corners(place);
        corners.iter().map(|&node| values[node]).sum::<f32>() / corners.len() as f32
    }

    /// `values` at the nodes, raised until they are short of what `wanted` says at no place.
    fn raised(&self, values: &[f32], wanted: impl Fn([usize; 3]) -> f32) -> Vec<f32> {
        let mut raise = vec![0.0_f32; values.len()];
        for place in self.places() {
            let short = wanted(place) - self.between(values, place);
            for node in self.corners(place) {
                raise[node] = raise[node].max(short);
            }
        }
        values.iter().zip(raise).map(|(value, raise)| value + raise).collect()
    }
}

/// 2 ∫ E(μ) μ dμ for E linear in t = √μ between the nodes: 4 ∫ E t³ dt.
fn cosine_average(row: &[f32]) -> f32 {
    let h = 1.0 / (COS_NODES - 1) as f32;
    let mut sum = 0.0;
    for (i, pair) in row.windows(2).enumerate() {
        let (a, b) = (i as f32 * h, (i + 1) as f32 * h);
        let slope = (pair[1] - pair[0]) / h;
        sum += (pair[0] - slope * a) * (b.powi(4) - a.powi(4)) + 0.8 * slope * (b.powi(5) - a.powi(5));
    }
    sum
}

/// Square of a place as a share of the whole axis.
fn squared(place: usize, nodes: usize) -> f32 {
    sqr(place as f32 / (halves(nodes) - 1) as f32)
}

/// Indices between 1 and that of the next node, within which all changes near grazing: what is raised for them would be
/// so for 1 itself.
fn near_none(place: [usize; 3]) -> bool {
    place[0] == 1
}

fn eta_at(place: usize) -> f32 {
    let root = sqr(LAST_ETA) * squared(place, ETA_NODES);
    (1.0 + root) / (1.0 - root)
}

#[test]
#[ignore = "writes src/bsdf/energy.bin"]
fn write_tables() {
    let (etas, rows, columns) = (halves(ETA_NODES), halves(ROUGHNESS_NODES), halves(COS_NODES));
    let known: Vec<(Plain, Vec<Refractive>)> = (0..rows * columns)
        .into_par_iter()
        .map(|at| {
            let seen = Seen::new(squared(at / columns, ROUGHNESS_NODES), squared(at % columns, COS_NODES));
            let all = (0..2 * etas).map(|k| if k < etas { eta_at(k) } else { 1.0 / eta_at(k - etas) });
            (seen.plain(), all.map(|eta| seen.refractive(eta)).collect())
        })
        .collect();
    let of = |[_, j, i]: [usize; 3]| &known[j * columns + i];
    let flat = [1, ROUGHNESS_NODES, COS_NODES];
    let reflected = Grid::new(flat, |place| of(place).0.reflected);
    let reflected_nodes = reflected.raised(&reflected.plain(), |place| reflected.at(place));
    let schlick = Grid::new(flat, |place| of(place).0.reflected_schlick).plain();
    let edges = Grid::new(flat, |place| of(place).0.reflected_edge).plain();
    let averages: Vec<f32> = reflected_nodes.chunks(COS_NODES).map(cosine_average).collect();

    let (mut blends, mut refracted, mut glass) = (Vec::new(), Vec::new(), Vec::new());
    for side in 0..2 {
        let grid = |value: fn(&Refractive) -> f32| {
            Grid::new([ETA_NODES, ROUGHNESS_NODES, COS_NODES], |place| value(&of(place).1[side * etas + place[0]]))
        };
        let (s, w, v) = (grid(|r| r.reflected_blend), grid(|r| r.refracted), grid(|r| r.refracted_blend));
        // The critical angle is a step, which is no less for being raised beside it: only the sum is held.
        let s_nodes = if side == 0 {
            s.raised(&s.plain(), |place| if near_none(place) { 0.0 } else { s.at(place) })
        } else {
            s.plain()
        };
        let v_nodes = v.plain();
        // What is reflected more does not pass: at the nodes the sum stays.
        let w_less: Vec<f32> =
            w.plain().iter().zip(s.plain().iter().zip(&s_nodes)).map(|(w, (s, t))| w + s - t).collect();
        let w_nodes = w.raised(&w_less, |place| {
            if near_none(place) {
                return 0.0;
            }
            let f0 = sqr((eta_at(place[0]) - 1.0) / (eta_at(place[0]) + 1.0));
            let e = |values: &[f32]| reflected.between(values, [0, place[1], place[2]]);
            let sum = |e: f32, s: f32, w: f32, v: f32| f0 * (e - s) + s + (1.0 - f0) * (w - v);
            let kept = sum(of(place).0.reflected, s.at(place), w.at(place), v.at(place));
            let [s, v] = [&s_nodes, &v_nodes].map(|values| w.between(values, place));
            // What W has to be for the sum to be that.
            (kept - sum(e(&reflected_nodes), s, 0.0, v)) / (1.0 - f0)
        });
        for (k, (s, (w, v))) in
            s_nodes.chunks(COS_NODES).zip(w_nodes.chunks(COS_NODES).zip(v_nodes.chunks(COS_NODES))).enumerate()
        {
            let (eta, row) = (eta_at(2 * (k / ROUGHNESS_NODES)), k % ROUGHNESS_NODES);
            let f0 = sqr((eta - 1.0) / (eta + 1.0));
            let e = &reflected_nodes[row * COS_NODES..][..COS_NODES];
            let kept: Vec<f32> =
                (0..COS_NODES).map(|i| f0 * (e[i] - s[i]) + s[i] + (1.0 - f0) * (w[i] - v[i])).collect();
            glass.push(cosine_average(&kept));
        }
        blends.extend(s_nodes);
        refracted.extend(w_nodes.into_iter().zip(v_nodes).flat_map(|(w, v)| [w, v]));
    }
    let plain = reflected_nodes.iter().zip(schlick).flat_map(|(e, c)| [*e, c]);
    let edges = edges.into_iter().map(|edge| edge * EDGE_SCALE);
    let values = plain.chain(averages).chain(blends).chain(refracted).chain(edges).chain(glass);
    let bytes: Vec<u8> = values.flat_map(|v| ((v.clamp(0.0, 1.0) * 65535.0).round() as u16).to_le_bytes()).collect();
    assert_eq!(bytes.len(), TABLES.len());
    std::fs::write(concat!(env!("CARGO_MANIFEST_DIR"), "/src/bsdf/energy.bin"), bytes).unwrap();
}
