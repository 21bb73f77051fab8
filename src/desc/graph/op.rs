//! The operations of a graph.

use super::{Function, Leaf, Sky, Value, ValueId};

/// An operation that makes one value.
#[derive(Clone, Debug, PartialEq)]
pub enum Op {
    /// The same everywhere.
    Constant(Value),
    /// Something known at the hit.
    Leaf(Leaf),
    /// Linear color and alpha of an image. The first two places of `uv` are its coordinates, v downwards.
    /// Where they are an affine map of one UV set the lookup is filtered exactly as a plain texture is;
    /// else the footprint is that of differences of `uv` between neighbouring points.
    Image {
        /// Index into `SceneDesc::textures`.
        texture: u32,
        /// Where.
        uv: ValueId,
    },
    /// A function of other values.
    Apply(Function, Vec<ValueId>),
    /// A procedural texture; its type names the arguments.
    Procedural(Procedural, Vec<ValueId>),
    /// A color of a sky, by a direction with z up.
    Sky {
        /// Which one.
        sky: Sky,
        /// Where.
        direction: ValueId,
    },
    /// A point, direction or normal carried from one space to another.
    Transform {
        /// What it is.
        quantity: Quantity,
        /// The space it is in.
        from: Space,
        /// The space it is to be in.
        to: Space,
        /// The point or vector.
        value: ValueId,
    },
    /// A normal bent by a height; world space.
    Bump(Bump),
    /// The slope of a height over texture coordinates, as a normal map has it.
    Relief(Relief),
    /// What a white layer throws back of light that comes from everywhere, towards whoever looks; a number.
    Albedo {
        /// What it is.
        layer: Layer,
        /// A number, 0 to 1.
        roughness: ValueId,
        /// Index of refraction, a number; fibers have none.
        ior: ValueId,
        /// World space.
        normal: ValueId,
    },
}

/// The slope of a height over texture coordinates: the unit normal of the relief in tangent space, 0 to 1 as a normal
/// map stores it. Level where coordinates stand still. It is MaterialX's `heighttonormal`, with its factor of a
/// sixteenth, by differences over a footprint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relief {
    /// The height, a number. It is evaluated at the hit and at two points beside it, as the coordinates are.
    pub height: ValueId,
    /// Factor of the height, a number.
    pub scale: ValueId,
    /// Coordinates in the first two places, in the directions of tangent and bitangent.
    pub uv: ValueId,
}

/// A layer over a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Fibers, as in `SheenDesc`.
    Sheen,
    /// A dielectric's reflection, as in `CoatDesc`.
    Coat,
}

/// A normal bent by the slope of a height, after Morten Mikkelsen: *Bump Mapping Unparametrized Surfaces on
/// the GPU*, Journal of Graphics Tools 15(1), 2010, as Cycles has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bump {
    /// The height, a number. It is evaluated at the hit and at two points beside it.
    pub height: ValueId,
    /// Share of the bent normal in the result; negative counts as 0.
    pub strength: ValueId,
    /// Metres (object space's with `object_space`) of a height of 1; negative turns the relief around.
    pub distance: ValueId,
    /// The normal to bend, world space; most often [`Leaf::Normal`].
    pub normal: ValueId,
    /// How far the two points are from the hit, in widths of the ray's footprint.
    pub filter_width: f64,
    /// True where heights are in object space, and scale with the object.
    pub object_space: bool,
}

/// A space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Space {
    /// That of the `SceneDesc`.
    World,
    /// The mesh's own.
    Object,
    /// x right, y up, z ahead.
    Camera,
}

/// What three numbers stand for, which says how they go from space to space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// A point.
    Point,
    /// A direction with a length.
    Vector,
    /// The normal of a plane; the result is unit.
    Normal,
}

/// Procedural textures, those of Blender. The result is a color in the first three places and the
/// texture's number in the fourth; where the color costs extra and is not asked for, the number stands in
/// all four.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Procedural {
    /// vector, w, scale, detail, roughness, lacunarity, offset, gain, distortion.
    Noise(Noise),
    /// vector, w, scale, detail, roughness, lacunarity, smoothness, exponent, randomness.
    Voronoi(Voronoi),
    /// vector, scale, distortion, detail, detail scale, detail roughness, phase.
    Wave(Wave),
    /// vector, scale, distortion.
    Magic {
        /// How many times it is folded, 0 to 10.
        depth: u8,
    },
    /// vector, color 1, color 2, mortar color, scale, mortar size, mortar smooth, bias, brick width, row
    /// height. The number is the share of mortar.
    Brick(Brick),
    /// vector, color 1, color 2, scale. The number is 1 where color 1 is.
    Checker,
    /// vector.
    Gradient(Gradient),
    /// vector, w.
    WhiteNoise {
        /// How many coordinates count: w alone, x y, x y z, or all.
        dimensions: u8,
    },
    /// vector: a number of 0 to 1 for each cell of whole coordinates, those of Open Shading Language and MaterialX.
    Cell {
        /// How many coordinates count: x y or x y z.
        dimensions: u8,
    },
    /// vector, detail, roughness, lacunarity: three sums of octaves of noise, as Open Shading Language and MaterialX have
    /// it of vectors. The first of them is the number, and what [`Noise`] makes of the same octaves.
    VectorNoise {
        /// How many coordinates count: x y or x y z.
        dimensions: u8,
    },
    /// vector, jitter: distances to the nearest, second and third point, one in each cell of whole coordinates, as in
    /// MaterialX; the first of them is the number.
    Worley {
        /// How many coordinates count: x y or x y z.
        dimensions: u8,
        /// Three numbers of 0 to 1 for the cell of the nearest point instead, and a fourth that is the number.
        solid: bool,
    },
    /// vector, scale, frequency, anisotropy, orientation (radians in the plane, a vector in space). Value,
    /// phase and intensity stand in the first three places, the value in the fourth, too.
    Gabor {
        /// In the plane of x and y instead of in space.
        flat: bool,
    },
}

/// Fractal Perlin noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// How many coordinates count: w alone, x y, x y z, or all.
    pub dimensions: u8,
    /// How octaves are put together.
    pub kind: NoiseKind,
    /// True where the sum is brought to 0 to 1.
    pub normalize: bool,
    /// True where its color is asked for.
    pub color: bool,
}

/// How octaves of noise are put together (F. K. Musgrave in Ebert et al.: *Texturing and Modeling*).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoiseKind {
    /// A sum.
    Fbm,
    /// A product.
    Multifractal,
    /// A sum weighted by what came before.
    HybridMultifractal,
    /// The same of ridges.
    RidgedMultifractal,
    /// A sum weighted by height.
    HeteroTerrain,
}

/// Cells about random points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Voronoi {
    /// How many coordinates count: w alone, x y, x y z, or all.
    pub dimensions: u8,
    /// What is measured.
    pub feature: VoronoiFeature,
    /// How distance is measured.
    pub metric: Metric,
    /// True where octaves are brought to 0 to 1.
    pub normalize: bool,
    /// What is asked for.
    pub output: VoronoiOutput,
    /// Which random numbers place the points.
    pub scatter: Scatter,
}

/// What is asked of Voronoi noise. Features that have but a distance or radius give that alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoronoiOutput {
    /// The distance in all four places.
    Distance,
    /// The color of the cell, the distance in the fourth place.
    Color,
    /// Where the point is, w in the fourth place.
    Position,
}

/// Which random numbers place the points of Voronoi noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scatter {
    /// Those of Blender up to 4.5.
    Jenkins,
    /// Those of Blender 5.0.
    Pcg,
}

/// What Voronoi noise measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoronoiFeature {
    /// Distance to the nearest point.
    F1,
    /// Distance to the second nearest.
    F2,
    /// The first, smoothed.
    SmoothF1,
    /// Distance to the nearest edge.
    DistanceToEdge,
    /// Radius of the sphere inscribed in the cell.
    NSphereRadius,
}

/// How distance is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// As the crow flies.
    Euclidean,
    /// Sum of the distances along the axes.
    Manhattan,
    /// Largest distance along an axis.
    Chebychev,
    /// Root of the sum of powers.
    Minkowski,
}

/// Bands or rings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Rings instead of bands.
    pub rings: bool,
    /// Along or around what.
    pub direction: WaveDirection,
    /// The shape of a wave.
    pub profile: WaveProfile,
}

/// Along which axis bands follow each other, or around which one rings lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaveDirection {
    /// x.
    X,
    /// y.
    Y,
    /// z.
    Z,
    /// Diagonal bands, or spheres.
    Whole,
}

/// The shape of a wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaveProfile {
    /// Sine.
    Sine,
    /// Saw tooth.
    Saw,
    /// Triangle.
    Triangle,
}

/// Rows of bricks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brick {
    /// How far shifted rows are shifted, in brick widths.
    pub offset: f64,
    /// Every how many rows; 0 for none.
    pub offset_frequency: u32,
    /// How wide squashed bricks are, in brick widths.
    pub squash: f64,
    /// Every how many rows; 0 for none.
    pub squash_frequency: u32,
}

/// Gradients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gradient {
    /// x.
    Linear,
    /// x squared.
    Quadratic,
    /// A smoothstep of x.
    Easing,
    /// The mean of x and y.
    Diagonal,
    /// The angle around z.
    Radial,
    /// One less the distance from the origin, squared.
    QuadraticSphere,
    /// One less the distance from the origin.
    Spherical,
}

impl Op {
    /// Values that it is made of.
    pub fn args(&self) -> impl Iterator<Item = ValueId> {
        let (list, few): (&[ValueId], [Option<ValueId>; 4]) = match self {
            Self::Constant(_) | Self::Leaf(_) => (&[], [None; 4]),
            Self::Image { uv, .. } => (&[], [Some(*uv), None, None, None]),
            Self::Sky { direction, .. } => (&[], [Some(*direction), None, None, None]),
            Self::Apply(_, args) | Self::Procedural(_, args) => (args, [None; 4]),
            Self::Transform { value, .. } => (&[], [Some(*value), None, None, None]),
            Self::Bump(b) => (&[], [b.height, b.strength, b.distance, b.normal].map(Some)),
            Self::Relief(r) => (&[], [Some(r.height), Some(r.scale), Some(r.uv), None]),
            Self::Albedo { roughness, ior, normal, .. } => (&[], [Some(*roughness), Some(*ior), Some(*normal), None]),
        };
        list.iter().copied().chain(few.into_iter().flatten())
    }

    /// The same, to be changed.
    pub(super) fn args_mut(&mut self) -> impl Iterator<Item = &mut ValueId> {
        let (list, few): (&mut [ValueId], [Option<&mut ValueId>; 4]) = match self {
            Self::Constant(_) | Self::Leaf(_) => (&mut [], [None, None, None, None]),
            Self::Image { uv, .. } => (&mut [], [Some(uv), None, None, None]),
            Self::Sky { direction, .. } => (&mut [], [Some(direction), None, None, None]),
            Self::Apply(_, args) | Self::Procedural(_, args) => (args, [None, None, None, None]),
            Self::Transform { value, .. } => (&mut [], [Some(value), None, None, None]),
            Self::Bump(b) => (&mut [], [&mut b.height, &mut b.strength, &mut b.distance, &mut b.normal].map(Some)),
            Self::Relief(r) => (&mut [], [Some(&mut r.height), Some(&mut r.scale), Some(&mut r.uv), None]),
            Self::Albedo { roughness, ior, normal, .. } => (&mut [], [Some(roughness), Some(ior), Some(normal), None]),
        };
        list.iter_mut().chain(few.into_iter().flatten())
    }
}
