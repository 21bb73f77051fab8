//! Looking an image up: wrap modes, bilinear within a level, linear between levels.
//!
//! Texel (i, j) of an n × m level has its centre at `((i + 0.5) / n, (j + 0.5) / m)`; v runs down from
//! the top row, as in glTF. The level is `log2(footprint · max(n, m))`: a footprint as wide as a texel
//! reads the finest level (Lance Williams: *Pyramidal Parametrics*, SIGGRAPH 1983). Blends have the
//! form `a + t (b - a)`, so that equal texels give their own value to the bit: an opaque image stays
//! exactly opaque.

use std::sync::Arc;

use super::blend::{Taps, Window, divided, finish};
use super::image::Image;
use super::texel::{Level, Reader};
use crate::desc::{Blending, Filter, TextureDesc, Wrap};

/// An image with its wrap modes and filter.
#[derive(Clone, Debug)]
pub struct Texture {
    image: Arc<Image>,
    wrap: [Wrap; 2],
    filter: Filter,
    /// Bilinear in light on every level.
    plain: bool,
}

impl Texture {
    /// The image of `desc` as `desc` looks it up.
    pub fn new(image: Arc<Image>, desc: &TextureDesc) -> Self {
        let plain = image.blending == Blending::default() && desc.filter == Filter::Linear;
        Self { image, wrap: [desc.wrap_u, desc.wrap_v], filter: desc.filter, plain }
    }

    /// What it looks up.
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// The value that every lookup gives, where there is one.
    pub fn constant(&self) -> Option<[f32; 4]> {
        if self.wrap.contains(&Wrap::Black) { None } else { self.image.constant() }
    }

    /// Linear Rec.709 color and alpha at `uv`, averaged over about `footprint`, the width of the ray's
    /// footprint in units of uv; 0 is the finest level. Grey fills all three channels. Coordinates that
    /// are not finite count as 0.
    pub fn lookup(&self, uv: [f32; 2], footprint: f32) -> [f32; 4] {
        let uv = uv.map(|x| if x.is_finite() { x } else { 0.0 });
        let levels = &self.image.levels;
        if self.filter == Filter::Nearest {
            return self.nearest(&levels[0], uv);
        }
        let texels = footprint * levels[0].width.max(levels[0].height) as f32;
        if texels.is_nan() || texels <= 1.0 {
            return self.within(0, uv);
        }
        let lod = texels.log2().min((levels.len() - 1) as f32);
        let (level, t) = (lod as usize, lod.fract());
        let fine = self.within(level, uv);
        if t == 0.0 { fine } else { mix(fine, self.within(level + 1, uv), t) }
    }

    /// Light within one level.
    fn within(&self, level: usize, uv: [f32; 2]) -> [f32; 4] {
        if self.plain { self.bilinear(&self.image.levels[level], uv) } else { self.blended(level, uv) }
    }

    /// What is not bilinear in light, see [`super::blend`].
    #[cold]
    #[inline(never)]
    fn blended(&self, level: usize, uv: [f32; 2]) -> [f32; 4] {
        let Image { format, blending, levels, .. } = &*self.image;
        let (of, finest) = (&levels[level], level == 0);
        let filter = if finest { self.filter } else { Filter::Linear };
        let x = Taps::at(uv[0], of.width, self.wrap[0], filter);
        let y = Taps::at(uv[1], of.height, self.wrap[1], filter);
        let window = Window { level: of, x, y, associate: blending.associated && !finest };
        if finest {
            return finish(format.stored(*blending).read(&of.pixels, window), *blending);
        }
        let value = format.read(&of.pixels, window);
        if blending.associated { divided(value) } else { value }
    }

    fn bilinear(&self, level: &Level, uv: [f32; 2]) -> [f32; 4] {
        let x = Pair::at(uv[0], level.width, self.wrap[0]);
        let y = Pair::at(uv[1], level.height, self.wrap[1]);
        self.image.format.read(&level.pixels, Bilinear { level, x, y })
    }

    fn nearest(&self, level: &Level, uv: [f32; 2]) -> [f32; 4] {
        let texel = |u: f32, n: u32, wrap: Wrap| {
            let folded = fold(u, wrap);
            let i = (folded * n as f32).floor();
            let inside = wrap != Wrap::Black || (0.0..1.0).contains(&folded);
            inside.then(|| (i.max(0.0) as u32).min(n - 1))
        };
        let (x, y) = (texel(uv[0], level.width, self.wrap[0]), texel(uv[1], level.height, self.wrap[1]));
        match (x, y) {
            (Some(x), Some(y)) => self.image.texel(x, y),
            _ => [0.0; 4],
        }
    }
}

/// A coordinate moved to where the image lies: 0 to 1; for [`Wrap::Black`] at most one image further.
pub(super) fn fold(u: f32, wrap: Wrap) -> f32 {
    match wrap {
        Wrap::Repeat => u - u.floor(),
        Wrap::Mirror => {
            let u = u - 2.0 * (0.5 * u).floor();
            if u > 1.0 { 2.0 - u } else { u }
        }
        Wrap::Clamp => u.clamp(0.0, 1.0),
        Wrap::Black => u.clamp(-1.0, 2.0),
    }
}

/// The two texels about a coordinate along one axis.
#[derive(Clone, Copy)]
struct Pair {
    index: [usize; 2],
    /// Whether each lies in the image; only [`Wrap::Black`] has others.
    inside: [bool; 2],
    /// From the first to the second, 0 to 1.
    t: f32,
}

impl Pair {
    fn at(u: f32, n: u32, wrap: Wrap) -> Self {
        let s = fold(u, wrap) * n as f32 - 0.5;
        let floor = s.floor();
        let (t, first, last) = (s - floor, floor as i32, n as i32 - 1);
        let pair = [first, first + 1];
        let index = match wrap {
            Wrap::Repeat => [if first < 0 { last } else { first.min(last) }, if first >= last { 0 } else { first + 1 }],
            _ => pair.map(|i| i.clamp(0, last)),
        };
        Self {
            index: index.map(|i| i as usize),
            inside: pair.map(|i| wrap != Wrap::Black || (0..=last).contains(&i)),
            t,
        }
    }
}

struct Bilinear<'a> {
    level: &'a Level,
    x: Pair,
    y: Pair,
}

impl Reader<[f32; 4]> for Bilinear<'_> {
    #[inline(always)]
    fn read(self, texel: impl Fn(usize) -> [f32; 4] + Sync) -> [f32; 4] {
        let Self { level, x, y } = self;
        let at = |i: usize, j: usize| {
            let inside = x.inside[i] && y.inside[j];
            if inside { texel(level.offset(x.index[i], y.index[j])) } else { [0.0; 4] }
        };
        mix(mix(at(0, 0), at(1, 0), x.t), mix(at(0, 1), at(1, 1), x.t), y.t)
    }
}

#[inline(always)]
fn mix(a: [f32; 4], b: [f32; 4], t: f32) -> [f32; 4] {
    std::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
}
