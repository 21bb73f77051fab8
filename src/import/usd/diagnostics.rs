//! What could not be composed, in plain words: which layer, which prim, and what became of it.

use openusd::pcp::{ArcType, CompositionDiagnostic};
use openusd::sdf;

use super::stage::Reading;
use super::wording::plain;
use crate::error::Place;

/// Arcs, each within the next, which the openusd crate (0.8) takes for a cycle whatever they are.
const LONGEST: usize = 99;

/// Tells of everything that composition left out so far.
pub(super) fn tell(reading: &Reading<'_>) {
    let mut told: Vec<(Place, String)> = Vec::new();
    for diagnostic in reading.stage.composition_errors() {
        // MaterialX documents are read by the materials, not by composition.
        if matches!(&diagnostic, CompositionDiagnostic::MalformedLayer { asset_path, .. } if is_document(asset_path)) {
            continue;
        }
        if let CompositionDiagnostic::UnreadableClip { asset_path, prim_path, .. } = &diagnostic
            && reading.missing_clips.borrow().contains(&(prim_path.clone(), asset_path.clone()))
        {
            continue;
        }
        let (layer, prim, what) = describe(&diagnostic);
        let place = match layer {
            Some(layer) => Place::file(layer),
            None => reading.place.clone(),
        };
        let place = prim.map_or_else(|| place.clone(), |prim| place.at(prim.as_str()));
        told.push((place, what));
    }
    // Composition finds them in an order of its own, which differs from run to run.
    told.sort_by(|a, b| (&a.0.file, &a.0.node, &a.1).cmp(&(&b.0.file, &b.0.node, &b.1)));
    for (place, what) in told {
        reading.warnings.borrow_mut().push(&place, what);
    }
}

/// Layer and prim that authored the fault, and a sentence.
fn describe(diagnostic: &CompositionDiagnostic) -> (Option<&str>, Option<&sdf::Path>, String) {
    use CompositionDiagnostic as D;
    match diagnostic {
        D::ArcCycle(cycle) => {
            let arcs: Vec<String> =
                cycle.hops.iter().map(|hop| format!("{} @{}@<{}>", arc_name(hop.arc), hop.layer, hop.path)).collect();
            let what = match &arcs[..] {
                [.., last] if arcs.len() >= LONGEST => format!(
                    "is composed through a chain of {LONGEST} arcs, more than are followed: what is {last} is left out"
                ),
                _ => format!("is composed of itself: {}; the last is left out", arcs.join(", ")),
            };
            (Some(&cycle.root_layer), Some(&cycle.composing), what)
        }
        D::UnresolvedLayer { asset_path, arc, introduced_by, site_path } => {
            let what = format!("the {} layer @{asset_path}@ is not found; it is left out", arc_name(*arc));
            (Some(introduced_by), Some(site_path), what)
        }
        D::MalformedLayer { asset_path, arc, introduced_by, site_path, reason } => {
            let what = format!(
                "the {} layer @{asset_path}@ can't be read ({}); it is left out",
                arc_name(*arc),
                plain(reason)
            );
            (Some(introduced_by), Some(site_path), what)
        }
        D::UnreadableClip { asset_path, prim_path, reason, .. } => {
            let what = format!("the value clip @{asset_path}@ can't be read ({}); it is left out", plain(reason));
            (None, Some(prim_path), what)
        }
        D::UnresolvedPrimPath { arc, target_layer, prim_path, introduced_by, site_path } => {
            let what = match (arc, target_layer == introduced_by) {
                (ArcType::Reference, true) => {
                    format!("its internal reference to <{prim_path}> finds no prim there; it is left out")
                }
                (ArcType::Payload, true) => {
                    format!("its internal payload <{prim_path}> finds no prim there; it is left out")
                }
                _ => format!("the {} layer @{target_layer}@ has no prim {prim_path}; it is left out", arc_name(*arc)),
            };
            (Some(introduced_by), Some(site_path), what)
        }
        D::UnresolvedDefaultPrim { layer_id, arc, site_path } => {
            let what = format!("the {} layer @{layer_id}@ names no default prim; it is left out", arc_name(*arc));
            (None, Some(site_path), what)
        }
        D::UnresolvedSublayer { asset_path, introduced_by } => {
            (Some(introduced_by), None, format!("the sublayer @{asset_path}@ is not found; it is left out"))
        }
        D::MalformedSublayer { asset_path, introduced_by, reason } => {
            let what = format!("the sublayer @{asset_path}@ can't be read ({}); it is left out", plain(reason));
            (Some(introduced_by), None, what)
        }
        D::SublayerCycle { root_layer, seen_layer } => {
            (Some(root_layer), None, format!("is its own sublayer through @{seen_layer}@; that is left out"))
        }
        D::InvalidExpression { source_layer, site_path, .. } => {
            (Some(source_layer), Some(site_path), format!("{diagnostic}; it is left out"))
        }
        D::InvalidExternalTargetPath { layer, property, .. } | D::InvalidInstanceTargetPath { layer, property, .. } => {
            (Some(layer), Some(property), format!("{diagnostic}; it is left out"))
        }
        _ => (None, None, format!("{diagnostic}; it is left out")),
    }
}

fn is_document(asset_path: &str) -> bool {
    asset_path.to_ascii_lowercase().ends_with(".mtlx")
}

fn arc_name(arc: ArcType) -> &'static str {
    match arc {
        ArcType::Reference => "referenced",
        ArcType::Payload => "payload",
        ArcType::Inherit => "inherited",
        ArcType::Specialize => "specialized",
        _ => "composed",
    }
}
