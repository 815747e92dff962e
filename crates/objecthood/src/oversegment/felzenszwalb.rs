//! Efficient graph-based segmentation (Felzenszwalb and Huttenlocher, IJCV 2004; paper, III-A).

use crate::oversegment::graph::{PixelEdge, PixelGraph, SortedEdges};
use crate::params;
use crate::raster::Raster;
use crate::workspace::Workspace;

/// The components of the pixel graph.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Components {
    /// The pixel that stands for the component of each pixel.
    pub root: Vec<u32>,
    /// Pixels of the component that each root stands for; 0 of other pixels.
    pub size_px: Vec<u32>,
}

impl Components {
    /// Gives its memory back.
    pub(crate) fn leave(self, workspace: &mut Workspace) {
        workspace.shelve(self.root);
        workspace.shelve(self.size_px);
    }
}

/// Joins pixels over ever heavier edges while the edge is not heavier than what holds both components together.
///
/// A component of s pixels whose heaviest joining edge is w tolerates w + k/s (`size_preference_grey`). Pixels in
/// `borders` are never joined. Afterwards components below `min_size_px` are joined to the neighbour over
/// the lightest edge.
///
/// The result is that of the article's loop over all edges, bit for bit, but only edges that can matter are sorted. The light
/// ones are decided first. Of the others one within a component changes nothing, and neither does one at a component that
/// tolerates less than every edge to come, for it has stopped growing: both are left out (as in filter-Kruskal: Osipov,
/// Sanders and Singler, ALENEX 2009). For the minimum size only edges at small components matter.
///
/// *Differs from the paper:* it says there is a boundary "if `MInt` is larger than `Dif`"; the cited algorithm, and
/// sense, join when `Dif` <= `MInt`. O(edges · log pixels), sequential: each decision depends on the ones before.
pub fn segment(
    graph: &PixelGraph,
    borders: &Raster<bool>,
    params: &params::Graph,
    workspace: &mut Workspace,
) -> Components {
    let k = params.size_preference_grey;
    let mut forest =
        Forest { nodes: workspace.filled(graph.pixels(), Node { link: ROOT + 1, tolerated: k }) };
    let mut part = workspace.collected((0..).zip(borders.as_slice()).map(|(i, &b)| if b { SHUT } else { i }));
    let mut over = f32::NEG_INFINITY;
    for upto in [graph.quantile(LIGHT_SHARE), f32::INFINITY] {
        let edges = graph.ascending(&part, over, upto, workspace);
        forest.between_components(&edges, |forest, PixelEdge { weight, p, q }| {
            if weight <= forest.tolerated(p) && weight <= forest.tolerated(q) {
                let root = forest.join(p, q);
                forest.tolerate(root, weight + k / forest.size_px(root) as f32);
            }
        });
        edges.leave(workspace);
        over = upto;
        for (i, part) in (0..).zip(&mut part).filter(|(_, part)| **part != SHUT) {
            let root = forest.find(i);
            *part = if forest.tolerated(root) <= over { SHUT } else { root };
        }
    }
    for (i, (part, &border)) in (0..).zip(part.iter_mut().zip(borders.as_slice())) {
        let root = forest.find(i);
        let large = forest.size_px(root) >= params.min_size_px;
        *part = if border {
            SHUT
        } else if large {
            LARGE
        } else {
            root
        };
    }
    let edges = graph.ascending(&part, f32::NEG_INFINITY, f32::INFINITY, workspace);
    forest.between_components(&edges, |forest, PixelEdge { p, q, .. }| {
        if forest.size_px(p).min(forest.size_px(q)) < params.min_size_px {
            forest.join(p, q);
        }
    });
    edges.leave(workspace);
    workspace.shelve(part);
    let root = workspace.collected((0..graph.pixels() as u32).map(|i| forest.find(i)));
    let sizes = (0..).zip(&root).map(|(i, &root)| if i == root { forest.size_px(i) } else { 0 });
    let size_px = workspace.collected(sizes);
    workspace.shelve(forest.nodes);
    Components { root, size_px }
}

/// No edge to come joins the pixel.
const SHUT: u32 = PixelGraph::NO_PART;

/// The pixel's component is no smaller than it must be.
const LARGE: u32 = SHUT - 1;

/// The share of the edges that is decided first; it changes the time alone.
const LIGHT_SHARE: f64 = 0.4;

/// Edges whose ends are followed upwards together.
const BLOCK: usize = 128;

/// The components as they grow: disjoint sets as in [`UnionFind`](crate::union_find::UnionFind), with all that is known of
/// a set in the eight bytes of its root, because it costs time to fetch nodes from memory.
struct Forest {
    nodes: Vec<Node>,
}

/// A pixel in the forest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    /// The parent; of a root [`ROOT`] + pixels of the component.
    link: u32,
    /// Of a root: the weight that its component tolerates.
    tolerated: f32,
}

/// Marks a root; pixels are fewer ([`Raster::MAX_PIXELS`]).
const ROOT: u32 = 1 << 31;

impl Forest {
    /// Calls `meet` with every edge that lies between two components when its turn comes, with their roots as its ends.
    ///
    /// How far it is to a root, and whether two ends have one already, no processor can guess, and each wrong guess costs
    /// more than all else that is done for an edge. So block by block both ends are first taken two steps up without a
    /// branch, the ways of many edges at once, and edges whose ends meet are left out. What remains mostly stands at two
    /// roots; which they are by then is asked again, one edge after the other.
    fn between_components(&mut self, edges: &SortedEdges, mut meet: impl FnMut(&mut Self, PixelEdge)) {
        let mut edges = edges.iter();
        let mut apart = [PixelEdge { weight: 0.0, p: 0, q: 0 }; BLOCK];
        while edges.len() > 0 {
            let mut count = 0;
            for edge in edges.by_ref().take(BLOCK) {
                let (p, q) = (self.two_up(edge.p), self.two_up(edge.q));
                apart[count] = PixelEdge { p, q, ..edge };
                count += usize::from(p != q);
            }
            for &PixelEdge { weight, p, q } in &apart[..count] {
                let (p, q) = (self.find(p), self.find(q));
                if p != q {
                    meet(self, PixelEdge { weight, p, q });
                }
            }
        }
    }

    /// The grandparent of `i`, or the root if that is nearer; becomes the parent of `i`.
    #[inline]
    fn two_up(&mut self, i: u32) -> u32 {
        let link = self.nodes[i as usize].link;
        let parent = if link < ROOT { link } else { i };
        let above = self.nodes[parent as usize].link;
        let grandparent = if above < ROOT { above } else { parent };
        self.nodes[i as usize].link = if link < ROOT { grandparent } else { link };
        grandparent
    }

    /// The root of the component of `i`; shortens the path on the way (path halving). Amortised O(log pixels).
    #[inline]
    fn find(&mut self, mut i: u32) -> u32 {
        loop {
            let parent = self.nodes[i as usize].link;
            if parent >= ROOT {
                return i;
            }
            let grandparent = self.nodes[parent as usize].link;
            if grandparent >= ROOT {
                return parent;
            }
            self.nodes[i as usize].link = grandparent;
            i = grandparent;
        }
    }

    #[inline]
    fn size_px(&self, root: u32) -> u32 {
        self.nodes[root as usize].link & !ROOT
    }

    #[inline]
    fn tolerated(&self, root: u32) -> f32 {
        self.nodes[root as usize].tolerated
    }

    #[inline]
    fn tolerate(&mut self, root: u32, weight: f32) {
        self.nodes[root as usize].tolerated = weight;
    }

    /// Joins two components below the larger one's root (a tie: p's) and returns it.
    #[inline]
    fn join(&mut self, p: u32, q: u32) -> u32 {
        let (root, child) = if self.size_px(p) < self.size_px(q) { (q, p) } else { (p, q) };
        self.nodes[root as usize].link += self.size_px(child);
        self.nodes[child as usize].link = root;
        root
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::camera::Camera;
    use crate::frame::Frame;
    use crate::oversegment::graph::Unmeasured;
    use crate::oversegment::graph::testing::naive_edges;
    use crate::oversegment::smoothing::smooth;

    /// The algorithm as the article states it: components as lists, Int and Dif spelled out, no union-find.
    fn textbook(graph: &PixelGraph, borders: &Raster<bool>, k: f32, min_size: u32) -> Vec<u32> {
        let mut component: Vec<u32> = (0..graph.pixels() as u32).collect();
        let mut internal = vec![0.0_f32; graph.pixels()];
        let size = |component: &[u32], c: u32| component.iter().filter(|&&x| x == c).count() as u32;
        let merge = |component: &mut [u32], a: u32, b: u32| {
            let (keep, drop) = (a.min(b), a.max(b));
            component.iter_mut().filter(|c| **c == drop).for_each(|c| *c = keep);
            keep
        };
        for pass in [true, false] {
            for edge in naive_edges(graph) {
                let (p, q) = (edge.p as usize, edge.q as usize);
                let (a, b) = (component[p], component[q]);
                if borders[p] || borders[q] || a == b {
                    continue;
                }
                let (size_a, size_b) = (size(&component, a), size(&component, b));
                let tau = |c: u32, size: u32| internal[c as usize] + k / size as f32;
                let m_int = tau(a, size_a).min(tau(b, size_b));
                if pass && edge.weight <= m_int {
                    let kept = merge(&mut component, a, b);
                    internal[kept as usize] = edge.weight;
                } else if !pass && size_a.min(size_b) < min_size {
                    merge(&mut component, a, b);
                }
            }
        }
        component
    }

    /// Names every part of a partition by its first pixel.
    fn by_first_pixel(labels: &[u32]) -> Vec<usize> {
        labels.iter().map(|l| labels.iter().position(|x| x == l).unwrap()).collect()
    }

    proptest! {
        #[test]
        fn equals_the_textbook(
            (width, height, pixels) in (1_usize..14, 1_usize..14).prop_flat_map(|(w, h)| {
                let pixel = (any::<[u8; 3]>(), 0.5_f32..2.0, 0_u8..10);
                (Just(w), Just(h), prop::collection::vec(pixel, w * h))
            }),
            // Few grey levels make many equal weights.
            levels in prop::sample::select(vec![1_u8, 64, 255]),
            k in 0.0_f32..400.0,
            min_size_px in 0_u32..12,
        ) {
            let color = pixels.iter().map(|(c, ..)| c.map(|c| c / levels * levels)).collect();
            let color = Raster::from_vec(width, height, color).unwrap();
            let depth = pixels.iter().map(|&(_, z, kind)| if kind == 0 { f32::NAN } else { z }).collect();
            let mut depth = Raster::from_vec(width, height, depth).unwrap();
            depth.as_mut_slice()[0] = 1.0;
            let borders = depth.with_data(pixels.iter().map(|p| p.2 == 1).collect());
            let workspace = &mut Workspace::default();
            let frame = Frame::new(depth, Some(color.clone()), Camera::new(1.0, 1.0, 0.0, 0.0).unwrap()).unwrap();
            let smoothed = smooth(&color, frame.depth_m(), &params::Smoothing { sigma_px: 0.0 }, workspace);
            let params = params::Graph { size_preference_grey: k, min_size_px, ..Default::default() };
            let sensor = params::Sensor::default();
            let graph = PixelGraph::new(&frame, Some(&smoothed), Unmeasured::ByColor, &sensor, &params, workspace);

            let fast = segment(&graph, &borders, &params, workspace);
            let slow = textbook(&graph, &borders, k, min_size_px);
            prop_assert_eq!(by_first_pixel(&fast.root), by_first_pixel(&slow));
            for &root in &fast.root {
                let members = fast.root.iter().filter(|&&r| r == root).count();
                prop_assert_eq!(fast.size_px[root as usize] as usize, members);
            }
        }
    }
}
