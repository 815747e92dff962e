//! How a part slopes where another may stand on it (docs/CONTEXT.md 4.7.2 and 4.7.7).

use glam::DVec3;

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::convexity::measure_convexity;
use crate::clusters::scene::{LEVEL_DEG, Scene};
use crate::clusters::vessels::walls::FLAT;

/// A pixel steeper than this is a side (degrees): it says nothing of what stands above it.
const STEEP_DEG: f64 = 65.0;
/// The lower part carries the upper one if a larger share of pixels around the contact is level.
const LEVEL_SHARE: f64 = 0.3;

/// The share of these pixels that is neither level nor steep: a thing slides off them. 0 without pixels. O(n).
pub(super) fn sliding_share(scene: &Scene<'_>, up: DVec3, pixels: &[u32]) -> f64 {
    let [level_cosine, steep_cosine] = [LEVEL_DEG, STEEP_DEG].map(|degrees| libm::cos(degrees.to_radians()));
    let slides = |&&i: &&u32| {
        let cosine = up.dot(DVec3::from(scene.normals[i as usize].map(f64::from)));
        cosine > steep_cosine && cosine <= level_cosine
    };
    share(pixels.iter().filter(slides).count(), pixels)
}

/// Checks that the lower part has no level face around its contact with the upper one, on which a thing could
/// stand. `around`: its pixels there. `may_be_round`: if too many are level, it is enough that these bend
/// outwards, because a thing would roll off them. Returns the check of roundness only if it holds in place of
/// the share. O(n).
pub(super) fn check_level(clusters: &Clusters<'_>, up: DVec3, around: &[u32], may_be_round: bool) -> Check {
    let is_level = |&i: &u32| clusters.scene.is_level(up, i as usize);
    let level: Vec<u32> = around.iter().copied().filter(is_level).collect();
    let what = "share of the lower part around it that is level";
    let check = Check::new(what, "", share(level.len(), around), Bound::Below, LEVEL_SHARE);
    if check.holds() || !may_be_round {
        return check;
    }
    let bends = measure_convexity(clusters.scene, &level);
    let round = Check::new("how far the level part around it bends outwards", "", bends, Bound::Above, FLAT);
    if round.holds() { round } else { check }
}

fn share(count: usize, pixels: &[u32]) -> f64 {
    count as f64 / pixels.len().max(1) as f64
}
