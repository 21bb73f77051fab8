//! A render on a thread of its own, watched by the thread that asked for it.

use std::sync::Arc;
use std::time::{Duration, Instant};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::observer::{Mailbox, Received};
use super::picture::Picture;
use penumbra::error::Result;
use penumbra::film;
use penumbra::output::Metadata;
use penumbra::plan::Plan;
use penumbra::render::Progress;

/// How often the watcher is asked whether to go on, at least.
const PULSE: Duration = Duration::from_millis(50);

/// What a caller wants to hear of a render.
pub struct Watch {
    /// Called with a dict of progress; a true answer stops the render.
    pub observer: Option<Py<PyAny>>,
    /// Called with pictures on the way.
    pub on_picture: Option<Py<PyAny>>,
    /// Between the ends of two such calls.
    pub picture_interval: Duration,
}

/// Runs `work` on a thread of its own. The calling thread sleeps without the interpreter's lock, and
/// holds it to call `watch`; an exception there stops the render and is raised once it has ended.
pub fn run<T: Send>(py: Python<'_>, watch: &Watch, work: impl FnOnce(&Mailbox) -> Result<T> + Send) -> PyResult<T> {
    let mailbox = Arc::new(Mailbox::default());
    let mut raised = None;
    let done = py.detach(|| {
        std::thread::scope(|scope| {
            let thread = scope.spawn(|| {
                // Told even where `work` panics.
                let _end = OnDrop(|| mailbox.finish());
                work(&mailbox)
            });
            raised = Python::attach(|py| attend(py, watch, &mailbox)).err();
            thread.join()
        })
    });
    if let Some(error) = raised {
        return Err(error);
    }
    match done {
        Ok(result) => result.map_err(|error| super::exception(&error)),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
            Err(PyRuntimeError::new_err(format!("the engine failed, which is a bug in it: {text}")))
        }
    }
}

/// Hears of the render until it ends.
fn attend(py: Python<'_>, watch: &Watch, mailbox: &Mailbox) -> PyResult<()> {
    let mut next_picture = Instant::now() + watch.picture_interval;
    loop {
        if watch.on_picture.is_some() && Instant::now() >= next_picture {
            mailbox.want_picture();
        }
        let Received { progress, picture, finished } = py.detach(|| mailbox.wait(PULSE));
        let answer = tell(py, watch, progress, picture);
        match &answer {
            Ok(heard) => {
                if heard.picture {
                    next_picture = Instant::now() + watch.picture_interval;
                }
                if heard.stop {
                    mailbox.cancel();
                }
            }
            Err(_) => mailbox.cancel(),
        }
        if finished {
            return answer.map(drop);
        }
        if answer.is_err() {
            while !py.detach(|| mailbox.wait(PULSE)).finished {}
            return answer.map(drop);
        }
    }
}

/// What came of telling.
struct Heard {
    stop: bool,
    picture: bool,
}

fn tell(py: Python<'_>, watch: &Watch, progress: Option<Progress>, picture: Option<film::Picture>) -> PyResult<Heard> {
    py.check_signals()?;
    let mut heard = Heard { stop: false, picture: picture.is_some() };
    if let (Some(on_picture), Some(picture)) = (&watch.on_picture, picture) {
        let picture =
            Picture { picture, metadata: Metadata::default(), half: false, plan: Plan::default(), interrupted: false };
        on_picture.call1(py, (picture,))?;
    }
    if let Some(observer) = &watch.observer {
        let told = progress.map(|progress| progress_dict(py, &progress)).transpose()?;
        heard.stop = observer.call1(py, (told,))?.is_truthy(py)?;
    }
    Ok(heard)
}

fn progress_dict<'py>(py: Python<'py>, progress: &Progress) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("done", progress.done)?;
    dict.set_item("spp", progress.spp)?;
    dict.set_item("target_spp", progress.target_spp)?;
    dict.set_item("elapsed", progress.elapsed.as_secs_f64())?;
    dict.set_item("remaining", progress.remaining.map(|left| left.as_secs_f64()))?;
    let outlook = progress.outlook;
    dict.set_item("error", outlook.and_then(|outlook| outlook.error))?;
    dict.set_item("error_at_end", outlook.and_then(|outlook| outlook.at_end))?;
    dict.set_item("error_target", outlook.and_then(|outlook| outlook.target))?;
    dict.set_item("to_target", progress.to_target())?;
    Ok(dict)
}

/// Calls a function when it goes.
struct OnDrop<F: Fn()>(F);

impl<F: Fn()> Drop for OnDrop<F> {
    fn drop(&mut self) {
        (self.0)();
    }
}
