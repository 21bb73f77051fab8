//! Numbers that overflow, vanish, add up for too long or come from the end of a sequence.

use penumbra::desc::{ColorInput, LightKind, MaterialDesc, ScalarInput};
use penumbra::film::{Film, PassSet, PixelSample, SampleId};
use penumbra::math::{DAffine3, DVec3, Rgb};
use penumbra::sampling::{AliasTable, Decision, Dimension, Distribution2d, PATTERNS, Sampler, power_heuristic};
use penumbra::scene::{View, prepare};
use penumbra::settings::Settings;

use crate::row::{Found, Row, hold, judge};
use crate::scene::{Builder, settings};

const DOWN: [f64; 3] = [0.0, -1.0, 0.0];

fn found(name: impl Into<String>, truth: f64, tolerance: f64, value: f64) -> Found {
    Found { name: name.into(), truth, tolerance, values: [Some(value), None], open: None }
}

#[test]
fn pictures() {
    let mut rows = Vec::new();
    // 10⁻⁴⁰ of the light comes through, which is a denormal.
    let mut scene = Builder::default();
    let white = scene.lambert(1.0);
    scene.ground(10.0, white);
    for i in 0..4 {
        let film = scene.material(MaterialDesc {
            base_color: ColorInput::constant([0.0; 3]),
            specular: ScalarInput::constant(0.0),
            transparency: ColorInput::constant([1e-10; 3]),
            ..MaterialDesc::default()
        });
        scene.quad([-1.0, 0.1 + 0.1 * f64::from(i), -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0], film);
    }
    scene.light(LightKind::Point { intensity: [1.0; 3] }, DAffine3::from_translation(DVec3::Y));
    // From the side, so that the films are in the way of the light alone.
    scene.look([0.0; 3], [0.99, -0.01, 0.0], 1e-6);
    rows.push(Row::new("light through four films of 1e-10", scene, "Diffuse Direct", 16, 0.0, 1e-37));
    hold("vanishing", rows);
}

/// Samples that overflow reach no pass: they are left out and counted.
#[test]
fn overflow() {
    let mut scene = Builder::default();
    let white = scene.lambert(1.0);
    scene.ground(10.0, white);
    scene.light(LightKind::Point { intensity: [1e30; 3] }, DAffine3::from_translation(DVec3::Y * 1e-6));
    scene.look([0.0; 3], DOWN, 1e-9);
    let view = View { camera: None, size: Some([4; 2]) };
    let settings = Settings { max_bounces: 0, ..settings("all", 16) };
    let prepared = prepare(scene.desc, &view, &settings).unwrap();
    let rendered = penumbra::render::render(&prepared.scene, &settings, &()).unwrap();
    let picture = rendered.film.develop();
    let bad = picture.layers.iter().flat_map(|layer| &layer.data).filter(|v| !v.is_finite()).count();
    judge(
        "overflow",
        vec![
            found(
                "lamp of 1e30 W/sr at a micrometre: samples that are counted, of 256",
                256.0,
                0.0,
                rendered.film.non_finite().count as f64,
            ),
            found("lamp of 1e30 W/sr at a micrometre: numbers in the picture that are none", 0.0, 0.0, bad as f64),
        ],
    );
}

#[test]
fn long_sums() {
    let mut film = Film::new(1, 1, PassSet::default());
    let sample = PixelSample { combined: Rgb::splat(0.1), alpha: 1.0, ..PixelSample::default() };
    for index in 0..10_000_000 {
        film.tiles_mut()[0].add(SampleId { x: 0, y: 0, index }, 1.0, &sample);
    }
    let value = f64::from(film.develop().layers[0].data[0]);
    judge("sums", vec![found("mean of 10,000,000 samples of 0.1", f64::from(0.1_f32), 1e-7, value)]);
}

/// Everything about 2³²: the last numbers before it, the first after it.
#[test]
fn far_indices() {
    let mut rows = Vec::new();
    for info in PATTERNS {
        let sampler = Sampler::new(info.pattern, 1);
        let dimension = Dimension::at_bounce(2, Decision::LightPoint);
        let outside = [(1_u64 << 32) - 1000, (1 << 32) - 1, 1 << 32, (1 << 40) + 5, u64::MAX - 1000].into_iter();
        let outside =
            outside.flat_map(|start| (start..start.saturating_add(1000)).map(|i| sampler.for_sample(7, 9, i)));
        let outside = outside.filter(|s| {
            let ([x, y], z) = (s.get_2d(dimension), s.get_1d(dimension));
            ![x, y, z].iter().all(|v| (0.0..1.0).contains(v))
        });
        rows.push(found(
            format!("{}: numbers outside of 0 to 1 about index 2^32, 2^40 and 2^64", info.name),
            0.0,
            0.0,
            outside.count() as f64,
        ));
        let at = |i: u64| sampler.for_sample(7, 9, i).get_2d(dimension);
        let again = (0..256).filter(|&i| at(i) == at((1 << 32) + i)).count();
        rows.push(found(
            format!("{}: of 256 points, those that come again 2^32 later", info.name),
            0.0,
            0.0,
            again as f64,
        ));
        if info.name == "sobol" {
            let mut seen = [false; 256];
            for i in 0..256 {
                let [x, y] = at((1 << 32) + i).map(|v| (v * 16.0) as usize);
                seen[16 * y + x] = true;
            }
            rows.push(found(
                "sobol: of 16 x 16 boxes, those without one of the 256 points from index 2^32",
                0.0,
                0.0,
                seen.iter().filter(|s| !**s).count() as f64,
            ));
        }
    }
    judge("indices", rows);
}

#[test]
fn tables() {
    let mut rows = Vec::new();
    let numbers = || (0..1_u32 << 20).map(|i| i as f32 / (1 << 20) as f32).chain([1.0 - f32::EPSILON / 2.0]);
    for (name, weights) in [
        ("zeros about one entry", vec![0.0, 0.0, 3.0, 0.0]),
        ("zeros first and last", vec![0.0, 1e-300, 1.0, 1e300, 0.0]),
        ("one entry", vec![1e-30]),
        ("a million zeros and one entry", [vec![0.0; 1_000_000], vec![1.0]].concat()),
    ] {
        let table = AliasTable::new(&weights).unwrap();
        let impossible = numbers().filter(|u| weights[table.sample(*u).index] == 0.0).count();
        rows.push(found(format!("table with {name}: draws of what has no weight"), 0.0, 0.0, impossible as f64));
        let sum: f64 = (0..weights.len()).map(|i| f64::from(table.pmf(i))).sum();
        rows.push(found(format!("table with {name}: sum of probabilities"), 1.0, 1e-6, sum));
    }
    let image = Distribution2d::new(64, 32, |x, y| if (x, y) == (63, 31) { 1e-30 } else { 0.0 }).unwrap();
    let impossible = (0..64).flat_map(|i| (0..64).map(move |j| [i, j].map(|k| k as f32 / 64.0)));
    let impossible = impossible.filter(|u| {
        let found = image.sample(*u);
        found.pdf <= 0.0 || found.p[0] < 63.0 / 64.0 || found.p[1] < 31.0 / 32.0 || found.p.iter().any(|v| *v > 1.0)
    });
    rows.push(found("image of zeros with one texel: draws beside it", 0.0, 0.0, impossible.count() as f64));
    for (p, q, truth) in [(1e25, 1.0, 1.0), (1.0, 1e25, 0.0), (1e38, 1e38, 0.5), (1e-38, 1e-38, 0.5), (0.0, 1.0, 0.0)] {
        rows.push(found(
            format!("MIS weight of densities {p:e} and {q:e}"),
            truth,
            1e-6,
            f64::from(power_heuristic(p, q)),
        ));
    }
    judge("tables", rows);
}
