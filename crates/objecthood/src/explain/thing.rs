//! What became of the thing that a facet belongs to: which rules joined it, which nearly did, which filter it met.

use crate::explain::Explainer;
use crate::explain::explanation::{Decision, Question, Reason};
use crate::objectness::check::{Bound, Check};
use crate::objectness::history::{Event, Miss, Rule};
use crate::objectness::hypotheses::Hypothesis;
use crate::objectness::join::JoinEvidence;
use crate::objectness::small;
use crate::regions::SegmentId;

/// So many parts of an object are named at most, beside those on the way of the pixel's own.
const PARTS: usize = 6;
/// A check that fails by more of its limit than this was not near to hold.
const NEAR: f64 = 0.5;

impl Explainer<'_> {
    /// Whether the thing that a facet belongs to is an object, and why.
    pub(super) fn kept(&self, facet: SegmentId) -> Decision {
        let question = Question::Kept { facet: facet.0 };
        let own = self.run.cluster(facet);
        let (reason, checks) = match own {
            // The last event of its way gave it to the background.
            None => {
                let last = self.run.chain(facet).pop().map(|last| &self.run.events[last]);
                last.map_or((Reason::Passed, Vec::new()), |event| {
                    (Reason::Rule(event.rule), event.checks.clone())
                })
            }
            Some(cluster) => {
                let size_px = self.run.size_px(cluster);
                let fragment = small(size_px, &self.space, &self.params.fragments);
                let too_small = self.too_small(size_px);
                let is_low = |(after, miss): &&(usize, Miss)| {
                    miss.rule == Rule::Low && self.run.owner(miss.from, *after) == Some(cluster)
                };
                // A thing is as high as the highest of what it was made of.
                let low = self.run.misses.iter().filter(is_low).flat_map(|(_, miss)| &miss.checks).copied();
                let low = low.reduce(|a, b| if b.measured > a.measured { b } else { a });
                let unlikely = self.run.hypothesis(cluster).and_then(|hypothesis| self.unlikely(hypothesis));
                match unlikely {
                    _ if too_small.holds() => (Reason::Size, vec![too_small]),
                    Some(unlikely) if unlikely.holds() => (Reason::Objectness, vec![unlikely]),
                    _ => {
                        let passed = low.into_iter().chain([too_small, fragment]).chain(unlikely);
                        (Reason::Passed, passed.collect())
                    }
                }
            }
        };
        self.decision(question, reason, checks)
    }

    /// That a cluster of so many pixels is too small for an object.
    fn too_small(&self, size_px: usize) -> Check {
        let limit = self.space.area_px(self.params.objectness.min_size_px) as f64;
        Check::new("its pixels", "px", size_px as f64, Bound::Below, limit).set_by("objectness.min_size_px")
    }

    /// That too little speaks for a hypothesis, if that is asked.
    fn unlikely(&self, hypothesis: &Hypothesis) -> Option<Check> {
        let params = &self.params.objectness;
        let measured = f64::from(hypothesis.objectness);
        let check = Check::new("its objectness", "", measured, Bound::Below, f64::from(params.threshold));
        (!params.every_hypothesis).then(|| check.set_by("objectness.threshold"))
    }

    /// What rules did with the thing of a facet: first what gave the facet on, then what else came to it.
    pub(super) fn way(&self, facet: SegmentId) -> Vec<Decision> {
        let own = self.run.chain(facet);
        let cluster = self.run.cluster(facet);
        let is_part = |event: &usize| {
            cluster.is_some() && self.run.owner_of_event(*event) == cluster && !own.contains(event)
        };
        let parts = (0..self.run.events.len()).filter(is_part).take(PARTS);
        own.iter().copied().chain(parts).filter_map(|event| self.joined(event)).collect()
    }

    /// Why two clusters were made one; `None` of what was given to the background.
    fn joined(&self, place: usize) -> Option<Decision> {
        let event = &self.run.events[place];
        let facet = |cluster| self.run.largest_facet(cluster, place).map(|facet| facet.0);
        let into = facet(event.into?)?;
        let question = match event.from {
            Some(from) => Question::OneThing { facets: [into, facet(from)?] },
            None => Question::Bottom { facet: into },
        };
        Some(self.decision(question, Reason::Rule(event.rule), event.checks.clone()))
    }

    /// Why a pixel of the structure is the bottom of an object, if it is.
    pub(super) fn bottom(&self, pixel: usize) -> Vec<Decision> {
        let (u, v) = (pixel % self.disparity.width(), pixel / self.disparity.width());
        let holds = |event: &Event| {
            let Some((join, _)) = &event.join else { return false };
            let [_, bottom] = join.parts;
            let (columns, rows) = (
                bottom.box_px.u..bottom.box_px.u + bottom.box_px.width,
                bottom.box_px.v..bottom.box_px.v + bottom.box_px.height,
            );
            matches!(join.evidence, JoinEvidence::VesselBottom { .. })
                && columns.contains(&u)
                && rows.contains(&v)
        };
        let label = self.discovery().labels[pixel];
        let is_own = |&place: &usize| {
            let facet = self.run.events[place].into.and_then(|into| self.run.largest_facet(into, place));
            label > 0 && facet.is_some_and(|facet| self.run.object(facet) == label)
        };
        let mut events = (0..self.run.events.len()).filter(|&place| holds(&self.run.events[place]));
        let event = events.find(is_own).and_then(|place| self.joined(place));
        event.into_iter().collect()
    }

    /// What rules nearly joined to the thing of a facet, if anything: of vessels and of occluded parts the one that failed the
    /// fewest checks, by the least.
    pub(super) fn near_misses(&self, facet: SegmentId) -> Vec<Decision> {
        let Some(cluster) = self.run.cluster(facet) else { return Vec::new() };
        let owner = |cluster, after| self.run.owner(cluster, after);
        let mut found = Vec::new();
        for is_kind in [
            |rule| rule == Rule::Occlusion,
            |rule| matches!(rule, Rule::VesselInside | Rule::VesselWall | Rule::VesselRemainder),
        ] {
            let own = self.run.misses.iter().filter(|(after, miss)| {
                let (a, b) = (owner(miss.from, *after), miss.into.and_then(|into| owner(into, *after)));
                let is_own = a != b && b.is_some() && (a == Some(cluster) || b == Some(cluster));
                let is_near = |check: &Check| check.holds() || check.distance() <= NEAR;
                is_kind(miss.rule) && is_own && miss.checks.iter().all(is_near)
            });
            let nearest = own.min_by(|a, b| {
                let [a, b] = [a, b].map(|(_, miss)| shortfall(&miss.checks));
                a.0.cmp(&b.0).then_with(|| a.1.total_cmp(&b.1))
            });
            found.extend(nearest);
        }
        let decide = |(after, miss): &(usize, Miss)| {
            let [a, b] = [miss.into?, miss.from].map(|cluster| self.run.largest_facet(cluster, *after));
            let question = Question::OneThing { facets: [a?.0, b?.0] };
            Some(self.decision(question, Reason::Rule(miss.rule), miss.checks.clone()))
        };
        found.into_iter().filter_map(decide).collect()
    }
}

/// How many checks fail, and by how much of their limits together.
fn shortfall(checks: &[Check]) -> (usize, f64) {
    let failed = checks.iter().filter(|check| !check.holds());
    (failed.clone().count(), failed.map(Check::distance).sum())
}
