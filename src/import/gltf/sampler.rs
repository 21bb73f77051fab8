//! Values between keyframes (glTF 2.0, section 3.11 and appendix C).

use crate::math::DQuat;

/// How a sampler fills the time between its keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Interpolation {
    /// The value of the key before.
    Step,
    /// A straight line; for rotations the shorter arc.
    Linear,
    /// A Hermite spline; each key has in-tangent, value and out-tangent.
    CubicSpline,
}

impl Interpolation {
    /// The mode of that name; linear where there is none.
    pub fn from_name(name: Option<&str>) -> Result<Self, String> {
        match name {
            None | Some("LINEAR") => Ok(Self::Linear),
            Some("STEP") => Ok(Self::Step),
            Some("CUBICSPLINE") => Ok(Self::CubicSpline),
            Some(name) => Err(format!("interpolation '{name}' is not known")),
        }
    }

    /// Elements of the output for each key.
    fn elements(self) -> usize {
        if self == Self::CubicSpline { 3 } else { 1 }
    }
}

/// The value at `time`: as many numbers as the output has for each key. Before the first key and
/// after the last one it stays what it is there. Times are compared in the single precision in
/// which the file holds them, so that a key on a frame is met by that frame.
pub(super) fn sample(
    times: &[f32],
    values: &[f32],
    interpolation: Interpolation,
    rotation: bool,
    time: f64,
) -> Result<Vec<f64>, String> {
    let keys = times.len();
    let elements = keys * interpolation.elements();
    if keys == 0 || values.is_empty() || !values.len().is_multiple_of(elements) {
        return Err(format!("{} output values don't fit {keys} keys", values.len()));
    }
    if !times.iter().all(|t| t.is_finite()) || times.windows(2).any(|pair| pair[0] >= pair[1]) {
        return Err("the times of the keys don't grow".into());
    }
    let width = values.len() / elements;
    if rotation && width != 4 {
        return Err(format!("a rotation of {width} numbers"));
    }
    let element = |i: usize| values[i * width..(i + 1) * width].iter().map(|&v| f64::from(v));
    let value = |key: usize| match interpolation {
        Interpolation::CubicSpline => element(3 * key + 1),
        Interpolation::Step | Interpolation::Linear => element(key),
    };
    let next = times.partition_point(|&t| t <= time as f32);
    if next == 0 || next == keys || interpolation == Interpolation::Step {
        return Ok(finish(value(next.saturating_sub(1)).collect(), rotation));
    }
    let (t0, t1) = (f64::from(times[next - 1]), f64::from(times[next]));
    let (span, t) = (t1 - t0, ((f64::from(time as f32) - t0) / (t1 - t0)).clamp(0.0, 1.0));
    let (a, b) = (value(next - 1), value(next));
    Ok(match interpolation {
        Interpolation::CubicSpline => {
            let (out_tangent, in_tangent) = (element(3 * (next - 1) + 2), element(3 * next));
            let (t2, t3) = (t * t, t * t * t);
            let hermite = |((p0, m0), (p1, m1)): ((f64, f64), (f64, f64))| {
                (2.0 * t3 - 3.0 * t2 + 1.0) * p0
                    + span * (t3 - 2.0 * t2 + t) * m0
                    + (3.0 * t2 - 2.0 * t3) * p1
                    + span * (t3 - t2) * m1
            };
            finish(a.zip(out_tangent).zip(b.zip(in_tangent)).map(hermite).collect(), rotation)
        }
        _ if rotation => {
            let quaternion = |values: Vec<f64>| DQuat::from_xyzw(values[0], values[1], values[2], values[3]);
            let (a, b) = (quaternion(finish(a.collect(), true)), quaternion(finish(b.collect(), true)));
            a.slerp(b, t).to_array().to_vec()
        }
        _ => a.zip(b).map(|(a, b)| a + t * (b - a)).collect(),
    })
}

/// Rotations come out with unit length.
fn finish(mut value: Vec<f64>, rotation: bool) -> Vec<f64> {
    let length = value.iter().map(|v| v * v).sum::<f64>().sqrt();
    if rotation && length > 0.0 {
        value.iter_mut().for_each(|v| *v /= length);
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_and_step_and_both_ends() {
        let (times, values) = ([1.0, 2.0], [10.0, 0.0, 20.0, 4.0]);
        let linear = |t| sample(&times, &values, Interpolation::Linear, false, t).unwrap();
        assert_eq!(linear(0.0), [10.0, 0.0]);
        assert_eq!(linear(1.25), [12.5, 1.0]);
        assert_eq!(linear(9.0), [20.0, 4.0]);
        let step = |t| sample(&times, &values, Interpolation::Step, false, t).unwrap();
        assert_eq!((step(1.99), step(2.0)), (vec![10.0, 0.0], vec![20.0, 4.0]));
    }

    #[test]
    fn a_key_on_a_frame_is_met_by_that_frame() {
        let times: Vec<f32> = (0..240).map(|frame| (f64::from(frame) / 24.0) as f32).collect();
        let values: Vec<f32> = (0..240).map(|frame| frame as f32).collect();
        for frame in 0..240 {
            let value = sample(&times, &values, Interpolation::Step, false, f64::from(frame) / 24.0).unwrap();
            assert_eq!(value, [f64::from(frame)]);
        }
    }

    #[test]
    fn rotations_take_the_shorter_arc() {
        let s = 0.5_f32.sqrt();
        // From no turn to a quarter turn about z, whose quaternion is written negated.
        let value =
            sample(&[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -s, -s], Interpolation::Linear, true, 0.5).unwrap();
        let (sin, cos) = (std::f64::consts::PI / 8.0).sin_cos();
        assert!((value[2] - sin).abs() < 1e-7 && (value[3] - cos).abs() < 1e-7, "{value:?}");
    }

    #[test]
    fn the_spline_is_the_specifications() {
        // p(t) of x = t³ from t = 0 to 2 with its own slopes 0 and 12.
        let values = [0.0, 0.0, 0.0, 12.0, 8.0, 0.0];
        for t in [0.0, 0.5, 1.0, 1.75, 2.0] {
            let value = sample(&[0.0, 2.0], &values, Interpolation::CubicSpline, false, t).unwrap();
            assert!((value[0] - t * t * t).abs() < 1e-12, "{t} {value:?}");
        }
    }

    #[test]
    fn misfits_are_errors() {
        let linear = Interpolation::Linear;
        assert!(sample(&[], &[1.0], linear, false, 0.0).is_err());
        assert!(sample(&[0.0, 1.0], &[1.0], linear, false, 0.0).is_err());
        assert!(sample(&[1.0, 0.0], &[1.0, 2.0], linear, false, 0.0).is_err());
        assert!(sample(&[f32::NAN], &[1.0], linear, false, 0.0).is_err());
        assert!(sample(&[0.0], &[1.0, 2.0, 3.0], linear, true, 0.0).is_err());
        assert!(Interpolation::from_name(Some("QUADRATIC")).is_err());
    }
}
