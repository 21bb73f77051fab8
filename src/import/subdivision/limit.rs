//! Where refinement for ever would take a value: eigenvectors of the subdivision matrices
//! (M. Halstead, M. Kass, T. DeRose, "Efficient, fair interpolation using Catmull-Clark surfaces", 1993;
//! H. Hoppe et al., "Piecewise smooth surface reconstruction", 1994).

use rayon::prelude::*;

use super::masks::{TASK, add, narrow};
use super::rules::Rules;
use super::topology::Topology;
use super::{Scheme, settle};

/// The values at the limit, one for each point. The faces are quads (Catmull-Clark) or triangles (Loop).
/// What sharpness still changes further down is `settle.rs`'s.
pub(super) fn positions<const N: usize>(
    topology: &Topology,
    rules: &Rules,
    scheme: Scheme,
    values: &[[f32; N]],
) -> Vec<[f32; N]> {
    let one = |(point, value)| limit(topology, rules, scheme, values, point, value);
    values.par_iter().with_min_len(TASK).enumerate().map(one).collect()
}

fn limit<const N: usize>(
    topology: &Topology,
    rules: &Rules,
    scheme: Scheme,
    values: &[[f32; N]],
    point: usize,
    value: &[f32; N],
) -> [f32; N] {
    let rule = &rules.points[point];
    let (corner, crease) = (f64::from(rule.corner), f64::from(rule.crease));
    let smooth = 1.0 - corner - crease;
    let around = topology.around(point);
    if around.len() == 0 || corner == 1.0 && !rule.open {
        return *value;
    }
    if rule.open
        && let Some(settled) = settle::limit(topology, rules, scheme, values, point)
    {
        return narrow(settled);
    }
    // Where faces form no fan what sharpness is left mixes as it does one level down.
    let mut sum = [0.0; N];
    add(&mut sum, value, corner + crease * 4.0 / 6.0);
    if crease > 0.0 {
        rule.ends.iter().for_each(|&end| add(&mut sum, &values[end as usize], crease / 6.0));
    }
    if smooth > 0.0 {
        let n = around.len() as f64;
        let (edge, face) = settle::smooth(scheme, n);
        add(&mut sum, value, smooth * (1.0 - n * (edge + face)));
        for corner in around {
            let next = topology.next(corner);
            add(&mut sum, &values[topology.point(next)], smooth * edge);
            if face > 0.0 {
                add(&mut sum, &values[topology.point(topology.next(next))], smooth * face);
            }
        }
    }
    narrow(sum)
}
