//! Instances: native ones, nested, and point instancers.

use std::collections::BTreeSet;

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
    let mesh = |path| loaded.one(path).mesh;
    let meshes: BTreeSet<u32> = nested.map(|(path, _)| mesh(path)).into();
    assert_eq!(meshes.len(), 1);
    // An inherited primvar may change the mesh, but once for all that inherit the same value.
    assert_eq!(mesh("/World/Colored/T"), mesh("/World/AlsoColored/T"));
    assert_eq!(loaded.scene.instances.len(), 7);
}

#[test]
fn a_prototype_has_its_materials_once() {
    let loaded = load("instances.usda", &ImportOptions::default());
    let of = |path| loaded.one(path).materials[0];
    let own: BTreeSet<Option<u32>> =
        ["/World/One/A/T", "/World/One/B/T", "/World/Two/A/T", "/World/Colored/T"].map(of).into();
    assert_eq!(own.len(), 1, "{own:?}");
    // What is bound to one instance, more strongly than what is bound within.
    assert!(loaded.material("/World/Bound/T").contains("Strong"), "{}", loaded.material("/World/Bound/T"));
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
        let meshes: BTreeSet<u32> = loaded.scene.instances.iter().map(|i| i.mesh).collect();
        assert_eq!(meshes.len(), 2);
    }
}
