//! Rule 4: upright walls around a patch of background are an open box, and the patch is its bottom (docs/CONTEXT.md 4.4.4).
//!
//! Where the camera looks down over a wall into a box, it would see the top of anything solid that is as high. So walls show no tops.

use glam::DVec3;

use super::limits::{Limits, RIM_HEIGHT};
use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Miss, Proposal, Rule, Source};
use crate::clusters::patches::{Patch, Shared, find_patches};
use crate::clusters::scene::sampled;
use crate::discovery::join::{Join, JoinEvidence};
use crate::regions::SegmentId;

/// Least number of pixels of the bottom (px at a focal length of 525 px).
const BOTTOM_PX: usize = 100;
/// A wall bounds at least this share of the bottom.
const WALL_SHARE: f64 = 0.05;
/// The walls bound at least this share of the bottom; the rest is shadow, and what lies in the box.
const ENCLOSED_SHARE: f64 = 0.6;
/// The bottom touches its walls along at least this share of its border, and goes on behind them along at least this share: the camera sees
/// the far walls from within, and the near ones from outside.
const SEEN_SHARE: f64 = 0.15;
/// Less than this share of a wall faces up.
const UP_SHARE: f64 = 0.25;
/// What faces up has at least this cosine with up: 45 degrees.
const UP_COSINE: f64 = 0.7;

/// Joins the walls of the first open box that it finds, and its bottom, and returns whether it found one.
pub(super) fn join_box(clusters: &mut Clusters<'_>, limits: Limits<'_>, misses: &mut Vec<Miss>) -> bool {
    let scene = clusters.scene;
    let least_px = scene.space.area_px(BOTTOM_PX);
    for patch in find_patches(clusters) {
        let is_wall = |shared: &Shared| patch.share_of_border(shared.touch + shared.hidden) >= WALL_SHARE;
        let walls: Vec<SegmentId> =
            patch.shared.iter().filter(|(_, shared)| is_wall(shared)).map(|(&id, _)| id).collect();
        if patch.size_px() < least_px || walls.len() < 2 {
            continue;
        }
        // On ties the wall with the smallest number wins.
        let Some(&largest) = walls.iter().rev().max_by_key(|wall| clusters.get(**wall).pixels.len()) else {
            continue;
        };
        let mut join = Proposal::new(Rule::OpenBox, Source::Patch(patch.first()), Some(largest));
        if !join.check(check_enclosed(&patch, &walls)) {
            continue;
        }
        let is_box = check_seen(&patch).into_iter().all(|check| join.check(check))
            && join.check(check_level(clusters, limits, &walls))
            && join.check(check_upright(clusters, limits, &walls));
        if is_box {
            join_all(clusters, &patch, &walls, largest, &join);
            return true;
        }
        misses.push(join.refuse());
    }
    false
}

/// Gives the other walls and the patch to one of the walls, on the evidence of the proposal.
fn join_all(
    clusters: &mut Clusters<'_>,
    patch: &Patch,
    walls: &[SegmentId],
    into: SegmentId,
    found: &Proposal,
) {
    let evidence = JoinEvidence::OpenBox { enclosed_share: enclosed_share(patch, walls) };
    for &wall in walls.iter().filter(|&&wall| wall != into) {
        clusters.join(found.clone().of(Source::Cluster(wall)), evidence);
    }
    let parts = [clusters.part(into), patch.part(clusters.scene.disparity.width())];
    clusters.give(found.clone().accept(Some((Join { parts, evidence, behind: None }, None))));
    let pixels: Vec<u32> = patch.runs.iter().cloned().flatten().map(|i| i as u32).collect();
    clusters.extend(into, &pixels);
}

fn enclosed_share(patch: &Patch, walls: &[SegmentId]) -> f64 {
    let sides =
        walls.iter().filter_map(|wall| patch.shared.get(wall)).map(|shared| shared.touch + shared.hidden);
    patch.share_of_border(sides.sum())
}

fn check_enclosed(patch: &Patch, walls: &[SegmentId]) -> Check {
    let share = enclosed_share(patch, walls);
    Check::new("share of its border with the walls", "", share, Bound::AtLeast, ENCLOSED_SHARE)
}

fn check_seen(patch: &Patch) -> [Check; 2] {
    let share = |sides: fn(&Shared) -> u32| patch.share_of_border(patch.shared.values().map(sides).sum());
    let at_least = |what, share| Check::new(what, "", share, Bound::AtLeast, SEEN_SHARE);
    [
        at_least("share of its border without a step", share(|shared| shared.touch)),
        at_least("share of its border behind walls", share(|shared| shared.hidden)),
    ]
}

fn check_level(clusters: &Clusters<'_>, limits: Limits<'_>, walls: &[SegmentId]) -> Check {
    let tops_m = || walls.iter().map(|&wall| limits.top_m(clusters, wall));
    let apart_m = tops_m().fold(f64::NEG_INFINITY, f64::max) - tops_m().fold(f64::INFINITY, f64::min);
    let limit_m = limits.params.rim_height_m;
    Check::new("difference of the tops", "m", apart_m, Bound::AtMost, limit_m).set_by(RIM_HEIGHT)
}

fn check_upright(clusters: &Clusters<'_>, limits: Limits<'_>, walls: &[SegmentId]) -> Check {
    let up_share = |&wall: &SegmentId| {
        let (up, all) = sampled(&clusters.get(wall).pixels).fold((0, 0), |(up, all), i| {
            let cosine = DVec3::from(clusters.scene.normals[i].map(f64::from)).dot(limits.support.normal);
            (up + u32::from(cosine > UP_COSINE), all + 1)
        });
        f64::from(up) / f64::from(all.max(1))
    };
    let most = walls.iter().map(up_share).fold(0.0, f64::max);
    Check::new("share of a wall that faces up", "", most, Bound::Below, UP_SHARE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::testing::{Table, single};
    use crate::params;

    /// How many clusters are left of a box 12 cm deep in the image, seen from above: its bottom is table, walls slope up to 6 cm around it. The
    /// thing before it is as high as `near_m` says by its row.
    fn left(near_m: impl Fn(usize) -> f64) -> Vec<usize> {
        let table = Table::new((60, 60), |u, v| {
            let is_box = (10..50).contains(&u) && (10..52).contains(&v);
            let out = [22_usize.saturating_sub(u), u.saturating_sub(37), 22_usize.saturating_sub(v)];
            let out = out.into_iter().max().unwrap_or(0);
            match v {
                _ if !is_box || v < 40 && out == 0 => Some((0, 0.0)),
                40.. => Some((2, near_m(v))),
                _ => Some((1, 0.06 * out as f64 / 12.0)),
            }
        });
        let scene = table.scene();
        let mut clusters = single(&scene);
        let params = params::Vessels::default();
        let limits = Limits { support: scene.ground().unwrap(), params: &params };
        let mut misses = Vec::new();
        let found = join_box(&mut clusters, limits, &mut misses);
        assert_eq!((found, misses.len()), (clusters.alive().len() == 1, usize::from(!found)), "{misses:?}");
        clusters.alive().into_iter().map(|id| clusters.get(id).pixels.len()).collect()
    }

    #[test]
    fn walls_around_a_patch_of_table_are_a_box_with_its_bottom() {
        assert_eq!(left(|v| 0.06 * (52 - v) as f64 / 12.0), [40 * 42]);
    }

    #[test]
    fn what_shows_its_top_or_is_lower_is_no_wall() {
        assert_eq!(left(|_| 0.06).len(), 2, "a solid thing before an inside");
        assert_eq!(left(|v| 0.03 * (52 - v) as f64 / 12.0).len(), 2, "something lower");
    }
}
