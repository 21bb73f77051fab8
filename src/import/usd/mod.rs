//! The USD door: `.usda`, `.usdc`, `.usd` and `.usdz` to a `SceneDesc`.
//!
//! The stage is composed by the `openusd` crate (docs/decisions/0001-usd.md); what its prims mean is
//! read here. USD's schemas: <https://openusd.org/release/api/>.
//!
//! ```text
//! stage ─► walk: what is shown, where ─► materials ─► shapes, in parallel ─► instances
//!                                    └─► lights, cameras, render settings
//! ```

mod authored;
mod bindings;
mod camera;
mod crew;
mod diagnostics;
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
use crate::error::{Result, Warnings};

/// Reads the stage whose root layer is `path`.
///
/// # Errors
/// A root layer that can't be read. Everything else that is broken is told of, and the rest of the
/// stage is read.
pub fn load(path: &Path, options: &ImportOptions, warnings: &mut Warnings) -> Result<SceneDesc> {
    let reading = stage::Reading::open(path, options)?;
    let scene = scene::build(&reading);
    warnings.extend(reading.warnings.take());
    scene
}
