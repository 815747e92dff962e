//! What the drawing shows of a support graph: the objects and what carries them, as a forest.

use std::cmp::Reverse;

use objecthood::Discovery;
use objecthood::discovery::{NodeKind, SupportEdge, SupportKind};

/// Objects and their carriers, each below what it carries. Carriers stand before what they carry.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Forest {
    pub(crate) nodes: Vec<ForestNode>,
    /// The edges beside those to the parents.
    pub(crate) others: Vec<Link>,
}

/// An edge of the forest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Link {
    pub(crate) lower: usize,
    pub(crate) upper: usize,
    pub(crate) edge: SupportEdge,
}

/// A node of the forest; nodes are named by their place in [`Forest::nodes`].
#[derive(Debug, PartialEq)]
pub(crate) struct ForestNode {
    /// Its number in the support graph.
    pub(crate) node: usize,
    /// Of all that carries it, the surest; what it leans on comes last.
    pub(crate) parent: Option<Link>,
    /// Edges on the longest way down: everything stands in a higher layer than what carries it.
    pub(crate) layer: usize,
    /// Where it stands in the image, so that the drawing is in the order of the image: for an object the middle of
    /// its box, for others the mean of what they carry [px].
    pub(crate) column: f32,
}

impl Forest {
    /// Every object and whatever carries one directly. Should the graph have a cycle, which none of `discover` has,
    /// the edges that close it are left out. O(nodes + edges log edges).
    pub(crate) fn new(discovery: &Discovery) -> Self {
        let nodes = &discovery.support.nodes;
        let is_object =
            |n: u32| matches!(nodes.get(n as usize).map(|n| n.kind), Some(NodeKind::Object { .. }));
        let mut is_shown: Vec<bool> = (0..nodes.len() as u32).map(is_object).collect();
        for edge in discovery.support.edges.iter().filter(|e| is_object(e.upper.0)) {
            is_shown.get_mut(edge.lower.0 as usize).into_iter().for_each(|shown| *shown = true);
        }
        let shown = |n: u32| is_shown.get(n as usize) == Some(&true);
        let edges: Vec<&SupportEdge> =
            discovery.support.edges.iter().filter(|e| shown(e.lower.0) && shown(e.upper.0)).collect();

        let order = upwards(&is_shown, &edges);
        let mut place = vec![usize::MAX; nodes.len()];
        order.iter().enumerate().for_each(|(k, &n)| place[n] = k);
        let placed = |e: &&SupportEdge| Link {
            lower: place[e.lower.0 as usize],
            upper: place[e.upper.0 as usize],
            edge: **e,
        };
        let mut links: Vec<Link> = edges.iter().map(placed).filter(|link| link.lower < link.upper).collect();
        links.sort_by_key(|&Link { lower, upper, edge }| {
            let leans = edge.kind == SupportKind::Leans;
            // As an integer: of a number that is not negative the order is the same.
            (upper, leans, Reverse(edge.confidence.max(0.0).to_bits()), Reverse(edge.contacts), lower)
        });

        let mut forest = Self {
            nodes: order
                .iter()
                .map(|&node| ForestNode { node, parent: None, layer: 0, column: 0.0 })
                .collect(),
            others: Vec::new(),
        };
        for &link in &links {
            let layer = forest.nodes[link.lower].layer + 1;
            let node = &mut forest.nodes[link.upper];
            node.layer = node.layer.max(layer);
            match node.parent {
                None => node.parent = Some(link),
                Some(_) => forest.others.push(link),
            }
        }
        forest.find_columns(&links, discovery);
        forest
    }

    /// All edges, those to the parents first.
    pub(crate) fn links(&self) -> impl Iterator<Item = Link> + '_ {
        self.nodes.iter().filter_map(|node| node.parent).chain(self.others.iter().copied())
    }

    /// What the nodes that are no objects are called, A, B, .. by falling size; "" for objects.
    pub(crate) fn surface_names(&self, discovery: &Discovery) -> Vec<String> {
        let support = |k: usize| &discovery.support.nodes[self.nodes[k].node];
        let is_object = |k: usize| matches!(support(k).kind, NodeKind::Object { .. });
        let mut surfaces: Vec<usize> = (0..self.nodes.len()).filter(|&k| !is_object(k)).collect();
        surfaces.sort_by_key(|&k| (Reverse(support(k).size_px), self.nodes[k].node));
        let mut names = vec![String::new(); self.nodes.len()];
        for (rank, k) in surfaces.into_iter().enumerate() {
            names[k] = letters(rank);
        }
        names
    }

    fn find_columns(&mut self, links: &[Link], discovery: &Discovery) {
        let mut carried: Vec<(f32, f32)> = vec![(0.0, 0.0); self.nodes.len()];
        let mut links = links.iter().rev().peekable();
        for k in (0..self.nodes.len()).rev() {
            let object = match discovery.support.nodes[self.nodes[k].node].kind {
                NodeKind::Object { object } => discovery.objects.get(usize::from(object.0).wrapping_sub(1)),
                _ => None,
            };
            let (sum, count) = carried[k];
            let column = match object {
                Some(object) => object.box_px.u as f32 + object.box_px.width as f32 / 2.0,
                None => sum / f32::max(count, 1.0),
            };
            self.nodes[k].column = column;
            while let Some(&Link { lower, .. }) = links.next_if(|link| link.upper == k) {
                carried[lower].0 += column;
                carried[lower].1 += 1.0;
            }
        }
    }
}

/// A, B, .. Z, AA, AB, .. for 0, 1, ..
fn letters(mut rank: usize) -> String {
    let mut letters = Vec::new();
    loop {
        letters.push(char::from(b'A' + (rank % 26) as u8));
        match rank / 26 {
            0 => return letters.into_iter().rev().collect(),
            more => rank = more - 1,
        }
    }
}

/// The shown nodes, carriers before what they carry (A. B. Kahn, 1962); those of cycles last.
fn upwards(is_shown: &[bool], edges: &[&SupportEdge]) -> Vec<usize> {
    let mut carries: Vec<Vec<usize>> = vec![Vec::new(); is_shown.len()];
    let mut carriers = vec![0_usize; is_shown.len()];
    for edge in edges {
        carries[edge.lower.0 as usize].push(edge.upper.0 as usize);
        carriers[edge.upper.0 as usize] += 1;
    }
    let shown = || (0..is_shown.len()).filter(|&n| is_shown[n]);
    let mut order: Vec<usize> = shown().filter(|&n| carriers[n] == 0).collect();
    let mut next = 0;
    while let Some(&n) = order.get(next) {
        next += 1;
        for &upper in &carries[n] {
            carriers[upper] -= 1;
            if carriers[upper] == 0 {
                order.push(upper);
            }
        }
    }
    order.extend(shown().filter(|&n| carriers[n] > 0));
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    #[test]
    fn objects_stand_on_what_they_touch_most() {
        // A table (0), a wall (1) that carries nothing, a tin (2) with a cup (3) that leans on a box (4).
        let discovery =
            testing::standing(5, &[2, 3, 4], &[(0, 2, 9), (0, 4, 9), (2, 3, 5), (3, 4, 1), (0, 1, 50)]);
        let Forest { nodes, others } = Forest::new(&discovery);
        assert_eq!(nodes.iter().map(|n| n.node).collect::<Vec<_>>(), [0, 2, 3, 4]);
        let parents: Vec<_> = nodes.iter().map(|n| n.parent.map(|link| link.lower)).collect();
        assert_eq!(parents, [None, Some(0), Some(1), Some(0)]);
        assert_eq!(nodes.iter().map(|n| n.layer).collect::<Vec<_>>(), [0, 1, 2, 3]);
        assert_eq!(others.iter().map(|link| (link.lower, link.upper)).collect::<Vec<_>>(), [(2, 3)]);
    }

    #[test]
    fn the_surest_carrier_is_the_parent_and_what_is_leant_on_comes_last() {
        let mut discovery = testing::standing(4, &[3], &[(0, 3, 1), (1, 3, 9), (2, 3, 5)]);
        let edges = &mut discovery.support.edges;
        (edges[0].confidence, edges[1].confidence) = (0.8, 0.3);
        edges[2].kind = SupportKind::Leans;
        let forest = Forest::new(&discovery);
        let lowers: Vec<_> = forest.links().map(|link| forest.nodes[link.lower].node).collect();
        assert_eq!(lowers, [0, 1, 2]);
    }

    #[test]
    fn every_edge_leads_upwards_and_is_drawn_once() {
        for seed in 0..200 {
            let discovery = testing::random_support(seed, 40, 90, true);
            let shown = Forest::new(&discovery);
            let drawn = shown.nodes.iter().filter(|n| n.parent.is_some()).count() + shown.others.len();
            let is_shown = |n: u32| shown.nodes.iter().any(|s| s.node == n as usize);
            let edges = &discovery.support.edges;
            let named = edges.iter().filter(|e| is_shown(e.lower.0) && is_shown(e.upper.0)).count();
            assert_eq!(drawn, named, "seed {seed}");
            for Link { lower, upper, .. } in shown.links() {
                assert!(lower < upper && shown.nodes[lower].layer < shown.nodes[upper].layer, "seed {seed}");
            }
        }
    }

    #[test]
    fn cycles_and_foreign_numbers_are_no_reason_to_panic() {
        for seed in 0..200 {
            let mut discovery = testing::random_support(seed, 12, 40, false);
            assert!(
                Forest::new(&discovery)
                    .nodes
                    .iter()
                    .enumerate()
                    .all(|(k, n)| n.parent.is_none_or(|link| link.lower < k))
            );
            discovery.support.nodes.truncate(7);
            discovery.objects.clear();
            Forest::new(&discovery);
        }
    }

    #[test]
    fn surfaces_are_named_by_falling_size() {
        // Node n has 100 + n pixels.
        let forest = Forest::new(&testing::standing(4, &[3], &[(0, 3, 1), (1, 3, 2), (2, 3, 3)]));
        let discovery = testing::standing(4, &[3], &[]);
        assert_eq!(forest.surface_names(&discovery), ["C", "B", "A", ""]);
        let names = [0, 25, 26, 51, 52, 26 + 26 * 26 - 1, 26 + 26 * 26].map(letters);
        assert_eq!(names, ["A", "Z", "AA", "AZ", "BA", "ZZ", "AAA"]);
    }

    #[test]
    fn nothing_stands_on_nothing() {
        assert_eq!(Forest::new(&testing::standing(3, &[], &[(0, 1, 4)])), Forest::default());
    }
}
