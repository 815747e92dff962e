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
    let cells = field.cells.len();
    let mut sets = UnionFind::of_pixels(cells);
    let mut growths = vec![Growth { cells: 1, tolerated: PREFERENCE }; cells];
    // Most edges end up within a patch; the others are asked again.
    let mut between = sorted_edges(field);
    between.retain(|edge| {
        let [p, q] = edge.cells(field.width).map(|cell| sets.find(cell));
        let weight = f32::from(edge.step) / WEIGHT_STEPS;
        let joins = p != q && weight <= growths[p].tolerated.min(growths[q].tolerated);
        if joins {
            let root = join(&mut sets, &mut growths, p, q);
            growths[root].tolerated = weight + PREFERENCE / growths[root].cells as f32;
        }
        p != q && !joins
    });
    for edge in between {
        let [p, q] = edge.cells(field.width).map(|cell| sets.find(cell));
        if p != q && growths[p].cells.min(growths[q].cells) < LEAST_CELLS {
            join(&mut sets, &mut growths, p, q);
        }
    }
    number(sets, |i| field.cells[i].support != NO_SUPPORT, cells)
}

/// What has become of the patch of a root.
#[derive(Clone, Copy)]
struct Growth {
    cells: u32,
    /// The step in colour that it tolerates (ΔE).
    tolerated: f32,
}

/// Finds the pieces of marked cells of one support that hang together. O(cells · α).
pub(super) fn find_pieces(field: &Field, marked: &[bool]) -> Patches {
    let mut sets = UnionFind::of_pixels(marked.len());
    for_each_pair(field, |i, j| {
        if marked[i] && marked[j] {
            let (a, b) = (sets.find(i), sets.find(j));
            sets.link(a.min(b), a.max(b));
        }
    });
    number(sets, |i| marked[i], marked.len())
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

/// Visits the pairs of neighbouring cells of one support, each cell with the one right of it and the one below, in scan order.
fn for_each_pair(field: &Field, mut visit: impl FnMut(usize, usize)) {
    let Field { width, cells, .. } = field;
    for (v, row) in cells.chunks(*width).enumerate() {
        for (u, cell) in row.iter().enumerate().filter(|(_, cell)| cell.support != NO_SUPPORT) {
            let i = v * width + u;
            if row.get(u + 1).is_some_and(|right| right.support == cell.support) {
                visit(i, i + 1);
            }
            if cells.get(i + width).is_some_and(|below| below.support == cell.support) {
                visit(i, i + width);
            }
        }
    }
}

fn join(sets: &mut UnionFind, growths: &mut [Growth], p: usize, q: usize) -> usize {
    let (root, child) = if growths[p].cells < growths[q].cells { (q, p) } else { (p, q) };
    sets.link(root, child);
    growths[root].cells += growths[child].cells;
    root
}

/// Two neighbouring cells.
#[derive(Clone, Copy, Default)]
struct Edge {
    /// How far their colours differ, in steps.
    step: u16,
    is_below: bool,
    /// The first of them; the other is right of it or below.
    first: u32,
}

impl Edge {
    fn cells(self, width: usize) -> [usize; 2] {
        let first = self.first as usize;
        [first, first + if self.is_below { width } else { 1 }]
    }
}

/// The edges between cells of one support, by ascending difference; of equal ones the first cell first, and right before below. O(cells).
fn sorted_edges(field: &Field) -> Vec<Edge> {
    let cells = &field.cells;
    let mut edges = Vec::with_capacity(2 * cells.len());
    let mut starts = vec![0_u32; MOST_STEPS + 2];
    for_each_pair(field, |i, j| {
        let step = ((difference(cells[i].lab, cells[j].lab) * WEIGHT_STEPS) as usize).min(MOST_STEPS);
        starts[step + 1] += 1;
        edges.push(Edge { step: step as u16, is_below: j != i + 1, first: i as u32 });
    });
    for step in 1..starts.len() {
        starts[step] += starts[step - 1];
    }
    let mut sorted = vec![Edge::default(); edges.len()];
    for edge in edges {
        let place = &mut starts[usize::from(edge.step)];
        sorted[*place as usize] = edge;
        *place += 1;
    }
    sorted
}
