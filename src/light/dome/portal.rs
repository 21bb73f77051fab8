//! Portals: openings through which a dome's light comes into a closed room. They are sampled evenly in solid angle
//! (see [`super::super::rect`]), each as often as it is large as seen from the point.
//!
//! They guide and never decide: directions beside them keep a density, so that a portal that is in the wrong
//! place costs noise alone.

use smallvec::SmallVec;

use super::super::Receiver;
use super::super::aim::Aim;
use super::super::spread::Spread;
use crate::math::{DMat3, DVec2, DVec3, Vec3};

/// A rectangle through which light comes towards its local −z.
#[derive(Clone, Debug, PartialEq)]
pub struct Portal {
    /// Its middle, render space.
    pub center: DVec3,
    /// Its orthonormal axes in render space.
    pub axes: DMat3,
    /// Half of its size along local x and y, metres, above 0.
    pub half: [f64; 2],
}

/// All portals of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Portals(Vec<Portal>);

/// A portal as seen from a point.
struct Seen<'a> {
    portal: &'a Portal,
    aim: Aim,
    /// Distance of its plane.
    h: f64,
    /// Share of the samples.
    share: f64,
}

/// The portals that light can come through to a point.
pub(super) struct Openings<'a> {
    seen: SmallVec<[Seen<'a>; 4]>,
    /// Their solid angle, or close to it.
    pub solid_angle: f64,
}

impl Portal {
    /// `None` from behind, and from where the surface at `at` turns away from all of it; else with its solid angle.
    fn seen(&self, at: &Receiver) -> Option<Seen<'_>> {
        let to_local = self.axes.transpose();
        let p = to_local * (at.p.as_dvec3() - self.center);
        let h = -p.z;
        if h <= 0.0 {
            return None;
        }
        let center = -DVec2::new(p.x, p.y);
        if let Some(n) = at.n {
            let n = to_local * n.as_dvec3();
            let reach = (n.x * self.half[0]).abs() + (n.y * self.half[1]).abs();
            if n.dot(center.extend(h)) + reach <= 0.0 {
                return None;
            }
        }
        let aim = Aim::rect(center, self.half, h, &Spread::FULL)?;
        let share = match aim {
            Aim::SolidAngle { rect, .. } => rect.solid_angle(),
            _ => {
                let dist_squared = center.length_squared() + h * h;
                4.0 * self.half[0] * self.half[1] * h / (dist_squared * dist_squared.sqrt())
            }
        };
        Some(Seen { portal: self, aim, h, share })
    }
}

impl Portals {
    /// Those of `portals`, which are not empty.
    pub fn new(portals: Vec<Portal>) -> Self {
        Self(portals)
    }

    /// Those through which light can come to `at`.
    pub(super) fn from(&self, at: &Receiver) -> Openings<'_> {
        let mut seen: SmallVec<[Seen<'_>; 4]> = self.0.iter().filter_map(|portal| portal.seen(at)).collect();
        let solid_angle: f64 = seen.iter().map(|seen| seen.share).sum();
        seen.iter_mut().for_each(|seen| seen.share /= solid_angle);
        if !(solid_angle > 0.0 && solid_angle.is_finite()) {
            seen.clear();
        }
        Openings { seen, solid_angle }
    }
}

impl Openings<'_> {
    /// True where no light can come through.
    pub fn are_none(&self) -> bool {
        self.seen.is_empty()
    }

    /// A unit direction through one of them, chosen by `uc`.
    pub fn sample(&self, uc: f32, u: [f32; 2]) -> Option<Vec3> {
        let mut left = f64::from(uc);
        let last = self.seen.len().checked_sub(1)?;
        let chosen = self.seen[..last].iter().find(|seen| {
            left -= seen.share;
            left < 0.0
        });
        let seen = chosen.unwrap_or(&self.seen[last]);
        let (at, _) = seen.aim.sample(u, seen.h);
        Some((seen.portal.axes * at.extend(seen.h).normalize()).as_vec3())
    }

    /// Density in solid angle with which [`Openings::sample`] chooses the unit direction `wi`.
    pub fn pdf(&self, wi: Vec3) -> f32 {
        let of = |seen: &Seen<'_>| {
            let d = seen.portal.axes.transpose() * wi.as_dvec3();
            if d.z <= 0.0 {
                return 0.0;
            }
            seen.share * seen.aim.pdf(DVec2::new(d.x, d.y) * (seen.h / d.z), seen.h)
        };
        self.seen.iter().map(of).sum::<f64>() as f32
    }
}
