//! UsdRender vars to passes.

use std::sync::Arc;

use super::render::is_a;
use super::shown::IN_CAMERA_SPACE;
use super::values::Values;
use crate::desc::{AovDesc, AovKind};
use crate::error::Place;

/// Where Houdini, and what reads its stages, keep the name under which a var is written.
const AOV_NAME: &str = "driver:parameters:aov:name";

/// What the vars of a product ask for.
#[derive(Default)]
pub(super) struct Vars {
    /// Names of the passes, each once.
    pub passes: Vec<Arc<str>>,
    /// AOVs that are among them, and where that is said.
    pub shown: Vec<(AovDesc, Place)>,
}

impl Vars {
    /// Those of `product`.
    pub fn of(product: &Values<'_>) -> Self {
        let reading = product.reading;
        let mut vars = Self::default();
        for path in product.targets("orderedVars") {
            let Some(var) = reading.stage.prim(path.clone()).ok().filter(|prim| is_a(prim, "RenderVar")) else {
                reading.warn(&path, "no RenderVar: it is left out");
                continue;
            };
            let values = Values { reading, prim: &var, path: &path };
            if let Some(shown) = primvar(&values).or_else(|| in_camera_space(&values)) {
                vars.add(&format!("aov:{}", shown.name));
                vars.shown.push((shown, reading.place_of(&path)));
            } else {
                of_var(&values).iter().for_each(|pass| vars.add(pass));
            }
        }
        vars
    }

    fn add(&mut self, pass: &str) {
        if !self.passes.iter().any(|known| **known == *pass) {
            self.passes.push(pass.into());
        }
    }
}

/// The primvar that a RenderVar shows as an AOV, under the name that Hydra has for it; `None` for one that shows
/// something else. The texture coordinates `st` have a pass.
fn primvar(values: &Values<'_>) -> Option<AovDesc> {
    let source = values.reading.value::<String>(values.prim, "sourceName").unwrap_or_default();
    let is_primvar = values.token("sourceType").is_some_and(|kind| kind == "primvar");
    let name = source.strip_prefix("primvars:").or_else(|| is_primvar.then_some(&*source))?;
    if name.is_empty() || name == "st" {
        return None;
    }
    let data = values.token("dataType").unwrap_or_default();
    if data.ends_with('4') || data.ends_with("4f") || data.ends_with("4d") || data.ends_with("4h") {
        values.warn(format!("of primvar {name}, which is {data}, three numbers are shown"));
    }
    let kind = if NUMBERS.contains(&&*data) { AovKind::Value } else { AovKind::Color };
    Some(AovDesc { name: format!("primvars:{name}").into(), kind })
}

/// What Hydra has in the camera's space: no pass, but an AOV of that name.
fn in_camera_space(values: &Values<'_>) -> Option<AovDesc> {
    let source = values.reading.value::<String>(values.prim, "sourceName").unwrap_or_default();
    let given = values.reading.value::<String>(values.prim, AOV_NAME).unwrap_or_default();
    let name = [&*source, &*given, values.path.name()?].into_iter().find(|name| !name.is_empty())?;
    let known = IN_CAMERA_SPACE.iter().find(|known| plain(known) == plain(name))?;
    Some(AovDesc { name: (*known).into(), kind: AovKind::Color })
}

/// Values of RenderVars' `dataType` that are one number.
const NUMBERS: &[&str] = &["bool", "uchar", "int", "uint", "int64", "uint64", "half", "float", "double", "timecode"];

/// The pass that one RenderVar asks for; none, with a warning, for what is not known. What its source does not
/// say its name may: well known names need no source.
fn of_var(values: &Values<'_>) -> Option<String> {
    let text = |name: &str| values.reading.value::<String>(values.prim, name).unwrap_or_default();
    let (source, given) = (text("sourceName"), text(AOV_NAME));
    let kind = values.token("sourceType").unwrap_or_default();
    let name = values.path.name().unwrap_or_default();
    if let Some(own) = [&source, &given].into_iter().find_map(|name| name.strip_prefix("penumbra:")) {
        return Some(own.to_string());
    }
    let is_expression = kind == "lpe" || source.starts_with("lpe:");
    let mut found = match kind.as_str() {
        _ if is_expression => of_expression(&source),
        // Of what shapes carry there is a pass of the first texture coordinates alone; others are AOVs.
        "primvar" => {
            if source == "st" {
                Some("uv")
            } else {
                None
            }
        }
        _ => of_name(&source),
    };
    if found.is_none() && kind != "primvar" {
        found = of_name(&given);
        if found.is_none() && source.is_empty() && given.is_empty() {
            found = of_name(name);
        }
    }
    let known = [&source, &given].into_iter().find(|text| !text.is_empty()).map_or(name, |text| text);
    let Some(found) = found else {
        values
            .warn(format!("there is no pass for \"{known}\": it is left out; penumbra:NAME asks for one by its name"));
        return None;
    };
    Some(found.into())
}

/// Names that renderers give what our passes hold, without case, spaces and underscores.
const NAMES: &[(&[&str], &str)] = &[
    (&["ci", "c", "color", "rgb", "rgba", "beauty", "a", "alpha", "luminance"], "combined"),
    (&["z", "pz", "zdepth", "lineardepth", "cameradepth", "depthlinear", "ray:hitpz"], "depth"),
    (&["p", "pworld", "po", "worldposition", "ray:hitp"], "position"),
    (&["n", "nn", "normals", "worldnormal", "nworld", "ray:hitn"], "normal"),
    (&["st", "primvars:st", "texcoord", "texcoords"], "uv"),
    (&["id", "primid", "objectid"], "object_index"),
    (&["materialid", "matid"], "material_index"),
    (&["albedo", "basecolor"], "denoising_albedo"),
    (&["occlusion", "ambientocclusion"], "ao"),
    (&["shadows"], "shadow"),
    (&["emissive"], "emission"),
    (&["background", "env"], "environment"),
    (&["samplecount", "debugsamplecount"], "sample_count"),
    (&["cryptomatteobject", "cryptoobject", "cryptomatte"], "crypto_object"),
    (&["cryptomattematerial", "cryptomaterial"], "crypto_material"),
    (&["cryptomatteasset", "cryptoasset"], "crypto_asset"),
    // The names that our passes have themselves.
    (&["combined"], "combined"),
    (&["depth"], "depth"),
    (&["position"], "position"),
    (&["normal"], "normal"),
    (&["uv"], "uv"),
    (&["mist"], "mist"),
    (&["vector", "motion", "motionvector", "motionvectors"], "vector"),
    (&["shadowcatcher"], "shadow_catcher"),
    (&["objectindex"], "object_index"),
    (&["materialindex"], "material_index"),
    (&["diffusedirect", "directdiffuse"], "diffuse_direct"),
    (&["diffuseindirect", "indirectdiffuse"], "diffuse_indirect"),
    (&["diffusecolor"], "diffuse_color"),
    (&["glossydirect", "directspecular", "speculardirect"], "glossy_direct"),
    (&["glossyindirect", "indirectspecular", "specularindirect"], "glossy_indirect"),
    (&["glossycolor", "specularcolor"], "glossy_color"),
    (&["transmissiondirect"], "transmission_direct"),
    (&["transmissionindirect"], "transmission_indirect"),
    (&["transmissioncolor"], "transmission_color"),
    (&["diffuselight"], "diffuse_light"),
    (&["diffuselightdirect"], "diffuse_light_direct"),
    (&["diffuselightindirect"], "diffuse_light_indirect"),
    (&["glossylight"], "glossy_light"),
    (&["glossylightdirect"], "glossy_light_direct"),
    (&["glossylightindirect"], "glossy_light_indirect"),
    (&["transmissionlight"], "transmission_light"),
    (&["transmissionlightdirect"], "transmission_light_direct"),
    (&["transmissionlightindirect"], "transmission_light_indirect"),
    (&["emission"], "emission"),
    (&["environment"], "environment"),
    (&["ao"], "ao"),
    (&["shadow"], "shadow"),
    (&["unshadowed", "diffusedirectunshadowed"], "unshadowed"),
    (&["error"], "error"),
    (&["errorao", "errorambientocclusion"], "error_ao"),
    (&["errorshadow"], "error_shadow"),
    (&["errortrust"], "error_trust"),
    (&["denoisingnormal"], "denoising_normal"),
    (&["denoisingalbedo"], "denoising_albedo"),
    (&["denoisingdepth"], "denoising_depth"),
];

fn plain(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, ' ' | '_' | '-')).collect::<String>().to_lowercase()
}

fn of_name(name: &str) -> Option<&'static str> {
    let plain = plain(name);
    NAMES.iter().find(|(names, _)| names.contains(&&*plain)).map(|(_, pass)| *pass)
}

/// The pass of a light path expression in the notation of OSL and RenderMan.
fn of_expression(expression: &str) -> Option<&'static str> {
    let mut plain: String = expression.trim().trim_start_matches("lpe:").split_whitespace().collect();
    if plain.contains("unoccluded") && plain.contains("nothruput") {
        // RenderMan's albedo.
        return Some("denoising_albedo");
    }
    // E: the path ends at a light; D, S and T: scattered diffusely, as in a mirror (sharp or not), through the surface.
    for (from, to) in [
        ("<L.>", "L"),
        ("<RD>", "D"),
        ("<.D>", "D"),
        ("<RS>", "S"),
        ("<.S>", "S"),
        ("<T[DS]>", "T"),
        ("<T[SD]>", "T"),
        ("<TD>", "T"),
        ("<TS>", "T"),
        ("<T.>", "T"),
        ("<RG>", "S"),
        ("<R[GS]>", "S"),
        ("<R[SG]>", "S"),
        ("<T[GS]>", "T"),
        ("<T[SG]>", "T"),
        ("[DGS]", "[DS]"),
        ("[OL]", "[LO]"),
        ("[LO]", "E"),
        ("[SD]", "[DS]"),
        ("[DS]+", ".+"),
        ("[DS]*", ".*"),
    ] {
        plain = plain.replace(from, to);
    }
    if plain.ends_with(['L', 'O']) {
        plain.pop();
        plain.push('E');
    }
    Some(match plain.as_str() {
        "C.*" | "C.*E" => "combined",
        "CE" => "emission",
        "CDE" => "diffuse_light_direct",
        "CD.+E" => "diffuse_light_indirect",
        "CD.*E" => "diffuse_light",
        "CSE" => "glossy_light_direct",
        "CS.+E" => "glossy_light_indirect",
        "CS.*E" => "glossy_light",
        "CTE" => "transmission_light_direct",
        "CT.+E" => "transmission_light_indirect",
        "CT.*E" => "transmission_light",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::super::render::tests::render;
    use super::*;
    use crate::desc::RenderDesc;

    /// The passes of vars, and what was said.
    fn of(vars: &[&str]) -> (String, String) {
        let (desc, said) = stage(vars);
        (desc.passes.join(" "), said)
    }

    fn stage(vars: &[&str]) -> (RenderDesc, String) {
        let names: Vec<String> = (0..vars.len()).map(|i| format!("</V{i}>")).collect();
        let prims: String =
            vars.iter().enumerate().map(|(i, var)| format!("def RenderVar \"V{i}\" {{ {var} }}\n")).collect();
        let prims = format!(
            "def RenderSettings \"S\" {{ rel products = </P> }}
            def RenderProduct \"P\" {{ rel orderedVars = [{}] }}\n{prims}",
            names.join(", ")
        );
        render(r#"renderSettingsPrimPath = "/S""#, &prims)
    }

    fn source(name: &str) -> String {
        format!("uniform string sourceName = \"{name}\"")
    }

    #[test]
    fn names_of_houdini_and_hydra_are_known() {
        for (name, pass) in [
            ("C", "combined"),
            ("color", "combined"),
            ("A", "combined"),
            ("cameraDepth", "depth"),
            ("ray:hitPz", "depth"),
            ("ray:hitN", "normal"),
            ("ray:hitP", "position"),
            ("primvars:st", "uv"),
            ("albedo", "denoising_albedo"),
            ("primId", "object_index"),
        ] {
            assert_eq!(of(&[&source(name)]), (pass.to_string(), String::new()), "{name}");
        }
        // Which face, and which instance of an instancer, no pass tells.
        for name in ["elementId", "instanceId"] {
            let (passes, said) = of(&[&source(name)]);
            assert!(passes.is_empty() && said.contains(&format!("/V0: there is no pass for \"{name}\"")), "{said}");
        }
        let (desc, said) = stage(&[&source("Neye"), "custom string driver:parameters:aov:name = \"Peye\""]);
        assert_eq!((desc.passes.join(" "), &*said), ("aov:Neye aov:Peye".to_string(), ""));
        assert!(desc.aovs.iter().all(|aov| aov.kind == AovKind::Color));
    }

    #[test]
    fn the_name_that_the_driver_writes_helps_out() {
        let name = |text: &str| format!("custom string driver:parameters:aov:name = \"{text}\"");
        assert_eq!(of(&[&name("N")]), ("normal".into(), String::new()));
        // The source comes first.
        assert_eq!(of(&[&format!("{}\n{}", source("Ci"), name("N"))]).0, "combined");
        assert_eq!(of(&[&format!("{}\n{}", source("some:thing"), name("diffuse_color"))]).0, "diffuse_color");
        assert_eq!(of(&[&name("penumbra:shadow")]).0, "shadow");
        let (passes, said) = of(&[&name("wobble")]);
        assert!(passes.is_empty() && said.contains("/V0: there is no pass for \"wobble\""), "{said}");
        let (passes, said) = of(&["uniform token sourceType = \"primvar\""]);
        assert!(passes.is_empty() && said.contains("no pass for \"V0\""), "{said}");
    }

    #[test]
    fn expressions_become_passes() {
        for (expression, expected) in [
            ("C.*[<L.>O]", Some("combined")),
            ("lpe:C[DS]*[LO]", Some("combined")),
            ("C<RD>[<L.>O]", Some("diffuse_light_direct")),
            ("CD[DS]+[LO]", Some("diffuse_light_indirect")),
            ("C<RD>.*[LO]", Some("diffuse_light")),
            ("C<RS>L", Some("glossy_light_direct")),
            ("C<TS>.*[OL]", Some("transmission_light")),
            ("C[<L.>O]", Some("emission")),
            (
                "lpe:nothruput;noinfinitecheck;noclamp;unoccluded;overwrite;C<.S'passthru'>*((U2L)|O)",
                Some("denoising_albedo"),
            ),
            ("C<RD>L", Some("diffuse_light_direct")),
            ("C<R[GS]>[LO]", Some("glossy_light_direct")),
            ("C[DGS]*[LO]", Some("combined")),
            ("C<RD>S+L", None),
        ] {
            assert_eq!(of_expression(expression), expected, "{expression}");
        }
    }

    /// By the type that the var names the AOV is a number or three.
    #[test]
    fn primvars_become_aovs() {
        let var = |kind: &str, data: &str, source: &str| {
            format!(
                "uniform token sourceType = \"{kind}\"\nuniform token dataType = \"{data}\"\n{}",
                self::source(source)
            )
        };
        let vars = [
            var("primvar", "float", "wet"),
            var("raw", "vector3f", "primvars:wind"),
            var("primvar", "int", "primvars:id"),
            var("primvar", "texCoord2f", "st"),
        ];
        let (desc, said) = stage(&vars.each_ref().map(String::as_str));
        assert_eq!(desc.passes.join(" "), "aov:primvars:wet aov:primvars:wind aov:primvars:id uv");
        let kinds: Vec<_> = desc.aovs.iter().map(|aov| (&*aov.name, aov.kind)).collect();
        let (number, color) = (AovKind::Value, AovKind::Color);
        assert_eq!(
            (kinds, &*said),
            (vec![("primvars:wet", number), ("primvars:wind", color), ("primvars:id", number)], "")
        );
        let (_, said) = stage(&[&var("primvar", "color4f", "tint")]);
        assert!(said.contains("/V0: of primvar tint, which is color4f, three numbers are shown"), "{said}");
    }

    #[test]
    fn every_name_is_that_of_a_pass_and_every_pass_has_one() {
        let known = |name: &str| crate::film::PASSES.iter().any(|pass| pass.name == name);
        assert!(NAMES.iter().all(|(_, pass)| known(pass)));
        for pass in crate::film::PASSES.iter().filter(|pass| pass.prefix().is_none()) {
            assert_eq!(of_name(pass.name), Some(pass.name));
            assert_eq!(of_name(pass.layer), Some(pass.name));
        }
    }
}
