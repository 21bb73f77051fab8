//! Procedural textures against values that Cycles computed: `reference.py` made the tables in
//! `reference/`, one line an evaluation.

mod extremes;
mod menus;
mod table;

use std::cell::RefCell;
use std::collections::HashMap;

use penumbra::math::Vec3;
use penumbra::texture::procedural::*;
use penumbra::texture::sky::{Atmosphere, AtmosphereSky, Preetham, ToRgb};
use table::{Line, compare, compare_in};

/// Places, sockets and colours are within this of Cycles, relative to 1 or to the value if that is larger.
const TOLERANCE: f32 = 1e-4;

#[test]
fn noise() {
    compare("noise", TOLERANCE, |line| {
        let noise = Noise {
            dimensions: menus::dimensions(line.choice(0)),
            kind: menus::noise_kind(line.choice(1)),
            normalize: line.choice(2) == "True",
        };
        let [x, y, z, w, scale, detail, roughness, lacunarity, offset, gain, distortion] = line.inputs();
        let sockets = NoiseSockets { scale, detail, roughness, lacunarity, offset, gain, distortion };
        let color = noise.color(Vec3::new(x, y, z), w, &sockets);
        assert_eq!(noise.factor(Vec3::new(x, y, z), w, &sockets).to_bits(), color[0].to_bits());
        color.to_vec()
    });
}

fn voronoi(name: &str, scatter: Scatter) {
    compare(name, TOLERANCE, |line| {
        let voronoi = Voronoi {
            dimensions: menus::dimensions(line.choice(0)),
            feature: menus::voronoi_feature(line.choice(1)),
            metric: menus::voronoi_metric(line.choice(2)),
            normalize: line.choice(3) == "True",
            scatter,
        };
        let [x, y, z, w, scale, detail, roughness, lacunarity, smoothness, exponent, randomness] = line.inputs();
        let sockets = VoronoiSockets { scale, detail, roughness, lacunarity, smoothness, exponent, randomness };
        let value = voronoi.value(Vec3::new(x, y, z), w, &sockets);
        assert_eq!(voronoi.distance(Vec3::new(x, y, z), w, &sockets).to_bits(), value.distance.to_bits());
        let mut outputs = vec![value.distance];
        outputs.extend(value.color);
        outputs.extend(value.position.to_array());
        outputs.extend([value.w, value.radius]);
        outputs
    });
}

#[test]
fn voronoi_from_blender_5() {
    voronoi("voronoi", Scatter::Pcg);
}

#[test]
fn voronoi_up_to_blender_4() {
    voronoi("voronoi_4", Scatter::Jenkins);
}

#[test]
fn wave() {
    compare("wave", TOLERANCE, |line| {
        let wave = Wave {
            direction: menus::wave_direction(line.choice(0), line.choice(1)),
            profile: menus::wave_profile(line.choice(2)),
        };
        let [x, y, z, scale, distortion, detail, detail_scale, detail_roughness, phase] = line.inputs();
        let sockets = WaveSockets { scale, distortion, detail, detail_scale, detail_roughness, phase };
        vec![wave.factor(Vec3::new(x, y, z), &sockets)]
    });
}

#[test]
fn checkers() {
    compare("checker", 0.0, |line| {
        let [x, y, z, scale] = line.inputs();
        vec![checker(Vec3::new(x, y, z), scale)]
    });
}

#[test]
fn brick() {
    compare("brick", TOLERANCE, |line| {
        let number = |i| line.choice(i).parse::<f32>().unwrap();
        let brick = Brick {
            offset: number(0),
            offset_frequency: number(1) as u32,
            squash: number(2),
            squash_frequency: number(3) as u32,
        };
        let inputs: [f32; 18] = line.inputs();
        let rgb = |i: usize| [inputs[i], inputs[i + 1], inputs[i + 2]];
        let [scale, mortar_size, mortar_smooth, bias, brick_width, row_height] =
            std::array::from_fn(|i| inputs[12 + i]);
        let sockets = BrickSockets { scale, mortar_size, mortar_smooth, bias, brick_width, row_height };
        let value = brick.value(rgb(0).into(), &sockets);
        let mut outputs = value.color(rgb(3), rgb(6), rgb(9)).to_vec();
        outputs.push(value.mortar);
        outputs
    });
}

#[test]
fn gradient() {
    compare("gradient", TOLERANCE, |line| vec![menus::gradient(line.choice(0)).factor(Vec3::from(line.inputs()))]);
}

#[test]
fn magic() {
    compare("magic", TOLERANCE, |line| {
        let magic = Magic { depth: line.choice(0).parse().unwrap() };
        let [x, y, z, scale, distortion] = line.inputs();
        let at = Vec3::new(x, y, z);
        let mut outputs = magic.color(at, scale, distortion).to_vec();
        outputs.push(magic.factor(at, scale, distortion));
        outputs
    });
}

#[test]
fn white_noise() {
    compare("white_noise", 0.0, |line: &Line| {
        let noise = WhiteNoise { dimensions: menus::dimensions(line.choice(0)) };
        let [x, y, z, w] = line.inputs();
        let color = noise.color(Vec3::new(x, y, z), w);
        vec![noise.value(Vec3::new(x, y, z), w), color[0], color[1], color[2]]
    });
}

#[test]
fn gabor() {
    compare("gabor", TOLERANCE, |line| {
        let gabor = if line.choice(0) == "2D" { Gabor::Two } else { Gabor::Three };
        let [x, y, z, scale, frequency, anisotropy, orientation_2d, ox, oy, oz] = line.inputs();
        let orientation_3d = Vec3::new(ox, oy, oz);
        let sockets = GaborSockets { scale, frequency, anisotropy, orientation_2d, orientation_3d };
        let value = gabor.value(Vec3::new(x, y, z), &sockets);
        vec![value.value, value.phase, value.intensity]
    });
}

/// Radiance of a sky at night.
const DARK: f32 = 1e-3;

/// Skies by their parameters: tables of the same skies share them.
type Skies = HashMap<String, AtmosphereSky>;

fn sky(name: &str, skies: &mut Skies) {
    let skies = RefCell::new(skies);
    compare_in(name, TOLERANCE, DARK, |line| {
        let number = |i| line.choice(i).parse::<f32>().unwrap();
        let sky = Atmosphere {
            scattering: menus::scattering(line.choice(0)),
            sun_elevation: number(2),
            sun_rotation: number(3),
            sun_size: Some(number(4)),
            sun_intensity: number(5),
            altitude: number(6),
            air: number(7),
            aerosol: number(8),
            ozone: number(9),
        };
        let mut skies = skies.borrow_mut();
        let prepared = skies.entry(format!("{sky:?}")).or_insert_with(|| sky.prepare());
        let direction = line.inputs().into();
        let has_disc = line.choice(1) == "True";
        let color = if has_disc { prepared.radiance(direction) } else { prepared.background(direction) };
        vec![color.r, color.g, color.b]
    });
}

#[test]
fn skies_from_blender_5() {
    let mut skies = Skies::new();
    sky("sky", &mut skies);
    sky("sun", &mut skies);
}

#[test]
fn skies_up_to_blender_4() {
    let mut skies = Skies::new();
    sky("sky_4", &mut skies);
    sky("sun_4", &mut skies);
}

fn preetham(name: &str, to_rgb: ToRgb) {
    compare_in(name, TOLERANCE, DARK, |line| {
        let number = |i| line.choice(i).parse::<f32>().unwrap();
        let sun_direction = Vec3::new(number(1), number(2), number(3));
        let sky = Preetham { sun_direction, turbidity: number(4), to_rgb };
        let color = sky.prepare().radiance(line.inputs().into());
        vec![color.r, color.g, color.b]
    });
}

#[test]
fn preetham_from_blender_5() {
    preetham("preetham", ToRgb::Blender5);
}

#[test]
fn preetham_up_to_blender_4() {
    preetham("preetham_4", ToRgb::Blender4);
}
