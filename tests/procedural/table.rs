//! Tables of reference values.

use std::fs;
use std::path::Path;

/// One evaluation: menu choices, position and sockets, outputs.
pub struct Line {
    text: String,
    choices: Vec<String>,
    inputs: Vec<f32>,
    outputs: Vec<f32>,
}

impl Line {
    /// What was picked in the menu of that number.
    pub fn choice(&self, i: usize) -> &str {
        &self.choices[i]
    }

    /// Position and sockets.
    pub fn inputs<const N: usize>(&self) -> [f32; N] {
        self.inputs.as_slice().try_into().unwrap_or_else(|_| panic!("not {N} inputs: {}", self.text))
    }

    fn parse(text: &str) -> Self {
        let mut columns = text.split('|');
        let mut column = || columns.next().unwrap().split_whitespace();
        let choices = column().map(str::to_owned).collect();
        let inputs = column().map(|n| n.parse().unwrap()).collect();
        let outputs = column().map(|n| n.parse().unwrap()).collect();
        Self { text: text.to_owned(), choices, inputs, outputs }
    }

    /// The largest difference of an output, relative to 1 or to the value if that is larger.
    fn error(&self, ours: &[f32]) -> f32 {
        assert_eq!(ours.len(), self.outputs.len(), "{}", self.text);
        let error = |(a, b): (&f32, &f32)| if a == b || a.is_nan() && b.is_nan() { 0.0 } else { (a - b).abs() / b.abs().max(1.0) };
        ours.iter().zip(&self.outputs).map(error).fold(0.0, |most, e| if e > most || e.is_nan() { e } else { most })
    }
}

/// Every line of a table against what `evaluate` makes of it.
pub fn compare(name: &str, tolerance: f32, evaluate: impl Fn(&Line) -> Vec<f32>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/procedural/reference").join(format!("{name}.txt"));
    let lines: Vec<Line> =
        fs::read_to_string(path).unwrap().lines().filter(|l| !l.starts_with('#')).map(Line::parse).collect();
    assert!(lines.len() > 60, "{name}: {} lines", lines.len());
    let mut wrong = Vec::new();
    let mut largest = 0.0_f32;
    for line in &lines {
        let ours = evaluate(line);
        let error = line.error(&ours);
        if error <= tolerance {
            largest = largest.max(error);
        } else {
            wrong.push(format!("{}\n   ours {ours:?}, off by {error}", line.text));
        }
    }
    println!("{name}: {} of {} lines agree, largest difference {largest:e}", lines.len() - wrong.len(), lines.len());
    assert!(wrong.is_empty(), "{name}: {} of {} lines differ:\n{}", wrong.len(), lines.len(), wrong.join("\n"));
}
