//! `extras.penumbra.light`: a lamp of any kind, from its own units to radiance.
//!
//! `power` is what it is for Blender's lamps: watts that a shape emits in all without cone or spread;
//! of a point and a sphere those of the full sphere, whatever the cone leaves.

use std::f64::consts::PI;

use serde_json::Value;

use super::fields::{Fields, three};
use super::light::tinted;
use crate::desc::{ConeDesc, DecayDesc, DecayLaw, LightKind, ShapingDesc};

/// A file that a light uses.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Source {
    /// Index into a list of the glTF file: of its images, or of the profiles of EXT_lights_ies.
    Index(usize),
    /// A file's name relative to the glTF file, or a data URI.
    Uri(String),
}

/// A measured distribution, not read yet.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct IesUse {
    pub source: Source,
    pub angle_scale: f64,
    pub keep_power: bool,
}

/// A light whose files are not read yet.
pub(super) struct Lamp {
    pub kind: LightKind,
    pub shaping: ShapingDesc,
    pub decay: DecayDesc,
    pub image: Option<Source>,
    pub ies: Option<IesUse>,
}

const KINDS: &str = "point, sphere, rect, disk, cylinder, distant, dome";

/// The light; `None`, after a warning, where it is none.
pub(super) fn read(mut fields: Fields<'_>) -> Option<Lamp> {
    let Some(kind) = fields.text("type") else {
        fields.tell("type", &format!("is missing: the light is left out; known are {KINDS}"));
        return None;
    };
    let kind = match kind {
        "point" => LightKind::Point { intensity: emission(&mut fields, &[("intensity", 1.0), ("power", 0.25 / PI)]) },
        "sphere" => sphere(&mut fields),
        "rect" => rect(&mut fields),
        "disk" => disk(&mut fields),
        "cylinder" => cylinder(&mut fields),
        "distant" => distant(&mut fields),
        "dome" => LightKind::Dome { radiance: emission(&mut fields, &[("radiance", 1.0)]), image: None },
        other => {
            fields.tell("type", &format!("'{other}' is not known: the light is left out; known are {KINDS}"));
            return None;
        }
    };
    let image = matches!(kind, LightKind::Rect { .. } | LightKind::Dome { .. }).then(|| source(&mut fields, "image"));
    let mut lamp =
        Lamp { kind, shaping: ShapingDesc::default(), decay: DecayDesc::default(), image: image.flatten(), ies: None };
    if !matches!(kind, LightKind::Distant { .. } | LightKind::Dome { .. }) {
        lamp.shaping = ShapingDesc {
            cone: cone(&mut fields),
            focus: fields.number("focus").unwrap_or(0.0),
            focus_tint: fields.color("focus_tint").unwrap_or_default(),
            ies: None,
            shader: None,
        };
        let (angle_scale, keep_power) = (fields.number("ies_angle_scale"), fields.flag("ies_keep_power"));
        lamp.ies = source(&mut fields, "ies").map(|source| IesUse {
            source,
            angle_scale: angle_scale.unwrap_or(0.0),
            keep_power: keep_power.unwrap_or(false),
        });
        lamp.decay = decay(&mut fields);
    }
    fields.finish();
    Some(lamp)
}

/// The first of `units` that is given, times its factor and the color; 1 of the first one unless set.
/// A factor that is infinite is that of a light without size: it is told where the light is prepared.
fn emission(fields: &mut Fields<'_>, units: &[(&'static str, f64)]) -> [f64; 3] {
    let mut found: Option<(&str, f64, [f64; 3])> = None;
    for &(key, factor) in units {
        let Some(value) = fields.color(key) else { continue };
        match found {
            None => found = Some((key, factor, value)),
            Some((first, ..)) => fields.tell(key, &format!("is ignored: {first} is given, too")),
        }
    }
    let (_, factor, value) = found.unwrap_or((units[0].0, units[0].1, [1.0; 3]));
    let factor = if factor.is_finite() { factor } else { 1.0 };
    let color = fields.color("color").unwrap_or([1.0; 3]);
    std::array::from_fn(|i| tinted(value[i] * factor, color[i]))
}

/// Radiance of a surface of `area` that emits diffusely.
fn surface(fields: &mut Fields<'_>, area: f64) -> [f64; 3] {
    emission(fields, &[("radiance", 1.0), ("power", 1.0 / (PI * area))])
}

/// A sphere without radius whose power is given is a point, as in Blender.
fn sphere(fields: &mut Fields<'_>) -> LightKind {
    let radius = fields.number("radius").unwrap_or(0.5);
    let facing = fields.flag("facing").unwrap_or(false);
    if radius == 0.0 && fields.value("power").is_some() {
        return LightKind::Point { intensity: emission(fields, &[("power", 0.25 / PI)]) };
    }
    LightKind::Sphere { radius, radiance: surface(fields, 4.0 * PI * radius * radius), facing }
}

/// Width and height, spread, two-sidedness and the sides that share the power.
fn panel(fields: &mut Fields<'_>) -> ([f64; 2], f64, bool, f64) {
    let width = fields.number("width").unwrap_or(1.0);
    let height = fields.number("height").unwrap_or(width);
    let two_sided = fields.flag("two_sided").unwrap_or(false);
    let sides = if two_sided { 2.0 } else { 1.0 };
    ([width, height], fields.number("spread").unwrap_or(PI), two_sided, sides)
}

fn rect(fields: &mut Fields<'_>) -> LightKind {
    let ([width, height], spread, two_sided, sides) = panel(fields);
    let radiance = surface(fields, sides * (width * height).abs());
    LightKind::Rect { width, height, radiance, spread, two_sided, image: None }
}

fn disk(fields: &mut Fields<'_>) -> LightKind {
    let ([width, height], spread, two_sided, sides) = panel(fields);
    let radiance = surface(fields, sides * 0.25 * PI * (width * height).abs());
    LightKind::Disk { width, height, radiance, spread, two_sided }
}

fn cylinder(fields: &mut Fields<'_>) -> LightKind {
    let radius = fields.number("radius").unwrap_or(0.5);
    let length = fields.number("length").unwrap_or(1.0);
    LightKind::Cylinder { radius, length, radiance: surface(fields, (2.0 * PI * radius * length).abs()) }
}

fn distant(fields: &mut Fields<'_>) -> LightKind {
    let angle = fields.number("angle").unwrap_or(0.0);
    let sin = (0.5 * angle.clamp(0.0, PI)).sin();
    // A radiance needs a disk to come from.
    let units = [("irradiance", 1.0), ("radiance", PI * sin * sin)];
    let units = if angle > 0.0 { &units[..] } else { &units[..1] };
    LightKind::Distant { irradiance: emission(fields, units), angle }
}

fn cone(fields: &mut Fields<'_>) -> Option<ConeDesc> {
    let mut cone = fields.object("cone")?;
    let angle = cone.number("angle");
    let read = match angle {
        Some(angle) => match (cone.number("blend"), cone.number("softness")) {
            (blend, None) => Some(ConeDesc::Blend { angle, blend: blend.unwrap_or(0.0) }),
            (None, Some(softness)) => Some(ConeDesc::Soft { angle, softness }),
            (Some(blend), Some(_)) => {
                cone.tell("softness", "is ignored: blend is given, too");
                Some(ConeDesc::Blend { angle, blend })
            }
        },
        None => cone.number("outer").map(|outer| ConeDesc::Ramp { outer, inner: cone.number("inner").unwrap_or(0.0) }),
    };
    if read.is_none() {
        cone.tell("angle", "is missing, and so is outer: the light has no cone");
    }
    cone.finish();
    read
}

fn decay(fields: &mut Fields<'_>) -> DecayDesc {
    let mut decay = DecayDesc::default();
    if let Some(value) = fields.value("decay") {
        let law = match value.as_str() {
            Some("none") => Some(DecayLaw::Constant),
            Some("linear") => Some(DecayLaw::Linear),
            Some("quadratic") => Some(DecayLaw::Quadratic),
            _ => three(value).map(|[kc, kl, kq]| DecayLaw::Polynomial { kc, kl, kq }),
        };
        match law {
            Some(law) => decay.law = law,
            None => fields.tell("decay", "is not none, linear, quadratic or three numbers: quadratic is taken"),
        }
    }
    decay.smooth = fields.number("smooth").unwrap_or(decay.smooth);
    decay.range = fields.number("range").unwrap_or(decay.range);
    decay
}

fn source(fields: &mut Fields<'_>, key: &'static str) -> Option<Source> {
    let source = match fields.value(key)? {
        Value::String(uri) if !uri.is_empty() => Some(Source::Uri(uri.clone())),
        value => value.as_u64().map(|index| Source::Index(index as usize)),
    };
    if source.is_none() {
        fields.tell(key, "is neither a file's name nor an index: ignored");
    }
    source
}
