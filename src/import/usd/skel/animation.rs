//! SkelAnimation: transforms of joints and weights of blend shapes at a time.

use openusd::sdf::{Path, Value};
use openusd::tf::Token;
use openusd::usd::{Attribute, Prim, TimeCode};

use super::super::instancer::turn;
use super::super::shape::values::{scalars, triples};
use super::super::stage::Reading;
use crate::math::{DAffine3, DMat3, DVec3};

/// An animation, of whatever skeletons have joints of these names.
pub(super) struct Animation {
    prim: Prim,
    pub joints: Vec<Token>,
    pub blend_shapes: Vec<Token>,
}

impl Animation {
    /// That at `path`.
    pub fn read(reading: &Reading<'_>, path: &Path) -> Option<Self> {
        let prim = reading.stage.prim(path).ok()?;
        let joints = reading.value(&prim, "joints").unwrap_or_default();
        let blend_shapes = reading.value(&prim, "blendShapes").unwrap_or_default();
        Some(Self { prim, joints, blend_shapes })
    }

    /// The path of the prim.
    pub fn path(&self) -> &Path {
        self.prim.path()
    }

    /// Joint to parent for each joint at `time`; `None`, with a warning, where the arrays don't fit.
    pub fn transforms(&self, reading: &Reading<'_>, time: TimeCode) -> Option<Vec<DAffine3>> {
        let value = |name: &str| reading.value_of::<Value>(&self.prim.attribute(name), time);
        let translations = value("translations").and_then(triples).unwrap_or_default();
        let rotations = value("rotations").and_then(quaternions).unwrap_or_default();
        let scales = value("scales").and_then(triples).unwrap_or_default();
        let counts = [translations.len(), rotations.len(), scales.len()];
        if counts != [self.joints.len(); 3] {
            let [t, r, s] = counts;
            let what = format!(
                "has {t} translations, {r} rotations and {s} scales for {} joints; the rest pose is used",
                self.joints.len()
            );
            reading.warn(self.path(), what);
            return None;
        }
        let vector = |v: [f32; 3]| DVec3::from(v.map(f64::from));
        let joint = |i: usize| {
            let linear = turn(rotations[i]) * DMat3::from_diagonal(vector(scales[i]));
            DAffine3::from_mat3_translation(linear, vector(translations[i]))
        };
        Some((0..self.joints.len()).map(joint).collect())
    }

    /// The weight of each blend shape at `time`.
    pub fn weights(&self, reading: &Reading<'_>, time: TimeCode) -> Vec<f32> {
        let value = reading.value_of::<Value>(&self.prim.attribute("blendShapeWeights"), time);
        let mut weights = value.and_then(scalars).unwrap_or_default().into_flattened();
        let (have, want) = (weights.len(), self.blend_shapes.len());
        if have != want {
            let instead = if have > want { "the first ones are used" } else { "the others are 0" };
            reading.warn(self.path(), format!("has {have} blendShapeWeights for {want} blend shapes; {instead}"));
            weights.resize(want, 0.0);
        }
        weights
    }

    /// The attributes that may change with time.
    pub fn attributes(&self) -> Vec<Attribute> {
        ["translations", "rotations", "scales", "blendShapeWeights"].map(|name| self.prim.attribute(name)).into()
    }
}

/// Quaternions x, y, z, w of any precision.
fn quaternions(value: Value) -> Option<Vec<[f64; 4]>> {
    Some(match value {
        Value::QuatfVec(v) => v.iter().map(|q| [q.x, q.y, q.z, q.w].map(f64::from)).collect(),
        Value::QuathVec(v) => v.iter().map(|q| [q.x, q.y, q.z, q.w].map(|c| c.to_f64())).collect(),
        Value::QuatdVec(v) => v.iter().map(|q| [q.x, q.y, q.z, q.w]).collect(),
        _ => return None,
    })
}
