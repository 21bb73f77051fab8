//! Holds a [`SceneDesc`] to its own rules, so that what follows need not.

use super::graph::{Graph, Op, ValueId};
use super::{LightKind, RoundsDesc, SceneDesc, ShapeRef};
use crate::error::{Error, Place, Result};

/// Checks every index and length of `scene`.
///
/// # Errors
/// [`Error::Invalid`] with the place of the first shape, instance, texture or material that breaks
/// a rule. A door that lets that happen has a bug: bad files are mended, with a warning, at the door.
pub fn check(scene: &SceneDesc) -> Result<()> {
    for mesh in &scene.meshes {
        let points = mesh.points.len();
        let corners = 3 * mesh.triangles.len();
        let rule = |ok: bool, what: &str| if ok { Ok(()) } else { Err(Error::invalid(&mesh.place, what)) };
        rule(mesh.triangles.iter().flatten().all(|&i| (i as usize) < points), "a triangle names a point out of range")?;
        rule(mesh.normals.as_ref().is_none_or(|a| attribute_fits(a, points, corners)), "wrong count of normals")?;
        rule(mesh.uvs.iter().all(|a| attribute_fits(a, points, corners)), "wrong count of UVs")?;
        rule(mesh.tangents.as_ref().is_none_or(|a| attribute_fits(a, points, corners)), "wrong count of tangents")?;
        rule(mesh.colors.as_ref().is_none_or(|a| attribute_fits(a, points, corners)), "wrong count of colors")?;
        rule(mesh.attributes.iter().all(|a| attribute_fits(&a.values, points, corners)), "wrong count of attributes")?;
        rule(mesh.material_slots.as_ref().is_none_or(|s| s.len() == mesh.triangles.len()), "wrong count of slots")?;
        rule(mesh.motion.iter().all(|m| m.value.len() == points), "wrong count of points that move")?;
    }
    scene.rounds.iter().try_for_each(|rounds| check_rounds(rounds))?;
    for instance in &scene.instances {
        match instance.shape {
            ShapeRef::Mesh(i) => index(i, scene.meshes.len(), &instance.place, "mesh")?,
            ShapeRef::Rounds(i) => index(i, scene.rounds.len(), &instance.place, "strands")?,
        }
        for &material in instance.materials.iter().flatten() {
            index(material, scene.materials.len(), &instance.place, "material")?;
        }
        if let Some(ies) = instance.shaped.as_ref().and_then(|shaped| shaped.shaping.ies) {
            index(ies.profile, scene.ies.len(), &instance.place, "IES profile")?;
        }
    }
    for texture in &scene.textures {
        index(texture.image, scene.images.len(), &texture.place, "image")?;
    }
    for material in &scene.materials {
        for texture in material.textures() {
            index(texture.texture, scene.textures.len(), &material.place, "texture")?;
        }
        check_graph(scene, &material.graph, material.graph_values(), &material.place)?;
    }
    let background = &scene.background_aovs;
    check_graph(scene, &background.graph, background.outputs.iter().flat_map(|(_, values)| *values), &scene.place)?;
    for image in &scene.images {
        let texels = image.width as usize * image.height as usize;
        if texels == 0 || image.pixels.len() != texels * usize::from(image.channels) {
            return Err(Error::invalid(&image.place, "image size and texel count differ"));
        }
    }
    for light in &scene.lights {
        if let Some(image) = light.kind.image() {
            index(image, scene.images.len(), &light.place, "image")?;
        }
        if let LightKind::ShadedDome { shader } = light.kind {
            index(shader, scene.dome_shaders.len(), &light.place, "dome shader")?;
            let shader = &scene.dome_shaders[shader as usize];
            check_graph(scene, &shader.graph, [shader.radiance], &light.place)?;
        }
        if let Some(shader) = light.shaping.shader {
            index(shader, scene.lamp_shaders.len(), &light.place, "lamp shader")?;
            let shader = &scene.lamp_shaders[shader as usize];
            check_graph(scene, &shader.graph, [shader.factor], &light.place)?;
        }
        if let Some(ies) = light.shaping.ies {
            index(ies.profile, scene.ies.len(), &light.place, "IES profile")?;
        }
    }
    for ies in &scene.ies {
        if ies.vertical.is_empty() || ies.candela.len() != ies.vertical.len() * ies.horizontal.len() {
            return Err(Error::invalid(&ies.place, "IES angles and values differ in number"));
        }
    }
    let of_lamps = scene.lights.iter().map(|light| (&light.links, &light.place));
    for (links, place) in of_lamps.chain(scene.instances.iter().map(|i| (&i.links, &i.place))) {
        for &i in links.receivers.iter().chain(&links.blockers).flat_map(|set| &set.instances) {
            index(i, scene.instances.len(), place, "linked object")?;
        }
    }
    Ok(())
}

fn check_graph(
    scene: &SceneDesc,
    graph: &Graph,
    values: impl IntoIterator<Item = ValueId>,
    place: &Place,
) -> Result<()> {
    for value in values {
        index(value.index() as u32, graph.ops().len(), place, "value of the graph")?;
    }
    for op in graph.ops() {
        if let Op::Image { texture, .. } = op {
            index(*texture, scene.textures.len(), place, "texture of the graph")?;
        }
    }
    Ok(())
}

fn check_rounds(rounds: &RoundsDesc) -> Result<()> {
    let points = rounds.points.len();
    let rule = |ok: bool, what: &str| if ok { Ok(()) } else { Err(Error::invalid(&rounds.place, what)) };
    rule(rounds.radii.len() == points, "wrong count of radii")?;
    rule(rounds.uvs.iter().all(|values| values.len() == points), "wrong count of UVs")?;
    rule(rounds.colors.as_ref().is_none_or(|values| values.len() == points), "wrong count of colors")?;
    rule(rounds.attributes.iter().all(|(_, values)| values.len() == points), "wrong count of attributes")?;
    rule(rounds.motion.iter().all(|m| m.value.len() == points), "wrong count of points that move")?;
    let radii = &rounds.radii_motion;
    let of_times = radii.is_empty() || radii.len() == rounds.motion.len();
    rule(of_times && radii.iter().all(|radii| radii.len() == points), "wrong count of radii that change")?;
    let ends = || rounds.strands.iter().map(|strand| strand.end);
    let grow = std::iter::once(0).chain(ends()).zip(ends()).all(|(before, end)| before < end);
    let fit = ends().next_back().is_none_or(|end| end as usize == points);
    rule(grow && fit, "strands and points differ in number")?;
    let slots = if rounds.strands.is_empty() { points } else { rounds.strands.len() };
    rule(rounds.material_slots.as_ref().is_none_or(|s| s.len() == slots), "wrong count of slots")
}

fn attribute_fits<T>(attribute: &super::Attribute<T>, points: usize, corners: usize) -> bool {
    match attribute {
        super::Attribute::Point(values) => values.len() == points,
        super::Attribute::Corner(values) => values.len() == corners,
    }
}

fn index(i: u32, len: usize, place: &Place, kind: &str) -> Result<()> {
    if (i as usize) < len { Ok(()) } else { Err(Error::invalid(place, format!("{kind} {i} of {len} does not exist"))) }
}
