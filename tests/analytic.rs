//! Whole renders against closed forms.

#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use std::f64::consts::PI;

use penumbra::desc::{AlphaMode, Attribute, ColorInput, LightKind, MaterialDesc, ScalarInput, VolumeDesc};
use penumbra::math::{DAffine3, DVec3};
use penumbra::settings::{EffectsMode, Integrator, Settings};
use scene::{Builder, close, mean, picture, settings};

const DOWN: [f64; 3] = [0.0, -1.0, 0.0];

fn emitter(builder: &mut Builder, radiance: f64, albedo: f64) -> u32 {
    builder.material(MaterialDesc {
        base_color: ColorInput::constant([albedo; 3]),
        specular: ScalarInput::constant(0.0),
        roughness: ScalarInput::constant(1.0),
        emission: ColorInput::constant([radiance; 3]),
        ..MaterialDesc::default()
    })
}

/// A lamp above the ground, a mile of wall beside it.
fn sun(builder: &mut Builder, irradiance: f64, angle: f64) {
    let transform = DAffine3::from_rotation_x(-0.5 * PI);
    builder.light(LightKind::Distant { irradiance: [irradiance; 3], angle }, transform);
}

#[test]
fn inside_a_closed_glowing_sphere_everything_is_le_over_one_minus_albedo() {
    for albedo in [0.0, 0.5, 0.8] {
        let mut builder = Builder::default();
        let material = emitter(&mut builder, 1.0 - albedo, albedo);
        builder.sphere(16, false, material, DAffine3::IDENTITY);
        builder.look([0.0, -0.5, 0.0], DOWN, 0.4);
        let whole = Settings { max_bounces: 200, ..settings("combined", 1024) };
        close(&format!("albedo {albedo}"), mean(&picture(&builder.desc, 8, &whole), "Combined", 0), 1.0, 4e-3);
        // Of which this part comes straight, and none of it from the triangle that the point lies on.
        let direct = Settings { max_bounces: 0, ..settings("diffuse_direct", 4096) };
        let value = mean(&picture(&builder.desc, 8, &direct), "Diffuse Direct", 0);
        let expected = if albedo > 0.0 { 1.0 - albedo } else { 0.0 };
        close(&format!("albedo {albedo}, direct"), value, expected, 3e-4);
    }
}

/// A sphere that is scaled to 0 along one axis, whichever of its own that is, is a disk.
#[test]
fn what_is_scaled_flat_is_there() {
    let turned = DAffine3::from_rotation_x(0.4) * DAffine3::from_rotation_z(1.0);
    for (turn, along_y) in [(DAffine3::IDENTITY, 0.0), (turned, 0.0), (turned, 1e-3)] {
        let mut builder = Builder::default();
        let material = builder.lambert(1.0);
        builder.ground(4.0, material);
        let squashed = DAffine3::from_scale(DVec3::new(1.0, along_y, 1.0)) * turn;
        builder.sphere(64, true, material, DAffine3::from_translation(DVec3::new(0.0, 0.5, 0.0)) * squashed);
        sun(&mut builder, PI, 0.0);
        builder.look([0.0, 1.0, 0.0], DOWN, 2.0);
        // From above it hides what it shadows.
        let direct = Settings { max_bounces: 0, ..settings("combined,position", 4) };
        let picture = picture(&builder.desc, 512, &direct);
        close(&format!("{along_y}: lit"), mean(&picture, "Combined", 0), 1.0, 1e-3);
        // The area of a polygon of 128 corners, of a square of 4 by 4, half a metre up; of positions each pixel has one.
        let area = 64.0 * (PI / 64.0).sin();
        let height = 0.5 + along_y * 2.0 / 3.0;
        close(&format!("{along_y}: height"), mean(&picture, "Position", 1), height * area / 16.0, 2e-3);
    }
}

#[test]
fn a_plane_under_a_constant_dome_reflects_its_albedo() {
    let mut builder = Builder::default();
    let material = builder.lambert(0.6);
    builder.ground(10.0, material);
    builder.dome(2.0);
    builder.look([0.0; 3], DOWN, 0.1);
    let picture = picture(&builder.desc, 4, &settings("all", 64));
    close("Combined", mean(&picture, "Combined", 0), 1.2, 2e-3);
    close("Diffuse Direct", mean(&picture, "Diffuse Direct", 1), 2.0, 2e-3);
    close("Unshadowed", mean(&picture, "Diffuse Direct Unshadowed", 1), 2.0, 2e-3);
    close("Diffuse Color", mean(&picture, "Diffuse Color", 2), 0.6, 1e-5);
    assert_eq!(mean(&picture, "Shadow", 0), 1.0);
    assert_eq!(mean(&picture, "Ambient Occlusion", 0), 1.0);
    assert_eq!(mean(&picture, "Diffuse Indirect", 0), 0.0);
}

#[test]
fn an_instance_has_a_color_of_its_own_where_its_mesh_has_none() {
    let mut builder = Builder::default();
    let blend = MaterialDesc {
        base_color: ColorInput::constant([0.6; 3]),
        specular: ScalarInput::constant(0.0),
        alpha_mode: AlphaMode::Blend,
        ..MaterialDesc::default()
    };
    let material = builder.material(blend);
    builder.ground(10.0, material);
    builder.desc.instances[0].color = Some([1.0, 0.5, 0.0, 0.25]);
    builder.dome(2.0);
    builder.look([0.0; 3], DOWN, 0.1);
    let picture = picture(&builder.desc, 4, &settings("combined,diffuse_color", 256));
    for (channel, albedo) in [0.6, 0.3, 0.0].into_iter().enumerate() {
        close("Diffuse Color", mean(&picture, "Diffuse Color", channel), 0.25 * albedo, 1e-2);
    }
    // Vertex colours come first.
    let colors = vec![[0.5, 0.5, 0.5, 1.0]; builder.desc.meshes[0].points.len()];
    std::sync::Arc::make_mut(&mut builder.desc.meshes[0]).colors = Some(Attribute::Point(colors));
    let picture = self::picture(&builder.desc, 4, &settings("combined,diffuse_color", 16));
    close("Diffuse Color", mean(&picture, "Diffuse Color", 1), 0.3, 1e-5);
}

#[test]
fn a_lamp_without_size_lights_by_the_inverse_square() {
    let mut builder = Builder::default();
    let material = builder.lambert(0.5);
    builder.ground(10.0, material);
    let lamp = LightKind::Point { intensity: [3.0; 3] };
    builder.light(lamp, DAffine3::from_translation(DVec3::new(1.0, 2.0, 0.0)));
    builder.look([0.0; 3], DOWN, 1e-3);
    let picture = picture(&builder.desc, 2, &settings("combined,diffuse_direct", 4));
    let irradiance = 3.0 * (2.0 / 5.0_f64.sqrt()) / 5.0;
    close("Diffuse Direct", mean(&picture, "Diffuse Direct", 0), irradiance / PI, 1e-4);
    close("Combined", mean(&picture, "Combined", 0), 0.5 * irradiance / PI, 1e-4);
}

#[test]
fn an_emissive_square_lights_by_its_form_factor() {
    let mut builder = Builder::default();
    let (floor, lamp) = (builder.lambert(0.5), emitter(&mut builder, 5.0, 0.0));
    builder.ground(10.0, floor);
    builder.quad([-0.5, 1.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], lamp);
    builder.look([0.0, 0.0, 0.0], [0.7, -0.7, 0.0], 1e-3);
    let picture = picture(&builder.desc, 4, &settings("diffuse_direct,combined,shadow", 512));
    // A unit square one above: E/(πL) = 4/(2π) · 2 · (a/√(1+a²)) atan(a/√(1+a²)), a = 1/2.
    let x = 0.5 / 1.25_f64.sqrt();
    let form = 4.0 / (2.0 * PI) * 2.0 * x * x.atan();
    close("Diffuse Direct", mean(&picture, "Diffuse Direct", 0), 5.0 * form, 3e-3);
    close("Shadow", mean(&picture, "Shadow", 0), 1.0, 1e-6);
}

#[test]
fn ambient_occlusion_beside_a_wall() {
    for (distance, height) in [(1.0, 1.0), (0.3, 0.9), (0.5, 1.0)] {
        let mut builder = Builder::default();
        let material = builder.lambert(0.5);
        builder.ground(100.0, material);
        builder.quad([distance, 0.0, -1e4], [0.0, height, 0.0], [0.0, 0.0, 2e4], material);
        builder.look([0.0; 3], DOWN, 1e-3);
        let expected = 0.5 * (1.0 + distance / distance.hypot(height));
        for integrator in [Integrator::Path, Integrator::Ao] {
            let settings = Settings { integrator, ..settings("ao,combined", 1024) };
            let picture = picture(&builder.desc, 4, &settings);
            close("open share beside a wall", mean(&picture, "Ambient Occlusion", 0), expected, 2e-3);
        }
    }
}

#[test]
fn ambient_occlusion_ends_at_its_distance() {
    for distance in [2.0, 4.0, 10.0] {
        let mut builder = Builder::default();
        let material = builder.lambert(0.5);
        builder.ground(100.0, material);
        builder.quad([1.0, 0.0, -1e3], [0.0, 1e3, 0.0], [0.0, 0.0, 2e3], material);
        builder.look([0.0; 3], DOWN, 1e-3);
        let settings = Settings { ao_distance: Some(distance), ..settings("ao", 1024) };
        let c = 1.0 / distance;
        let expected = 1.0 - (c.acos() - c * (1.0 - c * c).sqrt()) / PI;
        let value = mean(&picture(&builder.desc, 4, &settings), "Ambient Occlusion", 0);
        close("open share before a wall", value, expected, 2e-3);
    }
    let mut builder = Builder::default();
    let material = builder.lambert(0.5);
    builder.ground(100.0, material);
    builder.quad([0.1, 0.0, -1e3], [0.0, 1e3, 0.0], [0.0, 0.0, 2e3], material);
    builder.look([0.0; 3], DOWN, 1e-3);
    let settings = Settings { ao_distance: Some(0.0), ..settings("ao", 16) };
    assert_eq!(mean(&picture(&builder.desc, 4, &settings), "Ambient Occlusion", 0), 1.0);
}

#[test]
fn coverage_and_transparency_count_in_ambient_occlusion() {
    let glass = |opacity: f64| MaterialDesc {
        alpha: ScalarInput::constant(opacity),
        alpha_mode: AlphaMode::Blend,
        ..MaterialDesc::default()
    };
    // A half transparent ground over nothing, beside a wall of opacity 0.3.
    let mut builder = Builder::default();
    let (ground, wall) = (builder.material(glass(0.5)), builder.material(glass(0.3)));
    builder.ground(100.0, ground);
    builder.quad([1.0, 0.0, -1e4], [0.0, 1.0, 0.0], [0.0, 0.0, 2e4], wall);
    builder.look([0.0; 3], DOWN, 1e-3);
    let picture = picture(&builder.desc, 4, &settings("ao,combined", 4096));
    let blocked = 0.5 * (1.0 - 0.5_f64.sqrt());
    close("coverage × openness", mean(&picture, "Ambient Occlusion", 0), 0.5 * (1.0 - 0.3 * blocked), 3e-3);
    close("alpha", mean(&picture, "Combined", 3), 0.5, 3e-3);
}

#[test]
fn a_colored_film_tints_what_is_behind_it_and_its_shadow() {
    let tint = [0.9, 0.2, 0.1];
    let film = |builder: &mut Builder| {
        builder.material(MaterialDesc {
            base_color: ColorInput::constant([0.0; 3]),
            specular: ScalarInput::constant(0.0),
            transparency: ColorInput::constant(tint),
            ..MaterialDesc::default()
        })
    };
    // Seen through it, and in its shadow.
    for (from, to) in [([0.0, 2.0, 0.0], DOWN), ([0.0; 3], [0.9, -0.1, 0.0])] {
        let mut builder = Builder::default();
        let (floor, film) = (builder.lambert(0.5), film(&mut builder));
        builder.ground(100.0, floor);
        builder.quad([-0.5, 1.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], film);
        sun(&mut builder, 2.0, 0.0);
        builder.look(from, to, 1e-6);
        let settings = Settings { max_bounces: 0, ..settings("combined,shadow", 1024) };
        let seen = picture(&builder.desc, 4, &settings);
        let forced = Settings { effects: EffectsMode::All, ..settings };
        assert_eq!(seen, picture(&builder.desc, 4, &forced));
        let through = if from[1] > 1.0 { 2 } else { 1 };
        for (c, t) in tint.into_iter().enumerate() {
            close("Combined", mean(&seen, "Combined", c), 0.5 * 2.0 / PI * f64::powi(t, through), 2e-3);
            close("Shadow", mean(&seen, "Shadow", c), t, 2e-3);
        }
    }
}

#[test]
fn half_of_a_sun_is_half_of_its_shadow() {
    let mut builder = Builder::default();
    let material = builder.lambert(0.5);
    builder.ground(100.0, material);
    // An edge straight above the point hides half of the disk.
    builder.quad([0.0, 1.0, -50.0], [50.0, 0.0, 0.0], [0.0, 0.0, 100.0], material);
    sun(&mut builder, 2.0, 0.2);
    builder.look([0.0; 3], [0.5, -0.1, 0.0], 1e-6);
    let settings = Settings { max_bounces: 0, ..settings("shadow,unshadowed,diffuse_direct", 4096) };
    let picture = picture(&builder.desc, 4, &settings);
    close("Shadow", mean(&picture, "Shadow", 0), 0.5, 3e-3);
    close("Unshadowed", mean(&picture, "Diffuse Direct Unshadowed", 0), 2.0 / PI, 2e-3);
}

#[test]
fn an_occluder_between_leaves_the_unshadowed_light_as_it_was() {
    // A lid over the ground: in full shadow whatever the strategy that found the light.
    let mut builder = Builder::default();
    let (floor, lamp) = (builder.lambert(0.5), emitter(&mut builder, 5.0, 0.0));
    builder.ground(10.0, floor);
    builder.quad([-0.5, 1.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], lamp);
    builder.quad([-9.0, 0.5, -9.0], [18.0, 0.0, 0.0], [0.0, 0.0, 18.0], floor);
    builder.look([0.0, 0.0, 0.0], [0.9, -0.2, 0.0], 1e-3);
    let settings = Settings { max_bounces: 0, ..settings("shadow,unshadowed,diffuse_direct", 512) };
    let picture = picture(&builder.desc, 4, &settings);
    let x = 0.5 / 1.25_f64.sqrt();
    let form = 4.0 / (2.0 * PI) * 2.0 * x * x.atan();
    close("Unshadowed", mean(&picture, "Diffuse Direct Unshadowed", 0), 5.0 * form, 3e-3);
    assert_eq!(mean(&picture, "Shadow", 0), 0.0);
}

#[test]
fn an_emissive_square_does_not_shadow_itself_wherever_the_camera_stands() {
    // Where the camera stands decides where render space begins, and with that how all is rounded.
    let x = 0.5 / 1.25_f64.sqrt();
    let form = 4.0 / (2.0 * PI) * 2.0 * x * x.atan();
    for distance in [0.1, 0.3, 1.0, 2.0, 7.0, 16.0, 100.0, 1e3, 1e4] {
        let mut builder = Builder::default();
        let (floor, lamp) = (builder.lambert(0.5), emitter(&mut builder, 5.0, 0.0));
        builder.ground(10.0, floor);
        builder.quad([-0.5, 1.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], lamp);
        builder.look([0.0; 3], [distance, -0.6 * distance, 0.3 * distance], 1e-3);
        let camera = &mut builder.desc.cameras[0];
        camera.transform.translation *= distance;
        let picture = picture(&builder.desc, 4, &settings("diffuse_direct,shadow", 256));
        assert_eq!(mean(&picture, "Shadow", 0), 1.0, "camera at {distance}");
        close(&format!("camera at {distance}"), mean(&picture, "Diffuse Direct", 0), 5.0 * form, 5e-3);
    }
}

#[test]
fn what_is_inside_an_absorbing_solid_is_seen_through_it() {
    let mut builder = Builder::default();
    let lamp = emitter(&mut builder, 1.0, 0.0);
    let water = builder.material(MaterialDesc {
        ior: ScalarInput::constant(1.0),
        roughness: ScalarInput::constant(0.0),
        specular: ScalarInput::constant(0.0),
        base_color: ColorInput::constant([1.0; 3]),
        transmission: ScalarInput::constant(1.0),
        volume: Some(VolumeDesc {
            thickness: ScalarInput::constant(1.0),
            attenuation_distance: 2.0,
            attenuation_color: [0.25, 0.5, 1.0],
            adds: false,
        }),
        ..MaterialDesc::default()
    });
    builder.quad([-9.0, 3.0, 9.0], [18.0, 0.0, 0.0], [0.0, 0.0, -18.0], water);
    builder.quad([-1.0, 1.0, 1.0], [2.0, 0.0, 0.0], [0.0, 0.0, -2.0], lamp);
    builder.look([0.0, 3.5, 0.0], DOWN, 0.1);
    let picture = picture(&builder.desc, 4, &settings("combined", 16));
    // Two metres of it.
    for (channel, expected) in [(0, 0.25), (1, 0.5), (2, 1.0)] {
        close("through water", mean(&picture, "Combined", channel), expected, 1e-3);
    }
}

#[test]
fn data_of_the_first_hit_looks_through_what_is_mostly_open() {
    for (alpha, mode, depth) in [
        (0.2, AlphaMode::Blend, 2.0),
        (0.8, AlphaMode::Blend, 1.0),
        (0.2, AlphaMode::Mask { cutoff: 0.5 }, 2.0),
        (0.6, AlphaMode::Mask { cutoff: 0.5 }, 1.0),
    ] {
        let mut builder = Builder::default();
        let veil = MaterialDesc { alpha: ScalarInput::constant(alpha), alpha_mode: mode, ..MaterialDesc::default() };
        let (floor, veil) = (builder.lambert(0.5), builder.material(veil));
        builder.ground(9.0, floor);
        builder.quad([-1.0, 1.0, 1.0], [2.0, 0.0, 0.0], [0.0, 0.0, -2.0], veil);
        builder.look([0.0, 1.0, 0.0], DOWN, 0.1);
        let picture = picture(&builder.desc, 3, &settings("depth,object_index", 1));
        close("depth", mean(&picture, "Depth", 0), depth, 1e-6);
        assert_eq!(mean(&picture, "Object Index", 0), 3.0 - depth);
    }
}

/// Objects of every kind of surface under several lights.
fn busy_scene() -> Builder {
    let mut builder = Builder::default();
    let floor = builder.lambert(0.7);
    let lamp = emitter(&mut builder, 8.0, 0.2);
    let number = ScalarInput::constant;
    let metal = builder.material(MaterialDesc {
        base_color: ColorInput::constant([0.9, 0.6, 0.2]),
        metallic: number(1.0),
        roughness: number(0.3),
        ..MaterialDesc::default()
    });
    let glass = builder.material(MaterialDesc {
        base_color: ColorInput::constant([0.9, 1.0, 0.9]),
        transmission: number(1.0),
        roughness: number(0.1),
        volume: Some(VolumeDesc {
            thickness: number(1.0),
            attenuation_distance: 0.5,
            attenuation_color: [0.5, 0.8, 0.9],
            adds: false,
        }),
        ..MaterialDesc::default()
    });
    let plastic = builder.material(MaterialDesc {
        base_color: ColorInput::constant([0.8, 0.0, 0.1]),
        alpha: number(0.6),
        alpha_mode: AlphaMode::Blend,
        ..MaterialDesc::default()
    });
    // Opaque, though it has an inside: that must not matter.
    let stone = builder.material(MaterialDesc {
        volume: Some(VolumeDesc {
            thickness: number(1.0),
            attenuation_distance: 0.1,
            attenuation_color: [0.1, 0.9, 0.5],
            adds: false,
        }),
        ..MaterialDesc::default()
    });
    builder.quad([-4.0, 0.0, -2.0], [0.0, 3.0, 0.0], [8.0, 0.0, 0.0], stone);
    builder.ground(20.0, floor);
    builder.quad([-1.0, 4.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.5, 2.0], lamp);
    for (i, material) in [metal, glass, plastic].into_iter().enumerate() {
        let place = DVec3::new(2.2 * i as f64 - 2.2, 1.0, 0.0);
        builder.sphere(24, true, material, DAffine3::from_translation(place));
    }
    builder.light(LightKind::Distant { irradiance: [1.0, 0.9, 0.8], angle: 0.05 }, DAffine3::from_rotation_x(-1.1));
    builder.dome(0.3);
    builder.look([0.0, 1.0, 0.0], [0.0, -0.6, -1.0], 3.5);
    builder
}

#[test]
fn passes_recombine_to_the_picture() {
    let picture = picture(&busy_scene().desc, 24, &settings("all", 16));
    let layer = |name: &str| &picture.layer(name).unwrap_or_else(|| panic!("{name}")).data;
    let combined = layer("Combined");
    let lobes = ["Diffuse", "Glossy", "Transmission"].map(|lobe| {
        [layer(&format!("{lobe} Color")), layer(&format!("{lobe} Direct")), layer(&format!("{lobe} Indirect"))]
    });
    let lights = ["Diffuse", "Glossy", "Transmission"]
        .map(|lobe| ["Light", "Light Direct", "Light Indirect"].map(|part| layer(&format!("{lobe} {part}"))));
    for pixel in 0..24 * 24 {
        for c in 0..3 {
            let i = 3 * pixel + c;
            let sum: f32 = lobes.iter().map(|[color, direct, indirect]| color[i] * (direct[i] + indirect[i])).sum();
            let sum = sum + layer("Emission")[i] + layer("Environment")[i];
            let value = combined[4 * pixel + c];
            assert!((sum - value).abs() <= 1e-5 * value.max(1.0), "pixel {pixel}: {sum} and {value}");
            for ([color, direct, indirect], light) in lobes.iter().zip(&lights) {
                let expected = [direct[i] + indirect[i], direct[i], indirect[i]].map(|part| color[i] * part);
                for (light, expected) in light.iter().zip(expected) {
                    assert!((light[i] - expected).abs() <= 1e-5 * expected, "pixel {pixel}: {} {expected}", light[i]);
                }
            }
            let product = layer("Shadow")[i] * layer("Diffuse Direct Unshadowed")[i];
            let direct = layer("Diffuse Direct")[i];
            assert!((product - direct).abs() <= 1e-5 * direct.max(1e-3), "pixel {pixel}: {product} and {direct}");
        }
    }
}

#[test]
fn threads_and_forced_effects_change_no_bit() {
    let desc = busy_scene().desc;
    let base = Settings { threads: 1, ..settings("all", 8) };
    let one = picture(&desc, 20, &base);
    assert_eq!(one, picture(&desc, 20, &Settings { threads: 3, ..base.clone() }));
    assert_eq!(one, picture(&desc, 20, &Settings { effects: EffectsMode::All, ..base.clone() }));
    assert_ne!(one, picture(&desc, 20, &Settings { seed: 1, ..base.clone() }));
    // Asking for fewer passes leaves those that are asked for as they are.
    let few = picture(&desc, 20, &Settings { passes: settings("combined,ao", 8).passes, ..base });
    assert_eq!(few.layer("Combined"), one.layer("Combined"));
    assert_eq!(few.layer("Ambient Occlusion"), one.layer("Ambient Occlusion"));
}

#[test]
fn neither_scale_nor_place_matters() {
    let value = |scale: f64, offset: f64| {
        let mut builder = Builder::default();
        let (floor, lamp) = (builder.lambert(0.5), emitter(&mut builder, 5.0, 0.0));
        builder.ground(10.0, floor);
        builder.quad([-0.5, 1.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], lamp);
        builder.quad([0.0, 0.5, -9.0], [9.0, 0.0, 0.0], [0.0, 0.0, 18.0], floor);
        builder.look([0.0; 3], [0.4, -0.7, 0.1], 1e-3);
        let place = DAffine3::from_scale(DVec3::splat(scale));
        let place = DAffine3::from_translation(DVec3::new(offset, -offset, 0.5 * offset)) * place;
        for instance in &mut builder.desc.instances {
            instance.transform = place * instance.transform;
        }
        let camera = &mut builder.desc.cameras[0];
        camera.transform.translation = place.transform_point3(camera.transform.translation);
        camera.projection =
            penumbra::desc::ProjectionDesc::Orthographic { half_width: 1e-3 * scale, half_height: 1e-3 * scale };
        let settings = Settings { max_bounces: 1, ..settings("diffuse_direct,shadow,ao", 256) };
        let picture = picture(&builder.desc, 4, &settings);
        ["Diffuse Direct", "Shadow", "Ambient Occlusion"].map(|layer| mean(&picture, layer, 0))
    };
    let expected = value(1.0, 0.0);
    for (scale, offset) in [(1e-6, 0.0), (1e-3, 0.0), (1e3, 0.0), (1e9, 0.0), (1.0, 1e6), (1.0, 1e7), (1e-3, 1e3)] {
        for (value, expected) in value(scale, offset).into_iter().zip(expected) {
            close(&format!("scale {scale}, offset {offset}"), value, expected, 2e-3);
        }
    }
}

#[test]
fn bounced_light_sees_the_holes_of_a_mask_and_not_their_mean() {
    use penumbra::desc::{
        Attribute, Blending, Channel, ColorSpace, Filter, ImageDesc, MeshDesc, PixelData, TextureDesc,
    };
    use penumbra::desc::{TextureRef, TextureTransform, Wrap};
    // A board of holes: its mean alpha is a half, and a threshold of the mean would close or open all.
    let indirect = |cutoff: f64, channel: Channel| {
        let gray = channel == Channel::R;
        let mut builder = Builder::default();
        let board: Vec<u8> = (0..64 * 64).map(|i| if (i % 64 / 8 + i / 512) % 2 == 0 { 255 } else { 0 }).collect();
        let image = ImageDesc {
            name: "board".into(),
            place: Default::default(),
            width: 64,
            height: 64,
            channels: if gray { 1 } else { 2 },
            color_space: ColorSpace::Linear,
            blending: Blending::default(),
            pixels: PixelData::U8(match gray {
                true => board,
                false => board.iter().flat_map(|&alpha| [255, alpha]).collect(),
            }),
        };
        builder.desc.images.push(image.into());
        builder.desc.textures.push(TextureDesc {
            place: Default::default(),
            image: 0,
            wrap_u: Wrap::Repeat,
            wrap_v: Wrap::Repeat,
            filter: Filter::Linear,
        });
        let texture = TextureRef { texture: 0, uv_set: 0, transform: TextureTransform::IDENTITY };
        let floor = builder.lambert(0.8);
        let sheet = builder.material(MaterialDesc {
            specular: ScalarInput::constant(0.0),
            alpha: ScalarInput::textured(1.0, Some((texture, channel))),
            alpha_mode: AlphaMode::Mask { cutoff },
            ..MaterialDesc::default()
        });
        builder.ground(50.0, floor);
        let points = vec![[-50.0, 1.0, 50.0], [50.0, 1.0, 50.0], [50.0, 1.0, -50.0], [-50.0, 1.0, -50.0]];
        let uvs = vec![Attribute::Point(points.iter().map(|p: &[f32; 3]| [p[0] / 4.0, p[2] / 4.0]).collect())];
        let mesh = MeshDesc { points, triangles: vec![[0, 1, 2], [0, 2, 3]], uvs, ..MeshDesc::default() };
        builder.instance(mesh, sheet, DAffine3::IDENTITY);
        builder.dome(1.0);
        builder.look([0.0; 3], [0.3, -0.2, 0.1], 0.5);
        builder.desc.cameras[0].transform.translation *= 0.5;
        let settings = Settings { max_bounces: 4, ..settings("diffuse_indirect,combined", 256) };
        mean(&picture(&builder.desc, 8, &settings), "Combined", 0)
    };
    close("masks of cutoff 0.45 and 0.55", indirect(0.45, Channel::A), indirect(0.55, Channel::A), 0.08);
    // Images without alpha are masks, too.
    assert_eq!(indirect(0.45, Channel::R), indirect(0.45, Channel::A));
}
