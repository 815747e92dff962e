//! Edges from the lightest to the heaviest, as far as they lie between two sets.

use crate::oversegment::graph::PixelEdge;
use crate::union_find::UnionFind;
use crate::workspace::Workspace;

/// Edges of a pixel graph, dealt into buckets by the leading bits of their weights.
///
/// The key of an edge is the bits of its weight, below them its number. Weights are not negative, so keys sort as weights do,
/// equal weights in the order of their numbers.
pub(crate) struct Edges {
    /// Bucket by bucket; within one the numbers ascend.
    keys: Vec<u64>,
    spare: Vec<u64>,
    /// Where each bucket ends.
    ends: Vec<usize>,
    /// From p to q in each direction.
    ahead: [u32; 4],
}

/// What happens at an edge between two sets.
pub(crate) trait Rule {
    /// Whether no edge of this weight or a heavier one joins the set of `root`, whatever happens elsewhere. What is no root any
    /// more refuses nothing.
    fn refuses(&self, root: usize, weight: f32) -> bool;

    /// The edge's turn has come, and its ends have these roots.
    fn meet(&mut self, sets: &mut UnionFind, edge: PixelEdge, roots: (usize, usize));
}

/// A rule that refuses nothing.
impl<F: FnMut(&mut UnionFind, PixelEdge, (usize, usize))> Rule for F {
    #[inline]
    fn refuses(&self, _: usize, _: f32) -> bool {
        false
    }

    #[inline]
    fn meet(&mut self, sets: &mut UnionFind, edge: PixelEdge, roots: (usize, usize)) {
        self(sets, edge, roots);
    }
}

/// The sign of the weight, which is 0, its exponent and five more bits.
const BUCKET_BITS: u32 = 14;

/// Half of the bits of the weight that follow.
const DIGIT_BITS: u32 = 9;

/// Buckets with fewer keys are sorted by comparisons.
const FEW: usize = 64;

/// Edges whose ends are followed upwards together.
const BLOCK: usize = 128;

impl Edges {
    /// Deals the keys, of which there are `counts` at the start of each band of `band_len` places. O(keys).
    pub(crate) fn new(
        keys: Vec<u64>,
        band_len: usize,
        counts: &[usize],
        ahead: [u32; 4],
        workspace: &mut Workspace,
    ) -> Self {
        let bucket = |key: u64| (key >> (u64::BITS - BUCKET_BITS)) as usize;
        let bands = || keys.chunks(band_len).zip(counts).flat_map(|(band, &count)| &band[..count]);
        let mut ends = vec![0; 1 << BUCKET_BITS];
        bands().for_each(|&key| ends[bucket(key)] += 1);
        places(&mut ends);
        let mut dealt = workspace.stale(keys.len(), 0);
        for &key in bands() {
            let place = &mut ends[bucket(key)];
            dealt[*place] = key;
            *place += 1;
        }
        Self { keys: dealt, spare: keys, ends, ahead }
    }

    /// Hands every edge that lies between two sets when its turn comes to the rule, but for those that it refuses anyway.
    ///
    /// An edge within a set stays within it. So those that have come to lie within one are left out before a bucket is
    /// sorted, without asking for their order (as in filter-Kruskal: Osipov, Sanders and Singler, ALENEX 2009), and block by
    /// block once more when it is.
    ///
    /// How far it is to a root, and whether two ends have one already, no processor can guess, and each wrong guess costs
    /// more than all else that is done for an edge. So both ends are taken two steps up without a branch, the ways of many
    /// edges at once, and edges whose ends meet are left out, and those that the rule refuses at one of them. What remains
    /// mostly stands at two roots; which they are by then is asked again, one edge after the other. O(edges · log pixels).
    pub(crate) fn between_sets(
        mut self,
        sets: &mut UnionFind,
        workspace: &mut Workspace,
        rule: &mut impl Rule,
    ) {
        let ahead = self.ahead;
        let edge = |key: u64| {
            let p = key as u32 / ahead.len() as u32;
            let q = p.wrapping_add(ahead[key as usize % ahead.len()]);
            PixelEdge { weight: f32::from_bits((key >> u32::BITS) as u32), p, q }
        };
        let mut apart = [(edge(0), (0, 0)); BLOCK];
        let mut start = 0;
        for &end in &self.ends {
            let bucket = &mut self.keys[start..end];
            start = end;
            let mut count = 0;
            for &key in &*bucket {
                let PixelEdge { p, q, .. } = edge(key);
                self.spare[count] = key;
                count += usize::from(sets.two_up(p as usize) != sets.two_up(q as usize));
            }
            let keys = &mut self.spare[..count];
            sort(keys, &mut bucket[..count]);
            for block in keys.chunks(BLOCK) {
                let mut count = 0;
                let lightest = edge(block[0]).weight;
                for &key in block {
                    let edge = edge(key);
                    let (p, q) = (sets.two_up(edge.p as usize), sets.two_up(edge.q as usize));
                    apart[count] = (edge, (p, q));
                    let is_shut = rule.refuses(p, lightest) | rule.refuses(q, lightest);
                    count += usize::from((p != q) & !is_shut);
                }
                for &(edge, (p, q)) in &apart[..count] {
                    let (p, q) = (sets.find(p), sets.find(q));
                    if p != q {
                        rule.meet(sets, edge, (p, q));
                    }
                }
            }
        }
        workspace.shelve(self.keys);
        workspace.shelve(self.spare);
    }
}

/// Sorts the keys of a bucket, whose numbers ascend; `spare` is as long.
///
/// A radix sort from the lower digit on (Knuth 5.2.5). O(keys).
fn sort(keys: &mut [u64], spare: &mut [u64]) {
    if keys.len() < FEW {
        keys.sort_unstable();
        return;
    }
    let pass = |from: &[u64], to: &mut [u64], shift: u32| {
        let digit = |key: u64| (key >> shift) as usize % (1 << DIGIT_BITS);
        let mut ends = [0; 1 << DIGIT_BITS];
        from.iter().for_each(|&key| ends[digit(key)] += 1);
        places(&mut ends);
        for &key in from {
            let place = &mut ends[digit(key)];
            to[*place] = key;
            *place += 1;
        }
    };
    pass(keys, spare, u32::BITS);
    pass(spare, keys, u32::BITS + DIGIT_BITS);
}

/// Turns counts into the places where each begins.
fn places(counts: &mut [usize]) {
    let mut place = 0;
    for count in counts {
        place += std::mem::replace(count, place);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_bucket_is_sorted_as_by_comparisons(
            // Few weights make many equal ones.
            (weights, different) in (prop::collection::vec(any::<u32>(), 0..300), 1_u32..1 << (2 * DIGIT_BITS)),
        ) {
            let numbered = (0_u64..).zip(&weights).map(|(i, w)| u64::from(w % different) << u32::BITS | i);
            let mut keys: Vec<u64> = numbered.collect();
            let mut expected = keys.clone();
            expected.sort();
            let mut spare = vec![0; keys.len()];
            sort(&mut keys, &mut spare);
            prop_assert_eq!(keys, expected);
        }
    }
}
