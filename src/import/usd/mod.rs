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
mod crew;
mod cycles;
mod diagnostics;
mod draw_mode;
mod gather;
mod images;
mod inherit;
mod instancer;
mod instances;
mod kinds;
mod light;
mod material;
mod prototypes;
mod render;
mod scene;
mod schemas;
mod shape;
mod shapes;
mod stage;
mod udim;
mod units;
mod values;
mod variants;
mod walk;
mod xform;

use std::path::Path;

use super::ImportOptions;
use crate::desc::SceneDesc;
use crate::error::{Error, Result, Warnings};

/// Bytes of stack; memory is taken only where it is used.
const STACK: usize = 1 << 28;

/// Reads the stage whose root layer is `path`.
///
/// # Errors
/// A root layer that can't be read. Everything else that is broken is told of, and the rest of the
/// stage is read.
pub fn load(path: &Path, options: &ImportOptions, warnings: &mut Warnings) -> Result<SceneDesc> {
    // The openusd crate follows what is nested by calling itself: the stack of a thread of its own holds more.
    std::thread::scope(|scope| {
        let read = || {
            let reading = stage::Reading::open(path, options)?;
            let scene = scene::build(&reading);
            warnings.extend(reading.warnings.take());
            scene
        };
        let reader = std::thread::Builder::new().name("usd".into()).stack_size(STACK).spawn_scoped(scope, read);
        let reader = reader.map_err(|source| Error::io(path, "can't start a thread for", source))?;
        reader.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}
