//! Where refinement for ever would take a value: eigenvectors of the subdivision matrices
//! (M. Halstead, M. Kass, T. DeRose, "Efficient, fair interpolation using Catmull-Clark surfaces", 1993;
//! H. Hoppe et al., "Piecewise smooth surface reconstruction", 1994).

use rayon::prelude::*;

use super::Scheme;
use super::masks::{TASK, add, loop_weight, narrow};
use super::rules::{Rule, Rules};
use super::topology::Topology;

/// The values at the limit, one for each point. The faces are quads (Catmull-Clark) or triangles (Loop).
/// At the end of a sharp edge the smooth mask is close and not exact (as in OpenSubdiv).
pub(super) fn positions<const N: usize>(
    topology: &Topology,
    rules: &Rules,
    scheme: Scheme,
    values: &[[f32; N]],
) -> Vec<[f32; N]> {
    let one = |(point, value)| limit(topology, &rules.points[point], scheme, values, point, value);
    values.par_iter().with_min_len(TASK).enumerate().map(one).collect()
}

fn limit<const N: usize>(
    topology: &Topology,
    rule: &Rule,
    scheme: Scheme,
    values: &[[f32; N]],
    point: usize,
    value: &[f32; N],
) -> [f32; N] {
    // Sharpness that is left over mixes as it does one level down.
    let (corner, crease) = (f64::from(rule.corner), f64::from(rule.crease));
    let smooth = 1.0 - corner - crease;
    let around = topology.around(point);
    if corner == 1.0 || around.len() == 0 {
        return *value;
    }
    let mut sum = [0.0; N];
    add(&mut sum, value, corner + crease * 4.0 / 6.0);
    if crease > 0.0 {
        rule.ends.iter().for_each(|&end| add(&mut sum, &values[end as usize], crease / 6.0));
    }
    if smooth > 0.0 {
        let n = around.len() as f64;
        let (edge, face) = match scheme {
            Scheme::Loop => (1.0 / (3.0 / (8.0 * loop_weight(n)) + n), 0.0),
            _ => (4.0 / (n * (n + 5.0)), 1.0 / (n * (n + 5.0))),
        };
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
