//! Files of value clips that a pattern names, as `clip.###.usd` (UsdClipsAPI, "template clips").

/// More clips than this are left as they are.
const MOST: f64 = 1_048_576.0;
/// OpenUSD steps over the times in these parts, so that fractions add up.
const PARTS: f64 = 10_000.0;

/// A pattern, and the time codes for which there may be a file.
pub(super) struct Template {
    before: String,
    digits: usize,
    /// Digits of a second group, after the point.
    decimals: Option<usize>,
    after: String,
    pub start: f64,
    pub end: f64,
    stride: f64,
    /// How long after its own time a clip is active.
    pub offset: Option<f64>,
}

impl Template {
    /// The template `pattern`, with the values of the set's other fields; `None` where OpenUSD takes it for none.
    pub fn of(pattern: &str, field: impl Fn(&str) -> Option<f64>) -> Option<Self> {
        let [start, end, stride] = [field("templateStartTime")?, field("templateEndTime")?, field("templateStride")?];
        let offset = field("templateActiveOffset");
        let steps = (end - start) / stride;
        if !(stride > 0.0 && (0.0..MOST).contains(&steps)) || offset.is_some_and(|offset| offset.abs() > stride) {
            return None;
        }
        let at = pattern.find('#')?;
        let (before, rest) = pattern.split_at(at);
        let hashes = |text: &str| text.len() - text.trim_start_matches('#').len();
        let digits = hashes(rest);
        let rest = &rest[digits..];
        let decimals = rest.strip_prefix('.').map(hashes).filter(|&decimals| decimals > 0);
        let after = &rest[decimals.map_or(0, |decimals| decimals + 1)..];
        let (before, after) = (before.to_owned(), after.to_owned());
        (!after.contains('#')).then_some(Self { before, digits, decimals, after, start, end, stride, offset })
    }

    /// Every time code at which a clip may start.
    pub fn times(&self) -> Vec<f64> {
        let (end, stride) = (self.end * PARTS, self.stride * PARTS);
        let mut times = Vec::new();
        let mut time = self.start * PARTS;
        while time <= end + 0.5 {
            times.push(time / PARTS);
            time += stride;
        }
        times
    }

    /// The file for `time`.
    pub fn file(&self, time: f64) -> String {
        let Self { before, digits, decimals, after, .. } = self;
        let number = match decimals {
            Some(decimals) => {
                let sign = if time < 0.0 { 1 } else { 0 };
                format!("{time:0width$.decimals$}", width = digits + 1 + decimals + sign)
            }
            None => format!("{:0digits$}", time as i64),
        };
        format!("{before}{number}{after}")
    }
}

#[cfg(test)]
mod tests {
    use super::Template;

    fn template(pattern: &str, range: [f64; 3], offset: Option<f64>) -> Option<Template> {
        Template::of(pattern, |field| match field {
            "templateStartTime" => Some(range[0]),
            "templateEndTime" => Some(range[1]),
            "templateStride" => Some(range[2]),
            _ => offset,
        })
    }

    /// Names that UsdClipsAPI's documentation gives.
    #[test]
    fn files_are_named_by_whole_numbers_and_by_fractions() {
        let file = |pattern, time| template(pattern, [0.0, 1.0, 1.0], None).unwrap().file(time);
        assert_eq!(file("foo.###.usd", 12.0), "foo.012.usd");
        assert_eq!(file("foo.#.###.usd", 1.15), "foo.1.150.usd");
        assert_eq!(file("a/foo.##.#.usd", 101.5), "a/foo.101.5.usd");
    }

    #[test]
    fn times_are_those_of_the_range() {
        let times = |range| template("foo.#.usd", range, None).unwrap().times();
        assert_eq!(times([1.0, 3.0, 1.0]), [1.0, 2.0, 3.0]);
        assert_eq!(times([0.0, 0.3, 0.1]), [0.0, 0.1, 0.2, 0.3]);
    }

    #[test]
    fn what_is_no_template_is_none() {
        let range = [1.0, 3.0, 1.0];
        assert!(template("foo.#.usd", range, Some(1.0)).is_some());
        assert!(template("foo.usd", range, None).is_none() && template("#.#.#.usd", range, None).is_none());
        assert!(template("foo.#.usd", range, Some(1.5)).is_none());
        for range in [[3.0, 1.0, 1.0], [1.0, 3.0, 0.0], [1.0, 3.0, -1.0], [0.0, 1e9, 1.0], [0.0, f64::NAN, 1.0]] {
            assert!(template("foo.#.usd", range, None).is_none(), "{range:?}");
        }
    }
}
