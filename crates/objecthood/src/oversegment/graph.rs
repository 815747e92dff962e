//! The graph over the pixels and its edge weights (paper, eq. 1).

use std::ops::Range;

use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::frame::Frame;
use crate::oversegment::edges::Edges;
use crate::oversegment::pixel_edge::{STEPS, columns};
use crate::params::{self, Channels};
use crate::raster::Raster;
use crate::simd::vectorized;

/// Weight of an edge that only the minimum-size pass may cross: larger than any difference of colour or disparity.
const APART: f32 = f32::INFINITY;

/// Rows of a band, which one task processes.
pub(crate) const BAND_ROWS: usize = 64;

/// How pixels without depth enter the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unmeasured {
    /// Separate from all pixels with depth, and equal among themselves. Their colour has no influence.
    Apart,
    /// By colour alone (PARITY.md 2), for the paper's comparison without curvature.
    ByColor,
}

/// The graph over all pixels. Only the weights of its edges are stored: edge number 4·p + d leads from pixel p in direction d of
/// right, down, down-right, down-left.
#[derive(Clone, Debug)]
pub struct PixelGraph {
    width: usize,
    /// Row by row, and in a row direction by direction: right, down, down-right, down-left.
    weights: Buffer<f32>,
}

impl PixelGraph {
    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.weights.len() / STEPS.len()
    }

    /// Number of columns.
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    /// The weights of a row: all to the right, then all downwards, down-right, down-left.
    pub(crate) fn row(&self, v: usize) -> &[f32] {
        &self.weights[STEPS.len() * v * self.width..][..STEPS.len() * self.width]
    }

    /// Weighs the edges between 8-neighbours.
    ///
    /// Between two pixels with depth the weight is eq. 1: α·‖ΔRGB‖ + (1 - α)·|ΔD|, with the colours of `smoothed`
    /// (grey levels 0..255, [`super::smoothing::smooth`]) and D = disparity in quanta of the sensor. Where a pixel
    /// has no depth, `unmeasured` decides. Without colour, `params.channels` has to be [`Channels::Depth`].
    ///
    /// *Differs from the paper:* eq. 1 has depth, the text disparity. In metres the term would be negligible beside colour, so it is
    /// disparity, counted in quanta of the sensor. O(pixels); parallel over bands of rows.
    pub fn new(
        frame: &Frame,
        smoothed: Option<&[Raster<f32>; 3]>,
        unmeasured: Unmeasured,
        sensor: &params::Sensor,
        params: &params::Graph,
    ) -> Self {
        let (width, height) = frame.size();
        let weighing = Weighing {
            alpha: match params.channels {
                Channels::Color => 1.0,
                Channels::Depth => 0.0,
                Channels::Both => params.color_weight,
            },
            by_color: unmeasured == Unmeasured::ByColor,
            quantum_per_m: sensor.disparity_quantum_per_m,
        };
        let mut weights = Buffer::filled(STEPS.len() * width * height, APART);
        weights.par_chunks_mut(BAND_ROWS * STEPS.len() * width).enumerate().for_each(|(band, weights)| {
            vectorized(
                #[inline(always)]
                || weighing.weigh_band(frame, smoothed, band * BAND_ROWS, weights),
            );
        });
        Self { width, weights }
    }

    /// The edges between different parts, except at pixels whose part is [`Self::NO_PART`].
    pub(crate) fn edges_between(&self, part: &[u32]) -> Edges {
        self.edges(&self.between(part))
    }

    /// Finds the edges between different parts, except at pixels whose part is [`Self::NO_PART`]. Bit d of a pixel stands for
    /// its edge in direction d. O(pixels).
    pub(crate) fn between(&self, part: &[u32]) -> Buffer<u8> {
        self.open(part, |p, q| (p != q) & (p != Self::NO_PART) & (q != Self::NO_PART))
    }

    /// Finds the edges between pixels that are not `shut`. Bit d of a pixel stands for its edge in direction d. O(pixels).
    pub(crate) fn without(&self, shut: &Raster<bool>) -> Buffer<u8> {
        self.open(shut.as_slice(), |p, q| !p & !q)
    }

    /// Finds the edges for whose two pixels `is_open` holds, given their values in `of`.
    fn open<T: Copy + Sync>(&self, of: &[T], is_open: impl Fn(T, T) -> bool + Sync) -> Buffer<u8> {
        let width = self.width;
        let mut open = Buffer::stale(of.len(), 0);
        open.par_chunks_mut(width).enumerate().for_each(|(v, open)| {
            vectorized(
                #[inline(always)]
                || {
                    open.fill(0);
                    for (d, (du, dv)) in STEPS.into_iter().enumerate() {
                        let Some(others) = of.get((v + dv) * width..(v + dv + 1) * width) else { continue };
                        let (from, to) = columns(du, width);
                        let ends = of[v * width..][from.clone()].iter().zip(&others[to]);
                        for (open, (&p, &q)) in open[from].iter_mut().zip(ends) {
                            *open |= u8::from(is_open(p, q)) << d;
                        }
                    }
                },
            );
        });
        open
    }

    /// The edges whose bits are set in `open`; bits from 4 on are ignored.
    ///
    /// Only these edges are dealt and sorted. O(pixels + edges found).
    pub(crate) fn edges(&self, open: &[u8]) -> Edges {
        Edges::new(&self.weights, open, self.width)
    }

    /// Part number of a pixel whose edges are all left out.
    pub(crate) const NO_PART: u32 = u32::MAX;
}

/// Red, green, blue and disparity (quanta, `NaN` = none) of pixels in one row.
type Part<'a> = ([&'a [f32]; 3], &'a [f32]);

/// The settings of the weights, see [`PixelGraph::new`].
struct Weighing {
    alpha: f32,
    by_color: bool,
    quantum_per_m: f64,
}

impl Weighing {
    /// Weighs the edges of the rows from `top` on.
    #[inline(always)]
    fn weigh_band(
        &self,
        frame: &Frame,
        smoothed: Option<&[Raster<f32>; 3]>,
        top: usize,
        weights: &mut [f32],
    ) {
        let (width, height) = frame.size();
        let no_color = vec![0.0; width];
        let color = |v: usize, columns: Range<usize>| match smoothed {
            Some(planes) => planes.each_ref().map(|plane| &plane.as_slice()[v * width..][columns.clone()]),
            None => [&no_color[columns]; 3],
        };
        let [mut here, mut below] = [vec![0.0; width], vec![0.0; width]];
        self.read(&mut below, &frame.depth_m().as_slice()[top * width..]);
        for (v, weights) in (top..).zip(weights.chunks_exact_mut(STEPS.len() * width)) {
            std::mem::swap(&mut here, &mut below);
            if v + 1 < height {
                self.read(&mut below, &frame.depth_m().as_slice()[(v + 1) * width..]);
            }
            for ((du, dv), weights) in STEPS.into_iter().zip(weights.chunks_exact_mut(width)) {
                if v + dv < height {
                    let (from, to) = columns(du, width);
                    let other = if dv == 0 { &here } else { &below };
                    let (p, q) = (color(v, from.clone()), color(v + dv, to.clone()));
                    self.weigh_row((p, &here[from.clone()]), (q, &other[to]), &mut weights[from]);
                }
            }
        }
    }

    /// Computes the disparities of a row.
    #[inline(always)]
    fn read(&self, disparity: &mut [f32], depth_m: &[f32]) {
        for (disparity, &z) in disparity.iter_mut().zip(depth_m) {
            // Finite, so that no difference of two is NaN.
            let finite = (1.0 / (f64::from(z) * self.quantum_per_m)).min(f64::from(f32::MAX));
            *disparity = if z.is_nan() { f32::NAN } else { finite as f32 };
        }
    }

    /// Weighs the edges between the pixels of `p` and those of `q`.
    #[inline(always)]
    fn weigh_row(
        &self,
        ([r_p, g_p, b_p], d_p): Part<'_>,
        ([r_q, g_q, b_q], d_q): Part<'_>,
        weights: &mut [f32],
    ) {
        let n = weights.len();
        let (r_p, g_p, b_p, d_p) = (&r_p[..n], &g_p[..n], &b_p[..n], &d_p[..n]);
        let (r_q, g_q, b_q, d_q) = (&r_q[..n], &g_q[..n], &b_q[..n], &d_q[..n]);
        for i in 0..n {
            let (r, g, b) = (r_p[i] - r_q[i], g_p[i] - g_q[i], b_p[i] - b_q[i]);
            let color = (r * r + g * g + b * b).sqrt();
            let both = self.alpha * color + (1.0 - self.alpha) * (d_p[i] - d_q[i]).abs();
            let apart = if d_p[i].is_nan() & d_q[i].is_nan() { 0.0 } else { APART };
            let unmeasured = if self.by_color { color } else { apart };
            weights[i] = if both.is_nan() { unmeasured } else { both };
        }
    }
}

#[cfg(test)]
pub(crate) mod testing {
    use super::*;
    use crate::oversegment::pixel_edge::PixelEdge;
    use crate::union_find::UnionFind;

    /// A graph whose pixels' edges have these weights, in the order of their directions.
    pub(crate) fn of_weights(width: usize, pixels: &[[f32; 4]]) -> PixelGraph {
        let mut weights = vec![APART; STEPS.len() * pixels.len()];
        for (i, pixel) in pixels.iter().enumerate() {
            let (u, v) = (i % width, i / width);
            for (d, (du, dv)) in STEPS.into_iter().enumerate() {
                if u.wrapping_add_signed(du) < width && (v + dv) * width < pixels.len() {
                    weights[(STEPS.len() * v + d) * width + u] = pixel[d];
                }
            }
        }
        PixelGraph { width, weights: weights.into() }
    }

    /// The edges in their order, as long as no set is joined.
    pub(crate) fn in_order(graph: &PixelGraph, part: &[u32]) -> Vec<PixelEdge> {
        let mut edges = Vec::new();
        let sets = &mut UnionFind::new(graph.pixels());
        graph.edges_between(part).between_sets(
            sets,
            &mut |_: &mut UnionFind, edge: PixelEdge, roots: (usize, usize)| {
                assert_eq!(roots, (edge.p as usize, edge.q as usize));
                edges.push(edge);
            },
        );
        edges
    }

    /// All edges, pixel by pixel, sorted by comparisons.
    pub(crate) fn naive_edges(graph: &PixelGraph) -> Vec<PixelEdge> {
        let (width, height) = (graph.width, graph.pixels() / graph.width);
        let mut edges = Vec::new();
        for (u, v) in (0..height).flat_map(|v| (0..width).map(move |u| (u, v))) {
            for (d, (du, dv)) in STEPS.into_iter().enumerate() {
                let (un, vn) = (u.wrapping_add_signed(du), v + dv);
                if un < width && vn < height {
                    let weight = graph.weights[(4 * v + d) * width + u];
                    edges.push(PixelEdge { weight, p: (v * width + u) as u32, q: (vn * width + un) as u32 });
                }
            }
        }
        edges.sort_by(|a, b| a.weight.partial_cmp(&b.weight).unwrap());
        edges
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::testing::{in_order, naive_edges, of_weights};
    use super::*;
    use crate::camera::Camera;
    use crate::oversegment::pixel_edge::PixelEdge;

    /// Three columns: two with depth, one without.
    fn frame() -> Frame {
        let depth = Raster::from_vec(3, 2, vec![1.0, 1.25, f32::NAN, 1.0, 1.0, f32::NAN]).unwrap();
        Frame::new(depth, None, Camera::new(1.0, 1.0, 0.0, 0.0).unwrap()).unwrap()
    }

    fn weight_between(graph: &PixelGraph, p: u32, q: u32) -> f32 {
        naive_edges(graph).iter().find(|e| (e.p, e.q) == (p, q)).unwrap().weight
    }

    #[test]
    fn eq_1_and_its_switches() {
        let smoothed = [0.0, 1.0, 0.0].map(|c| {
            frame().depth_m().with_data([0.0, 30.0, 90.0, 0.0, 0.0, 0.0].map(|x| c * x).to_vec().into())
        });
        let sensor = params::Sensor { disparity_quantum_per_m: 0.01, ..Default::default() };
        let graph = |channels, unmeasured| {
            let params = params::Graph { channels, ..Default::default() };
            PixelGraph::new(&frame(), Some(&smoothed), unmeasured, &sensor, &params)
        };
        // Colours differ by 30, disparities by 100 - 80 quanta.
        let both = graph(Channels::Both, Unmeasured::Apart);
        assert!((weight_between(&both, 0, 1) - 25.0).abs() < 1e-3);
        assert!((weight_between(&graph(Channels::Color, Unmeasured::Apart), 0, 1) - 30.0).abs() < 1e-3);
        assert!((weight_between(&graph(Channels::Depth, Unmeasured::Apart), 0, 1) - 20.0).abs() < 1e-3);
        assert_eq!(weight_between(&both, 1, 2), APART);
        assert_eq!(weight_between(&both, 2, 5), 0.0);
        let by_color = graph(Channels::Both, Unmeasured::ByColor);
        assert_eq!(weight_between(&by_color, 1, 2), 60.0);
        assert_eq!(weight_between(&by_color, 2, 5), 90.0);
    }

    #[test]
    fn every_8_neighbour_pair_once_and_equal_weights_in_scan_order() {
        let graph = PixelGraph::new(
            &frame(),
            None,
            Unmeasured::ByColor,
            &params::Sensor::default(),
            &params::Graph { channels: Channels::Color, ..Default::default() },
        );
        let pairs: Vec<_> = in_order(&graph, &[0, 1, 2, 3, 4, 5]).iter().map(|e| (e.p, e.q)).collect();
        let scan = [(0, 1), (0, 3), (0, 4), (1, 2), (1, 4), (1, 5), (1, 3), (2, 5), (2, 4), (3, 4), (4, 5)];
        assert_eq!(pairs, scan, "all weights are 0");
    }

    #[test]
    fn edges_of_several_bands_are_those_of_a_sort_by_comparisons() {
        // Few weights, so that ties occur in all bands.
        let weight = |i: u32| (i.wrapping_mul(0x9e37_79b9) >> 26) as f32;
        let pixels: Vec<_> = (0..300 * 160).map(|p| [0, 1, 2, 3].map(|d| weight(4 * p + d))).collect();
        let graph = of_weights(300, &pixels);
        let part: Vec<u32> = (0..graph.pixels() as u32).collect();
        assert_eq!(in_order(&graph, &part), naive_edges(&graph));
    }

    proptest! {
        #[test]
        fn edges_are_those_of_a_sort_by_comparisons(
            (width, pixels) in prop_oneof![(1_usize..30, 1_usize..9), (1_usize..4, 60_usize..140)].prop_flat_map(|(w, h)| {
                // Weights of all magnitudes, many of them equal.
                let spread = prop_oneof![0.0_f32..1e-30, 0.0_f32..4.0, 0.0_f32..1e30];
                let weight = prop_oneof![spread, 1.0_f32..1.1, Just(0.5), Just(APART)];
                (Just(w), prop::collection::vec((prop::array::uniform4(weight), 0_u32..4), w * h))
            }),
        ) {
            let graph = of_weights(width, &pixels.iter().map(|p| p.0).collect::<Vec<_>>());
            let part: Vec<u32> = pixels.iter().map(|p| if p.1 == 0 { PixelGraph::NO_PART } else { p.1 }).collect();
            let wanted = |e: &PixelEdge| {
                let (p, q) = (part[e.p as usize], part[e.q as usize]);
                p != q && p != PixelGraph::NO_PART && q != PixelGraph::NO_PART
            };
            let expected: Vec<_> = naive_edges(&graph).into_iter().filter(wanted).collect();
            prop_assert_eq!(in_order(&graph, &part), expected);
        }
    }
}
