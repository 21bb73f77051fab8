//! Where the emitters of a shape stand, and what that makes of their bounds.

use std::sync::Arc;

use super::bounds::Asked;
use super::{LightBounds, LightTree, Profile, Receiver};
use crate::math::{Affine3A, Bounds, DMat3, DVec3, Mat3, MovingTransform, Rgb, Vec3, Vec3A, place_point, traced};

/// A tree over the emitters of a shape, in the shape's space, placed in render space.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    still: Pose,
    /// How it stands in place of that while the shutter is open.
    motion: Option<Arc<MovingTransform>>,
    /// Over all times.
    pub bounds: LightBounds,
    /// How emission varies with direction, without decay; `None` where the emitters alone say it.
    pub profile: Option<Arc<Profile>>,
    /// Irradiance in render space per irradiance in the shape's space: 1 unless the scale is not the same
    /// along all axes.
    importance_scale: f32,
}

/// Where a shape stands at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    pub to_render: Affine3A,
    to_shape: Affine3A,
    /// Carries the normal of a plane to the shape's space.
    plane_to_shape: Mat3,
}

impl Pose {
    /// `None` where `to_render`, whose linear part is `m`, can't be undone.
    fn new(to_render: Affine3A, m: DMat3) -> Option<Self> {
        let inverse = m.inverse();
        let to_shape =
            Affine3A::from_mat3_translation(inverse.as_mat3(), (inverse * -in_f64(to_render.translation)).as_vec3());
        to_shape.is_finite().then(|| Self { to_render, to_shape, plane_to_shape: m.transpose().as_mat3() })
    }

    /// The receiver in the shape's space.
    pub fn asked(&self, at: &Receiver) -> Asked {
        let (p, p_err) = place_point(&self.to_shape, at.p, Vec3::ZERO);
        // In f64, where the plane of a huge or tiny shape stays in range.
        let n = at.n.map(|n| (self.plane_to_shape * n).as_dvec3().normalize_or_zero().as_vec3());
        Asked::new(p, n, p_err)
    }
}

fn in_f64(v: Vec3A) -> DVec3 {
    Vec3::from(v).as_dvec3()
}

fn linear(to_render: &Affine3A) -> DMat3 {
    let m = &to_render.matrix3;
    DMat3::from_cols(in_f64(m.x_axis), in_f64(m.y_axis), in_f64(m.z_axis))
}

impl Placed {
    /// `None` where `to_render` can't be undone.
    pub fn new(tree: &LightTree, to_render: Affine3A) -> Option<Self> {
        let m = linear(&to_render);
        let still = Pose::new(to_render, m)?;
        let bounds = placed_bounds(tree, &to_render, m);
        let uniform = m.determinant().abs().powf(2.0 / 3.0);
        let area = f64::from(bounds.intensity) / f64::from(tree.bounds().intensity);
        Some(Self { still, motion: None, bounds, profile: None, importance_scale: (area / uniform) as f32 })
    }

    /// Where `motion` has it while the shutter is open.
    pub fn set_motion(&mut self, tree: &LightTree, motion: Arc<MovingTransform>) {
        self.bounds = moving_bounds(tree, self.bounds, &motion);
        self.motion = Some(motion);
    }

    /// Where the shape stands at `time`; `moved` holds that of one that moves.
    #[inline(always)]
    pub fn pose<'a>(&'a self, time: f32, moved: &'a mut Option<Pose>) -> &'a Pose {
        match &self.motion {
            None => &self.still,
            Some(motion) => {
                *moved = on_the_way(motion, time);
                moved.as_ref().unwrap_or(&self.still)
            }
        }
    }

    /// Unoccluded irradiance that the emitters of `tree` may bring to `at`.
    pub fn importance(&self, tree: &LightTree, at: &Receiver) -> f32 {
        let importance = tree.weigh(&self.pose(at.time, &mut None).asked(at)).sum * self.importance_scale;
        match &self.profile {
            None => importance,
            Some(profile) if !profile.reaches(self.bounds.bounds, at.p) => 0.0,
            Some(profile) => (importance * profile.peak().max_component()).min(f32::MAX),
        }
    }

    /// The bounds with the profile.
    pub fn shaped_bounds(&self) -> LightBounds {
        self.profile.as_ref().map_or(self.bounds, |profile| profile.bound_shape(self.bounds))
    }

    /// Factor of what leaves an emitter along the unit direction `w`, render space.
    pub fn factor(&self, w: Vec3) -> Rgb {
        self.profile.as_ref().map_or(Rgb::WHITE, |profile| profile.factor(w, 1.0))
    }

    /// Mean of the factor over all directions, luminance.
    pub fn mean_factor(&self) -> f32 {
        self.profile.as_ref().map_or(1.0, |profile| profile.mean().luminance())
    }
}

// Out of line, so that what stands still has no part in it. `None` where it is squeezed flat on its way.
#[cold]
#[inline(never)]
fn on_the_way(motion: &MovingTransform, time: f32) -> Option<Pose> {
    let to_render = traced(&motion.at(time));
    Pose::new(to_render, linear(&to_render))
}

/// The bounds of what moves, of which `at_frame` are those at the frame.
fn moving_bounds(tree: &LightTree, at_frame: LightBounds, motion: &MovingTransform) -> LightBounds {
    let boxes: Vec<Bounds> = tree.boxes().collect();
    let swept = motion.bounds(&boxes);
    // For the rounding of the transform, as `place_point` has it.
    let margin = f32::EPSILON * 8.0 * swept.min.abs().max(swept.max.abs());
    let bounds = Bounds { min: swept.min - margin, max: swept.max + margin };
    // What turns looks everywhere on its way.
    let cos_normals = if motion.is_translation() { at_frame.cos_normals } else { -1.0 };
    LightBounds { bounds, cos_normals, ..at_frame }
}

/// Bounds in render space of a tree placed by `to_render`, whose linear part is `m`.
fn placed_bounds(tree: &LightTree, to_render: &Affine3A, m: DMat3) -> LightBounds {
    let of_mesh = tree.bounds();
    let mut bounds = Bounds::EMPTY;
    for corner in tree.boxes().flat_map(Bounds::corners) {
        let (p, p_err) = place_point(to_render, corner, Vec3::ZERO);
        bounds = bounds.with_point(p - p_err).with_point(p + p_err);
    }
    // Rotation and uniform scale carry a cone as it is. Else normals go by the cofactors N of m. For unit x and y the sine of the angle between Nx and Ny is
    // |N'(x × y)| / (|Nx| |Ny|), N' the cofactors of N: it grows by |N'| / σ² at most, where σ, the
    // smallest factor of any length under N, is |det m| / |m| or more.
    let det = m.determinant().abs();
    let cofactors = m.inverse().transpose() * det;
    let norm = |m: DMat3| m.to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt();
    let scale = det.powf(2.0 / 3.0);
    let similar = norm(m.transpose() * m - DMat3::from_diagonal(DVec3::splat(scale))) < 1e-6 * scale;
    let growth = norm(m).powi(3) / det;
    let cos = f64::from(of_mesh.cos_normals);
    let sin = growth * (1.0 - cos * cos).max(0.0).sqrt();
    let cos = match () {
        () if similar => (cos - 1e-5).max(-1.0),
        () if cos > 0.0 && sin < 0.7 => (1.0 - sin * sin).sqrt() - 1e-6,
        () => -1.0,
    };
    let axis = cofactors * of_mesh.axis.as_dvec3();
    let area = if cos > 0.5 { axis.length() } else { scale };
    let intensity = (f64::from(of_mesh.intensity) * area).clamp(f64::from(f32::MIN_POSITIVE), f64::from(f32::MAX));
    LightBounds {
        bounds,
        axis: axis.normalize_or(DVec3::Z).as_vec3(),
        cos_normals: cos as f32,
        intensity: intensity as f32,
        ..*of_mesh
    }
}
