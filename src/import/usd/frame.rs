//! How the settings of a render frame the picture, and what of the camera they turn off. What a product
//! authors goes before what its settings say.

use openusd::sdf::Path;

use super::render::is_authored;
use super::values::Values;
use crate::desc::{Conform, EffectsOff, FramingDesc};

/// Settings, and the product that is rendered.
#[derive(Clone, Copy)]
pub(super) struct Said<'a> {
    pub settings: Values<'a>,
    pub product: Option<Values<'a>>,
}

impl<'a> Said<'a> {
    /// All that is said of what the picture shows.
    pub fn framing(&self) -> FramingDesc {
        FramingDesc {
            camera: self.camera().map(|path| path.as_str().into()),
            resolution: self.resolution(),
            pixel_aspect: self.pixel_aspect(),
            conform: self.conform(),
            window: self.window(),
            off: self.off(),
        }
    }

    /// Whose `name` counts.
    fn of(&self, name: &str) -> Values<'a> {
        self.product.filter(|product| is_authored(product.prim, name)).unwrap_or(self.settings)
    }

    /// The first camera that is named.
    fn camera(&self) -> Option<Path> {
        let of = |values: Values<'_>| values.targets("camera").into_iter().next();
        self.product.and_then(of).or_else(|| of(self.settings))
    }

    /// Width and height in pixels.
    fn resolution(&self) -> Option<[u32; 2]> {
        let values = self.of("resolution");
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

    /// Width of a pixel over its height.
    fn pixel_aspect(&self) -> f64 {
        let values = self.of("pixelAspectRatio");
        let aspect = values.number("pixelAspectRatio").unwrap_or(1.0);
        if aspect > 0.0 {
            return aspect;
        }
        values.warn(format!("a pixelAspectRatio of {aspect} is no shape: pixels are square"));
        1.0
    }

    fn conform(&self) -> Conform {
        let values = self.of("aspectRatioConformPolicy");
        match values.token("aspectRatioConformPolicy").as_deref() {
            None | Some("expandAperture") => Conform::Expand,
            Some("cropAperture") => Conform::Crop,
            Some("adjustApertureWidth") => Conform::Width,
            Some("adjustApertureHeight") => Conform::Height,
            Some("adjustPixelAspectRatio") => Conform::Pixels,
            Some(other) => {
                values.warn(format!("there is no aspectRatioConformPolicy \"{other}\": the aperture is expanded"));
                Conform::Expand
            }
        }
    }

    /// The part of the picture that is wanted, from the upper left corner; `None` for all of it.
    fn window(&self) -> Option<[f64; 4]> {
        let values = self.of("dataWindowNDC");
        let window = values.reading.value::<[f32; 4]>(values.prim, "dataWindowNDC")?.map(f64::from);
        let [left, lower, right, upper] = window;
        if window.iter().any(|x| !x.is_finite()) || left >= right || lower >= upper {
            let what = format!(
                "dataWindowNDC ({left}, {lower}, {right}, {upper}) shows nothing of the picture: all is rendered"
            );
            values.warn(what);
            return None;
        }
        (window != [0.0, 0.0, 1.0, 1.0]).then_some([left, 1.0 - upper, right, 1.0 - lower])
    }

    /// What is off.
    pub fn off(&self) -> EffectsOff {
        let flag = |name: &str| self.of(name).flag(name).unwrap_or(false);
        EffectsOff {
            motion_blur: flag("disableMotionBlur"),
            shutter: flag("instantaneousShutter"),
            depth_of_field: flag("disableDepthOfField"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::render::tests::render;
    use super::*;
    use crate::error::Warnings;
    use crate::import::ImportOptions;

    const NAMED: &str = r#"renderSettingsPrimPath = "/S""#;

    #[test]
    fn what_the_product_authors_goes_first() {
        let (desc, said) = render(
            NAMED,
            r#"def RenderSettings "S" {
                rel products = [</P>, </Q>]
                uniform float pixelAspectRatio = 3
                uniform token aspectRatioConformPolicy = "cropAperture"
                uniform float4 dataWindowNDC = (0.25, 0.5, 1, 1)
            }
            def RenderProduct "P" { token productName = "p.exr" uniform float pixelAspectRatio = 2 }
            def RenderProduct "Q" { token productName = "q.exr" uniform int2 resolution = (10, 10) }"#,
        );
        let framing = desc.framing;
        assert_eq!((framing.pixel_aspect, framing.conform), (2.0, Conform::Crop));
        // From below as it stands there, from above here.
        assert_eq!(framing.window, Some([0.25, 0.0, 1.0, 0.5]));
        let [p, q] = &desc.products[..] else { panic!("{:?}", desc.products) };
        let other = FramingDesc { resolution: Some([10, 10]), pixel_aspect: 3.0, ..framing.clone() };
        assert_eq!((&p.framing, &q.framing, &*said), (&framing, &other, ""));
    }

    #[test]
    fn frames_that_make_no_sense_are_told() {
        for (line, what, window) in [
            ("float4 dataWindowNDC = (-0.5, 0, 1.5, 0.5)", "", Some([-0.5, 0.5, 1.5, 1.0])),
            ("float4 dataWindowNDC = (1, 0, 0, 1)", "shows nothing", None),
            ("float pixelAspectRatio = -1", "pixels are square", None),
            ("token aspectRatioConformPolicy = \"odd\"", "no aspectRatioConformPolicy \"odd\"", None),
        ] {
            let (desc, said) = render(NAMED, &format!("def RenderSettings \"S\" {{ uniform {line} }}"));
            assert!(said.contains(what) && said.is_empty() == what.is_empty(), "{said}");
            let framing = desc.framing;
            assert_eq!((framing.window, framing.pixel_aspect, framing.conform), (window, 1.0, Conform::Expand));
        }
    }

    /// The effects that settings turn off with `line`, and whether a camera that blurs moves.
    fn off_by(line: &str) -> (EffectsOff, bool) {
        let text = format!(
            r#"#usda 1.0
            ( {NAMED} )
            def RenderSettings "S" {{ uniform bool {line} = 1 }}
            def Camera "C" {{
                double shutter:open = -0.25
                double shutter:close = 0.5
                double3 xformOp:translate.timeSamples = {{ 0: (0, 0, 0), 2: (1, 0, 0) }}
                uniform token[] xformOpOrder = ["xformOp:translate"]
            }}"#
        );
        let mut file = tempfile::Builder::new().suffix(".usda").tempfile().unwrap();
        std::io::Write::write_all(&mut file, text.as_bytes()).unwrap();
        let options = ImportOptions { frame: Some(1.0), ..ImportOptions::default() };
        let scene = crate::import::scene(file.path(), &options, &mut Warnings::new()).unwrap();
        (scene.render.framing.off, !scene.cameras[0].motion.is_empty())
    }

    #[test]
    fn settings_turn_effects_of_cameras_off() {
        let none = EffectsOff::default();
        assert_eq!(off_by("any"), (none, true));
        assert_eq!(off_by("disableDepthOfField"), (EffectsOff { depth_of_field: true, ..none }, true));
        assert_eq!(off_by("disableMotionBlur"), (EffectsOff { motion_blur: true, ..none }, false));
        assert_eq!(off_by("instantaneousShutter"), (EffectsOff { shutter: true, ..none }, false));
    }
}
