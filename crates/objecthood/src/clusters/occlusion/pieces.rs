//! Pieces: facets that may be cut by something nearer.

use glam::DVec3;

use super::spread::{Sample, Spread};
use crate::clusters::cluster::Clusters;
use crate::clusters::scene::Scene;
use crate::regions::SegmentId;
use crate::surface::disparity::position;

/// Least number of pixels of a piece (px at a focal length of 525 px).
const FACET_PX: usize = 80;
/// Least number of pixels of a piece in an image of any size: fewer do not fix a surface.
pub(super) const LEAST_FACET_PX: usize = 12;
/// Least share of its cluster's pixels that a piece has.
const FACET_SHARE: f64 = 0.15;
/// A cluster counts as cut when other clusters are in front of it along at least this many pixel pairs (px at 525 px).
const OCCLUDED_PX: usize = 8;
/// Number of samples of a piece, evenly spaced over its pixels; a small piece repeats some.
pub(super) const SAMPLES: usize = 150;
/// Bits of each colour channel in the histograms.
const COLOR_BITS: u32 = 2;

/// A facet that may be cut by something nearer.
pub(super) struct Piece {
    /// Its label.
    pub(super) facet: SegmentId,
    pub(super) cluster: SegmentId,
    /// In scan order.
    pub(super) pixels: Vec<u32>,
    /// Mean column and row (px).
    pub(super) centroid: [f64; 2],
    /// Point on the facet's surface at the centroid (m).
    pub(super) middle_m: DVec3,
    /// Positions of [`SAMPLES`] pixels, evenly spaced, with their disparities (quanta).
    pub(super) samples: Vec<Sample>,
    pub(super) spread: Spread,
    /// Share of its pixels in each cell of colour; empty without colour.
    colors: Vec<f64>,
}

impl Piece {
    fn new(scene: &Scene<'_>, facet: SegmentId, cluster: SegmentId, pixels: Vec<u32>) -> Self {
        let width = scene.disparity.width();
        let sum = pixels.iter().fold([0.0; 2], |[x, y], &i| {
            let [u, v] = position(i as usize, width);
            [x + u, y + v]
        });
        let centroid = sum.map(|sum| sum / pixels.len() as f64);
        let sample = |q: usize| {
            let i = pixels[q * pixels.len() / SAMPLES] as usize;
            (position(i, width), f64::from(scene.disparity[i]))
        };
        let samples: Vec<Sample> = (0..SAMPLES).map(sample).collect();
        let spread = Spread::of(&samples);
        let colors = scene.color.map(|color| histogram(&pixels, |i| color[i])).unwrap_or_default();
        // At least 1 quantum: a curved surface may have no positive disparity at the centroid.
        let disparity = scene.facets.models[facet.index()].value(centroid).max(1.0);
        let middle_m = DVec3::from(scene.space.point_m(centroid, disparity));
        Self { facet, cluster, pixels, centroid, middle_m, samples, spread, colors }
    }

    /// Overlap of the colour histograms, in [0, 1]; limited to 1 because of rounding.
    pub(super) fn color_overlap(&self, other: &Self) -> f64 {
        let common = |(x, y): (&f64, &f64)| x.min(*y);
        self.colors.iter().zip(&other.colors).map(common).sum::<f64>().min(1.0)
    }
}

/// The large facets of cut clusters. O(pixels of those clusters).
pub(super) fn find_pieces(clusters: &Clusters<'_>) -> Vec<Piece> {
    let scene = clusters.scene;
    let least_px = scene.space.area_px(FACET_PX).max(LEAST_FACET_PX);
    let judge = |(free, pixels): (usize, Vec<u32>)| {
        let cluster = clusters.of_facet(free)?;
        let share = pixels.len() as f64 / clusters.get(cluster).pixels.len() as f64;
        let is_piece = pixels.len() >= least_px && share >= FACET_SHARE;
        is_piece
            .then(|| Piece::new(scene, SegmentId((scene.facets.structure + free) as u32), cluster, pixels))
    };
    cut_facets(clusters).into_iter().enumerate().filter_map(judge).collect()
}

/// The pixels of each facet outside the structure, in scan order; empty for facets of clusters that are not cut.
fn cut_facets(clusters: &Clusters<'_>) -> Vec<Vec<u32>> {
    let (facets, space) = (clusters.scene.facets, clusters.scene.space);
    let least_hidden = space.length_px(OCCLUDED_PX) as u32;
    let hidden_along = |id: SegmentId| {
        let others = clusters.get(id).neighbours.iter().filter(|(other, _)| other.is_some());
        others.map(|(_, borders)| borders.behind).sum::<u32>()
    };
    let mut pixels: Vec<Vec<u32>> = vec![Vec::new(); facets.segments.count() - facets.structure];
    for id in clusters.alive().into_iter().filter(|&id| hidden_along(id) >= least_hidden) {
        for &i in &clusters.get(id).pixels {
            // The bottom of a vessel has the facet of the structure, or none.
            let facet = facets.segments.at(i as usize);
            let free = facet.and_then(|facet| facet.index().checked_sub(facets.structure));
            free.into_iter().for_each(|free| pixels[free].push(i));
        }
    }
    pixels
}

/// The share of pixels in each cell of a coarse RGB histogram.
fn histogram(pixels: &[u32], color: impl Fn(usize) -> [u8; 3]) -> Vec<f64> {
    let mut shares = vec![0.0; 1 << (3 * COLOR_BITS)];
    for &i in pixels {
        let cell = color(i as usize)
            .iter()
            .fold(0, |cell, &c| cell << COLOR_BITS | usize::from(c >> (8 - COLOR_BITS)));
        shares[cell] += 1.0 / pixels.len() as f64;
    }
    shares
}
