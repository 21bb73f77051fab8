//! What the add-on says of a scene: plain data, as Blender has it (z up, watts, its own names).
//!
//! Everything but the arrays of meshes comes as one JSON document; the add-on computes nothing, it
//! copies properties by their names in Blender's Python. What is absent has Blender's own default.

use std::collections::HashMap;
use std::f64::consts::PI;

use serde::Deserialize;

use super::nodes::TreeData;
use crate::desc::RenderDesc;

/// A scene at one frame, for one view layer.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Document {
    /// Path of the .blend file; empty for one that was never saved.
    pub file: String,
    /// `bpy.app.version`.
    pub version: [u32; 3],
    /// What of the scene's own settings shapes the picture.
    pub render: RenderData,
    /// The active camera.
    pub camera: Option<CameraData>,
    /// The world.
    pub world: Option<WorldData>,
    /// Lamps, placed.
    pub lights: Vec<LightData>,
    /// Materials; objects refer to them by index.
    pub materials: Vec<MaterialData>,
    /// Images by the name that nodes refer to them by.
    pub images: HashMap<String, ImageData>,
    /// Objects that have a shape; instances refer to them by index.
    pub objects: Vec<ObjectData>,
}

/// Settings that are the scene's and not the engine's.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct RenderData {
    /// Pixels across and down, percentage applied.
    pub size: [u32; 2],
    /// `pixel_aspect_x`, `pixel_aspect_y`.
    pub pixel_aspect: [f64; 2],
    /// The border, in pixels from the lower left corner: left, lower, right and upper edge.
    pub border: Option<[u32; 4]>,
    /// Factor of the picture's radiance (`cycles.film_exposure`).
    pub exposure: f64,
    /// The world is not seen by the camera, alpha is 0 there.
    pub film_transparent: bool,
    /// The view layer's.
    pub pass_alpha_threshold: f64,
}

impl Default for RenderData {
    fn default() -> Self {
        Self {
            size: [1920, 1080],
            pixel_aspect: [1.0; 2],
            border: None,
            exposure: 1.0,
            film_transparent: false,
            pass_alpha_threshold: 0.5,
        }
    }
}

impl RenderData {
    /// The same in the engine's terms.
    pub fn desc(&self) -> RenderDesc {
        let [x, y] = self.pixel_aspect;
        let aspect = x / y;
        RenderDesc {
            resolution: Some(self.size),
            pixel_aspect: if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 },
            crop: self.border.map(|[left, lower, right, upper]| {
                let height = self.size[1];
                [left, height.saturating_sub(upper), right.saturating_sub(left), upper.saturating_sub(lower)]
            }),
            film_transparent: self.film_transparent,
            pass_alpha_threshold: self.pass_alpha_threshold,
            ..RenderDesc::default()
        }
    }
}

/// A camera object with its data.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct CameraData {
    /// Name of the object.
    pub name: String,
    /// `matrix_world`, by rows.
    pub matrix: [[f64; 4]; 4],
    /// `PERSP`, `ORTHO` or `PANO`.
    pub r#type: String,
    /// Focal length, millimetres.
    pub lens: f64,
    /// Millimetres.
    pub sensor_width: f64,
    /// Millimetres.
    pub sensor_height: f64,
    /// `AUTO`, `HORIZONTAL` or `VERTICAL`.
    pub sensor_fit: String,
    /// In sizes of the fitted side.
    pub shift_x: f64,
    /// In sizes of the fitted side.
    pub shift_y: f64,
    /// Nearest distance that is seen.
    pub clip_start: f64,
    /// Farthest distance that is seen.
    pub clip_end: f64,
    /// Size of the fitted side of what an orthographic camera sees.
    pub ortho_scale: f64,
    /// Depth of field; `None` where it is off.
    pub dof: Option<DofData>,
    /// What panoramic cameras have.
    pub panorama: PanoramaData,
}

impl Default for CameraData {
    fn default() -> Self {
        Self {
            name: String::new(),
            matrix: IDENTITY,
            r#type: "PERSP".into(),
            lens: 50.0,
            sensor_width: 36.0,
            sensor_height: 24.0,
            sensor_fit: "AUTO".into(),
            shift_x: 0.0,
            shift_y: 0.0,
            clip_start: 0.1,
            clip_end: 1000.0,
            ortho_scale: 6.0,
            dof: None,
            panorama: PanoramaData::default(),
        }
    }
}

/// A camera's depth of field.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default)]
pub struct DofData {
    /// Metres along the axis, that of the focus object where there is one.
    pub distance: f64,
    /// `aperture_fstop`.
    pub fstop: f64,
    /// `aperture_blades`; fewer than 3 are round.
    pub blades: u32,
    /// `aperture_ratio`.
    pub ratio: f64,
    /// `aperture_rotation`, radians.
    pub rotation: f64,
}

impl Default for DofData {
    fn default() -> Self {
        Self { distance: 10.0, fstop: 2.8, blades: 0, ratio: 1.0, rotation: 0.0 }
    }
}

/// A panoramic camera's own settings.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct PanoramaData {
    /// `EQUIRECTANGULAR` and others.
    pub panorama_type: String,
    /// Radians.
    pub latitude_min: f64,
    /// Radians.
    pub latitude_max: f64,
    /// Radians.
    pub longitude_min: f64,
    /// Radians.
    pub longitude_max: f64,
}

impl Default for PanoramaData {
    fn default() -> Self {
        Self {
            panorama_type: "EQUIRECTANGULAR".into(),
            latitude_min: -0.5 * PI,
            latitude_max: 0.5 * PI,
            longitude_min: -PI,
            longitude_max: PI,
        }
    }
}

/// The world.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct WorldData {
    /// Its name.
    pub name: String,
    /// `World.color`, which a world without nodes has.
    pub color: [f64; 3],
    /// Its nodes; `None` where `use_nodes` is off.
    pub nodes: Option<TreeData>,
    /// Light group.
    pub lightgroup: String,
    /// Which rays see it.
    pub visibility: VisibilityData,
}

impl Default for WorldData {
    fn default() -> Self {
        Self {
            name: "World".into(),
            color: [0.05; 3],
            nodes: None,
            lightgroup: String::new(),
            visibility: VisibilityData::default(),
        }
    }
}

/// A lamp, placed.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct LightData {
    /// Name of the object.
    pub name: String,
    /// `matrix_world`, by rows.
    pub matrix: [[f64; 4]; 4],
    /// `POINT`, `SPOT`, `SUN` or `AREA`.
    pub r#type: String,
    /// Watts; for a sun W/m².
    pub energy: f64,
    /// Stops (4.5 and later).
    pub exposure: f64,
    /// Linear.
    pub color: [f64; 3],
    /// `temperature_color` where `use_temperature` is on, else white.
    pub temperature_color: [f64; 3],
    /// Energy is independent of the size (4.5 and later; before, it always is).
    pub normalize: bool,
    /// Radius of points and spots (`shadow_soft_size`).
    pub radius: f64,
    /// Points and spots are disks that face whoever looks.
    pub use_soft_falloff: bool,
    /// Full diameter of a sun, radians.
    pub angle: f64,
    /// Full angle of a spot, radians.
    pub spot_size: f64,
    /// Softness of a spot's edge.
    pub spot_blend: f64,
    /// `SQUARE`, `RECTANGLE`, `DISK` or `ELLIPSE`.
    pub shape: String,
    /// Along x, or both.
    pub size: f64,
    /// Along y of rectangles and ellipses.
    pub size_y: f64,
    /// Full angle of an area lamp's spread, radians.
    pub spread: f64,
    /// A portal (`cycles.is_portal`): emits nothing.
    pub is_portal: bool,
    /// Its light is stopped by objects.
    pub use_shadow: bool,
    /// Its nodes; `None` where `use_nodes` is off.
    pub nodes: Option<TreeData>,
    /// Light group.
    pub lightgroup: String,
    /// Which rays see it; its shadow flag means nothing.
    pub visibility: VisibilityData,
    /// Whom it lights (light linking), as indices of objects.
    pub receivers: Option<LinkData>,
    /// What stops its light (shadow linking).
    pub blockers: Option<LinkData>,
}

impl Default for LightData {
    fn default() -> Self {
        Self {
            name: String::new(),
            matrix: IDENTITY,
            r#type: "POINT".into(),
            energy: 10.0,
            exposure: 0.0,
            color: [1.0; 3],
            temperature_color: [1.0; 3],
            normalize: true,
            radius: 0.0,
            use_soft_falloff: true,
            angle: 0.009_18,
            spot_size: 0.25 * PI,
            spot_blend: 0.15,
            shape: "SQUARE".into(),
            size: 0.25,
            size_y: 0.25,
            spread: PI,
            is_portal: false,
            use_shadow: true,
            nodes: None,
            lightgroup: String::new(),
            visibility: VisibilityData::default(),
            receivers: None,
            blockers: None,
        }
    }
}

/// Objects of a light linking collection.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct LinkData {
    /// Indices into [`Document::objects`].
    pub objects: Vec<u32>,
    /// True where the set is all but these.
    pub exclude: bool,
}

/// A material.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct MaterialData {
    /// Its name.
    pub name: String,
    /// `pass_index`.
    pub pass_index: u32,
    /// `diffuse_color`, which a material without nodes has.
    pub diffuse_color: [f64; 4],
    /// Its nodes; `None` where `use_nodes` is off.
    pub nodes: Option<TreeData>,
}

impl Default for MaterialData {
    fn default() -> Self {
        Self { name: "Material".into(), pass_index: 0, diffuse_color: [0.8, 0.8, 0.8, 1.0], nodes: None }
    }
}

/// An image data-block.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct ImageData {
    /// Absolute path; `<UDIM>` stands for the tile's number.
    pub path: String,
    /// `colorspace_settings.name`.
    pub colorspace: String,
    /// `STRAIGHT`, `PREMUL`, `CHANNEL_PACKED` or `NONE`.
    pub alpha_mode: String,
    /// Numbers of the tiles of a UDIM image.
    pub tiles: Vec<u32>,
    /// Its bytes or pixels are handed over beside the document: packed, generated or painted.
    pub in_memory: bool,
}

impl Default for ImageData {
    fn default() -> Self {
        Self {
            path: String::new(),
            colorspace: "sRGB".into(),
            alpha_mode: "STRAIGHT".into(),
            tiles: Vec::new(),
            in_memory: false,
        }
    }
}

/// An object with a shape.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct ObjectData {
    /// Its name.
    pub name: String,
    /// Name of the topmost parent.
    pub asset: String,
    /// Key of its mesh, strands or points.
    pub mesh: u64,
    /// Index into [`Document::materials`] of each slot.
    pub materials: Vec<Option<u32>>,
    /// `pass_index`.
    pub pass_index: u32,
    /// `Object.color`.
    pub color: [f64; 4],
    /// Which rays see it.
    pub visibility: VisibilityData,
    /// `holdout_get`: it, or a collection that it is in, is a hole in the picture.
    pub holdout: bool,
    /// `is_shadow_catcher`.
    pub shadow_catcher: bool,
    /// Light group of what it emits.
    pub lightgroup: String,
    /// Whom its light falls on (light linking).
    pub receivers: Option<LinkData>,
    /// What stops its light (shadow linking).
    pub blockers: Option<LinkData>,
}

impl Default for ObjectData {
    fn default() -> Self {
        Self {
            name: String::new(),
            asset: String::new(),
            mesh: 0,
            materials: Vec::new(),
            pass_index: 0,
            color: [1.0; 4],
            visibility: VisibilityData::default(),
            holdout: false,
            shadow_catcher: false,
            lightgroup: String::new(),
            receivers: None,
            blockers: None,
        }
    }
}

/// Which kinds of ray see something, by Blender's names.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default)]
pub struct VisibilityData {
    /// `visible_camera`.
    pub camera: bool,
    /// `visible_diffuse`.
    pub diffuse: bool,
    /// `visible_glossy`.
    pub glossy: bool,
    /// `visible_transmission`.
    pub transmission: bool,
    /// `visible_shadow`.
    pub shadow: bool,
}

impl Default for VisibilityData {
    fn default() -> Self {
        Self { camera: true, diffuse: true, glossy: true, transmission: true, shadow: true }
    }
}

impl From<VisibilityData> for crate::desc::Visibility {
    fn from(data: VisibilityData) -> Self {
        let VisibilityData { camera, diffuse, glossy, transmission, shadow } = data;
        Self { camera, diffuse, glossy, transmission, shadow }
    }
}

const IDENTITY: [[f64; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
