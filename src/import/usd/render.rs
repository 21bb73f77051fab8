//! UsdRender settings to `RenderDesc`: what the settings that the stage names say, with what their first
//! product says instead, and the passes of all products.

use openusd::sdf::{self, Value};
use openusd::tf::Token;
use openusd::usd::Prim;

use super::frame::{Off, Said};
use super::stage::Reading;
use super::values::Values;
use crate::desc::RenderDesc;
use crate::import::Purpose;

/// What the stage says of its own render.
pub(super) fn read(reading: &Reading<'_>) -> RenderDesc {
    let Some((path, settings)) = settings(reading) else { return RenderDesc::default() };
    let values = Values { reading, prim: &settings, path: &path };
    let products: Vec<(sdf::Path, Prim)> = values
        .targets("products")
        .into_iter()
        .filter_map(|path| {
            let found = reading.stage.prim(path.clone()).ok().filter(|prim| is_a(prim, "RenderProduct"));
            if found.is_none() {
                values.warn(format!("product {path} is no RenderProduct: it is left out"));
            }
            Some((path, found?))
        })
        .collect();
    let product = products.first().map(|(path, prim)| Values { reading, prim, path });
    for (path, prim) in products.iter().skip(1) {
        tell_of_product(&Values { reading, prim, path }, products[0].0.as_str());
    }
    let said = Said { settings: values, product };
    if let Some(purposes) = tokens(&values, "includedPurposes") {
        if !purposes.iter().any(|purpose| purpose == "default") && reading.options.purposes.is_none() {
            values.warn("includedPurposes leaves out default: what has no other purpose is shown all the same");
        }
        for other in purposes.iter().filter(|purpose| *purpose != "default" && shown(purpose).is_none()) {
            values.warn(format!("includedPurposes names \"{other}\", which is no purpose: it is ignored"));
        }
    }
    if product.and_then(|product| product.token("productType")).is_some_and(|kind| kind == "deepRaster") {
        said.of("productType").warn("deep pictures are not written: it becomes a flat one");
    }
    let camera = |values: &Values<'_>| values.targets("camera").first().map(|path| path.as_str().into());
    let name = product.and_then(|product| product.token("productName")).filter(|name| !name.is_empty());
    RenderDesc {
        camera: product.as_ref().and_then(camera).or_else(|| camera(&values)),
        resolution: resolution(&said.of("resolution")),
        pixel_aspect: said.pixel_aspect(),
        conform: said.conform(),
        window: said.window(),
        passes: passes(reading, &products),
        product: name.map(Into::into),
        ..RenderDesc::default()
    }
}

/// What the settings, or their first product, turn off.
pub(super) fn off(reading: &Reading<'_>) -> Off {
    let Some((path, settings)) = settings(reading) else { return Off::default() };
    let values = Values { reading, prim: &settings, path: &path };
    let found = values.targets("products").into_iter().find_map(|path| {
        let prim = reading.stage.prim(path.clone()).ok().filter(|prim| is_a(prim, "RenderProduct"))?;
        Some((path, prim))
    });
    let product = found.as_ref().map(|(path, prim)| Values { reading, prim, path });
    Said { settings: values, product }.off()
}

/// Tells what of a further product is not rendered.
fn tell_of_product(values: &Values<'_>, first: &str) {
    let framing = ["resolution", "pixelAspectRatio", "aspectRatioConformPolicy", "dataWindowNDC"];
    let mut others: Vec<&str> = framing.into_iter().filter(|name| is_authored(values.prim, name)).collect();
    if !values.targets("camera").is_empty() {
        others.insert(0, "camera");
    }
    let mut what = format!("is not a picture of its own: its passes go to that of {first}");
    if !others.is_empty() {
        what += &format!(", whatever its {} say", others.join(", "));
    }
    values.warn(what);
}

/// What the settings say of purposes, or their fallbacks.
pub(super) struct Purposes {
    /// What is shown beside `default`.
    pub shown: Vec<Purpose>,
    /// Of material bindings, the strongest first.
    pub bindings: Vec<Token>,
}

impl Purposes {
    /// Those of the stage's own settings.
    pub fn of(reading: &Reading<'_>) -> Self {
        let settings = settings(reading);
        let values = settings.as_ref().map(|(path, prim)| Values { reading, prim, path });
        let authored = |name: &str| values.as_ref().and_then(|values| tokens(values, name));
        let included = authored("includedPurposes");
        Self {
            shown: included.map_or_else(|| vec![Purpose::Render], |names| names.iter().filter_map(shown).collect()),
            bindings: authored("materialBindingPurposes").unwrap_or_else(|| vec!["full".into(), "".into()]),
        }
    }
}

fn shown(name: &Token) -> Option<Purpose> {
    match name.as_str() {
        "render" => Some(Purpose::Render),
        "proxy" => Some(Purpose::Proxy),
        "guide" => Some(Purpose::Guide),
        _ => None,
    }
}

/// The tokens that are authored.
fn tokens(values: &Values<'_>, name: &str) -> Option<Vec<Token>> {
    is_authored(values.prim, name).then(|| values.reading.value(values.prim, name)).flatten()
}

/// The RenderSettings that the stage's metadata name.
fn settings(reading: &Reading<'_>) -> Option<(sdf::Path, Prim)> {
    let path = match reading.stage.stage_metadata("renderSettingsPrimPath").ok()?? {
        Value::String(path) => path,
        Value::Token(path) => path.to_string(),
        _ => return None,
    };
    if path.is_empty() {
        return None;
    }
    let found = sdf::Path::new(&path).ok().and_then(|path| Some((path.clone(), reading.stage.prim(path).ok()?)));
    let found = found.filter(|(_, prim)| is_a(prim, "RenderSettings"));
    if found.is_none() {
        let what = format!("renderSettingsPrimPath names \"{path}\", which is no RenderSettings: it is ignored");
        reading.warnings.borrow_mut().push(&reading.place, what);
    }
    found
}

fn is_a(prim: &Prim, schema: &str) -> bool {
    prim.is_a(schema).unwrap_or(false)
}

pub(super) fn is_authored(prim: &Prim, name: &str) -> bool {
    prim.attribute(name).has_authored_value().unwrap_or(false)
}

fn resolution(values: &Values<'_>) -> Option<[u32; 2]> {
    let [width, height] =
        values.reading.value::<openusd::gf::Vec2i>(values.prim, "resolution").map(<[i32; 2]>::from)?;
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(width), Ok(height)) if width > 0 && height > 0 => Some([width, height]),
        _ => {
            values.warn(format!("a resolution of {width} by {height} is no picture: it is ignored"));
            None
        }
    }
}

/// Names of the passes that the vars of `products` ask for, each once.
fn passes(reading: &Reading<'_>, products: &[(sdf::Path, Prim)]) -> Vec<std::sync::Arc<str>> {
    let mut passes: Vec<std::sync::Arc<str>> = Vec::new();
    for (path, prim) in products {
        for path in (Values { reading, prim, path }).targets("orderedVars") {
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
    }
    passes
}

/// The passes that one RenderVar asks for; none, with a warning, for what is not known.
fn of_var(values: &Values<'_>) -> Vec<String> {
    let source = values.reading.value::<String>(values.prim, "sourceName").unwrap_or_default();
    let kind = values.token("sourceType").unwrap_or_default();
    let name = values.path.name().unwrap_or_default();
    if let Some(own) = source.strip_prefix("penumbra:") {
        return vec![own.to_string()];
    }
    let is_expression = kind == "lpe" || source.starts_with("lpe:");
    let of_source = if is_expression { of_expression(&source) } else { of_name(&source) };
    // Well known names need no source.
    let found = if of_source.is_empty() && source.is_empty() { of_name(name) } else { of_source };
    if found.is_empty() {
        let what = if source.is_empty() { name } else { &source };
        values.warn(format!("there is no pass for \"{what}\": it is left out; penumbra:NAME asks for one by its name"));
    }
    if is_expression && found.iter().any(|pass| pass.ends_with("direct")) {
        values.warn(format!("rendered as {}, which is divided by the color of the surface", found.join(", ")));
    }
    found.into_iter().map(Into::into).collect()
}

/// Names that renderers give what our passes hold, without case, spaces and underscores.
const NAMES: &[(&[&str], &str)] = &[
    (&["ci", "c", "color", "rgb", "rgba", "beauty", "a", "alpha", "luminance"], "combined"),
    (&["z", "zdepth", "lineardepth", "cameradepth", "depthlinear"], "depth"),
    (&["p", "pworld", "po", "worldposition"], "position"),
    (&["n", "nn", "normals", "neye", "worldnormal", "nworld"], "normal"),
    (&["st", "texcoord", "texcoords"], "uv"),
    (&["id", "primid", "objectid", "elementid"], "object_index"),
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

fn of_name(name: &str) -> Vec<&'static str> {
    let plain: String = name.chars().filter(|c| !matches!(c, ' ' | '_' | '-')).collect::<String>().to_lowercase();
    NAMES.iter().find(|(names, _)| names.contains(&&*plain)).map(|(_, pass)| *pass).into_iter().collect()
}

/// Passes of light path expressions in the notation of OSL and RenderMan.
fn of_expression(expression: &str) -> Vec<&'static str> {
    let mut plain: String = expression.trim().trim_start_matches("lpe:").split_whitespace().collect();
    if plain.contains("unoccluded") && plain.contains("nothruput") {
        // RenderMan's albedo.
        return vec!["denoising_albedo"];
    }
    // E: the path ends at a light; D, S and T: scattered diffusely, as in a mirror, through the surface.
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
pub(super) mod tests {
    use super::super::light::testing::Stage;
    use super::*;

    pub fn render(metadata: &str, prims: &str) -> (RenderDesc, String) {
        let stage = Stage::new(metadata, &format!("def Xform \"Any\" {{}}\n{prims}"));
        let desc = stage.with("/Any", |reading, _| read(reading));
        (desc, stage.said())
    }

    const SETTINGS: &str = r#"def Scope "Render" {
        def RenderSettings "Main" {
            rel camera = </World/Cam>
            rel products = [</Render/Beauty>, </Render/Data>, </Any>]
            uniform int2 resolution = (640, 360)
            uniform float pixelAspectRatio = 2
        }
        def RenderProduct "Beauty" {
            token productName = "out/beauty.exr"
            rel orderedVars = [</Render/Vars/Ci>, </Render/Vars/Diffuse>, </Render/Vars/z>, </Render/Vars/Key>]
            uniform int2 resolution = (320, 180)
        }
        def RenderProduct "Data" {
            rel orderedVars = [</Render/Vars/Ci>, </Render/Vars/N>, </Render/Vars/Odd>, </Render/Vars>]
        }
        def Scope "Vars" {
            def RenderVar "Ci" { uniform string sourceName = "Ci" }
            def RenderVar "z" {}
            def RenderVar "N" { uniform string sourceName = "Nn"; uniform token sourceType = "intrinsic" }
            def RenderVar "Diffuse" { uniform string sourceName = "C<RD>[<L.>O]"; uniform token sourceType = "lpe" }
            def RenderVar "Key" { uniform string sourceName = "penumbra:shadow_key" }
            def RenderVar "Odd" { uniform string sourceName = "wobble" }
        }
    }"#;

    #[test]
    fn settings_products_and_vars_are_read() {
        let (desc, said) = render(r#"renderSettingsPrimPath = "/Render/Main""#, SETTINGS);
        assert_eq!(desc.camera.as_deref(), Some("/World/Cam"));
        assert_eq!((desc.resolution, desc.pixel_aspect), (Some([320, 180]), 2.0));
        assert_eq!(desc.product.as_deref(), Some("out/beauty.exr"));
        let passes: Vec<&str> = desc.passes.iter().map(|pass| &**pass).collect();
        assert_eq!(passes, ["combined", "diffuse_direct", "depth", "shadow_key", "normal"]);
        for what in [
            "/Render/Main: product /Any is no RenderProduct",
            "/Render/Data: is not a picture of its own: its passes go to that of /Render/Beauty",
            "/Render/Vars/Diffuse: rendered as diffuse_direct",
            "/Render/Vars/Odd: there is no pass for \"wobble\"",
            "/Render/Vars: no RenderVar",
        ] {
            assert!(said.contains(what), "{what} is not in\n{said}");
        }
    }

    #[test]
    fn settings_that_the_stage_does_not_name_say_nothing() {
        assert_eq!(render("", SETTINGS), (RenderDesc::default(), String::new()));
        let (desc, said) = render(r#"renderSettingsPrimPath = "/Any""#, SETTINGS);
        assert_eq!(desc, RenderDesc::default());
        assert!(said.contains("no RenderSettings"), "{said}");
    }

    /// The schema's fallback, as usd-core has it.
    #[test]
    fn a_resolution_that_is_not_authored_is_the_fallback() {
        let (desc, said) = render(r#"renderSettingsPrimPath = "/S""#, "def RenderSettings \"S\" {}");
        assert_eq!((desc.resolution, said.as_str()), (Some([2048, 1080]), ""));
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
