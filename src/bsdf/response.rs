//! What a surface answers, split into the classes of the render passes.

use std::ops::{Add, AddAssign, Mul};

use crate::math::{Rgb, Vec3};

/// The passes' classes of scattering.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Lobe {
    /// Scattering beneath the surface.
    Diffuse,
    /// Reflection at the interface, glass included.
    Glossy,
    /// Passage through the interface.
    Transmission,
}

/// What a denoiser asks of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Features {
    /// Color of what scatters widely.
    pub rough: Rgb,
    /// Color of what all but mirrors.
    pub mirror: Rgb,
    /// Sum of the normals of both, each as long as its lobe is bright; in the surface's frame.
    pub normal: Vec3,
    /// How bright what scatters widely is, and all together.
    pub rough_weight: f32,
    /// See `rough_weight`.
    pub weight: f32,
}

/// A color for each class.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ByLobe {
    /// Share of [`Lobe::Diffuse`].
    pub diffuse: Rgb,
    /// Share of [`Lobe::Glossy`].
    pub glossy: Rgb,
    /// Share of [`Lobe::Transmission`].
    pub transmission: Rgb,
}

impl ByLobe {
    /// Nothing in any class.
    pub const BLACK: Self = Self { diffuse: Rgb::BLACK, glossy: Rgb::BLACK, transmission: Rgb::BLACK };

    /// `color` in one class.
    pub fn only(lobe: Lobe, color: Rgb) -> Self {
        let mut by_lobe = Self::BLACK;
        *by_lobe.get_mut(lobe) = color;
        by_lobe
    }

    /// All classes together.
    pub fn sum(self) -> Rgb {
        self.diffuse + self.glossy + self.transmission
    }

    /// The color of one class.
    pub fn get(&self, lobe: Lobe) -> Rgb {
        match lobe {
            Lobe::Diffuse => self.diffuse,
            Lobe::Glossy => self.glossy,
            Lobe::Transmission => self.transmission,
        }
    }

    /// The color of one class, to change it.
    pub fn get_mut(&mut self, lobe: Lobe) -> &mut Rgb {
        match lobe {
            Lobe::Diffuse => &mut self.diffuse,
            Lobe::Glossy => &mut self.glossy,
            Lobe::Transmission => &mut self.transmission,
        }
    }

    /// `f` of each class's color.
    pub fn map(self, f: impl Fn(Rgb) -> Rgb) -> Self {
        Self { diffuse: f(self.diffuse), glossy: f(self.glossy), transmission: f(self.transmission) }
    }

    /// True where no channel of any class is NaN or infinite.
    pub fn is_finite(&self) -> bool {
        self.diffuse.is_finite() && self.glossy.is_finite() && self.transmission.is_finite()
    }
}

impl Add for ByLobe {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self {
            diffuse: self.diffuse + o.diffuse,
            glossy: self.glossy + o.glossy,
            transmission: self.transmission + o.transmission,
        }
    }
}

impl AddAssign for ByLobe {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl Mul<f32> for ByLobe {
    type Output = Self;
    fn mul(self, s: f32) -> Self {
        self.map(|color| color * s)
    }
}

impl Mul<Rgb> for ByLobe {
    type Output = Self;
    fn mul(self, s: Rgb) -> Self {
        self.map(|color| color * s)
    }
}

/// The value of a BSDF for a pair of directions; lobes of zero width (deltas) don't count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BsdfEval {
    /// f(wo, wi) |cos θi|, sr⁻¹.
    pub f_cos: ByLobe,
    /// Density with which `sample` draws `wi`, in solid angle.
    pub pdf: f32,
}

/// A direction drawn from a BSDF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// The direction, unit, on either side.
    pub wi: Vec3,
    /// f |cos θi| / pdf over the whole mixture of lobes; its mean is the albedo.
    pub weight: ByLobe,
    /// Density of `wi` in solid angle; for a delta lobe the probability with which it was chosen.
    pub pdf: f32,
    /// The class of the lobe that was chosen.
    pub lobe: Lobe,
    /// True for a lobe of zero width: no light sampling can find `wi`.
    pub delta: bool,
    /// Index of refraction on `wi`'s side over that on `wo`'s side; 1 unless a boundary was crossed.
    pub eta: f32,
    /// Index for [`Bsdf::beneath`](super::Bsdf::beneath) where `wi` leads beneath the surface, to a walk that comes out
    /// elsewhere.
    pub beneath: Option<u8>,
}
