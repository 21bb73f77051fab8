//! URIs of buffers and images: data URIs (RFC 2397) and paths relative to the file, percent-encoded
//! (glTF 2.0, section 2.8).

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

/// Base64 with or without padding, and without objection to non-zero trailing bits.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// What a URI leads to.
pub(super) enum Target {
    /// The bytes themselves, with their MIME type.
    Data { bytes: Vec<u8>, mime: String },
    /// A file.
    File(PathBuf),
}

/// Reads `uri`; relative ones start at `base`. The error is a sentence without place.
pub(super) fn resolve(uri: &str, base: Option<&Path>) -> Result<Target, String> {
    if let Some(data) = strip_prefix_ignore_case(uri, "data:") {
        return decode_data(data);
    }
    if let Some((scheme, _)) = uri.split_once(':')
        && scheme.len() > 1
        && scheme.bytes().all(|b| b.is_ascii_alphanumeric() || b"+-.".contains(&b))
    {
        let Some(path) = strip_prefix_ignore_case(uri, "file://") else {
            return Err(format!("a URI of scheme '{scheme}' is not fetched; only files and data URIs are read"));
        };
        return Ok(Target::File(PathBuf::from(decode_percent(path)?.as_ref())));
    }
    let Some(base) = base else {
        return Err(format!("'{}' is an external file and the scene comes from memory", shorten(uri)));
    };
    let decoded = base.join(decode_percent(uri)?.as_ref());
    // A file whose name holds a literal percent sign, written without encoding it.
    let literal = base.join(uri);
    Ok(Target::File(if !decoded.exists() && literal.exists() { literal } else { decoded }))
}

fn strip_prefix_ignore_case<'a>(text: &'a str, prefix: &str) -> Option<&'a str> {
    let head = text.get(..prefix.len())?;
    head.eq_ignore_ascii_case(prefix).then(|| &text[prefix.len()..])
}

fn decode_data(data: &str) -> Result<Target, String> {
    let (head, body) = data.split_once(',').ok_or("a data URI without comma")?;
    let mut words = head.split(';');
    let mime = words.next().unwrap_or_default().to_owned();
    let bytes = if words.any(|word| word.eq_ignore_ascii_case("base64")) {
        let text = decode_percent(body)?;
        let compact: Cow<'_, str> =
            if text.contains(char::is_whitespace) { Cow::Owned(text.split_whitespace().collect()) } else { text };
        BASE64.decode(compact.as_bytes()).map_err(|e| format!("bad base64 in a data URI: {e}"))?
    } else {
        percent_encoding::percent_decode_str(body).collect()
    };
    Ok(Target::Data { bytes, mime })
}

fn decode_percent(text: &str) -> Result<Cow<'_, str>, String> {
    percent_encoding::percent_decode_str(text)
        .decode_utf8()
        .map_err(|_| format!("'{}' is not UTF-8 after percent-decoding", shorten(text)))
}

/// The start of a URI, for messages.
pub(super) fn shorten(uri: &str) -> Cow<'_, str> {
    match uri.char_indices().nth(80) {
        Some((end, _)) => Cow::Owned(format!("{}…", &uri[..end])),
        None => Cow::Borrowed(uri),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn data(uri: &str) -> Vec<u8> {
        match resolve(uri, None) {
            Ok(Target::Data { bytes, .. }) => bytes,
            Ok(Target::File(path)) => panic!("file {}", path.display()),
            Err(e) => panic!("{e}"),
        }
    }

    #[test]
    fn data_uris_in_base64_and_in_text() {
        assert_eq!(data("data:application/octet-stream;base64,AQID"), [1, 2, 3]);
        assert_eq!(data("DATA:;base64,AQI"), [1, 2]);
        assert_eq!(data("data:,a%20b%ff"), b"a b\xff");
    }

    #[test]
    fn relative_uris_are_percent_decoded() {
        let Ok(Target::File(path)) = resolve("my%20textures/%C3%A4.png", Some(Path::new("scenes"))) else {
            panic!("not a file")
        };
        assert_eq!(path, Path::new("scenes/my textures/ä.png"));
    }

    #[test]
    fn the_network_is_left_alone() {
        assert!(resolve("https://example.org/a.bin", Some(Path::new("."))).err().unwrap().contains("https"));
        assert!(resolve("a.bin", None).is_err());
    }
}
