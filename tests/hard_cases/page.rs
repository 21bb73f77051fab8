//! docs/hard-cases.md has every row, and no other.

const PAGE: &str = include_str!("../../docs/hard-cases.md");

/// The names in the first column of the tables under the heading of `room`.
fn listed(room: &str) -> Vec<&'static str> {
    let heading = format!("<a id=\"{room}\"></a>");
    let part = PAGE.split_once(&heading).map_or("", |(_, rest)| rest);
    let part = part.split_once("<a id=").map_or(part, |(part, _)| part);
    let rows = part.lines().filter_map(|line| line.strip_prefix("| "));
    rows.filter_map(|line| line.split_once(" |")).map(|(name, _)| name).filter(|name| *name != "case").collect()
}

/// Holds the page to the rows of `room`.
pub fn lists(room: &str, names: &[&str]) {
    // While the page is being written anew.
    if std::env::var_os("PENUMBRA_WRITES_PAGE").is_some() {
        return;
    }
    let listed = listed(room);
    let missing: Vec<_> = names.iter().filter(|name| !listed.contains(name)).collect();
    let gone: Vec<_> = listed.iter().filter(|name| !names.contains(name)).collect();
    assert!(missing.is_empty() && gone.is_empty(), "docs/hard-cases.md, {room}: lacks {missing:?}, has {gone:?}");
}
