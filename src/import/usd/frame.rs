//! How the settings of a render frame the picture, and what of the camera they turn off. What a product
//! authors goes before what its settings say.

use openusd::sdf::Path;

use super::render::is_authored;
use super::values::Values;
use crate::desc::{CameraDesc, Conform};

/// Settings, and the product that is rendered.
#[derive(Clone, Copy)]
pub(super) struct Said<'a> {
    pub settings: Values<'a>,
    pub product: Option<Values<'a>>,
}

/// Effects of the cameras that are off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Off {
    /// The shutter is open at the frame alone.
    pub motion_blur: bool,
    /// The shutter closes when it opens.
    pub shutter: bool,
    /// All is sharp.
    pub depth_of_field: bool,
}

impl<'a> Said<'a> {
    /// Whose `name` counts.
    pub fn of(&self, name: &str) -> Values<'a> {
        self.product.filter(|product| is_authored(product.prim, name)).unwrap_or(self.settings)
    }

    /// The first camera that is named.
    pub fn camera(&self) -> Option<Path> {
        let of = |values: Values<'_>| values.targets("camera").into_iter().next();
        self.product.and_then(of).or_else(|| of(self.settings))
    }

    /// Width of a pixel over its height.
    pub fn pixel_aspect(&self) -> f64 {
        let values = self.of("pixelAspectRatio");
        let aspect = values.number("pixelAspectRatio").unwrap_or(1.0);
        if aspect > 0.0 {
            return aspect;
        }
        values.warn(format!("a pixelAspectRatio of {aspect} is no shape: pixels are square"));
        1.0
    }

    pub fn conform(&self) -> Conform {
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
    pub fn window(&self) -> Option<[f64; 4]> {
        let values = self.of("dataWindowNDC");
        let window = values.reading.value::<[f32; 4]>(values.prim, "dataWindowNDC")?.map(f64::from);
        let [left, lower, right, upper] = window;
        let inside = window.map(|x| x.clamp(0.0, 1.0));
        if window.iter().any(|x| !x.is_finite()) || inside[0] >= inside[2] || inside[1] >= inside[3] {
            let what = format!(
                "dataWindowNDC ({left}, {lower}, {right}, {upper}) shows nothing of the picture: all is rendered"
            );
            values.warn(what);
            return None;
        }
        if inside != window {
            values.warn("dataWindowNDC goes beyond the picture, which is not rendered: it ends there");
        }
        let [left, lower, right, upper] = inside;
        (inside != [0.0, 0.0, 1.0, 1.0]).then_some([left, 1.0 - upper, right, 1.0 - lower])
    }

    pub fn off(&self) -> Off {
        let flag = |name: &str| self.of(name).flag(name).unwrap_or(false);
        Off {
            motion_blur: flag("disableMotionBlur"),
            shutter: flag("instantaneousShutter"),
            depth_of_field: flag("disableDepthOfField"),
        }
    }
}

impl Off {
    /// True where no motion is to be read.
    pub fn stands_still(self) -> bool {
        self.motion_blur || self.shutter
    }

    /// Turns off what is off.
    pub fn apply(self, camera: &mut CameraDesc) {
        if self.depth_of_field {
            camera.lens = None;
        }
        if self.motion_blur {
            camera.shutter = [0.0; 2];
        } else if self.shutter {
            camera.shutter[1] = camera.shutter[0];
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
            def RenderProduct "P" { uniform float pixelAspectRatio = 2 }
            def RenderProduct "Q" { uniform int2 resolution = (10, 10) }"#,
        );
        assert_eq!((desc.pixel_aspect, desc.conform), (2.0, Conform::Crop));
        // From below as it stands there, from above here.
        assert_eq!(desc.window, Some([0.25, 0.0, 1.0, 0.5]));
        assert!(said.contains("/Q: is not rendered: its resolution, pixelAspectRatio are not those of /P"), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }

    #[test]
    fn frames_that_make_no_sense_are_told() {
        for (line, what, window) in [
            ("float4 dataWindowNDC = (-0.5, 0, 1.5, 0.5)", "goes beyond the picture", Some([0.0, 0.5, 1.0, 1.0])),
            ("float4 dataWindowNDC = (1, 0, 0, 1)", "shows nothing", None),
            ("float pixelAspectRatio = -1", "pixels are square", None),
            ("token aspectRatioConformPolicy = \"odd\"", "no aspectRatioConformPolicy \"odd\"", None),
        ] {
            let (desc, said) = render(NAMED, &format!("def RenderSettings \"S\" {{ uniform {line} }}"));
            assert!(said.contains(what), "{said}");
            assert_eq!((desc.window, desc.pixel_aspect, desc.conform), (window, 1.0, Conform::Expand));
        }
    }

    /// A camera that blurs, with settings that turn something off.
    fn camera_with(line: &str) -> ([f64; 2], bool) {
        let text = format!(
            r#"#usda 1.0
            ( {NAMED} )
            def RenderSettings "S" {{ uniform bool {line} = 1 }}
            def Camera "C" {{
                float fStop = 2
                float focusDistance = 5
                double shutter:open = -0.25
                double shutter:close = 0.5
            }}"#
        );
        let mut file = tempfile::Builder::new().suffix(".usda").tempfile().unwrap();
        std::io::Write::write_all(&mut file, text.as_bytes()).unwrap();
        let options = ImportOptions { frame: Some(1.0), ..ImportOptions::default() };
        let scene = crate::import::scene(file.path(), &options, &mut Warnings::new()).unwrap();
        (scene.cameras[0].shutter, scene.cameras[0].lens.is_some())
    }

    #[test]
    fn settings_turn_effects_of_cameras_off() {
        assert_eq!(camera_with("any"), ([-0.25, 0.5], true));
        assert_eq!(camera_with("disableDepthOfField"), ([-0.25, 0.5], false));
        assert_eq!(camera_with("disableMotionBlur"), ([0.0, 0.0], true));
        assert_eq!(camera_with("instantaneousShutter"), ([-0.25, -0.25], true));
    }
}
