//! Images that were decoded before, for scenes that are handed over again and again.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;
use std::time::SystemTime;

use super::blending::Reading;
use super::colors::Space;
use crate::desc::ImageDesc;

/// What tells whether an image is still the same.
#[derive(Clone, Debug, PartialEq)]
pub enum Version {
    /// A file, by when it was written last and its size.
    File { path: String, written: Option<SystemTime>, bytes: u64, space: Space },
    /// An image in memory, by how many were handed over before it.
    Memory { revision: u64, space: Space },
}

impl Version {
    /// That of the file at `path` as it is now; `None` where there is none.
    pub fn of_file(path: &str, space: Space) -> Option<Self> {
        let data = Path::new(path).metadata().ok()?;
        Some(Self::File { path: path.to_owned(), written: data.modified().ok(), bytes: data.len(), space })
    }
}

/// An image that is asked for.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Wanted {
    /// Its name.
    pub name: String,
    /// The tile of it.
    pub tile: Option<u32>,
    /// How it is made ready.
    pub reading: Reading,
}

/// Decoded images; none where nothing is kept, so that a single render holds no texel twice.
#[derive(Debug, Default)]
pub struct KeptImages {
    on: bool,
    images: HashMap<Wanted, (Version, Arc<ImageDesc>)>,
}

impl KeptImages {
    /// Keeps from now on what is decoded.
    pub fn turn_on(&mut self) {
        self.on = true;
    }

    /// The image, if it was decoded in this very version.
    pub fn get(&self, key: &Wanted, version: &Version) -> Option<Arc<ImageDesc>> {
        self.images.get(key).filter(|(known, _)| known == version).map(|(_, image)| image.clone())
    }

    /// Keeps these images and forgets all others.
    pub fn replace(&mut self, images: impl Iterator<Item = (Wanted, Version, Arc<ImageDesc>)>) {
        if self.on {
            self.images = images.map(|(key, version, image)| (key, (version, image))).collect();
        }
    }
}
