//! Functions of values, and what they compute.
//!
//! Doors fold constants with them and the engine evaluates them at hits: one definition, in `f64`, so that
//! folding never changes a picture. Their meaning is that of Blender 5.0's nodes (Cycles) or of MaterialX
//! 1.39's standard library where no other source is named.

mod blend;
mod color;
mod ies;
mod map;
mod math;
mod range;
mod spectrum;
mod surface;
mod vector;

use std::sync::Arc;

pub use blend::Blend;
pub use ies::IesTable;
pub use map::Mapping;
pub use math::Math;
pub use range::{Curves, Ramp, RampKind, Range, Table};

use super::{Value, finite};

/// A function; its documentation names the arguments. Missing ones are 0. Functions work place by place
/// unless they say otherwise.
#[derive(Clone, Debug, PartialEq)]
pub enum Function {
    /// Arithmetic, place by place.
    Math(Math),
    /// low, high of two values a and b: a, b, then what holds and what does not. The choice is made by the
    /// first places.
    IfGreater,
    /// The same with `a ≥ b`.
    IfGreaterOrEqual,
    /// The same with `a = b`.
    IfEqual,
    /// a, b: the sum of the products of the first so many places, a number.
    Dot(u8),
    /// a: root of the sum of squares of the first so many places, a number.
    Length(u8),
    /// a: divided by that; 0 stays 0.
    Normalize(u8),
    /// a, b: the vector product.
    Cross,
    /// a, b: the part of vector a along b.
    Project,
    /// a, normal: vector a mirrored by the plane.
    Reflect,
    /// a, normal, eta: vector a refracted, 0 for total reflection.
    Refract,
    /// a, incident, reference: a where incident and reference are opposed, else −a.
    FaceForward,
    /// a, b: distance of two points, a number.
    Distance,
    /// Which place each place comes from.
    Swizzle([u8; 4]),
    /// x, y, z, w: the first place of each; w is 1 where it is missing.
    Combine,
    /// a: rows of a 3×4 matrix times `(x, y, z, 1)`; the fourth place stays.
    Affine(Box<[[f64; 4]; 3]>),
    /// vector, location, rotation (Euler XYZ, radians), scale.
    Mapping(Mapping),
    /// vector, center, axis, angle.
    RotateAxis,
    /// vector, center, rotation (Euler XYZ, radians).
    RotateEuler {
        /// Back instead.
        invert: bool,
    },
    /// vector: coordinates on a sphere about the origin, u and v (upwards) 0 to 1.
    SphereMap,
    /// vector: coordinates on a tube around z.
    TubeMap,
    /// direction (z up): coordinates in a lat-long picture, v upwards.
    Equirectangular,
    /// direction (z up): coordinates in a picture of a mirror ball, v upwards.
    MirrorBall,
    /// normal: the weights of three projections along x, y and z, which blend over this share (0 to 1).
    BoxWeights(f64),
    /// value, from min, from max, to min, to max, steps.
    MapRange {
        /// How it goes from one end to the other.
        range: Range,
        /// True where the result stays between the ends.
        clamp: bool,
        /// True for what an empty range maps to: `to min` for vectors, 0 for numbers.
        vector: bool,
    },
    /// factor, a, b. Alpha is that of a, but for plain mixes of all four places.
    Mix {
        /// How the two are put together.
        blend: Blend,
        /// True where the factor stays within 0 to 1.
        clamp_factor: bool,
        /// True where the result does.
        clamp_result: bool,
    },
    /// position: a color at the first place.
    Ramp(Arc<Ramp>),
    /// position: a row of a table at the first place.
    Table(Arc<Table>),
    /// a: each place looked up in its own column; alpha stays.
    Curves(Arc<Table>),
    /// direction (−z is the axis): a measured distribution, a number.
    Ies(Arc<IesTable>),
    /// Hue, saturation, value (all 0 to 1) to red, green, blue.
    HsvToRgb,
    /// And back.
    RgbToHsv,
    /// Hue, saturation, lightness to red, green, blue.
    HslToRgb,
    /// And back.
    RgbToHsl,
    /// hue, saturation, value, factor, color: Blender's node.
    HueSaturationValue,
    /// color, brightness, contrast: Blender's node.
    BrightContrast,
    /// color, gamma.
    Gamma,
    /// factor, color: `1 − color` where the factor is 1.
    Invert,
    /// Kelvin, 800 to 12000: color of a black body of luminance 1.
    Blackbody,
    /// Nanometres: color of light of one wavelength.
    Wavelength,
    /// sRGB's curve to linear; alpha stays.
    FromSrgb,
    /// This power; alpha stays.
    FromGamma(f64),
    /// Colors by another three: rows of a matrix; alpha stays.
    Primaries(Box<[[f64; 3]; 3]>),
    /// ior, normal, incoming, backfacing: reflectance of a dielectric, a number.
    Fresnel,
    /// blend, normal, incoming, backfacing: the same of the index that blend stands for.
    LayerFresnel,
    /// blend, normal, incoming: 0 where the surface faces whoever looks, 1 at its edge.
    LayerFacing,
    /// color, strength, normal, tangent with sign: the normal of a tangent-space map (0 to 1), all in one
    /// space; unit. Without a tangent it is the normal.
    NormalMap,
    /// color, strength, mapped normal, normal: where a map of world or object space has no direction, or
    /// the strength is less than 1.
    NormalStrength,
}

impl Function {
    /// The value for `args`, finite whatever they are.
    pub fn eval(&self, args: &[Value]) -> Value {
        let arg = |i: usize| args.get(i).copied().unwrap_or_default();
        finite(self.value(args, arg))
    }

    fn value(&self, args: &[Value], arg: impl Fn(usize) -> Value) -> Value {
        let (a, b, c) = (arg(0), arg(1), arg(2));
        let choose = |yes: bool| if yes { c } else { arg(3) };
        match self {
            Self::Math(math) => math.eval(a, b, c),
            Self::IfGreater => choose(a[0] > b[0]),
            Self::IfGreaterOrEqual => choose(a[0] >= b[0]),
            Self::IfEqual => choose(a[0] == b[0]),
            Self::Dot(n) => [vector::dot(a, b, *n); 4],
            Self::Length(n) => [vector::dot(a, a, *n).sqrt(); 4],
            Self::Normalize(n) => vector::normalize(a, *n),
            Self::Cross => vector::cross(a, b),
            Self::Project => vector::project(a, b),
            Self::Reflect => vector::reflect(a, vector::normalize(b, 3)),
            Self::Refract => vector::refract(a, vector::normalize(b, 3), c[0]),
            Self::FaceForward => vector::face_forward(a, b, c),
            Self::Distance => [vector::length(vector::sub(a, b)); 4],
            Self::Swizzle(places) => places.map(|place| a[usize::from(place.min(3))]),
            Self::Combine => [a[0], b[0], c[0], args.get(3).map_or(1.0, |d| d[0])],
            Self::Affine(rows) => vector::affine(rows, a),
            Self::Mapping(mapping) => mapping.eval(a, b, c, arg(3)),
            Self::RotateAxis => map::rotate_axis(a, b, c, arg(3)[0]),
            Self::RotateEuler { invert } => map::rotate_euler(a, b, c, *invert),
            Self::SphereMap => map::sphere(a),
            Self::TubeMap => map::tube(a),
            Self::Equirectangular => map::equirectangular(a),
            Self::MirrorBall => map::mirror_ball(a),
            Self::BoxWeights(blend) => map::box_weights(a, *blend),
            Self::MapRange { range, clamp, vector } => range.eval(a, [b, c], [arg(3), arg(4)], arg(5), *clamp, *vector),
            Self::Mix { blend, clamp_factor, clamp_result } => {
                let factor = if *clamp_factor { a.map(|x| x.clamp(0.0, 1.0)) } else { a };
                let mixed = blend.eval(factor, b, c);
                if *clamp_result { mixed.map(|x| x.clamp(0.0, 1.0)) } else { mixed }
            }
            Self::Ramp(ramp) => ramp.at(a[0]),
            Self::Table(table) => table.row(a[0]),
            Self::Curves(table) => table.columns(a),
            Self::Ies(table) => [table.at(a); 4],
            Self::HsvToRgb => color::hsv_to_rgb(a),
            Self::RgbToHsv => color::rgb_to_hsv(a),
            Self::HslToRgb => color::hsl_to_rgb(a),
            Self::RgbToHsl => color::rgb_to_hsl(a),
            Self::HueSaturationValue => color::adjust([a[0], b[0], c[0]], arg(3)[0], arg(4)),
            Self::BrightContrast => color::bright_contrast(a, b[0], c[0]),
            Self::Gamma => color::gamma(a, b[0]),
            Self::Invert => color::invert(a[0], b),
            Self::Blackbody => spectrum::blackbody(a[0]),
            Self::Wavelength => spectrum::wavelength(a[0]),
            Self::FromSrgb => color::per_channel(a, color::from_srgb),
            Self::FromGamma(gamma) => color::per_channel(a, |x| x.max(0.0).powf(*gamma)),
            Self::Primaries(rows) => color::primaries(rows, a),
            Self::Fresnel => [surface::fresnel(a[0], b, c, arg(3)[0]); 4],
            Self::LayerFresnel => [surface::layer_fresnel(a[0], b, c, arg(3)[0]); 4],
            Self::LayerFacing => [surface::layer_facing(a[0], b, c); 4],
            Self::NormalMap => surface::normal_map(a, b[0], c, arg(3)),
            Self::NormalStrength => surface::normal_strength(a[0], b, c),
        }
    }
}
