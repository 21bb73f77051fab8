//! Color spaces by name, as MaterialX and OpenColorIO's configurations write them.

use super::super::images::Space;
use super::expr::{Exprs, Id};
use crate::desc::graph::Function;

/// ACEScg (AP1, white of ACES) to Rec.709 (D65), Bradford adaptation.
/// <https://docs.acescentral.com/specifications/acescg/>
const AP1: [[f64; 3]; 3] = [
    [1.705_050_992_658, -0.621_792_120_657, -0.083_258_872_001],
    [-0.130_256_417_507, 1.140_804_736_575, -0.010_548_319_068],
    [-0.024_003_356_805, -0.128_968_976_065, 1.152_972_332_870],
];

/// ACES2065-1 (AP0) to Rec.709.
const AP0: [[f64; 3]; 3] = [
    [2.521_686_186_744, -1.134_130_988_240, -0.387_555_198_504],
    [-0.276_479_914_230, 1.372_719_087_668, -0.096_239_173_438],
    [-0.015_378_064_966, -0.152_975_335_867, 1.168_353_400_833],
];

/// Display P3 (D65) to Rec.709.
const P3: [[f64; 3]; 3] = [
    [1.224_940_176_280, -0.224_940_176_280, 0.0],
    [-0.042_056_954_709, 1.042_056_954_709, 0.0],
    [-0.019_637_554_590, -0.078_636_045_551, 1.098_273_600_141],
];

/// Rec.2020 (D65) to Rec.709.
const REC2020: [[f64; 3]; 3] = [
    [1.660_491_002_108, -0.587_641_138_788, -0.072_849_863_320],
    [-0.124_550_474_522, 1.132_899_897_126, -0.008_349_422_604],
    [-0.018_150_763_355, -0.100_578_898_008, 1.118_729_661_363],
];

/// How a color space becomes linear Rec.709.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Conversion {
    None,
    Srgb,
    Gamma(f64),
    Primaries([[f64; 3]; 3]),
    SrgbThen([[f64; 3]; 3]),
}

fn conversion(name: &str) -> Option<Conversion> {
    Some(match name.to_ascii_lowercase().as_str() {
        ""
        | "raw"
        | "none"
        | "data"
        | "identity"
        | "unknown"
        | "non-color"
        | "lin_rec709"
        | "lin_srgb"
        | "lin_rec709_scene"
        | "linear"
        | "linear rec.709"
        | "scene_linear"
        | "utility - raw"
        | "utility - linear - srgb" => Conversion::None,
        "srgb" | "srgb_texture" | "srgb_rec709_scene" | "srgb_rec709_display" | "utility - srgb - texture" => {
            Conversion::Srgb
        }
        "g22_rec709" | "gamma22" | "g22_rec709_scene" => Conversion::Gamma(2.2),
        "g18_rec709" | "gamma18" | "g18_rec709_scene" => Conversion::Gamma(1.8),
        "rec709_display" | "g24_rec709" | "gamma24" => Conversion::Gamma(2.4),
        "acescg" | "lin_ap1" | "lin_ap1_scene" | "aces - acescg" => Conversion::Primaries(AP1),
        "aces2065-1" | "lin_ap0" | "lin_ap0_scene" | "aces - aces2065-1" => Conversion::Primaries(AP0),
        "lin_displayp3" | "lin_p3d65" | "lin_p3d65_scene" => Conversion::Primaries(P3),
        "lin_rec2020" | "lin_rec2020_scene" => Conversion::Primaries(REC2020),
        "srgb_displayp3" | "srgb_p3d65_scene" => Conversion::SrgbThen(P3),
        "srgb_ap1_scene" => Conversion::SrgbThen(AP1),
        _ => return None,
    })
}

/// `color` of the named space in linear Rec.709; `None` for a name that isn't known.
pub(super) fn convert(exprs: &mut Exprs, color: Id, space: &str) -> Option<Id> {
    Some(match conversion(space)? {
        Conversion::None => color,
        Conversion::Srgb => exprs.apply(Function::FromSrgb, &[color]),
        Conversion::Gamma(gamma) => exprs.apply(Function::FromGamma(gamma), &[color]),
        Conversion::Primaries(matrix) => exprs.apply(Function::Primaries(Box::new(matrix)), &[color]),
        Conversion::SrgbThen(matrix) => {
            let linear = exprs.apply(Function::FromSrgb, &[color]);
            exprs.apply(Function::Primaries(Box::new(matrix)), &[linear])
        }
    })
}

/// How a file of the named space is decoded, and what is left to convert after that; `None` for a name
/// that isn't known.
pub(super) fn decoding(space: &str) -> Option<(Space, &str)> {
    Some(match conversion(space)? {
        Conversion::None => (Space::Raw, ""),
        Conversion::Srgb => (Space::Srgb, ""),
        Conversion::SrgbThen(P3) => (Space::Srgb, "lin_displayp3"),
        Conversion::SrgbThen(_) => (Space::Srgb, "lin_ap1"),
        Conversion::Gamma(_) | Conversion::Primaries(_) => (Space::Raw, space),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_stays_white() {
        for matrix in [AP1, AP0, P3, REC2020] {
            for row in matrix {
                assert!((row.iter().sum::<f64>() - 1.0).abs() < 1e-6, "{row:?}");
            }
        }
    }

    #[test]
    fn names_are_known() {
        let mut exprs = Exprs::default();
        let half = exprs.number(0.5);
        let linear = convert(&mut exprs, half, "srgb_texture").unwrap();
        assert!((exprs.known(linear).unwrap()[0] - 0.214041).abs() < 1e-6);
        assert_eq!(convert(&mut exprs, half, "lin_rec709"), Some(half));
        assert_eq!(convert(&mut exprs, half, "mine"), None);
        assert_eq!(decoding("ACEScg"), Some((Space::Raw, "ACEScg")));
        assert_eq!(decoding("sRGB"), Some((Space::Srgb, "")));
    }
}
