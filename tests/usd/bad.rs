//! Bad input: what is broken is told, with its layer and prim; the rest of the stage is there.

use std::path::Path;

use penumbra::import::ImportOptions;

use super::{load, load_text, stage, try_load};

#[test]
fn what_is_broken_is_told_and_the_rest_is_shown() {
    let loaded = load("bad.usda", &ImportOptions::default());
    let told = [
        "bad.usda: the sublayer @./no_sublayer.usda@ is not found; it is left out",
        "bad.usda: upAxis is 'X', which is neither Y nor Z; taken for Y",
        "bad.usda, /World/MissingReference: the referenced layer",
        "bad.usda, /World/MissingPayload: the payload layer",
        "bad.usda, /World/Broken: the referenced layer",
        "bad.usda, /World/NoPrim: the referenced layer",
        "bad.usda, /World/Cycle/Inner: is composed of itself",
        "bad.usda, /World/FromTheFuture: type 'Mesh_9' is of no schema that is known here",
        "bad.usda, /World/Nan: its transform is not finite, or beyond 1e30; it is left out",
        "centimetres.usda: metersPerUnit is 0.01, that of the stage 1;",
        "centimetres.usda: upAxis is Z, that of the stage Y;",
        "bad.usda, /World/Sound: purpose 'ornament' is not known; taken for default",
        "bad.usda, /World/Points: 2 protoIndices are not those of one of its 3 prototypes; left out",
        "bad.usda, /World/Points: its prototype /World/Points/Gone does not exist; that is left out",
        "bad.usda, /World/Points: is within its own prototype /World; that is left out",
        "bad.usda, /World/Points: has 1 scales for 5 instances; they are left out",
        "bad.usda, /World/Points: has 2 ids for 5 instances; they are left out",
        "bad.usda, /World/TooFew: has 2 protoIndices but another number of positions; its instances are left out",
    ];
    for what in told {
        loaded.said_of(what);
    }
    assert_eq!(loaded.said.len(), told.len(), "{:#?}", loaded.said);
    assert_eq!(loaded.paths(), ["/World/Centimetres/T", "/World/Sound", "/World/Points/Proto"]);
    // Units of a referenced layer are not converted, as in OpenUSD.
    assert_eq!(loaded.origin("/World/Centimetres/T"), [0.0, 0.0, 100.0]);
}

#[test]
fn a_root_layer_that_can_t_be_read_is_an_error_that_names_it() {
    let error = |path: &Path| match try_load(path, &ImportOptions::default()) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("{} is read", path.display()),
    };
    assert!(error(&stage("no_such.usda")).contains("no_such.usda: can't read"));
    assert!(error(&stage("broken.usdc")).contains("broken.usdc: can't be opened as USD"));
    let dir = tempfile::tempdir().unwrap();
    let cut = dir.path().join("cut.usda");
    std::fs::write(&cut, "#usda 1.0\ndef Xform \"World\" {").unwrap();
    assert!(error(&cut).contains("cut.usda: can't be opened as USD"), "{}", error(&cut));
    std::fs::write(dir.path().join("not.usdz"), "PK").unwrap();
    assert!(error(&dir.path().join("not.usdz")).contains("not.usdz: can't be opened as USD"));
}

#[test]
fn schemas_that_do_nothing_are_told() {
    let text = r#"#usda 1.0
( metersPerUnit = 1 upAxis = "Y" )
def Mesh "Mesh" ( prepend apiSchemas = ["MaterialBindingAPI_7", "CollectionAPI_9:some", "StudioAPI_3", "MotionAPI"] )
{
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    uniform token subdivisionScheme = "none"
}
def "Nothing" ( prepend apiSchemas = ["MeshLightAPI"] )
{
}
def "Newer" ( prepend apiSchemas = ["LightAPI_2"] )
{
}
def Xform "Group" ( prepend apiSchemas = ["LightAPI"] )
{
    float inputs:intensity = 3
}
def Sphere "Blocked"
{
    double radius.timeSamples = { 0: None }
}
def Cylinder "Typed"
{
    string radius = "wide"
    double height = 0
}
def Cube "Flat"
{
    double size = 0
}
"#;
    let loaded = load_text(text);
    let told = [
        "/Mesh: has MaterialBindingAPI_7, a version of MaterialBindingAPI that is not known; it is ignored",
        "/Mesh: has CollectionAPI_9:some, a version of CollectionAPI that is not known; it is ignored",
        "/Nothing: is a light by LightAPI alone, without type or shape; it does not shine",
        "/Newer: has LightAPI_2, a version of LightAPI that is not known; it is ignored",
        "/Group: LightAPI on a prim of type Xform has no shape to shine; it is ignored",
        "/Blocked: there is no number in its radius; the shape is left out",
        "/Typed: there is no number in its radius; the shape is left out",
        "/Flat: its size is 0; the shape is left out",
    ];
    for what in told {
        loaded.said_of(what);
    }
    assert_eq!(loaded.said.len(), told.len(), "{:#?}", loaded.said);
    assert_eq!(loaded.paths(), ["/Mesh"]);
}

#[test]
fn faults_are_told_once_and_in_terms_of_the_file() {
    let text = r#"#usda 1.0
( metersPerUnit = 1 upAxis = "Y" )
def Xform "Inside" ( references = </Nothing> )
{
}
def BasisCurves "Short"
{
    int[] curveVertexCounts = [3]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    float[] widths = [1, 1, 1, 1, 1] (interpolation = "vertex")
}
def BasisCurves "Beyond"
{
    uniform token type = "linear"
    int[] curveVertexCounts = [2, 3]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    float[] widths = [1, 1, 1, 1, 1] (interpolation = "varying")
}
def RenderSettings "Unnamed"
{
}
"#;
    let loaded = load_text(text);
    let told = [
        "/Inside: its internal reference to </Nothing> finds no prim there; it is left out",
        "/Short: 1 curves have too few points for their basis; they are left out",
        "/Beyond: 1 curves need more points than there are; they are left out",
        "/Unnamed: are no settings of the stage, whose renderSettingsPrimPath names none: they are not used",
    ];
    for what in told {
        loaded.said_of(what);
    }
    assert_eq!(loaded.said.len(), told.len(), "{:#?}", loaded.said);
    assert_eq!(loaded.paths(), ["/Beyond"]);
}

/// What a stage of this text is told, and how much of it is a fault.
fn told(text: &str) -> (Vec<String>, usize) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("stage.usda");
    std::fs::write(&path, format!("#usda 1.0\n( metersPerUnit = 1 upAxis = \"Y\" )\n{text}")).unwrap();
    let mut warnings = penumbra::error::Warnings::new();
    penumbra::import::scene(&path, &ImportOptions::default(), &mut warnings).unwrap();
    let said = warnings.iter().map(|warning| format!("{}: {}", warning.place.node.as_deref().unwrap(), warning.what));
    (said.collect(), warnings.faults())
}

#[test]
fn arrays_that_do_not_fit_the_instances_are_told() {
    let text = r#"def PointInstancer "Many" {
        int[] protoIndices = [0, 0, 0, 0]
        point3f[] positions = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)]
        int64[] ids = [1, 2]
        vector3f[] velocities = [(1, 0, 0)]
        color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0)] (interpolation = "vertex")
        rel prototypes = </Many/Ball>
        def Sphere "Ball" {}
    }"#;
    let expected = [
        "/Many.primvars:displayColor: displayColor has 2 values, not one for each of 4 instances; it is left out",
        "/Many: has 1 velocities for 4 positions; they are left out",
        "/Many: has 2 ids for 4 instances; they are left out",
    ];
    let (mut said, faults) = told(text);
    said.sort();
    assert_eq!((said, faults), (expected.map(str::to_string).to_vec(), 3));
}

#[test]
fn stretched_highlights_without_coordinates_are_no_fault() {
    let text = r#"def Mesh "M" (prepend apiSchemas = ["MaterialBindingAPI"]) {
        rel material:binding = </M/Look>
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
        uniform token subdivisionScheme = "none"
        def Material "Look" {
            token outputs:mtlx:surface.connect = </M/Look/S.outputs:surface>
            def Shader "S" {
                uniform token info:id = "ND_open_pbr_surface_surfaceshader"
                float inputs:specular_roughness_anisotropy = 0.5
                token outputs:surface
            }
        }
    }"#;
    let note = "/M: its material bends or stretches light along primvar st, which is absent: the direction is any of the \
                surface";
    assert_eq!(told(text), (vec![note.to_string()], 0));
}

#[test]
fn sizes_of_lights_have_no_sign() {
    let text = r#"def RectLight "Rect" { float inputs:width = -2 }
        def DiskLight "Disk" { float inputs:radius = -0.5 }"#;
    let expected = [
        "/Rect: its inputs:width is negative; taken without the sign",
        "/Disk: its inputs:radius is negative; taken without the sign",
    ];
    assert_eq!(told(text), (expected.map(str::to_string).to_vec(), 2));
}

#[test]
fn tokens_that_are_none_of_the_schema_s_are_told() {
    let text = r#"def Mesh "M" {
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
        uniform token orientation = "upwards"
        uniform token triangleSubdivisionRule = "rough"
        token visibility = "hidden"
    }"#;
    let expected = [
        "/M: there is no visibility \"hidden\"; inherited is used",
        "/M: there is no triangleSubdivisionRule \"rough\"; catmullClark is used",
        "/M: there is no orientation \"upwards\"; rightHanded is used",
    ];
    let (mut said, faults) = told(text);
    said.sort();
    let mut expected = expected.map(str::to_string).to_vec();
    expected.sort();
    assert_eq!((said, faults), (expected, 3));
}

#[test]
fn spaces_of_colour_that_are_not_rendered_in_are_told() {
    let said = |space: &str| {
        let text = format!(
            "#usda 1.0\n( metersPerUnit = 1 upAxis = \"Y\" renderSettingsPrimPath = \"/R\" )\n\
             def RenderSettings \"R\" {{ uniform token renderingColorSpace = \"{space}\" }}\n\
             def Sphere \"S\" {{}}\n"
        );
        load_text(&text).said
    };
    assert_eq!(said("lin_rec709"), [""; 0]);
    let told = said("lin_ap1");
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].ends_with("/R: renderingColorSpace is \"lin_ap1\"; it is rendered in lin_rec709 all the same"));
}

/// OpenUSD uses no offset instead, and says so.
#[test]
fn offsets_that_turn_time_back_are_told() {
    let root = r#"#usda 1.0
( metersPerUnit = 1 upAxis = "Y" subLayers = [@./sub.usda@ (offset = 2; scale = 0)] )
def "Ref" ( references = @./mover.usda@</M> (offset = 3; scale = -1) ) {}
def "Pay" ( payload = @./mover.usda@</M> (scale = -2) ) {}
def "Sound" ( references = @./mover.usda@</M> (offset = 1; scale = 2) ) {}
"#;
    let mover = r#"#usda 1.0
( metersPerUnit = 1 upAxis = "Y" )
def Sphere "M" {
    double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 10: (10, 0, 0) }
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
"#;
    let files = [("root.usda", root), ("mover.usda", mover), ("sub.usda", mover)];
    let (_dir, path) = super::times::stage_of(&files);
    let loaded = try_load(&path, &super::at_frame(4.0)).unwrap();
    let told = [
        "root.usda: its sublayer @./sub.usda@ has the offset 2 and the scale 0",
        "/Ref: its reference @./mover.usda@ has the offset 3 and the scale -1",
        "/Pay: its payload @./mover.usda@ has the offset 0 and the scale -2",
    ];
    told.iter().for_each(|what| _ = loaded.said_of(what));
    assert_eq!(loaded.said.len(), told.len(), "{:#?}", loaded.said);
    assert_eq!(["/M", "/Ref", "/Pay", "/Sound"].map(|path| loaded.origin(path)[0]), [4.0, 4.0, 4.0, 1.5]);
}

#[test]
fn chains_that_are_too_long_are_no_cycles() {
    let link = |i: usize| format!("def \"R{i}\" ( references = </R{}> ) {{}}\n", i + 1);
    let text: String = (0..100).map(link).collect();
    let text = format!("#usda 1.0\n( metersPerUnit = 1 upAxis = \"Y\" )\n{text}def Sphere \"R100\" {{}}\n");
    let loaded = load_text(&text);
    let said = loaded.said_of("/R0: is composed through a chain of 99 arcs, more than are followed");
    assert!(said.ends_with("<R99> is left out") || said.ends_with("</R99> is left out"), "{said}");
    assert!(!loaded.said.iter().any(|said| said.contains("of itself")), "{:#?}", loaded.said);
    assert!(loaded.all("/R0").is_empty());
    loaded.one("/R2");
}
