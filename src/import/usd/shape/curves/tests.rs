use crate::desc::Attribute;
use crate::import::usd::shape::testing::built;
use crate::import::usd::shape::{Built, Wants};
use crate::math::Vec3;

fn curves(kind: &str, body: &str) -> (Option<Built>, Vec<String>) {
    let sets = if body.contains("primvars:st") { vec!["st".into()] } else { Vec::new() };
    let wants = Wants { uv_sets: sets, tangents: None, display_color: true, ..Wants::default() };
    built(&format!("def {kind} \"C\"\n{{\n{body}\n}}\n"), "/C", &wants, 2)
}

fn extent(built: &Built) -> (Vec3, Vec3) {
    let points = built.mesh.points.iter().map(|&p| Vec3::from(p));
    points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
}

/// The volume inside, positive where triangles face outwards.
fn volume(built: &Built) -> f32 {
    let p = |i: u32| Vec3::from(built.mesh.points[i as usize]);
    built.mesh.triangles.iter().map(|&[a, b, c]| p(a).dot(p(b).cross(p(c))) / 6.0).sum()
}

#[test]
fn a_straight_line_is_a_cylinder() {
    let (built, warnings) = curves(
        "BasisCurves",
        "uniform token type = \"linear\"
        int[] curveVertexCounts = [2]
        point3f[] points = [(0, 0, 0), (0, 0, 3)]
        float[] widths = [2] (interpolation = \"constant\")
        texCoord2f[] primvars:st = [(0.25, 0.5)] (interpolation = \"uniform\")
        color3f[] primvars:displayColor = [(0, 0, 0), (1, 1, 1)] (interpolation = \"vertex\")",
    );
    let built = built.unwrap();
    assert_eq!(warnings, Vec::<String>::new());
    // Sixteen sides: 16/2 sin(2π/16) of r² for π.
    let area = 8.0 * (std::f32::consts::TAU / 16.0).sin();
    assert!((volume(&built) - 3.0 * area).abs() < 1e-4, "{}", volume(&built));
    assert!(built.mesh.points.len() == 4 * 16 && built.mesh.triangles.len() == 2 * 16 + 2 * 14);
    let (Attribute::Point(uvs), Some(Attribute::Point(colors))) = (&built.mesh.uvs[0], &built.mesh.colors) else {
        panic!()
    };
    assert!(uvs.iter().all(|&uv| uv == [0.25, 0.5]));
    for (p, c) in built.mesh.points.iter().zip(colors) {
        assert!((c[0] - p[2] / 3.0).abs() < 1e-6);
    }
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
        let mesh = built.unwrap().mesh;
        assert_eq!(warnings, Vec::<String>::new());
        let center = |ring: &[[f32; 3]]| ring.iter().map(|&p| Vec3::from(p)).sum::<Vec3>() / ring.len() as f32;
        // Rings of sixteen, and two caps at the end.
        let first = center(&mesh.points[..16]);
        let last = center(&mesh.points[mesh.points.len() - 16..]);
        assert!(first.distance(Vec3::new(0.0, start[0], start[1])) < 1e-5, "{basis} {wrap} {first}");
        assert!(last.distance(Vec3::new(0.0, end[0], end[1])) < 1e-5, "{basis} {wrap} {last}");
    }
    let (built, _) = curves("BasisCurves", &body("bspline", "periodic"));
    let built = built.unwrap();
    // No caps: every ring joins the next.
    assert_eq!(built.mesh.triangles.len(), 2 * built.mesh.points.len());
    assert!(volume(&built) > 0.0);
}

#[test]
fn tapers_have_no_cap_and_normals_lean() {
    let (built, _) = curves(
        "BasisCurves",
        "uniform token type = \"linear\"
        int[] curveVertexCounts = [2]
        point3f[] points = [(0, 0, 0), (0, 0, 1)]
        float[] widths = [2, 0] (interpolation = \"varying\")",
    );
    let mesh = built.unwrap().mesh;
    let Some(Attribute::Point(normals)) = &mesh.normals else { panic!() };
    assert!((normals[0][2] - 0.5f32.sqrt()).abs() < 1e-5, "{:?}", normals[0]);
    assert_eq!(mesh.triangles.len(), 16 + 14);
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
    let built = built.unwrap();
    assert_eq!(warnings, Vec::<String>::new());
    assert_eq!(built.mesh.triangles.len(), 4);
    assert_eq!(extent(&built), (Vec3::new(0.0, -0.25, 0.0), Vec3::new(2.0, 0.25, 0.0)));
    let [a, b, c] = built.mesh.triangles[0].map(|i| Vec3::from(built.mesh.points[i as usize]));
    assert!((b - a).cross(c - a).z > 0.0);
}

#[test]
fn other_curves_are_approximated_or_told() {
    let points = "int[] curveVertexCounts = [2]
        point3f[] points = [(0, 0, 0), (1, 0, 0)]
        float[] widths = [0.1] (interpolation = \"constant\")";
    let (built, warnings) =
        curves("HermiteCurves", &format!("{points}\nvector3f[] tangents = [(0, 3, 0), (0, -3, 0)]"));
    // y = 3t(1 − t)… of two handles of length 1: 3/4 in the middle.
    assert!((extent(&built.unwrap()).1.y - 0.8).abs() < 2e-2, "{warnings:?}");
    let points = points.replace("[0.1] (interpolation = \"constant\")", "[0.1, 0.2]");
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
fn points_are_copies_of_a_sphere() {
    let (built, warnings) = curves(
        "Points",
        "point3f[] points = [(0, 0, 0), (5, 0, 0), (0, 0, inf), (1, 1, 1)]
        float[] widths = [1, 4, 1, 0]
        color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)] (interpolation = \"vertex\")",
    );
    let built = built.unwrap();
    assert_eq!(built.copies.len(), 2);
    let copy = built.copies[1];
    assert_eq!((copy.translation.x, copy.matrix3.x_axis.x), (5.0, 2.0));
    assert!((extent(&built).1 - Vec3::ONE).abs().max_element() < 1e-3);
    assert_eq!(warnings.len(), 2, "{warnings:?}");
}
