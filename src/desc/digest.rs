//! Whether two scenes are the same: a digest of all that can be seen of one.
//!
//! Bulk is taken in as bytes, all else as what `Debug` says, which names every field and writes numbers without loss.
//! Structs are taken apart field by field, so that a new field can't be forgotten. [Places](crate::error::Place), what
//! pictures are called and which variants there would be to choose from are no part of it: a scene that has moved to
//! another folder is the same.

use std::fmt::{Debug, Write};

use rayon::prelude::*;

use super::{Attribute, ImageDesc, MeshDesc, Motion, NamedAttribute, PixelData, RenderDesc, RoundsDesc, SceneDesc};
use crate::math::Digest;

impl SceneDesc {
    /// The digest of the scene.
    pub fn digest(&self) -> u64 {
        let Self {
            place: _,
            cameras,
            meshes,
            rounds,
            instances,
            materials,
            textures,
            images,
            lights,
            dome_shaders,
            lamp_shaders,
            background_aovs,
            lights_left_out,
            ies,
            variants: _,
            render,
        } = self;
        let RenderDesc {
            framing,
            crop,
            film_transparent,
            transparent_glass,
            fewer_in_shadow,
            pass_alpha_threshold,
            passes,
            aovs,
            product: _,
            product_place: _,
            products,
        } = render;
        let mut all = Digest::default();
        let lists = [
            each(meshes, |digest, mesh| add_mesh(digest, mesh)),
            each(rounds, |digest, rounds| add_rounds(digest, rounds)),
            each(instances, say),
            each(materials, say),
            each(textures, say),
            each(images, |digest, image| add_image(digest, image)),
            each(lights, say),
            each(ies, say),
        ];
        for list in lists {
            all.write_u64(list.len() as u64);
            list.into_iter().for_each(|digest| all.write_u64(digest));
        }
        say(&mut all, &(cameras, dome_shaders, lamp_shaders, background_aovs, lights_left_out));
        // Which of several pictures has what, but for their names.
        products.iter().for_each(|product| say(&mut all, &(&product.passes, &product.framing)));
        say(&mut all, &(framing, crop, film_transparent, transparent_glass, fewer_in_shadow));
        say(&mut all, &(pass_alpha_threshold, passes, aovs));
        all.finish()
    }
}

/// The digests of `items`.
fn each<T: Sync>(items: &[T], add: impl Fn(&mut Digest, &T) + Sync) -> Vec<u64> {
    let of = |item: &T| {
        let mut digest = Digest::default();
        add(&mut digest, item);
        digest.finish()
    };
    items.par_iter().map(of).collect()
}

/// Takes in what `Debug` says of `value`; the sign has places say nothing.
fn say<T: Debug + ?Sized>(digest: &mut Digest, value: &T) {
    // A digest takes everything.
    let _ = writeln!(digest, "{value:-?}");
}

/// Takes in numbers as they lie in memory, after how many there are.
fn add<T: bytemuck::NoUninit>(digest: &mut Digest, values: &[T]) {
    digest.write_u64(values.len() as u64);
    digest.write(bytemuck::cast_slice(values));
}

fn add_attribute<T: bytemuck::NoUninit>(digest: &mut Digest, attribute: &Attribute<T>) {
    match attribute {
        Attribute::Point(values) => {
            say(digest, "by point");
            add(digest, values);
        }
        Attribute::Corner(values) => {
            say(digest, "by corner");
            add(digest, values);
        }
    }
}

/// Takes in whether there is one, and if so what it is.
fn add_some<T>(digest: &mut Digest, value: &Option<T>, add: impl Fn(&mut Digest, &T)) {
    say(digest, &value.is_some());
    if let Some(value) = value {
        add(digest, value);
    }
}

fn add_motion(digest: &mut Digest, keys: &[Motion<Vec<[f32; 3]>>]) {
    say(digest, &keys.len());
    for Motion { time, value } in keys {
        say(digest, time);
        add(digest, value);
    }
}

fn add_mesh(digest: &mut Digest, mesh: &MeshDesc) {
    let MeshDesc {
        name,
        place: _,
        points,
        triangles,
        normals,
        uvs,
        tangents,
        colors,
        attributes,
        generated,
        material_slots,
        motion,
    } = mesh;
    say(digest, &(name, generated, uvs.len(), attributes.len()));
    add(digest, points);
    add(digest, triangles);
    add_some(digest, normals, add_attribute);
    uvs.iter().for_each(|uvs| add_attribute(digest, uvs));
    add_some(digest, tangents, add_attribute);
    add_some(digest, colors, add_attribute);
    for NamedAttribute { name, values } in attributes {
        say(digest, name);
        add_attribute(digest, values);
    }
    add_some(digest, material_slots, |digest, slots| add(digest, slots));
    add_motion(digest, motion);
}

fn add_rounds(digest: &mut Digest, rounds: &RoundsDesc) {
    let RoundsDesc {
        name,
        place: _,
        points,
        radii,
        strands,
        uvs,
        colors,
        attributes,
        material_slots,
        motion,
        radii_motion,
    } = rounds;
    say(digest, &(name, uvs.len(), attributes.len(), radii_motion.len()));
    add(digest, points);
    add(digest, radii);
    let strands: Vec<[u32; 2]> = strands.iter().map(|strand| [strand.end, u32::from(strand.closed)]).collect();
    add(digest, &strands);
    uvs.iter().for_each(|uvs| add(digest, uvs));
    add_some(digest, colors, |digest, colors| add(digest, colors));
    for (name, values) in attributes {
        say(digest, name);
        add(digest, values);
    }
    add_some(digest, material_slots, |digest, slots| add(digest, slots));
    add_motion(digest, motion);
    radii_motion.iter().for_each(|radii| add(digest, radii));
}

fn add_image(digest: &mut Digest, image: &ImageDesc) {
    let ImageDesc { name: _, place: _, width, height, channels, color_space, blending, pixels } = image;
    // `Debug` of pixels is their type and number.
    say(digest, &(width, height, channels, color_space, blending, pixels));
    match pixels {
        PixelData::U8(texels) => add(digest, texels),
        PixelData::U16(texels) => add(digest, texels),
        PixelData::F16(texels) => add(digest, texels),
        PixelData::F32(texels) => add(digest, texels),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::desc::{ColorSpace, LightDesc, LightKind, MaterialDesc};
    use crate::error::Place;
    use crate::math::DAffine3;

    fn scene(folder: &str) -> SceneDesc {
        let place = Place::file(format!("{folder}/scene.usda"));
        let mesh = MeshDesc {
            place: place.at("/Mesh"),
            points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            uvs: vec![Attribute::Point(vec![[0.0; 2]; 3])],
            ..MeshDesc::default()
        };
        let image = ImageDesc {
            name: "image".into(),
            place: place.clone(),
            width: 2,
            height: 1,
            channels: 1,
            color_space: ColorSpace::Linear,
            blending: Default::default(),
            pixels: PixelData::U8(vec![7, 8]),
        };
        let kind = LightKind::Point { intensity: [1.0; 3] };
        SceneDesc {
            meshes: vec![Arc::new(mesh)],
            images: vec![Arc::new(image)],
            materials: vec![MaterialDesc { place: place.clone(), ..MaterialDesc::default() }],
            lights: vec![LightDesc::new("lamp", place.at("/Lamp"), DAffine3::IDENTITY, kind)],
            place,
            ..SceneDesc::default()
        }
    }

    #[test]
    fn a_scene_that_has_moved_is_the_same() {
        let mut other = scene("b");
        other.variants.push("winter".into());
        other.render.product = Some("picture.exr".into());
        assert_eq!(scene("a").digest(), other.digest());
    }

    /// A change of a scene.
    type Change = fn(&mut SceneDesc);

    #[test]
    fn whatever_can_be_seen_makes_another_scene() {
        let changes: [Change; 9] = [
            |s| Arc::make_mut(&mut s.meshes[0]).points[2][1] = 1.000_000_1,
            |s| Arc::make_mut(&mut s.meshes[0]).triangles[0] = [1, 2, 0],
            |s| Arc::make_mut(&mut s.meshes[0]).uvs[0] = Attribute::Corner(vec![[0.0; 2]; 3]),
            |s| Arc::make_mut(&mut s.images[0]).pixels = PixelData::U8(vec![7, 9]),
            |s| s.materials[0].base_color.factor[1] += 1e-15,
            |s| s.lights[0].links.cast_shadow = false,
            |s| s.lights.push(s.lights[0].clone()),
            |s| s.render.crop = Some([0, 0, 1, 1]),
            |s| s.render.film_transparent = Some(true),
        ];
        let mut seen = vec![scene("a").digest()];
        for change in changes {
            let mut changed = scene("a");
            change(&mut changed);
            let digest = changed.digest();
            assert!(!seen.contains(&digest), "change {}", seen.len());
            seen.push(digest);
        }
    }
}
