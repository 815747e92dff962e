//! Gaussian smoothing of the colour image (paper, III-A).

use std::ops::Range;

use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::params;
use crate::raster::Raster;
use crate::simd::vectorized;

/// Rows and columns of a tile (px).
const TILE_PX: usize = 64;

/// Smooths the colour image by a separable Gaussian: red, green and blue in grey levels 0..255, not rounded.
///
/// Pixels with depth and pixels without are smoothed separately, with the weights normalised over the pixels of one kind in the
/// window (normalised convolution, Knutsson and Westin 1993). So the colour of unmeasured pixels does not bleed into measured
/// ones. The kernel reaches 4σ, rounded up (5 taps at the default); the image is mirrored at its border without repeating the edge
/// pixel. If all pixels of a tile are of one kind, the other kind costs nothing. O(pixels · taps); parallel over bands of rows.
pub fn smooth(
    color: &Raster<[u8; 3]>,
    depth_m: &Raster<f32>,
    params: &params::Smoothing,
) -> [Raster<f32>; 3] {
    let kernel = kernel(params.sigma_px);
    let image = Image { color, depth_m, kernel: &kernel };
    let (width, height) = color.size();
    // Every pixel is of one of the two kinds, so every value is written.
    let mut smoothed = [(); 3].map(|()| Buffer::stale(color.len(), 0.0));
    let bands = smoothed.each_mut().map(|plane| plane.par_chunks_mut(TILE_PX * width));
    let [red, green, blue] = bands;
    red.zip(green).zip(blue).enumerate().for_each(|(band, ((red, green), blue))| {
        let rows = band * TILE_PX..height.min((band + 1) * TILE_PX);
        let mut tile = Tile::new(kernel.len() - 1);
        let mut smoothed = [red, green, blue];
        for left in (0..width).step_by(TILE_PX) {
            let place = (left..width.min(left + TILE_PX), rows.clone());
            vectorized(
                #[inline(always)]
                || {
                    for measured in [true, false] {
                        tile.smooth(&image, measured, place.clone(), &mut smoothed);
                    }
                },
            );
        }
    });
    smoothed.map(|plane| color.with_data(plane))
}

/// The image to be smoothed, and the kernel.
struct Image<'a> {
    color: &'a Raster<[u8; 3]>,
    depth_m: &'a Raster<f32>,
    /// The right half of the kernel, the middle tap first.
    kernel: &'a [f32],
}

impl Image<'_> {
    /// Counts the pixels of the other kind than `measured`.
    #[inline(always)]
    fn count_others(&self, measured: bool, rows: Range<usize>, columns: &Range<usize>) -> usize {
        let width = self.depth_m.width();
        let row = |v: usize| &self.depth_m.as_slice()[v * width..][columns.clone()];
        rows.map(|v| row(v).iter().filter(|z| z.is_nan() == measured).count()).sum()
    }
}

/// Red, green, blue and one (the weight of the pixel), a row each.
type Planes = [[f32; TILE_PX]; 4];

/// The working memory of one tile.
struct Tile {
    reach: usize,
    /// The columns of the tile and its surroundings, mirrored into the image.
    columns: Vec<usize>,
    /// Places in `columns` of the columns that are not mirrored.
    inside: Range<usize>,
    /// One row of the image and its surroundings; zero where pixels are of the other kind.
    source: [Vec<f32>; 4],
    /// Number of planes that are smoothed: 4, or 3 when no pixel of the other kind is near and the sum of the weights is known.
    planes: usize,
    /// The rows around the present one, smoothed horizontally; row v is at place v modulo their number.
    along: Vec<Planes>,
}

impl Tile {
    fn new(reach: usize) -> Self {
        Self {
            reach,
            columns: vec![0; TILE_PX + 2 * reach],
            inside: 0..0,
            source: [(); 4].map(|()| vec![0.0; TILE_PX + 2 * reach]),
            planes: 4,
            along: vec![[[0.0; TILE_PX]; 4]; 2 * reach + 1],
        }
    }

    /// Smooths the measured or the unmeasured pixels of the tile, and writes them to `smoothed`, the rows of the band.
    #[inline(always)]
    fn smooth(
        &mut self,
        image: &Image<'_>,
        measured: bool,
        (columns, rows): (Range<usize>, Range<usize>),
        smoothed: &mut [&mut [f32]; 3],
    ) {
        if image.count_others(measured, rows.clone(), &columns) == rows.len() * columns.len() {
            return;
        }
        let (width, height) = image.color.size();
        let near = |range: &Range<usize>, size: usize| {
            range.start.saturating_sub(self.reach)..size.min(range.end + self.reach)
        };
        let is_alone = image.count_others(measured, near(&rows, height), &near(&columns, width)) == 0;
        self.planes = if is_alone { 3 } else { 4 };
        self.move_to(&columns, width);
        let reach = self.reach as isize;
        let one = filtered_alike(image.kernel, filtered_alike(image.kernel, 1.0));
        let mut sums = [[one; TILE_PX]; 4];
        for v in rows.start as isize - reach..rows.end as isize + reach {
            self.smooth_along(image, measured, v);
            // The row whose neighbouring rows are now complete.
            let v = v - reach;
            if v >= rows.start as isize {
                self.smooth_down(image.kernel, v, &mut sums);
                let pixels = v as usize * width + columns.start..v as usize * width + columns.end;
                let place = pixels.start - rows.start * width..pixels.end - rows.start * width;
                let depths = &image.depth_m.as_slice()[pixels];
                let others = (!is_alone).then_some((depths, measured));
                normalise(&sums, others, smoothed.each_mut().map(|plane| &mut plane[place.clone()]));
            }
        }
    }

    /// Finds the image columns of the tile and its surroundings.
    #[inline(always)]
    fn move_to(&mut self, columns: &Range<usize>, width: usize) {
        let left = columns.start as isize - self.reach as isize;
        for (u, at) in (left..).zip(&mut self.columns) {
            *at = mirror(u, width);
        }
        let at = |u: usize| (u as isize - left).clamp(0, self.columns.len() as isize) as usize;
        self.inside = at(0)..at(width);
    }

    /// Smooths row `v` horizontally; beyond the image it is mirrored.
    #[inline(always)]
    fn smooth_along(&mut self, image: &Image<'_>, measured: bool, v: isize) {
        let (width, height) = image.color.size();
        let row = mirror(v, height) * width;
        let place = v.rem_euclid(self.along.len() as isize) as usize;
        let [r, g, b, one] = &mut self.source;
        let mut read = |places: Range<usize>, first: usize| {
            let pixels = row + first..row + first + places.len();
            let (colors, depths) =
                (&image.color.as_slice()[pixels.clone()], &image.depth_m.as_slice()[pixels]);
            let source = r[places.clone()].iter_mut().zip(&mut g[places.clone()]);
            let source = source.zip(b[places.clone()].iter_mut().zip(&mut one[places]));
            for (((r, g), (b, one)), ([red, green, blue], z)) in source.zip(colors.iter().zip(depths)) {
                *one = if z.is_nan() == measured { 0.0 } else { 1.0 };
                (*r, *g, *b) = (*one * f32::from(*red), *one * f32::from(*green), *one * f32::from(*blue));
            }
        };
        // The columns that are not mirrored lie side by side.
        let (columns, inside) = (&self.columns, self.inside.clone());
        read(inside.clone(), columns[inside.start]);
        for place in (0..inside.start).chain(inside.end..columns.len()) {
            read(place..place + 1, columns[place]);
        }
        let reach = self.reach;
        for (sums, source) in self.along[place][..self.planes].iter_mut().zip(&self.source) {
            filter(sums, image.kernel, |t| (&source[reach - t..], &source[reach + t..]));
        }
    }

    /// Smooths row `v` vertically, over the rows around it.
    #[inline(always)]
    fn smooth_down(&self, kernel: &[f32], v: isize, sums: &mut Planes) {
        let at = |t: isize| &self.along[(v + t).rem_euclid(self.along.len() as isize) as usize];
        for (c, sums) in sums[..self.planes].iter_mut().enumerate() {
            filter(sums, kernel, |t| (&at(-(t as isize))[c], &at(t as isize)[c]));
        }
    }
}

/// Divides the sums of colours by the sums of weights and writes the results to a row of the tile. `others`: the depths of the row
/// and the kind that is written, if pixels of the other kind have to stay as they are.
#[inline(always)]
fn normalise(sums: &Planes, others: Option<(&[f32], bool)>, smoothed: [&mut [f32]; 3]) {
    let [colors @ .., one] = sums;
    for (smoothed, sums) in smoothed.into_iter().zip(colors) {
        let sums = sums.iter().zip(one);
        match others {
            None => smoothed.iter_mut().zip(sums).for_each(|(smoothed, (sum, one))| *smoothed = sum / one),
            Some((depths, measured)) => {
                for ((smoothed, z), (sum, one)) in smoothed.iter_mut().zip(depths).zip(sums) {
                    *smoothed = if z.is_nan() == measured { *smoothed } else { sum / one };
                }
            }
        }
    }
}

/// Sums the middle value and the pairs of values at each distance from it, weighted by the taps.
#[inline(always)]
fn filter<'a>(sums: &mut [f32; TILE_PX], kernel: &[f32], pair: impl Fn(usize) -> (&'a [f32], &'a [f32])) {
    for (sum, middle) in sums.iter_mut().zip(pair(0).0) {
        *sum = kernel[0] * middle;
    }
    for (t, &weight) in kernel.iter().enumerate().skip(1) {
        let (before, after) = pair(t);
        for (sum, (before, after)) in sums.iter_mut().zip(before.iter().zip(after)) {
            *sum += weight * (before + after);
        }
    }
}

/// The result of [`filter`] for equal values.
fn filtered_alike(kernel: &[f32], value: f32) -> f32 {
    kernel[1..].iter().fold(kernel[0] * value, |sum, weight| sum + weight * (value + value))
}

/// The right half of the kernel, the middle tap first.
fn kernel(sigma_px: f64) -> Vec<f32> {
    let reach = (4.0 * sigma_px).ceil() as usize;
    let tap =
        |t: usize| if t == 0 { 1.0 } else { libm::exp(-((t * t) as f64) / (2.0 * sigma_px * sigma_px)) };
    let taps: Vec<f64> = (0..=reach).map(tap).collect();
    let sum = 2.0 * taps.iter().sum::<f64>() - taps[0];
    taps.iter().map(|t| (t / sum) as f32).collect()
}

/// The index `i`; outside 0..n, mirrored at the first and the last pixel.
fn mirror(i: isize, n: usize) -> usize {
    let period = (2 * n as isize - 2).max(1);
    let i = i.rem_euclid(period) as usize;
    if i < n { i } else { period as usize - i }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_flat_image_stays_and_a_dot_becomes_the_kernel() {
        let flat = Raster::filled(3, 2, [10, 20, 30]).unwrap();
        let smooth_flat = smooth(&flat, &Raster::filled(3, 2, 1.0).unwrap(), &params::Smoothing::default());
        for (plane, grey) in smooth_flat.iter().zip([10.0, 20.0, 30.0]) {
            assert!(plane.as_slice().iter().all(|c| (c - grey).abs() < 1e-4), "{plane:?}");
        }
        let mut dot = Raster::filled(9, 9, [0; 3]).unwrap();
        dot.as_mut_slice()[40] = [255, 0, 0];
        let smoothed = smooth(&dot, &Raster::filled(9, 9, 1.0).unwrap(), &params::Smoothing::default());
        let k: Vec<f64> = (-2..=2).map(|t: i32| (-f64::from(t * t) / 0.5).exp()).collect();
        let sum: f64 = k.iter().sum();
        for dv in 0..5 {
            for du in 0..5 {
                let expected = 255.0 * k[du] * k[dv] / sum / sum;
                let got = f64::from(smoothed[0][(2 + dv) * 9 + 2 + du]);
                assert!((got - expected).abs() < 1e-3, "{got} {expected}");
            }
        }
    }

    #[test]
    fn the_border_is_mirrored_without_repeating_the_edge() {
        assert_eq!([-2, -1, 0, 3, 4, 5].map(|i| mirror(i, 4)), [2, 1, 0, 3, 2, 1]);
        assert_eq!([-3, 0, 2].map(|i| mirror(i, 1)), [0, 0, 0]);
    }

    /// The place reached after walking `steps` from `start`, turning round at the first and last of `n` places.
    fn walk(start: usize, steps: i32, n: usize) -> usize {
        let (mut at, mut direction) = (start as i32, steps.signum());
        for _ in 0..steps.abs() {
            if n > 1 && !(0..n as i32).contains(&(at + direction)) {
                direction = -direction;
            }
            at += if n > 1 { direction } else { 0 };
        }
        at as usize
    }

    proptest! {
        #[test]
        fn a_pixel_of_the_other_kind_changes_no_bit_beyond_its_reach(
            colors in prop::collection::vec(any::<[u8; 3]>(), 80 * 7),
            lost in 0_usize..80 * 7,
        ) {
            let color = Raster::from_vec(80, 7, colors).unwrap();
            let mut depth = color.map(|_| 1.0);
            let whole = smooth(&color, &depth, &params::Smoothing::default());
            depth.as_mut_slice()[lost] = f32::NAN;
            let holed = smooth(&color, &depth, &params::Smoothing::default());
            let is_far = |i: &usize| (i % 80).abs_diff(lost % 80) > 2 || (i / 80).abs_diff(lost / 80) > 2;
            for (whole, holed) in whole.iter().zip(&holed) {
                for i in (0..color.len()).filter(is_far) {
                    prop_assert_eq!(whole[i].to_bits(), holed[i].to_bits());
                }
            }
        }

        #[test]
        fn equals_the_naive_mean_over_neighbours_of_the_same_kind(
            (width, pixels) in (1_usize..9, 1_usize..9).prop_flat_map(|(w, h)| {
                (Just(w), prop::collection::vec((any::<[u8; 3]>(), 0_u8..3), w * h))
            }),
            sigma_px in 0.1_f64..1.5,
        ) {
            let height = pixels.len() / width;
            let color = Raster::from_vec(width, height, pixels.iter().map(|p| p.0).collect()).unwrap();
            let depth = color.with_data(pixels.iter().map(|p| if p.1 == 0 { f32::NAN } else { 1.0 }).collect());
            let smoothed = smooth(&color, &depth, &params::Smoothing { sigma_px });
            let reach = (4.0 * sigma_px).ceil() as i32;
            for i in 0..color.len() {
                let (mut sum, mut weights) = ([0.0; 3], 0.0);
                for (dv, du) in (-reach..=reach).flat_map(|dv| (-reach..=reach).map(move |du| (dv, du))) {
                    let q = walk(i / width, dv, height) * width + walk(i % width, du, width);
                    if depth[q].is_nan() == depth[i].is_nan() {
                        let weight = (-f64::from(du * du + dv * dv) / (2.0 * sigma_px * sigma_px)).exp();
                        (0..3).for_each(|c| sum[c] += weight * f64::from(color[q][c]));
                        weights += weight;
                    }
                }
                for (got, sum) in smoothed.each_ref().map(|plane| plane[i]).into_iter().zip(sum) {
                    prop_assert!((f64::from(got) - sum / weights).abs() < 1e-3, "{} {}", got, sum / weights);
                }
            }
        }
    }
}
