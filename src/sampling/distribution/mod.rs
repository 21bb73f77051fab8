//! Sampling in proportion to tabulated weights.

mod alias;
mod image;

pub use alias::{AliasSample, AliasTable};
pub use image::{Distribution2d, ImageSample};
