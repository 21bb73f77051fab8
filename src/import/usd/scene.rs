//! Puts the scene together.

use std::collections::BTreeSet;
use std::rc::Rc;

use openusd::sdf::Path;

use super::gather::{Found, Haul};
use super::images::Images;
use super::inherit::moving;
use super::instances::ShapeLights;
use super::light::Profiles;
use super::material::Materials;
use super::stage::Reading;
use super::walk::Placed;
use super::{camera, crew, instances, light, per_instance, pulse, render, shapes, shown, stamp, units, variants};
use crate::desc::{RenderDesc, SceneDesc};
use crate::error::Result;

/// The whole stage as a scene.
pub(super) fn build(reading: &Reading<'_>) -> Result<SceneDesc> {
    let (render, places_of_aovs) = render::read(reading);
    let mut scene =
        SceneDesc { place: reading.place.clone(), render, variants: offered(reading), ..SceneDesc::default() };
    let vectors = reading.options.vectors || scene.render.passes.iter().any(|pass| &**pass == "vector");
    let haul = gather(reading, vectors);
    pulse::rest();
    let mut images = Images::default();
    let shape_lights = lights_and_cameras(reading, &haul, &mut images, &mut scene);
    let mut materials = Materials::new(reading, images, per_instance::pairs(&haul.found), scene.render.aovs.clone());
    materials.preload(haul.found.iter().flat_map(|found| found.look.materials()).collect::<BTreeSet<_>>());
    let Haul { found, shapes, times } = haul;
    let shapes = shapes::build(reading, &found, shapes, &mut materials);
    materials.finish(&mut scene);
    instances::place(reading, &found, &times, shapes, &shape_lights, &mut scene);
    shape_lights.tell_of_missing(reading, &found);
    if found.iter().any(|found| found.look.linked) {
        light::link(reading, |shape| shape_lights.geometry.get(shape).map(|light| &light.path), &mut scene);
    }
    shown::tell_of_missing(reading, &scene, &places_of_aovs);
    if scene.instances.is_empty() && scene.lights.is_empty() {
        let what = "shows nothing: it has neither lights nor geometry that is visible";
        reading.warnings.borrow_mut().push(&reading.place, what);
    }
    units::warn_of_layers(reading);
    reading.extent.tell(&reading.place, &mut reading.warnings.borrow_mut());
    reading.warn_of_composition();
    Ok(scene)
}

/// True for what is read on its own, not as a shape.
fn aside(kind: &str) -> bool {
    matches!(kind, "Camera" | stamp::KIND) || light::is_light(kind)
}

/// Everything that is shown; read anew where a camera's shutter is open for longer than an instant, which
/// is known only when all was seen. With `vectors` from the frame before to the frame after, too.
fn gather(reading: &Reading<'_>, vectors: bool) -> Haul {
    let haul = crew::gather(reading, aside);
    let frames = frames(reading, vectors);
    let spans = [shutter(reading, &haul), frames].into_iter().flatten();
    let Some(shutter) = spans.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]) else { return haul };
    reading.shutter.set(Some(shutter));
    reading.crew.borrow_mut().clear();
    crew::gather(reading, aside)
}

/// From the frame before to the frame after, for the vector pass.
fn frames(reading: &Reading<'_>, vectors: bool) -> Option<[f64; 2]> {
    if vectors && reading.time.is_earliest_time() {
        let what =
            "the vector pass is asked for, but the stage has no startTimeCode, and no frame is given: nothing moves";
        reading.warnings.borrow_mut().push(&reading.place, what);
        return None;
    }
    vectors.then_some([-1.0, 1.0])
}

/// From when to when a camera's shutter is open, in time codes after the frame.
fn shutter(reading: &Reading<'_>, haul: &Haul) -> Option<[f64; 2]> {
    if render::stands_still(reading) {
        return None;
    }
    let of = |found: &Found| {
        let prim = reading.stage.prim(&found.look.prim).ok()?;
        let end = |name| reading.value::<f64>(&prim, name).filter(|t| t.is_finite()).unwrap_or(0.0);
        let (open, close) = (end("shutter:open"), end("shutter:close"));
        (open < close).then_some([open, close])
    };
    let cameras = haul.found.iter().filter(|found| &*found.look.kind == "Camera");
    let shutter = cameras.filter_map(of).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])?;
    if reading.time.is_earliest_time() {
        let what = "a camera's shutter is open, but the stage has no startTimeCode and endTimeCode, and no frame is given: nothing \
             moves";
        reading.warnings.borrow_mut().push(&reading.place, what);
        return None;
    }
    Some(shutter)
}

/// Variants of the prims in the root, as `--variant` takes them.
fn offered(reading: &Reading<'_>) -> Vec<String> {
    let root = reading.stage.prim(Path::abs_root()).map(|root| root.children().unwrap_or_default());
    let mut offered = Vec::new();
    for prim in root.unwrap_or_default() {
        for (set, choices) in variants::sets(&prim) {
            offered.extend(choices.into_iter().map(|choice| format!("{}{{{set}={choice}}}", prim.path())));
        }
    }
    offered
}

/// Adds lamps and cameras; gives the shapes that shine by what is said elsewhere than in their look.
fn lights_and_cameras(reading: &Reading<'_>, haul: &Haul, images: &mut Images, scene: &mut SceneDesc) -> ShapeLights {
    let mut profiles = Profiles::default();
    let mut shapes = ShapeLights::default();
    let mut lost = BTreeSet::new();
    let placed: Vec<Placed> = haul.found.iter().filter_map(|found| placed(reading, haul, found)).collect();
    let worlds = light::worlds(reading, &placed, images);
    for placed in &placed {
        match &*placed.kind {
            "Camera" | stamp::KIND => add_camera(reading, placed, scene),
            "GeometryLight" => {
                let found = light::geometry_light(reading, placed, &mut profiles);
                shapes.geometry.extend(found.map(|found| (found.target.clone(), found)));
            }
            _ if worlds.replace(&placed.path) => {}
            _ => {
                lost.extend(light::lost(reading, placed));
                scene.lights.extend(light::read(reading, placed, images, &mut profiles));
            }
        }
    }
    scene.lights.extend(worlds.domes);
    if !lost.is_empty() {
        let lost: Vec<&str> = lost.into_iter().collect();
        let what = format!(
            "was exported by Blender alone, which loses what lamps have of these: {}; they are as Blender has them \
             from the start. File > Export > Penumbra keeps them",
            lost.join(", ")
        );
        // Most lamps have nothing to lose, and the file does not say which do.
        reading.warnings.borrow_mut().note(&reading.place, what);
    }
    for found in &haul.found {
        let look = &found.look;
        if let Some(light) = look.shape.as_ref().and_then(|shape| shape.light.as_ref()) {
            shapes.read_shaping(reading, light, &look.prim, &found.path, &mut profiles);
        }
    }
    scene.ies = profiles.list;
    shapes
}

/// What is read on its own of `found`.
fn placed(reading: &Reading<'_>, haul: &Haul, found: &Found) -> Option<Placed> {
    if !aside(&found.look.kind) {
        return None;
    }
    Some(Placed {
        prim: reading.stage.prim(&found.look.prim).ok()?,
        path: found.path.clone(),
        kind: Rc::from(&*found.look.kind),
        world: found.pose.world,
        motion: moving(&haul.times, &found.pose),
        visible: found.look.visible,
    })
}

/// Adds the camera at `placed`, where there is one, and what Blender's scene says of its picture where the
/// stage itself says nothing.
fn add_camera(reading: &Reading<'_>, placed: &Placed, scene: &mut SceneDesc) {
    let Some((camera, render)) = camera::stamped(reading, placed) else {
        if &*placed.kind == "Camera" {
            scene.cameras.extend(camera::read(reading, placed));
        }
        return;
    };
    scene.cameras.push(camera);
    if let Some(render) = render.filter(|_| scene.render == RenderDesc::default()) {
        scene.render = render;
    }
}
