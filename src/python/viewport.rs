//! A picture that begins coarse, refines, and starts again where the scene or the view changes.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::exception;
use super::render::settings_of;
use super::scene::Scene;
use penumbra::desc::{CameraDesc, RenderDesc};
use penumbra::error::{Error, Result, Warnings};
use penumbra::film::Film;
use penumbra::import::blender::ViewData;
use penumbra::job;
use penumbra::render::{Observer, render};
use penumbra::scene::{self, Cache, View, prepare_with};
use penumbra::settings::Settings;

/// Sizes of the first pictures, as parts of the whole: something is to be seen at once.
const COARSE: [u32; 3] = [8, 4, 2];

/// Combined of a picture, rows from the bottom.
struct Shown {
    size: [u32; 2],
    rgba: Vec<f32>,
    spp: f64,
}

/// Between the render's thread and whoever draws.
#[derive(Default)]
struct Screen {
    shown: Mutex<Option<Shown>>,
    stop: AtomicBool,
}

impl Screen {
    fn lock(&self) -> MutexGuard<'_, Option<Shown>> {
        self.shown.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Observer for Screen {
    fn wave(&self, film: &Film) {
        // Whoever stops the render waits for it, and wants no picture of it.
        if self.cancelled() {
            return;
        }
        let picture = film.develop();
        let Some(layer) = picture.layer("Combined") else { return };
        let row = picture.width as usize * layer.channels.len();
        let rgba = layer.data.chunks_exact(row.max(1)).rev().flatten().copied().collect();
        let (size, spp) = ([picture.width, picture.height], job::samples_per_pixel(film));
        *self.lock() = Some(Shown { size, rgba, spp });
    }

    fn cancelled(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// What is rendered, and by whom.
#[derive(Default)]
struct Session {
    /// The scene as prepared, while no thread has it.
    scene: Option<scene::Scene>,
    settings: Settings,
    exposure: f64,
    cache: Option<Cache>,
    thread: Option<JoinHandle<scene::Scene>>,
    warnings: Vec<String>,
}

/// The rendered viewport of a scene.
#[pyclass(frozen)]
pub struct Viewport {
    session: Mutex<Session>,
    screen: Arc<Screen>,
}

#[pymethods]
impl Viewport {
    #[new]
    fn new() -> Self {
        Self { session: Mutex::default(), screen: Arc::default() }
    }

    /// Shows `scene` through `view`, JSON of matrices, sizes and lens. Where `changed` is false nothing but the
    /// view is new, and nothing else is prepared again. Settings are those of `render`.
    #[pyo3(signature = (scene, view, changed, **settings))]
    fn show(
        &self,
        py: Python<'_>,
        scene: &Bound<'_, Scene>,
        view: &str,
        changed: bool,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let (settings, _) = settings_of(settings)?;
        let view = ViewData::parse(view).map_err(|error| exception(&error))?;
        let scene = scene.get();
        py.detach(|| self.start(scene, &view, changed, settings)).map_err(|error| exception(&error))
    }

    /// The newest picture, once: width, height, RGBA of all pixels from the bottom, samples per pixel. `None`
    /// where there is no newer one.
    fn picture<'py>(&self, py: Python<'py>) -> Option<(u32, u32, Bound<'py, PyArray1<f32>>, f64)> {
        let Shown { size: [width, height], rgba, spp } = self.screen.lock().take()?;
        Some((width, height, PyArray1::from_vec(py, rgba), spp))
    }

    /// True where a picture waits.
    fn has_news(&self) -> bool {
        self.screen.lock().is_some()
    }

    /// What was replaced or left out of the scene.
    fn warnings(&self) -> Vec<String> {
        self.session().warnings.clone()
    }

    /// Ends the render.
    fn stop(&self, py: Python<'_>) {
        py.detach(|| self.halt(&mut self.session()));
    }
}

impl Viewport {
    fn session(&self) -> MutexGuard<'_, Session> {
        self.session.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Stops the thread, and takes the scene back from it.
    fn halt(&self, session: &mut Session) {
        self.screen.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = session.thread.take() {
            // A thread that panicked has no scene to give back: it is prepared anew.
            session.scene = thread.join().ok();
        }
        self.screen.stop.store(false, Ordering::Relaxed);
    }

    fn start(&self, source: &Scene, view: &ViewData, changed: bool, settings: Settings) -> Result<()> {
        let session = &mut *self.session();
        self.halt(session);
        *self.screen.lock() = None;
        let lit_by_view = |scene: &scene::Scene| scene.follows_camera;
        if changed || session.scene.as_ref().is_none_or(lit_by_view) || settings != session.settings {
            let mut warnings = Warnings::new();
            let mut source = source.lock();
            source.keep_images();
            let mut desc = source.scene(&mut warnings)?;
            drop(source);
            session.exposure = desc.cameras.first().map_or(1.0, |camera| camera.exposure);
            let camera = view.camera(session.exposure, &desc.place);
            desc.cameras = vec![camera];
            desc.render = RenderDesc {
                film_transparent: desc.render.film_transparent,
                transparent_glass: desc.render.transparent_glass,
                ..RenderDesc::default()
            };
            let view = View { camera: None, size: Some(view.size) };
            let cache = session.cache.get_or_insert_with(Cache::new);
            let prepared = prepare_with(desc, &view, &settings, cache)?;
            warnings.extend(prepared.warnings);
            session.warnings = warnings.iter().map(ToString::to_string).collect();
            session.scene = Some(prepared.scene);
            session.settings = settings;
        }
        let Some(scene) = session.scene.take() else { return Err(Error::Cancelled) };
        let camera = view.camera(session.exposure, &Default::default());
        let (screen, settings) = (self.screen.clone(), session.settings.clone());
        let (size, border) = (view.size, view.border);
        session.thread = Some(std::thread::spawn(move || refine(scene, &camera, size, border, &settings, &screen)));
        Ok(())
    }
}

/// Coarse pictures, then the fine one.
fn refine(
    mut scene: scene::Scene,
    camera: &CameraDesc,
    size: [u32; 2],
    border: Option<[u32; 4]>,
    settings: &Settings,
    screen: &Screen,
) -> scene::Scene {
    let once = Settings { spp: 1, ..settings.clone() };
    let levels = COARSE.map(|part| (part, &once)).into_iter().chain([(1, settings)]);
    for (part, settings) in levels {
        let whole = size.map(|n| n.div_ceil(part));
        let crop = border.map(|[left, top, width, height]| {
            let (left, top) = (left / part, top / part);
            [left, top, width.div_ceil(part).min(whole[0] - left), height.div_ceil(part).min(whole[1] - top)]
        });
        let wanted = RenderDesc { crop, ..RenderDesc::default() };
        if screen.cancelled() || scene.look(camera, &wanted, whole).is_err() {
            break;
        }
        if render(&scene, settings, screen).is_err() {
            break;
        }
    }
    scene
}

impl Drop for Viewport {
    fn drop(&mut self) {
        self.halt(&mut self.session());
    }
}
