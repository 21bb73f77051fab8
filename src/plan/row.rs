//! One line of a plan.

use std::sync::Arc;

/// Names that a reason shows; the rest is counted.
const SHOWN: usize = 3;

/// An effect: whether it is simulated, because of what, and what it adds.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What it is about: "picture", "light", "surface", "input", "pass".
    pub subject: &'static str,
    /// Its name.
    pub effect: &'static str,
    /// Whether it is simulated.
    pub on: bool,
    /// What calls for it, or why nothing does.
    pub because: String,
    /// What it adds where it is on: rays, structures, sample dimensions.
    pub adds: String,
    /// Memory that it takes, where that can be told, in bytes.
    pub bytes: Option<usize>,
    /// Share of a sample's time and the standard error of that, where it was measured.
    pub cost: Option<[f64; 2]>,
    /// The name under which [`costs`](crate::render::costs) measures it.
    pub(super) probe: Option<&'static str>,
}

impl Row {
    /// An effect that is there because of `because`, or is not there because of `otherwise` where that is empty.
    pub(super) fn new(
        subject: &'static str,
        effect: &'static str,
        because: impl Into<String>,
        otherwise: impl Into<String>,
    ) -> Self {
        let because = because.into();
        let on = !because.is_empty();
        let because = if on { because } else { otherwise.into() };
        Self { subject, effect, on, because, adds: String::new(), bytes: None, cost: None, probe: None }
    }

    /// What it adds where it is on.
    pub(super) fn adds(mut self, what: impl Into<String>) -> Self {
        if self.on {
            self.adds = what.into();
        }
        self
    }

    /// Memory that it takes where it is on.
    pub(super) fn bytes(mut self, bytes: usize) -> Self {
        self.bytes = self.on.then_some(bytes);
        self
    }

    /// By which name it is measured.
    pub(super) fn probe(mut self, name: &'static str) -> Self {
        self.probe = Some(name);
        self
    }

    /// What the render does counts: on where `on`, which is more than what was found where everything is `forced`.
    pub(super) fn is(mut self, on: bool, forced: bool) -> Self {
        if on && !self.on {
            self.because =
                format!("{}{}", if forced { "--effects all; " } else { "can't be ruled out; " }, self.because);
        }
        self.on = on;
        self
    }
}

/// "a, b, c and 4 more", for a list without repetitions; empty for none.
pub(super) fn names(list: &[Arc<str>]) -> String {
    let mut seen: Vec<&str> = Vec::new();
    for name in list {
        let name = if name.is_empty() { "(without a name)" } else { name };
        if !seen.contains(&name) {
            seen.push(name);
        }
    }
    let more = seen.len().saturating_sub(SHOWN);
    let shown = seen[..seen.len() - more].join(", ");
    if more > 0 { format!("{shown} and {more} more") } else { shown }
}

/// `what` and its names, "material a, b"; empty for none.
pub(super) fn of(what: &str, list: &[Arc<str>]) -> String {
    if list.is_empty() { String::new() } else { format!("{what} {}", names(list)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_shown_once_and_the_rest_is_counted() {
        let list: Vec<Arc<str>> = ["a", "b", "a", "c", "d", "e"].map(Arc::from).to_vec();
        assert_eq!(of("material", &list), "material a, b, c and 2 more");
        assert_eq!(of("material", &[]), "");
    }

    #[test]
    fn what_is_off_adds_nothing() {
        let off = Row::new("pass", "x", "", "no pass needs it").adds("a ray").bytes(9);
        assert_eq!((off.on, off.adds.as_str(), off.bytes), (false, "", None));
        let forced = off.is(true, true);
        assert!(forced.on && forced.because.starts_with("--effects all"));
    }
}
