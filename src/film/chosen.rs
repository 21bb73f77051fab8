//! One of the passes that a render is asked for.

use super::aov::Aov;
use super::cryptomatte::DEPTH;
use super::pass::{AOV, Develop, GROUP, Pass};

/// One pass of a set.
#[derive(Clone, Copy, Debug)]
pub struct Chosen<'a> {
    /// Its row.
    pub pass: &'static Pass,
    pub(super) of: Of<'a>,
}

/// Whose pass it is, with its index.
#[derive(Clone, Copy, Debug)]
pub(super) enum Of<'a> {
    Picture,
    Group(usize, &'a str),
    Aov(usize, &'a Aov),
}

impl Chosen<'_> {
    /// Name as `--passes` takes it.
    pub fn name(&self) -> String {
        self.fill(self.pass.name, |group| group.to_owned())
    }

    /// Name of the layer, without the number that those of Cryptomatte have; a dot in the name of a light group or
    /// AOV becomes `_`, as it ends a part of a channel's name.
    pub fn layer(&self) -> String {
        self.fill(self.pass.layer, layer_name)
    }

    /// Names of all of its layers.
    pub(super) fn layers(&self) -> Vec<String> {
        match self.pass.develop {
            Develop::Pixel(_) | Develop::Error(_) | Develop::Trust => vec![self.layer()],
            Develop::Cryptomatte(_) => (0..DEPTH / 2).map(|i| format!("{}{i:02}", self.pass.layer)).collect(),
        }
    }

    /// One letter per channel.
    pub fn channels(&self) -> &'static str {
        self.aov().map_or(self.pass.channels, |(_, aov)| aov.kind.channels())
    }

    /// Index in [`PassSet::groups`], for a row of groups.
    pub fn group_index(&self) -> Option<usize> {
        match self.of {
            Of::Group(index, _) => Some(index),
            _ => None,
        }
    }

    /// The AOV and its index in [`PassSet::aovs`], for the row of AOVs.
    pub(super) fn aov(&self) -> Option<(usize, &Aov)> {
        match self.of {
            Of::Aov(index, aov) => Some((index, aov)),
            _ => None,
        }
    }

    fn fill(&self, template: &str, name: impl Fn(&str) -> String) -> String {
        match self.of {
            Of::Picture => template.to_owned(),
            Of::Group(_, group) => template.replace(GROUP, &name(group)),
            Of::Aov(_, aov) => template.replace(AOV, &name(&aov.name)),
        }
    }
}

/// The name of a light group or AOV as a part of a layer's.
pub(super) fn layer_name(name: &str) -> String {
    name.chars().map(|c| if c == '.' || c.is_control() { '_' } else { c }).collect()
}
