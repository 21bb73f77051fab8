//! The colour spaces of Blender's configuration: those that are a matrix and a plain transfer curve.
//!
//! Matrices are those of the OpenColorIO configuration of Blender 5.0, into linear Rec.709, its scene linear space.

use half::f16;
use rayon::prelude::*;

use crate::desc::{ColorSpace, ImageDesc, PixelData};
use crate::math::srgb_to_linear;

/// By rows, to linear Rec.709.
type Matrix = [[f32; 3]; 3];

const REC709: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const REC2020: Matrix = [
    [1.660_490_9, -0.587_641_2, -0.072_849_92],
    [-0.124_550_4, 1.132_9, -0.008_349_307],
    [-0.018_150_8, -0.100_578_94, 1.118_729_7],
];
const P3_D65: Matrix = [
    [1.224_940_2, -0.224_940_21, 0.0],
    [-0.042_056_93, 1.042_056_9, 0.0],
    [-0.019_637_536, -0.078_636_05, 1.098_273_6],
];
const XYZ_D65: Matrix = [
    [3.240_97, -1.537_383_2, -0.498_610_8],
    [-0.969_243_6, 1.875_967_5, 0.041_555_1],
    [0.055_630_1, -0.203_977, 1.056_971_5],
];
/// Adapted from white E to D65 by Bradford's matrix.
const XYZ_E: Matrix = [
    [3.146_657_6, -1.666_463_8, -0.480_193_94],
    [-0.995_521_57, 1.955_756_7, 0.039_764_92],
    [0.063_594_82, -0.214_563_27, 1.150_968_4],
];
/// Adapted from the white of ACES to D65 by Bradford's matrix, as the next.
const AP0: Matrix = [
    [2.521_686, -1.134_131, -0.387_555_24],
    [-0.276_479_88, 1.372_719, -0.096_239_13],
    [-0.015_378_06, -0.152_975_37, 1.168_353_4],
];
const AP1: Matrix = [
    [1.705_051, -0.621_792_14, -0.083_258_92],
    [-0.130_256_4, 1.140_804_7, -0.010_548_266],
    [-0.024_003_354, -0.128_969, 1.152_972_3],
];
const E_GAMUT: Matrix = [
    [1.907_248_2, -0.692_966_6, -0.214_281_7],
    [-0.162_497_86, 1.376_655_3, -0.214_157_4],
    [-0.127_592_97, -0.235_238_49, 1.362_831_5],
];

/// How stored values become light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curve {
    /// They are it.
    Linear,
    /// IEC 61966-2-1.
    Srgb,
    /// The power 2.4 of BT.1886.
    Power,
}

/// The colour space of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Space {
    /// One that textures are looked up in as they are stored.
    Stored(ColorSpace),
    /// One that is converted when the image is decoded.
    Converted(Curve, &'static Matrix),
}

impl Space {
    /// The space of this name in Blender, today's or that of versions from 2.8 on; `None` for one that is more than a
    /// curve and a matrix, and for a name that is not Blender's.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "" | "sRGB" | "sRGB OETF" => Self::Stored(ColorSpace::Srgb),
            "Non-Color" | "Non-Colour Data" | "Generic Data" | "Raw" | "Linear" | "Linear Rec.709"
            | "Linear BT.709" => Self::Stored(ColorSpace::Linear),
            "Linear Rec.2020" | "Linear BT.2020" => Self::Converted(Curve::Linear, &REC2020),
            "Linear DCI-P3 D65" | "Linear P3-D65" => Self::Converted(Curve::Linear, &P3_D65),
            "Linear CIE-XYZ D65" | "XYZ" => Self::Converted(Curve::Linear, &XYZ_D65),
            "Linear CIE-XYZ E" => Self::Converted(Curve::Linear, &XYZ_E),
            "ACES2065-1" | "Linear ACES" => Self::Converted(Curve::Linear, &AP0),
            "ACEScg" | "Linear ACEScg" => Self::Converted(Curve::Linear, &AP1),
            "Linear FilmLight E-Gamut" => Self::Converted(Curve::Linear, &E_GAMUT),
            "Display P3" => Self::Converted(Curve::Srgb, &P3_D65),
            "Rec.1886" | "BT.1886" => Self::Converted(Curve::Power, &REC709),
            "Rec.2020" | "BT.2020" => Self::Converted(Curve::Power, &REC2020),
            _ => return None,
        })
    }

    /// What an image in this space is read as.
    pub fn stored(self) -> ColorSpace {
        match self {
            Self::Stored(space) => space,
            Self::Converted(..) => ColorSpace::Linear,
        }
    }

    /// The image in linear Rec.709 where its space has to be converted: three channels, or four with alpha. Bytes
    /// become half floats, as in Cycles.
    pub fn applied(self, image: ImageDesc) -> ImageDesc {
        let Self::Converted(curve, matrix) = self else { return image };
        let from = usize::from(image.channels);
        let to = if from.is_multiple_of(2) { 4 } else { 3 };
        let value = |i: usize| {
            let (texel, channel) = (i / to * from, i % to);
            if channel == 3 {
                return image.pixels.get(texel + from - 1);
            }
            let light = |c: usize| curve.decode(image.pixels.get(texel + if from < 3 { 0 } else { c }));
            let row = &matrix[channel];
            row[0] * light(0) + row[1] * light(1) + row[2] * light(2)
        };
        let count = image.width as usize * image.height as usize * to;
        let pixels = match &image.pixels {
            PixelData::U8(_) => PixelData::F16((0..count).into_par_iter().map(|i| f16::from_f32(value(i))).collect()),
            _ => PixelData::F32((0..count).into_par_iter().map(value).collect()),
        };
        ImageDesc { channels: to as u8, color_space: ColorSpace::Linear, pixels, ..image }
    }
}

impl Curve {
    fn decode(self, value: f32) -> f32 {
        match self {
            Self::Linear => value,
            Self::Srgb => srgb_to_linear(value),
            Self::Power => value.max(0.0).powf(2.4),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::Blending;
    use crate::error::Place;

    fn image(channels: u8, bytes: &[u8]) -> ImageDesc {
        ImageDesc {
            name: "a".into(),
            place: Place::default(),
            width: 1,
            height: 1,
            channels,
            color_space: ColorSpace::Linear,
            blending: Blending::default(),
            pixels: PixelData::U8(bytes.to_vec()),
        }
    }

    /// Cycles 5.0: an emitting plane with this pixel in each space, which it holds as half floats (cut, not rounded).
    #[test]
    fn a_pixel_is_what_cycles_makes_of_it() {
        for (name, measured) in [
            ("Linear Rec.2020", [1.372_07, 0.113_342_3, 0.077_575_7]),
            ("Linear DCI-P3 D65", [1.059_57, 0.170_410_2, 0.078_552_2]),
            ("Linear CIE-XYZ D65", [2.564_453, -0.494_628_9, 0.117_126_5]),
            ("Linear CIE-XYZ E", [2.455_078, -0.502_441_4, 0.131_713_9]),
            ("ACES2065-1", [2.007_813, 0.015_312_2, 0.074_646]),
            ("ACEScg", [1.404_297, 0.109_497_1, 0.070_129_4]),
            ("Display P3", [0.961_425_7, 0.001_209_3, -0.006_786_3]),
            ("Rec.1886", [0.780_273_4, 0.020_996_1, 0.004_173_3]),
            ("Rec.2020", [1.283_203, -0.073_425_3, -0.011_604_3]),
            ("Linear FilmLight E-Gamut", [1.559_57, 0.106_811_5, -0.023_101_8]),
        ] {
            let found = Space::named(name).unwrap().applied(image(3, &[230, 51, 26]));
            assert_eq!((found.channels, found.pixels.len()), (3, 3));
            for (c, measured) in measured.into_iter().enumerate() {
                let value = found.pixels.get(c);
                assert!(
                    (value - measured).abs() < 1e-3 * f32::max(measured.abs(), 1.0),
                    "{name} {c}: {value} {measured}"
                );
            }
        }
    }

    #[test]
    fn grey_gets_three_channels_and_alpha_stays() {
        let found = Space::named("Linear CIE-XYZ D65").unwrap().applied(image(2, &[255, 51]));
        assert_eq!(found.channels, 4);
        let found: Vec<f32> = (0..4).map(|c| found.pixels.get(c)).collect();
        // Sums of the matrix' rows.
        for (value, expected) in found.into_iter().zip([1.204_976, 0.948_279, 0.908_625, 0.2]) {
            assert!((value - expected).abs() < 1e-3, "{value} {expected}");
        }
    }

    #[test]
    fn what_is_stored_stays() {
        let before = image(3, &[1, 2, 3]);
        assert_eq!(Space::named("Non-Color").unwrap().applied(before.clone()).pixels, before.pixels);
        assert_eq!(Space::named("sRGB"), Some(Space::Stored(ColorSpace::Srgb)));
        assert_eq!([Space::named("Filmic Log"), Space::named("My Space")], [None; 2]);
    }
}
