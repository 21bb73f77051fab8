//! Damage to a rich stage and to one of skeletons, whose text mostly still parses and so reaches deep into the
//! door: numbers turn huge, negative and not finite, arrays shrink and grow, lines go and come twice, tokens and
//! paths trade places. The crate file and the package have bytes flipped, cut out and put in twice.
//!
//! `PENUMBRA_MUTATIONS=1000000` runs it for longer, `PENUMBRA_SEED` from another start.

use std::ops::Range;
use std::path::Path;
use std::time::{Duration, Instant};

use penumbra::import::ImportOptions;

use super::rng::Rng;
use super::{at_frame, corpus::corpus, stage, try_load};

/// What stands in a text where.
#[derive(Default)]
struct Parts {
    numbers: Vec<Range<usize>>,
    quoted: Vec<Range<usize>>,
    paths: Vec<Range<usize>>,
    /// Names of layers.
    assets: Vec<Range<usize>>,
    words: Vec<Range<usize>>,
    /// Insides of brackets.
    arrays: Vec<Range<usize>>,
    /// That author a value.
    lines: Vec<Range<usize>>,
}

impl Parts {
    fn of(text: &str) -> Self {
        let mut parts = Self::default();
        let bytes = text.as_bytes();
        let mut open = None;
        let mut start = 0;
        for line in text.split_inclusive('\n') {
            // Others open or close something.
            if line.contains(" = ") && !line.trim_end().ends_with(['(', '[', '{']) {
                parts.lines.push(start..start + line.len());
            }
            start += line.len();
        }
        let mut at = 0;
        let until = |at: usize, stop: &dyn Fn(u8) -> bool| {
            at + 1 + bytes[at + 1..].iter().position(|&b| stop(b)).unwrap_or(bytes.len() - at - 1)
        };
        while at < bytes.len() {
            let next = match bytes[at] {
                b'"' => until(at, &|b| b == b'"') + 1,
                b'<' => until(at, &|b| b == b'>') + 1,
                b'@' => until(at, &|b| b == b'@') + 1,
                b'-' | b'.' | b'0'..=b'9' => until(at, &|b| !b.is_ascii_alphanumeric() && b != b'.' && b != b'-'),
                b if b.is_ascii_alphabetic() => until(at, &|b| !b.is_ascii_alphanumeric() && b != b':' && b != b'_'),
                _ => at + 1,
            };
            match bytes[at] {
                b'"' => parts.quoted.push(at..next),
                b'<' => parts.paths.push(at..next),
                b'@' => parts.assets.push(at..next),
                b'-' | b'.' | b'0'..=b'9' => parts.numbers.push(at..next),
                b if b.is_ascii_alphabetic() => parts.words.push(at..next),
                b'[' => open = Some(at + 1),
                b']' => parts.arrays.extend(open.take().map(|open| open..at)),
                _ => {}
            }
            at = next;
        }
        parts
    }
}

/// The elements of the inside of brackets.
fn elements(inside: &str) -> Vec<&str> {
    let (mut depth, mut start, mut all) = (0, 0, Vec::new());
    for (at, c) in inside.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            ',' if depth == 0 => {
                all.push(&inside[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    all.push(&inside[start..]);
    all
}

const NUMBERS: [&str; 32] = [
    "0",
    "1",
    "2",
    "3",
    "4",
    "5",
    "-1",
    "-2",
    "0.5",
    "7",
    "8",
    "16",
    "100",
    "255",
    "65536",
    "1000000",
    "2147483647",
    "-2147483648",
    "4294967295",
    "1e38",
    "-1e38",
    "3.4e38",
    "1e300",
    "1e-40",
    "1e-300",
    "nan",
    "inf",
    "-inf",
    "9223372036854775807",
    "1e10",
    "-1e10",
    "1e20",
];

const TYPES: [&str; 16] = [
    "float",
    "double",
    "int",
    "float[]",
    "int[]",
    "point3f[]",
    "color3f[]",
    "texCoord2f[]",
    "token",
    "token[]",
    "string",
    "bool",
    "matrix4d",
    "quath[]",
    "asset",
    "half3[]",
];

fn mutate_text(text: &mut String, rng: &mut Rng) {
    let parts = Parts::of(text);
    let (at, new): (Range<usize>, String) = match rng.below(16) {
        0..=4 if !parts.numbers.is_empty() => (rng.one(&parts.numbers).clone(), (*rng.one(&NUMBERS)).into()),
        5..=8 if !parts.arrays.is_empty() => {
            let at = rng.one(&parts.arrays).clone();
            let mut all = elements(&text[at.clone()]);
            match rng.below(4) {
                0 => all.truncate(rng.below(all.len())),
                1 => drop(all.remove(rng.below(all.len()))),
                2 => all.extend(all.clone()),
                _ => {
                    let (a, b) = (rng.below(all.len()), rng.below(all.len()));
                    all[a] = all[b];
                }
            }
            (at, all.join(","))
        }
        kind @ (9 | 10) if !parts.quoted.is_empty() && !parts.paths.is_empty() => {
            let of = if kind == 9 { &parts.quoted } else { &parts.paths };
            (rng.one(of).clone(), text[rng.one(of).clone()].into())
        }
        11 if !parts.assets.is_empty() && rng.below(2) == 0 => {
            (rng.one(&parts.assets).clone(), text[rng.one(&parts.assets).clone()].into())
        }
        11 if !parts.words.is_empty() => (rng.one(&parts.words).clone(), text[rng.one(&parts.words).clone()].into()),
        12 if !parts.words.is_empty() => {
            let types =
                parts.words.iter().filter(|at| TYPES.iter().any(|t| t.trim_end_matches("[]") == &text[(*at).clone()]));
            let types: Vec<_> = types.cloned().collect();
            if types.is_empty() {
                return;
            }
            let mut at = rng.one(&types).clone();
            if text[at.end..].starts_with("[]") {
                at.end += 2;
            }
            (at, (*rng.one(&TYPES)).into())
        }
        _ if parts.lines.is_empty() => return,
        13 => (rng.one(&parts.lines).clone(), String::new()),
        14 => {
            let line = rng.one(&parts.lines).start;
            (line..line, text[rng.one(&parts.lines).clone()].into())
        }
        _ => (rng.one(&parts.lines).clone(), text[rng.one(&parts.lines).clone()].into()),
    };
    text.replace_range(at, &new);
}

fn mutate_bytes(bytes: &mut Vec<u8>, rng: &mut Rng) {
    let at = rng.below(bytes.len());
    let few = at..(at + 1 + rng.below(16)).min(bytes.len());
    match rng.below(12) {
        0 => bytes.truncate(at),
        1 => drop(bytes.drain(few)),
        2 => {
            let copy = bytes[few].to_vec();
            bytes.splice(at..at, copy);
        }
        3 | 4 => {
            let value = *rng.one(&[0, 1, 2, 0xFF, 0xFFFF, 1 << 31, u64::from(u32::MAX), 1 << 40, u64::MAX, 1 << 63]);
            let wide = [1, 4, 8][rng.below(3)].min(bytes.len() - at);
            bytes[at..at + wide].copy_from_slice(&value.to_le_bytes()[..wide]);
        }
        5 | 6 => {
            let value = *rng.one(&[f32::NAN, f32::INFINITY, f32::MAX, -1e30, 1e-40, -0.0]);
            let wide = 4.min(bytes.len() - at);
            bytes[at..at + wide].copy_from_slice(&value.to_le_bytes()[..wide]);
        }
        _ => bytes[at] ^= 1 << rng.below(8),
    }
}

fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(default)
}

/// What reading damaged stages came to.
struct Toll {
    seed: u64,
    cases: u64,
    accepted: u64,
    harm: Vec<String>,
    slowest: Duration,
}

impl Toll {
    fn new(seed: u64, cases: u64) -> Self {
        Self { seed, cases, accepted: 0, harm: Vec::new(), slowest: Duration::ZERO }
    }

    /// Reads the stage at `path`; a folder with all that it needs is kept where that does harm.
    fn read(&mut self, path: &Path, case: u64, options: &ImportOptions) {
        let start = Instant::now();
        let said = match std::panic::catch_unwind(|| try_load(path, options).map(drop)) {
            Ok(Ok(())) => {
                self.accepted += 1;
                None
            }
            // The door makes an error of a panic; here it stays one.
            Ok(Err(error)) if error.to_string().contains("broke down") => Some(error.to_string()),
            Ok(Err(_)) => None,
            Err(_) => Some("panics".into()),
        };
        let took = start.elapsed();
        let said = said.or_else(|| (took > Duration::from_secs(4)).then(|| format!("takes {took:?}")));
        if let Some(said) = said {
            self.harm.push(format!("{said}: {}", keep(path, case)));
        }
        self.slowest = self.slowest.max(took);
    }

    fn judge(self) {
        let Self { seed, cases, accepted, harm, slowest } = self;
        println!("{accepted} of {cases} were read, the slowest in {slowest:?}");
        assert!(harm.is_empty(), "of {cases} from seed {seed}:\n{}", harm.join("\n"));
        // Most of the damage has to get past the parser, or nothing is tested.
        assert!(accepted * 4 > cases, "{accepted} of {cases} were read");
    }
}

/// Keeps the folder of a stage that does harm where it can be looked at; its path.
fn keep(path: &Path, case: u64) -> String {
    let kept = std::env::temp_dir().join(format!("usd-mutation-{case}"));
    std::fs::create_dir_all(&kept).unwrap();
    for file in std::fs::read_dir(path.parent().unwrap()).unwrap() {
        let file = file.unwrap().path();
        std::fs::copy(&file, kept.join(file.file_name().unwrap())).unwrap();
    }
    kept.join(path.file_name().unwrap()).display().to_string()
}

#[test]
fn no_damage_panics() {
    let read = |name: &str| std::fs::read(corpus().join(name)).unwrap();
    let texts = [read("rich.usda"), std::fs::read(stage("skel.usda")).unwrap()];
    let texts = texts.map(|text| String::from_utf8(text).unwrap());
    let (binary, package) = (read("rich.usdc"), read("rich.usdz"));
    let dir = tempfile::tempdir().unwrap();
    for file in ["t.png", "lamp.ies"] {
        std::fs::copy(corpus().join(file), dir.path().join(file)).unwrap();
    }
    let mut toll = Toll::new(number("PENUMBRA_SEED", 1), number("PENUMBRA_MUTATIONS", 100));
    let mut rng = Rng(toll.seed | 1 << 40);
    for case in 0..toll.cases {
        let (ending, bytes) = match rng.below(8) {
            kind @ (0 | 1) => {
                let mut bytes = [&binary, &package][kind].clone();
                (0..1 + rng.below(4)).for_each(|_| mutate_bytes(&mut bytes, &mut rng));
                (["usdc", "usdz"][kind], bytes)
            }
            _ => {
                let mut text = texts[rng.below(2)].clone();
                (0..1 + rng.below(4)).for_each(|_| mutate_text(&mut text, &mut rng));
                ("usda", text.into_bytes())
            }
        };
        let path = dir.path().join("stage").with_extension(ending);
        std::fs::write(&path, &bytes).unwrap();
        let options = if rng.below(2) == 0 { ImportOptions::default() } else { at_frame([0.0, 7.5][rng.below(2)]) };
        toll.read(&path, case, &options);
    }
    toll.judge();
}

/// The same of one of the layers that make up a stage, so that arcs lead elsewhere.
#[test]
fn no_damage_to_its_layers_panics() {
    let stages = [&["composition.usda", "sub.usda", "triangle.usda"][..], &["implied.usda", "implied_asset.usda"]];
    let dir = tempfile::tempdir().unwrap();
    let mut toll = Toll::new(number("PENUMBRA_SEED", 1), number("PENUMBRA_MUTATIONS", 100));
    let mut rng = Rng(toll.seed | 1 << 41);
    for case in 0..toll.cases {
        let layers = rng.one(&stages);
        let damaged = rng.below(layers.len());
        for (i, name) in layers.iter().enumerate() {
            let mut text = std::fs::read_to_string(stage(name)).unwrap();
            if i == damaged {
                (0..1 + rng.below(3)).for_each(|_| mutate_text(&mut text, &mut rng));
            }
            std::fs::write(dir.path().join(name), text).unwrap();
        }
        toll.read(&dir.path().join(layers[0]), case, &at_frame(7.5));
    }
    toll.judge();
}
