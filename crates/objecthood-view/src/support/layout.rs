//! Where the nodes of a forest are drawn: what carries below, what is carried above.

use crate::drawing::Point;
use crate::support::forest::Forest;

/// Where the nodes are drawn.
#[derive(Debug, PartialEq)]
pub(super) struct Layout {
    /// The middle of every node of the forest [px].
    pub(super) centers: Vec<Point>,
    /// No two nodes of this radius touch [px].
    pub(super) radius_px: f32,
    /// From the middle of a node to the line from which those that it carries branch off [px].
    pub(super) branch_px: f32,
    /// Free width to the right of a node, before the next node of its row or the next line [px].
    pub(super) beside_px: f32,
}

/// A node takes at most this share of the smaller side of the drawing.
const MAX_SHARE: f32 = 1.0 / 24.0;
/// And this much of its row: the rest is for branches.
const OF_ROW: f32 = 0.4;
/// Nodes are raised when they then are larger by this factor.
const WORTH_RAISING: f32 = 1.25;

/// Places a forest on a drawing of `size` (width, height) pixels.
///
/// Leaves have a column each, in the order of the image; what carries stands under the middle of what it carries.
/// A subtree thus has its columns for itself, and the lines from carriers to what they carry cross neither
/// each other nor a node. When columns are narrow, every other node of a layer is raised by half a layer, so that nodes can
/// be larger. O(nodes log nodes).
pub(super) fn layout(forest: &Forest, [width, height]: Point) -> Layout {
    let columns = columns(forest);
    let leaves = columns.iter().copied().fold(0.0, f32::max) + 1.0;
    let layers = forest.nodes.iter().map(|n| n.layer + 1).max().unwrap_or(1);
    // Half a column on either side is a margin, also for the number beside the last node.
    let (column_px, layer_px) = (width / (leaves + 1.0), height / layers as f32);

    let largest = MAX_SHARE * width.min(height);
    let level = f32::min(0.42 * column_px, OF_ROW * layer_px).min(largest);
    let raised = f32::min(0.8 * column_px, OF_ROW * layer_px / 2.0).min(largest);
    let (rows, radius_px) = if raised > WORTH_RAISING * level { (2, raised) } else { (1, level) };
    let row_px = layer_px / rows as f32;

    let mut order: Vec<usize> = (0..columns.len()).collect();
    order.sort_by(|&a, &b| columns[a].total_cmp(&columns[b]));
    let mut in_layer = vec![0; layers];
    let mut centers = vec![[0.0; 2]; columns.len()];
    for k in order {
        let layer = forest.nodes[k].layer;
        let row = layer * rows + in_layer[layer] % rows;
        in_layer[layer] += 1;
        centers[k] = [(columns[k] + 1.0) * column_px, height - (row as f32 + 0.5) * row_px];
    }
    let beside_px = column_px - radius_px * if rows == 1 { 2.0 } else { 1.0 };
    Layout { centers, radius_px, branch_px: row_px / 2.0, beside_px }
}

/// The column of every node, in units of the width of a leaf.
fn columns(forest: &Forest) -> Vec<f32> {
    let nodes = &forest.nodes;
    // Siblings, and the roots as if they were such, from left to right.
    let mut order: Vec<usize> = (0..nodes.len()).collect();
    order.sort_by(|&a, &b| nodes[a].column.total_cmp(&nodes[b].column).then(a.cmp(&b)));
    let mut roots = Vec::new();
    let mut children = vec![Vec::new(); nodes.len()];
    for k in order {
        nodes[k].parent.map_or(&mut roots, |link| &mut children[link.lower]).push(k);
    }
    let mut leaves = vec![0_usize; nodes.len()];
    for k in (0..nodes.len()).rev() {
        leaves[k] = children[k].iter().map(|&c| leaves[c]).sum::<usize>().max(1);
    }
    let mut first = vec![0_usize; nodes.len()];
    let mut next = 0;
    for k in roots {
        first[k] = next;
        next += leaves[k];
    }
    let mut column = vec![0.0; nodes.len()];
    for k in 0..nodes.len() {
        let mut next = first[k];
        for &child in &children[k] {
            first[child] = next;
            next += leaves[child];
        }
        column[k] = first[k] as f32 + (leaves[k] - 1) as f32 / 2.0;
    }
    column
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::support::forest::Link;
    use crate::testing;

    const SIZE: Point = [640.0, 480.0];

    /// Trees and forests, flat, deep, and random.
    fn forests() -> Vec<Forest> {
        let flat: Vec<_> = (1..=200).map(|k| (0, k, 5)).collect();
        let stack: Vec<_> = (1..=200).map(|k| (k - 1, k, 5)).collect();
        let numbers: Vec<u32> = (1..=200).collect();
        let named = [
            testing::standing(1, &[0], &[]),
            testing::standing(2, &[1], &[(0, 1, 3)]),
            testing::standing(201, &numbers, &flat),
            testing::standing(201, &numbers, &stack),
            testing::standing(201, &numbers, &[]),
        ];
        let random = (0..100).map(|seed| testing::random_support(seed, 5 + seed % 90, 3 * (seed % 60), true));
        named.into_iter().chain(random).map(|d| Forest::new(&d)).collect()
    }

    #[test]
    fn no_two_nodes_touch_and_all_are_inside() {
        for forest in forests() {
            let Layout { centers, radius_px: r, .. } = layout(&forest, SIZE);
            assert!(r > 0.5 && r < 25.0, "{r}");
            for (k, a) in centers.iter().enumerate() {
                assert!(a[0] >= r && a[0] <= SIZE[0] - r && a[1] >= r && a[1] <= SIZE[1] - r, "{a:?} {r}");
                for b in &centers[..k] {
                    let apart = (a[0] - b[0]).hypot(a[1] - b[1]);
                    assert!(apart > 2.1 * r, "{a:?} {b:?}: {apart} px for a radius of {r}");
                }
            }
        }
    }

    #[test]
    fn what_is_carried_is_above_what_carries() {
        for forest in forests() {
            let Layout { centers, branch_px, .. } = layout(&forest, SIZE);
            for Link { lower, upper, .. } in forest.links() {
                assert!(centers[upper][1] < centers[lower][1] - branch_px, "{lower} carries {upper}");
            }
        }
    }

    #[test]
    fn lines_to_parents_cross_no_other_node() {
        for forest in forests() {
            let Layout { centers, radius_px: r, branch_px, .. } = layout(&forest, SIZE);
            for (k, node) in forest.nodes.iter().enumerate() {
                let Some(Link { lower: p, .. }) = node.parent else { continue };
                let ([x, y], [px, py]) = (centers[k], centers[p]);
                let branch = py - branch_px;
                let others = centers.iter().enumerate().filter(|(n, _)| *n != k && *n != p);
                for (_, [ox, oy]) in others {
                    let beside = (ox - x).abs() < r && (y..=branch).contains(oy);
                    let on_branch = (px.min(x)..=px.max(x)).contains(ox) && (oy - branch).abs() < r;
                    assert!(!beside && !on_branch, "{k} on {p}");
                }
            }
        }
    }

    #[test]
    fn the_order_is_that_of_the_image() {
        // Nodes 1, 2, 3 stand on 0; in the image the boxes of testing::standing go from right to left.
        let forest = Forest::new(&testing::standing(4, &[1, 2, 3], &[(0, 1, 1), (0, 2, 1), (0, 3, 1)]));
        let x: Vec<f32> = layout(&forest, SIZE).centers.iter().map(|c| c[0]).collect();
        assert!(x[3] < x[2] && x[2] < x[1], "{x:?}");
        assert_eq!(x[0], x[2], "the carrier stands under their middle");
    }

    #[test]
    fn an_empty_forest_has_no_places() {
        assert!(layout(&Forest::default(), SIZE).centers.is_empty());
    }
}
