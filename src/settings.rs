//! SETTINGS: one table of everything that a user can set about a render.
//!
//! The command line's flags, the add-on's properties and `docs/settings.md` are made of it; adding a
//! setting is adding a row.

use std::fmt::Display;

use crate::film::{Filter, PassSet, Quantity};
use crate::sampling::{PATTERNS, Pattern};

/// Which light transport is simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator {
    /// Path tracing with next-event estimation and multiple importance sampling.
    Path,
    /// Light that comes straight from lights; nothing bounces.
    Direct,
    /// Ambient occlusion alone: Combined holds the ao pass.
    Ao,
}

impl Integrator {
    /// True where it computes `q`, or `q` is 0 by what the integrator is.
    pub const fn computes(self, q: Quantity) -> bool {
        use Quantity::*;
        match self {
            Self::Path | Self::Direct => true,
            Self::Ao => matches!(
                q,
                Combined
                    | Ao
                    | Normal
                    | Uv
                    | Mist
                    | Vector
                    | VectorShare
                    | DenoisingNormal
                    | DenoisingDepth
                    | CryptoObject
                    | CryptoMaterial
                    | CryptoAsset
                    | FirstHit
                    | Aov
            ),
        }
    }
}

/// How one of many lights is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightSelection {
    /// By what it may send to the point that is lit.
    Tree,
    /// By its power.
    Power,
    /// All alike.
    Uniform,
}

/// How mist grows from where it begins to where it ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MistFalloff {
    /// Evenly.
    Linear,
    /// Slowly at first: the square of the share of the way.
    Quadratic,
    /// Fast at first: its root.
    InverseQuadratic,
}

/// Which effects are simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EffectsMode {
    /// Those that the scene calls for.
    Auto,
    /// All; gives the same bits as `auto`.
    All,
}

/// How a value is typed and shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A whole number in an inclusive range.
    Int {
        /// Smallest.
        min: u64,
        /// Largest.
        max: u64,
    },
    /// A number in an inclusive range.
    Float {
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
    },
    /// On or off.
    Bool,
    /// One of a few names.
    Choice(&'static [&'static str]),
    /// Anything that the setting's own parser takes.
    Text,
}

/// One row of the table.
#[derive(Clone, Copy, Debug)]
pub struct SettingDef {
    /// Name as in the struct; the flag is `--` and the name with `-` for `_`.
    pub name: &'static str,
    /// What stands for the value in the help.
    pub value_name: &'static str,
    /// How the value is typed.
    pub kind: Kind,
    /// Default, as typed; empty where absent means something of its own.
    pub default: &'static str,
    /// One line for the user.
    pub help: &'static str,
    set: fn(&mut Settings, &str) -> Result<(), String>,
    get: fn(&Settings) -> String,
}

impl SettingDef {
    /// Sets this row's value from what the user typed.
    ///
    /// # Errors
    /// A sentence that says what is allowed.
    pub fn set(&self, settings: &mut Settings, text: &str) -> Result<(), String> {
        (self.set)(settings, text)
    }

    /// The value as a user would type it.
    pub fn get(&self, settings: &Settings) -> String {
        (self.get)(settings)
    }
}

/// A type that stands in the table.
trait Value: Sized {
    fn parse(text: &str, kind: Kind) -> Result<Self, String>;
    fn show(&self) -> String;
}

/// `unbounded` is the largest number of its type, which as a limit is none.
fn in_range<T: PartialOrd + Display>(value: T, min: T, max: T, unbounded: T) -> Result<T, String> {
    match (min <= value && value <= max, max < unbounded) {
        (true, _) => Ok(value),
        (false, true) => Err(format!("must be from {min} to {max}")),
        (false, false) => Err(format!("must be a number of {min} or more")),
    }
}

impl Value for u64 {
    fn parse(text: &str, kind: Kind) -> Result<Self, String> {
        let value = text.parse().map_err(|_| "must be a whole number, not negative".to_string())?;
        if let Kind::Int { min, max } = kind { in_range(value, min, max, Self::MAX) } else { Ok(value) }
    }
    fn show(&self) -> String {
        self.to_string()
    }
}

impl Value for u32 {
    fn parse(text: &str, kind: Kind) -> Result<Self, String> {
        u64::parse(text, kind)?.try_into().map_err(|_| "is too large".to_string())
    }
    fn show(&self) -> String {
        self.to_string()
    }
}

impl Value for f64 {
    fn parse(text: &str, kind: Kind) -> Result<Self, String> {
        let value: Self = text.parse().map_err(|_| "must be a number".to_string())?;
        if let Kind::Float { min, max } = kind { in_range(value, min, max, Self::MAX) } else { Ok(value) }
    }
    fn show(&self) -> String {
        self.to_string()
    }
}

impl Value for bool {
    fn parse(text: &str, _kind: Kind) -> Result<Self, String> {
        match text {
            "on" | "true" => Ok(true),
            "off" | "false" => Ok(false),
            _ => Err("must be on or off".into()),
        }
    }
    fn show(&self) -> String {
        if *self { "on" } else { "off" }.into()
    }
}

impl<T: Value> Value for Option<T> {
    fn parse(text: &str, kind: Kind) -> Result<Self, String> {
        if text.is_empty() { Ok(None) } else { T::parse(text, kind).map(Some) }
    }
    fn show(&self) -> String {
        self.as_ref().map(T::show).unwrap_or_default()
    }
}

/// A value that is one of a list of names.
macro_rules! choice {
    ($type:ty, $names:ident, $($name:literal => $value:expr),+) => {
        const $names: &[&str] = &[$($name),+];
        impl Value for $type {
            fn parse(text: &str, _kind: Kind) -> Result<Self, String> {
                match text {
                    $($name => Ok($value),)+
                    _ => Err(format!("must be one of {}", $names.join(", "))),
                }
            }
            fn show(&self) -> String {
                $(if *self == $value { return $name.into(); })+
                String::new()
            }
        }
    };
}

choice!(Integrator, INTEGRATORS, "path" => Integrator::Path, "direct" => Integrator::Direct, "ao" => Integrator::Ao);
choice!(LightSelection, LIGHT_SELECTIONS,
    "tree" => LightSelection::Tree, "power" => LightSelection::Power, "uniform" => LightSelection::Uniform);
choice!(MistFalloff, MIST_FALLOFFS,
    "linear" => MistFalloff::Linear, "quadratic" => MistFalloff::Quadratic,
    "inverse_quadratic" => MistFalloff::InverseQuadratic);
choice!(EffectsMode, EFFECTS, "auto" => EffectsMode::Auto, "all" => EffectsMode::All);

impl Value for Pattern {
    fn parse(text: &str, _kind: Kind) -> Result<Self, String> {
        let names = || PATTERNS.iter().map(|info| info.name).collect::<Vec<_>>().join(", ");
        Self::from_name(text).ok_or_else(|| format!("must be one of {}", names()))
    }
    fn show(&self) -> String {
        self.name().into()
    }
}

impl Value for Filter {
    fn parse(text: &str, _kind: Kind) -> Result<Self, String> {
        Self::parse(text)
    }
    fn show(&self) -> String {
        self.to_string()
    }
}

impl Value for PassSet {
    fn parse(text: &str, _kind: Kind) -> Result<Self, String> {
        Self::parse(text)
    }
    fn show(&self) -> String {
        self.to_string()
    }
}

/// The table: the struct, its defaults and [`SETTINGS`] from one list.
macro_rules! settings {
    ($($name:ident: $type:ty = $default:literal, $kind:expr, $value_name:literal, $help:literal;)+) => {
        /// What a user has set about a render.
        #[derive(Clone, Debug, PartialEq)]
        pub struct Settings {
            $(#[doc = $help] pub $name: $type,)+
        }

        /// Every setting, in the order of the help.
        pub const SETTINGS: &[SettingDef] = &[$(SettingDef {
            name: stringify!($name),
            value_name: $value_name,
            kind: $kind,
            default: $default,
            help: $help,
            set: |settings, text| {
                settings.$name = <$type as Value>::parse(text, $kind)?;
                Ok(())
            },
            get: |settings| Value::show(&settings.$name),
        }),+];

        impl Default for Settings {
            fn default() -> Self {
                Self { $($name: <$type as Value>::parse($default, $kind).expect("defaults are in range"),)+ }
            }
        }
    };
}

settings! {
    spp: u32 = "64", Kind::Int { min: 1, max: Settings::NO_LIMIT as u64 }, "N",
        "Samples per pixel; their mean with --adaptive";
    error: Option<f64> = "", Kind::Float { min: 1e-6, max: 10.0 }, "E",
        "Stop once the noise of Combined is this share of the display's range, as 0.01; without --spp, whatever the samples";
    time: Option<f64> = "", Kind::Float { min: 1e-3, max: 1e9 }, "SECONDS",
        "Stop after so many seconds of rendering; without --spp, whatever the samples";
    adaptive: bool = "off", Kind::Bool, "on|off",
        "Give noisy pixels more samples and clean ones fewer";
    passes: PassSet = "combined", Kind::Text, "LIST",
        "Passes to write, separated by commas, or all; those of light groups as shadow_NAME, or shadow_* for each, AOVs as aov:NAME";
    integrator: Integrator = "path", Kind::Choice(INTEGRATORS), "NAME",
        "Light transport: path, direct (nothing bounces) or ao (occlusion alone)";
    max_bounces: u32 = "12", Kind::Int { min: 0, max: 1 << 20 }, "N",
        "Scatterings after the first hit; 0 for direct light only";
    diffuse_bounces: Option<u32> = "", Kind::Int { min: 0, max: 1 << 20 }, "N",
        "Diffuse reflections among them; as many as --max-bounces unless set";
    glossy_bounces: Option<u32> = "", Kind::Int { min: 0, max: 1 << 20 }, "N",
        "Glossy reflections among them; as many as --max-bounces unless set";
    transmission_bounces: Option<u32> = "", Kind::Int { min: 0, max: 1 << 20 }, "N",
        "Passages through surfaces among them; as many as --max-bounces unless set";
    transparent_bounces: u32 = "256", Kind::Int { min: 0, max: 1 << 15 }, "N",
        "Cut-outs and blends that a path, or a shadow ray, passes unscattered at most; what a path meets after so many is black";
    clamp_direct: f64 = "0", Kind::Float { min: 0.0, max: f64::MAX }, "X",
        "Dim what one path adds by direct light to three times this, red, green and blue together; biased; 0 for never";
    clamp_indirect: f64 = "0", Kind::Float { min: 0.0, max: f64::MAX }, "X",
        "The same for light that has bounced";
    caustics_reflective: bool = "on", Kind::Bool, "on|off",
        "Light that is reflected by glossy surfaces onto diffuse ones";
    caustics_refractive: bool = "on", Kind::Bool, "on|off",
        "Light that passes through surfaces onto diffuse ones";
    ao_distance: Option<f64> = "", Kind::Float { min: 0.0, max: f64::MAX }, "D",
        "Occluders farther than this many metres do not count in the ao pass; unlimited unless set";
    ao_samples: u32 = "1", Kind::Int { min: 1, max: 4096 }, "N",
        "Ambient occlusion rays per sample";
    mist_start: f64 = "5", Kind::Float { min: 0.0, max: f64::MAX }, "D",
        "Metres from the camera at which the mist pass begins";
    mist_depth: f64 = "25", Kind::Float { min: 0.0, max: f64::MAX }, "D",
        "Metres from there to where it ends";
    mist_falloff: MistFalloff = "quadratic", Kind::Choice(MIST_FALLOFFS), "NAME",
        "How the mist pass grows on the way: linear, quadratic (slowly at first) or inverse_quadratic (fast at first)";
    light_samples: u32 = "1", Kind::Int { min: 1, max: 4096 }, "N",
        "Light samples at the first hit per sample";
    light_selection: LightSelection = "tree", Kind::Choice(LIGHT_SELECTIONS), "NAME",
        "How one of many lights is chosen: tree (by what it may send to a point), or, with more noise, power or uniform";
    filter_glossy: f64 = "0", Kind::Float { min: 0.0, max: 10.0 }, "X",
        "Blur reflections and refractions that are seen through scattering spread wider than this density, as Cycles' Filter Glossy; 0 for none";
    specular_aa: f64 = "0", Kind::Float { min: 0.0, max: 8.0 }, "PIXELS",
        "Widen highlights by how much normals vary within so many pixels, against flicker; 0 for none";
    sampler: Pattern = "sobol", Kind::Text, "NAME",
        "Point set that the random decisions are drawn from";
    filter: Filter = "blackman_harris:1.5", Kind::Text, "NAME[:WIDTH]",
        "Pixel reconstruction filter and its half width in pixels";
    occlusion_maps: bool = "on", Kind::Bool, "on|off",
        "Apply baked occlusion maps to bounced diffuse light, as glTF defines them";
    motion_blur: bool = "on", Kind::Bool, "on|off",
        "Blur what moves while the camera's shutter is open";
    shadow_terminator_geometry_offset: f64 = "0.1", Kind::Float { min: 0.0, max: 1.0 }, "COSINE",
        "Rays to lights that meet smooth triangles at up to this cosine begin on a rounded surface, for objects that say nothing of it; 0 for none";
    shadow_terminator_shading_offset: f64 = "0", Kind::Float { min: 0.0, max: 1.0 }, "SHARE",
        "How far the edge of an object's own shadow is drawn towards the light, for objects that say nothing of it";
    seed: u64 = "0", Kind::Int { min: 0, max: u64::MAX }, "N",
        "Seed of every random decision; the same seed gives the same bits";
    threads: u32 = "0", Kind::Int { min: 0, max: 4096 }, "N",
        "Threads; 0 for one per core";
    half: bool = "off", Kind::Bool, "on|off",
        "Write colour passes as half floats; data passes stay float";
    effects: EffectsMode = "auto", Kind::Choice(EFFECTS), "auto|all",
        "Simulate the effects that the scene calls for, or all of them (the same picture, slower)";
}

impl Settings {
    /// Samples per pixel of a render that time ends.
    pub const NO_LIMIT: u32 = u32::MAX;

    /// Samples per pixel of a render that a small error is to end: it may never come.
    pub const MOST_FOR_ERROR: u32 = 1 << 16;

    /// True where the error of Combined has to be known, whether a pass shows it or not.
    pub fn needs_error(&self) -> bool {
        self.error.is_some() || self.adaptive
    }

    /// What the default number of samples gives way to where the user gave none: the other stop rules.
    pub fn without_spp(&mut self) {
        if self.time.is_some() {
            self.spp = Self::NO_LIMIT;
        } else if self.error.is_some() {
            self.spp = Self::MOST_FOR_ERROR;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_default_comes_back_as_it_is_typed() {
        let settings = Settings::default();
        for def in SETTINGS {
            assert_eq!(def.get(&settings), def.default, "{}", def.name);
        }
    }

    #[test]
    fn values_out_of_range_say_what_is_allowed() {
        let mut settings = Settings::default();
        let def = |name: &str| SETTINGS.iter().find(|d| d.name == name).unwrap();
        assert_eq!(def("spp").set(&mut settings, "0").unwrap_err(), "must be from 1 to 4294967295");
        assert!(def("spp").set(&mut settings, "many").is_err());
        assert!(def("integrator").set(&mut settings, "magic").unwrap_err().contains("path, direct, ao"));
        for name in ["time", "error"] {
            for text in ["NaN", "0", "-1", "inf", "1 %"] {
                assert!(def(name).set(&mut settings, text).unwrap_err().starts_with("must be"), "{name} {text}");
            }
        }
        def("ao_distance").set(&mut settings, "2.5").unwrap();
        assert_eq!(settings.ao_distance, Some(2.5));
    }
}
