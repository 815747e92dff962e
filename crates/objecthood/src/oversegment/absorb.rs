//! Absorption: pixels of high curvature join the region that they reach over their cheapest path (PARITY.md 2; not in the paper).
//!
//! Without absorption every object would lose 2 to 6 px at its borders. If the minimum-size pass joined these pixels instead,
//! regions would leak into each other.

use crate::buffers::Buffer;
use crate::oversegment::Superpixels;
use crate::oversegment::felzenszwalb::Components;
use crate::oversegment::graph::PixelGraph;
use crate::oversegment::pixel_edge::PixelEdge;
use crate::params;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::surface::depth_change::changes;
use crate::union_find::UnionFind;

/// Marks a pixel without a label.
const NONE: u32 = u32::MAX;

/// The common part number of all pixels that have a label from the start.
const SEED: u32 = PixelGraph::NO_PART - 1;

/// Gives each loose pixel the label that it reaches over its cheapest path: a minimum spanning forest seeded by the components of
/// at least `min_size_px` pixels. A pixel is loose if it lies in `borders` (high curvature) or in a smaller component. No path
/// crosses between pixels with and without depth, or a step of more than `depth_gate_per_m`·z² (m).
///
/// A loose pixel may reach no label: in `borders` it then belongs to no superpixel, elsewhere it keeps its component. Superpixels
/// are numbered in the order of their components' roots. O(edges · log pixels).
pub fn absorb(
    graph: &PixelGraph,
    components: &Components,
    borders: &Raster<bool>,
    depth_m: &Raster<f32>,
    params: &params::Absorption,
    min_size_px: u32,
) -> Superpixels {
    let is_seed =
        |i: usize| !borders[i] && components.size_px()[components.root()[i] as usize] >= min_size_px;
    let seeds = (0..graph.pixels()).map(|i| if is_seed(i) { components.root()[i] } else { NONE });
    let mut label: Buffer<u32> = seeds.collect();
    let core = borders.with_data(label.iter().map(|&l| l != NONE).collect());

    let mut sets = UnionFind::of_pixels(graph.pixels());
    // Edges between two labelled pixels decide nothing, so these share one part; every other pixel is its own part.
    let part: Buffer<u32> = (0..).zip(&*label).map(|(i, &l)| if l == NONE { i } else { SEED }).collect();
    graph.edges_between(&part).between_sets(
        &mut sets,
        &mut |sets: &mut UnionFind, edge: PixelEdge, (p, q): (usize, usize)| {
            let gated = changes(depth_m[edge.p as usize], depth_m[edge.q as usize], params.depth_gate_per_m);
            if !gated && (label[p] == NONE || label[q] == NONE) {
                let (root, child) = if label[p] == NONE { (q, p) } else { (p, q) };
                sets.link(root, child);
            }
        },
    );
    let reached: Buffer<u32> = (0..graph.pixels()).map(|i| label[sets.find(i)]).collect();
    for (i, label) in label.iter_mut().enumerate() {
        *label = match reached[i] {
            NONE if !borders[i] => components.root()[i],
            reached => reached,
        };
    }
    Superpixels { segments: number(&label, borders), core }
}

/// Numbers the labels, which are pixel indices, in ascending order.
fn number(label: &[u32], shape: &Raster<bool>) -> Segments {
    let mut number = Buffer::filled(label.len(), Segments::NONE);
    for &l in label.iter().filter(|&&l| l != NONE) {
        number[l as usize] = 0;
    }
    let mut count = 0;
    for number in number.iter_mut().filter(|n| **n == 0) {
        *number = count;
        count += 1;
    }
    let labels = label.iter().map(|&l| if l == NONE { Segments::NONE } else { number[l as usize] });
    Segments::from_numbered(shape.with_data(labels.collect()), count as usize)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::camera::Camera;
    use crate::frame::Frame;
    use crate::oversegment::felzenszwalb::segment;
    use crate::oversegment::graph::Unmeasured;
    use crate::oversegment::graph::testing::naive_edges;

    /// One row: depth per pixel (`NaN` = none), which pixels are borders, minimum size.
    fn superpixels(depth: &[f32], borders: &[bool], min_size_px: u32) -> Superpixels {
        let depth = Raster::from_vec(depth.len(), 1, depth.to_vec()).unwrap();
        let borders = Raster::from_vec(borders.len(), 1, borders.to_vec()).unwrap();
        let frame = Frame::new(depth, None, Camera::new(1.0, 1.0, 0.0, 0.0).unwrap()).unwrap();
        let params = params::Graph { channels: params::Channels::Depth, min_size_px, ..Default::default() };
        let graph = PixelGraph::new(&frame, None, Unmeasured::Apart, &params::Sensor::default(), &params);
        let components = segment(&graph, &borders, &params);
        absorb(&graph, &components, &borders, frame.depth_m(), &params::Absorption::default(), min_size_px)
    }

    #[test]
    fn a_border_goes_to_the_side_it_resembles() {
        // The border pixel at index 2 lies nearer in depth to the right side.
        let found = superpixels(&[1.0, 1.0, 1.009, 1.010, 1.010], &[false, false, true, false, false], 2);
        assert_eq!(found.segments.labels().as_slice(), [0, 0, 1, 1, 1]);
        assert_eq!(found.core.as_slice(), [true, true, false, true, true]);
    }

    #[test]
    fn nothing_is_absorbed_across_a_step_or_into_the_unmeasured() {
        let border = [false, false, true, false, false];
        let found = superpixels(&[1.0, 1.0, 1.5, f32::NAN, f32::NAN], &border, 2);
        assert_eq!(found.segments.labels().as_slice(), [0, 0, -1, 1, 1]);
    }

    #[test]
    fn a_small_component_out_of_reach_stays_a_region_without_core() {
        let border = [false, false, true, false, false, false];
        let found = superpixels(&[1.0, 1.0, 2.0, 3.0, 3.0, 3.0], &border, 3);
        assert_eq!(found.segments.labels().as_slice(), [0, 0, -1, 1, 1, 1]);
        assert_eq!(found.core.as_slice(), [false, false, false, true, true, true]);
    }

    /// Labels the loose pixels one by one, always over the cheapest edge from a labelled to an unlabelled pixel (Prim), while the
    /// code joins sets (Kruskal). Edges of equal weight have an order, so both grow the same forest.
    fn one_by_one(
        graph: &PixelGraph,
        components: &Components,
        borders: &Raster<bool>,
        depth_m: &Raster<f32>,
        gate_per_m: f32,
        min_size_px: usize,
    ) -> Superpixels {
        let root = components.root();
        let is_large = |i: usize| root.iter().filter(|&&r| r == root[i]).count() >= min_size_px;
        let seed = |i: usize| (!borders[i] && is_large(i)).then(|| root[i] as i32);
        let mut label: Vec<Option<i32>> = (0..root.len()).map(seed).collect();
        let core = borders.with_data(label.iter().map(Option::is_some).collect());
        let open = |p: usize, q: usize| match (depth_m[p], depth_m[q]) {
            (p, q) if p.is_nan() || q.is_nan() => p.is_nan() && q.is_nan(),
            (p, q) => (p - q).abs() <= gate_per_m * f32::max(p * p, q * q),
        };
        let ends: Vec<_> = naive_edges(graph).iter().map(|e| (e.p as usize, e.q as usize)).collect();
        while let Some(&(p, q)) =
            ends.iter().find(|&&(p, q)| label[p].is_some() != label[q].is_some() && open(p, q))
        {
            let reached = label[p].or(label[q]);
            (label[p], label[q]) = (reached, reached);
        }
        let kept = |i: usize| label[i].unwrap_or(if borders[i] { -1 } else { root[i] as i32 });
        let labels = borders.with_data((0..root.len()).map(kept).collect());
        Superpixels { segments: Segments::from_labels(&labels), core }
    }

    proptest! {
        #[test]
        fn equals_the_naive_growth_from_pixel_to_pixel(
            (width, pixels) in (1_usize..12, 1_usize..12).prop_flat_map(|(w, h)| {
                (Just(w), prop::collection::vec((0_u8..6, 0_u8..10, 0_u8..5), w * h))
            }),
            k in 0.0_f32..100.0,
            min_size_px in 0_u32..20,
            gate_per_m in 0.0_f32..0.03,
        ) {
            // Few depths make many equal weights, and steps on both sides of the gate.
            let depth = pixels.iter().map(|p| if p.1 == 0 { f32::NAN } else { 1.0 + 0.006 * f32::from(p.0) });
            let mut depth = Raster::from_vec(width, pixels.len() / width, depth.collect()).unwrap();
            depth.as_mut_slice()[0] = 1.0;
            let borders = depth.with_data(pixels.iter().map(|p| p.2 == 0).collect());
            let frame = Frame::new(depth, None, Camera::new(1.0, 1.0, 0.0, 0.0).unwrap()).unwrap();
            let params = params::Graph {
                channels: params::Channels::Depth, size_preference_grey: k, min_size_px: min_size_px / 2, ..Default::default()
            };
            let graph = PixelGraph::new(&frame, None, Unmeasured::Apart, &params::Sensor::default(), &params);
            let components = segment(&graph, &borders, &params);
            let gate = params::Absorption { depth_gate_per_m: gate_per_m };
            let fast = absorb(&graph, &components, &borders, frame.depth_m(), &gate, min_size_px);
            let slow =
                one_by_one(&graph, &components, &borders, frame.depth_m(), gate_per_m, min_size_px as usize);
            prop_assert_eq!(fast.core, slow.core);
            prop_assert_eq!(fast.segments, slow.segments);
        }
    }
}
