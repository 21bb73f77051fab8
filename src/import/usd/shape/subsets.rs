//! GeomSubsets that materials are bound to.

use openusd::sdf;
use openusd::tf::Token;
use openusd::usd::Prim;

use super::super::stage::Reading;

/// The subsets of family `materialBind` of a mesh.
#[derive(Clone, Debug, Default)]
pub(super) struct Subsets {
    pub paths: Vec<sdf::Path>,
    /// Faces of each, as authored.
    pub faces: Vec<Vec<i32>>,
}

impl PartialEq for Subsets {
    /// True for those of the same faces, whatever they are called.
    fn eq(&self, other: &Self) -> bool {
        self.faces == other.faces
    }
}

fn of_materials(reading: &Reading<'_>, prim: &Prim) -> impl Iterator<Item = Prim> {
    prim.children().unwrap_or_default().into_iter().filter(|child| {
        child.type_name().ok().flatten().is_some_and(|kind| kind == "GeomSubset")
            && reading.value::<Token>(child, "familyName").is_some_and(|family| family == "materialBind")
    })
}

/// Tells of those of `prim`, which is no mesh of faces.
pub(super) fn tell_of_those(reading: &Reading<'_>, prim: &Prim) {
    for child in of_materials(reading, prim) {
        reading
            .warn(child.path(), "subsets are supported of Mesh alone; it is left out, and its parent's material shown");
    }
}

/// Those of the mesh `prim`.
pub(super) fn read(reading: &Reading<'_>, prim: &Prim) -> Subsets {
    let mut subsets = Subsets::default();
    for child in of_materials(reading, prim) {
        let element = reading.value::<Token>(&child, "elementType");
        if let Some(element) = element.filter(|element| element != "face") {
            reading.warn(child.path(), format!("subsets of elements \"{element}\" are not supported; it is left out"));
            continue;
        }
        // Slots are counted in 16 bits.
        if subsets.paths.len() == usize::from(u16::MAX) {
            reading.warn(prim.path(), "it has more subsets than can be told apart; the rest is left out");
            break;
        }
        subsets.faces.push(reading.value(&child, "indices").unwrap_or_default());
        subsets.paths.push(child.path().clone());
    }
    subsets
}

impl Subsets {
    /// The material slot of each of `faces` faces, with what is wrong with the indices; `None` without
    /// subsets.
    pub fn slots(&self, faces: usize) -> (Option<Vec<u16>>, Vec<String>) {
        if self.paths.is_empty() {
            return (None, Vec::new());
        }
        let mut slots = vec![0; faces];
        let mut told = Vec::new();
        for (i, (path, list)) in self.paths.iter().zip(&self.faces).enumerate() {
            let (mut unknown, mut taken) = (0, 0);
            for &face in list {
                match usize::try_from(face).ok().and_then(|face| slots.get_mut(face)) {
                    Some(slot @ 0) => *slot = i as u16 + 1,
                    Some(slot) if *slot == i as u16 + 1 => {}
                    Some(_) => taken += 1,
                    None => unknown += 1,
                }
            }
            let name = path.name().unwrap_or_default();
            if unknown > 0 {
                told.push(format!("subset {name} names {unknown} faces that don't exist; they are left out"));
            }
            if taken > 0 {
                told.push(format!("{taken} faces of subset {name} are in another one before it, which has them"));
            }
        }
        (Some(slots), told)
    }
}
