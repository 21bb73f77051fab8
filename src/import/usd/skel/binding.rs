//! Which skeleton a prim follows and by what: properties of SkelBindingAPI, handed down from parent to child
//! within a SkelRoot.

use std::rc::Rc;
use std::sync::Arc;

use openusd::sdf::Path;
use openusd::tf::Token;
use openusd::usd::Prim;

use super::super::kinds::Kind;
use super::super::stage::Reading;
use super::{API, influences};

/// What a prim hands down.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in super::super) struct Inherited {
    /// What is bound; `None` outside of every SkelRoot, where nothing follows a skeleton.
    binding: Option<Binding>,
    /// Where the skeletons below get their poses from.
    animation: Option<Path>,
}

/// The skeleton, and the attributes that bind to it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Binding {
    skeleton: Option<Path>,
    /// True where one is named that is not there, which is told.
    lost: bool,
    indices: Option<Path>,
    weights: Option<Path>,
    bind: Option<Path>,
    joints: Option<Path>,
    method: Option<Path>,
}

/// What a prim follows.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(in super::super) struct Bound {
    pub(super) skeleton: Path,
    pub(super) animation: Option<Path>,
    /// The attributes with the joints of each point and their weights.
    pub(super) influences: Option<[Path; 2]>,
    /// The attribute with the transform at which it was bound.
    pub(super) bind: Option<Path>,
    /// The attribute with the joints that the indices count; those of the skeleton without.
    pub(super) joints: Option<Path>,
    pub(super) method: Option<Path>,
    /// True where it has blend shapes.
    pub(super) shapes: bool,
    /// True where all of it follows the same joints.
    pub(in super::super) rigid: bool,
}

impl Inherited {
    /// What `prim`, whose authored properties are `names`, hands down of its own and of `above`.
    pub fn of(
        reading: &Reading<'_>,
        prim: &Prim,
        kind: &Kind,
        names: &[Token],
        above: Option<&Rc<Self>>,
    ) -> Option<Rc<Self>> {
        let is_root = &*kind.name == "SkelRoot";
        let binds = names.iter().any(|name| is_of_binding(name)) && applies(reading, prim, names);
        if !is_root && !binds {
            return above.cloned();
        }
        let mut own = above.map(|above| (**above).clone()).unwrap_or_default();
        if is_root {
            own.binding.get_or_insert_default();
        }
        for name in names.iter().filter(|_| binds) {
            let is_blank = |name: &Token| !prim.relationship(name.clone()).has_authored_targets().unwrap_or(false);
            if matches!(name.as_str(), "skel:animationSource" | "skel:skeleton") && is_blank(name) {
                continue;
            }
            let path = || prim.path().append_property(name.clone()).ok();
            match (name.as_str(), &mut own.binding) {
                ("skel:animationSource", _) => own.animation = animation_source(reading, prim, name),
                ("skel:skeleton", Some(binding)) => {
                    let target = target(prim, name, "Skeleton");
                    binding.lost = target.is_err();
                    binding.skeleton = target.unwrap_or_else(|what| {
                        reading.warn(prim.path(), format!("{what}; what follows it stands as modelled"));
                        None
                    });
                }
                ("skel:skeleton", None) => {
                    reading.warn(prim.path(), "is bound to a skeleton outside of any SkelRoot; it stands as modelled");
                }
                ("primvars:skel:jointIndices", Some(binding)) => binding.indices = path(),
                ("primvars:skel:jointWeights", Some(binding)) => binding.weights = path(),
                ("primvars:skel:geomBindTransform", Some(binding)) => binding.bind = path(),
                ("primvars:skel:skinningMethod", Some(binding)) => binding.method = path(),
                ("skel:joints", Some(binding)) => binding.joints = path(),
                _ => {}
            }
        }
        Some(Rc::new(own))
    }

    /// The same as seen by a walk below `first` of what stands below `instance`: targets there become those
    /// of the same prims below the other.
    pub fn within(&self, first: &Path, instance: &Path) -> Self {
        let moved = |path: &Path| path.replace_prefix(instance, first).unwrap_or_else(|| path.clone());
        let mut inside = self.clone();
        inside.animation = inside.animation.as_ref().map(moved);
        if let Some(binding) = &mut inside.binding {
            binding.skeleton = binding.skeleton.as_ref().map(moved);
        }
        inside
    }

    /// Where skeletons below get their poses from.
    pub fn animation(&self) -> Option<&Path> {
        self.animation.as_ref()
    }

    /// What `prim`, whose authored properties are `names` and which hands this down, follows. Below each of
    /// `walked`, the first of like instances, poses come from the path beside it where nothing nearer to the
    /// skeleton names another.
    pub fn bound(
        &self,
        reading: &Reading<'_>,
        prim: &Prim,
        names: &[Token],
        walked: &[(Path, Option<Path>)],
    ) -> Option<Arc<Bound>> {
        let binding = self.binding.as_ref()?;
        let has = |name: &str| names.iter().any(|known| known.as_str() == name);
        // Unlike all else, these are not inherited.
        let shapes = has("skel:blendShapes") && has("skel:blendShapeTargets") && applies(reading, prim, names);
        let influences = match (&binding.indices, &binding.weights) {
            (Some(indices), Some(weights)) => Some([indices.clone(), weights.clone()]),
            (None, None) => None,
            _ => {
                reading.warn(prim.path(), "has joint indices or weights, but not both; it stands as modelled");
                None
            }
        };
        if influences.is_none() && !shapes {
            return None;
        }
        let registry = reading.stage.schema_registry();
        if !registry.is_a(&reading.type_name(prim), &Token::from("Boundable")) {
            return None;
        }
        let Some(skeleton) = binding.skeleton.clone() else {
            if binding.lost {
                return None;
            }
            reading.warn(prim.path(), "follows joints or blend shapes of no skeleton; it stands as modelled");
            return None;
        };
        let animation = animation(reading, &skeleton, walked);
        Some(Arc::new(Bound {
            rigid: influences.as_ref().is_some_and(|[indices, _]| influences::are_constant(reading, indices)),
            skeleton,
            animation,
            influences,
            bind: binding.bind.clone(),
            joints: binding.joints.clone(),
            method: binding.method.clone(),
            shapes,
        }))
    }
}

/// True for the names of properties of SkelBindingAPI.
pub(in super::super) fn is_of_binding(name: &str) -> bool {
    name.starts_with("skel:") || name.starts_with("primvars:skel:")
}

/// True where SkelBindingAPI is applied to `prim`; else its properties do nothing, which is told.
fn applies(reading: &Reading<'_>, prim: &Prim, names: &[Token]) -> bool {
    let applies = prim.has_api_schema(API).unwrap_or(false);
    if !applies && let Some(name) = names.iter().find(|name| is_of_binding(name)) {
        reading.warn(prim.path(), format!("has {name} without {API}; it is ignored, as OpenUSD does"));
    }
    applies
}

/// The first target of relationship `name`, if any, which is to be a prim of type `kind`; what is wrong as an error.
fn target(prim: &Prim, name: &Token, kind: &str) -> Result<Option<Path>, String> {
    let targets = prim.relationship(name.clone()).forwarded_targets().unwrap_or_default();
    let Some(target) = targets.into_iter().next() else { return Ok(None) };
    let found = prim.stage().prim(&target).ok().filter(|found| found.is_valid().unwrap_or(false));
    match found.map(|found| found.type_name().ok().flatten().unwrap_or_default()) {
        Some(found) if found.as_str() == kind => Ok(Some(target)),
        Some(found) => Err(format!("{name} leads to {target}, a {found}, not a {kind}")),
        None => Err(format!("{name} leads to {target}, where no {kind} is")),
    }
}

fn animation_source(reading: &Reading<'_>, prim: &Prim, name: &Token) -> Option<Path> {
    target(prim, name, "SkelAnimation").unwrap_or_else(|what| {
        reading.warn(prim.path(), format!("{what}; the rest pose is used"));
        None
    })
}

/// Where `skeleton` gets its poses from: what it names, or the nearest prim above it that does.
fn animation(reading: &Reading<'_>, skeleton: &Path, walked: &[(Path, Option<Path>)]) -> Option<Path> {
    let name = Token::from("skel:animationSource");
    for path in skeleton.ancestors() {
        if let Some((_, animation)) = walked.iter().find(|(first, _)| *first == path) {
            return animation.clone();
        }
        let Ok(prim) = reading.stage.prim(&path) else { continue };
        let names = prim.authored_property_names().unwrap_or_default();
        if names.contains(&name) && applies(reading, &prim, &names) {
            return animation_source(reading, &prim, &name);
        }
    }
    None
}
