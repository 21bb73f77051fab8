//! Scenes at random, within the ranges of the suite: white ones in a white world are white, and all look alike wherever
//! they stand, however they are turned and whatever their scale is.

use std::f64::consts::PI;

use penumbra::desc::{AlphaMode, ColorInput, LightKind, MaterialDesc, ScalarInput, VolumeDesc};
use penumbra::math::{DAffine3, DQuat, DVec3};
use penumbra::settings::Settings;
use proptest::prelude::*;

use crate::row::placed;
use crate::scene::{Builder, mean, picture, settings};

/// An object: which shape, of what, how large along its axes (powers of ten), where and how turned.
#[derive(Clone, Debug)]
struct Thing {
    shape: u8,
    surface: Surface,
    size: [f64; 3],
    mirrored: bool,
    at: [f64; 3],
    axis: [f64; 3],
    angle: f64,
}

#[derive(Clone, Debug)]
enum Surface {
    Matte,
    Metal { roughness: f64 },
    Glass { ior: f64, roughness: f64 },
    Film { opacity: f64 },
}

fn surface() -> impl Strategy<Value = Surface> {
    let roughness = || prop::sample::select(vec![0.0, 1e-7, 1e-4, 0.05, 0.3, 1.0]);
    let ior = prop::sample::select(vec![0.5, 1.0, 1.0 + 1e-6, 1.33, 1.5, 3.0]);
    prop_oneof![
        Just(Surface::Matte),
        roughness().prop_map(|roughness| Surface::Metal { roughness }),
        (ior, roughness()).prop_map(|(ior, roughness)| Surface::Glass { ior, roughness }),
        prop::sample::select(vec![0.0, 0.5, 1.0]).prop_map(|opacity| Surface::Film { opacity }),
    ]
}

fn thing() -> impl Strategy<Value = Thing> {
    let size = prop::array::uniform3((-3.0..0.0_f64).prop_map(|power| 10_f64.powf(power)));
    let unit = || prop::array::uniform3(-1.0..1.0_f64);
    (0..3_u8, surface(), size, any::<bool>(), unit(), unit(), 0.0..2.0 * PI).prop_map(
        |(shape, surface, size, mirrored, at, axis, angle)| Thing { shape, surface, size, mirrored, at, axis, angle },
    )
}

impl Surface {
    fn material(&self) -> MaterialDesc {
        let number = ScalarInput::constant;
        let white = MaterialDesc { base_color: ColorInput::constant([1.0; 3]), ..MaterialDesc::default() };
        let matte = MaterialDesc { specular: number(0.0), roughness: number(1.0), ..white.clone() };
        match *self {
            Self::Matte => matte,
            Self::Metal { roughness } => MaterialDesc { metallic: number(1.0), roughness: number(roughness), ..white },
            Self::Glass { ior, roughness } => MaterialDesc {
                ior: number(ior),
                roughness: number(roughness),
                transmission: number(1.0),
                volume: Some(VolumeDesc {
                    thickness: number(1.0),
                    attenuation_distance: f64::INFINITY,
                    attenuation_color: [1.0; 3],
                    adds: false,
                }),
                ..white
            },
            Self::Film { opacity } => MaterialDesc { alpha: number(opacity), alpha_mode: AlphaMode::Blend, ..matte },
        }
    }
}

fn scene(things: &[Thing]) -> Builder {
    let mut scene = Builder::default();
    for thing in things {
        let material = scene.material(thing.surface.material());
        let axis = DVec3::from(thing.axis).normalize_or(DVec3::X);
        let mirror = DVec3::new(if thing.mirrored { -1.0 } else { 1.0 }, 1.0, 1.0);
        let turn = DQuat::from_axis_angle(axis, thing.angle);
        let size = DVec3::from(thing.size) * mirror;
        let transform = DAffine3::from_scale_rotation_translation(size, turn, DVec3::from(thing.at));
        match thing.shape {
            0 => scene.sphere(6, false, material, transform),
            1 => scene.sphere(2, false, material, transform),
            _ => {
                let corners = vec![[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]];
                scene.mesh(corners, vec![[0, 1, 2], [0, 2, 3]], material, transform);
            }
        }
    }
    let floor = scene.lambert(1.0);
    scene.quad([-1.5, -1.2, 1.5], [3.0, 0.0, 0.0], [0.0, 0.0, -3.0], floor);
    scene.look([0.0; 3], [0.2, -0.7, -0.6], 1.2);
    scene.desc.cameras[0].transform.translation *= 4.0;
    scene
}

fn seen(scene: &Builder, settings: &Settings) -> f64 {
    let picture = picture(&scene.desc, 12, settings);
    for layer in &picture.layers {
        assert!(layer.data.iter().all(|v| v.is_finite()), "{} has what is no number", layer.name);
    }
    mean(&picture, "Combined", 0)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn white_in_white_is_white(things in prop::collection::vec(thing(), 1..8)) {
        let mut scene = scene(&things);
        scene.dome(1.0);
        let value = seen(&scene, &Settings { max_bounces: 500, ..settings("combined", 64) });
        prop_assert!((value - 1.0).abs() < 0.02, "{value}");
    }

    #[test]
    fn nothing_depends_on_where_and_how_large(
        things in prop::collection::vec(thing(), 1..8),
        axis in prop::array::uniform3(-1.0..1.0_f64),
        angle in 0.0..2.0 * PI,
        power in -4.0..5.0_f64,
        away in prop::array::uniform3(-1e5..1e5_f64),
    ) {
        let mut scene = scene(&things);
        scene.dome(0.3);
        let sun = LightKind::Distant { irradiance: [2.0; 3], angle: 0.1 };
        scene.light(sun, DAffine3::from_rotation_x(-1.1));
        let settings = Settings { max_bounces: 6, ..settings("combined", 64) };
        let expected = seen(&scene, &settings);
        let turn = DQuat::from_axis_angle(DVec3::from(axis).normalize_or(DVec3::Y), angle);
        // Orthographic: what is seen grows with the scene.
        let scale = 10_f64.powf(power);
        let mut other = placed(&scene, DAffine3::from_scale_rotation_translation(DVec3::splat(scale), turn, DVec3::from(away)));
        if let penumbra::desc::ProjectionDesc::Orthographic { half_width, half_height } = &mut other.desc.cameras[0].projection {
            (*half_width, *half_height) = (*half_width * scale, *half_height * scale);
        }
        let value = seen(&other, &settings);
        prop_assert!((value - expected).abs() < 0.02 * expected, "{value} instead of {expected}");
    }
}
