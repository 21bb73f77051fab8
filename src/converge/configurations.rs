//! The ways that a scene is rendered in.

use crate::compare::pass_of;
use crate::sampling::PATTERNS;
use crate::settings::{SETTINGS, Settings};

/// What a way is there to tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// What the user asked for; the others are held against it.
    Base,
    /// The same picture in another way.
    Way,
    /// Something is left out, which changes the picture: what it costs.
    Without,
    /// A pass is left out: what it costs.
    WithoutPass,
    /// The base, denoised.
    Denoised,
}

/// A way to render.
#[derive(Clone, Debug, PartialEq)]
pub struct Configuration {
    /// As "sampler=independent".
    pub name: String,
    /// What it is there for.
    pub kind: Kind,
    /// Settings other than the base's, by name, as a user types them.
    pub changes: Vec<(String, String)>,
}

impl Configuration {
    /// One change of a setting.
    pub fn of(name: &str, value: &str, kind: Kind) -> Self {
        let flag = name.replace('_', "-");
        Self { name: format!("{flag}={value}"), kind, changes: vec![(name.to_owned(), value.to_owned())] }
    }

    /// The base's settings with the changes.
    ///
    /// # Errors
    /// A setting that there is not, or a value that it does not take.
    pub fn apply(&self, base: &Settings) -> Result<Settings, String> {
        let mut settings = base.clone();
        for (name, value) in &self.changes {
            let Some(def) = SETTINGS.iter().find(|def| def.name == name) else {
                return Err(format!("there is no setting '{name}'"));
            };
            def.set(&mut settings, value).map_err(|what| format!("{name}={value}: {what}"))?;
        }
        Ok(settings)
    }
}

/// The base and all that is tried beside it: samplers of these names (all for `all`), choices of lights, samples where
/// noise is, and what leaving things out saves. `layer` is that which is looked at.
pub fn configurations(base: &Settings, samplers: &[String], layer: &str) -> Vec<Configuration> {
    let mut list = vec![Configuration { name: "base".to_owned(), kind: Kind::Base, changes: Vec::new() }];
    let own = base.sampler.name();
    let all = samplers.iter().any(|name| name == "all");
    let is_tried = |name: &str| name != own && (all || samplers.iter().any(|wanted| wanted == name));
    list.extend(PATTERNS.iter().filter(|info| is_tried(info.name)).map(|info| of("sampler", info.name, Kind::Way)));
    let mut ways = vec![("light_selection", "power"), ("light_selection", "uniform"), ("light_samples", "4")];
    if !base.adaptive {
        ways.push(("adaptive", "on"));
    }
    if layer == "Ambient Occlusion" {
        ways.extend([("ao_samples", "4"), ("ao_samples", "16")]);
    }
    ways.retain(|(name, value)| SETTINGS.iter().any(|def| def.name == *name && def.get(base) != *value));
    list.extend(ways.into_iter().map(|(name, value)| of(name, value, Kind::Way)));
    let without = [
        ("max_bounces", "0"),
        ("max_bounces", "1"),
        ("max_bounces", "2"),
        ("max_bounces", "4"),
        ("diffuse_bounces", "0"),
        ("glossy_bounces", "0"),
        ("transmission_bounces", "0"),
        ("transparent_bounces", "0"),
        ("caustics_reflective", "off"),
        ("caustics_refractive", "off"),
        ("motion_blur", "off"),
        ("clamp_indirect", "10"),
        ("filter_glossy", "1"),
    ];
    let is_less = |name: &str, value: &str| match name {
        "max_bounces" => value.parse().is_ok_and(|bounces: u32| bounces < base.max_bounces),
        _ => SETTINGS.iter().any(|def| def.name == name && def.get(base) != value),
    };
    list.extend(without.into_iter().filter(|(n, v)| is_less(n, v)).map(|(n, v)| of(n, v, Kind::Without)));
    let passes = base.passes.to_string();
    let passes: Vec<&str> = passes.split(',').collect();
    for pass in passes.iter().filter(|pass| pass_of(pass) != layer) {
        let others: Vec<&str> = passes.iter().filter(|other| *other != pass).copied().collect();
        if !others.is_empty() {
            let changes = vec![("passes".to_owned(), others.join(","))];
            list.push(Configuration { name: format!("without pass {pass}"), kind: Kind::WithoutPass, changes });
        }
    }
    list
}

fn of(name: &str, value: &str, kind: Kind) -> Configuration {
    Configuration::of(name, value, kind)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_change_can_be_made() {
        let mut base = Settings::default();
        SETTINGS.iter().find(|def| def.name == "passes").unwrap().set(&mut base, "combined,ao,shadow").unwrap();
        let list = configurations(&base, &["all".to_owned()], "Ambient Occlusion");
        for configuration in &list {
            let settings = configuration.apply(&base).unwrap();
            assert_eq!(settings == base, configuration.kind == Kind::Base, "{}", configuration.name);
        }
        let names: Vec<&str> = list.iter().map(|configuration| configuration.name.as_str()).collect();
        for name in ["light-selection=power", "max-bounces=4", "ao-samples=16", "without pass shadow", "adaptive=on"] {
            assert!(names.contains(&name), "{names:?}");
        }
        assert!(!names.contains(&"without pass ao"), "what is looked at stays");
        let few = configurations(&Settings { max_bounces: 2, ..Settings::default() }, &[], "Combined");
        assert!(!few.iter().any(|configuration| configuration.name == "max-bounces=4"));
    }
}
