//! What the camera and the shutter call for.

use super::Facts;
use super::row::{Row, names, of};
use crate::desc::{ProjectionDesc, ShapeRef};

const SUBJECT: &str = "picture";

pub(super) fn rows(facts: &Facts<'_>) -> Vec<Row> {
    vec![motion_blur(facts), depth_of_field(facts), rolling_shutter(facts), panorama(facts), geometry(facts)]
}

fn motion_blur(facts: &Facts<'_>) -> Row {
    let on = facts.scene.effects.motion_blur;
    let mut moving: Vec<_> =
        facts.camera.filter(|camera| !camera.motion.is_empty()).map(|c| c.name.clone()).into_iter().collect();
    moving.extend(
        facts
            .desc
            .instances
            .iter()
            .filter(|it| {
                let deforms = match it.shape {
                    ShapeRef::Mesh(i) => !facts.desc.meshes[i as usize].motion.is_empty(),
                    ShapeRef::Rounds(i) => !facts.desc.rounds[i as usize].motion.is_empty(),
                };
                deforms || !it.motion.is_empty()
            })
            .map(|it| it.name.clone()),
    );
    let shutter = facts.camera.map_or([0.0; 2], |camera| camera.shutter);
    let otherwise = match () {
        () if !facts.settings.motion_blur => "--motion-blur off".to_owned(),
        () if shutter[0] >= shutter[1] => "the shutter does not open".to_owned(),
        () if moving.is_empty() => {
            format!("nothing moves while the shutter is open, frame {:+} to {:+}", shutter[0], shutter[1])
        }
        () => format!("{} would not be seen to move", names(&moving)),
    };
    facts
        .flagged(SUBJECT, "motion blur", on, of("moving:", &moving), otherwise)
        .adds("a time for each sample, boxes that span the shutter")
        .probe("effect motion blur")
}

fn depth_of_field(facts: &Facts<'_>) -> Row {
    let lens = facts.camera.and_then(|camera| camera.lens.map(|lens| (camera, lens)));
    let because = lens.filter(|(_, lens)| lens.aperture_radius > 0.0).map(|(camera, lens)| {
        let millimetres = 2000.0 * lens.aperture_radius;
        format!("camera {}: a lens of {millimetres:.3} mm, sharp at {:.3} m", camera.name, lens.focus_distance)
    });
    let otherwise = if lens.is_some() { "the aperture is 0" } else { "the camera is a pinhole" };
    Row::new(SUBJECT, "depth of field", because.unwrap_or_default(), otherwise)
        .adds("2 numbers a sample, for a point of the lens")
}

fn rolling_shutter(facts: &Facts<'_>) -> Row {
    let rolling = facts.camera.and_then(|camera| camera.rolling_shutter).filter(|_| facts.scene.effects.motion_blur);
    let because = rolling.map(|share| format!("each row is exposed for {share:.3} of the shutter's time"));
    Row::new(SUBJECT, "rolling shutter", because.unwrap_or_default(), "all rows are exposed at once, or nothing moves")
}

fn panorama(facts: &Facts<'_>) -> Row {
    let is = facts.camera.is_some_and(|c| matches!(c.projection, ProjectionDesc::Equirectangular { .. }));
    let because = if is { "the camera sees all around" } else { "" };
    Row::new(SUBJECT, "panorama", because, "the camera has a plane picture")
}

/// What there is to trace.
fn geometry(facts: &Facts<'_>) -> Row {
    let desc = facts.desc;
    let triangles: usize = desc.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    let (strands, balls) = desc.rounds.iter().fold((0, 0), |(strands, balls), rounds| match rounds.segments() {
        Some(segments) => (strands + segments.len(), balls),
        None => (strands, balls + rounds.points.len()),
    });
    let parts = [(triangles, "triangles"), (strands, "pieces of strands"), (balls, "balls")];
    let parts: Vec<String> = parts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
    let placed = desc.instances.len();
    let because = if parts.is_empty() { String::new() } else { format!("{} in {placed} instances", parts.join(", ")) };
    let [tree, shapes, _] = facts.scene.bytes();
    Row::new(SUBJECT, "geometry", because, "there are no shapes")
        .adds("a ray and its tree at every step of a path")
        .bytes(tree + shapes)
}
