//! Curves as SVG: small, and the same text for the same figures.

use std::fmt::Write;

/// Curves over one axis.
pub(crate) struct Plot<'a> {
    pub(crate) title: &'a str,
    pub(crate) across: &'a str,
    pub(crate) up: &'a str,
    pub(crate) curves: Vec<(&'a str, Vec<[f64; 2]>)>,
}

const SIZE: [f64; 2] = [460.0, 300.0];
/// Of the axes from the border: left, top, right, bottom.
const MARGIN: [f64; 4] = [58.0, 34.0, 90.0, 46.0];
const COLORS: [&str; 2] = ["#1f6fb4", "#c4561a"];

impl Plot<'_> {
    /// The picture. Both axes begin at 0, so that what grows in proportion is a straight line.
    pub(crate) fn svg(&self) -> String {
        let points = || self.curves.iter().flat_map(|(_, points)| points);
        let most = [0, 1].map(|axis| points().map(|p| p[axis]).fold(f64::MIN_POSITIVE, f64::max));
        let steps = most.map(step);
        let [left, top, right, bottom] = MARGIN;
        let (width, height) = (SIZE[0] - left - right, SIZE[1] - top - bottom);
        let ends = [0, 1].map(|axis| steps[axis] * (most[axis] / steps[axis]).ceil());
        let x = |value: f64| left + value / ends[0] * width;
        let y = |value: f64| top + height - value / ends[1] * height;

        let mut svg = String::new();
        // Writing to a string cannot fail.
        let _ = writeln!(
            svg,
            r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {} {}" font-family="sans-serif" font-size="12">"#,
            SIZE[0], SIZE[1]
        );
        let _ = writeln!(svg, r#"<rect width="100%" height="100%" fill="white"/>"#);
        let mut label = |x: f64, y: f64, anchor: &str, more: &str, text: &str| {
            let _ =
                writeln!(svg, r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}"{more}>{text}</text>"#);
        };
        label(left, 20.0, "start", r#" font-weight="bold""#, self.title);
        label(left + width / 2.0, SIZE[1] - 10.0, "middle", "", self.across);
        let turned = format!(r#" transform="rotate(-90 14 {:.1})""#, top + height / 2.0);
        label(14.0, top + height / 2.0, "middle", &turned, self.up);
        for k in ticks(ends[0], steps[0]) {
            label(x(k), top + height + 16.0, "middle", "", &number(k));
        }
        for k in ticks(ends[1], steps[1]) {
            label(left - 6.0, y(k) + 4.0, "end", "", &number(k));
        }
        for ((name, points), color) in self.curves.iter().zip(COLORS.iter().cycle()) {
            if let Some(&[last_x, last_y]) = points.last() {
                label(x(last_x) + 8.0, y(last_y) + 4.0, "start", &format!(r#" fill="{color}""#), name);
            }
        }
        for k in ticks(ends[1], steps[1]) {
            let (to, at) = (left + width, y(k));
            let _ = writeln!(svg, r##"<path d="M{left:.1} {at:.1}H{to:.1}" stroke="#ddd"/>"##);
        }
        for ((_, points), color) in self.curves.iter().zip(COLORS.iter().cycle()) {
            let path: Vec<String> = points.iter().map(|p| format!("{:.1},{:.1}", x(p[0]), y(p[1]))).collect();
            let _ = writeln!(
                svg,
                r#"<polyline points="{}" fill="none" stroke="{color}" stroke-width="2"/>"#,
                path.join(" ")
            );
            for p in points {
                let _ = writeln!(
                    svg,
                    r#"<circle cx="{:.1}" cy="{:.1}" r="3" fill="{color}"/>"#,
                    x(p[0]),
                    y(p[1])
                );
            }
        }
        svg.push_str("</svg>\n");
        svg
    }
}

/// A round step that divides the way to `most` into three to seven.
fn step(most: f64) -> f64 {
    let power = 10_f64.powf((most / 3.0).log10().floor());
    let fits = |&factor: &f64| most / (factor * power) >= 3.0;
    power * [5.0, 2.0, 1.0].into_iter().find(fits).unwrap_or(1.0)
}

fn ticks(end: f64, step: f64) -> impl Iterator<Item = f64> {
    (0..=(end / step).round() as usize).map(move |k| k as f64 * step)
}

/// A number without the noise of binary fractions.
fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round_and_few() {
        for (most, wanted) in [(2.1, 0.5), (80.0, 20.0), (9.0, 2.0), (0.3, 0.1), (1234.0, 200.0)] {
            assert!((step(most) - wanted).abs() < 1e-9, "{most}: {}", step(most));
        }
        assert_eq!([0.1 + 0.2, 20.0, 0.0].map(number), ["0.3", "20", "0"]);
    }

    #[test]
    fn a_plot_holds_its_curves_within_its_axes() {
        let plot = Plot {
            title: "t",
            across: "x",
            up: "y",
            curves: vec![("a", vec![[0.0, 1.0], [10.0, 5.0]]), ("b", vec![[10.0, 0.0]])],
        };
        let svg = plot.svg();
        // The axes run from 58 to 370 and from 254 up to 34, for 10 and for 5.
        assert!(svg.contains(r#"points="58.0,210.0 370.0,34.0""#), "{svg}");
        assert!(svg.contains(r#"points="370.0,254.0""#), "{svg}");
        assert_eq!(svg, plot.svg());
    }
}
