//! The film: tiles of sums that threads fill and that can be developed at any moment.
//!
//! A pixel's value is `1/N Σ w·v` over its N samples, `w` the reconstruction filter's weight with
//! expected value 1. Dividing by N and not by `Σ w` keeps the estimate unbiased for filters with
//! negative lobes too, whose `Σ w` can come near 0. Sums are `f64`.

use std::io::{self, Read, Write};
use std::sync::Arc;

use super::chosen::Chosen;
use super::pass::Develop;
use super::pass_set::PassSet;
use super::picture::{Layer, Picture};
use super::replicates::Replicates;
use super::tile::{Layout, NonFinite, Tile};

/// What a render accumulates.
#[derive(Clone, Debug)]
pub struct Film {
    width: u32,
    height: u32,
    passes: PassSet,
    tiles: Vec<Tile>,
}

impl Film {
    /// Side of a tile in pixels.
    pub const TILE: u32 = 16;

    /// An empty film that can develop `passes`; of light groups those that they were resolved with.
    pub fn new(width: u32, height: u32, passes: PassSet) -> Self {
        let layout = Arc::new(Layout::of(&passes));
        let starts = |size: u32| (0..size).step_by(Self::TILE as usize);
        let tile =
            |x: u32, y: u32| Tile::new(x, y, Self::TILE.min(width - x), Self::TILE.min(height - y), layout.clone());
        let tiles = starts(height).flat_map(|y| starts(width).map(move |x| (x, y))).map(|(x, y)| tile(x, y)).collect();
        Self { width, height, passes, tiles }
    }

    /// Memory that a film of this size needs for its sums, in bytes.
    pub fn bytes_needed(width: u32, height: u32, passes: &PassSet) -> u64 {
        let layout = Layout::of(passes);
        let replicates = match layout.replicated.len() {
            0 => 0,
            numbers => Replicates::bytes_per_pixel(numbers) as u64,
        };
        u64::from(width) * u64::from(height) * (8 * layout.stride as u64 + 4 + replicates)
    }

    /// Pixels per row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// What it can develop.
    pub fn passes(&self) -> &PassSet {
        &self.passes
    }

    /// The tiles, row by row.
    pub fn tiles(&self) -> &[Tile] {
        &self.tiles
    }

    /// The tiles, for threads to share out; none touches another's memory.
    pub fn tiles_mut(&mut self) -> &mut [Tile] {
        &mut self.tiles
    }

    /// Samples that were dropped, over the whole film.
    pub fn non_finite(&self) -> NonFinite {
        let mut all = NonFinite::default();
        for tile in &self.tiles {
            all.merge(tile.non_finite());
        }
        all
    }

    /// Samples taken in, over the whole film.
    pub fn samples(&self) -> u64 {
        let of_tile = |tile: &Tile| tile.pixels().map(|(x, y)| u64::from(tile.count(x, y))).sum::<u64>();
        self.tiles.iter().map(of_tile).sum()
    }

    /// Writes all that samples have left, without loss.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn save(&self, out: &mut dyn Write) -> io::Result<()> {
        self.tiles.iter().try_for_each(|tile| tile.save(out))
    }

    /// Takes in what [`Film::save`] has written of a film of the same size and passes.
    ///
    /// # Errors
    /// Those of `from`; data that no film has. The film is then of no use.
    pub fn load(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.tiles.iter_mut().try_for_each(|tile| tile.load(from))
    }

    /// Fewest and most samples that a pixel was given, dropped ones among them, and their sum.
    pub fn given(&self) -> (u32, u32, u64) {
        let all = self.tiles.iter().flat_map(|tile| (0..tile.pixels().count()).map(|i| tile.given(i)));
        let count = |(least, most, sum): (u32, u32, u64), given: u32| {
            (least.min(given), most.max(given), sum + u64::from(given))
        };
        all.fold((u32::MAX, 0, 0), count)
    }

    /// Memory that it holds.
    pub fn bytes(&self) -> usize {
        self.tiles.iter().map(Tile::bytes).sum()
    }

    /// The picture so far. Pixels without a sample are 0 (a shadow of 1, the background's depth).
    pub fn develop(&self) -> Picture {
        let layers = self.passes.iter().flat_map(|chosen| self.develop_pass(&chosen)).collect();
        Picture { width: self.width, height: self.height, layers }
    }

    fn develop_pass(&self, chosen: &Chosen<'_>) -> Vec<Layer> {
        let pass = chosen.pass;
        let n = chosen.channels().len();
        let channels: Vec<String> = chosen.channels().chars().map(String::from).collect();
        let size = self.width as usize * self.height as usize * n;
        let empty = |name| Layer { name, channels: channels.clone(), data: vec![0.0; size], storage: pass.storage };
        let mut layers: Vec<Layer> = chosen.layers().into_iter().map(empty).collect();
        let trust = matches!(pass.develop, Develop::Trust).then(|| self.trust());
        let mut rest = Vec::new();
        for tile in &self.tiles {
            for (x, y) in tile.pixels() {
                let at = (y as usize * self.width as usize + x as usize) * n;
                match pass.develop {
                    Develop::Pixel(value) => {
                        let value = value(&tile.sums(x, y, chosen)).map(to_f32);
                        layers[0].data[at..at + n].copy_from_slice(&value[..n]);
                    }
                    Develop::Error(value) => {
                        // Where nothing is known yet, as where there is no error, it is 0.
                        let Some(pseudo) = tile.pseudo_values(x, y, value, &mut rest) else { continue };
                        for (c, error) in layers[0].data[at..at + n].iter_mut().enumerate() {
                            *error = to_f32(pseudo.variance(c).sqrt());
                        }
                    }
                    Develop::Trust => {
                        let trusted = trust.as_ref().is_some_and(|trust| trust[at]);
                        layers[0].data[at] = if trusted { 1.0 } else { 0.0 };
                    }
                    Develop::Cryptomatte(kind) => {
                        let Some(matte) = tile.matte(kind, x, y) else { continue };
                        let ranked = matte.rank(tile.count(x, y));
                        for (layer, ranks) in layers.iter_mut().zip(ranked.chunks_exact(n)) {
                            layer.data[at..at + n].copy_from_slice(ranks);
                        }
                    }
                }
            }
        }
        layers
    }
}

/// Nearest float; a ratio that overflows becomes the largest one, so that no pass ever holds an infinity.
fn to_f32(value: f64) -> f32 {
    value.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Aov, AovKind, CryptoSample, FirstHit, GroupSample, PixelSample, SampleId, Split, cryptomatte};
    use crate::math::{Rgb, Vec3};

    fn id(index: u32) -> SampleId {
        SampleId { x: 0, y: 0, index }
    }

    fn diffuse(direct: Rgb, unshadowed: Rgb, color: Rgb) -> PixelSample {
        let split = |diffuse| Split { diffuse, ..Split::default() };
        PixelSample { direct: split(direct), unshadowed, color: split(color), ..PixelSample::default() }
    }

    fn one_pixel(passes: &str, samples: &[PixelSample]) -> Picture {
        of_groups(passes, &[], samples)
    }

    fn of_groups(passes: &str, groups: &[&str], samples: &[PixelSample]) -> Picture {
        let groups: Vec<Arc<str>> = groups.iter().map(|&name| name.into()).collect();
        let passes = PassSet::parse(passes).expect("known passes").resolve(&groups, &[]).expect("known groups");
        let mut film = Film::new(1, 1, passes);
        for (i, sample) in samples.iter().enumerate() {
            film.tiles_mut()[0].add(id(i as u32), 1.0, sample);
        }
        film.develop()
    }

    fn value<'a>(picture: &'a Picture, layer: &str) -> &'a [f32] {
        picture.layer(layer).expect("layer is there").pixel(picture.width, 0, 0)
    }

    #[test]
    fn tiles_cover_every_pixel_once() {
        for (width, height) in [(1, 1), (16, 16), (17, 33), (5, 40)] {
            let film = Film::new(width, height, PassSet::default());
            let mut seen = vec![0; (width * height) as usize];
            for (x, y) in film.tiles().iter().flat_map(|tile| tile.pixels()) {
                seen[(y * width + x) as usize] += 1;
            }
            assert!(seen.iter().all(|&n| n == 1), "{width}x{height}");
        }
    }

    #[test]
    fn shadow_is_the_ratio_of_the_means() {
        let light = Rgb::splat;
        let samples = [
            diffuse(light(4.0), light(4.0), light(0.5)),
            diffuse(light(0.0), light(1.0), light(0.5)),
            diffuse(light(1.0), light(3.0), light(0.5)),
        ];
        let picture = one_pixel("shadow,unshadowed,diffuse_direct", &samples);
        // The mean of the ratios would be 0.444.
        assert_eq!(value(&picture, "Shadow"), [0.625; 3]);
        assert_eq!(value(&picture, "Diffuse Direct Unshadowed"), [(8.0_f32 / 3.0) / 0.5; 3]);
        assert_eq!(value(&picture, "Diffuse Direct"), [(5.0_f32 / 3.0) / 0.5; 3]);
    }

    #[test]
    fn diffuse_direct_is_shadow_times_unshadowed() {
        // A fixed walk over awkward values: large and small, channels that are black.
        let mut state = 1_u32;
        let mut next = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        for _ in 0..500 {
            let samples: [PixelSample; 7] = std::array::from_fn(|_| {
                let unshadowed = Rgb::new(next() * 1e4, if next() < 0.5 { 0.0 } else { next() * 1e-5 }, next());
                let color = Rgb::new(next(), next() * 1e-3, if next() < 0.8 { 0.0 } else { next() });
                let visible = if next() < 0.5 { 0.0 } else { 1.0 };
                diffuse(unshadowed * color * visible, unshadowed * color, color)
            });
            let picture = one_pixel("shadow,unshadowed,diffuse_direct", &samples);
            let [direct, shadow, unshadowed] =
                ["Diffuse Direct", "Shadow", "Diffuse Direct Unshadowed"].map(|layer| value(&picture, layer));
            for channel in 0..3 {
                let product = shadow[channel] * unshadowed[channel];
                assert!((direct[channel] - product).abs() <= 2.0 * f32::EPSILON * direct[channel].abs());
            }
        }
    }

    #[test]
    fn shadow_falls_back_to_bare_irradiance_and_then_to_one() {
        let mirror = PixelSample {
            irradiance_shadowed: Rgb::new(1.0, 0.0, 0.0),
            irradiance_unshadowed: Rgb::new(4.0, 2.0, 0.0),
            ..PixelSample::default()
        };
        assert_eq!(value(&one_pixel("shadow", &[mirror]), "Shadow"), [0.25, 0.0, 1.0]);
        assert_eq!(value(&one_pixel("shadow", &[]), "Shadow"), [1.0; 3]);
    }

    /// Light of two groups and of a lamp in neither, over three samples.
    fn two_groups() -> Vec<PixelSample> {
        let group = |lit: f32, unshadowed: f32, more: f32| GroupSample {
            combined: Rgb::splat(lit + more),
            lit: Rgb::splat(lit),
            unshadowed: Rgb::splat(unshadowed),
            ..GroupSample::default()
        };
        let rows = [
            [group(4.0, 4.0, 0.5), group(1.0, 2.0, 0.25)],
            [group(0.0, 1.0, 0.0), group(0.0, 2.0, 0.0)],
            [group(1.0, 3.0, 2.0), group(0.5, 4.0, 1.0)],
        ];
        let sample = |groups: [GroupSample; 2]| PixelSample {
            combined: groups[0].combined + groups[1].combined,
            ..PixelSample { groups: groups.into(), ..PixelSample::default() }
        };
        rows.map(sample).into()
    }

    #[test]
    fn the_shadow_of_a_group_is_the_ratio_of_its_means() {
        let picture = of_groups("shadow_*", &["fill", "key"], &two_groups());
        assert_eq!(value(&picture, "Shadow_fill"), [0.625; 3]);
        assert_eq!(value(&picture, "Shadow_key"), [1.5 / 8.0; 3]);
        assert_eq!(picture.layers.len(), 2);
        let bare =
            |lit, all| GroupSample { irradiance_shadowed: lit, irradiance_unshadowed: all, ..GroupSample::default() };
        let [red, white] = [Rgb::new(1.0, 0.0, 0.0), Rgb::new(4.0, 2.0, 0.0)];
        let groups = [bare(Rgb::splat(3.0), Rgb::splat(3.0)), bare(red, white)].into();
        let picture = of_groups("shadow_*", &["fill", "key"], &[PixelSample { groups, ..PixelSample::default() }]);
        assert_eq!(value(&picture, "Shadow_key"), [0.25, 0.0, 1.0]);
        assert_eq!(value(&picture, "Shadow_fill"), [1.0; 3]);
    }

    #[test]
    fn groups_sum_to_combined_and_one_alone_is_the_same() {
        let picture = of_groups("all", &["fill", "key"], &two_groups());
        let red = |layer: &str| value(&picture, layer)[0];
        assert_eq!(red("Combined_fill") + red("Combined_key"), red("Combined"));
        assert_eq!(red("Combined_fill"), 7.5 / 3.0);
        // What is asked for alone lies elsewhere in memory.
        let mut swapped = two_groups();
        swapped.iter_mut().for_each(|sample| sample.groups = Box::new([sample.groups[1]]));
        let alone = of_groups("combined_key,shadow_key", &["key"], &swapped);
        for layer in ["Combined_key", "Shadow_key"] {
            assert_eq!(value(&alone, layer), value(&picture, layer));
        }
    }

    #[test]
    fn groups_are_held_to_be_finite_where_they_are_asked_for() {
        let groups: Vec<Arc<str>> = vec!["fill".into(), "key".into()];
        let kept = |passes: &str, bad: GroupSample| {
            let passes = PassSet::parse(passes).expect("known").resolve(&groups, &[]).expect("there");
            let groups = vec![bad; passes.groups().len()].into();
            let mut film = Film::new(1, 1, passes);
            film.tiles_mut()[0].add(id(0), 1.0, &PixelSample { groups, ..PixelSample::default() })
        };
        let nan = Rgb::new(0.0, 0.0, f32::NAN);
        assert!(!kept("combined_key", GroupSample { combined: nan, ..GroupSample::default() }));
        assert!(!kept("combined,shadow_*", GroupSample { unshadowed: nan, ..GroupSample::default() }));
        assert!(kept("combined,shadow_*", GroupSample { combined: nan, ..GroupSample::default() }));
    }

    #[test]
    fn light_passes_recombine() {
        let split = |a, b, c| Split { diffuse: Rgb::splat(a), glossy: Rgb::splat(b), transmission: Rgb::splat(c) };
        let sample = PixelSample {
            combined: Rgb::splat(0.1 + 0.2 + 0.3 + 1.0 + 2.0 + 3.0 + 0.25 + 0.5),
            alpha: 0.75,
            direct: split(0.1, 0.2, 0.3),
            indirect: split(1.0, 2.0, 3.0),
            color: split(0.7, 0.04, 0.9),
            emission: Rgb::splat(0.25),
            environment: Rgb::splat(0.5),
            ..PixelSample::default()
        };
        let picture = one_pixel("all", &[sample, PixelSample::default()]);
        let red = |layer: &str| value(&picture, layer)[0];
        let mut sum = red("Emission") + red("Environment");
        for lobe in ["Diffuse", "Glossy", "Transmission"] {
            sum += red(&format!("{lobe} Color")) * (red(&format!("{lobe} Direct")) + red(&format!("{lobe} Indirect")));
        }
        assert!((sum - red("Combined")).abs() < 1e-6, "{sum} is not {}", red("Combined"));
        assert_eq!(value(&picture, "Combined")[3], 0.375);
    }

    #[test]
    fn non_finite_samples_are_dropped_and_named() {
        let mut film = Film::new(20, 20, PassSet::default());
        let good = PixelSample { combined: Rgb::splat(2.0), alpha: 1.0, ..PixelSample::default() };
        let bad = PixelSample { combined: Rgb::new(0.0, f32::NAN, 0.0), ..good.clone() };
        for (x, y, index, sample) in [(18, 3, 7, &bad), (2, 9, 4, &bad), (1, 9, 4, &bad), (1, 9, 5, &good)] {
            let tile = film.tiles_mut().iter_mut().find(|tile| tile.pixels().any(|p| p == (x, y)));
            let kept = tile.expect("in the film").add(SampleId { x, y, index }, 1.0, sample);
            assert_eq!(kept, sample.combined.is_finite());
        }
        assert_eq!(film.non_finite(), NonFinite { count: 3, first: Some(SampleId { x: 1, y: 9, index: 4 }) });
        let picture = film.develop();
        assert_eq!(picture.layers[0].pixel(20, 1, 9), [2.0, 2.0, 2.0, 1.0]);
        assert_eq!(film.samples(), 1);
    }

    #[test]
    fn values_that_no_pass_asks_for_are_not_looked_at() {
        let sample = PixelSample { ao: Rgb::splat(f32::NAN), ..PixelSample::default() };
        let mut film = Film::new(1, 1, PassSet::default());
        assert!(film.tiles_mut()[0].add(id(0), 1.0, &sample));
        let mut film = Film::new(1, 1, PassSet::all());
        assert!(!film.tiles_mut()[0].add(id(0), 1.0, &sample));
    }

    #[test]
    fn memory_follows_the_passes() {
        let bytes = |list| Film::new(64, 64, PassSet::parse(list).expect("known")).bytes();
        let pixels = 64 * 64;
        assert!((pixels * (4 * 8 + 4)..pixels * (4 * 8 + 8)).contains(&bytes("combined")), "{}", bytes("combined"));
        assert!(bytes("ao") < bytes("combined"));
        assert!(bytes("all") > pixels * 62 * 8);
        let groups: Vec<Arc<str>> = vec!["fill".into(), "key".into()];
        let stride = |list: &str| {
            let passes = PassSet::parse(list).expect("known").resolve(&groups, &[]).expect("there");
            (Film::bytes_needed(1, 1, &passes) - 4) / 8
        };
        assert_eq!([stride("combined"), stride("combined,combined_key")], [4, 7]);
        assert_eq!([stride("combined_key,shadow_fill"), stride("combined_*,shadow_*")], [15, 30]);
    }

    #[test]
    fn ten_million_small_samples_lose_nothing() {
        let sample = PixelSample { ao: Rgb::splat(0.1), ..PixelSample::default() };
        let mut film = Film::new(1, 1, PassSet::parse("ao").expect("known"));
        for i in 0..10_000_000 {
            film.tiles_mut()[0].add(id(i), 1.0, &sample);
        }
        // A float's sum would stand at 0.1087.
        assert_eq!(value(&film.develop(), "Ambient Occlusion"), [0.1; 3]);
    }

    #[test]
    fn first_hits_are_kept_as_they_are_and_backgrounds_are_cycles() {
        let mut film = Film::new(2, 1, PassSet::parse("depth,position,object_index,material_index").expect("known"));
        let hit = FirstHit { depth: 3.5, position: Vec3::new(1.0, -2.0, 3.0), object_index: 7.0, material_index: 2.0 };
        film.tiles_mut()[0].set_first_hit(1, 0, hit);
        let picture = film.develop();
        let pair = |layer: &str| picture.layer(layer).expect("there").data.clone();
        assert_eq!(pair("Depth"), [1e10, 3.5]);
        assert_eq!(pair("Position"), [0.0, 0.0, 0.0, 1.0, -2.0, 3.0]);
        assert_eq!(pair("Object Index"), [0.0, 7.0]);
        assert_eq!(pair("Material Index"), [0.0, 2.0]);
    }

    #[test]
    fn mattes_are_ranked_by_coverage() {
        let [cube, lamp] = ["Cube", "Light"].map(cryptomatte::id_from_name);
        let seen = |object, coverage| PixelSample {
            crypto: CryptoSample { object, material: 0.0, asset: cube, coverage },
            ..PixelSample::default()
        };
        let samples = [seen(lamp, 1.0), seen(cube, 1.0), seen(cube, 1.0), seen(0.0, 0.0)];
        let picture = one_pixel("crypto_object,crypto_material,crypto_asset", &samples);
        assert_eq!(picture.layers.len(), 9);
        assert_eq!(value(&picture, "CryptoObject00"), [cube, 0.5, lamp, 0.25]);
        assert_eq!(value(&picture, "CryptoObject01"), [0.0; 4]);
        assert_eq!(value(&picture, "CryptoMaterial00"), [0.0; 4]);
        assert_eq!(value(&picture, "CryptoAsset00"), [cube, 0.75, 0.0, 0.0]);
    }
    #[test]
    fn aovs_lie_behind_the_groups_and_are_held_to_be_finite() {
        let aovs = [("a", AovKind::Value), ("b", AovKind::Color), ("c", AovKind::Value)];
        let aovs = aovs.map(|(name, kind)| Aov { name: name.into(), kind });
        let groups: Vec<Arc<str>> = vec!["key".into()];
        let passes = PassSet::parse("all").expect("known").resolve(&groups, &aovs).expect("there");
        let mut film = Film::new(1, 1, passes.clone());
        let mut sample = PixelSample { combined: Rgb::splat(9.0), ..PixelSample::of(&passes) };
        sample.groups[0].combined = Rgb::splat(8.0);
        sample.aovs = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].into();
        assert!(film.tiles_mut()[0].add(id(0), 0.5, &sample) && film.tiles_mut()[0].add(id(1), 1.5, &sample));
        sample.aovs[5] = f32::INFINITY;
        assert!(!film.tiles_mut()[0].add(id(2), 1.0, &sample));
        let picture = film.develop();
        assert_eq!(value(&picture, "a"), [1.0]);
        assert_eq!(value(&picture, "b"), [2.0, 3.0, 4.0, 5.0]);
        assert_eq!(value(&picture, "c"), [6.0]);
        assert_eq!((value(&picture, "Combined")[0], value(&picture, "Combined_key")[0]), (9.0, 8.0));
    }
}
