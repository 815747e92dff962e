//! Plots as SVG: figures of several settings beside each other, and curves.

use std::fmt::Write;

/// Blue, orange and green of Okabe and Ito, which every eye tells apart; the marks differ in shape too.
const COLORS: [&str; 3] = ["#0072b2", "#d55e00", "#009e73"];
/// Height of a row (px).
const ROW_PX: f64 = 22.0;
/// Room above the first row (px), for title and legend.
const HEAD_PX: f64 = 58.0;
/// Room below the last row (px), for the scale.
const FOOT_PX: f64 = 42.0;
/// Width of the field in which marks lie (px).
const FIELD_PX: f64 = 420.0;
/// Room a letter takes (px).
const LETTER_PX: f64 = 7.2;
/// Side of the field of a curve (px).
const SIDE_PX: f64 = 360.0;

/// A row of [`dots`]: its name, and a share of 1 for each series.
pub type DotsRow = (String, Vec<f64>);

/// Shares of several settings, a row each, on a scale in percent that ends at 100; at most three series.
pub fn dots(title: &str, series: &[&str], rows: &[DotsRow]) -> String {
    let longest = rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    let left = 20.0 + LETTER_PX * longest as f64;
    let (width, height) = (left + FIELD_PX + 30.0, HEAD_PX + ROW_PX * rows.len() as f64 + FOOT_PX);
    let least = rows.iter().flat_map(|(_, shares)| shares).copied().fold(1.0, f64::min);
    // The scale begins at a whole ten below the least.
    let begin = ((least * 10.0).floor() / 10.0).clamp(0.0, 0.9);
    let x = |share: f64| left + FIELD_PX * (share - begin) / (1.0 - begin);
    let bottom = HEAD_PX + ROW_PX * rows.len() as f64;
    let mut svg = begun(title, width, height);
    for ten in (begin * 10.0).round() as u32..=10 {
        let place = x(f64::from(ten) / 10.0);
        line(&mut svg, [place, HEAD_PX - 4.0, place, bottom], "#d9dde1");
        text(&mut svg, [place, bottom + 18.0], "middle", &format!("{}", 10 * ten));
    }
    text(&mut svg, [left + FIELD_PX / 2.0, bottom + 36.0], "middle", "percent");
    for (k, name) in series.iter().enumerate() {
        let place = left + 150.0 * k as f64;
        mark(&mut svg, [place, 40.0], k);
        text(&mut svg, [place + 10.0, 44.0], "start", name);
    }
    for (k, (name, shares)) in rows.iter().enumerate() {
        let y = HEAD_PX + ROW_PX * (k as f64 + 0.5);
        text(&mut svg, [left - 10.0, y + 4.0], "end", name);
        shares.iter().enumerate().for_each(|(k, &share)| mark(&mut svg, [x(share), y], k));
    }
    svg + "</svg>\n"
}

/// Amounts, a bar each, on a scale that begins at 0; `unit` names it.
pub fn bars(title: &str, unit: &str, rows: &[(String, f64)]) -> String {
    let longest = rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    let left = 20.0 + LETTER_PX * longest as f64;
    let bottom = HEAD_PX + ROW_PX * rows.len() as f64;
    let mut svg = begun(title, left + FIELD_PX + 70.0, bottom + FOOT_PX);
    let most = rows.iter().map(|&(_, amount)| amount).fold(f64::MIN_POSITIVE, f64::max);
    for (k, (name, amount)) in rows.iter().enumerate() {
        let (y, width) = (HEAD_PX + ROW_PX * k as f64, FIELD_PX * amount / most);
        text(&mut svg, [left - 10.0, y + 15.0], "end", name);
        let _ = writeln!(
            svg,
            "<rect x=\"{left:.1}\" y=\"{:.1}\" width=\"{width:.1}\" height=\"{:.1}\" fill=\"{}\"/>",
            y + 3.0,
            ROW_PX - 6.0,
            COLORS[0]
        );
        text(&mut svg, [left + width + 6.0, y + 15.0], "start", &format!("{amount:.2}"));
    }
    text(&mut svg, [left, bottom + 22.0], "start", unit);
    svg + "</svg>\n"
}

/// A curve in the unit square; the names are those of its axes, in percent.
pub fn curve(title: &str, [across, up]: [&str; 2], points: &[[f64; 2]]) -> String {
    let (left, top) = (70.0, 50.0);
    let mut svg = begun(title, left + SIDE_PX + 30.0, top + SIDE_PX + 55.0);
    let place = |[x, y]: [f64; 2]| [left + SIDE_PX * x, top + SIDE_PX * (1.0 - y)];
    for fifth in 0..=5 {
        let share = f64::from(fifth) / 5.0;
        let ([x, _], [_, y]) = (place([share, 0.0]), place([0.0, share]));
        line(&mut svg, [x, top, x, top + SIDE_PX], "#d9dde1");
        line(&mut svg, [left, y, left + SIDE_PX, y], "#d9dde1");
        text(&mut svg, [x, top + SIDE_PX + 18.0], "middle", &format!("{}", 20 * fifth));
        text(&mut svg, [left - 8.0, y + 4.0], "end", &format!("{}", 20 * fifth));
    }
    text(&mut svg, [left + SIDE_PX / 2.0, top + SIDE_PX + 40.0], "middle", &format!("{across} [%]"));
    text(&mut svg, [left, top - 10.0], "middle", &format!("{up} [%]"));
    let path: String = points.iter().map(|&point| place(point)).fold(String::new(), |mut path, [x, y]| {
        // Writing to a string cannot fail.
        let _ = write!(path, "{x:.1},{y:.1} ");
        path
    });
    let _ = writeln!(
        svg,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>",
        path.trim_end(),
        COLORS[0]
    );
    svg + "</svg>\n"
}

fn begun(title: &str, width: f64, height: f64) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" height=\"{height:.0}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    let _ = writeln!(svg, "<title>{}</title>", escaped(title));
    let _ = writeln!(svg, "<text x=\"16\" y=\"22\" font-weight=\"bold\">{}</text>", escaped(title));
    svg
}

fn line(svg: &mut String, [x1, y1, x2, y2]: [f64; 4], color: &str) {
    let _ = writeln!(
        svg,
        "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{color}\"/>"
    );
}

fn text(svg: &mut String, [x, y]: [f64; 2], anchor: &str, words: &str) {
    let _ =
        writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>", escaped(words));
}

/// A circle, a square or a triangle.
fn mark(svg: &mut String, [x, y]: [f64; 2], series: usize) {
    let color = COLORS[series % COLORS.len()];
    let _ = match series % COLORS.len() {
        0 => writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\" fill=\"{color}\"/>"),
        1 => writeln!(
            svg,
            "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"8\" height=\"8\" fill=\"{color}\"/>",
            x - 4.0,
            y - 4.0
        ),
        _ => writeln!(svg, "<path d=\"M{x:.1} {:.1}l5 9h-10z\" fill=\"{color}\"/>", y - 5.0),
    };
}

fn escaped(words: &str) -> String {
    words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_lie_where_the_scale_says() {
        let rows = [("a".to_owned(), vec![1.0, 0.5]), ("b < c".to_owned(), vec![0.75, 0.5])];
        let svg = dots("two", &["correct", "overlap F"], &rows);
        let right = 20.0 + LETTER_PX * 5.0 + FIELD_PX;
        assert!(
            svg.contains(&format!("<circle cx=\"{right:.1}\" cy=\"{:.1}\"", HEAD_PX + ROW_PX / 2.0)),
            "{svg}"
        );
        let middle = right - FIELD_PX / 2.0;
        assert!(
            svg.contains(&format!("<circle cx=\"{middle:.1}\" cy=\"{:.1}\"", HEAD_PX + 1.5 * ROW_PX)),
            "{svg}"
        );
        assert!(svg.contains("b &lt; c") && svg.ends_with("</svg>\n"));
        assert!(dots("none", &[], &[]).ends_with("</svg>\n"));
    }

    #[test]
    fn a_curve_spans_the_square() {
        let svg = curve("all", ["recall", "precision"], &[[0.0, 1.0], [1.0, 0.0]]);
        assert!(svg.contains("points=\"70.0,50.0 430.0,410.0\""), "{svg}");
    }
}
