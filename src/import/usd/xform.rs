//! Local transforms: the ordered operations of UsdGeomXformable.

use std::rc::Rc;

use openusd::gf::{Matrix4d, Rotation, Vec3d};
use openusd::sdf;
use openusd::tf::Token;
use openusd::usd::{Attribute, Prim, TimeCode};
use openusd_schemas::geom::XformOp;

use super::layer::Site;
use super::retime::{self, Retime};
use super::stage::Reading;
use crate::math::{DAffine3, DMat3, DVec3};

/// The operations of one prim. The crate's own `XformQuery` is slower, and knows nothing of values that are
/// held up to a block.
#[derive(Clone)]
pub(super) struct Xform {
    prim: Prim,
    ops: Vec<Op>,
    /// True where it starts from the root, not from the prim's parent.
    pub resets: bool,
}

/// One operation.
#[derive(Clone)]
struct Op {
    op: XformOp,
    /// The curve that its number follows.
    spline: Option<Rc<Site>>,
    retime: Option<Retime>,
}

impl Op {
    fn at(&self, time: TimeCode) -> Result<Matrix4d, openusd_schemas::SchemaError> {
        if let Some(spline) = &self.spline {
            let number = spline.at(time).and_then(|value| value.cast::<f64>().ok());
            return Ok(number.map_or(Matrix4d::IDENTITY, |number| about_an_axis(&self.op, number)));
        }
        let time = self.retime.map_or(time, |retime| retime.asked(time));
        match self.op.op_transform(time) {
            // Also that of an operation without value.
            Ok(matrix) if matrix == Matrix4d::IDENTITY => self.op.op_transform(held(self.op.attribute(), time)),
            other => other,
        }
    }
}

/// What an operation along one axis does with `number`; those of several take no curves.
fn about_an_axis(op: &XformOp, number: f64) -> Matrix4d {
    let kind = op.name().split(':').nth(1).unwrap_or_default().to_string();
    let Some(axis) = ["X", "Y", "Z"].iter().position(|axis| kind.ends_with(axis)) else { return Matrix4d::IDENTITY };
    let along = |rest: f64, value: f64| std::array::from_fn(|i| if i == axis { value } else { rest });
    let signed = if op.is_inverse_op() { -number } else { number };
    match &kind[..kind.len() - 1] {
        "translate" => Matrix4d::translation(along(0.0, signed)),
        "scale" => Matrix4d::scale(along(1.0, if op.is_inverse_op() { 1.0 / number } else { number })),
        "rotate" => {
            let [x, y, z] = along(0.0, 1.0);
            Matrix4d::from_quat(Rotation::new(Vec3d { x, y, z }, signed).quat())
        }
        _ => Matrix4d::IDENTITY,
    }
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
            if !names.contains(&name) {
                reading.warn(
                    prim.path(),
                    format!("its xformOpOrder names {name}, which it does not have; that is left out"),
                );
            } else {
                let attribute = prim.attribute(name);
                let spline = reading.spline(&attribute);
                if spline.is_none() {
                    reading.extent.note(reading, &attribute);
                }
                let retime = Retime::of(reading, &attribute).filter(|_| spline.is_none());
                xform.ops.push(Op { op: XformOp::new(&attribute, inverse), spline, retime });
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
            let undone =
                |next: &&Op| next.op.name() == op.op.name() && next.op.is_inverse_op() != op.op.is_inverse_op();
            if ops.next_if(undone).is_some() {
                continue;
            }
            match op.at(time) {
                Ok(matrix) => {
                    if [3, 7, 11].iter().any(|&i| matrix.0[i] != 0.0) || matrix.0[15] != 1.0 {
                        reading.warn(
                            self.prim.path(),
                            "its transform is projective; the last column counts as 0, 0, 0, 1",
                        );
                    }
                    local *= affine(&matrix.0);
                }
                Err(error) => reading.warn(self.prim.path(), format!("{error}; that is left out")),
            }
        }
        local
    }

    /// True where it may differ between times.
    pub fn varies(&self) -> bool {
        self.ops.iter().any(|op| match &op.spline {
            Some(spline) => spline.varies(),
            None => op.op.might_be_time_varying().unwrap_or(false),
        })
    }

    /// Times of its samples from `open` to `close`.
    pub fn samples(&self, reading: &Reading<'_>, open: f64, close: f64) -> Vec<f64> {
        let (curved, sampled): (Vec<&Op>, Vec<&Op>) = self.ops.iter().partition(|op| op.spline.is_some());
        let attributes: Vec<Attribute> = sampled.iter().map(|op| op.op.attribute().clone()).collect();
        let mut times = retime::samples(reading, &attributes, open, close);
        let splines = curved.iter().filter_map(|op| op.spline.as_ref()).filter(|spline| spline.varies());
        times.extend(splines.flat_map(|spline| spline.samples(open, close)));
        times
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
