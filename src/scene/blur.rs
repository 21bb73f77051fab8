//! Highlights that are made wider than the material says, or left out, where that was asked for.

use super::{Interaction, Scene};
use crate::bsdf::Widening;
use crate::math::Vec3;
use crate::settings::Settings;
use crate::shape::Shape;

/// Variance over a square of what changes evenly by 1 from side to side.
const SQUARE: f32 = 1.0 / 12.0;

/// No variance of normals counts for more: it is known from their change at one place alone. Tokuyoshi and
/// Kaplanyan, *Improved Geometric Specular Antialiasing*, I3D 2019.
const MOST_VARIANCE: f32 = 0.18;

/// How far beyond a primitive its normals are followed, in its own coordinates: farther off, what it says of them is
/// too much more often than not.
const MOST_STEP: f32 = 8.0;

/// What widens the highlights of a surface, and hides them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Blur {
    /// Microfacets are at least so wide.
    least: f32,
    /// Normals are averaged over so many pixels; 0 for none.
    pixels: f32,
    /// Reflections and refractions that are not seen.
    hidden: [bool; 2],
}

impl Blur {
    /// For a surface at the end of a path whose most spread scattering drew its direction with the density
    /// `min_pdf`, infinite as long as there were only mirrors; `from_diffuse` where its last one was diffuse, so that
    /// highlights are caustics.
    pub fn of_path(settings: &Settings, min_pdf: f32, from_diffuse: bool) -> Self {
        if min_pdf == f32::INFINITY {
            return Self { pixels: settings.specular_aa as f32, ..Self::default() };
        }
        let hidden = [settings.caustics_reflective, settings.caustics_refractive].map(|seen| from_diffuse && !seen);
        let filter = settings.filter_glossy as f32;
        // Cycles' Filter Glossy: nothing for directions more likely than its value, up to a width of a half.
        let least = if filter > min_pdf { 0.5 * (1.0 - min_pdf / filter).sqrt() } else { 0.0 };
        Self { least, pixels: 0.0, hidden }
    }

    /// Whether interfaces reflect, and let pass.
    pub(super) fn kept(self) -> [bool; 2] {
        self.hidden.map(|hidden| !hidden)
    }
}

impl Scene {
    /// What `blur` makes of microfacets at `it`, whose normals are as `normal` says.
    pub(super) fn widening(&self, it: &Interaction, blur: Blur, normal: impl Fn(&Interaction) -> Vec3) -> Widening {
        let variance = if blur.pixels > 0.0 { self.normal_variance(it, blur.pixels, normal) } else { 0.0 };
        Widening { variance, least: blur.least }
    }

    /// What normals that change within `pixels` of the picture add to the squares of widths of microfacets:
    /// 2 σ² (|Δn|² + |Δn|²), with the changes from side to side of a square of that size; Tokuyoshi and Kaplanyan,
    /// section 3.
    ///
    /// They are those from `it` on, along the slant of the surface and across, of what maps and graphs make of the
    /// normals at their finest: what varies faster is caught by chance.
    #[cold]
    fn normal_variance(&self, it: &Interaction, pixels: f32, normal: impl Fn(&Interaction) -> Vec3) -> f32 {
        let Some(steps) = self.tangents(it) else { return 0.0 };
        let along =
            (it.wo - it.ng * it.wo.dot(it.ng)).try_normalize().unwrap_or_else(|| it.ng.any_orthonormal_vector());
        let across = it.ng.cross(along);
        let cos = it.wo.dot(it.ng).abs().max(0.05);
        let here = normal(&Interaction { footprint: 0.0, ..*it });
        let change = |direction: Vec3, width: f32| {
            let there = self.moved(it, steps, direction * (pixels * width));
            there.map_or(0.0, |there| (normal(&there) - here).length_squared())
        };
        let change = change(along, it.footprint) + change(across, it.footprint * cos);
        let variance = 2.0 * SQUARE * change;
        if variance.is_finite() { variance.min(MOST_VARIANCE) } else { 0.0 }
    }

    /// How far the point moves with each of its coordinates.
    fn tangents(&self, it: &Interaction) -> Option<[Vec3; 2]> {
        let instance = self.instance(it.instance);
        let shape = self.shape(instance);
        // Triangles are flat, and rounds bend.
        let step = if matches!(shape, Shape::Mesh(_)) { 1.0 } else { 1e-2 };
        let [u, v] = it.at;
        let mut moved = None;
        let placement = instance.placement_at(it.time, &mut moved);
        let to = |at: [f32; 2]| (shape.geometry(it.primitive, at, placement, it.time).p - it.p) / step;
        let steps = [to([u + step, v]), to([u, v + step])];
        steps.iter().all(|step| step.is_finite()).then_some(steps)
    }

    /// The surface at `it` moved by `by` along it, as if its primitive went on beyond its edges; `None` where its
    /// coordinates don't span it.
    fn moved(&self, it: &Interaction, [du, dv]: [Vec3; 2], by: Vec3) -> Option<Interaction> {
        let (a, b, c) = (du.length_squared(), du.dot(dv), dv.length_squared());
        let det = a * c - b * b;
        let (x, y) = (du.dot(by), dv.dot(by));
        // A change is not what a triangle would make of it over many of its like, which turn this way and that.
        let step = |by: f32| (by / det).clamp(-MOST_STEP, MOST_STEP);
        let at = [it.at[0] + step(c * x - b * y), it.at[1] + step(a * y - b * x)];
        if !(at[0].is_finite() && at[1].is_finite()) {
            return None;
        }
        let instance = self.instance(it.instance);
        let there = Interaction::on(self.shape(instance), instance, it.primitive, at, it.wo, it.time);
        // The side that is seen stays the same, whatever an edge hides.
        Some(Interaction { instance: it.instance, front: it.front, path: it.path, ..there })
    }
}
