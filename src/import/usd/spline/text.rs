//! Curves as text layers write them.

use super::{Beyond, Kind, Knot, Loops, Next, Spline, Tangent};

/// The curve between the braces of an attribute's `.spline`; `None` where that is no curve.
pub(in super::super) fn read(text: &str) -> Option<Spline> {
    let mut words = Words { rest: text };
    let mut kind = Kind::default();
    let mut beyond = [Beyond::default(); 2];
    let mut loops = None;
    let mut knots = Vec::new();
    while let Some(word) = words.next() {
        match word {
            "," | ";" => {}
            "bezier" => kind = Kind::Bezier,
            "hermite" => kind = Kind::Hermite,
            "pre" | "post" => beyond[usize::from(word == "post")] = words.after(":")?.beyond()?,
            "loop" => {
                let numbers = words.after(":")?.after("(")?.numbers()?;
                let [start, end, before, after, offset] = numbers.try_into().ok()?;
                let [times_before, times_after] = [before, after].map(|times: f64| times as i32);
                loops = Some(Loops { start, end, times_before, times_after, offset });
            }
            time => knots.push(words.after(":")?.knot(time.parse().ok()?, kind)?),
        }
    }
    Spline::new(kind, beyond, loops, knots)
}

/// Words, numbers and signs, one after another.
struct Words<'a> {
    rest: &'a str,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a str> {
        let rest = self.rest.trim_start();
        let first = rest.chars().next()?;
        let length =
            if is_of_word(first) { rest.find(|c| !is_of_word(c)).unwrap_or(rest.len()) } else { first.len_utf8() };
        let (word, rest) = rest.split_at(length);
        self.rest = rest;
        Some(word)
    }

    fn peek(&self) -> &'a str {
        Words { rest: self.rest }.next().unwrap_or_default()
    }

    /// The rest after `sign`.
    fn after(&mut self, sign: &str) -> Option<&mut Self> {
        (self.next()? == sign).then_some(self)
    }

    fn number(&mut self) -> Option<f64> {
        self.next()?.parse().ok()
    }

    /// Numbers up to the closing bracket; names among them say how they were found.
    fn numbers(&mut self) -> Option<Vec<f64>> {
        let mut numbers = Vec::new();
        loop {
            match self.next()? {
                ")" => return Some(numbers),
                "," => {}
                word => numbers.extend(word.parse::<f64>()),
            }
        }
    }

    fn beyond(&mut self) -> Option<Beyond> {
        Some(match self.next()? {
            "none" => Beyond::Blocked,
            "held" => Beyond::Held,
            "linear" => Beyond::Linear,
            "sloped" => Beyond::Sloped(*self.after("(")?.numbers()?.first()?),
            "loop" => match self.next()? {
                "repeat" => Beyond::Repeat,
                "reset" => Beyond::Reset,
                "oscillate" => Beyond::Oscillate,
                _ => return None,
            },
            _ => return None,
        })
    }

    /// What follows the time of a knot.
    fn knot(&mut self, time: f64, kind: Kind) -> Option<Knot> {
        let mut knot = Knot { time, value: self.number()?, ..Knot::default() };
        if self.peek() == "&" {
            self.next();
            knot.value_before = Some(std::mem::replace(&mut knot.value, self.number()?));
        }
        while self.peek() == ";" {
            self.next();
            match self.peek() {
                "pre" => {
                    self.next();
                    knot.before = self.tangent(kind)?;
                }
                "post" => {
                    self.next();
                    knot.next = match self.next()? {
                        "none" => Next::Blocked,
                        "held" => Next::Held,
                        "linear" => Next::Linear,
                        "curve" => Next::Curved,
                        _ => return None,
                    };
                    if self.peek() == "(" {
                        knot.after = self.tangent(kind)?;
                    }
                }
                _ => {}
            }
        }
        Some(knot)
    }

    fn tangent(&mut self, kind: Kind) -> Option<Tangent> {
        let numbers = self.after("(")?.numbers()?;
        Some(match (kind, numbers[..].first(), numbers.get(1)) {
            (Kind::Bezier, Some(&width), Some(&slope)) => Tangent { width, slope },
            (Kind::Hermite, Some(&slope), None) => Tangent { width: 0.0, slope },
            _ => return None,
        })
    }
}

fn is_of_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | '-' | '+')
}
