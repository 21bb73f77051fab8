//! The attributes of a primitive by name, from accessors or from a compressed piece.

use super::accessor::Reader;
use super::draco::Decoded;
use super::json::Primitive;

/// Where a primitive's attributes come from. Errors are sentences that name the attribute.
pub(super) struct Attributes<'a> {
    reader: Reader<'a>,
    primitive: &'a Primitive,
    compressed: Option<Decoded<'a>>,
}

impl<'a> Attributes<'a> {
    /// Decodes what is compressed.
    pub fn new(reader: Reader<'a>, primitive: &'a Primitive) -> Result<Self, String> {
        let compressed = primitive.extensions.draco.as_ref().map(|json| Decoded::new(reader, json)).transpose()?;
        Ok(Self { reader, primitive, compressed })
    }

    /// The index list; `None` where points come in order.
    pub fn indices(&self) -> Result<Option<Vec<u32>>, String> {
        if let Some(compressed) = &self.compressed {
            return Ok(Some(compressed.indices()));
        }
        let Some(accessor) = self.primitive.indices else { return Ok(None) };
        let indices = self.reader.integers::<1>(accessor).map_err(|e| format!("indices: {e}"))?;
        Ok(Some(indices.into_flattened()))
    }

    /// Values of `N` numbers; `None` where the primitive has no such attribute.
    pub fn floats<const N: usize>(&self, name: &str) -> Result<Option<Vec<[f32; N]>>, String> {
        let Some(&accessor) = self.primitive.attributes.get(name) else { return Ok(None) };
        let read = || match self.compressed.as_ref().and_then(|compressed| compressed.floats::<N>(name)) {
            Some(mut values) => {
                let scale = self.reader.normalization(accessor)?;
                if scale != 1.0 {
                    values.iter_mut().flatten().for_each(|v| *v = (*v * scale).max(-1.0));
                }
                Ok(values)
            }
            None => self.reader.floats::<N>(accessor),
        };
        read().map(Some).map_err(|e: String| format!("{name}: {e}"))
    }

    /// Values of `N` unsigned integers.
    pub fn integers<const N: usize>(&self, name: &str) -> Result<Option<Vec<[u32; N]>>, String> {
        let Some(&accessor) = self.primitive.attributes.get(name) else { return Ok(None) };
        if let Some(values) = self.compressed.as_ref().and_then(|compressed| compressed.floats::<N>(name)) {
            return Ok(Some(values.into_iter().map(|value| value.map(|v| v as u32)).collect()));
        }
        self.reader.integers::<N>(accessor).map(Some).map_err(|e| format!("{name}: {e}"))
    }

    /// How many components an attribute has; 0 where the primitive has no such attribute.
    pub fn components(&self, name: &str) -> Result<usize, String> {
        let Some(&accessor) = self.primitive.attributes.get(name) else { return Ok(0) };
        self.reader.components(accessor).map_err(|e| format!("{name}: {e}"))
    }
}
