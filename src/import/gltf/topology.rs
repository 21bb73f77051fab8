//! From primitive modes to triangles (glTF 2.0, section 3.7.2.1).

/// The triangles of `indices` in a primitive mode with area; `None` for points and lines.
pub(super) fn triangles(mode: u32, indices: &[u32]) -> Option<Vec<[u32; 3]>> {
    match mode {
        4 => Some(indices.as_chunks().0.to_vec()),
        // Every other triangle of a strip is turned round: p_i = {v_i, v_(i+1+i%2), v_(i+2−i%2)}.
        5 => Some(
            indices
                .windows(3)
                .enumerate()
                .map(|(i, v)| if i % 2 == 0 { [v[0], v[1], v[2]] } else { [v[0], v[2], v[1]] })
                .collect(),
        ),
        // p_i = {v_(i+1), v_(i+2), v_0}.
        6 => Some(indices.get(1..).unwrap_or_default().windows(2).map(|v| [v[0], v[1], indices[0]]).collect()),
        _ => None,
    }
}

/// The name of a primitive mode.
pub(super) fn mode_name(mode: u32) -> &'static str {
    match mode {
        0 => "points",
        1 => "lines",
        2 => "a line loop",
        3 => "a line strip",
        4 => "triangles",
        5 => "a triangle strip",
        6 => "a triangle fan",
        _ => "of an unknown mode",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_keep_their_winding() {
        assert_eq!(triangles(5, &[0, 1, 2, 3, 4]).unwrap(), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
    }

    #[test]
    fn fans_share_their_first_point() {
        assert_eq!(triangles(6, &[9, 1, 2, 3]).unwrap(), [[1, 2, 9], [2, 3, 9]]);
    }

    #[test]
    fn too_few_indices_make_no_triangle() {
        for mode in 4..7 {
            for n in 0..3 {
                assert!(triangles(mode, &[0, 1][..n.min(2)]).unwrap().is_empty());
            }
        }
        assert!(triangles(1, &[0, 1, 2]).is_none());
    }
}
