//! Domes by a graph against closed forms, and what the film makes of holes and thin surfaces.

#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use penumbra::desc::graph::{Graph, Leaf, Math};
use penumbra::desc::{AlphaMode, DomeShader, LightKind, MaterialDesc, ScalarInput};
use penumbra::math::DAffine3;
use penumbra::settings::Integrator;
use scene::{Builder, close, mean, picture, settings};

const DOWN: [f64; 3] = [0.0, -1.0, 0.0];

/// A dome of radiance `max(y, 0)` to the power of `power`, times `scale`.
fn towards_zenith(builder: &mut Builder, power: f64, scale: f64) {
    let mut graph = Graph::default();
    let direction = graph.leaf(Leaf::Position);
    let (up, zero, power) = (graph.place(direction, 1), graph.number(0.0), graph.number(power));
    let up = graph.math(Math::Maximum, &[up, zero]);
    let lobe = graph.math(Math::Power, &[up, power]);
    let radiance = graph.scale(lobe, scale);
    let shader = builder.desc.dome_shaders.len() as u32;
    builder.desc.dome_shaders.push(DomeShader { graph, radiance, suns: Vec::new() });
    builder.light(LightKind::ShadedDome { shader }, DAffine3::IDENTITY);
}

/// `E = ∫ cosᵖ⁺¹ dω = 2π / (p + 2)`: broad, and as narrow as the map can hardly tell.
#[test]
fn a_plane_under_a_shaded_dome_gets_its_irradiance() {
    for (power, tolerance) in [(0.0, 2e-3), (1.0, 4e-3), (60.0, 1e-2), (40_000.0, 2e-2)] {
        let mut builder = Builder::default();
        let material = builder.lambert(0.5);
        builder.ground(10.0, material);
        towards_zenith(&mut builder, power, power + 2.0);
        builder.look([0.0; 3], DOWN, 0.1);
        let picture = picture(&builder.desc, 8, &settings("combined,diffuse_direct,unshadowed,shadow", 256));
        close(&format!("power {power}"), mean(&picture, "Diffuse Direct", 0), 2.0, tolerance);
        close(&format!("power {power}, unshadowed"), mean(&picture, "Diffuse Direct Unshadowed", 0), 2.0, tolerance);
        assert_eq!(mean(&picture, "Shadow", 0), 1.0);
    }
}

/// Half of the picture is a wall that is a hole.
#[test]
fn holes_are_black_of_alpha_0_to_the_camera_and_solid_to_all_others() {
    for by_material in [false, true] {
        let mut builder = Builder::default();
        let ground = builder.lambert(0.5);
        let hole = builder.material(MaterialDesc { holdout: by_material, ..MaterialDesc::default() });
        builder.ground(10.0, ground);
        builder.quad([0.0, 0.5, -5.0], [0.0, 0.0, 10.0], [5.0, 0.0, 0.0], hole);
        builder.desc.instances[1].holdout = !by_material;
        builder.dome(1.0);
        // All of the camera's rays meet the hole.
        builder.look([1.0, 0.5, 0.0], DOWN, 0.2);
        let hole = picture(&builder.desc, 4, &settings("all", 16));
        for (layer, channels) in [("Combined", 4), ("Environment", 3), ("Ambient Occlusion", 3), ("Normal", 3)] {
            (0..channels).for_each(|channel| assert_eq!(mean(&hole, layer, channel), 0.0, "{layer}"));
        }
        assert_eq!(mean(&hole, "Depth", 0), f64::from(1e10_f32));
        let mut only_ao = settings("combined,ao", 16);
        only_ao.integrator = Integrator::Ao;
        assert_eq!(mean(&picture(&builder.desc, 4, &only_ao), "Combined", 3), 0.0);
        // Beside it the ground gets light from half of the sky.
        builder.desc.cameras.clear();
        builder.look([-1e-3, 0.0, 0.0], DOWN, 1e-4);
        let beside = picture(&builder.desc, 4, &settings("combined,shadow", 1024));
        close("beside", mean(&beside, "Shadow", 0), 0.5, 2e-2);
    }
}

#[test]
fn data_passes_look_through_what_is_thinner_than_the_threshold() {
    let (alpha, above) = (0.3, 0.5);
    for (threshold, depth, normal) in [(0.5, 1.0 + above, 1.0 - alpha), (0.25, 1.0, 1.0), (0.0, 1.0, 1.0)] {
        let mut builder = Builder::default();
        let ground = builder.lambert(0.5);
        let pane = builder.material(MaterialDesc {
            alpha: ScalarInput::constant(alpha),
            alpha_mode: AlphaMode::Blend,
            ..MaterialDesc::default()
        });
        builder.ground(10.0, ground);
        builder.quad([-5.0, above, -5.0], [0.0, 0.0, 10.0], [10.0, 0.0, 0.0], pane);
        builder.dome(1.0);
        builder.desc.render.pass_alpha_threshold = threshold;
        builder.look([0.01, above, 0.02], DOWN, 0.1);
        let picture = picture(&builder.desc, 8, &settings("combined,depth,normal,object_index", 64));
        close("depth", mean(&picture, "Depth", 0), depth, 1e-5);
        close("normal", mean(&picture, "Normal", 1), normal, 1e-2);
        assert_eq!(mean(&picture, "Combined", 3), 1.0);
    }
}

/// What is in front of nothing is the last surface that was met.
#[test]
fn a_thin_pane_before_nothing_is_what_data_passes_show() {
    let mut builder = Builder::default();
    let pane = builder.material(MaterialDesc {
        alpha: ScalarInput::constant(0.3),
        alpha_mode: AlphaMode::Blend,
        ..MaterialDesc::default()
    });
    builder.ground(10.0, pane);
    builder.dome(1.0);
    builder.look([0.0; 3], DOWN, 0.1);
    let picture = picture(&builder.desc, 4, &settings("depth,normal", 16));
    close("depth", mean(&picture, "Depth", 0), 1.0, 1e-5);
    assert_eq!(mean(&picture, "Normal", 1), 0.0);
}
