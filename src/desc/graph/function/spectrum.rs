//! Colors of spectra.

use std::sync::LazyLock;

use super::Value;

/// x̄, ȳ and z̄ every 5 nm from 380 to 780 nm: *CIE 1931 Standard Colorimetric Observer* (CIE 15).
#[rustfmt::skip]
const OBSERVER: [[f64; 3]; 81] = [
    [0.0014, 0.0, 0.0065], [0.0022, 0.0001, 0.0105], [0.0042, 0.0001, 0.0201], [0.0076, 0.0002, 0.0362],
    [0.0143, 0.0004, 0.0679], [0.0232, 0.0006, 0.1102], [0.0435, 0.0012, 0.2074], [0.0776, 0.0022, 0.3713],
    [0.1344, 0.004, 0.6456], [0.2148, 0.0073, 1.0391], [0.2839, 0.0116, 1.3856], [0.3285, 0.0168, 1.623],
    [0.3483, 0.023, 1.7471], [0.3481, 0.0298, 1.7826], [0.3362, 0.038, 1.7721], [0.3187, 0.048, 1.7441],
    [0.2908, 0.06, 1.6692], [0.2511, 0.0739, 1.5281], [0.1954, 0.091, 1.2876], [0.1421, 0.1126, 1.0419],
    [0.0956, 0.139, 0.813], [0.058, 0.1693, 0.6162], [0.032, 0.208, 0.4652], [0.0147, 0.2586, 0.3533],
    [0.0049, 0.323, 0.272], [0.0024, 0.4073, 0.2123], [0.0093, 0.503, 0.1582], [0.0291, 0.6082, 0.1117],
    [0.0633, 0.71, 0.0782], [0.1096, 0.7932, 0.0573], [0.1655, 0.862, 0.0422], [0.2257, 0.9149, 0.0298],
    [0.2904, 0.954, 0.0203], [0.3597, 0.9803, 0.0134], [0.4334, 0.995, 0.0087], [0.5121, 1.0, 0.0057],
    [0.5945, 0.995, 0.0039], [0.6784, 0.9786, 0.0027], [0.7621, 0.952, 0.0021], [0.8425, 0.9154, 0.0018],
    [0.9163, 0.87, 0.0017], [0.9786, 0.8163, 0.0014], [1.0263, 0.757, 0.0011], [1.0567, 0.6949, 0.001],
    [1.0622, 0.631, 0.0008], [1.0456, 0.5668, 0.0006], [1.0026, 0.503, 0.0003], [0.9384, 0.4412, 0.0002],
    [0.8544, 0.381, 0.0002], [0.7514, 0.321, 0.0001], [0.6424, 0.265, 0.0], [0.5419, 0.217, 0.0],
    [0.4479, 0.175, 0.0], [0.3608, 0.1382, 0.0], [0.2835, 0.107, 0.0], [0.2187, 0.0816, 0.0],
    [0.1649, 0.061, 0.0], [0.1212, 0.0446, 0.0], [0.0874, 0.032, 0.0], [0.0636, 0.0232, 0.0],
    [0.0468, 0.017, 0.0], [0.0329, 0.0119, 0.0], [0.0227, 0.0082, 0.0], [0.0158, 0.0057, 0.0],
    [0.0114, 0.0041, 0.0], [0.0081, 0.0029, 0.0], [0.0058, 0.0021, 0.0], [0.0041, 0.0015, 0.0],
    [0.0029, 0.001, 0.0], [0.002, 0.0007, 0.0], [0.0014, 0.0005, 0.0], [0.001, 0.0004, 0.0],
    [0.0007, 0.0002, 0.0], [0.0005, 0.0002, 0.0], [0.0003, 0.0001, 0.0], [0.0002, 0.0001, 0.0],
    [0.0002, 0.0001, 0.0], [0.0001, 0.0, 0.0], [0.0001, 0.0, 0.0], [0.0001, 0.0, 0.0], [0.0, 0.0, 0.0],
];

/// XYZ to linear Rec.709 (IEC 61966-2-1).
const TO_RGB: [[f64; 3]; 3] =
    [[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]];

fn to_rgb(xyz: [f64; 3]) -> [f64; 3] {
    TO_RGB.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}

/// What no wavelength exceeds in any channel; Blender's node brings all colors below 1 with it.
const BRIGHTEST: f64 = 2.52;

/// Color of light of one wavelength in nanometres, without what lies outside of Rec.709.
pub(super) fn wavelength(nanometres: f64) -> Value {
    let at = (nanometres - 380.0) / 5.0;
    if !(0.0..80.0).contains(&at) {
        return [0.0, 0.0, 0.0, 1.0];
    }
    let (i, t) = (at as usize, at.fract());
    let xyz = std::array::from_fn(|k| OBSERVER[i][k] + t * (OBSERVER[i + 1][k] - OBSERVER[i][k]));
    let [r, g, b] = to_rgb(xyz).map(|x| (x / BRIGHTEST).max(0.0));
    [r, g, b, 1.0]
}

/// Kelvin within which there are colors of black bodies.
const KELVIN: [f64; 2] = [800.0, 12000.0];

/// Colors at evenly spaced inverse temperatures, from the hottest on.
static BLACK_BODIES: LazyLock<Vec<[f64; 3]>> = LazyLock::new(|| {
    let count = 1024;
    let [coldest, hottest] = KELVIN.map(f64::recip);
    (0..count).map(|i| black_body(hottest + (coldest - hottest) * f64::from(i) / f64::from(count - 1))).collect()
});

/// Planck's law seen by the observer, its luminance 1; the inverse of kelvin.
fn black_body(inverse: f64) -> [f64; 3] {
    /// h c / k, in metres × kelvin (CODATA 2018).
    const C2: f64 = 1.438_776_877e-2;
    let mut xyz = [0.0; 3];
    for (i, bar) in OBSERVER.iter().enumerate() {
        let metres = (380.0 + 5.0 * i as f64) * 1e-9;
        // Relative to 560 nm: only ratios count.
        let radiance =
            (560e-9 / metres).powi(5) * ((C2 / 560e-9 * inverse).exp_m1() / (C2 / metres * inverse).exp_m1());
        (0..3).for_each(|k| xyz[k] += bar[k] * radiance);
    }
    to_rgb(xyz.map(|x| x / xyz[1]))
}

/// Color of a black body of a temperature in kelvin, of luminance 1 before what lies outside of Rec.709 is
/// cut off; beyond 800 to 12000 K it is that of the end.
pub(super) fn blackbody(kelvin: f64) -> Value {
    let [coldest, hottest] = KELVIN.map(f64::recip);
    let inverse = kelvin.clamp(KELVIN[0], KELVIN[1]).recip();
    let table = &*BLACK_BODIES;
    let at = (inverse - hottest) / (coldest - hottest) * (table.len() - 1) as f64;
    let i = (at as usize).min(table.len() - 2);
    let t = at - i as f64;
    let [r, g, b] = std::array::from_fn(|k| (table[i][k] + t * (table[i + 1][k] - table[i][k])).max(0.0));
    [r, g, b, 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cycles' fits of Blender 5.0, and `pxr.UsdLux.BlackbodyTemperatureAsRgb` of usd-core 26.11.
    #[test]
    fn black_bodies_are_those_of_others() {
        for (kelvin, expected, tolerance) in [
            (800.0, [5.4139, 0.0, 0.0], 1e-3),
            (1500.0, [3.2643, 0.4340, 0.0], 1e-3),
            (2700.0, [1.9351, 0.8035, 0.1917], 1e-3),
            (5000.0, [1.2131, 0.9608, 0.7622], 1e-3),
            (9000.0, [0.9041, 0.9940, 1.3430], 1e-3),
            (3000.0, [1.7710284, 0.84429353, 0.27203175], 0.02),
            (6500.0, [1.0433334, 0.98362446, 1.0346133], 0.02),
            (10000.0, [0.8718413, 0.9946879, 1.4299959], 0.02),
        ] {
            let got = blackbody(kelvin);
            assert!((0..3).all(|i| (got[i] - expected[i]).abs() < tolerance), "{kelvin} K: {got:?}");
        }
        // A table entry and what stands between.
        let exact = black_body(1.0 / 4321.0);
        assert!((0..3).all(|i| (blackbody(4321.0)[i] - exact[i]).abs() < 1e-5));
        assert_eq!(blackbody(1.0), blackbody(800.0));
        assert_eq!(blackbody(f64::MAX), blackbody(12000.0));
    }

    #[test]
    fn the_spectrum_goes_from_violet_to_red() {
        let [r, g, b, _] = wavelength(450.0);
        assert!(b > r && b > g, "{r} {g} {b}");
        let [r, g, b, _] = wavelength(540.0);
        assert!(g > r && g > b, "{r} {g} {b}");
        let [r, g, b, _] = wavelength(640.0);
        assert!(r > 10.0 * g.max(b), "{r} {g} {b}");
        assert_eq!(wavelength(1000.0), [0.0, 0.0, 0.0, 1.0]);
        // 555 nm to the digits of the table: XYZ (0.5121, 1, 0.0057).
        let [r, g, _, _] = wavelength(555.0);
        assert!((r - (3.2404542 * 0.5121 - 1.5371385 - 0.4985314 * 0.0057) / 2.52).abs() < 1e-12);
        assert!((g - (-0.9692660 * 0.5121 + 1.8760108 + 0.0415560 * 0.0057) / 2.52).abs() < 1e-12);
        let brightest = (0..800).flat_map(|i| wavelength(380.0 + f64::from(i) / 2.0)).fold(0.0, f64::max);
        assert!(brightest <= 1.0);
    }
}
