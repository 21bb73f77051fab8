//! Highlights on surfaces that are finer than a pixel, and highlights that Filter Glossy blurs.

#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use std::f64::consts::TAU;
use std::sync::Arc;

use penumbra::desc::{
    Attribute, Blending, ColorInput, ColorSpace, Filter, ImageDesc, LightKind, MaterialDesc, MeshDesc, NormalInput,
    PixelData, ScalarInput, TextureDesc, TextureRef, TextureTransform, Wrap,
};
use penumbra::error::Place;
use penumbra::math::{DAffine3, DVec3};
use penumbra::settings::Settings;
use scene::{Builder, close, mean, picture, settings};

/// Pixels on each side, and what they show, metres.
const SIZE: u32 = 24;
const SIDE: f64 = 1.0;
/// Waves of the surface from side to side: six pixels each, of which a highlight takes a small part.
const WAVES: f64 = 4.0;
/// Steepest slope.
const SLOPE: f64 = 0.25;
/// Positions within a pixel.
const FRAMES: u32 = 12;

fn polished() -> MaterialDesc {
    MaterialDesc {
        base_color: ColorInput::constant([0.9; 3]),
        metallic: ScalarInput::constant(1.0),
        roughness: ScalarInput::constant(0.15),
        ..MaterialDesc::default()
    }
}

/// Slopes along x and z of the waves at a point.
fn slopes(x: f64, z: f64) -> [f64; 2] {
    [(TAU * WAVES * x / SIDE).cos() * SLOPE, (TAU * WAVES * z / SIDE).cos() * SLOPE]
}

/// A flat sheet of many triangles with the normals of waves.
fn waves() -> MeshDesc {
    let n = 400_u32;
    let at = |i: u32| (f64::from(i) / f64::from(n) - 0.5) * 1.5 * SIDE;
    let (mut points, mut normals) = (Vec::new(), Vec::new());
    for i in 0..=n {
        for j in 0..=n {
            let [x, z] = [at(i), at(j)];
            let [a, b] = slopes(x, z);
            points.push([x as f32, 0.0, z as f32]);
            normals.push(DVec3::new(-a, 1.0, -b).normalize().as_vec3().to_array());
        }
    }
    let index = |i: u32, j: u32| i * (n + 1) + j;
    let quads = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let triangles = quads
        .flat_map(|(i, j)| {
            [[index(i, j), index(i, j + 1), index(i + 1, j)], [index(i + 1, j), index(i, j + 1), index(i + 1, j + 1)]]
        })
        .collect();
    MeshDesc { points, triangles, normals: Some(Attribute::Point(normals)), ..MeshDesc::default() }
}

/// The sheet moved along x and z by shares of a pixel, lit from the side.
fn shifted(sheet: &Builder, share: f64) -> Builder {
    let mut builder = sheet.clone();
    let pixel = SIDE / f64::from(SIZE);
    builder.desc.instances[0].transform =
        DAffine3::from_translation(DVec3::new(share * pixel, 0.0, 0.618 * share * pixel));
    builder.light(
        LightKind::Sphere { radius: 0.4, radiance: [30.0; 3], facing: false },
        DAffine3::from_translation(DVec3::new(2.0, 6.0, 1.0)),
    );
    builder.look([0.0; 3], [0.0, -1.0, 0.0], 0.5 * SIDE);
    builder
}

/// Mean over pixels and frames, and how much pixels change from frame to frame: the mean of their variances.
fn flicker(sheet: &Builder, specular_aa: f64) -> [f64; 2] {
    let settings = Settings { specular_aa, max_bounces: 0, ..settings("combined", 4) };
    let frames: Vec<Vec<f64>> = (0..FRAMES)
        .map(|frame| {
            let desc = shifted(sheet, f64::from(frame) / f64::from(FRAMES)).desc;
            let picture = picture(&desc, SIZE, &settings);
            picture.layer("Combined").unwrap().data.iter().step_by(4).map(|v| f64::from(*v)).collect()
        })
        .collect();
    let count = f64::from(FRAMES);
    let pixels = frames[0].len();
    let of_pixel = |pixel: usize| {
        let values = frames.iter().map(|frame| frame[pixel]);
        let mean = values.clone().sum::<f64>() / count;
        [mean, values.map(|v| (v - mean).powi(2)).sum::<f64>() / count]
    };
    let sums = (0..pixels).map(of_pixel).fold([0.0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]]);
    sums.map(|sum| sum / pixels as f64)
}

fn calms(what: &str, sheet: &Builder) {
    let [plain, calm] = [0.0, 0.5].map(|pixels| flicker(sheet, pixels));
    println!("{what}: mean {:.4} and {:.4}, variance {:.4} and {:.4}", plain[0], calm[0], plain[1], calm[1]);
    close(what, calm[0], plain[0], 0.05);
    assert!(calm[1] < 0.2 * plain[1], "{what}: {} after {}", calm[1], plain[1]);
}

#[test]
fn fine_waves_flicker_less_and_stay_as_bright() {
    let mut sheet = Builder::default();
    let metal = sheet.material(polished());
    sheet.instance(waves(), metal, DAffine3::IDENTITY);
    calms("waves of the mesh", &sheet);
}

#[test]
fn a_fine_normal_map_flickers_less_and_stays_as_bright() {
    let mut sheet = Builder::default();
    let n = 512_u32;
    let texel = |i: u32| {
        let at = |k: u32| (f64::from(k) + 0.5) / f64::from(n) * SIDE;
        let [a, b] = slopes(at(i % n), at(i / n));
        let unit = DVec3::new(-a, -b, 1.0).normalize();
        [unit.x, unit.y, unit.z].map(|c| (127.5 * (c + 1.0)).round() as u8)
    };
    let image = ImageDesc {
        name: "waves".into(),
        place: Place::default(),
        width: n,
        height: n,
        channels: 3,
        color_space: ColorSpace::Linear,
        blending: Blending::default(),
        pixels: PixelData::U8((0..n * n).flat_map(texel).collect()),
    };
    sheet.desc.images.push(Arc::new(image));
    let [wrap_u, wrap_v] = [Wrap::Repeat; 2];
    // Always the finest level: a coarser one would be flat.
    let filter = Filter::Nearest;
    sheet.desc.textures.push(TextureDesc { place: Place::default(), image: 0, wrap_u, wrap_v, filter });
    let texture = TextureRef { texture: 0, uv_set: 0, transform: TextureTransform::IDENTITY };
    let map = NormalInput::Map { texture, scale: 1.0 };
    let metal = sheet.material(MaterialDesc { normal: Some(map), ..polished() });
    let h = 0.75 * SIDE as f32;
    let points = vec![[-h, 0.0, -h], [-h, 0.0, h], [h, 0.0, h], [h, 0.0, -h]];
    let uvs = points.iter().map(|p| [p[0] / SIDE as f32, p[2] / SIDE as f32]).collect();
    sheet.instance(
        MeshDesc {
            normals: Some(Attribute::Point(vec![[0.0, 1.0, 0.0]; 4])),
            tangents: Some(Attribute::Point(vec![[1.0, 0.0, 0.0, 1.0]; 4])),
            uvs: vec![Attribute::Point(uvs)],
            points,
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..MeshDesc::default()
        },
        metal,
        DAffine3::IDENTITY,
    );
    calms("normal map", &sheet);
}

/// What does not vary is not widened: a flat mirror shows the lamp as it is.
#[test]
fn flat_surfaces_stay_as_they_are() {
    let mut sheet = Builder::default();
    let metal = sheet.material(polished());
    sheet.quad([-1.0, 0.0, 1.0], [2.0, 0.0, 0.0], [0.0, 0.0, -2.0], metal);
    let pictures = [0.0, 4.0].map(|specular_aa| {
        picture(&shifted(&sheet, 0.0).desc, SIZE, &Settings { specular_aa, ..settings("combined", 4) })
    });
    assert_eq!(pictures[0], pictures[1]);
}

/// A lamp that a mirror throws onto a floor: never found without light sampling at the mirror, which the filter makes
/// possible; what the camera sees directly stays sharp.
#[test]
fn the_filter_blurs_what_is_behind_diffuse_scattering_alone() {
    let mut builder = Builder::default();
    let white = builder.lambert(0.7);
    let mirror = builder.material(MaterialDesc { roughness: ScalarInput::constant(0.0), ..polished() });
    builder.quad([-2.0, 0.0, 2.0], [4.0, 0.0, 0.0], [0.0, 0.0, -4.0], white);
    builder.quad([1.5, 0.0, 2.0], [0.0, 0.0, -4.0], [0.0, 2.0, 0.0], mirror);
    builder.light(LightKind::Point { intensity: [4.0; 3] }, DAffine3::from_translation(DVec3::new(0.0, 1.5, 0.0)));
    builder.look([0.0, 0.0, 0.0], [0.0, -1.0, 0.0], 1.0);
    let with = |filter_glossy: f64| picture(&builder.desc, 16, &Settings { filter_glossy, ..settings("all", 64) });
    let [sharp, blurred] = [0.0, 1.0].map(with);
    let layer = "Diffuse Indirect";
    // No ray meets a point.
    assert_eq!(mean(&sharp, layer, 0), 0.0);
    assert!(mean(&blurred, layer, 0) > 0.01, "{}", mean(&blurred, layer, 0));
    assert_eq!(mean(&sharp, "Diffuse Direct", 0), mean(&blurred, "Diffuse Direct", 0));
}
