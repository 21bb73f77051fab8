//! Blender's matrices.

use crate::math::{DAffine3, DMat3, DVec3};

/// The map of a matrix given by rows.
pub fn affine(m: &[[f64; 4]; 4]) -> DAffine3 {
    let column = |i: usize| DVec3::new(m[0][i], m[1][i], m[2][i]);
    DAffine3::from_mat3_translation(DMat3::from_cols(column(0), column(1), column(2)), column(3))
}

/// The same of sixteen floats in a row.
pub fn affine_of_floats(m: &[f32; 16]) -> DAffine3 {
    affine(&std::array::from_fn(|row| std::array::from_fn(|column| f64::from(m[4 * row + column]))))
}
