//! Between the render's threads and the thread that waits for them.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use penumbra::error::Stop;
use penumbra::film::{Film, Picture};
use penumbra::render::{Observer, Progress};

/// What the render's threads leave for the waiting one.
#[derive(Default)]
struct News {
    progress: Option<Progress>,
    picture: Option<Picture>,
    finished: bool,
}

/// The news, a bell, and a wish to stop.
#[derive(Default)]
pub struct Mailbox {
    news: Mutex<News>,
    bell: Condvar,
    stop: Stop,
    /// A picture is wanted at the end of the next wave.
    wants_picture: AtomicBool,
}

/// What has come in.
pub struct Received {
    /// How far the render is, if it was told.
    pub progress: Option<Progress>,
    /// The picture so far, if one was wanted.
    pub picture: Option<Picture>,
    /// True after the end.
    pub finished: bool,
}

impl Mailbox {
    fn lock(&self) -> MutexGuard<'_, News> {
        self.news.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Stops the render soon.
    pub fn cancel(&self) {
        self.stop.wish();
    }

    /// What asks whether to stop before there is a render.
    pub fn stop(&self) -> &Stop {
        &self.stop
    }

    /// Asks for the picture as it is after the next wave.
    pub fn want_picture(&self) {
        self.wants_picture.store(true, Ordering::Relaxed);
    }

    /// Tells that nothing more comes.
    pub fn finish(&self) {
        self.lock().finished = true;
        self.bell.notify_all();
    }

    /// Waits for news, for `longest` at most, and takes them.
    pub fn wait(&self, longest: Duration) -> Received {
        let news = self.lock();
        let quiet = |news: &mut News| news.progress.is_none() && news.picture.is_none() && !news.finished;
        let (mut news, _) = self.bell.wait_timeout_while(news, longest, quiet).unwrap_or_else(PoisonError::into_inner);
        Received { progress: news.progress.take(), picture: news.picture.take(), finished: news.finished }
    }
}

impl Observer for Mailbox {
    fn progress(&self, progress: &Progress) {
        self.lock().progress = Some(*progress);
        self.bell.notify_all();
    }

    fn wave(&self, film: &Film) {
        if self.wants_picture.swap(false, Ordering::Relaxed) {
            let picture = film.develop();
            self.lock().picture = Some(picture);
            self.bell.notify_all();
        }
    }

    fn cancelled(&self) -> bool {
        self.stop.is_wished()
    }
}
