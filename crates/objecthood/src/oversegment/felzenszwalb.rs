//! Efficient graph-based segmentation (Felzenszwalb and Huttenlocher, IJCV 2004; paper, III-A).

use crate::buffers::Buffer;
use crate::oversegment::edges::Rule;
use crate::oversegment::graph::PixelGraph;
use crate::oversegment::pixel_edge::PixelEdge;
use crate::oversegment::settled::{join_settled, settle};
use crate::params;
use crate::raster::Raster;
use crate::union_find::UnionFind;

/// The components of the pixel graph.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Components {
    root: Buffer<u32>,
    size_px: Buffer<u32>,
}

impl Components {
    /// For each pixel, the root of its component: the pixel that represents it.
    pub fn root(&self) -> &[u32] {
        &self.root
    }

    /// At each root, the number of pixels of its component; 0 at other pixels.
    pub fn size_px(&self) -> &[u32] {
        &self.size_px
    }
}

/// Segments the pixel graph: visits the edges by ascending weight, and joins two components if both tolerate the edge's weight.
///
/// A component of s pixels whose heaviest joining edge is w tolerates w + k/s, k = `size_preference_grey`. Pixels in
/// `borders` are never joined. Afterwards each component below `min_size_px` is joined to the neighbour over its lightest edge.
///
/// The result equals the article's loop over all edges, bit for bit. Pairs whose edge is decided before all others at its pixels
/// are joined first (`settle`). Then the edges follow by weight, at equal weight by number, without edges that change nothing
/// (`Edges::between_sets`). The minimum-size pass visits only edges at small components.
///
/// *Differs from the paper:* it sets a boundary "if `MInt` is larger than `Dif`"; the cited algorithm joins when
/// `Dif` <= `MInt`, and only this makes sense. O(edges · log pixels), sequential: each decision depends on the ones before.
pub fn segment(graph: &PixelGraph, borders: &Raster<bool>, params: &params::Graph) -> Components {
    let pixels = graph.pixels();
    let mut growing = Growing {
        k: params.size_preference_grey,
        of: Buffer::filled(pixels, Component { size_px: 1, tolerated: params.size_preference_grey }),
    };
    let mut sets = UnionFind::of_pixels(pixels);
    let mut open = graph.without(borders);
    settle(graph, borders, growing.k, &mut open);
    join_settled(graph, &open, |edge| growing.pair(&mut sets, edge));
    let edges = graph.edges(&open);
    drop(open);
    edges.between_sets(&mut sets, &mut growing);

    let min_size = params.min_size_px;
    let parts = borders.as_slice().iter().enumerate().map(|(i, &shut)| {
        let root = sets.find(i);
        let kept = if growing.of[root].size_px >= min_size { LARGE } else { root as u32 };
        if shut { SHUT } else { kept }
    });
    let part: Buffer<u32> = parts.collect();
    let edges = graph.edges_between(&part);
    drop(part);
    edges.between_sets(&mut sets, &mut TooSmall { min_size, growing: &mut growing });

    let root = (0..pixels).map(|i| sets.find(i) as u32).collect();
    let size_px = growing.of.iter().map(|component| component.size_px).collect();
    Components { root, size_px }
}

/// Part number of a pixel that no edge joins.
const SHUT: u32 = PixelGraph::NO_PART;

/// Part number of all pixels whose component has reached the minimum size.
const LARGE: u32 = SHUT - 1;

/// The components while they grow. The entry at a root holds the values of its component.
struct Growing {
    /// The weight that a single pixel tolerates.
    k: f32,
    of: Buffer<Component>,
}

/// A growing component.
#[derive(Clone, Copy, Debug)]
struct Component {
    /// Number of pixels; 0 at pixels that are no longer a root.
    size_px: u32,
    /// Weight of the heaviest edge that may still join it; infinite at pixels that are no longer a root.
    tolerated: f32,
}

impl Growing {
    /// Joins two single pixels as [`join`](Self::join) does, but does not read their sizes, which would cost a cache line each.
    #[inline]
    fn pair(&mut self, sets: &mut UnionFind, PixelEdge { weight, p, q }: PixelEdge) {
        let (root, child) = (p as usize, q as usize);
        sets.link(root, child);
        self.of[child] = Component { size_px: 0, tolerated: f32::INFINITY };
        self.of[root] = Component { size_px: 2, tolerated: weight + self.k / 2.0 };
    }

    /// Joins two components under the root of the larger one, on ties under p's.
    #[inline]
    fn join(&mut self, sets: &mut UnionFind, weight: f32, (p, q): (usize, usize)) {
        let size_px = [p, q].map(|root| self.of[root].size_px);
        let is_swapped = size_px[0] < size_px[1];
        let (root, child) = if is_swapped { (q, p) } else { (p, q) };
        sets.link(root, child);
        let size_px = size_px[0] + size_px[1];
        self.of[child] = Component { size_px: 0, tolerated: f32::INFINITY };
        self.of[root] = Component { size_px, tolerated: weight + self.k / size_px as f32 };
    }
}

impl Rule for Growing {
    #[inline]
    fn refuses(&self, root: usize, weight: f32) -> bool {
        self.of[root].tolerated < weight
    }

    #[inline]
    fn meet(&mut self, sets: &mut UnionFind, PixelEdge { weight, .. }: PixelEdge, (p, q): (usize, usize)) {
        if weight <= self.of[p].tolerated.min(self.of[q].tolerated) {
            self.join(sets, weight, (p, q));
        }
    }
}

/// The rule of the minimum-size pass: joins two components if one of them is too small.
struct TooSmall<'a> {
    min_size: u32,
    growing: &'a mut Growing,
}

impl Rule for TooSmall<'_> {
    #[inline]
    fn refuses(&self, _: usize, _: f32) -> bool {
        false
    }

    #[inline]
    fn meet(&mut self, sets: &mut UnionFind, PixelEdge { weight, .. }: PixelEdge, (p, q): (usize, usize)) {
        if self.growing.of[p].size_px.min(self.growing.of[q].size_px) < self.min_size {
            self.growing.join(sets, weight, (p, q));
        }
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

    /// The algorithm as in the article: components as lists, Int and Dif computed directly, no union-find.
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
            (width, height, pixels) in (1_usize..24, 1_usize..24).prop_flat_map(|(w, h)| {
                let pixel = (any::<[u8; 3]>(), 0.5_f32..2.0, 0_u8..10);
                (Just(w), Just(h), prop::collection::vec(pixel, w * h))
            }),
            // Few grey levels make many equal weights.
            levels in prop::sample::select(vec![1_u8, 32, 64, 255]),
            k in prop_oneof![Just(0.0), 0.0_f32..400.0, Just(1e6)],
            // Apart: infinite weights.
            unmeasured in prop::sample::select(vec![Unmeasured::ByColor, Unmeasured::Apart]),
            min_size_px in 0_u32..12,
        ) {
            let color = pixels.iter().map(|(c, ..)| c.map(|c| c / levels * levels)).collect();
            let color = Raster::from_vec(width, height, color).unwrap();
            let depth = pixels.iter().map(|&(_, z, kind)| if kind == 0 { f32::NAN } else { z }).collect();
            let mut depth = Raster::from_vec(width, height, depth).unwrap();
            depth.as_mut_slice()[0] = 1.0;
            let borders = depth.with_data(pixels.iter().map(|p| p.2 == 1).collect());
            let frame = Frame::new(depth, Some(color.clone()), Camera::new(1.0, 1.0, 0.0, 0.0).unwrap()).unwrap();
            let smoothed = smooth(&color, frame.depth_m(), &params::Smoothing { sigma_px: 0.0 });
            let params = params::Graph { size_preference_grey: k, min_size_px, ..Default::default() };
            let sensor = params::Sensor::default();
            let graph = PixelGraph::new(&frame, Some(&smoothed), unmeasured, &sensor, &params);

            let fast = segment(&graph, &borders, &params);
            let slow = textbook(&graph, &borders, k, min_size_px);
            prop_assert_eq!(by_first_pixel(&fast.root), by_first_pixel(&slow));
            for &root in fast.root() {
                let members = fast.root.iter().filter(|&&r| r == root).count();
                prop_assert_eq!(fast.size_px[root as usize] as usize, members);
            }
        }
    }

    /// Edges are dealt in bands of rows; this image has three bands.
    #[test]
    fn several_bands_equal_the_textbook() {
        let (width, height) = (300, 120);
        let depth = Raster::filled(width, height, 1.0).unwrap();
        // Patches of few levels with noise, so that equal weights occur in all bands.
        let level = |i: usize, c: usize| {
            let patch = i % width / 25 * 7 + i / width / 20 * 5 + c;
            let noise = (i as u32 * 3 + c as u32).wrapping_mul(0x9e37_79b9) >> 29;
            (patch * 53 % 200) as u8 + noise as u8
        };
        let color = (0..width * height).map(|i| [0, 1, 2].map(|c| level(i, c))).collect();
        let color = Raster::from_vec(width, height, color).unwrap();
        let borders = depth.with_data(vec![false; width * height].into());
        let smoothed = smooth(&color, &depth, &params::Smoothing { sigma_px: 0.0 });
        let frame = Frame::new(depth, Some(color), Camera::new(1.0, 1.0, 0.0, 0.0).unwrap()).unwrap();
        let params = params::Graph { size_preference_grey: 60.0, min_size_px: 30, ..Default::default() };
        let sensor = params::Sensor::default();
        let graph = PixelGraph::new(&frame, Some(&smoothed), Unmeasured::ByColor, &sensor, &params);
        let fast = by_first_pixel(&segment(&graph, &borders, &params).root);
        let slow = by_first_pixel(&textbook(&graph, &borders, 60.0, 30));
        assert!(slow.iter().collect::<std::collections::BTreeSet<_>>().len() > 10);
        assert!(fast == slow);
    }
}
