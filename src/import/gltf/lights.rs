//! The light of a node: of `extras.penumbra`, of EXT_lights_ies or of KHR_lights_punctual, in this
//! order, so that a plainer light can stand in for programs that know no better one.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use super::super::blender::Stamp;
use super::super::{LightUnits, decode_ies};
use super::accessor::Reader;
use super::document::label;
use super::extras::Penumbra;
use super::json::{IesProfile, Image, NodeIes};
use super::lamp::{IesUse, Lamp, Source};
use super::light::{self, LUMENS_PER_WATT, tinted};
use super::node::PlacedNode;
use super::uri::{self, Target};
use super::{stamp, texture};
use crate::desc::{
    ColorSpace, DecayDesc, IesDesc, IesRef, ImageDesc, LightDesc, LightKind, SceneDesc, ShapingDesc, Visibility,
};
use crate::error::{Error, Place, Warnings};

/// What shines where a measured light can't be read, candela.
const SUBSTITUTE: f64 = 1000.0;

/// Reads lights, and the files that they use once each.
pub(super) struct Lights<'a> {
    reader: Reader<'a>,
    base: Option<&'a Path>,
    place: &'a Place,
    units: LightUnits,
    images: BTreeMap<Source, Result<u32, String>>,
    profiles: BTreeMap<Source, Result<u32, String>>,
    /// Kinds of lamps that Blender's exporter wrote without help.
    plain: BTreeSet<&'static str>,
}

/// What a light is and how it is shaped.
type Emission = (LightKind, ShapingDesc, DecayDesc);

impl<'a> Lights<'a> {
    pub fn new(reader: Reader<'a>, base: Option<&'a Path>, place: &'a Place, units: LightUnits) -> Self {
        Self { reader, base, place, units, images: BTreeMap::new(), profiles: BTreeMap::new(), plain: BTreeSet::new() }
    }

    /// Adds the light of a node, if there is one.
    pub fn add(
        &mut self,
        placed: &PlacedNode,
        penumbra: &Penumbra,
        stamp: Option<&Stamp>,
        scene: &mut SceneDesc,
        warnings: &mut Warnings,
    ) {
        let node = &self.reader.root.nodes[placed.node];
        let stamp = stamp.filter(|_| penumbra.light.is_none());
        if let Some(light) = stamp.and_then(|stamp| stamp::light(stamp, placed, scene, warnings)) {
            scene.lights.extend(light.map(|light| LightDesc {
                visibility: penumbra.visible(light.visibility),
                links: penumbra.over(light.links.clone()),
                ..light
            }));
            return;
        }
        let emission = if let Some(lamp) = &penumbra.light {
            Some(self.lamp(lamp, placed, scene, warnings))
        } else if let Some(measured) = &node.extensions.ies {
            self.measured(measured, placed, scene, warnings)
        } else {
            self.punctual(placed, warnings)
        };
        let Some((kind, shaping, decay)) = emission else { return };
        // Lamps are not seen by the camera unless it is said, as in Blender.
        let by_default = Visibility { camera: matches!(kind, LightKind::Dome { .. }), ..Visibility::ALL };
        scene.lights.push(LightDesc {
            shaping,
            decay,
            visibility: penumbra.visible(by_default),
            links: penumbra.links(),
            ..LightDesc::new(placed.name.clone(), placed.place.clone(), placed.world, kind)
        });
    }

    /// KHR_lights_punctual.
    fn punctual(&mut self, placed: &PlacedNode, warnings: &mut Warnings) -> Option<Emission> {
        let root = self.reader.root;
        let node = &root.nodes[placed.node];
        let index = node.extensions.light.as_ref()?.light?;
        let lights = &root.extensions.lights.lights;
        let Some(json) = lights.get(index) else {
            warnings.push(&placed.place, format!("names light {index} of {}; it is left out", lights.len()));
            return None;
        };
        let kind = light::kind(json, &node.extras, self.units);
        let (kind, mut shaping, decay) =
            kind.map_err(|what| warnings.push(&placed.place, format!("{what}; the light is left out"))).ok()?;
        if self.is_blenders() {
            shaping.cone = shaping.cone.map(light::cone_of_blender);
            self.plain.insert(match kind {
                LightKind::Distant { .. } => "the angle of suns",
                _ => "the radius and soft falloff of lamps",
            });
        }
        Some((kind, shaping, decay))
    }

    /// True for files of Blender's exporter.
    fn is_blenders(&self) -> bool {
        self.reader.root.asset.generator.contains("Blender I/O")
    }

    /// Tells, once, what Blender's exporter lost of the lamps that nothing was stamped on.
    pub fn tell_of_lost(&self, warnings: &mut Warnings) {
        if self.plain.is_empty() {
            return;
        }
        let lost: Vec<&str> = self.plain.iter().copied().collect();
        let what = format!(
            "was exported by Blender alone, which loses {}, the shadow switch, area lamps and the world. \
             File > Export > Penumbra keeps them",
            lost.join(", ")
        );
        warnings.push(self.place, what);
    }

    /// EXT_lights_ies: a point whose intensity is that of the file, in candela.
    fn measured(
        &mut self,
        json: &NodeIes,
        placed: &PlacedNode,
        scene: &mut SceneDesc,
        warnings: &mut Warnings,
    ) -> Option<Emission> {
        let count = self.reader.root.extensions.ies.lights.len();
        let index = json.light?;
        if index >= count {
            warnings.push(&placed.place, format!("names IES light {index} of {count}; it is left out"));
            return None;
        }
        let (candela, ies) = match self.profile(&Source::Index(index), scene, warnings) {
            Ok(profile) => {
                let peak = scene.ies[profile as usize].candela.iter().copied().fold(0.0, f64::max);
                (peak, Some(IesRef { profile, angle_scale: 0.0, keep_power: false }))
            }
            Err(what) => {
                let what = format!("light '{}': {what}; it shines evenly with {SUBSTITUTE} cd", placed.name);
                warnings.push(&placed.place, what);
                (SUBSTITUTE, None)
            }
        };
        let scale = candela * json.multiplier / LUMENS_PER_WATT;
        let intensity = json.color.map(|c| tinted(scale, c));
        Some((LightKind::Point { intensity }, ShapingDesc { ies, ..ShapingDesc::default() }, DecayDesc::default()))
    }

    /// `extras.penumbra.light`.
    fn lamp(&mut self, lamp: &Lamp, placed: &PlacedNode, scene: &mut SceneDesc, warnings: &mut Warnings) -> Emission {
        let mut kind = lamp.kind;
        let tell = |what: String, warnings: &mut Warnings| {
            warnings.push(&placed.place, format!("light '{}': {what}", placed.name));
        };
        if let LightKind::Rect { image, .. } | LightKind::Dome { image, .. } = &mut kind
            && let Some(source) = &lamp.image
        {
            match self.image(source, scene) {
                Ok(index) => *image = Some(index),
                Err(what) => tell(format!("{what}; it shines with its radiance alone, without an image"), warnings),
            }
        }
        let mut shaping = lamp.shaping;
        if let Some(IesUse { source, angle_scale, keep_power }) = &lamp.ies {
            match self.profile(source, scene, warnings) {
                Ok(profile) => {
                    shaping.ies = Some(IesRef { profile, angle_scale: *angle_scale, keep_power: *keep_power });
                }
                Err(what) => tell(format!("{what}; it shines evenly"), warnings),
            }
        }
        (kind, shaping, lamp.decay)
    }

    /// Index of an image in `scene`, read if it is not there yet.
    fn image(&mut self, source: &Source, scene: &mut SceneDesc) -> Result<u32, String> {
        if let Some(known) = self.images.get(source) {
            return known.clone();
        }
        let read = self.read_image(source).map(|image| {
            scene.images.push(image.into());
            scene.images.len() as u32 - 1
        });
        self.images.insert(source.clone(), read.clone());
        read
    }

    fn read_image(&self, source: &Source) -> Result<ImageDesc, String> {
        let images = &self.reader.root.images;
        let (index, json) = match source {
            Source::Index(i) => {
                let json = images.get(*i).ok_or_else(|| format!("image {i} of {} does not exist", images.len()))?;
                (*i, json.clone())
            }
            Source::Uri(uri) => (images.len(), Image { uri: Some(uri.clone()), ..Image::default() }),
        };
        let here = self.place.at(label("image", index, json.name.as_deref().or(texture::file_name(&json))));
        texture::decode(self.reader, index, &json, self.base, &here, ColorSpace::Srgb)
    }

    /// Index of a profile in `scene`, read if it is not there yet.
    fn profile(&mut self, source: &Source, scene: &mut SceneDesc, warnings: &mut Warnings) -> Result<u32, String> {
        if let Some(known) = self.profiles.get(source) {
            return known.clone();
        }
        let read = self.read_profile(source, warnings).map(|profile| {
            scene.ies.push(profile);
            scene.ies.len() as u32 - 1
        });
        self.profiles.insert(source.clone(), read.clone());
        read
    }

    fn read_profile(&self, source: &Source, warnings: &mut Warnings) -> Result<IesDesc, String> {
        let list = &self.reader.root.extensions.ies.lights;
        let json = match source {
            Source::Index(i) => {
                list.get(*i).cloned().ok_or_else(|| format!("IES profile {i} of {} does not exist", list.len()))?
            }
            Source::Uri(uri) => IesProfile { uri: Some(uri.clone()), ..IesProfile::default() },
        };
        let file = json.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
        let own = json.name.as_deref().filter(|name| !name.is_empty());
        let name: Arc<str> = own.or(file).unwrap_or("IES profile").into();
        let place = self.place.at(format!("IES profile '{name}'"));
        let here = |what: String| format!("IES profile '{name}': {what}");
        let bytes: Cow<'_, [u8]> = match (&json.uri, json.buffer_view) {
            (Some(uri), _) => match uri::resolve(uri, self.base).map_err(here)? {
                Target::Data { bytes, .. } => bytes.into(),
                Target::File(path) => {
                    let read = std::fs::read(&path);
                    read.map_err(|e| here(format!("can't read {}: {e}", path.display())))?.into()
                }
            },
            (None, Some(view)) => self.reader.buffers.view(self.reader.root, view).map_err(here)?.0.into(),
            (None, None) => return Err(here("has neither a URI nor a buffer view".into())),
        };
        decode_ies(&bytes, &name, &place, warnings).map_err(|error| match error {
            // Its place tells the line, too.
            Error::Invalid { place: Place { node: Some(line), .. }, what } => format!("{line}: {what}"),
            other => here(texture::reason(other)),
        })
    }
}
