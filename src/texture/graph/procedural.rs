//! Procedural textures as steps: sockets from values, and back.

use crate::desc::graph::{self as desc, Value, finite};
use crate::math::Vec3;
use crate::texture::procedural as made;

/// The texture for its arguments, in the order in which [`desc::Procedural`] has them.
pub(super) fn eval(texture: &desc::Procedural, args: &[Value]) -> Value {
    let args = Args(args);
    let p = args.vector(0);
    finite(match texture {
        desc::Procedural::Noise(noise) => {
            let sockets = made::NoiseSockets {
                scale: args.number(2),
                detail: args.number(3),
                roughness: args.number(4),
                lacunarity: args.number(5),
                offset: args.number(6),
                gain: args.number(7),
                distortion: args.number(8),
            };
            let (dimensions, kind, normalize) = (dimensions(noise.dimensions), kind(noise.kind), noise.normalize);
            let (texture, w) = (made::Noise { dimensions, kind, normalize }, args.number(1));
            if noise.color {
                let color = texture.color(p, w, &sockets);
                rgb(color, color[0])
            } else {
                splat(texture.factor(p, w, &sockets))
            }
        }
        desc::Procedural::Voronoi(of) => {
            let sockets = made::VoronoiSockets {
                scale: args.number(2),
                detail: args.number(3),
                roughness: args.number(4),
                lacunarity: args.number(5),
                smoothness: args.number(6),
                exponent: args.number(7),
                randomness: args.number(8),
            };
            voronoi(of, p, args.number(1), &sockets)
        }
        desc::Procedural::Wave(wave) => {
            let sockets = made::WaveSockets {
                scale: args.number(1),
                distortion: args.number(2),
                detail: args.number(3),
                detail_scale: args.number(4),
                detail_roughness: args.number(5),
                phase: args.number(6),
            };
            let texture = made::Wave { direction: direction(wave), profile: profile(wave.profile) };
            splat(texture.factor(p, &sockets))
        }
        desc::Procedural::Magic { depth } => {
            let [r, g, b] = made::Magic { depth: *depth }.color(p, args.number(1), args.number(2));
            rgb([r, g, b], (r + g + b) / 3.0)
        }
        desc::Procedural::Brick(brick) => {
            let texture = made::Brick {
                offset: brick.offset as f32,
                offset_frequency: brick.offset_frequency,
                squash: brick.squash as f32,
                squash_frequency: brick.squash_frequency,
            };
            let sockets = made::BrickSockets {
                scale: args.number(4),
                mortar_size: args.number(5),
                mortar_smooth: args.number(6),
                bias: args.number(7),
                brick_width: args.number(8),
                row_height: args.number(9),
            };
            let value = texture.value(p, &sockets);
            rgb(value.color(args.color(1), args.color(2), args.color(3)), value.mortar)
        }
        desc::Procedural::Checker => {
            let first = made::checker(p, args.number(3));
            rgb(if first == 1.0 { args.color(1) } else { args.color(2) }, first)
        }
        desc::Procedural::Gradient(of) => splat(gradient(*of).factor(p)),
        desc::Procedural::WhiteNoise { dimensions: of } => {
            let color = made::WhiteNoise { dimensions: dimensions(*of) }.color(p, args.number(1));
            rgb(color, color[0])
        }
        desc::Procedural::Cell { dimensions } => splat(made::cell(p, *dimensions)),
        desc::Procedural::VectorNoise { dimensions } => {
            let [detail, roughness, lacunarity] = [1, 2, 3].map(|i| args.number(i));
            let noise = match dimensions {
                0..=2 => made::vector_noise([p.x, p.y], detail, roughness, lacunarity),
                _ => made::vector_noise(p.to_array(), detail, roughness, lacunarity),
            };
            rgb(noise, noise[0])
        }
        desc::Procedural::Worley { dimensions, solid } => {
            let found = match dimensions {
                0..=2 => made::worley([p.x, p.y], args.number(1)),
                _ => made::worley(p.to_array(), args.number(1)),
            };
            if *solid { rgb(found.cell, found.number) } else { rgb(found.distances, found.distances[0]) }
        }
        desc::Procedural::Gabor { flat } => {
            let sockets = made::GaborSockets {
                scale: args.number(1),
                frequency: args.number(2),
                anisotropy: args.number(3),
                orientation_2d: args.number(4),
                orientation_3d: args.vector(4),
            };
            let texture = if *flat { made::Gabor::Two } else { made::Gabor::Three };
            let made::GaborValue { value, phase, intensity } = texture.value(p, &sockets);
            rgb([value, phase, intensity], value)
        }
    })
}

struct Args<'a>(&'a [Value]);

impl Args<'_> {
    fn color(&self, i: usize) -> [f32; 3] {
        let [x, y, z, _] = self.0.get(i).copied().unwrap_or_default();
        [x, y, z].map(single)
    }

    fn vector(&self, i: usize) -> Vec3 {
        Vec3::from(self.color(i))
    }

    fn number(&self, i: usize) -> f32 {
        self.0.get(i).map_or(0.0, |value| single(value[0]))
    }
}

/// Within the range of `f32`.
fn single(x: f64) -> f32 {
    x.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32
}

fn splat(x: f32) -> Value {
    [f64::from(x); 4]
}

fn rgb([r, g, b]: [f32; 3], number: f32) -> Value {
    [r, g, b, number].map(f64::from)
}

fn voronoi(of: &desc::Voronoi, p: Vec3, w: f32, sockets: &made::VoronoiSockets) -> Value {
    use made::VoronoiFeature as Made;
    let texture = made::Voronoi {
        dimensions: dimensions(of.dimensions),
        feature: match of.feature {
            desc::VoronoiFeature::F1 => Made::F1,
            desc::VoronoiFeature::F2 => Made::F2,
            desc::VoronoiFeature::SmoothF1 => Made::SmoothF1,
            desc::VoronoiFeature::DistanceToEdge => Made::DistanceToEdge,
            desc::VoronoiFeature::NSphereRadius => Made::NSphereRadius,
        },
        metric: match of.metric {
            desc::Metric::Euclidean => made::VoronoiMetric::Euclidean,
            desc::Metric::Manhattan => made::VoronoiMetric::Manhattan,
            desc::Metric::Chebychev => made::VoronoiMetric::Chebychev,
            desc::Metric::Minkowski => made::VoronoiMetric::Minkowski,
        },
        normalize: of.normalize,
        scatter: match of.scatter {
            desc::Scatter::Jenkins => made::Scatter::Jenkins,
            desc::Scatter::Pcg => made::Scatter::Pcg,
        },
    };
    match (of.feature, of.output) {
        (desc::VoronoiFeature::NSphereRadius, _) => splat(texture.value(p, w, sockets).radius),
        (desc::VoronoiFeature::DistanceToEdge, _) | (_, desc::VoronoiOutput::Distance) => {
            splat(texture.distance(p, w, sockets))
        }
        (_, desc::VoronoiOutput::Color) => {
            let value = texture.value(p, w, sockets);
            rgb(value.color, value.distance)
        }
        (_, desc::VoronoiOutput::Position) => {
            let value = texture.value(p, w, sockets);
            rgb(value.position.to_array(), value.w)
        }
    }
}

fn dimensions(of: u8) -> made::Dimensions {
    match of {
        0 | 1 => made::Dimensions::One,
        2 => made::Dimensions::Two,
        3 => made::Dimensions::Three,
        _ => made::Dimensions::Four,
    }
}

fn kind(of: desc::NoiseKind) -> made::NoiseKind {
    match of {
        desc::NoiseKind::Fbm => made::NoiseKind::Fbm,
        desc::NoiseKind::Multifractal => made::NoiseKind::Multifractal,
        desc::NoiseKind::HybridMultifractal => made::NoiseKind::HybridMultifractal,
        desc::NoiseKind::RidgedMultifractal => made::NoiseKind::RidgedMultifractal,
        desc::NoiseKind::HeteroTerrain => made::NoiseKind::HeteroTerrain,
    }
}

fn direction(of: &desc::Wave) -> made::WaveDirection {
    use made::WaveDirection as Made;
    match (of.rings, of.direction) {
        (false, desc::WaveDirection::X) => Made::BandsX,
        (false, desc::WaveDirection::Y) => Made::BandsY,
        (false, desc::WaveDirection::Z) => Made::BandsZ,
        (false, desc::WaveDirection::Whole) => Made::BandsDiagonal,
        (true, desc::WaveDirection::X) => Made::RingsX,
        (true, desc::WaveDirection::Y) => Made::RingsY,
        (true, desc::WaveDirection::Z) => Made::RingsZ,
        (true, desc::WaveDirection::Whole) => Made::RingsSpherical,
    }
}

fn profile(of: desc::WaveProfile) -> made::WaveProfile {
    match of {
        desc::WaveProfile::Sine => made::WaveProfile::Sine,
        desc::WaveProfile::Saw => made::WaveProfile::Saw,
        desc::WaveProfile::Triangle => made::WaveProfile::Triangle,
    }
}

fn gradient(of: desc::Gradient) -> made::Gradient {
    match of {
        desc::Gradient::Linear => made::Gradient::Linear,
        desc::Gradient::Quadratic => made::Gradient::Quadratic,
        desc::Gradient::Easing => made::Gradient::Easing,
        desc::Gradient::Diagonal => made::Gradient::Diagonal,
        desc::Gradient::Radial => made::Gradient::Radial,
        desc::Gradient::QuadraticSphere => made::Gradient::QuadraticSphere,
        desc::Gradient::Spherical => made::Gradient::Spherical,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sockets reach their places: each changes what it says, and the result is that of the texture itself.
    #[test]
    fn textures_get_their_arguments() {
        let p = [0.3, 0.7, -1.2, 0.0];
        let n = |x: f64| [x; 4];
        let noise = desc::Noise { dimensions: 4, kind: desc::NoiseKind::Fbm, normalize: true, color: true };
        let args = [p, n(0.5), n(3.0), n(2.0), n(0.6), n(2.1), n(0.0), n(1.0), n(0.2)];
        let sockets = made::NoiseSockets {
            scale: 3.0,
            detail: 2.0,
            roughness: 0.6,
            lacunarity: 2.1,
            offset: 0.0,
            gain: 1.0,
            distortion: 0.2,
        };
        let texture = made::Noise { dimensions: made::Dimensions::Four, kind: made::NoiseKind::Fbm, normalize: true };
        let color = texture.color(Vec3::new(0.3, 0.7, -1.2), 0.5, &sockets);
        assert_eq!(eval(&desc::Procedural::Noise(noise), &args), rgb(color, color[0]));
        let number = desc::Procedural::Noise(desc::Noise { color: false, ..noise });
        assert_eq!(eval(&number, &args), splat(color[0]));

        let (red, blue, gray) = ([1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0], [0.5, 0.5, 0.5, 1.0]);
        let checker = |x: f64| eval(&desc::Procedural::Checker, &[[x, 0.25, 0.25, 0.0], red, blue, n(2.0)]);
        assert_eq!([checker(0.25)[0], checker(0.75)[0]].iter().sum::<f64>(), 1.0);
        assert_eq!(checker(0.25)[3], checker(0.25)[0]);
        let brick = desc::Brick { offset: 0.5, offset_frequency: 2, squash: 1.0, squash_frequency: 2 };
        let args = |y: f64| [[0.3, y, 0.0, 0.0], red, red, gray, n(1.0), n(0.02), n(0.0), n(0.0), n(0.5), n(0.25)];
        assert_eq!(eval(&desc::Procedural::Brick(brick), &args(0.125)), [1.0, 0.0, 0.0, 0.0]);
        assert_eq!(eval(&desc::Procedural::Brick(brick), &args(0.251)), [0.5, 0.5, 0.5, 1.0]);
        let gradient = desc::Procedural::Gradient(desc::Gradient::Quadratic);
        assert_eq!(eval(&gradient, &[[0.5, 9.0, 9.0, 9.0]]), n(0.25));
        let wave = desc::Wave { rings: false, direction: desc::WaveDirection::X, profile: desc::WaveProfile::Saw };
        let saw = |x: f64| eval(&desc::Procedural::Wave(wave), &[[x, 0.0, 0.0, 0.0], n(1.0)])[0];
        assert!((saw(0.1) - 20.0 * 0.1 / std::f64::consts::TAU).abs() < 1e-4);
        let magic = eval(&desc::Procedural::Magic { depth: 2 }, &[p, n(5.0), n(1.0)]);
        assert!((magic[3] - (magic[0] + magic[1] + magic[2]) / 3.0).abs() < 1e-6);
        let number = desc::Noise { dimensions: 3, kind: desc::NoiseKind::Fbm, normalize: false, color: false };
        let same = [p, n(0.0), n(1.0), n(2.0), n(0.6), n(2.1), n(0.0), n(0.0), n(0.0)];
        let same = eval(&desc::Procedural::Noise(number), &same);
        let vector = eval(&desc::Procedural::VectorNoise { dimensions: 3 }, &[p, n(2.0), n(0.6), n(2.1)]);
        assert!((vector[0] - same[0]).abs() < 1e-6 && vector[3] == vector[0] && vector[1] != vector[0]);
        let worley = |solid, jitter: f64| {
            let p = [0.25, 0.5, 9.0, 0.0];
            eval(&desc::Procedural::Worley { dimensions: 2, solid }, &[p, n(jitter)])
        };
        assert_eq!([worley(false, 0.0)[0], worley(false, 0.0)[3]], [0.25; 2]);
        assert!(worley(false, 1.0)[0] != 0.25 && worley(true, 0.0)[0] != worley(true, 0.0)[3]);
        let white = eval(&desc::Procedural::WhiteNoise { dimensions: 3 }, &[p, n(0.0)]);
        assert!(white[3] == white[0] && white[1] != white[0]);
    }

    #[test]
    fn voronoi_gives_what_is_asked() {
        let of = |feature, output| {
            let voronoi = desc::Voronoi {
                dimensions: 3,
                feature,
                metric: desc::Metric::Euclidean,
                normalize: false,
                output,
                scatter: desc::Scatter::Pcg,
            };
            let n = |x: f64| [x; 4];
            let args = [[0.3, 0.7, -1.2, 0.0], n(0.0), n(2.0), n(0.0), n(0.5), n(2.0), n(1.0), n(0.5), n(1.0)];
            eval(&desc::Procedural::Voronoi(voronoi), &args)
        };
        let distance = of(desc::VoronoiFeature::F1, desc::VoronoiOutput::Distance);
        let color = of(desc::VoronoiFeature::F1, desc::VoronoiOutput::Color);
        let position = of(desc::VoronoiFeature::F1, desc::VoronoiOutput::Position);
        assert!(distance[0] > 0.0 && distance[0] == color[3] && distance[1] == distance[0]);
        // Distances are in cells, of which there are two to a unit.
        let away = [0.3 - position[0], 0.7 - position[1], -1.2 - position[2]].map(|d| 4.0 * d * d);
        assert!((away.iter().sum::<f64>().sqrt() - distance[0]).abs() < 1e-5, "{position:?} {distance:?}");
        assert!(of(desc::VoronoiFeature::F2, desc::VoronoiOutput::Distance)[0] > distance[0]);
        let edge = of(desc::VoronoiFeature::DistanceToEdge, desc::VoronoiOutput::Color);
        assert!(edge[0] > 0.0 && edge == splat(edge[0] as f32));
        let radius = of(desc::VoronoiFeature::NSphereRadius, desc::VoronoiOutput::Position);
        assert!(radius[0] > 0.0 && radius == splat(radius[0] as f32));
    }

    #[test]
    fn what_leaves_the_range_of_floats_stays_finite() {
        let huge = [1e300, -1e300, 1e39, 0.0];
        for texture in [
            desc::Procedural::Checker,
            desc::Procedural::Magic { depth: 10 },
            desc::Procedural::WhiteNoise { dimensions: 4 },
            desc::Procedural::Gradient(desc::Gradient::Radial),
            desc::Procedural::Gabor { flat: false },
            desc::Procedural::VectorNoise { dimensions: 3 },
            desc::Procedural::Worley { dimensions: 3, solid: false },
        ] {
            let value = eval(&texture, &[huge; 10]);
            assert!(value.iter().all(|x| x.is_finite()), "{texture:?}: {value:?}");
        }
    }
}
