//! A compiled graph, and how it runs.

use super::hit::{Beside, Hit};
use super::procedural;
use super::sky::Sky;
use crate::desc::graph::{Function, Layer, Leaf, Math, Procedural, Quantity, Space, Value, finite};
use crate::texture::{Texture, TextureRef};

/// Where a step finds an argument: a constant, or the register of a step before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Operand(u32);

/// How far beside the hit the speed of texture coordinates is taken, in widths of the footprint: so near that
/// coordinates hardly ever jump in between, as those around a sphere do at its seam.
pub(super) const NEAR: f32 = 1.0 / 64.0;

/// Marks a constant.
const CONSTANT: u32 = 1 << 31;

impl Operand {
    pub fn constant(index: usize) -> Self {
        Self(index as u32 | CONSTANT)
    }

    pub fn register(index: u32) -> Self {
        Self(index)
    }
}

/// What a step does.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Action {
    /// Something known at the hit or beside it.
    Leaf(Leaf, Beside),
    /// A named attribute, or what is taken where there is none.
    Attribute(u16, Value, Beside),
    /// An image by a UV set.
    Texture(TextureRef, Beside),
    /// Texture of the scene by any coordinates: those to look up, and those at the hit and [`NEAR`] it.
    Image(u32),
    /// A function.
    Apply(Function),
    /// Arithmetic with numbers: one place stands for all.
    Number(Math),
    /// A procedural texture.
    Procedural(Procedural),
    /// A sky.
    Sky(Sky),
    /// From space to space.
    Transform(Quantity, Space, Space),
    /// height here and at two points beside, strength, distance, normal.
    Bump { filter_width: f64, object_space: bool },
    /// height here and at two points beside, coordinates at the three, factor of the height.
    Relief,
    /// Albedo of a layer: roughness, index, normal.
    Albedo(Layer),
}

/// A step: its action, and where it leaves the result.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub action: Action,
    /// The first of its arguments in [`Program::args`].
    pub first: u32,
    pub count: u8,
    pub out: u32,
}

/// What a program goes by beyond the place itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Asks {
    /// The direction that the surface is seen from.
    pub view: bool,
    /// The path that the ray is part of.
    pub path: bool,
}

/// A compiled graph: steps in order, and which of their results are asked for.
#[derive(Clone, Debug)]
pub struct Program {
    pub(super) steps: Box<[Step]>,
    pub(super) args: Box<[Operand]>,
    pub(super) constants: Box<[Value]>,
    pub(super) outputs: Box<[Operand]>,
    pub(super) registers: u32,
    pub(super) asks: Asks,
}

/// The most arguments that anything takes.
pub(super) const MOST_ARGS: usize = 10;

impl Program {
    /// What it goes by.
    pub fn asks(&self) -> Asks {
        self.asks
    }

    /// How many steps it has.
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// True for a program of constants.
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// How many values it gives.
    pub fn outputs(&self) -> usize {
        self.outputs.len()
    }

    /// Its values at `hit`, in the order in which they were asked for, all of them finite. Programs with more
    /// than 256 values alive at once, which no tree of nodes that was made by hand needs, take their
    /// registers from the heap.
    pub fn run(&self, hit: &impl Hit, textures: &[Texture], out: &mut [Value]) {
        match self.registers {
            0..=16 => self.run_in(hit, textures, &mut [[0.0; 4]; 16], out),
            17..=64 => self.run_in(hit, textures, &mut [[0.0; 4]; 64], out),
            65..=256 => self.run_in(hit, textures, &mut [[0.0; 4]; 256], out),
            many => self.run_in(hit, textures, &mut vec![[0.0; 4]; many as usize], out),
        }
    }

    fn run_in(&self, hit: &impl Hit, textures: &[Texture], registers: &mut [Value], out: &mut [Value]) {
        for step in &self.steps {
            let args = &self.args[step.first as usize..][..usize::from(step.count)];
            let arg = |i: usize| self.get(registers, args[i]);
            let value = match &step.action {
                Action::Leaf(leaf, at) => hit.leaf(leaf, *at),
                Action::Attribute(slot, fallback, at) => hit.attribute(*slot, *at).unwrap_or(*fallback),
                Action::Texture(texture, at) => hit.texture(texture, *at).map(f64::from),
                Action::Image(texture) => look_up(&textures[*texture as usize], [arg(0), arg(1), arg(2), arg(3)]),
                Action::Number(math) => {
                    let number = |i: usize| args.get(i).map_or(0.0, |arg| self.get(registers, *arg)[0]);
                    [math.number(number(0), number(1), number(2)); 4]
                }
                Action::Apply(function) => match args.len() {
                    1 => function.eval(&[arg(0)]),
                    2 => function.eval(&[arg(0), arg(1)]),
                    3 => function.eval(&[arg(0), arg(1), arg(2)]),
                    _ => function.eval(self.gather(registers, args, &mut [[0.0; 4]; MOST_ARGS])),
                },
                Action::Procedural(texture) => {
                    procedural::eval(texture, self.gather(registers, args, &mut [[0.0; 4]; MOST_ARGS]))
                }
                Action::Sky(sky) => {
                    let [r, g, b] = sky.radiance(arg(0)).to_array().map(f64::from);
                    finite([r, g, b, 1.0])
                }
                Action::Transform(quantity, from, to) => finite(hit.transform(*quantity, *from, *to, arg(0))),
                Action::Bump { filter_width, object_space } => {
                    let heights = [arg(0)[0], arg(1)[0], arg(2)[0]];
                    finite(bump(hit, heights, arg(3)[0], arg(4)[0], arg(5), *filter_width, *object_space))
                }
                Action::Relief => {
                    let factor = arg(6)[0] * SOBEL;
                    finite(relief([0, 1, 2].map(|i| factor * arg(i)[0]), [arg(3), arg(4), arg(5)]))
                }
                Action::Albedo(layer) => finite([hit.albedo(*layer, arg(0)[0], arg(1)[0], arg(2)); 4]),
            };
            registers[step.out as usize] = value;
        }
        for (out, operand) in out.iter_mut().zip(&self.outputs) {
            *out = self.get(registers, *operand);
        }
    }

    #[inline(always)]
    fn get(&self, registers: &[Value], Operand(at): Operand) -> Value {
        if at & CONSTANT == 0 { registers[at as usize] } else { self.constants[(at & !CONSTANT) as usize] }
    }

    fn gather<'v>(&self, registers: &[Value], args: &[Operand], values: &'v mut [Value; MOST_ARGS]) -> &'v [Value] {
        for (value, arg) in values.iter_mut().zip(args) {
            *value = self.get(registers, *arg);
        }
        &values[..args.len().min(MOST_ARGS)]
    }
}

/// An image at `uv`, averaged over how far coordinates move along the footprint, by the faster one of its two
/// directions.
fn look_up(texture: &Texture, [uv, here, x, y]: [Value; 4]) -> Value {
    let width = |to: Value| (to[0] - here[0]).hypot(to[1] - here[1]) / f64::from(NEAR);
    texture.lookup([uv[0] as f32, uv[1] as f32], width(x).max(width(y)) as f32).map(f64::from)
}

/// See [`crate::desc::graph::Bump`].
fn bump(
    hit: &impl Hit,
    [here, x, y]: [f64; 3],
    strength: f64,
    distance: f64,
    normal: Value,
    filter_width: f64,
    object_space: bool,
) -> Value {
    let carried = |quantity: Quantity, from: Space, to: Space, v: Value| {
        if object_space { hit.transform(quantity, from, to, v) } else { v }
    };
    let n = carried(Quantity::Normal, Space::World, Space::Object, normal);
    let [dx, dy] = hit.footprint().map(|d| carried(Quantity::Vector, Space::World, Space::Object, d));
    // The gradient of the height over the surface, times the area that dx and dy span.
    let (rx, ry) = (cross(dy, n), cross(n, dx));
    let area = dot(dx, rx);
    let slope = |i: usize| (x - here) * rx[i] + (y - here) * ry[i];
    let bent: Value = std::array::from_fn(|i| match i {
        3 => 0.0,
        _ => filter_width * area.abs() * n[i] - distance * area.signum() * slope(i),
    });
    let bent = unit(bent);
    if bent == [0.0; 4] {
        return normal;
    }
    let strength = strength.max(0.0);
    let mixed = unit(std::array::from_fn(|i| strength * bent[i] + (1.0 - strength) * n[i]));
    if mixed == [0.0; 4] { normal } else { carried(Quantity::Normal, Space::Object, Space::World, mixed) }
}

/// What a height of 1 is to MaterialX's `heighttonormal`.
const SOBEL: f64 = 1.0 / 16.0;

/// The normal of a level surface as a normal map stores it.
pub(super) const LEVEL: Value = [0.5, 0.5, 1.0, 1.0];

/// See [`crate::desc::graph::Relief`].
fn relief([here, x, y]: [f64; 3], [uv, uv_x, uv_y]: [Value; 3]) -> Value {
    let along = |to: Value, height: f64| [to[0] - uv[0], to[1] - uv[1], height - here, 0.0];
    let n = unit(cross(along(uv_x, x), along(uv_y, y)));
    if n[2] == 0.0 {
        return LEVEL;
    }
    // Coordinates may run the other way round.
    let side = n[2].signum();
    std::array::from_fn(|i| if i == 3 { 1.0 } else { 0.5 + 0.5 * side * n[i] })
}

fn cross(a: Value, b: Value) -> Value {
    Function::Cross.eval(&[a, b])
}

fn dot(a: Value, b: Value) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit([x, y, z, _]: Value) -> Value {
    Function::Normalize(3).eval(&[[x, y, z, 0.0]])
}
