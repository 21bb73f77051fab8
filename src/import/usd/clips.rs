//! Value clips of attributes that no layer of the stage has. OpenUSD reaches those that a schema declares; the
//! openusd crate (0.8) those that a layer does, so what a set's manifest has is declared in memory, beside the
//! set.

use std::collections::HashSet;

use openusd::ar::{DefaultResolver, Resolver};
use openusd::sdf::{self, AbstractData, FieldKey, Value};
use openusd::usd::{ClipsAPI, Prim};

use super::stage::Reading;
use super::{clip_sets, layer};

/// Where clips were declared.
pub(super) type Declared = HashSet<(String, sdf::Path)>;

/// Declares what the clips of `prim`, if it has any, give values to.
pub(super) fn declare(reading: &Reading<'_>, prim: &Prim) {
    let stage = &reading.stage;
    let has_clips = |layer: &str, path: &sdf::Path| {
        stage.layer(layer).is_some_and(|layer| layer.data().has_field(path, FieldKey::Clips.as_str()))
    };
    let mut sites = prim.prim_stack().unwrap_or_default();
    sites.retain(|site| has_clips(&site.layer, &site.path));
    let Some(site) = sites.first() else { return };
    if !reading.declared.borrow_mut().insert((site.layer.clone(), site.path.clone())) {
        return;
    }
    clip_sets::mend(reading, prim, &sites);
    let clips = ClipsAPI::from_prim_unchecked(prim.clone());
    let mut declared = Vec::new();
    for set in clips.clip_set_names().unwrap_or_default() {
        let root = clips.clip_prim_path(&set).ok().flatten().and_then(|path| sdf::path(path).ok());
        let root = root.unwrap_or_else(|| prim.path().clone());
        match clips.clip_manifest_asset_path(&set).ok().flatten() {
            Some(asset) => {
                let resolved = asset.resolved_path().map(ToOwned::to_owned);
                let manifest = resolved.unwrap_or_else(|| clip_sets::identifier(&site.layer, asset.asset_path()));
                if let Some(manifest) = open(reading, &manifest) {
                    declared.extend(attributes(&*manifest, &root));
                }
            }
            None => {
                if let Ok(Some(manifest)) = clips.generate_clip_manifest(&set, false) {
                    declared.extend(attributes(manifest.data(), &root));
                }
            }
        }
    }
    // Several sets may have the same.
    let mut known = HashSet::new();
    declared.retain(|(below, _)| {
        let Some(path) = below.at(prim.path()).filter(|path| known.insert(path.clone())) else { return false };
        let attribute = stage.attribute(path).ok();
        attribute.and_then(|a| a.property_stack().ok()).is_some_and(|stack| stack.is_empty())
    });
    if declared.is_empty() {
        return;
    }
    let Some(mut layer) = stage.layer_mut(&site.layer) else { return };
    let edited = layer.edit(|edit| {
        for (below, type_name) in declared {
            let Some(path) = below.at(&site.path) else { continue };
            sdf::AttributeSpec::new(edit.data_mut(), path, type_name.as_str(), sdf::Variability::Varying, false)?;
        }
        Ok(())
    });
    drop(layer);
    if let Err(error) = edited {
        reading.warn(prim.path(), format!("what only its value clips have is left out: {error}"));
    }
}

/// The manifest at `path`; what is wrong with one is told by the crate, which opens it as well.
fn open(reading: &Reading<'_>, path: &str) -> Option<sdf::LayerData> {
    let resolver = DefaultResolver::new();
    let asset = resolver.open_asset(&resolver.resolve(path)?).ok()?;
    let asset = layer::mend(asset, path, &mut reading.met.borrow_mut()).ok()?;
    sdf::LayerRegistry::read_bytes(asset.into_buffer().ok()?, path).ok()
}

/// A path below another.
struct Below {
    path: sdf::Path,
    root: sdf::Path,
}

impl Below {
    /// The same below `root`.
    fn at(&self, root: &sdf::Path) -> Option<sdf::Path> {
        self.path.replace_prefix(&self.root, root)
    }
}

/// Attributes of `manifest` at and below `root`, with their types. Operations of transforms and primvars count
/// only where the stage itself has them.
fn attributes(manifest: &dyn AbstractData, root: &sdf::Path) -> Vec<(Below, String)> {
    let attribute = |spec: sdf::Path| {
        let path = spec.strip_all_variant_selections();
        let name = path.name().unwrap_or_default();
        let is_listed = name.starts_with("primvars:") || name.starts_with("xformOp:");
        if !path.is_property_path() || is_listed || !path.has_prefix(root) {
            return None;
        }
        let type_name = match manifest.try_field(&spec, FieldKey::TypeName.as_str()).ok()??.into_owned() {
            Value::Token(name) => name.to_string(),
            Value::String(name) => name,
            _ => return None,
        };
        Some((Below { path, root: root.clone() }, type_name))
    };
    manifest.spec_paths().into_iter().filter_map(attribute).collect()
}
