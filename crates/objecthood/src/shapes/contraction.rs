//! Shapes of `context`: a signed graph, contracted greedily (METHOD 3.8).

use std::collections::{BTreeMap, BinaryHeap};

use crate::facets::Facets;
use crate::params;
use crate::regions::{RegionGraph, SegmentId, Segments};
use crate::shapes::border::BorderEvidence;
use crate::union_find::UnionFind;

/// An edge on the heap: by weight, then by both regions, greatest first.
#[derive(Clone, Copy, PartialEq)]
struct Contraction {
    weight: f64,
    a: u32,
    b: u32,
}

impl Eq for Contraction {}

impl Ord for Contraction {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.weight.total_cmp(&other.weight).then_with(|| (self.a, self.b).cmp(&(other.a, other.b)))
    }
}

impl PartialOrd for Contraction {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// Which facets are one shape.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shapes {
    /// The shape of each facet that is no structure, numbered in the order of their first facets.
    pub of_facet: Vec<u32>,
    /// How many there are.
    pub count: usize,
}

impl Shapes {
    /// The label map: all structure is region 0, shape k is region k + 1.
    pub(crate) fn with_structure(&self, facets: &Facets) -> Segments {
        let of_structure = std::iter::repeat_n(0, facets.structure);
        let region_of: Vec<u32> = of_structure.chain(self.of_facet.iter().map(|shape| shape + 1)).collect();
        facets.segments.grouped(&region_of, self.count + 1)
    }
}

/// The votes of the borders between facets that are no structure; a facet keeps its number less those of the structure.
pub fn votes(
    borders: &RegionGraph<BorderEvidence>,
    structure: usize,
    params: &params::Contraction,
) -> RegionGraph<f64> {
    let free = |facet: SegmentId| facet.index().checked_sub(structure).map(|f| SegmentId(f as u32));
    let votes =
        borders.edges().iter().filter_map(|e| Some((free(e.a)?, free(e.b)?, e.evidence.vote_m(params))));
    RegionGraph::gather(borders.regions() - structure, votes, |sum: &mut f64, vote| *sum += vote)
}

/// Groups regions so that what is joined agrees and what is parted disagrees: greedy additive edge contraction (Keuper et
/// al., ICCV 2015). The edge of greatest weight is contracted, parallel edges add up, until no weight is above 0.
///
/// The weights are metres of border, so a long valley outvotes a short ridge. O(E log E).
pub fn contract(weights: &RegionGraph<f64>) -> Shapes {
    let mut neighbours: Vec<BTreeMap<u32, f64>> = vec![BTreeMap::new(); weights.regions()];
    let mut heap = BinaryHeap::new();
    for edge in weights.edges() {
        let (a, b, weight) = (edge.a.0, edge.b.0, edge.evidence);
        neighbours[a as usize].insert(b, weight);
        neighbours[b as usize].insert(a, weight);
        if weight > 0.0 {
            heap.push(Contraction { weight, a, b });
        }
    }
    let mut sets = UnionFind::new(weights.regions());
    while let Some(Contraction { weight, a, b }) = heap.pop() {
        // Out of date when either was merged or the weight has changed since.
        if neighbours[a as usize].get(&b) != Some(&weight) {
            continue;
        }
        sets.link(a as usize, b as usize);
        neighbours[a as usize].remove(&b);
        for (t, weight) in std::mem::take(&mut neighbours[b as usize]) {
            if t == a {
                continue;
            }
            let sum = neighbours[a as usize].get(&t).unwrap_or(&0.0) + weight;
            neighbours[a as usize].insert(t, sum);
            neighbours[t as usize].remove(&b);
            neighbours[t as usize].insert(a, sum);
            if sum > 0.0 {
                heap.push(Contraction { weight: sum, a: a.min(t), b: a.max(t) });
            }
        }
    }
    let (of_facet, count) = sets.groups();
    Shapes { of_facet, count }
}
