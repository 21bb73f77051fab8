//! Colors of whole instances: displayColor and displayOpacity of point instancers, and those that the prims
//! in an instance inherit from outside of it. They are kept beside the mesh, so that all instances share it.

use std::rc::Rc;

use openusd::usd::Prim;
use openusd_schemas::geom::{Interpolation, Primvar, PrimvarsAPI};

use super::super::stage::Reading;
use super::finish::UNCOLORED;
use super::primvar::{Channel, Convert, data};
use super::values::{scalars, triples};

/// Linear color and straight alpha.
pub(in super::super) type Tint = [f32; 4];

const COLOR: &str = "displayColor";
const OPACITY: &str = "displayOpacity";

/// True for the primvars that are read here.
pub(in super::super) fn is_one(name: &str) -> bool {
    matches!(name, COLOR | OPACITY)
}

/// What a graph that asks for the primvar `name` gets of an instance's color.
pub(in super::super) fn named([r, g, b, a]: Tint, name: &str) -> Option<[f32; 4]> {
    match name {
        COLOR => Some([r, g, b, 1.0]),
        OPACITY => Some([a; 4]),
        _ => None,
    }
}

/// The color of each of the `count` instances of the point instancer `prim`, whose primvars are those of a
/// cloud of points with one for each instance; what its prototypes author themselves goes before it.
pub(in super::super) fn of_instances(reading: &Reading<'_>, prim: &Prim, count: usize) -> Option<Vec<Tint>> {
    let api = PrimvarsAPI::from_prim_unchecked(prim.clone());
    let own: Vec<Primvar> = [COLOR, OPACITY].iter().filter_map(|name| api.primvar(name).ok()).collect();
    let tints = Tints::of(reading, &own, count)?;
    Some((0..count).map(|i| tints.at(i)).collect())
}

/// The color among the inherited `primvars`.
pub(in super::super) fn inherited(reading: &Reading<'_>, primvars: &[Primvar]) -> Option<Tint> {
    Tints::of(reading, primvars, 1).map(|tints| tints.at(0))
}

/// `primvars` without what [`inherited`] reads.
pub(in super::super) fn without(primvars: &Rc<Vec<Primvar>>) -> Rc<Vec<Primvar>> {
    let tints = |primvar: &Primvar| is_one(primvar.primvar_name());
    if !primvars.iter().any(tints) {
        return primvars.clone();
    }
    Rc::new(primvars.iter().filter(|primvar| !tints(primvar)).cloned().collect())
}

struct Tints {
    color: Option<Channel<3>>,
    opacity: Option<Channel<1>>,
}

impl Tints {
    fn of(reading: &Reading<'_>, primvars: &[Primvar], count: usize) -> Option<Self> {
        let tints = Self {
            color: channel(reading, primvars, COLOR, triples, count),
            opacity: channel(reading, primvars, OPACITY, scalars, count),
        };
        (tints.color.is_some() || tints.opacity.is_some()).then_some(tints)
    }

    fn at(&self, i: usize) -> Tint {
        let [r, g, b] = self.color.as_ref().map_or(UNCOLORED, |color| place(color, i));
        let [a] = self.opacity.as_ref().map_or([1.0], |opacity| place(opacity, i));
        [r, g, b, a]
    }
}

fn channel<const N: usize>(
    reading: &Reading<'_>,
    primvars: &[Primvar],
    name: &str,
    convert: Convert<N>,
    count: usize,
) -> Option<Channel<N>> {
    let primvar = primvars.iter().find(|primvar| primvar.primvar_name() == name)?;
    let place = reading.place_of(primvar.attribute().path());
    data(reading, primvar, convert)?.fit_instances(count, &place, &mut reading.warnings.borrow_mut())
}

/// The value of one instance; constant and uniform ones are those of all.
fn place<const N: usize>(channel: &Channel<N>, i: usize) -> [f32; N] {
    let of_all = matches!(channel.interpolation, Interpolation::Constant | Interpolation::Uniform);
    channel.at(if of_all { 0 } else { i })
}
