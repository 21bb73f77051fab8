//! What plans say is what renders do: each effect by the scene that calls for it, and by one that does not.

#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use penumbra::desc::{AlphaMode, ColorInput, LensDesc, LightKind, MaterialDesc, ScalarInput, SceneDesc, Visibility};
use penumbra::film::PassSet;
use penumbra::math::{DAffine3, DVec3};
use penumbra::plan::{Plan, Row};
use penumbra::render::render;
use penumbra::scene::{View, prepare};
use penumbra::settings::{EffectsMode, Settings};
use scene::{Builder, settings};

/// A ball over ground under a lamp, both plain.
fn plain() -> Builder {
    let mut builder = Builder::default();
    let white = builder.lambert(0.7);
    builder.ground(20.0, white);
    builder.sphere(8, false, white, DAffine3::from_translation(DVec3::Y));
    let lamp = LightKind::Sphere { radius: 0.3, radiance: [6.0; 3], facing: false };
    builder.light(lamp, DAffine3::from_translation(DVec3::new(1.0, 3.0, 0.5)));
    builder.look([0.0, 0.5, 0.0], [0.0, -0.4, -1.0], 2.0);
    builder
}

const SIZE: [u32; 2] = [16, 12];

fn plan(desc: &SceneDesc, settings: &Settings) -> Plan {
    let prepared = prepare(desc.clone(), &View { camera: None, size: Some(SIZE) }, settings).unwrap();
    Plan::of(desc, &prepared, settings)
}

fn row(plan: &Plan, effect: &str) -> Row {
    plan.rows.iter().find(|row| row.effect == effect).unwrap_or_else(|| panic!("no row {effect}")).clone()
}

fn bits(desc: &SceneDesc, settings: &Settings) -> Vec<Vec<u32>> {
    let prepared = prepare(desc.clone(), &View { camera: None, size: Some(SIZE) }, settings).unwrap();
    let picture = render(&prepared.scene, settings, &()).unwrap().film.develop();
    picture.layers.iter().map(|layer| layer.data.iter().map(|x| x.to_bits()).collect()).collect()
}

/// Something that calls for an effect, by name, with what the reason has to hold.
type Case = (&'static str, fn(&mut Builder), &'static str);

/// Changes the material of the ball and the ground.
fn of_material(builder: &mut Builder, change: impl Fn(&mut MaterialDesc)) {
    for material in &mut builder.desc.materials {
        material.name = "matter".into();
        change(material);
    }
}

const CASES: &[Case] = &[
    ("depth of field", |b| b.desc.cameras[0].lens = Some(LensDesc::round(0.05, 4.0)), "100.000 mm"),
    ("cut-outs and transparency", |b| of_material(b, |m| m.transparency = ColorInput::constant([0.5; 3])), "matter"),
    ("refraction", |b| of_material(b, |m| m.transmission = ScalarInput::constant(1.0)), "matter"),
    ("metal", |b| of_material(b, |m| m.metallic = ScalarInput::constant(1.0)), "matter"),
    ("objects that emit", |b| of_material(b, |m| m.emission = ColorInput::constant([1.0; 3])), "matter"),
    ("holdouts", |b| b.desc.instances[1].holdout = true, "hole"),
    ("shadow catchers", |b| b.desc.instances[0].catcher = true, "object"),
    ("own shadows", |b| b.desc.lights[0].links.cast_shadow = false, "shadow of"),
    ("light linking", |b| b.desc.lights[0].links.response = [0.0, 1.0], "light"),
    ("domes", |b| b.dome(0.5), ""),
    (
        "bumps",
        |b| {
            of_material(b, |m| {
                use penumbra::desc::graph::{Bump, Leaf, Op};
                let [height, normal] = [Leaf::ObjectPosition, Leaf::Normal].map(|leaf| m.graph.leaf(leaf));
                let [strength, distance] = [1.0, 0.1].map(|value| m.graph.number(value));
                let bump = Bump { height, strength, distance, normal, filter_width: 0.1, object_space: false };
                let bent = m.graph.push(Op::Bump(bump));
                m.normal = Some(penumbra::desc::NormalInput::Graph(bent));
            })
        },
        "matter",
    ),
];

#[test]
fn each_effect_is_on_where_the_scene_calls_for_it_alone() {
    let settings = settings("combined", 2);
    let without = plan(&plain().desc, &settings);
    for (effect, add, reason) in CASES {
        assert!(!row(&without, effect).on, "{effect} is on in a plain scene");
        let mut builder = plain();
        add(&mut builder);
        let found = row(&plan(&builder.desc, &settings), effect);
        assert!(found.on && found.because.contains(reason), "{effect}: {found:?}");
    }
}

#[test]
fn forcing_all_effects_changes_no_bit_of_any_case() {
    let auto = settings("combined,ao,shadow,normal,diffuse_direct,mist", 4);
    let all = Settings { effects: EffectsMode::All, ..auto.clone() };
    for (effect, add, _) in CASES {
        let mut builder = plain();
        add(&mut builder);
        assert!(bits(&builder.desc, &auto) == bits(&builder.desc, &all), "{effect}");
    }
}

#[test]
fn passes_are_named_as_what_calls_for_their_rays() {
    let desc = plain().desc;
    for (passes, effect) in
        [("ao", "ambient occlusion"), ("shadow", "shadow"), ("crypto_object", "cryptomatte"), ("mist", "mist")]
    {
        let found = row(&plan(&desc, &settings(passes, 2)), effect);
        assert!(found.on && found.because.contains(passes), "{passes}: {found:?}");
        assert!(!row(&plan(&desc, &settings("combined", 2)), effect).on);
    }
    let alone = plan(&desc, &settings("ao", 2));
    assert!(!row(&alone, "indirect light").on && !row(&alone, "sphere lights").on, "light for ao alone");
    let errors = Settings { passes: PassSet::parse("combined").unwrap(), error: Some(0.1), ..Settings::default() };
    assert!(row(&plan(&desc, &errors), "error estimate").because.contains("--error"));
}

/// What is left out for passes that don't ask for it is no part of those.
#[test]
fn a_pass_alone_has_the_bits_that_it_has_beside_others() {
    for (effect, add, _) in CASES {
        let mut builder = plain();
        add(&mut builder);
        let layers = |passes: &str| {
            let settings = settings(passes, 4);
            let view = View { camera: None, size: Some(SIZE) };
            let prepared = prepare(builder.desc.clone(), &view, &settings).unwrap();
            render(&prepared.scene, &settings, &()).unwrap().film.develop().layers
        };
        let together = layers("combined,ao,mist,normal,emission,environment,diffuse_color");
        for alone in ["ao", "mist", "normal", "emission", "environment", "diffuse_color"] {
            let alone = layers(alone).remove(0);
            let beside = together.iter().find(|layer| layer.name == alone.name).unwrap();
            assert!(alone.data == beside.data, "{effect}: {}", alone.name);
        }
    }
}

#[test]
fn what_can_not_be_seen_calls_for_nothing() {
    let settings = settings("combined", 2);
    // A lamp without power is no lamp.
    let mut dark = plain();
    dark.dome(0.5);
    dark.desc.lights[0].kind = LightKind::Sphere { radius: 0.3, radiance: [0.0; 3], facing: false };
    let prepared = prepare(dark.desc.clone(), &View { camera: None, size: Some(SIZE) }, &settings).unwrap();
    assert!(!prepared.scene.effects.lamps);
    let found = row(&plan(&dark.desc, &settings), "sphere lights");
    assert!(!found.on && found.because.contains("gives no light"), "{found:?}");
    // Glass that no ray may meet, and an alpha of 1.
    let mut hidden = plain();
    let clear = hidden.material(MaterialDesc {
        transparency: ColorInput::constant([1.0; 3]),
        transmission: ScalarInput::constant(1.0),
        ..MaterialDesc::default()
    });
    hidden.sphere(8, false, clear, DAffine3::from_translation(DVec3::new(0.0, 1.0, 2.0)));
    let last = hidden.desc.instances.len() - 1;
    let seen = plan(&hidden.desc, &settings);
    assert!(row(&seen, "refraction").on && row(&seen, "cut-outs and transparency").on);
    let none = Visibility { camera: false, diffuse: false, glossy: false, transmission: false, shadow: false };
    hidden.desc.instances[last].visibility = none;
    let unseen = plan(&hidden.desc, &settings);
    assert!(!row(&unseen, "refraction").on && !row(&unseen, "cut-outs and transparency").on);
    let all = Settings { effects: EffectsMode::All, ..settings.clone() };
    assert!(bits(&hidden.desc, &settings) == bits(&hidden.desc, &all));
    let mut opaque = plain();
    of_material(&mut opaque, |m| m.alpha_mode = AlphaMode::Blend);
    let found = row(&plan(&opaque.desc, &settings), "cut-outs and transparency");
    assert!(!found.on && found.because.contains("opaque everywhere"), "{found:?}");
}

#[test]
fn forced_effects_say_so() {
    let forced = Settings { effects: EffectsMode::All, ..settings("combined", 2) };
    let found = row(&plan(&plain().desc, &forced), "holdouts");
    assert!(found.on && found.because.starts_with("--effects all"), "{found:?}");
}

#[test]
fn the_command_prints_a_table_and_json() {
    let penumbra = |args: &[&str]| {
        let root = env!("CARGO_MANIFEST_DIR");
        std::process::Command::new(env!("CARGO_BIN_EXE_penumbra"))
            .arg("plan")
            .args(args)
            .current_dir(root)
            .output()
            .unwrap()
    };
    let wheel = "scenes/wheel.usda";
    let done = penumbra(&[wheel, "--passes", "combined,ao", "--size", "32x18", "--json"]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let told: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    let effect = |name: &str| {
        let rows = told["effects"].as_array().unwrap();
        rows.iter().find(|row| row["effect"] == name).unwrap_or_else(|| panic!("no {name}"))
    };
    assert!(told["seconds_a_sample"].as_f64().unwrap() > 0.0);
    assert_eq!(effect("motion blur")["on"], true);
    assert_eq!(effect("ambient occlusion")["because"], "--passes ao");
    assert!(effect("ambient occlusion")["share"].is_number(), "{}", effect("ambient occlusion"));
    assert_eq!(effect("refraction")["on"], false);
    let brief = penumbra(&[wheel, "--no-probe", "--brief"]);
    let text = String::from_utf8(brief.stdout).unwrap();
    assert!(text.contains("motion blur") && text.contains("not called for: ") && !text.contains("no surface has it"));
    let missing = penumbra(&["nowhere.usda"]);
    let said = String::from_utf8(missing.stderr).unwrap();
    assert!(missing.status.code() == Some(1) && said.starts_with("error: ") && said.contains("nowhere.usda"), "{said}");
}
