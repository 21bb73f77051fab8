//! Progress on stderr: a bar for people at a terminal, JSON lines for machines, and Ctrl-C.

use std::io::IsTerminal;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use penumbra::output::Metadata;
use penumbra::render::{Observer, Progress};
use serde_json::{Value, json};

use super::say;

/// Set by the first Ctrl-C; the second one ends the process.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// True while there may be something to save.
static RENDERING: AtomicBool = AtomicBool::new(false);

/// Makes Ctrl-C stop the render instead of the process, and a second one the process.
pub fn catch_interrupts() {
    let handler = || {
        if !RENDERING.load(Ordering::SeqCst) {
            say::err("\ninterrupted before the first sample: nothing to save");
            std::process::exit(i32::from(super::INTERRUPTED));
        }
        if INTERRUPTED.swap(true, Ordering::SeqCst) {
            say::err("discarded");
            std::process::exit(i32::from(super::INTERRUPTED));
        }
        say::err("\nstopping, and saving what is there; Ctrl-C again discards it");
    };
    // Without a handler Ctrl-C ends the process as ever, which is all that can be done then.
    if let Err(error) = ctrlc::set_handler(handler) {
        say::err(format!("warning: Ctrl-C will lose the render: {error}"));
    }
}

/// From now on, or no longer, Ctrl-C stops a render and has it saved.
pub fn rendering(is_rendering: bool) {
    RENDERING.store(is_rendering, Ordering::SeqCst);
}

/// True once Ctrl-C was pressed.
pub fn interrupted() -> bool {
    INTERRUPTED.load(Ordering::SeqCst)
}

/// How progress is told.
pub enum Reporter {
    Bar(ProgressBar),
    Json { output: String, frame: Option<f64>, last: Mutex<Value> },
    None,
}

impl Reporter {
    /// By the name that `--progress` takes, for the picture `out` of `frame`.
    pub fn new(kind: &str, out: &Path, frame: Option<f64>) -> Self {
        match kind {
            "json" => Self::Json { output: out.display().to_string(), frame, last: Mutex::default() },
            "bar" if std::io::stderr().is_terminal() => {
                let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr_with_hz(10));
                let style = ProgressStyle::with_template("{bar:30} {percent:>3}%  {msg}");
                bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
                Self::Bar(bar)
            }
            _ => Self::None,
        }
    }

    /// Tells machines that the picture is written: the last line again, with where the time went.
    pub fn written(&self, metadata: &Metadata) {
        let Self::Json { last, .. } = self else { return };
        let mut line = last.lock().unwrap_or_else(PoisonError::into_inner).clone();
        line["ended_by"] = json!(metadata.ended_by);
        line["time_s"] = metadata.times.iter().map(|(name, seconds)| (name.clone(), json!(seconds))).collect();
        if !metadata.costs.is_empty() {
            line["costs"] = metadata.costs.iter().map(|(name, cost)| (name.clone(), json!(cost))).collect();
        }
        say::err(line.to_string());
    }

    /// Clears the bar.
    pub fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

impl Observer for Reporter {
    fn progress(&self, progress: &Progress) {
        let left = progress.remaining.map(|left| left.as_secs_f64());
        match self {
            Self::Bar(bar) => {
                bar.set_position((progress.done * 1000.0) as u64);
                let of = progress.target_spp.map(|n| format!("/{n}")).unwrap_or_default();
                let left = left.map_or_else(|| "?".into(), clock);
                let error = progress.outlook.map(|_| format!("  {}", error(progress))).unwrap_or_default();
                bar.set_message(format!("{:.0}{of} spp  {left} left{error}", progress.spp));
            }
            Self::Json { output, frame, last } => {
                let mut line = json!({
                    "output": output,
                    "frame": frame,
                    "done": progress.done,
                    "spp": progress.spp,
                    "target_spp": progress.target_spp,
                    "elapsed_s": progress.elapsed.as_secs_f64(),
                    "remaining_s": left,
                });
                if let Some(outlook) = progress.outlook {
                    line["error"] = json!(outlook.error);
                    line["error_at_end"] = json!(outlook.at_end);
                    line["error_target"] = json!(outlook.target);
                    line["to_target_s"] = json!(progress.to_target());
                }
                say::err(line.to_string());
                *last.lock().unwrap_or_else(PoisonError::into_inner) = line;
            }
            Self::None => {}
        }
    }

    fn cancelled(&self) -> bool {
        interrupted()
    }
}

/// Error now, at the end, and the time to its target, as far as they are known.
fn error(progress: &Progress) -> String {
    let Some(outlook) = progress.outlook else { return String::new() };
    let Some(now) = outlook.error else { return "error not estimable yet".into() };
    let mut text = format!("error {now:.2e}");
    if let Some(end) = outlook.at_end {
        text += &format!(", {end:.2e} at the end");
    }
    if let (Some(target), Some([likely, low, high])) = (outlook.target, progress.to_target()) {
        text += &format!(", {target} in {} ({} to {})", clock(likely), clock(low), clock(high));
    }
    text
}

/// `1:02:03`, `2:03` or `3.4 s`.
pub fn clock(seconds: f64) -> String {
    if seconds < 10.0 {
        return format!("{seconds:.1} s");
    }
    let s = seconds.round() as u64;
    match (s / 3600, s / 60 % 60, s % 60) {
        (0, 0, s) => format!("{s} s"),
        (0, m, s) => format!("{m}:{s:02}"),
        (h, m, s) => format!("{h}:{m:02}:{s:02}"),
    }
}

#[cfg(test)]
mod tests {
    use super::{clock, error};
    use penumbra::render::{Outlook, Progress};
    use std::time::Duration;

    #[test]
    fn the_error_is_told_as_far_as_it_is_known() {
        let unknown = Outlook { error: None, at_end: None, target: Some(0.01), target_at: None };
        let mut progress = Progress {
            spp: 64.0,
            target_spp: None,
            done: 0.5,
            elapsed: Duration::from_secs(5),
            remaining: None,
            outlook: Some(unknown),
        };
        assert_eq!(error(&progress), "error not estimable yet");
        let known = Outlook { error: Some(0.02), at_end: Some(0.005), target_at: Some([25.0, 20.0, 95.0]), ..unknown };
        progress.outlook = Some(known);
        let text = "error 2.00e-2, 5.00e-3 at the end, 0.01 in 20 s (15 s to 1:30)";
        assert_eq!(error(&progress), text);
        progress.outlook = None;
        assert_eq!(error(&progress), "");
    }

    #[test]
    fn times_read_as_people_write_them() {
        assert_eq!([0.04, 9.94, 59.4, 61.0, 3725.0].map(clock), ["0.0 s", "9.9 s", "59 s", "1:01", "1:02:05"]);
    }
}
