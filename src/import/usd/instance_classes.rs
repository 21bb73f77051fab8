//! Classes that the stage's own layers have something to say of, to prims below native instances. OpenUSD composes
//! them into the prototype; the openusd crate (0.8) looks for them from a root that it has taken out by then, so
//! that such instances have to be prims of their own.

use openusd::sdf::{FieldKey, Path, Value};
use openusd::usd::Prim;

use super::stage::Reading;

/// Makes the instance `prim` an instance no more, in memory, where that is needed. Nothing below it may have been
/// read before.
pub(super) fn take_apart(reading: &Reading<'_>, prim: &Prim) -> bool {
    if !is_spoken_of(reading, prim) {
        return false;
    }
    let path = prim.path();
    match reading.stage.override_prim(path.clone()).and_then(|prim| prim.set_instanceable(false)) {
        Ok(_) => true,
        Err(error) => {
            reading.warn(path, format!("what the stage says of classes below this instance is left out: {error}"));
            false
        }
    }
}

fn is_spoken_of(reading: &Reading<'_>, instance: &Prim) -> bool {
    let classes = reading.classes.borrow();
    let of_stage = |class: &Path| reading.stage.prim(class.clone()).is_ok_and(|prim| prim.is_valid().unwrap_or(false));
    if classes.is_empty() || !classes.iter().any(of_stage) {
        return false;
    }
    let mut below = instance.children().unwrap_or_default();
    while let Some(prim) = below.pop() {
        let named = [FieldKey::InheritPaths, FieldKey::Specializes].into_iter().any(|field| {
            let Ok(Some(Value::PathListOp(list))) = reading.stage.field::<Value>(prim.path(), field) else {
                return false;
            };
            list.flatten().iter().any(|class| !class.has_prefix(instance.path()) && of_stage(class))
        });
        if named {
            return true;
        }
        below.extend(prim.children().unwrap_or_default());
    }
    false
}
