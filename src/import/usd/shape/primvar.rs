//! Primvars: how values lie on a shape.

use std::collections::HashSet;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use openusd::sdf::{Value, ValueKind};
use openusd::tf::Token;
use openusd::usd::{Attribute, Prim};
use openusd_schemas::geom::{Interpolation, Primvar, PrimvarsAPI};

use super::super::stage::Reading;
use super::values::{graph_values, pairs, scalars, triples};
use crate::error::{Place, Warnings};

/// Values as authored, not yet held against the shape.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in super::super) struct Data<const N: usize> {
    pub name: Arc<str>,
    pub interpolation: Interpolation,
    pub values: Vec<[f32; N]>,
    /// Which element each place has; `None` for one after the other.
    pub indices: Option<Vec<i32>>,
    /// Values for each element, of which the first counts.
    pub stride: usize,
}

/// The values of a shape that rendering knows, its own and those it inherits.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Primvars {
    /// Everything that has two numbers.
    pub uvs: Vec<Data<2>>,
    pub color: Option<Data<3>>,
    pub opacity: Option<Data<1>>,
    pub normals: Option<Data<3>>,
    pub widths: Option<Data<1>>,
    /// What graphs ask for by name.
    pub named: Vec<Data<4>>,
}

/// How many of what a shape has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) struct Counts {
    pub faces: usize,
    /// For `varying`: the points of a mesh, the joints of curves.
    pub joints: usize,
    pub points: usize,
    pub corners: usize,
}

/// Values that fit a shape: as many places as its count says, and indices that are in range.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct Channel<const N: usize> {
    pub interpolation: Interpolation,
    pub values: Vec<[f32; N]>,
    pub indices: Option<Vec<u32>>,
}

impl<const N: usize> Channel<N> {
    /// The value at a place.
    pub fn at(&self, place: usize) -> [f32; N] {
        match &self.indices {
            Some(indices) => self.values[indices[place] as usize],
            None => self.values[place],
        }
    }

    /// One value for each place.
    pub fn flat(self) -> Vec<[f32; N]> {
        match self.indices {
            Some(indices) => indices.iter().map(|&i| self.values[i as usize]).collect(),
            None => self.values,
        }
    }
}

/// The primvars of `prim`, which inherits `inherited`.
///
/// Whether a value is authored is told by reading it: to ask the stage first would decode it twice.
pub(super) fn read(reading: &Reading<'_>, prim: &Prim, inherited: &[Primvar]) -> Primvars {
    let own = if reading.names(prim).iter().any(|name| name.starts_with("primvars:")) {
        PrimvarsAPI::from_prim_unchecked(prim.clone()).authored_primvars().unwrap_or_else(|error| {
            reading.warn(prim.path(), format!("its primvars can't be read: {error}"));
            Vec::new()
        })
    } else {
        Vec::new()
    };
    let mut primvars = Primvars::default();
    let mut known: HashSet<&str> = HashSet::new();
    for primvar in own.iter().chain(inherited) {
        let name = primvar.primvar_name();
        if !known.contains(name) && primvars.take(reading, primvar) {
            known.insert(name);
        }
    }
    primvars
}

/// Those of `names` that `prim` has, or inherits as one of `inherited`.
pub(super) fn named(reading: &Reading<'_>, prim: &Prim, inherited: &[Primvar], names: &[Arc<str>]) -> Vec<Data<4>> {
    let api = PrimvarsAPI::from_prim_unchecked(prim.clone());
    let found = |name: &Arc<str>| {
        let own = api.primvar(name).ok();
        let above = inherited.iter().filter(|primvar| primvar.primvar_name() == &**name).cloned();
        own.into_iter().chain(above).find_map(|primvar| data(reading, &primvar, graph_values))
    };
    names.iter().filter_map(found).collect()
}

/// Adds how many values there are, and a few of them.
pub(super) fn digest<const N: usize>(values: &[[f32; N]], hasher: &mut impl Hasher) {
    values.len().hash(hasher);
    let some = values.iter().step_by((values.len() / 32).max(1)).flatten();
    some.for_each(|x| x.to_bits().hash(hasher));
}

impl Primvars {
    /// Adds a few of the values of each.
    pub fn digest(&self, hasher: &mut impl Hasher) {
        let Self { uvs, color, opacity, normals, widths, named } = self;
        uvs.iter().for_each(|data| digest(&data.values, hasher));
        color.iter().chain(normals).for_each(|data| digest(&data.values, hasher));
        opacity.iter().chain(widths).for_each(|data| digest(&data.values, hasher));
        named.iter().for_each(|data| digest(&data.values, hasher));
    }

    /// True where nothing was found.
    pub fn is_empty(&self) -> bool {
        let Self { uvs, color, opacity, normals, widths, named } = self;
        uvs.is_empty()
            && named.is_empty()
            && color.is_none()
            && opacity.is_none()
            && normals.is_none()
            && widths.is_none()
    }

    /// True where `primvar` has a value.
    fn take(&mut self, reading: &Reading<'_>, primvar: &Primvar) -> bool {
        match primvar.primvar_name() {
            "displayColor" => keep(&mut self.color, data(reading, primvar, triples)),
            "displayOpacity" => keep(&mut self.opacity, data(reading, primvar, scalars)),
            "normals" => keep(&mut self.normals, data(reading, primvar, triples)),
            "widths" => keep(&mut self.widths, data(reading, primvar, scalars)),
            _ if has_two_numbers(primvar) => {
                let mut slot = None;
                let found = keep(&mut slot, data(reading, primvar, pairs));
                self.uvs.extend(slot);
                found
            }
            _ => false,
        }
    }
}

fn keep<T>(slot: &mut Option<T>, value: Option<T>) -> bool {
    let found = value.is_some();
    *slot = value;
    found
}

/// True for values of two numbers, which may be texture coordinates.
pub(in super::super) fn has_two_numbers(primvar: &Primvar) -> bool {
    use ValueKind as K;
    let kind = primvar.attribute().type_name().ok().flatten().and_then(|name| name.kind());
    matches!(kind, Some(K::Vec2f | K::Vec2d | K::Vec2h | K::Vec2fVec | K::Vec2dVec | K::Vec2hVec))
}

/// How an attribute converts to numbers.
pub(in super::super) type Convert<const N: usize> = fn(Value) -> Option<Vec<[f32; N]>>;

/// The values of `primvar`; `None` where it has none.
pub(in super::super) fn data<const N: usize>(
    reading: &Reading<'_>,
    primvar: &Primvar,
    convert: Convert<N>,
) -> Option<Data<N>> {
    let mut data = array(reading, primvar.attribute(), convert, Interpolation::Constant)?;
    data.name = primvar.primvar_name().into();
    data.stride = primvar.element_size().ok().and_then(|size| usize::try_from(size).ok()).unwrap_or(1).max(1);
    data.indices = primvar.indices(reading.time).unwrap_or_default();
    if data.indices.is_none() && primvar.is_indexed().unwrap_or(false) {
        reading.warn(primvar.attribute().path(), "its indices can't be read; the primvar is left out");
        return None;
    }
    Some(data)
}

/// The array in `attribute`, whose interpolation is `fallback` where none is authored.
pub(super) fn array<const N: usize>(
    reading: &Reading<'_>,
    attribute: &Attribute,
    convert: Convert<N>,
    fallback: Interpolation,
) -> Option<Data<N>> {
    let value = reading.value_of::<Value>(attribute, reading.time)?;
    let kind = ValueKind::from(&value);
    let Some(values) = convert(value) else {
        reading.warn(attribute.path(), format!("a value of type {kind} is not what is expected here; it is left out"));
        return None;
    };
    let token = attribute.get_metadata::<Token>("interpolation").ok().flatten();
    let interpolation = match token {
        None => fallback,
        Some(token) => Interpolation::from_token(&token).unwrap_or_else(|| {
            let what = format!("there is no interpolation \"{token}\"; {} is used", fallback.as_token());
            reading.warn(attribute.path(), what);
            fallback
        }),
    };
    Some(Data { name: attribute.name().into(), interpolation, values, indices: None, stride: 1 })
}

impl<const N: usize> Data<N> {
    /// Values of points become varying ones.
    pub fn at_joints(&mut self) {
        if self.interpolation == Interpolation::Vertex {
            self.interpolation = Interpolation::Varying;
        }
    }

    /// Holds the values against the `count` of instances, one for each or one for all; `None`, with a warning, where
    /// there are too few.
    pub(in super::super) fn fit_instances(
        mut self,
        count: usize,
        place: &Place,
        warnings: &mut Warnings,
    ) -> Option<Channel<N>> {
        let stride = self.stride.max(1);
        let have = self.indices.as_ref().map_or(self.values.len().div_ceil(stride), Vec::len);
        if have != count && !matches!(self.interpolation, Interpolation::Constant | Interpolation::Uniform) {
            let what = format!("{} has {have} values, not one for each of {count} instances", self.name);
            if have < count {
                warnings.push(place, format!("{what}; it is left out"));
                return None;
            }
            warnings.push(place, format!("{what}; the first ones are used"));
            match &mut self.indices {
                Some(indices) => indices.truncate(count),
                None => self.values.truncate(count * stride),
            }
        }
        self.fit(&Counts { faces: 1, joints: count, points: count, corners: count }, place, warnings)
    }

    /// Holds the values against the counts of the shape; `None`, with a warning, where there are too few.
    pub(in super::super) fn fit(self, counts: &Counts, place: &Place, warnings: &mut Warnings) -> Option<Channel<N>> {
        let Self { name, interpolation, mut values, indices, stride } = self;
        if stride > 1 {
            values = values.into_iter().step_by(stride).collect();
        }
        let wanted = match interpolation {
            Interpolation::Constant => 1,
            Interpolation::Uniform => counts.faces,
            Interpolation::Varying => counts.joints,
            Interpolation::Vertex => counts.points,
            Interpolation::FaceVarying => counts.corners,
        };
        let have = indices.as_ref().map_or(values.len(), Vec::len);
        if have < wanted || values.is_empty() {
            let kind = interpolation.as_token();
            warnings.push(place, format!("{name} has {have} values where {kind} ones need {wanted}; it is left out"));
            return None;
        }
        // Constant arrays may be of any length; their first value counts.
        if have > wanted && interpolation != Interpolation::Constant {
            let what = format!("{name} has {have} values where {wanted} are needed; the first ones are used");
            warnings.push(place, what);
        }
        let Some(mut indices) = indices else {
            values.truncate(wanted);
            return Some(Channel { interpolation, values, indices: None });
        };
        indices.truncate(wanted);
        let wrong = indices.iter().filter(|&&i| usize::try_from(i).map_or(true, |i| i >= values.len())).count();
        if wrong > 0 {
            let what = format!("{wrong} indices of {name} are out of range; its first value stands in");
            warnings.push(place, what);
        }
        let clamp = |i: i32| if (i as u32 as usize) < values.len() { i as u32 } else { 0 };
        let indices = indices.into_iter().map(clamp).collect();
        Some(Channel { interpolation, values, indices: Some(indices) })
    }
}
