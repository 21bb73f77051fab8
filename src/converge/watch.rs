//! Takes pictures of a render while it goes on.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use super::Shot;
use crate::denoise::{Denoiser, Noisy};
use crate::film::{Film, Layer, Picture};
use crate::render::Observer;

/// Samples per pixel at the first picture.
const FIRST: f64 = 4.0;

/// Looks at the film whenever its samples have doubled.
pub(super) struct Watch<'a> {
    layer: &'a str,
    denoiser: Option<&'a Denoiser>,
    threads: u32,
    state: Mutex<State>,
}

struct State {
    start: Instant,
    /// Seconds that looking took.
    looking: f64,
    next: f64,
    shots: Vec<Shot>,
    failed: Option<String>,
}

impl<'a> Watch<'a> {
    /// Of a render that begins now.
    pub(super) fn new(layer: &'a str, denoiser: Option<&'a Denoiser>, threads: u32) -> Self {
        let state = State { start: Instant::now(), looking: 0.0, next: FIRST, shots: Vec::new(), failed: None };
        Self { layer, denoiser, threads, state: Mutex::new(state) }
    }

    /// All pictures, that of the finished film last.
    ///
    /// # Errors
    /// A layer that is not there; what the denoiser complained of.
    pub(super) fn shots(self, film: &Film) -> Result<Vec<Shot>, String> {
        self.look(film, true);
        let state = self.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        state.failed.map_or(Ok(state.shots), Err)
    }

    fn look(&self, film: &Film, is_end: bool) {
        let spp = film.samples() as f64 / (f64::from(film.width()) * f64::from(film.height()));
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let known = state.shots.last().is_some_and(|shot| shot.spp == spp);
        if known || (spp < state.next && !is_end) || state.failed.is_some() {
            return;
        }
        let now = Instant::now();
        let seconds = (now - state.start).as_secs_f64() - state.looking;
        while state.next <= spp {
            state.next *= 2.0;
        }
        let picture = film.develop();
        let shot = match self.values(&picture) {
            Ok((values, denoising)) => Some(Shot { spp, seconds: seconds + denoising, values }),
            Err(what) => {
                state.failed = Some(what);
                None
            }
        };
        state.shots.extend(shot);
        state.looking += now.elapsed().as_secs_f64();
    }

    /// The layer, and the seconds that denoising it took.
    fn values(&self, picture: &Picture) -> Result<(Vec<f32>, f64), String> {
        let of = |name: &str| picture.layer(name).ok_or_else(|| format!("the picture has no layer {name}"));
        let color = three(of(self.layer)?);
        let Some(denoiser) = self.denoiser else { return Ok((color, 0.0)) };
        let (albedo, normal) = (three(of("Denoising Albedo")?), three(of("Denoising Normal")?));
        let start = Instant::now();
        let noisy = Noisy { width: picture.width as usize, color: &color, albedo: &albedo, normal: &normal };
        let clean = denoiser.denoised(&noisy, self.threads)?;
        Ok((clean, start.elapsed().as_secs_f64()))
    }
}

/// The first three channels; of one channel it three times.
fn three(layer: &Layer) -> Vec<f32> {
    let n = layer.channels.len();
    layer.data.chunks_exact(n).flat_map(|pixel| [pixel[0], pixel[1.min(n - 1)], pixel[2.min(n - 1)]]).collect()
}

impl Observer for Watch<'_> {
    fn wave(&self, film: &Film) {
        self.look(film, false);
    }
}
