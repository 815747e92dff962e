//! Whether a part is the level top face of another (docs/CONTEXT.md 4.7.3).

use glam::DVec3;

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::scene::{Scene, level_share};
use crate::neighbours::four_neighbours;
use crate::quantile::{element_at, reach_m};
use crate::regions::SegmentId;

/// At least this share of a top face is level.
const LEVEL_SHARE: f64 = 0.75;
/// The edge of a top is at most this far below its level (m): a thicker thing shows a side of its own.
const RIM_M: f64 = 0.008;
/// The side is set back from the edge by at most this (m): with time of flight, light that comes by way of
/// the table lengthens distances by as much, and lids overhang.
const SET_BACK_M: f64 = 0.035;
/// Distances of fewer quanta than this are noise.
const NOISE_QUANTA: f64 = 2.0;
/// The width of the top is divided into this many stripes ...
const STRIPES: usize = 10;
/// ... and the side begins in at least this share of them.
const STRIPE_SHARE: f64 = 0.8;
/// The width of the side over that of the top: a separate thing on another has another width.
const WIDTHS: [f64; 2] = [0.85, 1.18];
/// Widths reach from the first to the second of these quantiles: outlines are noisy.
const QUANTILES: [f64; 2] = [0.005, 0.995];

/// The checks by which the first part is the top face of the second; `None` when one fails. O(pixels of the part).
pub(super) fn checks(clusters: &Clusters<'_>, up: DVec3, [top, body]: [SegmentId; 2]) -> Option<Vec<Check>> {
    let scene = clusters.scene;
    let pixels = [top, body].map(|id| &clusters.get(id).pixels[..]);
    let level_share = level_share(scene, up, pixels[0]);
    let level = Check::new("share of the top that is level", "", level_share, Bound::AtLeast, LEVEL_SHARE);
    if !level.holds() {
        return None;
    }
    let [level_m, middle_m] = pixels.map(|pixels| {
        let mut heights: Vec<f64> = scene.sampled_points(pixels).map(|point| up.dot(point)).collect();
        element_at(&mut heights, 0.5)
    });
    let aside = up.cross(scene.point_at(pixels[0][pixels[0].len() / 2] as usize)).try_normalize()?;
    let across = pixels.map(|pixels| Extent::of(scene, aside, pixels));
    let width_share = across[1].width_m() / across[0].width_m();
    let rise_m = level_m - middle_m;
    let limits = Limits { level_m, up, aside };
    let check = |name, unit, value, bound, limit| Check::new(name, unit, value, bound, limit);
    let width = "width of the side, over that of the top";
    let mut checks = vec![
        level,
        check("the top above the middle of the side", "m", rise_m, Bound::Above, RIM_M),
        check(width, "", width_share, Bound::AtLeast, WIDTHS[0]),
        check(width, "", width_share, Bound::AtMost, WIDTHS[1]),
    ];
    if !checks.iter().all(Check::holds) {
        return None;
    }
    let begins = limits.stripes(clusters, [top, body], &across[0]);
    let what = "share of the top's width at which the side begins below it";
    checks.push(check(what, "", begins, Bound::AtLeast, STRIPE_SHARE));
    checks.iter().all(Check::holds).then_some(checks)
}

/// How far pixels reach along a direction (m).
struct Extent {
    from_m: f64,
    to_m: f64,
}

impl Extent {
    fn of(scene: &Scene<'_>, along: DVec3, pixels: &[u32]) -> Self {
        let points = pixels.iter().map(|&i| scene.point_at(i as usize));
        let [from_m, to_m] = reach_m(points, along, QUANTILES);
        Self { from_m, to_m }
    }

    fn width_m(&self) -> f64 {
        self.to_m - self.from_m
    }
}

/// Where the side of a top face may begin.
struct Limits {
    /// Height of the top along `up` (m).
    level_m: f64,
    up: DVec3,
    /// Across the line of sight, level.
    aside: DVec3,
}

impl Limits {
    /// The share of the stripes of the top in which the body begins as a side below its edge.
    fn stripes(&self, clusters: &Clusters<'_>, [top, body]: [SegmentId; 2], across: &Extent) -> f64 {
        let scene = clusters.scene;
        let (width, height) = scene.disparity.size();
        let mut begins = [false; STRIPES];
        for i in clusters.get(top).pixels.iter().map(|&i| i as usize) {
            let below =
                |&(j, _): &(usize, _)| clusters.at_pixel(j) == Some(body) && self.is_below(scene, i, j);
            if four_neighbours(i, width, height).any(|beside| below(&beside)) {
                let place = (self.aside.dot(scene.point_at(i)) - across.from_m) / across.width_m();
                let stripe = (place * STRIPES as f64).clamp(0.0, STRIPES as f64 - 1.0);
                begins[stripe as usize] = true;
            }
        }
        begins.iter().filter(|&&begins| begins).count() as f64 / STRIPES as f64
    }

    /// Whether a pixel of the body shows a side that begins at a pixel of the top's edge, set back a little.
    /// If it is not set back, the fold has voted already.
    fn is_below(&self, scene: &Scene<'_>, edge: usize, side: usize) -> bool {
        let [edge, at] = [edge, side].map(|i| scene.point_at(i));
        let noise_m = scene.space.step_m(NOISE_QUANTA, at.z);
        let is_rim = (self.level_m - self.up.dot(edge)).abs() < RIM_M.max(noise_m);
        is_rim && (noise_m..SET_BACK_M).contains(&(at.z - edge.z)) && !scene.is_level(self.up, side)
    }
}
