//! Hair curves and point clouds, from the arrays that Blender keeps them in.

use super::smooth;
use crate::desc::{RoundsDesc, Strand};
use crate::error::{Error, Place, Result, Warnings};

/// Where strands end, and what they are between their points.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ends<'a> {
    /// The points behind the last one of each strand, in order; none for points that stand alone.
    pub points: &'a [u32],
    /// Catmull-Rom splines, as Cycles has them; else straight.
    pub smooth: bool,
}

/// Strands of `positions` (three numbers each) and `radii`.
///
/// # Errors
/// Arrays whose lengths don't fit together. Strands and points that are not finite are told and left out.
pub fn rounds(
    name: &str,
    place: &Place,
    positions: &[f32],
    radii: &[f32],
    ends: Ends<'_>,
    warnings: &mut Warnings,
) -> Result<RoundsDesc> {
    let Ends { points: ends, smooth } = ends;
    let (points, rest) = positions.as_chunks::<3>();
    let broken = |what: String| Error::invalid(place, format!("\"{name}\" {what}"));
    if !rest.is_empty() || radii.len() != points.len() {
        return Err(broken(format!("has {} radii for {} points", radii.len(), points.len())));
    }
    let grows = ends.windows(2).all(|pair| pair[0] <= pair[1]);
    if !grows || ends.last().is_some_and(|&end| end as usize != points.len()) {
        return Err(broken(format!("has curves that do not end at its {} points", points.len())));
    }
    let usable = |i: usize| points[i].iter().all(|x| x.is_finite()) && radii[i].is_finite();
    let alone: Vec<u32>;
    let ranges = match ends {
        [] => {
            alone = (1..=points.len() as u32).collect();
            &alone
        }
        ends => ends,
    };
    let mut desc = RoundsDesc { name: name.into(), place: place.clone(), ..RoundsDesc::default() };
    let (mut start, mut left_out) = (0, 0);
    for &end in ranges {
        let range = start..end as usize;
        start = end as usize;
        if range.is_empty() {
            continue;
        }
        if !range.clone().all(usable) {
            left_out += 1;
            continue;
        }
        if smooth {
            smooth::flatten(&points[range.clone()], &radii[range], &mut desc.points, &mut desc.radii);
        } else {
            desc.points.extend_from_slice(&points[range.clone()]);
            desc.radii.extend(radii[range].iter().map(|radius| radius.max(0.0)));
        }
        if !ends.is_empty() {
            desc.strands.push(Strand { end: desc.points.len() as u32, closed: false });
        }
    }
    if left_out > 0 {
        warnings.push(place, format!("{left_out} strands or points of \"{name}\" are not finite; they are left out"));
    }
    Ok(desc)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(positions: &[f32], radii: &[f32], ends: &[u32]) -> (Result<RoundsDesc>, usize) {
        let mut warnings = Warnings::new();
        let ends = Ends { points: ends, smooth: false };
        let desc = rounds("Fur", &Place::default(), positions, radii, ends, &mut warnings);
        (desc, warnings.len())
    }

    #[test]
    fn strands_end_where_they_say_and_points_stand_alone() {
        let positions: Vec<f32> = (0..15).map(|i| i as f32).collect();
        let (desc, said) = made(&positions, &[0.1; 5], &[2, 2, 5]);
        let desc = desc.unwrap();
        assert_eq!(
            (desc.points.len(), desc.strands.iter().map(|s| s.end).collect::<Vec<_>>(), said),
            (5, vec![2, 5], 0)
        );
        let (desc, _) = made(&positions, &[0.1; 5], &[]);
        assert!(desc.unwrap().strands.is_empty());
    }

    #[test]
    fn what_is_not_finite_is_left_out_and_told() {
        let mut positions = [0.5_f32; 12];
        positions[4] = f32::NAN;
        let (desc, said) = made(&positions, &[0.1, 0.1, -1.0, 0.1], &[2, 4]);
        let desc = desc.unwrap();
        assert_eq!((desc.points.len(), desc.radii, desc.strands.len(), said), (2, vec![0.0, 0.1], 1, 1));
        let (desc, said) = made(&positions, &[0.1; 4], &[]);
        assert_eq!((desc.unwrap().points.len(), said), (3, 1));
    }

    #[test]
    fn arrays_that_do_not_fit_are_errors() {
        assert!(made(&[0.0; 6], &[0.1], &[]).0.is_err());
        assert!(made(&[0.0; 6], &[0.1; 2], &[3]).0.is_err());
        assert!(made(&[0.0; 6], &[0.1; 2], &[2, 1]).0.is_err());
    }
}
