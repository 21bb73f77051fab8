//! Scenes that no door would make: whatever bytes say, within the rules of indices and nothing else.

use std::sync::Arc;

use penumbra::desc::{
    AlphaMode, Blending, ColorInput, ColorSpace, ConeDesc, DecayDesc, DecayLaw, Filter, ImageDesc, LensDesc, LightKind,
    MaterialDesc, MeshDesc, NormalInput, PixelData, ProjectionDesc, RoundsDesc, ScalarInput, SceneDesc, ShapingDesc,
    SubsurfaceDesc, SubsurfaceMethod, TextureDesc, TextureRef, TextureTransform, VolumeDesc, Wrap,
};
use penumbra::error::Place;
use penumbra::film::PassSet;
use penumbra::math::{DAffine3, DMat3, DVec3};
use penumbra::scene::{View, prepare};
use penumbra::settings::Settings;

use crate::scene::Builder;

/// Numbers that have done harm before.
const NUMBERS: [f64; 24] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    2.0,
    1e-3,
    1e3,
    1e-7,
    1e7,
    1e-30,
    1e30,
    1e-38,
    1e38,
    1e-45,
    1e-300,
    1e300,
    3.5e38,
    1e200,
    -1e30,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    std::f64::consts::PI,
];

/// Takes what it is asked for from the bytes, zeros where they have ended.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        *first
    }

    fn coin(&mut self) -> bool {
        self.byte() & 1 == 0
    }

    fn below(&mut self, n: usize) -> usize {
        usize::from(self.byte()) % n
    }

    /// Mostly a number near 1, sometimes one of the harmful.
    fn number(&mut self) -> f64 {
        match self.byte() {
            kind @ 0..=191 => f64::from(kind) / 64.0 - 1.0 + f64::from(self.byte()) / 16384.0,
            kind => NUMBERS[usize::from(kind) % NUMBERS.len()],
        }
    }

    fn numbers<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| self.number())
    }

    fn scalar(&mut self) -> ScalarInput {
        ScalarInput::constant(self.number())
    }

    fn color(&mut self) -> ColorInput {
        ColorInput::constant(self.numbers())
    }

    fn transform(&mut self) -> DAffine3 {
        let at = DVec3::from(self.numbers());
        match self.byte() % 4 {
            0 => DAffine3::from_translation(at),
            1 => DAffine3::from_scale(DVec3::from(self.numbers())) * DAffine3::from_translation(at),
            2 => DAffine3::from_translation(at) * DAffine3::from_rotation_x(self.number()),
            _ => {
                let [x, y, z] = std::array::from_fn(|_| DVec3::from(self.numbers()));
                DAffine3::from_mat3_translation(DMat3::from_cols(x, y, z), at)
            }
        }
    }
}

/// The scene that `data` stands for.
pub fn scene(data: &[u8]) -> SceneDesc {
    let bytes = &mut Bytes(data);
    let mut scene = Builder::default();
    for _ in 0..=bytes.below(3) {
        let material = material(bytes, &mut scene);
        scene.material(material);
    }
    for _ in 0..bytes.below(4) {
        let material = bytes.below(scene.desc.materials.len()) as u32;
        let transform = bytes.transform();
        let points: Vec<[f32; 3]> = (0..3 + bytes.below(6)).map(|_| bytes.numbers().map(|v: f64| v as f32)).collect();
        if bytes.byte() < 200 {
            let corner = |bytes: &mut Bytes<'_>| bytes.below(points.len()) as u32;
            let triangles = (0..bytes.below(8)).map(|_| std::array::from_fn(|_| corner(bytes))).collect();
            let uvs = vec![penumbra::desc::Attribute::Point(points.iter().map(|p| [p[0], p[1]]).collect())];
            scene.instance(MeshDesc { points, triangles, uvs, ..MeshDesc::default() }, material, transform);
        } else {
            let radii = points.iter().map(|_| bytes.number() as f32).collect();
            scene.rounds(RoundsDesc { points, radii, ..RoundsDesc::default() }, material);
        }
    }
    for _ in 0..bytes.below(4) {
        let (kind, transform) = (lamp(bytes, scene.desc.images.len()), bytes.transform());
        scene.light(kind, transform);
        let light = scene.desc.lights.last_mut().expect("just made");
        light.shaping = shaping(bytes);
        light.decay = decay(bytes);
    }
    scene.look(bytes.numbers(), [0.3, -0.5, -0.8], 1.0);
    let camera = &mut scene.desc.cameras[0];
    camera.projection = match bytes.byte() % 3 {
        0 => ProjectionDesc::Perspective { fov_y: bytes.number(), aspect: None },
        1 => ProjectionDesc::Orthographic { half_width: bytes.number(), half_height: bytes.number() },
        _ => ProjectionDesc::Equirectangular { longitude: bytes.numbers(), latitude: bytes.numbers() },
    };
    if bytes.coin() {
        [camera.clip_near, camera.clip_far] = bytes.numbers();
        camera.lens = Some(LensDesc::round(bytes.number(), bytes.number()));
        camera.transform = bytes.transform();
    }
    scene.desc
}

fn material(bytes: &mut Bytes<'_>, scene: &mut Builder) -> MaterialDesc {
    let mut material = MaterialDesc {
        base_color: bytes.color(),
        metallic: bytes.scalar(),
        roughness: bytes.scalar(),
        ior: bytes.scalar(),
        specular: bytes.scalar(),
        transmission: bytes.scalar(),
        diffuse_roughness: bytes.scalar(),
        ..MaterialDesc::default()
    };
    let asks = bytes.byte();
    if asks & 1 != 0 {
        (material.emission, material.emission_strength) = (bytes.color(), bytes.number());
    }
    if asks & 2 != 0 {
        material.alpha = bytes.scalar();
        material.alpha_mode = if bytes.coin() { AlphaMode::Blend } else { AlphaMode::Mask { cutoff: bytes.number() } };
    }
    if asks & 4 != 0 {
        let (thickness, attenuation_distance, attenuation_color) = (bytes.scalar(), bytes.number(), bytes.numbers());
        material.volume = Some(VolumeDesc { thickness, attenuation_distance, attenuation_color, adds: bytes.coin() });
    }
    if asks & 8 != 0 {
        material.subsurface = Some(SubsurfaceDesc {
            weight: bytes.scalar(),
            color: bytes.color(),
            radius: bytes.color(),
            anisotropy: bytes.scalar(),
            ior: bytes.scalar(),
            method: SubsurfaceMethod::RandomWalk,
            shallow: false,
        });
    }
    if asks & 16 != 0 {
        material.transparency = bytes.color();
    }
    if asks & 32 != 0 {
        let texture = texture(bytes, scene);
        material.base_color.texture = Some(texture);
        if asks & 64 != 0 {
            material.normal = Some(NormalInput::Map { texture, scale: bytes.number() });
        }
    }
    material
}

/// An image of any size and floats.
fn texture(bytes: &mut Bytes<'_>, scene: &mut Builder) -> TextureRef {
    let [width, height] = [0, 1].map(|_| bytes.below(4) as u32);
    let pixels = PixelData::F32((0..3 * width * height).map(|_| bytes.number() as f32).collect());
    scene.desc.images.push(Arc::new(ImageDesc {
        name: "image".into(),
        place: Place::default(),
        width,
        height,
        channels: 3,
        color_space: ColorSpace::Linear,
        blending: Blending::default(),
        pixels,
    }));
    let image = scene.desc.images.len() as u32 - 1;
    let [wrap_u, wrap_v] = [0, 1].map(|_| [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Black][bytes.below(4)]);
    scene.desc.textures.push(TextureDesc { place: Place::default(), image, wrap_u, wrap_v, filter: Filter::Linear });
    let transform = TextureTransform([bytes.numbers(), bytes.numbers()]);
    TextureRef { texture: scene.desc.textures.len() as u32 - 1, uv_set: 0, transform }
}

fn lamp(bytes: &mut Bytes<'_>, images: usize) -> LightKind {
    let radiance = bytes.numbers();
    let image = (images > 0 && bytes.coin()).then(|| bytes.below(images) as u32);
    let [width, height, spread] = bytes.numbers();
    match bytes.byte() % 7 {
        0 => LightKind::Point { intensity: radiance },
        1 => LightKind::Sphere { radius: width, radiance, facing: bytes.coin() },
        2 => LightKind::Rect { width, height, radiance, spread, two_sided: bytes.coin(), image },
        3 => LightKind::Disk { width, height, radiance, spread, two_sided: bytes.coin() },
        4 => LightKind::Cylinder { radius: width, length: height, radiance },
        5 => LightKind::Distant { irradiance: radiance, angle: spread },
        _ => LightKind::Dome { radiance, image },
    }
}

fn shaping(bytes: &mut Bytes<'_>) -> ShapingDesc {
    let cone = match bytes.byte() % 6 {
        0 => Some(ConeDesc::Ramp { inner: bytes.number(), outer: bytes.number() }),
        1 => Some(ConeDesc::Blend { angle: bytes.number(), blend: bytes.number() }),
        2 => Some(ConeDesc::Soft { angle: bytes.number(), softness: bytes.number() }),
        _ => None,
    };
    let focus = if bytes.below(4) == 0 { bytes.number() } else { 0.0 };
    ShapingDesc { cone, focus, ..ShapingDesc::default() }
}

fn decay(bytes: &mut Bytes<'_>) -> DecayDesc {
    let law = match bytes.byte() % 8 {
        0 => DecayLaw::Constant,
        1 => DecayLaw::Linear,
        2 => DecayLaw::Polynomial { kc: bytes.number(), kl: bytes.number(), kq: bytes.number() },
        _ => DecayLaw::Quadratic,
    };
    match bytes.byte() % 4 {
        0 => DecayDesc { law, smooth: bytes.number(), range: bytes.number() },
        _ => DecayDesc { law, ..DecayDesc::default() },
    }
}

/// Builds and renders the scene of `data`: an error, or a picture of every pass that holds numbers alone.
pub fn hold(data: &[u8]) {
    let desc = scene(data);
    let mut settings = Settings { spp: 2, max_bounces: 4, threads: 1, ..Settings::default() };
    settings.passes = PassSet::parse("all").expect("a name of the help");
    let view = View { camera: None, size: Some([3, 2]) };
    let Ok(prepared) = prepare(desc, &view, &settings) else { return };
    let rendered = penumbra::render::render(&prepared.scene, &settings, &()).expect("threads and memory for 6 pixels");
    for layer in rendered.film.develop().layers {
        // Positions of what lies beyond the largest float are beyond it, too; ids are bits.
        let id = layer.name.starts_with("Crypto");
        assert!(id || layer.data.iter().all(|v| v.is_finite()), "{} has what is no number", layer.name);
    }
}
