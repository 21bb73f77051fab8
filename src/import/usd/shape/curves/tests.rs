use crate::desc::Strand;
use crate::import::usd::shape::testing::built;
use crate::import::usd::shape::{Built, Wants};
use crate::math::Vec3;

fn curves(kind: &str, body: &str) -> (Option<Built>, Vec<String>) {
    let sets = if body.contains("primvars:st") { vec!["st".into()] } else { Vec::new() };
    let wants = Wants { uv_sets: sets, tangents: None, display_color: true, ..Wants::default() };
    built(&format!("def {kind} \"C\"\n{{\n{body}\n}}\n"), "/C", &wants, 2)
}

/// Box of the points.
fn extent(points: &[[f32; 3]]) -> (Vec3, Vec3) {
    let points = points.iter().map(|&p| Vec3::from(p));
    points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
}

#[test]
fn a_straight_line_is_one_segment() {
    let (built, warnings) = curves(
        "BasisCurves",
        "uniform token type = \"linear\"
        int[] curveVertexCounts = [2, 3]
        point3f[] points = [(0, 0, 0), (0, 0, 3), (1, 0, 0), (1, 0, 0), (1, 2, 0)]
        float[] widths = [2] (interpolation = \"constant\")
        texCoord2f[] primvars:st = [(0.25, 0.5), (0.5, 1)] (interpolation = \"uniform\")
        color3f[] primvars:displayColor = [(0, 0, 0), (1, 1, 1), (0, 0, 0), (0, 0, 0), (0, 1, 0)] (interpolation = \"vertex\")
        float[] primvars:displayOpacity = [0.5]",
    );
    let rounds = built.unwrap().into_rounds();
    assert_eq!(warnings, Vec::<String>::new());
    // Of two points at one place one is left.
    assert_eq!(rounds.points, [[0.0, 0.0, 0.0], [0.0, 0.0, 3.0], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0]]);
    assert_eq!(rounds.radii, [1.0; 4]);
    assert_eq!(rounds.strands, [2, 4].map(|end| Strand { end, closed: false }));
    assert_eq!(rounds.uvs[0], [[0.25, 0.5], [0.25, 0.5], [0.5, 0.0], [0.5, 0.0]]);
    let colors = [[0.0, 0.0, 0.0, 0.5], [1.0, 1.0, 1.0, 0.5], [0.0, 0.0, 0.0, 0.5], [0.0, 1.0, 0.0, 0.5]];
    assert_eq!(rounds.colors.unwrap(), colors);
}

#[test]
fn segments_are_those_that_usd_counts() {
    // UsdGeom.BasisCurves.ComputeSegmentCounts of usd-core 26.11 for [7]. Its ComputeVaryingDataSize agrees but
    // for linear periodic curves (8) and pinned splines (5), where it contradicts the segments.
    use super::super::segments::{Basis, Curve, Wrap};
    let cases = [
        (Basis::Linear, Wrap::Open, 6, 7),
        (Basis::Linear, Wrap::Closed, 7, 7),
        (Basis::Bezier, Wrap::Open, 2, 3),
        (Basis::Bspline, Wrap::Open, 4, 5),
        (Basis::Bspline, Wrap::Closed, 7, 7),
        (Basis::Bspline, Wrap::Pinned, 6, 7),
        (Basis::CatmullRom, Wrap::Pinned, 6, 7),
    ];
    for (basis, wrap, segments, varying) in cases {
        let curve = Curve::new(0..7, 0, basis, wrap);
        assert_eq!((curve.segments(), curve.joints.len()), (segments, varying), "{basis:?} {wrap:?}");
    }
    assert_eq!(Curve::new(0..6, 0, Basis::Bezier, Wrap::Closed).segments(), 2);
}

#[test]
fn cubic_bases_pass_where_they_should() {
    let body = |basis: &str, wrap: &str| {
        format!(
            "uniform token basis = \"{basis}\"
            uniform token wrap = \"{wrap}\"
            int[] curveVertexCounts = [4]
            point3f[] points = [(0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1)]
            float[] widths = [0.02] (interpolation = \"constant\")"
        )
    };
    // Where each starts and ends: at the points; at 1/6, 4/6, 1/6 of three; at the inner points.
    let cases = [
        ("bezier", "nonperiodic", [0.0, 0.0], [0.0, 1.0]),
        ("bspline", "nonperiodic", [5.0 / 6.0, 1.0 / 6.0], [5.0 / 6.0, 5.0 / 6.0]),
        ("catmullRom", "nonperiodic", [1.0, 0.0], [1.0, 1.0]),
        ("bspline", "pinned", [0.0, 0.0], [0.0, 1.0]),
        ("catmullRom", "pinned", [0.0, 0.0], [0.0, 1.0]),
    ];
    for (basis, wrap, start, end) in cases {
        let (built, warnings) = curves("BasisCurves", &body(basis, wrap));
        let rounds = built.unwrap().into_rounds();
        assert_eq!(warnings, Vec::<String>::new());
        let (first, last) = (Vec3::from(rounds.points[0]), Vec3::from(rounds.points[rounds.points.len() - 1]));
        assert!(first.distance(Vec3::new(0.0, start[0], start[1])) < 1e-5, "{basis} {wrap} {first}");
        assert!(last.distance(Vec3::new(0.0, end[0], end[1])) < 1e-5, "{basis} {wrap} {last}");
        assert!(!rounds.strands[0].closed && rounds.strands.len() == 1);
    }
    let (built, _) = curves("BasisCurves", &body("bspline", "periodic"));
    let rounds = built.unwrap().into_rounds();
    assert!(rounds.strands[0].closed && rounds.points[0] != rounds.points[rounds.points.len() - 1]);
}

#[test]
fn pieces_are_as_fine_as_bends_and_widths_call_for() {
    let count = |points: &str, widths: &str, interpolation: &str| {
        let body = format!(
            "uniform token basis = \"bezier\"
            int[] curveVertexCounts = [4]
            point3f[] points = {points}
            float[] widths = {widths} (interpolation = \"{interpolation}\")"
        );
        curves("BasisCurves", &body).0.unwrap().into_rounds()
    };
    let straight = "[(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)]";
    assert_eq!(count(straight, "[0.2]", "constant").points.len(), 2);
    let tapered = count(straight, "[0.2, 0]", "varying");
    assert_eq!((tapered.points.len(), tapered.radii), (2, vec![0.1, 0.0]));
    // 0.1 (1 − 3 s t): bends between the ends.
    let waist = count(straight, "[0.2, 0, 0, 0.2]", "vertex");
    let middle = waist.radii.iter().copied().fold(f32::INFINITY, f32::min);
    assert!(waist.points.len() > 6 && (middle - 0.025).abs() < 1e-2, "{:?}", waist.radii);
    // A quarter of a circle: the chord's sagitta against the radius.
    let bow = "[(0, 0, 0), (0, 0.5523, 0), (0.4477, 1, 0), (1, 1, 0)]";
    for (width, tolerance) in [(0.4, 0.01), (0.02, 0.0005)] {
        let points = count(bow, &format!("[{width}]"), "constant").points;
        let radius = |p: Vec3| p.distance(Vec3::X);
        let off = |w: &[[f32; 3]]| 1.0 - radius(0.5 * (Vec3::from(w[0]) + Vec3::from(w[1])));
        let worst = points.windows(2).map(off).fold(0.0, f32::max);
        assert!(worst < tolerance && worst > 0.2 * tolerance, "{width}: {worst}");
    }
}

#[test]
fn normals_make_ribbons() {
    let (built, warnings) = curves(
        "BasisCurves",
        "uniform token type = \"linear\"
        int[] curveVertexCounts = [3]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (2, 0, 0)]
        normal3f[] normals = [(0, 0, 1), (0, 0, 1), (0, 0, 1)]
        float[] widths = [0.5, 0.5, 0.5]",
    );
    let mesh = built.unwrap().into_mesh();
    assert_eq!(warnings, Vec::<String>::new());
    assert_eq!(mesh.triangles.len(), 4);
    assert_eq!(extent(&mesh.points), (Vec3::new(0.0, -0.25, 0.0), Vec3::new(2.0, 0.25, 0.0)));
    let [a, b, c] = mesh.triangles[0].map(|i| Vec3::from(mesh.points[i as usize]));
    assert!((b - a).cross(c - a).z > 0.0);
}

#[test]
fn other_curves_are_approximated_or_told() {
    let body = "int[] curveVertexCounts = [2]
        point3f[] points = [(0, 0, 0), (1, 0, 0)]
        float[] widths = [0.1] (interpolation = \"constant\")";
    let (built, warnings) = curves("HermiteCurves", &format!("{body}\nvector3f[] tangents = [(0, 3, 0), (0, -3, 0)]"));
    // y = 3t(1 − t)… of two handles of length 1: 3/4 in the middle.
    let points = built.unwrap().into_rounds().points;
    assert!((extent(&points).1.y - 0.75).abs() < 1e-2, "{warnings:?}");
    let points = body.replace("[0.1] (interpolation = \"constant\")", "[0.1, 0.2]");
    let (built, warnings) =
        curves("HermiteCurves", &format!("{points}\nvector3f[] tangents = [(0, 3, 0), (0, -3, 0)]"));
    assert!(built.is_some() && warnings.is_empty(), "{warnings:?}");
    let points = points.as_str();
    let (built, warnings) = curves("NurbsCurves", points);
    assert!(built.is_some() && warnings[0].contains("NURBS"), "{warnings:?}");
    let (built, warnings) = curves("BasisCurves", points);
    assert!(built.is_none() && warnings.iter().any(|w| w.contains("too few points")), "{warnings:?}");
    let (built, warnings) = curves("BasisCurves", "int[] curveVertexCounts = [9, 9]\npoint3f[] points = [(0, 0, 0)]");
    assert!(built.is_none() && warnings.iter().any(|w| w.contains("2 curves need more points")), "{warnings:?}");
}

#[test]
fn curves_without_width_are_left_out() {
    let (built, warnings) = curves(
        "BasisCurves",
        "uniform token type = \"linear\"
        int[] curveVertexCounts = [2, 2, 2]
        point3f[] points = [(0, 0, 0), (0, 0, 3), (1, 0, 0), (1, 0, 3), (nan, 0, 0), (0, 0, 0)]
        float[] widths = [0, -1, 1, 1, 1, 1]",
    );
    assert_eq!(built.unwrap().into_rounds().points, [[1.0, 0.0, 0.0], [1.0, 0.0, 3.0]]);
    assert!(warnings.iter().any(|w| w.contains("1 curves have no width")), "{warnings:?}");
    assert!(warnings.iter().any(|w| w.contains("1 curves have points that are not finite")), "{warnings:?}");
}

#[test]
fn points_are_balls_with_values_of_their_own() {
    let (built, warnings) = curves(
        "Points",
        "point3f[] points = [(0, 0, 0), (5, 0, 0), (0, 0, inf), (1, 1, 1)]
        float[] widths = [1, 4, 1, 0]
        color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)] (interpolation = \"vertex\")
        float[] primvars:displayOpacity = [0, 0.25] (interpolation = \"vertex\")
        int[] primvars:displayOpacity:indices = [1, 0, 1, 1]
        texCoord2f[] primvars:st = [(0, 0), (0.5, 0.25), (1, 1), (1, 1)] (interpolation = \"varying\")",
    );
    let rounds = built.unwrap().into_rounds();
    assert_eq!(rounds.points, [[0.0, 0.0, 0.0], [5.0, 0.0, 0.0]]);
    assert_eq!((rounds.radii, rounds.strands), (vec![0.5, 2.0], Vec::new()));
    assert_eq!(rounds.colors.unwrap(), [[1.0, 0.0, 0.0, 0.25], [0.0, 1.0, 0.0, 0.0]]);
    assert_eq!(rounds.uvs, [[[0.0, 1.0], [0.5, 0.75]]]);
    assert_eq!(warnings.len(), 1, "{warnings:?}");
}

#[test]
fn subsets_of_curves_are_told() {
    let lines = "uniform token type = \"linear\"
        int[] curveVertexCounts = [2]
        point3f[] points = [(0, 0, 0), (0, 1, 0)]
        float[] widths = [0.1] ( interpolation = \"constant\" )
        def GeomSubset \"S\" {
            uniform token elementType = \"segment\"
            uniform token familyName = \"materialBind\"
            int[] indices = [0]
        }";
    let (built, warnings) = curves("BasisCurves", lines);
    assert!(built.is_some());
    assert!(warnings.iter().any(|said| said.contains("subsets are supported of Mesh alone")), "{warnings:?}");
}
