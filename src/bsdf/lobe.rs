//! The list of lobes, and what each of them answers.

use super::glass::Glass;
use super::lambert::Lambert;
use super::oren_nayar::OrenNayar;
use super::reflection::Reflection;
use super::sheen::SheenLobe;
use super::subsurface::WayIn;
use super::toon::Toon;
use super::translucent::Translucent;
use crate::math::{Rgb, Vec3};

/// A lobe as seen from the direction for which it was made. That `wo` is in the lobe's own frame and above
/// its horizon; `wi` is on either side.
pub(super) trait Scatter {
    /// What it makes of a white surrounding: the part that comes from above, the part from below. An
    /// estimate, and never 0 where there is a value.
    fn albedo(&self) -> Sides;

    /// What color passes hold of it.
    fn color(&self) -> Sides {
        self.albedo()
    }

    /// The value towards `wi`.
    fn eval(&self, wo: Vec3, wi: Vec3) -> Value;

    /// Draws a direction by `u`; `uc` decides between ways to go. `None` where nothing scatters.
    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<Drawn>;

    /// True where `eval` is 0 for all directions.
    fn is_delta(&self) -> bool {
        false
    }

    /// True where light from below passes.
    fn transmits(&self) -> bool {
        false
    }
}

/// A color for each side of the surface.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sides {
    pub above: Rgb,
    pub below: Rgb,
}

impl Sides {
    /// Nothing from below.
    pub fn above(above: Rgb) -> Self {
        Self { above, below: Rgb::BLACK }
    }

    pub fn sum(self) -> Rgb {
        self.above + self.below
    }
}

/// A lobe's value for a pair of directions.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Value {
    /// f |cos θi|.
    pub f_cos: Rgb,
    /// Density with which it draws `wi`, in solid angle.
    pub pdf: f32,
}

/// A direction that a lobe has drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drawn {
    pub wi: Vec3,
    /// Index of refraction on `wi`'s side over that on `wo`'s side.
    pub eta: f32,
    /// For one of zero width its color and the probability that it was drawn.
    pub delta: Option<(Rgb, f32)>,
}

impl Drawn {
    /// A direction that `eval` knows, with the same medium on either side.
    pub fn plain(wi: Vec3) -> Self {
        Self { wi, eta: 1.0, delta: None }
    }
}

macro_rules! lobes {
    ($($lobe:ident($kind:ty)),* $(,)?) => {
        /// One of all lobes.
        #[derive(Clone, Copy, Debug)]
        pub(super) enum AnyLobe {
            $($lobe($kind)),*
        }

        $(impl From<$kind> for AnyLobe {
            fn from(lobe: $kind) -> Self {
                Self::$lobe(lobe)
            }
        })*

        impl Scatter for AnyLobe {
            #[inline]
            fn albedo(&self) -> Sides {
                match self { $(Self::$lobe(lobe) => lobe.albedo()),* }
            }

            #[inline]
            fn color(&self) -> Sides {
                match self { $(Self::$lobe(lobe) => lobe.color()),* }
            }

            #[inline]
            fn eval(&self, wo: Vec3, wi: Vec3) -> Value {
                match self { $(Self::$lobe(lobe) => lobe.eval(wo, wi)),* }
            }

            #[inline]
            fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<Drawn> {
                match self { $(Self::$lobe(lobe) => lobe.sample(wo, uc, u)),* }
            }

            #[inline]
            fn is_delta(&self) -> bool {
                match self { $(Self::$lobe(lobe) => lobe.is_delta()),* }
            }

            #[inline]
            fn transmits(&self) -> bool {
                match self { $(Self::$lobe(lobe) => lobe.transmits()),* }
            }
        }
    };
}

impl AnyLobe {
    /// Width of its microfacets; 0 for a mirror and 1 for what has none.
    pub fn width(&self) -> f32 {
        match self {
            Self::Reflection(lobe) => lobe.width(),
            Self::Glass(lobe) => lobe.width(),
            _ => 1.0,
        }
    }

    /// Makes microfacets at least `least` wide; what they keep of light stays what it is.
    #[cold]
    pub fn widen(&mut self, least: f32) {
        match self {
            Self::Reflection(lobe) => lobe.widen(least),
            Self::Glass(lobe) => lobe.widen(least),
            _ => {}
        }
    }

    /// Of glass, the width of its microfacets.
    #[cold]
    pub fn passage_width(&self) -> Option<f32> {
        match self {
            Self::Glass(lobe) => Some(lobe.width()),
            _ => None,
        }
    }

    /// Of an interface, leaves reflection and passage as `kept` says; false where nothing is left.
    #[cold]
    pub fn keep(&mut self, kept: [bool; 2]) -> bool {
        match self {
            Self::Glass(lobe) => lobe.keep(kept),
            _ => kept[0],
        }
    }
}

lobes! {
    Lambert(Lambert),
    OrenNayar(OrenNayar),
    Translucent(Translucent),
    Toon(Toon),
    Sheen(SheenLobe),
    Reflection(Reflection),
    Glass(Glass),
    WayIn(WayIn),
}
