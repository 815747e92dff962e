//! The surfaces on both sides of a place on a border.

use crate::facets::Facets;
use crate::raster::Raster;
use crate::regions::SegmentId;
use crate::simd::vectorized;
use crate::surface::disparity::DisparitySpace;
use crate::surface::model::Model;

/// A side with fewer pixels in the window gives no evidence (px at a focal length of 525 px): they do not fix a plane.
const LEAST_SIDE_PX: usize = 15;
/// Weight of the facet's own slope in the fit of a side (px^2), which replaces the slope of a narrow side.
const RIDGE_PX2: f64 = 1.0;

/// The facets and the disparity around a place on a border.
#[derive(Clone, Copy)]
pub(super) struct Surroundings<'a> {
    pub(super) facets: &'a Facets,
    pub(super) disparity: &'a Raster<f32>,
    pub(super) space: &'a DisparitySpace,
    /// Half size of the window (px).
    pub(super) radius: usize,
}

/// The plane of one side.
pub(super) struct SidePlane {
    /// Disparity at the place (quanta).
    pub(super) value: f64,
    /// Change of disparity along u and v (quanta/px).
    pub(super) slope: [f64; 2],
    /// Mean position of its pixels, relative to the place (px).
    pub(super) mean: [f64; 2],
    /// Mean disparity of its pixels (quanta).
    pub(super) mean_disparity: f64,
}

/// Number and sums of x, y, d, xx, xy, yy, xd and yd of some pixels.
#[derive(Clone, Copy, Default)]
struct SideSums {
    n: usize,
    terms: [f64; 8],
}

/// Windows reach at most so far (px): sums of sums of their rows, 1.4e9, fit into 32 bits.
pub(super) const MOST_RADIUS_PX: usize = 1000;
/// Columns of a window that are summed side by side: their sums stay in registers, even in the narrowest vectors.
const LANES: usize = 8;

/// Number and sums of y, yy, d and yd of each column. Whole numbers of 32 bits take half of the place.
///
/// Rows are added from the last to the first; then sums of sums are moments about the row before the first.
#[derive(Clone, Copy, Default)]
struct Columns {
    n: [i32; LANES],
    y: [i32; LANES],
    yy: [i32; LANES],
    d: [f64; LANES],
    yd: [f64; LANES],
}

impl Columns {
    /// Adds the pixels of a row that belong to the facet: their number, y and yy. `own`: -1, that is all bits, for these and 0 for the others.
    #[inline(always)]
    fn count(&mut self, own: &[i32; LANES]) {
        for (k, own) in own.iter().enumerate() {
            self.n[k] -= own;
            self.y[k] += self.n[k];
            self.yy[k] += self.y[k];
        }
    }

    /// Adds the same pixels: d and yd.
    #[inline(always)]
    fn add(&mut self, own: &[i32; LANES], disparity: &[f32; LANES]) {
        for k in 0..LANES {
            self.d[k] += f64::from(f32::from_bits(disparity[k].to_bits() & own[k] as u32));
            self.yd[k] += self.d[k];
        }
    }
}

impl SideSums {
    /// Adds columns, the first one at x. Their first row lies `above` rows above the place.
    #[inline(always)]
    fn add(&mut self, x: f64, above: usize, Columns { n, y, yy, d, yd }: &Columns) {
        let x: [f64; LANES] = std::array::from_fn(|k| x + k as f64);
        let [n, mut y, mut yy] = [n, y, yy].map(|sums| sums.map(f64::from));
        let (mut yd, first) = (*yd, above as f64 + 1.0);
        for k in 0..LANES {
            y[k] -= first * n[k];
            // Until here a pixel adds (y + first) (y + first + 1) / 2 to yy.
            yy[k] = 2.0 * yy[k] - (2.0 * first + 1.0) * y[k] - first * (first + 1.0) * n[k];
            yd[k] -= first * d[k];
        }
        let times = |a: &[f64; LANES], b: &[f64; LANES]| std::array::from_fn(|k| a[k] * b[k]);
        let xn = times(&x, &n);
        let terms = [&xn, &y, d, &times(&x, &xn), &times(&x, &y), &yy, &times(&x, d), &yd].map(total);
        self.n += total(&n) as usize;
        self.terms.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
    }
}

/// The sum of all values: the halves are added to each other again and again.
#[inline(always)]
fn total(values: &[f64; LANES]) -> f64 {
    let mut sums = *values;
    let mut half = LANES / 2;
    while half > 0 {
        for k in 0..half {
            sums[k] += sums[k + half];
        }
        half /= 2;
    }
    sums[0]
}

/// The first values of a row, padded if the row is shorter.
#[inline(always)]
fn first<T: Copy + Default>(row: &[T]) -> [T; LANES] {
    row.first_chunk().copied().unwrap_or_else(|| {
        let mut padded = [T::default(); LANES];
        padded[..row.len()].copy_from_slice(row);
        padded
    })
}

impl Surroundings<'_> {
    /// Fits a plane to the pixels of each facet around `middle`; `None` when one facet has too few.
    pub(super) fn fit_sides(&self, facets: [SegmentId; 2], middle: [f64; 2]) -> Option<[SidePlane; 2]> {
        let [sums_a, sums_b] = self.sum_sides(facets, middle);
        let [a, b] = facets;
        Some([self.fit_side(a, middle, &sums_a)?, self.fit_side(b, middle, &sums_b)?])
    }

    /// Sums over the pixels of two facets around `middle`, many columns side by side. In windows of up to 80 px to either side
    /// the order of the sums does not matter, because they are exact: positions are whole numbers, and disparities have 24 bits and differ
    /// by less than a factor of 200. In wider ones last digits may be rounded, always in this order: the result is the same everywhere.
    fn sum_sides(&self, facets: [SegmentId; 2], middle: [f64; 2]) -> [SideSums; 2] {
        let (width, height) = self.disparity.size();
        let [u, v] = middle.map(|x| x as usize);
        let rows = v.saturating_sub(self.radius)..(v + self.radius + 1).min(height);
        let end = (u + self.radius + 1).min(width);
        let (labels, disparity) = (self.facets.segments.labels().as_slice(), self.disparity.as_slice());
        let above = v - rows.start;
        let mut sums = [SideSums::default(); 2];
        vectorized(
            #[inline(always)]
            || {
                for start in (u.saturating_sub(self.radius)..end).step_by(LANES) {
                    let inside: [i32; LANES] = std::array::from_fn(|k| -i32::from(start + k < end));
                    for (sums, facet) in sums.iter_mut().zip(facets) {
                        let own = |i: usize| {
                            let labels = first(&labels[i..]);
                            std::array::from_fn(|k| inside[k] & -i32::from(labels[k] == facet.0 as i32))
                        };
                        // May read on into the next row; `inside` excludes those pixels.
                        let rows = || rows.clone().rev().map(|v_row| v_row * width + start);
                        let mut columns = Columns::default();
                        rows().for_each(|i| columns.count(&own(i)));
                        rows().for_each(|i| columns.add(&own(i), &first(&disparity[i..])));
                        sums.add(start as f64 - u as f64, above, &columns);
                    }
                }
            },
        );
        sums
    }

    /// Fits the plane of one side; `None` when it has too few pixels.
    fn fit_side(&self, facet: SegmentId, middle: [f64; 2], sums: &SideSums) -> Option<SidePlane> {
        let &SideSums { n, terms: sums } = sums;
        if n < self.space.area_px(LEAST_SIDE_PX).max(1) {
            return None;
        }
        let [mx, my, md, xx, xy, yy, xd, yd] = sums.map(|sum| sum / n as f64);
        let model: &Model = &self.facets.models[facet.index()];
        let [gx, gy] = model.slope([middle[0] + mx, middle[1] + my]);
        let (xx, xy, yy) = (xx - mx * mx + RIDGE_PX2, xy - mx * my, yy - my * my + RIDGE_PX2);
        let (xd, yd) = (xd - mx * md + RIDGE_PX2 * gx, yd - my * md + RIDGE_PX2 * gy);
        let determinant = xx * yy - xy * xy;
        let slope = [(xd * yy - yd * xy) / determinant, (yd * xx - xd * xy) / determinant];
        let value = md - slope[0] * mx - slope[1] * my;
        Some(SidePlane { value, slope, mean: [mx, my], mean_disparity: md })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::regions::Segments;
    use crate::surface::disparity::position;
    use crate::testing::{kinect, raster};

    proptest! {
        /// Pixel by pixel, term by term.
        #[test]
        fn sums_of_both_sides_are_the_naive_ones(
            (labels, disparity) in (1_usize..20, 1_usize..20)
                .prop_flat_map(|size| (raster(size, -1_i32..3), raster(size, 17.0_f32..3500.0))),
            at in 0_usize..400,
            radius in 0_usize..8,
        ) {
            let space = kinect();
            let facets = Facets { segments: Segments::from_numbered(labels.clone(), 3), models: Vec::new(), structure: 0, flats: vec![] };
            let surroundings = Surroundings { facets: &facets, disparity: &disparity, space: &space, radius };
            let width = labels.width();
            let middle = position(at % labels.len(), width);
            let got = surroundings.sum_sides([SegmentId(0), SegmentId(2)], middle);
            for (label, got) in [0, 2].into_iter().zip(got) {
                let mut expected = SideSums::default();
                for i in (0..labels.len()).filter(|&i| labels[i] == label) {
                    let [x, y] = [0, 1].map(|k| position(i, width)[k] - middle[k]);
                    if x.abs().max(y.abs()) > radius as f64 {
                        continue;
                    }
                    let d = f64::from(disparity[i]);
                    let terms = [x, y, d, x * x, x * y, y * y, x * d, y * d];
                    expected.terms.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
                    expected.n += 1;
                }
                prop_assert_eq!((got.n, got.terms), (expected.n, expected.terms));
            }
        }
    }
}
