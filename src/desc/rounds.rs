//! Strands of hair, wires and point clouds, as authored.

use std::sync::Arc;

use super::Motion;
use crate::error::Place;

/// Balls that stand alone, or strands of balls: round tubes whose radius changes evenly from each point
/// to the next, round at open ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RoundsDesc {
    /// Name.
    pub name: Arc<str>,
    /// Where it stands in the file.
    pub place: Place,
    /// Centres, in metres before the instance's transform.
    pub points: Vec<[f32; 3]>,
    /// Radius of each point, in the same unit.
    pub radii: Vec<f32>,
    /// Which points follow each other, strand by strand; empty where every point is a ball by itself.
    pub strands: Vec<Strand>,
    /// UV sets, of each point; v grows downwards in the image.
    pub uvs: Vec<Vec<[f32; 2]>>,
    /// Linear colour of each point, straight alpha; multiplied onto the base colour.
    pub colors: Option<Vec<[f32; 4]>>,
    /// Values of each point that graphs ask for by name, as in [`super::NamedAttribute`].
    pub attributes: Vec<(Arc<str>, Vec<[f32; 4]>)>,
    /// Index into the instance's material list for each strand, or ball; `None` for 0 everywhere.
    pub material_slots: Option<Vec<u16>>,
    /// Points at other times of the shutter, in the order of time; empty for what keeps its shape.
    pub motion: Vec<Motion<Vec<[f32; 3]>>>,
    /// Radii at each of the times of `motion`; empty for those that stay as they are.
    pub radii_motion: Vec<Vec<f32>>,
}

/// Points and radii at one time.
pub type RoundsKey<'a> = (&'a [[f32; 3]], &'a [f32]);

/// Points that follow each other: those from the end of the strand before to this one's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strand {
    /// The point behind its last one.
    pub end: u32,
    /// True where the last point leads back to the first.
    pub closed: bool,
}

impl RoundsDesc {
    /// What it is at the frame, and at other times of the shutter.
    pub fn keys(&self) -> (RoundsKey<'_>, Vec<Motion<RoundsKey<'_>>>) {
        let radii = |i: usize| self.radii_motion.get(i).unwrap_or(&self.radii).as_slice();
        let keys = self.motion.iter().enumerate();
        let motion = keys.map(|(i, m)| Motion { time: m.time, value: (m.value.as_slice(), radii(i)) });
        ((&self.points, &self.radii), motion.collect())
    }

    /// The points before, at both ends and after each segment of the strands, in their order; the point
    /// before or after an open end is the end itself. A strand of one point is a segment from it to
    /// itself. `None` where all points stand alone.
    pub fn segments(&self) -> Option<Vec<[u32; 4]>> {
        if self.strands.is_empty() {
            return None;
        }
        let mut segments = Vec::with_capacity(self.points.len());
        self.each_segment(|_, segment| segments.push(segment));
        Some(segments)
    }

    /// Material slot of each segment, or ball.
    pub fn segment_slots(&self) -> Option<Vec<u16>> {
        let slots = self.material_slots.as_ref()?;
        if self.strands.is_empty() {
            return Some(slots.clone());
        }
        let mut of_segments = Vec::with_capacity(self.points.len());
        self.each_segment(|strand, _| of_segments.push(slots[strand]));
        Some(of_segments)
    }

    fn each_segment(&self, mut visit: impl FnMut(usize, [u32; 4])) {
        let mut start = 0;
        for (i, &Strand { end, closed }) in self.strands.iter().enumerate() {
            let count = end - start;
            let closed = closed && count > 2;
            let at = |k: u32| if closed { start + k % count } else { start + k.min(count - 1) };
            let steps = if closed { count } else { (count - 1).max(1) };
            for k in 0..steps {
                let before = if closed { at(k + count - 1) } else { at(k.saturating_sub(1)) };
                visit(i, [before, at(k), at(k + 1), at(k + 2)]);
            }
            start = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rounds(count: usize, strands: &[(u32, bool)]) -> RoundsDesc {
        let strands = strands.iter().map(|&(end, closed)| Strand { end, closed }).collect();
        RoundsDesc { points: vec![[0.0; 3]; count], strands, ..RoundsDesc::default() }
    }

    #[test]
    fn segments_know_what_is_before_and_after() {
        assert_eq!(rounds(3, &[]).segments(), None);
        let open = rounds(5, &[(3, false), (4, false), (5, false)]);
        assert_eq!(open.segments().unwrap(), [[0, 0, 1, 2], [0, 1, 2, 2], [3, 3, 3, 3], [4, 4, 4, 4]]);
        let closed = rounds(6, &[(2, true), (6, true)]);
        let ring = [[5, 2, 3, 4], [2, 3, 4, 5], [3, 4, 5, 2], [4, 5, 2, 3]];
        assert_eq!(closed.segments().unwrap(), [&[[0, 0, 1, 1]][..], &ring].concat());
        let slots = RoundsDesc { material_slots: Some(vec![7, 9]), ..closed };
        assert_eq!(slots.segment_slots().unwrap(), [7, 9, 9, 9, 9]);
    }
}
