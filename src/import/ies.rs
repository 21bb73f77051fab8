//! Measured distributions of light: IES LM-63 of 1986 to 2019, type C.
//!
//! Lines of labels end with one that begins with `TILT=`; from there the file is numbers apart by
//! blanks or commas, whatever the lines: counts, multipliers, vertical angles, horizontal angles, and
//! for each horizontal angle the candela of all vertical ones.

use std::path::Path;
use std::sync::Arc;

use crate::desc::IesDesc;
use crate::error::{Error, Place, Result, Warnings};

/// Loads the profile at `path`.
///
/// # Errors
/// A file that can't be read, and what [`decode_ies`] says.
pub fn load_ies(path: &Path, warnings: &mut Warnings) -> Result<IesDesc> {
    let bytes = std::fs::read(path).map_err(|source| Error::io(path, "can't read", source))?;
    let name: Arc<str> = path.file_name().map_or_else(|| "profile".into(), |name| name.to_string_lossy().into());
    decode_ies(&bytes, &name, &Place::file(path), warnings)
}

/// Decodes a profile.
///
/// # Errors
/// [`Error::Unsupported`] for photometry of types A and B, [`Error::Invalid`] with the line for what is
/// no profile.
pub fn decode_ies(bytes: &[u8], name: &Arc<str>, place: &Place, warnings: &mut Warnings) -> Result<IesDesc> {
    let text = String::from_utf8_lossy(bytes);
    // Of the time when a line ended with a carriage return alone.
    let text = if text.contains('\n') { text.into_owned() } else { text.replace('\r', "\n") };
    let (edition, tilt_line, tilt) = header(&text, place)?;
    let mut numbers = Numbers::after(&text, tilt_line, place);
    match tilt.to_ascii_uppercase().as_str() {
        "NONE" => {}
        "INCLUDE" => numbers.skip_tilt()?,
        _ => warnings.push(place, format!("the tilt of file \"{tilt}\" is ignored")),
    }
    let scale = Intro::read(&mut numbers)?;
    let factor = scale.factor(edition, place, warnings);
    let vertical = numbers.angles("vertical", scale.vertical, [0.0, 180.0])?;
    let horizontal = numbers.angles("horizontal", scale.horizontal, [0.0, 360.0])?;
    let mut candela = numbers.many("candela", scale.vertical * scale.horizontal)?;
    let negative = candela.iter().filter(|c| **c < 0.0).count();
    if negative > 0 {
        warnings.push(place, format!("{negative} of the candela are negative: taken as 0"));
    }
    candela.iter_mut().for_each(|c| *c = c.max(0.0) * factor);
    if !candela.iter().all(|c| c.is_finite()) {
        return Err(numbers.invalid("candela times the multiplier are too large"));
    }
    let (horizontal, candela) = whole(horizontal, candela, &numbers, warnings)?;
    Ok(IesDesc { name: name.clone(), place: place.clone(), vertical, horizontal, candela })
}

/// What matters of the edition of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Edition {
    /// 1986 and 1991: the second factor after the ballast's is one of the lamp with its ballast.
    Old,
    /// 1995 and 2002 keep that place for later, 2019 has a code there.
    New,
}

/// The edition, the index of the line with the tilt, and the tilt.
fn header<'a>(text: &'a str, place: &Place) -> Result<(Edition, usize, &'a str)> {
    let first = text.trim_start_matches('\u{feff}').lines().next().unwrap_or_default().trim();
    let new = ["LM-63-1995", "LM-63-2002", "LM-63-2019"].iter().any(|edition| first.contains(edition));
    let tilt = text.lines().enumerate().find_map(|(i, line)| {
        let (key, value) = line.split_once('=')?;
        key.trim().trim_start_matches('\u{feff}').eq_ignore_ascii_case("TILT").then_some((i, value.trim()))
    });
    let (line, tilt) = tilt.ok_or_else(|| Error::invalid(place, "no IES profile: it has no line TILT="))?;
    Ok((if new { Edition::New } else { Edition::Old }, line, tilt))
}

/// The numbers after the tilt, each with its line.
struct Numbers<'a> {
    place: &'a Place,
    tokens: Vec<(usize, &'a str)>,
    next: usize,
    last_line: usize,
}

impl<'a> Numbers<'a> {
    fn after(text: &'a str, tilt_line: usize, place: &'a Place) -> Self {
        let lines = text.lines().enumerate().skip(tilt_line + 1);
        let words = |line: &'a str| line.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
        let tokens = lines.flat_map(|(i, line)| words(line).map(move |word| (i + 1, word))).collect();
        Self { place, tokens, next: 0, last_line: text.lines().count() }
    }

    /// Broken at the line of the number that was read last.
    fn invalid(&self, what: impl Into<String>) -> Error {
        let line = self.tokens.get(self.next.saturating_sub(1)).map_or(self.last_line, |(line, _)| *line);
        Error::invalid(&self.at(line), what)
    }

    fn at(&self, line: usize) -> Place {
        match &self.place.node {
            Some(node) => self.place.at(format!("{node}, line {line}")),
            None => self.place.at(format!("line {line}")),
        }
    }

    fn number(&mut self, what: &str) -> Result<f64> {
        let Some(&(_, word)) = self.tokens.get(self.next) else {
            let place = self.at(self.last_line);
            return Err(Error::invalid(&place, format!("the file ends where {what} should stand")));
        };
        self.next += 1;
        // Fortran's exponents begin with a D.
        let parsed = word.parse().or_else(|_| word.replace(['d', 'D'], "e").parse());
        let parsed = parsed.ok().filter(|v: &f64| v.is_finite());
        parsed.ok_or_else(|| self.invalid(format!("\"{}\" is no number, {what} should stand here", short(word))))
    }

    fn count(&mut self, what: &str, least: usize) -> Result<usize> {
        let value = self.number(what)?;
        // More than all the numbers of the file can't be.
        let most = self.tokens.len();
        if value.fract() != 0.0 || value < least as f64 || value > most as f64 {
            return Err(self.invalid(format!("{what} is {value}, of {most} numbers in all")));
        }
        Ok(value as usize)
    }

    fn many(&mut self, what: &str, count: usize) -> Result<Vec<f64>> {
        let left = self.tokens.len() - self.next;
        if count > left {
            let place = self.at(self.last_line);
            return Err(Error::invalid(&place, format!("{count} numbers of {what} should come, {left} do")));
        }
        (0..count).map(|_| self.number(what)).collect()
    }

    fn angles(&mut self, what: &str, count: usize, [low, high]: [f64; 2]) -> Result<Vec<f64>> {
        let mut angles: Vec<f64> = Vec::new();
        for _ in 0..count {
            let angle = self.number(&format!("a {what} angle"))?;
            if !(low..=high).contains(&angle) {
                return Err(self.invalid(format!("{what} angle {angle} is not within {low} to {high} degrees")));
            }
            if angles.last().is_some_and(|last| angle <= *last) {
                return Err(self.invalid(format!("{what} angle {angle} is not above the one before")));
            }
            angles.push(angle);
        }
        Ok(angles)
    }

    /// How the lamp's output depends on its tilt does not matter to the distribution.
    fn skip_tilt(&mut self) -> Result<()> {
        self.number("the lamp's geometry")?;
        let pairs = self.count("the count of tilt angles", 0)?;
        self.many("tilt", 2 * pairs).map(|_| ())
    }
}

/// A word of an error message.
fn short(word: &str) -> String {
    word.chars().take(20).map(|c| if c.is_control() { '?' } else { c }).collect()
}

/// The thirteen numbers before the angles.
struct Intro {
    vertical: usize,
    horizontal: usize,
    multiplier: f64,
    ballast: f64,
    ballast_lamp: f64,
}

impl Intro {
    fn read(numbers: &mut Numbers<'_>) -> Result<Self> {
        numbers.number("the count of lamps")?;
        numbers.number("the lumens of a lamp")?;
        let multiplier = numbers.number("the multiplier of candela")?;
        let vertical = numbers.count("the count of vertical angles", 2)?;
        let horizontal = numbers.count("the count of horizontal angles", 1)?;
        let photometry = numbers.number("the type of photometry")?;
        let named = [(2.0, "B"), (3.0, "A")].into_iter().find(|(code, _)| *code == photometry);
        if let Some((_, kind)) = named {
            let what = format!("photometry of type {kind}; only type C (1) is read: convert the profile to it");
            return Err(Error::unsupported(numbers.place, what));
        }
        if photometry != 1.0 {
            return Err(numbers.invalid(format!("type of photometry {photometry}: 1 (C), 2 (B) and 3 (A) exist")));
        }
        for what in ["the type of units", "the width", "the length", "the height"] {
            numbers.number(what)?;
        }
        let ballast = numbers.number("the ballast factor")?;
        let ballast_lamp = numbers.number("the factor of ballast and lamp")?;
        numbers.number("the input watts")?;
        Ok(Self { vertical, horizontal, multiplier, ballast, ballast_lamp })
    }

    /// What candela are multiplied by.
    fn factor(&self, edition: Edition, place: &Place, warnings: &mut Warnings) -> f64 {
        let mut factors = vec![("multiplier", self.multiplier), ("ballast factor", self.ballast)];
        if edition == Edition::Old {
            factors.push(("factor of ballast and lamp", self.ballast_lamp));
        }
        let mut product = 1.0;
        for (what, factor) in factors {
            if factor > 0.0 {
                product *= factor;
            } else {
                warnings.push(place, format!("the {what} is {factor}: taken as 1"));
            }
        }
        product
    }
}

/// Horizontal angles from 0 to 0, 90, 180 or 360, and their candela.
fn whole(
    mut horizontal: Vec<f64>,
    mut candela: Vec<f64>,
    numbers: &Numbers<'_>,
    warnings: &mut Warnings,
) -> Result<(Vec<f64>, Vec<f64>)> {
    let rows = horizontal.len();
    let columns = candela.len() / rows;
    if rows == 1 {
        return Ok((vec![0.0], candela));
    }
    let (first, last) = (horizontal[0], horizontal[rows - 1]);
    match (first, last) {
        (0.0, 90.0 | 180.0 | 360.0) => Ok((horizontal, candela)),
        (90.0, 270.0) => Ok(mirrored(&horizontal, &candela, columns)),
        (0.0, last) if last > 180.0 => {
            // Around but for the last step, which leads back to the first plane.
            warnings.push(numbers.place, format!("horizontal angles end at {last}: closed to 360 degrees"));
            horizontal.push(360.0);
            candela.extend_from_within(..columns);
            Ok((horizontal, candela))
        }
        _ => Err(numbers.invalid(format!(
            "horizontal angles from {first} to {last}; they go from 0 to 0, 90, 180 or 360, or from 90 to 270"
        ))),
    }
}

/// The whole circle of a distribution from 90 to 270 degrees, symmetric to that plane.
fn mirrored(horizontal: &[f64], candela: &[f64], columns: usize) -> (Vec<f64>, Vec<f64>) {
    let around = |angle: f64| angle.rem_euclid(360.0);
    let rows = || horizontal.iter().zip(candela.chunks_exact(columns));
    let given = rows().map(|(&angle, row)| (around(angle), row.to_vec()));
    let others = rows().map(|(&angle, row)| (around(180.0 - angle), row.to_vec()));
    let mut planes: Vec<(f64, Vec<f64>)> = given.chain(others).collect();
    planes.sort_by(|a, b| a.0.total_cmp(&b.0));
    planes.dedup_by_key(|plane| plane.0);
    let (after, before) = (&planes[0], &planes[planes.len() - 1]);
    if after.0 > 0.0 {
        // The circle is cut between two planes.
        let t = (360.0 - before.0) / (360.0 - before.0 + after.0);
        let cut = before.1.iter().zip(&after.1).map(|(b, a)| b + (a - b) * t).collect();
        planes.insert(0, (0.0, cut));
    }
    planes.push((360.0, planes[0].1.clone()));
    let (angles, rows): (Vec<f64>, Vec<Vec<f64>>) = planes.into_iter().unzip();
    (angles, rows.concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decode(text: &str) -> Result<IesDesc> {
        decode_ies(text.as_bytes(), &"test".into(), &Place::file("a.ies"), &mut Warnings::new())
    }

    fn file(header: &str, tilt: &str, numbers: &str) -> String {
        format!("{header}\r\n[TEST] a lamp\r\nTILT={tilt}\r\n{numbers}\r\n")
    }

    const ROUND: &str = "1 -1 2 3 1 1 2 0 0 0\n0.5 4 100\n0 45 90\n0\n10 5 0";

    #[test]
    fn every_edition_is_read() {
        for (header, factor) in [
            ("An old lamp", 4.0),
            ("IESNA91", 4.0),
            ("IESNA:LM-63-1995", 1.0),
            ("IESNA:LM-63-2002", 1.0),
            ("IES:LM-63-2019", 1.0),
        ] {
            let ies = decode(&file(header, "NONE", ROUND)).unwrap();
            assert_eq!(ies.candela, [10.0 * factor, 5.0 * factor, 0.0], "{header}");
            assert_eq!((ies.vertical, ies.horizontal), (vec![0.0, 45.0, 90.0], vec![0.0]), "{header}");
        }
    }

    #[test]
    fn layouts_of_the_wild_are_read() {
        let plain = decode(&file("IESNA:LM-63-2002", "NONE", ROUND)).unwrap();
        let one_line = file("IESNA:LM-63-2002", "NONE", &ROUND.replace('\n', " "));
        let commas = file("IESNA:LM-63-2002", "NONE", &ROUND.replace(' ', ", "));
        let old_mac = file("IESNA:LM-63-2002", "NONE", ROUND).replace("\r\n", "\n").replace('\n', "\r");
        let marked = format!("\u{feff}{}", file("IESNA:LM-63-2002", " none ", ROUND));
        let fortran = file("IESNA:LM-63-2002", "NONE", &ROUND.replace("10 5", "1.0D+01 5."));
        let tilted = file("IESNA:LM-63-2002", "INCLUDE", &format!("1\n3\n0 45 90\n1 .9 .8\n{ROUND}"));
        for text in [one_line, commas, old_mac, marked, fortran, tilted] {
            assert_eq!(decode(&text).unwrap(), plain, "{text}");
        }
        let latin = [b"IESNA:LM-63-2002\n\xe9clairage\nTILT=NONE\n", ROUND.as_bytes()].concat();
        assert_eq!(decode_ies(&latin, &"test".into(), &Place::file("a.ies"), &mut Warnings::new()).unwrap(), plain);
    }

    #[test]
    fn a_tilt_file_and_odd_numbers_are_told() {
        let warned = |text: &str| {
            let mut warnings = Warnings::new();
            let ies = decode_ies(text.as_bytes(), &"test".into(), &Place::file("a.ies"), &mut warnings).unwrap();
            (ies, warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))
        };
        let (_, said) = warned(&file("IESNA:LM-63-2002", "lamp.tlt", ROUND));
        assert_eq!(said, "a.ies: the tilt of file \"lamp.tlt\" is ignored");
        let (ies, said) =
            warned(&file("IESNA:LM-63-2002", "NONE", &ROUND.replace("0.5 4", "0 4").replace("5 0", "-5 0")));
        assert_eq!(ies.candela, [20.0, 0.0, 0.0]);
        assert!(said.contains("ballast factor is 0: taken as 1") && said.contains("1 of the candela are negative"));
    }

    fn planes(angles: &str) -> Result<IesDesc> {
        let count = angles.split(' ').count();
        let rows: Vec<String> = (0..count).map(|i| format!("{} {}", i + 1, 10 * (i + 1))).collect();
        let numbers = format!("1 -1 1 2 {count} 1 2 0 0 0 1 1 1\n0 90\n{angles}\n{}", rows.join("\n"));
        decode(&file("IESNA:LM-63-2002", "NONE", &numbers))
    }

    #[test]
    fn symmetries_become_those_of_the_description() {
        assert_eq!(planes("0 45 90").unwrap().candela, [1.0, 10.0, 2.0, 20.0, 3.0, 30.0]);
        assert_eq!(planes("0 360").unwrap().horizontal, [0.0, 360.0]);
        assert_eq!(planes("30").unwrap().horizontal, [0.0]);
        let closed = planes("0 120 240").unwrap();
        assert_eq!((closed.horizontal, closed.candela[6]), (vec![0.0, 120.0, 240.0, 360.0], 1.0));
        // Symmetric to the plane of 90 and 270 degrees.
        let folded = planes("90 135 180 270").unwrap();
        assert_eq!(folded.horizontal, [0.0, 45.0, 90.0, 135.0, 180.0, 270.0, 360.0]);
        let down: Vec<f64> = folded.candela.iter().copied().step_by(2).collect();
        assert_eq!(down, [3.0, 2.0, 1.0, 2.0, 3.0, 4.0, 3.0]);
        let without_middle = planes("90 150 270").unwrap();
        assert_eq!(without_middle.horizontal, [0.0, 30.0, 90.0, 150.0, 270.0, 360.0]);
        // At 0 as at 180, a quarter of the way from 150 to 270.
        assert_eq!(without_middle.candela[0], 2.25);
    }

    #[test]
    fn errors_name_the_line() {
        let said = |text: &str| decode(text).unwrap_err().to_string();
        let with = |from: &str, to: &str| said(&file("IESNA:LM-63-2002", "NONE", &ROUND.replace(from, to)));
        assert_eq!(said("hello"), "a.ies: no IES profile: it has no line TILT=");
        assert_eq!(with("45", "x45"), "a.ies, line 6: \"x45\" is no number, a vertical angle should stand here");
        assert_eq!(with("0 45 90", "0 90 45"), "a.ies, line 6: vertical angle 45 is not above the one before");
        assert_eq!(with("10 5 0", "10 5"), "a.ies, line 8: 3 numbers of candela should come, 2 do");
        assert_eq!(with("10 5 0", "10 nan 0"), "a.ies, line 8: \"nan\" is no number, candela should stand here");
        assert!(with("0 45 90", "0 45 190").starts_with("a.ies, line 6: vertical angle 190"));
        assert!(with("3 1 1 2", "3e9 1 1 2").starts_with("a.ies, line 4: the count of vertical angles is 3000000000"));
        for (code, kind) in [("2", "B"), ("3", "A")] {
            let error = decode(&file("IESNA:LM-63-2002", "NONE", &ROUND.replace("3 1 1 2", &format!("3 1 {code} 2"))));
            assert!(matches!(&error, Err(Error::Unsupported { what, .. }) if what.contains(&format!("type {kind};"))));
        }
        assert!(planes("0 45").unwrap_err().to_string().contains("horizontal angles from 0 to 45"));
    }

    /// Every truncation, and thousands of files with bytes changed, end in a profile or an error.
    #[test]
    fn broken_files_never_panic() {
        let tilted = file("IESNA:LM-63-2002", "INCLUDE", &format!("1\n3\n0 45 90\n1 .9 .8\n{ROUND}"));
        let bytes = tilted.as_bytes();
        let read = |bytes: &[u8]| {
            if let Ok(ies) = decode_ies(bytes, &"test".into(), &Place::default(), &mut Warnings::new()) {
                assert_eq!(ies.candela.len(), ies.vertical.len() * ies.horizontal.len());
                assert!(ies.candela.iter().all(|c| c.is_finite() && *c >= 0.0));
                let last = ies.horizontal[ies.horizontal.len() - 1];
                assert!(ies.horizontal[0] == 0.0 && [0.0, 90.0, 180.0, 360.0].contains(&last));
            }
        };
        (0..=bytes.len()).for_each(|end| read(&bytes[..end]));
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize
        };
        for _ in 0..20_000 {
            let mut changed = bytes.to_vec();
            for _ in 0..1 + random() % 4 {
                let i = random() % changed.len();
                changed[i] = if random() % 2 == 0 { b"0123456789 .-e,\n\r="[random() % 18] } else { random() as u8 };
            }
            read(&changed);
            let noise: Vec<u8> = (0..random() % 64).map(|_| random() as u8).collect();
            read(&[b"TILT=NONE\n", noise.as_slice()].concat());
        }
    }
}
