//! Bridges small holes in disparity (docs/CONTEXT.md 0.1, ours, because a grid of single holes broke every surface).
//!
//! Depth that is registered to a larger colour image has holes in a regular grid: no measurement falls there. A link of the watershed
//! or the border of a facet would end at each of them.

use crate::raster::Raster;

/// Holes of at most this many pixels in a row or column are bridged.
const WIDEST_PX: usize = 2;
/// Holes form a grid if they are at least this share of the pixels: one pixel in a square of ten by ten.
const LEAST_SHARE: f32 = 0.01;
/// Lines of holes run in all directions if holes that are small along their row or their column are at least
/// this share of the pixels.
const SCATTERED_SHARE: f32 = 0.05;
/// Single holes are filled in this many rounds: in an image that was enlarged to twice its size and turned,
/// some lie between other holes.
const ROUNDS: usize = 3;
/// Both sides of a hole agree when they differ by at most this (quanta): rounding, and a slope of one quantum a pixel.
const AGREE_QUANTA: f32 = 2.0;

/// Fills empty lines of the image, then single holes, then holes between pixels that were filled. Returns the
/// share of the pixels that was filled. O(pixels).
pub(super) fn bridge_holes(disparity: &mut Raster<f32>) -> f32 {
    let mut share = bridge_lines(disparity);
    for _ in 0..ROUNDS {
        match bridge_dots(disparity) {
            0.0 => break,
            bridged => share += bridged,
        }
    }
    share
}

/// Fills rows and columns without any measurement, at most two side by side, with the mean of the values on
/// both sides if these agree. Depth that was mapped forward into a larger image has such lines; a sensor's
/// own holes are never as long as the image. Nothing is filled if that would be less than [`LEAST_SHARE`] of
/// the image. O(pixels).
fn bridge_lines(disparity: &mut Raster<f32>) -> f32 {
    let (width, height) = disparity.size();
    let is_empty_column = |u: usize| (0..height).all(|v| disparity[v * width + u].is_nan());
    let is_empty_row = |v: usize| (0..width).all(|u| disparity[v * width + u].is_nan());
    let empty_columns = find_narrow(width, is_empty_column);
    let empty_rows = find_narrow(height, is_empty_row);
    if empty_columns.is_empty() && empty_rows.is_empty() {
        return 0.0;
    }
    // First across columns; where rows cross them both sides are empty, until the rows are filled too.
    let mut filled = disparity.clone();
    let mut count = 0;
    for v in 0..height {
        for &u in &empty_columns {
            if let Some(value) = between(u, width, |u| disparity[v * width + u]) {
                filled.as_mut_slice()[v * width + u] = value;
                count += 1;
            }
        }
    }
    let columns = filled.clone();
    for v in empty_rows {
        for u in 0..width {
            if let Some(value) = between(v, height, |v| columns[v * width + u]) {
                filled.as_mut_slice()[v * width + u] = value;
                count += 1;
            }
        }
    }
    let share = count as f32 / disparity.len() as f32;
    if share < LEAST_SHARE {
        return 0.0;
    }
    *disparity = filled;
    share
}

/// The empty lines, at most two side by side, that have lines with depth on both sides. Bands and borders
/// have none.
fn find_narrow(lines: usize, is_empty: impl Fn(usize) -> bool) -> Vec<usize> {
    let is_narrow = |&k: &usize| {
        let before = (1..=WIDEST_PX.min(k)).find(|j| !is_empty(k - j));
        let after = (1..=WIDEST_PX.min(lines - 1 - k)).find(|j| !is_empty(k + j));
        before.zip(after).is_some_and(|(before, after)| before + after <= WIDEST_PX + 1)
    };
    (0..lines).filter(|&k| is_empty(k)).filter(is_narrow).collect()
}

/// Fills holes of one or two pixels whose sides agree, by the mean of the values between them.
///
/// A hole has to be small along its row and along its column. A line of missing pixels that ends within the
/// image stays, because it is the border of a thing. So do holes at the border of the image. If such holes
/// are less than [`LEAST_SHARE`] of the image, they are the sensor's own, often at borders, and stay too. But
/// if holes that are small along one of the two directions are a [`SCATTERED_SHARE`], lines of holes are
/// everywhere, as in depth that was mapped forward and turned. Then one direction is enough. Returns the
/// share that was filled. O(pixels).
fn bridge_dots(disparity: &mut Raster<f32>) -> f32 {
    let share = |count: usize| count as f32 / disparity.len() as f32;
    let (mut all, mut dots) = (0, 0);
    visit_holes(disparity, |bridge| {
        all += 1;
        dots += usize::from(bridge.is_dot);
    });
    let is_scattered = share(all) >= SCATTERED_SHARE;
    let built = share(if is_scattered { all } else { dots });
    if built < LEAST_SHARE {
        return 0.0;
    }
    let measured = disparity.clone();
    visit_holes(&measured, |bridge| {
        if bridge.is_dot || is_scattered {
            disparity.as_mut_slice()[bridge.i] = bridge.value;
        }
    });
    built
}

/// Visits the missing pixels that can be filled, with their values, in scan order.
fn visit_holes(measured: &Raster<f32>, mut visit: impl FnMut(Bridge)) {
    let (width, height) = measured.size();
    for (v, row) in measured.as_slice().chunks(width).enumerate() {
        for u in holes(row) {
            let i = v * width + u;
            let along = between(u, width, |u| row[u]);
            let down = between(v, height, |v| measured[v * width + u]);
            match (along, down) {
                (Some(along), Some(down)) => visit(Bridge { i, value: (along + down) / 2.0, is_dot: true }),
                (Some(value), None) | (None, Some(value)) => visit(Bridge { i, value, is_dot: false }),
                (None, None) => (),
            }
        }
    }
}

/// The missing pixels of a row. Stretches without any are passed at once.
fn holes(row: &[f32]) -> impl Iterator<Item = usize> + '_ {
    const STRETCH: usize = 32;
    let has_hole = |stretch: &[f32]| stretch.iter().fold(false, |any, d| any | d.is_nan());
    let stretches =
        (0..).step_by(STRETCH).zip(row.chunks(STRETCH)).filter(move |(_, stretch)| has_hole(stretch));
    stretches.flat_map(|(from, stretch)| (from..).zip(stretch).filter(|(_, d)| d.is_nan()).map(|(u, _)| u))
}

/// A value for a missing pixel.
struct Bridge {
    /// The pixel.
    i: usize,
    /// Disparity (quanta).
    value: f32,
    /// Whether the hole is small along its row and along its column.
    is_dot: bool,
}

/// The value at a place of a line between the nearest measured places on both sides, if the hole is small and they agree.
fn between(place: usize, length: usize, value: impl Fn(usize) -> f32) -> Option<f32> {
    // Most holes are large, and end here: every place of a small hole has a measured place near it on either
    // side.
    let is_measured = |place: usize| place < length && !value(place).is_nan();
    if !is_measured(place.wrapping_sub(1)) && !is_measured(place + 1) {
        return None;
    }
    let before = (1..=WIDEST_PX.min(place)).find(|k| !value(place - k).is_nan())?;
    let after = (1..=WIDEST_PX.min(length - 1 - place)).find(|k| !value(place + k).is_nan())?;
    let [a, b] = [value(place - before), value(place + after)];
    // The slope that the surface has beyond each side, where the next place is measured.
    let behind = (place > before).then(|| a - value(place - before - 1)).filter(|slope| !slope.is_nan());
    let ahead =
        (place + after + 1 < length).then(|| value(place + after + 1) - b).filter(|slope| !slope.is_nan());
    let slope = match (behind, ahead) {
        (Some(behind), Some(ahead)) => (behind + ahead) / 2.0,
        (one, other) => one.or(other).unwrap_or(0.0),
    };
    let rise = (before + after) as f32 * slope;
    let agrees = (b - a).abs() <= AGREE_QUANTA || (b - a - rise).abs() <= AGREE_QUANTA;
    let is_bridge = before + after <= WIDEST_PX + 1 && agrees;
    is_bridge.then(|| a + (b - a) * before as f32 / (before + after) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The image after its holes (`NaN`) are bridged.
    fn bridged<const W: usize>(rows: &[[f32; W]]) -> Vec<f32> {
        let mut raster = Raster::from_vec(W, rows.len(), rows.as_flattened().to_vec()).unwrap();
        bridge_holes(&mut raster);
        raster.as_slice().to_vec()
    }

    const X: f32 = f32::NAN;

    #[test]
    fn small_holes_between_sides_that_agree_are_bridged() {
        assert_eq!(bridged(&[[1.0, 2.0, 3.0], [1.0, X, 3.0], [1.0, 3.0, 3.0]])[4], 2.25);
        let two = bridged(&[[5.0; 4], [5.0, X, X, 6.5], [5.0, X, X, 6.5], [5.0, 5.0, 5.0, 6.5]]);
        assert_eq!([5, 6].map(|i| two[i]), [5.25, 5.5]);
    }

    /// A regression: holes in what is near, steep or seen at a short focal length stayed.
    #[test]
    fn holes_of_a_steep_surface_are_bridged_and_its_steps_are_not() {
        let slope = 3.0;
        let seen = |step: f32| {
            let value = |i: usize| slope * (i % 40) as f32 + if i % 40 > 20 { step } else { 0.0 };
            let is_hole = |i: usize| i % 40 % 5 == 1 && i / 40 % 5 == 2;
            let seen = |i: usize| if is_hole(i) { X } else { value(i) };
            let mut raster = Raster::from_vec(40, 40, (0..1600).map(seen).collect()).unwrap();
            bridge_holes(&mut raster);
            let left: Vec<usize> = (0..1600).filter(|&i| raster[i].is_nan()).map(|i| i % 40).collect();
            let is_true = |&i: &usize| raster[i].is_nan() || (raster[i] - value(i)).abs() < 0.5;
            assert_eq!((0..1600).find(|i| !is_true(i)), None);
            left
        };
        assert_eq!(seen(0.0), []);
        assert_eq!(seen(8.0), [21; 8]);
    }

    #[test]
    fn lines_steps_and_wide_holes_stay() {
        let left = |value: fn(usize) -> f32, holes: &[[usize; 2]]| {
            let seen = |i: usize| if holes.contains(&[i % 10, i / 10]) { X } else { value(i % 10) };
            let mut raster = Raster::from_vec(10, 10, (0..100).map(seen).collect()).unwrap();
            bridge_holes(&mut raster);
            raster.as_slice().iter().filter(|d| d.is_nan()).count()
        };
        let mut few = Raster::filled(20, 20, 5.0).unwrap();
        few.as_mut_slice()[210] = X;
        assert_eq!(bridge_holes(&mut few), 0.0, "the sensor's own hole");
        let level = |_| 5.0;
        assert_eq!(left(level, &[[2, 2]]), 0);
        assert_eq!(left(level, &[[2, 1], [2, 2], [2, 3], [2, 4]]), 4, "a line");
        assert_eq!(left(|u| if u > 2 { 9.0 } else { 5.0 }, &[[2, 1]]), 1, "a step");
        assert_eq!(left(level, &[[1, 1], [2, 1], [3, 1]]), 3, "too wide");
        assert_eq!(left(level, &[[0, 5], [9, 5], [4, 0]]), 3, "at the border");
    }

    /// Depth that was mapped forward, turned a little: lines of holes that go on in the next column after some rows.
    #[test]
    fn lines_that_are_everywhere_are_bridged() {
        let value = |i: usize| 5.0 + 0.1 * (i % 40) as f32;
        let seen = |i: usize| if i % 40 % 3 == i / 40 / 7 % 3 { X } else { value(i) };
        let mut raster = Raster::from_vec(40, 40, (0..1600).map(seen).collect()).unwrap();
        assert!(bridge_holes(&mut raster) > 0.3);
        for i in 0..1600 {
            let is_at_border = [0, 39].contains(&(i % 40));
            assert!(is_at_border || (raster[i] - value(i)).abs() < 0.2, "{i}: {}", raster[i]);
        }
    }

    #[test]
    fn rows_and_columns_without_any_measurement_are_bridged() {
        // Depth mapped forward into an image 1.5 times as large: a table, and a box on it.
        let value = |u: usize, v: usize| if u > 20 && v > 20 { 60.0 } else { 5.0 + 0.1 * v as f32 };
        let is_empty = |k: usize| k % 3 == 2;
        let seen = |i: usize| {
            let [u, v] = [i % 40, i / 40];
            if is_empty(u) || is_empty(v) { X } else { value(u, v) }
        };
        let mut raster = Raster::from_vec(40, 40, (0..1600).map(seen).collect()).unwrap();
        let share = bridge_holes(&mut raster);
        assert!(share > 0.4, "{share}");
        for i in 0..1600 {
            let [u, v] = [i % 40, i / 40];
            // The line between the table and the box stays.
            if u != 20 && v != 20 {
                assert!((raster[i] - value(u, v)).abs() < 0.01, "{u} {v}: {}", raster[i]);
            }
        }
        assert!(raster[30 * 40 + 20].is_nan(), "a step");
    }
}
