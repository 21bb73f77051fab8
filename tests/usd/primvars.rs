//! Primvars that materials name.

use penumbra::desc::{Attribute, ShapeRef};
use penumbra::import::ImportOptions;

use super::{Loaded, load};

/// The values of a mesh by name; `None` where it has none.
fn of_mesh<'a>(loaded: &'a Loaded, path: &str, name: &str) -> Option<&'a Attribute<[f32; 4]>> {
    let mesh = loaded.scene.mesh(loaded.one(path)).expect("a mesh");
    mesh.attributes.iter().find(|attribute| &*attribute.name == name).map(|attribute| &attribute.values)
}

/// The values of strands or balls by name.
fn of_rounds(loaded: &Loaded, path: &str, name: &str) -> Vec<[f32; 4]> {
    let ShapeRef::Rounds(i) = loaded.one(path).shape else { panic!("{path} is not round") };
    let found = loaded.scene.rounds[i as usize].attributes.iter().find(|(of, _)| &**of == name);
    found.map(|(_, values)| values.clone()).unwrap_or_default()
}

fn all(values: &[f32]) -> Vec<[f32; 4]> {
    values.iter().map(|x| [*x; 4]).collect()
}

#[test]
fn shapes_carry_what_their_material_names() {
    let loaded = load("primvars.usda", &ImportOptions::default());
    // Uniform and indexed: a color for all corners of the two triangles of each face.
    let (blue, green) = ([0.0, 0.0, 1.0, 1.0], [0.0, 1.0, 0.0, 1.0]);
    let faces = [[blue; 6], [green; 6]].concat();
    assert_eq!(of_mesh(&loaded, "/World/Faces", "tint"), Some(&Attribute::Corner(faces)));
    // Inherited.
    assert_eq!(of_mesh(&loaded, "/World/Faces", "rough"), Some(&Attribute::Point(all(&[0.75; 6]))));
    let corners = all(&[0.0, 0.125, 0.25, 0.375, 0.5, 0.625]);
    assert_eq!(of_mesh(&loaded, "/World/Corners", "rough"), Some(&Attribute::Corner(corners)));
    let points = (0..4).map(|i| [1.0, 2.0, 3.0, 4.0].map(|x| x + 4.0 * i as f32)).collect();
    assert_eq!(of_mesh(&loaded, "/World/Corners", "tint"), Some(&Attribute::Point(points)));
    // Refined like everything else: the middle of 0 and 4 is there now.
    let Some(Attribute::Point(smooth)) = of_mesh(&loaded, "/World/Smooth", "rough") else { panic!() };
    assert!(smooth.contains(&[2.0; 4]) && smooth.contains(&[1.0; 4]), "{smooth:?}");
    // Two numbers; and a sphere that has them is not the same shape as one that has not.
    let Some(Attribute::Point(ball)) = of_mesh(&loaded, "/World/Ball", "tint") else { panic!() };
    assert!(ball.iter().all(|value| *value == [3.0, 4.0, 0.0, 1.0]));
    assert_ne!(loaded.one("/World/Ball").shape, loaded.one("/World/Other").shape);
    // The material's fallback is taken where there is none.
    assert_eq!(of_mesh(&loaded, "/World/Smooth", "tint"), None);
    assert_eq!(of_mesh(&loaded, "/World/Other", "tint"), None);
    assert!(loaded.said_of("/World/Other").contains("a value of type String"), "{:?}", loaded.said);
    assert_eq!(loaded.said.len(), 1, "{:?}", loaded.said);
}

#[test]
fn strands_and_balls_carry_them_too() {
    let loaded = load("primvars.usda", &ImportOptions::default());
    assert_eq!(of_rounds(&loaded, "/World/Wires", "rough"), all(&[0.0, 1.0, 2.0, 3.0]));
    let (a, b) = ([1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 2.0, 1.0]);
    assert_eq!(of_rounds(&loaded, "/World/Wires", "tint"), [a, a, b, b]);
    assert_eq!(of_rounds(&loaded, "/World/Dust", "rough"), all(&[5.0, 6.0]));
}

#[test]
fn what_no_material_names_is_not_kept() {
    let loaded = load("primvars.usda", &ImportOptions::default());
    assert!(loaded.scene.mesh(loaded.one("/Unbound")).unwrap().attributes.is_empty());
}
