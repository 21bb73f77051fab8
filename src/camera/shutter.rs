//! When each ray sees the scene: how a shutter exposes the picture while it is open, as Cycles has it.

/// Times of rays, 0 where the shutter opens to 1 where it has closed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exposure {
    /// Of the shares of the light that has come in by the ends of even pieces of that time; `None` where as much comes
    /// in all the time.
    let_in: Option<Box<[f32]>>,
    /// Rows of the picture are exposed one after the other, from the top, each for this share of the time; `None` where
    /// all are at once.
    rolling: Option<f32>,
}

impl Exposure {
    /// A shutter that is `curve` open at even steps of the time, and in between as on straight lines; wide open all the
    /// time by an empty one, and by one that never opens. `rolling` is the share of the time that each row is exposed.
    pub fn new(curve: &[f64], rolling: Option<f64>) -> Self {
        let pieces = curve.windows(2).map(|ends| 0.5 * (ends[0].abs() + ends[1].abs()));
        let mut sum = 0.0;
        let sums: Vec<f64> = pieces
            .map(|piece| {
                sum += piece;
                sum
            })
            .collect();
        let let_in = (sum.is_finite() && sum > 0.0 && curve.iter().any(|&open| open != curve[0]))
            .then(|| sums.iter().map(|part| (part / sum) as f32).collect());
        Self { let_in, rolling: rolling.map(|share| share.clamp(0.0, 1.0) as f32) }
    }

    /// True where rows are exposed one after the other.
    pub fn is_rolling(&self) -> bool {
        self.rolling.is_some()
    }

    /// The time of a ray of a row that is `down` of the picture's height below its top; `u` is uniform.
    pub fn time(&self, u: f32, down: f32) -> f32 {
        let time = self.let_in.as_ref().map_or(u, |let_in| inverse(let_in, u));
        match self.rolling {
            None => time,
            Some(share) => (time - 0.5) * share + (down - 0.5) * (1.0 - share) + 0.5,
        }
    }
}

/// Where the sums of even pieces reach `u`.
fn inverse(sums: &[f32], u: f32) -> f32 {
    let piece = sums.partition_point(|&sum| sum <= u).min(sums.len() - 1);
    let before = if piece == 0 { 0.0 } else { sums[piece - 1] };
    let size = sums[piece] - before;
    let within = if size > 0.0 { ((u - before) / size).clamp(0.0, 1.0) } else { 0.0 };
    (piece as f32 + within) / sums.len() as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_come_as_often_as_the_shutter_is_open() {
        let triangle: Vec<f64> = (0..=256).map(|i| 1.0 - (f64::from(i) / 128.0 - 1.0).abs()).collect();
        let exposure = Exposure::new(&triangle, None);
        // The integral of the triangle: 2 t² up to the middle.
        for u in [0.0_f32, 0.02, 0.125, 0.5, 0.875, 0.98, 0.999_999] {
            let exact = if u < 0.5 { (0.5 * u).sqrt() } else { 1.0 - (0.5 * (1.0 - u)).sqrt() };
            assert!((exposure.time(u, 0.3) - exact).abs() < 3e-3, "{u}: {}", exposure.time(u, 0.3));
        }
        // A shutter that is closed for half of the time.
        let late = Exposure::new(&[0.0, 0.0, 0.0, 1.0, 1.0], None);
        assert!(late.time(0.0, 0.0) >= 0.5 && late.time(0.2, 0.0) > 0.6);
        for same in [&[][..], &[0.0, 0.0], &[2.0, 2.0, 2.0], &[f64::NAN, 1.0]] {
            assert_eq!(Exposure::new(same, None), Exposure::default());
        }
    }

    #[test]
    fn rows_of_a_rolling_shutter_are_exposed_from_the_top() {
        let whole = Exposure::new(&[], Some(0.0));
        assert_eq!([0.0, 0.25, 1.0].map(|down| whole.time(0.9, down)), [0.0, 0.25, 1.0]);
        let half = Exposure::new(&[], Some(0.5));
        assert_eq!([half.time(0.0, 0.0), half.time(1.0, 0.0), half.time(0.5, 0.5)], [0.0, 0.5, 0.5]);
        assert_eq!(half.time(1.0, 1.0), 1.0);
    }
}
