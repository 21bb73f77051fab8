//! Which material is bound: near and far, strong and weak, by collection, by purpose. The answers are those
//! of UsdShadeMaterialBindingAPI::ComputeBoundMaterial("full").

use penumbra::import::ImportOptions;

use super::load;

#[test]
fn bindings_are_those_of_openusd() {
    let loaded = load("bindings_all.usda", &ImportOptions::default());
    let expected = [
        // A collection of the asset beats what is bound directly; both are nearer than those of the world.
        ("/World/First/Geo/A", "Red"),
        ("/World/First/Geo/B", "Grey"),
        // A collection of the world that is stronger than what is bound below.
        ("/World/Second/Geo/A", "Strong"),
        ("/World/Second/Geo/B", "Strong"),
        ("/World/Third/Geo/A", "Red"),
        ("/World/Near", "Near"),
        ("/World/NearFull", "Near"),
        ("/World/Preview", "All"),
    ];
    for (path, material) in expected {
        assert_eq!(loaded.material(path), material, "{path}");
    }
    // All instances have the same materials and meshes, whatever else is bound to them.
    let [first, second, third] = ["First", "Second", "Third"].map(|i| loaded.one(&format!("/World/{i}/Geo/A")));
    assert_eq!(first.materials, third.materials);
    assert_eq!((first.shape, first.shape), (second.shape, third.shape));
    let none = loaded.material("/Unbound");
    assert!(!expected.iter().any(|(_, material)| *material == none), "{none}");
    // What is bound but does not exist hides what is bound above.
    assert_eq!(loaded.material("/World/Gone"), none);
    loaded.said_of("/World/Gone: is bound to /World/Looks/Gone, which is not a material; nothing is bound");
}

#[test]
fn the_purpose_full_comes_before_all_purpose_bindings_however_near() {
    let loaded = load("bindings.usda", &ImportOptions::default());
    for path in ["/World/First/Geo/A", "/World/Second/Geo/B", "/World/Near", "/World/Preview"] {
        assert_eq!(loaded.material(path), "Full", "{path}");
    }
    assert_eq!(loaded.material("/World/NearFull"), "Near");
}

#[test]
fn a_collection_takes_the_strength_of_what_is_bound_beside_it() {
    let loaded = load("strong.usda", &ImportOptions::default());
    // OpenUSD's.
    assert_eq!((loaded.material("/Set/A"), loaded.material("/Set/B")), ("Metal", "Plain"));
}
