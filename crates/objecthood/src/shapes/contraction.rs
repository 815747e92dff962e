//! Shapes of `context`: greedy contraction of a graph with signed weights (docs/CONTEXT.md 3.3).

use std::collections::{BTreeMap, BinaryHeap};

use crate::facets::Facets;
use crate::params;
use crate::regions::{RegionGraph, SegmentId, Segments};
use crate::shapes::border::BorderEvidence;
use crate::union_find::UnionFind;

/// An edge on the heap: the greatest weight comes first, then the greatest region numbers.
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

/// The grouping of facets to shapes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shapes {
    /// The shape of each facet that is no structure, numbered in the order of their first facets.
    pub of_facet: Vec<u32>,
    /// Number of shapes.
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

/// Sums the votes (m) of the borders between facets outside the structure. `structure`: the number of facets that are structure, the
/// first ones. Node k of the result is facet `structure` + k; if all facets are structure, there is no node. O(E log E).
pub fn sum_votes(
    borders: &RegionGraph<BorderEvidence>,
    structure: usize,
    params: &params::Contraction,
) -> RegionGraph<f64> {
    let free = |facet: SegmentId| facet.index().checked_sub(structure).map(|f| SegmentId(f as u32));
    let votes =
        borders.edges().iter().filter_map(|e| Some((free(e.a)?, free(e.b)?, e.evidence.vote_m(params))));
    RegionGraph::gather(borders.regions().saturating_sub(structure), votes, |sum: &mut f64, vote| {
        *sum += vote;
    })
}

/// Groups regions by greedy additive edge contraction (Keuper et al., ICCV 2015). Positive weights attract, negative weights repel.
/// The edge of greatest weight is contracted, and parallel edges add up, until no weight is above 0.
///
/// The weights are metres of border, so a long valley outvotes a short ridge. O(E log E), as long as no region has very many
/// neighbours.
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
        // Out of date: one of the regions was merged, or the weight has changed.
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::shapes::border::Fold;

    const REGIONS: u32 = 9;

    fn graph(edges: &[(u32, u32, f64)]) -> RegionGraph<f64> {
        let edges = edges.iter().map(|&(a, b, weight)| (SegmentId(a), SegmentId(b), weight));
        RegionGraph::gather(REGIONS as usize, edges, |sum: &mut f64, weight| *sum += weight)
    }

    /// Sums the weights between any two groups, joins the two groups with the greatest sum, and starts again.
    fn naive(weights: &RegionGraph<f64>) -> Vec<u32> {
        let mut group: Vec<u32> = (0..REGIONS).collect();
        loop {
            let mut sums: BTreeMap<(u32, u32), f64> = BTreeMap::new();
            for edge in weights.edges() {
                let [a, b] = [edge.a, edge.b].map(|k| group[k.index()]);
                if a != b {
                    *sums.entry((a.min(b), a.max(b))).or_default() += edge.evidence;
                }
            }
            // On ties the last one.
            let best = sums.into_iter().reduce(|best, next| if next.1 >= best.1 { next } else { best });
            let Some(((a, b), _)) = best.filter(|&(_, sum)| sum > 0.0) else { break };
            group.iter_mut().filter(|k| **k == b).for_each(|k| *k = a);
        }
        let mut names = group.clone();
        names.sort_unstable();
        names.dedup();
        group.iter().map(|k| names.binary_search(k).expect("it is a name") as u32).collect()
    }

    fn pair() -> impl Strategy<Value = (u32, u32)> {
        (0..REGIONS, 0..REGIONS)
    }

    proptest! {
        #[test]
        fn the_groups_are_the_naive_ones(
            // Small whole numbers add up exactly, and tie.
            edges in prop::collection::vec((pair(), -3_i8..=3), 0..30),
        ) {
            let edges: Vec<_> = edges.into_iter().map(|((a, b), weight)| (a, b, f64::from(weight))).collect();
            let weights = graph(&edges);
            let shapes = contract(&weights);
            prop_assert_eq!(&shapes.of_facet, &naive(&weights));
            prop_assert_eq!(shapes.count, shapes.of_facet.iter().max().map_or(0, |most| *most as usize + 1));
        }

        #[test]
        fn without_ties_the_order_of_the_regions_does_not_matter(
            edges in prop::collection::vec((pair(), any::<bool>()), 0..30),
            order in Just((0..REGIONS).collect::<Vec<u32>>()).prop_shuffle(),
        ) {
            // Powers of two: no two sums are equal.
            let weight = |(k, &((a, b), is_for)): (usize, &((u32, u32), bool))| {
                (a, b, if is_for { 1.0 } else { -1.0 } * f64::from(1 << k))
            };
            let edges: Vec<_> = edges.iter().enumerate().map(weight).collect();
            let renamed: Vec<_> =
                edges.iter().map(|&(a, b, w)| (order[a as usize], order[b as usize], w)).collect();
            let [plain, other] = [&edges, &renamed].map(|edges| contract(&graph(edges)));
            prop_assert_eq!(plain.count, other.count);
            for (a, b) in (0..REGIONS as usize).flat_map(|a| (0..a).map(move |b| (a, b))) {
                let together = plain.of_facet[a] == plain.of_facet[b];
                let [c, d] = [a, b].map(|k| order[k] as usize);
                prop_assert_eq!(together, other.of_facet[c] == other.of_facet[d], "{} {}", a, b);
            }
        }
    }

    #[test]
    fn what_agrees_is_one_and_what_disagrees_is_parted() {
        let chain = |weight: f64| graph(&(1..REGIONS).map(|b| (b - 1, b, weight)).collect::<Vec<_>>());
        assert_eq!(contract(&chain(0.1)).count, 1);
        assert_eq!(contract(&chain(-0.1)).of_facet, (0..REGIONS).collect::<Vec<_>>());
        assert_eq!(contract(&chain(0.0)).count, REGIONS as usize, "no vote joins nothing");
    }

    #[test]
    fn a_long_valley_outvotes_a_short_ridge() {
        // 0 and 1 agree strongly; 2 agrees with 0, but disagrees more with 1.
        let weights = [(0, 1, 0.5), (0, 2, 0.2), (1, 2, -0.3)];
        let shapes = contract(&graph(&weights));
        assert_eq!(shapes.of_facet[..3], [0, 0, 1]);
    }

    #[test]
    fn votes_leave_the_structure_out() {
        let fold = |angle_deg: f64| BorderEvidence {
            folds: vec![Fold { angle_deg, length_m: 0.1 }],
            ..Default::default()
        };
        let pairs = [(0, 2, 90.0), (1, 3, 90.0), (2, 3, 90.0), (3, 4, -90.0)];
        let pairs = pairs.map(|(a, b, angle)| (SegmentId(a), SegmentId(b), fold(angle)));
        let borders = RegionGraph::gather(5, pairs, |evidence: &mut BorderEvidence, next| *evidence = next);
        let votes = sum_votes(&borders, 2, &params::Contraction::default());
        let got: Vec<_> = votes.edges().iter().map(|e| (e.a.0, e.b.0, e.evidence)).collect();
        assert_eq!((votes.regions(), got), (3, vec![(0, 1, 0.1), (1, 2, -0.1)]));
    }
}
