//! Curves against `Ts.Spline.Eval` of usd-core 26.11.

use super::*;

/// Curves as text, and their values at some times.
type Known = (&'static str, &'static [(f64, Option<f64>)]);

const KNOWN: &[Known] = &[
    (
        "bezier, pre: linear, post: sloped(0.5), 1: 3; pre (0, 0); post curve (0.2, 0.5), 5: 4 & 7; pre (1, 2); post held, 8: 2; post linear, 10: 1",
        &[
            (-2.0, Some(1.5)),
            (1.0, Some(3.0)),
            (1.1, Some(3.002675557777)),
            (3.0, Some(2.793635325178)),
            (4.999, Some(3.998002230174)),
            (5.0, Some(7.0)),
            (7.0, Some(7.0)),
            (9.0, Some(1.5)),
            (10.0, Some(1.0)),
            (12.0, Some(2.0)),
        ],
    ),
    (
        "hermite, pre: held, post: linear, 0: 0; post curve (1), 4: 5; pre (-1); post curve (2), 6: 1 & 2; pre (0.5); post linear, 9: -1",
        &[
            (-1.0, Some(0.0)),
            (1.0, Some(1.53125)),
            (3.5, Some(5.22265625)),
            (5.0, Some(3.375)),
            (6.0, Some(2.0)),
            (7.0, Some(1.0)),
            (9.0, Some(-1.0)),
            (11.0, Some(-3.0)),
        ],
    ),
    (
        "bezier, 0: 0; post curve (7, 1), 10: 5; pre (8, 1)",
        &[
            (1.0, Some(0.960690990749)),
            (4.9, Some(1.884258026561)),
            (5.0, Some(1.821153385026)),
            (5.1, Some(1.772546751953)),
            (9.0, Some(4.029257849785)),
        ],
    ),
    (
        "bezier, pre: none, post: none, 0: 1; post none, 2: 3; post linear, 4: 5; post held",
        &[(-1.0, None), (0.0, None), (1.0, None), (2.0, Some(3.0)), (3.0, Some(4.0)), (4.0, None), (5.0, None)],
    ),
    (
        "bezier, pre: loop repeat, post: loop repeat, 1: 1 & 2; post curve (1, 0), 4: 6; pre (1, 1); post linear, 6: 5 & 9",
        &[
            (-9.0, Some(-6.0)),
            (-4.0, Some(-2.0)),
            (-0.5, Some(1.75)),
            (1.0, Some(2.0)),
            (5.0, Some(5.5)),
            (6.0, Some(9.0)),
            (7.0, Some(9.814814814815)),
            (11.0, Some(16.0)),
            (17.5, Some(24.625)),
        ],
    ),
    (
        "bezier, pre: loop reset, post: loop reset, 1: 1 & 2; post linear, 4: 6; post held, 6: 5 & 9",
        &[
            (-9.0, Some(2.0)),
            (-4.0, Some(2.0)),
            (-0.5, Some(6.0)),
            (1.0, Some(2.0)),
            (5.0, Some(6.0)),
            (6.0, Some(2.0)),
            (7.0, Some(3.333333333333)),
            (11.0, Some(2.0)),
            (17.5, Some(4.0)),
        ],
    ),
    (
        "bezier, pre: loop oscillate, post: loop oscillate, 1: 1 & 2; post linear, 4: 6; post held, 6: 5 & 9",
        &[
            (-9.0, Some(2.0)),
            (-4.0, Some(6.0)),
            (-0.5, Some(4.0)),
            (1.0, Some(2.0)),
            (5.0, Some(6.0)),
            (6.0, Some(6.0)),
            (7.5, Some(6.0)),
            (11.0, Some(2.0)),
            (17.5, Some(6.0)),
        ],
    ),
    (
        "bezier, pre: held, post: held, loop: (2, 4, 1, 2, 0.5), -1: 3; post linear, 2: 1; post linear, 3: 4; post curve (0.5, 1), 12: 2; pre (1, 0)",
        &[
            (-2.0, Some(3.0)),
            (-0.5, Some(1.75)),
            (0.25, Some(1.25)),
            (1.5, Some(3.026768498515)),
            (2.5, Some(2.5)),
            (3.75, Some(2.697514785058)),
            (4.25, Some(2.25)),
            (6.5, Some(3.5)),
            (7.9, Some(3.030571737321)),
            (9.0, Some(2.375)),
            (13.0, Some(2.0)),
        ],
    ),
];

#[test]
fn values_are_those_of_usd_core() {
    for (text, values) in KNOWN {
        let spline = from_text(text).unwrap();
        for &(time, expected) in *values {
            let found = spline.at(time);
            let same = match (found, expected) {
                (Some(found), Some(expected)) => (found - expected).abs() <= 1e-9 * expected.abs().max(1.0),
                (found, expected) => found == expected,
            };
            // Where a curve is upright, both lose digits.
            let upright = text.contains("(7, 1)") && found.zip(expected).is_some_and(|(a, b)| (a - b).abs() < 1e-4);
            assert!(same || upright, "{text} at {time} is {found:?}, not {expected:?}");
        }
    }
}

/// What usd-core 26.11 writes of `1: 3; post curve (0.2, 0.5)`, `5: 4 & 7; pre (1, 2); post held` and linear
/// and sloped (0.5) ends, in doubles.
#[test]
fn bytes_and_text_are_the_same() {
    let text = "bezier, pre: linear, post: sloped(0.5), 1: 3; post curve (0.2, 0.5), 5: 4 & 7; pre (1, 2); post held";
    let mut bytes = vec![0x11, 0x1a];
    bytes.extend(0.5_f64.to_le_bytes());
    bytes.extend(2_u32.to_le_bytes());
    for (flags, numbers) in [(6_u8, &[1.0, 3.0, 0.0, 0.2, 0.0, 0.5][..]), (3, &[5.0, 7.0, 4.0, 1.0, 0.0, 2.0, 0.0])] {
        bytes.push(flags);
        bytes.extend(numbers.iter().flat_map(|number: &f64| number.to_le_bytes()));
    }
    assert_eq!(from_bytes(&bytes), from_text(text));
    for cut in 0..bytes.len() {
        assert!(cut == 0 || from_bytes(&bytes[..cut]).is_none(), "{cut} bytes");
    }
}

#[test]
fn broken_text_is_no_curve() {
    for text in
        ["1", "1: ", "1: x", "1: 2; post sideways", "1: 2; pre (1", "pre: up", "loop: (1, 2)", "1: nan", "1: inf"]
    {
        assert_eq!(from_text(text), None, "{text}");
    }
    assert_eq!(from_text("").unwrap().at(3.0), None);
}

/// Loops may be many: they are not written out.
#[test]
fn endless_loops_take_no_time() {
    let text = "loop: (0, 1, 2147483647, 2147483647, 1), pre: loop repeat, post: loop repeat, 0: 0; post linear";
    let spline = from_text(text).unwrap();
    assert_eq!(spline.at(1e9 + 0.5), Some(1e9 + 0.5));
    assert_eq!(spline.at(-1e9), Some(-1e9));
    assert_eq!(spline.times(5.5, 8.0), [6.0, 7.0, 8.0]);
}
