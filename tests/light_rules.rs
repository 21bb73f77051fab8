//! Shadow rules, linking, visibility and groups of lights, in whole renders, for every kind of light
//! and every strategy that finds it.

#[allow(dead_code)] // Not every test builds everything.
#[path = "support/scene.rs"]
mod scene;

use std::f64::consts::PI;

use penumbra::desc::{
    AlphaMode, ColorInput, LightKind, LightLinks, LinkSet, MaterialDesc, ScalarInput, ShadowDesc, Visibility,
};
use penumbra::math::{DAffine3, DVec3};
use penumbra::scene::{View, prepare};
use penumbra::settings::Settings;
use scene::{Builder, close, mean, picture, settings};

const DOWN: [f64; 3] = [0.0, -1.0, 0.0];

/// One light of each kind, two metres above the ground where it has a place.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Lamp(LightKind),
    Mesh,
}

fn kinds() -> Vec<(&'static str, Kind)> {
    let radiance = [3.0; 3];
    let lamp = |name, kind| (name, Kind::Lamp(kind));
    vec![
        lamp("point", LightKind::Point { intensity: [5.0; 3] }),
        lamp("sphere", LightKind::Sphere { radius: 0.5, radiance, facing: false }),
        lamp("soft sphere", LightKind::Sphere { radius: 0.5, radiance, facing: true }),
        lamp(
            "rectangle",
            LightKind::Rect { width: 1.5, height: 1.0, radiance, spread: PI, two_sided: false, image: None },
        ),
        lamp("disk", LightKind::Disk { width: 1.5, height: 1.0, radiance, spread: PI, two_sided: false }),
        lamp("cylinder", LightKind::Cylinder { radius: 0.2, length: 2.0, radiance }),
        lamp("sun without size", LightKind::Distant { irradiance: radiance, angle: 0.0 }),
        lamp("sun", LightKind::Distant { irradiance: radiance, angle: 0.5 }),
        lamp("dome", LightKind::Dome { radiance: [1.0; 3], image: None }),
        ("mesh", Kind::Mesh),
    ]
}

/// Ground that is half diffuse and half glossy, the light with `links` and `visibility`, and a camera
/// that looks straight at the ground between the light and it.
fn lit(kind: Kind, roughness: f64, links: LightLinks, visibility: Visibility) -> Builder {
    let mut builder = Builder::default();
    let ground = builder.material(MaterialDesc {
        base_color: ColorInput::constant([0.5; 3]),
        roughness: ScalarInput::constant(roughness),
        ..MaterialDesc::default()
    });
    builder.ground(40.0, ground);
    match kind {
        Kind::Lamp(kind) => {
            // Shines straight down.
            let transform =
                DAffine3::from_translation(DVec3::new(0.3, 2.0, 0.0)) * DAffine3::from_rotation_x(-0.5 * PI);
            builder.light(kind, transform);
            let light = builder.desc.lights.last_mut().unwrap();
            (light.links, light.visibility) = (links, visibility);
        }
        Kind::Mesh => {
            let glow = builder.material(MaterialDesc {
                base_color: ColorInput::constant([0.0; 3]),
                specular: ScalarInput::constant(0.0),
                emission: ColorInput::constant([3.0; 3]),
                ..MaterialDesc::default()
            });
            builder.quad([-0.5, 2.0, -0.5], [1.5, 0.0, 0.0], [0.0, 0.0, 1.0], glow);
            let instance = builder.desc.instances.last_mut().unwrap();
            (instance.links, instance.visibility) = (links, visibility);
        }
    }
    builder.look([0.0; 3], [0.4, -0.5, 0.1], 0.2);
    // Below every lid.
    builder.desc.cameras[0].transform.translation *= 0.5;
    builder
}

/// A box over the ground, open below: nothing from above or from the horizon gets in.
fn add_lid(builder: &mut Builder) -> u32 {
    let dark = builder.lambert(0.0);
    let corner = |i: usize| {
        let side = |bit: usize| if i >> bit & 1 == 0 { -9.0 } else { 9.0 };
        [side(0), if i & 4 == 0 { -1.0 } else { 1.0 }, side(1)]
    };
    let triangles = vec![[4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 3, 6], [3, 7, 6]];
    let sides = [[0, 2, 4], [2, 6, 4], [1, 3, 5], [3, 7, 5]];
    let points = (0..8).map(corner).collect();
    builder.mesh(points, triangles.into_iter().chain(sides).collect(), dark, DAffine3::IDENTITY);
    builder.desc.instances.len() as u32 - 1
}

fn direct(spp: u32) -> Settings {
    Settings { max_bounces: 0, ..settings("all", spp) }
}

/// Diffuse and glossy direct light, Combined, and the shadow passes' values.
fn values(builder: &Builder) -> [f64; 5] {
    let picture = picture(&builder.desc, 6, &direct(1024));
    ["Diffuse Direct", "Glossy Direct", "Combined", "Shadow", "Diffuse Direct Unshadowed"]
        .map(|layer| mean(&picture, layer, 0))
}

fn same(what: &str, a: [f64; 5], b: [f64; 5]) {
    for ((a, b), layer) in a.into_iter().zip(b).zip(["diffuse", "glossy", "combined", "shadow", "unshadowed"]) {
        assert!((a - b).abs() <= 0.02 * b.abs().max(1e-3), "{what}, {layer}: {a} and {b}");
    }
}

#[test]
fn light_that_casts_no_shadow_passes_everything_whichever_strategy_finds_it() {
    for (name, kind) in kinds() {
        for roughness in [0.0, 0.2, 0.6] {
            let what = format!("{name}, roughness {roughness}");
            let links = LightLinks { cast_shadow: false, ..LightLinks::default() };
            let free = values(&lit(kind, roughness, LightLinks::default(), Visibility::ALL));
            assert!(free[0] > 0.0, "{what}");
            let mut lidded = lit(kind, roughness, links, Visibility::ALL);
            add_lid(&mut lidded);
            same(&what, values(&lidded), free);
            // The lid does stop the light of a light that casts shadows.
            let mut dark = lit(kind, roughness, LightLinks::default(), Visibility::ALL);
            add_lid(&mut dark);
            let [diffuse, glossy, combined, shadow, unshadowed] = values(&dark);
            assert_eq!([diffuse, glossy, combined, shadow], [0.0; 4], "{what}");
            same(&what, [free[0], free[1], free[2], free[3], unshadowed], free);
        }
    }
}

#[test]
fn only_linked_objects_stop_a_light() {
    for (name, kind) in kinds() {
        let free = values(&lit(kind, 0.3, LightLinks::default(), Visibility::ALL));
        for (blocked, exclude) in [(false, true), (true, false)] {
            let mut builder = lit(kind, 0.3, LightLinks::default(), Visibility::ALL);
            let lid = add_lid(&mut builder);
            let set = Some(LinkSet { instances: vec![lid], exclude });
            match kind {
                Kind::Mesh => builder.desc.instances[1].links.blockers = set,
                Kind::Lamp(_) => builder.desc.lights[0].links.blockers = set,
            }
            let found = values(&builder);
            if blocked {
                assert_eq!(found[..4], [0.0; 4], "{name}");
            } else {
                same(name, found, free);
            }
        }
    }
}

/// UsdLux' `inputs:diffuse` and `inputs:specular`.
#[test]
fn factors_weigh_what_a_light_does_to_each_kind_of_scattering() {
    for (name, kind) in kinds() {
        for roughness in [0.0, 0.3] {
            let free = values(&lit(kind, roughness, LightLinks::default(), Visibility::ALL));
            let links = LightLinks { response: [0.25, 2.0], ..LightLinks::default() };
            let [diffuse, glossy, combined, shadow, unshadowed] = values(&lit(kind, roughness, links, Visibility::ALL));
            let expected = [0.25 * free[0], 2.0 * free[1], combined, free[3], 0.25 * free[4]];
            same(&format!("{name}, roughness {roughness}"), [diffuse, glossy, combined, shadow, unshadowed], expected);
            // Each share lies between what both factors would do to all of it.
            assert!((0.25 * free[2]..=2.0 * free[2]).contains(&combined), "{name}: {combined} of {}", free[2]);
        }
    }
}

/// Blender's lamps of negative power.
#[test]
fn a_light_may_take_light_away() {
    for (name, kind) in kinds() {
        let [diffuse, glossy, combined, shadow, unshadowed] =
            values(&lit(kind, 0.3, LightLinks::default(), Visibility::ALL));
        let links = LightLinks { takes: true, ..LightLinks::default() };
        let found = values(&lit(kind, 0.3, links, Visibility::ALL));
        same(name, found, [-diffuse, -glossy, -combined, shadow, -unshadowed]);
    }
}

/// Cycles' limit of bounces of a lamp: what was scattered more often gets no light samples of it. What scattered rays find
/// of it by themselves stays, weighed as if there were those.
#[test]
fn a_light_is_sampled_where_light_was_scattered_no_more_often_than_it_says() {
    for (name, kind) in kinds() {
        let lit_after = |bounces: u32, max_bounces: Option<u32>| {
            let links = LightLinks { max_bounces, ..LightLinks::default() };
            let mut builder = lit(kind, 0.3, links, Visibility::ALL);
            // Something that is lit from the ground, and lights it.
            let white = builder.lambert(0.9);
            builder.quad([-8.0, 3.0, -8.0], [16.0, 0.0, 0.0], [0.0, 0.0, 16.0], white);
            builder.desc.instances.last_mut().unwrap().visibility.shadow = false;
            let settings = Settings { max_bounces: bounces, ..settings("combined", 1024) };
            mean(&picture(&builder.desc, 6, &settings), "Combined", 0)
        };
        let near = |a: f64, b: f64| assert!((a - b).abs() <= 0.03 * b.abs(), "{name}: {a} and {b}");
        let (direct, cut, whole) = (lit_after(0, None), lit_after(3, Some(0)), lit_after(3, None));
        match kind {
            // No ray finds these.
            Kind::Lamp(LightKind::Point { .. } | LightKind::Distant { angle: 0.0, .. }) => near(cut, direct),
            _ => assert!(cut > 0.97 * direct && cut < 1.03 * whole, "{name}: {cut} of {direct} to {whole}"),
        }
        near(lit_after(1, Some(1)), lit_after(1, None));
        near(lit_after(3, Some(9)), whole);
    }
}

/// Nothing but rays find what a mirror shows: behind a pane, after two scatterings, it is as bright as ever.
#[test]
fn mirrors_show_lamps_that_light_only_what_the_camera_sees() {
    let kind =
        LightKind::Rect { width: 1.5, height: 1.0, radiance: [3.0; 3], spread: PI, two_sided: false, image: None };
    let shown = |max_bounces: Option<u32>| {
        let mut builder =
            lit(Kind::Lamp(kind), 0.0, LightLinks { max_bounces, ..LightLinks::default() }, Visibility::ALL);
        let ground = &mut builder.desc.materials[0];
        (ground.metallic, ground.base_color) = (ScalarInput::constant(1.0), ColorInput::constant([1.0; 3]));
        let pane = builder.material(MaterialDesc {
            transmission: ScalarInput::constant(1.0),
            roughness: ScalarInput::constant(0.0),
            ior: ScalarInput::constant(1.0),
            ..MaterialDesc::default()
        });
        builder.quad([-9.0, 1.0, -9.0], [0.0, 0.0, 18.0], [18.0, 0.0, 0.0], pane);
        // What the camera looks at from straight above.
        builder.desc.cameras.clear();
        builder.look([0.3, 0.0, 0.0], DOWN, 0.2);
        builder.desc.cameras[0].transform.translation.y = 0.5;
        mean(&picture(&builder.desc, 6, &Settings { max_bounces: 3, ..settings("combined", 16) }), "Combined", 0)
    };
    let whole = shown(None);
    assert!(whole > 1.0, "{whole}");
    assert_eq!(shown(Some(0)), whole);
}

#[test]
fn only_linked_objects_are_lit() {
    for (name, kind) in kinds() {
        for roughness in [0.0, 0.3] {
            let free = values(&lit(kind, roughness, LightLinks::default(), Visibility::ALL));
            for (is_lit, exclude) in [(false, true), (true, false)] {
                let receivers = Some(LinkSet { instances: vec![0], exclude });
                let links = LightLinks { receivers, ..LightLinks::default() };
                let found = values(&lit(kind, roughness, links, Visibility::ALL));
                if is_lit {
                    same(name, found, free);
                } else {
                    // Nothing could have reached it.
                    assert_eq!(found, [0.0, 0.0, 0.0, 1.0, 0.0], "{name}");
                }
            }
        }
    }
}

#[test]
fn a_light_lights_only_the_kinds_of_reflection_that_see_it() {
    for (name, kind) in kinds() {
        let free = values(&lit(kind, 0.3, LightLinks::default(), Visibility::ALL));
        let no_diffuse = Visibility { diffuse: false, ..Visibility::ALL };
        let found = values(&lit(kind, 0.3, LightLinks::default(), no_diffuse));
        assert_eq!((found[0], found[4]), (0.0, 0.0), "{name}");
        let no_glossy = Visibility { glossy: false, ..Visibility::ALL };
        let dull = values(&lit(kind, 0.3, LightLinks::default(), no_glossy));
        assert_eq!(dull[1], 0.0, "{name}");
        if kind != Kind::Mesh {
            same(name, [dull[0], found[1], free[2], free[3], dull[4]], free);
        }
    }
}

#[test]
fn lamps_are_seen_without_alpha_and_by_whom_they_are_meant_to_be_seen() {
    for (name, kind) in kinds() {
        let Kind::Lamp(lamp) = kind else { continue };
        if !lamp.is_shape() {
            continue;
        }
        let mut builder = lit(kind, 0.5, LightLinks::default(), Visibility::ALL);
        builder.desc.instances.clear();
        builder.desc.meshes.clear();
        builder.desc.cameras.clear();
        // From below, straight into the light.
        builder.look([0.3, 1.0, 0.0], [0.0, 1.0, 0.0], 0.05);
        let seen = picture(&builder.desc, 4, &settings("combined,emission", 16));
        close(name, mean(&seen, "Combined", 0), 3.0, 1e-5);
        close(name, mean(&seen, "Emission", 1), 3.0, 1e-5);
        assert_eq!(mean(&seen, "Combined", 3), 0.0, "{name}");
        builder.desc.lights[0].visibility.camera = false;
        assert_eq!(mean(&picture(&builder.desc, 4, &settings("combined", 4)), "Combined", 0), 0.0, "{name}");
    }
}

/// A mirror shows lamps, and hides those that reflections do not see.
#[test]
fn mirrors_show_lamps() {
    for (name, kind) in kinds() {
        let Kind::Lamp(lamp) = kind else { continue };
        if !lamp.is_shape() {
            continue;
        }
        for glossy in [true, false] {
            let visibility = Visibility { glossy, camera: false, ..Visibility::ALL };
            let mut builder = lit(kind, 0.0, LightLinks::default(), visibility);
            builder.desc.materials[0].metallic = ScalarInput::constant(1.0);
            builder.desc.cameras.clear();
            builder.look([0.3, 0.0, 0.0], DOWN, 0.05);
            let picture = picture(&builder.desc, 4, &direct(16));
            let expected = if glossy { 0.5 * 3.0 } else { 0.0 };
            close(name, mean(&picture, "Combined", 0), expected, 1e-4);
        }
    }
}

#[test]
fn groups_sum_to_the_picture_and_have_shadows_of_their_own() {
    let mut builder = Builder::default();
    let ground = builder.lambert(0.5);
    builder.ground(40.0, ground);
    for (i, (_, kind)) in kinds().into_iter().enumerate() {
        if let Kind::Lamp(kind) = kind {
            let place = DVec3::new(i as f64 - 4.0, 2.0, 0.0);
            builder.light(kind, DAffine3::from_translation(place) * DAffine3::from_rotation_x(-0.5 * PI));
            let group = if i % 2 == 0 { "key" } else { "fill" };
            builder.desc.lights.last_mut().unwrap().links.group = Some(group.into());
        }
    }
    builder.quad([-1.0, 1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 2.0], ground);
    builder.look([0.0; 3], [0.1, -0.5, 0.1], 1.0);
    let both = picture(&builder.desc, 16, &settings("combined,combined_*,shadow_key,shadow_fill,shadow", 64));
    let layer = |name: &str| both.layer(name).unwrap_or_else(|| panic!("{name}")).data.clone();
    let (combined, key, fill) = (layer("Combined"), layer("Combined_key"), layer("Combined_fill"));
    for pixel in 0..16 * 16 {
        for c in 0..3 {
            let (whole, sum) = (combined[4 * pixel + c], key[3 * pixel + c] + fill[3 * pixel + c]);
            assert!((whole - sum).abs() <= 1e-5 * whole.max(1e-3), "pixel {pixel}: {whole} and {sum}");
        }
    }
    // The shadow of a group is that of its lights alone.
    for group in ["key", "fill"] {
        let mut alone = builder.clone();
        alone.desc.lights.retain(|light| light.links.group.as_deref() == Some(group));
        let alone = picture(&alone.desc, 16, &settings("shadow", 64));
        let expected = mean(&alone, "Shadow", 0);
        close(group, mean(&both, &format!("Shadow_{group}"), 0), expected, 0.02);
    }
}

#[test]
fn a_light_that_transmission_does_not_see_is_not_transmitted() {
    for (name, kind) in kinds() {
        let through = |transmission: bool| {
            let mut builder =
                lit(kind, 0.4, LightLinks::default(), Visibility { transmission, camera: false, ..Visibility::ALL });
            builder.desc.materials[0].transmission = ScalarInput::constant(0.5);
            // From below, where nothing shines but through the ground.
            builder.desc.cameras.clear();
            builder.look([0.0; 3], [0.1, 1.0, 0.1], 0.2);
            mean(&picture(&builder.desc, 6, &direct(256)), "Transmission Direct", 0)
        };
        assert!(through(true) > 1e-3, "{name}");
        assert_eq!(through(false), 0.0, "{name}");
    }
}

/// Objects that are more kinds of blocker than can be told apart: the first are, the rest stop every light.
#[test]
fn blockers_of_too_many_kinds_stop_the_light_of_every_light() {
    for (last, stopped) in [(false, 0.0), (true, 1.0)] {
        let links =
            LightLinks { blockers: Some(LinkSet { instances: vec![0], exclude: false }), ..LightLinks::default() };
        let mut builder = lit(Kind::Lamp(LightKind::Point { intensity: [5.0; 3] }), 0.5, links, Visibility::ALL);
        let add_far_objects = |builder: &mut Builder| {
            for i in 0..30 {
                builder.quad([100.0, f64::from(i), 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0);
                let itself = vec![builder.desc.instances.len() as u32 - 1];
                let links = &mut builder.desc.instances.last_mut().unwrap().links;
                links.blockers = Some(LinkSet { instances: itself, exclude: false });
            }
        };
        if last {
            add_far_objects(&mut builder);
        }
        let lid = add_lid(&mut builder);
        builder.desc.instances[lid as usize].links.blockers = Some(LinkSet { instances: vec![lid], exclude: false });
        if !last {
            add_far_objects(&mut builder);
        }
        let view = View { camera: None, size: Some([4, 4]) };
        let warnings = prepare(builder.desc.clone(), &view, &direct(1)).unwrap().warnings;
        let told: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        let expected =
            "shadow links tell 32 kinds of object apart, 28 are possible: the rest stop the light of every light";
        assert!(told.len() == 1 && told[0].contains(expected), "{told:?}");
        let shadow = mean(&picture(&builder.desc, 4, &direct(16)), "Shadow", 0);
        assert_eq!(shadow, 1.0 - stopped, "the lid comes {}", if last { "last" } else { "first" });
    }
}

#[test]
fn a_glowing_object_and_a_dome_have_groups_like_lamps() {
    let mut builder = Builder::default();
    let (white, glow) = (builder.lambert(0.5), builder.lambert(0.0));
    builder.desc.materials[glow as usize].emission = ColorInput::constant([20.0; 3]);
    builder.ground(40.0, white);
    builder.quad([-0.25, 2.0, -0.25], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5], glow);
    builder.desc.instances[1].links.group = Some("glow".into());
    builder.dome(0.01);
    builder.desc.lights[0].links.group = Some("sky".into());
    builder.quad([-1.0, 1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 2.0], white);
    builder.look([0.0; 3], [0.1, -0.5, 0.1], 1.0);
    let both = picture(&builder.desc, 16, &settings("combined,combined_*,shadow_*", 64));
    let layer = |name: &str| both.layer(name).unwrap_or_else(|| panic!("{name}")).data.clone();
    let (combined, glow, sky) = (layer("Combined"), layer("Combined_glow"), layer("Combined_sky"));
    for i in 0..16 * 16 {
        let (whole, sum) = (combined[4 * i], glow[3 * i] + sky[3 * i]);
        assert!((whole - sum).abs() <= 1e-5 * whole.max(1e-3), "pixel {i}: {whole} and {sum}");
    }
    assert!(glow.iter().sum::<f32>() > 0.0 && sky.iter().sum::<f32>() > 0.0);
    let shadow_alone = |remove: &dyn Fn(&mut Builder)| {
        let mut alone = builder.clone();
        remove(&mut alone);
        mean(&picture(&alone.desc, 16, &settings("shadow", 256)), "Shadow", 0)
    };
    let of_glow = shadow_alone(&|alone| alone.desc.lights.clear());
    // What glows still stands in the way of the sky.
    let of_sky = shadow_alone(&|alone| alone.desc.materials[1].emission = ColorInput::constant([0.0; 3]));
    close("glow", mean(&both, "Shadow_glow", 0), of_glow, 0.01);
    close("sky", mean(&both, "Shadow_sky", 0), of_sky, 0.01);
}

fn shadow(shadow: ShadowDesc) -> LightLinks {
    LightLinks { shadow, ..LightLinks::default() }
}

/// UsdLux' ShadowAPI: what is in full shadow has the shadow's color times the light, whichever strategy finds it.
#[test]
fn shadows_have_the_color_of_the_light_that_they_leave() {
    for (name, kind) in kinds() {
        for roughness in [0.0, 0.2, 0.6] {
            let free = values(&lit(kind, roughness, LightLinks::default(), Visibility::ALL));
            let links = shadow(ShadowDesc { color: [0.25, 0.0, 1.0], ..ShadowDesc::default() });
            let mut lidded = lit(kind, roughness, links, Visibility::ALL);
            same(name, values(&lidded), free);
            add_lid(&mut lidded);
            let [diffuse, glossy, combined, shadow, unshadowed] = free;
            let expected = [0.25 * diffuse, 0.25 * glossy, 0.25 * combined, 0.25 * shadow, unshadowed];
            same(&format!("{name}, roughness {roughness}"), values(&lidded), expected);
            let picture = picture(&lidded.desc, 6, &direct(256));
            assert_eq!(mean(&picture, "Shadow", 1), 0.0, "{name}");
            close(name, mean(&picture, "Shadow", 2), 1.0, 1e-5);
        }
    }
}

/// White shadows are none, in bounced light, too.
#[test]
fn bounced_light_has_the_same_shadows() {
    for (name, kind) in kinds() {
        let bounced = |links: LightLinks| {
            let mut builder = lit(kind, 0.3, links, Visibility::ALL);
            add_lid(&mut builder);
            builder.quad([-1.0, 0.0, -1.0], [0.0, 0.8, 0.0], [0.0, 0.0, 2.0], 0);
            let picture = picture(&builder.desc, 6, &Settings { max_bounces: 3, ..settings("all", 512) });
            ["Diffuse Indirect", "Glossy Indirect", "Combined"].map(|layer| mean(&picture, layer, 1))
        };
        let white = bounced(shadow(ShadowDesc { color: [1.0; 3], ..ShadowDesc::default() }));
        let none = bounced(LightLinks { cast_shadow: false, ..LightLinks::default() });
        for (white, none) in white.into_iter().zip(none) {
            assert!(none > 0.0, "{name}");
            close(name, white, none, 1e-4);
        }
    }
}

#[test]
fn blockers_beyond_the_distance_cast_no_shadow() {
    for (name, kind) in kinds() {
        let free = values(&lit(kind, 0.3, LightLinks::default(), Visibility::ALL));
        // The lid is one metre above, and its sides are nine metres away.
        for (distance, falloff, counts) in [(0.0, 1.0, false), (0.9, 0.9, false), (1e3, 0.0, true), (1e3, 1.0, true)] {
            let links = shadow(ShadowDesc { distance, falloff, ..ShadowDesc::default() });
            let mut builder = lit(kind, 0.3, links, Visibility::ALL);
            add_lid(&mut builder);
            let found = values(&builder);
            if counts {
                assert_eq!(found[..4], [0.0; 4], "{name}, {distance}");
                same(name, [free[0], free[1], free[2], free[3], found[4]], free);
            } else {
                same(&format!("{name}, {distance}"), found, free);
            }
        }
    }
}

#[test]
fn only_linked_objects_cast_fading_shadows() {
    let look = ShadowDesc { color: [0.5; 3], distance: 1.5, falloff: 1.0, gamma: 1.0 };
    for (exclude, expected) in [(true, 1.0), (false, 0.75)] {
        let mut builder = lit(SUN, 0.3, shadow(look), Visibility::ALL);
        let lid = add_lid(&mut builder);
        builder.desc.lights[0].links.blockers = Some(LinkSet { instances: vec![lid], exclude });
        close("shadow", values(&builder)[3], expected, 1e-5);
    }
}

const SUN: Kind = Kind::Lamp(LightKind::Distant { irradiance: [3.0; 3], angle: 0.0 });

/// Horizontal sheets of the given height and alpha in the way of `kind`; the share of its light that arrives.
fn below_sheets(kind: Kind, look: ShadowDesc, sheets: &[(f64, f64)]) -> f64 {
    let mut builder = lit(kind, 0.3, shadow(look), Visibility::ALL);
    for &(height, alpha) in sheets {
        let sheet = builder.lambert(0.0);
        let material = &mut builder.desc.materials[sheet as usize];
        (material.alpha, material.alpha_mode) = (ScalarInput::constant(alpha), AlphaMode::Blend);
        builder.quad([-9.0, height, -9.1], [18.0, 0.0, 0.0], [0.0, 0.0, 18.0], sheet);
    }
    values(&builder)[3]
}

#[test]
fn shadows_fade_before_their_distance() {
    let look = |gamma| ShadowDesc { distance: 2.0, falloff: 1.0, gamma, ..ShadowDesc::default() };
    for (gamma, sheets, expected) in [
        (1.0, &[(0.5, 1.0)][..], 0.0),
        (1.0, &[(1.5, 1.0)], 0.5),
        (2.0, &[(1.5, 1.0)], 0.75),
        (0.5, &[(1.75, 1.0)], 0.5),
        (1.0, &[(2.5, 1.0)], 1.0),
        // Where the zone begins and where it ends.
        (1.0, &[(1.0, 1.0)], 0.0),
        (1.0, &[(1.999, 1.0)], 0.999),
        // Of opaque blockers the nearest counts; what is partly open lets the same share of each pass.
        (1.0, &[(1.5, 1.0), (1.75, 1.0)], 0.5),
        (1.0, &[(1.5, 0.5)], 0.75),
        (1.0, &[(0.5, 0.5)], 0.5),
        (1.0, &[(1.25, 0.5), (1.5, 1.0)], 0.625 * 0.5),
        (1.0, &[(1.5, 0.5), (1.75, 0.5), (2.5, 1.0)], 0.75 * 0.875),
    ] {
        let found = below_sheets(SUN, look(gamma), sheets);
        assert!((found - expected).abs() < 2e-4, "{sheets:?}, gamma {gamma}: {found} instead of {expected}");
    }
    // With a color.
    let look = ShadowDesc { color: [0.5; 3], ..look(1.0) };
    close("color", below_sheets(SUN, look, &[(1.5, 1.0)]), 0.75, 1e-5);
}

/// Of a constant dome, whose light rays alone find: with a zone as long as the distance D a sheet at the height h counts
/// for 1 − m / cos θ, where m = h / D, and 2m − m² of the irradiance arrives. Of a panel, whose light both strategies
/// find, by quadrature.
#[test]
fn lights_of_any_size_fade_by_the_distance_along_each_ray() {
    let look = |distance| ShadowDesc { distance, falloff: distance, ..ShadowDesc::default() };
    let dome = Kind::Lamp(LightKind::Dome { radiance: [1.0; 3], image: None });
    for distance in [1.25, 2.0, 5.0] {
        let m = 1.0 / distance;
        close("dome", below_sheets(dome, look(distance), &[(1.0, 1.0)]), 2.0 * m - m * m, 2e-3);
    }
    let (width, height, radiance) = (3.0, 2.0, [3.0; 3]);
    let panel = Kind::Lamp(LightKind::Rect { width, height, radiance, spread: PI, two_sided: false, image: None });
    for distance in [1.125, 1.5, 4.0] {
        let (mut arrives, mut all) = (0.0, 0.0);
        for (i, j) in (0..200).flat_map(|i| (0..200).map(move |j| (i, j))) {
            let along = |k: i32| (f64::from(k) + 0.5) / 200.0 - 0.5;
            let to_light = DVec3::new(0.3 + width * along(i), 2.0, height * along(j));
            let weight = to_light.length().powi(-4);
            all += weight;
            // The sheet is halfway.
            arrives += weight * (0.5 * to_light.length() / distance).min(1.0);
        }
        close("panel", below_sheets(panel, look(distance), &[(1.0, 1.0)]), arrives / all, 2e-3);
    }
}
