//! Text layers word by word, as far as mending needs it.

use std::ops::Range;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A keyword or name, with its namespaces.
    Word,
    Number,
    /// A string, an asset or a path, with what encloses it.
    Quoted,
    /// Any other character.
    Sign(u8),
    /// What the crate does not know as a comment: `//` up to the end of the line, `/* */`.
    Comment,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Token {
    pub kind: Kind,
    pub at: Range<usize>,
}

/// The words of `text`; what is not closed ends with it.
pub(super) struct Lexer<'a> {
    pub text: &'a [u8],
    pub at: usize,
}

impl Lexer<'_> {
    fn byte(&self, i: usize) -> u8 {
        self.text.get(i).copied().unwrap_or(0)
    }

    /// Where `is` ends from `from` on.
    fn run(&self, from: usize, is: impl Fn(u8) -> bool) -> usize {
        self.text[from..].iter().position(|&b| !is(b)).map_or(self.text.len(), |n| from + n)
    }

    /// Where `end` ends from `from` on, bytes after a backslash aside where there are `escapes`.
    fn past(&self, from: usize, end: &[u8], escapes: bool) -> usize {
        let mut i = from;
        while i < self.text.len() {
            if escapes && self.text[i] == b'\\' {
                i += 2;
            } else if self.text[i..].starts_with(end) {
                return i + end.len();
            } else {
                i += 1;
            }
        }
        self.text.len()
    }

    fn line(&self, from: usize) -> usize {
        self.run(from, |b| b != b'\n' && b != b'\r')
    }

    fn quoted(&self, start: usize, quote: u8) -> usize {
        let three = [quote; 3];
        let escapes = quote != b'@';
        if self.text[start..].starts_with(&three) {
            self.past(start + 3, &three, escapes)
        } else {
            self.past(start + 1, &[quote], escapes)
        }
    }

    fn number(&self, start: usize) -> usize {
        let digits = |from| self.run(from, |b| b.is_ascii_digit());
        let mut end = digits(start);
        if self.byte(end) == b'.' {
            end = digits(end + 1);
        }
        if matches!(self.byte(end), b'e' | b'E') {
            let signed = end + 1 + usize::from(matches!(self.byte(end + 1), b'+' | b'-'));
            if self.byte(signed).is_ascii_digit() {
                end = digits(signed);
            }
        }
        end
    }
}

impl Iterator for Lexer<'_> {
    type Item = Token;

    fn next(&mut self) -> Option<Token> {
        loop {
            let start = self.run(self.at, |b| b.is_ascii_whitespace());
            let first = *self.text.get(start)?;
            let (kind, end) = match (first, self.byte(start + 1)) {
                (b'#', _) => {
                    self.at = self.line(start);
                    continue;
                }
                (b'/', b'/') => (Kind::Comment, self.line(start)),
                (b'/', b'*') => (Kind::Comment, self.past(start + 2, b"*/", false)),
                (b'"' | b'\'' | b'@', _) => (Kind::Quoted, self.quoted(start, first)),
                (b'<', _) => (Kind::Quoted, self.past(start + 1, b">", false)),
                (b'0'..=b'9', _) | (b'.', b'0'..=b'9') => (Kind::Number, self.number(start)),
                (b'A'..=b'Z' | b'a'..=b'z' | b'_' | 0x80.., _) => (Kind::Word, self.run(start, is_of_name)),
                (sign, _) => (Kind::Sign(sign), start + 1),
            };
            let end = end.min(self.text.len());
            self.at = end;
            return Some(Token { kind, at: start..end });
        }
    }
}

fn is_of_name(b: u8) -> bool {
    b.is_ascii_alphanumeric() || matches!(b, b'_' | b':' | 0x80..)
}
