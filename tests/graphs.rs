//! Surfaces driven by graphs, against the same values in f64 and against pictures without graphs.

#[path = "lights/plane.rs"]
#[allow(dead_code, reason = "the tests of lights need more of it")]
mod plane;
#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use std::f64::consts::PI;

use penumbra::desc::graph::{Bump, Function, Graph, Leaf, Mapping, Math, Op, PathInfo, Quantity, Space, ValueId};
use penumbra::desc::{
    AlphaMode, Attribute, Blending, Channel, ColorInput, ColorSpace, Filter, ImageDesc, LightKind, MaterialDesc,
    MeshDesc, NamedAttribute, NormalInput, ObjectInfo, PixelData, ScalarInput, TextureDesc, TextureRef,
    TextureTransform, Wrap,
};
use penumbra::film::Picture;
use penumbra::math::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use penumbra::settings::{EffectsMode, Settings};
use plane::lambert;
use scene::{Builder, close, mean, picture, settings};

/// One sample within a hundredth of a pixel of its centre.
fn at_centres(passes: &str) -> Settings {
    let filter = penumbra::film::Filter::parse("triangle:0.01").unwrap();
    Settings { filter, ..settings(passes, 1) }
}

fn color(picture: &Picture, layer: &str, pixel: usize) -> [f64; 3] {
    let layer = picture.layer(layer).unwrap_or_else(|| panic!("no layer {layer}"));
    let n = layer.channels.len();
    std::array::from_fn(|i| f64::from(layer.data[pixel * n + i]))
}

/// Where the object of [`tilted`] is.
fn placement() -> DAffine3 {
    let turn = DMat3::from_quat(DQuat::from_rotation_x(0.4) * DQuat::from_rotation_z(-0.3));
    DAffine3::from_mat3_translation(turn * DMat3::from_diagonal(DVec3::new(2.0, 1.0, 3.0)), DVec3::new(0.2, 0.1, -0.4))
}

const SIZE: u32 = 16;
const LOOK: [f64; 3] = [0.1, -1.0, 0.2];

/// A square, y = 0 and 2 m wide in its own space, tilted, stretched and seen from above, with a material that
/// `fill` makes.
fn tilted(fill: impl FnOnce(&mut Graph) -> MaterialDesc) -> Builder {
    let mut builder = Builder::default();
    let mut graph = Graph::default();
    let material = fill(&mut graph);
    let material = builder.material(MaterialDesc { graph, material_index: 3, ..material });
    let mesh = MeshDesc {
        points: vec![[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        uvs: vec![Attribute::Point(vec![[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]])],
        tangents: Some(Attribute::Point(vec![[1.0, 0.0, 0.0, 1.0]; 4])),
        attributes: vec![NamedAttribute {
            name: "heat".into(),
            values: Attribute::Corner((0..6).map(|i| [i as f32, 1.0, -1.0, 0.5]).collect()),
        }],
        ..MeshDesc::default()
    };
    builder.instance(mesh, material, placement());
    let attributes = vec![("tint".into(), [0.25, 0.5, 0.75, 1.0])];
    builder.desc.instances[0].info = ObjectInfo { color: [0.9, 0.8, 0.7, 1.0], random: 0.375, attributes };
    builder.look([0.2, 0.1, -0.4], LOOK, 0.5);
    builder
}

/// The point of the square that pixel `i` has at its centre, world space.
fn seen(builder: &Builder, i: usize) -> DVec3 {
    let camera = builder.desc.cameras[0].transform;
    let (x, y) = (i as u32 % SIZE, i as u32 / SIZE);
    let share = |k: u32| (f64::from(k) + 0.5) / f64::from(SIZE) - 0.5;
    let (right, up, back) = (camera.matrix3.x_axis, camera.matrix3.y_axis, camera.matrix3.z_axis);
    let o = camera.translation + right * share(x) - up * share(y);
    let n = normal();
    o - back * ((o - placement().translation).dot(n) / back.dot(n))
}

fn normal() -> DVec3 {
    (placement().matrix3.inverse().transpose() * DVec3::Y).normalize()
}

/// Emission of the graph against `expected` of the world-space point, in every pixel.
fn emits(what: &str, value: impl FnOnce(&mut Graph) -> ValueId, expected: impl Fn(&Builder, DVec3) -> [f64; 3]) {
    let builder = tilted(|graph| MaterialDesc {
        base_color: ColorInput::constant([0.0; 3]),
        emission: ColorInput::graph(value(graph)),
        ..MaterialDesc::default()
    });
    let picture = picture(&builder.desc, SIZE, &at_centres("emission"));
    for i in 0..(SIZE * SIZE) as usize {
        let (got, expected) = (color(&picture, "Emission", i), expected(&builder, seen(&builder, i)));
        let near = |a: f64, b: f64| (a - b.max(0.0)).abs() < 2e-3 * b.abs().max(1.0);
        assert!((0..3).all(|k| near(got[k], expected[k])), "{what}, pixel {i}: {got:?} instead of {expected:?}");
    }
}

#[test]
fn leaves_are_what_they_say_at_pixel_centres() {
    let object = |p: DVec3| placement().inverse().transform_point3(p);
    let plus = |graph: &mut Graph, leaf: Leaf, by: f64| {
        let (leaf, by) = (graph.leaf(leaf), graph.number(by));
        graph.add(leaf, by)
    };
    emits("position", |g| plus(g, Leaf::Position, 2.0), |_, p| (p + 2.0).to_array());
    emits("object", |g| plus(g, Leaf::ObjectPosition, 2.0), |_, p| (object(p) + 2.0).to_array());
    let generated = |p: DVec3| {
        let q = object(p);
        [0.5 * (q.x + 1.0), 0.5, 0.5 * (q.z + 1.0)]
    };
    emits("generated", |g| g.leaf(Leaf::Generated), |_, p| generated(p));
    emits(
        "uv",
        |g| g.leaf(Leaf::Uv(0)),
        |_, p| {
            let [x, _, z] = generated(p);
            [x, z, 0.0]
        },
    );
    emits("normal", |g| plus(g, Leaf::Normal, 1.0), |_, _| (normal() + 1.0).to_array());
    emits("true normal", |g| plus(g, Leaf::TrueNormal, 1.0), |_, _| (normal() + 1.0).to_array());
    emits("object normal", |g| g.leaf(Leaf::ObjectNormal), |_, _| [0.0, 1.0, 0.0]);
    emits("incoming", |g| plus(g, Leaf::Incoming, 1.0), |_, _| (1.0 - DVec3::from(LOOK).normalize()).to_array());
    let camera = |builder: &Builder, p: DVec3| {
        let local = builder.desc.cameras[0].transform.inverse().transform_point3(p);
        DVec3::new(local.x, local.y, -local.z)
    };
    emits("camera", |g| plus(g, Leaf::CameraPosition, 2.0), |b, p| (camera(b, p) + 2.0).to_array());
    emits(
        "window",
        |g| g.leaf(Leaf::Window),
        |b, p| {
            let local = camera(b, p);
            [local.x + 0.5, local.y + 0.5, 0.0]
        },
    );
    emits("object color", |g| g.leaf(Leaf::ObjectColor), |_, _| [0.9, 0.8, 0.7]);
    emits("object random", |g| g.leaf(Leaf::ObjectRandom), |_, _| [0.375; 3]);
    emits("object index", |g| g.leaf(Leaf::ObjectIndex), |b, _| [f64::from(b.desc.instances[0].object_index); 3]);
    emits("object location", |g| plus(g, Leaf::ObjectLocation, 1.0), |_, _| [1.2, 1.1, 0.6]);
    emits("material index", |g| g.leaf(Leaf::MaterialIndex), |_, _| [3.0; 3]);
    let attribute = |name: &str| Leaf::Attribute { name: name.into(), fallback: [0.1, 0.2, 0.3, 1.0] };
    emits("object attribute", |g| g.leaf(attribute("tint")), |_, _| [0.25, 0.5, 0.75]);
    emits("no attribute", |g| g.leaf(attribute("none")), |_, _| [0.1, 0.2, 0.3]);
    emits(
        "mesh attribute",
        |g| g.leaf(attribute("heat")),
        |_, p| {
            // Corners count 0 1 2 on the triangle below the diagonal, 3 4 5 above it.
            let [x, _, z] = generated(p);
            let (right, back) = (x, 1.0 - z);
            [if right >= back { right + back } else { 3.0 - right + 2.0 * back }, 1.0, 0.0]
        },
    );
    emits("length", |g| g.leaf(Leaf::Path(PathInfo::Length)), |b, p| [camera(b, p).z; 3]);
    emits("camera ray", |g| g.leaf(Leaf::Path(PathInfo::IsCamera)), |_, _| [1.0; 3]);
    emits("shadow ray", |g| g.leaf(Leaf::Path(PathInfo::IsShadow)), |_, _| [0.0; 3]);
    emits("backfacing", |g| g.leaf(Leaf::Backfacing), |_, _| [0.0; 3]);
}

#[test]
fn spaces_lead_there_and_back() {
    for quantity in [Quantity::Point, Quantity::Vector, Quantity::Normal] {
        for space in [Space::Object, Space::Camera] {
            emits(
                &format!("{quantity:?} {space:?}"),
                |g| {
                    let (p, two) = (g.leaf(Leaf::Position), g.number(2.0));
                    let far = g.add(p, two);
                    let v = if quantity == Quantity::Normal { g.apply(Function::Normalize(3), &[far]) } else { p };
                    let there = g.transform(quantity, Space::World, space, v);
                    let back = g.transform(quantity, space, Space::World, there);
                    g.add(back, two)
                },
                |_, p| (2.0 + if quantity == Quantity::Normal { (p + 2.0).normalize() } else { p }).to_array(),
            );
        }
    }
    let there = |p: DVec3| (placement().matrix3.inverse() * p + 3.0).to_array();
    emits(
        "vector to object",
        |g| {
            let (p, three) = (g.leaf(Leaf::Position), g.number(3.0));
            let there = g.transform(Quantity::Vector, Space::World, Space::Object, p);
            g.add(there, three)
        },
        |_, p| there(p),
    );
}

/// A graph of many nodes: emission and the color of the diffuse reflection.
#[test]
fn a_plane_shows_the_values_of_its_graph() {
    let make = |graph: &mut Graph| {
        let p = graph.leaf(Leaf::Position);
        let (location, turn) = (graph.constant([0.1, 0.2, 0.3, 0.0]), graph.constant([0.2, 0.3, 0.4, 0.0]));
        let by = graph.constant([2.0, 3.0, 1.5, 0.0]);
        let mapped = graph.apply(Function::Mapping(Mapping::Point), &[p, location, turn, by]);
        let waves = graph.math(Math::Sine, &[mapped]);
        let half = graph.number(0.5);
        let unit = graph.math(Math::MultiplyAdd, &[waves, half, half]);
        let hsv = graph.apply(Function::RgbToHsv, &[unit]);
        graph.apply(Function::HsvToRgb, &[hsv])
    };
    let builder = tilted(|graph| {
        let value = make(graph);
        MaterialDesc {
            base_color: ColorInput::graph(value),
            specular: ScalarInput::constant(0.0),
            emission: ColorInput { factor: [2.0, 1.0, 0.5], ..ColorInput::graph(value) },
            ..MaterialDesc::default()
        }
    });
    let picture = picture(&builder.desc, SIZE, &at_centres("emission,diffuse_color"));
    for i in 0..(SIZE * SIZE) as usize {
        let p = seen(&builder, i) * DVec3::new(2.0, 3.0, 1.5);
        // Euler XYZ: about x first.
        let turn = DQuat::from_rotation_z(0.4) * DQuat::from_rotation_y(0.3) * DQuat::from_rotation_x(0.2);
        let q = turn * p + DVec3::new(0.1, 0.2, 0.3);
        let expected = q.to_array().map(|x| 0.5 + 0.5 * x.sin());
        let (emission, diffuse) = (color(&picture, "Emission", i), color(&picture, "Diffuse Color", i));
        for k in 0..3 {
            assert!((diffuse[k] - expected[k]).abs() < 2e-3, "pixel {i}: {diffuse:?} instead of {expected:?}");
            assert!((emission[k] - [2.0, 1.0, 0.5][k] * expected[k]).abs() < 4e-3, "pixel {i}: {emission:?}");
        }
    }
}

/// Images, one with alpha.
fn with_image(builder: &mut Builder) -> TextureRef {
    let texels = (0..16 * 8 * 4).map(|i| (i * 89 % 251) as u8).collect();
    let image = ImageDesc {
        name: "image".into(),
        place: Default::default(),
        width: 16,
        height: 8,
        channels: 4,
        color_space: ColorSpace::Srgb,
        blending: Blending::default(),
        pixels: PixelData::U8(texels),
    };
    builder.desc.images.push(image.into());
    builder.desc.textures.push(TextureDesc {
        place: Default::default(),
        image: 0,
        wrap_u: Wrap::Repeat,
        wrap_v: Wrap::Mirror,
        filter: Filter::Linear,
    });
    let transform = TextureTransform([[1.5, 0.25, 0.1], [-0.25, 2.0, 0.2]]);
    TextureRef { texture: 0, uv_set: 0, transform }
}

/// The image of `texture` as a value.
fn looked_up(graph: &mut Graph, texture: TextureRef) -> ValueId {
    let TextureTransform([u, v]) = texture.transform;
    let uv = graph.leaf(Leaf::Uv(texture.uv_set));
    let rows = [[u[0], u[1], 0.0, u[2]], [v[0], v[1], 0.0, v[2]], [0.0; 4]];
    let uv = graph.apply(Function::Affine(Box::new(rows)), &[uv]);
    graph.image(texture.texture, uv)
}

fn assert_same(a: &Picture, b: &Picture) {
    assert_eq!(a.layers.len(), b.layers.len());
    for (a, b) in a.layers.iter().zip(&b.layers) {
        assert!(a.data.iter().zip(&b.data).all(|(a, b)| a.to_bits() == b.to_bits()), "{} differs", a.name);
    }
}

#[test]
fn a_texture_in_a_graph_gives_the_bits_of_a_plain_one() {
    let scene = |in_graph: bool| {
        let mut builder = tilted(|_| MaterialDesc::default());
        let texture = with_image(&mut builder);
        let material = &mut builder.desc.materials[0];
        material.alpha_mode = AlphaMode::Blend;
        if in_graph {
            let texel = looked_up(&mut material.graph, texture);
            let (alpha, rough) = (material.graph.place(texel, 3), material.graph.place(texel, 1));
            material.base_color = ColorInput::graph(texel);
            material.emission = ColorInput { factor: [0.5, 2.0, 1.0], ..ColorInput::graph(texel) };
            material.alpha = ScalarInput::graph(alpha);
            material.roughness = ScalarInput { factor: 0.5, ..ScalarInput::graph(rough) };
        } else {
            material.base_color = ColorInput::textured([1.0; 3], Some(texture));
            material.emission = ColorInput::textured([0.5, 2.0, 1.0], Some(texture));
            material.alpha = ScalarInput::textured(1.0, Some((texture, Channel::A)));
            material.roughness = ScalarInput::textured(0.5, Some((texture, Channel::G)));
        }
        builder.dome(1.0);
        builder.desc
    };
    let settings = settings("combined,diffuse_color,emission,glossy_color", 8);
    assert_same(&picture(&scene(true), 24, &settings), &picture(&scene(false), 24, &settings));
}

#[test]
fn forced_effects_give_the_same_bits() {
    let mut builder = tilted(|graph| {
        let (p, camera) = (graph.leaf(Leaf::ObjectPosition), graph.leaf(Leaf::Path(PathInfo::IsCamera)));
        let seen = graph.multiply(p, camera);
        MaterialDesc { base_color: ColorInput::graph(p), emission: ColorInput::graph(seen), ..MaterialDesc::default() }
    });
    builder.dome(1.0);
    let of = |effects| Settings { effects, ..settings("combined", 8) };
    let (auto, all) = (of(EffectsMode::Auto), of(EffectsMode::All));
    assert_same(&picture(&builder.desc, 12, &auto), &picture(&builder.desc, 12, &all));
}

const RADIANCE: f64 = 100.0;
const HALF: f64 = 0.05;

/// Ground below a square of 0.1 m, one metre up, whose emission `fill` gives; its front faces down if so asked.
fn lamp(facing_down: bool, spp: u32, fill: impl FnOnce(&mut Graph) -> ValueId) -> f64 {
    let mut builder = Builder::default();
    let floor = builder.lambert(0.5);
    builder.ground(10.0, floor);
    let mut graph = Graph::default();
    let emission = ColorInput { factor: [RADIANCE; 3], ..ColorInput::graph(fill(&mut graph)) };
    let glow = builder.material(MaterialDesc {
        base_color: ColorInput::constant([0.0; 3]),
        specular: ScalarInput::constant(0.0),
        emission,
        graph,
        ..MaterialDesc::default()
    });
    let h = HALF as f32;
    let triangles = if facing_down { vec![[0, 1, 2], [0, 2, 3]] } else { vec![[2, 1, 0], [3, 2, 0]] };
    let mesh = MeshDesc {
        points: vec![[-h, 0.0, -h], [h, 0.0, -h], [h, 0.0, h], [-h, 0.0, h]],
        triangles,
        uvs: vec![Attribute::Point(vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])],
        ..MeshDesc::default()
    };
    builder.instance(mesh, glow, DAffine3::from_translation(DVec3::Y));
    builder.look([0.0; 3], [0.7, -0.7, 0.0], 1e-3);
    mean(&picture(&builder.desc, 4, &settings("diffuse_direct", spp)), "Diffuse Direct", 0)
}

/// Diffuse direct of the lamp where it glows between `from` and `to` along x.
fn lit(from: f64, to: f64) -> f64 {
    let corners = [[from, -HALF], [to, -HALF], [to, HALF], [from, HALF]];
    RADIANCE * lambert(&corners.map(|[x, z]| DVec3::new(x, 1.0, z)), Vec3::ZERO, Vec3::Y) / PI
}

#[test]
fn glowing_graphs_are_sampled_as_lights() {
    let whole = lit(-HALF, HALF);
    // Fades from 1 to 0; symmetric about the origin.
    let fade = lamp(true, 1024, |g| {
        let (uv, one) = (g.leaf(Leaf::Uv(0)), g.number(1.0));
        let u = g.place(uv, 0);
        g.subtract(one, u)
    });
    close("fade", fade, 0.5 * whole, 0.01);
    // Half of it, by where it is in the world and in object space.
    let halves = |leaf: fn() -> Leaf| {
        move |g: &mut Graph| {
            let (p, zero) = (g.leaf(leaf()), g.number(0.0));
            let x = g.place(p, 0);
            g.math(Math::LessThan, &[x, zero])
        }
    };
    close("world", lamp(true, 4096, halves(|| Leaf::Position)), lit(-HALF, 0.0), 0.01);
    close("object", lamp(false, 4096, halves(|| Leaf::ObjectPosition)), lit(-HALF, 0.0), 0.01);
    // One side alone, the other, and by the angle: cos² of almost straight down.
    let front = |g: &mut Graph| {
        let (back, one) = (g.leaf(Leaf::Backfacing), g.number(1.0));
        g.subtract(one, back)
    };
    close("front", lamp(true, 256, front), whole, 0.01);
    assert_eq!(lamp(false, 256, front), 0.0);
    close("back", lamp(false, 256, |g| g.leaf(Leaf::Backfacing)), whole, 0.01);
    let by_angle = lamp(true, 256, |g| {
        let (incoming, normal) = (g.leaf(Leaf::Incoming), g.leaf(Leaf::TrueNormal));
        g.apply(Function::Dot(3), &[incoming, normal])
    });
    close("angle", by_angle, whole * 0.99917, 0.01);
    // Seen by diffuse rays alone: found by them alone.
    close("path", lamp(true, 16384, |g| g.leaf(Leaf::Path(PathInfo::IsDiffuse))), whole, 0.15);
    assert_eq!(lamp(true, 256, |g| g.leaf(Leaf::Path(PathInfo::IsCamera))), 0.0);
}

/// Ground under a sheet 0.5 m up whose opacity is a value of a graph, lit straight from above, seen from
/// below the sheet.
fn under_a_sheet(fill: impl FnOnce(&mut Graph) -> ValueId, mode: AlphaMode) -> Picture {
    let mut builder = Builder::default();
    let floor = builder.lambert(0.5);
    builder.ground(10.0, floor);
    let mut graph = Graph::default();
    let alpha = ScalarInput::graph(fill(&mut graph));
    let sheet = builder.material(MaterialDesc { alpha, alpha_mode: mode, graph, ..MaterialDesc::default() });
    builder.quad([-2.0, 0.5, -2.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0], sheet);
    // Local −z is down.
    let down = DAffine3::from_rotation_x(-0.5 * PI);
    builder.light(LightKind::Distant { irradiance: [PI; 3], angle: 0.0 }, down);
    builder.look([0.0; 3], [0.0, -1.0, 0.0], 0.4);
    builder.desc.cameras[0].transform.translation *= 0.25;
    picture(&builder.desc, 16, &Settings { max_bounces: 0, ..settings("diffuse_direct,shadow", 64) })
}

#[test]
fn shadows_go_by_the_graph() {
    // Opaque where x > 0 of the sheet's own space.
    let right = |g: &mut Graph| {
        let (p, zero) = (g.leaf(Leaf::ObjectPosition), g.number(0.0));
        let x = g.place(p, 0);
        g.math(Math::GreaterThan, &[x, zero])
    };
    let masked = under_a_sheet(right, AlphaMode::Mask { cutoff: 0.5 });
    close("half", mean(&masked, "Diffuse Direct", 0), 0.5, 0.02);
    // Half of the light everywhere.
    let half = under_a_sheet(
        |g| {
            let (p, zero, half) = (g.leaf(Leaf::Position), g.number(1e-9), g.number(0.5));
            g.math(Math::MultiplyAdd, &[p, zero, half])
        },
        AlphaMode::Blend,
    );
    close("blend", mean(&half, "Diffuse Direct", 0), 0.5, 1e-3);
    close("shadow", mean(&half, "Shadow", 0), 0.5, 1e-3);
    // Shadow rays pass, or nothing else does.
    let no_shadow = |g: &mut Graph| {
        let (shadow, one) = (g.leaf(Leaf::Path(PathInfo::IsShadow)), g.number(1.0));
        g.subtract(one, shadow)
    };
    close("no shadow", mean(&under_a_sheet(no_shadow, AlphaMode::Blend), "Diffuse Direct", 0), 1.0, 1e-3);
    let shadow = under_a_sheet(|g| g.leaf(Leaf::Path(PathInfo::IsShadow)), AlphaMode::Blend);
    assert_eq!(mean(&shadow, "Diffuse Direct", 0), 0.0);
    // What folds to a constant is one, whatever it is made of.
    let folded = |value: f64| {
        move |g: &mut Graph| {
            let (index, zero, value) = (g.leaf(Leaf::MaterialIndex), g.number(0.0), g.number(value));
            g.math(Math::MultiplyAdd, &[index, zero, value])
        }
    };
    assert_eq!(mean(&under_a_sheet(folded(1.0), AlphaMode::Blend), "Diffuse Direct", 0), 0.0);
    close("a quarter", mean(&under_a_sheet(folded(0.75), AlphaMode::Blend), "Diffuse Direct", 0), 0.25, 1e-3);
}

/// The shading normal of a plane whose height or map is known.
#[test]
fn normals_come_from_bumps_and_maps() {
    let shown = |make: &dyn Fn(&mut Graph) -> ValueId| {
        let builder = tilted(|graph| {
            let normal = Some(NormalInput::Graph(make(graph)));
            MaterialDesc { normal, ..MaterialDesc::default() }
        });
        let picture = picture(&builder.desc, SIZE, &at_centres("normal"));
        (0..(SIZE * SIZE) as usize).map(|i| DVec3::from(color(&picture, "Normal", i))).collect::<Vec<_>>()
    };
    let near = |what: &str, shown: &[DVec3], expected: DVec3, tolerance: f64| {
        for n in shown {
            assert!((*n - expected).length() < tolerance, "{what}: {n} instead of {expected}");
        }
    };
    let flat = |g: &mut Graph| {
        let (color, one, tangent) = (g.constant([0.5, 0.5, 1.0, 1.0]), g.number(1.0), g.leaf(Leaf::Tangent));
        g.normal_map(color, one, tangent)
    };
    near("flat", &shown(&flat), normal(), 1e-5);
    // Tilted by 45° along the tangent, in object space.
    let tilt = |g: &mut Graph| {
        let (color, one, tangent) = (g.constant([1.0, 0.5, 1.0, 1.0]), g.number(1.0), g.leaf(Leaf::Tangent));
        g.normal_map(color, one, tangent)
    };
    let carried = placement().matrix3.inverse().transpose() * DVec3::new(1.0, 1.0, 0.0);
    near("tilt", &shown(&tilt), carried.normalize(), 1e-5);
    let of_world = |g: &mut Graph| {
        let (color, one) = (g.constant([0.6, 1.0, 0.5, 1.0]), g.number(1.0));
        g.normal_map_of(Space::World, color, one)
    };
    near("world", &shown(&of_world), DVec3::new(0.2, 1.0, 0.0).normalize(), 1e-5);
    // A height of 0.3 x in the world: its gradient along the plane.
    let bump = |g: &mut Graph| {
        let (p, normal) = (g.leaf(Leaf::Position), g.leaf(Leaf::Normal));
        let (one, distance) = (g.number(1.0), g.number(0.3));
        let height = g.place(p, 0);
        g.push(Op::Bump(Bump { height, strength: one, distance, normal, filter_width: 1.0, object_space: false }))
    };
    let n = normal();
    let gradient = (DVec3::X - n * n.x) * 0.3;
    near("bump", &shown(&bump), (n - gradient).normalize(), 1e-4);
}
