//! Domes: the density that follows the lookup, what is left to surfaces, the mapping, extremes.

use std::f64::consts::{PI, TAU};

use std::sync::Arc;

use penumbra::light::{Dome, DomeImage, Emitter, Portal, Portals, Receiver};
use penumbra::math::{Bounds, DVec3, Mat3, Rgb, Vec3};
use penumbra::sampling::{Decision, Dimension, Pattern, Sampler};

use crate::laws::{Case, hold, irradiance_holds};
use crate::plane::{self, Pose};

/// An image given by a function of column and row.
struct Image {
    size: [usize; 2],
    texels: Vec<f64>,
}

impl Image {
    fn new(size: [usize; 2], value: impl Fn(usize, usize) -> f64) -> Self {
        Self { size, texels: (0..size[0] * size[1]).map(|i| value(i % size[0], i / size[0])).collect() }
    }

    fn dome(&self, tint: Rgb, orientation: Mat3) -> Dome {
        let texels = self.texels.iter().map(|&v| Rgb::splat(v as f32)).collect();
        Dome::new(tint, DomeImage::new(self.size[0], self.size[1], texels, orientation))
    }

    /// The bilinear lookup in f64: around in u, clamped at the poles.
    fn lookup(&self, u: f64, v: f64) -> f64 {
        let [w, h] = self.size;
        let (x, y) = (u * w as f64 - 0.5, v * h as f64 - 0.5);
        let at = |i: f64, j: f64| {
            let column = (i as i64).rem_euclid(w as i64) as usize;
            self.texels[(j as i64).clamp(0, h as i64 - 1) as usize * w + column]
        };
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let row = |j: f64| at(x.floor(), j) * (1.0 - fx) + at(x.floor() + 1.0, j) * fx;
        row(y.floor()) * (1.0 - fy) + row(y.floor() + 1.0) * fy
    }

    /// Irradiance on a surface of normal `n` by the midpoint rule, texels cut in as many parts as give
    /// 1500 rows and twice as many columns: the error is below 1e-5, most of it at the horizon.
    fn irradiance(&self, orientation: Mat3, n: Vec3) -> f64 {
        let local = (orientation.transpose() * n).as_dvec3();
        let [columns, rows] =
            [(0, 3000), (1, 1500)].map(|(i, fewest): (usize, usize)| self.size[i] * fewest.div_ceil(self.size[i]));
        let mut sum = 0.0;
        for j in 0..rows {
            let v = (j as f64 + 0.5) / rows as f64;
            let (sin, cos) = (PI * v).sin_cos();
            for i in 0..columns {
                let u = (i as f64 + 0.5) / columns as f64;
                let (sin_phi, cos_phi) = (TAU * (u - 0.5)).sin_cos();
                let received = local.dot(DVec3::new(sin * cos_phi, cos, sin * sin_phi));
                if received > 0.0 {
                    sum += self.lookup(u, v) * received * sin;
                }
            }
        }
        sum * 2.0 * PI * PI / (rows * columns) as f64
    }
}

fn turned() -> Mat3 {
    Mat3::from_axis_angle(Vec3::new(0.48, 0.6, -0.64), 1.1)
}

fn case(name: &str, image: &Image, orientation: Mat3, n: Vec3) -> Case {
    let irradiance = image.irradiance(orientation, n);
    Case::new(format!("{name} on {n}"), image.dome(Rgb::WHITE, orientation), Vec3::ZERO, n, irradiance)
}

/// A value in [0, 1) for each texel.
fn noise(x: usize, y: usize) -> f64 {
    ((x * 7919 + y * 104_729 + x * y * 31) % 1009) as f64 / 1009.0
}

fn gradient(x: usize, y: usize) -> f64 {
    0.1 + x as f64 + 2.0 * y as f64
}

#[test]
fn constant_domes_hold_the_laws() {
    let n = Vec3::new(0.48, 0.6, -0.64);
    let image = Image::new([64, 32], |_, _| 0.5);
    hold(&[
        Case::new("constant", Dome::new(Rgb::splat(0.5), None), Vec3::ZERO, n, 0.5 * PI),
        Case::new("constant image", image.dome(Rgb::splat(2.0), turned()), Vec3::ZERO, n, PI),
        Case::new("one texel", Image::new([1, 1], |_, _| 0.5).dome(Rgb::WHITE, turned()), Vec3::ZERO, n, 0.5 * PI),
    ]);
}

#[test]
fn images_hold_the_laws() {
    let n = Vec3::new(0.48, 0.6, -0.64);
    let sky = |x: usize, y: usize| if y < 12 { 0.3 + 0.02 * x as f64 } else { 0.0 };
    let sun = |x: usize, y: usize| if (20..22).contains(&x) && (6..8).contains(&y) { 4000.0 } else { sky(x, y) };
    let images = [
        ("half black", Image::new([64, 32], |x, _| if x < 32 { 1.0 } else { 0.0 })),
        ("black below", Image::new([64, 32], sky)),
        ("noise", Image::new([16, 8], noise)),
        ("two rows", Image::new([5, 2], gradient)),
        ("a column", Image::new([1, 7], gradient)),
        ("a row", Image::new([6, 1], gradient)),
        ("two texels", Image::new([2, 1], gradient)),
        ("a texel among black", Image::new([3, 3], |x, y| f64::from(u8::from(x == 1 && y == 1)))),
        ("a bright pole", Image::new([8, 8], |_, y| if y == 0 { 50.0 } else { 0.1 })),
        ("a dark pole", Image::new([8, 8], |_, y| if y == 7 { 0.0 } else { 1.0 })),
        ("a sun", Image::new([64, 32], sun)),
        ("a seam", Image::new([32, 16], |x, _| if x == 0 { 30.0 } else { 0.2 })),
    ];
    let mut cases = Vec::new();
    for (name, image) in &images {
        cases.push(case(name, image, Mat3::IDENTITY, Vec3::Y));
        cases.push(case(name, image, turned(), n));
    }
    hold(&cases);
}

/// `dome`, guided by openings with these half sizes.
fn guided(mut dome: Dome, openings: &[(&Pose, [f64; 2])]) -> Dome {
    let portal = |&(pose, half): &(&Pose, [f64; 2])| Portal { center: pose.center, axes: pose.axes, half };
    dome.guide(Arc::new(Portals::new(openings.iter().map(portal).collect())));
    dome
}

/// Portals change where a dome is sampled, and nothing of what it gives: one and two, near, far, overlapping, below
/// the horizon, and those that are seen from behind.
#[test]
fn guided_domes_hold_the_laws() {
    let n = Vec3::new(0.48, 0.6, -0.64);
    let above = Pose::down(DVec3::new(0.3, 1.0, -0.5));
    let far = Pose::down(DVec3::new(-20.0, 90.0, 10.0));
    let below = Pose::down(DVec3::new(-1.0, 0.5, 3.0));
    let behind = Pose::down(DVec3::new(0.0, -1.0, 0.0));
    let mut cases = Vec::new();
    for (name, openings) in [
        ("near", vec![(&above, [0.5, 0.8])]),
        ("far", vec![(&far, [0.5, 0.25])]),
        ("overlapping", vec![(&above, [0.5, 0.8]), (&far, [20.0, 9.0])]),
        ("half below", vec![(&below, [4.0, 3.0]), (&above, [0.1, 0.1])]),
        ("behind", vec![(&behind, [1.0, 1.0])]),
    ] {
        let constant = guided(Dome::new(Rgb::splat(0.5), None), &openings);
        cases.push(Case::new(format!("constant, {name}"), constant, Vec3::ZERO, n, 0.5 * PI));
        let image = Image::new([16, 8], noise);
        let noisy = guided(image.dome(Rgb::WHITE, turned()), &openings);
        cases.push(Case::new(format!("noise, {name}"), noisy, Vec3::ZERO, n, image.irradiance(turned(), n)));
    }
    hold(&cases);
}

/// A room with one window: what comes through is known in closed form, and found with less noise.
#[test]
fn portals_find_the_light_of_a_room() {
    let window = Pose::down(DVec3::new(0.4, 2.0, 0.3));
    let half = [0.2, 0.15];
    let closed = plane::irradiance(&window.corners(half), Vec3::ZERO, Vec3::Y);
    let image = Image::new([64, 32], |_, _| 1.0);
    for (name, dome) in [("constant", Dome::new(Rgb::WHITE, None)), ("image", image.dome(Rgb::WHITE, turned()))] {
        let at = Receiver { n: Some(Vec3::Y), alone: true, ..Receiver::everywhere(Vec3::ZERO) };
        let estimate = |dome: &Dome| {
            let (mut sum, mut squares) = (0.0, 0.0);
            let n = 1 << 14;
            for i in 0..n {
                let sampler = Sampler::new(Pattern::Independent, 1).for_sample(0, 0, i);
                let uc = sampler.get_1d(Dimension::at_bounce(0, Decision::LightChoice));
                let sample = dome.sample_li(&at, uc, sampler.get_2d(Dimension::at_bounce(0, Decision::LightPoint)));
                let through = sample.filter(|s| {
                    let q = s.wi * (2.0 / s.wi.y);
                    s.wi.y > 0.0 && (q.x - 0.4).abs() < 0.2 && (q.z - 0.3).abs() < 0.15
                });
                let value = through.map_or(0.0, |s| f64::from(s.li.luminance() * s.wi.y / s.pdf));
                (sum, squares) = (sum + value, squares + value * value);
            }
            let mean = sum / n as f64;
            (mean, squares / n as f64 - mean * mean)
        };
        let (plain_mean, plain) = estimate(&dome);
        let (mean, variance) = estimate(&guided(dome, &[(&window, half)]));
        println!("{name}: {closed} in closed form, {plain_mean} and {mean}; variance {plain} and {variance}");
        let off = |mean: f64, variance: f64| (mean - closed).abs() / (variance / f64::from(1 << 14)).sqrt();
        assert!(off(plain_mean, plain) < 4.0 && off(mean, variance) < 4.0, "{name}: {plain_mean} {mean} {closed}");
        assert!(variance < 0.05 * plain, "{name}: {variance} {plain}");
    }
}

/// One texel of 1e2 to 1e8 above 1e-3 all around, `E = Σ L ½ (sin² θ₁ − sin² θ₀) Δφ` facing up.
#[test]
fn one_bright_texel_keeps_its_energy() {
    let [w, h] = [256, 128];
    let mut cases = Vec::new();
    for exponent in 2..=8 {
        for (x, y) in [(100, 30), (255, 1), (0, 60)] {
            let sun = 10.0_f64.powi(exponent);
            let image = Image::new([w, h], |i, j| if (i, j) == (x, y) { sun } else { 1e-3 });
            let square = |j: usize| (PI * j as f64 / h as f64).sin().powi(2);
            let sum = |j: usize| 0.5 * (square(j + 1) - square(j)) * TAU / w as f64;
            let closed = 1e-3 * PI + (sun - 1e-3) * sum(y);
            let name = format!("1e{exponent} at {x}, {y}");
            let case = case(&name, &image, Mat3::IDENTITY, Vec3::Y);
            // The lookup spreads the texel over its neighbours: a part in a thousand, near a pole more.
            let spread = if y == 1 { 0.12 } else { 1e-3 };
            assert!((case.irradiance / closed - 1.0).abs() < spread, "{name}: {} {closed}", case.irradiance);
            cases.push(Case { irradiance: if y == 1 { case.irradiance } else { closed }, ..case.clone() });
        }
        // From behind, where only the faint rest arrives.
        let image = Image::new([w, h], |i, j| if (i, j) == (100, 30) { 10.0_f64.powi(exponent) } else { 1e-3 });
        cases.push(case(&format!("1e{exponent} behind"), &image, Mat3::IDENTITY, Vec3::NEG_Y));
    }
    irradiance_holds(&cases);
}

#[test]
fn what_surfaces_find_better_is_left_to_them() {
    let at = Receiver { n: Some(Vec3::Y), ..Receiver::everywhere(Vec3::ZERO) };
    let constant = Image::new([64, 32], |_, _| 0.7);
    for dome in [Dome::new(Rgb::WHITE, None), constant.dome(Rgb::WHITE, turned())] {
        for i in 0..100 {
            let u = [(i as f32 * 0.618_034).fract(), (i as f32 * 0.754_877).fract()];
            assert!(dome.sample_li(&at, 0.5, u).is_none());
        }
        assert_eq!((dome.pdf_li(&at, Vec3::Y, None), dome.importance(&at)), (0.0, 0.0));
        assert!(dome.power(Bounds { min: Vec3::ZERO, max: Vec3::ONE }) > 0.0);
        let alone = Receiver { alone: true, ..at };
        assert!(dome.pdf_li(&alone, Vec3::Y, None) > 0.0 && dome.importance(&alone) > 0.0);
    }
    // Only what is brighter than the mean is sampled.
    let half = Image::new([64, 32], |_, y| if y < 16 { 1.0 } else { 0.9 }).dome(Rgb::WHITE, Mat3::IDENTITY);
    assert!(half.pdf_li(&at, Vec3::Y, None) > 0.0);
    assert_eq!(half.pdf_li(&at, Vec3::NEG_Y, None), 0.0);
}

/// Light in one channel alone, of any colour of the dome, is found as well as white light.
#[test]
fn every_channel_is_sampled() {
    for channel in 0..3 {
        let texel = |i: usize| {
            let mut rgb = [0.01_f32; 3];
            if (i % 64, i / 64) == (10, 8) {
                rgb[channel] = 1e4;
            }
            Rgb::from(rgb)
        };
        let bright = DomeImage::new(64, 32, (0..64 * 32).map(texel).collect(), Mat3::IDENTITY);
        let dome = Dome::new(Rgb::WHITE, bright);
        for alone in [false, true] {
            let at = Receiver { n: Some(Vec3::Y), alone, ..Receiver::everywhere(Vec3::ZERO) };
            let sampler = Sampler::new(Pattern::Sobol, 1);
            let n = 1024;
            let found = (0..n).filter(|&i| {
                let s = dome.sample_li(&at, 0.5, sampler.for_sample(0, 0, i).get_2d(Dimension::FREE)).unwrap();
                s.li[channel] > 1.0
            });
            let share = found.count() as f64 / n as f64;
            assert!(share > if alone { 0.2 } else { 0.99 }, "channel {channel}: {share}");
        }
    }
}

#[test]
fn importance_is_what_light_sampling_brings() {
    let size = [256, 128];
    let sun = Image::new(size, |x, y| if (x, y) == (64, 32) { 1e5 } else { 0.1 });
    let dome = sun.dome(Rgb::new(2.0, 1.0, 0.0), turned());
    let factor = f64::from(Rgb::new(2.0, 1.0, 0.0).luminance());
    let black_sky = Image::new(size, |x, y| if (x, y) == (64, 32) { 1e5 } else { 0.0 });
    // The texel's centre.
    let (theta, phi) = (PI * 32.5 / 128.0, TAU * (64.5 / 256.0 - 0.5));
    let to_sun = turned() * DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()).as_vec3();
    for i in 0..12 {
        let n = Mat3::from_axis_angle(to_sun.any_orthonormal_vector(), PI as f32 * i as f32 / 12.0) * to_sun;
        let at = Receiver { n: Some(n), ..Receiver::everywhere(Vec3::ZERO) };
        let bright = factor * black_sky.irradiance(turned(), n);
        let all = factor * sun.irradiance(turned(), n);
        let largest = factor * black_sky.irradiance(turned(), to_sun);
        // A bound: parts of the image and cells of the map are within 0.2 radians of their middles.
        let found = f64::from(dome.importance(&at));
        assert!(found >= 0.999 * bright && found < 1.02 * bright + 0.25 * largest, "{i}: {found} for {bright}");
        let found = f64::from(dome.importance(&Receiver { alone: true, ..at }));
        assert!(found >= 0.999 * all && found < 1.25 * all + 0.25 * largest, "{i}: {found} for {all}");
        // Well below the horizon, samples go to other lights.
        assert!(i < 9 || dome.importance(&at) == 0.0, "{i}: {}", dome.importance(&at));
    }
}

#[test]
fn is_turned_as_cycles_turns_it() {
    // One bright column at the image's centre: +x without rotation, −z after 90 degrees about +y.
    let middle = Image::new([64, 32], |x, _| f64::from(u8::from((31..33).contains(&x))));
    for (degrees, direction) in [(0.0_f32, Vec3::X), (90.0, Vec3::NEG_Z), (180.0, Vec3::NEG_X), (270.0, Vec3::Z)] {
        let dome = middle.dome(Rgb::WHITE, Mat3::from_rotation_y(degrees.to_radians()));
        assert!(dome.le(direction, None).r > 0.99, "{degrees}: {:?}", dome.le(direction, None));
        assert_eq!(dome.le(-direction, None).r, 0.0);
    }
    // A quarter of the image to the right is +z: seen from above, u grows clockwise.
    let right = Image::new([64, 32], |x, _| f64::from(u8::from((47..49).contains(&x))));
    assert!(right.dome(Rgb::WHITE, Mat3::IDENTITY).le(Vec3::Z, None).r > 0.99);
    // The top row is up.
    let top = Image::new([64, 32], |_, y| f64::from(u8::from(y == 0)));
    assert_eq!(top.dome(Rgb::WHITE, Mat3::IDENTITY).le(Vec3::Y, None).r, 1.0);
}

#[test]
fn poles_and_axes_are_like_any_other_direction() {
    let zeros = [0.0_f32, -0.0, 1e-45, -1e-45, 1e-30, -1e-30, 1e-9, -1e-9];
    for image in [
        Image::new([64, 32], |x, y| 1.0 + noise(x, y)),
        Image::new([1, 1], |_, _| 2.0),
        Image::new([8, 1], gradient),
        Image::new([1, 2], gradient),
        Image::new([7, 7], |_, y| if y == 0 || y == 6 { 100.0 } else { 0.1 }),
    ] {
        let dome = image.dome(Rgb::WHITE, Mat3::IDENTITY);
        let least = image.texels.iter().copied().fold(f64::INFINITY, f64::min);
        for alone in [false, true] {
            let at = Receiver { alone, ..Receiver::everywhere(Vec3::ZERO) };
            for axis in 0..3 {
                for sign in [-1.0, 1.0] {
                    for a in zeros {
                        for b in zeros {
                            let mut w = [a, b, a];
                            w[axis] = sign;
                            w[(axis + 2) % 3] = b;
                            let w = Vec3::from(w);
                            let (le, pdf) = (dome.le(w, None).r, dome.pdf_li(&at, w, None));
                            assert!(f64::from(le) >= least * 0.999 && le.is_finite(), "{w}: {le}");
                            assert!(pdf.is_finite() && pdf >= 0.0 && (!alone || pdf > 0.0), "{w}: {pdf}");
                            // The same as a little beside, save for the columns that meet at a pole.
                            if axis != 1 {
                                let beside = (w + Vec3::splat(1e-6)).normalize();
                                let other = dome.pdf_li(&at, beside, None);
                                assert!((pdf - other).abs() <= 1e-3 * other + 1e-5, "{w}: {pdf} {other}");
                            }
                        }
                    }
                }
            }
        }
    }
    // A bright row at a pole has a density there that is no less than beside it.
    let caps = Image::new([7, 7], |_, y| if y == 0 || y == 6 { 100.0 } else { 0.1 }).dome(Rgb::WHITE, Mat3::IDENTITY);
    let at = Receiver::everywhere(Vec3::ZERO);
    for pole in [Vec3::Y, Vec3::NEG_Y] {
        let (there, beside) =
            (caps.pdf_li(&at, pole, None), caps.pdf_li(&at, (pole + 1e-3 * Vec3::X).normalize(), None));
        assert!((there / beside - 1.0).abs() < 1e-3, "{there} {beside}");
    }
}

#[test]
fn samples_of_all_random_numbers_are_sane() {
    let sun = Image::new([64, 32], |x, y| if (x, y) == (16, 0) { 1e8 } else { 1e-3 * noise(x, y) });
    let dome = sun.dome(Rgb::WHITE, turned());
    let last = 1.0 - 2.0_f32.powi(-24);
    let edge = [0.0, 2.0_f32.powi(-24), 0.25 - 2.0_f32.powi(-24), 0.25, 0.5, 0.75 - 2.0_f32.powi(-24), 0.75, last];
    for alone in [false, true] {
        for n in [None, Some(Vec3::Y)] {
            let at = Receiver { n, alone, ..Receiver::everywhere(Vec3::ZERO) };
            for u in edge {
                for v in edge {
                    for uc in [0.0, last] {
                        if let Some(s) = dome.sample_li(&at, uc, [u, v]) {
                            let unit = (s.wi.length() - 1.0).abs() < 1e-5;
                            assert!(unit && s.pdf > 0.0 && s.pdf.is_finite() && s.li.is_finite(), "{u} {v}: {s:?}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn a_black_image_is_no_light() {
    assert!(DomeImage::new(4, 2, vec![Rgb::BLACK; 8], Mat3::IDENTITY).is_none());
    assert!(DomeImage::new(0, 0, vec![], Mat3::IDENTITY).is_none());
}

/// A large image is sampled as exactly as a small one.
#[test]
fn large_images_work() {
    let [w, h] = [8192, 4096];
    let texels = (0..w * h).map(|i| Rgb::splat(if (i % w, i / w) == (5000, 1000) { 1e6 } else { 0.5 })).collect();
    let dome = Dome::new(Rgb::WHITE, DomeImage::new(w, h, texels, Mat3::IDENTITY));
    let theta = PI * 1000.5 / h as f64;
    let sun = 1e6 * theta.sin() * 2.0 * PI * PI / (w * h) as f64;
    irradiance_holds(&[Case::new("8k", dome, Vec3::ZERO, Vec3::Y, 0.5 * PI + sun * theta.cos())]);
}
