//! Text layers, mended word by word. Lines stay where they are, so that what the crate says of them is true
//! of the file.

use std::collections::HashSet;
use std::ops::Range;

use super::Mended;
use super::kept::{INACTIVE, KEPT};
use super::lex::{Kind, Lexer, Token};
use super::names;

/// `text` in the crate's words; `None` where it is in them already.
pub(super) fn mend(text: &[u8]) -> Option<Mended> {
    let (changes, told) = Default::default();
    let scopes = vec![Scope::default()];
    let mut mender = Mender { text, changes, splines: false, renamed: false, told, scopes };
    mender.header();
    mender.read();
    let Mender { mut changes, splines, renamed, told, .. } = mender;
    if changes.is_empty() && told.is_empty() {
        return None;
    }
    changes.sort_by_key(|(at, _)| at.start);
    let mut bytes = Vec::with_capacity(text.len() + 64);
    let mut done = 0;
    for (at, new) in changes {
        bytes.extend_from_slice(&text[done..at.start]);
        bytes.extend_from_slice(&new);
        done = at.end;
    }
    bytes.extend_from_slice(&text[done..]);
    Some(Mended { bytes, splines, renamed, told })
}

struct Mender<'a> {
    text: &'a [u8],
    /// What is put in the place of what; no two overlap.
    changes: Vec<(Range<usize>, Vec<u8>)>,
    splines: bool,
    renamed: bool,
    told: Vec<(String, String)>,
    /// What is open, the root first.
    scopes: Vec<Scope<'a>>,
}

/// Between braces.
#[derive(Default)]
struct Scope<'a> {
    /// Of the prim whose they are; `None` for others.
    name: Option<String>,
    /// Names of the prims in it.
    prims: HashSet<&'a [u8]>,
}

impl<'a> Mender<'a> {
    fn word(&self, token: &Token) -> &'a [u8] {
        &self.text[token.at.clone()]
    }

    /// Versions after 1.0 only say that what is mended here may be met.
    fn header(&mut self) {
        let start = self.text.len() - self.text.trim_ascii_start().len();
        let line = &self.text[start..];
        let line = &line[..line.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(line.len())];
        let Some(version) = line.strip_prefix(openusd::usda::MAGIC) else { return };
        let version = version.trim_ascii();
        if version.starts_with(b"1.") && version != b"1.0" {
            self.changes.push((start..start + line.len(), b"#usda 1.0".to_vec()));
        }
    }

    fn read(&mut self) {
        let mut tokens = Lexer { text: self.text, at: 0 };
        // Brackets that are open, the last words, and the name of a prim whose braces come.
        let mut round = 0_usize;
        let mut before = [const { None::<Token> }; 2];
        let mut name = None;
        let mut property = None;
        while let Some(token) = tokens.next() {
            if token.kind == Kind::Quoted {
                self.quoted(&token);
            }
            if token.kind == Kind::Word {
                self.rename(&token);
            }
            let sign_before = match &before[1] {
                Some(Token { kind: Kind::Sign(sign), .. }) => *sign,
                _ => 0,
            };
            match token.kind {
                Kind::Comment => {
                    self.changes.push((token.at.clone(), blank(self.word(&token))));
                    continue;
                }
                Kind::Number => self.number(&token),
                Kind::Sign(b'(') => round += 1,
                Kind::Sign(b')') => round = round.saturating_sub(1),
                Kind::Sign(b'{') => {
                    let name = if round == 0 { name.take() } else { None };
                    self.scopes.push(Scope { name, ..Scope::default() });
                }
                // The root has none.
                Kind::Sign(b'}') if self.scopes.len() > 1 => _ = self.scopes.pop(),
                Kind::Quoted if round == 0 && before.iter().flatten().any(|word| self.is_prim(word)) => {
                    let word = self.word(&token);
                    let prim = String::from_utf8_lossy(word).trim_matches(['"', '\'']).to_string();
                    if !self.scopes.last_mut().is_none_or(|scope| scope.prims.insert(word)) {
                        let what =
                            "stands twice in its layer, which OpenUSD refuses; what the later one says goes first";
                        self.told.push((format!("{}/{prim}", self.path()), what.into()));
                    }
                    name = Some(prim);
                }
                Kind::Word => match (self.word(&token), sign_before) {
                    (b"spline", b'.') => self.spline(&mut tokens),
                    (b"AnimationBlock", b'=') => {
                        let sign = before[1].as_ref().map_or(token.at.start, |sign| sign.at.start);
                        self.animation_block(sign..token.at.end, &mut tokens);
                    }
                    (b"edit", b'=' | b':') if self.is_sign_next(&tokens, b'[') => {
                        let sign = before[1].as_ref().map_or(token.at.start, |sign| sign.at.start);
                        self.edit(sign, sign_before, property.as_deref(), &mut tokens);
                    }
                    (b"inactiveIds", 0) if before[1].as_ref().is_some_and(|word| self.is_list_op(word)) => {
                        self.changes.push((token.at.clone(), INACTIVE.as_bytes().to_vec()));
                    }
                    (word, _) if round == 0 && word != b"timeSamples" => {
                        property = Some(String::from_utf8_lossy(word).into_owned())
                    }
                    _ => {}
                },
                _ => {}
            }
            before = [before[1].take(), Some(token)];
        }
    }

    fn is_prim(&self, token: &Token) -> bool {
        token.kind == Kind::Word && matches!(self.word(token), b"def" | b"over" | b"class")
    }

    fn is_list_op(&self, token: &Token) -> bool {
        matches!(self.word(token), b"prepend" | b"append" | b"delete" | b"add" | b"reorder")
    }

    fn is_sign_next(&self, tokens: &Lexer<'_>, sign: u8) -> bool {
        Lexer { text: self.text, at: tokens.at }.next().is_some_and(|token| token.kind == Kind::Sign(sign))
    }

    /// In strings of three quotes the crate ends at a quote that is escaped, unless by its number.
    fn quoted(&mut self, token: &Token) {
        let quote = self.text[token.at.start];
        if quote == b'@' || !self.word(token).starts_with(&[quote; 3]) {
            return;
        }
        let mut i = token.at.start + 3;
        while i + 3 < token.at.end {
            if self.text[i] == b'\\' {
                if self.text[i + 1] == quote {
                    self.changes.push((i..i + 2, format!("\\x{quote:02x}").into_bytes()));
                }
                i += 1;
            }
            i += 1;
        }
    }

    /// Words in quotes aside, the crate reads ASCII letters alone.
    fn rename(&mut self, token: &Token) {
        let Ok(name) = std::str::from_utf8(self.word(token)) else { return };
        if !name.is_ascii() {
            let plain = names::plain(name).into_bytes();
            self.changes.push((token.at.clone(), plain));
            self.renamed = true;
        }
    }

    /// The crate wants digits on both sides of the point.
    fn number(&mut self, token: &Token) {
        let at = token.at.start;
        let Some(point) = self.word(token).iter().position(|&b| b == b'.').map(|i| at + i) else { return };
        if point == at && at.checked_sub(1).is_none_or(|i| !matches!(self.text[i], b'-' | b'+')) {
            self.changes.push((at..at, b"0".to_vec()));
        }
        if !self.text[point + 1..token.at.end].first().is_some_and(u8::is_ascii_digit) {
            self.changes.push((point + 1..point + 1, b"0".to_vec()));
        }
    }

    /// Curves are kept as text in a field of theirs that the crate carries as it is.
    fn spline(&mut self, tokens: &mut Lexer<'_>) {
        let mut depth = 0_usize;
        let mut body = Vec::new();
        let mut start = None;
        let mut last = 0;
        for token in tokens.by_ref() {
            let at = token.at.clone();
            match token.kind {
                Kind::Sign(b'{') => {
                    depth += 1;
                    if depth == 1 {
                        start = Some(at.end);
                        continue;
                    }
                }
                Kind::Sign(b'}') => depth = depth.saturating_sub(1),
                _ => {}
            }
            let Some(start) = start else { continue };
            if depth == 0 {
                let mut kept = format!("0: 0; {{ string {KEPT} = \"\"\"").into_bytes();
                kept.extend_from_slice(&body);
                kept.extend_from_slice(b"\"\"\" }");
                kept.extend(lines(&self.text[start..at.start]));
                self.changes.push((start..at.start, kept));
                self.splines = true;
                return;
            }
            // What users note of knots has no say, and is in braces.
            let is_noted = depth > 1 || token.kind == Kind::Sign(b'}');
            if !is_noted && !matches!(token.kind, Kind::Quoted | Kind::Comment) {
                if at.start > last {
                    body.push(b' ');
                }
                last = at.end;
                body.extend_from_slice(&self.text[at]);
            }
        }
    }

    /// `= AnimationBlock` hides the samples of weaker layers: the crate knows that as samples that are blocked.
    fn animation_block(&mut self, at: Range<usize>, tokens: &mut Lexer<'_>) {
        if self.is_sign_next(tokens, b'(') {
            let bracket = tokens.next().map_or(at.end, |token| token.at.end);
            let mut new = b"( timeSamples = None;".to_vec();
            new.extend(lines(&self.text[at.start..bracket]));
            self.changes.push((at.start..bracket, new));
        } else {
            self.changes.push((at, b"( timeSamples = None )".to_vec()));
        }
    }

    /// Edits of arrays are left out: the weaker value stands.
    fn edit(&mut self, start: usize, sign: u8, property: Option<&str>, tokens: &mut Lexer<'_>) {
        let mut depth = 0_usize;
        let mut end = tokens.at;
        for token in tokens.by_ref() {
            end = token.at.end;
            match token.kind {
                Kind::Sign(b'[') => depth += 1,
                Kind::Sign(b']') => depth = depth.saturating_sub(1),
                _ => {}
            }
            if depth == 0 {
                break;
            }
        }
        let mut new = lines(&self.text[start..end]);
        if sign == b':' {
            new.splice(0..0, *b": None");
        }
        self.changes.push((start..end, new));
        let path = match property {
            Some(property) => format!("{}.{property}", self.path()),
            None => self.path(),
        };
        self.told.push((path, super::EDIT_IS_NOT_MADE.into()));
    }

    fn path(&self) -> String {
        self.scopes.iter().filter_map(|scope| scope.name.as_deref()).flat_map(|name| ["/", name]).collect()
    }
}

/// Blanks of the same length, on the same lines.
fn blank(comment: &[u8]) -> Vec<u8> {
    comment.iter().map(|&b| if matches!(b, b'\n' | b'\r') { b } else { b' ' }).collect()
}

/// The ends of lines in `text`.
fn lines(text: &[u8]) -> Vec<u8> {
    text.iter().copied().filter(|b| matches!(b, b'\n' | b'\r')).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mended(text: &str) -> String {
        mend(text.as_bytes()).map_or_else(|| text.into(), |mended| String::from_utf8(mended.bytes).unwrap())
    }

    #[test]
    fn what_the_crate_reads_is_left_alone() {
        for text in [
            "#usda 1.0\ndef Xform \"A\" (doc = \"// /* */ .5\") { # .5 // here\n double x = -0.5\n}\n",
            "#usda 1.0\ndef \"A\" { asset a = @http://a/.5@\n rel r = </A.b>\n double b.timeSamples = { 1: 2.5e-3 }\n}\n",
            "#usda 1.0\ndef \"A\" { string s = '''it's // not\n/* a */ comment'''\n string t = \"\" # a\n}\n",
        ] {
            assert!(mend(text.as_bytes()).is_none(), "{text}");
        }
    }

    #[test]
    fn numbers_get_their_digits() {
        assert_eq!(mended("double x = .5"), "double x = 0.5");
        assert_eq!(mended("(1., -.5, 2.e3, .25e-1)"), "(1.0, -.5, 2.0e3, 0.25e-1)");
    }

    /// In strings, paths and the names of prims the crate reads them.
    #[test]
    fn names_of_properties_get_ascii_letters() {
        let text = "#usda 1.0\ndef Mesh \"Öl\" {\n float[] primvars:größe = [1] ( doc = \"ä\" )\n rel r = </Öl.primvars:größe>\n}\n";
        let mended = mend(text.as_bytes()).unwrap();
        let plain = text.replacen("primvars:größe =", &format!("{} =", names::plain("primvars:größe")), 1);
        assert!(mended.renamed && mended.bytes == plain.as_bytes(), "{}", String::from_utf8_lossy(&mended.bytes));
    }

    #[test]
    fn quotes_in_three_quotes_are_escaped_by_number() {
        assert_eq!(mended("s = \"\"\"a\\\"\"\"b\"\"\""), "s = \"\"\"a\\x22\"\"b\"\"\"");
        assert_eq!(mended("s = '''a\\'b''' // c"), "s = '''a\\x27b'''     ");
        assert_eq!(mended("s = \"a\\\"b\""), "s = \"a\\\"b\"");
    }

    #[test]
    fn lines_stay_where_they_are() {
        let text = "#usda 1.1\n/* a\n b { \" */ def \"A\" { // c\n double x.spline = {\n bezier,\n 1: 2; { string a = \"}\" },\n }\n double y = AnimationBlock (\n doc = \"d\"\n )\n int[] z = edit [\n append 1\n ]\n}\n";
        let new = mended(text);
        assert_eq!(new.matches('\n').count(), text.matches('\n').count());
        let line = |text: &str, what: &str| text.lines().position(|line| line.contains(what));
        for what in ["def \"A\"", "double x", "double y", "doc = ", "int[] z"] {
            assert_eq!(line(&new, what), line(text, what), "{what} in {new}");
        }
        assert!(new.starts_with("#usda 1.0\n") && new.contains("( timeSamples = None;"), "{new}");
        assert!(new.contains("\"\"\" bezier, 1: 2; ,\"\"\""), "{new}");
    }

    #[test]
    fn what_is_not_done_is_told_with_its_path() {
        let text = "def \"A\" (\n customData = { string b = \"def\" }\n) {\n over \"B\" { }\n def Mesh \"C\" {\n int[] z = edit [append [1]]\n double w.timeSamples = { 1: 2 }\n}\n}";
        let mended = mend(text.as_bytes()).unwrap();
        assert_eq!(mended.told.iter().map(|(path, _)| path.as_str()).collect::<Vec<_>>(), ["/A/C.z"]);
    }

    #[test]
    fn a_prim_that_stands_twice_is_told() {
        let twice = |text: &str| -> Vec<String> {
            mend(text.as_bytes())
                .map_or_else(Vec::new, |mended| mended.told.into_iter().map(|(path, _)| path).collect())
        };
        let text = "#usda 1.0\ndef \"A\" { def Mesh \"B\" { }\n over \"C\" {}\n over \"B\" {} }\nclass \"A\" {}\ndef \"B\" {}\n";
        assert_eq!(twice(text), ["/A/B", "/A"]);
        let variants = "#usda 1.0\ndef \"A\" { variantSet \"v\" = { \"x\" { def \"B\" {} } \"y\" { def \"B\" {} } } def \"B\" {} }\n";
        assert_eq!(twice(variants), [""; 0]);
        assert_eq!(twice("#usda 1.0\n} } def \"A\" {}\n"), [""; 0]);
    }

    /// Whatever is cut off where, nothing is lost and nothing breaks.
    #[test]
    fn text_may_end_anywhere() {
        let text = "#usda 1.1\n/* a */ def \"A\" ( prepend inactiveIds = [1] ) { double x.spline = { 1: 2; { string a = '''b''' } }\n double y = AnimationBlock ( )\n int[] z = edit [ [1] ]\n asset a = @@@b@@@ // c\n}\n";
        for end in 0..text.len() {
            let _ = mend(&text.as_bytes()[..end]);
        }
    }
}
