//! Joins the convex parts of one body across a neck or fold (docs/CONTEXT.md 4.7).

mod alike;
mod ball;
mod contact;
mod handle;
mod hanging;
mod limits;
mod part;
mod slopes;
mod standing;
mod symmetry;
#[cfg(test)]
mod tests;
mod top;
mod underside;
mod waist;

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use rayon::prelude::*;

use crate::check::Check;
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Event, Miss, Proposal, Rule, Source};
use crate::clusters::necks::alike::{check_alike, check_alike_in_light};
use crate::clusters::necks::contact::{beside, contacts, is_part, touch};
use crate::clusters::necks::part::Part;
use crate::params;
use crate::regions::SegmentId;
use crate::union_find::UnionFind;

/// Joins two clusters that are parts of one body. Seven rules, which have the numbers of their sections in
/// docs/CONTEXT.md, are tried for each pair in this order:
///
/// - 4.7.1 Hanging parts: a small part that is seen to hang in the air is joined to what holds it, whether or
///   not they touch.
/// - 4.7.2 Balls: a ball lies on a slope, but no level face, or on a neck of one other part alone, so a
///   separate ball would roll off. Colours do not matter.
/// - 4.7.3 Tops: a level part is the top of another part of its width, which begins as a side at its edge.
///   Colours do not matter.
/// - 4.7.4 Symmetry: the axis of a slim part is an axis of symmetry of the part at its end, as with a handle.
///   Colours do not matter.
/// - 4.7.5 Waists: a narrow part between two wider ones of its colours is joined to each of them where it
///   begins as a neck, whether or not they touch.
/// - 4.7.6 Handles: two parts share their colours, and one is slim and joined to the other along its whole
///   end.
/// - 4.7.7 Necks and folds: two clusters touch, and the upper one has no foot of its own: it stands neither
///   on a support nor on a level face of the lower one, as stacked things do. In addition, the two share
///   their colours, or the upper one is small and sits on a slope from which a separate thing would slide
///   off.
///
/// Pairs that share most colours are joined first. Parts that have grown are compared again, until no more
/// are joined.
///
/// Source: ours, because a neck or fold is a valley between convex parts (paper, future work: concavity).
/// O(rounds · pairs side by side · pixels of both); parallel over pairs. Does nothing without a support;
/// without colour the rules that compare colours join nothing.
pub(crate) fn join_necks(clusters: &mut Clusters<'_>, params: &params::Necks) {
    let Some(ground) = clusters.scene.ground().filter(|_| params.enabled) else { return };
    let mut changed = clusters.alive().into_iter().collect::<BTreeSet<SegmentId>>();
    while !changed.is_empty() {
        changed = join_once(clusters, ground.normal, params, &changed);
    }
}

/// Compares each pair of clusters of which at least one has grown, and joins those that are one body. Returns
/// the clusters that have grown.
fn join_once(
    clusters: &mut Clusters<'_>,
    up: DVec3,
    params: &params::Necks,
    changed: &BTreeSet<SegmentId>,
) -> BTreeSet<SegmentId> {
    let mut pairs = Vec::new();
    for id in clusters.alive().into_iter().filter(|&id| is_part(clusters, id)) {
        let others = beside(clusters, id).filter(|&other| other > id);
        let pair_with = |other| [id, other];
        pairs.extend(others.map(pair_with).filter(|pair| pair.iter().any(|id| changed.contains(id))));
    }
    let parts = clusters.alive().into_iter().map(|id| (id, Part::new(clusters, up, id))).collect();
    let compare = Compare { clusters, up, params, parts };
    let mut compared: Vec<Pair> = pairs.into_par_iter().filter_map(|pair| compare.pair(pair)).collect();
    compared.sort_by(|a, b| b.overlap.total_cmp(&a.overlap));
    let (joins, misses): (Vec<Pair>, Vec<Pair>) = compared.into_iter().partition(Pair::is_join);
    let count = clusters.alive().last().map_or(0, |last| last.index() + 1);
    let mut sets = UnionFind::new(count);
    let mut grown = BTreeSet::new();
    for pair in joins {
        let [a, b] = pair.parts.map(|part| sets.find(part.index()));
        if a != b {
            sets.link(a.min(b), a.max(b));
            clusters.give(pair.event([a.min(b), a.max(b)].map(|root| SegmentId(root as u32))));
            grown.insert(SegmentId(a.min(b) as u32));
        }
    }
    clusters.history.note_misses(misses.into_iter().map(Pair::miss));
    grown
}

/// Two clusters. The first is the upper one, the one that hangs, the ball, the slim part or the neck.
struct Pair {
    parts: [SegmentId; 2],
    overlap: f64,
    checks: Vec<Check>,
}

impl Pair {
    fn is_join(&self) -> bool {
        self.checks.iter().all(Check::holds)
    }

    fn propose(self, [into, from]: [SegmentId; 2]) -> Proposal {
        let mut proposal = Proposal::new(Rule::Neck, Source::Cluster(from), Some(into));
        proposal.extend(self.checks);
        proposal
    }

    fn event(self, parts: [SegmentId; 2]) -> Event {
        self.propose(parts).accept(None)
    }

    fn miss(self) -> Miss {
        let parts = self.parts;
        self.propose(parts).refuse()
    }
}

struct Compare<'a> {
    clusters: &'a Clusters<'a>,
    up: DVec3,
    params: &'a params::Necks,
    /// All clusters.
    parts: BTreeMap<SegmentId, Part<'a>>,
}

impl Compare<'_> {
    /// Compares two clusters; `None` if they do not touch and no other rule joins them.
    fn pair(&self, pair: [SegmentId; 2]) -> Option<Pair> {
        let (clusters, up) = (self.clusters, self.up);
        let part = |id: SegmentId| &self.parts[&id];
        let one_way = pair;
        let other_way = [pair[1], pair[0]];
        let either = |checks: &dyn Fn([SegmentId; 2]) -> Option<Vec<Check>>| {
            [one_way, other_way].into_iter().find_map(|parts| Some((parts, checks(parts)?)))
        };
        let sizes_px = pair.map(|id| part(id).pixels().len());
        let by_size = if sizes_px[0] < sizes_px[1] { one_way } else { other_way };
        if let Some(checks) = hanging::checks(clusters, by_size.map(part)) {
            return Some(Pair { parts: by_size, overlap: 0.0, checks });
        }
        let feet_m = pair.map(|id| part(id).foot_m());
        let [upper, lower] = if feet_m[0] >= feet_m[1] { one_way } else { other_way };
        let rolls = |parts: [SegmentId; 2]| ball::checks(clusters, up, part(parts[0]).ball()?, parts);
        let covers = || Some(([upper, lower], top::checks(clusters, up, [upper, lower])?));
        let symmetric = |parts: [SegmentId; 2]| {
            symmetry::checks(clusters, part(parts[0]).shaft()?, parts[1], parts.map(|id| part(id).foot_m()))
        };
        if let Some((parts, checks)) = either(&rolls).or_else(covers).or_else(|| either(&symmetric)) {
            return Some(Pair { parts, overlap: 1.0, checks });
        }
        let least = self.params.color_overlap;
        let colors = pair.map(|id| part(id).colors());
        let alike_in_light = check_alike_in_light(colors, least);
        if alike_in_light.holds()
            && let Some((parts, mut checks)) =
                either(&|parts| waist::checks(clusters, &self.parts, parts, least))
        {
            checks.insert(0, alike_in_light);
            return Some(Pair { parts, overlap: 1.0, checks });
        }
        if !touch(clusters, pair) {
            return None;
        }
        let (overlap, foot_m) = (colors[0].overlap(colors[1]), feet_m[0].max(feet_m[1]));
        let alike = check_alike(overlap, least);
        let carrying = contacts(clusters, [lower, upper]);
        let handle = || handle::checks(clusters, up, [upper, lower], &carrying, foot_m);
        let checks = match alike.holds().then(handle).flatten() {
            Some(handle) => [vec![alike], handle].concat(),
            None => standing::checks(clusters, up, [upper, lower], &carrying, foot_m, alike),
        };
        Some(Pair { parts: [upper, lower], overlap, checks })
    }
}
