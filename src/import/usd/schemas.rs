//! Applied API schemas that do nothing here: versions that are not known, and lights on prims without shape.

use openusd::sdf::Path;
use openusd::tf::Token;
use openusd::usd::{Prim, PrimTypeInfo, SchemaRegistry, VersionFilter};

use super::kinds::Kind;
use super::stage::Reading;

/// What is to be told of schemas on `prim` whose family is known and whose version is not, as `LightAPI_7`.
/// OpenUSD ignores them as it does every schema that it has never heard of; those are not told.
pub(super) fn unknown_versions(prim: &Prim, info: &PrimTypeInfo) -> Vec<(Path, String)> {
    let registry = prim.stage().schema_registry();
    let tell = |name: &Token| {
        let (schema, _) = SchemaRegistry::type_name_and_instance(name);
        if registry.schema_info(&schema).is_some() {
            return None;
        }
        let (family, _) = SchemaRegistry::parse_allowed_identifier(&schema)?;
        registry.schema_infos_in_family(&family, VersionFilter::All).next()?;
        Some((prim.path().clone(), format!("has {name}, a version of {family} that is not known; it is ignored")))
    };
    info.id().applied_api_schemas().iter().filter_map(tell).collect()
}

/// Tells of LightAPI on a prim of a `kind` that shows nothing itself; its authored properties are `names`.
///
/// To ask every transform for its schemas would take long: only those that author something of a light are.
pub(super) fn tell_of_shapeless(reading: &Reading<'_>, prim: &Prim, kind: &Kind, names: &[Token]) {
    let of_light = |name: &Token| name.starts_with("inputs:") || name.starts_with("light:");
    if !kind.name.is_empty() && !names.iter().any(of_light) {
        return;
    }
    let Ok(info) = prim.prim_type_info() else { return };
    for (path, what) in unknown_versions(prim, &info) {
        reading.warn(&path, what);
    }
    if info.prim_definition().applied_api_schemas().iter().any(|schema| schema.as_str() == "LightAPI") {
        let what = match kind.name.is_empty() {
            true => "is a light by LightAPI alone, without type or shape; it does not shine".to_string(),
            false => format!("LightAPI on a prim of type {} has no shape to shine; it is ignored", kind.name),
        };
        reading.warn(prim.path(), what);
    }
}
