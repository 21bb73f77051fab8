//! The faces of a mesh, rid of what can't be traced, and their triangles.

use bytemuck::allocation::{cast_vec, try_cast_vec};
use rayon::prelude::*;

use super::triangulate::{Scratch, triangulate};
use crate::error::{Place, Warnings};
use crate::import::subdivision::Faces;

/// Faces that can be worked on. Without the lists, all that were authored are there.
pub(super) struct Polygons {
    pub faces: Faces,
    /// What the corners and the faces were among those authored.
    pub corners: Option<Vec<u32>>,
    pub sources: Option<Vec<u32>>,
    /// Front faces wind clockwise.
    pub flipped: bool,
}

/// Triangles, and what they were: their corners are numbered as the faces' were, `None` for one after the
/// other.
pub(super) struct Triangles {
    pub points: Vec<[u32; 3]>,
    pub corners: Option<Vec<[u32; 3]>>,
    pub faces: Option<Vec<u32>>,
}

/// Values that one thread looks at in a pass over all; fewer are not worth a second thread.
pub(super) const PASS: usize = 1 << 16;

/// Points beyond this, whose squared length leaves single precision, count as not finite.
fn is_sound(point: &[f32; 3]) -> bool {
    point.iter().all(|v| v.abs() < 1e18)
}

/// Points that are not finite, which are moved to the origin.
pub(super) fn mend_points(points: &mut [[f32; 3]]) -> Option<Vec<bool>> {
    if points.par_iter().with_min_len(PASS).all(is_sound) {
        return None;
    }
    let bad = points.iter().map(|point| !is_sound(point)).collect();
    points.iter_mut().filter(|point| !is_sound(point)).for_each(|point| *point = [0.0; 3]);
    Some(bad)
}

/// Faces as authored.
pub(super) struct Authored<'a> {
    pub counts: Vec<i32>,
    pub indices: Vec<i32>,
    pub holes: &'a [i32],
    pub points: usize,
    /// Points that are not finite.
    pub bad: Option<Vec<bool>>,
    pub flipped: bool,
}

impl Authored<'_> {
    /// The triangles of a mesh that has nothing else and nothing wrong: the arrays as they are.
    pub fn into_triangles(self) -> Result<Triangles, Self> {
        let fits = self.indices.len() == 3 * self.counts.len()
            && self.holes.is_empty()
            && self.bad.is_none()
            && !self.flipped
            && self.counts.par_iter().with_min_len(PASS).all(|&count| count == 3)
            // Negative ones are large.
            && self.indices.par_iter().with_min_len(PASS).all(|&i| (i as u32) < self.points as u32);
        if !fits {
            return Err(self);
        }
        match try_cast_vec(cast_vec::<i32, u32>(self.indices)) {
            Ok(points) => Ok(Triangles { points, corners: None, faces: None }),
            // A capacity that is no multiple of three.
            Err((_, indices)) => Ok(Triangles { points: indices.as_chunks().0.to_vec(), corners: None, faces: None }),
        }
    }

    /// The faces that can be used. `holes` are kept, and told by the second list, where `keep_holes` says so.
    pub fn polygons(self, keep_holes: bool, place: &Place, warnings: &mut Warnings) -> (Polygons, Vec<bool>) {
        let Self { counts, indices, holes, points, bad, flipped } = self;
        let mut is_hole = vec![false; counts.len()];
        let mut unknown = 0;
        for &face in holes {
            match usize::try_from(face).ok().and_then(|face| is_hole.get_mut(face)) {
                Some(hole) => *hole = true,
                None => unknown += 1,
            }
        }
        if unknown > 0 {
            warnings.push(place, format!("holeIndices names {unknown} faces that don't exist; they are left out"));
        }
        let (mut kept, mut kept_corners, mut kept_holes) = (Vec::new(), Vec::new(), Vec::new());
        let (mut small, mut wrong, mut unsound, mut short) = (0, 0, 0, 0);
        let mut starts = vec![0];
        let mut corners: Vec<u32> = Vec::with_capacity(indices.len());
        let mut end = 0;
        for (face, &count) in counts.iter().enumerate() {
            let start = end;
            end = usize::try_from(count).map_or(usize::MAX, |count| start + count);
            let Some(list) = indices.get(start..end) else {
                short = counts.len() - face;
                break;
            };
            let is_known = |&i: &i32| usize::try_from(i).is_ok_and(|i| i < points);
            if list.len() < 3 {
                small += 1;
            } else if !list.iter().all(is_known) {
                wrong += 1;
            } else if bad.as_ref().is_some_and(|bad| list.iter().any(|&i| bad[i as usize])) {
                unsound += 1;
            } else if keep_holes || !is_hole[face] {
                kept.push(face as u32);
                kept_holes.push(is_hole[face]);
                kept_corners.extend(start as u32..end as u32);
                corners.extend(list.iter().map(|&i| i as u32));
                starts.push(corners.len() as u32);
            }
        }
        let tell = |count: usize, what: &str, warnings: &mut Warnings| {
            if count > 0 {
                warnings.push(place, format!("{count} faces {what}; they are left out"));
            }
        };
        tell(small, "have fewer than three corners", warnings);
        tell(wrong, &format!("use points that don't exist ({points} do)"), warnings);
        tell(unsound, "use points that are not finite", warnings);
        tell(short, "have corners beyond the end of faceVertexIndices", warnings);
        if short == 0 && end < indices.len() {
            let extra = indices.len() - end;
            warnings.push(place, format!("{extra} of faceVertexIndices belong to no face; they are left out"));
        }
        let all = kept.len() == counts.len();
        let polygons = Polygons {
            faces: Faces { starts, corners },
            corners: (!all).then_some(kept_corners),
            sources: (!all).then_some(kept),
            flipped,
        };
        (polygons, kept_holes)
    }
}

impl Polygons {
    /// Cuts the faces; those in `holes` are left out.
    pub fn triangles(&self, points: &[[f32; 3]], holes: &[bool]) -> Triangles {
        let faces = &self.faces;
        let expected = faces.corners.len().saturating_sub(2 * faces.len());
        let mut triangles = Triangles {
            points: Vec::with_capacity(expected),
            corners: Some(Vec::with_capacity(expected)),
            faces: Some(Vec::with_capacity(expected)),
        };
        let (mut scratch, mut cut) = (Scratch::default(), Vec::new());
        for face in 0..faces.len() {
            if holes.get(face).copied().unwrap_or(false) {
                continue;
            }
            let (start, list) = (faces.starts[face], faces.points(face));
            cut.clear();
            triangulate(list.len(), |i| points[list[i] as usize], &mut cut, &mut scratch);
            let source = self.sources.as_ref().map_or(face as u32, |sources| sources[face]);
            for &[a, b, c] in &cut {
                let triangle = if self.flipped { [a, c, b] } else { [a, b, c] };
                triangles.points.push(triangle.map(|i| list[i as usize]));
                let corner = |i: u32| {
                    let corner = start + i;
                    self.corners.as_ref().map_or(corner, |corners| corners[corner as usize])
                };
                triangles.corners.get_or_insert_default().push(triangle.map(corner));
                triangles.faces.get_or_insert_default().push(source);
            }
        }
        triangles
    }
}

impl Triangles {
    /// Drops what has no area.
    pub fn drop_flat(&mut self, points: &[[f32; 3]]) {
        let is_flat = |&[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|i| points[i as usize]);
            cross(a, b, c) == [0.0; 3] && cross(a.map(f64::from), b.map(f64::from), c.map(f64::from)) == [0.0; 3]
        };
        if !self.points.par_iter().with_min_len(PASS).any(is_flat) {
            return;
        }
        let count = self.points.len();
        let keep: Vec<u32> = (0..count as u32).filter(|&t| !is_flat(&self.points[t as usize])).collect();
        fn pick<T: Copy>(values: &mut Vec<T>, keep: &[u32]) {
            *values = keep.iter().map(|&t| values[t as usize]).collect();
        }
        pick(&mut self.points, &keep);
        match &mut self.corners {
            Some(corners) => pick(corners, &keep),
            None => self.corners = Some(keep.iter().map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()),
        }
        match &mut self.faces {
            Some(faces) => pick(faces, &keep),
            None => self.faces = Some(keep),
        }
    }
}

/// Twice the area times the normal.
pub(super) fn cross<T>([a, b, c]: [T; 3], [d, e, f]: [T; 3], [g, h, i]: [T; 3]) -> [T; 3]
where
    T: Copy + std::ops::Sub<Output = T> + std::ops::Mul<Output = T>,
{
    let (u, v) = ([d - a, e - b, f - c], [g - a, h - b, i - c]);
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}
