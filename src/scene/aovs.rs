//! What surfaces give as AOVs.

use super::material::AovInput;
use super::{Interaction, Scene};

impl Scene {
    /// Adds what the surface at `it` gives to `numbers`, which are those of
    /// [`PassSet::aovs`](crate::film::PassSet::aovs) one after the other. A color counts itself in its fourth.
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
                AovInput::Color(color) => {
                    let given = lookups.color(color);
                    for (number, given) in own.iter_mut().zip([given.r, given.g, given.b, 1.0]) {
                        *number += given;
                    }
                }
                AovInput::Value(value) => own[0] += lookups.scalar(value),
            }
            rest = next;
        }
    }
}
