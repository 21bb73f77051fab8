//! How the edge of an object's own shadow is softened.

/// What is done about triangles that their smooth normals would light, and that they shade themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TerminatorDesc {
    /// Up to which cosine to a light its rays begin on a rounded surface instead of the triangle; 0 for nowhere.
    pub geometry: f64,
    /// How far the darkest part of what is lit is drawn towards the light, 0 to 1.
    pub shading: f64,
}
