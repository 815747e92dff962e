//! Patches: pieces of the field of one colour each (graph segmentation by Felzenszwalb and Huttenlocher, IJCV 2004, on cells).

use crate::color::difference;
use crate::facets::flat::field::{Field, NO_SUPPORT};
use crate::union_find::UnionFind;

/// Preference for large patches: the step in colour that a patch of one cell tolerates (ΔE).
const PREFERENCE: f32 = 60.0;
/// Steps of the edge weights (1/ΔE), and their greatest number.
const WEIGHT_STEPS: f32 = 8.0;
const MOST_STEPS: usize = 1023;
/// Smaller patches (cells) are given to the neighbour that is most alike.
pub(super) const LEAST_CELLS: u32 = 12;

/// The patches of a field: the number of each cell's patch, and their count.
pub(super) struct Patches {
    pub of_cell: Vec<u32>,
    pub count: usize,
}

/// The patch of a cell outside the field.
pub(super) const NO_PATCH: u32 = u32::MAX;

/// Segments the cells by colour. O(cells · α), sequential: each decision depends on those before.
pub(super) fn find_patches(field: &Field) -> Patches {
    let edges = sorted_edges(field);
    let cells = field.cells.len();
    let mut sets = UnionFind::of_pixels(cells);
    let mut size = vec![1_u32; cells];
    let mut tolerated = vec![PREFERENCE; cells];
    for &(step, p, q) in &edges {
        let weight = f32::from(step) / WEIGHT_STEPS;
        let (p, q) = (sets.find(p as usize), sets.find(q as usize));
        if p != q && weight <= tolerated[p].min(tolerated[q]) {
            let root = join(&mut sets, &mut size, p, q);
            tolerated[root] = weight + PREFERENCE / size[root] as f32;
        }
    }
    for &(_, p, q) in &edges {
        let (p, q) = (sets.find(p as usize), sets.find(q as usize));
        if p != q && size[p].min(size[q]) < LEAST_CELLS {
            join(&mut sets, &mut size, p, q);
        }
    }
    number(sets, |i| field.cells[i].support != NO_SUPPORT, cells)
}

/// Finds the pieces of marked cells of one support that hang together. O(cells · α).
pub(super) fn find_pieces(field: &Field, marked: &[bool]) -> Patches {
    let Field { width, cells, .. } = field;
    let mut sets = UnionFind::of_pixels(cells.len());
    for i in (0..cells.len()).filter(|&i| marked[i]) {
        for j in later_neighbours(i, *width, cells.len()) {
            if marked[j] && cells[i].support == cells[j].support {
                let (a, b) = (sets.find(i), sets.find(j));
                sets.link(a.min(b), a.max(b));
            }
        }
    }
    number(sets, |i| marked[i], cells.len())
}

/// Numbers the sets of some cells, in the order of their first cells.
fn number(mut sets: UnionFind, is_in: impl Fn(usize) -> bool, cells: usize) -> Patches {
    let (mut number, mut of_cell) = (vec![NO_PATCH; cells], vec![NO_PATCH; cells]);
    let mut count = 0;
    for i in (0..cells).filter(|&i| is_in(i)) {
        let root = sets.find(i);
        if number[root] == NO_PATCH {
            number[root] = count;
            count += 1;
        }
        of_cell[i] = number[root];
    }
    Patches { of_cell, count: count as usize }
}

/// The cells right of and below a cell.
fn later_neighbours(i: usize, width: usize, cells: usize) -> impl Iterator<Item = usize> {
    let right = (!(i + 1).is_multiple_of(width)).then_some(i + 1);
    right.into_iter().chain(Some(i + width).filter(|&j| j < cells))
}

fn join(sets: &mut UnionFind, size: &mut [u32], p: usize, q: usize) -> usize {
    let (root, child) = if size[p] < size[q] { (q, p) } else { (p, q) };
    sets.link(root, child);
    size[root] += size[child];
    root
}

/// Pairs of neighbouring cells of one support by ascending difference. O(cells).
fn sorted_edges(field: &Field) -> Vec<(u16, u32, u32)> {
    let Field { width, cells, .. } = field;
    let mut edges = Vec::with_capacity(2 * cells.len());
    let mut starts = vec![0_u32; MOST_STEPS + 2];
    for (i, cell) in cells.iter().enumerate().filter(|(_, cell)| cell.support != NO_SUPPORT) {
        for j in later_neighbours(i, *width, cells.len()) {
            if cells[j].support == cell.support {
                let step = ((difference(cell.lab, cells[j].lab) * WEIGHT_STEPS) as usize).min(MOST_STEPS);
                starts[step + 1] += 1;
                edges.push((step as u16, i as u32, j as u32));
            }
        }
    }
    for step in 1..starts.len() {
        starts[step] += starts[step - 1];
    }
    let mut sorted = vec![(0, 0, 0); edges.len()];
    for edge in edges {
        let place = &mut starts[usize::from(edge.0)];
        sorted[*place as usize] = edge;
        *place += 1;
    }
    sorted
}
