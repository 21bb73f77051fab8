//! What `penumbra converge` found, as JSON and as a table.

use serde_json::{Value, json};

use crate::converge::{Kind, Measured, Reference};

/// Everything about a series of measurements that is no measurement.
pub struct Circumstances<'a> {
    /// The scene, as given.
    pub scene: &'a str,
    /// Name of its camera.
    pub camera: &'a str,
    /// Layer that was looked at.
    pub layer: &'a str,
    /// Width and height.
    pub size: [u32; 2],
    /// Renders of each way.
    pub seeds: u32,
    /// Threads of each render.
    pub threads: usize,
    /// What pictures were held against.
    pub reference: &'a Reference,
}

/// RMSE at which ways are compared: that of the base's last picture, and halves of it.
fn targets(all: &[Measured]) -> Vec<f64> {
    let last = all.first().and_then(|base| base.curve.points.last()).map_or(0.0, |point| point.variance.sqrt());
    [2.0, 1.0, 0.5, 0.25].iter().map(|factor| factor * last).filter(|target| *target > 0.0).collect()
}

/// Of ways that give the base's picture in another way, or are it, those that reach `rmse`, the fastest first.
fn fastest(all: &[Measured], rmse: f64) -> Vec<(&Measured, f64)> {
    let mut list: Vec<(&Measured, f64)> =
        all.iter().filter(|it| !it.is_base).filter_map(|it| Some((it, it.curve.seconds_to(rmse)?))).collect();
    list.sort_by(|a, b| a.1.total_cmp(&b.1));
    list
}

/// What leaving something out saves: shares of the base's time and noise at its last picture. `None` for ways that
/// leave nothing out or change nothing.
pub(super) fn saving(all: &[Measured], one: &Measured) -> Option<(f64, f64)> {
    let base = all.first()?.curve.points.last()?;
    let other = one.curve.points.last().filter(|_| !one.is_base)?;
    matches!(one.configuration.kind, Kind::Without | Kind::WithoutPass)
        .then(|| (1.0 - other.seconds / base.seconds, 1.0 - other.variance / base.variance))
}

fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Base => "base",
        Kind::Way => "way",
        Kind::Without => "without",
        Kind::WithoutPass => "without pass",
        Kind::Denoised => "denoised",
    }
}

/// All of it. Errors are scene-linear.
pub fn json(all: &[Measured], of: &Circumstances<'_>) -> Value {
    let targets = targets(all);
    let ways = all.iter().map(|it| {
        let points = it.curve.points.iter().map(|p| {
            json!({
                "spp": p.spp, "seconds": p.seconds, "rmse": p.mse.sqrt(), "rel_mse": p.rel_mse, "variance": p.variance,
                "bias_squared": p.bias_squared, "bias_squared_standard_error": p.bias_error,
                "bias": p.known_bias().sqrt(),
            })
        });
        let saving = saving(all, it);
        json!({
            "name": it.configuration.name,
            "kind": kind(it.configuration.kind),
            "changes": it.configuration.changes.iter().map(|(name, value)| json!({name: value})).collect::<Vec<_>>(),
            "same_as_base": it.is_base,
            "points": points.collect::<Vec<_>>(),
            "slope": it.curve.slope,
            "efficiency": it.curve.efficiency(),
            "seconds_to": targets.iter().map(|target| it.curve.seconds_to(*target)).collect::<Vec<_>>(),
            "time_share": saving.map(|saving| saving.0),
            "error_share": saving.map(|saving| saving.1),
        })
    });
    json!({
        "scene": of.scene,
        "camera": of.camera,
        "layer": of.layer,
        "size": of.size,
        "seeds": of.seeds,
        "threads": of.threads,
        "reference": {"origin": of.reference.origin, "mean": of.reference.mean()},
        "targets_rmse": targets,
        "cheapest": targets.iter().map(|t| fastest(all, *t).first().map(|(it, seconds)| {
            json!({"rmse": t, "name": it.configuration.name, "seconds": seconds})
        })).collect::<Vec<_>>(),
        "configurations": ways.collect::<Vec<_>>(),
    })
}

/// Rows of the table, the first of which is its head.
pub(super) fn rows(all: &[Measured], of: &Circumstances<'_>) -> Vec<Vec<String>> {
    let targets = targets(all);
    let mean = of.reference.mean().max(f64::MIN_POSITIVE);
    let percent = |rmse: f64| format!("{:.2} %", 100.0 * rmse / mean);
    let base = all.first().and_then(|base| base.curve.efficiency());
    let head = ["way", "spp", "seconds", "noise", "bias", "slope", "efficiency"].map(str::to_owned);
    let mut rows =
        vec![[&head[..], &targets.iter().map(|t| format!("s to {}", percent(*t))).collect::<Vec<_>>()].concat()];
    for it in all {
        let name = it.configuration.name.clone();
        let Some(last) = it.curve.points.last() else { continue };
        if it.is_base {
            let mut row = vec![name, "changes nothing here".to_owned()];
            row.resize(rows[0].len(), String::new());
            rows.push(row);
            continue;
        }
        let bias = if last.known_bias() > 0.0 { percent(last.known_bias().sqrt()) } else { "none seen".to_owned() };
        let efficiency =
            it.curve.efficiency().zip(base).map_or("-".to_owned(), |(own, base)| format!("{:.2}", own / base));
        let mut row = vec![
            name,
            format!("{:.0}", last.spp),
            format!("{:.2}", last.seconds),
            percent(last.variance.sqrt()),
            bias,
            it.curve.slope.map_or("-".to_owned(), |slope| format!("{slope:.2}")),
            efficiency,
        ];
        row.extend(targets.iter().map(|t| it.curve.seconds_to(*t).map_or("never".to_owned(), |s| format!("{s:.1}"))));
        rows.push(row);
    }
    rows
}

/// Sentences: the cheapest way to each error, and what each effect and pass costs.
pub(super) fn sentences(all: &[Measured], of: &Circumstances<'_>) -> Vec<String> {
    let mean = of.reference.mean().max(f64::MIN_POSITIVE);
    let mut list = Vec::new();
    for target in targets(all) {
        if let Some((it, seconds)) = fastest(all, target).first() {
            let percent = 100.0 * target / mean;
            list.push(format!(
                "{percent:.2} % of the mean is reached first by {}, in {seconds:.1} s",
                it.configuration.name
            ));
        }
    }
    for it in all {
        if let Some((time, error)) = saving(all, it) {
            let what = &it.configuration.name;
            list.push(match it.configuration.kind {
                Kind::WithoutPass => format!("{what}: {:.0} % of the time saved", 100.0 * time),
                _ => format!(
                    "{what}: saves {:.0} % of the time and {:.0} % of the squared noise",
                    100.0 * time,
                    100.0 * error
                ),
            });
        }
    }
    list
}

/// For the terminal.
pub fn table(all: &[Measured], of: &Circumstances<'_>) -> String {
    let rows = rows(all, of);
    let columns = rows[0].len();
    let widths: Vec<usize> = (0..columns)
        .map(|c| {
            rows.iter()
                .filter(|row| row[1] != "changes nothing here" || c == 0)
                .map(|row| row[c].chars().count())
                .max()
                .unwrap_or(0)
        })
        .collect();
    let mut text = String::new();
    for row in &rows {
        for (c, (cell, width)) in row.iter().zip(&widths).enumerate() {
            let width = *width;
            text += &if c == 0 || cell == "changes nothing here" {
                format!("{cell:<width$}  ")
            } else {
                format!("{cell:>width$}  ")
            };
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
    text += &format!(
        "errors of {} in percent of its mean, {:.4}; reference: {}\n",
        of.layer,
        of.reference.mean(),
        of.reference.origin
    );
    sentences(all, of).into_iter().for_each(|line| text += &(line + "\n"));
    text
}
