//! Smooth shapes on a picture, each given by the distance of a point to it.

use image::{Rgb, RgbImage};

use crate::text::blend;

/// A point or an extent on a picture: columns to the right, rows downwards [px].
pub(crate) type Point = [f32; 2];

/// A filled disc.
pub(crate) fn disc(picture: &mut RgbImage, center: Point, radius_px: f32, color: Rgb<u8>) {
    let reach = [radius_px; 2];
    fill(picture, minus(center, reach), plus(center, reach), color, |p| length(minus(p, center)) - radius_px);
}

/// A filled rectangle, `half` its width and height.
pub(crate) fn bar(picture: &mut RgbImage, center: Point, half: Point, color: Rgb<u8>) {
    fill(picture, minus(center, half), plus(center, half), color, |p| {
        let d = minus(p, center);
        (d[0].abs() - half[0]).max(d[1].abs() - half[1])
    });
}

/// A line along `points` with round ends and corners.
pub(crate) fn line(picture: &mut RgbImage, points: &[Point], width_px: f32, color: Rgb<u8>) {
    let half = width_px / 2.0;
    let of = |k: usize| points.iter().map(move |p| p[k]);
    let low = [0, 1].map(|k| of(k).fold(f32::INFINITY, f32::min) - half);
    let high = [0, 1].map(|k| of(k).fold(f32::NEG_INFINITY, f32::max) + half);
    fill(picture, low, high, color, |p| {
        let distances = points.windows(2).map(|ends| to_segment(p, ends[0], ends[1]));
        distances.fold(f32::INFINITY, f32::min) - half
    });
}

/// A line along `points` in dashes as long as the gaps between them, of which there is one at least a piece.
pub(crate) fn dashes(picture: &mut RgbImage, points: &[Point], width_px: f32, dash_px: f32, color: Rgb<u8>) {
    // Enough for a line across any picture, and an end to a line of infinite length.
    const MOST: usize = 1000;
    for ends in points.windows(2) {
        let way = minus(ends[1], ends[0]);
        let count = ((length(way) / (2.0 * dash_px)).ceil() as usize).clamp(1, MOST);
        let at = |share: f32| plus(ends[0], way.map(|d| d * share / count as f32));
        (0..count).for_each(|k| line(picture, &[at(k as f32), at(k as f32 + 0.5)], width_px, color));
    }
}

/// From `p` to the nearest point between `a` and `b`.
fn to_segment(p: Point, a: Point, b: Point) -> f32 {
    let (along, d) = (minus(b, a), minus(p, a));
    let squared = (along[0] * along[0] + along[1] * along[1]).max(f32::MIN_POSITIVE);
    let share = ((d[0] * along[0] + d[1] * along[1]) / squared).clamp(0.0, 1.0);
    length([d[0] - share * along[0], d[1] - share * along[1]])
}

/// Covers the pixels whose centre is inside, within `low..high`; `distance` is negative there, and a pixel on the
/// border is covered in part.
fn fill(picture: &mut RgbImage, low: Point, high: Point, color: Rgb<u8>, distance: impl Fn(Point) -> f32) {
    let (width, height) = picture.dimensions();
    let range = |k: usize, size: u32| {
        let first = (low[k] - 1.0).max(0.0) as u32;
        first..((high[k] + 2.0).max(0.0) as u32).min(size)
    };
    for y in range(1, height) {
        for x in range(0, width) {
            let covered = (0.5 - distance([x as f32 + 0.5, y as f32 + 0.5])).clamp(0.0, 1.0);
            blend(picture, (i64::from(x), i64::from(y)), color, covered);
        }
    }
}

fn plus(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1]]
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn length(a: Point) -> f32 {
    (a[0] * a[0] + a[1] * a[1]).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const INK: Rgb<u8> = Rgb([255; 3]);

    /// How much of a black picture of 40 x 30 pixels is covered, in pixels.
    fn area(draw: impl Fn(&mut RgbImage)) -> f32 {
        let mut picture = RgbImage::new(40, 30);
        draw(&mut picture);
        picture.pixels().map(|p| f32::from(p.0[0]) / 255.0).sum()
    }

    #[test]
    fn shapes_cover_their_area() {
        let close = |found: f32, exact: f32| assert!((found - exact).abs() < 0.03 * exact, "{found} {exact}");
        close(area(|p| disc(p, [20.0, 15.0], 9.0, INK)), 81.0 * std::f32::consts::PI);
        close(area(|p| disc(p, [20.3, 15.7], 9.4, INK)), 88.36 * std::f32::consts::PI);
        close(area(|p| bar(p, [20.0, 15.0], [8.0, 5.0], INK)), 160.0);
        close(area(|p| line(p, &[[5.0, 15.0], [35.0, 15.0]], 2.0, INK)), 60.0 + std::f32::consts::PI);
        let corner = [[5.0, 5.0], [5.0, 25.0], [35.0, 25.0]];
        close(area(|p| line(p, &corner, 2.0, INK)), 100.0 + std::f32::consts::PI);
        close(area(|p| line(p, &[[5.0, 5.0], [35.0, 25.0]], 2.0, INK)), 72.11 + std::f32::consts::PI);
        // Three dashes of 5 px with round ends.
        close(
            area(|p| dashes(p, &[[5.0, 15.0], [35.0, 15.0]], 2.0, 5.0, INK)),
            30.0 + 3.0 * std::f32::consts::PI,
        );
    }

    #[test]
    fn what_lies_outside_is_cut_off() {
        close_to_half(area(|p| disc(p, [0.0, 15.0], 9.0, INK)));
        for far in [-1e9, 1e9, f32::NAN] {
            assert_eq!(area(|p| disc(p, [far, 15.0], 9.0, INK)), 0.0);
        }
        assert_eq!(area(|p| line(p, &[[-9.0, -9.0], [-9.0, 90.0]], 2.0, INK)), 0.0);
        for points in [&[][..], &[[7.0, 7.0]], &[[7.0, 7.0], [7.0, 7.0]], &[[f32::NAN; 2], [7.0, 7.0]]] {
            area(|p| line(p, points, 1.0, INK));
            area(|p| dashes(p, points, 1.0, 3.0, INK));
        }
    }

    fn close_to_half(found: f32) {
        let half = 40.5 * std::f32::consts::PI;
        assert!((found - half).abs() < 0.03 * half, "{found}");
    }
}
