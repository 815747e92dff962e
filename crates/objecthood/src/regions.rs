//! Label maps and region graphs: the data that stages pass to each other.

use std::ops::Range;
use std::sync::OnceLock;

use rayon::prelude::*;

use crate::raster::Raster;
use crate::union_find::UnionFind;

/// Number of a segment (superpixel, facet, shape) within its [`Segments`], counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SegmentId(pub u32);

impl SegmentId {
    /// The number as an index into per-segment lists.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A label map: every pixel belongs to one segment or to none.
///
/// Segments are numbered 0..count. A segment may be empty.
#[derive(Clone, Debug)]
pub struct Segments {
    labels: Raster<i32>,
    count: usize,
    /// The runs of equal labels, which many stages visit instead of pixels; found on first use.
    runs: OnceLock<Runs>,
}

impl PartialEq for Segments {
    fn eq(&self, other: &Self) -> bool {
        self.labels == other.labels && self.count == other.count
    }
}

impl Eq for Segments {}

impl Segments {
    /// Label of a pixel that belongs to no segment.
    pub const NONE: i32 = -1;

    /// Segments from any label map: negative labels = none, the other labels are renumbered from 0 in ascending order.
    pub fn from_labels(labels: &Raster<i32>) -> Self {
        let mut values: Vec<i32> = labels.as_slice().iter().copied().filter(|&l| l >= 0).collect();
        values.sort_unstable();
        values.dedup();
        let number = |&l: &i32| values.binary_search(&l).map_or(Self::NONE, |k| k as i32);
        Self::from_numbered(labels.map(number), values.len())
    }

    /// Segments whose labels already are -1 or 0..count.
    pub(crate) fn from_numbered(labels: Raster<i32>, count: usize) -> Self {
        debug_assert!(labels.as_slice().iter().all(|&l| (-1..count as i32).contains(&l)));
        Self { labels, count, runs: OnceLock::new() }
    }

    /// The label of every pixel; [`Self::NONE`] or 0..count.
    #[inline]
    pub fn labels(&self) -> &Raster<i32> {
        &self.labels
    }

    /// Gives up the labels, so that another label map can reuse their memory.
    pub(crate) fn into_labels(self) -> Raster<i32> {
        self.labels
    }

    /// Number of segments.
    #[inline]
    pub fn count(&self) -> usize {
        self.count
    }

    /// The segment of the pixel with index `i`.
    #[inline]
    pub fn at(&self, i: usize) -> Option<SegmentId> {
        u32::try_from(self.labels[i]).ok().map(SegmentId)
    }

    /// The pixels that belong to a segment, as (pixel index, segment index), in scan order.
    pub(crate) fn members(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.labels
            .as_slice()
            .iter()
            .enumerate()
            .filter_map(|(i, &l)| usize::try_from(l).ok().map(|s| (i, s)))
    }

    /// The [`runs`] of its labels.
    pub(crate) fn runs(&self) -> impl Iterator<Item = (Range<usize>, usize)> + '_ {
        self.runs_in(0..self.labels.height())
    }

    /// The runs in some of the rows.
    pub(crate) fn runs_in(&self, rows: Range<usize>) -> impl Iterator<Item = (Range<usize>, usize)> + '_ {
        self.kept_runs().within(rows)
    }

    /// Finds the runs. Call it before several threads need them; otherwise each thread searches for itself.
    pub(crate) fn find_runs(&self) {
        self.kept_runs();
    }

    fn kept_runs(&self) -> &Runs {
        self.runs.get().unwrap_or_else(|| {
            // Outside the lock: while a thread waits inside, rayon may give it another task that needs the same runs.
            let found = Runs::of(&self.labels);
            self.runs.get_or_init(|| found)
        })
    }

    /// The [`runs`](Self::runs) of every segment. O(runs).
    pub(crate) fn runs_of_each(&self) -> RunsOfEach {
        let mut ends = vec![0; self.count];
        self.runs().for_each(|(_, s)| ends[s] += 1);
        let mut first = 0;
        ends.iter_mut().for_each(|end| first += std::mem::replace(end, first));
        let mut runs = vec![0..0; first];
        for (run, s) in self.runs() {
            runs[ends[s]] = run;
            ends[s] += 1;
        }
        RunsOfEach { runs, ends }
    }

    /// The coarser label map in which segment `s` becomes segment `group_of[s]` of `count` groups.
    pub(crate) fn grouped(&self, group_of: &[u32], count: usize) -> Self {
        let label = |&l: &i32| usize::try_from(l).map_or(Self::NONE, |s| group_of[s] as i32);
        Self::from_numbered(self.labels.map(label), count)
    }
}

/// The stored [`runs`] of a label map. O(pixels) to find them, parallel over bands of rows; O(1) to start at any row.
#[derive(Clone, Debug, Default)]
struct Runs {
    /// First pixel, the pixel after the last, label.
    all: Vec<[u32; 3]>,
    /// For each row, the number of runs in it and in all rows above.
    upto: Vec<u32>,
}

impl Runs {
    fn of(labels: &Raster<i32>) -> Self {
        let height = labels.height();
        // One band per thread.
        let rows = height.div_ceil(rayon::current_num_threads());
        let tops: Vec<usize> = (0..height).step_by(rows).collect();
        let band = |&top: &usize| Self::of_rows(labels, top..height.min(top + rows));
        let bands: Vec<Self> = tops.par_iter().map(band).collect();
        bands.into_iter().reduce(Self::followed_by).unwrap_or_default()
    }

    fn of_rows(labels: &Raster<i32>, rows: Range<usize>) -> Self {
        let mut found = Self::default();
        for row in rows {
            let runs = runs(labels, row..row + 1);
            found.all.extend(runs.map(|(run, s)| [run.start, run.end, s].map(|x| x as u32)));
            found.upto.push(found.all.len() as u32);
        }
        found
    }

    fn followed_by(mut self, below: Self) -> Self {
        let above = self.all.len() as u32;
        self.all.extend(below.all);
        self.upto.extend(below.upto.into_iter().map(|upto| above + upto));
        self
    }

    fn within(&self, rows: Range<usize>) -> impl Iterator<Item = (Range<usize>, usize)> + '_ {
        let above = |row: usize| row.checked_sub(1).map_or(0, |last| self.upto[last] as usize);
        let [first, end] = [rows.start, rows.end].map(above);
        self.all[first..end].iter().map(|run| {
            let [start, end, segment] = run.map(|x| x as usize);
            (start..end, segment)
        })
    }
}

/// The runs of every segment, in scan order. Segments can be processed in parallel, and sums over the pixels of a segment keep
/// their order.
pub(crate) struct RunsOfEach {
    /// Segment by segment.
    runs: Vec<Range<usize>>,
    /// The end of each segment's runs in `runs`.
    ends: Vec<usize>,
}

impl RunsOfEach {
    /// Applies `look` to the runs of every segment; parallel over segments.
    pub(crate) fn map<T: Send>(&self, look: impl Fn(usize, &[Range<usize>]) -> T + Sync) -> Vec<T> {
        let start = |s: usize| if s == 0 { 0 } else { self.ends[s - 1] };
        let of = |s: usize| look(s, &self.runs[start(s)..self.ends[s]]);
        (0..self.ends.len()).into_par_iter().map(of).collect()
    }
}

/// The runs of equal labels along these rows, each as long as possible, as (pixel indices, label) in scan order. Negative labels
/// are left out.
pub(crate) fn runs(
    labels: &Raster<i32>,
    rows: Range<usize>,
) -> impl Iterator<Item = (Range<usize>, usize)> + '_ {
    let (labels, width) = (&labels.as_slice()[..rows.end * labels.width()], labels.width());
    let mut end = rows.start * width;
    let run = std::iter::from_fn(move || {
        let (start, &label) = (end, labels.get(end)?);
        end += run_length(&labels[start..start / width * width + width]);
        Some((start..end, label))
    });
    run.filter_map(|(pixels, label)| usize::try_from(label).ok().map(|label| (pixels, label)))
}

/// The connected piece that each of these [`runs`] of an image of this width belongs to, and the number of pieces: runs of one label that share a
/// column in adjacent rows are connected. O(runs · log(runs)).
pub(crate) fn connect(runs: &[(Range<usize>, usize)], width: usize) -> (Vec<u32>, usize) {
    let mut pieces = UnionFind::new(runs.len());
    let mut above = 0;
    for (k, (run, label)) in runs.iter().enumerate() {
        while runs[above].0.end + width <= run.start {
            above += 1;
        }
        let touching = (above..k).take_while(|&other| runs[other].0.start + width < run.end);
        for other in touching.filter(|&other| runs[other].1 == *label) {
            let (a, b) = (pieces.find(other), pieces.find(k));
            pieces.link(a.min(b), a.max(b));
        }
    }
    pieces.groups()
}

/// The number of labels at the start that equal the first one. Long runs are compared in strides.
pub(crate) fn run_length(labels: &[i32]) -> usize {
    // Labels compared at once.
    const STRIDE_PX: usize = 16;
    let Some(&own) = labels.first() else { return 0 };
    let is_same = |stride: &&[i32]| stride.iter().fold(0, |any, label| any | (label ^ own)) == 0;
    let passed = STRIDE_PX * labels.chunks_exact(STRIDE_PX).take_while(is_same).count();
    passed + labels[passed..].iter().take_while(|label| **label == own).count()
}

/// An undirected edge between two regions, with evidence from their common border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegionEdge<E> {
    /// The region with the smaller number.
    pub a: SegmentId,
    /// The region with the larger number.
    pub b: SegmentId,
    /// The evidence.
    pub evidence: E,
}

/// The pairs of regions that touch, with their evidence. Edges are sorted by (a, b), a < b, each pair once.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionGraph<E> {
    regions: usize,
    edges: Vec<RegionEdge<E>>,
}

impl<E> RegionGraph<E> {
    /// Number of regions, with or without neighbours.
    pub fn regions(&self) -> usize {
        self.regions
    }

    /// The edges, sorted by (a, b).
    pub fn edges(&self) -> &[RegionEdge<E>] {
        &self.edges
    }

    /// A graph of edges that are sorted by (a, b), a < b, each pair once.
    pub(crate) fn from_sorted(regions: usize, edges: Vec<RegionEdge<E>>) -> Self {
        debug_assert!(edges.is_sorted_by(|one, next| (one.a, one.b) < (next.a, next.b)));
        Self { regions, edges }
    }

    /// Changes the evidence of each pair of regions.
    pub(crate) fn update(mut self, mut change: impl FnMut([SegmentId; 2], &mut E)) -> Self {
        self.edges.iter_mut().for_each(|edge| change([edge.a, edge.b], &mut edge.evidence));
        self
    }

    /// The same graph with other evidence.
    pub fn map<F>(&self, mut f: impl FnMut(&RegionEdge<E>) -> F) -> RegionGraph<F> {
        let edges = self.edges.iter().map(|e| RegionEdge { a: e.a, b: e.b, evidence: f(e) }).collect();
        RegionGraph { regions: self.regions, edges }
    }
}

impl<E: Default> RegionGraph<E> {
    /// Collects samples along the borders of regions: `add` adds each sample to the evidence of its pair, in the order of the
    /// samples. Samples within one region are left out. O(n log n).
    pub(crate) fn gather<S>(
        regions: usize,
        samples: impl IntoIterator<Item = (SegmentId, SegmentId, S)>,
        mut add: impl FnMut(&mut E, S),
    ) -> Self {
        let between = samples.into_iter().filter(|(a, b, _)| a != b);
        // One number for both regions compares faster.
        let pair = |a: SegmentId, b: SegmentId| u64::from(a.min(b).0) << 32 | u64::from(a.max(b).0);
        let mut samples: Vec<_> = between.map(|(a, b, sample)| (pair(a, b), sample)).collect();
        samples.sort_by_key(|&(pair, _)| pair);
        let mut edges: Vec<RegionEdge<E>> = Vec::new();
        for (pair, sample) in samples {
            let (a, b) = (SegmentId((pair >> 32) as u32), SegmentId(pair as u32));
            if edges.last().is_none_or(|edge| (edge.a, edge.b) != (a, b)) {
                edges.push(RegionEdge { a, b, evidence: E::default() });
            }
            if let Some(edge) = edges.last_mut() {
                add(&mut edge.evidence, sample);
            }
        }
        Self { regions, edges }
    }
}

impl RegionGraph<u32> {
    /// Counts how often each unordered pair of different regions occurs in `pairs`. O(n log n).
    pub fn from_pairs(regions: usize, pairs: impl IntoIterator<Item = (SegmentId, SegmentId)>) -> Self {
        // Along a border the same pair often repeats; repeats are counted before sorting.
        let mut counted: Vec<(SegmentId, SegmentId, u32)> = Vec::new();
        for (a, b) in pairs {
            match counted.last_mut() {
                Some(last) if (last.0, last.1) == (a, b) => last.2 += 1,
                _ => counted.push((a, b, 1)),
            }
        }
        Self::gather(regions, counted, |count, times| *count += times)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::testing::raster;

    proptest! {
        #[test]
        fn runs_are_the_longest_in_their_rows(
            labels in (1_usize..40, 1_usize..4)
                .prop_flat_map(|size| raster(size, prop_oneof![1 => Just(-1), 1 => Just(3), 9 => Just(0)])),
        ) {
            let width = labels.width();
            let segments = Segments::from_numbered(labels, 4);
            let runs: Vec<_> = segments.runs().collect();
            let members: Vec<_> = runs.iter().flat_map(|(run, s)| run.clone().map(move |i| (i, *s))).collect();
            prop_assert_eq!(members, segments.members().collect::<Vec<_>>());
            prop_assert!(runs.iter().all(|(run, _)| run.start / width == (run.end - 1) / width));
            for pair in runs.windows(2) {
                let [(a, own), (b, next)] = pair else { continue };
                prop_assert!(a.end < b.start || own != next || b.start % width == 0, "{:?}", runs);
            }
        }
    }

    #[test]
    fn runs_in_some_rows_are_theirs_on_any_number_of_threads() {
        let labels = Raster::from_vec(7, 11, (0..77).map(|i| i * i / 5 % 4 - 1).collect()).unwrap();
        for threads in [1, 2, 3, 8, 16] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let segments = Segments::from_numbered(labels.clone(), 3);
            pool.install(|| segments.find_runs());
            for rows in (0..=11).flat_map(|end| (0..=end).map(move |start| start..end)) {
                let found: Vec<_> = segments.runs_in(rows.clone()).collect();
                assert_eq!(
                    found,
                    runs(&labels, rows.clone()).collect::<Vec<_>>(),
                    "{threads} threads, {rows:?}"
                );
            }
        }
    }

    #[test]
    fn any_label_map_becomes_dense() {
        let labels = Raster::from_vec(3, 2, vec![7, -5, i32::MAX, 7, 0, -1]).unwrap();
        let segments = Segments::from_labels(&labels);
        assert_eq!(segments.labels().as_slice(), [1, -1, 2, 1, 0, -1]);
        assert_eq!(segments.count(), 3);
        assert_eq!(segments.at(0), Some(SegmentId(1)));
        assert_eq!(segments.at(1), None);
    }

    #[test]
    fn samples_are_added_in_their_order() {
        let samples =
            [(2, 1, 'a'), (0, 1, 'b'), (1, 2, 'c')].map(|(a, b, c)| (SegmentId(a), SegmentId(b), c));
        let graph: RegionGraph<String> = RegionGraph::gather(3, samples, String::push);
        assert_eq!(graph.edges().iter().map(|e| e.evidence.as_str()).collect::<Vec<_>>(), ["b", "ac"]);
    }

    #[test]
    fn pairs_are_counted_once_per_unordered_pair_and_sorted() {
        let pairs = [(2, 1), (0, 3), (3, 3), (1, 2)].map(|(a, b)| (SegmentId(a), SegmentId(b)));
        let graph = RegionGraph::from_pairs(4, pairs);
        let edges: Vec<_> = graph.edges().iter().map(|e| (e.a.0, e.b.0, e.evidence)).collect();
        assert_eq!(edges, [(0, 3, 1), (1, 2, 2)]);
    }
}
