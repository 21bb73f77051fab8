//! UsdRender products: the pictures that a stage asks for. Those that show the same are made by one render.

use std::sync::Arc;

use openusd::sdf::Path;
use openusd::usd::Prim;

use super::frame::Said;
use super::values::Values;
use super::vars::Vars;
use crate::desc::{AovDesc, FramingDesc, ProductDesc};
use crate::error::Place;

/// What the products of some settings ask for.
#[derive(Default)]
pub(super) struct Products {
    /// What the first picture shows.
    pub framing: FramingDesc,
    /// The passes of all pictures that show the same, each once.
    pub passes: Vec<Arc<str>>,
    /// Name of the first picture.
    pub name: Option<Arc<str>>,
    /// Where that is said.
    pub place: Place,
    /// Each picture, where there is more than one.
    pub pictures: Vec<ProductDesc>,
    /// Primvars that pictures show, and where that is said.
    pub shown: Vec<(AovDesc, Place)>,
}

/// The pictures of `products`, those of `settings`.
pub(super) fn of(settings: Values<'_>, products: &[(Path, Prim)]) -> Products {
    let mut all = products.iter().map(|(path, prim)| Picture::of(settings, Values { prim, path, ..settings }));
    let Some(first) = all.next() else {
        let framing = Said { settings, product: None }.framing();
        return Products { framing, ..Products::default() };
    };
    let mut pictures = vec![first];
    let mut shown: Vec<(AovDesc, Place)> = Vec::new();
    let mut show = |picture: &mut Picture<'_>| {
        for (aov, place) in picture.shown.drain(..) {
            if !shown.iter().any(|(known, _)| known.name == aov.name) {
                shown.push((aov, place));
            }
        }
    };
    show(&mut pictures[0]);
    for mut picture in all {
        show(&mut picture);
        add_picture(&mut pictures, picture);
    }
    if pictures.len() > 1 && pictures[0].name.is_none() {
        let unnamed = pictures.remove(0);
        let other = pictures[0].differences(&unnamed);
        unnamed.product.warn(format!("is not rendered: it names no picture, and {other}"));
    }
    if pictures.len() > 1 {
        for picture in pictures.iter_mut().filter(|picture| picture.passes.is_empty()) {
            picture.passes.push("combined".into());
        }
    }
    let mut passes = Vec::new();
    let framing = pictures[0].framing.clone();
    let same = pictures.iter().filter(|picture| picture.framing == framing);
    same.flat_map(|picture| &picture.passes).for_each(|pass| add(&mut passes, pass));
    let (name, place) = (pictures[0].name.clone(), pictures[0].place.clone());
    let named = |Picture { name, place, passes, framing, .. }: Picture<'_>| {
        Some(ProductDesc { name: name?, place, passes, framing })
    };
    let several = pictures.len() > 1;
    let pictures = if several { pictures.into_iter().filter_map(named).collect() } else { Vec::new() };
    Products { framing, passes, name, place, pictures, shown }
}

/// Adds `picture`, or its passes to one of `pictures` that shows the same under its name. What names none goes with
/// what does.
fn add_picture<'a>(pictures: &mut Vec<Picture<'a>>, picture: Picture<'a>) {
    let product = picture.product;
    let shows_same = |known: &Picture<'_>| known.framing == picture.framing;
    let Some(name) = picture.name.clone() else {
        match pictures.iter_mut().find(|known| shows_same(known)) {
            Some(known) => {
                let other = &known.product.path;
                product.warn(format!("names no picture of its own: its passes go to that of {other}"));
                picture.passes.iter().for_each(|pass| add(&mut known.passes, pass));
            }
            None => {
                let other = pictures[0].differences(&picture);
                product.warn(format!("is not rendered: it names no picture, and {other}"));
            }
        }
        return;
    };
    if let Some(known) = pictures.iter_mut().find(|known| known.name.as_ref() == Some(&name)) {
        if known.framing == picture.framing {
            picture.passes.iter().for_each(|pass| add(&mut known.passes, pass));
        } else {
            let (path, other) = (known.product.path, known.differences(&picture));
            product.warn(format!("is not rendered: its picture {name} is that of {path}, and {other}"));
        }
        return;
    }
    // What has no name goes with the first that has one.
    if pictures[0].name.is_none() && shows_same(&pictures[0]) {
        let first = &mut pictures[0];
        product.warn(format!("has the passes of {}, which names no picture, in its own", first.product.path));
        picture.passes.iter().for_each(|pass| add(&mut first.passes, pass));
        (first.name, first.place) = (picture.name, picture.place);
        return;
    }
    pictures.push(picture);
}

/// A picture, and the product that asks for it first.
struct Picture<'a> {
    product: Values<'a>,
    name: Option<Arc<str>>,
    /// Where it has that from.
    place: Place,
    passes: Vec<Arc<str>>,
    shown: Vec<(AovDesc, Place)>,
    framing: FramingDesc,
}

impl<'a> Picture<'a> {
    fn of(settings: Values<'a>, product: Values<'a>) -> Self {
        let name = product.token("productName").filter(|name| !name.is_empty()).map(Into::into);
        if product.token("productType").is_some_and(|kind| kind == "deepRaster") {
            product.warn("deep pictures are not written: it becomes a flat one");
        }
        let vars = Vars::of(&product);
        Self {
            product,
            name,
            place: product.reading.place_of(product.path),
            passes: vars.passes,
            shown: vars.shown,
            framing: Said { settings, product: Some(product) }.framing(),
        }
    }

    /// What of `other` is not as here, in words.
    fn differences(&self, other: &Self) -> String {
        let (ours, theirs) = (&self.framing, &other.framing);
        let (off, others_off) = (ours.off, theirs.off);
        let all = [
            ("camera", ours.camera != theirs.camera),
            ("resolution", ours.resolution != theirs.resolution),
            ("pixelAspectRatio", ours.pixel_aspect != theirs.pixel_aspect),
            ("aspectRatioConformPolicy", ours.conform != theirs.conform),
            ("dataWindowNDC", ours.window != theirs.window),
            ("motion blur", off.motion_blur != others_off.motion_blur || off.shutter != others_off.shutter),
            ("depth of field", off.depth_of_field != others_off.depth_of_field),
        ];
        let names: Vec<&str> = all.into_iter().filter(|(_, differs)| *differs).map(|(name, _)| name).collect();
        let are = if names.len() > 1 { "are not those" } else { "is not that" };
        format!("its {} {are} of {}", names.join(", "), self.product.path)
    }
}

/// Adds `pass` unless it is there.
fn add(passes: &mut Vec<Arc<str>>, pass: &Arc<str>) {
    if !passes.contains(pass) {
        passes.push(pass.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::super::render::tests::render;
    use crate::desc::ProductDesc;

    const NAMED: &str = r#"renderSettingsPrimPath = "/S""#;

    fn prims(products: &str) -> String {
        format!(
            r#"def RenderSettings "S" {{
                rel products = [</A>, </B>, </C>]
                rel camera = </Cam>
                uniform int2 resolution = (64, 32)
            }}
            def RenderVar "Ci" {{ uniform string sourceName = "Ci" }}
            def RenderVar "N" {{ uniform string sourceName = "N" }}
            {products}"#
        )
    }

    fn of(products: &str) -> (Vec<(String, String)>, String, String) {
        let (desc, said) = render(NAMED, &prims(products));
        let list = |passes: &[std::sync::Arc<str>]| passes.join(" ");
        let picture = |p: &ProductDesc| (p.name.to_string(), list(&p.passes));
        (desc.products.iter().map(picture).collect(), list(&desc.passes), said)
    }

    #[test]
    fn each_product_has_a_picture_of_its_own() {
        let (pictures, passes, said) = of(r#"def RenderProduct "A" { token productName = "a.exr" }
            def RenderProduct "B" { token productName = "b.exr" rel orderedVars = [</N>, </Ci>] rel camera = </Cam> }
            def RenderProduct "C" { token productName = "b.exr" rel orderedVars = </N> }"#);
        let expected = [("a.exr", "combined"), ("b.exr", "normal combined")];
        assert_eq!(pictures, expected.map(|(a, b)| (a.to_string(), b.to_string())));
        assert_eq!((&*passes, &*said), ("combined normal", ""));
    }

    #[test]
    fn products_that_frame_otherwise_have_pictures_of_their_own() {
        let (desc, said) = render(
            NAMED,
            &prims(
                r#"def RenderProduct "A" { token productName = "a.exr" rel orderedVars = </Ci> }
                def RenderProduct "B" { token productName = "b.exr" rel orderedVars = </N>
                    rel camera = </Other> uniform int2 resolution = (9, 9) }
                def RenderProduct "C" { token productName = "c.exr" uniform bool disableDepthOfField = 1 }"#,
            ),
        );
        assert_eq!((desc.passes.join(" "), &*said), ("combined".to_string(), ""));
        let [a, b, c] = &desc.products[..] else { panic!("{:?}", desc.products) };
        assert_eq!(a.framing, desc.framing);
        assert_eq!((a.framing.camera.as_deref(), a.framing.resolution), (Some("/Cam"), Some([64, 32])));
        assert_eq!((b.framing.camera.as_deref(), b.framing.resolution), (Some("/Other"), Some([9, 9])));
        assert_eq!((b.passes.join(" "), c.passes.join(" ")), ("normal".to_string(), "combined".to_string()));
        assert!(c.framing.off.depth_of_field && !a.framing.off.depth_of_field);
    }

    #[test]
    fn products_that_frame_otherwise_need_a_name_of_their_own() {
        let (pictures, passes, said) =
            of(r#"def RenderProduct "A" { token productName = "a.exr" rel orderedVars = </Ci> }
            def RenderProduct "B" { rel orderedVars = </N> rel camera = </Other> uniform int2 resolution = (9, 9) }
            def RenderProduct "C" { token productName = "a.exr" uniform bool disableDepthOfField = 1 }"#);
        assert_eq!((pictures.len(), &*passes), (0, "combined"));
        let what = "/B: is not rendered: it names no picture, and its camera, resolution are not those of /A";
        assert!(said.contains(what), "{said}");
        let what = "/C: is not rendered: its picture a.exr is that of /A, and its depth of field is not that of /A";
        assert!(said.contains(what), "{said}");
        assert_eq!(said.lines().count(), 2, "{said}");
    }

    #[test]
    fn what_names_no_picture_goes_with_what_does() {
        let (desc, said) = render(
            NAMED,
            &prims(
                r#"def RenderProduct "A" { rel orderedVars = </N> }
                def RenderProduct "B" { token productName = "b.exr" rel orderedVars = </Ci> }
                def RenderProduct "C" { rel orderedVars = </N> }"#,
            ),
        );
        assert_eq!((desc.product.as_deref(), desc.products.len()), (Some("b.exr"), 0));
        assert_eq!(desc.passes.join(" "), "normal combined");
        assert!(said.contains("/B: has the passes of /A") && said.contains("/C: names no picture"), "{said}");
    }
}
