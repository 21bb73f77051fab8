//! UsdRender vars to passes.

use std::sync::Arc;

use super::render::is_a;
use super::values::Values;

/// Where Houdini, and what reads its stages, keep the name under which a var is written.
const AOV_NAME: &str = "driver:parameters:aov:name";

/// Names of the passes that the vars of `product` ask for, each once.
pub(super) fn passes(product: &Values<'_>) -> Vec<Arc<str>> {
    let reading = product.reading;
    let mut passes: Vec<Arc<str>> = Vec::new();
    for path in product.targets("orderedVars") {
        let Some(var) = reading.stage.prim(path.clone()).ok().filter(|prim| is_a(prim, "RenderVar")) else {
            reading.warn(&path, "no RenderVar: it is left out");
            continue;
        };
        for pass in of_var(&Values { reading, prim: &var, path: &path }) {
            if !passes.iter().any(|known| **known == *pass) {
                passes.push(pass.into());
            }
        }
    }
    passes
}

/// The passes that one RenderVar asks for; none, with a warning, for what is not known. What its source does not
/// say its name may: well known names need no source.
fn of_var(values: &Values<'_>) -> Vec<String> {
    let text = |name: &str| values.reading.value::<String>(values.prim, name).unwrap_or_default();
    let (source, given) = (text("sourceName"), text(AOV_NAME));
    let kind = values.token("sourceType").unwrap_or_default();
    let name = values.path.name().unwrap_or_default();
    if let Some(own) = [&source, &given].into_iter().find_map(|name| name.strip_prefix("penumbra:")) {
        return vec![own.to_string()];
    }
    let is_expression = kind == "lpe" || source.starts_with("lpe:");
    let mut found = match kind.as_str() {
        _ if is_expression => of_expression(&source),
        "primvar" => of_primvar(&source),
        _ => of_name(&source),
    };
    let by_source = !found.is_empty();
    if !by_source && kind != "primvar" {
        found = of_name(&given);
        if found.is_empty() && source.is_empty() && given.is_empty() {
            found = of_name(name);
        }
    }
    let known = [&source, &given].into_iter().find(|text| !text.is_empty()).map_or(name, |text| text);
    if found.is_empty() {
        values
            .warn(format!("there is no pass for \"{known}\": it is left out; penumbra:NAME asks for one by its name"));
    }
    if let Some((_, space)) = IN_OTHER_SPACES.iter().find(|(names, _)| names.contains(&&*plain(known))) {
        values.warn(format!("\"{known}\" is {space}: rendered as {}, in world space", found.join(", ")));
    }
    if is_expression && by_source && found.iter().any(|pass| pass.ends_with("direct")) {
        values.warn(format!("rendered as {}, which is divided by the color of the surface", found.join(", ")));
    }
    found.into_iter().map(Into::into).collect()
}

/// What Hydra has in the camera's space, and our passes in that of the world.
const IN_OTHER_SPACES: &[(&[&str], &str)] = &[(&["neye", "peye"], "in the camera's space")];

/// Names that renderers give what our passes hold, without case, spaces and underscores.
const NAMES: &[(&[&str], &str)] = &[
    (&["ci", "c", "color", "rgb", "rgba", "beauty", "a", "alpha", "luminance"], "combined"),
    (&["z", "pz", "zdepth", "lineardepth", "cameradepth", "depthlinear", "ray:hitpz"], "depth"),
    (&["p", "pworld", "po", "peye", "worldposition", "ray:hitp"], "position"),
    (&["n", "nn", "normals", "neye", "worldnormal", "nworld", "ray:hitn"], "normal"),
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

fn of_name(name: &str) -> Vec<&'static str> {
    let plain = plain(name);
    NAMES.iter().find(|(names, _)| names.contains(&&*plain)).map(|(_, pass)| *pass).into_iter().collect()
}

/// Of what shapes carry there is a pass of the first texture coordinates alone.
fn of_primvar(name: &str) -> Vec<&'static str> {
    if name.strip_prefix("primvars:").unwrap_or(name) == "st" { vec!["uv"] } else { Vec::new() }
}

/// Passes of light path expressions in the notation of OSL and RenderMan.
fn of_expression(expression: &str) -> Vec<&'static str> {
    let mut plain: String = expression.trim().trim_start_matches("lpe:").split_whitespace().collect();
    if plain.contains("unoccluded") && plain.contains("nothruput") {
        // RenderMan's albedo.
        return vec!["denoising_albedo"];
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
    match plain.as_str() {
        "C.*" | "C.*E" => vec!["combined"],
        "CE" => vec!["emission"],
        "CDE" => vec!["diffuse_direct"],
        "CD.+E" => vec!["diffuse_indirect"],
        "CD.*E" => vec!["diffuse_direct", "diffuse_indirect", "diffuse_color"],
        "CSE" => vec!["glossy_direct"],
        "CS.+E" => vec!["glossy_indirect"],
        "CS.*E" => vec!["glossy_direct", "glossy_indirect", "glossy_color"],
        "CTE" => vec!["transmission_direct"],
        "CT.+E" => vec!["transmission_indirect"],
        "CT.*E" => vec!["transmission_direct", "transmission_indirect", "transmission_color"],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::render::tests::render;
    use super::*;

    /// The passes of vars, and what was said.
    fn of(vars: &[&str]) -> (String, String) {
        let names: Vec<String> = (0..vars.len()).map(|i| format!("</V{i}>")).collect();
        let prims: String =
            vars.iter().enumerate().map(|(i, var)| format!("def RenderVar \"V{i}\" {{ {var} }}\n")).collect();
        let prims = format!(
            "def RenderSettings \"S\" {{ rel products = </P> }}
            def RenderProduct \"P\" {{ rel orderedVars = [{}] }}\n{prims}",
            names.join(", ")
        );
        let (desc, said) = render(r#"renderSettingsPrimPath = "/S""#, &prims);
        (desc.passes.join(" "), said)
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
        let (passes, said) = of(&[&source("Neye"), &source("Peye")]);
        assert_eq!((&*passes, said.lines().count()), ("normal position", 2));
        assert!(
            said.contains("/V1: \"Peye\" is in the camera's space: rendered as position, in world space"),
            "{said}"
        );
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
        let (passes, said) = of(&["uniform token sourceType = \"primvar\"\nuniform string sourceName = \"color\""]);
        assert!(passes.is_empty() && said.contains("no pass for \"color\""), "{said}");
    }

    #[test]
    fn expressions_become_passes() {
        for (expression, expected) in [
            ("C.*[<L.>O]", vec!["combined"]),
            ("lpe:C[DS]*[LO]", vec!["combined"]),
            ("C<RD>[<L.>O]", vec!["diffuse_direct"]),
            ("CD[DS]+[LO]", vec!["diffuse_indirect"]),
            ("C<RS>L", vec!["glossy_direct"]),
            ("C<TS>.*[OL]", vec!["transmission_direct", "transmission_indirect", "transmission_color"]),
            ("C[<L.>O]", vec!["emission"]),
            (
                "lpe:nothruput;noinfinitecheck;noclamp;unoccluded;overwrite;C<.S'passthru'>*((U2L)|O)",
                vec!["denoising_albedo"],
            ),
            ("C<RD>L", vec!["diffuse_direct"]),
            ("C<R[GS]>[LO]", vec!["glossy_direct"]),
            ("C[DGS]*[LO]", vec!["combined"]),
            ("C<RD>S+L", vec![]),
        ] {
            assert_eq!(of_expression(expression), expected, "{expression}");
        }
    }

    #[test]
    fn every_name_is_that_of_a_pass_and_every_pass_has_one() {
        let known = |name: &str| crate::film::PASSES.iter().any(|pass| pass.name == name);
        assert!(NAMES.iter().all(|(_, pass)| known(pass)));
        for pass in crate::film::PASSES.iter().filter(|pass| pass.prefix().is_none()) {
            assert_eq!(of_name(pass.name), [pass.name]);
            assert_eq!(of_name(pass.layer), [pass.name]);
        }
    }
}
