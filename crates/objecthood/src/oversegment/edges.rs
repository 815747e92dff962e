//! Visits edges in the order of their weights and skips the edges within one set.

use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::oversegment::pixel_edge::{PixelEdge, STEPS, by_direction};
use crate::union_find::UnionFind;

/// Edges of a pixel graph, dealt into buckets by the leading bits of their weights.
pub(crate) struct Edges {
    dealt: Dealt,
    /// Working memory: first for dealing a band, later for the largest bucket and, if enough is left, for sorting it.
    spare: Buffer<u64>,
    directions: Directions,
}

/// The keys of edges, band by band, and bucket by bucket within a band. Within a bucket of a band the edge numbers ascend.
///
/// The upper 32 bits of a key are the bits of the edge's weight, the lower 32 its number. Weights are not negative, so keys sort
/// by weight, and at equal weight by number.
struct Dealt {
    keys: Buffer<u64>,
    /// Number of places of a band; some at its end may stay free.
    band_len: usize,
    /// The end of each bucket in each band.
    ends: Buffer<u32>,
}

/// For each direction, the difference of the pixel indices q - p of an edge.
#[derive(Clone, Copy)]
struct Directions([u32; 4]);

/// Decides about edges between two sets.
pub(crate) trait Rule {
    /// Whether no edge of this weight or more can ever join the set of `root`. If `root` is no longer a root, nothing is
    /// refused.
    fn refuses(&self, root: usize, weight: f32) -> bool;

    /// Decides about an edge whose ends have these roots.
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

/// Leading bits of a weight that number its bucket: the exponent and five more; the sign is always 0.
const BUCKET_BITS: u32 = 13;

/// Number of buckets.
const BUCKETS: usize = 1 << BUCKET_BITS;

/// Pixels whose edges are dealt together. Dealing writes to some three hundred places of 0.4 MB in turn, and reads and writes
/// as much again in order; both fit the second-level cache. (On an Intel Xeon with 2 MB, 8 and 32 thousand pixels were no
/// faster.)
const BAND_PX: usize = 1 << 14;

/// Bits of one pass of the radix sort: half of the bits of a weight below `BUCKET_BITS`.
const DIGIT_BITS: u32 = 9;

/// Buckets with fewer keys are sorted by comparisons, which is faster there.
const FEW: usize = 64;

/// Edges whose ends are followed towards their roots together, so that memory accesses overlap.
const BLOCK: usize = 128;

impl Edges {
    /// Deals the edges of an image of this width whose bits are set in `open`. O(pixels + edges found); parallel over bands.
    pub(crate) fn new(weights: &[f32], open: &[u8], width: usize) -> Self {
        let band_px = (BAND_PX / width).max(1) * width;
        let band_len = STEPS.len() * band_px;
        let bands = open.len().div_ceil(band_px);
        let mut keys = Buffer::stale(weights.len(), 0);
        // In turn: the counts, the starts and the ends of the buckets.
        let mut ends = Buffer::filled(bands * BUCKETS, 0);
        // A thread deals its bands one after the other in the same working memory. Two of these hold all but the largest buckets.
        let threads = rayon::current_num_threads().min(bands);
        let room = band_len.min(weights.len());
        let mut spare = Buffer::stale(threads.max(2) * room, 0);
        let share = bands.div_ceil(threads);
        let shares = keys.par_chunks_mut(share * band_len).zip(ends.par_chunks_mut(share * BUCKETS));
        shares.zip(spare.par_chunks_mut(room)).enumerate().for_each(|(i, ((keys, ends), spare))| {
            let bands = keys.chunks_mut(band_len).zip(ends.chunks_exact_mut(BUCKETS));
            for (band, (keys, ends)) in (i * share..).zip(bands) {
                let first = band * band_px;
                let open = &open[first..][..keys.len() / STEPS.len()];
                let weights = &weights[STEPS.len() * first..][..keys.len()];
                let count = open_keys(weights, open, width, STEPS.len() * first, keys, ends);
                deal(&mut keys[..count], &mut spare[..count], ends);
            }
        });
        let ahead = STEPS.map(|(du, dv)| (dv * width).wrapping_add_signed(du) as u32);
        Self { dealt: Dealt { keys, band_len, ends }, spare, directions: Directions(ahead) }
    }

    /// Calls the rule with the edges in the order of their weights. Edges within one set are skipped, and edges that the rule
    /// refuses.
    ///
    /// An edge within a set stays within it. So edges within a set are skipped before their bucket is sorted (as in
    /// filter-Kruskal: Osipov, Sanders and Singler, ALENEX 2009), and once more, block by block, after sorting.
    ///
    /// A processor cannot predict the distance of a root, or whether both ends have the same root, and each wrong prediction
    /// costs more than all other work for an edge. So both ends first move two steps up without a branch, for many edges at once.
    /// An edge is skipped if its ends meet there or if the rule refuses it at one of them. The ends of the others are mostly at
    /// their roots already; the search for the roots is finished edge by edge. O(pixels + edges · log pixels).
    pub(crate) fn between_sets(mut self, sets: &mut UnionFind, rule: &mut impl Rule) {
        let counts = self.dealt.count_keys();
        let most = counts.iter().fold(0, |most, &count| most.max(count as usize));
        if self.spare.len() < most {
            // Freed before it is replaced, so that the two are never in memory together.
            self.spare = Vec::new().into();
            self.spare = Buffer::stale(most, 0);
        }
        let (keys, room) = self.spare.split_at_mut(most);
        let directions = self.directions;
        let mut apart = [(directions.edge(0), (0, 0)); BLOCK];
        for bucket in (0..BUCKETS).filter(|&bucket| counts[bucket] > 0) {
            let mut count = 0;
            for of_band in self.dealt.bucket(bucket) {
                for &key in of_band {
                    let PixelEdge { p, q, .. } = directions.edge(key);
                    keys[count] = key;
                    count += usize::from(sets.two_up(p as usize) != sets.two_up(q as usize));
                }
            }
            let keys = &mut keys[..count];
            sort(keys, room);
            keys.chunks(BLOCK).for_each(|block| directions.hand_over(block, &mut apart, sets, rule));
        }
    }
}

impl Dealt {
    fn bands(&self) -> impl Iterator<Item = (&[u64], &[u32])> {
        self.keys.chunks(self.band_len).zip(self.ends.chunks_exact(BUCKETS))
    }

    /// The number of keys in each bucket.
    fn count_keys(&self) -> [u32; BUCKETS] {
        let mut counts = [0; BUCKETS];
        for (_, ends) in self.bands() {
            counts[0] += ends[0];
            for ((count, start), end) in counts[1..].iter_mut().zip(ends).zip(&ends[1..]) {
                *count += end - start;
            }
        }
        counts
    }

    /// The keys of a bucket, band by band.
    #[inline]
    fn bucket(&self, bucket: usize) -> impl Iterator<Item = &[u64]> {
        self.bands().map(move |(keys, ends)| {
            let start = bucket.checked_sub(1).map_or(0, |before| ends[before]);
            &keys[start as usize..ends[bucket] as usize]
        })
    }
}

impl Directions {
    /// The edge with this key.
    #[inline(always)]
    fn edge(self, key: u64) -> PixelEdge {
        let Self(ahead) = self;
        let p = key as u32 / ahead.len() as u32;
        let q = p.wrapping_add(ahead[key as usize % ahead.len()]);
        PixelEdge { weight: f32::from_bits((key >> u32::BITS) as u32), p, q }
    }

    /// Passes a block of edges to the rule, in their order. `apart`: working memory for the edges whose ends may lie in two sets.
    #[inline]
    fn hand_over(
        self,
        block: &[u64],
        apart: &mut [(PixelEdge, (usize, usize)); BLOCK],
        sets: &mut UnionFind,
        rule: &mut impl Rule,
    ) {
        let mut count = 0;
        let lightest = self.edge(block[0]).weight;
        for &key in block {
            let edge = self.edge(key);
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

/// Deals the keys of a band into buckets, using `spare`. `counts`: the number of keys of each bucket; afterwards the end of each
/// bucket.
fn deal(keys: &mut [u64], spare: &mut [u64], counts: &mut [u32]) {
    places(counts);
    for &key in &*keys {
        let place = &mut counts[bucket(key)];
        spare[*place as usize] = key;
        *place += 1;
    }
    keys.copy_from_slice(spare);
}

/// The bucket of a key.
#[inline(always)]
fn bucket(key: u64) -> usize {
    (key >> (u64::BITS - 1 - BUCKET_BITS)) as usize % BUCKETS
}

/// Writes the keys of the open edges to the start of `keys`, counts them bucket by bucket, and returns their number. `number`: the
/// number of the first pixel's first edge.
fn open_keys(
    weights: &[f32],
    open: &[u8],
    width: usize,
    number: usize,
    keys: &mut [u64],
    counts: &mut [u32],
) -> usize {
    let mut number = number as u64;
    let mut count = 0;
    for (weights, open) in weights.chunks_exact(STEPS.len() * width).zip(open.chunks_exact(width)) {
        let [right, down, down_right, down_left] = by_direction(weights);
        let weights = right.iter().zip(down).zip(down_right.iter().zip(down_left));
        for (&open, ((a, b), (c, d))) in open.iter().zip(weights) {
            if open % (1 << STEPS.len()) != 0 {
                for (k, weight) in (0_u32..).zip([a, b, c, d]) {
                    let key = u64::from(weight.to_bits()) << u32::BITS | (number + u64::from(k));
                    let is_open = u32::from(open) >> k & 1;
                    keys[count] = key;
                    count += is_open as usize;
                    counts[bucket(key)] += is_open;
                }
            }
            number += STEPS.len() as u64;
        }
    }
    count
}

/// Sorts the keys of a bucket, whose numbers ascend.
///
/// A radix sort from the lower digit up (Knuth 5.2.5), O(keys), if `room` is large enough and there are keys enough. Otherwise the
/// keys are sorted by comparisons, unless they are in order already. `room` is too small only when most weights of the image are
/// nearly equal.
fn sort(keys: &mut [u64], room: &mut [u64]) {
    let Some(spare) = room.get_mut(..keys.len()).filter(|spare| spare.len() >= FEW) else {
        if !keys.is_sorted() {
            keys.sort_unstable();
        }
        return;
    };
    let pass = |from: &[u64], to: &mut [u64], shift: u32| {
        let digit = |key: u64| (key >> shift) as usize % (1 << DIGIT_BITS);
        let mut ends = [0_u32; 1 << DIGIT_BITS];
        from.iter().for_each(|&key| ends[digit(key)] += 1);
        places(&mut ends);
        for &key in from {
            let place = &mut ends[digit(key)];
            to[*place as usize] = key;
            *place += 1;
        }
    };
    pass(keys, spare, u32::BITS);
    pass(spare, keys, u32::BITS + DIGIT_BITS);
}

/// Turns counts into start places.
fn places(counts: &mut [u32]) {
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
