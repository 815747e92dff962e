//! Joins the convex parts of one body across a neck or fold (docs/CONTEXT.md 4.7).

mod handle;
mod hanging;
mod symmetry;
#[cfg(test)]
mod tests;
mod top;

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use rayon::prelude::*;

use crate::check::{Bound, Check};
use crate::clusters::borders::BorderCounts;
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Event, Miss, Proposal, Rule, Source};
use crate::clusters::necks::handle::Joint;
use crate::clusters::necks::symmetry::Shaft;
use crate::clusters::scene::{LEVEL_DEG, Scene, sampled};
use crate::clusters::vessels::piece::check_on;
use crate::clusters::vessels::walls::FLAT;
use crate::color::histogram::ColorHistogram;
use crate::neighbours::four_neighbours;
use crate::params;
use crate::regions::SegmentId;
use crate::surface::disparity::position;
use crate::union_find::UnionFind;

/// Parts touch along at least this many pairs of pixels (px at 525 px).
const TOUCH_PX: usize = 8;
/// A smaller part has too few colours to compare (px at 525 px).
const PART_PX: usize = 100;
/// The foot of a part is this quantile of its heights.
const FOOT_SHARE: f64 = 0.05;
/// A part whose foot is no higher above its support (m) stands on it: twice the noise of a foot at 1.5 m.
const FOOT_M: f64 = 0.015;
/// The lower part is looked at this far (m) around the contact: where a foot would stand.
const AROUND_M: f64 = 0.03;
/// With a larger share of level pixels around the contact the lower part carries the upper one.
const LEVEL_SHARE: f64 = 0.3;
/// A pixel steeper than this is a side (degrees): it says nothing of what stands above it.
const STEEP_DEG: f64 = 65.0;
/// From this share of pixels on that are neither level nor steep, a thing of its own would slide off the lower part.
const SLIDING_SHARE: f64 = 0.33;
/// A part on a slope has at most this share of the pixels of the one below: caps and heads measure 0.1 to 0.35. Of things that lean on each other, the
/// front one hides the foot of the other, and both are of a size.
const SMALLER_SHARE: f64 = 0.4;
/// A part hangs when at least the first of these shares of its pixels hangs, and less than the second stands. What it hangs on stands with at
/// least the second.
const HANGING_SHARE: f64 = 0.5;
const STANDING_SHARE: f64 = 0.3;
/// The foot of a hanging part is at least this share as high as its top: what leans stands on an end.
const FOOT_OF_TOP: f64 = 0.35;
/// The top of a part is this quantile of its heights.
const TOP_SHARE: f64 = 0.98;
/// A part stands on the one below if that touches it within this (m) of the height of its foot.
const STANDS_M: f64 = 0.005;
/// A handle touches its body along this share of their border: what is merely pushed against another leaves gaps,
const CLOSED_SHARE: f64 = 0.7;
/// with all of its end: the width of the joint over that of the end,
const END_WIDTHS: [f64; 2] = [0.7, 1.5];
/// and is so many times as long as wide. Handles of synthetic tools and hammers measure 3 to 9.
const SLIMNESS: f64 = 2.5;
/// What a part hangs on is this close (m): a shoulder hides as much of the neck behind it.
const HANGING_M: f64 = 0.03;
/// Contacts around which the lower part is looked at, at most: evenly spread, their surroundings overlap.
const CONTACTS: usize = 16;

/// Joins two clusters that touch when the upper one has no foot of its own: it stands neither on a support nor on a level face of the lower
/// one, as stacked things do. They also share their colours, or the upper one is small and sits on a slope, from which a thing of its own
/// would slide off. Pairs that share most colours are joined first.
///
/// Of two that share their colours one may also be a handle: slim, and joined to the other with all of its end.
///
/// A small part that is seen to hang in the air is joined with what it hangs on, whether or not they touch.
///
/// The axis of a slim part may be an axis of symmetry of what it ends at, as that of a handle is: they are joined, whatever their colours.
///
/// A level part is the top of another of its width that begins as a side at its edge, whatever their colours.
///
/// Source: ours, because a neck or fold is a valley between convex parts (paper, future work: concavity). O(pairs side by side · pixels of
/// both); parallel over pairs. Does nothing without a support; without colour the rules that compare colours join nothing.
pub(crate) fn join_necks(clusters: &mut Clusters<'_>, params: &params::Necks) {
    let scene = clusters.scene;
    let Some(ground) = scene.ground().filter(|_| params.enabled) else { return };
    let least_touch = scene.space.length_px(TOUCH_PX) as u32;
    let least_px = scene.space.area_px(PART_PX);
    let is_part = |id: SegmentId| clusters.get(id).pixels.len() >= least_px;
    let mut pairs = Vec::new();
    for id in clusters.alive().into_iter().filter(|&id| is_part(id)) {
        let is_beside = |borders: &BorderCounts| borders.all() >= least_touch;
        let beside = clusters.get(id).neighbours.iter().filter(|(_, borders)| is_beside(borders));
        let others = beside.filter_map(|(other, _)| *other).filter(|&other| other > id && is_part(other));
        pairs.extend(others.map(|other| [id, other]));
    }
    let ids = pairs.iter().flatten().copied().collect::<BTreeSet<SegmentId>>();
    let shaft = |id| Some((id, Shaft::of(clusters, ground.normal, id)?));
    let shafts = ids.into_par_iter().filter_map(shaft).collect();
    let compare = Compare { clusters, up: ground.normal, least_touch, params, shafts };
    let mut compared: Vec<Pair> = pairs.into_par_iter().filter_map(|pair| compare.pair(pair)).collect();
    compared.sort_by(|a, b| b.overlap.total_cmp(&a.overlap));
    let (joins, misses): (Vec<Pair>, Vec<Pair>) = compared.into_iter().partition(Pair::is_join);
    let count = clusters.alive().last().map_or(0, |last| last.index() + 1);
    let mut sets = UnionFind::new(count);
    for pair in joins {
        let [a, b] = pair.parts.map(|part| sets.find(part.index()));
        if a != b {
            sets.link(a.min(b), a.max(b));
            clusters.give(pair.event([a.min(b), a.max(b)].map(|root| SegmentId(root as u32))));
        }
    }
    clusters.history.note_misses(misses.into_iter().map(Pair::miss));
}

/// Two clusters: the upper one first, or the one that hangs.
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

/// Shares of the pixels around a contact.
struct Slopes {
    /// A thing can stand on them.
    level_share: f64,
    /// A thing slides off them.
    sliding_share: f64,
}

struct Compare<'a> {
    clusters: &'a Clusters<'a>,
    up: DVec3,
    least_touch: u32,
    params: &'a params::Necks,
    /// The clusters that are slim.
    shafts: BTreeMap<SegmentId, Shaft>,
}

impl Compare<'_> {
    /// Compares two clusters; `None` if they do not touch and the upper one does not hang on the other.
    fn pair(&self, pair: [SegmentId; 2]) -> Option<Pair> {
        let scene = self.clusters.scene;
        let pixels = pair.map(|id| &self.clusters.get(id).pixels);
        let by_size = if pixels[0].len() < pixels[1].len() { pair } else { [pair[1], pair[0]] };
        if let Some(checks) = self.hangs(by_size) {
            return Some(Pair { parts: by_size, overlap: 0.0, checks });
        }
        let feet_m = pixels.map(|pixels| height_m(scene, pixels, FOOT_SHARE));
        let is_first_upper = feet_m[0] >= feet_m[1];
        let [upper, lower] = if is_first_upper { pair } else { [pair[1], pair[0]] };
        let foot_m = feet_m[0].max(feet_m[1]);
        if let Some(checks) = top::checks(self.clusters, self.up, [upper, lower]) {
            return Some(Pair { parts: [upper, lower], overlap: 1.0, checks });
        }
        let symmetric = [pair, [pair[1], pair[0]]].into_iter().find_map(|parts| {
            let shaft = self.shafts.get(&parts[0])?;
            Some((parts, symmetry::checks(self.clusters, shaft, parts[1])?))
        });
        if let Some((parts, checks)) = symmetric {
            return Some(Pair { parts, overlap: 1.0, checks });
        }
        let borders = self.clusters.get(upper).neighbours.get(&Some(lower))?;
        if borders.touch < self.least_touch {
            return None;
        }
        let overlap = self.color_overlap(pair);
        let carrying = self.contacts(lower, upper);
        let alike =
            Check::new("overlap of their colours", "", overlap, Bound::Above, self.params.color_overlap)
                .set_by("necks.color_overlap");
        if alike.holds()
            && let Some(handle) = self.handle_checks([upper, lower], &carrying, foot_m)
        {
            return Some(Pair { parts: [upper, lower], overlap, checks: [vec![alike], handle].concat() });
        }
        let Slopes { level_share, sliding_share } = self.slopes(lower, &carrying);
        let slides = self.slides([upper, lower], sliding_share);
        let mut checks = vec![
            Check::new("foot of the upper part above its support", "m", foot_m, Bound::Above, FOOT_M),
            Check::new(
                "share of the lower part around it that is level",
                "",
                level_share,
                Bound::Below,
                LEVEL_SHARE,
            ),
        ];
        checks.extend(self.check_hollow(by_size));
        if alike.holds() || !slides.iter().all(Check::holds) {
            checks.insert(0, alike);
        } else {
            checks.extend(slides);
        }
        Some(Pair { parts: [upper, lower], overlap, checks })
    }

    /// Checks that of two hollow parts, the smaller one first, that one goes on in the other: else it is a bowl that stands in it. `None` when one is not
    /// hollow, or where they lie cannot be told.
    fn check_hollow(&self, [smaller, larger]: [SegmentId; 2]) -> Option<Check> {
        let are_hollow = [smaller, larger].into_iter().all(|id| self.clusters.convexity(id) < -FLAT);
        let support = self.clusters.scene.ground().filter(|_| are_hollow)?;
        check_on(self.clusters, support, larger, smaller)
    }

    /// The checks by which the upper part would slide off the lower, from which a thing slides around their contact with this share.
    fn slides(&self, [upper, lower]: [SegmentId; 2], sliding_share: f64) -> [Check; 2] {
        let [upper_px, lower_px] = [upper, lower].map(|id| self.clusters.get(id).pixels.len() as f64);
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
        ]
    }

    /// The overlap of the colours of two parts; 0 without colour.
    fn color_overlap(&self, pair: [SegmentId; 2]) -> f64 {
        self.clusters.scene.lab.map_or(0.0, |lab| {
            let [a, b] =
                pair.map(|id| ColorHistogram::of(sampled(&self.clusters.get(id).pixels).map(|i| lab[i])));
            a.overlap(&b)
        })
    }

    /// The checks by which one of two parts is a handle of the other; `None` when one fails, or the upper one, with its foot at `foot_m`, stands on
    /// the lower. `carrying`: the pixels of the lower one that touch the upper.
    fn handle_checks(
        &self,
        [upper, lower]: [SegmentId; 2],
        carrying: &[usize],
        foot_m: f64,
    ) -> Option<Vec<Check>> {
        let pixels: Vec<u32> = carrying.iter().map(|&i| i as u32).collect();
        if foot_m > FOOT_M && (height_m(self.clusters.scene, &pixels, 0.5) - foot_m).abs() < STANDS_M {
            return None;
        }
        let ways = [([upper, lower], &*self.contacts(upper, lower)), ([lower, upper], carrying)];
        ways.into_iter().find_map(|([part, body], contacts)| {
            let Joint { closed_share, width_share, slimness } =
                handle::joint(self.clusters, self.up, [part, body], contacts)?;
            let check = |name, value, bound, limit| Check::new(name, "", value, bound, limit);
            let width = "width of the joint, over that of the end of the slim part";
            let checks = vec![
                check(
                    "share of their border at which they touch",
                    closed_share,
                    Bound::AtLeast,
                    CLOSED_SHARE,
                ),
                check(width, width_share, Bound::AtLeast, END_WIDTHS[0]),
                check(width, width_share, Bound::AtMost, END_WIDTHS[1]),
                check("length of the slim part, over its width", slimness, Bound::AtLeast, SLIMNESS),
            ];
            checks.iter().all(Check::holds).then_some(checks)
        })
    }

    /// The checks by which the smaller part hangs on the larger; `None` when one fails.
    fn hangs(&self, [part, carrier]: [SegmentId; 2]) -> Option<Vec<Check>> {
        let [part_px, carrier_px] = [part, carrier].map(|id| self.clusters.get(id).pixels.len() as f64);
        let smaller = Check::new(
            "pixels of the hanging part, over those of the other",
            "",
            part_px / carrier_px,
            Bound::AtMost,
            SMALLER_SHARE,
        );
        let share = |name, value, bound, limit| Check::new(name, "", value, bound, limit);
        let bends = self.clusters.convexity(carrier);
        let bends = share("how far the other bends outwards", bends, Bound::Above, 0.0);
        let [foot_m, top_m] = [FOOT_SHARE, TOP_SHARE]
            .map(|share| height_m(self.clusters.scene, &self.clusters.get(part).pixels, share));
        let foot =
            Check::new("foot of the hanging part above its support", "m", foot_m, Bound::Above, FOOT_M);
        let ends =
            share("height of that foot, over that of its top", foot_m / top_m, Bound::AtLeast, FOOT_OF_TOP);
        // Most pairs fail these, which cost little.
        if ![smaller, bends, foot, ends].iter().all(Check::holds) {
            return None;
        }
        let distance_m = hanging::distance_m(self.clusters, [part, carrier]);
        let near = Check::new("distance of the parts", "m", distance_m, Bound::AtMost, HANGING_M);
        if !near.holds() {
            return None;
        }
        let [own, other] = [part, carrier].map(|id| hanging::underside(self.clusters, id));
        let checks = vec![
            foot,
            ends,
            share(
                "share of the part that hangs: its support is seen below it",
                own.hanging,
                Bound::AtLeast,
                HANGING_SHARE,
            ),
            share("share of the part that stands", own.standing, Bound::Below, STANDING_SHARE),
            share("share of the other that stands", other.standing, Bound::AtLeast, STANDING_SHARE),
            near,
            smaller,
            bends,
        ];
        checks.iter().all(Check::holds).then_some(checks)
    }

    /// The pixels of one part that touch the other.
    fn contacts(&self, of: SegmentId, with: SegmentId) -> Vec<usize> {
        let scene = self.clusters.scene;
        let (width, height) = scene.disparity.size();
        let meets = |&i: &usize| {
            four_neighbours(i, width, height).any(|(j, _)| {
                self.clusters.at_pixel(j) == Some(with) && scene.steps.touch(scene.disparity, i, j)
            })
        };
        self.clusters.get(of).pixels.iter().map(|&i| i as usize).filter(meets).collect()
    }

    /// How the lower part slopes around its contacts with the upper one.
    fn slopes(&self, lower: SegmentId, contacts: &[usize]) -> Slopes {
        let scene = self.clusters.scene;
        let width = scene.disparity.width();
        let pixels = &self.clusters.get(lower).pixels;
        let step = contacts.len().div_ceil(CONTACTS).max(1);
        let around: Vec<(usize, DVec3)> =
            contacts.iter().step_by(step).map(|&i| (i, scene.point_at(i))).collect();
        let focal_px = scene.space.camera().fx_px.max(scene.space.camera().fy_px);
        let is_near = |&i: &usize| {
            let at = position(i, width);
            around.iter().any(|&(contact, point)| {
                let reach_px = AROUND_M * focal_px / point.z;
                let of_contact = position(contact, width);
                (0..2).all(|k| (at[k] - of_contact[k]).abs() < reach_px)
                    && scene.point_at(i).distance(point) < AROUND_M
            })
        };
        let [level_cosine, steep_cosine] =
            [LEVEL_DEG, STEEP_DEG].map(|degrees| libm::cos(degrees.to_radians()));
        let (mut near, mut level, mut sliding) = (0_u32, 0_u32, 0_u32);
        for i in pixels.iter().map(|&i| i as usize).filter(is_near) {
            let normal = scene.normals[i].map(f64::from);
            let cosine = self.up.dot(normal.into());
            near += 1;
            level += u32::from(cosine > level_cosine);
            sliding += u32::from(cosine > steep_cosine && cosine <= level_cosine);
        }
        let share = |count| f64::from(count) / f64::from(near.max(1));
        Slopes { level_share: share(level), sliding_share: share(sliding) }
    }
}

/// The height (m) above the support below some pixels below which a share of them lies.
fn height_m(scene: &Scene<'_>, pixels: &[u32], share: f64) -> f64 {
    let support = scene.own_support(pixels);
    support.map_or(0.0, |support| scene.height_quantile_m(sampled(pixels), support, share))
}
