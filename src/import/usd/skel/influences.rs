//! Which joints move each point, and how much.

use openusd::sdf::{Path, Value};
use openusd::tf::Token;
use openusd_schemas::geom::{Interpolation, Primvar};

use super::super::shape::values::scalars;
use super::super::stage::Reading;
use super::Bound;

/// The joints of each element, which is a point or the whole shape.
pub(super) struct Influences {
    per: usize,
    joints: Vec<u32>,
    weights: Vec<f32>,
}

impl Influences {
    /// Those of `bound` for `elements` elements, whose joints are fewer than `joints`; what is wrong as an error.
    pub fn read(reading: &Reading<'_>, bound: &Bound, elements: usize, joints: usize) -> Result<Self, String> {
        let attribute = |path: &Path| reading.stage.attribute(path.clone()).ok().and_then(Primvar::from_attribute);
        let [indices, weights] = bound.influences.as_ref().ok_or("has no joint influences")?.each_ref().map(attribute);
        let (indices, weights) = indices.zip(weights).ok_or("has joint influences that can't be read")?;
        let how = |primvar: &Primvar| (interpolation(primvar), primvar.element_size().unwrap_or(1));
        let (of_indices, of_weights) = (how(&indices), how(&weights));
        if of_indices != of_weights {
            return Err("has joint indices and weights of different interpolation or elementSize".into());
        }
        let (interpolation, per) = of_indices;
        if !matches!(interpolation, Some(Interpolation::Constant | Interpolation::Vertex)) {
            let what = interpolation.map_or("unknown", |interpolation| interpolation.as_token());
            return Err(format!("has joint influences of interpolation {what}, not constant or vertex"));
        }
        let per = usize::try_from(per).ok().filter(|&per| per > 0).ok_or("has joint influences of elementSize 0")?;
        let value = |primvar: &Primvar| primvar.compute_flattened::<Value>(reading.time).ok().flatten();
        let found: Vec<i32> = match value(&indices) {
            Some(Value::IntVec(found)) => found,
            _ => return Err("has joint indices that are no array of integers".into()),
        };
        let weights = value(&weights).and_then(scalars).ok_or("has joint weights that are no array of numbers")?;
        let weights = weights.into_flattened();
        if found.len() != weights.len() || found.len() != elements * per {
            return Err(format!(
                "has {} joint indices and {} weights where {} are needed",
                found.len(),
                weights.len(),
                elements * per
            ));
        }
        let known =
            |&index: &i32| usize::try_from(index).ok().filter(|&index| index < joints).map(|index| index as u32);
        let indices: Option<Vec<u32>> = found.iter().map(known).collect();
        let indices = indices.ok_or_else(|| format!("has joint indices out of range; there are {joints} joints"))?;
        Ok(Self { per, joints: indices, weights })
    }

    /// Joints and weights of an element.
    pub fn of(&self, element: usize) -> impl Iterator<Item = (usize, f64)> + Clone {
        let own = element * self.per..(element + 1) * self.per;
        let pairs = self.joints[own.clone()].iter().zip(&self.weights[own]);
        pairs.map(|(&joint, &weight)| (joint as usize, f64::from(weight)))
    }
}

/// True where the joint indices at `path` are the same for all points.
pub(super) fn are_constant(reading: &Reading<'_>, path: &Path) -> bool {
    let attribute = reading.stage.attribute(path.clone()).ok();
    let primvar = attribute.and_then(Primvar::from_attribute);
    primvar.is_some_and(|primvar| interpolation(&primvar) == Some(Interpolation::Constant))
}

/// That of `primvar`; `None` for one that does not exist.
fn interpolation(primvar: &Primvar) -> Option<Interpolation> {
    match primvar.attribute().get_metadata::<Token>("interpolation").ok().flatten() {
        Some(token) => Interpolation::from_token(&token),
        None => Some(Interpolation::Constant),
    }
}
