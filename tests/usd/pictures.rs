//! The pictures that a stage asks for, from the command line: each with its camera, its size and its passes.

use std::path::Path;
use std::process::{Command, Output};

use penumbra::film::Picture;
use penumbra::output::exr;

use super::stage;

fn render(folder: &Path, args: &[&str]) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_penumbra"));
    program.current_dir(folder).arg("render").arg(stage("pictures.usda")).args(args).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn read(folder: &Path, name: &str) -> Picture {
    exr::read(&folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn names(picture: &Picture) -> Vec<&str> {
    picture.layers.iter().map(|layer| layer.name.trim_start_matches("ViewLayer.")).collect()
}

/// The first channel of a layer.
fn first(picture: &Picture, layer: &str) -> Vec<f32> {
    let layer = picture.layer(layer).unwrap_or_else(|| panic!("{layer}"));
    layer.data.iter().step_by(layer.channels.len()).copied().collect()
}

#[test]
fn each_product_has_the_camera_and_the_size_that_it_asks_for() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let output = render(folder, &["--spp", "4", "--filter", "box:1"]);
    let told = said(&output);
    assert!(output.status.success(), "{told}");
    // One render for each view, and none is told as left out.
    for line in ["front.exr, data.exr: 8x4, camera Front", "away.exr: 6x5, camera Away", "part.exr: 16x2, camera Front"]
    {
        assert!(told.contains(line), "{line} is not in\n{told}");
    }
    assert!(!told.contains("is not rendered"), "{told}");
    let front = read(folder, "front.exr");
    assert_eq!((front.width, front.height, names(&front)), (8, 4, vec!["Combined"]));
    // The wall is two of eight units wide, the ball is in the seventh.
    let row: Vec<bool> = first(&front, "Combined")[8..16].iter().map(|red| *red > 0.1).collect();
    assert_eq!(row[1..7], [false, false, true, true, false, true]);
    let away = read(folder, "away.exr");
    assert_eq!((away.width, away.height, names(&away)), (6, 5, vec!["Combined", "Depth"]));
    assert!(first(&away, "Combined").iter().all(|red| *red == 0.0));
    let part = read(folder, "part.exr");
    assert_eq!((part.width, part.height, names(&part)), (16, 2, vec!["Depth"]));
    // Pixels of one and a half units, the first of them twelve from the middle: the cube is at −10 to −8.
    let row: Vec<usize> = (0..16).filter(|x| first(&part, "Depth")[*x] < 100.0).collect();
    assert_eq!(row, [1, 2, 7, 8]);
    let meta = ::exr::meta::MetaData::read_from_file(folder.join("part.exr"), false).unwrap();
    let header = &meta.headers[0];
    let display = header.shared_attributes.display_window;
    assert_eq!((display.position.x(), display.position.y(), display.size.x(), display.size.y()), (0, 0, 8, 4));
    let data = header.own_attributes.layer_position;
    assert_eq!((data.x(), data.y(), header.shared_attributes.pixel_aspect), (-4, 2, 1.5));
}

#[test]
fn what_is_typed_counts_for_every_picture() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let output = render(folder, &["--spp", "1", "--camera", "Front", "--size", "4x2"]);
    let told = said(&output);
    assert!(output.status.success(), "{told}");
    // What is left of the differences is the part that one shows.
    assert!(told.contains("front.exr, away.exr, data.exr: 4x2") && told.contains("part.exr: 8x1"), "{told}");
    let output = render(folder, &["--spp", "1", "-o", "one.exr"]);
    let told = said(&output);
    assert!(output.status.success() && told.contains("asks for 4 pictures; one is written"), "{told}");
    let one = read(folder, "one.exr");
    // The passes of the pictures that show the same.
    let expected = ["Combined", "primvars:wet", "primvars:wind", "primvars:part_id", "Peye", "Neye"];
    assert_eq!((one.width, one.height, names(&one)), (8, 4, expected.to_vec()));
}

#[test]
fn primvars_are_shown_where_shapes_have_them() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let output = render(folder, &["--spp", "64", "--filter", "box:1"]);
    let told = said(&output);
    assert!(output.status.success(), "{told}");
    for what in ["/Render/Wet: 2 of 3 shapes have no primvar wet", "/Render/Id: 2 of 3 shapes have no primvar part_id"]
    {
        assert!(told.contains(what), "{what} is not in\n{told}");
    }
    let data = read(folder, "data.exr");
    // Columns 3 and 4 are the wall, 6 and 7 the ball.
    let row = |layer: &str| first(&data, layer)[8..16].to_vec();
    assert_eq!(row("primvars:wet"), [0.0, 0.0, 0.0, 0.25, 0.25, 0.0, 0.0, 0.0]);
    assert!(row("primvars:part_id")[6] > 1.0 && row("primvars:part_id")[3] == 0.0);
    // From −3 to 1 over two units: means of −2 and 0, as far as 64 samples know.
    let wind = row("primvars:wind");
    assert!((wind[3] + 2.0).abs() < 0.1 && wind[4].abs() < 0.1 && wind[6] == 0.0, "{wind:?}");
    let layer = data.layer("primvars:wind").unwrap();
    assert_eq!(layer.channels.concat(), "RGBA");
    assert_eq!(layer.pixel(8, 3, 1)[1..], [0.0, 5.0, 1.0]);
    // As the camera has them, nine units away.
    let near = |layer: &str, expected: [f32; 4]| {
        let found = data.layer(layer).unwrap().pixel(8, 3, 1);
        assert!((1..4).all(|i| (found[i] - expected[i]).abs() < 0.1), "{layer}: {found:?}");
        assert!((found[2] - expected[2]).abs() < 1e-5, "{layer}: {found:?}");
    };
    near("Peye", [0.0, 0.5, -9.0, 1.0]);
    near("Neye", [0.0, 0.0, 1.0, 1.0]);
}
