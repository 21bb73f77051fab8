//! Colours of instances: primvars of point instancers, and what instances inherit.

use penumbra::desc::{Attribute, InstanceDesc};
use penumbra::import::ImportOptions;

use super::{Loaded, load};

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
