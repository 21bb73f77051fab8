//! The sums of a tile as bytes and back, without loss: what a render goes on from.
//!
//! Numbers lie in the order of the machine that wrote them; a file says which that is. What the rays through the
//! pixels' centres met is not among them, since it costs little to find again.

use std::io::{self, Read, Write};

use bytemuck::{Pod, cast_slice, cast_slice_mut};

use super::{NonFinite, SampleId, Tile};
use crate::film::cryptomatte::Matte;

/// Most ids that a pixel may be said to have.
const MOST_IDS: u32 = 1 << 24;

fn put<T: Pod>(out: &mut dyn Write, values: &[T]) -> io::Result<()> {
    out.write_all(cast_slice(values))
}

fn fill<T: Pod>(from: &mut dyn Read, values: &mut [T]) -> io::Result<()> {
    from.read_exact(cast_slice_mut(values))
}

fn one<T: Pod>(from: &mut dyn Read) -> io::Result<T> {
    let mut value = [T::zeroed()];
    fill(from, &mut value)?;
    Ok(value[0])
}

fn broken(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what.to_owned())
}

impl Tile {
    /// Writes all that samples have left.
    pub(in crate::film) fn save(&self, out: &mut dyn Write) -> io::Result<()> {
        put(out, &self.sums)?;
        put(out, &self.counts)?;
        if let Some(replicates) = &self.replicates {
            let (sums, counts, largest) = replicates.arrays();
            put(out, sums)?;
            put(out, counts)?;
            put(out, largest)?;
        }
        for matte in self.mattes.iter().flatten() {
            let entries: Vec<(u32, f32)> = matte.entries().collect();
            put(out, &[entries.len() as u32])?;
            let pairs: Vec<[u32; 2]> = entries.into_iter().map(|(id, coverage)| [id, coverage.to_bits()]).collect();
            put(out, &pairs)?;
        }
        put(out, &[self.dropped.len() as u32])?;
        let dropped: Vec<[u32; 2]> = self.dropped.iter().map(|(&pixel, &count)| [pixel, count]).collect();
        put(out, &dropped)?;
        let SampleId { x, y, index } = self.non_finite.first.unwrap_or(SampleId { x: 0, y: 0, index: 0 });
        put(out, &[self.non_finite.count])?;
        put(out, &[x, y, index])
    }

    /// Takes in what [`Tile::save`] has written of a tile of the same place, size and quantities.
    pub(in crate::film) fn load(&mut self, from: &mut dyn Read) -> io::Result<()> {
        fill(from, &mut self.sums)?;
        fill(from, &mut self.counts)?;
        if let Some(replicates) = &mut self.replicates {
            let (sums, counts, largest) = replicates.arrays_mut();
            fill(from, sums)?;
            fill(from, counts)?;
            fill(from, largest)?;
        }
        for matte in self.mattes.iter_mut().flatten() {
            let count: u32 = one(from)?;
            if count > MOST_IDS {
                return Err(broken("a pixel of more ids than there can be"));
            }
            // Grown as they come: memory is not taken by a number's word.
            let entries: io::Result<Vec<(u32, f32)>> =
                (0..count).map(|_| one(from).map(|[id, coverage]: [u32; 2]| (id, f32::from_bits(coverage)))).collect();
            *matte = Matte::of_entries(&entries?);
        }
        let dropped: u32 = one(from)?;
        self.dropped.clear();
        for _ in 0..dropped {
            let [pixel, count]: [u32; 2] = one(from)?;
            if pixel as usize >= self.counts.len() {
                return Err(broken("a dropped sample of a pixel that is not there"));
            }
            self.dropped.insert(pixel, count);
        }
        let (count, [x, y, index]): (u64, [u32; 3]) = (one(from)?, one(from)?);
        self.non_finite = NonFinite { count, first: (count > 0).then_some(SampleId { x, y, index }) };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{CryptoSample, Film, PassSet, PixelSample};
    use crate::math::Rgb;

    /// Samples of every fifth pixel are not finite, and pixels have more ids than lie inline.
    fn film(samples: std::ops::Range<u32>, mut film: Film) -> Film {
        for tile in film.tiles_mut() {
            for (x, y) in tile.pixels() {
                for index in samples.clone() {
                    let value =
                        if (x + 3 * y) % 5 == 0 && index % 3 == 1 { f32::NAN } else { 0.1 * index as f32 + 0.37 };
                    let crypto =
                        CryptoSample { object: 1.0 + (index % 7) as f32, coverage: 1.0, ..CryptoSample::default() };
                    let sample = PixelSample { combined: Rgb::new(value, 0.3, 0.7), crypto, ..PixelSample::default() };
                    tile.add(SampleId { x, y, index }, 0.9, &sample);
                }
            }
        }
        film
    }

    #[test]
    fn sums_come_back_and_go_on_as_they_were() {
        let passes = PassSet::parse("combined,crypto_object,error,error_trust,sample_count").expect("known");
        let new = || Film::new(19, 18, passes.clone());
        let (whole, half) = (film(0..40, new()), film(0..21, new()));
        let (mut bytes, mut other) = (Vec::new(), new());
        half.save(&mut bytes).expect("written");
        let mut rest = &*bytes;
        other.load(&mut rest).expect("read");
        assert!(rest.is_empty());
        assert_eq!((other.develop(), other.non_finite()), (half.develop(), half.non_finite()));
        // What was dropped was given, too.
        assert_eq!(other.given(), (21, 21, 21 * 19 * 18));
        assert!(other.samples() < 21 * 19 * 18);
        let other = film(21..40, other);
        assert_eq!((other.develop(), other.non_finite()), (whole.develop(), whole.non_finite()));
        assert!(new().load(&mut &bytes[..bytes.len() - 1]).is_err());
    }
}
