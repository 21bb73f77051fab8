//! Expressions that are more than `factor × texture`, computed per texel into an image of their own.

use std::sync::LazyLock;

use half::f16;
use rayon::prelude::*;

use super::expr::{Exprs, Id, Lookup, Op};
use super::function::{V, from_srgb};
use crate::desc::{ColorSpace, Filter, ImageDesc, PixelData, TextureDesc, TextureTransform, Wrap};

/// Largest side of a computed image.
const LARGEST: u32 = 4096;

/// Side of an image that is computed from texture coordinates alone.
const OF_UV: u32 = 512;

/// Where and how finely an expression is computed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Domain {
    pub size: [u32; 2],
    pub uv_set: u32,
    /// How the computed image lies in the UVs of the mesh.
    pub transform: TextureTransform,
    pub wrap: [Wrap; 2],
    pub filter: Filter,
    /// True where all lookups are placed alike: the domain is their image's, not the mesh's UVs.
    shared: bool,
    /// What had to be given up.
    pub notes: Vec<&'static str>,
}

/// What lookups see.
#[derive(Clone, Copy)]
pub(super) struct Tables<'a> {
    pub images: &'a [ImageDesc],
    pub textures: &'a [TextureDesc],
}

impl Tables<'_> {
    fn image(&self, lookup: &Lookup) -> &ImageDesc {
        &self.images[self.textures[lookup.texture.texture as usize].image as usize]
    }
}

/// Where `root` is to be computed; `None` for what no texture drives.
pub(super) fn domain(exprs: &Exprs, root: Id, tables: Tables<'_>) -> Option<Domain> {
    let needed = exprs.needed(root);
    let lookups: Vec<&Lookup> = needed
        .iter()
        .filter_map(|id| match exprs.op(*id) {
            Op::Lookup(lookup) => Some(lookup),
            _ => None,
        })
        .collect();
    let uv = needed.iter().find_map(|id| match exprs.op(*id) {
        Op::Uv { set, .. } => Some(*set),
        _ => None,
    });
    let texture = |lookup: &Lookup| &tables.textures[lookup.texture.texture as usize];
    let mut notes = Vec::new();
    let Some(first) = lookups.first() else {
        return uv.map(|uv_set| Domain {
            size: [OF_UV; 2],
            uv_set,
            transform: TextureTransform::IDENTITY,
            wrap: [Wrap::Repeat; 2],
            filter: Filter::Linear,
            shared: false,
            notes,
        });
    };
    let way = |l: &Lookup| (l.texture.uv_set, l.texture.transform, texture(l).wrap_u, texture(l).wrap_v);
    let shared = uv.is_none() && lookups.iter().all(|l| way(l) == way(first));
    if lookups.iter().any(|l| l.texture.uv_set != first.texture.uv_set)
        || uv.is_some_and(|set| set != first.texture.uv_set)
    {
        notes.push("its textures use several UV sets, all are looked up by the first one's");
    }
    if !shared {
        notes.push("its textures are placed differently, it is computed for UVs within 0 to 1 and repeated");
    }
    let mut size = [1_u32; 2];
    for lookup in &lookups {
        let image = tables.image(lookup);
        let TextureTransform([u, v]) = lookup.texture.transform;
        let times = if shared { [1.0; 2] } else { [u[0].hypot(v[0]), u[1].hypot(v[1])] };
        for (size, (texels, times)) in size.iter_mut().zip([image.width, image.height].into_iter().zip(times)) {
            let wanted = (f64::from(texels) * times).ceil().clamp(1.0, 1e6) as u32;
            *size = (*size).max(wanted);
        }
    }
    if size.iter().any(|side| *side > LARGEST) {
        notes.push("it is computed at 4096 texels to a side");
        size = size.map(|side| side.min(LARGEST));
    }
    let (transform, wrap) = match shared {
        true => (first.texture.transform, [texture(first).wrap_u, texture(first).wrap_v]),
        false => (TextureTransform::IDENTITY, [Wrap::Repeat; 2]),
    };
    Some(Domain { size, uv_set: first.texture.uv_set, transform, wrap, filter: texture(first).filter, shared, notes })
}

/// The expression in half floats, `channels` to a texel.
pub(super) fn image(exprs: &Exprs, root: Id, domain: &Domain, tables: Tables<'_>, channels: u8) -> Vec<f16> {
    let [width, height] = domain.size;
    let n = usize::from(channels);
    let program = Program::new(exprs, root, tables);
    let mut pixels = vec![f16::ZERO; width as usize * height as usize * n];
    pixels.par_chunks_mut(width as usize * n).enumerate().for_each(|(y, row)| {
        let mut registers = program.registers();
        for (x, texel) in row.chunks_mut(n).enumerate() {
            let uv = [(x as f64 + 0.5) / f64::from(width), (y as f64 + 0.5) / f64::from(height)];
            let value = program.run(&mut registers, uv, domain);
            for (texel, value) in texel.iter_mut().zip(value) {
                *texel = f16::from_f64(if value.is_finite() { value.clamp(-65504.0, 65504.0) } else { 0.0 });
            }
        }
    });
    pixels
}

/// The mean of an expression over its domain, of 16 × 16 points.
pub(super) fn mean(exprs: &Exprs, root: Id, tables: Tables<'_>) -> V {
    let Some(domain) = domain(exprs, root, tables) else { return [0.0; 4] };
    let program = Program::new(exprs, root, tables);
    let mut registers = program.registers();
    let mut sum = [0.0; 4];
    for i in 0..256 {
        let uv = [(f64::from(i % 16) + 0.5) / 16.0, (f64::from(i / 16) + 0.5) / 16.0];
        let value = program.run(&mut registers, uv, &domain);
        for (sum, value) in sum.iter_mut().zip(value) {
            *sum += if value.is_finite() { value / 256.0 } else { 0.0 };
        }
    }
    sum
}

/// Expressions in the order in which they are computed.
struct Program<'a> {
    exprs: &'a Exprs,
    steps: Vec<(Id, Option<Sampler<'a>>)>,
    root: Id,
}

impl<'a> Program<'a> {
    fn new(exprs: &'a Exprs, root: Id, tables: Tables<'a>) -> Self {
        let steps = exprs.needed(root).into_iter().map(|id| match exprs.op(id) {
            Op::Lookup(lookup) => {
                let texture = &tables.textures[lookup.texture.texture as usize];
                (id, Some(Sampler { image: &tables.images[texture.image as usize], texture }))
            }
            _ => (id, None),
        });
        Self { exprs, steps: steps.collect(), root }
    }

    fn registers(&self) -> Vec<V> {
        vec![[0.0; 4]; self.root.0 as usize + 1]
    }

    /// The value at `uv`: of the image that all lookups share, or of the mesh.
    fn run(&self, registers: &mut [V], uv: [f64; 2], domain: &Domain) -> V {
        for (id, sampler) in &self.steps {
            registers[id.0 as usize] = match (self.exprs.op(*id), sampler) {
                (Op::Constant(value), _) => *value,
                (Op::Lookup(lookup), Some(sampler)) => {
                    let at = if domain.shared { uv } else { transformed(lookup.texture.transform, uv) };
                    let texel = sampler.sample(at);
                    std::array::from_fn(|i| {
                        lookup.factor[i] * texel[usize::from(lookup.swizzle[i].min(3))] + lookup.bias[i]
                    })
                }
                (Op::Lookup(_), None) => [1.0; 4],
                (Op::Uv { rows, .. }, _) => {
                    let st = [uv[0], 1.0 - uv[1]];
                    let [u, v] = rows.map(|row| row[0] * st[0] + row[1] * st[1] + row[2]);
                    [u, v, 0.0, 1.0]
                }
                (Op::Primvar { fallback, .. }, _) => *fallback,
                (Op::Apply(function, args), _) => {
                    let mut values = [[0.0; 4]; 4];
                    let count = args.len().min(4);
                    for (value, arg) in values.iter_mut().zip(args) {
                        *value = registers[arg.0 as usize];
                    }
                    function.eval(&values[..count])
                }
            };
        }
        registers[self.root.0 as usize]
    }
}

fn transformed(TextureTransform(rows): TextureTransform, uv: [f64; 2]) -> [f64; 2] {
    rows.map(|row| row[0] * uv[0] + row[1] * uv[1] + row[2])
}

/// Linear values of the 8-bit sRGB codes.
static SRGB: LazyLock<[f64; 256]> = LazyLock::new(|| std::array::from_fn(|code| from_srgb(code as f64 / 255.0)));

/// Bilinear lookups at the finest level.
struct Sampler<'a> {
    image: &'a ImageDesc,
    texture: &'a TextureDesc,
}

impl Sampler<'_> {
    fn sample(&self, uv: [f64; 2]) -> V {
        let size = [self.image.width, self.image.height];
        let at: [f64; 2] = std::array::from_fn(|i| uv[i] * f64::from(size[i]) - 0.5);
        if self.texture.filter == Filter::Nearest {
            return self.texel(at.map(|x| (x + 0.5).floor() as i64));
        }
        let low = at.map(f64::floor);
        let share: [f64; 2] = std::array::from_fn(|i| at[i] - low[i]);
        let [x, y] = low.map(|x| x as i64);
        let mut sum = [0.0; 4];
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let one = |share: f64, d: i64| if d == 0 { 1.0 - share } else { share };
            let weight = one(share[0], dx) * one(share[1], dy);
            // Texel centres are met up to rounding where sizes agree.
            if weight > 1e-9 {
                let texel = self.texel([x + dx, y + dy]);
                sum.iter_mut().zip(texel).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        sum
    }

    fn texel(&self, [x, y]: [i64; 2]) -> V {
        let (Some(x), Some(y)) =
            (wrapped(x, self.image.width, self.texture.wrap_u), wrapped(y, self.image.height, self.texture.wrap_v))
        else {
            return [0.0; 4];
        };
        let n = usize::from(self.image.channels);
        let start = (y * self.image.width as usize + x) * n;
        let srgb = self.image.color_space == ColorSpace::Srgb;
        let color = |i: usize| match &self.image.pixels {
            PixelData::U8(v) if srgb => SRGB[usize::from(v[start + i])],
            pixels if srgb => from_srgb(f64::from(pixels.get(start + i))),
            pixels => f64::from(pixels.get(start + i)),
        };
        let alpha = |i: usize| f64::from(self.image.pixels.get(start + i));
        match n {
            1 => [color(0), color(0), color(0), 1.0],
            2 => [color(0), color(0), color(0), alpha(1)],
            3 => [color(0), color(1), color(2), 1.0],
            _ => [color(0), color(1), color(2), alpha(3)],
        }
    }
}

/// The texel that stands at `x`; `None` outside of an image that isn't repeated.
fn wrapped(x: i64, size: u32, wrap: Wrap) -> Option<usize> {
    let size = i64::from(size);
    let inside = match wrap {
        Wrap::Repeat => x.rem_euclid(size),
        Wrap::Mirror => {
            let x = x.rem_euclid(2 * size);
            if x < size { x } else { 2 * size - 1 - x }
        }
        Wrap::Clamp => x.clamp(0, size - 1),
        Wrap::Black if (0..size).contains(&x) => x,
        Wrap::Black => return None,
    };
    Some(inside as usize)
}

#[cfg(test)]
mod tests {
    use super::super::expr::tests::lookup;
    use super::super::function::Function;
    use super::*;
    use crate::error::Place;

    fn grey(width: u32, height: u32, texels: &[u8]) -> ImageDesc {
        ImageDesc {
            name: "grey".into(),
            place: Place::default(),
            width,
            height,
            channels: 1,
            color_space: ColorSpace::Linear,
            pixels: PixelData::U8(texels.to_vec()),
        }
    }

    fn texture(image: u32) -> TextureDesc {
        let (wrap_u, wrap_v) = (Wrap::Clamp, Wrap::Clamp);
        TextureDesc { place: Place::default(), image, wrap_u, wrap_v, filter: Filter::Linear }
    }

    /// The square of a 2 × 2 image times a 1 × 2 one, texel by texel.
    #[test]
    fn texels_are_computed_where_they_stand() {
        let images = [grey(2, 2, &[0, 51, 102, 255]), grey(1, 2, &[255, 51])];
        let textures = [texture(0), texture(1)];
        let tables = Tables { images: &images, textures: &textures };
        let mut e = Exprs::default();
        let first = e.push(Op::Lookup(Lookup { channels: 1, ..lookup() }));
        let other = crate::desc::TextureRef { texture: 1, ..lookup().texture };
        let second = e.push(Op::Lookup(Lookup { channels: 1, texture: other, ..lookup() }));
        let square = e.multiply(first, first);
        let product = e.multiply(square, second);
        let domain = domain(&e, product, tables).unwrap();
        assert_eq!((domain.size, domain.shared, domain.wrap), ([2, 2], true, [Wrap::Clamp; 2]));
        let pixels = image(&e, product, &domain, tables, 1);
        for (got, expected) in pixels.iter().zip([0.0, 0.04, 0.16 * 0.2, 0.2]) {
            assert!((got.to_f64() - expected).abs() < 1e-4, "{got} {expected}");
        }
        assert!((mean(&e, first, tables)[0] - 0.4).abs() < 0.01);
    }

    #[test]
    fn different_placements_are_computed_over_the_unit_square() {
        let images = [grey(2, 1, &[0, 255])];
        let textures = [TextureDesc { wrap_u: Wrap::Repeat, ..texture(0) }];
        let tables = Tables { images: &images, textures: &textures };
        let mut e = Exprs::default();
        let once = e.push(Op::Lookup(Lookup { channels: 1, ..lookup() }));
        let transform = TextureTransform([[2.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let twice = crate::desc::TextureRef { transform, ..lookup().texture };
        let twice = e.push(Op::Lookup(Lookup { channels: 1, texture: twice, ..lookup() }));
        let high = e.apply(Function::Maximum, &[once, twice]);
        let domain = domain(&e, high, tables).unwrap();
        assert_eq!((domain.size, domain.shared), ([4, 1], false));
        assert_eq!(domain.notes.len(), 1);
        let pixels = image(&e, high, &domain, tables, 1);
        // once at the four centres: 1/4 of the way between texels, wrapped; twice: 0 1 0 1.
        let expected = [0.25, 1.0, 0.75, 1.0];
        assert!(pixels.iter().zip(expected).all(|(a, b)| (a.to_f64() - b).abs() < 1e-3), "{pixels:?}");
    }

    #[test]
    fn wrap_modes() {
        let modes = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Black];
        let at = |x: i64| modes.map(|wrap| wrapped(x, 3, wrap));
        assert_eq!(at(-1), [Some(2), Some(0), Some(0), None]);
        assert_eq!(at(4), [Some(1), Some(1), Some(2), None]);
        assert_eq!(at(1), [Some(1); 4]);
    }
}
