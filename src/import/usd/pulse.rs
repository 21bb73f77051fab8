//! Whether composing gets on. The openusd crate can go around for ever among arcs of several layers, and nothing
//! stops it; whoever waits for the stage hears of it and lets it go.

use std::cell::RefCell;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use openusd::sdf::Path;

/// No prim that can be rendered takes as long to compose, the layers that it brings in included.
pub(super) const STILL: Duration = Duration::from_secs(120);

/// Of all threads that read a stage.
#[derive(Clone, Default)]
pub(super) struct Pulse(Arc<Mutex<State>>);

#[derive(Default)]
struct State {
    beats: u64,
    /// The prim that was reached last.
    at: String,
    /// True where all is composed.
    rests: bool,
}

thread_local! {
    static OWN: RefCell<Option<Pulse>> = const { RefCell::new(None) };
}

impl Pulse {
    /// That of this thread.
    pub fn own() -> Self {
        OWN.with_borrow(Clone::clone).unwrap_or_default()
    }

    /// Makes it that of this thread.
    pub fn adopt(self) {
        OWN.set(Some(self));
    }

    /// What comes by `receiver`.
    ///
    /// # Errors
    /// Nothing will come, or nothing more is composed for as long as `still`.
    pub fn wait<T>(&self, receiver: &Receiver<T>, still: Duration) -> Result<T, String> {
        loop {
            let before = self.state().beats;
            match receiver.recv_timeout(still) {
                Ok(value) => return Ok(value),
                Err(RecvTimeoutError::Disconnected) => return Err("its thread is gone".into()),
                Err(RecvTimeoutError::Timeout) => {
                    let state = self.state();
                    if !state.rests && state.beats > 0 && state.beats == before {
                        let (at, seconds) = (&state.at, still.as_secs());
                        return Err(format!("nothing came after {at} for {seconds} s: arcs that lead back to it?"));
                    }
                }
            }
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The prim at `path` is reached.
pub(super) fn beat(path: &Path) {
    OWN.with_borrow(|own| {
        if let Some(pulse) = own {
            let mut state = pulse.state();
            state.beats += 1;
            state.at.clear();
            state.at.push_str(path.as_str());
        }
    });
}

/// All is composed; what follows may take its time.
pub(super) fn rest() {
    OWN.with_borrow(|own| {
        if let Some(pulse) = own {
            pulse.state().rests = true;
        }
    });
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;

    #[test]
    fn what_stands_still_is_given_up_unless_it_rests() {
        let still = Duration::from_millis(20);
        let (sender, receiver) = mpsc::channel();
        let pulse = Pulse::default();
        pulse.clone().adopt();
        beat(&Path::new("/A/B").unwrap());
        let reason = pulse.wait(&receiver, still).unwrap_err();
        assert!(reason.contains("nothing came after /A/B"), "{reason}");
        rest();
        let late = std::thread::spawn(move || {
            std::thread::sleep(4 * still);
            sender.send(7)
        });
        assert_eq!(pulse.wait(&receiver, still), Ok(7));
        late.join().unwrap().unwrap();
        assert!(pulse.wait(&receiver, still).unwrap_err().contains("gone"));
    }
}
