//! The emission that all lights share: intensity, exposure, colour and colour temperature.

use super::super::values::Values;
use super::blender;

/// `intensity · 2^exposure · color · temperature`, before `normalize`.
pub(super) fn emission(values: &Values<'_>) -> [f64; 3] {
    let strength =
        values.number("inputs:intensity").unwrap_or(1.0) * values.number("inputs:exposure").unwrap_or(0.0).exp2();
    let color = values.color("inputs:color").unwrap_or([1.0; 3]);
    let tint = temperature(values).map_or([1.0; 3], blackbody);
    std::array::from_fn(|i| strength * color[i] * tint[i])
}

/// The colour temperature in kelvin, where it is in use.
fn temperature(values: &Values<'_>) -> Option<f64> {
    let kelvin = values.number("inputs:colorTemperature").unwrap_or(6500.0);
    if values.reading.blender {
        return blender::temperature(values, kelvin);
    }
    values.flag("inputs:enableColorTemperature").unwrap_or(false).then_some(kelvin)
}

/// Colour of a black body in Rec.709 every 500 K from 1000 K, its largest channel 1: John Walker, *Colour
/// Rendering of Spectra*, <https://www.fourmilab.ch/documents/specrend/>, as OpenUSD has them.
const COLORS: [[f64; 3]; 19] = [
    [1.0, 0.027490, 0.0],
    [1.0, 0.149664, 0.0],
    [1.0, 0.256644, 0.008095],
    [1.0, 0.372033, 0.067450],
    [1.0, 0.476725, 0.153601],
    [1.0, 0.570376, 0.259196],
    [1.0, 0.653480, 0.377155],
    [1.0, 0.726878, 0.501606],
    [1.0, 0.791543, 0.628050],
    [1.0, 0.848462, 0.753228],
    [1.0, 0.898581, 0.874905],
    [1.0, 0.942771, 0.991642],
    [0.906947, 0.890456, 1.0],
    [0.828247, 0.841838, 1.0],
    [0.765791, 0.801896, 1.0],
    [0.715255, 0.768579, 1.0],
    [0.673683, 0.740423, 1.0],
    [0.638992, 0.716359, 1.0],
    [0.609681, 0.695588, 1.0],
];

/// UsdLuxBlackbodyTemperatureAsRgb: a Catmull-Rom spline through [`COLORS`], its luminance then 1;
/// 1000 to 10000 K.
fn blackbody(kelvin: f64) -> [f64; 3] {
    let x = ((kelvin - 1000.0) / 500.0).clamp(0.0, 18.0);
    let t = x.fract();
    // The first and last colour are repeated.
    let knot = |i: f64| COLORS[i.clamp(0.0, 18.0) as usize];
    let [before, from, to, after] = [-1.0, 0.0, 1.0, 2.0].map(|step| knot(x.floor() + step));
    let rgb: [f64; 3] = std::array::from_fn(|i| {
        let (k0, k1, k2, k3) = (before[i], from[i], to[i], after[i]);
        let a = 0.5 * (3.0 * (k1 - k2) + k3 - k0);
        let b = k0 - 2.5 * k1 + 2.0 * k2 - 0.5 * k3;
        let c = 0.5 * (k2 - k0);
        ((a * t + b) * t + c) * t + k1
    });
    let luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    // The spline dips below 0 in blue.
    rgb.map(|v| (v / luminance).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::super::testing::Stage;
    use super::*;

    /// Numbers of `pxr.UsdLux.BlackbodyTemperatureAsRgb`, usd-core 26.11.
    #[test]
    fn black_bodies_are_those_of_usd() {
        for (kelvin, expected) in [
            (500.0, [4.3055043, 0.11835831, 0.0]),
            (1000.0, [4.3055043, 0.11835831, 0.0]),
            (1300.0, [3.5557542, 0.3414378, 0.0]),
            (1750.0, [2.791554, 0.5682992, 0.00094302144]),
            (3000.0, [1.7710284, 0.84429353, 0.27203175]),
            (3200.0, [1.6799053, 0.86596864, 0.32564223]),
            (5600.0, [1.132336, 0.97269464, 0.8808064]),
            (6500.0, [1.0433334, 0.98362446, 1.0346133]),
            (6600.0, [1.0355259, 0.9844481, 1.0494452]),
            (10000.0, [0.8718413, 0.9946879, 1.4299959]),
            (12000.0, [0.8718413, 0.9946879, 1.4299959]),
        ] {
            let found = blackbody(kelvin);
            for i in 0..3 {
                assert!((found[i] - expected[i]).abs() < 2e-6, "{kelvin} K: {found:?}");
            }
        }
    }

    #[test]
    fn intensity_exposure_color_and_temperature_multiply() {
        let stage = Stage::new(
            "",
            r#"def SphereLight "A" {
                float inputs:intensity = 3
                float inputs:exposure = 2
                color3f inputs:color = (1, 0.5, 0.25)
                float inputs:colorTemperature = 3000
            }
            def SphereLight "B" (references = </A>) { bool inputs:enableColorTemperature = 1 }
            def DistantLight "C" {}
            def SphereLight "D" { float inputs:intensity = nan }"#,
        );
        let emission = |path: &str| {
            stage.with(path, |reading, placed| emission(&Values { reading, prim: &placed.prim, path: &placed.path }))
        };
        assert_eq!(emission("/A"), [12.0, 6.0, 3.0]);
        let warm = emission("/B");
        assert!((warm[0] - 12.0 * 1.7710284).abs() < 1e-4 && (warm[2] - 3.0 * 0.27203175).abs() < 1e-5, "{warm:?}");
        // The schema's fallback.
        assert_eq!(emission("/C"), [50000.0; 3]);
        assert_eq!(emission("/D"), [1.0; 3]);
        assert!(stage.said().contains("inputs:intensity is NaN"), "{}", stage.said());
    }

    /// Connections as they may be made: to an input of what the light is in, to nodes that are the same everywhere.
    #[test]
    fn connected_inputs_have_the_value_that_they_are_connected_to() {
        let stage = Stage::new(
            "",
            r#"def Material "Look" {
                color3f inputs:tint = (0.25, 0.5, 1)
                float inputs:power.timeSamples = { 0: 3 }
                float inputs:unset
                def NodeGraph "Graph" {
                    float inputs:power.connect = </Look.inputs:power>
                    color3f outputs:color.connect = </Look/Graph/Times.outputs:out>
                    float outputs:power.connect = </Look/Graph.inputs:power>
                    def Shader "One" { uniform token info:id = "ND_constant_color3"
                        color3f inputs:value = (1, 2, 3)
                        color3f outputs:out }
                    def Shader "Times" { uniform token info:id = "ND_multiply_color3FA"
                        color3f inputs:in1.connect = </Look/Graph/One.outputs:out>
                        float inputs:in2 = 0.5
                        color3f outputs:out }
                    def Shader "Noise" { uniform token info:id = "ND_noise2d_float"
                        float outputs:out }
                }
                def SphereLight "A" {
                    color3f inputs:color = (9, 9, 9)
                    color3f inputs:color.connect = </Look.inputs:tint>
                    float inputs:intensity.connect = </Look/Graph.outputs:power>
                    float inputs:exposure = 1
                }
                def SphereLight "B" {
                    color3f inputs:color.connect = </Look/Graph.outputs:color>
                    float inputs:intensity = 2
                    float inputs:intensity.connect = </Look/Graph/Noise.outputs:out>
                }
                def SphereLight "C" {
                    float inputs:intensity = 5
                    float inputs:intensity.connect = </Look.inputs:unset>
                    float inputs:exposure = 2
                    float inputs:exposure.connect = </Gone.inputs:exposure>
                }
            }"#,
        );
        let emission = |path: &str| {
            stage.with(path, |reading, placed| emission(&Values { reading, prim: &placed.prim, path: &placed.path }))
        };
        assert_eq!(emission("/Look/A"), [1.5, 3.0, 6.0]);
        assert_eq!(stage.said(), "");
        assert_eq!(emission("/Look/B"), [1.0, 2.0, 3.0]);
        assert!(stage.said().contains("/Look/B: inputs:intensity is connected to what has no constant value"));
        assert_eq!(emission("/Look/C"), [20.0; 3]);
        assert!(stage.said().contains("/Look/C: inputs:exposure is connected to what has no"), "{}", stage.said());
    }
}
