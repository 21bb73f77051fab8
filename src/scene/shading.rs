//! What scatters at a point: the parts of its material evaluated, in its shading frame.

use super::blur::Blur;
use super::material::{Lookups, Material, NormalInput, Part, ScalarInput};
use super::{Interaction, Scene};
use crate::bsdf::{Bsdf, Builder, Closure, Microfacets, Softening, Stretched};
use crate::desc::AnisotropyLaw;
use crate::desc::graph::Value;
use crate::math::{DVec3, Frame, Rgb, Vec3, sqr};
use crate::shape::Shape;

/// Normals and tangents of a part.
#[derive(Clone, Debug, Default)]
pub struct Bends {
    /// Its normal; `None` for the surface's.
    pub normal: Option<NormalSource>,
    /// The normal of its coat.
    pub coat: Option<NormalSource>,
    /// What its microfacets are stretched along.
    pub anisotropy: Option<Anisotropy>,
}

/// Where a normal comes from.
#[derive(Clone, Copy, Debug)]
pub enum NormalSource {
    /// A tangent-space map.
    Map(NormalInput),
    /// Index of a value of the program for bends, in world space.
    Graph(u8),
}

/// Microfacets that are wider along one direction.
#[derive(Clone, Copy, Debug)]
pub struct Anisotropy {
    /// 0 to 1.
    pub strength: ScalarInput,
    /// Radians counter-clockwise from the tangent.
    pub rotation: ScalarInput,
    /// Direction in red and green, strength in blue: index into the material's inputs.
    pub texture: Option<u8>,
    /// Index of a value of the program for bends, the tangent in world space; `None` for that of the UVs.
    pub tangent: Option<u8>,
    /// What strength means.
    pub law: AnisotropyLaw,
}

impl Scene {
    /// Makes `bsdf` what scatters at `it`, seen from its `wo`, in the shading frame `frame`. `share` is the factor of
    /// all of it, `blur` what its highlights are widened by, or hidden.
    pub fn fill_bsdf(&self, bsdf: &mut Bsdf, it: &Interaction, frame: &Frame, share: f32, blur: Blur) {
        let material = self.material(it);
        let mut builder = self.builder(bsdf, it, frame);
        builder.keep(blur.kept());
        // Strands have no geometric normal but this.
        if material.upright && matches!(self.shape(self.instance(it.instance)), Shape::Mesh(_)) {
            builder.set_upright();
        }
        let widening = self.widening(it, blur, |it| self.shading_frame(it).n);
        let mut values = None;
        let lookups = self.lookups(it, |programs| programs.surface.as_ref(), &mut values);
        for part in &material.parts {
            let evaluate = || part.closure.map(|color| lookups.color(color), |scalar| lookups.scalar(scalar));
            let tint = if matches!(part.closure, Closure::Layered(_)) { self.vertex_color(it) } else { None };
            let mut own;
            let closure = match &part.fixed {
                Some(fixed) if tint.is_none() && part.bends.is_none() => {
                    builder.set_normal(None);
                    fixed
                }
                fixed => {
                    own = match fixed {
                        Some(fixed) => *fixed,
                        None => evaluate(),
                    };
                    if let (Closure::Layered(surface), Some([r, g, b, _])) = (&mut own, tint) {
                        let color = Rgb::new(r, g, b);
                        surface.base_color *= color;
                        if let Some(subsurface) = &mut surface.subsurface {
                            subsurface.color *= color;
                        }
                    }
                    let bent = part.bends.is_some();
                    builder.set_normal(bent.then(|| self.bend(it, frame, part, &lookups, &mut own)).flatten());
                    &own
                }
            };
            builder.set_widening(match part.bends.as_ref().and_then(|bends| bends.normal) {
                Some(source) if blur != Blur::default() => {
                    self.widening(it, blur, |it| self.normal_of_part(it, frame, &source))
                }
                _ => widening,
            });
            builder.add(Rgb::splat(lookups.scalar(&part.weight).max(0.0) * share), closure);
        }
        builder.finish();
    }

    /// For what scatters at `it`, in the shading frame `frame`, to be made in `bsdf`.
    #[inline]
    pub fn builder<'b>(&self, bsdf: &'b mut Bsdf, it: &Interaction, frame: &Frame) -> Builder<'b> {
        let side = if it.front { 1.0 } else { -1.0 };
        let mut builder = Builder::new(bsdf, frame.to_local(it.wo), frame.to_local(it.ng * side), it.front);
        let &Material { bumps, relief, .. } = self.material(it);
        let frequency = self.instance(it.instance).terminator.frequency;
        if relief {
            builder.set_smooth(Vec3::Z);
        } else if it.ns != it.ng {
            builder.set_smooth(frame.to_local(it.ns * side));
        }
        if bumps || frequency > 1.0 {
            builder.soften(Softening { frequency, bumps });
        }
        builder
    }

    /// Turns what has a normal or a tangent of its own; the frame of the whole part, if it has one.
    #[cold]
    fn bend(
        &self,
        it: &Interaction,
        frame: &Frame,
        part: &Part,
        lookups: &Lookups<'_>,
        closure: &mut Closure,
    ) -> Option<Frame> {
        let bends = part.bends.as_ref()?;
        let material = self.material(it);
        let mut values = None;
        let program = material.programs.as_ref().and_then(|programs| programs.bends.as_ref());
        let values = self.run(it, program, &mut values);
        let within = |source: &NormalSource| {
            let n = self.own_normal(it, frame, source, values);
            let along = Frame::from_z_and_tangent(n, frame.s);
            Frame { s: frame.to_local(along.s), t: frame.to_local(along.t), n: frame.to_local(along.n) }
        };
        let normal = bends.normal.as_ref().map(within);
        let coat = bends.coat.as_ref().map(within);
        let stretched = bends.anisotropy.as_ref().and_then(|anisotropy| {
            let roughness = match closure {
                Closure::Layered(surface) => surface.roughness,
                Closure::Glossy { facets, .. } | Closure::Metal { facets, .. } | Closure::Conductor { facets, .. } => {
                    facets.roughness
                }
                _ => return None,
            };
            let around = normal.map_or(Vec3::Z, |normal| normal.n);
            self.stretched(it, frame, around, anisotropy, lookups, values, roughness)
        });
        match closure {
            Closure::Layered(surface) => {
                surface.stretched = stretched;
                if let Some(layer) = &mut surface.coat {
                    layer.frame = coat.or(normal);
                }
            }
            Closure::Glossy { facets, .. } | Closure::Metal { facets, .. } | Closure::Conductor { facets, .. } => {
                *facets = Microfacets { stretched, ..*facets };
            }
            _ => {}
        }
        normal
    }

    /// A part's own normal at a place where nothing else of it is asked for.
    #[cold]
    fn normal_of_part(&self, it: &Interaction, frame: &Frame, source: &NormalSource) -> Vec3 {
        let mut values = None;
        let program = self.material(it).programs.as_ref().and_then(|programs| programs.bends.as_ref());
        self.own_normal(it, frame, source, self.run(it, program, &mut values))
    }

    /// A normal of its own in world space, on the side of `wo`.
    fn own_normal(&self, it: &Interaction, frame: &Frame, source: &NormalSource, values: &[Value]) -> Vec3 {
        let smooth = if it.front { it.ns } else { -it.ns };
        let n = match source {
            NormalSource::Map(map) => {
                let n = self.mapped_normal(it, map);
                if it.front { n } else { -n }
            }
            NormalSource::Graph(value) => values
                .get(usize::from(*value))
                .and_then(|[x, y, z, _]| DVec3::new(*x, *y, *z).as_vec3().try_normalize())
                .unwrap_or(smooth),
        };
        let ng = if it.front { it.ng } else { -it.ng };
        let n = super::interaction::facing(n, ng, it.wo);
        if n.is_finite() { n } else { frame.n }
    }

    fn stretched(
        &self,
        it: &Interaction,
        frame: &Frame,
        around: Vec3,
        anisotropy: &Anisotropy,
        lookups: &Lookups<'_>,
        values: &[Value],
        roughness: f32,
    ) -> Option<Stretched> {
        let mut strength = lookups.scalar(&anisotropy.strength);
        let mut rotation = lookups.scalar(&anisotropy.rotation);
        if let Some(texture) = anisotropy.texture {
            let [r, g, b, _] = lookups.texel(texture);
            rotation += (2.0_f32 * g - 1.0).atan2(2.0 * r - 1.0);
            strength *= b;
        }
        let least = if anisotropy.law == AnisotropyLaw::Glossy { -1.0 } else { 0.0 };
        let strength = strength.clamp(least, 1.0);
        if strength == 0.0 {
            return None;
        }
        let tangent = match anisotropy.tangent {
            Some(value) => {
                let [x, y, z, _] = values.get(usize::from(value)).copied().unwrap_or_default();
                frame.to_local(DVec3::new(x, y, z).as_vec3())
            }
            None => Vec3::X,
        };
        // Counter-clockwise as the texture's axes turn: mirrored ones turn the other way.
        let rotation = if anisotropy.tangent.is_none() { rotation * self.handedness(it) } else { rotation };
        let along = Frame::from_z_and_tangent(around, tangent);
        let (sin, cos) = rotation.sin_cos();
        let frame = Frame { s: along.s * cos + along.t * sin, t: along.t * cos - along.s * sin, n: along.n };
        Some(Stretched { alpha: widths(anisotropy.law, strength, sqr(roughness.clamp(0.0, 1.0))), frame })
    }
}

/// What `law` makes of microfacets of width `alpha`: widths along and across.
fn widths(law: AnisotropyLaw, strength: f32, alpha: f32) -> [f32; 2] {
    match law {
        AnisotropyLaw::Gltf => [alpha + (1.0 - alpha) * sqr(strength), alpha],
        AnisotropyLaw::Aspect => {
            let aspect = (1.0 - 0.9 * strength).sqrt();
            [alpha / aspect, alpha * aspect]
        }
        AnisotropyLaw::Glossy => {
            let narrow = 1.0 - strength.abs().min(0.99);
            if strength > 0.0 { [alpha * narrow, alpha / narrow] } else { [alpha / narrow, alpha * narrow] }
        }
        AnisotropyLaw::RoughnessAnisotropy => {
            let aspect = (1.0 - strength.min(0.98)).sqrt();
            [alpha / aspect, alpha * aspect]
        }
        AnisotropyLaw::OpenPbr => {
            let narrow = 1.0 - strength;
            let along = alpha * (2.0 / (1.0 + sqr(narrow))).sqrt();
            [along, narrow * along]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// MaterialX 1.39: `mx_roughness_anisotropy.glsl`, and the graph of `open_pbr_anisotropy`, which keeps the mean of
    /// the squares; roughness 0.4.
    #[test]
    fn laws_of_materialx() {
        let close = |found: [f32; 2], expected: [f32; 2]| {
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?} {expected:?}");
        };
        close(widths(AnisotropyLaw::RoughnessAnisotropy, 0.5, 0.16), [0.226_274_17, 0.113_137_09]);
        close(widths(AnisotropyLaw::RoughnessAnisotropy, 1.0, 0.16), [1.131_370_9, 0.022_627_417]);
        close(widths(AnisotropyLaw::OpenPbr, 0.5, 0.16), [0.202_385_77, 0.101_192_89]);
        for strength in [0.0, 0.3, 0.9, 1.0] {
            let [along, across] = widths(AnisotropyLaw::OpenPbr, strength, 0.16);
            assert!((0.5 * (sqr(along) + sqr(across)) - sqr(0.16)).abs() < 1e-7);
        }
        for law in [AnisotropyLaw::Aspect, AnisotropyLaw::OpenPbr, AnisotropyLaw::RoughnessAnisotropy] {
            close(widths(law, 0.0, 0.16), [0.16; 2]);
        }
    }
}
