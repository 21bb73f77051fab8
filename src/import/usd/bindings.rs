//! Which material is bound to a prim, by the rules of UsdShadeMaterialBindingAPI: the purpose `full` before
//! all-purpose bindings unless the render settings say otherwise, a near binding before a far one unless
//! that is the stronger, collections before what is bound directly.
//!
//! `compute_bound_material` climbs to the root for every prim that is asked; here a prim hands its
//! bindings down to its children.

use std::rc::Rc;

use openusd::sdf::{self, Path};
use openusd::tf::Token;
use openusd::usd::{CollectionAPI, MembershipQuery, Prim};

use super::material;
use super::stage::Reading;

/// What every binding's name starts with.
const BINDING: &str = "material:binding";

/// In the order of `Reading::binding_purposes`.
type ByPurpose<T> = Box<[T]>;

/// A material and whether it is stronger than what is bound below.
#[derive(Clone)]
struct Bound {
    material: Path,
    stronger: bool,
}

/// Bindings of a prim and of all above it.
pub(super) struct Bindings {
    above: Option<Rc<Bindings>>,
    direct: ByPurpose<Option<Bound>>,
    collections: ByPurpose<Vec<(MembershipQuery, Bound)>>,
    /// True where a collection has a say, here or above: what wins depends on who asks.
    by_member: bool,
}

/// What a chain of bindings says of a prim, while more of it may follow.
#[derive(Clone, Default)]
struct Winner {
    /// The nearest binding.
    near: Option<Path>,
    /// The farthest of those that are stronger than what is bound below.
    strong: Option<Path>,
}

impl Winner {
    fn add(&mut self, bound: &Bound) {
        self.near = Some(bound.material.clone());
        if bound.stronger && self.strong.is_none() {
            self.strong = Some(bound.material.clone());
        }
    }
}

impl Bindings {
    /// `above` with what `prim`, whose authored properties are `names`, binds.
    pub fn of(reading: &Reading<'_>, prim: &Prim, names: &[Token], above: Option<Rc<Self>>) -> Option<Rc<Self>> {
        let mut direct = vec![None; reading.binding_purposes.len()];
        let mut collections = vec![Vec::new(); reading.binding_purposes.len()];
        for name in names {
            let Some(rest) = name.strip_prefix(BINDING) else { continue };
            let parts: Vec<&str> = rest.split(':').skip(1).collect();
            let (named, by_collection) = match parts.as_slice() {
                [] if rest.is_empty() => ("", false),
                ["collection", named, _] => (*named, true),
                ["collection", ..] => ("", true),
                [named] => (*named, false),
                _ => continue,
            };
            let Some(purpose) = reading.binding_purposes.iter().position(|known| known.as_str() == named) else {
                continue;
            };
            if by_collection {
                collections[purpose].extend(collection_of(reading, prim, name));
            } else {
                direct[purpose] = direct_of(prim, name);
            }
        }
        if direct.iter().all(Option::is_none) && collections.iter().all(Vec::is_empty) {
            return above;
        }
        let by_member = collections.iter().any(|c| !c.is_empty()) || above.as_ref().is_some_and(|a| a.by_member);
        Some(Rc::new(Self { above, direct: direct.into(), collections: collections.into(), by_member }))
    }

    /// Adds what this chain says of the prim at `path`, the root first.
    fn fold(&self, purpose: usize, path: &Path, winner: &mut Winner) {
        if let Some(above) = &self.above {
            above.fold(purpose, path, winner);
        }
        // A collection takes the place of what the same prim is bound to directly, its strength included.
        let member = self.collections[purpose].iter().find(|(members, _)| members.is_path_included(path));
        match (member, &self.direct[purpose]) {
            (Some((_, bound)), direct) => {
                let stronger = bound.stronger || direct.as_ref().is_some_and(|direct| direct.stronger);
                winner.add(&Bound { material: bound.material.clone(), stronger });
            }
            (None, Some(direct)) => winner.add(direct),
            (None, None) => {}
        }
    }
}

/// How the prims of an instance are seen from outside: they were walked below another instance of the same
/// prototype.
pub(super) struct Scope {
    /// The scope that the instance itself is in.
    pub outer: Option<Rc<Scope>>,
    /// Bindings of the instance and of all above it.
    pub bindings: Option<Rc<Bindings>>,
    /// The instance that was walked.
    pub walked: Path,
    /// The instance that is meant.
    pub instance: Path,
}

impl Scope {
    /// `scope` within `outer`.
    pub fn within(scope: Option<&Rc<Self>>, outer: &Rc<Self>) -> Rc<Self> {
        match scope {
            None => outer.clone(),
            Some(scope) => Rc::new(Self {
                outer: Some(Self::within(scope.outer.as_ref(), outer)),
                bindings: scope.bindings.clone(),
                walked: scope.walked.clone(),
                instance: scope.instance.clone(),
            }),
        }
    }

    fn fold(&self, purpose: usize, path: &Path, winner: &mut Winner) {
        let outside = path.replace_prefix(&self.walked, &self.instance).unwrap_or_else(|| path.clone());
        if let Some(outer) = &self.outer {
            outer.fold(purpose, &outside, winner);
        }
        if let Some(bindings) = &self.bindings {
            bindings.fold(purpose, &outside, winner);
        }
        // A material of the instance is that of the instance that was walked: one for all.
        let inside = |material: &mut Path| {
            if let Some(path) = material.replace_prefix(&self.instance, &self.walked) {
                *material = path;
            }
        };
        winner.near.as_mut().map(inside);
        winner.strong.as_mut().map(inside);
    }

    /// True where what is bound depends on which instance is meant.
    pub fn matters(&self) -> bool {
        self.bindings.is_some() || self.outer.as_ref().is_some_and(|outer| outer.matters())
    }
}

/// The material bound to the prim at `path` below `bindings` in `scope`.
pub(super) fn bound(
    reading: &Reading<'_>,
    bindings: Option<&Rc<Bindings>>,
    scope: Option<&Rc<Scope>>,
    path: &Path,
) -> Option<Path> {
    for purpose in 0..reading.binding_purposes.len() {
        let mut winner = Winner::default();
        if let Some(scope) = scope {
            scope.fold(purpose, path, &mut winner);
        }
        if let Some(bindings) = bindings {
            bindings.fold(purpose, path, &mut winner);
        }
        if let Some(material) = winner.strong.or(winner.near) {
            // As in OpenUSD, what is bound but not there hides what else might be bound.
            let there = is_material(reading, &material);
            if !there {
                reading.warn(path, format!("is bound to {material}, which is not a material; nothing is bound"));
            }
            return there.then_some(material);
        }
    }
    None
}

/// True for a material, one of a MaterialX document included, which composition can't look into.
fn is_material(reading: &Reading<'_>, path: &Path) -> bool {
    let kind = reading.stage.prim(path).ok().and_then(|prim| prim.type_name().ok().flatten());
    kind.map_or_else(|| material::is_in_document(reading, path), |kind| kind.as_str() == "Material")
}

fn direct_of(prim: &Prim, name: &Token) -> Option<Bound> {
    let relationship = prim.relationship(name.clone());
    let targets = relationship.forwarded_targets().ok()?;
    let [material] = targets.as_slice() else { return None };
    Some(Bound { material: material.clone(), stronger: stronger(prim, name) })
}

fn collection_of(reading: &Reading<'_>, prim: &Prim, name: &Token) -> Option<(MembershipQuery, Bound)> {
    let targets = prim.relationship(name.clone()).targets().ok()?;
    let [collection, material] = targets.as_slice() else { return None };
    let (owner, instance) = CollectionAPI::instance_at_path(collection)?;
    let owner = reading.stage.prim(owner).ok()?;
    let members = CollectionAPI::from_prim_unchecked(owner, instance).compute_membership_query().ok()?;
    Some((members, Bound { material: material.clone(), stronger: stronger(prim, name) }))
}

fn stronger(prim: &Prim, name: &Token) -> bool {
    let strength = prim.relationship(name.clone()).get_metadata::<sdf::Value>("bindMaterialAs").ok().flatten();
    matches!(strength, Some(sdf::Value::Token(token)) if token.as_str() == "strongerThanDescendants")
}
