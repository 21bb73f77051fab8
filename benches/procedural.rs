//! Nanoseconds per evaluation of each procedural texture, on one thread.
//!
//! `cargo bench --ignore-rust-version --bench procedural`

use std::hint::black_box;
use std::time::Instant;

use penumbra::math::Vec3;
use penumbra::texture::procedural::*;
use penumbra::texture::sky::{Atmosphere, Preetham, Scattering, ToRgb};

/// Positions of one round.
const COUNT: usize = 1024;

/// The least of many short rounds counts, spread over the whole run: the machine may be shared.
const ROUNDS: usize = 30;
const PASSES: usize = 12;

type Evaluate = Box<dyn Fn(Vec3, f32) -> f32>;
type Table = Vec<(String, Evaluate)>;

fn main() {
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / 1_048_576.0 - 8.0
    };
    let places: Vec<(Vec3, f32)> = (0..COUNT).map(|_| (Vec3::new(random(), random(), random()), random())).collect();
    let mut table = Table::new();
    noise(&mut table);
    voronoi(&mut table);
    others(&mut table);
    let mut least = vec![f64::MAX; table.len()];
    for _ in 0..PASSES {
        for ((_, evaluate), least) in table.iter().zip(&mut least) {
            for _ in 0..ROUNDS {
                let start = Instant::now();
                black_box(places.iter().map(|(p, w)| evaluate(*p, *w)).sum::<f32>());
                *least = least.min(start.elapsed().as_secs_f64());
            }
        }
    }
    println!("{:<44}{:>9}", "texture", "ns");
    for ((name, _), least) in table.iter().zip(least) {
        println!("{name:<44}{:>9.1}", least * 1e9 / COUNT as f64);
    }
    skies();
}

const ALL: [Dimensions; 4] = [Dimensions::One, Dimensions::Two, Dimensions::Three, Dimensions::Four];

/// Adds a row.
fn time(table: &mut Table, name: &str, evaluate: impl Fn(Vec3, f32) -> f32 + 'static) {
    table.push((name.to_owned(), Box::new(evaluate)));
}

fn noise(table: &mut Table) {
    let sockets = move |detail| NoiseSockets {
        scale: 5.0,
        detail,
        roughness: 0.5,
        lacunarity: 2.0,
        offset: 0.0,
        gain: 1.0,
        distortion: 0.0,
    };
    for dimensions in ALL {
        let noise = Noise { dimensions, kind: NoiseKind::Fbm, normalize: true };
        time(table, &format!("noise {dimensions:?}, 1 octave"), move |p, w| noise.factor(p, w, &sockets(0.0)));
    }
    let noise = Noise { dimensions: Dimensions::Three, kind: NoiseKind::Fbm, normalize: true };
    time(table, "noise Three, 3 octaves", move |p, w| noise.factor(p, w, &sockets(2.0)));
    time(table, "noise Three, 3 octaves, colour", move |p, w| noise.color(p, w, &sockets(2.0))[2]);
    time(table, "noise Three, 16 octaves", move |p, w| noise.factor(p, w, &sockets(15.0)));
}

fn voronoi(table: &mut Table) {
    let sockets = VoronoiSockets {
        scale: 5.0,
        detail: 0.0,
        roughness: 0.5,
        lacunarity: 2.0,
        smoothness: 1.0,
        exponent: 0.5,
        randomness: 1.0,
    };
    let with = |dimensions, feature, scatter| Voronoi {
        dimensions,
        feature,
        metric: VoronoiMetric::Euclidean,
        normalize: false,
        scatter,
    };
    use VoronoiFeature::{DistanceToEdge, F1, F2, NSphereRadius, SmoothF1};
    for dimensions in ALL {
        for feature in [F1, F2, SmoothF1, DistanceToEdge, NSphereRadius] {
            let voronoi = with(dimensions, feature, Scatter::Pcg);
            time(table, &format!("voronoi {dimensions:?} {feature:?}"), move |p, w| {
                let value = voronoi.value(p, w, &sockets);
                value.distance + value.color[1] + value.radius
            });
        }
    }
    let voronoi = with(Dimensions::Three, F1, Scatter::Jenkins);
    time(table, "voronoi Three F1, Blender 4", move |p, w| voronoi.value(p, w, &sockets).color[1]);
    let voronoi = Voronoi { metric: VoronoiMetric::Minkowski, ..with(Dimensions::Three, F1, Scatter::Pcg) };
    time(table, "voronoi Three F1, Minkowski", move |p, w| voronoi.value(p, w, &sockets).color[1]);
}

fn others(table: &mut Table) {
    let wave = Wave { direction: WaveDirection::BandsX, profile: WaveProfile::Sine };
    let sockets = move |distortion| WaveSockets {
        scale: 5.0,
        distortion,
        detail: 2.0,
        detail_scale: 1.0,
        detail_roughness: 0.5,
        phase: 0.0,
    };
    time(table, "wave", move |p, _| wave.factor(p, &sockets(0.0)));
    time(table, "wave, distorted by 3 octaves", move |p, _| wave.factor(p, &sockets(1.0)));
    time(table, "checker", move |p, _| checker(p, 5.0));
    let brick = Brick { offset: 0.5, offset_frequency: 2, squash: 1.0, squash_frequency: 2 };
    let sockets = BrickSockets {
        scale: 5.0,
        mortar_size: 0.02,
        mortar_smooth: 0.1,
        bias: 0.0,
        brick_width: 0.5,
        row_height: 0.25,
    };
    time(table, "brick", move |p, _| brick.value(p, &sockets).tint);
    time(table, "gradient, spherical", move |p, _| Gradient::Spherical.factor(p));
    time(table, "gradient, radial", move |p, _| Gradient::Radial.factor(p));
    time(table, "magic, depth 2", move |p, _| Magic { depth: 2 }.factor(p, 5.0, 1.0));
    time(table, "white noise, value", move |p, w| WhiteNoise { dimensions: Dimensions::Three }.value(p, w));
    time(table, "white noise, colour", move |p, w| WhiteNoise { dimensions: Dimensions::Three }.color(p, w)[2]);
    let sockets =
        GaborSockets { scale: 5.0, frequency: 2.0, anisotropy: 1.0, orientation_2d: 0.785, orientation_3d: Vec3::ONE };
    time(table, "gabor Two", move |p, _| Gabor::Two.value(p, &sockets).value);
    sky(table);
    time(table, "gabor Three", move |p, _| Gabor::Three.value(p, &sockets).value);
}

fn sky(table: &mut Table) {
    let preetham = Preetham { sun_direction: Vec3::Z, turbidity: 2.2, to_rgb: ToRgb::Blender5 }.prepare();
    time(table, "sky, Preetham", move |p, _| preetham.radiance(p.normalize()).g);
    let sky = atmosphere(Scattering::Multiple).prepare();
    time(table, "sky, atmosphere", move |p, _| sky.radiance(p.normalize()).g);
}

fn atmosphere(scattering: Scattering) -> Atmosphere {
    Atmosphere {
        scattering,
        sun_elevation: 0.26,
        sun_rotation: 0.0,
        sun_size: Some(0.0095),
        sun_intensity: 1.0,
        altitude: 100.0,
        air: 1.0,
        aerosol: 1.0,
        ozone: 1.0,
    }
}

/// Making a sky's table, on all threads.
fn skies() {
    println!("{:<44}{:>9}", "sky", "ms");
    for scattering in [Scattering::Nishita, Scattering::Single, Scattering::Multiple] {
        let atmosphere = atmosphere(scattering);
        let time = |_| {
            let start = Instant::now();
            black_box(atmosphere.prepare());
            start.elapsed().as_secs_f64()
        };
        println!("{:<44}{:>9.0}", format!("{scattering:?}"), (0..5).map(time).fold(f64::MAX, f64::min) * 1e3);
    }
}
