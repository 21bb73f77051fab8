//! A log-log plot as SVG, in black ink on white for papers.

use std::fmt::Write;

/// One curve.
pub struct Line {
    /// What it is, in the legend.
    pub name: String,
    /// x and y of its points, both above 0.
    pub points: Vec<[f64; 2]>,
    /// Dashed, for what stands beside the others.
    pub dashed: bool,
}

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 520.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 210.0;
const TOP: f64 = 20.0;
const BOTTOM: f64 = 50.0;

/// Colors that those who see no red or green tell apart: M. Okabe, K. Ito, *Color Universal Design* (2008), and gray.
const COLORS: [&str; 8] = ["#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#888888"];

/// The plot. What is not above 0 is left out.
pub fn svg(lines: &[Line], x_label: &str, y_label: &str) -> String {
    let all = || lines.iter().flat_map(|line| &line.points).filter(|p| p[0] > 0.0 && p[1] > 0.0);
    let range = |axis: usize| {
        let bounds = all()
            .map(|p| p[axis].log10())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        if bounds.0 > bounds.1 { (0.0, 1.0) } else { (bounds.0 - 0.05, bounds.1 + 0.05) }
    };
    let (x, y) = (range(0), range(1));
    let x_at = |value: f64| LEFT + (value.log10() - x.0) / (x.1 - x.0) * (WIDTH - LEFT - RIGHT);
    let y_at = |value: f64| TOP + (y.1 - value.log10()) / (y.1 - y.0) * (HEIGHT - TOP - BOTTOM);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
         font-family=\"Helvetica,Arial,sans-serif\" font-size=\"12\"><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>"
    );
    let (right, bottom) = (WIDTH - RIGHT, HEIGHT - BOTTOM);
    for value in ticks(x) {
        let at = x_at(value);
        let _ = write!(
            svg,
            "<path d=\"M{at:.1} {TOP}V{bottom}\" stroke=\"#ddd\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            bottom + 16.0,
            label(value)
        );
    }
    for value in ticks(y) {
        let at = y_at(value);
        let _ = write!(
            svg,
            "<path d=\"M{LEFT} {at:.1}H{right}\" stroke=\"#ddd\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            LEFT - 6.0,
            at + 4.0,
            label(value)
        );
    }
    let _ = write!(
        svg,
        "<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#000\"/>",
        right - LEFT,
        bottom - TOP
    );
    for (i, line) in lines.iter().enumerate() {
        let (color, dash) =
            (COLORS[i % COLORS.len()], if line.dashed || i >= COLORS.len() { " stroke-dasharray=\"5 3\"" } else { "" });
        let points: Vec<(f64, f64)> =
            line.points.iter().filter(|p| p[0] > 0.0 && p[1] > 0.0).map(|p| (x_at(p[0]), y_at(p[1]))).collect();
        let path: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1} {y:.1}")).collect();
        if !path.is_empty() {
            let _ = write!(
                svg,
                "<path d=\"M{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.5\"{dash}/>",
                path.join("L")
            );
        }
        for (x, y) in points {
            let _ = write!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.5\" fill=\"{color}\"/>");
        }
        let at = TOP + 10.0 + 17.0 * i as f64;
        let _ = write!(
            svg,
            "<path d=\"M{} {at}h18\" stroke=\"{color}\" stroke-width=\"1.5\"{dash}/><text x=\"{}\" y=\"{}\">{}</text>",
            right + 10.0,
            right + 33.0,
            at + 4.0,
            escaped(&line.name)
        );
    }
    let _ = write!(
        svg,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text><text transform=\"translate(16 {}) rotate(-90)\" text-anchor=\"middle\">{}</text></svg>",
        0.5 * (LEFT + right),
        HEIGHT - 12.0,
        escaped(x_label),
        0.5 * (TOP + bottom),
        escaped(y_label)
    );
    svg
}

/// 1, 2 and 5 of each decade within a range of logarithms; the powers of ten alone where that would be many.
fn ticks((low, high): (f64, f64)) -> Vec<f64> {
    let steps: &[f64] = if high - low > 3.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let decades = low.floor() as i32..=high.ceil() as i32;
    let all = decades.flat_map(|decade| steps.iter().map(move |step| step * 10_f64.powi(decade)));
    all.filter(|value| (low..=high).contains(&value.log10())).collect()
}

fn label(value: f64) -> String {
    if (1e-3..1e4).contains(&value) { format!("{}", (value * 1e6).round() / 1e6) } else { format!("{value:.0e}") }
}

/// For use inside XML.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_sound_xml_with_every_point_inside() {
        let line = |name: &str, points: Vec<[f64; 2]>| Line { name: name.to_owned(), points, dashed: false };
        let text =
            svg(&[line("a < b & c", vec![[0.1, 3.0], [10.0, 0.02], [0.0, 1.0]]), line("none", vec![])], "s", "error");
        let document = roxmltree::Document::parse(&text).unwrap();
        let circles: Vec<_> = document.descendants().filter(|node| node.has_tag_name("circle")).collect();
        assert_eq!(circles.len(), 2);
        for circle in circles {
            let of = |name| circle.attribute(name).unwrap().parse::<f64>().unwrap();
            assert!((LEFT..=WIDTH - RIGHT).contains(&of("cx")) && (TOP..=HEIGHT - BOTTOM).contains(&of("cy")));
        }
        assert!(document.descendants().any(|node| node.text() == Some("a < b & c")));
    }

    #[test]
    fn ticks_are_in_the_range() {
        assert_eq!(ticks((-0.05, 1.05)), [1.0, 2.0, 5.0, 10.0]);
        assert_eq!(ticks((-2.5, 2.5)), [0.01, 0.1, 1.0, 10.0, 100.0]);
    }
}
