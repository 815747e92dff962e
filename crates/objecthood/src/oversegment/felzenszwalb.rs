//! Efficient graph-based segmentation (Felzenszwalb and Huttenlocher, IJCV 2004; paper, III-A).

use crate::oversegment::graph::{PixelEdge, PixelGraph};
use crate::params;
use crate::raster::Raster;
use crate::union_find::UnionFind;

/// The components of the pixel graph.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Components {
    /// The pixel that stands for the component of each pixel.
    pub root: Vec<u32>,
    /// Pixels of the component that each root stands for.
    pub size_px: Vec<u32>,
}

/// Joins pixels over ever heavier edges while the edge is not heavier than what holds both components together.
///
/// A component of s pixels whose heaviest joining edge is w tolerates w + k/s (`size_preference_grey`). Pixels in
/// `borders` are never joined. Afterwards components below `min_size_px` are joined to the neighbour over
/// the lightest edge.
///
/// *Differs from the paper:* it says there is a boundary "if `MInt` is larger than `Dif`"; the cited algorithm, and
/// sense, join when `Dif` <= `MInt`. O(edges · log pixels), sequential: each decision depends on the ones before.
pub fn segment(graph: &PixelGraph, borders: &Raster<bool>, params: &params::Graph) -> Components {
    let mut sets = UnionFind::new(graph.pixels());
    let mut size_px = vec![1_u32; graph.pixels()];
    let mut tolerated = vec![params.size_preference_grey; graph.pixels()];
    let open = |e: &&PixelEdge| !borders[e.p as usize] && !borders[e.q as usize];

    for edge in graph.edges().iter().filter(open) {
        let (p, q) = (sets.find(edge.p as usize), sets.find(edge.q as usize));
        if p != q && edge.weight <= tolerated[p] && edge.weight <= tolerated[q] {
            let root = join(&mut sets, &mut size_px, p, q);
            tolerated[root] = edge.weight + params.size_preference_grey / size_px[root] as f32;
        }
    }
    for edge in graph.edges().iter().filter(open) {
        let (p, q) = (sets.find(edge.p as usize), sets.find(edge.q as usize));
        if p != q && size_px[p].min(size_px[q]) < params.min_size_px {
            join(&mut sets, &mut size_px, p, q);
        }
    }

    let root = (0..graph.pixels()).map(|i| sets.find(i) as u32).collect();
    Components { root, size_px }
}

/// Joins two components below the larger one's root (a tie: p's) and returns it.
fn join(sets: &mut UnionFind, size_px: &mut [u32], p: usize, q: usize) -> usize {
    let (root, child) = if size_px[p] < size_px[q] { (q, p) } else { (p, q) };
    sets.link(root, child);
    size_px[root] += size_px[child];
    root
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::camera::Camera;
    use crate::frame::Frame;
    use crate::oversegment::graph::Unmeasured;
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
            for edge in graph.edges() {
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
            let frame = Frame::new(depth, Some(color.clone()), Camera::new(1.0, 1.0, 0.0, 0.0).unwrap()).unwrap();
            let smoothed = smooth(&color, frame.depth_m(), &params::Smoothing { sigma_px: 0.0 });
            let params = params::Graph { size_preference_grey: k, min_size_px, ..Default::default() };
            let sensor = params::Sensor::default();
            let graph = PixelGraph::new(&frame, Some(&smoothed), Unmeasured::ByColor, &sensor, &params);

            let fast = segment(&graph, &borders, &params);
            let slow = textbook(&graph, &borders, k, min_size_px);
            prop_assert_eq!(by_first_pixel(&fast.root), by_first_pixel(&slow));
            for &root in &fast.root {
                let members = fast.root.iter().filter(|&&r| r == root).count();
                prop_assert_eq!(fast.size_px[root as usize] as usize, members);
            }
        }
    }
}
