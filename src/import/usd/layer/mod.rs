//! What OpenUSD writes into layers and the openusd crate does not read, in words that it does read: mended as
//! the bytes come from the disk, before the crate sees them.

mod binary;
mod kept;
mod lex;
mod names;
mod text;

pub(super) use kept::{Kept, Site, inactive_ids};
pub(super) use names::restore as restore_names;

use std::io::{self, Cursor, Read, Seek};

use openusd::ar::{Asset, AssetBuffer};

/// What is told of an edit of an array.
const EDIT_IS_NOT_MADE: &str = "is an edit of an array, which is not made; the weaker value stands";

/// Bytes of a layer in the crate's words.
struct Mended {
    bytes: Vec<u8>,
    /// True where an attribute has a curve, kept as [`kept`] finds it.
    splines: bool,
    /// True where names of properties are in other letters, as [`names`] has them.
    renamed: bool,
    /// Paths in the layer, and what is told of them.
    told: Vec<(String, String)>,
}

/// What was met in the layers that were read so far.
#[derive(Default)]
pub(super) struct Met {
    pub splines: bool,
    pub renamed: bool,
    /// Layer, path in it, and what is told.
    pub told: Vec<(String, String, String)>,
}

/// The asset `name` as the crate is to read it.
///
/// # Errors
/// What can't be read.
pub(super) fn mend(mut asset: Box<dyn Asset>, name: &str, met: &mut Met) -> io::Result<Box<dyn Asset>> {
    let mut head = [0; binary::HEAD];
    let mut length = 0;
    while let count @ 1.. = asset.read(&mut head[length..])? {
        length += count;
    }
    asset.rewind()?;
    let head = &head[..length];
    let is_text = head.trim_ascii_start().starts_with(openusd::usda::MAGIC);
    if !is_text && !binary::is_binary(head) {
        return Ok(asset);
    }
    let bytes = asset.into_buffer()?;
    let mended = if is_text { text::mend(&bytes) } else { binary::mend(&bytes) };
    let Some(Mended { bytes, splines, renamed, told }) = mended else { return Ok(Box::new(Cursor::new(bytes))) };
    met.splines |= splines;
    met.renamed |= renamed;
    met.told.extend(told.into_iter().map(|(path, what)| (name.to_string(), path, what)));
    Ok(Box::new(Cursor::new(AssetBuffer::Owned(bytes))))
}
