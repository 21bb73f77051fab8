//! Nanoseconds per evaluation of each procedural texture, on one thread.
//!
//! `cargo bench --ignore-rust-version --bench procedural`

use std::hint::black_box;
use std::time::Instant;

use penumbra::math::Vec3;
use penumbra::texture::procedural::*;

/// Positions of one round.
const COUNT: usize = 4096;

/// The least of several rounds: the machine may be shared.
const ROUNDS: usize = 15;

fn main() {
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / 1_048_576.0 - 8.0
    };
    let places: Vec<(Vec3, f32)> = (0..COUNT).map(|_| (Vec3::new(random(), random(), random()), random())).collect();
    let time = |name: &str, evaluate: &dyn Fn(Vec3, f32) -> f32| {
        let mut least = f64::MAX;
        for _ in 0..ROUNDS {
            let start = Instant::now();
            let sum: f32 = places.iter().map(|(p, w)| evaluate(*p, *w)).sum();
            black_box(sum);
            least = least.min(start.elapsed().as_secs_f64());
        }
        println!("{name:<44}{:>9.1}", least * 1e9 / COUNT as f64);
    };
    println!("{:<44}{:>9}", "texture", "ns");
    time("empty", &|p, w| p.x + w);
    noise(&time);
    voronoi(&time);
    others(&time);
}

const ALL: [Dimensions; 4] = [Dimensions::One, Dimensions::Two, Dimensions::Three, Dimensions::Four];

fn noise(time: &dyn Fn(&str, &dyn Fn(Vec3, f32) -> f32)) {
    let sockets = |detail| NoiseSockets {
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
        time(&format!("noise {dimensions:?}, 1 octave"), &|p, w| noise.factor(p, w, &sockets(0.0)));
    }
    let noise = Noise { dimensions: Dimensions::Three, kind: NoiseKind::Fbm, normalize: true };
    time("noise Three, 3 octaves", &|p, w| noise.factor(p, w, &sockets(2.0)));
    time("noise Three, 3 octaves, colour", &|p, w| noise.color(p, w, &sockets(2.0))[2]);
    time("noise Three, 16 octaves", &|p, w| noise.factor(p, w, &sockets(15.0)));
}

fn voronoi(time: &dyn Fn(&str, &dyn Fn(Vec3, f32) -> f32)) {
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
            time(&format!("voronoi {dimensions:?} {feature:?}"), &|p, w| {
                let value = voronoi.value(p, w, &sockets);
                value.distance + value.color[1] + value.radius
            });
        }
    }
    let voronoi = with(Dimensions::Three, F1, Scatter::Jenkins);
    time("voronoi Three F1, Blender 4", &|p, w| voronoi.value(p, w, &sockets).color[1]);
    let voronoi = Voronoi { metric: VoronoiMetric::Minkowski, ..with(Dimensions::Three, F1, Scatter::Pcg) };
    time("voronoi Three F1, Minkowski", &|p, w| voronoi.value(p, w, &sockets).color[1]);
}

fn others(time: &dyn Fn(&str, &dyn Fn(Vec3, f32) -> f32)) {
    let wave = Wave { direction: WaveDirection::BandsX, profile: WaveProfile::Sine };
    let sockets = |distortion| WaveSockets {
        scale: 5.0,
        distortion,
        detail: 2.0,
        detail_scale: 1.0,
        detail_roughness: 0.5,
        phase: 0.0,
    };
    time("wave", &|p, _| wave.factor(p, &sockets(0.0)));
    time("wave, distorted by 3 octaves", &|p, _| wave.factor(p, &sockets(1.0)));
    time("checker", &|p, _| checker(p, 5.0));
    let brick = Brick { offset: 0.5, offset_frequency: 2, squash: 1.0, squash_frequency: 2 };
    let sockets = BrickSockets {
        scale: 5.0,
        mortar_size: 0.02,
        mortar_smooth: 0.1,
        bias: 0.0,
        brick_width: 0.5,
        row_height: 0.25,
    };
    time("brick", &|p, _| brick.value(p, &sockets).tint);
    time("gradient, spherical", &|p, _| Gradient::Spherical.factor(p));
    time("gradient, radial", &|p, _| Gradient::Radial.factor(p));
    time("magic, depth 2", &|p, _| Magic { depth: 2 }.factor(p, 5.0, 1.0));
    time("white noise, value", &|p, w| WhiteNoise { dimensions: Dimensions::Three }.value(p, w));
    time("white noise, colour", &|p, w| WhiteNoise { dimensions: Dimensions::Three }.color(p, w)[2]);
    let sockets =
        GaborSockets { scale: 5.0, frequency: 2.0, anisotropy: 1.0, orientation_2d: 0.785, orientation_3d: Vec3::ONE };
    time("gabor Two", &|p, _| Gabor::Two.value(p, &sockets).value);
    time("gabor Three", &|p, _| Gabor::Three.value(p, &sockets).value);
}
