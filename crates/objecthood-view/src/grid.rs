//! How large a tile is, and which pixel of the frame each of its pixels shows.

use objecthood::Raster;

/// Longest side of a tile [px]; four tiles make a picture about 4000 px wide.
const MAX_SIDE_PX: usize = 960;
/// What small frames are enlarged to [px], so that ids and titles are legible.
const MIN_SIDE_PX: usize = 320;

/// The size of the tiles of a frame, in pixels: (columns, rows), both at least 1.
///
/// Small frames are enlarged by a whole number, large ones shrunk; those in between keep their pixels.
pub(crate) fn tile_size((width, height): (usize, usize)) -> (usize, usize) {
    let longest = width.max(height).max(1);
    let scaled = |side: usize| {
        if longest > MAX_SIDE_PX {
            (side * MAX_SIDE_PX / longest).max(1)
        } else {
            side.max(1) * MIN_SIDE_PX.div_ceil(longest)
        }
    };
    (scaled(width), scaled(height))
}

/// `raster` at the size of a tile: each pixel shows the frame's pixel under its centre.
pub(crate) fn sample<T: Copy>(raster: &Raster<T>) -> Raster<T> {
    let (width, height) = raster.size();
    let (columns, rows) = tile_size(raster.size());
    let under = |x: usize, from: usize, to: usize| (2 * x + 1) * from / (2 * to);
    let of_column: Vec<usize> = (0..columns).map(|x| under(x, width, columns)).collect();
    let data = (0..rows)
        .map(|y| under(y, height, rows) * width)
        .flat_map(|row| of_column.iter().map(move |u| raster[row + u]))
        .collect();
    Raster::from_vec(columns, rows, data).expect("a tile has at least one pixel and at most MAX_SIDE_PX²")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_are_neither_tiny_nor_huge() {
        assert_eq!(tile_size((640, 480)), (640, 480));
        assert_eq!(tile_size((1, 1)), (320, 320));
        assert_eq!(tile_size((161, 3)), (322, 6));
        assert_eq!(tile_size((1920, 960)), (960, 480));
        assert_eq!(tile_size((8192, 1)), (960, 1));
        assert_eq!(tile_size((1, 8192)), (1, 960));
        for side in 1..3000 {
            let (w, h) = tile_size((side, side.div_ceil(2)));
            assert!((MIN_SIDE_PX..=MAX_SIDE_PX).contains(&w.max(h)), "{side}: {w} x {h}");
        }
    }

    #[test]
    fn an_enlarged_raster_repeats_its_pixels() {
        let small = Raster::from_vec(2, 2, vec![1, 2, 3, 4]).unwrap();
        let large = sample(&small);
        assert_eq!(large.size(), (320, 320));
        for (x, y) in [(0, 0), (159, 159), (160, 0), (319, 159), (0, 160), (159, 319), (160, 160), (319, 319)]
        {
            assert_eq!(large.get(x, y), small.get(x / 160, y / 160), "{x} {y}");
        }
    }

    #[test]
    fn a_shrunk_raster_shows_evenly_spaced_pixels() {
        let (width, height) = (9600, 20);
        let columns = (0..width * height).map(|i| i % width).collect();
        let small = sample(&Raster::from_vec(width, height, columns).unwrap());
        assert_eq!(small.size(), (960, 2));
        assert_eq!(small.as_slice()[..3], [5, 15, 25]);
        assert_eq!(small.get(959, 1), Some(&9595));
    }

    #[test]
    fn a_raster_of_tile_size_is_shown_as_it_is() {
        let raster = Raster::from_vec(640, 7, (0..640 * 7).collect()).unwrap();
        assert_eq!(sample(&raster), raster);
    }
}
