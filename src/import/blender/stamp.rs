//! Stamps: what *Export for Penumbra* writes at a lamp, a camera or the world of a USD or glTF file, since
//! these formats have no place for all of it. A stamp is a part of what the add-on hands over for a render,
//! and is read by the same functions, so that a file and F12 mean the same.
//!
//! Where the thing stands is up to the file: a lamp that is moved in another program has moved. Lengths
//! scale with it.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use serde::Deserialize;
use serde_json::Value as Json;

use super::document::{CameraData, ImageData, LightData, RenderData, WorldData};
use super::image::Images;
use super::kept::KeptImages;
use super::light::LampShader;
use super::transform::affine;
use super::{camera, light, nodes, world};
use crate::desc::{CameraDesc, ImageDesc, LightDesc, LightKind, ProjectionDesc, RenderDesc, SceneDesc};
use crate::error::{Place, Stop, Warnings};
use crate::math::{DAffine3, DMat3};

/// What this build reads.
const VERSION: u32 = 1;

/// Pixels along a side that Blender allows at most.
const LARGEST: u32 = 65_536;

/// When a stamp is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moment {
    /// As it was when the file was written.
    Authored,
    /// A frame of Blender's.
    Frame(f64),
    /// Seconds, frame 0 being at 0.
    Seconds(f64),
}

/// What stands at one lamp, camera or world.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct Stamp {
    version: u32,
    /// `bpy.app.version`.
    blender: [u32; 3],
    /// Frames per second of Blender's scene.
    fps: f64,
    /// Metres that the file makes of Blender's unit.
    unit: f64,
    /// The lamp.
    pub light: Option<LightData>,
    /// The camera.
    pub camera: Option<CameraData>,
    /// The world.
    pub world: Option<WorldData>,
    /// The scene's settings; with cameras only, which frame by them.
    render: RenderData,
    /// True for the camera that the scene is rendered with.
    active: bool,
    /// What nodes name; paths start from the file's folder.
    images: HashMap<String, ImageData>,
    /// What differs at each of these frames.
    frames: Vec<FrameData>,
}

/// What differs from the rest of the stamp from a frame on.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
struct FrameData {
    frame: f64,
    changes: Json,
}

impl Default for Stamp {
    fn default() -> Self {
        Self {
            version: 0,
            blender: [5, 0, 0],
            fps: 24.0,
            unit: 1.0,
            light: None,
            camera: None,
            world: None,
            render: RenderData::default(),
            active: false,
            images: HashMap::new(),
            frames: Vec::new(),
        }
    }
}

impl Stamp {
    /// Reads a stamp that is a text.
    ///
    /// # Errors
    /// As [`Stamp::read`].
    pub fn parse(text: &str, moment: Moment, folder: &Path) -> Result<Self, String> {
        let json = serde_json::from_str(text).map_err(|error| format!("it is not JSON: {error}"))?;
        Self::read(json, moment, folder)
    }

    /// Reads a stamp of a file that lies in `folder`.
    ///
    /// # Errors
    /// What is wrong with one that is no stamp, or one of a later version.
    pub fn read(json: Json, moment: Moment, folder: &Path) -> Result<Self, String> {
        let parse = |json: &Json| Self::deserialize(json).map_err(|error| error.to_string());
        let mut stamp = parse(&json)?;
        if stamp.version != VERSION {
            return Err(format!("it has version {}, known is {VERSION}", stamp.version));
        }
        let now = match moment {
            Moment::Authored => None,
            Moment::Frame(frame) => Some(frame),
            Moment::Seconds(seconds) => Some(seconds * stamp.fps),
        };
        let frames = std::mem::take(&mut stamp.frames);
        let at = |now: f64| frames.iter().rfind(|at| at.frame <= now + 1e-6);
        if let Some(at) = now.and_then(at).filter(|at| at.changes.is_object()) {
            let mut json = json;
            merge(&mut json, &at.changes);
            stamp = parse(&json)?;
        }
        for image in stamp.images.values_mut().filter(|image| !image.path.is_empty()) {
            image.path = folder.join(&image.path).to_string_lossy().into_owned();
        }
        Ok(stamp)
    }

    /// The light of `lamp`, this stamp's own or one that was changed, which stands at `world`; its images
    /// are added to `images`. `None` for one that emits nothing.
    pub fn light(
        &self,
        lamp: &LightData,
        world: &DAffine3,
        place: &Place,
        images: &mut Vec<Arc<ImageDesc>>,
        warnings: &mut Warnings,
    ) -> Option<LightDesc> {
        let scale = scale(&lamp.matrix, world);
        let at_a_distance = lamp.r#type != "SUN" && (lamp.normalize || lamp.radius <= 0.0);
        let lamp = LightData {
            matrix: rows(world),
            radius: lamp.radius * scale,
            // Cycles knows no metres: what it lights is as bright in a scene of another unit.
            energy: lamp.energy * if at_a_distance { self.unit * self.unit } else { 1.0 },
            ..lamp.clone()
        };
        let own = place.at(&lamp.name);
        let (shader, _) = self.with_images(place, images, warnings, |images, warnings| match &lamp.nodes {
            Some(tree) => nodes::lamp(tree, images, own, warnings),
            None => LampShader::default(),
        });
        if shader.varying.is_some() {
            let what = "the lamp's nodes vary over it, which files of other formats do not keep; they count as 1";
            warnings.push(&place.at(&lamp.name), what);
        }
        let mut light = light::light(&lamp, &shader, place, warnings)?;
        light.decay.smooth *= scale * scale;
        light.links.group = (!lamp.lightgroup.is_empty()).then(|| lamp.lightgroup.as_str().into());
        Some(light)
    }

    /// The camera, which stands at `world`.
    ///
    /// # Errors
    /// Why there is nothing to see through it.
    pub fn camera(
        &self,
        data: &CameraData,
        world: &DAffine3,
        place: &Place,
        warnings: &mut Warnings,
    ) -> Result<CameraDesc, String> {
        let lengths = [data.lens, data.sensor_width, data.sensor_height, data.ortho_scale, data.clip_end];
        if !lengths.iter().all(|&length| length > 0.0) {
            return Err("a length of its lens, sensor or frame is not above 0".into());
        }
        let scale = scale(&data.matrix, world);
        let data = CameraData {
            matrix: rows(world),
            dof: data.dof.filter(|dof| dof.fstop > 0.0 && dof.distance > 0.0),
            ..data.clone()
        };
        let mut camera = camera::camera(&data, &self.render, place, warnings);
        if let ProjectionDesc::Orthographic { half_width, half_height } = &mut camera.projection {
            *half_width *= scale;
            *half_height *= scale;
        }
        if let Some(lens) = &mut camera.lens {
            lens.aperture_radius *= scale;
            lens.focus_distance *= scale;
        }
        camera.clip_near = camera.clip_near.max(0.0) * scale;
        camera.clip_far *= scale;
        if camera.clip_far <= camera.clip_near {
            camera.clip_far = f64::INFINITY;
        }
        if camera.exposure.is_nan() || camera.exposure < 0.0 {
            camera.exposure = 1.0;
        }
        Ok(camera)
    }

    /// What the scene's settings say of its picture; `None` where the camera is not the one that they are for.
    pub fn render(&self) -> Option<RenderDesc> {
        let [width, height] = self.render.size;
        let sound = |size: u32| (1..=LARGEST).contains(&size);
        if !self.active || self.camera.is_none() || !sound(width) || !sound(height) {
            return None;
        }
        let border = self
            .render
            .border
            .filter(|&[left, lower, right, upper]| left < right && lower < upper && right <= width && upper <= height);
        Some(RenderData { border, ..self.render.clone() }.desc())
    }

    /// The dome that the world is; `turn` is the way from Blender's space, z up, to ours. `None` for a black one.
    pub fn dome(
        &self,
        world: &WorldData,
        turn: DMat3,
        place: &Place,
        images: &mut Vec<Arc<ImageDesc>>,
        warnings: &mut Warnings,
    ) -> Option<LightDesc> {
        let mut made = SceneDesc { place: place.clone(), ..SceneDesc::default() };
        let ((), first) = self
            .with_images(place, images, warnings, |images, warnings| world::add(world, images, &mut made, warnings));
        if made.lights.iter().any(|light| matches!(light.kind, LightKind::ShadedDome { .. })) || made.lights.len() > 1 {
            let what = "the stamped world is more than an image or a colour, which only Blender itself hands over; \
                        the plain dome counts";
            warnings.push(place, what);
            return None;
        }
        let mut dome = made.lights.pop()?;
        if let LightKind::Dome { image: Some(image), .. } = &mut dome.kind {
            *image += first;
        }
        dome.transform.matrix3 = turn * dome.transform.matrix3;
        Some(dome)
    }

    /// Lets `read` ask for images and adds them to `all`; gives the index of the first, too.
    fn with_images<T>(
        &self,
        place: &Place,
        all: &mut Vec<Arc<ImageDesc>>,
        warnings: &mut Warnings,
        read: impl FnOnce(&mut Images<'_>, &mut Warnings) -> T,
    ) -> (T, u32) {
        let in_memory = HashMap::new();
        let mut images = Images::new(&self.images, &in_memory, place, self.blender);
        let result = read(&mut images, warnings);
        let first = all.len() as u32;
        // Nothing stops it.
        let found = images.finish(&mut KeptImages::default(), &Stop::default(), warnings);
        all.extend(found.map(|(images, _)| images).unwrap_or_default());
        (result, first)
    }
}

/// Puts the values of `changes` in the place of those of `json`, objects key by key.
fn merge(json: &mut Json, changes: &Json) {
    match (json, changes) {
        (Json::Object(old), Json::Object(new)) => {
            new.iter().for_each(|(key, value)| merge(old.entry(key).or_insert(Json::Null), value));
        }
        (old, new) => old.clone_from(new),
    }
}

/// The map as a matrix of Blender's.
fn rows(map: &DAffine3) -> [[f64; 4]; 4] {
    let [x, y, z, origin] = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis, map.translation];
    let row = |i: usize| [x[i], y[i], z[i], origin[i]];
    [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
}

/// How much larger the thing is than it was in Blender.
fn scale(then: &[[f64; 4]; 4], now: &DAffine3) -> f64 {
    let ratio = now.matrix3.determinant() / affine(then).matrix3.determinant();
    let scale = ratio.abs().cbrt();
    // Files keep matrices to six digits.
    if (scale - 1.0).abs() < 1e-6 || scale == 0.0 || !scale.is_finite() { 1.0 } else { scale }
}
