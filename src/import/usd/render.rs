//! UsdRender settings to `RenderDesc`: what the settings that the stage names say, with what their first
//! product says instead.

use openusd::sdf::{self, Value};
use openusd::tf::Token;
use openusd::usd::Prim;

use super::frame::Said;
use super::products::{self, Products};
use super::stage::Reading;
use super::values::Values;
use crate::desc::RenderDesc;
use crate::error::Place;
use crate::import::Purpose;

/// What the stage says of its own render, and where it asks for each of the AOVs.
pub(super) fn read(reading: &Reading<'_>) -> (RenderDesc, Vec<Place>) {
    let Some((path, settings)) = settings(reading) else { return Default::default() };
    let values = Values { reading, prim: &settings, path: &path };
    let products = products(&values, |path| {
        values.warn(format!("product {path} is no RenderProduct: it is left out"));
    });
    let Products { passes, framing, name, place, pictures, shown } = products::of(values, &products);
    if let Some(purposes) = tokens(&values, "includedPurposes") {
        if !purposes.iter().any(|purpose| purpose == "default") && reading.options.purposes.is_none() {
            values.warn("includedPurposes leaves out default: what has no other purpose is shown all the same");
        }
        for other in purposes.iter().filter(|purpose| *purpose != "default" && purpose_named(purpose).is_none()) {
            values.warn(format!("includedPurposes names \"{other}\", which is no purpose: it is ignored"));
        }
    }
    // Names of one space, before and since OpenUSD 25.05.
    let own = ["", "lin_rec709", "lin_rec709_scene"];
    if let Some(space) = values.token("renderingColorSpace").filter(|space| !own.contains(&space.as_str())) {
        values.warn(format!("renderingColorSpace is \"{space}\"; it is rendered in lin_rec709 all the same"));
    }
    let (aovs, places) = shown.into_iter().unzip();
    let desc = RenderDesc {
        framing,
        passes,
        aovs,
        product: name,
        product_place: place,
        products: pictures,
        ..RenderDesc::default()
    };
    (desc, places)
}

/// The products of `settings`; what is named and is none is handed to `lost`.
fn products(settings: &Values<'_>, lost: impl Fn(&sdf::Path)) -> Vec<(sdf::Path, Prim)> {
    let stage = &settings.reading.stage;
    let found = settings.targets("products").into_iter().filter_map(|path| {
        let found = stage.prim(path.clone()).ok().filter(|prim| is_a(prim, "RenderProduct"));
        if found.is_none() {
            lost(&path);
        }
        Some((path, found?))
    });
    found.collect()
}

/// True where no picture shows that anything moves.
pub(super) fn stands_still(reading: &Reading<'_>) -> bool {
    let Some((path, settings)) = settings(reading) else { return false };
    let values = Values { reading, prim: &settings, path: &path };
    let products = products(&values, |_| ());
    let of = |product| Said { settings: values, product }.off().stands_still();
    if products.is_empty() {
        return of(None);
    }
    products.iter().all(|(path, prim)| of(Some(Values { reading, prim, path })))
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
            shown: included
                .map_or_else(|| vec![Purpose::Render], |names| names.iter().filter_map(purpose_named).collect()),
            bindings: authored("materialBindingPurposes").unwrap_or_else(|| vec!["full".into(), "".into()]),
        }
    }
}

fn purpose_named(name: &Token) -> Option<Purpose> {
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

/// Takes note of the RenderSettings at `path` where the stage names none: as in OpenUSD they are then not those of the
/// stage, however many there are.
pub(super) fn tell_of_unnamed(reading: &Reading<'_>, path: &sdf::Path) {
    let named = reading.stage.stage_metadata("renderSettingsPrimPath").ok().flatten();
    let is_empty = |value: &Value| match value {
        Value::String(path) => path.is_empty(),
        Value::Token(path) => path.as_str().is_empty(),
        _ => true,
    };
    if named.as_ref().is_none_or(is_empty) {
        let what = "are no settings of the stage, whose renderSettingsPrimPath names none: they are not used";
        reading.warnings.borrow_mut().note(&reading.place_of(path), what);
    }
}

pub(super) fn is_a(prim: &Prim, schema: &str) -> bool {
    prim.is_a(schema).unwrap_or(false)
}

pub(super) fn is_authored(prim: &Prim, name: &str) -> bool {
    prim.attribute(name).has_authored_value().unwrap_or(false)
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::light::testing::Stage;
    use super::*;

    pub fn render(metadata: &str, prims: &str) -> (RenderDesc, String) {
        let stage = Stage::new(metadata, &format!("def Xform \"Any\" {{}}\n{prims}"));
        let (desc, _) = stage.with("/Any", |reading, _| read(reading));
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
            rel orderedVars = [</Render/Vars/Ci>, </Render/Vars/Diffuse>, </Render/Vars/z>, </Render/Vars/Key>,
                </Render/Vars/Odd>, </Render/Vars>]
            uniform int2 resolution = (320, 180)
        }
        def RenderProduct "Data" {
            rel orderedVars = [</Render/Vars/Ci>, </Render/Vars/N>]
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
        assert_eq!(desc.framing.camera.as_deref(), Some("/World/Cam"));
        assert_eq!((desc.framing.resolution, desc.framing.pixel_aspect), (Some([320, 180]), 2.0));
        assert_eq!(desc.product.as_deref(), Some("out/beauty.exr"));
        let passes: Vec<&str> = desc.passes.iter().map(|pass| &**pass).collect();
        assert_eq!(passes, ["combined", "diffuse_light_direct", "depth", "shadow_key"]);
        for what in [
            "/Render/Main: product /Any is no RenderProduct",
            "/Render/Data: is not rendered: it names no picture, and its resolution is not that of /Render/Beauty",
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
        assert_eq!((desc.framing.resolution, said.as_str()), (Some([2048, 1080]), ""));
    }
}
