//! Transmissive solids around a path, the innermost last.

use crate::math::Rgb;

/// Solids within solids that are told apart; those beyond are taken for the last.
const DEPTH: usize = 4;

/// Absorption of each solid that a path has entered and not left.
#[derive(Clone, Copy, Debug, Default)]
pub struct Media {
    sigma: [Rgb; DEPTH],
    depth: usize,
}

impl Media {
    /// Absorption per metre where the path is; black in the open.
    pub fn current(&self) -> Rgb {
        if self.depth == 0 { Rgb::BLACK } else { self.sigma[self.depth.min(DEPTH) - 1] }
    }

    /// Crosses the boundary of a solid of absorption `sigma`, into it or out of it.
    pub fn cross(&mut self, sigma: Rgb, entering: bool) {
        if entering {
            if self.depth < DEPTH {
                self.sigma[self.depth] = sigma;
            }
            self.depth += 1;
        } else {
            self.depth = self.depth.saturating_sub(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaving_brings_back_what_was_outside() {
        let (water, glass) = (Rgb::splat(0.1), Rgb::splat(2.0));
        let mut media = Media::default();
        media.cross(water, true);
        media.cross(glass, true);
        assert_eq!(media.current(), glass);
        media.cross(glass, false);
        assert_eq!(media.current(), water);
        media.cross(water, false);
        media.cross(water, false);
        assert_eq!(media.current(), Rgb::BLACK);
        for _ in 0..9 {
            media.cross(glass, true);
        }
        assert_eq!(media.current(), glass);
    }
}
