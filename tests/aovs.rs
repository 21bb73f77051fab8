//! What materials and the background give as AOVs: where it is seen, how it is weighted, what is asked for.

#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use penumbra::desc::graph::{Graph, Leaf, PathInfo};
use penumbra::desc::{
    AlphaMode, AovDesc, AovKind, AovOutput, BackgroundAovs, ColorInput, MaterialDesc, ScalarInput, SceneDesc,
};
use penumbra::film::Picture;
use penumbra::scene::{View, prepare};
use penumbra::settings::{EffectsMode, Integrator, Settings};
use scene::{Builder, close, mean, picture, settings};

const DOWN: [f64; 3] = [0.0, -1.0, 0.0];

fn given(name: &str, color: [f64; 3], value: f64) -> AovOutput {
    AovOutput { name: name.into(), color: ColorInput::constant(color), value: ScalarInput::constant(value) }
}

/// A builder that declares `tint`, `mark` and `empty`, which no material gives.
fn declared() -> Builder {
    let mut builder = Builder::default();
    let aov = |name: &str, kind| AovDesc { name: name.into(), kind };
    let (color, value) = (AovKind::Color, AovKind::Value);
    builder.desc.render.aovs = vec![aov("tint", color), aov("mark", value), aov("empty", color)];
    builder.dome(1.0);
    builder
}

/// A square of half a metre's half side at height `y`.
fn square(builder: &mut Builder, y: f64, material: MaterialDesc) {
    let material = builder.material(material);
    builder.quad([-0.5, y, 0.5], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0], material);
}

/// The two AOVs of a square that lies over another, which gives 40 and (10, 20, 30).
fn over_another(top: MaterialDesc, settings: &Settings, change: impl FnOnce(&mut SceneDesc)) -> [f64; 5] {
    let mut builder = declared();
    let aovs = vec![given("tint", [0.5, -1.0, 4.0], 7.0), given("mark", [9.0; 3], 2.0)];
    square(&mut builder, 1.0, MaterialDesc { aovs, ..top });
    let aovs = vec![given("mark", [0.0; 3], 40.0), given("tint", [10.0, 20.0, 30.0], 0.0)];
    square(&mut builder, 0.0, MaterialDesc { aovs, ..MaterialDesc::default() });
    builder.look([0.0, 1.0, 0.0], DOWN, 0.25);
    change(&mut builder.desc);
    all_of(&picture(&builder.desc, 8, settings))
}

/// Means of the channels of `tint` and of `mark`.
fn all_of(picture: &Picture) -> [f64; 5] {
    let tint = |channel| mean(picture, "tint", channel);
    [tint(0), tint(1), tint(2), tint(3), mean(picture, "mark", 0)]
}

fn thin(alpha: f64) -> MaterialDesc {
    MaterialDesc { alpha: ScalarInput::constant(alpha), alpha_mode: AlphaMode::Blend, ..MaterialDesc::default() }
}

const TOP: [f64; 5] = [0.5, -1.0, 4.0, 1.0, 2.0];

#[test]
fn aovs_are_layers_of_the_order_in_which_they_are_declared_and_count_by_coverage() {
    let mut builder = declared();
    let aovs =
        vec![given("tint", [0.5, -1.0, 4.0], 7.0), given("mark", [9.0; 3], 2.0), given("stranger", [1.0; 3], 1.0)];
    square(&mut builder, 0.0, MaterialDesc { aovs, ..MaterialDesc::default() });
    // Two thirds of the picture and the edges of its pixels are beside the square.
    builder.look([0.0; 3], DOWN, 0.5 * 3.0_f64.sqrt());
    builder.desc.cameras[0].exposure = 16.0;
    let at = Settings { filter: penumbra::film::Filter::parse("box:1").unwrap(), ..settings("all", 256) };
    let picture = picture(&builder.desc, 7, &at);
    let layers: Vec<(&str, String)> =
        picture.layers.iter().map(|layer| (layer.name.as_str(), layer.channels.concat())).collect();
    let own = |(name, _): &&(&str, String)| ["tint", "mark", "empty"].contains(name);
    let own: Vec<_> = layers.iter().filter(own).map(|(name, channels)| (*name, channels.as_str())).collect();
    assert_eq!(own, [("tint", "RGBA"), ("mark", "X"), ("empty", "RGBA")]);
    assert!(!layers.iter().any(|(name, _)| *name == "stranger"));
    for (found, expected) in all_of(&picture).into_iter().zip(TOP) {
        close("coverage", found, expected / 3.0, 3e-3);
    }
    (0..4).for_each(|channel| assert_eq!(mean(&picture, "empty", channel), 0.0));
}

/// As in Cycles: each surface as it is, down to the first that is opaque enough.
#[test]
fn what_is_too_thin_is_added_to_what_lies_behind() {
    let of = |top, settings: &Settings| over_another(top, settings, |_| ());
    let all = settings("aov:*", 1024);
    assert_eq!(of(MaterialDesc::default(), &all), TOP);
    for (found, [top, below]) in
        of(thin(0.25), &all).into_iter().zip([[0.5, 10.0], [-1.0, 20.0], [4.0, 30.0], [1.0, 1.0], [2.0, 40.0]])
    {
        close("alpha of 0.25", found, top + 0.75 * below, 3e-3);
    }
    // Beyond the threshold nothing behind counts, though it is seen.
    assert_eq!(of(thin(0.75), &all), TOP);
    assert_eq!(over_another(thin(0.25), &all, |desc| desc.render.pass_alpha_threshold = 0.0), TOP);
    // What lets all of a color pass is no chance: both are there.
    let black = ScalarInput::constant(0.0);
    let glass = MaterialDesc {
        base_color: ColorInput::constant([0.0; 3]),
        specular: black,
        transparency: ColorInput::constant([0.5, 0.25, 1.0]),
        ..MaterialDesc::default()
    };
    let pane = of(glass, &all)[4];
    assert!(pane > 2.0 && pane <= 42.0, "{pane}");
}

#[test]
fn a_hole_in_the_picture_has_its_aovs() {
    let all = settings("aov:*", 4);
    assert_eq!(over_another(MaterialDesc { holdout: true, ..MaterialDesc::default() }, &all, |_| ()), TOP);
    assert_eq!(over_another(MaterialDesc::default(), &all, |desc| desc.instances[0].holdout = true), TOP);
}

#[test]
fn every_integrator_and_every_effect_give_the_same() {
    let path = settings("all", 16);
    let expected = over_another(thin(0.25), &path, |_| ());
    for settings in [
        Settings { integrator: Integrator::Ao, ..path.clone() },
        Settings { integrator: Integrator::Direct, ..path.clone() },
        Settings { effects: EffectsMode::All, ..path },
        settings("aov:mark,aov:tint", 16),
    ] {
        assert_eq!(over_another(thin(0.25), &settings, |_| ()), expected);
    }
}

#[test]
fn what_is_not_asked_for_is_not_there() {
    let mut builder = declared();
    let mut graph = Graph::default();
    let which = graph.leaf(Leaf::Path(PathInfo::Depth));
    let aovs = vec![AovOutput { value: ScalarInput::graph(which), ..given("mark", [0.0; 3], 0.0) }];
    square(&mut builder, 0.0, MaterialDesc { graph, aovs, ..MaterialDesc::default() });
    builder.look([0.0; 3], DOWN, 0.25);
    let effects = |passes: &str| {
        let prepared = prepare(builder.desc.clone(), &View::default(), &settings(passes, 1)).unwrap();
        (prepared.scene.effects.aovs, prepared.scene.effects.light_path)
    };
    assert_eq!(effects("aov:mark"), (true, true));
    assert_eq!(effects("combined,aov:tint"), (true, false));
    assert_eq!(effects("combined"), (false, false));
    let one = picture(&builder.desc, 2, &settings("aov:mark", 1));
    assert_eq!(one.layers.iter().map(|layer| layer.name.as_str()).collect::<Vec<_>>(), ["mark"]);
}

#[test]
fn names_that_are_unknown_or_taken_are_told() {
    let mut builder = declared();
    builder.look([0.0; 3], DOWN, 0.25);
    let refused = |desc: &SceneDesc, passes: &str| {
        prepare(desc.clone(), &View::default(), &settings(passes, 1)).err().expect("refused").to_string()
    };
    let unknown = refused(&builder.desc, "aov:tont");
    assert!(unknown.contains("there is no AOV 'tont'; the scene has: tint, mark, empty"), "{unknown}");
    builder.desc.render.aovs[0].name = "Normal".into();
    let taken = refused(&builder.desc, "all");
    assert!(taken.contains("'normal' and 'aov:Normal' would share the layer Normal"), "{taken}");
    builder.desc.render.aovs.clear();
    let none = refused(&builder.desc, "aov:*");
    assert!(none.contains("the scene has no AOVs"), "{none}");
}

/// A value of the graph is that of each point: here the world's x, over a picture half a metre wide.
#[test]
fn graphs_vary_over_the_surface() {
    let mut builder = declared();
    let mut graph = Graph::default();
    let position = graph.leaf(Leaf::Position);
    let (x, twice) = (graph.place(position, 0), graph.scale(position, 2.0));
    let aovs = vec![
        AovOutput { color: ColorInput::graph(twice), ..given("tint", [0.0; 3], 0.0) },
        AovOutput { value: ScalarInput::graph(x), ..given("mark", [0.0; 3], 0.0) },
    ];
    square(&mut builder, 0.0, MaterialDesc { graph, aovs, ..MaterialDesc::default() });
    builder.look([0.0; 3], DOWN, 0.25);
    let at_centres = penumbra::film::Filter::parse("triangle:0.01").unwrap();
    let picture = picture(&builder.desc, 8, &Settings { filter: at_centres, ..settings("aov:*,position", 1) });
    let [tint, mark, position] = ["tint", "mark", "Position"].map(|name| &picture.layer(name).unwrap().data);
    for i in 0..64 {
        let x = position[3 * i];
        assert!((mark[i] - x).abs() < 1e-3 && (tint[4 * i] - 2.0 * x).abs() < 2e-3, "{} {x}", mark[i]);
    }
    assert!(mark[0] != mark[7]);
}

#[test]
fn the_background_gives_what_the_camera_sees_of_it() {
    let mut builder = declared();
    let aovs = vec![given("mark", [0.0; 3], 2.0)];
    square(&mut builder, 0.0, MaterialDesc { aovs, ..thin(0.25) });
    let mut graph = Graph::default();
    let direction = graph.leaf(Leaf::Position);
    let (down, six) = (graph.place(direction, 1), graph.number(6.0));
    let outputs = vec![("mark".into(), [down, six]), ("tint".into(), [direction, six])];
    builder.desc.background_aovs = BackgroundAovs { graph, outputs };
    builder.look([0.0; 3], DOWN, 0.25);
    let all = settings("aov:*", 1024);
    let shown = all_of(&picture(&builder.desc, 8, &all));
    close("behind a pane", shown[4], 2.0 + 0.75 * 6.0, 5e-3);
    close("direction", shown[1], -0.75, 5e-3);
    close("count", shown[3], 0.75, 5e-3);
    let ao = all_of(&picture(&builder.desc, 8, &Settings { integrator: Integrator::Ao, ..all.clone() }));
    assert_eq!(ao, shown);
    builder.desc.render.film_transparent = Some(true);
    assert_eq!(all_of(&picture(&builder.desc, 8, &all)), [0.0, 0.0, 0.0, 0.0, 2.0]);
}
