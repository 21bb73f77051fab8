//! Colours of instances: primvars of point instancers, and what instances inherit.

use penumbra::desc::{Attribute, InstanceDesc};
use penumbra::import::ImportOptions;

use super::{Loaded, load, scene};

/// Colours of all instances at `path`: that of the instance, or of the mesh with a note.
fn colors(loaded: &Loaded, path: &str) -> Vec<(&'static str, [f32; 4])> {
    let of = |instance: &InstanceDesc| match loaded.scene.mesh(instance).and_then(|mesh| mesh.colors.as_ref()) {
        Some(Attribute::Point(values) | Attribute::Corner(values)) => Some(values[0]),
        None => None,
    };
    let each = loaded.all(path).into_iter().map(|instance| match (instance.color, of(instance)) {
        (Some(color), None) => ("instance", color),
        (None, Some(color)) => ("mesh", color),
        (None, None) => ("none", [0.0; 4]),
        (Some(_), Some(_)) => panic!("{path} has two colours"),
    });
    each.collect()
}

#[test]
fn instances_of_a_point_instancer_have_colors_of_their_own() {
    let loaded = load("instance_colors.usda", &ImportOptions::default());
    // The only thing to tell: two values are one for all instances.
    assert!(loaded.said_of("displayColor").contains("/World/Constant"));
    assert_eq!(loaded.said.len(), 1);
    let each = [[0.0, 1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.5], [0.0, 1.0, 0.0, 0.25]].map(|color| ("instance", color));
    for mesh in ["T", "Bound"] {
        assert_eq!(colors(&loaded, &format!("/World/Many/Leaf/{mesh}")), each);
        let one = ("instance", [0.0, 1.0, 1.0, 1.0]);
        assert_eq!(colors(&loaded, &format!("/World/Constant/Leaf/{mesh}")), [one, one]);
        // Without, that which is inherited.
        let above = ("instance", [0.1, 0.1, 0.1, 1.0]);
        assert_eq!(colors(&loaded, &format!("/World/Without/Leaf/{mesh}")), [above]);
    }
    // What the prototype has goes first, and a material that shows no displayColor is not tinted.
    assert_eq!(colors(&loaded, "/World/Many/Leaf/Own"), [("mesh", [0.0, 0.0, 1.0, 1.0]); 3]);
    assert_eq!(colors(&loaded, "/World/Many/Leaf/Red"), [("none", [0.0; 4]); 3]);
}

#[test]
fn native_instances_share_their_mesh_whatever_color_they_inherit() {
    let loaded = load("instance_colors.usda", &ImportOptions::default());
    for mesh in ["T", "Bound"] {
        let [green, above] = ["Green", "Above"].map(|instance| format!("/World/{instance}/{mesh}"));
        assert_eq!(colors(&loaded, &green), [("instance", [0.0, 1.0, 0.0, 1.0])]);
        assert_eq!(colors(&loaded, &above), [("instance", [0.1, 0.1, 0.1, 1.0])]);
        assert_eq!(loaded.one(&green).shape, loaded.one(&above).shape);
    }
    assert_eq!(colors(&loaded, "/World/Green/Own"), [("mesh", [0.0, 0.0, 1.0, 1.0])]);
}

#[test]
fn faces_beside_a_subset_with_a_material_keep_their_colors() {
    let loaded = load("subset_colors.usda", &ImportOptions::default());
    loaded.said_nothing();
    let filter = penumbra::film::Filter::parse("triangle:0.01").unwrap();
    let settings = penumbra::settings::Settings { filter, ..scene::settings("diffuse_color", 1) };
    let picture = scene::picture(&loaded.scene, 4, &settings);
    let layer = picture.layer("Diffuse Color").expect("the layer");
    let n = layer.channels.len();
    // Own colours, none, and those of two instances; the right half has the material.
    let left = [[0.8, 0.1, 0.2], [0.5; 3], [0.9, 0.8, 0.1], [0.1, 0.7, 0.6]];
    for (row, left) in left.into_iter().enumerate() {
        for (column, expected) in [left, left, [0.25, 0.5, 0.75], [0.25, 0.5, 0.75]].into_iter().enumerate() {
            let found = &layer.data[(4 * row + column) * n..][..3];
            let close = found.iter().zip(expected).all(|(&a, b)| (f64::from(a) - b).abs() < 1e-3);
            assert!(close, "row {row}, column {column}: {found:?} instead of {expected:?}");
        }
    }
    assert_eq!(colors(&loaded, "/World/Covered"), [("none", [0.0; 4])]);
}
