//! Arrays of numbers out of a value, whatever their precision; single precision is moved, not copied.

use bytemuck::allocation::cast_vec;
use openusd::sdf::Value;

/// Vectors of two; one for a value that is no array.
pub(in super::super) fn pairs(value: Value) -> Option<Vec<[f32; 2]>> {
    Some(match value {
        Value::Vec2fVec(v) => cast_vec(v),
        Value::Vec2dVec(v) => v.iter().map(|v| [v.x as f32, v.y as f32]).collect(),
        Value::Vec2hVec(v) => v.iter().map(|v| [v.x.to_f32(), v.y.to_f32()]).collect(),
        Value::Vec2f(v) => vec![[v.x, v.y]],
        Value::Vec2d(v) => vec![[v.x as f32, v.y as f32]],
        Value::Vec2h(v) => vec![[v.x.to_f32(), v.y.to_f32()]],
        _ => return None,
    })
}

/// Vectors of three.
pub(in super::super) fn triples(value: Value) -> Option<Vec<[f32; 3]>> {
    Some(match value {
        Value::Vec3fVec(v) => cast_vec(v),
        Value::Vec3dVec(v) => v.iter().map(|v| [v.x as f32, v.y as f32, v.z as f32]).collect(),
        Value::Vec3hVec(v) => v.iter().map(|v| [v.x.to_f32(), v.y.to_f32(), v.z.to_f32()]).collect(),
        Value::Vec3f(v) => vec![[v.x, v.y, v.z]],
        Value::Vec3d(v) => vec![[v.x as f32, v.y as f32, v.z as f32]],
        Value::Vec3h(v) => vec![[v.x.to_f32(), v.y.to_f32(), v.z.to_f32()]],
        _ => return None,
    })
}

/// Numbers.
pub(in super::super) fn scalars(value: Value) -> Option<Vec<[f32; 1]>> {
    Some(match value {
        Value::FloatVec(v) => cast_vec(v),
        Value::DoubleVec(v) => v.iter().map(|&v| [v as f32]).collect(),
        Value::HalfVec(v) => v.iter().map(|v| [v.to_f32()]).collect(),
        Value::Float(v) => vec![[v]],
        Value::Double(v) => vec![[v as f32]],
        Value::Half(v) => vec![[v.to_f32()]],
        _ => return None,
    })
}
