//! Words for the user. A reader that has gone away (`| head`, a closed terminal) must not end a
//! render, so failures to write are not failures.

use std::io::Write;

/// A line on stderr.
pub fn err(line: impl AsRef<str>) {
    let _ = writeln!(std::io::stderr(), "{}", line.as_ref());
}

/// Text on stdout.
pub fn out(text: impl AsRef<str>) {
    let mut stdout = std::io::stdout();
    let _ = stdout.write_all(text.as_ref().as_bytes()).and_then(|()| stdout.flush());
}
