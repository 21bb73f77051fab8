//! Models that are drawn by their bounds, their origin or cards (`model:drawMode`).

use std::collections::{BTreeSet, HashSet};

use penumbra::desc::{Attribute, MeshDesc, ShapeRef};
use penumbra::import::ImportOptions;

use super::{Loaded, load, try_load};

fn mesh<'a>(loaded: &'a Loaded, path: &str) -> &'a MeshDesc {
    loaded.scene.mesh(loaded.one(path)).unwrap()
}

/// Smallest and largest corner, rounded to a hundredth.
fn bounds(mesh: &MeshDesc) -> [[f32; 3]; 2] {
    let corner = |pick: fn(f32, f32) -> f32| {
        let all = mesh.points.iter().copied().reduce(|a, b| std::array::from_fn(|i| pick(a[i], b[i])));
        all.unwrap().map(|x| (100.0 * x).round() / 100.0)
    };
    [corner(f32::min), corner(f32::max)]
}

fn of_color(mesh: &MeshDesc) -> [f32; 4] {
    match mesh.colors.as_ref().unwrap() {
        Attribute::Point(values) | Attribute::Corner(values) => values[0],
    }
}

#[test]
fn models_are_replaced_where_their_mode_applies() {
    let loaded = load("draw_modes.usda", &ImportOptions::default());
    let paths: BTreeSet<&str> = loaded.paths().into_iter().collect();
    // What UsdGeomModelAPI::ComputeModelDrawMode says; what is not replaced shows its mesh.
    let expected = [
        "/World/Box",
        "/World/Computed",
        "/World/Cross",
        "/World/Default/T",
        "/World/Inherited",
        "/World/InstanceA",
        "/World/InstanceB",
        "/World/Many/Asset",
        "/World/NoModel/T",
        "/World/NotApplied/T",
        "/World/Origin",
        "/World/Plain",
    ];
    assert_eq!(paths, BTreeSet::from(expected));
    // z up becomes y up.
    assert_eq!(loaded.origin("/World/InstanceB"), [30.0, 0.0, 0.0]);
    let instanced: Vec<f64> = loaded.all("/World/Many/Asset").iter().map(|i| i.transform.translation.y).collect();
    assert_eq!(instanced, [10.0, 20.0]);
    // What looks the same is one mesh.
    let meshes: HashSet<ShapeRef> =
        ["/World/Inherited", "/World/InstanceA", "/World/InstanceB"].map(|path| loaded.one(path).shape).into();
    assert_eq!(meshes.len(), 1);
    assert_eq!(loaded.all("/World/Many/Asset")[0].shape, loaded.one("/World/Inherited").shape);
}

/// Bars of 1/200 of the diagonal.
#[test]
fn bounds_and_origins_are_lines() {
    let loaded = load("draw_modes.usda", &ImportOptions::default());
    let inherited = mesh(&loaded, "/World/Inherited");
    // The diagonal of 2 by 4 by 6 is 7.48: half of a bar is 0.02.
    assert_eq!(bounds(inherited), [[-1.02, -2.02, -0.02], [1.02, 2.02, 6.02]]);
    assert_eq!(inherited.triangles.len(), 12 * 12);
    assert_eq!(of_color(inherited), [1.0, 0.5, 0.0, 1.0]);
    // BBoxCache of usd-core: the sphere of radius 4, moved by 5 along y and three times as high.
    let computed = mesh(&loaded, "/World/Computed");
    assert_eq!(bounds(computed).map(|corner| corner.map(f32::round)), [[-4.0, 1.0, -12.0], [4.0, 9.0, 12.0]]);
    assert_eq!(of_color(computed), [0.18, 0.18, 0.18, 1.0]);
    let origin = mesh(&loaded, "/World/Origin");
    assert_eq!((bounds(origin), origin.triangles.len()), ([[0.0; 3], [1.0; 3]], 3 * 12));
}

/// Corners of each quad with its UVs, as `(x, y, z, u, v)`, v upwards.
fn corners(mesh: &MeshDesc, set: usize) -> Vec<[f32; 5]> {
    let Attribute::Point(uvs) = &mesh.uvs[set] else { panic!() };
    mesh.points.iter().zip(uvs).map(|(p, uv)| [p[0], p[1], p[2], uv[0], 1.0 - uv[1]]).collect()
}

#[test]
fn cards_lie_about_the_bounds() {
    let loaded = load("draw_modes.usda", &ImportOptions::default());
    let of = |path: &str| {
        let instance = loaded.one(path);
        let names: Vec<&str> =
            instance.materials.iter().map(|m| &*loaded.scene.materials[m.unwrap() as usize].name).collect();
        (mesh(&loaded, path), names)
    };
    // Without pictures three quads across the middle, seen from both sides.
    let (plain, names) = of("/World/Plain");
    assert_eq!((plain.triangles.len(), names), (6, vec!["displayColor"]));
    assert_eq!((bounds(plain), of_color(plain)), ([[-1.0, -2.0, 0.0], [1.0, 2.0, 6.0]], [1.0, 0.5, 0.0, 1.0]));

    // A box with a picture for x and one for −z: the faces of y are left out, those opposite share.
    let (boxed, names) = of("/World/Box");
    assert_eq!(names, ["displayColor", "Box.model:cardTextureXPos", "Box.model:cardTextureZNeg"]);
    assert_eq!(boxed.material_slots.as_deref(), Some(&[1, 1, 1, 1, 2, 2, 2, 2][..]));
    assert!(boxed.colors.is_none());
    let found = corners(boxed, 1);
    // Seen from +x, y goes to the right; from behind it is the same picture.
    for x in [1.0, -1.0] {
        for (y, z, u, v) in [(-2.0, 0.0, 0.0, 0.0), (2.0, 0.0, 1.0, 0.0), (2.0, 6.0, 1.0, 1.0)] {
            assert!(found[..8].contains(&[x, y, z, u, v]), "{x} {y} {z} is not at {u} {v} in {found:?}");
        }
    }
    // Seen from −z with x to the right, y goes down.
    for (x, y, u, v) in [(-1.0, 2.0, 0.0, 0.0), (1.0, -2.0, 1.0, 1.0)] {
        assert!(found[8..].contains(&[x, y, 0.0, u, v]) && found[8..].contains(&[x, y, 6.0, u, v]), "{found:?}");
    }
    // Front faces look outwards.
    let outward = |[a, b, c]: &[u32; 3]| {
        let [a, b, c] = [a, b, c].map(|&i| penumbra::math::Vec3::from(boxed.points[i as usize]));
        (b - a).cross(c - a).dot(a - penumbra::math::Vec3::new(0.0, 0.0, 3.0)) > 0.0
    };
    assert!(boxed.triangles.iter().all(outward));
    assert!(loaded.said_of("missing.png").contains("/World/Box.model:cardTextureZNeg"));

    // One quad for x, as both sides show one picture; two for y, a little apart.
    let (cross, _) = of("/World/Cross");
    assert_eq!(cross.triangles.len(), 6);
    let ys: BTreeSet<String> = cross.points[4..].iter().map(|p| format!("{:.5}", p[1])).collect();
    assert_eq!(ys, BTreeSet::from(["-0.00037".to_string(), "0.00037".to_string()]));
    assert!(cross.points[..4].iter().all(|p| p[0] == 0.0));
}

/// A card for each picture that says where it stands; others are told.
#[test]
fn cards_may_stand_where_their_pictures_say() {
    use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage};
    let folder = tempfile::tempdir().unwrap();
    // Row vectors: x / 2, y / 4, and z less 3 to the screen.
    let to_screen = [0.5, 0.0, 0.0, 0.0, 0.0, 0.25, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -3.0, 1.0];
    let write = |name: &str, matrix: Option<[f32; 16]>| {
        let channels = ["R", "G", "B"].map(|name| AnyChannel::new(name, FlatSamples::F32(vec![0.5])));
        let attributes = LayerAttributes { world_to_normalized_device: matrix, ..LayerAttributes::named("x") };
        let channels = AnyChannels::sort(channels.into_iter().collect());
        let layer = Layer::new((1, 1), attributes, Encoding::UNCOMPRESSED, channels);
        Image::from_layer(layer).write().to_file(folder.path().join(name)).unwrap();
    };
    write("there.exr", Some(to_screen));
    write("nowhere.exr", None);
    write("flat.exr", Some([0.0; 16]));
    let text = r#"#usda 1.0
( metersPerUnit = 1 upAxis = "Y" )
def Xform "A" ( kind = "component" prepend apiSchemas = ["GeomModelAPI"] )
{
    uniform token model:drawMode = "cards"
    uniform token model:cardGeometry = "fromTexture"
    asset model:cardTextureXPos = @there.exr@
    asset model:cardTextureYPos = @nowhere.exr@
    asset model:cardTextureZPos = @flat.exr@
}
def Xform "B" ( kind = "component" prepend apiSchemas = ["GeomModelAPI"] )
{
    uniform token model:drawMode = "bounds"
}
def Xform "C" ( kind = "component" prepend apiSchemas = ["GeomModelAPI"] )
{
    uniform token model:drawMode = "sketch"
}
"#;
    let path = folder.path().join("stage.usda");
    std::fs::write(&path, text).unwrap();
    let loaded = try_load(&path, &ImportOptions::default()).unwrap();
    assert_eq!(loaded.paths(), ["/A"]);
    let expected = [
        [-2.0, 4.0, 3.0, 0.0, 0.0],
        [-2.0, -4.0, 3.0, 0.0, 1.0],
        [2.0, -4.0, 3.0, 1.0, 1.0],
        [2.0, 4.0, 3.0, 1.0, 0.0],
    ];
    assert_eq!(corners(mesh(&loaded, "/A"), 1), expected);
    assert!(loaded.said_of("nowhere.exr").contains("/A.model:cardTextureYPos"));
    assert!(loaded.said_of("cardTextureZPos").contains("no inverse"));
    assert!(loaded.said_of("/B").contains("nothing whose bounds"));
    assert!(loaded.said_of("/C").contains("'sketch' is not known"));
}
