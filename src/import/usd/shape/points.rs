//! UsdGeomPoints as spheres.

use openusd::sdf::Value;
use openusd::usd::Prim;
use openusd_schemas::geom::{Interpolation, Primvar};

use super::super::stage::Reading;
use super::finish::Channels;
use super::primvar::{self, Counts, Data, Primvars};
use super::profile::Solid;
use super::values::scalars;
use super::{Built, Wants, mesh, primitive};
use crate::error::{Place, Warnings};
use crate::math::{DAffine3, DMat3, DVec3};

/// Points as authored.
pub(in super::super) struct Points {
    points: Vec<[f32; 3]>,
    widths: Option<Data<1>>,
    primvars: Primvars,
}

/// Reads points; `None`, with a warning, where there are none.
pub(super) fn read(reading: &Reading<'_>, prim: &Prim, inherited: &[Primvar]) -> Option<Points> {
    let points = mesh::points(reading, prim)?;
    let mut primvars = primvar::read(reading, prim, inherited);
    let widths = widths(reading, prim, &mut primvars);
    Some(Points { points, widths, primvars })
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

impl Points {
    pub fn build(self, wants: &Wants, place: &Place, warnings: &mut Warnings) -> Option<Built> {
        let Self { points, widths, primvars } = self;
        let count = points.len();
        let counts = Counts { faces: 1, joints: count, points: count, corners: count };
        let widths = widths.and_then(|data| data.fit(&counts, place, warnings));
        let is_constant = |i: Interpolation| matches!(i, Interpolation::Constant | Interpolation::Uniform);
        let width = |i: usize| match &widths {
            Some(channel) if is_constant(channel.interpolation) => channel.at(0)[0],
            Some(channel) => channel.at(i)[0],
            None => 1.0,
        };
        let mut copies = Vec::with_capacity(count);
        for (i, point) in points.iter().enumerate() {
            let radius = 0.5 * f64::from(width(i));
            let center = DVec3::from(point.map(f64::from));
            if center.is_finite() && radius.is_finite() && radius > 0.0 {
                copies.push(DAffine3::from_mat3_translation(DMat3::from_diagonal(DVec3::splat(radius)), center));
            }
        }
        if copies.len() < count {
            let dropped = count - copies.len();
            warnings.push(place, format!("{dropped} points are not finite or have no width; they are left out"));
        }
        if copies.is_empty() {
            return None;
        }
        let mut channels = Channels::new(primvars, &counts, wants, place, warnings);
        if channels.make_constant() {
            warnings.push(place, "values of single points are left out; those of the first point stand for all");
        }
        let mesh = primitive::solid_surface(Solid::sphere(1.0), channels).finish(wants, place, warnings)?;
        Some(Built { mesh, copies })
    }
}
