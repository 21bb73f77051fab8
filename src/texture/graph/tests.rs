//! Programs against the graph they come from, evaluated without any of what compiling does.

use std::sync::Arc;

use proptest::prelude::*;

use super::*;
use crate::desc::graph::{
    Blend, Bump, Function, Graph, Layer, Leaf, Mapping, Math, Op, PathInfo, Quantity, Range, Relief, Space, Value,
    ValueId, finite,
};
use crate::desc::{Blending, ColorSpace, Filter, ImageDesc, PixelData, TextureDesc, TextureTransform, Wrap};
use crate::error::{Place, Warnings};
use crate::texture::{Image, Texture, TextureRef, UvTransform};

/// A point of the plane z = 1 + x / 2 with simple numbers for everything else.
struct Plain {
    textures: Vec<Texture>,
    width: f64,
    front: bool,
}

const DX: [f64; 3] = [0.894_427_190_999_916, 0.0, 0.447_213_595_499_958];
const DY: [f64; 3] = [0.0, 1.0, 0.0];
const P: [f64; 3] = [0.3, -0.7, 1.15];

impl Plain {
    fn uv(&self, set: u32, [x, y]: Beside) -> [f64; 2] {
        let scale = f64::from(set + 1) * self.width;
        [0.25 + scale * f64::from(x), 0.6 + 0.5 * scale * f64::from(y)]
    }
}

impl Hit for Plain {
    fn leaf(&self, leaf: &Leaf, at: Beside) -> Value {
        match leaf {
            Leaf::Position => {
                let [x, y, z] =
                    std::array::from_fn(|i| P[i] + self.width * (f64::from(at[0]) * DX[i] + f64::from(at[1]) * DY[i]));
                [x, y, z, 0.0]
            }
            Leaf::Uv(set) => {
                let [u, v] = self.uv(*set, at);
                [u, v, 0.0, 1.0]
            }
            Leaf::Normal => [-0.447_213_595_499_958, 0.0, 0.894_427_190_999_916, 0.0],
            Leaf::Incoming => [0.0, 0.6, 0.8, 0.0],
            Leaf::Backfacing => [f64::from(u8::from(!self.front)); 4],
            Leaf::Path(PathInfo::Length) => [2.5; 4],
            Leaf::ObjectColor => [0.2, 0.4, 0.6, 0.8],
            _ => [0.5; 4],
        }
    }

    fn attribute(&self, slot: u16, _at: Beside) -> Option<Value> {
        (slot == 0).then_some([0.1, 0.2, 0.3, 0.4])
    }

    fn texture(&self, texture: &TextureRef, at: Beside) -> [f32; 4] {
        texture.lookup(&self.textures, self.uv(texture.uv_set, at).map(|x| x as f32), self.width as f32)
    }

    fn transform(&self, quantity: Quantity, from: Space, _to: Space, [x, y, z, w]: Value) -> Value {
        // Object space is twice as large along y, and moved.
        let (stretch, shift) = if from == Space::World { (2.0, 1.0) } else { (0.5, -0.5) };
        match quantity {
            Quantity::Point => [x, stretch * y + shift, z, w],
            Quantity::Vector => [x, stretch * y, z, w],
            Quantity::Normal => Function::Normalize(3).eval(&[[x, y / stretch, z, 0.0]]),
        }
    }

    fn albedo(&self, layer: Layer, roughness: f64, ior: f64, normal: Value) -> f64 {
        let share = 0.25 * (roughness + normal[2]);
        if layer == Layer::Sheen { share } else { share * ior }
    }

    fn footprint(&self) -> [Value; 2] {
        [DX, DY].map(|[x, y, z]| [x, y, z, 0.0].map(|v| v * self.width))
    }
}

/// "a" is in slot 0, all others are nowhere; texture 2 is gray.
struct Names;

impl Resolve for Names {
    fn texture(&mut self, texture: u32) -> Resolved {
        if texture == 2 { Resolved::Constant([0.5, 0.5, 0.5, 1.0]) } else { Resolved::Texture(texture) }
    }

    fn attribute(&mut self, name: &Arc<str>) -> u16 {
        u16::from(**name != *"a")
    }

    fn material_index(&self) -> u32 {
        7
    }
}

fn texture(filter: Filter) -> Texture {
    let texels = (0..4 * 8 * 4).map(|i| f32::from((i * 37 % 101) as u8) / 101.0).collect();
    let image = ImageDesc {
        name: "i".into(),
        place: Place::default(),
        width: 8,
        height: 4,
        channels: 4,
        color_space: ColorSpace::Linear,
        blending: Blending::default(),
        pixels: PixelData::F32(texels),
    };
    let image = Image::new(image, &mut Warnings::new()).unwrap();
    let desc = TextureDesc { place: Place::default(), image: 0, wrap_u: Wrap::Repeat, wrap_v: Wrap::Mirror, filter };
    Texture::new(Arc::new(image), &desc)
}

fn plain(width: f64) -> Plain {
    Plain { textures: vec![texture(Filter::Linear), texture(Filter::Nearest)], width, front: true }
}

/// The value of `id` beside the hit by its definition, every operation as often as it is used.
fn naive(graph: &Graph, id: ValueId, hit: &Plain, at: Beside) -> Value {
    let value = |id: ValueId| naive(graph, id, hit, at);
    let around = |id: ValueId, width: f32| [[0.0, 0.0], [width, 0.0], [0.0, width]].map(|at| naive(graph, id, hit, at));
    match graph.op(id) {
        Op::Constant(value) => *value,
        Op::Leaf(Leaf::MaterialIndex) => [7.0; 4],
        Op::Leaf(Leaf::Attribute { name, fallback }) => {
            if **name == *"a" {
                [0.1, 0.2, 0.3, 0.4]
            } else {
                *fallback
            }
        }
        Op::Leaf(leaf) => hit.leaf(leaf, at),
        Op::Apply(function, args) => function.eval(&args.iter().map(|id| value(*id)).collect::<Vec<_>>()),
        Op::Procedural(texture, args) => {
            procedural::eval(texture, &args.iter().map(|id| value(*id)).collect::<Vec<_>>())
        }
        Op::Sky { .. } | Op::Relief(_) => panic!("random graphs have none"),
        Op::Albedo { layer, roughness, ior, normal } => {
            [hit.albedo(*layer, value(*roughness)[0], value(*ior)[0], value(*normal)); 4]
        }
        Op::Transform { quantity, from, to, value: id } => finite(hit.transform(*quantity, *from, *to, value(*id))),
        Op::Image { texture: 2, .. } => [0.5, 0.5, 0.5, 1.0],
        Op::Image { texture, uv } => {
            let [here, x, y] = around(*uv, 1.0 / 64.0);
            let apart = |to: Value| 64.0 * (to[0] - here[0]).hypot(to[1] - here[1]);
            let uv = value(*uv);
            let width = apart(x).max(apart(y)) as f32;
            hit.textures[*texture as usize].lookup([uv[0] as f32, uv[1] as f32], width).map(f64::from)
        }
        Op::Bump(bump) => {
            let [strength, distance, normal] =
                [bump.strength, bump.distance, bump.normal].map(|id| naive(graph, id, hit, HERE));
            let [h, x, y] = around(bump.height, bump.filter_width as f32).map(|h| h[0]);
            if h == x && h == y {
                return normal;
            }
            // Slopes along DX and DY, which are unit and square to each other.
            let [sx, sy] = [x - h, y - h].map(|d| distance[0] * d / (bump.filter_width * hit.width));
            let n = glam::DVec3::new(normal[0], normal[1], normal[2]);
            let (dx, dy) = (glam::DVec3::from(DX), glam::DVec3::from(DY));
            let det = dx.dot(dy.cross(n));
            let gradient = dy.cross(n) * sx + n.cross(dx) * sy;
            let bent = (n * det.abs() - gradient * det.signum()).normalize_or_zero();
            let s = strength[0].max(0.0);
            let mixed = (bent * s + n * (1.0 - s)).normalize_or_zero();
            let result = if bent == glam::DVec3::ZERO || mixed == glam::DVec3::ZERO { n } else { mixed };
            [result.x, result.y, result.z, 0.0]
        }
    }
}

fn run(graph: &Graph, ids: &[ValueId], hit: &Plain) -> Vec<Value> {
    let mut out = vec![[0.0; 4]; ids.len()];
    Compiler::new(graph, &mut Names).program(ids).run(hit, &hit.textures, &mut out);
    out
}

const MATHS: [Math; 14] = [
    Math::Add,
    Math::Subtract,
    Math::Multiply,
    Math::Divide,
    Math::MultiplyAdd,
    Math::Power,
    Math::Modulo,
    Math::Wrap,
    Math::Sine,
    Math::Arctangent2,
    Math::Exponent,
    Math::Floor,
    Math::LessThan,
    Math::SmoothMinimum,
];

/// An operation by numbers that say which one and of what.
fn random_op(kind: u8, pick: u8, x: f64, args: [ValueId; 3], graph: &mut Graph) -> ValueId {
    let [a, b, c] = args;
    match kind % 17 {
        0 => graph.number(x),
        1 => graph.constant([x, 1.0, -x, 0.0]),
        2 => graph.number([0.0, 1.0][usize::from(pick % 2)]),
        3 => {
            let leaves = [
                Leaf::Position,
                Leaf::Uv(u32::from(pick % 2)),
                Leaf::Normal,
                Leaf::Incoming,
                Leaf::Backfacing,
                Leaf::MaterialIndex,
                Leaf::Path(PathInfo::Length),
                Leaf::Attribute { name: if pick.is_multiple_of(2) { "a" } else { "b" }.into(), fallback: [x; 4] },
            ];
            graph.leaf(leaves[usize::from(pick) % leaves.len()].clone())
        }
        4..=8 => graph.math(MATHS[usize::from(pick) % MATHS.len()], &[a, b, c]),
        9 => graph.apply(Function::Swizzle([pick % 4, pick / 4 % 4, pick / 16 % 4, pick / 64]), &[a]),
        10 => {
            let blends = [Blend::Mix, Blend::Screen, Blend::Hue, Blend::Burn];
            let blend = blends[usize::from(pick) % 4];
            graph.apply(Function::Mix { blend, clamp_factor: pick > 127, clamp_result: false }, &[a, b, c])
        }
        11 => {
            let functions = [
                Function::Cross,
                Function::Dot(3),
                Function::Normalize(3),
                Function::IfGreater,
                Function::Combine,
                Function::RgbToHsv,
                Function::Mapping(Mapping::Point),
                Function::MapRange { range: Range::Smooth, clamp: true, vector: false },
            ];
            graph.apply(functions[usize::from(pick) % functions.len()].clone(), &[a, b, c, a])
        }
        12 => {
            // Through a sine: by no affine map.
            let bent = graph.math(Math::Sine, &[a]);
            graph.image(u32::from(pick % 3), bent)
        }
        13 => {
            let up = graph.constant([0.0, 0.0, 1.0, 0.0]);
            let bump = Bump {
                height: a,
                strength: b,
                distance: c,
                normal: up,
                filter_width: f64::from(pick % 3) * 0.5 + 0.5,
                object_space: false,
            };
            graph.push(Op::Bump(bump))
        }
        14 => {
            let layer = if pick.is_multiple_of(2) { Layer::Sheen } else { Layer::Coat };
            graph.push(Op::Albedo { layer, roughness: a, ior: b, normal: c })
        }
        15 => graph.transform(Quantity::Point, Space::World, Space::Object, a),
        _ => graph.apply(Function::Length(3), &[a]),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Bumps apart, whose formula is written in another way here, results are the same to the bit.
    #[test]
    fn programs_are_what_their_graph_says(
        ops in prop::collection::vec((0_u8..16, 0_u8.., -2.0_f64..2.0, [0_usize.., 0.., 0..]), 1..24),
        width in 1e-3_f64..0.3,
    ) {
        let mut graph = Graph::default();
        let mut ids = vec![graph.leaf(Leaf::Position)];
        let bumped = ops.iter().any(|(kind, ..)| kind % 16 == 13);
        for (kind, pick, x, args) in ops {
            let args = args.map(|i| ids[i % ids.len()]);
            ids.push(random_op(kind, pick, x, args, &mut graph));
        }
        let hit = plain(width);
        let roots = &ids[ids.len().saturating_sub(3)..];
        for (got, id) in run(&graph, roots, &hit).into_iter().zip(roots) {
            prop_assert!(got.iter().all(|x| x.is_finite()), "{got:?}");
            let expected = naive(&graph, *id, &hit, HERE);
            if !bumped {
                prop_assert_eq!(got, expected, "{:?}", graph);
            }
        }
    }
}

#[test]
fn bumps_bend_normals_by_the_slope() {
    let mut graph = Graph::default();
    let p = graph.leaf(Leaf::Position);
    let (one, two) = (graph.number(1.0), graph.number(2.0));
    let x = graph.place(p, 0);
    let height = graph.math(Math::Power, &[x, two]);
    let half = graph.number(0.5);
    let normal = graph.leaf(Leaf::Normal);
    for (strength, object_space) in [(one, false), (half, false), (two, false), (one, true)] {
        let bump = Bump { height, strength, distance: half, normal, filter_width: 1.0, object_space };
        let id = graph.push(Op::Bump(bump));
        let hit = plain(1e-4);
        let got = run(&graph, &[id], &hit)[0];
        if !object_space {
            let expected = naive(&graph, id, &hit, HERE);
            assert!((0..3).all(|i| (got[i] - expected[i]).abs() < 1e-9), "{got:?} {expected:?}");
        }
        if strength == one {
            // x² / 2 has the slope 0.3 along x, and that over the plane 0.3 · 0.894…
            let slope = 0.3 * DX[0];
            let (n, d) = ([-DX[2], 0.0, DX[0]], DX);
            let length = (1.0 + slope * slope).sqrt();
            assert!((0..3).all(|i| (got[i] - (n[i] - slope * d[i]) / length).abs() < 1e-4), "{got:?}");
        }
    }
    // What is level stays as it is, and so does everything where the footprint has no width.
    let level = Bump { height: half, strength: one, distance: one, normal, filter_width: 1.0, object_space: false };
    let level = graph.push(Op::Bump(level));
    assert_eq!(run(&graph, &[level], &plain(0.1))[0], plain(0.1).leaf(&Leaf::Normal, HERE));
    let bump = Bump { height, strength: one, distance: one, normal, filter_width: 1.0, object_space: false };
    let bump = graph.push(Op::Bump(bump));
    assert_eq!(run(&graph, &[bump], &plain(0.0))[0], plain(0.0).leaf(&Leaf::Normal, HERE));
}

/// u² + 3 v rises by 2 u along u and by 3 along v; a sixteenth of that counts.
#[test]
fn reliefs_are_the_slope_over_the_coordinates() {
    let mut graph = Graph::default();
    let uv = graph.leaf(Leaf::Uv(0));
    let [u, v] = [0, 1].map(|place| graph.place(uv, place));
    let (two, three) = (graph.number(2.0), graph.number(3.0));
    let (square, triple) = (graph.math(Math::Power, &[u, two]), graph.math(Math::Multiply, &[v, three]));
    let height = graph.math(Math::Add, &[square, triple]);
    let minus = graph.constant([-1.0, 1.0, 1.0, 1.0]);
    let mirrored = graph.math(Math::Multiply, &[uv, minus]);
    let (eight, half) = (graph.number(8.0), graph.number(0.5));
    let of = |graph: &mut Graph, height, uv| graph.push(Op::Relief(Relief { height, scale: eight, uv }));
    for (uv, along) in [(uv, 0.25), (mirrored, -0.25)] {
        let relief = of(&mut graph, height, uv);
        let [x, y, z, _] = run(&graph, &[relief], &plain(1e-5))[0];
        let length = (along * along + 1.5_f64 * 1.5 + 1.0).sqrt();
        for (found, expected) in [(x, -along), (y, -1.5), (z, 1.0)] {
            assert!((2.0 * found - 1.0 - expected / length).abs() < 1e-4, "{x} {y} {z}");
        }
    }
    // Level heights, coordinates that stand still and footprints without width are level.
    let level = [of(&mut graph, half, uv), of(&mut graph, height, half)];
    assert_eq!(run(&graph, &level, &plain(0.1)), [[0.5, 0.5, 1.0, 1.0]; 2]);
    let relief = of(&mut graph, height, uv);
    assert_eq!(run(&graph, &[relief], &plain(0.0))[0], [0.5, 0.5, 1.0, 1.0]);
}

/// A UV set, scaled, turned and moved by all the operations that doors use for it, is the plain texture.
#[test]
fn images_by_a_uv_set_are_plain_lookups_to_the_bit() {
    let hit = plain(0.04);
    let transform = TextureTransform([[2.0, 0.5, 0.25], [-0.5, 3.0, -1.0]]);
    let plain = TextureRef { texture: 0, uv_set: 1, transform: UvTransform::from(transform) };
    let expected = hit.texture(&plain, HERE).map(f64::from);
    let TextureTransform([u, v]) = transform;

    let mut graph = Graph::default();
    let uv = graph.leaf(Leaf::Uv(1));
    let rows = [[u[0], u[1], 0.0, u[2]], [v[0], v[1], 0.0, v[2]], [0.0; 4]];
    let by_matrix = graph.apply(Function::Affine(Box::new(rows)), &[uv]);
    let swapped = graph.apply(Function::Swizzle([1, 0, 2, 3]), &[uv]);
    let straight = graph.constant([u[0], v[1], 1.0, 1.0]);
    let across = graph.constant([u[1], v[0], 0.0, 0.0]);
    let moved = graph.constant([u[2], v[2], 0.0, 0.0]);
    let straight = graph.multiply(uv, straight);
    let by_maths = graph.math(Math::MultiplyAdd, &[swapped, across, straight]);
    let by_maths = graph.add(by_maths, moved);
    let (along, up) = (graph.place(by_maths, 0), graph.place(by_maths, 1));
    let zero = graph.number(0.0);
    let put_together = graph.combine(along, up, zero);
    let images = [by_matrix, by_maths, put_together].map(|uv| graph.image(0, uv));
    let values = run(&graph, &images, &hit);
    assert_eq!(values, vec![expected; 3]);
    let program = Compiler::new(&graph, &mut Names).program(&images);
    assert_eq!(program.len(), 1, "three times the same lookup, and nothing else");
}

#[test]
fn other_coordinates_are_averaged_over_their_differences() {
    let mut graph = Graph::default();
    let p = graph.leaf(Leaf::Position);
    let image = graph.image(0, p);
    for width in [1e-4, 0.2, 0.9] {
        let hit = plain(width);
        let expected = hit.textures[0].lookup([P[0] as f32, P[1] as f32], width as f32);
        let got = run(&graph, &[image], &hit)[0];
        assert!((0..4).all(|i| (got[i] - f64::from(expected[i])).abs() < 1e-6), "{got:?} {expected:?}");
    }
    // Coordinates jump within the footprint, by a whole image, and are as fast as without.
    let (zero, shift) = (graph.number(0.0), graph.number(0.699));
    let x = graph.place(p, 0);
    let moved = graph.add(x, shift);
    let fraction = graph.math(Math::Fraction, &[moved]);
    let uv = graph.combine(fraction, zero, zero);
    let image = graph.image(0, uv);
    let hit = plain(0.01);
    let expected = hit.textures[0].lookup([0.999, 0.0], (0.01 * DX[0]) as f32);
    let got = run(&graph, &[image], &hit)[0];
    assert!((0..4).all(|i| (got[i] - f64::from(expected[i])).abs() < 1e-4), "{got:?} {expected:?}");
}

#[test]
fn what_is_not_needed_is_not_there() {
    let mut graph = Graph::default();
    let uv = graph.leaf(Leaf::Uv(0));
    let used = graph.math(Math::Sine, &[uv]);
    let unused = graph.math(Math::Cosine, &[uv]);
    graph.math(Math::Tangent, &[unused]);
    let length = |graph: &Graph, ids: &[ValueId]| Compiler::new(graph, &mut Names).program(ids).len();
    assert_eq!(length(&graph, &[used]), 2);
    assert_eq!(length(&graph, &[used, unused]), 3);
    // Twice the same, found after other operations.
    let again = graph.push(Op::Apply(Function::Math(Math::Sine), vec![uv]));
    let sum = graph.add(used, again);
    assert_eq!(length(&graph, &[sum]), 3);
    // Constants fold through images that are the same all over and the material's index.
    let gray = graph.image(2, uv);
    let index = graph.leaf(Leaf::MaterialIndex);
    let known = graph.multiply(gray, index);
    assert_eq!(Compiler::new(&graph, &mut Names).constant(known), Some([3.5, 3.5, 3.5, 7.0]));
    let zero = graph.number(0.0);
    let nothing = graph.multiply(used, zero);
    let mixed = graph.mix(used, known, zero);
    assert_eq!((length(&graph, &[nothing]), length(&graph, &[mixed])), (0, 2));
}

#[test]
fn programs_say_what_they_go_by() {
    let mut graph = Graph::default();
    let (uv, camera) = (graph.leaf(Leaf::Uv(0)), graph.leaf(Leaf::Path(PathInfo::IsCamera)));
    let back = graph.leaf(Leaf::Backfacing);
    let seen = graph.add(uv, back);
    let path = graph.multiply(uv, camera);
    let asks = |ids: &[ValueId]| Compiler::new(&graph, &mut Names).program(ids).asks();
    assert_eq!(asks(&[uv]), Asks::default());
    assert_eq!(asks(&[seen]), Asks { view: true, path: false });
    assert_eq!(asks(&[path]), Asks { view: true, path: true });
}

/// Long chains, wide sums and images within images end, and are what they should be.
#[test]
fn huge_graphs_are_compiled_and_run() {
    let mut graph = Graph::default();
    let mut chain = graph.leaf(Leaf::Uv(0));
    for _ in 0..50_000 {
        chain = graph.math(Math::Cosine, &[chain]);
    }
    // The fixed point of the cosine.
    assert!((run(&graph, &[chain], &plain(0.1))[0][0] - 0.739_085_133_215_160_6).abs() < 1e-12);

    let mut graph = Graph::default();
    let uv = graph.leaf(Leaf::Uv(0));
    let terms: Vec<ValueId> = (0..1000)
        .map(|i| {
            let shift = graph.number(f64::from(i));
            let moved = graph.add(uv, shift);
            graph.math(Math::Sine, &[moved])
        })
        .collect();
    let (mut sum, mut expected) = (terms[0], 0.25_f64.sin());
    for (i, term) in terms.iter().enumerate().skip(1) {
        sum = graph.add(sum, *term);
        expected += (0.25 + i as f64).sin();
    }
    let program = Compiler::new(&graph, &mut Names).program(&[sum]);
    assert!(program.registers > 256, "{}", program.registers);
    assert!((run(&graph, &[sum], &plain(0.1))[0][0] - expected).abs() < 1e-9);

    let mut graph = Graph::default();
    let mut image = graph.leaf(Leaf::Position);
    for _ in 0..2000 {
        image = graph.image(0, image);
    }
    let value = run(&graph, &[image], &plain(0.1))[0];
    assert!(value.iter().all(|x| (0.0..=1.0).contains(x)));
}
