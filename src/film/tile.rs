//! A square of pixels and the sums behind them, owned by one thread at a time.

mod state;

use std::array;
use std::collections::BTreeMap;
use std::sync::Arc;

use super::aov::Aov;
use super::chosen::Chosen;
use super::cryptomatte::{CryptoKind, Matte};
use super::pass::Means;
use super::pass_set::PassSet;
use super::quantity::{Quantities, Quantity};
use super::replicates::{PseudoValues, Replicates};
use super::sample::{FirstHit, PixelSample};
use crate::math::Rgb;

/// Names one sample of one pixel, so that it can be replayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleId {
    /// Column.
    pub x: u32,
    /// Row from the top.
    pub y: u32,
    /// Which sample of the pixel.
    pub index: u32,
}

/// Samples that were dropped since some value was NaN or infinite.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NonFinite {
    /// How many.
    pub count: u64,
    /// The one of lowest index, then row, then column, whatever the order of the threads.
    pub first: Option<SampleId>,
}

impl NonFinite {
    fn note(&mut self, id: SampleId) {
        let key = |id: SampleId| (id.index, id.y, id.x);
        self.count += 1;
        if self.first.is_none_or(|first| key(id) < key(first)) {
            self.first = Some(id);
        }
    }

    pub(super) fn merge(&mut self, other: Self) {
        if let Some(id) = other.first {
            self.note(id);
            self.count += other.count - 1;
        }
    }
}

/// Where some quantities lie among the numbers of a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slots {
    pub(super) quantities: Quantities,
    /// First number of each quantity.
    pub(super) offsets: [u32; Quantity::ALL.len()],
}

/// The numbers of a pixel.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// What is kept once.
    all: Slots,
    /// What is kept of each light group, by its index.
    groups: Vec<Slots>,
    /// First number of the AOVs, and where each ends.
    aovs: (usize, Vec<usize>),
    /// Numbers that are kept for each replicate, too, ascending; colors of one quantity follow each other.
    pub(super) replicated: Arc<[u32]>,
    /// Numbers per pixel.
    pub(super) stride: usize,
}

/// Most numbers per pixel but for those of groups and AOVs.
const MAX_STRIDE: usize = {
    let (mut stride, mut i) = (0, 0);
    while i < Quantity::ALL.len() {
        if !Quantity::ALL[i].is_of_group() {
            stride += Quantity::ALL[i].width();
        }
        i += 1;
    }
    stride
};

impl Slots {
    /// `quantities` from number `stride` on, which moves to the first number after them.
    fn after(stride: &mut usize, quantities: Quantities) -> Self {
        let mut offsets = [0; Quantity::ALL.len()];
        for q in quantities.iter() {
            offsets[q as usize] = *stride as u32;
            *stride += q.width();
        }
        Self { quantities, offsets }
    }

    /// Each quantity and its first number.
    fn iter(&self) -> impl Iterator<Item = (Quantity, usize)> {
        self.quantities.iter().map(|q| (q, self.offsets[q as usize] as usize))
    }
}

impl Layout {
    pub(super) fn of(passes: &PassSet) -> Self {
        let mut stride = 0;
        let all = Slots::after(&mut stride, passes.quantities().of_groups(false));
        let groups =
            (0..passes.groups().len()).map(|i| Slots::after(&mut stride, passes.group_quantities(i))).collect();
        let first = stride;
        let end = |aov: &Aov| {
            stride += aov.kind.width();
            stride
        };
        let aovs = (first, passes.aovs().iter().map(end).collect());
        // Errors are those of colors: alpha and coverage have none.
        let colors = passes.replicated().iter().map(|q| (q, all.offsets[q as usize])).filter(|(q, _)| q.width() >= 3);
        let replicated = colors.flat_map(|(_, start)| start..start + 3).collect();
        Self { all, groups, aovs, replicated, stride }
    }
}

/// A square of the film.
#[derive(Clone, Debug)]
pub struct Tile {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
    layout: Arc<Layout>,
    /// Sum of weight × value, `layout.stride` numbers per pixel.
    sums: Vec<f64>,
    /// Samples taken in, per pixel.
    counts: Vec<u32>,
    /// Samples that were dropped, by pixel; few pixels have any.
    dropped: BTreeMap<u32, u32>,
    /// Per pixel; empty where no pass needs it.
    first_hits: Vec<FirstHit>,
    /// Per pixel, per kind; empty where no pass needs it.
    mattes: [Vec<Matte>; 3],
    /// Where errors are asked for.
    replicates: Option<Replicates>,
    non_finite: NonFinite,
}

impl Tile {
    pub(super) fn new(x: u32, y: u32, width: u32, height: u32, layout: Arc<Layout>) -> Self {
        let pixels = width as usize * height as usize;
        let mattes = CryptoKind::ALL.map(|kind| {
            let len = if layout.all.quantities.contains(kind.quantity()) { pixels } else { 0 };
            vec![Matte::default(); len]
        });
        let first_hits = if layout.all.quantities.contains(Quantity::FirstHit) { pixels } else { 0 };
        Self {
            x,
            y,
            width,
            height,
            sums: vec![0.0; pixels * layout.stride],
            replicates: (!layout.replicated.is_empty()).then(|| Replicates::new(pixels, layout.replicated.clone())),
            layout,
            counts: vec![0; pixels],
            dropped: BTreeMap::new(),
            first_hits: vec![FirstHit::BACKGROUND; first_hits],
            mattes,
            non_finite: NonFinite::default(),
        }
    }

    /// Column and row of every pixel in the tile, row by row.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (x, y, width, height) = (self.x, self.y, self.width, self.height);
        (y..y + height).flat_map(move |row| (x..x + width).map(move |column| (column, row)))
    }

    /// Left column, top row, width and height.
    pub fn rect(&self) -> [u32; 4] {
        [self.x, self.y, self.width, self.height]
    }

    /// Takes in a sample of a pixel of this tile. `weight` is the reconstruction filter's
    /// ([`Filter::sample`](super::Filter::sample)): expected value 1. False where the sample was dropped
    /// since a value of it is NaN or infinite.
    pub fn add(&mut self, id: SampleId, weight: f32, sample: &PixelSample) -> bool {
        let pixel = self.index(id.x, id.y);
        let mut values = [0.0_f32; MAX_STRIDE];
        let mut crypto = false;
        let mut once = 0;
        for (q, start) in self.layout.all.iter() {
            once = start + q.width();
            values[start..once].copy_from_slice(&q.read(sample)[..q.width()]);
            crypto |= matches!(q, Quantity::CryptoObject | Quantity::CryptoMaterial | Quantity::CryptoAsset);
        }
        let values = &values[..once];
        let groups = || self.layout.groups.iter().zip(&sample.groups);
        let of_groups = || groups().flat_map(|(slots, group)| slots.iter().map(|(q, at)| (at, q.read_group(group))));
        let coverage = if crypto { weight * sample.crypto.coverage } else { weight };
        let finite = values.iter().all(|value| value.is_finite()) && of_groups().all(|(_, rgb)| rgb.is_finite());
        let finite = finite && sample.aovs.iter().all(|value| value.is_finite());
        if !coverage.is_finite() || !finite {
            self.non_finite.note(id);
            *self.dropped.entry(pixel as u32).or_default() += 1;
            return false;
        }

        let sums = &mut self.sums[pixel * self.layout.stride..][..self.layout.stride];
        let add = |sums: &mut [f64], values: &[f32]| {
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += f64::from(weight) * f64::from(*value);
            }
        };
        add(sums, values);
        for (start, Rgb { r, g, b }) in of_groups() {
            add(&mut sums[start..], &[r, g, b]);
        }
        add(&mut sums[self.layout.aovs.0..], &sample.aovs);
        if let Some(replicates) = &mut self.replicates {
            replicates.add(pixel, id.index, weight, values);
        }
        if crypto {
            let ids = [sample.crypto.object, sample.crypto.material, sample.crypto.asset];
            for (mattes, id) in self.mattes.iter_mut().zip(ids) {
                if let Some(matte) = mattes.get_mut(pixel) {
                    matte.add(id, coverage);
                }
            }
        }
        self.counts[pixel] += 1;
        true
    }

    /// Keeps what the ray through the pixel's centre met; nothing happens where no pass needs it. What lies beyond the
    /// largest float is left out, and counted as a sample that is.
    pub fn set_first_hit(&mut self, x: u32, y: u32, hit: FirstHit) {
        let pixel = self.index(x, y);
        if let Some(place) = self.first_hits.get_mut(pixel) {
            match hit.depth.is_finite() && hit.position.is_finite() {
                true => *place = hit,
                false => self.non_finite.note(SampleId { x, y, index: 0 }),
            }
        }
    }

    /// Samples taken in at a pixel of this tile.
    pub fn count(&self, x: u32, y: u32) -> u32 {
        self.counts[self.index(x, y)]
    }

    /// Samples of pixel `i`, counted as [`Tile::pixels`] does, that it was given, dropped ones among them: the index of
    /// the next.
    pub fn given(&self, i: usize) -> u32 {
        let dropped = if self.dropped.is_empty() { None } else { self.dropped.get(&(i as u32)) };
        self.counts[i] + dropped.copied().unwrap_or(0)
    }

    /// What was dropped.
    pub fn non_finite(&self) -> NonFinite {
        self.non_finite
    }

    /// The sums of a pixel, as `chosen` sees them.
    pub(super) fn sums(&self, x: u32, y: u32, chosen: &Chosen<'_>) -> Means<'_> {
        let pixel = self.index(x, y);
        let sums = &self.sums[pixel * self.layout.stride..][..self.layout.stride];
        let of_aov = |(i, aov): (usize, &Aov)| {
            let end = self.layout.aovs.1[i];
            &sums[end - aov.kind.width()..end]
        };
        Means {
            sums,
            offsets: &chosen.group_index().map_or(&self.layout.all, |group| &self.layout.groups[group]).offsets,
            aov: chosen.aov().map_or(&[], of_aov),
            count: self.counts[pixel],
            first_hit: self.first_hits.get(pixel).copied().unwrap_or_default(),
            has_catchers: self.layout.all.quantities.contains(Quantity::CatcherShare),
        }
    }

    /// What the replicates of a pixel say about `value`, of the sums that are kept once; `None` where there are none,
    /// or too few samples in them. `rest` is scratch.
    pub(super) fn pseudo_values(
        &self,
        x: u32,
        y: u32,
        value: fn(&Means<'_>) -> [f64; 4],
        rest: &mut Vec<f64>,
    ) -> Option<PseudoValues> {
        let pixel = self.index(x, y);
        let sums = &self.sums[pixel * self.layout.stride..][..self.layout.stride];
        self.replicates.as_ref()?.pseudo_values(pixel, sums, rest, |sums, count| value(&self.means(sums, count)))
    }

    /// `value` of the sums that are kept once.
    pub(super) fn value(&self, x: u32, y: u32, value: fn(&Means<'_>) -> [f64; 4]) -> [f64; 4] {
        let pixel = self.index(x, y);
        let sums = &self.sums[pixel * self.layout.stride..][..self.layout.stride];
        value(&self.means(sums, self.counts[pixel]))
    }

    /// Those sums, as passes that are neither of groups nor AOVs see them.
    fn means<'a>(&'a self, sums: &'a [f64], count: u32) -> Means<'a> {
        let (first_hit, has_catchers) =
            (FirstHit::BACKGROUND, self.layout.all.quantities.contains(Quantity::CatcherShare));
        Means { sums, offsets: &self.layout.all.offsets, aov: &[], count, first_hit, has_catchers }
    }

    /// The largest color that a sample brought to a pixel, the mean of its channels times the filter's weight; 0
    /// where no errors are asked for.
    pub(super) fn largest(&self, x: u32, y: u32) -> f32 {
        self.replicates.as_ref().map_or(0.0, |replicates| replicates.largest(self.index(x, y)))
    }

    pub(super) fn matte(&self, kind: CryptoKind, x: u32, y: u32) -> Option<&Matte> {
        self.mattes[kind as usize].get(self.index(x, y))
    }

    pub(super) fn bytes(&self) -> usize {
        let mattes: [usize; 3] = array::from_fn(|kind| {
            let heap: usize = self.mattes[kind].iter().map(Matte::heap_bytes).sum();
            heap + self.mattes[kind].len() * size_of::<Matte>()
        });
        size_of::<Self>()
            + self.sums.len() * size_of::<f64>()
            + self.counts.len() * size_of::<u32>()
            + self.first_hits.len() * size_of::<FirstHit>()
            + mattes.iter().sum::<usize>()
            + self.replicates.as_ref().map_or(0, Replicates::bytes)
    }

    fn index(&self, x: u32, y: u32) -> usize {
        debug_assert!(x >= self.x && x < self.x + self.width && y >= self.y && y < self.y + self.height);
        (y - self.y) as usize * self.width as usize + (x - self.x) as usize
    }
}
