//! UsdGeomBasisCurves, and Hermite and NURBS curves as such.

use openusd::tf::Token;
use openusd::usd::Prim;
use openusd_schemas::geom::{Interpolation, Primvar};

use super::super::skel::{Bound, Deformer};
use super::super::stage::Reading;
use super::finish::{Channels, Surface};
use super::polygons::{Triangles, mend_points};
use super::primvar::{self, Channel, Counts, Data, Primvars};
use super::ribbon::{Joint, Ribbons};
use super::rounds::Rounds;
use super::segments::{Basis, Curve, Wrap};
use super::values::triples;
use super::{Built, Wants, mesh, motion, points, subsets};
use crate::desc::{Motion, Strand};
use crate::error::{Place, Warnings};
use crate::math::Vec3;

/// How far, in radii, the straight pieces may be off the curve.
const TOLERANCE: f32 = 0.05;

/// Curves as authored.
pub(in super::super) struct Curves {
    points: Vec<[f32; 3]>,
    counts: Vec<i32>,
    basis: Basis,
    wrap: Wrap,
    widths: Option<Data<1>>,
    /// Values of points are those at the ends of pieces.
    pub(super) from_hermite: bool,
    pub(super) primvars: Primvars,
    motion: Vec<Motion<Vec<[f32; 3]>>>,
    /// Widths at each of those times; empty where they stay.
    moving_widths: Vec<Data<1>>,
}

/// Reads curves of schema `kind` that follow the skeleton of `skin`; `None`, with a warning, where there are none.
pub(super) fn read(
    reading: &Reading<'_>,
    prim: &Prim,
    inherited: &[Primvar],
    skin: Option<&Bound>,
    kind: &str,
) -> Option<Curves> {
    let mut points = mesh::points(reading, prim, skin)?;
    let deformer = skin.and_then(|bound| Deformer::of(reading, prim, bound, points.len()));
    let mut counts: Vec<i32> = reading.value(prim, "curveVertexCounts").unwrap_or_default();
    let token = |name: &str| reading.value::<Token>(prim, name);
    let (mut basis, mut wrap) = (Basis::Linear, Wrap::Open);
    let shutter = reading.shutter.get();
    let of_widths = points::width_attribute(reading, prim);
    let moved = |shutter| motion::read(reading, prim, shutter, points.len(), deformer.as_ref(), Some(&of_widths));
    let mut motion = shutter.map_or_else(Vec::new, moved);
    if let Some(deformer) = &deformer {
        points = deformer.points(points, reading.time);
    }
    subsets::tell_of_those(reading, prim);
    let mut from_hermite = false;
    match kind {
        "BasisCurves" => {
            let is_linear = token("type").is_some_and(|kind| kind == "linear");
            basis = match token("basis").as_ref().map_or("bezier", Token::as_str) {
                _ if is_linear => Basis::Linear,
                "bspline" => Basis::Bspline,
                "catmullRom" => Basis::CatmullRom,
                "bezier" => Basis::Bezier,
                other => {
                    reading.warn(prim.path(), format!("there is no basis \"{other}\"; bezier is used"));
                    Basis::Bezier
                }
            };
            wrap = match token("wrap").as_ref().map_or("nonperiodic", Token::as_str) {
                "periodic" => Wrap::Closed,
                "pinned" => Wrap::Pinned,
                _ => Wrap::Open,
            };
        }
        "HermiteCurves" => {
            let tangents = primvar::array(reading, &prim.attribute("tangents"), triples, Interpolation::Vertex);
            match tangents.map(|data| data.values).filter(|tangents| tangents.len() == points.len()) {
                Some(tangents) => {
                    motion.iter_mut().for_each(|m| m.value = as_bezier(&m.value, &tangents, &counts).0);
                    (points, counts) = as_bezier(&points, &tangents, &counts);
                    (basis, from_hermite) = (Basis::Bezier, true);
                }
                None => {
                    reading.warn(prim.path(), "the curves need a tangent for each point; they are straight instead")
                }
            }
        }
        _ => reading.warn(prim.path(), "NURBS curves are drawn as straight lines between their points, as Hydra does"),
    }
    if counts.is_empty() {
        reading.warn(prim.path(), "the curves have no curveVertexCounts; they are left out");
        return None;
    }
    let mut primvars = primvar::read(reading, prim, inherited);
    let mut widths = points::widths(reading, prim, &mut primvars);
    let mut moving_widths = points::moving_widths(reading, &of_widths, widths.as_ref(), &motion);
    if primvars.normals.is_none() {
        primvars.normals = primvar::array(reading, &prim.attribute("normals"), triples, Interpolation::Vertex);
    }
    if let (Some(deformer), Some(normals)) = (&deformer, &mut primvars.normals) {
        deformer.normals(normals, &[]);
    }
    if from_hermite {
        // The points are the ends of the pieces.
        widths.iter_mut().chain(&mut moving_widths).for_each(Data::at_joints);
        primvars.uvs.iter_mut().for_each(Data::at_joints);
        primvars.normals.iter_mut().for_each(Data::at_joints);
        primvars.color.iter_mut().for_each(Data::at_joints);
        primvars.opacity.iter_mut().for_each(Data::at_joints);
    }
    Some(Curves { points, counts, basis, wrap, widths, primvars, motion, moving_widths, from_hermite })
}

/// Cubic pieces between points with tangents.
fn as_bezier(points: &[[f32; 3]], tangents: &[[f32; 3]], counts: &[i32]) -> (Vec<[f32; 3]>, Vec<i32>) {
    let (mut bezier, mut bezier_counts) = (Vec::new(), Vec::new());
    let mut start = 0;
    for &count in counts {
        let range = start..start + usize::try_from(count).unwrap_or(0);
        start = range.end;
        let (Some(p), Some(t)) = (points.get(range.clone()), tangents.get(range)) else { break };
        let before = bezier.len();
        for (i, (&point, &tangent)) in p.iter().zip(t).enumerate() {
            let (point, third) = (Vec3::from(point), Vec3::from(tangent) / 3.0);
            if i > 0 {
                bezier.push((point - third).into());
            }
            bezier.push(point.into());
            if i + 1 < p.len() {
                bezier.push((point + third).into());
            }
        }
        bezier_counts.push((bezier.len() - before) as i32);
    }
    (bezier, bezier_counts)
}

impl Curves {
    pub fn build(self, wants: &Wants, place: &Place, warnings: &mut Warnings) -> Option<Built> {
        let Self { mut points, counts, basis, wrap, widths, primvars, motion, moving_widths, .. } = self;
        let bad = mend_points(&mut points);
        let curves = lay_out(&counts, points.len(), basis, wrap, place, warnings);
        let LaidOut { curves, are_all } = curves;
        if curves.iter().all(|curve| curve.segments() == 0) {
            return None;
        }
        let joints = curves.last().map_or(0, |curve| curve.joints.end);
        let sizes = Counts { faces: counts.len(), joints, points: points.len(), corners: joints };
        // Values for curves that are left out can't fit, which is not to be told once more.
        let mut of_values = Warnings::new();
        let widths = widths.and_then(|data| data.fit(&sizes, place, &mut of_values));
        // What does not fit at the frame does not at other times either.
        let fitting = |data: Data<1>| data.fit(&sizes, place, &mut Warnings::new());
        let moving: Option<Vec<_>> = moving_widths.into_iter().map(fitting).collect();
        let moving = Moving { points: &motion, widths: moving.unwrap_or_default() };
        let mut channels = Channels::new(primvars, &sizes, wants, place, &mut of_values);
        if are_all {
            warnings.extend(of_values);
        }
        let normals = channels.normals.take();
        let mut lines: Vec<(usize, Vec<Joint>)> = Vec::with_capacity(curves.len());
        let mut dropped = 0;
        for (i, curve) in curves.iter().enumerate() {
            if bad.as_ref().is_some_and(|bad| bad[curve.points.clone()].contains(&true)) {
                dropped += 1;
                continue;
            }
            lines.push((i, line(curve, i, &points, widths.as_ref(), normals.as_ref())));
        }
        if dropped > 0 {
            warnings.push(place, format!("{dropped} curves have points that are not finite; they are left out"));
        }
        let set = Set { curves: &curves, lines };
        if normals.is_some() {
            set.ribbons(channels, &moving, wants, place, warnings)
        } else {
            set.strands(channels, &moving, wants, place, warnings)
        }
    }
}

/// Curves and their joints.
struct Set<'a> {
    curves: &'a [Curve],
    /// Index of the curve, and its joints.
    lines: Vec<(usize, Vec<Joint>)>,
}

/// What curves are at other times of the shutter.
struct Moving<'a> {
    points: &'a [Motion<Vec<[f32; 3]>>],
    /// At each of those times; empty where they stay.
    widths: Vec<Channel<1>>,
}

impl Set<'_> {
    fn ribbons(
        self,
        channels: Channels,
        moving: &Moving<'_>,
        wants: &Wants,
        place: &Place,
        warnings: &mut Warnings,
    ) -> Option<Built> {
        let of = |lines: &[(usize, Vec<Joint>)]| {
            let mut ribbons = Ribbons::default();
            for (i, joints) in lines {
                ribbons.push(*i as u32, joints, self.curves[*i].is_closed());
            }
            ribbons
        };
        let motion = (0..moving.points.len()).map(|key| {
            let lines: Vec<_> =
                self.lines.iter().map(|(i, joints)| (*i, self.moved(*i, joints, moving, key))).collect();
            Motion { time: moving.points[key].time, value: of(&lines).points }
        });
        let motion = motion.collect();
        let Ribbons { points, normals, triangles, origins } = of(&self.lines);
        let normals = Channel { interpolation: Interpolation::Vertex, values: normals, indices: None };
        let channels = Channels { normals: Some(normals), ..self.along(&origins, &channels) };
        let triangles = Triangles { points: triangles, corners: None, faces: None };
        let surface = Surface { points, triangles, channels, slots: None, motion };
        surface.finish(wants, place, warnings).map(Built::Mesh)
    }

    /// The joints of curve `index` as they are at a key of the motion; ribbons face what they face at the frame.
    fn moved(&self, index: usize, joints: &[Joint], moving: &Moving<'_>, key: usize) -> Vec<Joint> {
        let (curve, points) = (&self.curves[index], &moving.points[key].value);
        let at = |joint: &Joint| {
            let piece = curve.piece(joint.at.0 as usize, |i| points[i]);
            let (center, tangent) = (piece.at(joint.at.1).into(), piece.tangent(joint.at.1).into());
            let radius = moving.widths.get(key).map_or(joint.radius, |widths| radius(curve, widths, index, joint.at));
            Joint { center, tangent, radius, ..*joint }
        };
        let mut joints: Vec<Joint> = joints.iter().map(at).collect();
        curve.soften(&mut joints);
        joints
    }

    fn strands(
        self,
        channels: Channels,
        moving: &Moving<'_>,
        wants: &Wants,
        place: &Place,
        warnings: &mut Warnings,
    ) -> Option<Built> {
        let (mut points, mut radii, mut strands, mut origins) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (mut thin, mut last) = (0, None);
        for (i, joints) in &self.lines {
            if !joints.iter().any(|joint| joint.radius > 0.0) {
                thin += u32::from(!joints.is_empty());
                continue;
            }
            let first = points.len();
            for joint in joints {
                // Two joints at one place would be a ball within the strand.
                if last.replace(joint.center) == Some(joint.center) && points.len() > first {
                    let radius: &mut f32 = radii.last_mut()?;
                    *radius = radius.max(joint.radius);
                    continue;
                }
                points.push(joint.center.into());
                radii.push(joint.radius);
                origins.push((*i as u32, joint.at));
            }
            strands.push(Strand { end: points.len() as u32, closed: self.curves[*i].is_closed() });
        }
        if thin > 0 {
            warnings.push(place, format!("{thin} curves have no width; they are left out"));
        }
        if strands.is_empty() {
            return None;
        }
        let at = |m: &Motion<Vec<[f32; 3]>>| {
            let point = |&(curve, (segment, t)): &(u32, (u32, f32))| {
                self.curves[curve as usize].piece(segment as usize, |i| m.value[i]).at(t)
            };
            Motion { time: m.time, value: origins.iter().map(point).collect() }
        };
        let motion = moving.points.iter().map(at).collect();
        let radii_of = |widths: &Channel<1>| {
            let one =
                |&(curve, at): &(u32, (u32, f32))| radius(&self.curves[curve as usize], widths, curve as usize, at);
            origins.iter().map(one).collect()
        };
        let radii_motion = moving.widths.iter().map(radii_of).collect();
        let channels = self.along(&origins, &channels);
        let rounds = Rounds { points, radii, strands, channels, motion, radii_motion };
        Some(Built::Rounds(rounds.finish(wants, place, warnings)))
    }

    /// Values at places along the curves.
    fn along(&self, origins: &[(u32, (u32, f32))], channels: &Channels) -> Channels {
        let along = Along { curves: self.curves, origins };
        Channels {
            normals: None,
            uvs: channels.uvs.iter().map(|(name, channel)| (name.clone(), along.channel(channel))).collect(),
            color: channels.color.as_ref().map(|channel| along.channel(channel)),
            opacity: channels.opacity.as_ref().map(|channel| along.channel(channel)),
            named: channels.named.iter().map(|(name, channel)| (name.clone(), along.channel(channel))).collect(),
        }
    }
}

/// Curves, and whether they are all that were authored.
struct LaidOut {
    curves: Vec<Curve>,
    are_all: bool,
}

/// Which points each curve has, and which varying values.
fn lay_out(counts: &[i32], points: usize, basis: Basis, wrap: Wrap, place: &Place, warnings: &mut Warnings) -> LaidOut {
    let mut curves = Vec::with_capacity(counts.len());
    let (mut start, mut joints, mut short, mut odd) = (0, 0, 0, 0);
    let spare = |count: i32| basis == Basis::Bezier && count % 3 != i32::from(wrap != Wrap::Closed);
    for (i, &count) in counts.iter().enumerate() {
        let end = start + usize::try_from(count).unwrap_or(0);
        if end > points {
            let left = counts.len() - i;
            warnings.push(place, format!("{left} curves need more points than there are; they are left out"));
            break;
        }
        let curve = Curve::new(start..end, joints, basis, wrap);
        match curve.segments() {
            0 => short += 1,
            _ => odd += u32::from(spare(count)),
        }
        (start, joints) = (end, curve.joints.end);
        curves.push(curve);
    }
    if short > 0 {
        warnings.push(place, format!("{short} curves have too few points for their basis; they are left out"));
    }
    if odd > 0 {
        warnings.push(place, format!("{odd} curves have a number of points that their basis has no use for"));
    }
    LaidOut { are_all: curves.len() == counts.len() && short == 0, curves }
}

/// The joints of a curve: close enough where it bends.
fn line(
    curve: &Curve,
    index: usize,
    points: &[[f32; 3]],
    widths: Option<&Channel<1>>,
    normals: Option<&Channel<3>>,
) -> Vec<Joint> {
    let mut joints = Vec::new();
    let width = |at| widths.map_or(1.0, |channel| curve.value(channel, index, at)[0]);
    let facing = |at| normals.map(|channel| Vec3::from(curve.value(channel, index, at)));
    let segments = curve.segments() as u32;
    for segment in 0..segments {
        let piece = curve.piece(segment as usize, |i| points[i]);
        let tolerance = TOLERANCE * 0.5 * width((segment, 0.5)).abs();
        let of_widths = widths.filter(|channel| channel.interpolation == Interpolation::Vertex);
        let of_widths = of_widths.map_or(0.0, |channel| 0.5 * curve.piece(segment as usize, |i| channel.at(i)).bend());
        let steps = piece.steps(of_widths, tolerance);
        let last = segment + 1 == segments && !curve.is_closed();
        for step in 0..steps + u32::from(last) {
            let t = step as f32 / steps as f32;
            let at = (segment, t);
            let joint = Joint {
                center: piece.at(t).into(),
                tangent: piece.tangent(t).into(),
                radius: widths.map_or(0.5, |widths| radius(curve, widths, index, at)),
                facing: facing(at),
                at,
            };
            joints.push(joint);
        }
    }
    curve.soften(&mut joints);
    joints
}

/// Half the width at a place along a curve, which is the prim's curve `index`.
fn radius(curve: &Curve, widths: &Channel<1>, index: usize, at: (u32, f32)) -> f32 {
    0.5 * curve.value(widths, index, at)[0].max(0.0)
}

/// Values at places along curves.
struct Along<'a> {
    curves: &'a [Curve],
    origins: &'a [(u32, (u32, f32))],
}

impl Along<'_> {
    fn channel<const N: usize>(&self, channel: &Channel<N>) -> Channel<N> {
        let value = |&(curve, at): &(u32, (u32, f32))| self.curves[curve as usize].value(channel, curve as usize, at);
        let values = self.origins.iter().map(value).collect();
        Channel { interpolation: Interpolation::Vertex, values, indices: None }
    }
}

#[cfg(test)]
mod tests;
