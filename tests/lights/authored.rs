//! Authored rectangles and ellipses as emitters, and what bad numbers become.

use std::f64::consts::PI;

use penumbra::desc::{Blending, ColorSpace, ImageDesc, LightKind, PixelData};
use penumbra::error::Place;
use penumbra::light::{AnyEmitter, Emitter};
use penumbra::math::{Bounds, DAffine3, DMat3, DVec3, Vec3};
use penumbra::scene::{View, prepare};

use crate::scene::{Builder, settings};

/// The emitter that a light becomes and the warnings on the way.
fn made(kind: LightKind, transform: DAffine3, images: &[ImageDesc]) -> (Option<AnyEmitter>, Vec<String>) {
    let mut builder = Builder::default();
    let white = builder.lambert(0.5);
    builder.ground(1.0, white);
    builder.look([0.0; 3], [0.0, -1.0, 0.0], 1.0);
    // So that render space is the world's.
    builder.desc.cameras[0].transform.translation = DVec3::ZERO;
    builder.desc.images = images.iter().cloned().map(Into::into).collect();
    builder.light(kind, transform);
    let view = View { camera: None, size: Some([4, 4]) };
    let prepared = prepare(builder.desc, &view, &settings("combined", 1)).unwrap();
    let warnings = prepared.warnings.iter().map(ToString::to_string).collect();
    (prepared.scene.lights.iter().next().map(|light| light.emitter.clone()), warnings)
}

fn rect(width: f64, height: f64, spread: f64) -> LightKind {
    LightKind::Rect { width, height, radiance: [2.0; 3], spread, two_sided: false, image: None }
}

fn disk(width: f64, height: f64, spread: f64) -> LightKind {
    LightKind::Disk { width, height, radiance: [2.0; 3], spread, two_sided: false }
}

fn power(emitter: &AnyEmitter) -> f64 {
    f64::from(emitter.power(Bounds::EMPTY))
}

#[test]
fn good_numbers_need_no_warning() {
    for (kind, exact) in [(rect(2.0, 3.0, PI), 12.0 * PI), (disk(2.0, 3.0, 1.0), 3.0 * PI * PI)] {
        let (emitter, warnings) = made(kind, DAffine3::IDENTITY, &[]);
        assert!((power(&emitter.unwrap()) / exact - 1.0).abs() < 1e-6);
        assert!(warnings.is_empty(), "{warnings:?}");
    }
}

#[test]
fn bad_numbers_are_told_once_with_the_name_of_the_light() {
    let nan = f64::NAN;
    let cases: [(LightKind, &[&str], Option<f64>); 9] = [
        (rect(0.0, 1.0, PI), &["width is 0", "emits nothing"], None),
        (disk(1.0, 0.0, PI), &["height is 0", "emits nothing"], None),
        (rect(-2.0, 1.0, PI), &["width is negative: taken as 2"], Some(4.0 * PI)),
        (disk(-2.0, -2.0, PI), &["width is negative: taken as 2", "height is negative"], Some(2.0 * PI * PI)),
        (rect(nan, 1.0, PI), &["width is NaN", "emits nothing"], None),
        (rect(f64::INFINITY, 1.0, PI), &["width is inf", "emits nothing"], None),
        (rect(1.0, 1.0, 4.0), &["spread is 4: taken as 3.14"], Some(2.0 * PI)),
        (disk(2.0, 2.0, -0.5), &["spread is -0.5: taken as 0"], Some(2.0 * PI * PI)),
        (rect(1.0, 1.0, nan), &["spread is NaN: taken as none"], Some(2.0 * PI)),
    ];
    for (kind, said, exact) in cases {
        let (emitter, warnings) = made(kind, DAffine3::IDENTITY, &[]);
        assert_eq!(emitter.as_ref().map(power).is_some(), exact.is_some(), "{kind:?}");
        if let (Some(emitter), Some(exact)) = (emitter, exact) {
            assert!((power(&emitter) / exact - 1.0).abs() < 1e-6, "{kind:?}");
        }
        // That nothing is left to shine is told apart.
        assert_eq!(warnings.len(), if exact.is_some() { 1 } else { 2 }, "{warnings:?}");
        for said in said.iter().chain(&["lamp 0"]) {
            assert!(warnings[0].contains(said), "{:?} lacks {said:?}", warnings[0]);
        }
    }
}

#[test]
fn scale_and_shear_leave_size_and_right_angles() {
    // Columns of very different lengths, x sheared towards z, mirrored.
    let m = DMat3::from_cols(DVec3::new(3.0, 0.0, 1.0), DVec3::new(0.0, -0.1, 0.0), DVec3::new(0.0, 0.0, 20.0));
    let transform = DAffine3::from_mat3_translation(m, DVec3::new(1.0, 2.0, 3.0));
    let (emitter, warnings) = made(rect(2.0, 4.0, PI), transform, &[]);
    let emitter = emitter.unwrap();
    assert!((power(&emitter) / (16.0 * PI) - 1.0).abs() < 1e-6 && warnings.is_empty(), "{warnings:?}");
    let bounds = emitter.bounds().unwrap();
    assert!((bounds.bounds.min - Vec3::new(0.0, 0.0, 3.0)).length() < 1e-5, "{bounds:?}");
    assert!((bounds.bounds.max - Vec3::new(2.0, 4.0, 3.0)).length() < 1e-5, "{bounds:?}");
    assert_eq!(bounds.axis, -Vec3::Z);
    // A z turned round turns the light.
    let (emitter, _) = made(rect(2.0, 4.0, PI), DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0)), &[]);
    assert_eq!(emitter.unwrap().bounds().unwrap().axis, Vec3::Z);
}

fn image(values: [f32; 4]) -> ImageDesc {
    ImageDesc {
        name: "gobo".into(),
        place: Place::default(),
        width: 2,
        height: 2,
        channels: 1,
        color_space: ColorSpace::Linear,
        blending: Blending::default(),
        pixels: PixelData::F32(values.to_vec()),
    }
}

#[test]
fn an_image_is_radiance_upright_with_its_mean() {
    let kind =
        LightKind::Rect { width: 2.0, height: 2.0, radiance: [3.0; 3], spread: PI, two_sided: false, image: Some(0) };
    // Shines down −z on a viewer who looks up +z, y up: his right is −x.
    let above = DAffine3::from_translation(DVec3::new(0.0, 0.0, 1.0));
    let seen = |emitter: &AnyEmitter, x: f32, y: f32| {
        let wi = Vec3::new(x, y, 1.0).normalize();
        emitter.le(wi, emitter.hit(Vec3::ZERO, wi).as_ref()).r
    };
    let (emitter, warnings) = made(kind, above, &[image([1.0, 2.0, 4.0, 9.0])]);
    let emitter = emitter.unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    for (x, y, exact) in [(0.75, 0.75, 3.0), (-0.75, 0.75, 6.0), (0.75, -0.75, 12.0), (-0.75, -0.75, 27.0)] {
        assert_eq!(seen(&emitter, x, y), exact, "{x} {y}");
    }
    assert!((power(&emitter) / (PI * 4.0 * 12.0) - 1.0).abs() < 1e-6);

    let (emitter, warnings) = made(kind, above, &[image([2.0; 4])]);
    assert!((power(&emitter.unwrap()) / (PI * 4.0 * 6.0) - 1.0).abs() < 1e-6 && warnings.is_empty());
    let (emitter, warnings) = made(kind, above, &[image([0.0; 4])]);
    assert!(emitter.is_none() && warnings[0].contains("image \"gobo\" is black"), "{warnings:?}");
    let (emitter, warnings) = made(kind, above, &[image([-1.0, 0.0, 4.0, 0.0])]);
    let emitter = emitter.unwrap();
    assert!((power(&emitter) / (PI * 4.0 * 3.0) - 1.0).abs() < 1e-6);
    assert!(warnings.len() == 1 && warnings[0].contains("1 pixel negative: taken as 0"), "{warnings:?}");
    assert_eq!(seen(&emitter, 0.75, 0.75), 0.0);
    // As a dome's: a sun above the range of the file is as bright as the brightest of the others.
    let (emitter, warnings) = made(kind, above, &[image([f32::INFINITY, f32::NAN, 4.0, -1.0])]);
    let emitter = emitter.unwrap();
    assert!((power(&emitter) / (PI * 4.0 * 6.0) - 1.0).abs() < 1e-6);
    assert_eq!([seen(&emitter, 0.75, 0.75), seen(&emitter, -0.75, 0.75)], [12.0, 0.0]);
    let said = "lamp 0\": its image \"gobo\" has 1 pixel not a number: taken as 0, 1 pixel negative: taken as 0, \
                1 pixel infinite: taken as 4, the largest of the others";
    assert!(warnings.len() == 1 && warnings[0].contains(said), "{warnings:?}");
}
