//! UsdGeomPoints as balls.

use openusd::sdf::Value;
use openusd::usd::{Attribute, Prim, TimeCode};
use openusd_schemas::geom::{Interpolation, Primvar};

use super::super::skel::{Bound, Deformer};
use super::super::stage::Reading;
use super::finish::Channels;
use super::primvar::{self, Channel, Counts, Data, Primvars};
use super::rounds::Rounds;
use super::values::scalars;
use super::{Built, Wants, mesh, motion};
use crate::desc::Motion;
use crate::error::{Place, Warnings};
use crate::math::Vec3;

/// Points as authored.
pub(in super::super) struct Points {
    points: Vec<[f32; 3]>,
    widths: Option<Data<1>>,
    pub(super) primvars: Primvars,
    motion: Vec<Motion<Vec<[f32; 3]>>>,
    /// At each of those times; empty where they stay.
    moving_widths: Vec<Data<1>>,
}

/// Reads points that follow the skeleton of `skin`; `None`, with a warning, where there are none.
pub(super) fn read(reading: &Reading<'_>, prim: &Prim, inherited: &[Primvar], skin: Option<&Bound>) -> Option<Points> {
    let points = mesh::points(reading, prim, skin)?;
    let deformer = skin.and_then(|bound| Deformer::of(reading, prim, bound, points.len()));
    let mut primvars = primvar::read(reading, prim, inherited);
    let widths = widths(reading, prim, &mut primvars);
    let shutter = reading.shutter.get();
    let of_widths = width_attribute(reading, prim);
    let moved = |shutter| motion::read(reading, prim, shutter, points.len(), deformer.as_ref(), Some(&of_widths));
    let motion = shutter.map_or_else(Vec::new, moved);
    let moving_widths = moving_widths(reading, &of_widths, widths.as_ref(), &motion);
    let points = match &deformer {
        Some(deformer) => deformer.points(points, reading.time),
        None => points,
    };
    Some(Points { points, widths, primvars, motion, moving_widths })
}

/// Widths of points and curves: the primvar comes before the attribute.
pub(super) fn widths(reading: &Reading<'_>, prim: &Prim, primvars: &mut Primvars) -> Option<Data<1>> {
    let attribute = prim.attribute("widths");
    let convert: fn(Value) -> _ = scalars;
    let widths = primvars.widths.take().or_else(|| primvar::array(reading, &attribute, convert, Interpolation::Vertex));
    if widths.is_none() {
        reading.warn(prim.path(), "it has no widths; 1 is used, as Hydra does");
    }
    widths
}

/// The attribute that holds the widths of `prim` itself.
pub(super) fn width_attribute(reading: &Reading<'_>, prim: &Prim) -> Attribute {
    let primvar = "primvars:widths";
    let is_primvar = reading.names(prim).iter().any(|name| name.as_str() == primvar);
    prim.attribute(if is_primvar { primvar } else { "widths" })
}

/// The widths in `attribute`, which are `now` at the frame, at the times of `motion`; empty where they do not change.
pub(super) fn moving_widths<T>(
    reading: &Reading<'_>,
    attribute: &Attribute,
    now: Option<&Data<1>>,
    motion: &[Motion<T>],
) -> Vec<Data<1>> {
    let Some(now) = now.filter(|_| !motion.is_empty() && motion::varies(attribute)) else { return Vec::new() };
    let at = |m: &Motion<T>| {
        let time = TimeCode::new(reading.time.value() + m.time);
        let values = reading.value_of::<Value>(attribute, time).and_then(scalars)?;
        (values.len() == now.values.len()).then(|| Data { values, ..now.clone() })
    };
    motion.iter().map(at).collect::<Option<Vec<_>>>().unwrap_or_else(|| {
        reading.warn(attribute.path(), "the number of widths changes within the shutter; those of the frame are used");
        Vec::new()
    })
}

impl Points {
    pub fn build(self, wants: &Wants, place: &Place, warnings: &mut Warnings) -> Option<Built> {
        let Self { points, widths, primvars, motion, moving_widths } = self;
        let count = points.len();
        let counts = Counts { faces: 1, joints: count, points: count, corners: count };
        let radii = |widths| by_point(widths, count).into_iter().map(|[width]| 0.5 * width).collect::<Vec<f32>>();
        // What does not fit at the frame does not at other times either, which is not to be told again.
        let fitting = |data: Data<1>| data.fit(&counts, place, &mut Warnings::new()).map(radii);
        let moving: Option<Vec<_>> = moving_widths.into_iter().map(fitting).collect();
        let radii = widths.and_then(|data| data.fit(&counts, place, warnings)).map_or_else(|| vec![0.5; count], radii);
        let is_sound = |&i: &usize| Vec3::from(points[i]).is_finite() && radii[i].is_finite() && radii[i] > 0.0;
        let kept: Vec<usize> = (0..count).filter(is_sound).collect();
        if kept.len() < count {
            let dropped = count - kept.len();
            warnings.push(place, format!("{dropped} points are not finite or have no width; they are left out"));
        }
        if kept.is_empty() {
            return None;
        }
        let kept = Kept { of: count, kept };
        let Channels { uvs, color, opacity, named, .. } = Channels::new(primvars, &counts, wants, place, warnings);
        let channels = Channels {
            normals: None,
            uvs: uvs.into_iter().map(|(name, channel)| (name, kept.channel(channel))).collect(),
            color: color.map(|channel| kept.channel(channel)),
            opacity: opacity.map(|channel| kept.channel(channel)),
            named: named.into_iter().map(|(name, channel)| (name, kept.channel(channel))).collect(),
        };
        let rounds = Rounds {
            points: kept.values(points),
            radii: kept.values(radii),
            strands: Vec::new(),
            channels,
            motion: motion.into_iter().map(|m| Motion { time: m.time, value: kept.values(m.value) }).collect(),
            radii_motion: moving.into_iter().flatten().map(|radii| not_negative(kept.values(radii))).collect(),
        };
        Some(Built::Rounds(rounds.finish(wants, place, warnings)))
    }
}

/// Nothing is less than a point.
fn not_negative(radii: Vec<f32>) -> Vec<f32> {
    radii.into_iter().map(|radius| if radius > 0.0 { radius } else { 0.0 }).collect()
}

/// One value for each of `count` points.
fn by_point<const N: usize>(channel: Channel<N>, count: usize) -> Vec<[f32; N]> {
    match channel.interpolation {
        Interpolation::Constant | Interpolation::Uniform => vec![channel.at(0); count],
        _ => channel.flat(),
    }
}

/// The points that are kept.
struct Kept {
    of: usize,
    kept: Vec<usize>,
}

impl Kept {
    fn values<T: Copy>(&self, values: Vec<T>) -> Vec<T> {
        if self.kept.len() == self.of { values } else { self.kept.iter().map(|&i| values[i]).collect() }
    }

    fn channel<const N: usize>(&self, channel: Channel<N>) -> Channel<N> {
        let values = self.values(by_point(channel, self.of));
        Channel { interpolation: Interpolation::Vertex, values, indices: None }
    }
}
