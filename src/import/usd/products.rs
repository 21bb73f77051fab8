//! UsdRender products: one render gives the picture of each that frames the scene as the first one does.

use std::sync::Arc;

use openusd::sdf::Path;
use openusd::usd::Prim;

use super::frame::{Off, Said};
use super::render::resolution;
use super::values::Values;
use super::vars;
use crate::desc::{Conform, ProductDesc};
use crate::error::Place;

/// What the products of some settings ask for.
#[derive(Default)]
pub(super) struct Products {
    /// The passes of all pictures, each once.
    pub passes: Vec<Arc<str>>,
    /// Name of the first picture.
    pub name: Option<Arc<str>>,
    /// Where that is said.
    pub place: Place,
    /// Each picture, where there is more than one.
    pub pictures: Vec<ProductDesc>,
}

/// The pictures of `products`, those of `settings`.
pub(super) fn of(settings: Values<'_>, products: &[(Path, Prim)]) -> Products {
    let mut all = products.iter().map(|(path, prim)| Values { prim, path, ..settings });
    let Some(first) = all.next() else { return Products::default() };
    let frame = Frame::of(settings, first);
    let mut pictures = vec![Picture::of(first)];
    for product in all {
        let others = frame.differences(&Frame::of(settings, product));
        if !others.is_empty() {
            let (what, are) = (others.join(", "), if others.len() > 1 { "are not those" } else { "is not that" });
            product.warn(format!("is not rendered: its {what} {are} of {}", first.path));
            continue;
        }
        let picture = Picture::of(product);
        if picture.name.is_none() {
            product.warn(format!("names no picture of its own: its passes go to that of {}", pictures[0].product.path));
        }
        match pictures.iter().position(|known| known.name == picture.name || picture.name.is_none()) {
            Some(known) => picture.passes.iter().for_each(|pass| add(&mut pictures[known].passes, pass)),
            // What has no name goes with the first that has one.
            None if pictures[0].name.is_none() => {
                product.warn(format!("has the passes of {}, which names no picture, in its own", first.path));
                picture.passes.iter().for_each(|pass| add(&mut pictures[0].passes, pass));
                (pictures[0].name, pictures[0].place) = (picture.name, picture.place);
            }
            None => pictures.push(picture),
        }
    }
    let mut passes = Vec::new();
    let several = pictures.len() > 1;
    for picture in &mut pictures {
        if several && picture.passes.is_empty() {
            picture.passes.push("combined".into());
        }
        picture.passes.iter().for_each(|pass| add(&mut passes, pass));
    }
    let (name, place) = (pictures[0].name.clone(), pictures[0].place.clone());
    let named = |Picture { name, place, passes, .. }: Picture<'_>| Some(ProductDesc { name: name?, place, passes });
    let pictures = if several { pictures.into_iter().filter_map(named).collect() } else { Vec::new() };
    Products { passes, name, place, pictures }
}

/// A picture, and the product that asks for it first.
struct Picture<'a> {
    product: Values<'a>,
    name: Option<Arc<str>>,
    /// Where it has that from.
    place: Place,
    passes: Vec<Arc<str>>,
}

impl<'a> Picture<'a> {
    fn of(product: Values<'a>) -> Self {
        let name = product.token("productName").filter(|name| !name.is_empty()).map(Into::into);
        if product.token("productType").is_some_and(|kind| kind == "deepRaster") {
            product.warn("deep pictures are not written: it becomes a flat one");
        }
        Self { product, name, place: product.reading.place_of(product.path), passes: vars::passes(&product) }
    }
}

/// Adds `pass` unless it is there.
fn add(passes: &mut Vec<Arc<str>>, pass: &Arc<str>) {
    if !passes.contains(pass) {
        passes.push(pass.clone());
    }
}

/// How a product frames the scene.
struct Frame {
    camera: Option<Path>,
    resolution: Option<[u32; 2]>,
    pixel_aspect: f64,
    conform: Conform,
    window: Option<[f64; 4]>,
    off: Off,
}

impl Frame {
    fn of(settings: Values<'_>, product: Values<'_>) -> Self {
        let said = Said { settings, product: Some(product) };
        Self {
            camera: said.camera(),
            resolution: resolution(&said.of("resolution")),
            pixel_aspect: said.pixel_aspect(),
            conform: said.conform(),
            window: said.window(),
            off: said.off(),
        }
    }

    /// What of `other` is not the same.
    fn differences(&self, other: &Self) -> Vec<&'static str> {
        let all = [
            ("camera", self.camera != other.camera),
            ("resolution", self.resolution != other.resolution),
            ("pixelAspectRatio", self.pixel_aspect != other.pixel_aspect),
            ("aspectRatioConformPolicy", self.conform != other.conform),
            ("dataWindowNDC", self.window != other.window),
            ("motion blur", self.off.motion_blur != other.off.motion_blur || self.off.shutter != other.off.shutter),
            ("depth of field", self.off.depth_of_field != other.off.depth_of_field),
        ];
        all.into_iter().filter(|(_, differs)| *differs).map(|(name, _)| name).collect()
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
    fn products_that_frame_otherwise_are_told_and_left_out() {
        let (pictures, passes, said) =
            of(r#"def RenderProduct "A" { token productName = "a.exr" rel orderedVars = </Ci> }
            def RenderProduct "B" { rel orderedVars = </N> rel camera = </Other> uniform int2 resolution = (9, 9) }
            def RenderProduct "C" { token productName = "c.exr" uniform bool disableDepthOfField = 1 }"#);
        assert_eq!((pictures.len(), &*passes), (0, "combined"));
        assert!(said.contains("/B: is not rendered: its camera, resolution are not those of /A"), "{said}");
        assert!(said.contains("/C: is not rendered: its depth of field is not that of /A"), "{said}");
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
