//! Primvars of point instancers that have a value for each instance, beside the colours of `tint.rs`. As in
//! UsdImaging they are those of the instancer itself that are neither constant nor uniform; constant ones reach
//! the prototypes below it as any ancestor's do. They are kept beside the shapes, which all instances share, and
//! only those that a material reads by name.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use openusd::sdf::Path;
use openusd::usd::Prim;
use openusd_schemas::geom::{Interpolation, Primvar, PrimvarsAPI};

use super::gather::Found;
use super::shape::primvar::{Channel, data, has_two_numbers};
use super::shape::tint;
use super::shape::values::graph_values;
use super::stage::Reading;

/// A point instancer that has such primvars.
pub(super) struct PerInstance {
    prim: Path,
    count: usize,
    names: Vec<Arc<str>>,
    /// Those of two numbers, which a material may take for texture coordinates.
    pairs: Vec<Arc<str>>,
}

impl PerInstance {
    /// Those of the instancer `prim` of `count` instances; `None` where it has none.
    pub fn of(reading: &Reading<'_>, prim: &Prim, count: usize) -> Option<Arc<Self>> {
        let api = PrimvarsAPI::from_prim_unchecked(prim.clone());
        let (mut names, mut pairs) = (Vec::new(), Vec::new());
        for name in reading.names(prim).iter().filter_map(|name| name.strip_prefix("primvars:")) {
            let Some(primvar) = api.primvar(name).ok().filter(|_| !tint::is_one(name)) else { continue };
            if !is_of_each(&primvar) {
                continue;
            }
            let name: Arc<str> = name.into();
            if has_two_numbers(&primvar) {
                pairs.push(name.clone());
            }
            names.push(name);
        }
        (!names.is_empty()).then(|| Arc::new(Self { prim: prim.path().clone(), count, names, pairs }))
    }
}

fn is_of_each(primvar: &Primvar) -> bool {
    let token = primvar.attribute().get_metadata::<openusd::tf::Token>("interpolation").ok().flatten();
    let interpolation = token.and_then(|token| Interpolation::from_token(&token));
    !matches!(interpolation, None | Some(Interpolation::Constant | Interpolation::Uniform))
}

/// An instance of an instancer with such primvars.
type One = (Arc<PerInstance>, u32);

/// Which of them something is in; the innermost first.
#[derive(Clone, Default)]
pub(super) struct Each(Option<Arc<[One]>>);

impl Each {
    /// Instance `index` of `instancer`.
    pub fn one(instancer: Option<&Arc<PerInstance>>, index: usize) -> Self {
        Self(instancer.map(|instancer| [(instancer.clone(), index as u32)].into()))
    }

    /// The same within the instances `outer`.
    pub fn within(&self, outer: &Self) -> Self {
        match (&self.0, &outer.0) {
            (None, _) => outer.clone(),
            (_, None) => self.clone(),
            (Some(inner), Some(outer)) => Self(Some(inner.iter().chain(&**outer).cloned().collect())),
        }
    }

    fn iter(&self) -> impl Iterator<Item = &One> {
        self.0.iter().flat_map(|list| list.iter())
    }
}

/// Names of the primvars of two numbers that some instance has a value of its own of.
pub(super) fn pairs(found: &[Found]) -> BTreeSet<Arc<str>> {
    found.iter().flat_map(|found| found.each.iter()).flat_map(|(of, _)| of.pairs.iter().cloned()).collect()
}

/// Values that were read, by the instancer's path and their name.
#[derive(Default)]
pub(super) struct Known(HashMap<(Path, Arc<str>), Option<Channel<4>>>);

impl Known {
    /// The values that `found` has for those of `names` that its instances, or the colour of these, say.
    pub fn of(&mut self, reading: &Reading<'_>, found: &Found, names: &[Arc<str>]) -> Vec<(Arc<str>, [f64; 4])> {
        let value = |name: &Arc<str>| {
            let of_color = found.color.and_then(|color| tint::named(color, name));
            let value = of_color.or_else(|| found.each.iter().find_map(|(of, i)| self.at(reading, of, *i, name)))?;
            Some((name.clone(), value.map(f64::from)))
        };
        names.iter().filter_map(value).collect()
    }

    fn at(&mut self, reading: &Reading<'_>, of: &PerInstance, index: u32, name: &Arc<str>) -> Option<[f32; 4]> {
        if !of.names.contains(name) {
            return None;
        }
        let read = || {
            let primvar = PrimvarsAPI::from_prim_unchecked(reading.stage.prim(&of.prim).ok()?).primvar(name).ok()?;
            let place = reading.place_of(primvar.attribute().path());
            data(reading, &primvar, graph_values)?.fit_instances(of.count, &place, &mut reading.warnings.borrow_mut())
        };
        let channel = self.0.entry((of.prim.clone(), name.clone())).or_insert_with(read).as_ref()?;
        Some(channel.at(index as usize))
    }
}
