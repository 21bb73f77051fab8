//! From strands and balls with their values to a `RoundsDesc`.

use openusd_schemas::geom::Interpolation;

use super::finish::{Channels, UNCOLORED, rgba, uv_sets};
use super::primvar::Channel;
use super::{Wants, finish};
use crate::desc::{Motion, RoundsDesc, Strand};
use crate::error::{Place, Warnings};

/// Strands or balls, and which values their points have.
pub(super) struct Rounds {
    pub points: Vec<[f32; 3]>,
    pub radii: Vec<f32>,
    /// Empty for balls that stand alone.
    pub strands: Vec<Strand>,
    /// One value for each point, or one for all.
    pub channels: Channels,
    pub motion: Vec<Motion<Vec<[f32; 3]>>>,
    /// At each of those times; empty where radii stay.
    pub radii_motion: Vec<Vec<f32>>,
}

impl Rounds {
    pub fn finish(self, wants: &Wants, place: &Place, warnings: &mut Warnings) -> RoundsDesc {
        let Self { points, radii, strands, channels, motion, radii_motion } = self;
        let Channels { uvs, color, opacity, named, .. } = channels;
        let count = points.len();
        let uvs = uv_sets(uvs, wants, place, warnings, |channel| match channel {
            Some(channel) => by_point(channel, count).into_iter().map(finish::upside_down).collect(),
            None => vec![[0.0, 1.0]; count],
        });
        // What has no displayColor has that of its instance, or is grey, as in usdview.
        let of_instance = wants.instance_color && color.is_none() && opacity.is_none();
        let colors = (wants.display_color && !of_instance).then(|| {
            let color = color.map_or_else(|| vec![UNCOLORED; count], |channel| by_point(channel, count));
            let opacity = opacity.map_or_else(|| vec![[1.0]; count], |channel| by_point(channel, count));
            color.into_iter().zip(opacity).map(|(color, opacity)| rgba(color, opacity)).collect()
        });
        RoundsDesc {
            name: finish::name(place),
            place: place.clone(),
            points,
            radii,
            strands,
            uvs,
            colors,
            attributes: named.into_iter().map(|(name, channel)| (name, by_point(channel, count))).collect(),
            material_slots: None,
            motion,
            radii_motion,
        }
    }
}

fn by_point<const N: usize>(channel: Channel<N>, points: usize) -> Vec<[f32; N]> {
    if channel.interpolation == Interpolation::Constant { vec![channel.at(0); points] } else { channel.flat() }
}
