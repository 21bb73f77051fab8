//! Normals that the slope of a height over texture coordinates bends, as they are rendered.

use super::load_text;
use super::scene::{mean, picture, settings};

/// A square of two units whose height is 16 times one of its texture coordinates; 7 stands for which.
const STAGE: &str = r#"#usda 1.0
( metersPerUnit = 1 upAxis = "Y" )
def Mesh "W" (
    prepend apiSchemas = ["MaterialBindingAPI"]
)
{
    rel material:binding = </m>
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
    texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (
        interpolation = "vertex"
    )
    uniform token subdivisionScheme = "none"
}
def Material "m"
{
    token outputs:mtlx:surface.connect = </m/s.outputs:surface>
    def Shader "s"
    {
        uniform token info:id = "ND_open_pbr_surface_surfaceshader"
        normal3f inputs:geometry_normal.connect = </m/n.outputs:out>
        token outputs:surface
    }
    def Shader "n"
    {
        uniform token info:id = "ND_bump_vector3"
        float inputs:height.connect = </m/h.outputs:out>
        vector3f outputs:out
    }
    def Shader "h"
    {
        uniform token info:id = "ND_multiply_float"
        float inputs:in1.connect = </m/x.outputs:out>
        float inputs:in2 = 16
        float outputs:out
    }
    def Shader "x"
    {
        uniform token info:id = "ND_extract_vector2"
        float2 inputs:in.connect = </m/t.outputs:out>
        int inputs:index = 7
        float outputs:out
    }
    def Shader "t"
    {
        uniform token info:id = "ND_texcoord_vector2"
        float2 outputs:out
    }
}
def Camera "C"
{
    token projection = "orthographic"
    float horizontalAperture = 15
    float verticalAperture = 15
    double3 xformOp:translate = (0, 0, 20)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def DistantLight "D"
{
}
"#;

/// MaterialX counts a sixteenth of the slope: half a right angle, away from where the height grows.
#[test]
fn heights_bend_normals_along_both_coordinates() {
    for (coordinate, expected) in [("0", [-1.0, 0.0, 1.0]), ("1", [0.0, -1.0, 1.0])] {
        let loaded = load_text(&STAGE.replace('7', coordinate));
        loaded.said_nothing();
        let picture = picture(&loaded.scene, 4, &settings("normal", 4));
        for (channel, expected) in expected.into_iter().enumerate() {
            let found = mean(&picture, "Normal", channel);
            assert!((found - expected * 0.5_f64.sqrt()).abs() < 1e-5, "{coordinate}, {channel}: {found}");
        }
    }
}
