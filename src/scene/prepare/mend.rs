//! Bad numbers of a light and what they are taken as, told in one warning.

use crate::desc::LightDesc;
use crate::error::Warnings;
use crate::math::Rgb;

/// What was wrong with one light.
#[derive(Debug, Default)]
pub struct Mended {
    notes: Vec<String>,
}

impl Mended {
    /// Notes that `what` was wrong, and what was done about it.
    pub fn note(&mut self, what: impl Into<String>) {
        self.notes.push(what.into());
    }

    /// One warning for all notes.
    pub fn tell(self, light: &LightDesc, left_out: bool, warnings: &mut Warnings) {
        if !self.notes.is_empty() {
            let notes = self.notes.join("; ");
            let end = if left_out { "; it emits nothing and is left out" } else { "" };
            warnings.push(&light.place, format!("light \"{}\": {notes}{end}", light.name));
        }
    }

    /// `rgb` without what is no light; `None` where nothing is left.
    pub fn color(&mut self, rgb: [f64; 3]) -> Option<Rgb> {
        let finite = |v: &f64| (*v as f32).is_finite();
        if !rgb.iter().all(finite) {
            self.note("its intensity is not finite: taken as 0");
        }
        if rgb.iter().any(|v| finite(v) && *v < 0.0) {
            self.note("its intensity is negative: taken as 0");
        }
        let color = Rgb::from(rgb.map(|v| if finite(&v) { v.max(0.0) } else { 0.0 }));
        (!color.is_black()).then_some(color)
    }

    /// A length in metres above 0; `None` for a light that has no size.
    pub fn size(&mut self, what: &str, value: f64) -> Option<f32> {
        if value < 0.0 {
            self.note(format!("its {what} is negative: taken as {}", -value));
        }
        let size = value.abs() as f32;
        if size > 0.0 && size.is_finite() {
            return Some(size);
        }
        self.note(format!("its {what} is {value}"));
        None
    }

    /// `value` within `low` to `high`, or `low` for what is no number.
    pub fn clamped(&mut self, what: &str, value: f64, [low, high]: [f64; 2]) -> f64 {
        let taken = if value.is_nan() { low } else { value.clamp(low, high) };
        if taken != value {
            self.note(format!("its {what} is {value}: taken as {taken}"));
        }
        taken
    }
}
