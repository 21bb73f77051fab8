//! open_pbr_surface against numbers that follow from its node's graph: smooth surfaces in a white furnace.

use super::load_text;
use super::scene::{mean, picture, settings};

/// What a smooth surface with these inputs reflects at an angle to its normal in degrees.
fn reflected(lines: &str, degrees: f64) -> f64 {
    let turn = degrees - 90.0;
    let text = format!(
        r#"#usda 1.0
        ( metersPerUnit = 1 upAxis = "Y" )
        def Camera "Cam" {{
            token projection = "orthographic"
            float horizontalAperture = 0.1
            float verticalAperture = 0.1
            float xformOp:rotateX = {turn}
            double3 xformOp:translate = (0, 0, 5)
            uniform token[] xformOpOrder = ["xformOp:rotateX", "xformOp:translate"]
        }}
        def Material "M" {{
            token outputs:mtlx:surface.connect = </M/S.outputs:out>
            def Shader "S" {{
                uniform token info:id = "ND_open_pbr_surface_surfaceshader"
                float inputs:specular_roughness = 0
                {lines}
                token outputs:out
            }}
        }}
        def Mesh "Pane" ( prepend apiSchemas = ["MaterialBindingAPI"] ) {{
            rel material:binding = </M>
            int[] faceVertexCounts = [4]
            int[] faceVertexIndices = [0, 1, 2, 3]
            point3f[] points = [(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)]
            uniform token subdivisionScheme = "none"
        }}
        def DomeLight "Sky" {{ float inputs:intensity = 1 }}"#
    );
    let loaded = load_text(&text);
    assert!(loaded.said.is_empty(), "{:?}", loaded.said);
    mean(&picture(&loaded.scene, 2, &settings("combined", 256)), "Combined", 0)
}

#[track_caller]
fn check(lines: &str, degrees: f64, expected: f64) {
    let found = reflected(lines, degrees);
    assert!((found - expected).abs() < 2e-4 + 2e-3 * expected, "{lines}, {degrees}: {found}, not {expected}");
}

/// specular_weight is a factor of the reflectance at normal incidence, and at grazing angles all is reflected whatever it
/// is.
#[test]
fn its_weight_changes_the_index() {
    let weighted =
        |weight: f64| format!("color3f inputs:base_color = (0, 0, 0)\nfloat inputs:specular_weight = {weight}");
    check(&weighted(1.0), 85.0, 0.6128);
    check(&weighted(2.0), 0.0, 0.08);
    check(&weighted(0.5), 0.0, 0.02);
    check(&weighted(0.5), 85.0, 0.5826);
    check(&weighted(0.0), 85.0, 0.0);
}

/// `metal_bsdf`: its weight, and once more in the color at 82 degrees, where the cosine is 1/7.
#[test]
fn its_metal_is_weighed() {
    let metal = "float inputs:base_metalness = 1
        color3f inputs:base_color = (0.8, 0.8, 0.8)
        color3f inputs:specular_color = (0.9, 0.9, 0.9)
        float inputs:specular_weight = 0.5";
    let at_82 = (1.0_f64 / 7.0).acos().to_degrees();
    let schlick = 0.8 + 0.2 * (6.0_f64 / 7.0).powi(5);
    check(metal, 0.0, 0.4);
    check(metal, at_82, 0.5 * 0.5 * 0.9 * schlick);
    let whole = metal.replace("specular_weight = 0.5", "specular_weight = 1");
    check(&whole, 0.0, 0.8);
    check(&whole, at_82, 0.9 * schlick);
}

/// Between a coat and a base of one index there is nothing to reflect light.
#[test]
fn its_coat_reaches_the_base() {
    let coated = |ior: f64| {
        format!(
            "color3f inputs:base_color = (0, 0, 0)
            float inputs:coat_weight = 1
            float inputs:coat_ior = 1.5
            float inputs:coat_darkening = 0
            float inputs:specular_ior = {ior}"
        )
    };
    check(&coated(1.5), 0.0, 0.04);
    // 1.8 over 1.5 is 1.2, and so is 1.5 over 1.25.
    let base = 0.96 * (0.2_f64 / 2.2).powi(2);
    check(&coated(1.8), 0.0, 0.04 + base);
    check(&coated(1.25), 0.0, 0.04 + base);
}
