//! The ground and the other supports: the surfaces on which things stand (docs/CONTEXT.md 1.1.4 and 1.1.8;
//! ours, because the largest surface of a room is often a wall).

use glam::DVec3;

use super::choice::{Choice, Evidence, FACED, choose_ground, missed_gravity_deg};
use super::surface::StructureSurface;
use crate::attitude::Attitude;
use crate::raster::Raster;
use crate::surface::disparity::{DisparitySpace, position};
use crate::union_find::UnionFind;

/// A thing rises from the surface on which it stands by at least this much (m) ...
const LEAST_RISE_M: f64 = 0.02;
/// ... and by at least this many quanta, so that waves of the surface are no things.
const LEAST_RISE_QUANTA: f64 = 4.0;
/// Pixels farther apart than this many times their distance in the image lie on both sides of a step.
const MOST_STRETCH: f64 = 4.0;
/// Distance (px at a focal length of 525 px) of the cells in which the frame is sampled.
const CELL_PX: usize = 3;
/// A thing touches a surface within this many cells.
const CONTACT_CELLS: usize = 2;
/// Least number of places where a thing touches the surface on which it stands.
const LEAST_CONTACTS: u32 = 3;
/// A thing surely rests on a surface if it rises by this many quanta ...
const SURE_RISE_QUANTA: f64 = 8.0;
/// ... has at least this many pixels (at a focal length of 525 px) ...
const SURE_PX: usize = 540;
/// ... and touches the surface where it is at most this high above it (m) ...
const LOW_M: f64 = 0.01;
/// ... or than this many quanta.
const LOW_QUANTA: f64 = 4.0;
/// Pieces that do not have more pixels than this (at a focal length of 525 px) are noise, as fragments are.
const LEAST_THING_PX: usize = 250;
/// Pieces longer than this (m) along an axis of the camera are furniture, as for `objectness.max_side_m`.
const MOST_SIDE_M: f64 = 0.6;

/// The surfaces on which things stand.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Supports {
    /// The numbers of the surfaces. The ground, on which most things stand, comes first.
    pub surfaces: Vec<usize>,
    /// How far the camera is turned clockwise about its optical axis beyond what was given: 0, 90, 180 or 270 degrees.
    pub turned_deg: u16,
    /// Whether there is little evidence for another surface as the ground.
    pub is_clear: bool,
    /// The angle (degrees) between a measured up, which no surface faces, and the normal of the surface with
    /// most votes.
    pub missed_gravity_deg: Option<f32>,
}

/// Finds the ground and all supports that are parallel to it.
///
/// Counts, for each surface, the things that touch it more than any other: a wall touches furniture, a board
/// what stands on it. [`choose_ground`] weighs them. Without surfaces there is no support. O(pixels / 9 +
/// surfaces²).
pub(super) fn find_supports(
    surfaces: &[StructureSurface],
    large: usize,
    labels: &Raster<i32>,
    disparity: &Raster<f32>,
    space: &DisparitySpace,
    attitude: &Attitude,
) -> Supports {
    let seen = Seen::new(labels, disparity, space);
    let (mut evidence, things) = count_things(&seen, surfaces);
    let Some(ground) = choose_ground(&evidence, things, attitude) else {
        return Supports {
            missed_gravity_deg: missed_gravity_deg(&evidence, attitude),
            ..Supports::default()
        };
    };
    let (mut ground, mut surfaces) = (ground, supports_beside(ground.surface, &evidence, large));
    if surfaces.is_empty() {
        // An empty board is no structure. Another surface may be the ground, but no wall.
        for k in 0..evidence.len() {
            let is_faced = evidence[k].normal.dot(attitude.up) < FACED;
            evidence[k].may_be_ground = !is_faced && is_structure(k, &evidence, large);
        }
        let Some(second) = choose_ground(&evidence, things, attitude) else { return Supports::default() };
        (ground, surfaces) = (second, supports_beside(second.surface, &evidence, large));
    }
    let Choice { turned_deg, is_clear, .. } = ground;
    let votes = |k: usize| evidence[k].things + evidence[k].share;
    surfaces.sort_by(|&a, &b| votes(b).total_cmp(&votes(a)));
    Supports { surfaces, turned_deg, is_clear, missed_gravity_deg: None }
}

/// Whether a surface is structure: it is among the `large` ones, or a board on which a thing stands.
fn is_structure(k: usize, evidence: &[Evidence], large: usize) -> bool {
    k < large || evidence[k].things >= 1.0
}

/// The structure that is parallel to a surface, including the surface itself.
fn supports_beside(surface: usize, evidence: &[Evidence], large: usize) -> Vec<usize> {
    let is_support =
        |&k: &usize| evidence[surface].is_parallel_to(&evidence[k]) && is_structure(k, evidence, large);
    (0..evidence.len()).filter(is_support).collect()
}

impl Supports {
    /// Keeps the first `large` of `count` surfaces, and the supports among the others. Returns them in their order, and renumbers the
    /// supports accordingly.
    pub(super) fn keep(&mut self, count: usize, large: usize) -> Vec<usize> {
        let kept: Vec<usize> = (0..count).filter(|k| *k < large || self.surfaces.contains(k)).collect();
        for surface in &mut self.surfaces {
            *surface = kept.iter().position(|k| k == surface).unwrap_or_default();
        }
        kept
    }
}

/// Counts the things on each surface. A thing is a connected piece on no surface, has a graspable size, and
/// touches this surface more than the others. Also returns how many things could surely rest on one.
fn count_things(scene: &Seen<'_>, surfaces: &[StructureSurface]) -> (Vec<Evidence>, f64) {
    let evidence = |s: &StructureSurface| Evidence {
        normal: s.normal,
        things: 0.0,
        resting: 0.0,
        share: 0.0,
        may_be_ground: true,
    };
    let mut evidence: Vec<Evidence> = surfaces.iter().map(evidence).collect();
    let cells = (scene.columns * scene.rows).max(1) as f64;
    for s in (0..scene.columns * scene.rows).filter_map(|cell| scene.surface(cell)) {
        evidence[s].share += 1.0 / cells;
    }
    let pieces = scene.measure_pieces(surfaces);
    let things = || pieces.iter().filter(|piece| piece.is_thing(scene));
    for piece in things() {
        if let Some(s) = piece.support(scene, surfaces, LEAST_RISE_QUANTA) {
            evidence[s].things += 1.0;
        }
    }
    let mut count = 0.0;
    for piece in things().filter(|piece| piece.cells >= scene.cells_of(SURE_PX)) {
        count += 1.0;
        if let Some(s) = piece.lowest_support(scene, surfaces) {
            evidence[s].resting += 1.0;
        }
    }
    (evidence, count)
}

/// A connected piece of pixels that are on no surface.
#[derive(Clone)]
struct Piece {
    cells: usize,
    low_m: DVec3,
    high_m: DVec3,
    /// Whether it reaches the border of the image, so that its size is not known.
    is_cut: bool,
    /// Its greatest depth (m).
    far_m: f64,
    /// Places where it touches each surface.
    contacts: Vec<u32>,
    /// Those of them where it is low above that surface.
    low_contacts: Vec<u32>,
    /// Its greatest height above each surface (m).
    top_m: Vec<f64>,
}

impl Piece {
    fn new(surfaces: usize) -> Self {
        let (low_m, high_m) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        Self {
            cells: 0,
            is_cut: false,
            low_m,
            high_m,
            far_m: 0.0,
            contacts: vec![0; surfaces],
            low_contacts: vec![0; surfaces],
            top_m: vec![0.0; surfaces],
        }
    }

    fn add(&mut self, point_m: DVec3, surfaces: &[StructureSurface]) {
        self.cells += 1;
        self.far_m = self.far_m.max(point_m.z);
        for (top_m, surface) in self.top_m.iter_mut().zip(surfaces) {
            *top_m = top_m.max(surface.above_m(point_m));
        }
        (self.low_m, self.high_m) = (self.low_m.min(point_m), self.high_m.max(point_m));
    }

    fn is_thing(&self, scene: &Seen<'_>) -> bool {
        let is_short = (self.high_m - self.low_m).max_element() < MOST_SIDE_M;
        !self.is_cut && self.cells > scene.cells_of(LEAST_THING_PX) && is_short
    }

    /// The surface that it touches most among those from which it rises; on ties the first.
    fn support(&self, scene: &Seen<'_>, surfaces: &[StructureSurface], least_quanta: f64) -> Option<usize> {
        self.most_touched(surfaces, least_quanta, scene, &self.contacts)
    }

    /// The surface that it touches most among those at which it ends and above which it surely rises.
    fn lowest_support(&self, scene: &Seen<'_>, surfaces: &[StructureSurface]) -> Option<usize> {
        self.most_touched(surfaces, SURE_RISE_QUANTA, scene, &self.low_contacts)
    }

    fn most_touched(
        &self,
        surfaces: &[StructureSurface],
        least_quanta: f64,
        scene: &Seen<'_>,
        least: &[u32],
    ) -> Option<usize> {
        let rises = |&s: &usize| {
            let least_m = scene.space.step_m(least_quanta * surfaces[s].scale, self.far_m);
            least[s] >= LEAST_CONTACTS && self.top_m[s] > least_m.max(LEAST_RISE_M)
        };
        (0..surfaces.len()).rev().filter(rises).max_by_key(|&s| self.contacts[s])
    }
}

/// The frame, sampled in cells: every few pixels along rows and columns.
struct Seen<'a> {
    space: &'a DisparitySpace,
    /// Distance (px) of the cells.
    step: usize,
    columns: usize,
    rows: usize,
    /// What is seen in every cell.
    of: Vec<Shown>,
    /// The point of every cell (m).
    points_m: Vec<DVec3>,
}

/// What is seen in a cell.
#[derive(Clone, Copy, PartialEq)]
enum Shown {
    Surface(usize),
    /// It is measured, and lies on no surface.
    Free,
    Nothing,
}

impl<'a> Seen<'a> {
    fn new(labels: &Raster<i32>, disparity: &Raster<f32>, space: &'a DisparitySpace) -> Self {
        let step = space.length_px(CELL_PX);
        let (width, height) = labels.size();
        let (columns, rows) = (width.div_ceil(step), height.div_ceil(step));
        let cells =
            (0..height).step_by(step).flat_map(|v| (0..width).step_by(step).map(move |u| v * width + u));
        let shown = |i: usize| match usize::try_from(labels[i]) {
            Ok(surface) => Shown::Surface(surface),
            Err(_) if disparity[i].is_nan() => Shown::Nothing,
            Err(_) => Shown::Free,
        };
        let point_m = |i: usize| DVec3::from(space.point_m(position(i, width), disparity[i].into()));
        let (of, points_m) = cells.map(|i| (shown(i), point_m(i))).unzip();
        Self { space, step, columns, rows, of, points_m }
    }

    fn is_at_border(&self, cell: usize) -> bool {
        let [column, row] = [cell % self.columns, cell / self.columns];
        column == 0 || row == 0 || column + 1 == self.columns || row + 1 == self.rows
    }

    fn point_m(&self, cell: usize) -> DVec3 {
        self.points_m[cell]
    }

    fn surface(&self, cell: usize) -> Option<usize> {
        match self.of[cell] {
            Shown::Surface(surface) => Some(surface),
            _ => None,
        }
    }

    /// The cell this many columns to the right and rows below.
    fn beside(&self, cell: usize, apart: usize) -> impl Iterator<Item = usize> + use<> {
        let [column, row] = [cell % self.columns, cell / self.columns];
        let right = (column + apart < self.columns).then_some(cell + apart);
        right.into_iter().chain((row + apart < self.rows).then_some(cell + apart * self.columns))
    }

    /// Whether two cells a few places apart show one surface without a step.
    fn are_near(&self, [a, b]: [DVec3; 2], apart: usize) -> bool {
        let px = (apart * self.step) as f64;
        a.distance(b) < MOST_STRETCH * px * b.z.min(a.z) / self.space.camera().fx_px
    }

    /// The cells that so many pixels (at a focal length of 525 px) fill.
    fn cells_of(&self, px: usize) -> usize {
        self.space.area_px(px) / (self.step * self.step)
    }

    /// The pieces that are on no surface, and where they touch surfaces. O(cells · surfaces).
    fn measure_pieces(&self, surfaces: &[StructureSurface]) -> Vec<Piece> {
        let (of_cell, count) = self.find_pieces();
        let mut pieces = vec![Piece::new(surfaces.len()); count];
        for cell in 0..of_cell.len() {
            if let Some(piece) = of_cell[cell] {
                pieces[piece].add(self.point_m(cell), surfaces);
                pieces[piece].is_cut |= self.is_at_border(cell);
            }
            for beside in self.beside(cell, CONTACT_CELLS) {
                for (on, above) in [(cell, beside), (beside, cell)] {
                    let (Some(s), Some(piece)) = (self.surface(on), of_cell[above]) else { continue };
                    let point_m = self.point_m(above);
                    if self.are_near([self.point_m(on), point_m], CONTACT_CELLS) {
                        let low_m = self.space.step_m(LOW_QUANTA, point_m.z).max(LOW_M);
                        pieces[piece].contacts[s] += 1;
                        pieces[piece].low_contacts[s] += u32::from(surfaces[s].above_m(point_m) < low_m);
                    }
                }
            }
        }
        pieces
    }

    /// The piece of every cell that is measured and lies on no surface, and the number of pieces.
    fn find_pieces(&self) -> (Vec<Option<usize>>, usize) {
        let cells = self.columns * self.rows;
        let is_free = |cell: usize| self.of[cell] == Shown::Free;
        let mut sets = UnionFind::new(cells);
        for cell in (0..cells).filter(|&cell| is_free(cell)) {
            for other in self.beside(cell, 1).filter(|&other| is_free(other)) {
                if self.are_near([cell, other].map(|cell| self.point_m(cell)), 1) {
                    let [a, b] = [cell, other].map(|cell| sets.find(cell));
                    sets.link(a.min(b), a.max(b));
                }
            }
        }
        // Every cell of a surface is a set of its own, but not a piece.
        let (set_of, sets) = sets.groups();
        let (mut piece_of, mut count) = (vec![None; sets], 0);
        let mut piece = |cell: usize| {
            let piece = piece_of[set_of[cell] as usize].get_or_insert(count);
            count += usize::from(*piece == count);
            *piece
        };
        let pieces = (0..cells).map(|cell| is_free(cell).then(|| piece(cell))).collect();
        (pieces, count)
    }
}
