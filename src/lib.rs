//! Penumbra: a production render engine for shadows, ambient occlusion and honest noise figures.
//!
//! ```text
//! USD, glTF ──► SceneDesc ──prepare──► Scene ──integrator──► Film ──► EXR, PNG
//! ```
//!
//! What an artist wrote ([`desc`]) and what is traced ([`scene`]) are different types; files and the
//! terminal stay at the doors ([`import`], [`output`], the command line). The rooms, from the ground:
//!
//! - [`math`], [`error`], [`sampling`] (point patterns, warps, distributions);
//! - [`desc`]: the authored scene, filled by [`import`];
//! - [`bvh`], [`shape`], [`texture`], [`bsdf`], [`light`], [`camera`]: what rays meet; these do not
//!   know each other;
//! - [`scene`]: all of them together, made by [`scene::prepare`];
//! - [`settings`]: the table of everything that can be set; [`film`]: the table of passes and the sums
//!   behind them;
//! - [`integrator`]: one sample of one pixel; [`render`]: all of them; [`job`]: what the front doors share;
//! - [`compare`]: two pictures of one scene; [`converge`]: one scene in many ways, error against seconds;
//!   [`denoise`]: a denoiser that may be there; [`output`]: files and reports.
//!
//! ```no_run
//! use penumbra::{error::Warnings, import, output, render, scene, settings::Settings};
//!
//! let settings = Settings::default();
//! let path = std::path::Path::new("scene.glb");
//! let desc = import::scene(path, &import::ImportOptions::default(), &mut Warnings::new())?;
//! let prepared = scene::prepare(desc, &scene::View::default(), &settings)?;
//! let picture = render::render(&prepared.scene, &settings, &())?.film.develop();
//! output::exr::write("out.exr".as_ref(), &picture, &Default::default(), &Default::default())?;
//! # Ok::<(), penumbra::error::Error>(())
//! ```

pub mod bsdf;
pub mod bvh;
pub mod camera;
pub mod compare;
pub mod converge;
pub mod denoise;
pub mod desc;
pub mod error;
pub mod film;
pub mod import;
pub mod integrator;
pub mod job;
pub mod light;
pub mod math;
pub mod output;
pub mod plan;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod settings;
pub mod shape;
pub mod texture;
