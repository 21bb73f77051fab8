use crate::desc::Attribute;
use crate::import::usd::shape::testing::{built, source};
use crate::import::usd::shape::{Built, Wants};

fn wants(sets: &[&str]) -> Wants {
    Wants {
        uv_sets: sets.iter().map(|&name| name.into()).collect(),
        tangents: None,
        display_color: true,
        ..Wants::default()
    }
}

fn mesh(body: &str) -> (Option<Built>, Vec<String>) {
    built(&format!("def Mesh \"M\"\n{{\n{body}\n}}\n"), "/M", &wants(&["st"]), 2)
}

const QUADS: &str = "
    uniform token subdivisionScheme = \"none\"
    int[] faceVertexCounts = [4, 4]
    int[] faceVertexIndices = [0, 1, 4, 3, 1, 2, 5, 4]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0), (1, 1, 0), (2, 1, 0)]";

#[test]
fn quads_become_fans_and_v_is_turned() {
    let (built, warnings) = mesh(&format!(
        "{QUADS}
        texCoord2f[] primvars:st = [(0, 0.25), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)] (interpolation = \"vertex\")
        color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0)] (interpolation = \"uniform\")
        float[] primvars:displayOpacity = [0.5]"
    ));
    let mesh = built.unwrap().into_mesh();
    assert_eq!(mesh.triangles, [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]]);
    let Attribute::Point(uvs) = &mesh.uvs[0] else { panic!() };
    assert_eq!((uvs[0], uvs[4]), ([0.0, 0.75], [1.0, 0.0]));
    let Some(Attribute::Corner(colors)) = &mesh.colors else { panic!() };
    assert_eq!((colors[5], colors[6]), ([1.0, 0.0, 0.0, 0.5], [0.0, 1.0, 0.0, 0.5]));
    assert_eq!((mesh.normals, mesh.name.as_ref()), (None, "M"));
    assert_eq!(warnings, Vec::<String>::new());
}

#[test]
fn left_handed_faces_are_turned_over_with_their_corners() {
    let (built, warnings) = mesh(&format!(
        "{QUADS}
        uniform token orientation = \"leftHanded\"
        normal3f[] normals = [(0, 0, -2), (0, 0, -1)] (interpolation = \"uniform\")
        texCoord2f[] primvars:st = [(0, 0), (1, 0), (2, 1), (3, 1)] (interpolation = \"faceVarying\")
        int[] primvars:st:indices = [0, 1, 2, 3, 3, 2, 1, 0]"
    ));
    let mesh = built.unwrap().into_mesh();
    assert_eq!(mesh.triangles[0], [0, 4, 1]);
    let Attribute::Corner(uvs) = &mesh.uvs[0] else { panic!() };
    assert_eq!(uvs[..3], [[0.0, 1.0], [2.0, 0.0], [1.0, 1.0]]);
    let Some(Attribute::Corner(normals)) = &mesh.normals else { panic!() };
    assert_eq!(normals[0], [0.0, 0.0, -1.0]);
    assert_eq!(warnings, Vec::<String>::new());
}

#[test]
fn triangles_keep_their_arrays() {
    let (built, warnings) = mesh(
        "uniform token subdivisionScheme = \"none\"
        int[] faceVertexCounts = [3, 3]
        int[] faceVertexIndices = [0, 1, 2, 2, 1, 3]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]
        normal3f[] normals = [(9, 9, 9)] (interpolation = \"constant\")
        normal3f[] primvars:normals = [(0, 0, 1), (0, 0, 1), (0, 0, 1), (0, 0, 1)] (interpolation = \"vertex\")
        double2[] primvars:st = [(0, 0), (1, 0), (0, 1), (0, 1), (1, 0), (1, 1)] (interpolation = \"faceVarying\")",
    );
    let mesh = built.unwrap().into_mesh();
    assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(mesh.normals, Some(Attribute::Point(vec![[0.0, 0.0, 1.0]; 4])));
    let Attribute::Corner(uvs) = &mesh.uvs[0] else { panic!() };
    assert_eq!(uvs[5], [1.0, 0.0]);
    assert_eq!(warnings, Vec::<String>::new());
}

#[test]
fn constant_primvars_are_inherited_and_missing_ones_told_once() {
    let usda = format!(
        "def Xform \"X\" {{
        texCoord2f[] primvars:st = [(0.5, 0.25)]
        color3f[] primvars:displayColor = [(0, 0, 1)]
        def Mesh \"M\" {{ {QUADS} }} }}"
    );
    let (shape, warnings) = built(&usda, "/X/M", &wants(&["st", "", "map1"]), 0);
    let mesh = shape.unwrap().into_mesh();
    assert_eq!(mesh.uvs[0], Attribute::Point(vec![[0.5, 0.75]; 6]));
    assert_eq!(mesh.uvs[2], Attribute::Point(vec![[0.0, 1.0]; 6]));
    assert_eq!(mesh.colors, Some(Attribute::Point(vec![[0.0, 0.0, 1.0, 1.0]; 6])));
    assert_eq!(warnings, ["its material looks textures up by primvar map1, which is absent; (0, 0) is used"]);
    let (shape, _) = built(&usda, "/X/M", &Wants { display_color: false, ..wants(&[]) }, 0);
    assert_eq!(shape.unwrap().into_mesh().colors, None);
}

#[test]
fn subsets_choose_slots_and_holes_are_left_out() {
    let body = format!(
        "{QUADS}
        int[] holeIndices = [7]
        def GeomSubset \"a\" {{ uniform token elementType = \"face\" uniform token familyName = \"materialBind\" int[] indices = [1, 9] }}
        def GeomSubset \"b\" {{ uniform token elementType = \"face\" uniform token familyName = \"materialBind\" int[] indices = [1] }}
        def GeomSubset \"c\" {{ uniform token familyName = \"other\" int[] indices = [0] }}"
    );
    let (source, _) = source(&format!("def Mesh \"M\"\n{{\n{body}\n}}\n"), "/M");
    let paths: Vec<String> = source.unwrap().subsets().iter().map(|p| p.to_string()).collect();
    assert_eq!(paths, ["/M/a", "/M/b"]);
    let (built, warnings) = built(&format!("def Mesh \"M\"\n{{\n{body}\n}}\n"), "/M", &wants(&[]), 2);
    assert_eq!(built.unwrap().into_mesh().material_slots, Some(vec![0, 0, 1, 1]));
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    let (built, _) = mesh(&format!("{QUADS}\nint[] holeIndices = [0]"));
    assert_eq!(built.unwrap().into_mesh().triangles, [[1, 2, 5], [1, 5, 4]]);
}

#[test]
fn a_scheme_refines_everything_and_ignores_normals() {
    let cage = QUADS.replace("\"none\"", "\"catmullClark\"");
    let body = format!(
        "{cage}
        normal3f[] normals = [(1, 0, 0)] (interpolation = \"constant\")
        texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1), (1, 0), (2, 0), (2, 1), (1, 1)] (interpolation = \"faceVarying\")
        color3f[] primvars:displayColor = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 0, 0), (1, 0, 0), (2, 0, 0)] (interpolation = \"varying\")
        def GeomSubset \"a\" {{ uniform token familyName = \"materialBind\" int[] indices = [1] }}"
    );
    let (built, warnings) = mesh(&body);
    assert_eq!(warnings, Vec::<String>::new());
    let mesh = built.unwrap().into_mesh();
    assert_eq!(mesh.triangles.len(), 2 * 16 * 2);
    let Some(Attribute::Point(normals)) = &mesh.normals else { panic!() };
    assert!(normals.iter().all(|n| (n[2] - 1.0).abs() < 1e-6));
    let Attribute::Corner(uvs) = &mesh.uvs[0] else { panic!() };
    let Some(Attribute::Point(colors)) = &mesh.colors else { panic!() };
    for (corner, &point) in mesh.triangles.as_flattened().iter().enumerate() {
        let p = mesh.points[point as usize];
        // The values of this cage are its points, and both go by the same masks.
        assert!((uvs[corner][0] - p[0]).abs() < 1e-5 && (1.0 - uvs[corner][1] - p[1]).abs() < 1e-5);
        let slot = mesh.material_slots.as_ref().unwrap()[corner / 3];
        assert!(if slot == 1 { p[0] > 0.99 } else { p[0] < 1.01 });
        assert!((0.0..=2.0).contains(&colors[point as usize][0]));
    }
}

#[test]
fn level_zero_shows_the_cage_with_smooth_normals() {
    let usda = format!("def Mesh \"M\" {{ {} }}", QUADS.replace("\"none\"", "\"catmullClark\""));
    let (shape, _) = built(&usda, "/M", &wants(&[]), 0);
    let mesh = shape.unwrap().into_mesh();
    assert_eq!((mesh.points.len(), mesh.triangles.len()), (6, 4));
    assert_eq!(mesh.normals, Some(Attribute::Point(vec![[0.0, 0.0, 1.0]; 6])));
}

#[test]
fn loop_on_quads_is_told_and_cut() {
    let (built, warnings) = mesh(&QUADS.replace("\"none\"", "\"loop\""));
    assert_eq!(built.unwrap().into_mesh().triangles.len(), 4 * 16);
    assert!(warnings[0].contains("cut to triangles"), "{warnings:?}");
}

#[test]
fn what_is_broken_is_told_and_the_rest_stays() {
    let one = |body: &str| {
        let (built, warnings) = mesh(&format!("uniform token subdivisionScheme = \"none\"\n{body}"));
        (built.map(|b| b.into_mesh().triangles), warnings)
    };
    let points = "point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]";
    let cases = [
        ("", None, "it has no points"),
        (points, None, "no faces"),
        ("int[] points = [1, 2]", None, "type IntVec"),
        (
            "point3f points = (1, 2, 3)\nint[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 0, 0]",
            None,
            "has area",
        ),
    ];
    for (body, expected, told) in cases {
        let (triangles, warnings) = one(body);
        assert_eq!(triangles, expected);
        assert!(warnings.iter().any(|w| w.contains(told)), "{body}: {warnings:?}");
    }
    let faces = |counts: &str, indices: &str, more: &str| {
        one(&format!("{points}\nint[] faceVertexCounts = {counts}\nint[] faceVertexIndices = {indices}\n{more}"))
    };
    let st = "texCoord2f[] primvars:st = [(0, 0)]";
    let (triangles, warnings) = faces("[3, 3, 2, 3]", "[0, 1, 2, 1, 3, 9, 0, 1, 2, 1, 3]", st);
    assert_eq!(triangles.unwrap(), [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    let (triangles, warnings) = faces("[3, 3, -1, 3]", "[0, 1, 2, 2, 1, 3, 0, 1, 2]", st);
    assert_eq!(triangles.unwrap().len(), 2);
    assert!(warnings[0].contains("2 faces have corners beyond"), "{warnings:?}");
    let (triangles, warnings) =
        faces("[3]", "[0, 1, 2, 2, 1, 3]", "texCoord2f[] primvars:st = [(0, 0)] (interpolation = \"vertex\")");
    assert_eq!(triangles.unwrap().len(), 1);
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    let (triangles, warnings) = faces(
        "[3]",
        "[0, 1, 2]",
        "texCoord2f[] primvars:st = [(0, 0)] (interpolation = \"vertex\")\nint[] primvars:st:indices = [0, -4, 7, 0]",
    );
    assert_eq!(triangles.unwrap().len(), 1);
    assert!(warnings[0].contains("2 indices of st are out of range"), "{warnings:?}");
    let nan = "point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (nan, 1, 0)]";
    let (triangles, warnings) =
        one(&format!("{nan}\nint[] faceVertexCounts = [3, 3]\nint[] faceVertexIndices = [0, 1, 2, 2, 1, 3]\n{st}"));
    assert_eq!(triangles.unwrap().len(), 1);
    assert!(warnings[0].contains("not finite"), "{warnings:?}");
}

#[test]
fn arrays_of_creases_that_do_not_fit_are_told() {
    let cage = QUADS.replace("\"none\"", "\"catmullClark\"");
    let told = |lines: &str| built(&format!("def Mesh \"M\"\n{{\n{cage}\n{lines}\n}}\n"), "/M", &wants(&[]), 2).1;
    let creases = "int[] creaseIndices = [0, 1, 2, 5, 4] int[] creaseLengths = [3, 2]";
    for sharpnesses in ["[1, 2]", "[1, 2, 3]"] {
        assert_eq!(told(&format!("{creases} float[] creaseSharpnesses = {sharpnesses}")), Vec::<String>::new());
    }
    assert_eq!(
        told(&format!("{creases} float[] creaseSharpnesses = [1, 2, 3, 4]")),
        ["has 4 creaseSharpnesses for 2 creases of 3 edges; the first ones are used, one for each crease"]
    );
    let of = |lengths: &str| {
        told(&format!(
            "int[] creaseIndices = [0, 1, 2, 5, 4] int[] creaseLengths = {lengths} float[] creaseSharpnesses = [1, 2]"
        ))
    };
    assert_eq!(of("[2, 2]"), ["has 5 creaseIndices where its creaseLengths come to 4; those beyond are left out"]);
    assert_eq!(
        of("[3, 3]"),
        ["has 5 creaseIndices where its creaseLengths come to 6; the creases beyond are left out"]
    );
    assert_eq!(
        told("int[] cornerIndices = [0] float[] cornerSharpnesses = [1, 2]"),
        ["has 2 cornerSharpnesses for 1 corners; the first ones are used"]
    );
}
