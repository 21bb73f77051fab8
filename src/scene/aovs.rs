//! What surfaces and the background give as AOVs.

use super::material::{AovInput, rgb_of, single};
use super::surroundings::Surroundings;
use super::{Interaction, Scene};
use crate::film::AovKind;
use crate::math::{Rgb, Vec3};
use smallvec::SmallVec;

/// What lies behind everything, as AOVs.
pub struct BackgroundAovs {
    /// Its graph.
    pub surroundings: Surroundings,
    /// Which AOV each value of the graph's program is, growing.
    pub outputs: Vec<usize>,
}

/// Adds `color` to the numbers of an AOV; it counts itself in the fourth.
fn add_color(numbers: &mut [f32], color: Rgb) {
    for (number, given) in numbers.iter_mut().zip([color.r, color.g, color.b, 1.0]) {
        *number += given;
    }
}

impl Scene {
    /// Adds what the surface at `it` gives to `numbers`, which are those of
    /// [`PassSet::aovs`](crate::film::PassSet::aovs) one after the other.
    pub fn add_aovs(&self, it: &Interaction, numbers: &mut [f32]) {
        let material = self.material(it);
        if material.aovs.is_empty() {
            return;
        }
        let mut values = None;
        let lookups = self.lookups(it, |programs| programs.aovs.as_ref(), &mut values);
        let mut rest = numbers;
        for (aov, input) in self.passes.aovs().iter().zip(&material.aovs) {
            let (own, next) = rest.split_at_mut(aov.kind.width());
            match input {
                AovInput::No => {}
                AovInput::Color(color) => add_color(own, lookups.color(color)),
                AovInput::Value(value) => own[0] += lookups.scalar(value),
            }
            rest = next;
        }
    }

    /// Adds what the background gives where the unit direction `wi` leads to, as [`Scene::add_aovs`] does.
    pub fn add_background_aovs(&self, wi: Vec3, numbers: &mut [f32]) {
        let Some(background) = &self.background_aovs else { return };
        let mut values: SmallVec<[_; 8]> = SmallVec::from_elem([0.0; 4], background.outputs.len());
        background.surroundings.run(wi, &mut values);
        let mut given = background.outputs.iter().zip(values).peekable();
        let mut rest = numbers;
        for (index, aov) in self.passes.aovs().iter().enumerate() {
            let (own, next) = rest.split_at_mut(aov.kind.width());
            if let Some((_, [r, g, b, _])) = given.next_if(|(of, _)| **of == index) {
                match aov.kind {
                    AovKind::Color => add_color(own, rgb_of([r, g, b])),
                    AovKind::Value => own[0] += single(r),
                }
            }
            rest = next;
        }
    }
}
