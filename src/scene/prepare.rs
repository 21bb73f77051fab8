//! From what was authored to what is traced: the only place that sees both sides.

mod aovs;
mod cache;
mod camera;
mod dome;
mod emissive;
mod flat;
mod flattened;
mod geometry;
mod graphs;
mod lamp;
mod lamp_shader;
mod lights;
mod links;
mod materials;
mod mend;
mod portals;
mod shadow_look;
mod shaping;
mod suns;
mod texels;
mod vectors;

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::aovs::BackgroundAovs;
use super::effects::emits;
use super::framing::world_bounds;
use super::shutter::Shutter;
use super::surroundings::Surroundings;
use super::{Effects, Ids, Mist, Scene};
use crate::camera::Exposure;
use crate::desc::{
    self, CameraDesc, InstanceDesc, LightDesc, LightKind, RenderDesc, SceneDesc, TerminatorDesc, Visibility,
};
use crate::error::{Error, Result, Warnings};
use crate::film::{Chosen, PassSet, Quantity};
use crate::light::{AnyEmitter, Light, LightSet, Strategy};
use crate::math::{DAffine3, DVec3};
use crate::settings::{LightSelection, Settings};
pub use cache::Cache;
use emissive::Shared;
use links::Links;
use materials::Materials;

/// What to make of a scene's cameras.
#[derive(Clone, Debug, Default)]
pub struct View {
    /// Name or node path of the camera; `None` for the first, or one that frames the scene.
    pub camera: Option<String>,
    /// Width and height of the picture; `None` for 960 across and the camera's own aspect.
    pub size: Option<[u32; 2]>,
}

/// A scene ready to be traced, and what it took.
pub struct Prepared {
    /// The scene.
    pub scene: Scene,
    /// Name of the camera that was chosen.
    pub camera: Arc<str>,
    /// Width and height of the whole picture, of which the scene may show a part.
    pub whole: [u32; 2],
    /// Where in it the upper left pixel of that part is.
    pub corner: [i32; 2],
    /// Time spent on each part, by name.
    pub times: Vec<(&'static str, Duration)>,
    /// What was replaced or left out.
    pub warnings: Warnings,
}

/// Turns `desc` into what is traced, as `settings` ask.
///
/// # Errors
/// An index of `desc` that is out of range, an unknown camera, light group or AOV, a picture without size.
pub fn prepare(desc: SceneDesc, view: &View, settings: &Settings) -> Result<Prepared> {
    prepare_with(desc, view, settings, &mut Cache::default())
}

/// The same, with what `cache` has kept of the scene before, until it is [stopped](Cache::stopped_by).
///
/// # Errors
/// As [`prepare`], and [`Error::Cancelled`] once it is stopped.
pub fn prepare_with(mut desc: SceneDesc, view: &View, settings: &Settings, cache: &mut Cache) -> Result<Prepared> {
    desc::check(&desc)?;
    let mut warnings = Warnings::new();
    flattened::prepare(&mut desc);
    let (camera_desc, whole) = camera::choose(&desc, view, &mut warnings)?;
    let size = cropped(&desc, whole)?;
    let origin = render_space_origin(&desc, camera_desc.transform.translation);
    let shutter = Shutter::of(&camera_desc, settings);
    let (camera, camera_motion) = camera::prepare(&camera_desc, &desc.render, whole, origin, shutter);

    let passes = settings.passes.resolve(&light_groups(&desc), &aovs::declared(&desc));
    let passes = passes.map_err(|what| Error::invalid(&desc.place, what))?;
    let passes = if settings.needs_error() { passes.with_error() } else { passes };
    aovs::keep(&mut desc, passes.aovs());
    let catchers = desc.instances.iter().any(|instance| instance.catcher);
    let passes = if catchers { passes.with_catchers() } else { passes };
    warn_of_passes_left_out(&desc, settings, &passes, &mut warnings);
    let effects = Effects::of(&desc, &camera_desc, settings, &passes);
    let start = Instant::now();
    let Materials { list: materials, textures, names, domes, lamps, background } =
        materials::prepare(&mut desc, settings, passes.aovs(), cache, &mut warnings);
    cache.stop.check()?;
    let textures = Arc::new(textures);
    let background_aovs = background.map(|(program, outputs)| {
        let surroundings = Surroundings { program, textures: textures.clone(), camera, origin };
        BackgroundAovs { surroundings, outputs }
    });
    let mut times = vec![("materials", start.elapsed())];
    let start = Instant::now();
    let links = Links::of(&desc, &mut warnings);
    let terminator = TerminatorDesc {
        geometry: settings.shadow_terminator_geometry_offset,
        shading: settings.shadow_terminator_shading_offset,
    };
    let mut geometry = geometry::prepare(&desc, origin, shutter, &materials, &links, terminator, cache, &mut warnings)?;
    times.push(("geometry", start.elapsed()));
    let start = Instant::now();
    let vectors = passes.needs(Quantity::Vector) && !tell_of_no_vectors(&desc, &camera_desc, shutter, &mut warnings);
    let vectors = vectors.then(|| vectors::prepare(&desc, &camera_desc, whole, origin, &geometry));
    let asked = Arc::new(graphs::asked(&desc, &geometry, &materials, names));

    let default_dome = default_dome(&desc, &materials, &mut warnings);
    let lights = if effects.light || effects.group_shadows || passes.needs(Quantity::Environment) {
        let dome = default_dome.as_ref();
        let groups = passes.groups();
        let (materials, textures) = (&materials, &textures);
        let shared = Shared { materials, domes: &domes, lamps: &lamps, textures, asked: &asked, camera, origin };
        let lights = lights::prepare(&desc, dome, &links, groups, &mut geometry, &shared, cache, &mut warnings);
        tell_of_darkness(&desc, &lights, materials, &mut warnings);
        lights
    } else {
        Vec::new()
    };
    let shows = |light: &Light| light.rules.seen.camera && matches!(light.emitter, AnyEmitter::Dome(_));
    let film_transparent = desc.render.film_transparent == Some(true);
    let background_visible = match desc.render.film_transparent {
        Some(transparent) => !transparent,
        None => lights.iter().any(shows),
    };
    let by = match settings.light_selection {
        LightSelection::Tree => Strategy::Tree,
        LightSelection::Power => Strategy::Power,
        LightSelection::Uniform => Strategy::Uniform,
    };
    let of_groups = passes.needs_shadow_of_groups();
    cache.stop.check()?;
    let lights = LightSet::chosen_by(by, lights, geometry.bvh.bounds(), links.receiver_classes(), &of_groups);
    times.push(("lights", start.elapsed()));
    let scene = Scene {
        camera,
        camera_motion,
        times: Exposure::new(&camera_desc.shutter_curve, camera_desc.rolling_shutter),
        exposure: camera::exposure(&camera_desc),
        size,
        origin,
        passes,
        effects,
        lights,
        background_visible,
        follows_camera: follows_camera(&desc),
        film_transparent,
        transparent_glass: desc.render.transparent_glass.filter(|_| film_transparent).map(|roughness| {
            let roughness = if roughness > 0.0 { roughness.min(1.0) as f32 } else { 0.0 };
            roughness * roughness
        }),
        max_transparent: settings.transparent_bounces,
        max_transparent_shadow: settings.transparent_bounces.saturating_sub(desc.render.fewer_in_shadow),
        pass_alpha_threshold: desc.render.pass_alpha_threshold as f32,
        mist: Mist::of(settings),
        vectors,
        ids: Ids::of(&desc, &geometry.placed),
        bvh: geometry.bvh,
        insides: geometry.insides,
        absorbing: geometry.absorbing,
        shapes: geometry.shapes,
        instances: geometry.instances,
        materials,
        textures,
        asked,
        background_aovs,
    };
    let corner = desc.render.part(whole).map_or([0; 2], |(corner, _)| corner);
    Ok(Prepared { scene, camera: camera_desc.name, whole, corner, times, warnings })
}

impl Scene {
    /// Looks at the same scene through another camera, or at another size: nothing else is prepared again, so that a
    /// dome that [follows the camera](Scene::follows_camera) stays where it was. `render` says what part of a
    /// picture of `whole` pixels is wanted.
    ///
    /// # Errors
    /// A camera or a part that makes no picture; the scene then stays as it was.
    pub fn look(&mut self, camera: &CameraDesc, render: &RenderDesc, whole: [u32; 2]) -> Result<()> {
        let desc = SceneDesc { cameras: vec![camera.clone()], render: render.clone(), ..SceneDesc::default() };
        let view = View { camera: None, size: Some(whole) };
        let (camera, whole) = camera::choose(&desc, &view, &mut Warnings::new())?;
        self.size = cropped(&desc, whole)?;
        // Whether anything else moves was found when the scene was prepared.
        let shutter = Some(camera.shutter).filter(|_| self.effects.motion_blur).and_then(Shutter::between);
        (self.camera, self.camera_motion) = camera::prepare(&camera, render, whole, self.origin, shutter);
        if let Some(background) = &mut self.background_aovs {
            background.surroundings.camera = self.camera;
        }
        if let Some(vectors) = &mut self.vectors {
            vectors.cameras = vectors::cameras(&camera, render, whole, self.origin);
        }
        self.times = Exposure::new(&camera.shutter_curve, camera.rolling_shutter);
        self.exposure = camera::exposure(&camera);
        Ok(())
    }
}

/// True where domes or lamps go by the camera.
fn follows_camera(desc: &SceneDesc) -> bool {
    desc.dome_shaders.iter().any(|dome| graphs::follows_camera(&dome.graph, [dome.radiance]))
        || desc.lamp_shaders.iter().any(|lamp| graphs::follows_camera(&lamp.graph, [lamp.factor]))
}

/// Size of the part of a picture of `whole` that is wanted.
fn cropped(desc: &SceneDesc, whole: [u32; 2]) -> Result<[u32; 2]> {
    let Some((corner, size)) = desc.render.part(whole) else { return Ok(whole) };
    let fits = |axis: usize| {
        let [start, size, whole] = [i64::from(corner[axis]), i64::from(size[axis]), i64::from(whole[axis])];
        start >= 0 && start + size <= whole
    };
    // A border is drawn in the picture, a data window may go beyond it.
    let is_window = desc.render.crop.is_none();
    let [width, height] = size;
    let is_picture = width > 0 && height > 0 && u64::from(width) * u64::from(height) <= camera::MAX_PIXELS;
    if is_picture && (is_window || (fits(0) && fits(1))) {
        return Ok(size);
    }
    let ([left, top], [w, h]) = (corner, whole);
    let why = if is_picture { "is not within" } else { "is no picture: it is part of" };
    let what = format!("the part of {width}x{height} pixels at ({left}, {top}) {why} the picture of {w}x{h}");
    Err(Error::invalid(&desc.place, what))
}

/// One warning for passes that the integrator does not compute.
fn warn_of_passes_left_out(desc: &SceneDesc, settings: &Settings, passes: &PassSet, warnings: &mut Warnings) {
    let is_left_out = |chosen: &Chosen<'_>| chosen.pass.needs.iter().any(|&q| !settings.integrator.computes(q));
    let names: Vec<String> = passes.iter().filter(is_left_out).map(|chosen| chosen.name()).collect();
    if !names.is_empty() {
        let names = names.join(", ");
        let what = format!("--integrator ao computes none of these passes, which stay 0 and shadows 1: {names}");
        warnings.push(&desc.place, what);
    }
}

/// True, with a warning, where motion is blurred: then there is no vector pass, as in Cycles.
fn tell_of_no_vectors(
    desc: &SceneDesc,
    camera: &CameraDesc,
    shutter: Option<Shutter>,
    warnings: &mut Warnings,
) -> bool {
    let blurred = shutter.is_some_and(|shutter| shutter.shows_motion(desc, camera));
    if blurred {
        let what = "the vector pass is of pictures without motion blur, this one stays 0; --motion-blur off renders it";
        warnings.push(&desc.place, what);
    }
    blurred
}

/// Names of the light groups that lamps and emissive objects are in.
fn light_groups(desc: &SceneDesc) -> Vec<Arc<str>> {
    let can_emit = |i: &&InstanceDesc| i.materials.iter().flatten().any(|&m| emits(&desc.materials[m as usize]));
    let of_objects = desc.instances.iter().filter(can_emit).map(|i| &i.links);
    let groups = desc.lights.iter().map(|light| &light.links).chain(of_objects).filter_map(|links| links.group.clone());
    groups.collect::<BTreeSet<_>>().into_iter().collect()
}

/// A point near the camera on a grid as coarse as the scene allows: where everything is near the
/// world's origin it is that origin's neighbour, and it stays put while the camera moves a little.
fn render_space_origin(desc: &SceneDesc, camera: DVec3) -> DVec3 {
    if !camera.is_finite() {
        return DVec3::ZERO;
    }
    let reach = world_bounds(desc).map_or(1.0, |(min, max)| (0.5 * (min + max)).distance(camera).max(1e-9));
    let cell = reach.log2().floor().clamp(-60.0, 60.0).exp2();
    (camera / cell).round() * cell
}

/// True where bad input has taken a light away before it came to be prepared.
fn lost_light(desc: &SceneDesc) -> bool {
    desc.lights_left_out > 0 || desc.materials.iter().any(materials::emission_is_lost)
}

/// Warns where the author's lights have all been left out: another light would be a guess.
fn tell_of_darkness(desc: &SceneDesc, lights: &[Light], materials: &[super::Material], warnings: &mut Warnings) {
    let shines = !lights.is_empty() || materials.iter().any(super::Material::emits);
    // Lamps that are turned down to 0 are meant to be dark.
    let meant = desc.lights.iter().any(|light| light.kind.color() != [0.0; 3]);
    if !shines && (meant || lost_light(desc)) {
        warnings.push(&desc.place, "none of the scene's lights shines: it is rendered in the dark");
    }
}

/// The dome of a scene that was given no light at all.
fn default_dome(desc: &SceneDesc, materials: &[super::Material], warnings: &mut Warnings) -> Option<LightDesc> {
    let lit = desc.lights.iter().any(|light| !light.kind.is_portal())
        || materials.iter().any(super::Material::emits)
        || lost_light(desc);
    if lit {
        return None;
    }
    warnings.push(
        &desc.place,
        "no light in the scene: lit by a constant white dome (radiance 1, not seen by the camera); \
         --environment FILE replaces it",
    );
    let kind = LightKind::Dome { radiance: [1.0; 3], image: None };
    let light = LightDesc::new("default dome", desc.place.clone(), DAffine3::IDENTITY, kind);
    Some(LightDesc { visibility: Visibility { camera: false, ..Visibility::ALL }, ..light })
}
