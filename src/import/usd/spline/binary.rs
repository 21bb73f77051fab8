//! Curves as binary layers keep them (`Ts_BinaryDataAccess`, versions 1 and 2).

use super::{Beyond, Kind, Knot, Loops, Next, Spline, Tangent};

/// The curve that `bytes` tell; `None` where they are broken or of a version that is not known.
pub(in super::super) fn read(bytes: &[u8]) -> Option<Spline> {
    if bytes.is_empty() {
        return Spline::new(Kind::Bezier, [Beyond::Held; 2], None, Vec::new());
    }
    let mut bytes = Bytes(bytes);
    let [head, modes] = bytes.take()?;
    let version = head & 0x0f;
    if !matches!(version, 1 | 2) {
        return None;
    }
    let number: fn(&mut Bytes<'_>) -> Option<f64> = match (head >> 4) & 3 {
        0 | 1 => |bytes| bytes.double(),
        2 => |bytes| bytes.take().map(|b| f32::from_le_bytes(b).into()),
        _ => |bytes| bytes.take().map(|b| half::f16::from_le_bytes(b).to_f64()),
    };
    let kind = if head & 0x80 == 0 { Kind::Bezier } else { Kind::Hermite };
    let before = bytes.beyond(modes & 7)?;
    let after = bytes.beyond((modes >> 3) & 7)?;
    let loops = match modes & 0x40 {
        0 => None,
        _ => Some(Loops {
            start: bytes.double()?,
            end: bytes.double()?,
            times_before: bytes.take().map(i32::from_le_bytes)?,
            times_after: bytes.take().map(i32::from_le_bytes)?,
            offset: bytes.double()?,
        }),
    };
    let count = bytes.take().map(u32::from_le_bytes)?;
    let mut knots = Vec::new();
    for _ in 0..count {
        let [flags] = bytes.take()?;
        let (time, value) = (bytes.double()?, number(&mut bytes)?);
        let value_before = if flags & 1 == 0 { None } else { Some(number(&mut bytes)?) };
        let widths = match kind {
            Kind::Bezier => [bytes.double()?, bytes.double()?],
            Kind::Hermite => [0.0; 2],
        };
        let slopes = [number(&mut bytes)?, number(&mut bytes)?];
        if version > 1 {
            // How the tangents were found.
            let [_] = bytes.take()?;
        }
        let next = [Next::Blocked, Next::Held, Next::Linear, Next::Curved][usize::from((flags >> 1) & 3)];
        let [before, after] = [0, 1].map(|i| Tangent { width: widths[i], slope: slopes[i] });
        knots.push(Knot { time, value, value_before, before, after, next });
    }
    Spline::new(kind, [before, after], loops, knots).map(Spline::settled)
}

struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*taken)
    }

    fn double(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    fn beyond(&mut self, mode: u8) -> Option<Beyond> {
        Some(match mode {
            0 => Beyond::Blocked,
            1 => Beyond::Held,
            2 => Beyond::Linear,
            3 => Beyond::Sloped(self.double()?),
            4 => Beyond::Repeat,
            5 => Beyond::Reset,
            6 => Beyond::Oscillate,
            _ => return None,
        })
    }
}
