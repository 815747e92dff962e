//! Support in `paper`: of two shapes in contact the higher one stands on the other (eq. 6 to 8).

use glam::{DVec3, Vec3};

use crate::discovery::ids::NodeId;
use crate::discovery::support_graph::{NodeKind, SupportEdge, SupportGraph, SupportNode};
use crate::discovery::up::Up;
use crate::raster::Raster;
use crate::regions::{RegionGraph, Segments};
use crate::shapes::descriptor::Descriptor;

/// A shape with fewer points has height 0.
const MIN_POINTS: usize = 3;

/// Builds the support graph of the shapes in contact and passes P(O) up through it.
///
/// * eq. 6: of two shapes in contact, the one with the greater mean height stands on the other (on ties the one with the greater
///   number), so there are no cycles;
/// * eq. 7: P(S) = the component of the mean normal along up, clamped to [0, 1];
/// * eq. 8: P(O) = the greatest P(S) or P(O) of any parent, 0 without parents; computed in ascending height.
///
/// All nodes start as [`NodeKind::Surface`]. *Differs from the paper:* its "vertical position" is read as the mean
/// height. O(pixels + E log E).
pub fn build_by_height(
    shapes: &Segments,
    descriptors: &[Descriptor],
    contacts: &RegionGraph<u32>,
    points_m: &Raster<[f32; 3]>,
    up: &Up,
) -> SupportGraph {
    let up = Vec3::from(up.direction).as_dvec3();
    let (height_m, size_px) = measure_heights(shapes, points_m, up);
    let rank = rank_by(&height_m);
    let edge = |(a, b, contacts): (usize, usize, u32)| {
        let (lower, upper) = if rank[a] < rank[b] { (a, b) } else { (b, a) };
        SupportEdge::seen(NodeId(lower as u32), NodeId(upper as u32), contacts)
    };
    let pairs = contacts.edges().iter().map(|e| (e.a.index(), e.b.index(), e.evidence));
    let mut edges: Vec<SupportEdge> = pairs.map(edge).collect();
    edges.sort_by_key(|e| (e.lower, e.upper));

    // Adding 0 turns a negative zero into zero.
    let upward = |d: &Descriptor| DVec3::from(d.normal).dot(up).clamp(0.0, 1.0) + 0.0;
    let p_s: Vec<f64> = descriptors.iter().map(upward).collect();
    let p_o = hand_up(&p_s, &edges, &rank);
    let node = |s: usize| SupportNode {
        kind: NodeKind::Surface,
        p_s: p_s[s] as f32,
        p_o: p_o[s] as f32,
        height_m: height_m[s] as f32,
        size_px: size_px[s],
    };
    SupportGraph { nodes: (0..shapes.count()).map(node).collect(), edges }
}

/// Mean height (m) and number of points of every shape.
fn measure_heights(shapes: &Segments, points_m: &Raster<[f32; 3]>, up: DVec3) -> (Vec<f64>, Vec<usize>) {
    let mut sum_m = vec![0.0; shapes.count()];
    let mut size_px = vec![0_usize; shapes.count()];
    for (run, s) in shapes.runs() {
        let measured = points_m.as_slice()[run].iter().filter(|point| !point[2].is_nan());
        (sum_m[s], size_px[s]) = measured.fold((sum_m[s], size_px[s]), |(sum_m, size_px), &point| {
            (sum_m + Vec3::from(point).as_dvec3().dot(up), size_px + 1)
        });
    }
    let mean = |(sum, &n): (&f64, &usize)| if n < MIN_POINTS { 0.0 } else { sum / n as f64 };
    (sum_m.iter().zip(&size_px).map(mean).collect(), size_px)
}

/// The rank of every value in ascending order; equal values keep their order.
fn rank_by(values: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut rank = vec![0; order.len()];
    order.iter().enumerate().for_each(|(place, &s)| rank[s] = place);
    rank
}

/// P(O) of every shape (eq. 8).
fn hand_up(p_s: &[f64], edges: &[SupportEdge], rank: &[usize]) -> Vec<f64> {
    let mut p_o = vec![0.0_f64; p_s.len()];
    let mut upwards: Vec<&SupportEdge> = edges.iter().collect();
    // Edges to a parent come before edges from it.
    upwards.sort_by_key(|e| rank[e.upper.0 as usize]);
    for edge in upwards {
        let (parent, child) = (edge.lower.0 as usize, edge.upper.0 as usize);
        p_o[child] = p_o[child].max(p_s[parent]).max(p_o[parent]);
    }
    p_o
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discovery::up::UpSource;
    use crate::regions::SegmentId;

    /// One column of shapes, the last one lowest: shape s has three points at height `heights[s]` and a
    /// mean normal with the component `upward[s]` along up.
    fn stack(heights: &[f32], upward: &[f64], contacts: &[(u32, u32)]) -> SupportGraph {
        let n = heights.len();
        let labels = Raster::from_vec(3, n, (0..3 * n as i32).map(|i| i / 3).collect()).unwrap();
        let points = labels.map(|&s| [0.0, -heights[s as usize], 1.0]);
        let describe = |&y: &f64| Descriptor { normal: [0.0, -y, 0.0], ..Default::default() };
        let described: Vec<_> = upward.iter().map(describe).collect();
        let up = Up { direction: [0.0, -1.0, 0.0], source: UpSource::Camera };
        let contacts =
            RegionGraph::from_pairs(n, contacts.iter().map(|&(a, b)| (SegmentId(a), SegmentId(b))));
        build_by_height(&Segments::from_labels(&labels), &described, &contacts, &points, &up)
    }

    fn p_o(graph: &SupportGraph) -> Vec<f32> {
        graph.nodes.iter().map(|n| n.p_o).collect()
    }

    #[test]
    fn support_is_handed_up_through_a_stack() {
        // A cup (0) on a round tin (1) on a table (2): the tin carries nothing by its own surface.
        let graph = stack(&[0.3, 0.2, 0.0], &[0.5, 0.1, 0.9], &[(0, 1), (1, 2)]);
        let edges: Vec<_> = graph.edges.iter().map(|e| (e.lower.0, e.upper.0)).collect();
        assert_eq!(edges, [(1, 0), (2, 1)]);
        assert_eq!(p_o(&graph), [0.9, 0.9, 0.0]);
        assert_eq!(graph.parents(), [vec![NodeId(1)], vec![NodeId(2)], vec![]]);
    }

    #[test]
    fn the_best_parent_counts_and_a_ceiling_carries_nothing() {
        let graph = stack(&[0.0, 0.1, 0.2, 0.3], &[0.2, 0.8, 0.0, -0.9], &[(0, 2), (1, 2), (2, 3)]);
        assert_eq!(p_o(&graph), [0.0, 0.0, 0.8, 0.8]);
        assert_eq!(graph.nodes[3].p_s, 0.0);
    }

    #[test]
    fn equal_heights_and_rings_make_no_cycle() {
        let graph = stack(&[0.1, 0.1, 0.1], &[1.0, 1.0, 1.0], &[(0, 1), (1, 2), (0, 2)]);
        assert!(graph.edges.iter().all(|e| e.lower < e.upper), "{:?}", graph.edges);
    }

    #[test]
    fn three_points_make_a_height_and_two_do_not() {
        // Shape 0 has two points with depth and one without, shape 1 has three.
        let labels = Raster::from_vec(6, 1, vec![0, 0, 0, 1, 1, 1]).unwrap();
        let heights = [0.5, 0.7, f32::NAN, 0.2, 0.3, 0.7];
        let points = labels.with_data(heights.map(|h| [0.0, -h, h + 1.0]).to_vec().into());
        let up = Up { direction: [0.0, -1.0, 0.0], source: UpSource::Camera };
        let contacts = RegionGraph::from_pairs(2, [(SegmentId(0), SegmentId(1))]);
        let described = [Descriptor::default(); 2];
        let graph = build_by_height(&Segments::from_labels(&labels), &described, &contacts, &points, &up);
        assert_eq!((graph.nodes[0].height_m, graph.nodes[0].size_px), (0.0, 2));
        assert_eq!((graph.nodes[1].height_m, graph.nodes[1].size_px), (0.4, 3));
        let (lower, upper) = (graph.edges[0].lower, graph.edges[0].upper);
        assert_eq!((lower, upper), (NodeId(0), NodeId(1)), "height 0 is the lower one");
    }
}
