//! Counts the links between superpixels.

use rayon::prelude::*;

use crate::oversegment::links::{DOWN, Links, RIGHT};
use crate::raster::marked;
use crate::regions::{RegionEdge, RegionGraph, SegmentId, Segments};
use crate::simd::vectorized;

/// A pair of superpixels, the smaller number first, and a number of links between them.
type Count = ([u32; 2], u32);

/// Counts, for any two superpixels, the linked 4-neighbours between them. O(pixels); parallel over rows.
pub(crate) fn count_linked_pairs(superpixels: &Segments, links: &Links) -> RegionGraph<u32> {
    let (width, height) = superpixels.labels().size();
    let of_row = |marks: &mut Vec<i32>, v: usize| {
        mark_links(superpixels, links, v, marks);
        count_marked(superpixels, v, marks)
    };
    let rows: Vec<Vec<Count>> = (0..height).into_par_iter().map_init(|| vec![0; width], of_row).collect();
    sum_counts(superpixels.count(), rows.into_iter().flatten())
}

/// Marks the pixels of row `v` with the sides on which a link leads to another superpixel: [`RIGHT`], [`DOWN`].
fn mark_links(superpixels: &Segments, links: &Links, v: usize, marks: &mut [i32]) {
    let (width, height) = superpixels.labels().size();
    let labels = superpixels.labels().as_slice();
    let start = v * width;
    let own = &labels[start..start + width];
    let sides = &links.sides.as_slice()[start..start + width];
    // Beyond the right and lower image border any label will do: no link leads there.
    let right = &labels[start + 1..labels.len().min(start + width + 1)];
    let below = if v + 1 < height { &labels[start + width..start + 2 * width] } else { own };
    vectorized(
        #[inline(always)]
        || {
            let mark = |side: u8, sides: u8, a: i32, b: i32| {
                i32::from(side * u8::from((a != b) & (a >= 0) & (b >= 0) & (sides & side != 0)))
            };
            for (((marked, sides), a), b) in marks.iter_mut().zip(sides).zip(own).zip(below) {
                *marked = mark(DOWN, *sides, *a, *b);
            }
            for (((marked, sides), a), b) in marks.iter_mut().zip(sides).zip(own).zip(right) {
                *marked |= mark(RIGHT, *sides, *a, *b);
            }
        },
    );
}

/// Counts the marked links of row `v`. Successive links of the same pair make one entry.
fn count_marked(superpixels: &Segments, v: usize, marks: &[i32]) -> Vec<Count> {
    let labels = superpixels.labels();
    let width = labels.width();
    let mut counts: Vec<Count> = Vec::new();
    for u in marked(marks) {
        let i = v * width + u;
        for (side, j) in [(DOWN, i + width), (RIGHT, i + 1)] {
            if marks[u] & i32::from(side) != 0 {
                let pair = [labels[i].min(labels[j]), labels[i].max(labels[j])].map(|s| s as u32);
                match counts.last_mut() {
                    Some((last, times)) if *last == pair => *times += 1,
                    _ => counts.push((pair, 1)),
                }
            }
        }
    }
    counts
}

/// Sums the counts of each pair. A superpixel has few neighbours, so searching its list is faster than sorting all counts.
/// O(counts · neighbours).
fn sum_counts(superpixels: usize, counts: impl Iterator<Item = Count>) -> RegionGraph<u32> {
    // Marks the end of a list.
    const END: u32 = u32::MAX;
    let mut firsts = vec![END; superpixels];
    // Linked lists, one for each first superpixel: the second one, the number of links, the place of the next entry.
    let mut entries: Vec<(u32, u32, u32)> = Vec::new();
    for ([a, b], times) in counts {
        let first = &mut firsts[a as usize];
        let mut at = *first;
        while at != END && entries[at as usize].0 != b {
            at = entries[at as usize].2;
        }
        match entries.get_mut(at as usize) {
            Some(entry) => entry.1 += times,
            None => {
                entries.push((b, times, *first));
                *first = entries.len() as u32 - 1;
            }
        }
    }
    let mut edges = Vec::with_capacity(entries.len());
    for (a, first) in (0..).zip(firsts) {
        let (own, mut at) = (edges.len(), first);
        while let Some(&(b, times, next)) = entries.get(at as usize) {
            edges.push(RegionEdge { a: SegmentId(a), b: SegmentId(b), evidence: times });
            at = next;
        }
        edges[own..].sort_unstable_by_key(|edge| edge.b);
    }
    RegionGraph::from_sorted(superpixels, edges)
}
