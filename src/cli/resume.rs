//! `--resume` and `--checkpoint`: what a picture goes on from, and the state beside it.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{Arg, ArgAction, ArgMatches};
use penumbra::job::resume::{self, Found, Saver};
use penumbra::output::check_writable;
use penumbra::output::state::{Head, path_of};
use penumbra::render::{Observer, Rendered, Start, render_from};
use penumbra::scene::Scene;
use penumbra::settings::Settings;

use super::say;

pub fn args() -> [Arg; 2] {
    [
        Arg::new("resume").long("resume").action(ArgAction::SetTrue).conflicts_with("debug-sample").help(
            "Go on with OUT.exr from the state beside it, OUT.exr.state, as if it had never stopped, and keep that \
             state; begin anew where there is none",
        ),
        Arg::new("checkpoint")
            .long("checkpoint")
            .value_name("SECONDS")
            .value_parser(parse_checkpoint)
            .allow_negative_numbers(true)
            .help("Save the state for --resume every so many seconds, against crashes; never unless set"),
    ]
}

fn parse_checkpoint(text: &str) -> Result<Duration, String> {
    let seconds: f64 = text.parse().map_err(|_| "must be a number".to_string())?;
    match Duration::try_from_secs_f64(seconds) {
        Ok(every) if seconds >= 1.0 => Ok(every),
        _ => Err("must be a number of seconds, 1 or more".into()),
    }
}

/// A picture that another run may have begun.
pub struct Begun {
    state: PathBuf,
    /// What it is made of.
    pub identity: Head,
    /// True where the state stays when the picture is done.
    keeps: bool,
    every: Option<Duration>,
    found: Option<Found>,
}

impl Begun {
    /// The picture `out`, with `others` that the same render writes, as `args` ask for it.
    ///
    /// # Errors
    /// What can't be gone on from; a state that can't be written.
    pub fn of(
        args: &ArgMatches,
        out: &Path,
        others: &[&Path],
        identity: Head,
        settings: &Settings,
    ) -> anyhow::Result<Self> {
        let (keeps, every) = (args.get_flag("resume"), args.get_one::<Duration>("checkpoint").copied());
        let state = path_of(out);
        if keeps || every.is_some() {
            check_writable(&state)?;
        }
        let found = keeps.then(|| resume::find(out, others, &identity, settings)).transpose()?;
        if let Some(Found::Nothing(why)) = &found {
            say::err(format!("{}: {why}: it begins anew", out.display()));
        }
        Ok(Self { state, identity, keeps, every, found })
    }

    /// Says that nothing is left to do, where that is so.
    pub fn done(&self) -> Option<&str> {
        match &self.found {
            Some(Found::Done(what)) => Some(what),
            _ => None,
        }
    }

    /// Renders what is left of it, and gives the samples per pixel that there were.
    ///
    /// # Errors
    /// A damaged state, and those of [`render_from`].
    pub fn render(
        &mut self,
        scene: &Scene,
        settings: &Settings,
        observer: &dyn Observer,
    ) -> penumbra::error::Result<(Rendered, f64)> {
        let start = match self.found.take() {
            Some(Found::State(file)) => resume::read(*file, scene, settings)?,
            _ => Start::new(scene, settings)?,
        };
        let before = penumbra::job::samples_per_pixel(start.film());
        let saver = Saver::new(observer, self.state.clone(), self.identity.clone(), self.every);
        let rendered = render_from(start, scene, settings, &saver)?;
        if let Some(error) = saver.failure() {
            say::err(format!("warning: the state could not be saved on the way: {error}"));
        }
        Ok((rendered, before))
    }

    /// Saves the state of what was rendered, or removes one that is no longer that of the picture; true where the
    /// render can go on.
    pub fn keep(&self, rendered: &Rendered) -> bool {
        if !self.keeps && !rendered.interrupted {
            if let Err(error) = resume::discard(&self.state) {
                let state = self.state.display();
                say::err(format!("warning: {state}: this old state is not that of the picture, and stays: {error}"));
            }
            return false;
        }
        if rendered.was_done && self.state.exists() {
            return true;
        }
        let saved = resume::save(&self.state, &self.identity, rendered);
        if let Err(error) = &saved {
            say::err(format!("warning: {error}: --resume can't go on from here"));
        }
        saved.is_ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_a_second_or_more() {
        assert_eq!(parse_checkpoint("1.5"), Ok(Duration::from_millis(1500)));
        for text in ["0", "0.5", "-1", "NaN", "inf", "1e30", "often"] {
            assert!(parse_checkpoint(text).is_err(), "{text}");
        }
    }
}
