//! The prims that are shown, and what they take from their ancestors.

use std::rc::Rc;

use openusd::sdf;
use openusd::usd::Prim;
use openusd_schemas::geom::Primvar;

use super::stage::Reading;
use crate::desc::Motion;
use crate::math::DAffine3;

/// A prim that shows something: a shape, a light, a camera.
pub(super) struct Placed {
    /// Where its properties are read; within a prototype for what is instanced.
    pub prim: Prim,
    /// Where the user sees it.
    pub path: sdf::Path,
    /// Its schema, as "Mesh".
    pub kind: Rc<str>,
    /// Object to world: y up, metres.
    pub world: DAffine3,
    /// The same at the ends and samples of the shutter; empty for what does not move.
    pub motion: Vec<Motion<DAffine3>>,
    /// The material bound to it, by the rules of UsdShade.
    pub material: Option<sdf::Path>,
    /// What it inherits; the same pointer for all instances of a prototype in the same surroundings.
    pub primvars: Rc<Vec<Primvar>>,
    /// False for what no ray sees.
    pub visible: bool,
}

/// All of them, parents before children, in the order of the stage.
pub(super) fn walk(_reading: &Reading<'_>) -> Vec<Placed> {
    Vec::new()
}
