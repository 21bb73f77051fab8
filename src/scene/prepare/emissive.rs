//! Emissive shapes as lights.

use std::collections::HashMap;
use std::sync::Arc;

use crate::camera::Camera;
use crate::desc::graph::Value;
use crate::light::{AnyEmitter, Emission, MeshEmitters, MeshLight, RoundEmitters, RoundLight};
use crate::math::{DVec3, Rgb, Vec3};
use crate::scene::asked::Asked;
use crate::scene::material::{Opacity, Programs, Varying, rgb_of, single};
use crate::scene::spot::{Around, Spot};
use crate::scene::{Instance, Interaction, Material};
use crate::shape::Shape;
use crate::texture::graph::{Asks, Program};
use crate::texture::{Texture, TextureRef};

/// Share of the mean of a whole texture that every triangle with it counts for at least: what the few
/// points of its own mean have missed is still found now and then.
const OF_TEXTURE: f32 = 1e-4;

/// What the mean of a texture with any light counts for at least: coarse levels of eight bits lose it.
const LEAST_MEAN: f32 = 1e-3;

/// Emitted radiance of a shape: of a surface that is partly open what its rays get on the mean.
#[derive(Debug)]
struct MaterialEmission {
    shape: Shape,
    textures: Arc<Vec<Texture>>,
    /// By material slot.
    slots: Box<[Slot]>,
    /// Of the instance's colour, where the mesh has none.
    alpha: f32,
    /// Where some slot is a value of a graph.
    owner: Option<Owner>,
}

/// What graphs ask of the one object whose emission this is.
#[derive(Debug)]
struct Owner {
    instance: Instance,
    index: u32,
    asked: Arc<Asked>,
    camera: Camera,
    origin: DVec3,
}

/// What all emissive meshes share.
pub struct Shared<'a> {
    /// All materials.
    pub materials: &'a [Material],
    /// What domes emit that have a graph.
    pub domes: &'a [Program],
    /// What lamps emit that have a graph.
    pub lamps: &'a [Program],
    /// Textures of all of them.
    pub textures: &'a Arc<Vec<Texture>>,
    /// What graphs ask of meshes and objects.
    pub asked: &'a Arc<Asked>,
    /// The camera.
    pub camera: Camera,
    /// World position of render space's origin.
    pub origin: DVec3,
}

/// Emission of a material.
#[derive(Clone, Debug)]
struct Slot {
    factor: Rgb,
    texture: Option<TextureRef>,
    /// Radiance may be below 0.
    unbounded: bool,
    /// Colours of instances stand in for those that shapes lack.
    tinted: bool,
    opacity: Opacity,
    alpha: f32,
    /// Times this channel.
    alpha_texture: Option<(TextureRef, u8)>,
    /// Least mean radiance of a triangle whose emission varies.
    least: Rgb,
    /// The material's graphs, where emission or alpha are values of them.
    programs: Option<Arc<Programs>>,
}

impl Slot {
    fn emission_program(&self) -> Option<&Program> {
        self.programs.as_ref()?.emission.as_ref()
    }

    fn alpha_program(&self) -> Option<&Program> {
        self.programs.as_ref()?.opacity.as_ref()
    }

    /// True where what it emits goes by the path that finds it, which a point on a light does not know:
    /// rays alone find it then.
    fn asks_path(&self) -> bool {
        self.asks(|asks| asks.path)
    }

    /// True where it goes by the direction that it is seen from.
    fn asks_view(&self) -> bool {
        self.asks(|asks| asks.view)
    }

    fn asks(&self, what: fn(Asks) -> bool) -> bool {
        [self.emission_program(), self.alpha_program()].into_iter().flatten().any(|program| what(program.asks()))
    }
}

impl MaterialEmission {
    fn slot(&self, triangle: u32) -> &Slot {
        &self.slots[self.shape.slot(triangle).min(self.slots.len() - 1)]
    }

    /// The texture behind `input`, averaged over `share` of the width of the triangle.
    fn look_up(&self, input: TextureRef, triangle: u32, barycentrics: [f32; 2], share: f32) -> [f32; 4] {
        let Some(uv) = self.shape.uv(input.uv_set, triangle, barycentrics) else { return [1.0; 4] };
        let width = if share > 0.0 { (0.5 * self.shape.uv_size(input.uv_set, triangle)).sqrt() } else { 0.0 };
        input.lookup(&self.textures, uv.to_array(), share * width)
    }

    /// The first value of `program` at a point that is seen from `wo`.
    fn value(&self, program: &Program, triangle: u32, barycentrics: [f32; 2], wo: Vec3, time: f32) -> Option<Value> {
        let Owner { instance, index, asked, camera, origin } = self.owner.as_ref()?;
        let it = Interaction::on(&self.shape, instance, triangle, barycentrics, wo, time);
        let (shape, textures) = (&self.shape, &self.textures);
        let (origin, tinted) = (*origin, self.slot(triangle).tinted);
        let around = Around { shape, instance, index: *index, asked, textures, camera, origin, tinted };
        Some(Spot { around, it: &it }.run(program)[0])
    }

    fn emitted(&self, triangle: u32, barycentrics: [f32; 2], share: f32, wo: Vec3, time: f32) -> Rgb {
        let slot = self.slot(triangle);
        let Slot { factor, texture, .. } = *slot;
        if let Some([r, g, b, _]) =
            slot.emission_program().and_then(|program| self.value(program, triangle, barycentrics, wo, time))
        {
            let radiance = factor * rgb_of([r, g, b]);
            return if slot.unbounded { radiance } else { radiance.map(|c| c.max(0.0)) };
        }
        let Some(input) = texture else { return factor };
        let [r, g, b, _] = self.look_up(input, triangle, barycentrics, share);
        factor * Rgb::new(r, g, b)
    }

    fn alpha(&self, triangle: u32, barycentrics: [f32; 2], share: f32, wo: Vec3, time: f32) -> f32 {
        let slot = self.slot(triangle);
        let Slot { alpha, alpha_texture, .. } = *slot;
        let value = slot.alpha_program().and_then(|program| self.value(program, triangle, barycentrics, wo, time));
        let texel = value.map(|value| single(value[0])).unwrap_or_else(|| {
            alpha_texture.map_or(1.0, |(input, channel)| {
                self.look_up(input, triangle, barycentrics, share)[usize::from(channel)]
            })
        });
        alpha * texel * self.shape.color(triangle, barycentrics).map_or(self.alpha, |color| color[3])
    }

    fn is_constant(&self, triangle: u32) -> bool {
        let slot = self.slot(triangle);
        let Slot { texture, opacity, alpha_texture, .. } = slot;
        if slot.programs.is_some() {
            return false;
        }
        let is_evenly_open = alpha_texture.is_none() && !self.shape.has_colors();
        texture.is_none() && (*opacity == Opacity::Opaque || is_evenly_open)
    }
}

impl Emission for MaterialEmission {
    fn radiance(&self, triangle: u32, uv: [f32; 2]) -> Rgb {
        self.radiance_towards(triangle, uv, self.normal(triangle), 0.0)
    }

    fn radiance_towards(&self, triangle: u32, uv: [f32; 2], wo: Vec3, time: f32) -> Rgb {
        let emitted = self.emitted(triangle, uv, 0.0, wo, time);
        match self.slot(triangle).opacity {
            Opacity::Opaque => emitted,
            opacity => emitted * opacity.of(self.alpha(triangle, uv, 0.0, wo, time)),
        }
    }

    /// The mip level that the triangle's size in UV calls for, and points around it; of a graph the points
    /// alone, seen from both sides. Seen from so far a mask is as open as a blend of its alpha.
    fn mean(&self, triangle: u32) -> Rgb {
        let third = 1.0 / 3.0;
        let slot = self.slot(triangle);
        let &Slot { opacity, least, .. } = slot;
        if self.is_constant(triangle) {
            return self.radiance(triangle, [third, third]).map(f32::abs);
        }
        if slot.asks_path() {
            return Rgb::BLACK;
        }
        if least.is_black() {
            return least;
        }
        // What takes light away counts as much as what gives it.
        let emitted = |uv: [f32; 2], share: f32, wo: Vec3| self.emitted(triangle, uv, share, wo, 0.5).map(f32::abs);
        let seen = |uv: [f32; 2], share: f32, wo: Vec3| match opacity {
            Opacity::Opaque => emitted(uv, share, wo),
            _ => emitted(uv, share, wo) * self.alpha(triangle, uv, share, wo, 0.5).clamp(0.0, 1.0),
        };
        let n = self.normal(triangle);
        let at = |uv: [f32; 2], share: f32| match slot.asks_view() {
            false => seen(uv, share, n),
            true => (seen(uv, share, n) + seen(uv, share, -n)) * 0.5,
        };
        let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5], [0.5, 0.0], [0.0, 0.5]];
        let around: Rgb = points.iter().map(|&uv| at(uv, 0.5)).sum();
        at([third, third], 1.0) * 0.7 + around * (0.3 / points.len() as f32) + least
    }
}

impl MaterialEmission {
    /// Unit normal of a triangle in the render space of its owner, in the middle of the shutter; any direction where there is none to ask.
    fn normal(&self, triangle: u32) -> Vec3 {
        let on = |owner: &Owner| Interaction::on(&self.shape, &owner.instance, triangle, [0.25; 2], Vec3::Z, 0.5).ng;
        self.owner.as_ref().map_or(Vec3::Z, on)
    }
}

/// The emitters of a shape.
#[derive(Clone)]
enum Emitters {
    Mesh(Arc<MeshEmitters>),
    Rounds(Arc<RoundEmitters>),
}

/// The emitters of a shape under a list of materials and the bits of an alpha, and of which object where they
/// are not those of all; `None` where nothing is emitted.
type Known = HashMap<(u32, Box<[u32]>, u32, Option<u32>), Option<Emitters>>;

/// Emissive shapes as lights, one by one: instances of the same shape with the same materials share
/// their emitters.
pub struct Emissive<'a> {
    shared: &'a Shared<'a>,
    known: Known,
}

impl<'a> Emissive<'a> {
    /// For the instances of a scene.
    pub fn new(shared: &'a Shared<'a>) -> Self {
        Self { shared, known: HashMap::new() }
    }

    /// The light that the emissive primitives of `instance`, whose index is `index`, form; `None` where it
    /// has none.
    pub fn light(&mut self, instance: &Instance, index: u32, shape: &Shape) -> Option<AnyEmitter> {
        let Shared { materials, textures, asked, camera, origin, .. } = *self.shared;
        let slots: Box<[Slot]> = instance.materials.iter().map(|&m| slot(&materials[m as usize], textures)).collect();
        // Graphs may ask where the object is.
        let owner = slots.iter().any(|slot| slot.programs.is_some()).then_some(index);
        let alpha = instance.color.map_or(1.0, |color| color[3]);
        let key = (instance.shape, instance.materials.clone(), alpha.to_bits(), owner);
        let emitters = self.known.entry(key).or_insert_with(|| {
            let owner =
                owner.map(|index| Owner { instance: instance.clone(), index, asked: asked.clone(), camera, origin });
            let (shape, textures) = (shape.clone(), textures.clone());
            let emission = Arc::new(MaterialEmission { shape: shape.clone(), textures, slots, alpha, owner });
            match shape {
                Shape::Mesh(mesh) => MeshEmitters::new(mesh, emission).map(|e| Emitters::Mesh(Arc::new(e))),
                Shape::Rounds(rounds) => RoundEmitters::new(rounds, emission).map(|e| Emitters::Rounds(Arc::new(e))),
            }
        });
        let (to_render, motion) = (instance.placement.to_render, instance.motion.clone());
        let profile = instance.profile.clone();
        match emitters.clone()? {
            Emitters::Mesh(emitters) => {
                MeshLight::new(emitters, to_render).map(|light| light.moving(motion).shaped(profile).into())
            }
            Emitters::Rounds(emitters) => {
                RoundLight::new(emitters, to_render).map(|light| light.moving(motion).shaped(profile).into())
            }
        }
    }
}

fn slot(material: &Material, textures: &[Texture]) -> Slot {
    let factor = if material.emits() { material.emission.factor } else { Rgb::BLACK };
    let texture = |varying: Varying| match varying {
        Varying::Texture(i, channel) => Some((material.inputs[usize::from(i)], channel)),
        Varying::No | Varying::Graph(_) => None,
    };
    let (emission, alpha_texture) = (texture(material.emission.varying), texture(material.alpha.varying));
    let whole = emission.map_or(Rgb::WHITE, |(input, _)| mean_of(&textures[input.texture as usize]));
    let asked = |programs: &&Arc<Programs>| programs.emission.is_some() || programs.opacity.is_some();
    Slot {
        factor,
        texture: emission.map(|(input, _)| input),
        unbounded: material.unbounded,
        opacity: material.opacity,
        tinted: material.tinted,
        alpha: material.alpha.factor,
        alpha_texture,
        least: (factor * whole * OF_TEXTURE).map(f32::abs),
        programs: material.programs.as_ref().filter(|_| material.emits()).filter(asked).cloned(),
    }
}

/// Mean of a texture, above 0 unless it is black all over.
fn mean_of(texture: &Texture) -> Rgb {
    let image = texture.image();
    let color = |[r, g, b, _]: [f32; 4]| Rgb::new(r, g, b);
    let mut texels = (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y)));
    if !texels.any(|(x, y)| !color(image.texel(x, y)).is_black()) {
        return Rgb::BLACK;
    }
    color(image.level_texel(image.level_count() - 1, 0, 0)).map(|v| v.max(LEAST_MEAN))
}
