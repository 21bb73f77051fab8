//! Bad numbers of a light and what they are taken as, told in one warning.

use crate::desc::LightDesc;
use crate::error::{Place, Warnings};
use crate::math::Rgb;

/// Nothing is brighter, W·sr⁻¹·m⁻² and the like: sums over pixels and samples stay far below the end of
/// `f32`.
pub const LARGEST: f32 = 1e30;

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

    /// One warning for all notes on `light`.
    pub fn tell(self, light: &LightDesc, left_out: bool, warnings: &mut Warnings) {
        if !self.notes.is_empty() {
            let notes = self.notes.join("; ");
            let end = if left_out { "; it emits nothing and is left out" } else { "" };
            warnings.push(&light.place, format!("light \"{}\": {notes}{end}", light.name));
        }
    }

    /// One warning for all notes on what stands at `place`, which names it.
    pub fn tell_at(self, place: &Place, warnings: &mut Warnings) {
        if !self.notes.is_empty() {
            warnings.push(place, self.notes.join("; "));
        }
    }

    /// `rgb` without what is no light, black where nothing is left; `what` names it.
    pub fn color(&mut self, what: &str, rgb: [f64; 3]) -> Rgb {
        if rgb.iter().any(|v| v.is_finite() && *v < 0.0) {
            self.note(format!("its {what} is negative: taken as 0"));
        }
        self.signed_color(what, rgb.map(|v| if v < 0.0 { 0.0 } else { v }))
    }

    /// `rgb` where light may be taken away, too.
    pub fn signed_color(&mut self, what: &str, rgb: [f64; 3]) -> Rgb {
        let largest = f64::from(LARGEST);
        for (bad, is, taken) in [
            (rgb.iter().any(|v| !v.is_finite()), "not finite", "0"),
            (rgb.iter().any(|v| v.is_finite() && v.abs() > largest), "too bright", "1e30"),
        ] {
            if bad {
                self.note(format!("its {what} is {is}: taken as {taken}"));
            }
        }
        Rgb::from(rgb.map(|v| if v.is_finite() { v.clamp(-largest, largest) } else { 0.0 }))
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
