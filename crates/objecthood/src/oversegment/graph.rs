//! The graph over the pixels and its edge weights (paper, eq. 1).

use glam::Vec3;
use rayon::prelude::*;

use crate::frame::Frame;
use crate::params::{self, Channels};
use crate::raster::Raster;

/// Column and row steps to the four neighbours that follow a pixel in the graph: right, down, down-right, down-left.
const STEPS: [(isize, usize); 4] = [(1, 0), (0, 1), (1, 1), (-1, 1)];

/// Weight of an edge that only the minimum-size pass may cross: heavier than any colour or disparity difference.
const APART: f32 = f32::INFINITY;

/// How pixels without depth enter the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unmeasured {
    /// Apart from everything with depth and one among themselves, so that their colour changes nothing elsewhere.
    Apart,
    /// By colour alone (METHOD 2.3), for the paper's comparison without curvature.
    ByColor,
}

/// An edge between two 8-neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PixelEdge {
    /// Dissimilarity, eq. 1.
    pub(crate) weight: f32,
    /// Index of the pixel that comes first in scan order.
    pub(crate) p: u32,
    /// Index of the other pixel.
    pub(crate) q: u32,
}

/// The edges of the graph over all pixels, lightest first; equal weights in scan order of p, then right, down,
/// down-right, down-left.
#[derive(Clone, Debug)]
pub struct PixelGraph {
    pixels: usize,
    edges: Vec<PixelEdge>,
}

impl PixelGraph {
    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.pixels
    }

    /// The edges, lightest first.
    pub(crate) fn edges(&self) -> &[PixelEdge] {
        &self.edges
    }

    /// Builds the edges between 8-neighbours and sorts them.
    ///
    /// Between two pixels with depth the weight is eq. 1: α·‖ΔRGB‖ + (1 - α)·|ΔD|, with the colours of `smoothed`
    /// (grey levels 0..255, [`super::smoothing::smooth`]) and D = disparity in quanta of the sensor. Where a pixel
    /// has no depth, `unmeasured` decides. Without colour give [`Channels::Depth`].
    ///
    /// *Differs from the paper:* eq. 1 says depth, its text disparity; in metres the term would vanish against
    /// colours, so it is disparity, in units of what the sensor resolves.
    /// O(pixels): the sort is a radix sort.
    pub fn new(
        frame: &Frame,
        smoothed: Option<&Raster<[f32; 3]>>,
        unmeasured: Unmeasured,
        sensor: &params::Sensor,
        params: &params::Graph,
    ) -> Self {
        let (width, height) = frame.size();
        let quantum = sensor.disparity_quantum_per_m;
        let disparity = frame.depth_m().map(|&z| (1.0 / (f64::from(z) * quantum)) as f32);
        let alpha = match params.channels {
            Channels::Color => 1.0,
            Channels::Depth => 0.0,
            Channels::Both => params.color_weight,
        };
        let weight = |p: usize, q: usize| {
            let color = || smoothed.map_or(0.0, |s| Vec3::from(s[p]).distance(Vec3::from(s[q])));
            match (frame.is_valid(p), frame.is_valid(q)) {
                (true, true) if alpha == 0.0 => (disparity[p] - disparity[q]).abs(),
                (true, true) => alpha * color() + (1.0 - alpha) * (disparity[p] - disparity[q]).abs(),
                _ if unmeasured == Unmeasured::ByColor => color(),
                (false, false) => 0.0,
                _ => APART,
            }
        };
        // Every row has an edge to the right, down and to both sides downwards from each pixel but those at the
        // ends; the last row only has those to the right.
        let (edges_of_a_row, edges_of_the_last) = (4 * width - 3, width - 1);
        let none = PixelEdge { weight: 0.0, p: 0, q: 0 };
        let mut edges = vec![none; (height - 1) * edges_of_a_row + edges_of_the_last];
        edges.par_chunks_mut(edges_of_a_row).enumerate().for_each(|(v, row)| {
            let mut row = row.iter_mut();
            for u in 0..width {
                for (du, dv) in STEPS {
                    let (un, vn) = (u.wrapping_add_signed(du), v + dv);
                    let inside = un < width && vn < height;
                    if let Some(edge) = if inside { row.next() } else { None } {
                        let (p, q) = (v * width + u, vn * width + un);
                        *edge = PixelEdge { weight: weight(p, q), p: p as u32, q: q as u32 };
                    }
                }
            }
        });
        radsort::sort_by_key(&mut edges, |e| e.weight);
        Self { pixels: width * height, edges }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;

    /// Three columns: two with depth, one without.
    fn frame() -> Frame {
        let depth = Raster::from_vec(3, 2, vec![1.0, 1.25, f32::NAN, 1.0, 1.0, f32::NAN]).unwrap();
        Frame::new(depth, None, Camera::new(1.0, 1.0, 0.0, 0.0).unwrap()).unwrap()
    }

    fn weight_between(graph: &PixelGraph, p: u32, q: u32) -> f32 {
        graph.edges().iter().find(|e| (e.p, e.q) == (p, q)).unwrap().weight
    }

    #[test]
    fn eq_1_and_its_switches() {
        let smoothed =
            Raster::from_vec(3, 2, [0.0, 30.0, 90.0, 0.0, 0.0, 0.0].map(|c| [0.0, c, 0.0]).to_vec());
        let smoothed = smoothed.unwrap();
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
        let pairs: Vec<_> = graph.edges().iter().map(|e| (e.p, e.q)).collect();
        let scan = [(0, 1), (0, 3), (0, 4), (1, 2), (1, 4), (1, 5), (1, 3), (2, 5), (2, 4), (3, 4), (4, 5)];
        assert_eq!(pairs, scan, "all weights are 0");
    }
}
