//! Whether a part is a handle: slim, and joined to the body along its whole end (docs/CONTEXT.md 4.7.6).

use glam::DVec3;

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::necks::contact::contacts;
use crate::clusters::necks::limits::{FOOT_M, SIDES, WIDTH_QUANTA};
use crate::quantile::reach_m;
use crate::regions::SegmentId;

/// A part stands on the lower one if it touches it within this (m) of the height of its own foot.
const STANDS_M: f64 = 0.005;
/// A handle touches its body along at least this share of their border (a thing that is merely pushed against
/// another leaves gaps),
const CLOSED_SHARE: f64 = 0.7;
/// with its whole end (the width of the joint over that of the end),
const END_WIDTHS: [f64; 2] = [0.7, 1.5];
/// and is at least this many times as long as wide. Handles of synthetic tools and hammers measure 3 to 9.
const SLIMNESS: f64 = 2.5;
/// The end of a part is what lies this near (m) to its joint.
const END_M: f64 = 0.03;

/// The checks by which one of two parts is a handle of the other. `None` if one fails, or if the upper one,
/// whose foot is at `foot_m`, stands on the lower. `carrying`: the pixels of the lower one that touch the
/// upper. O(pixels of both).
pub(super) fn checks(
    clusters: &Clusters<'_>,
    up: DVec3,
    [upper, lower]: [SegmentId; 2],
    carrying: &[usize],
    foot_m: f64,
) -> Option<Vec<Check>> {
    let pixels: Vec<u32> = carrying.iter().map(|&i| i as u32).collect();
    if foot_m > FOOT_M && (clusters.scene.own_height_m(&pixels, 0.5) - foot_m).abs() < STANDS_M {
        return None;
    }
    let ways = [([upper, lower], &*contacts(clusters, [upper, lower])), ([lower, upper], carrying)];
    ways.into_iter().find_map(|([part, body], contacts)| {
        let Joint { closed_share, width_share, slimness } = joint(clusters, up, [part, body], contacts)?;
        let check = |name, value, bound, limit| Check::new(name, "", value, bound, limit);
        let width = "width of the joint, over that of the end of the slim part";
        let checks = vec![
            check("share of their border at which they touch", closed_share, Bound::AtLeast, CLOSED_SHARE),
            check(width, width_share, Bound::AtLeast, END_WIDTHS[0]),
            check(width, width_share, Bound::AtMost, END_WIDTHS[1]),
            check("length of the slim part, over its width", slimness, Bound::AtLeast, SLIMNESS),
        ];
        checks.iter().all(Check::holds).then_some(checks)
    })
}

/// How a part is joined to a body, in the plan view.
#[derive(Clone, Copy, Debug, Default)]
struct Joint {
    /// The share of their common border, in [0, 1], at which they touch: what is merely pushed against another leaves gaps.
    closed_share: f64,
    /// The width of the joint, over that of the end of the part.
    width_share: f64,
    /// How far the part extends away from the joint, over the width of its end.
    slimness: f64,
}

/// Measures the joint of a part with a body. `contacts`: the pixels of the part that touch the body. `None`
/// without contacts, or if only the narrow side of the part is seen. O(sampled pixels · log(sampled pixels)).
fn joint(
    clusters: &Clusters<'_>,
    up: DVec3,
    [part, body]: [SegmentId; 2],
    contacts: &[usize],
) -> Option<Joint> {
    let scene = clusters.scene;
    let level = |point: DVec3| point - up * up.dot(point);
    let points: Vec<DVec3> = contacts.iter().map(|&i| scene.point_at(i)).collect();
    let touching: Vec<DVec3> = points.iter().map(|&point| level(point)).collect();
    let own: Vec<DVec3> = scene.sampled_points(&clusters.get(part).pixels).map(level).collect();
    let mean = |points: &[DVec3]| points.iter().sum::<DVec3>() / points.len() as f64;
    let from = mean(&touching);
    // Without contacts this is no direction.
    let away = (mean(&own) - from).try_normalize()?;
    let aside = up.cross(away);
    let extent_m = |points: &mut dyn Iterator<Item = &DVec3>, direction| {
        let [low_m, high_m] = reach_m(points.copied(), direction, SIDES);
        high_m - low_m
    };
    let is_end = |point: &&DVec3| away.dot(**point - from).abs() < END_M;
    let length_m = extent_m(&mut own.iter(), away);
    let width_m = extent_m(&mut own.iter().filter(is_end), aside);
    let joint_m = extent_m(&mut touching.iter(), aside);
    let borders = clusters.get(part).neighbours.get(&Some(body))?;
    let all = borders.touch + borders.level + borders.in_front + borders.behind;
    let noise_m = scene.space.step_m(WIDTH_QUANTA, mean(&points).z);
    (width_m > noise_m).then(|| Joint {
        closed_share: f64::from(borders.touch) / f64::from(all),
        width_share: joint_m / width_m,
        slimness: length_m / width_m,
    })
}
