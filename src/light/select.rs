//! Which light a shading point samples.
//!
//! With few lights each is asked what it could send to the point and one is chosen in proportion;
//! beyond [`SCAN_LIMIT`] lights that would cost more than it gains, and the choice is by power.

use super::{Emitter, EmitterHit, Light, Receiver};
use crate::math::{Bounds, Vec3};
use crate::sampling::AliasTable;

/// Up to so many lights are weighed at every shading point.
const SCAN_LIMIT: usize = 32;

/// All lights of a scene and the choice among them.
#[derive(Clone, Debug, Default)]
pub struct LightSet {
    lights: Vec<Light>,
    /// Indices of the lights that the background shows.
    background: Vec<u32>,
    /// Indices of the lights with a shape of their own.
    lamps: Vec<u32>,
    by_power: Option<AliasTable>,
}

/// Odds by power; those whose power is lost in `f32` still get a small share.
fn power_table(lights: &[Light], scene: Bounds) -> Option<AliasTable> {
    let powers: Vec<f64> = lights.iter().map(|l| f64::from(l.emitter.power(scene)).clamp(0.0, 1e30)).collect();
    let least = (1e-3 * powers.iter().sum::<f64>() / powers.len() as f64).max(f64::MIN_POSITIVE);
    AliasTable::new(&powers.iter().map(|p| p.max(least)).collect::<Vec<_>>())
}

/// A light that was chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Its index.
    pub light: u32,
    /// Probability with which it was chosen.
    pub pmf: f32,
    /// A fresh uniform number, made of what the choice left of the one it took.
    pub u: f32,
}

impl LightSet {
    /// The lights of a scene whose box is `scene` and whose receivers are of `classes` classes.
    pub fn new(lights: Vec<Light>, scene: Bounds, _classes: usize) -> Self {
        let those = |test: &dyn Fn(&Light) -> bool| -> Vec<u32> {
            (0..lights.len() as u32).filter(|&i| test(&lights[i as usize])).collect()
        };
        let background = those(&|light| light.emitter.in_background());
        let lamps = those(&|light| light.emitter.is_lamp());
        let by_power = (lights.len() > SCAN_LIMIT).then(|| power_table(&lights, scene)).flatten();
        Self { lights, background, lamps, by_power }
    }

    /// True where nothing shines.
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// How many lights there are.
    pub fn len(&self) -> usize {
        self.lights.len()
    }

    /// Light `i`.
    pub fn get(&self, i: u32) -> &Light {
        &self.lights[i as usize]
    }

    /// All lights, in the order of their indices.
    pub fn iter(&self) -> impl Iterator<Item = &Light> {
        self.lights.iter()
    }

    /// Lights that a ray which leaves the scene may see, with their indices.
    pub fn background(&self) -> impl Iterator<Item = (u32, &Light)> {
        self.background.iter().map(|&i| (i, self.get(i)))
    }

    /// True where some light has a shape of its own that rays may meet.
    pub fn has_lamps(&self) -> bool {
        !self.lamps.is_empty()
    }

    /// Calls `visit` with every lamp that the ray from `p` along the unit direction `wi` meets at a
    /// distance of `range`, in the order of their indices.
    pub fn lamps_along(&self, p: Vec3, wi: Vec3, range: [f32; 2], mut visit: impl FnMut(u32, &Light, &EmitterHit)) {
        for &i in &self.lamps {
            let light = self.get(i);
            if let Some(hit) = light.emitter.hit(p, wi).filter(|hit| (range[0]..range[1]).contains(&hit.dist)) {
                visit(i, light, &hit);
            }
        }
    }

    /// Chooses a light for `at` by `u`; `None` where none can reach it.
    pub fn choose(&self, at: &Receiver, u: f32) -> Option<Choice> {
        if let Some(table) = &self.by_power {
            let chosen = table.sample(u);
            return Some(Choice { light: chosen.index as u32, pmf: chosen.pmf, u: chosen.u });
        }
        if self.lights.len() == 1 {
            return Some(Choice { light: 0, pmf: 1.0, u });
        }
        let (weights, total) = self.weigh(at);
        let mut left = u * total;
        let mut last = None;
        for (i, &weight) in weights[..self.lights.len()].iter().enumerate().filter(|(_, w)| **w > 0.0) {
            let rest = (left / weight).clamp(0.0, crate::math::ONE_MINUS_EPSILON);
            last = Some(Choice { light: i as u32, pmf: weight / total, u: rest });
            if left < weight {
                return last;
            }
            left -= weight;
        }
        last
    }

    /// Probability with which [`LightSet::choose`] at `at` chooses `light`.
    pub fn pmf(&self, at: &Receiver, light: u32) -> f32 {
        if let Some(table) = &self.by_power {
            return table.pmf(light as usize);
        }
        if self.lights.len() == 1 {
            return 1.0;
        }
        let (weights, total) = self.weigh(at);
        if total > 0.0 { weights[light as usize] / total } else { 0.0 }
    }

    /// Density in solid angle with which light sampling at `at` finds `light` along `wi`.
    pub fn pdf_li(&self, at: &Receiver, light: u32, wi: Vec3, hit: Option<&EmitterHit>) -> f32 {
        let pdf = self.get(light).emitter.pdf_li(at, wi, hit);
        if pdf > 0.0 { pdf * self.pmf(at, light) } else { 0.0 }
    }

    /// Importance of each light at `at`, and their sum.
    fn weigh(&self, at: &Receiver) -> ([f32; SCAN_LIMIT], f32) {
        let mut weights = [0.0; SCAN_LIMIT];
        let mut total = 0.0;
        for (weight, light) in weights.iter_mut().zip(&self.lights) {
            if !light.rules.lights(at.class) {
                continue;
            }
            // Bounded, so that a point light at zero distance leaves the sum finite.
            *weight = light.emitter.importance(at).min(1e30);
            total += *weight;
        }
        (weights, total)
    }
}
