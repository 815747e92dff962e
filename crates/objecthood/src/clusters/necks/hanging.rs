//! Whether a part is seen to hang in the air: its support is seen below it (docs/CONTEXT.md 4.7).

use glam::DVec3;

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::necks::limits::{FOOT_M, HIDDEN_M, SMALLER_SHARE};
use crate::clusters::necks::part::Part;
use crate::clusters::scene::sampled;
use crate::regions::SegmentId;

/// A part hangs when at least the first of these shares of its pixels hangs, and less than the second stands. What it hangs on stands with at
/// least the second.
const HANGING_SHARE: f64 = 0.5;
const STANDING_SHARE: f64 = 0.3;
/// The foot of a hanging part is at least this share as high as its top: what leans stands on an end.
const FOOT_OF_TOP: f64 = 0.35;
/// The top of a part is this quantile of its heights.
const TOP_SHARE: f64 = 0.98;
/// A part is followed down in steps of this (m), for at most so many.
const STEP_M: f64 = 0.002;
const MOST_STEPS: usize = 150;
/// What ends higher than this above its support (m), and than so many quanta, hangs there.
const UNDERSIDE_M: f64 = 0.006;
const UNDERSIDE_QUANTA: f64 = 2.5;

/// The checks by which the smaller part hangs on the larger; `None` when one fails. O(sampled pixels · (steps + sampled pixels)).
pub(super) fn checks(clusters: &Clusters<'_>, [part, carrier]: [&Part<'_>; 2]) -> Option<Vec<Check>> {
    let share = |name, value, bound, limit| Check::new(name, "", value, bound, limit);
    let size_share = part.pixels().len() as f64 / carrier.pixels().len() as f64;
    let smaller = "pixels of the hanging part, over those of the other";
    let smaller = share(smaller, size_share, Bound::AtMost, SMALLER_SHARE);
    let bends = clusters.convexity(carrier.id);
    let bends = share("how far the other bends outwards", bends, Bound::Above, 0.0);
    let foot_m = part.foot_m();
    let foot = Check::new("foot of the hanging part above its support", "m", foot_m, Bound::Above, FOOT_M);
    // Most pairs fail these, which cost little.
    if ![smaller, bends, foot].iter().all(Check::holds) {
        return None;
    }
    let (top_m, own) = (clusters.scene.own_height_m(part.pixels(), TOP_SHARE), part.underside());
    let (hangs, stands) =
        ("share of the part that hangs: its support is seen below it", "share of the part that stands");
    let mut checks = vec![
        foot,
        share("height of that foot, over that of its top", foot_m / top_m, Bound::AtLeast, FOOT_OF_TOP),
        share(hangs, own.hanging, Bound::AtLeast, HANGING_SHARE),
        share(stands, own.standing, Bound::Below, STANDING_SHARE),
    ];
    if !checks.iter().all(Check::holds) {
        return None;
    }
    let other_stands = carrier.underside().standing;
    let distance_m = distance_m(clusters, [part.pixels(), carrier.pixels()]);
    checks.extend([
        share("share of the other that stands", other_stands, Bound::AtLeast, STANDING_SHARE),
        Check::new("distance of the parts", "m", distance_m, Bound::AtMost, HIDDEN_M),
        smaller,
        bends,
    ]);
    checks.iter().all(Check::holds).then_some(checks)
}

/// Shares of the pixels of a part by what is seen below it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Underside {
    /// The support, below where the part ends.
    hanging: f64,
    /// The support, where the part meets it.
    standing: f64,
}

impl Underside {
    /// Follows pixels of a part down along gravity, across holes, to the first that is not its own. The line below a thing that stands leaves its
    /// outline where it meets the support, or lower. O(sampled pixels · steps).
    pub(super) fn of(clusters: &Clusters<'_>, part: SegmentId) -> Self {
        let scene = clusters.scene;
        let pixels = &clusters.get(part).pixels;
        let Some(support) = scene.own_support(pixels) else { return Self::default() };
        let (up, camera, size) =
            (scene.surfaces[support].normal, scene.space.camera(), scene.disparity.size());
        let ends = |from: DVec3| {
            for step in 1..=MOST_STEPS {
                let at = camera.pixel_at(from - step as f64 * STEP_M * up, size)?;
                let facet = scene.facets.segments.at(at).filter(|_| clusters.at_pixel(at) != Some(part));
                if let Some(facet) = facet {
                    return (facet.index() == support).then_some((step, at));
                }
            }
            None
        };
        let (mut hanging, mut standing, mut all) = (0, 0, 0);
        for i in sampled(pixels) {
            all += 1;
            let from = scene.point_at(i);
            let Some((step, seen)) = ends(from) else { continue };
            let least_m = UNDERSIDE_M.max(scene.space.step_m(UNDERSIDE_QUANTA, from.z));
            // What lies flat on the support may count as part of it.
            if scene.height_over_m(seen, support) > least_m {
                continue;
            }
            if scene.height_over_m(i, support) - step as f64 * STEP_M > least_m {
                hanging += 1;
            } else {
                standing += 1;
            }
        }
        let share = |count: usize| count as f64 / all.max(1) as f64;
        Self { hanging: share(hanging), standing: share(standing) }
    }
}

/// The least distance (m) between sampled points of two parts. O(sampled pixels²).
fn distance_m(clusters: &Clusters<'_>, parts: [&[u32]; 2]) -> f64 {
    let [a, b] = parts.map(|pixels| clusters.scene.sampled_points(pixels).collect::<Vec<_>>());
    let distances = a.iter().flat_map(|one| b.iter().map(move |other| one.distance_squared(*other)));
    distances.fold(f64::INFINITY, f64::min).sqrt()
}
