//! What a render gathers: passes, filters, and the sums behind every pixel.
//!
//! [`PASSES`] says what a picture can hold and what each pass is made of; a [`PassSet`] chooses; a
//! [`Film`] adds up exactly the quantities the choice needs, in tiles that threads own one at a time,
//! and [`Film::develop`] turns them into a [`Picture`] at any moment.

mod accuracy;
mod aov;
mod chosen;
pub mod cryptomatte;
mod filter;
mod pass;
mod pass_set;
mod picture;
mod quantity;
mod replicates;
mod sample;
mod store;
mod tile;

pub use accuracy::{Accuracy, Doubt, Figure, PixelErrors};
pub use aov::{Aov, AovKind};
pub use chosen::Chosen;
pub use filter::{FILTERS, Filter, FilterRow};
pub use pass::{PASSES, Pass, Storage};
pub use pass_set::PassSet;
pub use picture::{Layer, Picture};
pub use quantity::{Quantities, Quantity};
pub use replicates::{LEAST_PER_REPLICATE, REPLICATES};
pub use sample::{CryptoSample, FirstHit, GroupSample, PixelSample, Split};
pub use store::Film;
pub use tile::{NonFinite, SampleId, Tile};
