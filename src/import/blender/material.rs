//! Materials: what a surface's nodes compute.

use super::document::{Document, MaterialData};
use super::image::Images;
use super::layers::UvSets;
use super::nodes;
use crate::desc::{ColorInput, MaterialDesc, ScalarInput, SceneDesc};
use crate::error::{Place, Warnings};

/// Adds every material of `document`, in its order.
pub fn materials(
    document: &Document,
    images: &mut Images<'_>,
    uv_sets: &UvSets,
    desc: &mut SceneDesc,
    warnings: &mut Warnings,
) {
    let place = desc.place.clone();
    desc.materials = document.materials.iter().map(|data| material(data, images, uv_sets, &place, warnings)).collect();
    desc.materials.push(default_material(document));
}

/// Index of the material of slots without one.
pub fn default_index(document: &Document) -> u32 {
    document.materials.len() as u32
}

/// What Cycles calls the material of what has none, in Cryptomatte.
const DEFAULT: &str = "default_surface";

/// Up to Blender 4.5 what has no material is a matt 0.8; since 5.0 it is the Principled BSDF's default, which
/// is the engine's, too.
fn default_material(document: &Document) -> MaterialDesc {
    let named = MaterialDesc { name: DEFAULT.into(), ..MaterialDesc::default() };
    if (1..5).contains(&document.version[0]) {
        let plain = ScalarInput::constant;
        return MaterialDesc { roughness: plain(1.0), specular: plain(0.0), ..named };
    }
    named
}

fn material(
    data: &MaterialData,
    images: &mut Images<'_>,
    uv_sets: &UvSets,
    place: &Place,
    warnings: &mut Warnings,
) -> MaterialDesc {
    let base = MaterialDesc {
        name: data.name.as_str().into(),
        place: place.at(&data.name),
        material_index: data.pass_index,
        bump_correction: data.bump_correction,
        unbounded: true,
        ..MaterialDesc::default()
    };
    match &data.nodes {
        Some(tree) => nodes::surface(tree, base, images, uv_sets, &data.displacement_method, warnings),
        None => {
            let [r, g, b, _] = data.diffuse_color;
            let plain = ScalarInput::constant;
            MaterialDesc {
                base_color: ColorInput::constant([r, g, b]),
                roughness: plain(1.0),
                specular: plain(0.0),
                ..base
            }
        }
    }
}
