//! How light sampling chooses a point of a flat light, decided from the receiver's place alone.

use super::Spread;
use crate::math::{DVec2, DVec3};
use crate::sampling::warp::{self, EllipticCone, SphericalRect};

/// Square of the ratio of half diagonal to distance below which a light is sampled by area. Within it
/// `cos θ / d²` has a standard deviation of at most 1.5% over the light, a relative variance of 2e-4 of
/// one sample, which the cosine at the receiver has as well; a penumbra has 1. Sampling by area takes
/// a quarter of the time and is exact at any distance.
const FAR_SQUARED: f64 = 1.0 / (64.0 * 64.0);

/// Half angles of a spread, radians, above which its footprint is better sampled by solid angle than
/// by the spread's own falloff.
const WIDE: f64 = 1.0;

/// The share of a flat light that is sampled from a point, and how. Positions are relative to the foot
/// of the point in the light's plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Aim {
    /// A rectangle by area: a far one.
    Area {
        /// Range along x.
        x: [f64; 2],
        /// Range along y.
        y: [f64; 2],
    },
    /// A rectangle by solid angle.
    SolidAngle {
        /// Range along x.
        x: [f64; 2],
        /// Range along y.
        y: [f64; 2],
        /// As seen from the point.
        rect: SphericalRect,
    },
    /// An ellipse by area: a far one.
    Ellipse {
        /// Its centre.
        center: DVec2,
        /// Its half axes.
        half: [f64; 2],
    },
    /// An ellipse by solid angle.
    Cone(EllipticCone),
    /// The circle of this radius within which a spread lets the point see, by the spread's falloff.
    Footprint(f64),
}

/// Density of a point on a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Density {
    /// Per steradian.
    SolidAngle(f64),
    /// Per square metre.
    Area(f64),
}

impl Density {
    /// In solid angle, for a point at `at` from the foot in a plane at distance `h`.
    pub fn in_solid_angle(self, at: DVec2, h: f64) -> f64 {
        match self {
            Self::SolidAngle(density) => density,
            Self::Area(density) => {
                let dist_squared = at.length_squared() + h * h;
                density * dist_squared * dist_squared.sqrt() / h
            }
        }
    }
}

/// The part of `range` within `radius` of 0.
fn clip(range: [f64; 2], radius: f64) -> [f64; 2] {
    [range[0].max(-radius), range[1].min(radius)]
}

impl Aim {
    /// At the rectangle with the half sizes `half` about `center`, from the distance `h` of its plane.
    /// `None` where nothing of it is seen.
    pub fn rect(center: DVec2, half: [f64; 2], h: f64, spread: &Spread) -> Option<Self> {
        let (x, y) = ([center.x - half[0], center.x + half[0]], [center.y - half[1], center.y + half[1]]);
        let radius = h * spread.tan();
        let (seen_x, seen_y) = (clip(x, radius), clip(y, radius));
        let whole = [-radius, radius];
        if seen_x == whole && seen_y == whole && spread.half_angle() < WIDE {
            return Some(Self::Footprint(radius));
        }
        Self::window(seen_x, seen_y, h)
    }

    /// At the ellipse with the half axes `half`.
    pub fn ellipse(center: DVec2, half: [f64; 2], h: f64, spread: &Spread) -> Option<Self> {
        let (x, y) = ([center.x - half[0], center.x + half[0]], [center.y - half[1], center.y + half[1]]);
        let radius = h * spread.tan();
        let (seen_x, seen_y) = (clip(x, radius), clip(y, radius));
        if (seen_x, seen_y) != (x, y) {
            let off_center = (center.x / half[0]).hypot(center.y / half[1]);
            if off_center + radius / half[0].min(half[1]) <= 1.0 && spread.half_angle() < WIDE {
                return Some(Self::Footprint(radius));
            }
            return Self::window(seen_x, seen_y, h);
        }
        if half[0].max(half[1]).powi(2) <= FAR_SQUARED * (center.length_squared() + h * h) {
            return Some(Self::Ellipse { center, half });
        }
        EllipticCone::new(center.extend(h), half).map(Self::Cone)
    }

    fn window(x: [f64; 2], y: [f64; 2], h: f64) -> Option<Self> {
        let size = DVec2::new(x[1] - x[0], y[1] - y[0]);
        if size.min_element() <= 0.0 {
            return None;
        }
        let center = 0.5 * DVec2::new(x[0] + x[1], y[0] + y[1]);
        if 0.25 * size.length_squared() <= FAR_SQUARED * (center.length_squared() + h * h) {
            return Some(Self::Area { x, y });
        }
        SphericalRect::new(x, y, h).map(|rect| Self::SolidAngle { x, y, rect })
    }

    /// A point of the plane at distance `h`, and its density.
    pub fn sample(&self, u: [f32; 2], h: f64) -> (DVec2, Density) {
        match self {
            Self::Area { x, y } => {
                let lerp = |[from, to]: [f64; 2], u: f32| from + f64::from(u) * (to - from);
                let at = DVec2::new(lerp(*x, u[0]), lerp(*y, u[1]));
                (at, Density::Area(1.0 / ((x[1] - x[0]) * (y[1] - y[0]))))
            }
            Self::SolidAngle { rect, .. } => {
                (DVec2::from(rect.sample(u)), Density::SolidAngle(1.0 / rect.solid_angle()))
            }
            Self::Ellipse { center, half } => {
                let on_disk = DVec2::from(warp::sample_disk(u).map(f64::from));
                (*center + on_disk * DVec2::from(*half), Density::Area(area_of(*half).recip()))
            }
            Self::Cone(cone) => {
                let (w, density) = cone.sample(u);
                (DVec2::new(w.x, w.y) * (h / w.z), Density::SolidAngle(density))
            }
            Self::Footprint(radius) => {
                // The concentric map spreads areas evenly; its squared radius is uniform.
                let on_disk = DVec2::from(warp::sample_disk(u).map(f64::from));
                let share = Spread::sample_radius(on_disk.length_squared());
                let at = on_disk.normalize_or_zero() * share * *radius;
                (at, Density::Area(Spread::pdf_radius(share) / (radius * radius)))
            }
        }
    }

    /// Density in solid angle with which [`Aim::sample`] chooses the point `at` of the plane at
    /// distance `h`, which is on the light.
    pub fn pdf(&self, at: DVec2, h: f64) -> f64 {
        let inside = |x: &[f64; 2], y: &[f64; 2]| x[0] <= at.x && at.x <= x[1] && y[0] <= at.y && at.y <= y[1];
        let density = match self {
            Self::Area { x, y } if inside(x, y) => Density::Area(1.0 / ((x[1] - x[0]) * (y[1] - y[0]))),
            Self::SolidAngle { x, y, rect } if inside(x, y) => Density::SolidAngle(1.0 / rect.solid_angle()),
            Self::Area { .. } | Self::SolidAngle { .. } => return 0.0,
            Self::Ellipse { half, .. } => Density::Area(area_of(*half).recip()),
            Self::Cone(cone) => Density::SolidAngle(cone.pdf(DVec3::new(at.x, at.y, h))),
            Self::Footprint(radius) => Density::Area(Spread::pdf_radius(at.length() / radius) / (radius * radius)),
        };
        density.in_solid_angle(at, h)
    }
}

/// Of an ellipse by its half axes.
pub(super) fn area_of(half: [f64; 2]) -> f64 {
    std::f64::consts::PI * half[0] * half[1]
}
