//! Measured distributions that lights name, each file read once.

use std::collections::HashMap;
use std::f64::consts::PI;

use openusd::ar::{DefaultResolver, ResolvedPath, Resolver};
use openusd::sdf::AssetPath;

use super::super::values::Values;
use crate::desc::{IesDesc, IesRef};
use crate::error::{Place, Warnings};
use crate::import::decode_ies;

/// Distributions read so far.
#[derive(Default)]
pub(in super::super) struct Profiles {
    /// In the order of `SceneDesc::ies`.
    pub list: Vec<IesDesc>,
    known: HashMap<String, Option<u32>>,
}

impl Profiles {
    /// The distribution of `file` as ShapingAPI uses it, and what the light's emission is multiplied by:
    /// the candela themselves are the factors, or those over their mean. `None`, with a warning, where
    /// there is none.
    pub(super) fn load(&mut self, values: &Values<'_>, file: &AssetPath) -> Option<(IesRef, f64)> {
        let path = file.resolved_path().unwrap_or_default().to_string();
        if path.is_empty() {
            values.warn(format!("IES profile \"{}\" is not there: shines without it", file.asset_path()));
            return None;
        }
        let known = self.known.get(&path).copied();
        let profile = known.unwrap_or_else(|| {
            let read = decode(&path, values).map(|ies| {
                self.list.push(ies);
                (self.list.len() - 1) as u32
            });
            self.known.insert(path, read);
            read
        })?;
        let ies = self.list.get(profile as usize)?;
        let peak = ies.candela.iter().copied().fold(0.0, f64::max);
        let normalized = values.flag("inputs:shaping:ies:normalize").unwrap_or(false);
        let mean = if normalized { mean(ies) } else { 1.0 };
        if !(peak > 0.0 && mean > 0.0) {
            values.warn(format!("IES profile \"{}\" gives no light: shines without it", ies.name));
            return None;
        }
        let angle_scale = values.number("inputs:shaping:ies:angleScale").unwrap_or(0.0);
        Some((IesRef { profile, angle_scale, keep_power: false }, peak / mean))
    }
}

fn decode(path: &str, values: &Values<'_>) -> Option<IesDesc> {
    let bytes = DefaultResolver::new().open_asset(&ResolvedPath::new(path)).and_then(|mut asset| asset.read_all());
    let bytes = bytes.map_err(|e| values.warn(format!("IES profile {path} can't be read: {e}; shines without it")));
    let name = path.trim_end_matches(']').rsplit(['/', '\\', '[']).next().unwrap_or(path);
    let mut warnings = Warnings::new();
    let ies = decode_ies(&bytes.ok()?, &name.into(), &Place::file(path), &mut warnings);
    values.reading.warnings.borrow_mut().extend(warnings);
    ies.map_err(|e| values.warn(format!("{e}; shines without the IES profile"))).ok()
}

/// The mean of the candela over the sphere, or over the hemisphere that they are in: what OpenUSD's own
/// renderer, Karma and RenderMan divide by (`hdEmbree/pxrIES/pxrIES.cpp`).
fn mean(ies: &IesDesc) -> f64 {
    let (rows, columns) = (ies.horizontal.len(), ies.vertical.len());
    let last = ies.horizontal.last().copied().unwrap_or(0.0);
    // How often the angles that are there go around.
    let (steps, times) = if rows < 2 { (1, 1.0) } else { (rows - 1, 360.0 / last) };
    let at = |h: usize, v: usize| ies.candela.get(h.min(rows.saturating_sub(1)) * columns + v).copied().unwrap_or(0.0);
    let mut sum = 0.0;
    for h in 0..steps {
        let around = if rows < 2 { 360.0 } else { ies.horizontal[h + 1] - ies.horizontal[h] };
        for (v, pair) in ies.vertical.windows(2).enumerate() {
            let center = 0.25 * (at(h, v) + at(h, v + 1) + at(h + 1, v) + at(h + 1, v + 1));
            let (low, step) = (pair[0].to_radians(), (pair[1] - pair[0]).to_radians());
            sum += around.to_radians() * step * (low + 0.5 * step).sin() * center;
        }
    }
    let range = ies.vertical.last().copied().unwrap_or(0.0) - ies.vertical.first().copied().unwrap_or(0.0);
    let is_sphere = range.to_radians() > 0.5 * PI + 0.1;
    times * sum / (PI * if is_sphere { 4.0 } else { 2.0 })
}

#[cfg(test)]
mod tests {
    use super::super::super::images::Images;
    use super::super::testing::Stage;
    use super::*;
    use crate::desc::LightKind;

    #[test]
    fn candela_are_factors_unless_normalised() {
        let stage = Stage::new(
            "",
            r#"def SphereLight "Raw" (prepend apiSchemas = ["ShapingAPI"]) {
                asset inputs:shaping:ies:file = @./a.ies@
            }
            def SphereLight "Mean" (prepend apiSchemas = ["ShapingAPI"]) {
                asset inputs:shaping:ies:file = @./a.ies@
                bool inputs:shaping:ies:normalize = 1
                float inputs:shaping:ies:angleScale = 0.5
            }
            def SphereLight "Lost" (prepend apiSchemas = ["ShapingAPI"]) {
                asset inputs:shaping:ies:file = @./b.ies@
            }"#,
        );
        // Even to all sides, 30 candela: the mean is that, but for the patches' sum.
        let angles: Vec<String> = (0..=180).map(|a| a.to_string()).collect();
        let text = format!(
            "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 181 1 1 2 0 0 0\n1 1 1\n{}\n0\n{}\n",
            angles.join(" "),
            "30 ".repeat(181)
        );
        std::fs::write(stage.folder.path().join("a.ies"), text).unwrap();
        let mut profiles = Profiles::default();
        let mut light = |path: &str| stage.light_with(path, &mut Images::default(), &mut profiles).unwrap();
        let radiance = |kind: LightKind| kind.color()[0];
        let raw = light("/Raw");
        assert!((radiance(raw.kind) - 30.0).abs() < 1e-9);
        assert_eq!(raw.shaping.ies, Some(IesRef { profile: 0, angle_scale: 0.0, keep_power: false }));
        let mean = light("/Mean");
        assert!((radiance(mean.kind) - 1.0).abs() < 1e-4, "{mean:?}");
        assert_eq!(mean.shaping.ies.unwrap().angle_scale, 0.5);
        assert_eq!(light("/Lost").shaping.ies, None);
        assert!(stage.said().contains("b.ies"), "{}", stage.said());
        assert_eq!(profiles.list.len(), 1);
    }
}
