//! What a scene can show at all, found once from what was authored and what was asked for.
//!
//! Absent effects build nothing and cast nothing. Every test of these flags stands at a coarse
//! point: per pixel, per hit or per bounce.

use super::shutter::Shutter;
use crate::desc::graph::{Leaf, Op};
use crate::desc::{
    AlphaMode, CameraDesc, Channel, InstanceDesc, LightDesc, LightLinks, MaterialDesc, ScalarInput, SceneDesc,
    ShadowDesc, Visibility,
};
use crate::film::{PassSet, Quantity};
use crate::settings::{EffectsMode, Settings};

/// Effects that a render simulates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effects {
    /// Something moves while the shutter is open.
    pub motion_blur: bool,
    /// Light that arrives at surfaces, but for what the shadow passes of light groups sample.
    pub light: bool,
    /// Light after more than one scattering.
    pub indirect: bool,
    /// What surfaces and the background emit.
    pub radiance: bool,
    /// How surfaces scatter.
    pub scattering: bool,
    /// Some surface lets light pass unscattered: cut-outs and blends.
    pub cutouts: bool,
    /// Some surface is a hole in the picture.
    pub holdouts: bool,
    /// Some object catches shadows.
    pub catchers: bool,
    /// Some graph asks which path a ray is part of.
    pub light_path: bool,
    /// Light that gets into some surface is absorbed there.
    pub absorption: bool,
    /// Baked occlusion maps are applied.
    pub occlusion_maps: bool,
    /// The ao pass.
    pub ao: bool,
    /// The shadow and unshadowed passes.
    pub shadow: bool,
    /// Shadow passes of light groups.
    pub group_shadows: bool,
    /// The irradiance of surfaces without diffuse reflection, for those.
    pub irradiance: bool,
    /// Some light has a shape of its own that rays may meet.
    pub lamps: bool,
    /// Some object emits, or is unlit.
    pub emissive: bool,
    /// What some object emits is shaped by direction.
    pub shaped_emission: bool,
    /// Some light can be found by rays that surfaces have sampled.
    pub found_by_rays: bool,
    /// Some light casts no shadow, not that of every object, or one that is not black or ends.
    pub own_shadows: bool,
    /// The albedo of the first surface.
    pub color: bool,
    /// Data of the first surface that average over samples: normal, uv, vector.
    pub geometry: bool,
    /// What a denoiser is told: normal, albedo and depth of what is seen, in mirrors too.
    pub denoising: bool,
    /// How far what is seen is.
    pub mist: bool,
    /// What surfaces give as AOVs.
    pub aovs: bool,
    /// Passes that take one ray through the pixel's centre.
    pub first_hit: bool,
    /// Cryptomatte.
    pub cryptomatte: bool,
}

impl Effects {
    /// The effects that `scene` as `camera` sees it calls for under `settings`, for `passes` with the scene's light
    /// groups.
    pub fn of(scene: &SceneDesc, camera: &CameraDesc, settings: &Settings, passes: &PassSet) -> Self {
        if settings.effects == EffectsMode::All {
            return Self::forced(passes);
        }
        let used = Self::materials_met(scene);
        let any = |test: &dyn Fn(&MaterialDesc) -> bool| {
            scene.materials.iter().zip(&used).any(|(material, used)| *used && test(material))
        };
        let lamps = scene.lights.iter().any(|light| light.kind.is_shape() && shines(light));
        let (emissive, unlit) = (any(&emits), any(&|m| m.unlit));
        // A scene without lights gets a dome.
        let in_background = scene.lights.iter().all(|light| light.kind.is_portal())
            || scene.lights.iter().any(|light| light.kind.is_in_background() && shines(light));
        let catchers = scene.instances.iter().any(|instance| instance.catcher);
        let forced = Self::forced(passes);
        Self {
            motion_blur: Shutter::of(camera, settings).is_some_and(|shutter| shutter.shows_motion(scene, camera)),
            indirect: forced.indirect && settings.max_bounces > 0,
            cutouts: any(&|m| lets_pass(m) || !is_opaque(scene, m)),
            holdouts: any(&|m| m.holdout) || scene.instances.iter().any(|instance| instance.holdout),
            catchers,
            scattering: catchers || forced.scattering,
            light_path: any(&asks_path),
            absorption: any(&|m| absorbs(scene, m)),
            lamps,
            emissive: emissive || unlit,
            shaped_emission: emissive && scene.instances.iter().any(|instance| instance.shaped.is_some()),
            found_by_rays: lamps || emissive || in_background || unlit,
            own_shadows: scene.lights.iter().any(|light| shines(light) && has_own_shadow(&light.links))
                || (emissive && scene.instances.iter().any(|instance| has_own_shadow(&instance.links))),
            occlusion_maps: settings.occlusion_maps && any(&|m| m.occlusion.is_some_and(|o| o.factor != 0.0)),
            ..forced
        }
    }

    /// Names of those that are there.
    pub fn names(&self) -> Vec<&'static str> {
        let all = [
            ("motion blur", self.motion_blur),
            ("light", self.light),
            ("indirect light", self.indirect),
            ("radiance", self.radiance),
            ("scattering", self.scattering),
            ("cut-outs", self.cutouts),
            ("holdouts", self.holdouts),
            ("shadow catchers", self.catchers),
            ("light path", self.light_path),
            ("absorption", self.absorption),
            ("occlusion maps", self.occlusion_maps),
            ("ao", self.ao),
            ("shadow", self.shadow),
            ("shadow of groups", self.group_shadows),
            ("irradiance", self.irradiance),
            ("lamps", self.lamps),
            ("emissive objects", self.emissive),
            ("shaped emission", self.shaped_emission),
            ("light found by rays", self.found_by_rays),
            ("own shadows", self.own_shadows),
            ("colors", self.color),
            ("normal, uv, vector", self.geometry),
            ("denoising", self.denoising),
            ("mist", self.mist),
            ("aovs", self.aovs),
            ("first hit", self.first_hit),
            ("cryptomatte", self.cryptomatte),
        ];
        all.iter().filter(|(_, on)| *on).map(|(name, _)| *name).collect()
    }

    /// For each material of `scene`, whether rays may meet it or be lit by it.
    pub fn materials_met(scene: &SceneDesc) -> Vec<bool> {
        let mut met = vec![false; scene.materials.len()];
        for instance in scene.instances.iter().filter(|instance| is_met(scene, instance)) {
            for &material in instance.materials.iter().flatten() {
                met[material as usize] = true;
            }
        }
        met
    }

    /// Everything on that the passes can show.
    fn forced(passes: &PassSet) -> Self {
        Self {
            motion_blur: true,
            light: passes.needs_light(),
            indirect: passes.needs_indirect(),
            radiance: passes.needs_light() || passes.needs(Quantity::Emission) || passes.needs(Quantity::Environment),
            scattering: passes.needs_light() || passes.needs_color() || passes.needs(Quantity::GroupUnshadowed),
            cutouts: true,
            holdouts: true,
            catchers: true,
            light_path: true,
            absorption: true,
            occlusion_maps: true,
            ao: passes.needs_ao(),
            shadow: passes.needs_shadow(),
            group_shadows: passes.needs(Quantity::GroupUnshadowed),
            irradiance: passes.needs_irradiance(),
            lamps: true,
            emissive: true,
            shaped_emission: true,
            found_by_rays: true,
            own_shadows: true,
            color: passes.needs_color(),
            geometry: passes.needs(Quantity::Normal) || passes.needs(Quantity::Uv) || passes.needs(Quantity::Vector),
            denoising: passes.needs_denoising(),
            mist: passes.needs(Quantity::Mist),
            aovs: passes.needs_aovs(),
            first_hit: passes.needs_first_hit(),
            cryptomatte: passes.needs_cryptomatte(),
        }
    }
}

/// True for an object that some ray may meet, that catches shadows or gives light.
pub(super) fn is_met(scene: &SceneDesc, instance: &InstanceDesc) -> bool {
    let Visibility { camera, diffuse, glossy, transmission, shadow } = instance.visibility;
    let mut materials = instance.materials.iter().flatten().map(|&m| &scene.materials[m as usize]);
    camera || diffuse || glossy || transmission || shadow || instance.catcher || materials.any(emits)
}

/// True for a light that gives any.
pub(crate) fn shines(light: &LightDesc) -> bool {
    light.kind.color().iter().any(|&c| c != 0.0)
}

/// True for a light whose shadow is not that of every object, black and without end.
pub(crate) fn has_own_shadow(links: &LightLinks) -> bool {
    !links.cast_shadow || links.blockers.is_some() || links.shadow != ShadowDesc::default()
}

pub(super) fn emits(material: &MaterialDesc) -> bool {
    let known = material.emission.graph.and_then(|value| material.graph.known(value));
    !material.unlit
        && material.emission_strength != 0.0
        && material.emission.factor.iter().any(|&c| c != 0.0)
        && known.is_none_or(|[r, g, b, _]| r > 0.0 || g > 0.0 || b > 0.0)
}

/// True where light may pass on top of all that the material does.
fn lets_pass(material: &MaterialDesc) -> bool {
    material.transparency.factor.iter().any(|&c| c > 0.0)
}

/// True where the material's opacity is 1 everywhere.
pub(super) fn is_opaque(scene: &SceneDesc, material: &MaterialDesc) -> bool {
    let alpha = &material.alpha;
    let textured = alpha.texture.is_some_and(|(texture, channel)| {
        if channel != Channel::A {
            return true;
        }
        let image = scene.textures.get(texture.texture as usize).and_then(|t| scene.images.get(t.image as usize));
        image.is_some_and(|image| matches!(image.channels, 2 | 4))
    });
    let known = match alpha.graph {
        Some(value) => material.graph.known(value).map(|value| value[0]),
        None => Some(1.0),
    };
    match known {
        Some(known) if !textured => is_opaque_at(scene, material.alpha_mode, alpha.factor * known),
        _ => material.alpha_mode == AlphaMode::Opaque,
    }
}

/// True where opacity is 1 for an alpha of `alpha` everywhere.
pub(super) fn is_opaque_at(scene: &SceneDesc, mode: AlphaMode, alpha: f64) -> bool {
    match mode {
        AlphaMode::Opaque => true,
        AlphaMode::Mask { cutoff } => alpha >= cutoff && !has_vertex_alpha(scene),
        AlphaMode::Blend => alpha >= 1.0 && !has_vertex_alpha(scene),
    }
}

/// True where what the material does goes by the path that a ray is part of.
fn asks_path(material: &MaterialDesc) -> bool {
    let needed = material.graph.needed(material.graph_values());
    material.graph.ops().iter().zip(needed).any(|(op, needed)| needed && matches!(op, Op::Leaf(Leaf::Path(_))))
}

fn has_vertex_alpha(scene: &SceneDesc) -> bool {
    use crate::desc::Attribute::{Corner, Point};
    let of_meshes = scene.meshes.iter().filter_map(|mesh| mesh.colors.as_ref()).map(|colors| match colors {
        Point(values) | Corner(values) => values,
    });
    let of_rounds = scene.rounds.iter().filter_map(|rounds| rounds.colors.as_ref());
    of_meshes.chain(of_rounds).flatten().any(|c| c[3] < 1.0)
        || scene.instances.iter().filter_map(|instance| instance.color).any(|c| c[3] < 1.0)
}

/// True where some light can be refracted into the material.
fn transmits(material: &MaterialDesc) -> bool {
    scalar_can_be_positive(&material.transmission)
        || material.translucent.is_some()
        || material.parts.iter().any(|part| part.closure.transmits())
}

/// True where light that gets into the material is absorbed there.
fn absorbs(scene: &SceneDesc, material: &MaterialDesc) -> bool {
    (transmits(material) || lets_pass(material) || !is_opaque(scene, material))
        && material.volume.is_some_and(|v| {
            scalar_can_be_positive(&v.thickness)
                && v.attenuation_distance.is_finite()
                && v.attenuation_color.iter().any(|&c| c < 1.0)
        })
}

fn scalar_can_be_positive(input: &ScalarInput) -> bool {
    input.factor > 0.0
}
