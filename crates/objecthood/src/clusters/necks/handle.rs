//! Whether a part is a handle: slim, and joined to the body with all of its end (docs/CONTEXT.md 4.7).

use glam::DVec3;

use crate::clusters::cluster::Clusters;
use crate::quantile::reach_m;
use crate::regions::SegmentId;

/// Lengths and widths reach from the first to the second of these quantiles: outlines are noisy.
const QUANTILES: [f64; 2] = [0.05, 0.95];
/// The end of a part is what lies this near (m) to its joint.
const END_M: f64 = 0.03;
/// A width of fewer quanta than this is noise: of what stands upright only the front is seen.
const WIDTH_QUANTA: f64 = 2.0;

/// How a part is joined to a body, in the plan view.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Joint {
    /// The share of their common border, in [0, 1], at which they touch: what is merely pushed against another leaves gaps.
    pub(super) closed_share: f64,
    /// The width of the joint, over that of the end of the part.
    pub(super) width_share: f64,
    /// How far the part goes away from the joint, over the width of its end.
    pub(super) slimness: f64,
}

/// Measures the joint of a part with a body; `contacts`: the pixels of the part that touch it. `None` when there are none, or the part is seen
/// from its narrow side only. O(sampled pixels · log(sampled pixels)).
pub(super) fn joint(
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
        let [low_m, high_m] = reach_m(points.copied(), direction, QUANTILES);
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
