//! Integrators and sample counts against each other.

#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use std::f64::consts::PI;

use penumbra::desc::{ColorInput, LightKind, MaterialDesc, ScalarInput};
use penumbra::film::Picture;
use penumbra::math::{DAffine3, DVec3};
use penumbra::scene::{View, prepare};
use penumbra::settings::{Integrator, Settings};
use scene::{Builder, close, mean, picture, settings};

const DOWN: [f64; 3] = [0.0, -1.0, 0.0];

/// Glossy ground, a glossy ball, a lamp, a glowing square and a dome.
fn busy() -> Builder {
    let mut builder = Builder::default();
    let shiny = builder.material(MaterialDesc {
        base_color: ColorInput::constant([0.6, 0.5, 0.4]),
        roughness: ScalarInput::constant(0.3),
        ..MaterialDesc::default()
    });
    let glow = builder.material(MaterialDesc { emission: ColorInput::constant([2.0; 3]), ..MaterialDesc::default() });
    builder.ground(20.0, shiny);
    builder.sphere(16, true, shiny, DAffine3::from_translation(DVec3::Y));
    builder.quad([-2.0, 1.0, -1.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], glow);
    builder.light(
        LightKind::Sphere { radius: 0.2, radiance: [9.0; 3], facing: false },
        DAffine3::from_translation(DVec3::new(2.0, 2.0, 1.0)),
    );
    builder.dome(0.5);
    builder.look([0.0, 0.5, 0.0], [0.3, -0.6, -0.4], 2.0);
    builder
}

#[test]
fn direct_is_the_path_integrator_without_bounces_to_the_bit() {
    let desc = busy().desc;
    let direct = picture(&desc, 24, &Settings { integrator: Integrator::Direct, ..settings("all", 8) });
    let path = picture(&desc, 24, &Settings { max_bounces: 0, ..settings("all", 8) });
    assert_eq!(direct, path);
    assert!(mean(&direct, "Diffuse Direct", 0) > 0.0);
    assert_eq!(mean(&direct, "Diffuse Indirect", 0) + mean(&direct, "Glossy Indirect", 0), 0.0);
}

/// Mean and variance over the pixels.
fn statistics(picture: &Picture, layer: &str) -> [f64; 2] {
    let mean = mean(picture, layer, 0);
    let values = picture.layer(layer).unwrap().data.iter().step_by(3);
    let squares: Vec<f64> = values.map(|v| (f64::from(*v) - mean).powi(2)).collect();
    [mean, squares.iter().sum::<f64>() / squares.len() as f64]
}

#[test]
fn more_ao_samples_are_the_same_mean_with_less_noise() {
    let mut builder = Builder::default();
    let white = builder.lambert(0.5);
    builder.ground(100.0, white);
    builder.quad([1.0, 0.0, -1e4], [0.0, 1.0, 0.0], [0.0, 0.0, 2e4], white);
    builder.look([0.0; 3], DOWN, 1e-3);
    let exact = 0.5 * (1.0 + 0.5_f64.sqrt());
    let mut last = f64::INFINITY;
    for ao_samples in [1, 4, 16] {
        let settings = Settings { ao_samples, integrator: Integrator::Ao, ..settings("ao", 8) };
        let [mean, variance] = statistics(&picture(&builder.desc, 32, &settings), "Ambient Occlusion");
        println!("{ao_samples} rays: {mean:.5}, variance {variance:.2e}");
        close("ao", mean, exact, 5e-3);
        // Of independent rays it would be a quarter.
        assert!(variance < 0.3 * last, "{ao_samples} rays: variance {variance} after {last}");
        last = variance;
    }
}

#[test]
fn light_sampling_and_the_surface_s_own_directions_agree_on_a_glowing_square() {
    let lit_by = |material: MaterialDesc| -> [f64; 2] {
        let mut builder = Builder::default();
        let floor = builder.lambert(0.5);
        builder.ground(10.0, floor);
        let glow = builder.material(material);
        builder.quad([-0.5, 1.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], glow);
        // Dim, for there to be a light where the square is none.
        builder.light(LightKind::Point { intensity: [1e-6; 3] }, DAffine3::from_translation(DVec3::Y * 2.0));
        builder.look([0.0; 3], [0.7, -0.7, 0.0], 1e-3);
        let picture = picture(&builder.desc, 16, &settings("diffuse_direct,shadow", 256));
        ["Diffuse Direct", "Shadow"].map(|layer| mean(&picture, layer, 0))
    };
    let white = ColorInput::constant([1.0; 3]);
    let [sampled, shadow] = lit_by(MaterialDesc { emission: white, ..MaterialDesc::default() });
    // What is unlit is no light: only rays that the surface has sampled find it.
    let [found, shadow_of_unlit] = lit_by(MaterialDesc { base_color: white, unlit: true, ..MaterialDesc::default() });
    let x = 0.5 / 1.25_f64.sqrt();
    let exact = 4.0 / PI * x * x.atan();
    close("both strategies", sampled, exact, 2e-3);
    close("the surface's directions alone", found, exact, 5e-3);
    // All but the point lies behind the square.
    close("shadow", shadow, 1.0, 1e-4);
    close("shadow of what is unlit", shadow_of_unlit, 1.0, 1e-4);
}

#[test]
fn passes_that_occlusion_alone_does_not_compute_are_named_in_one_warning() {
    let warnings = |integrator: Integrator, passes: &str| {
        let settings = Settings { integrator, ..settings(passes, 1) };
        let prepared = prepare(busy().desc, &View { camera: None, size: Some([4, 4]) }, &settings).unwrap();
        prepared.warnings.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    let told = warnings(Integrator::Ao, "combined,ao,shadow,normal,depth,diffuse_direct,sample_count,crypto_object");
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].ends_with("none of these passes, which stay 0 and shadows 1: diffuse_direct, shadow"), "{told:?}");
    assert!(warnings(Integrator::Ao, "combined,ao,normal,uv,depth,crypto_asset").is_empty());
    for integrator in [Integrator::Path, Integrator::Direct] {
        assert!(warnings(integrator, "all").is_empty());
    }
}
