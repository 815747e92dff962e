//! Vessels: joins the inside and the wall of a cup or bowl into one cluster (docs/CONTEXT.md 4.4).
//!
//! A camera sees the far part of a vessel's inside and the near part of its wall. Between them is a step in
//! depth at the rim, so no convex border joins the two. Six rules join them. They have the numbers of their
//! sections, 4.4.1 to 4.4.6, and run in this order:
//!
//! 1. [`insides`]: concave pieces that touch are one inside. [`flat_bottoms`]: what it surrounds without a step is
//!    its bottom.
//! 2. [`walls`]: an inside and the wall in front of it, equally high, are one vessel.
//! 3. [`remainders`]: a small cluster that touches hardly anything but a vessel belongs to it.
//! 4. [`turned`]: pieces of one surface of revolution, which things in the vessel separate, are one vessel.
//! 5. [`panels`]: thin upright panels of equal height that meet or face each other are the walls of a box.
//! 6. [`boxes`]: upright walls of equal height around a patch of the support are an open box.

mod boxes;
mod flat_bottoms;
mod insides;
mod limits;
mod panels;
pub(super) mod piece;
mod remainders;
mod revolution;
mod turned;
pub(super) mod walls;

use std::collections::BTreeSet;

use self::boxes::join_box;
use self::flat_bottoms::join_flat_bottom;
use self::insides::join_insides;
use self::limits::Limits;
use self::panels::join_panels;
use self::remainders::join_remainder;
use self::turned::join_turned;
use self::walls::join_wall;
use crate::clusters::cluster::Clusters;
use crate::clusters::history::Miss;
use crate::params;

/// Most joins of pieces of insides in one frame.
const INSIDE_MERGES: usize = 6;
/// Most joins of flat bottoms, and of each of the rules 2, 3, 4 and 6, in one frame.
const MERGES: usize = 12;

/// Joins the parts of vessels. Does nothing without a support surface or with `concavity` 0.
/// O(merges · clusters · neighbours + the pixels of all insides and walls tried, up to 12 times each + pairs of round clusters).
pub(crate) fn join_vessels(clusters: &mut Clusters<'_>, params: &params::Vessels) {
    let Some(support) = clusters.scene.ground().filter(|_| params.concavity > 0.0) else { return };
    let limits = Limits { support, params };
    let mut vessels = BTreeSet::new();
    repeat(clusters, INSIDE_MERGES, |clusters, misses| join_insides(clusters, limits, misses));
    repeat(clusters, MERGES, |clusters, misses| join_flat_bottom(clusters, limits, misses));
    repeat(clusters, MERGES, |clusters, misses| join_wall(clusters, limits, &mut vessels, misses));
    repeat(clusters, MERGES, |clusters, misses| join_remainder(clusters, limits, &vessels, misses));
    join_turned(clusters, limits, MERGES);
    join_panels(clusters, limits);
    repeat(clusters, MERGES, |clusters, misses| join_box(clusters, limits, misses));
}

/// Applies a rule until it joins nothing more, at most `times` times. Records its refusals of the last round.
fn repeat<'a>(
    clusters: &mut Clusters<'a>,
    times: usize,
    mut rule: impl FnMut(&mut Clusters<'a>, &mut Vec<Miss>) -> bool,
) {
    let mut misses = Vec::new();
    for _ in 0..times {
        misses.clear();
        if !rule(clusters, &mut misses) {
            break;
        }
    }
    clusters.history.note_misses(misses);
}
