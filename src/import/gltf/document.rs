//! From JSON text to [`Root`]: version and extensions are checked before anything else is done.

use super::json::{Head, Root};
use crate::error::{Error, Place, Result, Warnings};

/// Extensions that are read in full.
const SUPPORTED: &[&str] = &[
    "EXT_lights_ies",
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    super::stamp::NAME,
];

/// Extensions that are read where the build has their decoder.
const MESHOPT: &[&str] = &["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Optional extensions that change what is seen, so that their absence is told; without an entry
/// here an unknown optional extension is ignored.
const VISIBLE: &[(&str, &str)] = &[
    ("KHR_materials_subsurface", "subsurface scattering is left out"),
    ("KHR_materials_volume_scatter", "scattering inside of volumes is left out"),
    ("EXT_lights_image_based", "the image-based light is left out"),
    ("MSFT_lod", "the finest level of detail is rendered"),
];

/// Parses `json`.
///
/// # Errors
/// [`Error::Invalid`] for text that isn't glTF, [`Error::Unsupported`] for another version and for
/// extensions that the file requires and this build lacks (all of them named).
pub(super) fn parse(json: &[u8], place: &Place, warnings: &mut Warnings) -> Result<Root> {
    let text = std::str::from_utf8(json).map_err(|e| Error::invalid(place, format!("the JSON is not UTF-8: {e}")))?;
    let parsed = serde_json::from_str::<Root>(text);
    match &parsed {
        Ok(root) => {
            let mut required = root.extensions_required.clone();
            // Textures that come with another image, too, need no KTX2.
            if root.textures.iter().all(|t| t.extensions.basisu.is_none() || t.source.is_some()) {
                required.retain(|name| name != "KHR_texture_basisu");
            }
            check_head(&root.asset.version, root.asset.min_version.as_deref(), &required, place)?;
        }
        // What an unsupported extension does to the rest of the file may be why it doesn't parse.
        Err(_) => {
            if let Ok(head) = serde_json::from_str::<Head>(text) {
                check_head(&head.asset.version, head.asset.min_version.as_deref(), &head.extensions_required, place)?;
            }
        }
    }
    let root = parsed.map_err(|e| Error::invalid(place, format!("the JSON is not glTF 2.0: {e}")))?;
    for (name, consequence) in VISIBLE {
        if root.extensions_used.iter().any(|used| used == name) {
            warnings.push(place, format!("extension {name} is not supported: {consequence}"));
        }
    }
    Ok(root)
}

fn check_head(version: &str, min_version: Option<&str>, required: &[String], place: &Place) -> Result<()> {
    let major = |version: &str| version.split('.').next().unwrap_or_default().to_owned();
    match major(version).as_str() {
        "2" => {}
        "" => return Err(Error::invalid(place, "no asset.version: this JSON is not glTF")),
        _ => return Err(Error::unsupported(place, format!("glTF version {version}; only version 2 is read"))),
    }
    if let Some(min) = min_version
        && min != "2.0"
    {
        return Err(Error::unsupported(place, format!("needs a reader of glTF {min}; this one reads 2.0")));
    }
    let missing: Vec<&str> = required.iter().map(String::as_str).filter(|name| !is_supported(name)).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let hint = if missing.contains(&"KHR_texture_basisu") { "; export with PNG, JPEG or WebP textures" } else { "" };
    Err(Error::unsupported(place, format!("requires extensions that are not supported: {}{hint}", missing.join(", "))))
}

fn is_supported(name: &str) -> bool {
    SUPPORTED.contains(&name) || (cfg!(feature = "meshopt") && MESHOPT.contains(&name))
}

/// How messages name an element of the file: its kind, and its name or else its index.
pub(super) fn label(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} '{name}'"),
        _ => format!("{kind} {index}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse_str(json: &str) -> Result<Root> {
        parse(json.as_bytes(), &Place::file("a.gltf"), &mut Warnings::new())
    }

    #[test]
    fn unknown_required_extensions_are_all_named() {
        let error = parse_str(
            r#"{"asset":{"version":"2.0"},"extensionsRequired":["KHR_lights_punctual","VENDOR_a","KHR_texture_basisu"],"textures":[{"extensions":{"KHR_texture_basisu":{"source":0}}}]}"#,
        );
        let message = error.unwrap_err().to_string();
        assert!(message.contains("VENDOR_a, KHR_texture_basisu"), "{message}");
        assert!(!message.contains("KHR_lights_punctual"), "{message}");
    }

    #[test]
    fn an_unknown_extension_is_named_even_where_the_rest_does_not_parse() {
        let error = parse_str(r#"{"asset":{"version":"2.0"},"extensionsRequired":["VENDOR_a"],"nodes":[{"mesh":{}}]}"#);
        assert!(matches!(error, Err(Error::Unsupported { .. })));
    }

    #[test]
    fn other_versions_and_other_json_are_refused() {
        assert!(matches!(parse_str(r#"{"asset":{"version":"1.0"}}"#), Err(Error::Unsupported { .. })));
        assert!(matches!(
            parse_str(r#"{"asset":{"version":"2.1","minVersion":"2.1"}}"#),
            Err(Error::Unsupported { .. })
        ));
        assert!(parse_str(r#"{"asset":{"version":"2.1"}}"#).is_ok());
        assert!(matches!(parse_str("{}"), Err(Error::Invalid { .. })));
        assert!(matches!(parse_str(r#"{"asset":"#), Err(Error::Invalid { .. })));
    }
}
