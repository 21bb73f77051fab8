//! Arrays of numbers out of a value, whatever their precision; single precision is moved, not copied.

use bytemuck::allocation::cast_vec;
use openusd::sdf::{Value, ValueKind};

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

/// Whatever numbers there are, as graphs have them: a number in all four places, a vector or color with 1
/// behind it.
pub(in super::super) fn graph_values(value: Value) -> Option<Vec<[f32; 4]>> {
    use ValueKind as K;
    let numbers = |v: Vec<f32>| -> Vec<[f32; 4]> { v.into_iter().map(|v| [v; 4]).collect() };
    Some(match ValueKind::from(&value) {
        K::Vec2f | K::Vec2d | K::Vec2h | K::Vec2fVec | K::Vec2dVec | K::Vec2hVec => {
            pairs(value)?.into_iter().map(|[x, y]| [x, y, 0.0, 1.0]).collect()
        }
        K::Vec3f | K::Vec3d | K::Vec3h | K::Vec3fVec | K::Vec3dVec | K::Vec3hVec => {
            triples(value)?.into_iter().map(|[x, y, z]| [x, y, z, 1.0]).collect()
        }
        _ => match value {
            Value::Vec4fVec(v) => cast_vec(v),
            Value::Vec4dVec(v) => v.iter().map(|v| [v.x, v.y, v.z, v.w].map(|x| x as f32)).collect(),
            Value::Vec4hVec(v) => v.iter().map(|v| [v.x, v.y, v.z, v.w].map(|x| x.to_f32())).collect(),
            Value::Vec4f(v) => vec![[v.x, v.y, v.z, v.w]],
            Value::Vec4d(v) => vec![[v.x, v.y, v.z, v.w].map(|x| x as f32)],
            Value::Vec4h(v) => vec![[v.x, v.y, v.z, v.w].map(|x| x.to_f32())],
            Value::IntVec(v) => numbers(v.into_iter().map(|v| v as f32).collect()),
            Value::UintVec(v) => numbers(v.into_iter().map(|v| v as f32).collect()),
            Value::Int64Vec(v) => numbers(v.into_iter().map(|v| v as f32).collect()),
            Value::BoolVec(v) => numbers(v.into_iter().map(|v| f32::from(u8::from(v))).collect()),
            Value::Int(v) => vec![[v as f32; 4]],
            Value::Uint(v) => vec![[v as f32; 4]],
            Value::Int64(v) => vec![[v as f32; 4]],
            Value::Bool(v) => vec![[f32::from(u8::from(v)); 4]],
            other => numbers(scalars(other)?.into_flattened()),
        },
    })
}
