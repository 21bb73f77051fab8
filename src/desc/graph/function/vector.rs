//! Functions of vectors.

use super::Value;

/// Sum of the products of the first `n` places.
pub(super) fn dot(a: Value, b: Value, n: u8) -> f64 {
    a.iter().zip(b).take(usize::from(n)).map(|(a, b)| a * b).sum()
}

pub(super) fn length(a: Value) -> f64 {
    dot(a, a, 3).sqrt()
}

pub(super) fn scale(a: Value, by: f64) -> Value {
    a.map(|x| x * by)
}

pub(super) fn add(a: Value, b: Value) -> Value {
    std::array::from_fn(|i| a[i] + b[i])
}

pub(super) fn sub(a: Value, b: Value) -> Value {
    std::array::from_fn(|i| a[i] - b[i])
}

/// `a` of unit length in its first `n` places; 0 where it has none.
pub(super) fn normalize(a: Value, n: u8) -> Value {
    let length = dot(a, a, n).sqrt();
    if length > 0.0 && length.is_finite() { a.map(|x| x / length) } else { [0.0; 4] }
}

pub(super) fn cross(a: Value, b: Value) -> Value {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0], 0.0]
}

pub(super) fn project(a: Value, b: Value) -> Value {
    let squared = dot(b, b, 3);
    if squared > 0.0 { scale(b, dot(a, b, 3) / squared) } else { [0.0; 4] }
}

/// `a` mirrored by the plane of the unit normal `n`.
pub(super) fn reflect(a: Value, n: Value) -> Value {
    sub(a, scale(n, 2.0 * dot(a, n, 3)))
}

/// `a` refracted at the plane of the unit normal `n`, GLSL's function.
pub(super) fn refract(a: Value, n: Value, eta: f64) -> Value {
    let cos = dot(n, a, 3);
    let k = 1.0 - eta * eta * (1.0 - cos * cos);
    if k < 0.0 { [0.0; 4] } else { sub(scale(a, eta), scale(n, eta * cos + k.sqrt())) }
}

pub(super) fn face_forward(a: Value, incident: Value, reference: Value) -> Value {
    if dot(reference, incident, 3) < 0.0 { a } else { scale(a, -1.0) }
}

/// Rows of a 3×4 matrix times `(x, y, z, 1)`.
pub(super) fn affine(rows: &[[f64; 4]; 3], a: Value) -> Value {
    let [x, y, z] = rows.map(|r| r[0] * a[0] + r[1] * a[1] + r[2] * a[2] + r[3]);
    [x, y, z, a[3]]
}

#[cfg(test)]
mod tests {
    use super::super::Function;
    use super::*;

    fn is(function: &Function, args: &[Value], expected: [f64; 3]) {
        let value = function.eval(args);
        assert!(value.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{function:?} {args:?}: {value:?}");
    }

    #[test]
    fn functions_have_their_closed_forms() {
        let (x, y) = ([1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]);
        is(&Function::Cross, &[x, y], [0.0, 0.0, 1.0]);
        is(&Function::Project, &[[3.0, 4.0, 5.0, 0.0], [2.0, 0.0, 0.0, 0.0]], [3.0, 0.0, 0.0]);
        is(&Function::Project, &[[3.0, 4.0, 5.0, 0.0], [0.0; 4]], [0.0; 3]);
        is(&Function::Reflect, &[[1.0, -1.0, 0.0, 0.0], [0.0, 9.0, 0.0, 0.0]], [1.0, 1.0, 0.0]);
        is(&Function::FaceForward, &[x, y, scale(y, -1.0)], [1.0, 0.0, 0.0]);
        is(&Function::FaceForward, &[x, y, y], [-1.0, 0.0, 0.0]);
        is(&Function::Distance, &[x, y], [2.0_f64.sqrt(); 3]);
        is(&Function::Dot(3), &[[1.0, 2.0, 3.0, 9.0], [4.0, 5.0, 6.0, 9.0]], [32.0; 3]);
        is(&Function::Length(2), &[[3.0, 4.0, 9.0, 9.0]], [5.0; 3]);
        is(&Function::Normalize(3), &[[0.0, 3.0, 4.0, 0.0]], [0.0, 0.6, 0.8]);
        is(&Function::Normalize(3), &[[0.0; 4]], [0.0; 3]);
        // Snell: sin 45° from index 1 to 1.5.
        let (sin, cos) = std::f64::consts::FRAC_PI_4.sin_cos();
        let eta = [1.0 / 1.5; 4];
        let refracted = Function::Refract.eval(&[[sin, -cos, 0.0, 0.0], y, eta]);
        assert!((refracted[0] - sin / 1.5).abs() < 1e-12 && (length(refracted) - 1.0).abs() < 1e-12);
        is(&Function::Refract, &[[sin, -cos, 0.0, 0.0], y, [1.5; 4]], [0.0; 3]);
        let rows = [[1.0, 2.0, 0.0, 10.0], [0.0, 1.0, 0.0, 20.0], [0.0, 0.0, -1.0, 0.0]];
        is(&Function::Affine(Box::new(rows)), &[[1.0, 2.0, 3.0, 0.0]], [15.0, 22.0, -3.0]);
        is(&Function::Swizzle([2, 2, 0, 3]), &[[1.0, 2.0, 3.0, 4.0]], [3.0, 3.0, 1.0]);
        is(&Function::Combine, &[[1.0; 4], [2.0; 4], [3.0; 4]], [1.0, 2.0, 3.0]);
    }

    #[test]
    fn choices_go_by_the_first_place() {
        let (two, one, yes, no) = ([2.0, 0.0, 0.0, 0.0], [1.0; 4], [7.0; 4], [8.0; 4]);
        assert_eq!(Function::IfGreater.eval(&[two, one, yes, no]), yes);
        assert_eq!(Function::IfGreater.eval(&[one, two, yes, no]), no);
        assert_eq!(Function::IfGreaterOrEqual.eval(&[one, one, yes, no]), yes);
        assert_eq!(Function::IfEqual.eval(&[two, one, yes, no]), no);
    }
}
