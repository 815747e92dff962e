//! Proposals: groups of cells that may be flat things, by colour or by depth (docs/CONTEXT.md 2.4).

use std::collections::{BTreeMap, BTreeSet};

use crate::color::histogram::ColorHistogram;
use crate::facets::flat::field::Field;
use crate::facets::flat::patches::{LEAST_CELLS, NO_PATCH, Patches};
use crate::union_find::UnionFind;

/// A patch belongs to the support itself if the field ends along more than this share of its outline: the
/// support goes on under things.
const OPEN_SHARE: f64 = 0.25;
/// A colour also counts as the support's if its share in the support is at least its share in the patch,
/// divided by this.
pub(super) const RARE: f32 = 10.0;
/// A patch belongs to the support if at least this share of it has colours of the support.
const FAMILIAR_SHARE: f64 = 0.5;

/// The colours of each support, from the patches that are its own.
pub(super) type OwnColors = BTreeMap<u8, ColorHistogram>;

/// Cells that may be a flat thing.
pub(super) struct Proposal {
    pub cells: Vec<u32>,
    /// Whether cells of other colours, which are not the support's, touch it. Then colour alone does not show
    /// that it ends there.
    pub is_part: bool,
}

/// What is known of a patch.
#[derive(Clone, Default)]
struct Patch {
    cells: Vec<u32>,
    /// Sides of its cells beyond which it ends.
    outline: u32,
    /// Of these, those beyond which the field ends.
    open: u32,
    /// Whether it reaches the border of the image.
    is_cut: bool,
    neighbours: BTreeSet<u32>,
}

impl Patch {
    /// Whether it ends by itself.
    fn is_closed(&self) -> bool {
        !self.is_cut && f64::from(self.open) <= OPEN_SHARE * f64::from(self.outline)
    }
}

/// Proposes, by colour, patches that differ from their support, and groups of such patches that touch. Also
/// returns the supports' own colours. `is_large`: whether these cells are too many, or too far apart, for a
/// thing. O(cells · log patches).
pub(super) fn propose_by_color(
    field: &Field,
    patches: &Patches,
    is_large: impl Fn(&[u32]) -> bool,
) -> (Vec<Proposal>, OwnColors) {
    let found = measure(field, patches);
    let support_of = |patch: &Patch| field.cells[patch.cells[0] as usize].support;
    let add = |colors: &mut ColorHistogram, patch: &Patch| {
        patch.cells.iter().for_each(|&i| colors.add(field.cells[i as usize].lab));
    };
    let mut is_own: Vec<bool> = found.iter().map(|p| !p.is_closed() || is_large(&p.cells)).collect();
    let mut own = OwnColors::new();
    for (patch, is_own) in found.iter().zip(&is_own) {
        let colors = own.entry(support_of(patch)).or_default();
        if *is_own {
            add(colors, patch);
        }
    }
    for (patch, is_own) in found.iter().zip(&mut is_own).filter(|(_, is_own)| !**is_own) {
        *is_own = patch.cells.len() < LEAST_CELLS as usize || {
            let mut colors = ColorHistogram::empty();
            add(&mut colors, patch);
            colors.share_in(&own[&support_of(patch)], RARE) >= FAMILIAR_SHARE
        };
    }
    (with_groups(found, &is_own), own)
}

/// Proposes, by depth, connected pieces of raised cells. O(cells).
pub(super) fn propose_by_depth(
    field: &Field,
    pieces: &Patches,
    is_large: impl Fn(&[u32]) -> bool,
) -> Vec<Proposal> {
    let found = measure(field, pieces).into_iter();
    let closed = found.filter(|piece| piece.is_closed() && !is_large(&piece.cells));
    closed.map(|piece| Proposal { cells: piece.cells, is_part: true }).collect()
}

/// Proposes the patches that are not the support's own, and the groups of such patches that touch.
fn with_groups(found: Vec<Patch>, is_own: &[bool]) -> Vec<Proposal> {
    let mut sets = UnionFind::new(found.len());
    for (k, patch) in found.iter().enumerate().filter(|(k, _)| !is_own[*k]) {
        for &other in patch.neighbours.iter().filter(|&&other| !is_own[other as usize]) {
            let (a, b) = (sets.find(k), sets.find(other as usize));
            sets.link(a.min(b), a.max(b));
        }
    }
    let mut groups: BTreeMap<usize, Vec<Vec<u32>>> = BTreeMap::new();
    for (k, patch) in found.into_iter().enumerate().filter(|(k, _)| !is_own[*k]) {
        groups.entry(sets.find(k)).or_default().push(patch.cells);
    }
    let mut proposals = Vec::new();
    for parts in groups.into_values() {
        let is_part = parts.len() > 1;
        if is_part {
            proposals.push(Proposal { cells: parts.concat(), is_part: false });
        }
        proposals.extend(parts.into_iter().map(|cells| Proposal { cells, is_part }));
    }
    proposals
}

fn measure(field: &Field, patches: &Patches) -> Vec<Patch> {
    let mut found = vec![Patch::default(); patches.count];
    let (width, height, of_cell) = (field.width, field.height, &patches.of_cell);
    let mut sizes = vec![0; patches.count];
    of_cell.iter().filter(|k| **k != NO_PATCH).for_each(|&k| sizes[k as usize] += 1);
    for (patch, size) in found.iter_mut().zip(sizes) {
        patch.cells.reserve_exact(size);
    }
    for v in 0..height {
        let row = v * width..(v + 1) * width;
        let mut from = row.start;
        for run in of_cell[row.clone()].chunk_by(|a, b| a == b) {
            let cells = from..from + run.len();
            from = cells.end;
            if let Some(patch) = found.get_mut(run[0] as usize) {
                patch.is_cut |= v == 0 || v + 1 == height || cells.start == row.start || cells.end == row.end;
                patch.cells.extend(cells.start as u32..cells.end as u32);
            }
            if cells.end < row.end {
                end_at_each_other(&mut found, field, of_cell, [cells.end - 1, cells.end]);
            }
        }
        for i in row {
            if of_cell.get(i + width).is_some_and(|below| *below != of_cell[i]) {
                end_at_each_other(&mut found, field, of_cell, [i, i + width]);
            }
        }
    }
    found
}

/// Notes that the patches of two neighbouring cells end at each other. A cell outside the field has no patch.
fn end_at_each_other(found: &mut [Patch], field: &Field, of_cell: &[u32], [one, other]: [usize; 2]) {
    for (last, beyond) in [(one, other), (other, one)] {
        let Some(patch) = found.get_mut(of_cell[last] as usize) else { continue };
        patch.outline += 1;
        if field.cells[beyond].support != field.cells[last].support {
            patch.open += 1;
        } else if of_cell[beyond] != NO_PATCH {
            patch.neighbours.insert(of_cell[beyond]);
        }
    }
}
