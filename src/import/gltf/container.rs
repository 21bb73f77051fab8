//! The outer shell: a `.gltf` is the JSON itself, a `.glb` is a header and chunks
//! (glTF 2.0, section 4.4: magic, version, length; then length, type, data of each chunk).

use crate::error::{Error, Place, Result};

const MAGIC: &[u8; 4] = b"glTF";
const CHUNK_JSON: u32 = 0x4E4F_534A;
const CHUNK_BIN: u32 = 0x004E_4942;

/// The two parts of a file.
pub(super) struct Container<'a> {
    /// The JSON text.
    pub json: &'a [u8],
    /// The binary chunk, which is buffer 0 where that has no URI.
    pub bin: Option<&'a [u8]>,
}

/// Splits `bytes` into JSON and binary chunk.
pub(super) fn split<'a>(bytes: &'a [u8], place: &Place) -> Result<Container<'a>> {
    if !bytes.starts_with(MAGIC) {
        let json = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        return match json.iter().find(|b| !b.is_ascii_whitespace()) {
            Some(b'{') => Ok(Container { json, bin: None }),
            Some(_) => Err(Error::invalid(place, "neither a .glb (no 'glTF' magic) nor JSON")),
            None => Err(Error::invalid(place, "the file is empty")),
        };
    }
    let word = |at: usize| -> Option<u32> {
        let word = bytes.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(word.try_into().ok()?))
    };
    let truncated = |what: &str| Error::invalid(place, format!("truncated .glb: {what}"));
    let version = word(4).ok_or_else(|| truncated("no header"))?;
    if version != 2 {
        return Err(Error::unsupported(place, format!("binary glTF version {version}; only version 2 is read")));
    }
    let length = word(8).ok_or_else(|| truncated("no header"))? as usize;
    if length > bytes.len() {
        return Err(truncated(&format!("the header says {length} bytes, the file has {}", bytes.len())));
    }
    let mut container = Container { json: &[], bin: None };
    let mut at = 12;
    while at + 8 <= length {
        let (Some(size), Some(kind)) = (word(at), word(at + 4)) else { break };
        let end = (at + 8).checked_add(size as usize).filter(|&end| end <= length);
        let end = end.ok_or_else(|| truncated(&format!("a chunk of {size} bytes reaches past the end")))?;
        let data = &bytes[at + 8..end];
        match kind {
            CHUNK_JSON if container.json.is_empty() => container.json = data,
            CHUNK_BIN if container.bin.is_none() => container.bin = Some(data),
            _ => {}
        }
        at = end.next_multiple_of(4);
    }
    if container.json.is_empty() { Err(Error::invalid(place, "a .glb without JSON chunk")) } else { Ok(container) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glb(version: u32, chunks: &[(u32, &[u8])]) -> Vec<u8> {
        let mut out = b"glTF".to_vec();
        out.extend(version.to_le_bytes());
        let length: usize = 12 + chunks.iter().map(|(_, data)| 8 + data.len()).sum::<usize>();
        out.extend((length as u32).to_le_bytes());
        for (kind, data) in chunks {
            out.extend((data.len() as u32).to_le_bytes());
            out.extend(kind.to_le_bytes());
            out.extend_from_slice(data);
        }
        out
    }

    #[test]
    fn chunks_are_found_and_unknown_ones_skipped() {
        let bytes = glb(2, &[(CHUNK_JSON, b"{}  "), (7, b"????"), (CHUNK_BIN, b"data")]);
        let container = split(&bytes, &Place::default()).unwrap();
        assert_eq!((container.json, container.bin), (&b"{}  "[..], Some(&b"data"[..])));
    }

    #[test]
    fn every_truncation_is_an_error() {
        let bytes = glb(2, &[(CHUNK_JSON, b"{}  "), (CHUNK_BIN, b"data")]);
        for length in 0..bytes.len() {
            assert!(split(&bytes[..length], &Place::default()).is_err(), "{length} bytes");
        }
    }

    #[test]
    fn version_1_is_refused_by_name() {
        let error = split(&glb(1, &[]), &Place::default()).err().unwrap().to_string();
        assert!(error.contains("version 1"), "{error}");
    }
}
