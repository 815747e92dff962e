//! Rule 5: thin upright panels that are equally high, and meet at corners or face each other, are the walls of a box
//! (docs/CONTEXT.md 4.4.5).
//!
//! Rule 4 looks for what surrounds a bottom. This rule needs no bottom: contents may hide it, and it may lie above the support. A solid thing is no
//! panel, because behind the rim of a panel the camera sees down past it.

mod interior;
mod meeting;
mod panel;

use self::interior::Interior;
use self::meeting::Meeting;
use self::panel::{Panel, find_panels};
use super::limits::{Limits, RIM_HEIGHT};
use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Proposal, Rule, Source};
use crate::regions::SegmentId;
use crate::union_find::UnionFind;

/// Two panels, and the checks by which they are walls of one box.
struct Pair {
    panels: [usize; 2],
    /// The clusters that they belong to.
    clusters: [SegmentId; 2],
    /// Whether their meeting shows the inside of a box.
    is_inside: bool,
    checks: Vec<Check>,
}

impl Pair {
    fn propose(self, [into, from]: [SegmentId; 2]) -> Proposal {
        let mut proposal = Proposal::new(Rule::BoxWalls, Source::Cluster(from), Some(into));
        proposal.extend(self.checks);
        proposal
    }
}

/// Joins the walls of every box, and what else belongs to it. O(pixels of upright facets + panels² + boxes · clusters).
pub(super) fn join_panels(clusters: &mut Clusters<'_>, limits: Limits<'_>) {
    let panels = find_panels(clusters, limits.support);
    let (pairs, misses): (Vec<Pair>, Vec<Pair>) =
        compare(clusters, limits, &panels).into_iter().partition(|pair| pair.checks.iter().all(Check::holds));
    let mut boxes = UnionFind::new(panels.len());
    let mut is_box = vec![false; panels.len()];
    for pair in &pairs {
        let [a, b] = pair.panels.map(|panel| boxes.find(panel));
        boxes.link(a.min(b), a.max(b));
        is_box[a.min(b)] = is_box[a] || is_box[b] || pair.is_inside;
    }
    let count = clusters.alive().last().map_or(0, |last| last.index() + 1);
    let mut joined = UnionFind::new(count);
    for pair in pairs.into_iter().filter(|pair| is_box[boxes.find(pair.panels[0])]) {
        let [a, b] = pair.clusters.map(|id| joined.find(id.index()));
        if a != b {
            joined.link(a.min(b), a.max(b));
            let [into, from] = [a.min(b), a.max(b)].map(|root| SegmentId(root as u32));
            clusters.give(pair.propose([into, from]).accept(None));
        }
    }
    let misses = misses.into_iter().filter(|pair| pair.clusters[0] != pair.clusters[1]);
    clusters.history.note_misses(misses.map(|pair| {
        let clusters = pair.clusters;
        pair.propose(clusters).refuse()
    }));
    for root in (0..panels.len()).filter(|&panel| is_box[panel]) {
        if boxes.find(root) != root {
            continue;
        }
        let walls: Vec<&Panel> =
            (0..panels.len()).filter(|&k| boxes.find(k) == root).map(|k| &panels[k]).collect();
        if let Some(interior) = Interior::of(&walls) {
            let into = SegmentId(joined.find(walls[0].cluster.index()) as u32);
            // The walls of a box in a box may be a piece of the outer one by now.
            if !clusters.get(into).pixels.is_empty() {
                interior.join(clusters, limits.support, into);
            }
        }
    }
}

/// The pairs of panels whose places fit two walls of one box, with their checks.
fn compare(clusters: &Clusters<'_>, limits: Limits<'_>, panels: &[Panel]) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for (b, other) in panels.iter().enumerate() {
        for (a, one) in panels[..b].iter().enumerate() {
            let Some(Meeting { check, is_inside }) = Meeting::of(one, other) else { continue };
            let apart_m = (one.top_m - other.top_m).abs();
            let limit_m = limits.params.rim_height_m;
            let tops = Check::new("difference of the tops", "m", apart_m, Bound::AtMost, limit_m);
            let checks = vec![
                check,
                tops.set_by(RIM_HEIGHT),
                limits.check_color(clusters, other.cluster, &[one.cluster]),
            ];
            pairs.push(Pair {
                panels: [a, b],
                clusters: [one, other].map(|panel| panel.cluster),
                is_inside,
                checks,
            });
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::testing::{Table, single};
    use crate::params;

    /// The number of clusters that are left of a drawing (facet, height).
    fn left(at: impl Fn(usize, usize) -> (i32, f64)) -> usize {
        let table = Table::new((120, 100), |u, v| Some(at(u, v)));
        let scene = table.scene();
        let mut clusters = single(&scene);
        let params = params::Vessels::default();
        join_panels(&mut clusters, Limits { support: scene.ground().unwrap(), params: &params });
        clusters.alive().len()
    }

    /// A box without its near wall, seen from above: a left, a right and a far wall, facets 1 to 3, which slope up from the bottom, facet 4, by
    /// so many metres. The bottom lies 12 mm above the table, and the rims are as high for `thick_px`.
    fn seen_box(walls_m: [f64; 3], thick_px: usize) -> impl Fn(usize, usize) -> (i32, f64) {
        move |u, v| {
            let out = [46_usize.saturating_sub(u), u.saturating_sub(73), 46_usize.saturating_sub(v)];
            let wall = (0..3).max_by_key(|&wall| out[wall]).unwrap_or(0);
            match out[wall] {
                _ if v > 73 => (0, 0.0),
                0 => (4, 0.012),
                out if out > 12 + thick_px => (0, 0.0),
                out => (1 + wall as i32, 0.012 + walls_m[wall] * out.min(12) as f64 / 12.0),
            }
        }
    }

    #[test]
    fn walls_and_a_bottom_above_the_table_are_a_box() {
        assert_eq!(left(seen_box([0.06; 3], 0)), 1);
    }

    #[test]
    fn what_lies_in_a_box_stays_apart() {
        let empty = seen_box([0.06; 3], 0);
        let is_thing = |u: usize, v: usize| (56..64).contains(&u) && (56..64).contains(&v);
        assert_eq!(left(|u, v| if is_thing(u, v) { (5, 0.04) } else { empty(u, v) }), 2);
    }

    #[test]
    fn solid_things_around_a_pocket_are_no_walls() {
        let things = left(seen_box([0.06; 3], 20));
        assert_eq!(things, 4, "3.8 cm thick");
    }

    #[test]
    fn walls_of_a_box_are_equally_high() {
        assert_eq!(left(seen_box([0.06, 0.09, 0.12], 0)), 4);
    }
}
