//! Sampling in proportion to tabulated weights.

mod alias;
mod bilinear;
mod image;

pub use alias::{AliasSample, AliasTable};
pub use bilinear::{BilinearImage, BilinearSample};
pub use image::{Distribution2d, ImageSample};
