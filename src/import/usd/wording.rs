//! What the openusd crate says of a broken layer, in one line and in words for people.

/// `text` without the crate's own names: where in the file first, then what is wrong.
pub(super) fn plain(text: &str) -> String {
    let first = text.lines().next().unwrap_or_default();
    let what = named(first.replace("error: ", "").trim());
    let place = text.lines().find_map(|line| line.trim_start().strip_prefix("--> "));
    let numbers = place.map(|place| place.rsplitn(3, ':').collect::<Vec<_>>());
    match numbers.as_deref() {
        Some([column, line, _]) => format!("line {line}, column {column}: {what}"),
        _ => what,
    }
}

/// `what` with its tokens and types as a user writes them.
fn named(what: &str) -> String {
    let mut what = what.replace("failed to read pod ", "failed to read ");
    // Types of the crate: the last part of their path says enough.
    while let Some(start) = what.find("openusd::") {
        let end = what[start..]
            .find(|c: char| !(c.is_alphanumeric() || c == ':' || c == '_'))
            .map_or(what.len(), |n| start + n);
        let path = what[start..end].trim_end_matches(':');
        let last = path.rsplit("::").next().unwrap_or_default().to_lowercase();
        what.replace_range(start..start + path.len(), &last);
    }
    // `Punctuation('=')`, `Identifier("def")`.
    for token in ["Punctuation(", "Identifier(", "NamespacedIdentifier(", "Number(", "String("] {
        while let Some(start) = what.find(token) {
            let Some(end) = what[start..].find(')').map(|n| start + n) else { break };
            // A bracket that is the token itself.
            let end = if what[end..].starts_with(")')") { end + 2 } else { end };
            let inside = what[start + token.len()..end].to_string();
            what.replace_range(start..=end, &inside);
        }
    }
    // How Rust calls a number that is none.
    match what.find(": ParseFloatError").or_else(|| what.find(": ParseIntError")) {
        Some(end) => what[..end]
            .replace("Failed to parse f64 from", "no number:")
            .replace("Failed to parse f32 from", "no number:"),
        None => what,
    }
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn the_place_comes_first_and_names_of_the_crate_go() {
        for (text, expected) in [
            (
                "error: Expected a number, got Punctuation('=')\n --> /a/b:c.usda:2:34\n  |\n2 | x = = 3\n  | ^",
                "line 2, column 34: Expected a number, got '='",
            ),
            (
                "error: Unable to parse pseudo root: got Identifier(\"hello\")\n --> a.usda:1:1",
                "line 1, column 1: Unable to parse pseudo root: got \"hello\"",
            ),
            ("got Punctuation(')') here", "got ')' here"),
            (
                "error: Failed to parse f64 from 'three': ParseFloatError { kind: Invalid }\n --> b.usda:3:19",
                "line 3, column 19: no number: 'three'",
            ),
            (
                "failed to read pod openusd::usdc::layout::Bootstrap: corrupt crate data: 32 bytes at offset 0",
                "failed to read bootstrap: corrupt crate data: 32 bytes at offset 0",
            ),
            ("corrupt crate data: section corrupt", "corrupt crate data: section corrupt"),
        ] {
            assert_eq!(plain(text), expected);
        }
    }
}
