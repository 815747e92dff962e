//! Whether the upper part stands on the lower one, or would slide off it (docs/CONTEXT.md 4.7.7).

use std::ops::Range;

use glam::DVec3;

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::necks::limits::{AROUND_M, FOOT_M, SMALLER_SHARE};
use crate::clusters::necks::slopes::{check_level, sliding_share};
use crate::clusters::vessels::piece::check_on;
use crate::clusters::vessels::walls::FLAT;
use crate::regions::SegmentId;
use crate::surface::disparity::position;

/// A separate thing would slide off the lower part if at least this share of pixels is neither level nor
/// steep.
const SLIDING_SHARE: f64 = 0.33;
/// At most this many contacts are examined, evenly spread, because their surroundings overlap.
const CONTACTS: usize = 16;

/// The checks by which the upper part, whose foot is at `foot_m`, does not stand by itself and is one body
/// with the lower: by their colours (`alike`), or because a separate thing would slide off. `carrying`: the
/// pixels of the lower one that touch the upper. O(pixels of the lower).
pub(super) fn checks(
    clusters: &Clusters<'_>,
    up: DVec3,
    [upper, lower]: [SegmentId; 2],
    carrying: &[usize],
    foot_m: f64,
    alike: Check,
) -> Vec<Check> {
    let around = around(clusters, lower, carrying);
    let slides = slides(clusters, [upper, lower], sliding_share(clusters.scene, up, &around));
    let mut checks = vec![
        Check::new("foot of the upper part above its support", "m", foot_m, Bound::Above, FOOT_M),
        check_level(clusters, up, &around, alike.holds()),
    ];
    checks.extend(check_hollow(clusters, [upper, lower]));
    if alike.holds() || !slides.iter().all(Check::holds) {
        checks.insert(0, alike);
    } else {
        checks.extend(slides);
    }
    checks
}

/// Checks that one of two hollow parts continues the other; otherwise it is a bowl that stands in the other.
/// `None` if one of them is not hollow, or if their places cannot be compared.
fn check_hollow(clusters: &Clusters<'_>, mut parts: [SegmentId; 2]) -> Option<Check> {
    parts.sort_by_key(|&id| clusters.get(id).pixels.len());
    let [smaller, larger] = parts;
    let are_hollow = [smaller, larger].into_iter().all(|id| clusters.convexity(id) < -FLAT);
    let support = clusters.scene.ground().filter(|_| are_hollow)?;
    check_on(clusters, support, larger, smaller)
}

/// The checks by which the upper part would slide off the lower: the share of the lower one that slopes
/// around their contact, their sizes, and that the lower one is not hollow.
fn slides(clusters: &Clusters<'_>, [upper, lower]: [SegmentId; 2], sliding_share: f64) -> [Check; 3] {
    let convexity = clusters.convexity(lower);
    let [upper_px, lower_px] = [upper, lower].map(|id| clusters.get(id).pixels.len() as f64);
    [
        Check::new(
            "share of the lower part around it from which it would slide off",
            "",
            sliding_share,
            Bound::AtLeast,
            SLIDING_SHARE,
        ),
        Check::new(
            "pixels of the upper part, over those of the lower",
            "",
            upper_px / lower_px,
            Bound::AtMost,
            SMALLER_SHARE,
        ),
        Check::new("how far the lower part bends outwards", "", convexity, Bound::AtLeast, -FLAT),
    ]
}

/// The pixels of the lower part around its contacts with the upper one.
fn around(clusters: &Clusters<'_>, lower: SegmentId, contacts: &[usize]) -> Vec<u32> {
    let scene = clusters.scene;
    let width = scene.disparity.width();
    let pixels = &clusters.get(lower).pixels;
    let step = contacts.len().div_ceil(CONTACTS).max(1);
    let focal_px = scene.space.camera().fx_px.max(scene.space.camera().fy_px);
    let surroundings = |&i: &usize| {
        let (point, at) = (scene.point_at(i), position(i, width));
        let reach_px = AROUND_M * focal_px / point.z;
        (point, at.map(|at| at - reach_px..at + reach_px))
    };
    let around: Vec<(DVec3, [Range<f64>; 2])> = contacts.iter().step_by(step).map(surroundings).collect();
    let is_near = |&i: &usize| {
        let at = position(i, width);
        let mut near = around.iter().filter(|(_, places)| (0..2).all(|k| places[k].contains(&at[k])));
        near.any(|(point, _)| scene.point_at(i).distance(*point) < AROUND_M)
    };
    pixels.iter().copied().filter(|&i| is_near(&(i as usize))).collect()
}
