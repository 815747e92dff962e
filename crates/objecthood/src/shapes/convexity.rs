//! Joins facets that meet in a convex edge into shapes (paper, eq. 5).

use glam::DVec3;

use crate::regions::{RegionGraph, Segments};
use crate::shapes::descriptor::Descriptor;
use crate::union_find::UnionFind;

/// Height (m) of the centre of one facet above the plane of the other, the larger of both heights: below 0 = ridge, the edge is
/// convex; above 0 = valley.
pub(crate) fn convexity_m(a: &Descriptor, b: &Descriptor) -> f64 {
    let [center_a, center_b] = [a, b].map(|d| DVec3::from(d.centroid_m));
    let rise_of_a = (center_a - center_b).dot(DVec3::from(b.normal));
    let rise_of_b = (center_b - center_a).dot(DVec3::from(a.normal));
    rise_of_a.max(rise_of_b)
}

/// Measures the convexity of every contact: the height (m) of the centre of one facet above the plane of the other, the larger of both
/// heights. Below 0 the edge is convex. O(E).
///
/// *Differs from the paper:* eq. 5 is not symmetric and does not define which facet is "2". Here both heights must be below 0
/// (PARITY.md 4: any other reading joins the table to the objects).
pub fn measure_convexities(contacts: &RegionGraph<u32>, facets: &[Descriptor]) -> RegionGraph<f64> {
    contacts.map(|e| convexity_m(&facets[e.a.index()], &facets[e.b.index()]))
}

/// Joins facets to shapes: connected components over convex edges between facets that both have a core pixel with a normal.
/// Shapes are numbered in the order of their roots in the union-find. O(E).
pub fn join_shapes(
    facets: &Segments,
    descriptors: &[Descriptor],
    convexities: &RegionGraph<f64>,
) -> Segments {
    let mut sets = UnionFind::new(facets.count());
    for edge in convexities.edges() {
        let (a, b) = (edge.a.index(), edge.b.index());
        let oriented = descriptors[a].core_normals > 0 && descriptors[b].core_normals > 0;
        if edge.evidence < 0.0 && oriented {
            let (a, b) = (sets.find(a), sets.find(b));
            if a != b {
                sets.link(a, b);
            }
        }
    }
    let (group_of, count) = sets.groups();
    facets.grouped(&group_of, count)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::raster::Raster;
    use crate::regions::SegmentId;

    /// A facet at `centroid_m` that faces `normal`.
    fn facet(centroid_m: [f64; 3], normal: [f64; 3]) -> Descriptor {
        Descriptor { centroid_m, normal, core_normals: 100 }
    }

    #[test]
    fn a_ridge_is_convex_and_a_valley_is_not() {
        // Two faces that meet at 90 degrees in an edge along x, seen from -z; up is -y.
        let (top, front) =
            (facet([0.0, 0.0, 1.05], [0.0, -1.0, 0.0]), facet([0.0, 0.05, 1.0], [0.0, 0.0, -1.0]));
        assert!((convexity_m(&top, &front) - -0.05).abs() < 1e-12);
        let (floor, wall) =
            (facet([0.0, 0.05, 1.0], [0.0, -1.0, 0.0]), facet([0.0, 0.0, 1.05], [0.0, 0.0, -1.0]));
        assert!((convexity_m(&floor, &wall) - 0.05).abs() < 1e-12);
    }

    #[test]
    fn shapes_are_components_over_convex_edges_between_oriented_facets() {
        let labels = Raster::from_vec(5, 1, vec![0, 1, 2, 3, -1]).unwrap();
        let facets = Segments::from_labels(&labels);
        let pairs = [(0, 1), (1, 2), (2, 3)].map(|(a, b)| (SegmentId(a), SegmentId(b)));
        let contacts = RegionGraph::from_pairs(4, pairs);
        let mut weights = [-0.01, 0.0, -0.02].into_iter();
        let convexities = contacts.map(|_| weights.next().unwrap());
        let mut described = vec![facet([0.0; 3], [0.0, 0.0, -1.0]); 4];
        let labels_of = |d: &[Descriptor]| join_shapes(&facets, d, &convexities).labels().as_slice().to_vec();
        assert_eq!(labels_of(&described), [0, 0, 1, 1, -1]);
        described[3].core_normals = 0;
        assert_eq!(labels_of(&described), [0, 0, 1, 2, -1]);
    }

    proptest! {
        #[test]
        fn convexity_is_symmetric(
            a in prop::array::uniform3(-1.0_f64..1.0), b in prop::array::uniform3(-1.0_f64..1.0),
            n in prop::array::uniform3(-1.0_f64..1.0), m in prop::array::uniform3(-1.0_f64..1.0),
        ) {
            prop_assert_eq!(convexity_m(&facet(a, n), &facet(b, m)), convexity_m(&facet(b, m), &facet(a, n)));
        }
    }

    proptest! {
        #[test]
        fn shapes_are_what_floods_over_convex_edges(
            (normals, edges) in (1_usize..12).prop_flat_map(|n| (
                prop::collection::vec(0_u32..4, n),
                prop::collection::vec((0..n as u32, 0..n as u32, -2_i32..3), 0..2 * n),
            )),
        ) {
            let n = normals.len();
            let facets = Segments::from_labels(&Raster::from_vec(n, 1, (0..n as i32).collect()).unwrap());
            let described: Vec<_> =
                normals.iter().map(|&k| Descriptor { core_normals: k, ..Default::default() }).collect();
            let graph = RegionGraph::from_pairs(n, edges.iter().map(|e| (SegmentId(e.0), SegmentId(e.1))));
            let between = |a: u32, b: u32| edges.iter().find(|e| (e.0, e.1) == (a, b) || (e.0, e.1) == (b, a));
            let graph = graph.map(|e| f64::from(between(e.a.0, e.b.0).unwrap().2));

            let joined = |a: usize, b: usize| {
                let convex = between(a as u32, b as u32).is_some_and(|e| e.2 < 0);
                convex && normals[a] > 0 && normals[b] > 0
            };
            let mut flooded: Vec<Option<usize>> = vec![None; n];
            for start in 0..n {
                let mut open = vec![start];
                while let Some(a) = open.pop() {
                    if flooded[a].is_none() {
                        flooded[a] = Some(start);
                        open.extend((0..n).filter(|&b| joined(a, b)));
                    }
                }
            }
            let found = join_shapes(&facets, &described, &graph);
            let labels = found.labels().as_slice();
            let first: Vec<_> = labels.iter().map(|l| labels.iter().position(|m| m == l)).collect();
            prop_assert_eq!(first, flooded);
            prop_assert_eq!(found.count() as i32, labels.iter().max().unwrap() + 1);
        }
    }
}
