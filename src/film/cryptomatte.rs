//! Cryptomatte: which names cover a pixel, and by how much.
//!
//! Jonah Friedman, Andrew C. Jones: *Fully automatic ID mattes with support for motion blur and
//! transparency*, SIGGRAPH 2015 posters; Psyop, *Cryptomatte Specification* 1.2.0. An id is the
//! MurmurHash3_32 of a name, read as a float whose exponent is neither 0 nor 255.

use std::collections::BTreeMap;

use super::quantity::Quantity;

/// How many ids a file holds per pixel; two to a layer.
pub const DEPTH: usize = 6;

/// What a Cryptomatte tells apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CryptoKind {
    /// Objects.
    Object,
    /// Materials.
    Material,
    /// Topmost parents.
    Asset,
}

impl CryptoKind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Object, Self::Material, Self::Asset];

    /// Layer name without its two digits, as Blender writes it.
    pub const fn layer(self) -> &'static str {
        match self {
            Self::Object => "CryptoObject",
            Self::Material => "CryptoMaterial",
            Self::Asset => "CryptoAsset",
        }
    }

    /// What the film keeps for it.
    pub const fn quantity(self) -> Quantity {
        match self {
            Self::Object => Quantity::CryptoObject,
            Self::Material => Quantity::CryptoMaterial,
            Self::Asset => Quantity::CryptoAsset,
        }
    }
}

/// MurmurHash3_x86_32 (Austin Appleby, public domain algorithm).
pub fn murmur3_32(bytes: &[u8], seed: u32) -> u32 {
    let scramble = |k: u32| k.wrapping_mul(0xcc9e_2d51).rotate_left(15).wrapping_mul(0x1b87_3593);
    let mut h = seed;
    let mut blocks = bytes.chunks_exact(4);
    for block in &mut blocks {
        h ^= scramble(u32::from_le_bytes([block[0], block[1], block[2], block[3]]));
        h = h.rotate_left(13).wrapping_mul(5).wrapping_add(0xe654_6b64);
    }
    let tail = blocks.remainder().iter().rev().fold(0, |k, &byte| k << 8 | u32::from(byte));
    h ^= scramble(tail);
    h ^= bytes.len() as u32;
    h = (h ^ h >> 16).wrapping_mul(0x85eb_ca6b);
    h = (h ^ h >> 13).wrapping_mul(0xc2b2_ae35);
    h ^ h >> 16
}

/// The id of a name: its hash as float bits, never a denormal, an infinity or NaN.
pub fn id_from_name(name: &str) -> f32 {
    let hash = murmur3_32(name.as_bytes(), 0);
    let exponent = hash >> 23 & 0xff;
    // Specification 1.2.0, "ID generation": flip the lowest exponent bit of the forbidden two.
    let bits = if exponent == 0 || exponent == 255 { hash ^ 1 << 23 } else { hash };
    f32::from_bits(bits)
}

/// The names behind the ids of one kind, for the file's header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Manifest {
    /// Which Cryptomatte it belongs to.
    pub kind: CryptoKind,
    /// The names in the scene; those that repeat count once.
    pub names: Vec<String>,
}

impl Manifest {
    /// `{"name":"8 hexadecimal digits of the id's bits",…}`, sorted by name.
    pub fn to_json(&self) -> String {
        let ids: BTreeMap<&str, String> =
            self.names.iter().map(|name| (name.as_str(), format!("{:08x}", id_from_name(name).to_bits()))).collect();
        serde_json::to_string(&ids).unwrap_or_else(|_| "{}".to_owned())
    }
}

/// Id and summed coverage.
type Entry = (u32, f32);
const INLINE: usize = 4;

/// The ids seen in one pixel; more than four go to the heap.
#[derive(Clone, Debug, Default)]
pub(super) struct Matte {
    inline: [Entry; INLINE],
    #[allow(clippy::box_collection)] // One pointer in the many pixels that never need it.
    spill: Option<Box<Vec<Entry>>>,
}

impl Matte {
    /// Adds `coverage` to `id`; an id of 0 is nothing.
    pub(super) fn add(&mut self, id: f32, coverage: f32) {
        let id = id.to_bits();
        if id == 0 || coverage == 0.0 {
            return;
        }
        let inline = self.inline.iter_mut().find(|entry| entry.0 == id || entry.0 == 0);
        if let Some(entry) = inline {
            *entry = (id, entry.1 + coverage);
            return;
        }
        let spill = self.spill.get_or_insert_default();
        match spill.iter_mut().find(|entry| entry.0 == id) {
            Some(entry) => entry.1 += coverage,
            None => spill.push((id, coverage)),
        }
    }

    /// The [`DEPTH`] largest as id, coverage, id, coverage, …; coverages are fractions of `count` samples.
    pub(super) fn rank(&self, count: u32) -> [f32; 2 * DEPTH] {
        let spill = self.spill.iter().flat_map(|spill| spill.iter());
        let mut entries: Vec<Entry> = self.inline.iter().chain(spill).copied().filter(|entry| entry.1 > 0.0).collect();
        entries.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let mut out = [0.0; 2 * DEPTH];
        for (pair, entry) in out.chunks_exact_mut(2).zip(entries) {
            pair[0] = f32::from_bits(entry.0);
            pair[1] = entry.1 / count.max(1) as f32;
        }
        out
    }

    /// Ids and coverages in the order in which they came.
    pub(super) fn entries(&self) -> impl Iterator<Item = (u32, f32)> {
        let spill = self.spill.iter().flat_map(|spill| spill.iter());
        self.inline.iter().filter(|entry| entry.0 != 0).chain(spill).copied()
    }

    /// Of what [`Self::entries`] gave.
    pub(super) fn of_entries(entries: &[(u32, f32)]) -> Self {
        let mut matte = Self::default();
        let (inline, spill) = entries.split_at(entries.len().min(INLINE));
        matte.inline[..inline.len()].copy_from_slice(inline);
        if !spill.is_empty() {
            matte.spill = Some(Box::new(spill.to_vec()));
        }
        matte
    }

    pub(super) fn heap_bytes(&self) -> usize {
        self.spill.as_ref().map_or(0, |spill| size_of::<Vec<Entry>>() + spill.capacity() * size_of::<Entry>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn murmur3_gives_the_published_vectors() {
        let vectors: [(&str, u32, u32); 9] = [
            ("", 0, 0),
            ("", 1, 0x514e_28b7),
            ("", 0xffff_ffff, 0x81f1_6f39),
            ("test", 0, 0xba6b_d213),
            ("test", 0x9747_b28c, 0x704b_81dc),
            ("Hello, world!", 0, 0xc036_3e43),
            ("Hello, world!", 0x9747_b28c, 0x2488_4cba),
            ("The quick brown fox jumps over the lazy dog", 0, 0x2e4f_f723),
            ("The quick brown fox jumps over the lazy dog", 0x9747_b28c, 0x2fa8_26cd),
        ];
        for (text, seed, hash) in vectors {
            assert_eq!(murmur3_32(text.as_bytes(), seed), hash, "{text:?} {seed:x}");
        }
    }

    #[test]
    fn manifest_holds_what_blender_writes_for_its_default_scene() {
        let names = ["Light", "Cube", "Cube", "object"].map(String::from).to_vec();
        let json = Manifest { kind: CryptoKind::Object, names }.to_json();
        assert_eq!(json, r#"{"Cube":"a8fce865","Light":"c77d43e5","object":"055ec73d"}"#);
    }

    #[test]
    fn ids_are_normal_floats_even_where_the_hash_is_not() {
        let mut forbidden = 0;
        for i in 0..4000 {
            let name = format!("object {i}");
            let exponent = murmur3_32(name.as_bytes(), 0) >> 23 & 0xff;
            forbidden += u32::from(exponent == 0 || exponent == 255);
            assert!(id_from_name(&name).is_normal(), "{name}");
        }
        assert!(forbidden > 10, "the names must reach the rule, {forbidden} did");
    }

    #[test]
    fn names_with_quotes_and_umlauts_stay_json() {
        let names = vec!["a\"b\\c".to_owned(), "Würfel".to_owned()];
        let json = Manifest { kind: CryptoKind::Asset, names }.to_json();
        let parsed: BTreeMap<String, String> = serde_json::from_str(&json).expect("valid JSON");
        assert_eq!(parsed["Würfel"], format!("{:08x}", id_from_name("Würfel").to_bits()));
        assert!(parsed.contains_key("a\"b\\c"));
    }

    #[test]
    fn ranks_by_coverage_beyond_the_inline_capacity() {
        let mut matte = Matte::default();
        for (id, times) in [(1.0, 1), (2.0, 2), (3.0, 9), (4.0, 4), (5.0, 5), (6.0, 6), (7.0, 7), (8.0, 8)] {
            for _ in 0..times {
                matte.add(id, 0.5);
            }
        }
        matte.add(0.0, 1.0);
        let ranked = matte.rank(42);
        assert_eq!(ranked[..6], [3.0, 4.5 / 42.0, 8.0, 4.0 / 42.0, 7.0, 3.5 / 42.0]);
        assert_eq!(ranked[10], 4.0);
        assert!(matte.heap_bytes() > 0);
    }
}
