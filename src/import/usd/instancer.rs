//! Point instancers: prototypes that stand wherever an array says (UsdGeomPointInstancer).

use std::collections::HashSet;
use std::rc::Rc;

use openusd::gf::{Quatf, Quath, Vec3f};
use openusd::sdf;
use openusd::usd::{Prim, TimeCode};

use super::flow::{self, Flow, vector};
use super::inherit::{Context, Mover, Pose};
use super::layer;
use super::per_instance::{Each, PerInstance};
use super::shape::tint::{self, Tint};
use super::stage::Reading;
use super::walk::{Shown, Walk};
use crate::math::{DAffine3, DMat3, DQuat, DVec3};

/// What places the instances, beside their velocities.
const PLACES: [&str; 4] = ["positions", "orientations", "orientationsf", "scales"];

/// Adds the instances of the instancer `prim`, whose children take `context` from it.
pub(super) fn walk(walk: &mut Walk<'_, '_>, prim: &Prim, context: &Context, shown: &mut Vec<Shown>) {
    let reading = walk.reading;
    let indices: Vec<i32> = reading.value(prim, "protoIndices").unwrap_or_default();
    let count = indices.len();
    if count == 0 {
        return;
    }
    let prototypes = prototypes(walk, prim, context);
    let of =
        |index: &i32| usize::try_from(*index).ok().and_then(|index| prototypes.get(index)).map_or(0, |p| p.shown.len());
    if !walk.affords(indices.iter().map(of).fold(0, usize::saturating_add), prim) {
        return;
    }
    let Some(layout) = Layout::of(reading, prim, count) else {
        let what = format!("has {count} protoIndices but another number of positions; its instances are left out");
        return reading.warn(prim.path(), what);
    };
    let colors = tint::of_instances(reading, prim, count);
    let values = PerInstance::of(reading, prim, count);
    let places = layout.at(reading.time);
    let motion = motion(walk, prim, &layout);
    let mask = mask(reading, prim, count);
    let mut lost = 0;
    for (i, index) in indices.into_iter().enumerate() {
        if !mask.as_ref().is_none_or(|mask| mask[i]) {
            continue;
        }
        let Some(prototype) = usize::try_from(index).ok().and_then(|index| prototypes.get(index)) else {
            lost += 1;
            continue;
        };
        let moved = motion.as_ref().map(|at| at.iter().map(|places| places[i]).collect());
        let place = context.pose.place(&Pose { motion: moved, ..Pose::still(places[i]) });
        let color = colors.as_ref().map(|colors| colors[i]).or(prototype.color);
        let each = Each::one(values.as_ref(), i);
        for inner in prototype.shown.iter() {
            let pose = place.place(&inner.pose);
            let asset = inner.asset.clone().or_else(|| context.asset.clone());
            let each = inner.each.within(&each);
            walk.show(Shown { pose, asset, color: inner.color.or(color), each, ..inner.clone() }, shown);
        }
    }
    if lost > 0 {
        let what = format!("{lost} protoIndices are not those of one of its {} prototypes; left out", prototypes.len());
        reading.warn(prim.path(), what);
    }
}

/// A prototype, where its root stands as if alone.
struct Prototype {
    shown: Rc<Vec<Shown>>,
    /// What its prims inherit from above it, where the instancer has no colours.
    color: Option<Tint>,
}

fn prototypes(walk: &mut Walk<'_, '_>, prim: &Prim, context: &Context) -> Vec<Prototype> {
    let reading = walk.reading;
    let targets = prim.relationship("prototypes").forwarded_targets().unwrap_or_default();
    let of = |path: sdf::Path| {
        let above = walk.context_at(&path.parent().unwrap_or_default());
        let color = tint::inherited(reading, &above.primvars);
        let shown = match walk.prototypes.pointed.get(&path) {
            Some(Some(known)) => known.clone(),
            Some(None) => {
                reading.warn(prim.path(), format!("is within its own prototype {path}; that is left out"));
                Rc::default()
            }
            None => {
                walk.prototypes.pointed.insert(path.clone(), None);
                let found = Rc::new(prototype(walk, prim, context, &path));
                walk.prototypes.pointed.insert(path, Some(found.clone()));
                found
            }
        };
        Prototype { shown, color }
    };
    targets.into_iter().map(of).collect()
}

fn prototype(walk: &mut Walk<'_, '_>, instancer: &Prim, context: &Context, path: &sdf::Path) -> Vec<Shown> {
    let reading = walk.reading;
    let Some(root) = reading.stage.prim(path).ok().filter(|root| root.is_valid().unwrap_or(false)) else {
        reading.warn(instancer.path(), format!("its prototype {path} does not exist; that is left out"));
        return Vec::new();
    };
    if instancer.path().has_prefix(path) {
        reading.warn(instancer.path(), format!("is within its own prototype {path}; that is left out"));
        return Vec::new();
    }
    // What it takes from its ancestors, save where they stand.
    let inside = path.has_prefix(instancer.path());
    let mut within = match path.parent() {
        Some(above) => (*walk.context_at(&above)).clone(),
        None => return Vec::new(),
    };
    within.pose = Pose::still(DAffine3::IDENTITY);
    within.asset = None;
    within.group = false;
    within.primvars = tint::without(&within.primvars);
    within.purpose = within.purpose.or(context.purpose);
    let mut shown = Vec::new();
    if let Some(inner) = walk.enter(&root, &within, true, &mut shown) {
        walk.below(&root, inner, true, &mut shown);
    }
    if !inside {
        // The instancer is what the user sees.
        let name = path.name().unwrap_or_default();
        let seen = instancer.path().append_path(name).unwrap_or_else(|_| instancer.path().clone());
        for one in &mut shown {
            one.path = one.path.replace_prefix(path, &seen).unwrap_or_else(|| one.path.clone());
        }
    }
    shown
}

/// The transforms of all instances at each time of the shutter, if they move.
fn motion(walk: &mut Walk<'_, '_>, prim: &Prim, layout: &Layout<'_>) -> Option<Vec<Vec<DAffine3>>> {
    let attributes = || PLACES.map(|name| prim.attribute(name)).to_vec();
    let flows = layout.flow.is_some() || layout.spin.is_some();
    walk.clock.note(|| Mover::Attributes(attributes(), flows));
    let varies = || attributes().iter().any(|a| a.value_might_be_time_varying().unwrap_or(false));
    if walk.clock.times.is_empty() || !(flows || varies()) {
        return None;
    }
    let frame = walk.reading.time.value();
    Some(walk.clock.times.iter().map(|time| layout.at(TimeCode::new(frame + time))).collect())
}

/// What places the instances within the instancer, as UsdGeomPointInstancer's
/// ComputeInstanceTransformsAtTimes has it without the prototypes' own transforms: by velocities from the last
/// sample on, or, where there are none, by the values of each time.
struct Layout<'a> {
    reading: &'a Reading<'a>,
    prim: &'a Prim,
    places: Places,
    flow: Option<Flow>,
    spin: Option<Flow>,
    /// The attribute of the orientations.
    turned_by: Option<&'static str>,
}

/// Places of all instances; scales and turns where there are any.
#[derive(Clone)]
struct Places {
    positions: Vec<Vec3f>,
    scales: Option<Vec<Vec3f>>,
    turns: Option<Vec<DMat3>>,
}

impl<'a> Layout<'a> {
    /// That of `count` instances; `None` where there are positions for another number of them.
    fn of(reading: &'a Reading<'a>, prim: &'a Prim, count: usize) -> Option<Self> {
        let turned_by = ["orientationsf", "orientations"].into_iter().find(|name| {
            let at = flow::last_sample(reading, &prim.attribute(*name), reading.time);
            turns(reading, prim, name, at).is_some()
        });
        let flow = Flow::of(reading, prim, "positions", "velocities", Some("accelerations"), count);
        let spin = turned_by.and_then(|name| Flow::of(reading, prim, name, "angularVelocities", None, count));
        let fits = |len: usize, name: &str| {
            if len != count {
                reading.warn(prim.path(), format!("has {len} {name} for {count} instances; they are left out"));
            }
            len == count
        };
        // Between samples where nothing flows; the base that times of the shutter fall back to.
        let is_still = flow.is_none() && spin.is_none();
        let at = |name: &str| {
            if is_still { reading.time } else { flow::last_sample(reading, &prim.attribute(name), reading.time) }
        };
        let positions = vectors(reading, prim, "positions", at("positions")).filter(|p| p.len() == count)?;
        let scales = vectors(reading, prim, "scales", at("scales")).filter(|scales| fits(scales.len(), "scales"));
        let turned_by = turned_by.filter(|name| {
            let turns = turns(reading, prim, name, at(name));
            turns.is_some_and(|turns| fits(turns.len(), name))
        });
        let turns = turned_by.and_then(|name| turns(reading, prim, name, at(name)));
        let spin = spin.filter(|_| turns.is_some());
        Some(Self { reading, prim, places: Places { positions, scales, turns }, flow, spin, turned_by })
    }

    fn at(&self, time: TimeCode) -> Vec<DAffine3> {
        if self.flow.is_some() || self.spin.is_some() || time == self.reading.time {
            return self.placed(&self.places, time);
        }
        let Self { reading, prim, places, .. } = self;
        let count = places.positions.len();
        let vectors = |name: &str| vectors(reading, prim, name, time).filter(|values| values.len() == count);
        let turned = |name| turns(reading, prim, name, time).filter(|values| values.len() == count);
        let now = Places {
            positions: vectors("positions").unwrap_or_else(|| places.positions.clone()),
            scales: vectors("scales").or_else(|| places.scales.clone()),
            turns: self.turned_by.and_then(turned).or_else(|| places.turns.clone()),
        };
        self.placed(&now, time)
    }

    fn placed(&self, places: &Places, time: TimeCode) -> Vec<DAffine3> {
        let Places { positions, scales, turns } = places;
        let place = |i: usize| {
            let moved = self.flow.as_ref().map_or(DVec3::ZERO, |flow| flow.change(i, time));
            let turned = self.spin.as_ref().map(|spin| DEGREE * spin.change(i, time));
            let turn = match (turns, turned) {
                (Some(turns), Some(angles)) => DMat3::from_quat(DQuat::from_scaled_axis(angles)) * turns[i],
                (Some(turns), None) => turns[i],
                _ => DMat3::IDENTITY,
            };
            let scale = scales.as_ref().map_or(DVec3::ONE, |scales| vector(scales[i]));
            DAffine3::from_mat3_translation(turn * DMat3::from_diagonal(scale), vector(positions[i]) + moved)
        };
        (0..positions.len()).map(place).collect()
    }
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// The vectors of attribute `name`; `None` where there are none.
fn vectors(reading: &Reading<'_>, prim: &Prim, name: &str, time: TimeCode) -> Option<Vec<Vec3f>> {
    reading.value_of::<Vec<Vec3f>>(&prim.attribute(name), time).filter(|values| !values.is_empty())
}

/// The orientations `name`, of half or single precision, as matrices.
fn turns(reading: &Reading<'_>, prim: &Prim, name: &str, time: TimeCode) -> Option<Vec<DMat3>> {
    let attribute = prim.attribute(name);
    let turns: Vec<DMat3> = if name == "orientations" {
        let halves: Vec<Quath> = reading.value_of(&attribute, time)?;
        halves.into_iter().map(|q| turn([q.x, q.y, q.z, q.w].map(|c| c.to_f64()))).collect()
    } else {
        let singles: Vec<Quatf> = reading.value_of(&attribute, time)?;
        singles.into_iter().map(|q| turn([q.x, q.y, q.z, q.w].map(f64::from))).collect()
    };
    (!turns.is_empty()).then_some(turns)
}

/// The matrix of a quaternion as it is: like OpenUSD, without making it a unit one first, which those of
/// half precision never quite are.
pub(super) fn turn([x, y, z, w]: [f64; 4]) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (z * x - y * w)),
        DVec3::new(2.0 * (x * y - z * w), 1.0 - 2.0 * (z * z + x * x), 2.0 * (y * z + x * w)),
        DVec3::new(2.0 * (z * x + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (y * y + x * x)),
    )
}

/// Which instances are seen; `None` for all.
fn mask(reading: &Reading<'_>, prim: &Prim, count: usize) -> Option<Vec<bool>> {
    let ids: Option<Vec<i64>> = reading.value(prim, "ids").filter(|ids: &Vec<i64>| !ids.is_empty());
    let ids = ids.filter(|ids| {
        if ids.len() != count {
            reading.warn(prim.path(), format!("has {} ids for {count} instances; they are left out", ids.len()));
        }
        ids.len() == count
    });
    let mut off: HashSet<i64> =
        reading.value::<Vec<i64>>(prim, "invisibleIds").unwrap_or_default().into_iter().collect();
    off.extend(layer::inactive_ids(&reading.stage, prim));
    if off.is_empty() {
        return None;
    }
    let seen = |i: usize| !off.contains(&ids.as_ref().map_or(i as i64, |ids| ids[i]));
    Some((0..count).map(seen).collect())
}
