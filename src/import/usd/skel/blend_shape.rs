//! Blend shapes: offsets of points by weight, with shapes in between.

use openusd::sdf::{Path, Value};
use openusd::tf::Token;
use openusd::usd::{Prim, TimeCode};

use super::super::shape::values::triples;
use super::super::stage::Reading;
use super::animation::Animation;
use super::skeleton::mapped;

/// Weights and distances of weights below this are none (UsdSkel's).
const CLOSE: f32 = 1e-6;

/// The blend shapes of a prim.
pub(super) struct BlendShapes {
    shapes: Vec<BlendShape>,
    /// Which weight of the animation each has.
    weights: Vec<Option<usize>>,
}

/// What a weight does.
struct BlendShape {
    /// The points that it moves; `None` for all.
    points: Option<Vec<u32>>,
    /// By weight; one at 0 that does nothing, and one at 1.
    steps: Vec<Step>,
}

/// How far points are moved at a weight; empty for not at all.
struct Step {
    weight: f32,
    offsets: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
}

impl BlendShapes {
    /// Those of `prim`, which has `count` points; `None` where none can be used, which is told.
    pub fn read(reading: &Reading<'_>, prim: &Prim, animation: Option<&Animation>, count: usize) -> Option<Self> {
        let names: Vec<Token> = reading.value(prim, "skel:blendShapes").unwrap_or_default();
        let targets = prim.relationship("skel:blendShapeTargets").forwarded_targets().unwrap_or_default();
        if names.len() != targets.len() {
            let (names, targets) = (names.len(), targets.len());
            let what = format!("has {names} skel:blendShapes and {targets} targets for them; they are left out");
            reading.warn(prim.path(), what);
            return None;
        }
        let order = animation.map_or(&[][..], |animation| &animation.blend_shapes);
        let (mut shapes, mut weights) = (Vec::new(), Vec::new());
        for (target, weight) in targets.iter().zip(mapped(&names, order)) {
            match BlendShape::read(reading, target, count) {
                Ok(shape) => {
                    shapes.push(shape);
                    weights.push(weight);
                }
                Err(what) => reading.warn(prim.path(), format!("blend shape {target} {what}; it is left out")),
            }
        }
        (!shapes.is_empty()).then_some(Self { shapes, weights })
    }

    /// Offsets of points, and of normals where there are some, at `time`.
    pub fn offsets(&self, reading: &Reading<'_>, animation: &Animation, time: TimeCode, count: usize) -> Offsets {
        let weights = animation.weights(reading, time);
        let mut offsets = Offsets { points: vec![[0.0; 3]; count], normals: None };
        for (shape, weight) in self.shapes.iter().zip(&self.weights) {
            for (step, share) in shape.mix(weight.map_or(0.0, |weight| weights[weight])) {
                shape.add(&step.offsets, share, &mut offsets.points);
                if !step.normals.is_empty() {
                    let normals = offsets.normals.get_or_insert_with(|| vec![[0.0; 3]; count]);
                    shape.add(&step.normals, share, normals);
                }
            }
        }
        offsets
    }
}

/// What is added to points and to normals at them.
pub(super) struct Offsets {
    pub points: Vec<[f32; 3]>,
    pub normals: Option<Vec<[f32; 3]>>,
}

impl BlendShape {
    /// That at `path`, of a shape with `count` points; what is wrong as an error.
    fn read(reading: &Reading<'_>, path: &Path, count: usize) -> Result<Self, String> {
        let prim = reading.stage.prim(path).ok().filter(|prim| prim.is_valid().unwrap_or(false));
        let prim = prim.ok_or("does not exist")?;
        if prim.type_name().ok().flatten().is_none_or(|kind| kind.as_str() != "BlendShape") {
            return Err("is no BlendShape".into());
        }
        let points: Vec<i32> = reading.value(&prim, "pointIndices").unwrap_or_default();
        let wanted = if points.is_empty() { count } else { points.len() };
        let known = |&i: &i32| usize::try_from(i).ok().filter(|&i| i < count).map(|i| i as u32);
        let indices: Option<Vec<u32>> = points.iter().map(known).collect();
        let indices = indices.ok_or_else(|| format!("has pointIndices out of range; there are {count} points"))?;
        let offsets = |name: &str, is_needed: bool| {
            let values = reading.value::<Value>(&prim, name).and_then(triples).unwrap_or_default();
            let fits = values.len() == wanted || (values.is_empty() && !is_needed);
            if fits { Ok(values) } else { Err(format!("has {} {name} for {wanted} points", values.len())) }
        };
        let none = Step { weight: 0.0, offsets: Vec::new(), normals: Vec::new() };
        let all = Step { weight: 1.0, offsets: offsets("offsets", true)?, normals: offsets("normalOffsets", false)? };
        let mut steps = vec![none, all];
        for name in prim.authored_property_names().unwrap_or_default() {
            let Some(between) = name.strip_prefix("inbetweens:").filter(|rest| !rest.contains(':')) else { continue };
            let weight = match prim.attribute(name.clone()).get_metadata::<Value>("weight") {
                Ok(Some(Value::Float(weight))) => weight,
                Ok(Some(Value::Double(weight))) => weight as f32,
                _ => return Err(format!("has the in-between {between} without weight")),
            };
            if weight.abs() < CLOSE || (weight - 1.0).abs() < CLOSE || !weight.is_finite() {
                return Err(format!("has the in-between {between} at weight {weight}, where another shape is"));
            }
            let offsets_of_normals = format!("inbetweens:{between}:normalOffsets");
            steps.push(Step {
                weight,
                offsets: offsets(name.as_str(), true)?,
                normals: offsets(&offsets_of_normals, false)?,
            });
        }
        steps.sort_by(|a, b| a.weight.total_cmp(&b.weight));
        Ok(Self { points: (!indices.is_empty()).then_some(indices), steps })
    }

    /// The two steps around `weight` with their shares; beyond the last, it goes on as between the last two.
    fn mix(&self, weight: f32) -> impl Iterator<Item = (&Step, f32)> {
        let above = self.steps.partition_point(|step| step.weight <= weight).clamp(1, self.steps.len() - 1);
        let [low, high] = [&self.steps[above - 1], &self.steps[above]];
        let distance = high.weight - low.weight;
        let share = if distance > CLOSE { (weight - low.weight) / distance } else { 0.0 };
        let shares = [(low, 1.0 - share), (high, share)];
        let counts = weight.abs() >= CLOSE && weight.is_finite();
        shares.into_iter().filter(move |(step, share)| counts && share.abs() >= CLOSE && !step.offsets.is_empty())
    }

    /// Adds a `share` of `offsets` to `values`, one for each point.
    fn add(&self, offsets: &[[f32; 3]], share: f32, values: &mut [[f32; 3]]) {
        let add = |value: &mut [f32; 3], offset: &[f32; 3]| {
            value.iter_mut().zip(offset).for_each(|(value, offset)| *value += share * offset);
        };
        match &self.points {
            Some(points) => points.iter().zip(offsets).for_each(|(&i, offset)| add(&mut values[i as usize], offset)),
            None => values.iter_mut().zip(offsets).for_each(|(value, offset)| add(value, offset)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(weight: f32) -> f32 {
        let step = |weight, x| Step { weight, offsets: vec![[x, 0.0, 0.0]], normals: Vec::new() };
        let none = Step { weight: 0.0, offsets: Vec::new(), normals: Vec::new() };
        let shape =
            BlendShape { points: Some(vec![1]), steps: vec![step(-0.5, 3.0), none, step(0.25, 8.0), step(1.0, 2.0)] };
        let mut values = [[0.0; 3]; 2];
        shape.mix(weight).for_each(|(step, share)| shape.add(&step.offsets, share, &mut values));
        assert_eq!(values[0], [0.0; 3]);
        values[1][0]
    }

    #[test]
    fn weights_pass_the_shapes_between_and_go_on_beyond_them() {
        for (weight, expected) in
            [(0.0, 0.0), (0.125, 4.0), (0.25, 8.0), (0.625, 5.0), (1.0, 2.0), (1.75, -4.0), (-0.25, 1.5), (-1.0, 6.0)]
        {
            assert!((at(weight) - expected).abs() < 1e-5, "{weight}: {}", at(weight));
        }
        assert_eq!(at(f32::NAN), 0.0);
    }
}
