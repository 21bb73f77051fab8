//! KHR_draco_mesh_compression: the triangles and attributes of a primitive in one compressed piece.

use std::collections::BTreeMap;

use draco_core::decode_limits::DecodeLimits;
use draco_core::{DecoderBuffer, Mesh, MeshDecoder};

use super::accessor::Reader;
use super::json::Draco;

/// Faces and points that any piece may claim; more only in proportion to its bytes.
const FREE_ELEMENTS: u64 = 1 << 20;

/// A decoded primitive.
pub(super) struct Decoded<'a> {
    mesh: Mesh,
    ids: &'a BTreeMap<String, u32>,
}

impl<'a> Decoded<'a> {
    /// Decodes. The error is a sentence without place.
    pub fn new(reader: Reader<'_>, json: &'a Draco) -> Result<Self, String> {
        let view = json.buffer_view.ok_or("KHR_draco_mesh_compression names no buffer view")?;
        let (bytes, _) = reader.buffers.view(reader.root, view)?;
        // Connectivity and smooth attributes can take far less than a bit for each element.
        let elements = FREE_ELEMENTS.max(256 * bytes.len() as u64);
        let limits = DecodeLimits::default()
            .with_max_faces(elements)
            .with_max_points(elements)
            .with_max_decoded_bytes(64 * elements);
        let mut mesh = Mesh::new();
        let decoded = MeshDecoder::new().decode(&mut DecoderBuffer::new(bytes).with_limits(limits), &mut mesh);
        decoded.map_err(|e| format!("KHR_draco_mesh_compression: the data doesn't decode: {e}"))?;
        Ok(Self { mesh, ids: &json.attributes })
    }

    /// Three point indices for each triangle.
    pub fn indices(&self) -> Vec<u32> {
        self.mesh.faces().iter().flatten().map(|point| point.0).collect()
    }

    /// The values of an attribute, integers as they are; `None` where it is not in the piece.
    pub fn floats<const N: usize>(&self, name: &str) -> Option<Vec<[f32; N]>> {
        let attribute = self.mesh.attribute_by_unique_id(*self.ids.get(name)?)?;
        let values = attribute.read_f32s(self.mesh.num_points(), N);
        Some(values.as_chunks().0.to_vec())
    }
}
