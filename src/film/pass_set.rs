//! The passes that one render is asked for, and what they call for.

use std::collections::{BTreeSet, HashMap};
use std::fmt::{self, Write};
use std::sync::Arc;

use super::aov::Aov;
use super::chosen::{Chosen, Of, layer_name};
use super::pass::{PASSES, Pass};
use super::quantity::{Quantities, Quantity};
use super::replicates::place;

/// Most AOVs of a render: materials number what varies in a byte.
const MOST_AOVS: usize = 255;

/// What of a row is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Choice {
    /// Nothing.
    Nothing,
    /// The pass, of a row of groups or AOVs that of each of them.
    All,
    /// Of a row of groups or AOVs those of some names.
    Named(BTreeSet<Arc<str>>),
}

/// The passes of one render, and through them what has to be accumulated and computed.
///
/// Which light groups and AOVs there are is the scene's to say: until [`PassSet::resolve`] has been told, the
/// set has no passes of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PassSet {
    /// By row of [`PASSES`].
    choices: Vec<Choice>,
    /// Light groups whose sums are kept; those of `choices` are among them.
    groups: Vec<Arc<str>>,
    /// AOVs whose sums are kept, those of `choices`.
    aovs: Vec<Aov>,
    quantities: Quantities,
    /// Those of `quantities` whose error is asked for.
    replicated: Quantities,
}

impl fmt::Display for PassSet {
    /// As [`PassSet::parse`] takes it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut names = Vec::new();
        for (pass, choice) in PASSES.iter().zip(&self.choices) {
            match (choice, pass.prefix()) {
                (Choice::Nothing, _) => {}
                (Choice::All, None) => names.push(pass.name.to_owned()),
                (Choice::All, Some(prefix)) => names.push(format!("{prefix}*")),
                (Choice::Named(some), prefix) => {
                    names.extend(some.iter().map(|name| format!("{}{name}", prefix.unwrap_or_default())));
                }
            }
        }
        f.write_str(&names.join(","))
    }
}

impl Default for PassSet {
    /// Combined alone.
    fn default() -> Self {
        Self::parse("combined").unwrap_or_else(|_| Self::all())
    }
}

impl PassSet {
    /// Every pass there is, those of every light group and AOV included, but for the errors.
    pub fn all() -> Self {
        let choice = |pass: &Pass| if pass.is_error() { Choice::Nothing } else { Choice::All };
        Self::from_choices(PASSES.iter().map(choice).collect(), Vec::new(), Vec::new())
    }

    /// A comma-separated list of names, among them `all` for every one but the errors. An empty list is Combined
    /// alone. In the rows of groups and AOVs the name of one stands for `<…>`, or `*` for each.
    ///
    /// # Errors
    /// A message that names the unknown pass and those there are.
    pub fn parse(list: &str) -> Result<Self, String> {
        let mut choices = vec![Choice::Nothing; PASSES.len()];
        for name in list.split(',').map(str::trim).filter(|name| !name.is_empty()) {
            if name.eq_ignore_ascii_case("all") {
                let every = PASSES.iter().zip(&mut choices).filter(|(pass, _)| !pass.is_error());
                every.for_each(|(_, choice)| *choice = Choice::All);
                continue;
            }
            let (row, one) = find(name).ok_or_else(|| unknown(name))?;
            match (one, &mut choices[row]) {
                (None | Some("*"), choice) => *choice = Choice::All,
                (Some(_), Choice::All) => {}
                (Some(one), Choice::Named(some)) => _ = some.insert(one.into()),
                (Some(one), choice) => *choice = Choice::Named(BTreeSet::from([one.into()])),
            }
        }
        if choices.iter().all(|choice| *choice == Choice::Nothing) {
            choices[0] = Choice::All;
        }
        Ok(Self::from_choices(choices, Vec::new(), Vec::new()))
    }

    /// The set for a scene with these light groups and AOVs: `*` and `all` become the passes of each of them.
    ///
    /// # Errors
    /// A message that names a group or AOV that was asked for and is not there, with those that are; two
    /// passes whose layers would have the same name; more than 255 AOVs; a set of which nothing is left.
    pub fn resolve(&self, groups: &[Arc<str>], aovs: &[Aov]) -> Result<Self, String> {
        let mut choices = self.choices.clone();
        let (mut kept, mut kept_aovs) = (BTreeSet::new(), Vec::new());
        let mut missing = Vec::new();
        let aov_names: Vec<Arc<str>> = aovs.iter().map(|aov| aov.name.clone()).collect();
        for (pass, choice) in PASSES.iter().zip(&mut choices) {
            if pass.prefix().is_none() || *choice == Choice::Nothing {
                continue;
            }
            let (what, there) = if pass.is_of_aovs() { ("AOV", &aov_names[..]) } else { ("light group", groups) };
            let chosen = match choice {
                Choice::Named(asked) => asked.iter().map(|name| known(name, what, there)).collect::<Result<_, _>>()?,
                _ => there.iter().cloned().collect::<BTreeSet<_>>(),
            };
            if pass.is_of_aovs() {
                kept_aovs.extend(aovs.iter().filter(|aov| chosen.contains(&aov.name)).cloned());
            } else {
                kept.extend(chosen.iter().cloned());
            }
            if chosen.is_empty() {
                *choice = Choice::Nothing;
                if !missing.contains(&what) {
                    missing.push(what);
                }
            } else {
                *choice = Choice::Named(chosen);
            }
        }
        if choices.iter().all(|choice| *choice == Choice::Nothing) {
            return Err(format!("the scene has no {}s", missing.join("s and no ")));
        }
        if kept_aovs.len() > MOST_AOVS {
            return Err(format!("{} AOVs are more than the {MOST_AOVS} that one render can have", kept_aovs.len()));
        }
        let set = Self::from_choices(choices, kept.into_iter().collect(), kept_aovs);
        set.tell_layers_apart()?;
        Ok(set)
    }

    /// Two layers of one name could not be told apart.
    fn tell_layers_apart(&self) -> Result<(), String> {
        let mut known: HashMap<String, String> = HashMap::new();
        for chosen in self.iter() {
            for layer in chosen.layers() {
                let name = chosen.name();
                if let Some(other) = known.get(&layer) {
                    return Err(format!("the passes '{other}' and '{name}' would share the layer {layer}"));
                }
                known.insert(layer, name);
            }
        }
        Ok(())
    }

    /// The same for a scene with shadow catchers, which change Combined.
    pub fn with_catchers(mut self) -> Self {
        if self.needs(Quantity::Combined) {
            use Quantity::{Behind, CatcherLit, CatcherShare, CatcherUnshadowed};
            let all = [CatcherLit, CatcherUnshadowed, CatcherShare, Behind];
            self.quantities = all.into_iter().fold(self.quantities, |set, q| set.with(q));
            if self.has_error() {
                self.replicated = all.into_iter().fold(self.replicated, |set, q| set.with(q));
            }
        }
        self
    }

    /// The same with the error of Combined known, whether a pass shows it or not.
    pub fn with_error(mut self) -> Self {
        self.quantities = self.quantities.with(Quantity::Combined);
        self.replicated = self.replicated.with(Quantity::Combined);
        self
    }

    /// True where the error of Combined is known.
    pub fn has_error(&self) -> bool {
        self.replicated.contains(Quantity::Combined)
    }

    /// What the film keeps for each replicate, too.
    pub(super) fn replicated(&self) -> Quantities {
        self.replicated
    }

    /// The place of sample `index` of a pixel in the sampler's sequences: errors have them dealt over several.
    pub fn sequence_place(&self, index: u32) -> u64 {
        if self.replicated == Quantities::default() { u64::from(index) } else { place(index) }
    }

    fn from_choices(choices: Vec<Choice>, groups: Vec<Arc<str>>, aovs: Vec<Aov>) -> Self {
        let asked = PASSES.iter().zip(&choices).filter(|(_, choice)| **choice != Choice::Nothing);
        let of = |errors: bool| {
            let some = asked.clone().filter(|(pass, _)| pass.is_error() || !errors);
            some.flat_map(|(pass, _)| pass.needs).fold(Quantities::default(), |set, &q| set.with(q))
        };
        let (quantities, replicated) = (of(false), of(true));
        Self { choices, groups, aovs, quantities, replicated }
    }

    /// The passes, in the order of [`PASSES`]; of rows of groups those of [`PassSet::groups`], of the row of AOVs
    /// those of [`PassSet::aovs`].
    pub fn iter(&self) -> impl Iterator<Item = Chosen<'_>> {
        PASSES.iter().zip(&self.choices).flat_map(|(pass, choice)| {
            let once = (pass.prefix().is_none() && *choice == Choice::All).then_some(Of::Picture);
            let is_chosen = move |name: &str| match choice {
                Choice::Named(some) => some.contains(name),
                _ => false,
            };
            let groups = if pass.is_of_aovs() { &[] } else { &self.groups[..] };
            let aovs = if pass.is_of_aovs() { &self.aovs[..] } else { &[] };
            let groups = groups.iter().enumerate().filter(move |(_, group)| is_chosen(group));
            let groups = groups.map(|(i, group)| Of::Group(i, group));
            let aovs = aovs.iter().enumerate().map(|(i, aov)| Of::Aov(i, aov));
            once.into_iter().chain(groups).chain(aovs).map(move |of| Chosen { pass, of })
        })
    }

    /// Names of the layers that those of its passes have which are among `names`; `*` in place of the name of a group
    /// or AOV is each.
    pub fn layers_of(&self, names: &[Arc<str>]) -> BTreeSet<String> {
        let asks = |name: &str, wanted: &str| match wanted.strip_suffix('*') {
            Some(prefix) => name.starts_with(prefix),
            None => name.eq_ignore_ascii_case(wanted),
        };
        let asked = self.iter().filter(|chosen| names.iter().any(|wanted| asks(&chosen.name(), wanted)));
        asked.flat_map(|chosen| chosen.layers()).collect()
    }

    /// Names of the light groups whose sums are kept, in the order of their indices.
    pub fn groups(&self) -> &[Arc<str>] {
        &self.groups
    }

    /// AOVs whose sums are kept, in the order of their indices, which is the scene's.
    pub fn aovs(&self) -> &[Aov] {
        &self.aovs
    }

    /// How many numbers all of them are.
    pub fn aov_numbers(&self) -> usize {
        self.aovs.iter().map(|aov| aov.kind.width()).sum()
    }

    /// What the film accumulates of the light group of that index.
    pub(super) fn group_quantities(&self, group: usize) -> Quantities {
        let of_group = self.iter().filter(|chosen| chosen.group_index() == Some(group));
        of_group.flat_map(|chosen| chosen.pass.needs).fold(Quantities::default(), |set, &q| set.with(q))
    }

    /// What the film accumulates.
    pub fn quantities(&self) -> Quantities {
        self.quantities
    }

    /// True where some pass needs `q`.
    pub fn needs(&self, q: Quantity) -> bool {
        self.quantities.contains(q)
    }

    fn needs_any(&self, list: &[Quantity]) -> bool {
        list.iter().any(|&q| self.needs(q))
    }

    /// Ambient-occlusion rays are called for.
    pub fn needs_ao(&self) -> bool {
        self.needs(Quantity::Ao)
    }

    /// Direct light has to be kept with and without its shadows.
    pub fn needs_shadow(&self) -> bool {
        self.needs_any(&[Quantity::Unshadowed, Quantity::IrradianceUnshadowed])
    }

    /// For each of [`PassSet::groups`], whether its own shadow is called for.
    pub fn needs_shadow_of_groups(&self) -> Vec<bool> {
        let groups = 0..self.groups.len();
        groups.map(|group| self.group_quantities(group).contains(Quantity::GroupUnshadowed)).collect()
    }

    /// The albedo-free pair of irradiances has to be computed too, for surfaces without diffuse albedo.
    pub fn needs_irradiance(&self) -> bool {
        self.needs(Quantity::IrradianceUnshadowed)
    }

    /// An extra ray through the pixel's centre is called for.
    pub fn needs_first_hit(&self) -> bool {
        self.needs(Quantity::FirstHit)
    }

    /// Light has to be split by lobe class.
    pub fn needs_split(&self) -> bool {
        use Quantity::*;
        self.needs_any(&[DiffuseDirect, DiffuseIndirect, GlossyDirect, GlossyIndirect])
            || self.needs_any(&[TransmissionDirect, TransmissionIndirect])
    }

    /// The albedo of the first surface is called for, by lobe class.
    pub fn needs_color(&self) -> bool {
        self.needs_any(&[Quantity::DiffuseColor, Quantity::GlossyColor, Quantity::TransmissionColor])
    }

    /// Paths beyond the first surface are called for: by a denoiser in mirrors.
    pub fn needs_indirect(&self) -> bool {
        use Quantity::*;
        self.needs_any(&[Combined, GroupCombined, DiffuseIndirect, GlossyIndirect, TransmissionIndirect])
            || self.needs_denoising()
    }

    /// Light arriving at surfaces is called for, but for the shadows of light groups.
    pub fn needs_light(&self) -> bool {
        self.needs_indirect() || self.needs_split() || self.needs_shadow()
    }

    /// Names have to be hashed and ids kept.
    pub fn needs_cryptomatte(&self) -> bool {
        self.needs_any(&[Quantity::CryptoObject, Quantity::CryptoMaterial, Quantity::CryptoAsset])
    }

    /// What materials give as AOVs has to be computed.
    pub fn needs_aovs(&self) -> bool {
        !self.aovs.is_empty()
    }

    /// Normal, albedo or depth for a denoiser are called for.
    pub fn needs_denoising(&self) -> bool {
        self.needs_any(&[Quantity::DenoisingNormal, Quantity::DenoisingAlbedo, Quantity::DenoisingDepth])
    }
}

/// The row of a name, and the light group or AOV for a row of such.
fn find(name: &str) -> Option<(usize, Option<&str>)> {
    let whole = PASSES.iter().position(|pass| pass.prefix().is_none() && pass.name.eq_ignore_ascii_case(name));
    let named = || {
        PASSES.iter().enumerate().find_map(|(row, pass)| {
            let (prefix, one) = name.split_at_checked(pass.prefix()?.len())?;
            let matches = !one.is_empty() && pass.prefix()?.eq_ignore_ascii_case(prefix);
            matches.then_some((row, Some(one)))
        })
    };
    whole.map(|row| (row, None)).or_else(named)
}

/// The group or AOV of the scene, `what` says which, that `name` means: its name, or that of its layers.
fn known(name: &str, what: &str, there: &[Arc<str>]) -> Result<Arc<str>, String> {
    let exact = there.iter().find(|known| ***known == *name);
    let found = exact.or_else(|| there.iter().find(|known| layer_name(known) == name));
    found.cloned().ok_or_else(|| {
        if there.is_empty() {
            return format!("there is no {what} '{name}': the scene has no {what}s");
        }
        format!("there is no {what} '{name}'; the scene has: {}", there.join(", "))
    })
}

fn unknown(name: &str) -> String {
    let mut message = format!("there is no pass '{name}'; there are: all");
    for pass in PASSES {
        let _ = write!(message, ", {}", pass.name);
    }
    message
}

#[cfg(test)]
mod tests;
