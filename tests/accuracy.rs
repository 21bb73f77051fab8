//! Estimated errors against those that pictures have, and stops that depend on them.

#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use penumbra::desc::{ColorInput, LightKind, MaterialDesc, ScalarInput, SceneDesc};
use penumbra::film::{Doubt, Film, Picture};
use penumbra::math::{DAffine3, DVec3};
use penumbra::render::{Observer, Progress, Rendered, render};
use penumbra::scene::{View, prepare};
use penumbra::settings::{EffectsMode, Settings};
use scene::{Builder, settings};

/// A ball over glossy ground, lit by a lamp, which gives it a wide penumbra, and a dim dome.
fn still() -> SceneDesc {
    let mut builder = Builder::default();
    let white = builder.lambert(0.7);
    let shiny = builder.material(MaterialDesc {
        base_color: ColorInput::constant([0.6, 0.5, 0.4]),
        roughness: ScalarInput::constant(0.3),
        ..MaterialDesc::default()
    });
    builder.ground(20.0, shiny);
    builder.sphere(16, true, white, DAffine3::from_translation(DVec3::Y));
    let lamp = LightKind::Sphere { radius: 0.7, radiance: [6.0, 5.0, 4.0], facing: false };
    builder.light(lamp, DAffine3::from_translation(DVec3::new(1.5, 3.5, 0.5)));
    builder.dome(0.1);
    builder.look([0.0, 0.3, 0.0], [0.3, -0.7, -0.4], 2.5);
    builder.desc
}

fn rendered(desc: &SceneDesc, size: u32, settings: &Settings, observer: &dyn Observer) -> Rendered {
    let view = View { camera: None, size: Some([size, size]) };
    let prepared = prepare(desc.clone(), &view, settings).unwrap();
    render(&prepared.scene, settings, observer).unwrap()
}

fn developed(desc: &SceneDesc, size: u32, settings: &Settings) -> Picture {
    rendered(desc, size, settings, &()).film.develop()
}

/// Values of a layer's first three channels.
fn values(picture: &Picture, layer: &str) -> Vec<f64> {
    let layer = picture.layer(layer).unwrap();
    let n = layer.channels.len();
    layer.data.chunks_exact(n).flat_map(|pixel| pixel[..3].iter().map(|&v| f64::from(v))).collect()
}

/// Over many seeds, the mean of the estimated variances is that of the values, pixel by pixel summed up.
#[test]
fn errors_are_what_pictures_differ_by() {
    let desc = still();
    let base = Settings { max_bounces: 1, ..settings("combined,ao,shadow,error,error_ao,error_shadow", 64) };
    let seeds = 100;
    let pictures: Vec<Picture> =
        (0..seeds).map(|seed| developed(&desc, 20, &Settings { seed, ..base.clone() })).collect();
    for (layer, error) in
        [("Combined", "Error"), ("Ambient Occlusion", "Error Ambient Occlusion"), ("Shadow", "Error Shadow")]
    {
        let n = seeds as f64;
        let all: Vec<Vec<f64>> = pictures.iter().map(|picture| values(picture, layer)).collect();
        let errors: Vec<Vec<f64>> = pictures.iter().map(|picture| values(picture, error)).collect();
        let (mut true_variance, mut estimated) = (0.0, 0.0);
        for i in 0..all[0].len() {
            let square = errors.iter().map(|errors| errors[i].powi(2)).sum::<f64>() / n;
            // A shadow where hardly a sample could be lit is a ratio of little to little: no first order holds there.
            if square < 0.1 * 0.1 {
                let mean = all.iter().map(|values| values[i]).sum::<f64>() / n;
                true_variance += all.iter().map(|values| (values[i] - mean).powi(2)).sum::<f64>() / (n - 1.0);
                estimated += square;
            }
        }
        println!("{layer}: estimated over true variance {:.3}", estimated / true_variance);
        // The sum of 100 squares has a standard deviation of a seventh, that of the hundred pixels which hold most of
        // it one of a seventieth.
        assert!((estimated / true_variance - 1.0).abs() < 0.05, "{layer}: {estimated} for {true_variance}");
    }
}

/// The samples of a sequence say nothing of its error: that of Sobol points is well below the spread of as many
/// independent samples, and the estimate knows.
#[test]
fn points_that_are_better_than_random_have_a_smaller_error() {
    let mut builder = Builder::default();
    let white = builder.lambert(0.5);
    builder.ground(100.0, white);
    builder.light(
        LightKind::Sphere { radius: 1.0, radiance: [1.0; 3], facing: false },
        DAffine3::from_translation(DVec3::new(0.0, 3.0, 0.0)),
    );
    builder.look([0.0; 3], [0.0, -1.0, 0.0], 1e-3);
    let error = |sampler: &str| {
        let mut settings = Settings { max_bounces: 0, ..settings("combined,error", 256) };
        let def = penumbra::settings::SETTINGS.iter().find(|def| def.name == "sampler").unwrap();
        def.set(&mut settings, sampler).unwrap();
        rendered(&builder.desc, 32, &settings, &()).accuracy.unwrap().rmse.unwrap().value
    };
    let [sobol, independent] = ["sobol", "independent"].map(error);
    println!("{sobol:.2e} of {independent:.2e}");
    assert!(sobol < 0.7 * independent, "{sobol} and {independent}");
}

#[test]
fn threads_and_forced_effects_change_no_bit_of_errors_and_plans() {
    let desc = still();
    for adaptive in [false, true] {
        let passes = "combined,shadow,error,error_shadow,error_trust,sample_count";
        let base = Settings { threads: 1, adaptive, error: Some(0.005), ..settings(passes, 64) };
        let one = developed(&desc, 36, &base);
        assert_eq!(one, developed(&desc, 36, &Settings { threads: 3, ..base.clone() }));
        assert_eq!(one, developed(&desc, 36, &Settings { effects: EffectsMode::All, ..base }));
        let counts = &one.layer("Debug Sample Count").unwrap().data;
        assert_eq!(adaptive, counts.iter().any(|&n| n != counts[0]));
    }
}

/// Passes of errors that are not asked for change nothing, and those that are deal samples alike.
#[test]
fn a_stop_rule_and_a_pass_deal_the_same_samples() {
    let desc = still();
    let plain = developed(&desc, 16, &settings("combined", 32));
    let pass = developed(&desc, 16, &settings("combined,error", 32));
    let rule = developed(&desc, 16, &Settings { error: Some(1e-6), ..settings("combined", 32) });
    assert_eq!(pass.layers[0], rule.layers[0]);
    assert_ne!(plain.layers[0], rule.layers[0]);
}

/// What a render tells on the way.
#[derive(Default)]
struct Told(std::sync::Mutex<Vec<Progress>>);

impl Observer for Told {
    fn progress(&self, progress: &Progress) {
        self.0.lock().unwrap().push(*progress);
    }

    fn wave(&self, film: &Film) {
        assert!(film.samples() > 0);
    }
}

#[test]
fn a_render_ends_where_the_error_is_reached() {
    let desc = still();
    let told = Told::default();
    let base = Settings { error: Some(0.004), ..settings("combined", Settings::MOST_FOR_ERROR) };
    let rendered = rendered(&desc, 32, &base, &told);
    let display = rendered.accuracy.unwrap().display.unwrap();
    let spp = rendered.film.samples() / (32 * 32);
    assert!(display.value <= 0.004 && display.low < display.value && display.value < display.high, "{display:?}");
    assert!(display.value > 0.0035 && spp > 16, "{spp} samples are more than it takes: {display:?}");
    let last = *told.0.lock().unwrap().last().unwrap();
    assert_eq!(last.outlook.unwrap().error, Some(display.value));
    assert!(last.done == 1.0 && last.to_target().unwrap()[0] == 0.0, "{last:?}");
    // The picture's own error, against 64 times as many samples.
    let reference = {
        let settings = Settings { seed: 77, ..settings("combined", 64 * spp as u32) };
        values(&developed(&desc, 32, &settings), "Combined")
    };
    let truth = values(&rendered.film.develop(), "Combined");
    let slope = |y: f64| if y <= 0.003_130_8 { 12.92 } else { 1.055 / 2.4 * y.powf(1.0 / 2.4 - 1.0) };
    let luminance =
        |i: usize| 0.2126 * reference[3 * i] + 0.7152 * reference[3 * i + 1] + 0.0722 * reference[3 * i + 2];
    let near = |x: usize| x.saturating_sub(1)..(x + 2).min(32);
    let squares: f64 = (0..32 * 32)
        .map(|i| {
            let around: Vec<f64> =
                near(i / 32).flat_map(|y| near(i % 32).map(move |x| 32 * y + x)).map(luminance).collect();
            let slope = slope((around.iter().sum::<f64>() / around.len() as f64).min(1.0));
            (3 * i..3 * i + 3).map(|c| (slope * (reference[c] - truth[c])).powi(2)).sum::<f64>()
        })
        .sum();
    let truth = (squares / reference.len() as f64).sqrt();
    println!("error {display:?}, true {truth:.5}");
    assert!((truth / display.value - 1.0).abs() < 0.15, "{truth} and {display:?}");
}

/// Doubt is no number, and stops nothing.
#[test]
fn an_error_that_is_not_known_stops_nothing() {
    let desc = still();
    let base = Settings { error: Some(10.0), ..settings("combined", 12) };
    let rendered = rendered(&desc, 8, &base, &());
    assert_eq!(rendered.accuracy.unwrap().display, Err(Doubt::TooFewSamples));
    assert_eq!(rendered.film.samples(), 12 * 64);
}

/// Pixels that stop by their neighbours' samples, pictures by their errors: the mean over many seeds is that of a
/// reference. A pixel that stopped by its own samples would be too dark.
#[test]
fn adaptive_renders_that_stop_at_a_target_are_unbiased() {
    let desc = still();
    let size = 24;
    let mean = |picture: &Picture| {
        let values = values(picture, "Combined");
        values.iter().sum::<f64>() / values.len() as f64
    };
    let base = Settings {
        error: Some(0.006),
        adaptive: true,
        max_bounces: 1,
        ..settings("combined,sample_count", Settings::MOST_FOR_ERROR)
    };
    let seeds = 160;
    let (mut means, mut uneven) = (Vec::new(), 0);
    for seed in 0..seeds {
        let picture = developed(&desc, size, &Settings { seed, ..base.clone() });
        let counts = &picture.layer("Debug Sample Count").unwrap().data;
        uneven += u32::from(counts.iter().any(|&n| n > 2.0 * counts.iter().copied().fold(f32::MAX, f32::min)));
        means.push(mean(&picture));
    }
    let n = means.len() as f64;
    let average = means.iter().sum::<f64>() / n;
    let sigma = (means.iter().map(|m| (m - average).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt();
    let reference =
        mean(&developed(&desc, size, &Settings { max_bounces: 1, seed: 999, ..settings("combined", 8192) }));
    println!("bias {:.2e} of the mean, standard error {:.2e}", average / reference - 1.0, sigma / reference);
    assert!(uneven > seeds as u32 / 2, "samples differ from pixel to pixel: {uneven}");
    assert!(sigma < 3e-4 * reference, "the test is too weak: {sigma}");
    assert!((average - reference).abs() < 1e-3 * reference, "{average} for {reference} ± {sigma}");
}
