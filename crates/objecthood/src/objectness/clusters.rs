//! Clusters: shapes on their way to objects, and what is known of each (METHOD 3.9).

use std::collections::{BTreeMap, VecDeque};
use std::ops::AddAssign;
use std::sync::OnceLock;

use glam::{DVec3, Vec3};

use crate::facets::Facets;
use crate::objectness::join::{Join, JoinedPart};
use crate::objectness::objects::pixel_box;
use crate::oversegment::structure::{StructureSurface, percentile};
use crate::oversegment::watershed::neighbours;
use crate::raster::Raster;
use crate::regions::{RegionGraph, SegmentId, Segments};
use crate::shapes::contraction::Shapes;
use crate::surface::disparity::{DisparitySpace, position};

/// What stage 4 looks at besides the clusters: it stays as it is.
pub(crate) struct Scene<'a> {
    /// Facets and structure after [`fill`].
    pub facets: &'a Facets,
    pub disparity: &'a Raster<f32>,
    pub normals: &'a Raster<[f32; 3]>,
    pub points_m: &'a Raster<[f32; 3]>,
    pub color: Option<&'a Raster<[u8; 3]>>,
    pub space: &'a DisparitySpace,
    /// What objects stand on.
    pub support: Option<&'a StructureSurface>,
}

/// How two clusters lie to each other in the image: pairs of neighbouring pixels, also across a gap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Borders {
    /// Next to each other without a step in depth.
    pub touch: u32,
    /// The same across a gap.
    pub level: u32,
    /// This one before the other.
    pub in_front: u32,
    /// The other before this one.
    pub behind: u32,
}

/// A group of facets.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cluster {
    /// In scan order; empty when it has been merged into another.
    pub pixels: Vec<u32>,
    /// How it lies to others; `None` = the background, which is all structure.
    pub neighbours: BTreeMap<Option<SegmentId>, Borders>,
    /// Which of its parts were joined although they do not touch as one surface, each with the facet that hides what is between.
    pub joins: Vec<(Join, Option<SegmentId>)>,
    top_m: OnceLock<f64>,
    concavity: OnceLock<f64>,
}

/// The clusters of a frame. Merging keeps everything known of them in step.
pub(crate) struct Clusters<'a> {
    pub scene: &'a Scene<'a>,
    clusters: Vec<Cluster>,
    /// Cluster of each facet that is no structure; `None` = background.
    of_facet: Vec<Option<SegmentId>>,
    /// Pixels of clusters that turned out to be background.
    remains: Vec<u32>,
}

/// Pixels farther apart in a row or column (px at a focal length of 525 px) are no neighbours.
const REACH_PX: usize = 24;
/// How high a cluster is: this share of its pixels is lower.
const TOP_SHARE: f64 = 0.98;
/// Fewer pixels (at 525 px) tell nothing about concavity.
const CONCAVITY_PX: usize = 80;
/// Concavity looks at about so many points ...
const CONCAVITY_SAMPLES: usize = 48;
/// ... and at pairs of them whose squared distance (m^2) is at least this.
const CONCAVITY_APART_M2: f64 = 1e-5;

/// Gives measured pixels without a facet to the facet of a neighbour, breadth first, across steps of at most `jump_quanta`.
/// O(pixels).
pub(crate) fn fill(facets: Facets, disparity: &Raster<f32>, jump_quanta: f32) -> Facets {
    let count = facets.segments.count();
    let mut labels = facets.segments.labels().clone();
    let (width, height) = labels.size();
    let slice = labels.as_mut_slice();
    let mut open: VecDeque<usize> = (0..slice.len()).filter(|&i| slice[i] >= 0).collect();
    while let Some(i) = open.pop_front() {
        for (j, _) in neighbours(i, width, height) {
            if slice[j] < 0 && (disparity[j] - disparity[i]).abs() <= jump_quanta {
                slice[j] = slice[i];
                open.push_back(j);
            }
        }
    }
    Facets { segments: Segments::from_numbered(labels, count), ..facets }
}

impl AddAssign for Borders {
    fn add_assign(&mut self, other: Self) {
        self.touch += other.touch;
        self.level += other.level;
        self.in_front += other.in_front;
        self.behind += other.behind;
    }
}

impl Borders {
    /// As the other cluster sees it.
    fn mirrored(self) -> Self {
        Self { in_front: self.behind, behind: self.in_front, ..self }
    }
}

impl<'a> Clusters<'a> {
    /// The shapes. Neighbours differ by at most `jump_quanta` where no step parts them. O(pixels).
    pub(crate) fn new(scene: &'a Scene<'a>, shapes: &Shapes, jump_quanta: f32) -> Self {
        let Shapes { of_facet: shape_of, count } = shapes;
        let of_facet: Vec<_> = shape_of.iter().map(|&shape| Some(SegmentId(shape))).collect();
        let mut clusters = vec![Cluster::default(); *count];
        let Facets { segments, structure, .. } = scene.facets;
        for (i, facet) in segments.members() {
            if let Some(shape) = facet.checked_sub(*structure) {
                clusters[shape_of[shape] as usize].pixels.push(i as u32);
            }
        }
        for edge in lie_of_clusters(scene, shapes, jump_quanta).edges() {
            // Region 0 is the background.
            let [a, b] = [edge.a, edge.b].map(|k| k.0.checked_sub(1).map(SegmentId));
            for (own, other, borders) in [(a, b, edge.evidence), (b, a, edge.evidence.mirrored())] {
                if let Some(own) = own {
                    clusters[own.index()].neighbours.insert(other, borders);
                }
            }
        }
        Self { scene, clusters, of_facet, remains: Vec::new() }
    }

    /// The clusters that have pixels, in ascending order.
    pub(crate) fn alive(&self) -> Vec<SegmentId> {
        let alive = (0..self.clusters.len()).filter(|&k| !self.clusters[k].pixels.is_empty());
        alive.map(|k| SegmentId(k as u32)).collect()
    }

    /// A cluster.
    pub(crate) fn get(&self, id: SegmentId) -> &Cluster {
        &self.clusters[id.index()]
    }

    /// The cluster of a facet that comes after the structure, counted from 0.
    pub(crate) fn of_facet(&self, facet: usize) -> Option<SegmentId> {
        self.of_facet[facet]
    }

    /// What a cluster looks like as a part of something.
    pub(crate) fn part(&self, id: SegmentId) -> JoinedPart {
        let pixels = self.get(id).pixels.iter().map(|&i| i as usize);
        JoinedPart { size_px: pixels.len(), box_px: pixel_box(pixels, self.scene.disparity.width()) }
    }

    /// How `a` lies to `b`.
    pub(crate) fn borders(&self, a: SegmentId, b: SegmentId) -> Borders {
        self.get(a).neighbours.get(&Some(b)).copied().unwrap_or_default()
    }

    /// Notes why a cluster is one although its parts do not touch as one surface, and the facet that hides what is between.
    pub(crate) fn note(&mut self, id: SegmentId, join: Join, hider: Option<SegmentId>) {
        self.clusters[id.index()].joins.push((join, hider));
    }

    /// Pixels of clusters that were merged into the background.
    pub(crate) fn remains(&self) -> &[u32] {
        &self.remains
    }

    /// Merges a cluster into another, or into the background. O(pixels of both + neighbours).
    pub(crate) fn merge(&mut self, into: Option<SegmentId>, from: SegmentId) {
        let Cluster { pixels, neighbours, joins, .. } = std::mem::take(&mut self.clusters[from.index()]);
        for cluster in self.of_facet.iter_mut().filter(|cluster| **cluster == Some(from)) {
            *cluster = into;
        }
        for (other, borders) in neighbours.into_iter().filter(|&(other, _)| other != into) {
            if let Some(other) = other {
                let seen = &mut self.clusters[other.index()].neighbours;
                seen.remove(&Some(from));
                *seen.entry(into).or_default() += borders.mirrored();
            }
            if let Some(into) = into {
                *self.clusters[into.index()].neighbours.entry(other).or_default() += borders;
            }
        }
        let Some(into) = into else {
            self.remains.extend(pixels);
            return;
        };
        let cluster = &mut self.clusters[into.index()];
        cluster.neighbours.remove(&Some(from));
        cluster.pixels.extend(pixels);
        // Two sorted runs: linear.
        cluster.pixels.sort();
        cluster.joins.extend(joins);
        cluster.top_m = OnceLock::new();
        cluster.concavity = OnceLock::new();
    }

    /// How high a cluster stands (m) above a surface: nearly its highest pixel. Single noisy pixels stand high anywhere.
    pub(crate) fn top_m(&self, id: SegmentId, support: &StructureSurface) -> f64 {
        let cluster = self.get(id);
        *cluster.top_m.get_or_init(|| {
            let every_other = cluster.pixels.iter().step_by(2);
            let mut heights: Vec<f64> =
                every_other.map(|&i| self.scene.height_m(i as usize, support)).collect();
            percentile(&mut heights, TOP_SHARE)
        })
    }

    /// How a cluster bends: the mean over pairs of its points of how much the normals turn apart along the way, above 0
    /// when it is convex, below 0 when it is concave, 0 when it is flat or small. Between -2 and 2. O(1).
    pub(crate) fn concavity(&self, id: SegmentId) -> f64 {
        let cluster = self.get(id);
        *cluster.concavity.get_or_init(|| self.scene.concavity(&cluster.pixels))
    }
}

impl Scene<'_> {
    /// Height (m) of a pixel above a surface.
    pub(crate) fn height_m(&self, i: usize, support: &StructureSurface) -> f64 {
        support.height_m(position(i, self.disparity.width()), f64::from(self.disparity[i]), self.space)
    }

    fn concavity(&self, pixels: &[u32]) -> f64 {
        if pixels.len() < self.space.area_px(CONCAVITY_PX) {
            return 0.0;
        }
        let step = (pixels.len() / CONCAVITY_SAMPLES).max(1);
        let sampled = pixels.iter().map(|&i| i as usize).skip(step / 2).step_by(step);
        let samples: Vec<(DVec3, DVec3)> = sampled
            .filter(|&i| self.normals[i] != [0.0; 3])
            .map(|i| {
                let at = position(i, self.disparity.width());
                let point = self.space.point_m(at, f64::from(self.disparity[i]));
                (point, Vec3::from(self.normals[i]).as_dvec3())
            })
            .collect();
        let (mut sum, mut pairs) = (0.0, 0);
        for (k, (x, n)) in samples.iter().enumerate() {
            for (y, m) in &samples[k + 1..] {
                let apart = *x - *y;
                if apart.length_squared() >= CONCAVITY_APART_M2 {
                    sum += apart.dot(*n - *m) / apart.length();
                    pairs += 1;
                }
            }
        }
        if pairs == 0 { 0.0 } else { sum / f64::from(pairs) }
    }
}

/// How any two clusters lie to each other; region 0 is the background, region k + 1 is cluster k.
fn lie_of_clusters(scene: &Scene<'_>, shapes: &Shapes, jump_quanta: f32) -> RegionGraph<Borders> {
    let Facets { segments, structure, .. } = scene.facets;
    let (width, height) = segments.labels().size();
    let reach = scene.space.length_px(REACH_PX);
    let region = |i: usize| {
        let facet = segments.at(i)?.index();
        Some(facet.checked_sub(*structure).map_or(0, |shape| shapes.of_facet[shape] + 1))
    };
    let mut samples = Vec::new();
    // Along a line of pixels, `stride` apart: neighbours are those with nothing but holes between them.
    let mut walk = |start: usize, stride: usize, length: usize| {
        let mut last: Option<(usize, u32)> = None;
        for t in 0..length {
            let Some(b) = region(start + t * stride) else { continue };
            if let Some((s, a)) = last
                && a != b
                && t - s <= reach
            {
                let [d_a, d_b] = [s, t].map(|t| scene.disparity[start + t * stride]);
                let rise = if a < b { d_a - d_b } else { d_b - d_a };
                let borders = match (rise.abs(), t - s) {
                    (step, 1) if step <= jump_quanta + 1.0 => Borders { touch: 1, ..Default::default() },
                    (step, _) if step <= jump_quanta => Borders { level: 1, ..Default::default() },
                    _ if rise > 0.0 => Borders { in_front: 1, ..Default::default() },
                    _ => Borders { behind: 1, ..Default::default() },
                };
                samples.push((SegmentId(a), SegmentId(b), borders));
            }
            last = Some((t, b));
        }
    };
    (0..height).for_each(|v| walk(v * width, 1, width));
    (0..width).for_each(|u| walk(u, width, height));
    RegionGraph::gather(shapes.count + 1, samples, |sum: &mut Borders, borders| *sum += borders)
}
