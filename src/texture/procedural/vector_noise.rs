//! Noise of vectors: three gradient noises of one hash, as Open Shading Language and MaterialX have it.

use super::fractal::Octaves;

/// Three sums of `detail` octaves beyond the first at `p`, each from about -1 to 1 for one octave; amplitude times
/// `roughness` and frequency times `lacunarity` from one octave to the next.
pub fn vector_noise<const N: usize>(p: [f32; N], detail: f32, roughness: f32, lacunarity: f32) -> [f32; 3] {
    Octaves::new(detail, roughness, lacunarity).fbm_vector(p)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of MaterialX's `mx_noise.glsl` (1.39), compiled as C++.
    #[test]
    fn noises_are_those_of_materialx() {
        let (flat, space) = ([3.7, -1.3], [0.3, -2.6, 7.45]);
        for (found, expected) in [
            (vector_noise(flat, 0.0, 0.5, 2.0), [-0.253_699_24, -0.580_434_9, 0.428_807_97]),
            (vector_noise(space, 0.0, 0.5, 2.0), [0.141_109_45, 0.179_559_63, 0.029_278_722]),
            (vector_noise(space, 2.0, 0.6, 2.1), [0.176_472_46, 0.622_765_96, 0.186_666_07]),
        ] {
            let close = found.iter().zip(expected).all(|(a, b): (&f32, f32)| (a - b).abs() < 2e-6);
            assert!(close, "{found:?} is not {expected:?}");
        }
    }
}
