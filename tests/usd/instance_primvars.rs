//! Primvars of point instancers that have a value for each instance, for the materials that read them by name.

use penumbra::desc::InstanceDesc;
use penumbra::import::ImportOptions;

use super::{Loaded, load};

fn value(instance: &InstanceDesc, name: &str) -> Option<[f64; 4]> {
    instance.info.attributes.iter().find(|(of, _)| &**of == name).map(|(_, value)| *value)
}

fn values(loaded: &Loaded, path: &str, name: &str) -> Vec<Option<[f64; 4]>> {
    loaded.all(path).into_iter().map(|instance| value(instance, name)).collect()
}

/// A color or a vector of those places.
fn all<const N: usize>(values: [[f64; 3]; N]) -> Vec<Option<[f64; 4]>> {
    values.iter().map(|[x, y, z]| Some([*x, *y, *z, 1.0])).collect()
}

#[test]
fn instances_have_values_of_their_own_and_share_their_shape() {
    let loaded = load("instance_primvars.usda", &ImportOptions::default());
    let path = "/World/Many/Leaf";
    // As UsdGeomPrimvarsAPI flattens them: [(1, 0, 0), (0, 1, 0), (0, 1, 0), (0, 0, 1)].
    assert_eq!(values(&loaded, path, "tint"), all([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]));
    // Two numbers, which are no texture coordinates where each instance has its own.
    assert_eq!(values(&loaded, path, "cell"), all([[0.0, 1.0, 0.0], [2.0, 3.0, 0.0], [6.0, 7.0, 0.0]]));
    assert_eq!(values(&loaded, path, "displayColor"), all([[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [1.0, 1.0, 1.0]]));
    let shapes: Vec<_> = loaded.all(path).into_iter().map(|instance| instance.shape).collect();
    assert!(shapes.iter().all(|shape| *shape == shapes[0]));
    // A constant is inherited by the prototype, and is not the instance's.
    assert_eq!(values(&loaded, path, "rough"), [None; 3]);
    let mesh = loaded.scene.mesh(loaded.all(path)[0]).unwrap();
    let rough = mesh.attributes.iter().find(|attribute| &*attribute.name == "rough").expect("it is inherited");
    assert_eq!(rough.values, penumbra::desc::Attribute::Point(vec![[0.125; 4]; 3]));
    // Of a material that reads none nothing is kept.
    assert!(loaded.one("/World/Many/Plain").info.attributes.is_empty());
}

#[test]
fn the_innermost_instance_that_has_a_value_counts() {
    let loaded = load("instance_primvars.usda", &ImportOptions::default());
    let path = "/World/Outer/Inner/Leaf";
    let tint = [[1.0, 1.0, 0.0], [0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 0.0]];
    assert_eq!(values(&loaded, path, "tint"), all(tint));
    let rough: Vec<f64> = values(&loaded, path, "rough").into_iter().map(|v| v.unwrap()[0]).collect();
    assert_eq!(rough, [0.5, 0.5, 1.0, 1.0]);
}

#[test]
fn values_that_are_too_few_are_told() {
    let loaded = load("instance_primvars.usda", &ImportOptions::default());
    assert_eq!(values(&loaded, "/World/Short/Leaf", "tint"), [None; 2]);
    let said = loaded.said_of("/World/Short");
    assert!(said.contains("/World/Short.primvars:tint") && said.contains("has 1 values"), "{said}");
    assert_eq!(loaded.said.len(), 1, "{:?}", loaded.said);
}
