//! The files of value clips. OpenUSD takes those of a template that are there, and holds or interpolates over the
//! frames that are missing; the openusd crate (0.8) takes every frame for a clip, so a set of such a template is
//! written out in memory. What is missing of others is told.

use std::collections::{BTreeMap, HashMap, HashSet};

use openusd::ar::{DefaultResolver, ResolvedPath, Resolver};
use openusd::gf;
use openusd::sdf::{self, AssetPath, Dictionary, FieldKey, Value};
use openusd::usd::{ClipsAPI, Prim, SpecSite};

use super::clip_template::Template;
use super::stage::Reading;

/// Files of clips that were told of: the prim of their set, and how that names them.
pub(super) type Missing = HashSet<(sdf::Path, String)>;

/// The fields of a clip set, each with its strongest opinion and the site of that.
type Set<'s> = HashMap<String, (Value, &'s SpecSite)>;

/// Makes the sets that `sites`, the strongest first, have for `prim` what OpenUSD makes of them.
pub(super) fn mend(reading: &Reading<'_>, prim: &Prim, sites: &[SpecSite]) {
    let mut sets = compose(reading, sites);
    let named = ClipsAPI::from_prim_unchecked(prim.clone()).clip_sets().ok().flatten();
    if let Some(named) = named.map(|named| named.flatten()) {
        sets.retain(|name, _| named.contains(name));
    }
    for (name, set) in &sets {
        if let Some((Value::AssetPathVec(clips), site)) = set.get("assetPaths") {
            tell_of_missing(reading, prim, clips, site);
            tell_of_indices(reading, prim, name, set, clips.len());
        } else if let Some((_, site)) = set.get("templateAssetPath") {
            write_out(reading, prim, name, set, site);
        }
        if let Some((manifest, site)) = set.get("manifestAssetPath")
            && let Some(asset) = manifest.as_str().filter(|asset| is_missing(&site.layer, asset))
        {
            reading.warn(
                prim.path(),
                format!("the manifest @{asset}@ of its value clips is not found; they are left out"),
            );
        }
    }
}

/// The path of `asset` as `layer` names it, for a resolver.
pub(super) fn identifier(layer: &str, asset: &str) -> String {
    DefaultResolver::new().create_identifier(asset, Some(&ResolvedPath::new(layer)))
}

/// True where there is no file `asset`; of expressions nothing is known.
fn is_missing(layer: &str, asset: &str) -> bool {
    !asset.is_empty() && !asset.starts_with('`') && DefaultResolver::new().resolve(&identifier(layer, asset)).is_none()
}

fn compose<'s>(reading: &Reading<'_>, sites: &'s [SpecSite]) -> BTreeMap<String, Set<'s>> {
    let mut sets: BTreeMap<String, Set<'_>> = BTreeMap::new();
    for site in sites {
        let clips = clips(reading, site);
        let of_set = |(name, fields)| Some((name, Value::try_as_dictionary(fields)?));
        for (name, fields) in clips.into_iter().flatten().filter_map(of_set) {
            let set = sets.entry(name).or_default();
            for (field, value) in fields {
                set.entry(field).or_insert((value, site));
            }
        }
    }
    sets
}

/// The clip sets that are authored at `site`.
fn clips(reading: &Reading<'_>, site: &SpecSite) -> Option<Dictionary> {
    let layer = reading.stage.layer(&site.layer)?;
    let field = layer.data().try_field(&site.path, FieldKey::Clips.as_str()).ok()??;
    field.into_owned().try_as_dictionary()
}

fn tell_of_missing(reading: &Reading<'_>, prim: &Prim, clips: &[AssetPath], site: &SpecSite) {
    let missing: Vec<&str> =
        clips.iter().map(AssetPath::asset_path).filter(|asset| is_missing(&site.layer, asset)).collect();
    let what = match missing[..] {
        [] => return,
        [asset] => format!("the value clip @{asset}@ is not found; it gives no values"),
        [asset, ..] => format!(
            "{} of its {} value clips are not found, @{asset}@ the first; they give no values",
            missing.len(),
            clips.len()
        ),
    };
    reading.warn(prim.path(), what);
    let told = missing.into_iter().map(|asset| (prim.path().clone(), asset.to_owned()));
    reading.missing_clips.borrow_mut().extend(told);
}

/// Tells of times at which a clip is active that there is not, for which OpenUSD and the crate leave out the set.
fn tell_of_indices(reading: &Reading<'_>, prim: &Prim, name: &str, set: &Set<'_>, count: usize) {
    let Some((Value::Vec2dVec(active), _)) = set.get("active") else { return };
    if let Some(odd) = active.iter().find(|active| !(0.0..count as f64).contains(&active.y)) {
        let what = format!(
            "active of its clip set \"{name}\" asks for clip {} at {}, and there are {count}; the set is left out",
            odd.y, odd.x
        );
        reading.warn(prim.path(), what);
    }
}

/// Makes the set `name` one of the files that its template finds, where some are missing.
fn write_out(reading: &Reading<'_>, prim: &Prim, name: &str, set: &Set<'_>, site: &SpecSite) {
    let number = |field: &str| match set.get(field) {
        Some((Value::Double(number), _)) => Some(*number),
        _ => None,
    };
    let pattern = set.get("templateAssetPath").and_then(|(pattern, _)| pattern.as_str());
    let Some(template) = pattern.filter(|p| !p.starts_with('`')).and_then(|pattern| Template::of(pattern, number))
    else {
        return;
    };
    let times = template.times();
    let found: Vec<(f64, String)> = times
        .iter()
        .map(|&time| (time, template.file(time)))
        .filter(|(_, file)| !is_missing(&site.layer, file))
        .collect();
    if found.len() == times.len() {
        return;
    }
    let Some(mut clips) = clips(reading, site) else { return };
    let Some(Value::Dictionary(fields)) = clips.get_mut(name) else { return };
    if found.is_empty() {
        let what = format!("no file of its value clips {} is found; they are left out", pattern.unwrap_or_default());
        reading.warn(prim.path(), what);
        fields.remove("templateAssetPath");
    } else {
        let offset = template.offset.unwrap_or(0.0);
        let active = found.iter().enumerate().map(|(i, (time, _))| gf::vec2d(time + offset, i as f64));
        let mut knots: Vec<f64> = found.iter().map(|(time, _)| *time).collect();
        // What an offset lets the first and the last clip be asked for beyond them.
        if template.offset.is_some() {
            knots.insert(0, template.start - offset.abs());
            knots.push(template.end + offset.abs());
        }
        fields.insert("active".into(), Value::Vec2dVec(active.collect()));
        fields.insert("times".into(), Value::Vec2dVec(knots.into_iter().map(|time| gf::vec2d(time, time)).collect()));
        let files = found.into_iter().map(|(_, file)| AssetPath::from(file)).collect();
        fields.insert("assetPaths".into(), Value::AssetPathVec(files));
    }
    let Some(mut layer) = reading.stage.layer_mut(&site.layer) else { return };
    let edited = layer.edit(|edit| {
        edit.data_mut().set_field(&site.path, FieldKey::Clips.as_str(), Value::Dictionary(clips));
        Ok(())
    });
    drop(layer);
    if let Err(error) = edited {
        reading.warn(prim.path(), format!("its value clips can't do without those that are missing: {error}"));
    }
}
