//! Light and shadow linking: the collections of a light as sets of instances.

use openusd::sdf::{self, Path};
use openusd::usd::{CollectionAPI, PathRule, Prim};

use super::super::stage::Reading;
use crate::desc::{LinkSet, SceneDesc};

/// Fills the links of all lights once all instances are there: of lamps, of shapes with LightAPI, and of shapes
/// that another prim makes shine, which `light_of` gives.
pub(in super::super) fn link<'a>(
    reading: &Reading<'_>,
    light_of: impl Fn(&Path) -> Option<&'a Path>,
    scene: &mut SceneDesc,
) {
    let path_of = |node: Option<&str>| Path::new(node?).ok();
    let instances: Vec<Option<Path>> = scene.instances.iter().map(|i| path_of(i.place.node.as_deref())).collect();
    let lamps = scene.lights.iter_mut().map(|light| (&light.place, &mut light.links, true));
    let shapes = scene.instances.iter_mut().map(|instance| (&instance.place, &mut instance.links, false));
    for (place, links, is_lamp) in lamps.chain(shapes) {
        let Some(path) = path_of(place.node.as_deref()) else { continue };
        let Ok(mut prim) = reading.stage.prim(path.clone()) else { continue };
        if !is_lamp && !prim.has_api_schema("LightAPI").unwrap_or(false) {
            let Some(Ok(light)) = light_of(&path).map(|light| reading.stage.prim(light.clone())) else { continue };
            prim = light;
        }
        links.receivers = members(&prim, "lightLink", &instances);
        links.blockers = members(&prim, "shadowLink", &instances);
    }
}

/// The instances in a collection; `None` for all of them.
fn members(prim: &Prim, collection: &str, instances: &[Option<Path>]) -> Option<LinkSet> {
    let query = CollectionAPI::from_prim_unchecked(prim.clone(), collection).compute_membership_query().ok()?;
    let is_root = |(path, rule): (&sdf::Path, &PathRule)| path.is_abs_root() && *rule != PathRule::Exclude;
    if query.expression_evaluator().is_none() && query.rule_map().iter().all(is_root) {
        // The fallback is the root with all below; without any rule nothing was said.
        return None;
    }
    let inside = |path: &Option<Path>| path.as_ref().is_none_or(|path| query.is_path_included(path));
    let (mut members, mut others) = (Vec::new(), Vec::new());
    for (i, path) in instances.iter().enumerate() {
        if inside(path) { members.push(i as u32) } else { others.push(i as u32) }
    }
    match (members.len(), others.len()) {
        (_, 0) => None,
        (inside, outside) if outside < inside => Some(LinkSet { instances: others, exclude: true }),
        _ => Some(LinkSet { instances: members, exclude: false }),
    }
}
