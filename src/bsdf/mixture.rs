//! A mixture of weighted lobes, seen from one direction.

use smallvec::SmallVec;

use super::ggx::Ggx;
use super::lobe::{AnyLobe, Drawn, Scatter, Sides, Value};
use super::softening::Softening;
use super::surface::ThinFilm;
use super::upright;
use super::{Beneath, BsdfEval, BsdfSample, ByLobe, Closure, Features, Lobe, Surface};
use crate::math::{Frame, ONE_MINUS_EPSILON, Rgb, Vec3};

/// How the sides of a lobe are counted in the passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    /// Diffuse on both sides.
    Diffuse,
    /// Glossy above, transmission below.
    Interface,
}

impl Class {
    fn above(self) -> Lobe {
        match self {
            Self::Diffuse => Lobe::Diffuse,
            Self::Interface => Lobe::Glossy,
        }
    }

    fn below(self) -> Lobe {
        match self {
            Self::Diffuse => Lobe::Diffuse,
            Self::Interface => Lobe::Transmission,
        }
    }
}

/// A lobe and its share.
#[derive(Clone, Copy, Debug)]
struct Term {
    lobe: AnyLobe,
    color: Rgb,
    /// Probability with which it is chosen.
    pick: f32,
    class: Class,
    /// Index of its own frame.
    frame: Option<u8>,
}

/// Index of a lobe's own frame; `None` for that of the surface.
pub(super) type FrameId = Option<u8>;

/// A surface, seen from one direction.
#[derive(Clone, Debug)]
pub struct Bsdf {
    terms: SmallVec<[Term; 4]>,
    /// Frames of lobes with normals or tangents of their own, within the surface's frame, and `wo` in them.
    frames: SmallVec<[(Frame, Vec3); 1]>,
    /// With z ≥ 0.
    wo: Vec3,
    /// The sign of the given z.
    side: f32,
    /// Geometric normal on the side of `wo`.
    ng: Vec3,
    /// The smooth one that it stands for, before maps.
    ns: Vec3,
    /// `None` where the edge of shadows is as the lobes have it.
    softening: Option<Softening>,
}

/// What makes microfacets wider than the material says; nothing by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Widening {
    /// Added to the squares of their widths, as if the material said so: of normals that vary within a pixel.
    pub variance: f32,
    /// They are at least so wide, and keep as much light as they would have without: Cycles' Filter Glossy.
    pub least: f32,
}

/// A [`Bsdf`] in the making, where it will be: it is too large to be handed over.
#[derive(Debug)]
pub struct Builder<'b> {
    bsdf: &'b mut Bsdf,
    entering: bool,
    /// Frame of what is added next, where it names none.
    base: FrameId,
    widening: Widening,
    /// Whether interfaces reflect, and let pass.
    kept: [bool; 2],
    /// Whether interfaces lean so that they mirror what is above the geometry.
    upright: bool,
}

impl<'b> Builder<'b> {
    /// For a view from `wo` of a surface with geometric normal `ng` on the side of `wo`, both in the
    /// surface's frame. `entering` is true where `wo` is on the outside, the side to which the geometric
    /// normal points; it has no meaning for thin surfaces. What `bsdf` was before is forgotten.
    #[inline]
    pub fn new(bsdf: &'b mut Bsdf, wo: Vec3, ng: Vec3, entering: bool) -> Self {
        let side = if wo.z < 0.0 { -1.0 } else { 1.0 };
        bsdf.terms.clear();
        bsdf.frames.clear();
        bsdf.wo = Vec3::new(wo.x, wo.y, wo.z.abs());
        bsdf.ng = Vec3::new(ng.x, ng.y, ng.z * side);
        (bsdf.ns, bsdf.side, bsdf.softening) = (bsdf.ng, side, None);
        Self { bsdf, entering, base: None, widening: Widening::default(), kept: [true; 2], upright: false }
    }

    /// The geometry stands for a smooth surface of normal `ns`, on the side of `wo`: what is lit and what is not goes by
    /// that, but no direction is drawn through the geometry.
    pub fn set_smooth(&mut self, ns: Vec3) {
        self.bsdf.ns = Vec3::new(ns.x, ns.y, ns.z * self.bsdf.side);
    }

    /// How the edges of shadows are softened.
    pub fn soften(&mut self, softening: Softening) {
        self.bsdf.softening = Some(softening);
    }

    pub(super) fn entering(&self) -> bool {
        self.entering
    }

    /// The microfacets of what is added from now on are made wider.
    pub fn set_widening(&mut self, widening: Widening) {
        self.widening = widening;
    }

    /// What is added from now on reflects and refracts as `kept` says; diffuse light is as ever.
    pub fn keep(&mut self, kept: [bool; 2]) {
        self.kept = kept;
    }

    /// Interfaces that are added from now on lean towards the geometry where they would mirror what is below it.
    pub fn set_upright(&mut self) {
        self.upright = true;
    }

    /// `frame`, or one that leans from it; see [`Self::set_upright`].
    pub(super) fn upright(&mut self, frame: FrameId) -> FrameId {
        if !self.upright {
            return frame;
        }
        let own = Frame { s: Vec3::X, t: Vec3::Y, n: Vec3::Z };
        let given = frame.or(self.base).map_or(own, |frame| self.bsdf.frames[usize::from(frame)].0);
        match upright::raised(given.n, self.bsdf.ng, self.bsdf.wo) {
            Some(n) => self.frame(Some(Frame::from_z_and_tangent(n, given.s))).or(frame),
            None => frame,
        }
    }

    /// Microfacets of these widths, which count up to 1, made wider by normals that vary; `None` for a mirror.
    pub(super) fn ggx(&self, widths: [f32; 2]) -> Option<Ggx> {
        let Widening { variance, .. } = self.widening;
        let wider = |alpha: f32| if variance > 0.0 { (alpha * alpha + variance).sqrt() } else { alpha };
        Ggx::new(widths.map(|alpha| wider(alpha).min(1.0)))
    }

    /// What is added from now on has the normal of `frame`, given within the surface's own; with `None` that of
    /// the surface.
    pub fn set_normal(&mut self, frame: Option<Frame>) {
        self.base = self.frame(frame);
    }

    /// `wo` in a lobe's frame.
    pub(super) fn wo(&self, frame: FrameId) -> Vec3 {
        frame.or(self.base).map_or(self.bsdf.wo, |frame| self.bsdf.frames[usize::from(frame)].1)
    }

    /// Keeps a frame for lobes to name. One from which `wo` is seen below the horizon is not kept.
    pub(super) fn frame(&mut self, frame: Option<Frame>) -> FrameId {
        let frame = frame?;
        let wo = frame.to_local(self.bsdf.wo);
        let index = self.bsdf.frames.len();
        if wo.z <= 0.0 || index > usize::from(u8::MAX) {
            return None;
        }
        self.bsdf.frames.push((frame, wo));
        Some(index as u8)
    }

    /// Film as seen from the camera's side: relative to the medium there.
    pub(super) fn film_seen(&self, film: &Option<ThinFilm>, ior: f32) -> Option<ThinFilm> {
        film.map(|film| ThinFilm { ior: if self.entering { film.ior } else { film.ior / ior }, ..film })
    }

    /// Adds a lobe times `color`.
    #[inline]
    pub(super) fn push(&mut self, color: Rgb, class: Class, frame: FrameId, lobe: impl Into<AnyLobe>) {
        let color = color.map(|c| c.max(0.0));
        if color.max_component() > 0.0 {
            let mut lobe: AnyLobe = lobe.into();
            if self.widening.least > 0.0 {
                lobe.widen(self.widening.least);
            }
            if self.kept != [true; 2] && class == Class::Interface && !lobe.keep(self.kept) {
                return;
            }
            self.bsdf.terms.push(Term { lobe, color, pick: 0.0, class, frame: frame.or(self.base) });
        }
    }

    /// Nothing is added any more: lobes are chosen in proportion to their albedos.
    #[inline]
    pub fn finish(self) {
        let mut total = 0.0;
        for term in &mut self.bsdf.terms {
            term.pick = (term.color * term.lobe.albedo().sum()).mean();
            total += term.pick;
        }
        let scale = if total > 0.0 { 1.0 / total } else { 0.0 };
        for term in &mut self.bsdf.terms {
            term.pick *= scale;
        }
    }
}

impl Bsdf {
    /// What scatters nothing.
    #[inline]
    pub fn none() -> Self {
        let (wo, ng) = (Vec3::Z, Vec3::Z);
        Self { terms: SmallVec::new(), frames: SmallVec::new(), wo, side: 1.0, ng, ns: ng, softening: None }
    }

    /// One layered surface, seen from `wo`; see [`Builder::new`].
    pub fn new(surface: &Surface, wo: Vec3, entering: bool) -> Self {
        let mut bsdf = Self::none();
        let mut builder = Builder::new(&mut bsdf, wo, if wo.z < 0.0 { -Vec3::Z } else { Vec3::Z }, entering);
        builder.add(Rgb::WHITE, &Closure::Layered(*surface));
        builder.finish();
        bsdf
    }

    /// The directional albedo per class.
    pub fn albedo(&self) -> ByLobe {
        self.sum(Scatter::albedo)
    }

    /// What the color passes hold: the albedo, but of a rough diffuse surface its color, as Cycles has it.
    pub fn color(&self) -> ByLobe {
        self.sum(Scatter::color)
    }

    fn sum(&self, of: impl Fn(&AnyLobe) -> Sides) -> ByLobe {
        let mut sum = ByLobe::BLACK;
        for term in &self.terms {
            let sides = of(&term.lobe);
            *sum.get_mut(term.class.above()) += term.color * sides.above;
            *sum.get_mut(term.class.below()) += term.color * sides.below;
        }
        sum
    }

    /// What a denoiser asks, where microfacets narrower than `mirror` are mirrors.
    pub fn features(&self, mirror: f32) -> Features {
        let mut features = Features::default();
        for term in &self.terms {
            let color = term.color * term.lobe.color().sum();
            let n = term.frame.map_or(Vec3::Z, |frame| self.frames[usize::from(frame)].0.n);
            let weight = color.mean();
            features.normal += Vec3::new(n.x, n.y, n.z * self.side) * weight;
            features.weight += weight;
            if term.lobe.width() > mirror {
                features.rough += color;
                features.rough_weight += weight;
            } else {
                features.mirror += color;
            }
        }
        features
    }

    /// True where `eval` is 0 for all directions: asking lights is of no use.
    pub fn is_delta_only(&self) -> bool {
        self.terms.iter().all(|term| term.lobe.is_delta())
    }

    /// True where light can come from the other side of the surface.
    pub fn transmits(&self) -> bool {
        self.terms.iter().any(|term| term.lobe.transmits())
    }

    /// Width of the widest microfacets that let light pass: the root of the product of both widths, 0 for perfect glass.
    #[cold]
    pub fn passage_width(&self) -> f32 {
        self.terms.iter().filter_map(|term| term.lobe.passage_width()).fold(0.0, f32::max)
    }

    /// True where some channel is not scattered diffusely.
    pub fn lacks_diffuse(&self) -> bool {
        let diffuse: Rgb = self.terms.iter().filter(|t| t.class == Class::Diffuse).map(|t| t.color).sum();
        diffuse.r == 0.0 || diffuse.g == 0.0 || diffuse.b == 0.0
    }

    /// The value towards `wi`.
    pub fn eval(&self, wi: Vec3) -> BsdfEval {
        self.value(self.turned(wi))
    }

    fn value(&self, wi: Vec3) -> BsdfEval {
        let above = wi.dot(self.ns) > 0.0;
        let mut sum = BsdfEval::default();
        for term in &self.terms {
            let (wo, wi) = match term.frame {
                None => (self.wo, wi),
                Some(frame) => self.within(frame, wi),
            };
            // Where a map's normal and the smooth one disagree on the side, light would leak through the surface, or
            // a reflection go into it.
            if (wi.z > 0.0) != above || wi.z == 0.0 {
                continue;
            }
            let Value { mut f_cos, pdf } = term.lobe.eval(wo, wi);
            if let Some(softening) = &self.softening {
                f_cos *= self.softened(softening, term, wi);
            }
            let class = if above { term.class.above() } else { term.class.below() };
            *sum.f_cos.get_mut(class) += term.color * f_cos;
            sum.pdf += term.pick * pdf;
        }
        if above != (wi.dot(self.ng) > 0.0) {
            // Lit around the triangle that is there: `sample` never goes that way.
            sum.pdf = 0.0;
        }
        sum
    }

    /// What is left of a lobe's value towards `wi`, in its own frame.
    #[cold]
    fn softened(&self, softening: &Softening, term: &Term, wi: Vec3) -> f32 {
        let ns = term.frame.map_or(self.ns, |frame| self.frames[usize::from(frame)].0.to_local(self.ns));
        softening.at_edge(wi.z) * if term.class == Class::Diffuse { softening.of_bumps(ns, wi) } else { 1.0 }
    }

    /// Draws a direction: `uc` chooses the lobe, `u` the direction. `None` where nothing scatters.
    pub fn sample(&self, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        let mut rest = uc;
        let mut chosen = self.terms.iter().enumerate().filter(|(_, term)| term.pick > 0.0);
        let (mut index, mut term) = chosen.next()?;
        while rest >= term.pick {
            // Rounding may leave a little beyond the last.
            let Some(next) = chosen.next() else {
                rest = term.pick * ONE_MINUS_EPSILON;
                break;
            };
            rest -= term.pick;
            (index, term) = next;
        }
        let uc = (rest / term.pick).min(ONE_MINUS_EPSILON);
        let wo = term.frame.map_or(self.wo, |frame| self.frames[usize::from(frame)].1);
        let Drawn { wi: local, eta, delta } = term.lobe.sample(wo, uc, u)?;
        let wi = term.frame.map_or(local, |frame| self.frames[usize::from(frame)].0.to_world(local));
        let above = local.z > 0.0;
        if above != (wi.dot(self.ng) > 0.0) {
            return None;
        }
        let lobe = if above { term.class.above() } else { term.class.below() };
        if let Some((color, p)) = delta {
            let pdf = term.pick * p;
            let weight = ByLobe::only(lobe, term.color * color * (1.0 / pdf));
            let beneath = matches!(term.lobe, AnyLobe::WayIn(_)).then_some(index as u8);
            return (pdf > 0.0).then(|| BsdfSample {
                wi: self.turned(wi),
                weight,
                pdf,
                lobe,
                delta: true,
                eta,
                beneath,
            });
        }
        let BsdfEval { f_cos, pdf } = self.value(wi);
        let wi = self.turned(wi);
        (pdf > 0.0).then(|| BsdfSample { wi, weight: f_cos * (1.0 / pdf), pdf, lobe, delta: false, eta, beneath: None })
    }

    /// What a sampled direction that leads beneath the surface leads into; see [`BsdfSample::beneath`].
    pub fn beneath(&self, beneath: u8) -> Option<Beneath> {
        match self.terms.get(usize::from(beneath))?.lobe {
            AnyLobe::WayIn(way_in) => Some(way_in.beneath()),
            _ => None,
        }
    }

    fn within(&self, frame: u8, wi: Vec3) -> (Vec3, Vec3) {
        let (frame, wo) = &self.frames[usize::from(frame)];
        (*wo, frame.to_local(wi))
    }

    /// Between the caller's hemisphere and that in which `wo` is above; its own inverse.
    fn turned(&self, w: Vec3) -> Vec3 {
        Vec3::new(w.x, w.y, w.z * self.side)
    }
}
