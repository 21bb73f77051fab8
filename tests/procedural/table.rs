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

    /// The same with the last two bits of an input moved up or down.
    fn nudged(&self, input: usize, up: bool) -> Self {
        let mut inputs = self.inputs.clone();
        for _ in 0..3 {
            inputs[input] = if up { inputs[input].next_up() } else { inputs[input].next_down() };
        }
        Self { text: self.text.clone(), choices: self.choices.clone(), inputs, outputs: Vec::new() }
    }
}

/// The largest difference, relative to `unit` or to the value if that is larger.
fn difference(ours: &[f32], theirs: &[f32], unit: f32) -> f32 {
    assert_eq!(ours.len(), theirs.len());
    let one = |(a, b): (&f32, &f32)| if a == b { 0.0 } else { (a - b).abs() / b.abs().max(unit) };
    ours.iter().zip(theirs).map(one).fold(0.0, |most, d| if d > most || d.is_nan() { d } else { most })
}

/// Every line of a table against what `evaluate` makes of it, within `tolerance` relative to 1 or to the
/// value if that is larger.
pub fn compare(name: &str, tolerance: f32, evaluate: impl Fn(&Line) -> Vec<f32>) {
    compare_in(name, tolerance, 1.0, evaluate);
}

/// The same in another unit than 1: dark skies are compared among themselves.
///
/// Fifteen octaves, sines of sines and far positions make large differences of the last bits of the
/// position, and Cycles rounds its intermediate results in its own way (not even its versions agree on
/// these lines). A line may differ by what such bits do to it; at most one in fifty may need that.
pub fn compare_in(name: &str, tolerance: f32, unit: f32, evaluate: impl Fn(&Line) -> Vec<f32>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/procedural/reference").join(format!("{name}.txt"));
    let text = fs::read_to_string(path).unwrap();
    let lines: Vec<Line> = text.lines().filter(|l| !l.starts_with('#')).map(Line::parse).collect();
    assert!(lines.len() >= 24, "{name}: {} lines", lines.len());
    let (mut wrong, mut sensitive, mut largest) = (Vec::new(), 0, 0.0_f32);
    for line in &lines {
        let ours = evaluate(line);
        let off = difference(&ours, &line.outputs, unit);
        let last_bits = |input: usize| {
            let nudged = |up| difference(&evaluate(&line.nudged(input, up)), &ours, unit);
            nudged(true).max(nudged(false))
        };
        if off <= tolerance {
            largest = largest.max(off);
        } else if off <= (0..line.inputs.len().min(4)).map(last_bits).sum() {
            sensitive += 1;
        } else {
            wrong.push(format!("{}\n   ours {ours:?}, off by {off}", line.text));
        }
    }
    let of = lines.len();
    println!(
        "{name}: {} of {of} lines agree within {largest:e}, {sensitive} by the last bits",
        of - wrong.len() - sensitive
    );
    assert!(wrong.is_empty(), "{name}: {} of {of} lines differ:\n{}", wrong.len(), wrong.join("\n"));
    assert!(sensitive * 50 <= of, "{name}: {sensitive} of {of} lines agree by the last bits only");
}
