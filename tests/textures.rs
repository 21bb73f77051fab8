//! Texture lookups against closed forms.

use std::sync::Arc;

use half::f16;
use penumbra::desc::{Blending, ColorSpace, Filter, ImageDesc, PixelData, TextureDesc, Wrap};
use penumbra::error::{Place, Warnings};
use penumbra::texture::{Image, Texture};

const WRAPS: [Wrap; 4] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Black];

fn desc(size: [u32; 2], channels: u8, color_space: ColorSpace, pixels: PixelData) -> ImageDesc {
    let place = Place::file("a.glb").at("image 0");
    let ([width, height], blending) = (size, Blending::default());
    ImageDesc { name: "wood".into(), place, width, height, channels, color_space, blending, pixels }
}

fn image(size: [u32; 2], channels: u8, color_space: ColorSpace, pixels: PixelData) -> Arc<Image> {
    let mut warnings = Warnings::new();
    let image = Image::new(desc(size, channels, color_space, pixels), &mut warnings).expect("a sound image");
    assert!(warnings.is_empty());
    Arc::new(image)
}

fn texture(image: &Arc<Image>, wrap: [Wrap; 2], filter: Filter) -> Texture {
    let [wrap_u, wrap_v] = wrap;
    Texture::new(image.clone(), &TextureDesc { place: Place::default(), image: 0, wrap_u, wrap_v, filter })
}

fn linear(image: &Arc<Image>, wrap: Wrap) -> Texture {
    texture(image, [wrap, wrap], Filter::Linear)
}

/// Numbers from 0 to 1, the same in every run.
fn noise(n: usize) -> Vec<f32> {
    let mut state = 12_345_u32;
    let mut next = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    (0..n).map(|_| next()).collect()
}

/// A float image of one channel, its wrap modes resolved by definition and blended in f64.
fn analytic(values: &[f32], size: [u32; 2], wrap: [Wrap; 2], uv: [f32; 2]) -> f64 {
    let fetch = |i: i64, j: i64| {
        let resolve = |i: i64, n: i64, wrap: Wrap| match wrap {
            Wrap::Repeat => Some(i.rem_euclid(n)),
            Wrap::Mirror => Some(if i.rem_euclid(2 * n) < n { i.rem_euclid(n) } else { n - 1 - i.rem_euclid(n) }),
            Wrap::Clamp => Some(i.clamp(0, n - 1)),
            Wrap::Black => (0..n).contains(&i).then_some(i),
        };
        let (x, y) = (resolve(i, size[0].into(), wrap[0]), resolve(j, size[1].into(), wrap[1]));
        x.zip(y).map_or(0.0, |(x, y)| f64::from(values[(y * i64::from(size[0]) + x) as usize]))
    };
    let s = [0, 1].map(|k| f64::from(uv[k]) * f64::from(size[k]) - 0.5);
    let (i, j) = (s[0].floor() as i64, s[1].floor() as i64);
    let (tx, ty) = (s[0] - s[0].floor(), s[1] - s[1].floor());
    let row = |j| fetch(i, j) * (1.0 - tx) + fetch(i + 1, j) * tx;
    row(j) * (1.0 - ty) + row(j + 1) * ty
}

#[test]
fn bilinear_lookups_are_the_definition_for_every_wrap_and_size() {
    let points = noise(400);
    for size in [[1, 1], [1, 7], [7, 1], [5, 3], [8, 8], [3, 16]] {
        let values = noise((size[0] * size[1]) as usize);
        let image = image(size, 1, ColorSpace::Linear, PixelData::F32(values.clone()));
        for wrap_u in WRAPS {
            for wrap_v in WRAPS {
                let texture = texture(&image, [wrap_u, wrap_v], Filter::Linear);
                for point in points.chunks_exact(2) {
                    let uv = [point[0] * 7.0 - 3.0, point[1] * 7.0 - 3.0];
                    let expected = analytic(&values, size, [wrap_u, wrap_v], uv);
                    for footprint in [0.0, 0.5 / 16.0, -1.0, f32::NAN] {
                        let [r, g, b, _] = texture.lookup(uv, footprint);
                        assert!(r == g && g == b);
                        // uv of magnitude 4 are off by 2⁻²², times 16 texels, times a slope of 1.
                        let error = (f64::from(r) - expected).abs();
                        assert!(error < 2e-5, "{size:?} {wrap_u:?} {wrap_v:?} {uv:?}: {r} is not {expected}");
                    }
                }
            }
        }
    }
}

#[test]
fn texel_centers_give_the_texel_and_v_runs_down() {
    let values = noise(15);
    let image = image([5, 3], 1, ColorSpace::Linear, PixelData::F32(values.clone()));
    for wrap in WRAPS {
        for filter in [Filter::Linear, Filter::Nearest] {
            let texture = texture(&image, [wrap, wrap], filter);
            for (i, value) in values.iter().enumerate() {
                let uv = [(i % 5) as f32 / 5.0 + 0.1, (i / 5) as f32 / 3.0 + 1.0 / 6.0];
                assert!((texture.lookup(uv, 0.0)[0] - value).abs() < 1e-6, "{wrap:?} {filter:?} {i}");
            }
        }
    }
}

#[test]
fn nearest_is_the_texel_that_holds_the_point() {
    let values = [0.0, 0.25, 0.5, 0.75];
    let image = image([4, 1], 1, ColorSpace::Linear, PixelData::F32(values.to_vec()));
    let at = |wrap, u| texture(&image, [wrap, Wrap::Repeat], Filter::Nearest).lookup([u, 0.3], 0.9)[0];
    assert_eq!([0.0, 0.24, 0.26, 0.99].map(|u| at(Wrap::Repeat, u)), [0.0, 0.0, 0.25, 0.75]);
    assert_eq!([-0.01, 1.01, 1.3, -0.3].map(|u| at(Wrap::Repeat, u)), [0.75, 0.0, 0.25, 0.5]);
    assert_eq!([-0.01, 1.01, 1.3, -0.3].map(|u| at(Wrap::Mirror, u)), [0.0, 0.75, 0.5, 0.25]);
    assert_eq!([-0.01, 1.0, 7.0].map(|u| at(Wrap::Clamp, u)), [0.0, 0.75, 0.75]);
    assert_eq!([-0.01, 0.99, 1.0, 7.0].map(|u| at(Wrap::Black, u)), [0.0, 0.75, 0.0, 0.0]);
}

#[test]
fn every_storage_gives_the_same_picture() {
    // Multiples of 1/255 are exact in 8 bit and, times 257, in 16 bit.
    for channels in 1..=4_u8 {
        for space in [ColorSpace::Srgb, ColorSpace::Linear] {
            let codes: Vec<u8> =
                noise(11 * 6 * usize::from(channels)).iter().map(|value| (value * 255.0) as u8).collect();
            let float = || codes.iter().map(|&code| f32::from(code) / 255.0);
            let size = [11, 6];
            let images = [
                PixelData::U8(codes.clone()),
                PixelData::U16(codes.iter().map(|&code| u16::from(code) * 257).collect()),
                PixelData::F32(float().collect()),
                PixelData::F16(float().map(f16::from_f32).collect()),
            ]
            .map(|pixels| linear(&image(size, channels, space, pixels), Wrap::Repeat));
            for point in noise(200).chunks_exact(2) {
                let reference = images[2].lookup([point[0], point[1]], 0.0);
                for (texture, bound) in [(&images[0], 1e-6), (&images[1], 1e-6), (&images[3], 2e-3)] {
                    let value = texture.lookup([point[0], point[1]], 0.0);
                    for i in 0..4 {
                        assert!(
                            (value[i] - reference[i]).abs() <= bound,
                            "{channels} {space:?}: {value:?} {reference:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn channels_expand_to_rgba() {
    let one = |channels, values: &[u8]| {
        let image = image([1, 1], channels, ColorSpace::Linear, PixelData::U8(values.to_vec()));
        linear(&image, Wrap::Repeat).lookup([0.3, 0.4], 0.0)
    };
    assert_eq!(one(1, &[51]), [0.2, 0.2, 0.2, 1.0]);
    assert_eq!(one(2, &[51, 0]), [0.2, 0.2, 0.2, 0.0]);
    assert_eq!(one(3, &[51, 102, 255]), [0.2, 0.4, 1.0, 1.0]);
    assert_eq!(one(4, &[51, 102, 255, 51]), [0.2, 0.4, 1.0, 0.2]);
    // Alpha carries no transfer function.
    let image = image([1, 1], 4, ColorSpace::Srgb, PixelData::U8(vec![128; 4]));
    let [r, _, _, a] = linear(&image, Wrap::Repeat).lookup([0.0, 0.0], 0.0);
    assert!((r - 0.215_860_5).abs() < 1e-7 && (a - 128.0 / 255.0).abs() < 1e-7);
}

#[test]
fn srgb_codes_come_out_exactly() {
    let codes: Vec<u8> = (0..=255).collect();
    let image = image([256, 1], 1, ColorSpace::Srgb, PixelData::U8(codes));
    for code in 0..256_u32 {
        let encoded = f64::from(code) / 255.0;
        let expected = if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) };
        assert_eq!(image.texel(code, 0)[0], expected as f32);
    }
}

#[test]
fn a_checker_averages_to_its_linear_mean() {
    let texel = |i: usize| if (i % 16 + i / 16).is_multiple_of(2) { 255 } else { 0 };
    let image = image([16, 16], 1, ColorSpace::Srgb, PixelData::U8((0..256).map(texel).collect()));
    let texture = linear(&image, Wrap::Repeat);
    // Not 0.214, the linear value of the mean code. The stored code 188 is 0.5029.
    for footprint in [2.0 / 16.0, 0.5, 1.0, 100.0, f32::INFINITY] {
        let value = texture.lookup([0.37, 0.71], footprint)[0];
        assert!((value - 0.502_886_5).abs() < 1e-6, "{footprint}: {value}");
    }
}

#[test]
fn every_level_keeps_the_mean() {
    for size in [[64, 64], [5, 3], [1, 31], [37, 100], [255, 2]] {
        for channels in 1..=4_u8 {
            let n = usize::from(channels);
            let values = noise((size[0] * size[1]) as usize * n);
            let codes8: Vec<u8> = values.iter().map(|value| (value * 255.0) as u8).collect();
            let codes16: Vec<u16> = values.iter().map(|value| (value * 65535.0) as u16).collect();
            let halves: Vec<f16> = values.iter().copied().map(f16::from_f32).collect();
            // Bound: half a step of the storage; of sRGB codes, times the steepest slope of 2.28.
            let cases = [
                (PixelData::F32(values), ColorSpace::Linear, 1e-6),
                (PixelData::F16(halves), ColorSpace::Linear, 2.5e-4),
                (PixelData::U16(codes16), ColorSpace::Linear, 0.5 / 65535.0 + 1e-6),
                (PixelData::U8(codes8.clone()), ColorSpace::Linear, 0.5 / 255.0 + 1e-6),
                (PixelData::U8(codes8), ColorSpace::Srgb, 2.28 * 0.5 / 255.0 + 1e-6),
            ];
            for (pixels, space, bound) in cases {
                let image = image(size, channels, space, pixels);
                let mean = |level: usize| -> [f64; 4] {
                    let [width, height] = image.level_size(level);
                    let mut sum = [0.0; 4];
                    for i in 0..width * height {
                        for (sum, value) in sum.iter_mut().zip(image.level_texel(level, i % width, i / width)) {
                            *sum += f64::from(value) / f64::from(width * height);
                        }
                    }
                    sum
                };
                let finest = mean(0);
                assert_eq!(image.level_size(image.level_count() - 1), [1, 1]);
                for level in 1..image.level_count() {
                    for (value, finest) in mean(level).into_iter().zip(finest) {
                        let error = (value - finest).abs();
                        assert!(error <= bound, "{size:?} {channels} {space:?} level {level}: off by {error}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_gradient_stays_a_gradient_at_every_level() {
    // The mean of a linear function over a texel is its value at the centre.
    let (n, slope) = (64_u32, 1.0 / 64.0);
    let values = (0..n * n).map(|i| ((i % n) as f32 + 0.5) * slope).collect();
    let image = image([n, n], 1, ColorSpace::Linear, PixelData::F32(values));
    let texture = linear(&image, Wrap::Clamp);
    for footprint in [0.0, 1.0 / 64.0, 1.7 / 64.0, 2.0 / 64.0, 0.1, 0.2] {
        for u in [0.3, 0.41, 0.5, 0.66] {
            let value = texture.lookup([u, 0.5], footprint)[0];
            assert!((value - u).abs() < 1e-5, "{footprint} {u}: {value}");
        }
    }
}

#[test]
fn levels_blend_linearly_with_the_logarithm_of_the_footprint() {
    let image = image([8, 8], 1, ColorSpace::Linear, PixelData::F32(noise(64)));
    let texture = linear(&image, Wrap::Repeat);
    let at = |lod: f32| f64::from(texture.lookup([0.61, 0.27], lod.exp2() / 8.0)[0]);
    for level in 0..3 {
        let (a, b) = (at(level as f32), at(level as f32 + 1.0));
        assert!((at(level as f32 + 0.25) - (0.75 * a + 0.25 * b)).abs() < 1e-6);
    }
    assert_eq!(at(3.0), at(9.0));
}

#[test]
fn equal_alpha_stays_exact_under_every_blend() {
    let mut codes: Vec<u8> = noise(33 * 17 * 4).iter().map(|value| (value * 255.0) as u8).collect();
    codes.iter_mut().skip(3).step_by(4).for_each(|alpha| *alpha = 255);
    let texture = linear(&image([33, 17], 4, ColorSpace::Srgb, PixelData::U8(codes)), Wrap::Mirror);
    for point in noise(3000).chunks_exact(3) {
        assert_eq!(texture.lookup([point[0] * 9.0, point[1] * 9.0], point[2])[3], 1.0);
    }
}

#[test]
fn constant_images_are_known_and_small() {
    for space in [ColorSpace::Srgb, ColorSpace::Linear] {
        let codes = [10, 200, 30].repeat(300 * 200);
        let image = image([300, 200], 3, space, PixelData::U8(codes));
        let constant = image.constant().expect("all texels are equal");
        assert!(image.bytes() < 100, "{}", image.bytes());
        assert_eq!((image.width(), image.height()), (300, 200));
        for wrap in WRAPS {
            let texture = linear(&image, wrap);
            assert_eq!(texture.constant(), (wrap != Wrap::Black).then_some(constant));
            // Wider footprints reach beyond the image, where black may lie.
            for footprint in [0.0, 0.01, if wrap == Wrap::Black { 0.1 } else { 3.0 }] {
                assert_eq!(texture.lookup([0.4, 0.5], footprint), constant, "{wrap:?}");
            }
        }
        // Far outside nothing; at the edge half, since the texel beyond is transparent black.
        let texture = linear(&image, Wrap::Black);
        assert_eq!(texture.lookup([2.5, 0.5], 0.0), [0.0; 4]);
        let edge = texture.lookup([0.0, 0.5], 0.0);
        assert!((edge[3] - 0.5).abs() < 1e-6 && (edge[1] - 0.5 * constant[1]).abs() < 1e-6);
    }
    let almost = image([2, 2], 1, ColorSpace::Linear, PixelData::U8(vec![7, 7, 7, 8]));
    assert_eq!(almost.constant(), None);
}

#[test]
fn any_coordinate_gives_a_finite_value() {
    let values: Vec<f32> = noise(5 * 3).iter().map(|value| (value - 0.5) * f32::MAX).collect();
    let image = image([5, 3], 1, ColorSpace::Linear, PixelData::F32(values));
    let odd = [0.0, -0.0, 1.0, -1e-9, 0.999_999_94, 1e9, -1e9, 3.4e38, -3.4e38, f32::INFINITY, f32::NAN, 1e-45];
    for wrap in WRAPS {
        for filter in [Filter::Linear, Filter::Nearest] {
            let texture = texture(&image, [wrap, wrap], filter);
            for u in odd {
                for v in odd {
                    for footprint in odd {
                        let value = texture.lookup([u, v], footprint);
                        assert!(value.iter().all(|x| x.is_finite()), "{wrap:?} {u} {v} {footprint}: {value:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn broken_float_texels_become_black_with_one_warning() {
    let mut values = vec![0.5; 12];
    (values[1], values[5], values[7], values[8]) = (f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -2.0);
    let half = values.iter().copied().map(f16::from_f32).collect();
    for pixels in [PixelData::F32(values), PixelData::F16(half)] {
        let mut warnings = Warnings::new();
        let image = Image::new(desc([4, 3], 1, ColorSpace::Linear, pixels), &mut warnings).expect("usable");
        let told: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        assert_eq!(told, ["a.glb, image 0: image 'wood' holds 3 values that are NaN or infinite; they are 0"]);
        assert_eq!([1, 5, 7, 8, 9].map(|i| image.texel(i % 4, i / 4)[0]), [0.0, 0.0, 0.0, -2.0, 0.5]);
    }
}

#[test]
fn images_whose_texels_do_not_fill_them_are_refused() {
    for (size, channels, n) in [([0, 4], 1, 0), ([4, 4], 1, 15), ([4, 4], 0, 0), ([2, 2], 5, 20), ([4, 4], 3, 16)] {
        let broken = desc(size, channels, ColorSpace::Linear, PixelData::U8(vec![1; n]));
        let error = Image::new(broken, &mut Warnings::new()).expect_err("broken");
        assert!(error.to_string().contains("wood"), "{error}");
    }
}

/// An image whose texels are blended otherwise than in light.
fn blended(size: [u32; 2], channels: u8, texels: Vec<u8>, blending: Blending) -> Arc<Image> {
    let desc = ImageDesc { blending, ..desc(size, channels, ColorSpace::Srgb, PixelData::U8(texels)) };
    Arc::new(Image::new(desc, &mut Warnings::new()).expect("a sound image"))
}

fn decoded(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// What is stored is blended and decoded last, and from afar the image is the mean of that.
#[test]
fn encoded_values_are_blended_as_they_are_stored() {
    let stripes: Vec<u8> = (0..64).map(|i| if i % 2 == 0 { 0 } else { 255 }).collect();
    let blending = Blending { encoded: Some(Filter::Linear), associated: false };
    let image = blended([64, 1], 1, stripes, blending);
    let texture = linear(&image, Wrap::Clamp);
    for i in 0..=16 {
        let t = f64::from(i) / 16.0;
        let found = texture.lookup([((10.5 + t) / 64.0) as f32, 0.5], 0.0)[0];
        assert!((f64::from(found) - decoded(t)).abs() < 1e-6, "{t}: {found}");
    }
    // Between texels the mean is that of the curve; half a texel at both ends is what it is.
    let steps = 10_000;
    let mean: f64 =
        (0..steps).map(|i| decoded((f64::from(i) + 0.5) / f64::from(steps))).sum::<f64>() / f64::from(steps);
    let expected = (63.0 * mean + 0.5) / 64.0;
    let found = f64::from(texture.lookup([0.5, 0.5], 1.0)[0]);
    assert!((found - expected).abs() < 0.003, "{found} is not {expected}");
    assert!((found - 0.5).abs() > 0.1, "in light it would be half");
}

/// What is transparent gives its neighbours no colour, near and from afar.
#[test]
fn colors_times_alpha_are_divided_by_what_comes_out() {
    let texels: Vec<u8> = (0..8).flat_map(|i| if i % 2 == 0 { [200, 100, 50, 255] } else { [0; 4] }).collect();
    let blending = Blending { encoded: Some(Filter::Linear), associated: true };
    let texture = linear(&blended([8, 1], 4, texels, blending), Wrap::Repeat);
    let expected = [200.0, 100.0, 50.0].map(|code: f64| decoded(code / 255.0) as f32);
    for (u, footprint, alpha) in [(1.0 / 16.0, 0.0, 1.0), (1.0 / 8.0, 0.0, 0.5), (0.3, 0.0, 0.9), (0.3, 1.0, 0.5)] {
        let [r, g, b, a] = texture.lookup([u, 0.5], footprint);
        assert!((a - alpha).abs() < 0.003, "{u}: {a} is not {alpha}");
        for (found, expected) in [r, g, b].into_iter().zip(expected) {
            assert!(
                (found - expected).abs() < 0.006 * expected.max(0.1),
                "{u}, {footprint}: {found} is not {expected}"
            );
        }
    }
}

/// B-splines keep what is straight, spread a single texel over four by their weights, and go on beyond edges.
#[test]
fn cubic_lookups_are_splines() {
    let ramp = image([8, 1], 1, ColorSpace::Linear, PixelData::F32((0..8).map(|i| i as f32).collect()));
    let cubic = |image: &Arc<Image>, wrap: Wrap| texture(image, [wrap, wrap], Filter::Cubic);
    for i in 20..=60 {
        let x = i as f32 / 10.0;
        let found = cubic(&ramp, Wrap::Clamp).lookup([x / 8.0, 0.5], 0.0)[0];
        assert!((found - (x - 0.5)).abs() < 1e-5, "{x}: {found}");
    }
    let mut one = vec![0.0; 8];
    one[4] = 6.0;
    let one = image([8, 1], 1, ColorSpace::Linear, PixelData::F32(one));
    for wrap in WRAPS {
        for (x, expected) in [(4.5, 4.0), (3.5, 1.0), (5.5, 1.0), (2.5, 0.0), (5.0, 2.875)] {
            let found = cubic(&one, wrap).lookup([x / 8.0, 0.5], 0.0)[0];
            // Clamped rows are the same, those outside of a black border are black.
            let rows = if wrap == Wrap::Black { 4.0 / 6.0 } else { 1.0 };
            assert!((found - rows * expected).abs() < 1e-5, "{wrap:?} {x}: {found}");
        }
    }
    let edge = cubic(&ramp, Wrap::Clamp);
    assert_eq!([edge.lookup([5.0, 0.5], 0.0)[0], edge.lookup([-5.0, 0.5], 0.0)[0]], [7.0, 0.0]);
}
