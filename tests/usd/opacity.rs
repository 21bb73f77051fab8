//! UsdPreviewSurface's opacity in both modes, against closed forms: a pane in a white furnace, or between a dark side
//! and one that shines.

use penumbra::desc::SceneDesc;

use super::load_text;
use super::scene::{close, mean, picture, settings};

/// Radiance of a pane in the plane y = 0 with these inputs, seen at an angle to its normal in degrees, with `world`
/// around it.
fn seen(lines: &str, degrees: f64, world: &str) -> f64 {
    scene_of(lines, degrees, world, "", 16384)
}

fn scene_of(lines: &str, degrees: f64, world: &str, primvars: &str, spp: u32) -> f64 {
    let desc = stage(lines, degrees, world, primvars);
    mean(&picture(&desc, 2, &settings("combined", spp)), "Combined", 0)
}

fn stage(lines: &str, degrees: f64, world: &str, primvars: &str) -> SceneDesc {
    let turn = degrees - 90.0;
    let black = if lines.contains("inputs:diffuseColor") { "" } else { "color3f inputs:diffuseColor = (0, 0, 0)" };
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
        def Material "Glass" {{
            token outputs:surface.connect = </Glass/S.outputs:surface>
            def Shader "S" {{
                uniform token info:id = "UsdPreviewSurface"
                {black}
                {lines}
                token outputs:surface
            }}
            def Shader "Opacity" {{
                uniform token info:id = "UsdPrimvarReader_float"
                string inputs:varname = "displayOpacity"
                float outputs:result
            }}
            def Shader "Color" {{
                uniform token info:id = "UsdPrimvarReader_float3"
                string inputs:varname = "displayColor"
                float3 outputs:result
            }}
        }}
        def Material "Glow" {{
            token outputs:surface.connect = </Glow/S.outputs:surface>
            def Shader "S" {{
                uniform token info:id = "UsdPreviewSurface"
                color3f inputs:diffuseColor = (0, 0, 0)
                color3f inputs:emissiveColor = (1, 1, 1)
                int inputs:useSpecularWorkflow = 1
                float inputs:roughness = 1
                token outputs:surface
            }}
        }}
        def Mesh "Pane" ( prepend apiSchemas = ["MaterialBindingAPI"] ) {{
            rel material:binding = </Glass>
            int[] faceVertexCounts = [4]
            int[] faceVertexIndices = [0, 1, 2, 3]
            point3f[] points = [(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)]
            uniform token subdivisionScheme = "none"
            {primvars}
        }}
        {world}"#
    );
    let loaded = load_text(&text);
    assert!(loaded.said.is_empty(), "{:?}", loaded.said);
    loaded.scene
}

const FURNACE: &str = r#"def DomeLight "Sky" { float inputs:intensity = 1 }"#;

/// A plate that shines, above or below the pane.
fn plate(y: f64) -> String {
    format!(
        r#"def Mesh "Plate" ( prepend apiSchemas = ["MaterialBindingAPI"] ) {{
            rel material:binding = </Glow>
            int[] faceVertexCounts = [4]
            int[] faceVertexIndices = [0, 1, 2, 3]
            point3f[] points = [(-99, {y}, 99), (99, {y}, 99), (99, {y}, -99), (-99, {y}, -99)]
            uniform token subdivisionScheme = "none"
        }}"#
    )
}

/// Fresnel's equations for a dielectric of index `eta`.
fn fresnel(degrees: f64, eta: f64) -> f64 {
    let cos = degrees.to_radians().cos();
    let t = (1.0 - (1.0 - cos * cos) / (eta * eta)).sqrt();
    let (across, along) = ((cos - eta * t) / (cos + eta * t), (eta * cos - t) / (eta * cos + t));
    0.5 * (across * across + along * along)
}

fn mode(mode: &str, opacity: f64, more: &str) -> String {
    format!("float inputs:opacity = {opacity}\ntoken inputs:opacityMode = \"{mode}\"\n{more}")
}

const SMOOTH: &str = "float inputs:roughness = 0";

#[test]
fn a_clear_pane_mirrors_where_it_is_transparent_and_is_not_there_in_presence() {
    for degrees in [0.0, 60.0, 80.0] {
        let f = fresnel(degrees, 1.5);
        let (above, below) = (plate(8.0), plate(-8.0));
        let at = |mode_of: &str, opacity: f64, world: &str| seen(&mode(mode_of, opacity, SMOOTH), degrees, world);
        close("passes, transparent", at("transparent", 0.0, &below), 1.0 - f, 2e-3);
        close("mirrors, transparent", at("transparent", 0.0, &above), f, 2e-3);
        close("passes, presence", at("presence", 0.0, &below), 1.0, 1e-5);
        close("mirrors, presence", at("presence", 0.0, &above), 0.0, 1e-5);
        // The mirror stays as it is, and what passes goes by what is clear.
        close("half passes, transparent", at("transparent", 0.5, &below), 0.5 * (1.0 - f), 3e-3);
        close("mirrors by half, transparent", at("transparent", 0.5, &above), f, 3e-3);
        close("half passes, presence", at("presence", 0.5, &below), 0.5, 2e-2);
        close("mirrors by half, presence", at("presence", 0.5, &above), 0.5 * f, 1e-2);
    }
    // What nobody says is "transparent", the schema's fallback.
    let unsaid = seen("float inputs:opacity = 0\nfloat inputs:roughness = 0", 60.0, &plate(8.0));
    close("unsaid", unsaid, fresnel(60.0, 1.5), 2e-3);
}

#[test]
fn nothing_is_gained_or_lost_at_a_clear_pane() {
    for (what, more) in [
        ("smooth", "float inputs:roughness = 0"),
        ("as it comes", ""),
        ("rough", "float inputs:roughness = 0.9"),
        ("dense", "float inputs:roughness = 0.3\nfloat inputs:ior = 2.4"),
        ("coated", "float inputs:roughness = 0.4\nfloat inputs:clearcoat = 0.7\nfloat inputs:clearcoatRoughness = 0.2"),
        (
            "tinted",
            "int inputs:useSpecularWorkflow = 1\ncolor3f inputs:specularColor = (0.5, 0.5, 0.5)\nfloat inputs:roughness = 0",
        ),
        ("half metal", "float inputs:metallic = 0.5"),
    ] {
        for degrees in [0.0, 60.0, 80.0] {
            // All light passes or comes back, whatever it is that comes from everywhere.
            let seen = seen(&mode("transparent", 0.0, more), degrees, FURNACE);
            close(&format!("{what}, {degrees} degrees"), seen, 1.0, 1e-2);
        }
    }
}

/// Microfacets that reflect a part lose some of what meets several of them, as those of the opaque surface do: of half
/// a mirror of roughness 0.5 it is 3.3 % at most.
#[test]
fn rough_reflections_with_a_color_lose_little_and_gain_nothing() {
    for degrees in [0.0, 60.0, 80.0] {
        let more = "int inputs:useSpecularWorkflow = 1\ncolor3f inputs:specularColor = (0.5, 0.5, 0.5)";
        let seen = seen(&mode("transparent", 0.0, more), degrees, FURNACE);
        assert!((0.965..1.005).contains(&seen), "{degrees} degrees: {seen}");
    }
}

/// Metal has no interface for light to pass beneath: it fades as it does in Storm.
#[test]
fn metal_fades() {
    let more = "float inputs:metallic = 1\nfloat inputs:roughness = 0";
    for (opacity, expected) in [(0.0, 1.0), (0.25, 0.75)] {
        close("passes", seen(&mode("transparent", opacity, more), 30.0, &plate(-8.0)), expected, 2e-2);
    }
    close("mirrors", seen(&mode("transparent", 0.0, more), 30.0, &plate(8.0)), 0.0, 1e-5);
}

/// Opacities of a shape are those of its material's, in both modes.
#[test]
fn a_material_that_shows_opacities_of_shapes_is_clear_as_they_say() {
    let lines = "float inputs:opacity.connect = </Glass/Opacity.outputs:result>\nfloat inputs:roughness = 0";
    let colored = format!("{lines}\ncolor3f inputs:diffuseColor.connect = </Glass/Color.outputs:result>");
    let primvars = "float[] primvars:displayOpacity = [0.25]\ncolor3f[] primvars:displayColor = [(0, 0, 0)]";
    let f = fresnel(60.0, 1.5);
    for lines in [lines, &colored] {
        close("passes", scene_of(lines, 60.0, &plate(-8.0), primvars, 16384), 0.75 * (1.0 - f), 3e-3);
        close("mirrors", scene_of(lines, 60.0, &plate(8.0), primvars, 16384), f, 3e-3);
    }
}

/// Light of lamps without size goes straight through, so that shadows are as clear as the pane is.
#[test]
fn shadows_are_as_clear_as_the_pane() {
    let sun = r#"def DistantLight "Sun" {
            float inputs:angle = 0
            float inputs:intensity = 3.14159265
            float xformOp:rotateX = -90
            uniform token[] xformOpOrder = ["xformOp:rotateX"]
        }
        def Material "White" {
            token outputs:surface.connect = </White/S.outputs:surface>
            def Shader "S" {
                uniform token info:id = "UsdPreviewSurface"
                color3f inputs:diffuseColor = (1, 1, 1)
                int inputs:useSpecularWorkflow = 1
                float inputs:roughness = 1
                token outputs:surface
            }
        }
        def Mesh "Floor" ( prepend apiSchemas = ["MaterialBindingAPI"] ) {
            rel material:binding = </White>
            int[] faceVertexCounts = [4]
            int[] faceVertexIndices = [0, 1, 2, 3]
            point3f[] points = [(-9, -0.1, 9), (9, -0.1, 9), (9, -0.1, -9), (-9, -0.1, -9)]
            uniform token subdivisionScheme = "none"
        }"#;
    let lit = |opacity: f64| seen(&mode("transparent", opacity, SMOOTH), 0.0, sun);
    // Down, and up again; light that comes back from the pane to the floor is a few hundredths more.
    let left = (1.0 - 0.04_f64).powi(2);
    let (whole, half) = (lit(0.0), lit(0.5));
    assert!(whole > 0.9 * left && whole < 1.15 * left, "{whole}");
    assert!(half > 0.9 * 0.25 * left && half < 1.15 * 0.25 * left, "{half}");
}
