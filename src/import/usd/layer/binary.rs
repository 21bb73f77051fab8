//! Binary layers ("crate" files) of versions that the openusd crate does not read, or in which it does not know
//! a value's type. Their tables are written anew behind the rest of the file; no other byte moves.
//!
//! Versions 0.12 to 0.14 differ from 0.11 in what they may hold: curves, how tangents were found, edits of
//! arrays. Blocks of animation are in files of any version. `Usd_CrateFile` describes the format.

use openusd::usdc::{CrateFile, MAGIC};

use super::Mended;
use super::kept::EDIT;

/// Bytes in which a layer's kind and version are told.
pub(super) const HEAD: usize = 16;

/// Where the minor version stands.
const MINOR: usize = MAGIC.len() + 1;
/// The last version that the crate reads, and that is known here.
const READ: u8 = 12;
const LAST: u8 = 14;

/// The field of an attribute's samples.
const SAMPLES: &str = "timeSamples";

/// Values: six bytes of data or of a place in the file, a type, flags.
const TYPE: u64 = 0xff << 48;
const ARRAY: u64 = 1 << 63;
const INLINED: u64 = 1 << 62;
const IS_EDIT: u64 = 1 << 60;
const DATA: u64 = (1 << 48) - 1;
const UCHAR: u64 = 2 << 48;
const BLOCK: u64 = 51 << 48;
const SPLINE: u64 = 59 << 48;
const ANIMATION_BLOCK: u64 = 60 << 48;

/// True for a binary layer.
pub(super) fn is_binary(head: &[u8]) -> bool {
    head.starts_with(MAGIC)
}

/// True where a version or the type of a value is newer than the crate; also where that can't be told.
fn is_newer(bytes: &[u8]) -> bool {
    let is_known = |value: &[u8]| {
        let value = value.try_into().map_or(0, u64::from_le_bytes);
        value & IS_EDIT == 0 && !matches!(value & TYPE, SPLINE | ANIMATION_BLOCK)
    };
    let newer = bytes.get(MINOR).is_some_and(|version| *version > READ);
    newer || values(bytes).is_none_or(|values| !values.chunks_exact(8).all(is_known))
}

/// The values of all fields, unpacked.
fn values(bytes: &[u8]) -> Option<Vec<u8>> {
    let entry = section(bytes, "FIELDS")?;
    let count = number(bytes, number(bytes, entry + 16)?)?;
    let names = number(bytes, entry + 16)? + 8;
    let packed = names.checked_add(8)?.checked_add(number(bytes, names)?)?;
    let start = packed.checked_add(8)?;
    let packed = bytes.get(start..start.checked_add(number(bytes, packed)?)?)?;
    unpack(packed, count.checked_mul(8)?)
}

/// The file in the crate's words; `None` where it is in them, or broken.
pub(super) fn mend(bytes: &[u8]) -> Option<Mended> {
    if !is_newer(bytes) || bytes.get(MINOR - 1) != Some(&0) {
        return None;
    }
    let mut bytes = bytes.to_vec();
    let version = bytes.get_mut(MINOR).filter(|version| **version <= LAST)?;
    let is_read = *version <= READ;
    *version = (*version).min(READ);
    let mut file = CrateFile::open(bytes.clone()).ok()?;
    let mut mended = Mended { bytes: Vec::new(), renamed: false, splines: false, told: Vec::new() };
    let mut changed = false;
    let mut edits = Vec::new();
    let mut blocks = Vec::new();
    for i in 0..file.fields.len() {
        let value = file.fields[i].value_rep.0;
        let (name, value) = match value & TYPE {
            _ if value & IS_EDIT != 0 => {
                edits.push(i);
                (Some(EDIT), BLOCK | INLINED)
            }
            // Their bytes, counted as those of an array are.
            SPLINE => {
                mended.splines = true;
                (None, UCHAR | ARRAY | (value & DATA))
            }
            // Hides the samples of weaker layers: known to the crate as samples that are blocked.
            ANIMATION_BLOCK => {
                blocks.push(i);
                (Some(SAMPLES), BLOCK | INLINED)
            }
            _ => continue,
        };
        changed = true;
        file.fields[i].value_rep.0 = value;
        if let Some(name) = name {
            file.fields[i].token_index = token(&mut file.tokens, name);
        }
    }
    if !changed {
        return (!is_read).then_some(Mended { bytes, ..mended });
    }
    mended.told = told(&file, &edits);
    if let Some(fieldsets) = unblocked(&mut file, &blocks) {
        append(&mut bytes, "FIELDSETS", &fieldsets)?;
    }
    append(&mut bytes, "TOKENS", &tokens(&file)?)?;
    append(&mut bytes, "FIELDS", &fields(&file)?)?;
    Some(Mended { bytes, ..mended })
}

/// The table of sets of fields, in which samples count before the blocks among their own set; `None` where no set
/// has both.
fn unblocked(file: &mut CrateFile, blocks: &[usize]) -> Option<Vec<u8>> {
    let is_samples = |field: usize| {
        let name = file.fields.get(field).and_then(|field| file.tokens.get(field.token_index));
        name.is_some_and(|name| name == SAMPLES) && !blocks.contains(&field)
    };
    let mut both = Vec::new();
    let mut start = 0;
    for set in file.fieldsets.split(Option::is_none) {
        if !blocks.is_empty() && set.iter().flatten().any(|field| is_samples(*field)) {
            both.extend((0..set.len()).filter(|&i| set[i].is_some_and(|f| blocks.contains(&f))).map(|i| start + i));
        }
        start += set.len() + 1;
    }
    let &field = blocks.first().filter(|_| !both.is_empty())?;
    let mut spare = file.fields[field];
    spare.token_index = token(&mut file.tokens, EDIT);
    file.fields.push(spare);
    both.into_iter().for_each(|i| file.fieldsets[i] = Some(file.fields.len() - 1));
    let indices: Option<Vec<i32>> =
        file.fieldsets.iter().map(|field| field.map_or(Some(-1), |field| i32::try_from(field).ok())).collect();
    let mut data = (file.fieldsets.len() as u64).to_le_bytes().to_vec();
    data.extend(block(&integers(&indices?))?);
    Some(data)
}

/// Index of the token `name`, which is added where it is not there.
fn token(tokens: &mut Vec<String>, name: &str) -> usize {
    tokens.iter().position(|token| token == name).unwrap_or_else(|| {
        tokens.push(name.into());
        tokens.len() - 1
    })
}

/// The attributes that have one of the fields `edits`.
fn told(file: &CrateFile, edits: &[usize]) -> Vec<(String, String)> {
    let is_edited = |start: usize| {
        let set = file.fieldsets.get(start..).unwrap_or_default();
        set.iter().map_while(|field| *field).any(|field| edits.contains(&field))
    };
    let edited = file.specs.iter().filter(|spec| !edits.is_empty() && is_edited(spec.fieldset_index));
    let path = |index: usize| file.paths.get(index).map(ToString::to_string);
    edited.filter_map(|spec| Some((path(spec.path_index)?, super::EDIT_IS_NOT_MADE.into()))).collect()
}

/// Puts `data` at the end of the file and makes it the section `name`.
fn append(bytes: &mut Vec<u8>, name: &str, data: &[u8]) -> Option<()> {
    let entry = section(bytes, name)?;
    let start = bytes.len() as u64;
    bytes.extend_from_slice(data);
    bytes.get_mut(entry + 16..entry + 24)?.copy_from_slice(&start.to_le_bytes());
    bytes.get_mut(entry + 24..entry + 32)?.copy_from_slice(&(data.len() as u64).to_le_bytes());
    Some(())
}

/// Where the table of contents has the section `name`: 16 bytes of name, its start, its size.
fn section(bytes: &[u8], name: &str) -> Option<usize> {
    let contents = number(bytes, HEAD)?;
    let count = number(bytes, contents)?.min(bytes.len() / 32);
    (0..count).map(|i| contents + 8 + 32 * i).find(|&entry| {
        bytes.get(entry..entry + 16).is_some_and(|text| text.split(|&b| b == 0).next() == Some(name.as_bytes()))
    })
}

/// The number at `at`.
fn number(bytes: &[u8], at: usize) -> Option<usize> {
    usize::try_from(u64::from_le_bytes(bytes.get(at..at.checked_add(8)?)?.try_into().ok()?)).ok()
}

/// What a block of LZ4 holds, at most `size` bytes; `None` for one that is broken or in pieces, which no file
/// of tables has.
fn unpack(block: &[u8], size: usize) -> Option<Vec<u8>> {
    let (&pieces, block) = block.split_first()?;
    if pieces != 0 {
        return None;
    }
    let mut input = block.iter();
    let mut output = Vec::new();
    while let Some(token) = input.next() {
        let count = length(token >> 4, &mut input)?;
        output.extend_from_slice(input.as_slice().get(..count)?);
        input = input.as_slice()[count..].iter();
        let Some(low) = input.next() else { break };
        let back = usize::from(u16::from_le_bytes([*low, *input.next()?]));
        let count = length(token & 15, &mut input)? + 4;
        let start = output.len().checked_sub(back).filter(|_| back > 0)?;
        if output.len() + count > size {
            return None;
        }
        (start..start + count).for_each(|i| output.push(output[i]));
    }
    Some(output)
}

/// A length whose first four bits are `first`.
fn length(first: u8, input: &mut std::slice::Iter<'_, u8>) -> Option<usize> {
    let mut length = usize::from(first);
    let mut more = first == 15;
    while more {
        let byte = *input.next()?;
        length += usize::from(byte);
        more = byte == 255;
    }
    Some(length)
}

fn tokens(file: &CrateFile) -> Option<Vec<u8>> {
    let text: Vec<u8> = file.tokens.iter().flat_map(|token| token.bytes().chain([0])).collect();
    let mut data = (file.tokens.len() as u64).to_le_bytes().to_vec();
    data.extend((text.len() as u64).to_le_bytes());
    data.extend(block(&text)?);
    Some(data)
}

fn fields(file: &CrateFile) -> Option<Vec<u8>> {
    let indices: Option<Vec<i32>> = file.fields.iter().map(|field| i32::try_from(field.token_index).ok()).collect();
    let values: Vec<u8> = file.fields.iter().flat_map(|field| field.value_rep.0.to_le_bytes()).collect();
    let mut data = (file.fields.len() as u64).to_le_bytes().to_vec();
    data.extend(block(&integers(&indices?))?);
    data.extend(block(&values)?);
    Some(data)
}

/// Integers as `Usd_IntegerCompression` has them, each by its whole difference to the one before.
fn integers(values: &[i32]) -> Vec<u8> {
    let mut data = vec![0; 4];
    data.extend(values.chunks(4).map(|four| 0xff_u8 >> (8 - 2 * four.len())));
    let before = std::iter::once(&0).chain(values);
    data.extend(values.iter().zip(before).flat_map(|(value, before)| value.wrapping_sub(*before).to_le_bytes()));
    data
}

/// `data` as one block of LZ4 that says all of it word for word, with its length before it.
fn block(data: &[u8]) -> Option<Vec<u8>> {
    let mut packed = vec![0];
    match data.len().checked_sub(15) {
        None => packed.push(u8::try_from(data.len()).ok()? << 4),
        Some(rest) => {
            packed.push(0xf0);
            packed.extend(std::iter::repeat_n(255, rest / 255));
            packed.push((rest % 255) as u8);
        }
    }
    packed.extend_from_slice(data);
    let mut block = (packed.len() as u64).to_le_bytes().to_vec();
    block.append(&mut packed);
    Some(block)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is packed here and elsewhere comes out as it was.
    #[test]
    fn blocks_are_unpacked() {
        for length in [0, 1, 14, 15, 16, 269, 270, 271, 1000] {
            let data: Vec<u8> = (0..length).map(|i| (i * 7 % 251) as u8).collect();
            assert_eq!(unpack(&block(&data).unwrap()[8..], length), Some(data));
        }
        // A literal, then nine more of it; and what reaches before the start or beyond the size.
        let again = [0, 0x15, b'a', 1, 0, 0x10, b'b'];
        assert_eq!(unpack(&again, 11).as_deref(), Some(&b"aaaaaaaaaab"[..]));
        assert_eq!(unpack(&again, 9), None);
        assert_eq!(unpack(&[0, 0x15, b'a', 2, 0, 0x10, b'b'], 11), None);
        assert_eq!(unpack(&[1, 0x10, b'a'], 1), None);
    }

    #[test]
    fn broken_files_are_left_to_the_crate() {
        let file = std::fs::read("tests/data/usd/corpus/rich.usdc").unwrap();
        assert!(!is_newer(&file) && mend(&file).is_none());
        for end in (0..file.len()).step_by(97) {
            assert!(mend(&file[..end]).is_none(), "{end} bytes");
        }
    }
}
