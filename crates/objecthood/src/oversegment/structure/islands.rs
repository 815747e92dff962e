//! Islands: pixels that lie on a surface of the structure by chance, such as the tops of boxes that are as
//! high as a cupboard (docs/CONTEXT.md 1.1.3).
//!
//! A surface may go on behind what is in front of it. It ends in two cases: where something farther is seen,
//! and where it would leave the room. The room ends at its bounds, the floors and walls behind which nothing
//! is seen. An island is a piece of a surface that no path through the image joins to the rest of the surface
//! without crossing such an end.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::size::SurfaceSize;
use super::stretches::{STRETCH, Stretches, range_in_row};
use super::surface::StructureSurface;
use crate::raster::Raster;
use crate::regions::{Segments, connect, run_length, runs};
use crate::simd::vectorized;
use crate::surface::disparity::{DisparitySpace, position};

/// A smaller island (px at 525 px) stays with its surface: it has less than half the pixels of a thing in the
/// choice of the ground, and may be a strip of a wall behind a desk.
const LEAST_PX: usize = 120;
/// A surface bounds the room if at most this share of the pixels that are looked at lies behind it: so many are outliers.
const BEHIND_SHARE: f64 = 0.01;
/// Least cosine of the angle (30 degrees) between the normals of two surfaces that do not cross in sight.
const PARALLEL: f64 = 0.87;
/// Rows and columns are sampled at this distance for that.
const GRID_PX: usize = 4;

/// The surface is seen, or may go on behind what is seen.
const GOES_ON: i32 = 0;
/// Something behind the surface is seen. Runs leave it out.
const ENDS: i32 = -1;
/// Nothing is measured.
const UNSEEN: i32 = -2;

/// Removes the labels of islands. An island stays if it is tiny, or if it is as large as the board of a shelf
/// and so another board of the same height. O(surfaces · pixels); parallel over surfaces.
pub(super) fn free_islands(
    labels: &mut Raster<i32>,
    surfaces: &[StructureSurface],
    disparity: &Raster<f32>,
    stretches: &Stretches,
    space: &DisparitySpace,
    tolerance_quanta: f64,
) {
    let least_px = space.area_px(LEAST_PX);
    let bounds_room = |surface: &&StructureSurface| surface.bounds_room(disparity, tolerance_quanta);
    let bounds: Vec<&StructureSurface> = surfaces.iter().filter(bounds_room).collect();
    let of = |(s, surface): (usize, &StructureSurface)| {
        let others =
            find_lesser_pieces(surface, s as i32, &bounds, labels, disparity, stretches, tolerance_quanta);
        let is_island =
            |pixels: &Vec<usize>| pixels.len() >= least_px && !surface.is_board(pixels, disparity, space);
        let islands = others.into_iter().filter(is_island);
        islands.flatten().collect()
    };
    let islands: Vec<Vec<usize>> = surfaces.par_iter().enumerate().map(of).collect();
    islands.into_iter().flatten().for_each(|i| labels.as_mut_slice()[i] = Segments::NONE);
}

/// Divides the image into the pieces in which a surface may go on. Returns the pixels with the label of the
/// surface, piece by piece, without the piece that has most of them. O(pixels · log(pixels)).
fn find_lesser_pieces(
    surface: &StructureSurface,
    label: i32,
    bounds: &[&StructureSurface],
    labels: &Raster<i32>,
    disparity: &Raster<f32>,
    stretches: &Stretches,
    tolerance_quanta: f64,
) -> Vec<Vec<usize>> {
    let width = labels.width();
    // A parallel surface does not cross it within sight.
    let crosses = |bound: &&&StructureSurface| bound.normal.dot(surface.normal).abs() < PARALLEL;
    let bounds: Vec<&StructureSurface> = bounds.iter().filter(crosses).copied().collect();
    let mut seen = labels.map(|_| ENDS);
    let rows = seen.as_mut_slice().chunks_mut(width).zip(disparity.as_slice().chunks(width));
    for (v, (seen, disparity)) in rows.enumerate() {
        let pixels = seen.chunks_mut(STRETCH).zip(disparity.chunks(STRETCH));
        vectorized(
            #[inline(always)]
            || {
                for ((u, range), (seen, disparity)) in stretches.of_row(v).zip(pixels) {
                    surface.mark_where_it_goes_on(seen, disparity, range, [u, v], tolerance_quanta);
                    for bound in &bounds {
                        surface.mark_ends(seen, bound, [u, v], tolerance_quanta);
                    }
                }
            },
        );
        fill_unseen(seen);
    }
    let runs: Vec<(Range<usize>, usize)> = runs(&seen, 0..labels.height()).collect();
    let (piece_of, count) = connect(&runs, width);
    let own = |run: &Range<usize>| labels.as_slice()[run.clone()].iter().filter(|&&l| l == label).count();
    let mut sizes = vec![0; count];
    runs.iter().zip(&piece_of).for_each(|((run, _), &piece)| sizes[piece as usize] += own(run));
    // On ties the first.
    let largest = (0..count).rev().max_by_key(|&piece| sizes[piece]);
    let mut pieces = vec![Vec::new(); count];
    for ((run, _), piece) in runs.into_iter().zip(piece_of) {
        let piece = piece as usize;
        if Some(piece) != largest && sizes[piece] > 0 {
            pieces[piece].extend(run.filter(|&i| labels[i] == label));
        }
    }
    pieces.retain(|pixels| !pixels.is_empty());
    pieces
}

/// A surface goes on through a hole in a row unless it ends on either side of the hole: shadows lie between a thing and what is behind it.
fn fill_unseen(row: &mut [i32]) {
    let mut end = 0;
    while let Some(start) = next_unseen(row, end) {
        end = start + run_length(&row[start..]);
        let beside = [start.checked_sub(1), Some(end)];
        let ends = beside.into_iter().flatten().any(|k| row.get(k) == Some(&ENDS));
        row[start..end].fill(if ends { ENDS } else { GOES_ON });
    }
}

/// The first unseen place of a row from one on. Seen ones are passed in strides.
fn next_unseen(row: &[i32], from: usize) -> Option<usize> {
    const STRIDE_PX: usize = 16;
    let is_seen = |stride: &&[i32]| stride.iter().fold(0, |any, seen| any | i32::from(*seen == UNSEEN)) == 0;
    let passed = from + STRIDE_PX * row[from..].chunks_exact(STRIDE_PX).take_while(is_seen).count();
    row[passed..].iter().position(|&seen| seen == UNSEEN).map(|k| passed + k)
}

impl StructureSurface {
    /// Marks where this surface is seen or may go on, in a stretch from the pixel (u, v) on. `least` and `greatest`: its disparities.
    #[inline(always)]
    fn mark_where_it_goes_on(
        &self,
        seen: &mut [i32],
        disparity: &[f32],
        [least, greatest]: [f64; 2],
        [u, v]: [usize; 2],
        tolerance_quanta: f64,
    ) {
        let limit = self.scale * tolerance_quanta;
        let value = |u: f64| self.model.value([u, v as f64]);
        let [low, high] = range_in_row(value, self.model.bend_in_rows(), u, seen.len());
        if high - least <= limit || low - greatest > limit {
            let all = if low - greatest > limit { ENDS } else { GOES_ON };
            seen.iter_mut()
                .zip(disparity)
                .for_each(|(seen, d)| *seen = if d.is_nan() { UNSEEN } else { all });
            return;
        }
        for (u, (seen, d)) in (u as i32..).zip(seen.iter_mut().zip(disparity)) {
            let measured = if value(u.into()) - f64::from(*d) <= limit { GOES_ON } else { ENDS };
            *seen = if d.is_nan() { UNSEEN } else { measured };
        }
    }

    /// Marks the end where this surface would leave the room, in a stretch from the pixel (u, v) on.
    #[inline(always)]
    fn mark_ends(&self, seen: &mut [i32], bound: &Self, [u, v]: [usize; 2], tolerance_quanta: f64) {
        // Where the two meet, both are seen, and there a way would lead along the fold.
        let limit = -(bound.scale + self.scale) * tolerance_quanta;
        let behind = |u: f64| bound.model.value([u, v as f64]) - self.model.value([u, v as f64]);
        let bend = bound.model.bend_in_rows() + self.model.bend_in_rows();
        let [low, high] = range_in_row(behind, bend, u, seen.len());
        if low > limit {
            seen.fill(ENDS);
        } else if high > limit {
            for (u, seen) in (u as i32..).zip(seen) {
                *seen = if behind(u.into()) > limit { ENDS } else { *seen };
            }
        }
    }

    /// Whether nothing is seen behind it, as behind a floor or a wall without a window.
    fn bounds_room(&self, disparity: &Raster<f32>, tolerance_quanta: f64) -> bool {
        let (width, height) = disparity.size();
        let places =
            (0..height).step_by(GRID_PX).flat_map(|v| (0..width).step_by(GRID_PX).map(move |u| (u, v)));
        let (mut behind, mut measured) = (0, 0);
        for (u, v) in places {
            let d = f64::from(disparity[v * width + u]);
            measured += usize::from(!d.is_nan());
            behind +=
                usize::from(self.model.value([u as f64, v as f64]) - d > 2.0 * self.scale * tolerance_quanta);
        }
        behind as f64 <= BEHIND_SHARE * measured as f64
    }

    /// Whether these of its pixels are as large as the board of a shelf.
    fn is_board(&self, pixels: &[usize], disparity: &Raster<f32>, space: &DisparitySpace) -> bool {
        let point_m =
            |&i: &usize| DVec3::from(space.point_m(position(i, disparity.width()), disparity[i].into()));
        let points_m: Vec<DVec3> = pixels.iter().map(point_m).collect();
        SurfaceSize::measure(&points_m, self.normal, 1, &space.camera()).is_board()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::surface::model::Basis;
    use crate::surface::moments::Moments;

    /// A surface with this disparity (quanta) at column `u` of row 0.
    fn surface([c, cx, cxx]: [f64; 3]) -> StructureSurface {
        let mut moments = Moments::about([0.0; 2]);
        for [u, v] in [[0.0, 0.0], [50.0, 0.0], [100.0, 0.0], [0.0, 9.0], [50.0, 9.0], [0.0, 18.0]] {
            moments.add([u, v], c + cx * u + cxx * u * u);
        }
        let model = moments.fit(Basis::Quadratic).model;
        StructureSurface { model, normal: [0.0, 0.0, -1.0].into(), offset_m: 1.0, scale: 1.0 }
    }

    proptest! {
        /// Pixel by pixel.
        #[test]
        fn stretches_are_marked_as_their_pixels_would_be(
            coefficients in prop::array::uniform2((90.0_f64..110.0, -0.2_f64..0.2, -0.002_f64..0.002)),
            // Around the surface, wholly before it or behind it, or unmeasured.
            (middle, spread) in prop::sample::select(vec![(100.0_f32, 20.0_f32), (400.0, 5.0), (20.0, 5.0), (f32::NAN, 1.0)]),
            noise in prop::collection::vec((-1.0_f32..1.0, 0.0..1.0_f32), 1..=STRETCH),
            first in 0_usize..100,
        ) {
            let [own, bound] = coefficients.map(|(c, cx, cxx)| surface([c, cx, cxx]));
            let disparity: Vec<f32> = noise
                .iter()
                .map(|(off, hole)| if *hole < 0.1 { f32::NAN } else { middle + spread * off })
                .collect();
            let measured = || disparity.iter().copied().filter(|d| !d.is_nan()).map(f64::from);
            let range = [measured().fold(f64::INFINITY, f64::min), measured().fold(f64::NEG_INFINITY, f64::max)];
            let mut seen = vec![ENDS; disparity.len()];
            own.mark_where_it_goes_on(&mut seen, &disparity, range, [first, 3], 2.0);
            let value = |s: &StructureSurface, k: usize| s.model.value([(first + k) as f64, 3.0]);
            for (k, d) in disparity.iter().enumerate() {
                let goes_on = value(&own, k) - f64::from(*d) <= 2.0;
                let expected = if d.is_nan() { UNSEEN } else if goes_on { GOES_ON } else { ENDS };
                prop_assert_eq!(seen[k], expected);
            }
            let before = seen.clone();
            own.mark_ends(&mut seen, &bound, [first, 3], 2.0);
            for (k, before) in before.into_iter().enumerate() {
                let leaves = value(&bound, k) - value(&own, k) > -4.0;
                prop_assert_eq!(seen[k], if leaves { ENDS } else { before });
            }
        }
    }
}
