//! What a render begins with: nothing, or all that another one has left.

use std::io::{self, Read, Write};
use std::time::Duration;

use super::forecast::Forecast;
use super::plan::Plan;
use crate::error::{Error, Place, Result};
use crate::film::Film;
use crate::scene::Scene;
use crate::settings::Settings;

/// How a render came to where it is, but for its sums.
#[derive(Clone, Debug)]
pub(super) struct Course {
    /// Time that it has taken so far.
    pub(super) elapsed: Duration,
    /// The last step at which its error was looked at, in samples per pixel.
    pub(super) step: u32,
    pub(super) forecast: Forecast,
    /// Where pixels differ in their number of samples.
    pub(super) plan: Option<Plan>,
}

/// What a render begins with.
#[derive(Debug)]
pub struct Start {
    pub(super) film: Film,
    pub(super) course: Course,
}

impl Start {
    /// Nothing.
    ///
    /// # Errors
    /// A picture too large for the memory that there is.
    pub fn new(scene: &Scene, settings: &Settings) -> Result<Self> {
        let [width, height] = scene.size;
        // Asked for beforehand, since what runs out in the middle aborts the process.
        let bytes = Film::bytes_needed(width, height, &scene.passes);
        let there = usize::try_from(bytes).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok());
        if !there {
            return Err(Error::Unsupported {
                place: Place::default(),
                what: format!("a picture of {width}x{height} pixels needs {} MiB, which are not there", bytes >> 20),
            });
        }
        let film = Film::new(width, height, scene.passes.clone());
        let plan = (settings.adaptive && scene.passes.has_error()).then(|| Plan::new(&film));
        let forecast = Forecast::new(settings.error, settings.adaptive);
        Ok(Self { film, course: Course { elapsed: Duration::ZERO, step: 0, forecast, plan } })
    }

    /// What [`State::write`] has written of a render of the same scene, size, passes, and settings but for stop rules.
    ///
    /// # Errors
    /// Those of `from`, data that come from no render; a picture too large for memory.
    pub fn read(scene: &Scene, settings: &Settings, from: &mut dyn Read) -> Result<io::Result<Self>> {
        let mut start = Self::new(scene, settings)?;
        Ok(start.load(from).map(|()| start))
    }

    fn load(&mut self, from: &mut dyn Read) -> io::Result<()> {
        let mut head = [0; 12];
        from.read_exact(&mut head)?;
        let (seconds, step) = head.split_at(8);
        let seconds = f64::from_le_bytes(seconds.try_into().unwrap_or_default());
        self.course.elapsed = Duration::try_from_secs_f64(seconds)
            .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, format!("{error}")))?;
        self.course.step = u32::from_le_bytes(step.try_into().unwrap_or_default());
        self.course.forecast.load(from)?;
        if let Some(plan) = &mut self.course.plan {
            plan.load(from)?;
        }
        self.film.load(from)
    }

    /// What it takes to begin there again.
    pub fn state(&self) -> State<'_> {
        State { film: &self.film, course: &self.course }
    }

    /// The sums so far.
    pub fn film(&self) -> &Film {
        &self.film
    }
}

/// All that a render needs to go on later as if it had never stopped.
#[derive(Clone, Copy, Debug)]
pub struct State<'a> {
    /// The sums so far.
    pub film: &'a Film,
    pub(super) course: &'a Course,
}

impl State<'_> {
    /// Writes it without loss.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let Course { elapsed, step, forecast, plan } = self.course;
        out.write_all(&elapsed.as_secs_f64().to_le_bytes())?;
        out.write_all(&step.to_le_bytes())?;
        forecast.save(out)?;
        if let Some(plan) = plan {
            plan.save(out)?;
        }
        self.film.save(out)
    }
}
