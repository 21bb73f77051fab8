//! EXT_meshopt_compression and its successor KHR_meshopt_compression: buffer views decoded before
//! anything reads them.
//!
//! The decoder (zeux's meshoptimizer) checks the bounds of what it reads and writes; its output may
//! be anything, which accessors are checked for anyway.

use rayon::prelude::*;

use super::buffer::Buffers;
use super::json::Root;
use crate::error::{Error, Place, Result};

/// The codec's blocks of up to 256 vertices cost at least a byte for every four bytes of stride.
const LARGEST_RATIO: usize = 1024;

/// Decodes every compressed view; `None` for the others.
pub(super) fn decode_views(root: &Root, buffers: &Buffers<'_>, place: &Place) -> Result<Vec<Option<Vec<u8>>>> {
    // Many views of the same few bytes could ask for any amount of memory.
    let sizes = root.buffer_views.iter().filter_map(|view| view.extensions.meshopt.as_ref());
    let total = sizes.fold(0_usize, |sum, json| sum.saturating_add(json.count.saturating_mul(json.byte_stride)));
    if total / LARGEST_RATIO > buffers.total_bytes {
        return Err(Error::invalid(place, format!("EXT_meshopt_compression: {total} bytes can't come from this file")));
    }
    let decode = |(i, view): (usize, &super::json::BufferView)| {
        let Some(json) = &view.extensions.meshopt else { return Ok(None) };
        let here = place.at(format!("buffer view {i}"));
        decoder::decode(json, buffers)
            .map_err(|e| Error::invalid(&here, format!("EXT_meshopt_compression: {e}")))
            .map(Some)
    };
    root.buffer_views.par_iter().enumerate().map(decode).collect()
}

#[cfg(feature = "meshopt")]
mod decoder {
    use bytemuck::Zeroable;

    use super::super::buffer::Buffers;
    use super::super::json::Meshopt;
    use super::LARGEST_RATIO;

    /// The bytes of a compressed view. The error is a sentence without place.
    pub fn decode(json: &Meshopt, buffers: &Buffers<'_>) -> Result<Vec<u8>, String> {
        let encoded = buffers.slice(json.buffer, json.byte_offset, json.byte_length)?;
        let (count, stride) = (json.count, json.byte_stride);
        let size = count.checked_mul(stride).filter(|&size| size / LARGEST_RATIO <= encoded.len());
        if size.is_none() {
            return Err(format!("{count} elements of {stride} bytes can't come from {} bytes", encoded.len()));
        }
        let bad = |e: meshopt::Error| format!("the data doesn't decode: {e}");
        let mut bytes = match (json.mode.as_str(), stride) {
            ("ATTRIBUTES", _) => attributes(encoded, count, stride)?,
            ("TRIANGLES", _) if !count.is_multiple_of(3) => return Err(format!("{count} indices make no triangles")),
            ("TRIANGLES", 2) => to_bytes(meshopt::decode_index_buffer::<u16>(encoded, count).map_err(bad)?),
            ("TRIANGLES", 4) => to_bytes(meshopt::decode_index_buffer::<u32>(encoded, count).map_err(bad)?),
            ("INDICES", 2) => to_bytes(meshopt::decode_index_sequence::<u16>(encoded, count).map_err(bad)?),
            ("INDICES", 4) => to_bytes(meshopt::decode_index_sequence::<u32>(encoded, count).map_err(bad)?),
            (mode, _) => return Err(format!("mode '{mode}' with a stride of {stride} bytes is not defined")),
        };
        filter(json.filter.as_deref().unwrap_or("NONE"), stride, &mut bytes)?;
        Ok(bytes)
    }

    fn to_bytes<T: bytemuck::Pod>(values: Vec<T>) -> Vec<u8> {
        bytemuck::cast_slice(&values).to_vec()
    }

    /// Vertices of a stride that is only known at run time; the decoder takes it from a type.
    fn attributes(encoded: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, String> {
        fn typed<const N: usize>(encoded: &[u8], count: usize) -> Result<Vec<u8>, String> {
            #[derive(Clone, Copy)]
            struct Vertex<const N: usize>([u8; N]);
            impl<const N: usize> Default for Vertex<N> {
                fn default() -> Self {
                    Self([0; N])
                }
            }
            let vertices = meshopt::decode_vertex_buffer::<Vertex<N>>(encoded, count);
            let vertices = vertices.map_err(|e| format!("the data doesn't decode: {e}"))?;
            Ok(vertices.iter().flat_map(|vertex| vertex.0).collect())
        }
        macro_rules! strides {
            ($($n:literal)*) => {
                match stride {
                    $($n => typed::<$n>(encoded, count),)*
                    _ => Err(format!("a stride of {stride} bytes: only multiples of 4 up to 256 are defined")),
                }
            };
        }
        strides!(
            4 8 12 16 20 24 28 32 36 40 44 48 52 56 60 64 68 72 76 80 84 88 92 96 100 104 108 112 116 120 124 128
            132 136 140 144 148 152 156 160 164 168 172 176 180 184 188 192 196 200 204 208 212 216 220 224 228 232
            236 240 244 248 252 256
        )
    }

    /// Undoes a filter in place.
    fn filter(name: &str, stride: usize, bytes: &mut [u8]) -> Result<(), String> {
        /// Elements copied out, so that they stand aligned, and back.
        fn each<T: bytemuck::Pod + Zeroable>(bytes: &mut [u8], decode: impl Fn(&mut [T])) {
            let mut values: Vec<T> = bytemuck::pod_collect_to_vec(bytes);
            decode(&mut values);
            bytes.copy_from_slice(&bytemuck::cast_slice(&values)[..bytes.len()]);
        }
        match (name, stride) {
            ("NONE", _) => {}
            ("OCTAHEDRAL", 4) => each::<[i8; 4]>(bytes, meshopt::decode_filter_oct),
            ("OCTAHEDRAL", 8) => each::<[i16; 4]>(bytes, meshopt::decode_filter_oct),
            ("QUATERNION", 8) => each::<[i16; 4]>(bytes, meshopt::decode_filter_quat),
            ("EXPONENTIAL", _) if stride.is_multiple_of(4) => each::<[u32; 1]>(bytes, meshopt::decode_filter_exp),
            ("COLOR", 4) => each::<[u8; 4]>(bytes, meshopt::decode_filter_color),
            ("COLOR", 8) => each::<[u16; 4]>(bytes, meshopt::decode_filter_color),
            _ => return Err(format!("filter '{name}' with a stride of {stride} bytes is not defined")),
        }
        Ok(())
    }
}

#[cfg(not(feature = "meshopt"))]
mod decoder {
    use super::super::buffer::Buffers;
    use super::super::json::Meshopt;

    /// Says that this build can't.
    pub fn decode(_: &Meshopt, _: &Buffers<'_>) -> Result<Vec<u8>, String> {
        Err("this build was made without the feature 'meshopt'".into())
    }
}
