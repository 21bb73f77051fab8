//! What the walk does at prims of each type.

use std::collections::HashMap;
use std::sync::Arc;

use openusd::tf::Token;
use openusd::usd::Prim;

use super::stage::Reading;

/// What is done at a prim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// It shows nothing, its children may.
    Group,
    /// It and all below are no part of the picture, or are read from elsewhere.
    Aside,
    /// Its children are prototypes.
    Instancer,
    /// Something to see, or to see by.
    Leaf,
}

/// A type of prims.
#[derive(Clone)]
pub(super) struct Kind {
    /// The type as authored.
    pub type_name: Token,
    /// Name of its schema, as "Mesh".
    pub name: Arc<str>,
    pub role: Role,
    /// True where it has visibility and purpose.
    pub imageable: bool,
    /// True where it has a transform.
    pub xformable: bool,
}

/// Types of OpenUSD that there is no schema of here.
const NOT_RENDERED: [&str; 4] = ["Volume", "OpenVDBAsset", "Field3DAsset", "GenerativeProcedural"];

/// The types met so far.
#[derive(Default)]
pub(super) struct Kinds(HashMap<Token, Kind>);

impl Kinds {
    /// That of `prim`; a type that no schema is known of is told.
    pub fn of(&mut self, reading: &Reading<'_>, prim: &Prim) -> Kind {
        let token = prim.type_name().ok().flatten().unwrap_or_default();
        if let Some(kind) = self.0.get(&token) {
            return kind.clone();
        }
        let registry = reading.stage.schema_registry();
        let known = token.as_str().is_empty() || registry.is_concrete_type(&token);
        // A type that is not known may name others that it can be taken for.
        let schema = if known { Some(token.clone()) } else { prim.schema_type().ok().flatten() };
        let name = schema.as_ref().unwrap_or(&token);
        let role = role(name.as_str());
        let is = |base: &str| registry.is_a(name, &Token::from(base));
        let (imageable, xformable) = (is("Imageable"), is("Xformable"));
        let mut kind = Kind { type_name: token.clone(), name: name.as_str().into(), role, imageable, xformable };
        if schema.is_none() && role == Role::Leaf {
            let what = match NOT_RENDERED.contains(&token.as_str()) {
                true => format!("prims of type '{token}' are not rendered"),
                false => format!("type '{token}' is of no schema that is known here; the prim itself shows nothing"),
            };
            reading.warn(prim.path(), what);
            kind.role = Role::Group;
        }
        if known {
            self.0.insert(token, kind.clone());
        }
        kind
    }
}

fn role(schema: &str) -> Role {
    match schema {
        "" | "Xform" | "Scope" | "SkelRoot" => Role::Group,
        "Material" | "NodeGraph" | "Shader" | "GeomSubset" | "Skeleton" | "SkelAnimation" | "BlendShape"
        | "RenderSettings" | "RenderProduct" | "RenderVar" | "RenderPass" | "SpatialAudio" => Role::Aside,
        physics if physics.starts_with("Physics") => Role::Aside,
        "PointInstancer" => Role::Instancer,
        _ => Role::Leaf,
    }
}
