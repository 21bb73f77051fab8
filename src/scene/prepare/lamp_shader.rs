//! Lamps whose emission is a graph: by direction where it goes by that, as a picture where it varies over an area.

use std::f64::consts::PI;
use std::sync::Arc;

use rayon::prelude::*;

use super::emissive::Shared;
use super::mend::Mended;
use crate::desc::graph::{Leaf, Op};
use crate::desc::{
    Blending, ColorSpace, ConeDesc, ImageDesc, LampShaderDesc, LightDesc, LightKind, PixelData, SceneDesc,
};
use crate::light::Drawn;
use crate::math::{DVec2, DVec3, Rgb};
use crate::scene::lamp_shading::{LampShading, Parameters};

/// Pixels along each side of the picture of an area, and at most where its graph looks up images.
const PICTURE: [u32; 2] = [256, 1024];

/// Points along each axis of a sun's disk that its factor is the mean of.
const OF_SUN: u32 = 16;

/// What a lamp's graph makes of it.
#[derive(Clone, Debug)]
pub struct LampShader {
    shading: Arc<LampShading>,
    /// Goes by where on an area it is.
    by_place: bool,
    /// Pixels along each side of a picture of it.
    pixels: u32,
}

impl LampShader {
    /// That of `light`, where it has one.
    pub fn of(desc: &SceneDesc, light: &LightDesc, shared: &Shared<'_>) -> Option<Self> {
        let shader = light.shaping.shader?;
        let Shared { lamps, textures, camera, origin, .. } = *shared;
        let parameters = match light.kind {
            LightKind::Rect { width, height, .. } | LightKind::Disk { width, height, .. } => {
                Parameters::Area(DVec2::new(width, height))
            }
            LightKind::Distant { angle, .. } if angle > 0.0 => Parameters::Disk(0.5 / (0.25 * angle).sin()),
            LightKind::Distant { .. } => Parameters::Disk(0.0),
            _ => match light.shaping.cone {
                Some(ConeDesc::Blend { angle, .. }) => Parameters::Cone(0.5 / angle.clamp(1e-4, 0.5 * PI - 1e-4).tan()),
                _ => Parameters::Sphere,
            },
        };
        let (program, textures, to_world) = (lamps[shader as usize].clone(), textures.clone(), light.transform);
        let of = &desc.lamp_shaders[shader as usize];
        let area = matches!(parameters, Parameters::Area(_));
        let shading = Arc::new(LampShading { program, textures, camera, origin, to_world, parameters });
        Some(Self { shading, by_place: area && goes_by_place(of), pixels: pixels(desc, of) })
    }

    /// True where the factor varies over an area.
    pub fn by_place(&self) -> bool {
        self.by_place
    }

    /// The factor by direction, seen from the middle of the lamp.
    pub fn drawn(&self) -> Drawn {
        let shading = self.shading.clone();
        Drawn::new(move |w, dist| shading.factor(w.as_dvec3(), f64::from(dist), DVec2::ZERO))
    }

    /// The factor over a rectangle, as it is seen from straight ahead, in its [texture
    /// coordinates](crate::light::Rect).
    pub fn picture(&self, light: &LightDesc, size: DVec2) -> ImageDesc {
        let (n, axis) = (self.pixels, -light.transform.matrix3.z_axis.normalize_or(DVec3::Z));
        let texel = |i: u32| {
            let uv = DVec2::new(f64::from(i % n) + 0.5, f64::from(i / n) + 0.5) / f64::from(n);
            self.shading.factor(axis, 1.0, (0.5 - uv) * size).to_array()
        };
        ImageDesc {
            name: light.name.clone(),
            place: light.place.clone(),
            width: n,
            height: n,
            channels: 3,
            color_space: ColorSpace::Linear,
            blending: Blending::default(),
            pixels: PixelData::F32((0..n * n).into_par_iter().flat_map_iter(texel).collect()),
        }
    }

    /// The mean of the factor over the disk of a sun of this diameter, radians; that it varies is told.
    pub fn of_sun(&self, light: &LightDesc, angle: f64, mended: &mut Mended) -> Rgb {
        let axes = light.transform.matrix3;
        let (x, y, z) = (axes.x_axis, axes.y_axis, axes.z_axis);
        let radius = (0.5 * angle).sin();
        let (mut sum, mut count, mut least, mut most) = (Rgb::BLACK, 0.0, Rgb::splat(f32::INFINITY), Rgb::BLACK);
        for i in 0..OF_SUN * OF_SUN {
            let at =
                DVec2::new(f64::from(i % OF_SUN) + 0.5, f64::from(i / OF_SUN) + 0.5) * (2.0 / f64::from(OF_SUN)) - 1.0;
            if at.length() > 1.0 {
                continue;
            }
            let [x, y, z] = [x, y, z].map(|axis| axis.normalize_or_zero());
            let w = z * (1.0 - (at * radius).length_squared()).max(0.0).sqrt() + (x * at.x + y * at.y) * radius;
            // Towards whom the sun shines, as all lamps shine along −z.
            let found = self.shading.factor(-w, 1.0, DVec2::ZERO);
            sum += found;
            count += 1.0;
            least = least.zip(found, f32::min);
            most = most.zip(found, f32::max);
        }
        if least.zip(most, |a, b| b - a).max_component() > 0.01 * most.max_component() {
            mended.note("its nodes vary over the disk of the sun: their mean is taken");
        }
        sum * (1.0 / count)
    }
}

/// True where a factor goes by where it is on an area.
fn goes_by_place(shader: &LampShaderDesc) -> bool {
    let by_place = |op: &Op| {
        matches!(
            op,
            Op::Leaf(Leaf::Parametric | Leaf::Position | Leaf::ObjectPosition | Leaf::CameraPosition | Leaf::Window)
        )
    };
    let needed = shader.graph.needed([shader.factor]);
    shader.graph.ops().iter().zip(needed).any(|(op, needed)| needed && by_place(op))
}

fn pixels(desc: &SceneDesc, shader: &LampShaderDesc) -> u32 {
    let looked_up = super::graphs::looked_up(&shader.graph, [shader.factor]).into_iter();
    let sides = looked_up.map(|texture| {
        let image = &desc.images[desc.textures[texture as usize].image as usize];
        image.width.max(image.height)
    });
    sides.max().map_or(PICTURE[0], |side| side.clamp(PICTURE[0], PICTURE[1]))
}
