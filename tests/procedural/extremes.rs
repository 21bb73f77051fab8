//! Whatever comes in, every texture answers, in bounded time and without a panic; where the inputs are
//! numbers of ordinary size, so is the answer.

use penumbra::math::Vec3;
use penumbra::texture::procedural::*;
use penumbra::texture::sky::{Atmosphere, Preetham, Scattering, ToRgb};

const ALL: [Dimensions; 4] = [Dimensions::One, Dimensions::Two, Dimensions::Three, Dimensions::Four];

const NUMBERS: [f32; 20] = [
    0.0,
    -0.0,
    0.3,
    -1.0,
    2.0,
    15.5,
    -2.7,
    1e5,
    -1e6,
    1e9,
    -2_147_483_648.0,
    8_388_607.5,
    1e-40,
    1e38,
    f32::MIN,
    f32::MAX,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    f32::EPSILON,
];

/// Draws from a list, the same each time.
struct Draws(u32);

impl Draws {
    fn index(&mut self, of: usize) -> usize {
        self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (self.0 >> 16) as usize % of
    }

    fn of(&mut self, numbers: &[f32]) -> f32 {
        numbers[self.index(numbers.len())]
    }

    fn place(&mut self, numbers: &[f32]) -> Vec3 {
        Vec3::new(self.of(numbers), self.of(numbers), self.of(numbers))
    }
}

/// Every texture with every menu choice at drawn places with drawn sockets.
fn all(rounds: usize, numbers: &[f32]) -> Vec<f32> {
    let mut draws = Draws(7);
    let mut values = Vec::new();
    for _ in 0..rounds {
        noise(&mut draws, numbers, &mut values);
        voronoi(&mut draws, numbers, &mut values);
        others(&mut draws, numbers, &mut values);
    }
    values
}

fn noise(draws: &mut Draws, numbers: &[f32], values: &mut Vec<f32>) {
    for dimensions in ALL {
        let p = draws.place(numbers);
        let mut number = || draws.of(numbers);
        let sockets = NoiseSockets {
            scale: number(),
            detail: number(),
            roughness: number(),
            lacunarity: number(),
            offset: number(),
            gain: number(),
            distortion: number(),
        };
        let w = number();
        for kind in [
            NoiseKind::Fbm,
            NoiseKind::Multifractal,
            NoiseKind::HybridMultifractal,
            NoiseKind::RidgedMultifractal,
            NoiseKind::HeteroTerrain,
        ] {
            values.extend(Noise { dimensions, kind, normalize: true }.color(p, w, &sockets));
        }
        values.extend(WhiteNoise { dimensions }.color(p, w));
    }
}

fn voronoi(draws: &mut Draws, numbers: &[f32], values: &mut Vec<f32>) {
    use VoronoiFeature::{DistanceToEdge, F1, F2, NSphereRadius, SmoothF1};
    use VoronoiMetric::{Chebychev, Euclidean, Manhattan, Minkowski};
    for dimensions in ALL {
        for feature in [F1, F2, SmoothF1, DistanceToEdge, NSphereRadius] {
            for metric in [Euclidean, Manhattan, Chebychev, Minkowski] {
                for scatter in [Scatter::Jenkins, Scatter::Pcg] {
                    let p = draws.place(numbers);
                    let mut number = || draws.of(numbers);
                    let sockets = VoronoiSockets {
                        scale: number(),
                        detail: number().min(2.5),
                        roughness: number(),
                        lacunarity: number(),
                        smoothness: number(),
                        exponent: number(),
                        randomness: number(),
                    };
                    let voronoi = Voronoi { dimensions, feature, metric, normalize: false, scatter };
                    let value = voronoi.value(p, number(), &sockets);
                    values.extend(value.color);
                    values.extend([value.distance, value.radius]);
                }
            }
        }
    }
}

fn others(draws: &mut Draws, numbers: &[f32], values: &mut Vec<f32>) {
    let p = draws.place(numbers);
    let mut number = || draws.of(numbers);
    let sockets = WaveSockets {
        scale: number(),
        distortion: number(),
        detail: number(),
        detail_scale: number(),
        detail_roughness: number().clamp(0.0, 2.0),
        phase: number(),
    };
    for direction in [WaveDirection::BandsDiagonal, WaveDirection::RingsSpherical, WaveDirection::RingsX] {
        for profile in [WaveProfile::Sine, WaveProfile::Saw, WaveProfile::Triangle] {
            values.push(Wave { direction, profile }.factor(p, &sockets));
        }
    }
    values.push(checker(p, number()));
    let brick = Brick {
        offset: number(),
        offset_frequency: number() as u32,
        squash: number(),
        squash_frequency: number() as u32,
    };
    let sockets = BrickSockets {
        scale: number(),
        mortar_size: number(),
        mortar_smooth: number(),
        bias: number(),
        brick_width: number(),
        row_height: number(),
    };
    let value = brick.value(p, &sockets);
    values.extend([value.tint, value.mortar]);
    for gradient in [Gradient::Easing, Gradient::Radial, Gradient::QuadraticSphere] {
        values.push(gradient.factor(p));
    }
    for depth in [0, 10, 255] {
        values.extend(Magic { depth }.color(p, number(), number()));
    }
    let sockets = GaborSockets {
        scale: number(),
        frequency: number(),
        anisotropy: number(),
        orientation_2d: number(),
        orientation_3d: Vec3::new(number(), number(), 1.0),
    };
    for gabor in [Gabor::Two, Gabor::Three] {
        let value = gabor.value(p, &sockets);
        values.extend([value.value, value.phase, value.intensity]);
    }
}

#[test]
fn no_number_makes_a_texture_panic() {
    assert!(!all(400, &NUMBERS).is_empty());
}

#[test]
fn no_number_makes_a_sky_panic() {
    for (scattering, number) in
        [(Scattering::Nishita, f32::NAN), (Scattering::Single, f32::INFINITY), (Scattering::Multiple, -1e9)]
    {
        let sky = Atmosphere {
            scattering,
            sun_elevation: number,
            sun_rotation: number,
            sun_size: Some(number.abs()),
            sun_intensity: number,
            altitude: number,
            air: number,
            aerosol: number,
            ozone: number,
        };
        let sky = sky.prepare();
        let mut draws = Draws(7);
        for _ in 0..100 {
            let direction = draws.place(&NUMBERS);
            let preetham = Preetham { sun_direction: direction, turbidity: number, to_rgb: ToRgb::Blender5 };
            std::hint::black_box((sky.radiance(direction), preetham.prepare().radiance(direction)));
        }
    }
}

#[test]
fn ordinary_numbers_give_numbers() {
    let values = all(100, &[0.1, 0.3, 0.9, 1.0, 1.7, 2.5]);
    let wrong = values.iter().filter(|v| !v.is_finite()).count();
    assert_eq!(wrong, 0, "of {}", values.len());
}
