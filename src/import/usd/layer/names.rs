//! Names of properties with letters beyond ASCII. In text the openusd crate (0.8) does not read them, in memory it
//! has them: they go through its parser in letters that it reads, and are named back in the layer that it made.

use openusd::sdf::{self, ChildrenKey, Value};
use openusd::tf::Token;
use openusd::usd::Stage;

/// Before the bytes of a name, in hexadecimal digits.
const MARK: &str = "penumbra_utf8_";

/// `name` in ASCII letters.
pub(super) fn plain(name: &str) -> String {
    let segment = |segment: &str| match segment.is_ascii() {
        true => segment.to_owned(),
        false => segment.bytes().fold(MARK.to_owned(), |plain, byte| format!("{plain}{byte:02x}")),
    };
    name.split(':').map(segment).collect::<Vec<_>>().join(":")
}

/// The name or path that became `plain`.
fn named(plain: &str) -> String {
    let mut parts = plain.split(MARK);
    let mut name = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let digits = part.bytes().take_while(u8::is_ascii_hexdigit).count();
        let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok();
        let bytes = part.as_bytes()[..digits].chunks(2).map(byte).collect::<Option<Vec<u8>>>();
        match bytes.filter(|bytes| !bytes.is_empty()).and_then(|bytes| String::from_utf8(bytes).ok()) {
            Some(text) => name.extend([text.as_str(), &part[digits..]]),
            None => name.extend([MARK, part]),
        }
    }
    name
}

/// Gives the properties of `layer` their names back.
pub(in super::super) fn restore(stage: &Stage, layer: &str) {
    let Some(mut layer) = stage.layer_mut(layer) else { return };
    let renamed: Vec<(sdf::Path, sdf::Path)> = layer
        .data()
        .spec_paths()
        .into_iter()
        .filter(|path| path.as_str().contains(MARK))
        .filter_map(|path| Some((path.clone(), sdf::path(named(path.as_str())).ok()?)))
        .collect();
    if renamed.is_empty() {
        return;
    }
    // A name that can't be given back stays as it is: a property that nobody asks for.
    let _ = layer.edit(|edit| {
        let data = edit.data_mut();
        let key = ChildrenKey::PropertyChildren.as_str();
        for (plain, path) in &renamed {
            let Some(kind) = data.spec_type(plain) else { continue };
            data.create_spec(path.clone(), kind);
            for field in data.list_fields(plain).unwrap_or_default() {
                let value = data.try_field(plain, &field).ok().flatten().map(|value| value.into_owned());
                value.into_iter().for_each(|value| data.set_field(path, &field, value));
            }
            data.erase_spec(plain);
            let Some(owner) = plain.parent() else { continue };
            let children = data.try_field(&owner, key).ok().flatten().map(|value| value.into_owned());
            if let Some(Value::TokenVec(names)) = children {
                let names = names.iter().map(|name| Token::from(named(name.as_str()).as_str())).collect();
                data.set_field(&owner, key, Value::TokenVec(names));
            }
        }
        Ok(())
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_back() {
        for name in ["size", "primvars:größe", "größe:x:日本", "ä", "primvars:größe:indices"] {
            assert!(plain(name).is_ascii());
            assert_eq!(named(&plain(name)), name);
            let path = format!("/Müll/A.{}", plain(name));
            assert_eq!(named(&path), format!("/Müll/A.{name}"));
        }
        for odd in ["penumbra_utf8_zz", "penumbra_utf8_ff", "penumbra_utf8_"] {
            assert_eq!(named(odd), odd);
        }
    }
}
