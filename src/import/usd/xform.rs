//! Local transforms: the ordered operations of UsdGeomXformable.

use openusd::gf::Matrix4d;
use openusd::sdf;
use openusd::tf::Token;
use openusd::usd::{Attribute, Prim, TimeCode};
use openusd_schemas::geom::XformOp;

use super::stage::Reading;
use crate::math::{DAffine3, DMat3, DVec3};

/// The operations of one prim. The crate's own `XformQuery` is slower, and knows nothing of values that are
/// held up to a block.
#[derive(Clone)]
pub(super) struct Xform {
    prim: Prim,
    ops: Vec<XformOp>,
    /// True where it starts from the root, not from the prim's parent.
    pub resets: bool,
}

impl Xform {
    /// That of `prim`, whose authored properties are `names`; `None` where it has none.
    pub fn of(reading: &Reading<'_>, prim: &Prim, names: &[Token]) -> Option<Self> {
        let attribute = prim.attribute("xformOpOrder");
        // As in OpenUSD, whatever the time.
        let order = attribute.get_at::<Vec<Token>>(None).unwrap_or_else(|error| {
            reading.warn(attribute.path(), format!("{error}; taken for not authored"));
            None
        })?;
        let mut xform = Self { prim: prim.clone(), ops: Vec::new(), resets: false };
        for entry in &order {
            if entry.as_str() == "!resetXformStack!" {
                xform.resets = true;
                xform.ops.clear();
                continue;
            }
            let (inverse, name) = match entry.strip_prefix("!invert!") {
                Some(name) => (true, Token::from(name)),
                None => (false, entry.clone()),
            };
            // As in OpenUSD, an operation without its attribute does nothing.
            if names.contains(&name) {
                xform.ops.push(XformOp::new(&prim.attribute(name), inverse));
            }
        }
        Some(xform)
    }

    /// Object to parent at `time`.
    pub fn at(&self, reading: &Reading<'_>, time: TimeCode) -> DAffine3 {
        let mut local = DAffine3::IDENTITY;
        let mut ops = self.ops.iter().peekable();
        while let Some(op) = ops.next() {
            // A pivot that is undone at once: one that is singular would else spoil everything.
            let undone = |next: &&XformOp| next.name() == op.name() && next.is_inverse_op() != op.is_inverse_op();
            if ops.next_if(undone).is_some() {
                continue;
            }
            let transform = match op.op_transform(time) {
                // Also that of an operation without value.
                Ok(matrix) if matrix == Matrix4d::IDENTITY => op.op_transform(held(op.attribute(), time)),
                other => other,
            };
            match transform {
                Ok(matrix) => local *= affine(&matrix.0),
                Err(error) => reading.warn(self.prim.path(), format!("{error}; that is left out")),
            }
        }
        local
    }

    /// True where it may differ between times.
    pub fn varies(&self) -> bool {
        self.ops.iter().any(|op| op.might_be_time_varying().unwrap_or(false))
    }

    /// Times of its samples from `open` to `close`.
    pub fn samples(&self, open: f64, close: f64) -> Vec<f64> {
        let attributes: Vec<Attribute> = self.ops.iter().map(|op| op.attribute().clone()).collect();
        Attribute::unioned_time_samples_in_interval(&attributes, open..=close).unwrap_or_default()
    }
}

/// The time at which `attribute` has the value that it has at `time`: that of the last sample where a block
/// follows, up to which OpenUSD holds it.
fn held(attribute: &Attribute, time: TimeCode) -> TimeCode {
    match attribute.bracketing_time_samples(time) {
        Ok(Some((before, after))) if before < after => {
            let blocked = matches!(attribute.get_at::<sdf::Value>(TimeCode::new(after)), Ok(None));
            if blocked { TimeCode::new(before) } else { time }
        }
        _ => time,
    }
}

/// A matrix for row vectors, row by row, as ours. What it does beyond an affine map is left out.
pub(super) fn affine(m: &[f64; 16]) -> DAffine3 {
    let row = |i: usize| DVec3::new(m[i], m[i + 1], m[i + 2]);
    DAffine3 { matrix3: DMat3::from_cols(row(0), row(4), row(8)), translation: row(12) }
}
