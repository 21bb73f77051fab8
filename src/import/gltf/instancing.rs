//! EXT_mesh_gpu_instancing: one node, many places.

use super::accessor::Reader;
use super::json::Instancing;
use super::node::from_trs;
use crate::math::DAffine3;

/// Instance to node, for each instance. The error is a sentence without place.
pub(super) fn transforms(reader: Reader<'_>, instancing: &Instancing) -> Result<Vec<DAffine3>, String> {
    fn read<const N: usize>(reader: Reader<'_>, instancing: &Instancing, name: &str) -> Result<Vec<[f64; N]>, String> {
        let Some(&accessor) = instancing.attributes.get(name) else { return Ok(Vec::new()) };
        let values = reader.floats::<N>(accessor).map_err(|e| format!("EXT_mesh_gpu_instancing {name}: {e}"))?;
        Ok(values.into_iter().map(|value| value.map(f64::from)).collect())
    }
    let translations = read::<3>(reader, instancing, "TRANSLATION")?;
    let rotations = read::<4>(reader, instancing, "ROTATION")?;
    let scales = read::<3>(reader, instancing, "SCALE")?;
    let counts = [translations.len(), rotations.len(), scales.len()];
    let count = counts.into_iter().max().unwrap_or(0);
    if counts.iter().any(|&n| n != 0 && n != count) {
        return Err(format!("EXT_mesh_gpu_instancing has attributes of unequal counts: {counts:?}"));
    }
    let transform = |i: usize| {
        from_trs(
            translations.get(i).copied().unwrap_or([0.0; 3]),
            rotations.get(i).copied().unwrap_or([0.0, 0.0, 0.0, 1.0]),
            scales.get(i).copied().unwrap_or([1.0; 3]),
        )
    };
    Ok((0..count).map(transform).collect())
}
