//! Other pieces of a box whose walls were found: the level pieces of its bottom, and the rest of its walls.

use glam::DVec3;

use super::panel::Panel;
use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::colors::Colors;
use crate::clusters::history::{Proposal, Rule, Source};
use crate::clusters::scene::sampled;
use crate::clusters::vessels::limits::check_walls_color;
use crate::oversegment::structure::StructureSurface;
use crate::quantile::element_at;
use crate::regions::SegmentId;

/// At least this share of a piece of the bottom lies as low as the feet of the walls, ...
const LOW_SHARE: f64 = 0.75;
/// ... to within this (m).
const BOTTOM_M: f64 = 0.007;
/// At least this share of a piece lies in the box, or at its walls.
const WITHIN_SHARE: f64 = 0.9;
/// A piece may lie this far beyond the walls (m): the walls have this thickness, and their ends are noisy.
const MARGIN_M: f64 = 0.025;
/// The top of a piece of a wall lies at most this far below the rim (m).
const RIM_M: f64 = 0.02;
/// The top of a piece is this quantile of its heights.
const TOP_SHARE: f64 = 0.98;

/// The inside of a box in the plan view: a rectangle along its longest wall.
pub(super) struct Interior<'p> {
    walls: &'p [&'p Panel],
    axes: [DVec3; 2],
    /// Along each axis (m).
    ranges_m: [[f64; 2]; 2],
    foot_m: f64,
    top_m: f64,
    noise_m: f64,
}

impl<'p> Interior<'p> {
    /// The inside of these walls; `None` without any.
    pub(super) fn of(walls: &'p [&'p Panel]) -> Option<Self> {
        let longest = walls.iter().max_by(|a, b| a.length_m().total_cmp(&b.length_m()))?;
        let axes = [longest.along, longest.normal];
        let range_m = |axis: DVec3| {
            let places = walls.iter().flat_map(|wall| wall.ends()).map(|end| axis.dot(end));
            places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
        };
        // Contents of the box hide the feet of some walls, and noise lowers those of short pieces. So the
        // level is that below which a quarter of all wall has its foot.
        let mut feet: Vec<(f64, f64)> = walls.iter().map(|wall| (wall.foot_m, wall.length_m())).collect();
        feet.sort_by(|a, b| a.0.total_cmp(&b.0));
        let quarter_m = feet.iter().map(|foot| foot.1).sum::<f64>() / 4.0;
        let mut below_m = 0.0;
        let foot = feet.iter().find(|foot| {
            below_m += foot.1;
            below_m >= quarter_m
        });
        Some(Self {
            walls,
            axes,
            ranges_m: axes.map(range_m),
            foot_m: foot?.0,
            top_m: walls.iter().map(|wall| wall.top_m).fold(f64::NEG_INFINITY, f64::max),
            noise_m: longest.noise_m,
        })
    }

    /// How far (m) a point lies within the walls; below 0 outside.
    fn depth_m(&self, point: DVec3) -> f64 {
        let inside = |k: usize| {
            let at_m = self.axes[k].dot(point);
            (at_m - self.ranges_m[k][0]).min(self.ranges_m[k][1] - at_m)
        };
        inside(0).min(inside(1))
    }

    /// Gives the pieces of the bottom and the walls to the cluster of the walls. O(clusters · (sampled pixels + walls · bins of colours)).
    pub(super) fn join(&self, clusters: &mut Clusters<'_>, ground: &StructureSurface, walls: SegmentId) {
        for id in clusters.alive().into_iter().filter(|&id| id != walls) {
            if clusters.flat(id).is_some() {
                continue;
            }
            for checks in [self.check_bottom(clusters, ground, id), self.check_wall(clusters, ground, id)] {
                let mut join = Proposal::new(Rule::BoxWalls, Source::Cluster(id), Some(walls));
                if checks.into_iter().all(|check| join.check(check)) {
                    clusters.give(join.accept(None));
                    break;
                }
            }
        }
    }

    /// A piece of the bottom lies within the walls, as low as their feet.
    fn check_bottom(&self, clusters: &Clusters<'_>, ground: &StructureSurface, id: SegmentId) -> Vec<Check> {
        let (scene, pixels) = (clusters.scene, &clusters.get(id).pixels[..]);
        let limit_m = BOTTOM_M.max(self.noise_m / 2.0);
        let within = share(pixels, |i| self.depth_m(scene.point_at(i)) > -MARGIN_M);
        let low = share(pixels, |i| (scene.height_m(i, ground) - self.foot_m).abs() < limit_m);
        vec![
            Check::new("share of it within the walls", "", within, Bound::AtLeast, WITHIN_SHARE),
            Check::new("share of it as low as the feet of the walls", "", low, Bound::AtLeast, LOW_SHARE),
        ]
    }

    /// A piece of a wall lies at the walls, ends at the rim, and has the colours of one of the walls: small things in a tray lie at its walls
    /// too, and are as high.
    fn check_wall(&self, clusters: &Clusters<'_>, ground: &StructureSurface, id: SegmentId) -> Vec<Check> {
        let (scene, pixels) = (clusters.scene, &clusters.get(id).pixels[..]);
        let limit_m = MARGIN_M.max(self.noise_m);
        let own = Colors::of(scene, pixels);
        let colors = self.walls.iter().map(|wall| check_walls_color(scene, [&own, &wall.colors]));
        let alike = colors.max_by(|a, b| a.measured.total_cmp(&b.measured));
        let beside = share(pixels, |i| self.depth_m(scene.point_at(i)).abs() < limit_m);
        let mut heights_m: Vec<f64> = sampled(pixels).map(|i| scene.height_m(i, ground)).collect();
        let below_m = (self.top_m - element_at(&mut heights_m, TOP_SHARE)).abs();
        vec![
            Check::new("share of it at the walls", "", beside, Bound::AtLeast, WITHIN_SHARE),
            Check::new("distance of its top from the rim", "m", below_m, Bound::AtMost, RIM_M),
        ]
        .into_iter()
        .chain(alike)
        .collect()
    }
}

fn share(pixels: &[u32], holds: impl Fn(usize) -> bool) -> f64 {
    let (mut held, mut all) = (0_u32, 0_u32);
    for i in sampled(pixels) {
        held += u32::from(holds(i));
        all += 1;
    }
    f64::from(held) / f64::from(all.max(1))
}
