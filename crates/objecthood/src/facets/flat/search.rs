//! The search: proposals, their evidence, and the choice among those that overlap.

use std::f64::consts::FRAC_PI_2;
use std::ops::RangeInclusive;

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use crate::check::Check;
use crate::color::difference;
use crate::facets::flat::evidence::{LEAST_PX, Shown, measure};
use crate::facets::flat::field::Field;
use crate::facets::flat::hull::{hull_of, turn};
use crate::facets::flat::patches::{find_patches, find_pieces};
use crate::facets::flat::proposals::{OwnColors, Proposal, propose_by_color, propose_by_depth};
use crate::facets::flat::raised::find_raised;
use crate::facets::flat::surroundings::Surroundings;
use crate::noise::KINECT_QUANTA;
use crate::oriented_box::fit_oriented_box;
use crate::oversegment::structure::{Structure, StructureSurface};
use crate::params::{self, Params};
use crate::surface::surfaces::Surfaces;
use crate::tangents::tangents;

/// The parameters of [`find_flats`](super::find_flats).
#[derive(Clone, Copy, Debug)]
pub struct FlatParams<'a> {
    /// For flat things.
    pub flat: &'a params::Flat,
    /// For the sizes of objects.
    pub objectness: &'a params::Objectness,
}

impl<'a> FlatParams<'a> {
    /// Selects the groups of [`find_flats`](super::find_flats) from all parameters.
    pub fn of(params: &'a Params) -> Self {
        let Params { flat, objectness, .. } = params;
        Self { flat, objectness }
    }
}

/// The ring around a group (px at a focal length of 525 px): beyond mixed pixels and smeared depth, and near enough for one plane.
const RING_PX: [usize; 2] = [5, 20];
/// Two groups are alike when their mean colours differ by less than this (ΔE) ...
const ALIKE: f32 = 12.0;
/// ... and the smaller one has at least this share of the cells of the larger one.
const ALIKE_SHARE: f64 = 0.15;
/// Two groups are parallel when the sides of the rectangles around them differ by less than this (radians, 6 degrees).
const PARALLEL: f64 = 0.1;
/// A group may lose this share of its cells to another one; with more in common they are the same thing.
const COMMON_SHARE: f64 = 0.2;
/// The sides of a group are measured on about this many of its cells.
const SAMPLED_CELLS: usize = 200;
/// The diagonal of the box around a group grows by this factor, which is more than a side of the group is rounded by.
const ROUNDED: f64 = 1.001;

/// A group of cells with its evidence.
struct Group {
    cells: Vec<usize>,
    /// The support that it lies on.
    support: u8,
    is_part: bool,
    shown: Shown,
    /// Its longest and its second-longest side (m).
    sides_m: [f64; 2],
    /// The direction of its sides on its support (radians, from 0 to a right angle).
    turn: f64,
    /// The check that it rises above its support, which is proof.
    rises: Check,
}

/// A group that is a flat thing.
pub(super) struct Found {
    pub cells: Vec<usize>,
    pub is_proven: bool,
    pub checks: Vec<Check>,
    rank: f64,
}

pub(super) struct Search<'a> {
    field: &'a Field,
    surfaces: &'a Surfaces,
    structure: &'a Structure,
    params: FlatParams<'a>,
    ring: RangeInclusive<u8>,
}

impl<'a> Search<'a> {
    pub(super) fn new(
        field: &'a Field,
        surfaces: &'a Surfaces,
        structure: &'a Structure,
        params: FlatParams<'a>,
    ) -> Self {
        let [near, far] = RING_PX.map(|px| surfaces.space.length_px(px).div_ceil(2).min(100) as u8);
        Self { field, surfaces, structure, params, ring: near..=far }
    }

    /// Finds the flat things, in the order of their first cells.
    pub(super) fn run(&self, has_color: bool) -> Vec<Found> {
        let is_large = |cells: &[u32]| !self.is_small(cells) && !self.is_graspable(self.sides_m(cells));
        let (mut proposals, own) = if has_color {
            propose_by_color(self.field, &find_patches(self.field), is_large)
        } else {
            (Vec::new(), OwnColors::new())
        };
        let raised = find_raised(self.field, self.noise_quanta(0));
        proposals.extend(propose_by_depth(self.field, &find_pieces(self.field, &raised), is_large));
        let least_cells = self.cells(self.params.objectness.min_size_px);
        proposals.retain(|Proposal { cells, .. }| cells.len() >= least_cells && !is_large(cells));
        let groups: Vec<Group> =
            proposals.par_iter().filter_map(|proposal| self.look(proposal, &own)).collect();
        let found = (0..groups.len()).filter_map(|k| self.judge(&groups, k)).collect();
        self.choose(found)
    }

    /// Measures a proposal; `None` if its shape is not that of a thing.
    fn look(&self, Proposal { cells, is_part }: &Proposal, own: &OwnColors) -> Option<Group> {
        let around = Surroundings::new(self.field, cells, usize::from(*self.ring.end()) + 1);
        let inside: Vec<usize> = around.inside().collect();
        let shown = measure(self.field, &around, &inside, self.ring.clone(), own.get(&around.support))?;
        Some(Group {
            turn: self.turn(&inside),
            cells: inside,
            support: around.support,
            is_part: *is_part,
            rises: shown.check_offset(self.noise_quanta(1), self.params.flat),
            shown,
            sides_m: self.sides_m(cells),
        })
    }

    /// Decides whether a group is a flat thing.
    fn judge(&self, groups: &[Group], k: usize) -> Option<Found> {
        let Group { cells, is_part, shown, sides_m, rises, .. } = &groups[k];
        let mut checks = shown.shape.check().to_vec();
        let is_proven = rises.holds();
        if is_proven {
            checks.push(*rises);
        } else {
            let color = shown.color.filter(|_| !is_part && cells.len() >= self.cells(LEAST_PX))?;
            let (alike, parallel) = (count_alike(groups, k), count_parallel(groups, k));
            checks.extend(color.check(alike, parallel, sides_m[1], self.params.flat));
        }
        // A group that lies deeper than its ring is no thing, whatever its colour.
        let is_sunk = shown.offset_quanta < -rises.limit;
        let rank = cells.len() as f64 * shown.shape.solid * shown.shape.solid;
        let is_thing = !is_sunk && checks.iter().all(Check::holds);
        is_thing.then(|| Found { cells: cells.clone(), is_proven, checks, rank })
    }

    /// Of things that overlap, keeps the largest and most solid one.
    fn choose(&self, mut found: Vec<Found>) -> Vec<Found> {
        found.sort_by(|a, b| b.rank.total_cmp(&a.rank).then_with(|| a.cells.cmp(&b.cells)));
        let mut is_taken = vec![false; self.field.cells.len()];
        found.retain_mut(|thing| {
            let all = thing.cells.len() as f64;
            thing.cells.retain(|&i| !is_taken[i]);
            let keeps = thing.cells.len() as f64 >= (1.0 - COMMON_SHARE) * all;
            if keeps {
                thing.cells.iter().for_each(|&i| is_taken[i] = true);
            }
            keeps
        });
        found.sort_by_key(|thing| thing.cells[0]);
        found
    }

    /// The disagreement (quanta) of blocks of an empty surface: a Kinect's, times the largest ratio of the
    /// frame's to a Kinect's over all sizes of blocks, because waves of stereo are longer than the blocks. At
    /// least a Kinect's, because bent tables and stray light do not shrink with the noise.
    fn noise_quanta(&self, block: usize) -> f64 {
        let noise = self.surfaces.space.noise().blocks_quanta;
        let ratios = noise.iter().zip(KINECT_QUANTA).map(|(own, kinect)| own / kinect);
        ratios.fold(1.0, f64::max) * KINECT_QUANTA[block]
    }

    /// An area in pixels at a focal length of 525 px, in cells.
    fn cells(&self, px: usize) -> usize {
        self.surfaces.space.area_px(px).div_ceil(4).max(1)
    }

    fn is_graspable(&self, [longest_m, second_m]: [f64; 2]) -> bool {
        let objectness = self.params.objectness;
        longest_m <= f64::from(objectness.max_side_m) && second_m <= f64::from(objectness.max_second_side_m)
    }

    /// The support of a group of cells.
    fn support_of(&self, first: usize) -> &StructureSurface {
        let place = usize::from(self.field.cells[first].support);
        &self.structure.surfaces[self.structure.supports.surfaces[place]]
    }

    /// The direction of the sides of the smallest rectangle around some cells on their support (radians, from 0 to a right angle).
    fn turn(&self, cells: &[usize]) -> f64 {
        let surface = self.support_of(cells[0]);
        let [x, y] = tangents(DVec3::from(surface.normal()));
        let corner = |corner: [i64; 2]| {
            let at = corner.map(|x| 2.0 * x as f64 - 0.5);
            let point_m = DVec3::from(self.surfaces.space.point_m(at, surface.model.value(at)));
            DVec2::new(point_m.dot(x), point_m.dot(y))
        };
        turn(&hull_of(cells, self.field.width).into_iter().map(corner).collect::<Vec<_>>())
    }

    /// Whether the upright box around some cells on their support tells that they are graspable: no side is longer than its diagonal.
    fn is_small(&self, cells: &[u32]) -> bool {
        let points_m = self.sample_m(cells);
        let ends = |k: usize| {
            let along = points_m.iter().map(|point| point[k]);
            along.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
        };
        let sides = Vec3::from([0, 1, 2].map(ends).map(|[low, high]| high - low));
        let diagonal_m = f64::from(sides.length()) * ROUNDED;
        self.is_graspable([diagonal_m; 2])
    }

    /// The longest and the second-longest side (m) of some cells on their support.
    fn sides_m(&self, cells: &[u32]) -> [f64; 2] {
        let surface = self.support_of(cells[0] as usize);
        let up = surface.normal().map(|x| x as f32);
        let [x, y, _] = fit_oriented_box(&self.sample_m(cells), up).extents_m;
        [x.max(y), x.min(y)].map(f64::from)
    }

    /// Some cells as points (m) on their support.
    fn sample_m(&self, cells: &[u32]) -> Vec<[f32; 3]> {
        let surface = self.support_of(cells[0] as usize);
        let step = cells.len().div_ceil(SAMPLED_CELLS);
        let points_m = cells.iter().step_by(step).map(|&i| {
            let at = self.field.middle_px(i as usize);
            self.surfaces.space.point_m(at, surface.model.value(at)).map(|x| x as f32)
        });
        points_m.collect()
    }
}

/// The number of other groups of about the same colour and size.
fn count_alike(groups: &[Group], k: usize) -> usize {
    let own = &groups[k];
    count_others(groups, k, |other| {
        let sizes = [own.cells.len(), other.cells.len()].map(|cells| cells as f64);
        let colors = own.shown.color.zip(other.shown.color);
        sizes[0].min(sizes[1]) >= ALIKE_SHARE * sizes[0].max(sizes[1])
            && colors.is_some_and(|(a, b)| difference(a.mean, b.mean) < ALIKE)
    })
}

/// The number of other groups on the same support that only colour shows, and whose sides are parallel to its
/// own.
fn count_parallel(groups: &[Group], k: usize) -> usize {
    let own = &groups[k];
    count_others(groups, k, |other| {
        let between = (own.turn - other.turn).abs();
        let is_parallel = between.min(FRAC_PI_2 - between) < PARALLEL;
        is_parallel && !other.rises.holds() && other.support == own.support
    })
}

/// The number of other groups for which a condition holds. A group and the patches that it consists of count
/// once.
fn count_others(groups: &[Group], k: usize, is_meant: impl Fn(&Group) -> bool) -> usize {
    let mut counted = vec![&groups[k].cells];
    for other in groups.iter().filter(|other| is_meant(other)) {
        if !counted.iter().any(|cells| overlap(cells, &other.cells)) {
            counted.push(&other.cells);
        }
    }
    counted.len() - 1
}

/// Whether two lists of cells in scan order have one in common.
fn overlap(a: &[usize], b: &[usize]) -> bool {
    let (few, many) = if a.len() < b.len() { (a, b) } else { (b, a) };
    few.iter().any(|i| many.binary_search(i).is_ok())
}
