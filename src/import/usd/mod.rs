//! The USD door: `.usda`, `.usdc`, `.usd` and `.usdz` to a `SceneDesc`.
//!
//! The stage is composed by the `openusd` crate (docs/decisions/0001-usd.md); what its prims mean is
//! read here. USD's schemas: <https://openusd.org/release/api/>.
//!
//! ```text
//! stage ─► crew ─► walk: what is shown, where ─► gather: shapes as authored, materials' paths
//!                                                   ├─► lights, cameras
//!                                                   └─► materials ─► shapes, in parallel ─► instances
//! ```
//!
//! A stage is bound to its thread. What needs it stands left of and in `gather`; large stages are opened by
//! many threads, each of which walks a share of the prims.

mod authored;
mod bindings;
mod camera;
mod cards;
mod clip_sets;
mod clip_template;
mod clips;
mod crew;
mod cycles;
mod diagnostics;
mod draw_mode;
mod extent;
mod files;
mod flow;
mod frame;
mod gather;
mod guard;
mod images;
mod implied;
mod inherit;
mod instance_classes;
mod instancer;
mod instances;
mod kinds;
mod layer;
mod light;
mod material;
mod offsets;
mod per_instance;
mod products;
mod prototypes;
mod pulse;
mod render;
mod retime;
mod scene;
mod schemas;
mod shape;
mod shapes;
mod shown;
mod skel;
mod spline;
mod stage;
mod stamp;
mod told;
mod udim;
mod units;
mod values;
mod variants;
mod vars;
mod walk;
mod wording;
mod xform;

use std::path::Path;
use std::sync::mpsc;

use self::pulse::Pulse;
use super::ImportOptions;
use crate::desc::SceneDesc;
use crate::error::{Error, Result, Warnings};

/// Bytes of a reader's stack; memory is taken only where it is used.
const STACK: usize = 1 << 28;

/// Reads the stage whose root layer is `path`.
///
/// # Errors
/// A root layer that can't be read, a fault of the openusd crate. Everything else that is broken is told of, and the rest of the
/// stage is read.
pub fn load(path: &Path, options: &ImportOptions, warnings: &mut Warnings) -> Result<SceneDesc> {
    let (sender, scene) = mpsc::channel();
    let pulse = Pulse::default();
    let read = {
        let (path, options, pulse) = (path.to_owned(), options.clone(), pulse.clone());
        move || {
            pulse.adopt();
            let reader = guard::guarded(|| {
                let reading = match stage::Reading::open(&path, &options) {
                    Ok(reading) => reading,
                    Err(error) => return drop(sender.send((Err(error), Warnings::new()))),
                };
                let scene = scene::build(&reading);
                let told = told::with_layers(&reading, reading.warnings.take());
                // Letting go of a stage takes long, and nobody needs to wait for it.
                let _ = sender.send((scene, told));
            });
            if let Err(reason) = reader {
                let _ = sender.send((Err(guard::broken(&path, &reason)), Warnings::new()));
            }
        }
    };
    // The openusd crate follows what is nested by calling itself: the stack of a thread of its own holds more.
    let reader = std::thread::Builder::new().name("usd".into()).stack_size(STACK).spawn(read);
    reader.map_err(|source| Error::io(path, "can't start a thread for", source))?;
    let (scene, told) = pulse.wait(&scene, pulse::STILL).map_err(|reason| guard::broken(path, &reason))?;
    warnings.extend(told);
    scene
}
