//! From the space of one prim to that of another, at any time.

use openusd::sdf::Path;
use openusd::tf::Token;
use openusd::usd::TimeCode;

use super::super::stage::Reading;
use super::super::xform::Xform;
use crate::math::DAffine3;

/// The transforms between two prims; those that they share are left out.
pub(super) struct Between {
    from: Vec<Xform>,
    to: Vec<Xform>,
}

impl Between {
    pub fn new(reading: &Reading<'_>, from: &Path, to: &Path) -> Self {
        let shared = from.ancestors().find(|path| to.has_prefix(path)).unwrap_or_default();
        let (up, down) = (chain(reading, from, &shared), chain(reading, to, &shared));
        if up.iter().chain(&down).any(|xform| xform.resets) {
            // One of them starts from the root.
            let root = Path::abs_root();
            return Self { from: chain(reading, from, &root), to: chain(reading, to, &root) };
        }
        Self { from: up, to: down }
    }

    /// The transform at `time`; `None` where that of the second prim is singular.
    pub fn at(&self, reading: &Reading<'_>, time: TimeCode) -> Option<DAffine3> {
        let above = |chain: &[Xform]| chain.iter().fold(DAffine3::IDENTITY, |inner, x| x.at(reading, time) * inner);
        let between = above(&self.to).inverse() * above(&self.from);
        between.is_finite().then_some(between)
    }

    /// All of them that may change with time.
    pub fn varying(&self) -> impl Iterator<Item = &Xform> {
        self.from.iter().chain(&self.to).filter(|xform| xform.varies())
    }
}

/// The transforms of the prim at `path` and of those above it, up to `top` or to one that starts from the root.
fn chain(reading: &Reading<'_>, path: &Path, top: &Path) -> Vec<Xform> {
    let mut chain = Vec::new();
    for path in path.ancestors().take_while(|path| path != top) {
        let Ok(prim) = reading.stage.prim(&path) else { continue };
        let kind = prim.type_name().ok().flatten().unwrap_or_default();
        let xformable = reading.stage.schema_registry().is_a(&kind, &Token::from("Xformable"));
        let names = prim.authored_property_names().unwrap_or_default();
        if !xformable || !names.iter().any(|name| name.as_str() == "xformOpOrder") {
            continue;
        }
        let xform = Xform::of(reading, &prim, &names);
        let resets = xform.as_ref().is_some_and(|xform| xform.resets);
        chain.extend(xform);
        if resets {
            break;
        }
    }
    chain
}
