//! Two pictures of one scene, side by side: layers matched by name, figures of each pass, and a verdict that noise
//! passes and bias fails.
//!
//! What is known of noise comes from the files: from renders with other seeds, or from the `error` passes. See
//! `docs/compare.md` for the definitions.

mod cryptomatte;
mod figures;
pub mod flip;
mod names;
mod side;
mod verdict;

use std::fmt;

pub use figures::{ChannelFigures, Figures, Worst};
pub use names::{Names, pass_of};
pub use side::{Layer, Noise, Side};
pub use verdict::{Extreme, Judgement, Verdict};

/// A layer that both pictures have.
#[derive(Clone, Debug)]
pub struct Pair {
    /// Its name, with the view layer where there are several.
    pub name: String,
    /// Of the first picture, the reference.
    pub a: Layer,
    /// Of the second.
    pub b: Layer,
    /// What the two say.
    pub figures: Figures,
}

impl Pair {
    /// What is compared: the means of both.
    pub fn values(&self) -> (&[f32], &[f32]) {
        (&self.a.mean, &self.b.mean)
    }
}

/// Everything that was found out of two pictures.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// In the order of the first picture.
    pub pairs: Vec<Pair>,
    /// Layers of the first picture alone.
    pub only_a: Vec<String>,
    /// Layers of the second picture alone.
    pub only_b: Vec<String>,
    /// Layers of both whose channels are not the same, with what is wrong.
    pub unlike: Vec<String>,
}

/// Pictures that can't be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SizesDiffer {
    /// Of the first, width and height.
    pub a: [u32; 2],
    /// Of the second.
    pub b: [u32; 2],
}

impl fmt::Display for SizesDiffer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { a: [aw, ah], b: [bw, bh] } = self;
        write!(f, "the pictures have different sizes: {aw} x {ah} and {bw} x {bh} pixels")
    }
}

/// What to compare, and how.
#[derive(Clone, Debug)]
pub struct Options {
    /// Names of passes as `--passes` has them, or of layers; all where empty.
    pub passes: Vec<String>,
    /// FLIP costs more than all else.
    pub flip: bool,
    /// How many passes are judged altogether, in this comparison and others: the more there are, the farther the
    /// farthest is by chance.
    pub among: u32,
}

impl Default for Options {
    fn default() -> Self {
        Self { passes: Vec::new(), flip: true, among: 1 }
    }
}

/// Compares `b` with the reference `a`.
///
/// # Errors
/// Pictures of different sizes.
pub fn compare(a: Side, b: Side, options: &Options) -> Result<Comparison, SizesDiffer> {
    if (a.width, a.height) != (b.width, b.height) {
        return Err(SizesDiffer { a: [a.width, a.height], b: [b.width, b.height] });
    }
    let (width, height) = (a.width, a.height);
    let matched = names::matched(a.layers, b.layers, &options.passes);
    let (mut pairs, mut unlike) = (Vec::new(), Vec::new());
    for (name, mut a, mut b) in matched.pairs {
        if !a.coverage.is_empty() && !b.coverage.is_empty() {
            cryptomatte::spread(&mut a, &mut b);
        }
        if a.channels != b.channels {
            unlike.push(format!("{name}: {} and {}", a.channels.concat(), b.channels.concat()));
            continue;
        }
        let figures = Figures::of(&name, &a, &b, width as usize, options);
        pairs.push(Pair { name, a, b, figures });
    }
    Ok(Comparison { width, height, pairs, only_a: matched.only_a, only_b: matched.only_b, unlike })
}

impl Comparison {
    /// True where no pass differs.
    pub fn agrees(&self) -> bool {
        self.pairs.iter().all(|pair| pair.figures.judgement.verdict != Verdict::Differs)
    }
}
