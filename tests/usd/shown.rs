//! Visibility, purpose, units and the up axis.

use penumbra::import::{ImportOptions, Purpose};

use super::load;

fn showing(purposes: &[Purpose]) -> ImportOptions {
    ImportOptions { purposes: purposes.to_vec(), ..ImportOptions::default() }
}

#[test]
fn purposes_are_shown_as_asked() {
    let paths = |purposes: &[Purpose]| {
        let loaded = load("shown.usda", &showing(purposes));
        loaded.paths().into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    // What usdview shows for the same choices; the invisible mesh in none.
    let default = ["/Set/Proxy/AsDefault", "/Set/Reset"];
    assert_eq!(paths(&[]), default);
    assert_eq!(paths(&[Purpose::Render]), ["/Set/Render/T", default[0], default[1]]);
    assert_eq!(paths(&[Purpose::Proxy]), ["/Set/Proxy/T", default[0], default[1]]);
    assert_eq!(paths(&[Purpose::Guide]), [default[0], "/Set/Guide", default[1]]);
}

#[test]
fn the_world_is_y_up_in_metres() {
    let loaded = load("shown.usda", &showing(&[Purpose::Render]));
    // (100, 200, 300) centimetres, z up.
    assert_eq!(loaded.origin("/Set/Render/T"), [1.0, 3.0, -2.0]);
    // !resetXformStack! leaves out the parents, not the units of the stage.
    assert_eq!(loaded.origin("/Set/Reset"), [0.01, 0.03, -0.02]);
}
