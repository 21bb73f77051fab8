//! Renders of strands and balls against closed forms and against fine meshes.

#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use penumbra::desc::graph::{Graph, Leaf};
use penumbra::desc::{
    Attribute, ColorInput, MaterialDesc, MeshDesc, RoundsDesc, ScalarInput, SceneDesc, ShapeRef, Strand, VolumeDesc,
};
use penumbra::error::Warnings;
use penumbra::film::Picture;
use penumbra::import::ImportOptions;
use penumbra::math::{DAffine3, DVec3, RoundCone};
use penumbra::scene::{View, prepare};
use penumbra::settings::Settings;
use scene::{Builder, close, mean, picture, settings};

const DOWN: [f64; 3] = [0.0, -1.0, 0.0];

fn balls(balls: &[[f32; 4]]) -> RoundsDesc {
    RoundsDesc {
        points: balls.iter().map(|&[x, y, z, _]| [x, y, z]).collect(),
        radii: balls.iter().map(|ball| ball[3]).collect(),
        ..RoundsDesc::default()
    }
}

fn strands(list: &[Vec<[f32; 4]>]) -> RoundsDesc {
    let mut end = 0;
    let mut next = |count: usize| {
        end += count as u32;
        Strand { end, closed: false }
    };
    RoundsDesc { strands: list.iter().map(|strand| next(strand.len())).collect(), ..balls(&list.concat()) }
}

/// Numbers in [0, 1) that look random.
fn hash(i: u32) -> f32 {
    let x = i.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let x = ((x >> ((x >> 28) + 4)) ^ x).wrapping_mul(277_803_737);
    ((x >> 22) ^ x) as f32 / 4_294_967_296.0
}

/// Straight, tapered hairs on a small patch.
fn tuft(count: u32) -> Vec<Vec<[f32; 4]>> {
    (0..count)
        .map(|i| {
            let h = |k: u32| hash(8 * i + k) - 0.5;
            let (x, z) = (h(0), h(1));
            (0..5)
                .map(|k| {
                    let t = k as f32 / 4.0;
                    [x + 0.6 * h(2) * t, 1.2 * t - 0.6, z + 0.6 * h(3) * t, 0.02 * (1.0 - t)]
                })
                .collect()
        })
        .collect()
}

#[test]
fn graphs_read_values_along_strands_and_of_balls() {
    let mut graph = Graph::default();
    let glow = graph.leaf(Leaf::Attribute { name: "glow".into(), fallback: [0.0; 4] });
    let shining = MaterialDesc {
        base_color: ColorInput::constant([0.0; 3]),
        specular: ScalarInput::constant(0.0),
        emission: ColorInput::graph(glow),
        graph,
        ..MaterialDesc::default()
    };
    let strand = strands(&[vec![[-1.0, 0.0, 0.0, 0.3], [1.0, 0.0, 0.0, 0.3]]]);
    let ball = balls(&[[0.0, 0.0, 0.0, 0.5]]);
    // Half way between both ends of the strand.
    for (rounds, values, expected) in
        [(strand, vec![[1.0; 4], [3.0; 4]], 2.0), (ball.clone(), vec![[5.0; 4]], 5.0), (ball, Vec::new(), 0.0)]
    {
        let mut builder = Builder::default();
        let material = builder.material(shining.clone());
        let attributes = if values.is_empty() { Vec::new() } else { vec![("glow".into(), values)] };
        builder.rounds(RoundsDesc { attributes, ..rounds }, material);
        builder.look([0.0; 3], [0.0, 0.0, -1.0], 0.1);
        let picture = picture(&builder.desc, 4, &settings("combined", 64));
        close("glow", mean(&picture, "Combined", 0), expected, 1e-2);
    }
}

#[test]
fn white_hair_in_a_white_world_is_not_to_be_seen() {
    let mut builder = Builder::default();
    let white = builder.lambert(1.0);
    builder.rounds(strands(&tuft(300)), white);
    builder.rounds(balls(&[[0.3, 0.2, 0.6, 0.15], [-0.2, 0.1, 0.7, 0.1]]), white);
    builder.dome(1.0);
    builder.look([0.0; 3], [0.3, -0.2, -1.0], 0.5);
    let picture = picture(&builder.desc, 16, &Settings { max_bounces: 500, ..settings("combined,ao", 512) });
    close("furnace", mean(&picture, "Combined", 0), 1.0, 1e-3);
    let layer = picture.layer("Combined").unwrap();
    let worst = layer.data.chunks(layer.channels.len()).map(|p| (p[0] - 1.0).abs()).fold(0.0, f32::max);
    assert!(worst < 0.1, "{worst}");
    // And there is something to be seen.
    assert!(mean(&picture, "Ambient Occlusion", 0) < 0.7);
}

#[test]
fn a_ball_hides_its_share_of_the_sky_and_shines_by_it() {
    for (radius, height) in [(0.5_f32, 1.0_f32), (0.1, 2.0), (1e-3, 0.01), (300.0, 1000.0)] {
        let mut builder = Builder::default();
        let (floor, glow) = (
            builder.lambert(0.5),
            builder.material(MaterialDesc {
                base_color: ColorInput::constant([0.0; 3]),
                specular: ScalarInput::constant(0.0),
                emission: ColorInput::constant([3.0; 3]),
                ..MaterialDesc::default()
            }),
        );
        builder.ground(100.0 * f64::from(height), floor);
        builder.rounds(balls(&[[0.0, height, 0.0, radius]]), glow);
        builder.look([0.0; 3], [0.7, -0.7, 0.0], 1e-4 * f64::from(height));
        let picture = picture(&builder.desc, 8, &settings("ao,diffuse_direct", 4096));
        let form = f64::from(radius / height).powi(2);
        let open = mean(&picture, "Ambient Occlusion", 0);
        close("hidden sky", 1.0 - open, form, 0.02);
        close("light of the ball", mean(&picture, "Diffuse Direct", 0), 3.0 * form, 0.02);
    }
}

#[test]
fn what_strands_absorb_goes_by_the_way_inside_for_there_are_no_inner_walls() {
    let density = 0.8_f64;
    let tinted = MaterialDesc {
        base_color: ColorInput::constant([1.0; 3]),
        specular: ScalarInput::constant(0.0),
        transmission: ScalarInput::constant(1.0),
        roughness: ScalarInput::constant(0.0),
        ior: ScalarInput::constant(1.0),
        volume: Some(VolumeDesc {
            thickness: ScalarInput::constant(1.0),
            attenuation_distance: 1.0 / density,
            attenuation_color: [(-1.0_f64).exp(); 3],
            adds: false,
        }),
        ..MaterialDesc::default()
    };
    // Many short pieces, also of much less than the radius, and one that bends.
    let straight = |count: u32| (0..=count).map(|i| [2.0 * i as f32 / count as f32 - 1.0, 0.0, 0.0, 0.25]).collect();
    let bent = (0..=30).map(|i| {
        let angle = 0.1 * (i as f32 - 15.0);
        [2.0 * angle.sin(), 2.0 * angle.cos() - 2.0, 0.0, 0.25]
    });
    for strand in [straight(1), straight(7), straight(100), bent.collect::<Vec<[f32; 4]>>()] {
        let mut builder = Builder::default();
        let material = builder.material(tinted.clone());
        builder.rounds(strands(std::slice::from_ref(&strand)), material);
        builder.dome(1.0);
        builder.look([0.0; 3], DOWN, 0.01);
        let picture = picture(&builder.desc, 4, &Settings { max_bounces: 60, ..settings("combined", 64) });
        let expected = (-density * 0.5).exp();
        close(&format!("{} pieces", strand.len() - 1), mean(&picture, "Combined", 0), expected, 2e-3);
    }
}

/// A mesh of each round cone, far finer than a pixel: both balls, and the side between them.
fn tessellated(rounds: &RoundsDesc) -> MeshDesc {
    const AROUND: u32 = 48;
    let (mut normals, mut colors) = (Vec::new(), Vec::new());
    let mut mesh = MeshDesc::default();
    let center = |i: u32| rounds.points[i as usize];
    let ball = |i: u32| {
        let [x, y, z] = center(i);
        [x, y, z, rounds.radii[i as usize]]
    };
    let color = |i: u32| rounds.colors.as_ref().map_or([1.0; 4], |colors| colors[i as usize]);
    let alone = || (0..rounds.points.len() as u32).map(|i| [i; 4]).collect();
    for [_, first, last, _] in rounds.segments().unwrap_or_else(alone) {
        let cone = RoundCone::new(ball(first), ball(last));
        for (from, to, rows) in [(-3.0, -1.0, 24), (0.0, 1.0, 1), (4.0, 2.0, 24)] {
            let base = mesh.points.len() as u32;
            for (row, k) in (0..=rows).flat_map(|row| (0..AROUND).map(move |k| (row, k))) {
                let u = from + (to - from) * row as f32 / rows as f32;
                let point = cone.point([u, 4.0 * k as f32 / AROUND as f32 - 2.0]);
                let origin = DVec3::from(center(first).map(f64::from));
                mesh.points.push((origin + point.p).as_vec3().to_array());
                normals.push(point.normal.as_vec3().to_array());
                colors.push(color(if point.s > 0.5 { last } else { first }));
            }
            for (row, k) in (0..rows).flat_map(|row| (0..AROUND).map(move |k| (row, k))) {
                let at = |row: u32, k: u32| base + row * AROUND + k % AROUND;
                let [a, b, c, d] = [at(row, k), at(row, k + 1), at(row + 1, k + 1), at(row + 1, k)];
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    mesh.normals = Some(Attribute::Point(normals));
    mesh.colors = Some(Attribute::Point(colors));
    mesh
}

const STAGE: &str = r#"#usda 1.0
( upAxis = "Y" metersPerUnit = 1 )
def Material "Matte" {
    token outputs:surface.connect = </Matte/Surface.outputs:surface>
    def Shader "Surface" {
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor.connect = </Matte/Color.outputs:result>
        float inputs:roughness = 1
        float inputs:ior = 1
        token outputs:surface
    }
    def Shader "Color" {
        uniform token info:id = "UsdPrimvarReader_float3"
        string inputs:varname = "displayColor"
        color3f outputs:result
    }
}
def BasisCurves "Hair" (prepend apiSchemas = ["MaterialBindingAPI"]) {
    rel material:binding = </Matte>
    uniform token basis = "catmullRom"
    uniform token wrap = "pinned"
    int[] curveVertexCounts = [4, 4, 4]
    point3f[] points = [(-0.8, -0.5, 0), (-0.7, 0, 0.2), (-0.5, 0.2, -0.2), (-0.1, 0.5, 0),
        (-0.2, -0.6, 0.1), (0, 0, 0.3), (-0.3, 0.3, 0.3), (0.1, 0.7, 0),
        (0.9, -0.6, 0), (0.4, -0.4, 0), (0.7, 0, 0.4), (0.2, 0.2, -0.1)]
    float[] widths = [0.2, 0.25, 0.15, 0.05, 0.1, 0.1, 0.1, 0.1, 0.02, 0.3, 0.1, 0.2] (interpolation = "vertex")
    color3f[] primvars:displayColor = [(0.9, 0.2, 0.1), (0.2, 0.8, 0.3), (0.3, 0.3, 0.9)] (interpolation = "uniform")
}
def Points "Beads" (prepend apiSchemas = ["MaterialBindingAPI"]) {
    rel material:binding = </Matte>
    point3f[] points = [(0.5, 0.6, 0), (0.75, 0.5, 0.1), (-0.6, 0.7, 0.2), (0.6, -0.2, -0.5)]
    float[] widths = [0.3, 0.15, 0.2, 0.5]
    color3f[] primvars:displayColor = [(0.8, 0.8, 0), (0, 0.8, 0.8), (0.8, 0, 0.8), (0.5, 0.5, 0.5)] (interpolation = "vertex")
}
def DomeLight "Sky" {}
def DistantLight "Sun" {
    float inputs:intensity = 2
    float inputs:angle = 2
    double3 xformOp:rotateXYZ = (-40, 30, 0)
    uniform token[] xformOpOrder = ["xformOp:rotateXYZ"]
}
def Camera "Camera" {
    token projection = "orthographic"
    float horizontalAperture = 20
    float verticalAperture = 20
    double3 xformOp:translate = (0, 0, 5)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
"#;

fn rendered(scene: SceneDesc, size: u32, settings: &Settings) -> Picture {
    let view = View { camera: None, size: Some([size, size]) };
    let prepared = prepare(scene, &view, settings).unwrap();
    penumbra::render::render(&prepared.scene, settings, &()).unwrap().film.develop()
}

#[test]
fn curves_and_points_of_usd_look_like_fine_meshes_of_them() {
    let file = tempfile::Builder::new().suffix(".usda").tempfile().unwrap();
    std::fs::write(file.path(), STAGE).unwrap();
    let mut warnings = Warnings::new();
    let scene = penumbra::import::scene(file.path(), &ImportOptions::default(), &mut warnings).unwrap();
    assert_eq!(warnings.iter().map(ToString::to_string).collect::<Vec<_>>(), Vec::<String>::new());
    assert_eq!((scene.rounds.len(), scene.meshes.len()), (2, 0));
    let mut fine = scene.clone();
    fine.meshes = scene.rounds.iter().map(|rounds| tessellated(rounds).into()).collect();
    for instance in &mut fine.instances {
        let ShapeRef::Rounds(i) = instance.shape else { panic!("a mesh") };
        instance.shape = ShapeRef::Mesh(i);
    }
    let size = 48;
    let [a, b] = [(scene, 1), (fine, 2)]
        .map(|(scene, seed)| rendered(scene, size, &Settings { seed, max_bounces: 3, ..settings("combined", 256) }));
    let [a, b] = [&a, &b].map(|picture| picture.layer("Combined").unwrap());
    assert_eq!(a.channels.len(), 4);
    let mut sum = 0.0;
    // Means over squares of four pixels.
    for (y, x) in (0..size / 4).flat_map(|y| (0..size / 4).map(move |x| (4 * y, 4 * x))) {
        for channel in 0..3 {
            let mean = |data: &[f32]| {
                let pixels = (0..16).map(|i| ((y + i / 4) * size + x + i % 4) as usize);
                pixels.map(|p| f64::from(data[4 * p + channel])).sum::<f64>() / 16.0
            };
            let (a, b) = (mean(&a.data), mean(&b.data));
            assert!((a - b).abs() < 0.03, "at {x}, {y}, channel {channel}: {a} and {b}");
            sum += (a - b) / f64::from((size / 4).pow(2));
        }
    }
    assert!(sum.abs() < 4e-3, "{sum}");
    // The sky is white.
    let shown = a.data.chunks(4).filter(|p| (p[0] - 1.0).abs() > 0.02).count();
    assert!(shown > a.data.len() / 4 / 5, "{shown}");
}

#[test]
fn far_from_the_origin_and_small_they_look_the_same() {
    let look = |scale: f64, shift: f64| {
        let mut builder = Builder::default();
        let white = builder.lambert(0.8);
        builder.rounds(strands(&tuft(50)), white);
        builder.dome(1.0);
        builder.look([0.0; 3], [0.3, -0.2, -1.0], 0.5);
        let place = DAffine3::from_scale(DVec3::splat(scale));
        let place = DAffine3::from_translation(DVec3::new(shift, -shift, 0.5 * shift)) * place;
        builder.desc.instances[0].transform = place * builder.desc.instances[0].transform;
        let camera = &mut builder.desc.cameras[0];
        camera.transform = place * camera.transform * DAffine3::from_scale(DVec3::splat(1.0 / scale));
        let half = 0.5 * scale;
        camera.projection = penumbra::desc::ProjectionDesc::Orthographic { half_width: half, half_height: half };
        picture(&builder.desc, 16, &Settings { max_bounces: 4, ..settings("combined,ao", 256) })
    };
    let here = look(1.0, 0.0);
    for (scale, shift) in [(1e-3, 0.0), (1e3, 0.0), (1.0, 1e6)] {
        let there = look(scale, shift);
        for layer in ["Combined", "Ambient Occlusion"] {
            close(&format!("{layer} {scale} {shift}"), mean(&there, layer, 0), mean(&here, layer, 0), 4e-3);
        }
    }
}
