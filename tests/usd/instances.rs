//! Instances: native ones, nested, and point instancers.

use std::collections::{BTreeSet, HashSet};

use penumbra::desc::ShapeRef;
use penumbra::import::ImportOptions;
use penumbra::math::{DAffine3, DMat3, DVec3};

use super::{at_frame, load};

#[test]
fn instances_share_their_meshes() {
    let loaded = load("instances.usda", &ImportOptions::default());
    loaded.said_nothing();
    // OpenUSD's translations of the instance proxies.
    let nested = [
        ("/World/One/A/T", [1.0, 10.0, 0.0]),
        ("/World/One/B/T", [2.0, 10.0, 0.0]),
        ("/World/Two/A/T", [3.0, 20.0, 0.0]),
        ("/World/Two/B/T", [6.0, 20.0, 0.0]),
    ];
    for (path, origin) in nested {
        assert_eq!(loaded.origin(path), origin, "{path}");
    }
    let mesh = |path| loaded.one(path).shape;
    let meshes: HashSet<ShapeRef> = nested.map(|(path, _)| mesh(path)).into();
    assert_eq!(meshes.len(), 1);
    // An inherited primvar may change the mesh, but once for all that inherit the same value.
    assert_eq!(mesh("/World/Colored/T"), mesh("/World/AlsoColored/T"));
    assert_eq!(loaded.scene.instances.len(), 7);
}

#[test]
fn what_the_stage_says_of_classes_reaches_prims_below_instances() {
    let loaded = load("implied.usda", &ImportOptions::default());
    loaded.said_nothing();
    // OpenUSD's translations; it has the class that is specialized take the mesh away.
    let expected = [
        ("/World/Inst/Part/T", [5.0, 0.0, 0.0]),
        ("/World/Plain/Part/T", [5.0, 0.0, 0.0]),
        ("/World/One/Part/T", [0.0, 3.0, 0.0]),
        ("/World/Two/Part/T", [0.0, 3.0, 0.0]),
    ];
    for (path, origin) in expected {
        assert_eq!(loaded.origin(path), origin, "{path}");
    }
    assert_eq!(loaded.scene.instances.len(), expected.len(), "{:?}", loaded.paths());
    assert_eq!(loaded.one("/World/One/Part/T").shape, loaded.one("/World/Two/Part/T").shape);
}

#[test]
fn a_prototype_has_its_materials_once() {
    let loaded = load("instances.usda", &ImportOptions::default());
    let of = |path| loaded.one(path).materials[0];
    let own: BTreeSet<Option<u32>> =
        ["/World/One/A/T", "/World/One/B/T", "/World/Two/A/T", "/World/Colored/T"].map(of).into();
    assert_eq!(own.len(), 1, "{own:?}");
    // What is bound to one instance, more strongly than what is bound within.
    assert_eq!(loaded.material("/World/Bound/T"), "Strong");
}

/// UsdGeomPointInstancer::ComputeInstanceTransformsAtTime of `points.usda`, in rows, with the prototypes' own
/// transforms.
const AT_0: [[f64; 12]; 3] = [
    [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.5, 0.0],
    [0.000427, 1.999573, 0.0, -1.999573, 0.000427, 0.0, 0.0, 0.0, 2.0, 2.0, 0.0, 0.0],
    [1.0, 0.0, 0.0, 0.0, 0.000427, 1.999573, 0.0, -2.999359, 0.000641, 3.0, 0.000214, 0.999786],
];
/// Two frames later: one has moved by its velocity, one has turned by its angular velocity.
const AT_2: [[f64; 12]; 3] = [
    [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 3.0, 0.5, 0.0],
    AT_0[1],
    [-1.0, 0.0, 0.0, 0.0, -0.000427, 1.999573, 0.0, 2.999359, 0.000641, 3.0, -0.000214, 0.999786],
];

#[test]
fn point_instancers_place_their_prototypes() {
    for (frame, expected) in [(0.0, AT_0), (2.0, AT_2)] {
        let loaded = load("points.usda", &at_frame(frame));
        loaded.said_nothing();
        // Of six, one is inactive and one invisible.
        assert_eq!(loaded.scene.instances.len(), 4);
        let forest = DAffine3::from_translation(DVec3::new(0.0, 100.0, 1000.0));
        let order = ["/Set/Forest/Protos/Tree", "/Set/Forest/Bush/T", "/Set/Forest/Protos/Tree", "/Set/Forest/Bush/T"];
        assert_eq!(loaded.paths(), order);
        for (instance, m) in loaded.scene.instances.iter().zip(expected) {
            let row = |i: usize| DVec3::new(m[i], m[i + 1], m[i + 2]);
            let matrix3 = DMat3::from_cols(row(0), row(3), row(6));
            let expected = forest * DAffine3 { matrix3, translation: row(9) };
            let close = instance.transform.abs_diff_eq(expected, 2e-6);
            assert!(close, "{:?} at {frame}: {:?} is not {expected:?}", instance.place, instance.transform);
        }
        let meshes: HashSet<ShapeRef> = loaded.scene.instances.iter().map(|i| i.shape).collect();
        // Tree and bush are the same triangle.
        assert_eq!(meshes.len(), 1);
    }
}

#[test]
fn a_prototype_that_is_shown_by_an_instance_of_an_instancer_is_shown_once_at_its_own_place() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("stage.usda");
    // An instance of a class that holds an instancer whose prototype stands beside it.
    let text = r#"#usda 1.0
( metersPerUnit = 1 upAxis = "Y" )
class Xform "_Bed" {
    def Mesh "Flower" {
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
        uniform token subdivisionScheme = "none"
    }
    def PointInstancer "Bed" {
        rel prototypes = </_Bed/Flower>
        int[] protoIndices = [0, 0]
        point3f[] positions = [(1, 0, 0), (2, 0, 0)]
    }
}
def Xform "One" ( instanceable = true inherits = </_Bed> ) {
    double3 xformOp:translate = (0, 10, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Xform "Two" ( instanceable = true inherits = </_Bed> ) {
    double3 xformOp:translate = (0, 20, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
"#;
    std::fs::write(&path, text).unwrap();
    let loaded = super::try_load(&path, &ImportOptions::default()).unwrap();
    loaded.said_nothing();
    let places: Vec<(&str, [f64; 3])> = loaded
        .scene
        .instances
        .iter()
        .map(|i| (i.place.node.as_deref().unwrap(), i.transform.translation.to_array()))
        .collect();
    let expected = [
        ("/One/Flower", [0.0, 10.0, 0.0]),
        ("/One/Bed/Flower", [1.0, 10.0, 0.0]),
        ("/One/Bed/Flower", [2.0, 10.0, 0.0]),
        ("/Two/Flower", [0.0, 20.0, 0.0]),
        ("/Two/Bed/Flower", [1.0, 20.0, 0.0]),
        ("/Two/Bed/Flower", [2.0, 20.0, 0.0]),
    ];
    assert_eq!(places, expected);
    assert_eq!(loaded.scene.meshes.len(), 1);
}

#[test]
fn primitives_that_are_alike_share_a_mesh_and_each_is_told_of() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("stage.usda");
    let text = r#"#usda 1.0
( metersPerUnit = 1 upAxis = "Y" )
def Cube "Fallback" { }
def Cube "Same" { double size = 2 }
def Cube "Large" { double size = 3 }
def Cube "Red" { color3f[] primvars:displayColor = [(1, 0, 0)] }
def Cylinder "Up" { uniform token axis = "Y" }
def Cylinder "Too" { uniform token axis = "Y" }
def Cylinder "Along" { uniform token axis = "X" }
def Scope "Looks" {
    def Material "Look" {
        token outputs:surface.connect = </Looks/Look/S.outputs:surface>
        def Shader "S" {
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor.connect = </Looks/Look/T.outputs:rgb>
            token outputs:surface
        }
        def Shader "T" {
            uniform token info:id = "UsdUVTexture"
            asset inputs:file = @texel.png@
            float2 inputs:st.connect = </Looks/Look/R.outputs:result>
            float3 outputs:rgb
        }
        def Shader "R" {
            uniform token info:id = "UsdPrimvarReader_float2"
            string inputs:varname = "st"
            float2 outputs:result
        }
    }
}
def Cube "Textured" ( prepend apiSchemas = ["MaterialBindingAPI"] ) { rel material:binding = </Looks/Look> }
def Cube "Textured2" ( prepend apiSchemas = ["MaterialBindingAPI"] ) { rel material:binding = </Looks/Look> }
"#;
    std::fs::write(&path, text).unwrap();
    image::RgbImage::new(1, 1).save(dir.path().join("texel.png")).unwrap();
    let loaded = super::try_load(&path, &ImportOptions::default()).unwrap();
    let mesh = |path: &str| loaded.one(path).shape;
    assert_eq!(mesh("/Fallback"), mesh("/Same"));
    assert_eq!(mesh("/Up"), mesh("/Too"));
    assert_eq!(mesh("/Textured"), mesh("/Textured2"));
    let different = ["/Same", "/Large", "/Red", "/Up", "/Along", "/Textured"].map(mesh);
    assert_eq!(HashSet::from(different).len(), different.len());
    // Cubes have no UVs.
    for path in ["/Textured:", "/Textured2:"] {
        assert!(loaded.said_of(path).contains("primvar st, which is absent"), "{:#?}", loaded.said);
    }
}

#[test]
fn equal_meshes_are_one_without_being_instances() {
    let mesh = |name: &str, more: &str| {
        format!(
            r#"def Mesh "{name}" {{
                int[] faceVertexCounts = [3]
                int[] faceVertexIndices = [0, 1, 2]
                point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
                {more}
            }}
"#
        )
    };
    let same = "color3f[] primvars:displayColor = [(1, 0, 0)]";
    let others = [
        "uniform token orientation = \"leftHanded\"",
        "uniform token subdivisionScheme = \"none\"",
        "color3f[] primvars:displayColor = [(0, 1, 0)]",
        "float[] creaseSharpnesses = [3]\nint[] creaseIndices = [0, 1]\nint[] creaseLengths = [2]",
    ];
    let mut text = "#usda 1.0\n( metersPerUnit = 1 upAxis = \"Y\" )\n".to_string();
    text += &mesh("A", same);
    text += &mesh(
        "B",
        &format!(
            "{same}\ndouble3 xformOp:translate = (0, 0, 5)\nuniform token[] xformOpOrder = [\"xformOp:translate\"]"
        ),
    );
    for (i, other) in others.iter().enumerate() {
        text += &mesh(&format!("Other{i}"), other);
    }
    let loaded = super::load_text(&text);
    loaded.said_nothing();
    assert_eq!(loaded.one("/A").shape, loaded.one("/B").shape);
    assert_eq!(loaded.origin("/B"), [0.0, 0.0, 5.0]);
    assert_eq!(loaded.scene.meshes.len(), 1 + others.len());
}

/// OpenUSD's: an instance is itself a prim of the stage, whatever its type, and only what is below it is shared.
#[test]
fn instances_that_are_shapes_lights_or_cameras_are_there() {
    let text = r#"#usda 1.0
( metersPerUnit = 1 upAxis = "Y" )
class Mesh "_Tile" {
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    uniform token subdivisionScheme = "none"
    def Sphere "Knob" {}
}
class PointInstancer "_Row" {
    rel prototypes = </_Row/Ball>
    int[] protoIndices = [0, 0]
    point3f[] positions = [(1, 0, 0), (2, 0, 0)]
    def Sphere "Ball" {}
}
class SphereLight "_Lamp" {}
class Camera "_View" {}
def Mesh "One" ( instanceable = true inherits = </_Tile> ) {}
def Mesh "Two" ( instanceable = true inherits = </_Tile> ) {
    double3 xformOp:translate = (0, 0, 5)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def PointInstancer "Row" ( instanceable = true inherits = </_Row> ) {
    double3 xformOp:translate = (0, 7, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def SphereLight "Lamp" ( instanceable = true inherits = </_Lamp> ) {}
def Camera "View" ( instanceable = true inherits = </_View> ) {}
"#;
    let loaded = super::load_text(text);
    loaded.said_nothing();
    assert_eq!(loaded.origin("/Two"), [0.0, 0.0, 5.0]);
    assert_eq!(loaded.one("/One").shape, loaded.one("/Two").shape);
    assert_eq!(loaded.origin("/Two/Knob"), [0.0, 0.0, 5.0]);
    assert_eq!(loaded.one("/One/Knob").shape, loaded.one("/Two/Knob").shape);
    let row: Vec<_> = loaded.all("/Row/Ball").iter().map(|i| i.transform.translation.to_array()).collect();
    assert_eq!(row, [[1.0, 7.0, 0.0], [2.0, 7.0, 0.0]]);
    assert_eq!((loaded.scene.lights.len(), loaded.scene.cameras.len()), (1, 1));
}
