//! What `penumbra compare` found, as JSON and as a table.

use serde_json::{Value, json};

use crate::compare::{Comparison, Extreme, Figures, Judgement, Noise, Pair, Verdict};

/// Everything that was found, without pixels. `a` and `b` are names of files, the renders of each side.
pub fn json(comparison: &Comparison, a: &[String], b: &[String]) -> Value {
    json!({
        "a": a,
        "b": b,
        "size": [comparison.width, comparison.height],
        "agrees": comparison.agrees(),
        "passes": comparison.pairs.iter().map(of_pair).collect::<Vec<_>>(),
        "only_a": comparison.only_a,
        "only_b": comparison.only_b,
        "unlike": comparison.unlike,
    })
}

fn of_pair(pair: &Pair) -> Value {
    let Pair { name, figures: f, .. } = pair;
    let channels = f.channels.iter().map(|c| {
        let bias = c.mean_b - c.mean_a;
        json!({"name": c.name, "mean_a": c.mean_a, "mean_b": c.mean_b, "bias": bias, "standard_error": c.standard_error})
    });
    let worst = f.worst.iter().map(|w| json!({"x": w.x, "y": w.y, "channel": w.channel, "a": w.a, "b": w.b}));
    let worst: Vec<Value> = worst.collect();
    let j = &f.judgement;
    json!({
        "pass": name,
        "verdict": verdict(j.verdict),
        "why": why(pair),
        "channels": channels.collect::<Vec<_>>(),
        "mean": f.mean,
        "bias": f.bias,
        "bias_share": share(f),
        "standard_error": f.standard_error,
        "rmse": f.rmse,
        "noise_rmse": f.noise_rmse,
        "rel_mse": f.rel_mse,
        "psnr_db": f.psnr.is_finite().then_some(f.psnr),
        "flip": f.flip,
        "max": worst.first(),
        "worst": worst,
        "not_finite": {"a": f.not_finite[0], "b": f.not_finite[1]},
        "background_of_one": f.background_of_one,
        "noise": {"a": noise(j.noise[0]), "b": noise(j.noise[1])},
        "tests": j.tests,
        "failed": j.failed,
        "limit_sigmas": j.limit,
        "extreme": j.extreme.as_ref().map(|e| json!({
            "block": e.at, "channel": f.channels[e.channel].name, "bias": e.bias,
            "share": finite(e.share), "sigmas": finite(e.sigmas),
        })),
    })
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Bias over the mean of the reference's magnitude.
fn share(figures: &Figures) -> Option<f64> {
    finite(figures.bias / figures.mean)
}

fn noise(noise: Noise) -> &'static str {
    match noise {
        Noise::Seeds => "seeds",
        Noise::ErrorPass => "error pass",
        Noise::Unknown => "unknown",
    }
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Same => "same",
        Verdict::Agrees => "agrees",
        Verdict::Differs => "differs",
        Verdict::NotJudged => "not judged",
    }
}

/// The verdict in a sentence.
fn why(pair: &Pair) -> String {
    let figures = &pair.figures;
    let Judgement { verdict, noise, tests, failed, limit, extreme } = &figures.judgement;
    let from = match noise {
        [Noise::Unknown, Noise::Unknown] => "noise taken from how differences vary within blocks",
        [Noise::Unknown, _] => "noise of B alone is known",
        [_, Noise::Unknown] => "noise of A alone is known",
        _ => "noise of both is known",
    };
    let holes = match figures.background_of_one {
        0 => String::new(),
        n => format!("; {n} pixels are background in one of the two alone"),
    };
    let extreme = || extreme.as_ref().map(|it| place(it, figures)).unwrap_or_default();
    match verdict {
        Verdict::Same => "bit for bit the same".to_owned(),
        Verdict::NotJudged => "tells of the render, not of the scene".to_owned(),
        Verdict::Agrees => {
            format!("{tests} means within {limit:.1} standard errors or 0.5 %, {from}; farthest {}{holes}", extreme())
        }
        Verdict::Differs if *failed == 0 => format!("where the background is differs{holes}"),
        Verdict::Differs => {
            format!(
                "{failed} of {tests} means beyond {limit:.1} standard errors and 0.5 %, {from}; worst {}{holes}",
                extreme()
            )
        }
    }
}

fn place(extreme: &Extreme, figures: &Figures) -> String {
    let channel = &figures.channels[extreme.channel].name;
    let at = extreme.at.map_or("the whole picture".to_owned(), |[x, y]| format!("the block at {x},{y}"));
    let share = 100.0 * extreme.share * extreme.bias.signum();
    if extreme.sigmas.is_finite() {
        format!("{at} in {channel}: {share:+.2} %, {:.1} standard errors", extreme.sigmas)
    } else {
        format!("{at} in {channel}: {share:+.2} %, without noise")
    }
}

/// A table for the terminal, a line for each pass, and what is missing.
pub fn table(comparison: &Comparison) -> String {
    const HEAD: [&str; 9] = ["pass", "mean of A", "bias", "+-", "RMSE", "relMSE", "PSNR dB", "FLIP", "verdict"];
    let rows = comparison.pairs.iter().map(|pair| {
        let f = &pair.figures;
        let percent = |value: Option<f64>, sign: bool| match value.map(|v| 100.0 * v / f.mean) {
            Some(v) if v.is_finite() && sign => format!("{v:+.3} %"),
            Some(v) if v.is_finite() => format!("{v:.3} %"),
            _ => "-".to_owned(),
        };
        let number = |value: f64| if value.is_finite() { format!("{value:.4}") } else { "-".to_owned() };
        [
            pair.name.clone(),
            short(f.mean),
            percent(Some(f.bias), true),
            percent(f.standard_error, false),
            short(f.rmse),
            short(f.rel_mse),
            if f.psnr.is_finite() { format!("{:.1}", f.psnr) } else { "-".to_owned() },
            f.flip.map_or("-".to_owned(), number),
            verdict(f.judgement.verdict).to_owned(),
        ]
    });
    let rows: Vec<[String; 9]> = std::iter::once(HEAD.map(str::to_owned)).chain(rows).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; 9] = std::array::from_fn(width);
    let mut text = String::new();
    for row in &rows {
        for (column, (cell, width)) in row.iter().zip(widths).enumerate() {
            // Words to the left, numbers to the right.
            let cell = if matches!(column, 0 | 8) { format!("{cell:<width$}") } else { format!("{cell:>width$}") };
            text += &cell;
            text += "  ";
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
    text + &remarks(comparison)
}

/// Four digits, in whatever form is short.
fn short(value: f64) -> String {
    match value.abs() {
        size if size == 0.0 || (1e-3..1e5).contains(&size) => format!("{value:.4}"),
        _ => format!("{value:.3e}"),
    }
}

fn remarks(comparison: &Comparison) -> String {
    let mut text = String::new();
    let mut line = |what: String| text += &(what + "\n");
    for pair in &comparison.pairs {
        let f = &pair.figures;
        if f.judgement.verdict == Verdict::Differs {
            line(format!("{}: {}", pair.name, why(pair)));
            if let Some(w) = f.worst.first() {
                line(format!(
                    "{}: largest difference at {},{} in {}: {} and {}",
                    pair.name, w.x, w.y, w.channel, w.a, w.b
                ));
            }
        }
        for (side, count) in ["A", "B"].iter().zip(f.not_finite).filter(|(_, count)| *count > 0) {
            line(format!("{}: {count} values of {side} are not finite; their pixels are left out", pair.name));
        }
    }
    for (side, names) in [("A", &comparison.only_a), ("B", &comparison.only_b)] {
        if !names.is_empty() {
            line(format!("only in {side}: {}", names.join(", ")));
        }
    }
    for what in &comparison.unlike {
        line(format!("not compared, other channels: {what}"));
    }
    text
}
