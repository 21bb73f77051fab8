//! A page on what accuracy costs: the plot, the table, pictures at equal time.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use base64::Engine;

use super::converge::{Circumstances, rows, sentences};
use super::plot::{self, Line, escaped};
use crate::converge::{Kind, Measured, Point};
use crate::error::Result;
use crate::film::{Layer, Storage};
use crate::output::{file, png};

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;margin:24px;max-width:1200px;color:#222;background:#fff}\
table{border-collapse:collapse;font-variant-numeric:tabular-nums}th,td{padding:3px 10px;text-align:right;border-bottom:1px solid #ddd}\
th:first-child,td:first-child{text-align:left}figure{display:inline-block;margin:8px}figcaption{font-size:13px;color:#555;max-width:320px}\
img{image-rendering:pixelated;min-width:256px}";

/// Writes `index.html` and `error.svg` into a folder.
///
/// # Errors
/// Files that can't be written.
pub fn write(folder: &Path, all: &[Measured], of: &Circumstances<'_>) -> Result<()> {
    let svg = plot(all, of);
    file::replace(&folder.join("error.svg"), |mut out| out.write_all(svg.as_bytes()))?;
    let page = page(all, of, &svg)?;
    file::replace(&folder.join("index.html"), |mut out| out.write_all(page.as_bytes()))
}

/// RMSE over seconds of all ways that are not the base's picture.
fn plot(all: &[Measured], of: &Circumstances<'_>) -> String {
    let mean = of.reference.mean().max(f64::MIN_POSITIVE);
    let line = |it: &Measured| Line {
        name: it.configuration.name.clone(),
        points: it.curve.points.iter().map(|p| [p.seconds, 100.0 * p.mse.sqrt() / mean]).collect(),
        dashed: matches!(it.configuration.kind, Kind::Without | Kind::WithoutPass),
    };
    let lines: Vec<Line> = all.iter().filter(|it| !it.is_base).map(line).collect();
    plot::svg(&lines, "seconds of rendering", &format!("RMSE of {}, % of its mean", of.layer))
}

fn page(all: &[Measured], of: &Circumstances<'_>, svg: &str) -> Result<String> {
    let Circumstances { scene, camera, layer, size: [width, height], seeds, threads, reference } = of;
    let mut page = format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Penumbra converge: {0}</title><style>{STYLE}</style><h1>{0}</h1>",
        escaped(scene)
    );
    let _ = write!(
        page,
        "<p>{} at {width} × {height} pixels, camera {}, {seeds} renders of each way on {threads} threads. Reference: {}.</p>{svg}<table>",
        escaped(layer),
        escaped(camera),
        escaped(&reference.origin)
    );
    for (i, row) in rows(all, of).iter().enumerate() {
        let tag = if i == 0 { "th" } else { "td" };
        let cells: String = row.iter().map(|cell| format!("<{tag}>{}", escaped(cell))).collect();
        let _ = write!(page, "<tr>{cells}");
    }
    page += "</table><p>Noise and bias in percent of the picture's mean; noise is what differs between seeds, bias what does not. Slope: exponent of the noise over seconds. Efficiency: 1 / (MSE × s), over the base's.</p><ul>";
    sentences(all, of).iter().for_each(|line| page += &format!("<li>{}", escaped(line)));
    page += "</ul>";
    let time = all.first().and_then(|base| base.curve.points.last()).map_or(0.0, |point| 0.5 * point.seconds);
    let _ = write!(page, "<h2>At equal time: {time:.2} s</h2>");
    page += &figure("reference", &reference.values, *width, *height)?;
    for it in all.iter().filter(|it| !it.is_base) {
        if let Some(point) = nearest(&it.curve.points, time) {
            let mean = reference.mean().max(f64::MIN_POSITIVE);
            let caption = format!(
                "{}: {:.0} spp, {:.2} s, RMSE {:.2} %",
                it.configuration.name,
                point.spp,
                point.seconds,
                100.0 * point.mse.sqrt() / mean
            );
            page += &figure(&caption, &point.picture, *width, *height)?;
        }
    }
    page += "</html>\n";
    Ok(page)
}

/// The point whose time is nearest, by ratio.
fn nearest(points: &[Point], seconds: f64) -> Option<&Point> {
    let distance = |point: &Point| (point.seconds / seconds).ln().abs();
    points.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

fn figure(caption: &str, values: &[f32], width: u32, height: u32) -> Result<String> {
    let channels = ["R", "G", "B"].map(str::to_owned).to_vec();
    let layer = Layer { name: String::new(), channels, data: values.to_vec(), storage: Storage::Color };
    let picture = base64::engine::general_purpose::STANDARD.encode(png::bytes(&layer, width, height)?);
    let caption = escaped(caption);
    Ok(format!(
        "<figure><img width=\"{width}\" alt=\"{caption}\" src=\"data:image/png;base64,{picture}\"><figcaption>{caption}</figcaption></figure>"
    ))
}
