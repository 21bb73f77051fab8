//! What a picture says about its own making.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use crate::film::cryptomatte::Manifest;
use crate::film::{Accuracy, Doubt, Figure, SampleId};

/// Written into the header of the EXR file's first part. Names follow what others read: `software`,
/// `owner`, `comments`, `capDate`, `utcOffset` of the OpenEXR standard; `File`, `Camera`, `Frame`,
/// `RenderTime` as Blender stamps them; the rest as `penumbra/…`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Metadata {
    /// Path of the scene, as given.
    pub scene: String,
    /// Name of the camera.
    pub camera: String,
    /// Frame, where the scene has time.
    pub frame: Option<f64>,
    /// Samples per pixel, mean over the picture.
    pub samples: f64,
    /// Seed of the samplers.
    pub seed: u64,
    /// Wall-clock time of the render, in seconds.
    pub seconds: f64,
    /// The picture's errors, where they were asked for.
    pub accuracy: Option<Accuracy>,
    /// When the render ended; `None` leaves the date out.
    pub date: Option<SystemTime>,
    /// Samples that were dropped as not finite.
    pub non_finite: u64,
    /// The first of them.
    pub non_finite_first: Option<SampleId>,
    /// What the import and the render warned of.
    pub warnings: Vec<String>,
    /// Settings that shaped the picture, as name and value.
    pub settings: Vec<(String, String)>,
    /// Who owns the picture.
    pub owner: Option<String>,
    /// Where the time went: seconds by what took them.
    pub times: Vec<(String, f64)>,
    /// Effects that were simulated, by name: see [`Effects`](crate::scene::Effects).
    pub effects: Vec<&'static str>,
    /// Shares of a sample's time by what they went into, with their standard errors, where that was measured.
    pub costs: Vec<(String, [f64; 2])>,
    /// What made the picture, as far as it changes a sample, as names and values: see
    /// [`identity`](crate::job::identity).
    pub identity: Vec<(String, String)>,
    /// What ended the render, as "samples".
    pub ended_by: String,
    /// Free text.
    pub comments: Option<String>,
    /// Names behind the Cryptomatte ids.
    pub manifests: Vec<Manifest>,
}

impl Metadata {
    /// Name and version of this engine.
    pub const SOFTWARE: &'static str = concat!("Penumbra ", env!("CARGO_PKG_VERSION"));

    /// The attribute that holds [`Metadata::ended_by`].
    pub const ENDED_BY: &'static str = "penumbra/ended_by";

    /// The attribute that holds [`Metadata::identity`], as JSON.
    pub const IDENTITY: &'static str = "penumbra/identity";

    /// Attributes other than the standard's own, as name and text.
    pub(super) fn attributes(&self) -> Vec<(String, String)> {
        let mut list = Vec::new();
        let mut add = |name: &str, value: String| list.push((name.to_owned(), value));
        add("File", self.scene.clone());
        add("Camera", self.camera.clone());
        if let Some(frame) = self.frame {
            add("Frame", frame.to_string());
        }
        add("RenderTime", clock(self.seconds));
        add("penumbra/version", env!("CARGO_PKG_VERSION").to_owned());
        add("penumbra/samples", self.samples.to_string());
        add("penumbra/seed", self.seed.to_string());
        add("penumbra/seconds", format!("{:.3}", self.seconds));
        if let Some(Accuracy { rmse, rel_mse, display }) = self.accuracy {
            for (name, figure) in [("display", display), ("rmse", rmse), ("rel_mse", rel_mse)] {
                add(&format!("penumbra/error/{name}"), error(figure));
            }
        }
        add("penumbra/non_finite", self.non_finite.to_string());
        if let Some(SampleId { x, y, index }) = self.non_finite_first {
            add("penumbra/non_finite_first", format!("{x},{y},{index}"));
        }
        if !self.warnings.is_empty() {
            add("penumbra/warnings", self.warnings.join("\n"));
        }
        for (name, value) in &self.settings {
            add(&format!("penumbra/settings/{name}"), value.clone());
        }
        if !self.effects.is_empty() {
            add("penumbra/effects", self.effects.join("; "));
        }
        for (name, seconds) in &self.times {
            add(&format!("penumbra/time/{name}"), format!("{seconds:.3}"));
        }
        for (name, [share, error]) in &self.costs {
            add(&format!("penumbra/cost/{name}"), format!("{share:.4} {error:.4}"));
        }
        if !self.ended_by.is_empty() {
            add(Self::ENDED_BY, self.ended_by.clone());
        }
        if !self.identity.is_empty() {
            add(Self::IDENTITY, serde_json::to_string(&self.identity).unwrap_or_default());
        }
        list
    }

    /// `YYYY:MM:DD hh:mm:ss` in UTC, the form that `capDate` has.
    pub(super) fn cap_date(&self) -> Option<String> {
        let since: Duration = self.date?.duration_since(UNIX_EPOCH).ok()?;
        let (days, seconds) = (since.as_secs() / 86_400, since.as_secs() % 86_400);
        let (year, month, day) = civil(days);
        let (h, m, s) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
        Some(format!("{year:04}:{month:02}:{day:02} {h:02}:{m:02}:{s:02}"))
    }
}

/// Value and both ends of its 95 % interval, or why there is none.
fn error(figure: Result<Figure, Doubt>) -> String {
    match figure {
        Ok(Figure { value, low, high }) => format!("{value:.4e} {low:.4e} {high:.4e}"),
        Err(doubt) => format!("not estimable yet: {doubt}"),
    }
}

/// `mm:ss.cc`, with hours where there are some, as Blender writes times.
fn clock(seconds: f64) -> String {
    let centis = (seconds.max(0.0) * 100.0).round() as u64;
    let (h, m, s, c) = (centis / 360_000, centis / 6000 % 60, centis / 100 % 60, centis % 100);
    if h > 0 { format!("{h:02}:{m:02}:{s:02}.{c:02}") } else { format!("{m:02}:{s:02}.{c:02}") }
}

/// Year, month and day of a day counted from 1970-01-01, in the Gregorian calendar.
///
/// Edward Reingold, Nachum Dershowitz: *Calendrical Calculations*; years are taken from March, so
/// that the leap day is the last.
fn civil(days: u64) -> (u64, u64, u64) {
    let days = days + 719_468; // from 0000-03-01
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    (era * 400 + year + u64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        let at = |seconds| Metadata { date: Some(UNIX_EPOCH + Duration::from_secs(seconds)), ..Metadata::default() };
        let known = [
            (0, "1970:01:01 00:00:00"),
            (951_782_399, "2000:02:28 23:59:59"),
            (951_782_400, "2000:02:29 00:00:00"),
            (1_735_689_599, "2024:12:31 23:59:59"),
            (4_107_542_400, "2100:03:01 00:00:00"),
        ];
        for (seconds, text) in known {
            assert_eq!(at(seconds).cap_date().as_deref(), Some(text));
        }
        assert_eq!(Metadata::default().cap_date(), None);
    }

    #[test]
    fn render_times_look_like_blenders() {
        assert_eq!(clock(0.05), "00:00.05");
        assert_eq!(clock(59.999), "01:00.00");
        assert_eq!(clock(3_725.5), "01:02:05.50");
    }
}
