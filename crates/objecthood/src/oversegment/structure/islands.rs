//! Islands: what lies on a surface of the structure by chance, as the tops of boxes that are as high as a cupboard (docs/CONTEXT.md 1.1).
//!
//! A surface may go on behind what is in front of it. It ends where something farther is seen. So an island is what no way through the image
//! joins to the rest of its surface without showing something behind it.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::size::SurfaceSize;
use super::surface::StructureSurface;
use crate::raster::Raster;
use crate::regions::{Segments, connect, runs};
use crate::surface::disparity::{DisparitySpace, position};

/// The surface is seen, or may go on behind what is seen.
const GOES_ON: i32 = 0;
/// Something behind the surface is seen. Runs leave it out.
const ENDS: i32 = -1;
/// Nothing is measured.
const UNSEEN: i32 = -2;

/// Takes the labels of islands away, unless one is as large as the board of a shelf: that is another board of the same height.
/// O(surfaces · pixels); parallel over surfaces.
pub(super) fn free_islands(
    labels: &mut Raster<i32>,
    surfaces: &[StructureSurface],
    disparity: &Raster<f32>,
    space: &DisparitySpace,
    tolerance_quanta: f64,
) {
    let of = |(s, surface): (usize, &StructureSurface)| {
        let pieces = find_pieces(surface, s as i32, labels, disparity, surface.scale * tolerance_quanta);
        // On ties the first.
        let largest = (0..pieces.len()).rev().max_by_key(|&piece| pieces[piece].len());
        let others = pieces.into_iter().enumerate().filter(|(piece, _)| Some(*piece) != largest);
        let islands = others
            .map(|(_, pixels)| pixels)
            .filter(|pixels| !surface.is_board(pixels, labels.width(), space));
        islands.flatten().collect()
    };
    let islands: Vec<Vec<usize>> = surfaces.par_iter().enumerate().map(of).collect();
    islands.into_iter().flatten().for_each(|i| labels.as_mut_slice()[i] = Segments::NONE);
}

/// The pixels with the label of a surface, by the pieces of the image in which it may go on. O(pixels).
fn find_pieces(
    surface: &StructureSurface,
    label: i32,
    labels: &Raster<i32>,
    disparity: &Raster<f32>,
    tolerance_quanta: f64,
) -> Vec<Vec<usize>> {
    let width = labels.width();
    let goes_on = |(i, &d): (usize, &f32)| {
        let behind = surface.model.value(position(i, width)) - f64::from(d);
        if d.is_nan() {
            UNSEEN
        } else if behind <= tolerance_quanta {
            GOES_ON
        } else {
            ENDS
        }
    };
    let mut seen = labels.with_data(disparity.as_slice().iter().enumerate().map(goes_on).collect());
    seen.as_mut_slice().chunks_mut(width).for_each(fill_unseen);
    let runs: Vec<(Range<usize>, usize)> = runs(&seen, 0..labels.height()).collect();
    let (piece_of, count) = connect(&runs, width);
    let mut pieces = vec![Vec::new(); count];
    for ((run, _), piece) in runs.into_iter().zip(piece_of) {
        pieces[piece as usize].extend(run.filter(|&i| labels[i] == label));
    }
    pieces.retain(|pixels| !pixels.is_empty());
    pieces
}

/// A surface goes on through a hole in a row unless it ends on either side of the hole: shadows lie between a thing and what is behind it.
fn fill_unseen(row: &mut [i32]) {
    let mut end = 0;
    while let Some(start) = row[end..].iter().position(|&seen| seen == UNSEEN).map(|k| end + k) {
        end = row[start..].iter().position(|&seen| seen != UNSEEN).map_or(row.len(), |k| start + k);
        let beside = [start.checked_sub(1), Some(end)];
        let ends = beside.into_iter().flatten().any(|k| row.get(k) == Some(&ENDS));
        row[start..end].fill(if ends { ENDS } else { GOES_ON });
    }
}

impl StructureSurface {
    /// Whether these of its pixels are as large as the board of a shelf.
    fn is_board(&self, pixels: &[usize], width: usize, space: &DisparitySpace) -> bool {
        let point_m = |&i: &usize| {
            let at = position(i, width);
            DVec3::from(space.point_m(at, self.model.value(at)))
        };
        let points_m: Vec<DVec3> = pixels.iter().map(point_m).collect();
        SurfaceSize::measure(&points_m, self.normal, 1, &space.camera()).is_board()
    }
}
