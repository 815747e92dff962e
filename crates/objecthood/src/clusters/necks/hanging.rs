//! Whether a part is seen to hang in the air: its support is seen below it (docs/CONTEXT.md 4.7.1).

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::necks::limits::{FOOT_M, HIDDEN_M, SMALLER_SHARE};
use crate::clusters::necks::part::Part;

/// A part hangs if at least the first of these shares of its pixels hangs, and less than the second stands.
/// At least the second share of the part that holds it stands.
const HANGING_SHARE: f64 = 0.5;
const STANDING_SHARE: f64 = 0.3;
/// The foot of a hanging part is at least this share as high as its top: a leaning part stands on one end.
const FOOT_OF_TOP: f64 = 0.35;
/// The top of a part is this quantile of its heights.
const TOP_SHARE: f64 = 0.98;

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
    let top_m = || clusters.scene.own_height_m(part.pixels(), TOP_SHARE);
    let ends =
        || share("height of that foot, over that of its top", foot_m / top_m(), Bound::AtLeast, FOOT_OF_TOP);
    // Most pairs fail these, which cost little.
    let is_open = [smaller, bends, foot].iter().all(Check::holds);
    let ends = is_open.then(ends).filter(Check::holds)?;
    let own = part.underside();
    let (hangs, stands) =
        ("share of the part that hangs: its support is seen below it", "share of the part that stands");
    let mut checks = vec![
        foot,
        ends,
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

/// The least distance (m) between sampled points of two parts. O(sampled pixels²).
fn distance_m(clusters: &Clusters<'_>, parts: [&[u32]; 2]) -> f64 {
    let [a, b] = parts.map(|pixels| clusters.scene.sampled_points(pixels).collect::<Vec<_>>());
    let distances = a.iter().flat_map(|one| b.iter().map(move |other| one.distance_squared(*other)));
    distances.fold(f64::INFINITY, f64::min).sqrt()
}
