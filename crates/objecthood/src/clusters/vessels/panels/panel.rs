//! A panel: a thin, flat, upright piece, such as each wall of a box shows.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use crate::clusters::cluster::Clusters;
use crate::clusters::colors::Colors;
use crate::clusters::scene::{Scene, sampled};
use crate::clusters::vessels::piece::Piece;
use crate::oversegment::structure::StructureSurface;
use crate::planes::Plane;
use crate::quantile::{range, reach_m};
use crate::regions::SegmentId;

/// Least number of pixels of a panel (px at a focal length of 525 px).
const PANEL_PX: usize = 150;
/// Greatest sine of a panel's slant, 25 degrees: the walls of totes are slanted by up to 15, so that totes
/// can be stacked, and stereo smears their feet.
const SLANT: f64 = 0.42;
/// A panel is flat to within this (m), half of the greatest thickness of a wall, ...
const FLAT_M: f64 = 0.015;
/// ... or to this many quanta, for each time that the sensor's waves exceed a Kinect's,
const NOISE_QUANTA: f64 = 4.0;
/// between these quantiles of its pixels.
const FLAT_QUANTILES: [f64; 2] = [0.1, 0.9];
/// The plane of a panel is fitted to all of its points, then this many times to those near it.
const REFITS: usize = 2;
/// The left and the right half of a panel face the same way: the cosine of 20 degrees. The wall of a cup is no panel.
const STRAIGHT_COSINE: f64 = 0.94;
/// A panel is at least this long and this high (m): a smaller one is the rim of a thing.
const LENGTH_M: f64 = 0.04;
const HEIGHT_M: f64 = 0.02;
/// Lengths reach from the first to the second of these quantiles: outlines are noisy.
const ENDS: [f64; 2] = [0.02, 0.98];
/// Heights reach from the first to the second of these: a thing that stands before a wall is higher in a few
/// places.
const FOOT_AND_TOP: [f64; 2] = [0.02, 0.95];
/// A wall is thinner than this (m): behind its rim the camera sees past it, down to something farther by `BEHIND_M`.
const THICKNESS_M: f64 = 0.03;
const BEHIND_M: f64 = 0.02;
/// The camera sees past the wall along at least this share of the rim whose back it sees,
const THIN_SHARE: f64 = 0.7;
/// and it sees the back of at least this share of the rim.
const SIGHT_SHARE: f64 = 0.3;
/// The rim is the part at most this far below the top (m).
const RIM_M: f64 = 0.01;
/// About this many pixels of a rim are examined.
const RIM_SAMPLES: usize = 60;

/// Distances (m) below this are noise, for pixels at depth `z_m`.
pub(super) fn noise_m(scene: &Scene<'_>, z_m: f64) -> f64 {
    let quanta = NOISE_QUANTA * scene.space.noise().waves().max(1.0);
    scene.space.step_m(quanta, z_m).max(FLAT_M)
}

/// A thin upright wall in the plan view. Levels and heights are measured above the ground.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    /// The cluster that it is, or to which its facet belongs.
    pub cluster: SegmentId,
    /// Level, towards the camera.
    pub normal: DVec3,
    /// Level, along the wall.
    pub along: DVec3,
    /// Of the wall's plane: `normal · point` (m).
    pub offset_m: f64,
    /// Where the wall begins and ends: `along · point` (m).
    pub ends_m: [f64; 2],
    /// Where it begins and ends in height (m).
    pub foot_m: f64,
    pub top_m: f64,
    /// Distances below this are noise (m).
    pub noise_m: f64,
    pub colors: Colors,
    pub size_px: usize,
    /// The share of its cluster that is panels.
    pub wall_share: f64,
}

/// The clusters that are panels, and in the other clusters the facets that are panels, each in the order of
/// their numbers. O(pixels + clusters of which a part is a panel).
pub(super) fn find_panels(clusters: &Clusters<'_>, ground: &StructureSurface) -> Vec<Panel> {
    let (scene, facets) = (clusters.scene, clusters.scene.facets);
    let panel = |cluster: SegmentId, pixels: &[u32]| Panel::of(scene, ground, cluster, pixels);
    let mut panels: Vec<Panel> = clusters
        .alive()
        .into_iter()
        .filter_map(|cluster| panel(cluster, &clusters.get(cluster).pixels))
        .collect();
    let whole: BTreeSet<SegmentId> = panels.iter().map(|panel| panel.cluster).collect();
    let of_facets = facets.segments.runs_of_each().map(|facet, runs| {
        let cluster = clusters.of_facet(facet.checked_sub(facets.structure)?)?;
        let pixels: Vec<u32> = runs.iter().cloned().flatten().map(|i| i as u32).collect();
        (!whole.contains(&cluster)).then(|| panel(cluster, &pixels)).flatten()
    });
    let of_facets: Vec<Panel> = of_facets.into_iter().flatten().collect();
    // A small piece of a bowl is nearly flat.
    let in_part: BTreeSet<SegmentId> = of_facets.iter().map(|panel| panel.cluster).collect();
    let is_round = |cluster: &SegmentId| Piece::of(clusters, ground, *cluster).is_some();
    let round: BTreeSet<SegmentId> = in_part.into_iter().filter(is_round).collect();
    panels.extend(of_facets.into_iter().filter(|panel| !round.contains(&panel.cluster)));
    let mut wall_px = BTreeMap::new();
    for panel in &panels {
        *wall_px.entry(panel.cluster).or_insert(0) += panel.size_px;
    }
    for panel in &mut panels {
        let size_px = clusters.get(panel.cluster).pixels.len();
        panel.wall_share = wall_px[&panel.cluster] as f64 / size_px as f64;
    }
    panels
}

impl Panel {
    /// `None` if the pixels of the cluster show nothing upright, flat and thin, or too little of it.
    fn of(scene: &Scene<'_>, ground: &StructureSurface, cluster: SegmentId, pixels: &[u32]) -> Option<Self> {
        if pixels.len() < scene.space.area_px(PANEL_PX) {
            return None;
        }
        let up = ground.normal;
        let points: Vec<DVec3> = scene.sampled_points(pixels).collect();
        // At a small focal length the limit may be below one pixel.
        let noise_m = noise_m(scene, points.get(points.len() / 2)?.z);
        let plane = plane_of_most(&points, noise_m)?;
        let facing = plane.normal;
        if facing.dot(up).abs() > SLANT {
            return None;
        }
        let normal = (facing - up * up.dot(facing)).try_normalize()?;
        let along = up.cross(normal);
        let [near_m, far_m] = reach_m(points.iter().copied(), facing, FLAT_QUANTILES);
        let is_flat = (far_m - near_m).abs() < noise_m;
        // Most pieces end here, before all of their pixels are looked at.
        if !is_flat || !is_straight(scene, pixels, up, along) {
            return None;
        }
        // A thing that stands before a wall, or lies against it, may have become a part of its facet. A
        // sample may be in step with the rows of the image.
        let is_of_wall = |&i: &usize| plane.distance_m(scene.point_at(i)) < noise_m;
        let of_wall: Vec<usize> = pixels.iter().map(|&i| i as usize).filter(is_of_wall).collect();
        let ends_m = reach_m(of_wall.iter().map(|&i| scene.point_at(i)), along, ENDS);
        let mut heights_m: Vec<f64> = of_wall.iter().map(|&i| scene.height_m(i, ground)).collect();
        let [foot_m, top_m] = range(&mut heights_m, FOOT_AND_TOP);
        let is_wall = ends_m[1] - ends_m[0] >= LENGTH_M && top_m - foot_m >= HEIGHT_M;
        if !is_wall {
            return None;
        }
        let [offset_m, _] = reach_m(points.iter().copied(), normal, [0.5; 2]);
        let colors = Colors::of(scene, pixels);
        let panel = Self {
            cluster,
            normal,
            along,
            offset_m,
            ends_m,
            foot_m,
            top_m,
            noise_m,
            colors,
            size_px: pixels.len(),
            wall_share: 1.0,
        };
        panel.is_thin(scene, ground, pixels).then_some(panel)
    }

    /// Whether the camera sees past the wall at the height of its rim.
    fn is_thin(&self, scene: &Scene<'_>, ground: &StructureSurface, pixels: &[u32]) -> bool {
        let below_m = |i: usize| self.top_m - scene.height_m(i, ground);
        let rim: Vec<usize> = pixels.iter().map(|&i| i as usize).filter(|&i| below_m(i) < RIM_M).collect();
        let (mut past, mut solid, mut all) = (0_u32, 0_u32, 0_u32);
        for &i in rim.iter().step_by(rim.len().div_ceil(RIM_SAMPLES).max(1)) {
            all += 1;
            let behind = scene.point_at(i) + ground.normal * below_m(i) - self.normal * THICKNESS_M;
            let Some(j) = scene.space.camera().pixel_at(behind, scene.disparity.size()) else { continue };
            let farther_m = scene.space.depth_m(scene.disparity[j].into()) - behind.z;
            let limit_m = BEHIND_M.max(noise_m(scene, behind.z));
            past += u32::from(farther_m > limit_m);
            solid += u32::from(farther_m.abs() <= limit_m);
        }
        let known = f64::from(past + solid);
        past > 0 && known >= SIGHT_SHARE * f64::from(all) && f64::from(past) >= THIN_SHARE * known
    }

    /// Its ends in the plan view (m).
    pub(super) fn ends(&self) -> [DVec3; 2] {
        self.ends_m.map(|end_m| self.at(end_m))
    }

    /// Its middle in the plan view (m).
    pub(super) fn middle(&self) -> DVec3 {
        self.at(f64::midpoint(self.ends_m[0], self.ends_m[1]))
    }

    fn at(&self, along_m: f64) -> DVec3 {
        self.along * along_m + self.normal * self.offset_m
    }

    /// Its length (m).
    pub(super) fn length_m(&self) -> f64 {
        self.ends_m[1] - self.ends_m[0]
    }
}

/// The plane of most points: those within half of `noise_m` of it. Noise smears the edge where a wall meets
/// the bottom. `None` for fewer than three points.
fn plane_of_most(points: &[DVec3], noise_m: f64) -> Option<Plane> {
    let mut plane = Plane::fit(points.iter().copied())?;
    for _ in 0..REFITS {
        plane = Plane::fit(points.iter().copied().filter(|&point| plane.distance_m(point) < noise_m / 2.0))?;
    }
    Some(plane)
}

/// Whether the two halves of a wall face the same way in the plan view.
fn is_straight(scene: &Scene<'_>, pixels: &[u32], up: DVec3, along: DVec3) -> bool {
    let [middle_m, _] = reach_m(scene.sampled_points(pixels), along, [0.5; 2]);
    let mut facing = [DVec3::ZERO; 2];
    for i in sampled(pixels) {
        let normal = DVec3::from(scene.normals[i].map(f64::from));
        facing[usize::from(along.dot(scene.point_at(i)) > middle_m)] += normal - up * up.dot(normal);
    }
    let [left, right] = facing.map(DVec3::normalize_or_zero);
    left.dot(right) >= STRAIGHT_COSINE
}
