//! The world, as a dome.

use super::document::WorldData;
use super::image::Images;
use super::nodes;
use crate::desc::{LightDesc, LightKind, LightLinks};
use crate::error::{Place, Warnings};
use crate::math::{DAffine3, DMat3, DVec3};

/// What a world's nodes make of it.
#[derive(Clone, Debug)]
pub struct WorldShader {
    /// Radiance, or the factor of the image.
    pub radiance: [f64; 3],
    /// A lat-long image.
    pub image: Option<u32>,
    /// From the direction of a ray to the coordinates that the image is looked up at.
    pub turn: DMat3,
}

/// The dome that `data` is; `None` for a black one.
pub fn dome(data: &WorldData, images: &mut Images<'_>, place: &Place, warnings: &mut Warnings) -> Option<LightDesc> {
    let place = place.at(&data.name);
    let shader = match &data.nodes {
        Some(tree) => nodes::world(tree, images, place.clone(), warnings)?,
        None => WorldShader { radiance: data.color, image: None, turn: DMat3::IDENTITY },
    };
    if shader.radiance == [0.0; 3] {
        return None;
    }
    let kind = LightKind::Dome { radiance: shader.radiance, image: shader.image };
    // The dome's space has y up and the image's centre at +x; Blender's has z up.
    let upright = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y);
    let turn = shader.turn.transpose() * upright;
    let mut light = LightDesc::new(data.name.as_str(), place, DAffine3::from_mat3(turn), kind);
    light.visibility = data.visibility.into();
    light.links = LightLinks {
        group: (!data.lightgroup.is_empty()).then(|| data.lightgroup.as_str().into()),
        ..LightLinks::default()
    };
    Some(light)
}
