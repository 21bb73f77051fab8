//! Hair curves and point clouds, from the arrays that Blender keeps them in.

use std::ops::Range;
use std::sync::Arc;

use super::mesh::LayerArray;
use super::motion::{self, MovedPoints};
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
    /// True where points at other times will follow.
    pub moving: bool,
}

/// Strands or points, and what their UV sets are called.
#[derive(Debug)]
pub struct NamedRounds {
    rounds: Arc<RoundsDesc>,
    uv_names: Vec<Arc<str>>,
    /// What they were made of; kept for those that move.
    source: Option<Source>,
    /// As it was asked for last, and with which maps.
    dressed: Option<(Vec<String>, Arc<RoundsDesc>)>,
}

/// Points as they were handed over.
#[derive(Debug)]
struct Source {
    points: Vec<[f32; 3]>,
    radii: Vec<f32>,
    ends: Vec<u32>,
    smooth: bool,
}

impl Source {
    /// Where the points of the description are while those of the source are at `moved`.
    fn laid_out(&self, moved: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let (mut points, mut radii) = (Vec::new(), Vec::new());
        for range in ranges(self.points.len(), &self.ends).filter(|range| usable(&self.points, &self.radii, range)) {
            let at = &moved[range.clone()];
            if self.smooth {
                smooth::flatten_like(&self.points[range.clone()], at, &self.radii[range], &mut points, &mut radii);
            } else {
                points.extend_from_slice(at);
            }
        }
        points
    }
}

/// The points of each strand, or of each ball where no strand ends.
fn ranges<'a>(points: usize, ends: &'a [u32]) -> impl Iterator<Item = Range<usize>> + 'a {
    let count = if ends.is_empty() { points } else { ends.len() };
    let end = move |strand: usize| if ends.is_empty() { strand + 1 } else { ends[strand] as usize };
    (0..count).map(move |strand| if strand == 0 { 0 } else { end(strand - 1) }..end(strand))
}

/// True for points that are there and finite.
fn usable(points: &[[f32; 3]], radii: &[f32], range: &Range<usize>) -> bool {
    let finite = |i: usize| points[i].iter().all(|x| x.is_finite()) && radii[i].is_finite();
    !range.is_empty() && range.clone().all(finite)
}

impl NamedRounds {
    /// Takes in where the points are at other times of the shutter. Points that move out of number or whose count
    /// changes are told, and stand still.
    pub fn set_motion(&mut self, moved: &[MovedPoints<'_>], blurred: bool, warnings: &mut Warnings) {
        let Some(source) = &self.source else { return };
        self.dressed = None;
        let fits = |moved: &MovedPoints<'_>| moved.positions.len() == 3 * source.points.len();
        let rounds = Arc::make_mut(&mut self.rounds);
        let laid_out = |moved: &MovedPoints<'_>| (moved.time, source.laid_out(moved.positions.as_chunks::<3>().0));
        let same_count = moved.iter().all(fits);
        let others: Vec<_> = if same_count { moved.iter().map(laid_out).collect() } else { Vec::new() };
        if same_count && others.iter().flat_map(|(_, points)| points).flatten().all(|x| x.is_finite()) {
            rounds.motion = motion::keys(&rounds.points, others);
        } else {
            motion::tell_of_still(&rounds.name, &rounds.place, same_count, blurred, warnings);
            rounds.motion.clear();
        }
    }

    /// Names of the UV maps; the first is the one to render with.
    pub fn uv_names(&self) -> &[Arc<str>] {
        &self.uv_names
    }

    /// With the map to render with as set 0 and those of `uv_maps` after it; the same one as long as they are.
    pub fn dressed(&mut self, uv_maps: &[String]) -> Arc<RoundsDesc> {
        if self.uv_names.is_empty() || uv_maps.is_empty() {
            return self.rounds.clone();
        }
        if let Some((known, rounds)) = &self.dressed
            && known == uv_maps
        {
            return rounds.clone();
        }
        let named = |name: &String| {
            let index = self.uv_names.iter().position(|known| **known == **name);
            // 0 everywhere for a map that the hair lacks, as in Cycles.
            index.map_or_else(|| vec![[0.0, 1.0]; self.rounds.points.len()], |index| self.rounds.uvs[index].clone())
        };
        let first = self.rounds.uvs[0].clone();
        let uvs = std::iter::once(first).chain(uv_maps.iter().map(named)).collect();
        let rounds = Arc::new(RoundsDesc { uvs, ..RoundsDesc::clone(&self.rounds) });
        self.dressed = Some((uv_maps.to_vec(), rounds.clone()));
        rounds
    }
}

/// Strands of `positions` (three numbers each) and `radii`, with UV maps that hold one pair for each strand, and attributes
/// of four numbers for each point or each strand.
///
/// # Errors
/// Arrays whose lengths don't fit together. Strands and points that are not finite are told and left out.
pub fn rounds(
    name: &str,
    place: &Place,
    positions: &[f32],
    radii: &[f32],
    ends: Ends<'_>,
    [uvs, attributes]: [&[LayerArray<'_>]; 2],
    warnings: &mut Warnings,
) -> Result<NamedRounds> {
    let Ends { points: ends, smooth, moving } = ends;
    let (points, rest) = positions.as_chunks::<3>();
    let broken = |what: String| Error::invalid(place, format!("\"{name}\" {what}"));
    if !rest.is_empty() || radii.len() != points.len() {
        return Err(broken(format!("has {} radii for {} points", radii.len(), points.len())));
    }
    let grows = ends.windows(2).all(|pair| pair[0] <= pair[1]);
    if !grows || ends.last().is_some_and(|&end| end as usize != points.len()) {
        return Err(broken(format!("has curves that do not end at its {} points", points.len())));
    }
    if let Some(layer) = uvs.iter().find(|layer| layer.values.len() != 2 * ends.len()) {
        let given = layer.values.len() / 2;
        return Err(broken(format!("has a UV map \"{}\" of {given} pairs for {} strands", layer.name, ends.len())));
    }
    if let Some(layer) =
        attributes.iter().find(|layer| ![4 * points.len(), 4 * ends.len()].contains(&layer.values.len()))
    {
        let (name, given) = (layer.name, layer.values.len() / 4);
        return Err(broken(format!("has an attribute \"{name}\" of {given} values for {} points", points.len())));
    }
    let mut desc = RoundsDesc { name: name.into(), place: place.clone(), ..RoundsDesc::default() };
    desc.uvs = vec![Vec::new(); uvs.len()];
    desc.attributes = attributes.iter().map(|layer| (layer.name.into(), Vec::new())).collect();
    let mut left_out = 0;
    for (strand, range) in ranges(points.len(), ends).enumerate() {
        if !usable(points, radii, &range) {
            left_out += usize::from(!range.is_empty());
            continue;
        }
        let (at, thick) = (&points[range.clone()], &radii[range.clone()]);
        if smooth {
            smooth::flatten(at, thick, &mut desc.points, &mut desc.radii);
        } else {
            desc.points.extend_from_slice(at);
            desc.radii.extend(thick.iter().map(|radius| radius.max(0.0)));
        }
        for ((_, to), layer) in desc.attributes.iter_mut().zip(attributes) {
            let values = layer.values.as_chunks::<4>().0;
            if values.len() != points.len() {
                to.resize(desc.points.len(), values[strand]);
            } else if smooth {
                smooth::spread(at, thick, &values[range.clone()], to);
            } else {
                to.extend_from_slice(&values[range.clone()]);
            }
        }
        for (set, layer) in desc.uvs.iter_mut().zip(uvs) {
            // Blender's v grows upwards.
            set.resize(desc.points.len(), [layer.values[2 * strand], 1.0 - layer.values[2 * strand + 1]]);
        }
        if !ends.is_empty() {
            desc.strands.push(Strand { end: desc.points.len() as u32, closed: false });
        }
    }
    if left_out > 0 {
        warnings.push(place, format!("{left_out} strands or points of \"{name}\" are not finite; they are left out"));
    }
    let uv_names = uvs.iter().map(|layer| layer.name.into()).collect();
    let source = moving.then(|| Source { points: points.to_vec(), radii: radii.to_vec(), ends: ends.to_vec(), smooth });
    Ok(NamedRounds { rounds: desc.into(), uv_names, source, dressed: None })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(positions: &[f32], radii: &[f32], ends: &[u32]) -> (Result<Arc<RoundsDesc>>, usize) {
        let mut warnings = Warnings::new();
        let ends = Ends { points: ends, ..Ends::default() };
        let made = rounds("Fur", &Place::default(), positions, radii, ends, [&[], &[]], &mut warnings);
        (made.map(|mut made| made.dressed(&[])), warnings.len())
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
        assert_eq!((desc.points.len(), &desc.radii, desc.strands.len(), said), (2, &vec![0.0, 0.1], 1, 1));
        let (desc, said) = made(&positions, &[0.1; 4], &[]);
        assert_eq!((desc.unwrap().points.len(), said), (3, 1));
    }

    #[test]
    fn a_strand_has_one_place_on_each_map() {
        let positions: Vec<f32> = (0..15).map(|i| i as f32).collect();
        let ends = Ends { points: &[2, 5], ..Ends::default() };
        let layer = |name, values| LayerArray { name, values };
        let maps = [layer("first", &[0.1, 0.2, 0.3, 0.4][..]), layer("second", &[0.5, 0.6, 0.7, 0.8])];
        let mut warnings = Warnings::new();
        let mut made =
            rounds("Fur", &Place::default(), &positions, &[0.1; 5], ends, [&maps, &[]], &mut warnings).unwrap();
        let named = made.dressed(&["second".into(), "third".into()]);
        assert_eq!(named.uvs[0], [[0.1, 0.8], [0.1, 0.8], [0.3, 0.6], [0.3, 0.6], [0.3, 0.6]]);
        assert_eq!(named.uvs[1][4], [0.7, 1.0 - 0.8]);
        assert_eq!(named.uvs[2], [[0.0, 1.0]; 5]);
        assert!(Arc::ptr_eq(&named, &made.dressed(&["second".into(), "third".into()])));
        let short = [layer("first", &[0.1, 0.2][..])];
        assert!(rounds("Fur", &Place::default(), &positions, &[0.1; 5], ends, [&short, &[]], &mut warnings).is_err());
    }

    #[test]
    fn attributes_are_of_points_or_of_strands() {
        // The first strand is not finite.
        let positions = [f32::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0];
        let of_points: Vec<f32> = (0..16).map(|i| i as f32).collect();
        let of_strands = [9.0, 9.0, 9.0, 9.0, 1.0, 2.0, 3.0, 4.0];
        let layers =
            [LayerArray { name: "points", values: &of_points }, LayerArray { name: "strands", values: &of_strands }];
        let mut warnings = Warnings::new();
        for smooth in [false, true] {
            let ends = Ends { points: &[1, 4], smooth, moving: false };
            let made = rounds("Fur", &Place::default(), &positions, &[0.1; 4], ends, [&[], &layers], &mut warnings);
            let desc = made.unwrap().dressed(&[]);
            let [points, strands] = [0, 1].map(|i| desc.attributes[i].1.clone());
            assert!(points.len() == desc.points.len() && strands == vec![[1.0, 2.0, 3.0, 4.0]; points.len()]);
            assert_eq!((points[0][0], points[points.len() - 1][0]), (4.0, 12.0));
            let middle = desc.points.iter().position(|p| *p == [1.0, 0.0, 0.0]).unwrap();
            assert_eq!(points[middle][0], 8.0);
        }
        let few = [LayerArray { name: "few", values: &of_points[..12] }];
        let ends = Ends { points: &[1, 4], ..Ends::default() };
        assert!(rounds("Fur", &Place::default(), &positions, &[0.1; 4], ends, [&[], &few], &mut warnings).is_err());
    }

    /// A strand that is left out is left out at all times, and a bend keeps its count of pieces.
    #[test]
    fn points_move_with_the_strands_that_they_are_on() {
        let positions = [f32::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0];
        let ends = Ends { points: &[1, 4], smooth: true, moving: true };
        let mut warnings = Warnings::new();
        let mut made =
            rounds("Fur", &Place::default(), &positions, &[0.1; 4], ends, [&[], &[]], &mut warnings).unwrap();
        let still = made.dressed(&[]);
        assert!(still.motion.is_empty());
        let moved = [9.0, 9.0, 9.0, 0.0, 0.0, 0.5, 1.0, 0.0, 0.5, 1.0, 1.0, 0.5];
        made.set_motion(&[MovedPoints { time: 0.5, positions: &moved }], true, &mut warnings);
        let desc = made.dressed(&[]);
        assert_eq!((desc.motion.len(), desc.motion[0].time, &desc.motion[0].value), (2, 0.0, &still.points));
        let after = &desc.motion[1];
        assert_eq!((after.time, after.value.len()), (0.5, still.points.len()));
        let lifted = |(now, then): (&[f32; 3], &[f32; 3])| now[..2] == then[..2] && (then[2] - 0.5).abs() < 1e-6;
        assert!(still.points.iter().zip(&after.value).all(lifted), "{:?}", after.value);
        assert_eq!(warnings.len(), 1);
        made.set_motion(&[MovedPoints { time: 0.5, positions: &moved[3..] }], true, &mut warnings);
        assert!(made.dressed(&[]).motion.is_empty() && warnings.len() == 2);
    }

    #[test]
    fn arrays_that_do_not_fit_are_errors() {
        assert!(made(&[0.0; 6], &[0.1], &[]).0.is_err());
        assert!(made(&[0.0; 6], &[0.1; 2], &[3]).0.is_err());
        assert!(made(&[0.0; 6], &[0.1; 2], &[2, 1]).0.is_err());
    }
}
