//! Shapes that are lights, with what ShapingAPI and ShadowAPI say of them.

use std::f64::consts::FRAC_PI_2;

use penumbra::desc::{ConeDesc, InstanceDesc, LinkSet, ShadowDesc, ShapingDesc};
use penumbra::import::ImportOptions;

use super::{Loaded, near, try_load};

const IES: &str = "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 3 1 1 2 0.1 0.1 0.1\n1 1 100\n0 45 90\n0\n100 50 0\n";

const TRIANGLE: &str = "uniform token subdivisionScheme = \"none\"
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]";

const SPOT: &str = "float inputs:shaping:cone:angle = 30
    float inputs:shaping:cone:softness = 0.25
    float inputs:shaping:focus = 2
    color3f inputs:shaping:focusTint = (0.5, 0, 0)";

const TURNED: &str = "double xformOp:rotateX = 90
    double3 xformOp:translate = (0, 0, 3)
    uniform token[] xformOpOrder = [\"xformOp:rotateX\", \"xformOp:translate\"]";

fn load(prims: &str) -> Loaded {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("lamp.ies"), IES).unwrap();
    let path = folder.path().join("stage.usda");
    let text = format!("#usda 1.0\n( metersPerUnit = 0.5 upAxis = \"Y\" )\n{prims}")
        .replace("TRIANGLE", TRIANGLE)
        .replace("SPOT", SPOT)
        .replace("TURNED", TURNED);
    std::fs::write(&path, text).unwrap();
    try_load(&path, &ImportOptions::default()).unwrap()
}

fn emission(loaded: &Loaded, instance: &InstanceDesc) -> f64 {
    loaded.scene.materials[instance.materials[0].unwrap() as usize].emission.factor[0]
}

#[test]
fn shapes_are_shaped_about_the_axis_of_their_light() {
    let loaded = load(
        r#"def Mesh "Plain" (prepend apiSchemas = ["MeshLightAPI"]) { TRIANGLE }
        def Mesh "Half" (prepend apiSchemas = ["MeshLightAPI", "ShapingAPI"]) { TRIANGLE }
        def Mesh "Spot" (prepend apiSchemas = ["MeshLightAPI", "ShapingAPI"]) { TRIANGLE SPOT TURNED }
        def Sphere "Ball" (prepend apiSchemas = ["LightAPI", "ShapingAPI"]) {
            asset inputs:shaping:ies:file = @./lamp.ies@
            float inputs:shaping:cone:angle = 180
            float inputs:intensity = 3
        }
        def Mesh "Named" { TRIANGLE }
        def GeometryLight "By" (prepend apiSchemas = ["ShapingAPI"]) { rel geometry = </Named> SPOT TURNED }"#,
    );
    loaded.said_nothing();
    let cone = |angle, softness| Some(ConeDesc::Soft { angle, softness });
    assert_eq!(loaded.one("/Plain").shaped, None);
    let half = loaded.one("/Half").shaped.clone().unwrap();
    assert_eq!(half.shaping, ShapingDesc { cone: cone(FRAC_PI_2, 0.0), ..ShapingDesc::default() });
    let spot = ShapingDesc {
        cone: cone(30.0_f64.to_radians(), 0.25),
        focus: 2.0,
        focus_tint: [0.5, 0.0, 0.0],
        ..ShapingDesc::default()
    };
    // The mesh itself stands as it is; that which a light names is shaped about the axis of the light.
    for path in ["/Spot", "/Named"] {
        let shaped = loaded.one(path).shaped.clone().unwrap();
        assert_eq!(shaped.shaping, spot, "{path}");
        near(-shaped.transform.matrix3.z_axis.normalize(), [0.0, 1.0, 0.0]);
    }
    near(loaded.one("/Named").transform.matrix3.z_axis.normalize(), [0.0, 0.0, 1.0]);
    // Candela themselves are the factors, of which the shaping keeps those over their largest.
    let ball = loaded.one("/Ball");
    assert_eq!(ball.shaped.as_ref().unwrap().shaping.ies.unwrap().profile, 0);
    assert_eq!((emission(&loaded, ball), emission(&loaded, loaded.one("/Half"))), (300.0, 1.0));
}

#[test]
fn instances_are_shaped_each_about_its_own_axis() {
    let loaded = load(
        r#"def Xform "Lamp" (instanceable = true) {
            def Mesh "Glow" (prepend apiSchemas = ["MeshLightAPI", "ShapingAPI"]) { TRIANGLE SPOT }
        }
        def Xform "Other" (instanceable = true prepend references = </Lamp>) { TURNED }"#,
    );
    loaded.said_nothing();
    for (path, axis) in [("/Lamp/Glow", [0.0, 0.0, -1.0]), ("/Other/Glow", [0.0, 1.0, 0.0])] {
        let shaped = loaded.one(path).shaped.clone().unwrap();
        near(-shaped.transform.matrix3.z_axis.normalize(), axis);
        assert_eq!(shaped.shaping.focus, 2.0);
    }
}

#[test]
fn shapes_have_the_shadows_of_lamps() {
    let loaded = load(
        r#"def Mesh "Glow" (prepend apiSchemas = ["MeshLightAPI", "ShadowAPI"]) {
            TRIANGLE
            color3f inputs:shadow:color = (0, 0, 1)
            float inputs:shadow:distance = 4
            float inputs:shadow:falloff = 1
        }"#,
    );
    loaded.said_nothing();
    let shadow = ShadowDesc { color: [0.0, 0.0, 1.0], distance: 2.0, falloff: 0.5, gamma: 1.0 };
    assert_eq!(loaded.one("/Glow").links.shadow, shadow);
}

#[test]
fn a_geometry_light_has_its_links_and_tells_of_what_it_does_not_find() {
    let loaded = load(
        r#"def Mesh "Named" { TRIANGLE }
        def Mesh "Lit" { TRIANGLE }
        def Mesh "Other" { TRIANGLE }
        def Xform "Group" { }
        def GeometryLight "By" {
            rel geometry = </Named>
            uniform bool collection:lightLink:includeRoot = 0
            rel collection:lightLink:includes = [</Lit>]
        }
        def GeometryLight "OfGroup" { rel geometry = </Group> }
        def GeometryLight "OfNothing" { rel geometry = </Nowhere> }"#,
    );
    let links = &loaded.one("/Named").links;
    let lit = loaded.scene.instances.iter().position(|instance| &*instance.name == "Lit").unwrap();
    assert_eq!(links.receivers, Some(LinkSet { instances: vec![lit as u32], exclude: false }));
    assert_eq!(links.blockers, None);
    for light in ["/OfGroup: its geometry /Group", "/OfNothing: its geometry /Nowhere"] {
        loaded.said_of(light);
    }
}
