//! A page that shows two pictures side by side: one file that opens from disk, with nothing to load.

use std::io::Write;
use std::path::Path;

use serde_json::{Value, json};

use super::{compare, embed};
use crate::compare::{Comparison, Pair};
use crate::error::Result;
use crate::output::file;

/// The page without its data, which stand in the place of [`DATA`].
const TEMPLATE: &str = include_str!("compare_page.html");
const DATA: &str = "__DATA__";

/// Numbers that the page may hold: 192 MB before they are packed. Larger pictures are reduced; around the worst pixels
/// they are whole.
const MOST_NUMBERS: usize = 96 << 20;

/// Side of what is shown around a worst pixel.
const CROP: usize = 33;

/// Bins of differences.
const BINS: usize = 81;

/// Writes the page in full or not at all. `a` and `b` are the names of the renders of either side.
///
/// # Errors
/// A file that can't be written.
pub fn write(path: &Path, comparison: &Comparison, a: &[String], b: &[String]) -> Result<()> {
    let page = page(comparison, a, b);
    file::replace(path, |mut out| out.write_all(page.as_bytes()))
}

fn page(comparison: &Comparison, a: &[String], b: &[String]) -> String {
    let mut data = compare::json(comparison, a, b);
    let pixels = comparison.width as usize * comparison.height as usize;
    let numbers: usize = comparison.pairs.iter().map(|pair| 2 * pixels * pair.a.channels.len()).sum();
    let factor = (1..).find(|f| numbers / (f * f) <= MOST_NUMBERS).unwrap_or(1);
    data["factor"] = json!(factor);
    if let Some(list) = data["passes"].as_array_mut() {
        for (value, pair) in list.iter_mut().zip(&comparison.pairs) {
            value["view"] = view(pair, comparison.width as usize, factor);
        }
    }
    // What looks like the end of the script would be one.
    let data = data.to_string().replace("</", "<\\/");
    TEMPLATE.replacen(DATA, &data, 1)
}

/// Pixels of a pass, what they are shown by, and the histogram of their differences.
fn view(pair: &Pair, width: usize, factor: usize) -> Value {
    let (a, b) = pair.values();
    let n = pair.a.channels.len();
    let (small_a, small_width, small_height) = embed::reduced(a, n, width, factor);
    let (small_b, ..) = embed::reduced(b, n, width, factor);
    let scale = scale(a, n);
    let scaled = |values: &[f32]| embed::halves(&values.iter().map(|v| v * scale.recip()).collect::<Vec<_>>(), n);
    let flip = &pair.figures.flip_map;
    let flip = (!flip.is_empty()).then(|| embed::shares(&embed::reduced(flip, 1, width, factor).0));
    let crops = pair.figures.worst.iter().map(|worst| {
        let [(part_a, place), (part_b, _)] =
            [a, b].map(|values| embed::crop(values, n, width, [worst.x, worst.y], CROP));
        json!({"place": place, "a": scaled(&part_a), "b": scaled(&part_b)})
    });
    json!({
        "size": [small_width, small_height],
        "scale": scale,
        "is_color": pair.a.is_color,
        "a": scaled(&small_a),
        "b": scaled(&small_b),
        "flip": flip,
        "crops": crops.collect::<Vec<_>>(),
        "histogram": histogram(a, b, n),
    })
}

/// What values are divided by to be shown: 1 for colors, else the magnitude that one in a hundred exceeds, where that
/// would not fit a half float or a display.
fn scale(values: &[f32], channels: usize) -> f32 {
    let is_color = channels >= 3;
    let mut sizes: Vec<f32> = values.iter().map(|v| v.abs()).filter(|v| v.is_finite() && *v < 1e9).collect();
    if sizes.is_empty() {
        return 1.0;
    }
    let rank = sizes.len() - 1 - sizes.len() / 100;
    let size = *sizes.select_nth_unstable_by(rank, f32::total_cmp).1;
    if (is_color && size < 1000.0) || size <= 1.0 { 1.0 } else { size }
}

/// How often which difference of B to A occurs, over all channels: the range, which one in a thousand exceeds, and
/// counts from its lower end on; what is beyond is in the outermost.
fn histogram(a: &[f32], b: &[f32], channels: usize) -> Value {
    let mut differences: Vec<f32> = a
        .chunks_exact(channels)
        .zip(b.chunks_exact(channels))
        .flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| b - a))
        .filter(|d| d.is_finite())
        .collect();
    if differences.is_empty() {
        return Value::Null;
    }
    let rank = differences.len() - 1 - differences.len() / 1000;
    let size = differences.select_nth_unstable_by(rank, |a, b| a.abs().total_cmp(&b.abs())).1.abs();
    let mut counts = vec![0_u64; BINS];
    for d in differences {
        let at = if size > 0.0 { (d / size * 0.5 + 0.5) * BINS as f32 } else { BINS as f32 / 2.0 };
        counts[(at.max(0.0) as usize).min(BINS - 1)] += 1;
    }
    json!({"range": size, "counts": counts})
}
