//! Explains the thing of a facet: the rules that joined it, the rules that nearly did, and the filters.

use crate::check::{Bound, Check};
use crate::clusters::candidates::check_too_small;
use crate::clusters::fragments::check_small;
use crate::clusters::history::{Rule, Source};
use crate::explain::Explainer;
use crate::explain::explanation::{Decision, Question, Reason};
use crate::explain::steps::{NearStep, Step};
use crate::regions::SegmentId;

/// Most parts of an object that are named, besides the parts with the pixel's own facet.
const PARTS: usize = 6;
/// A failing check is near when value and limit differ by at most this share of the larger of both.
const NEAR: f64 = 0.5;

impl Explainer {
    /// Whether the thing that a facet belongs to is an object, and why.
    pub(super) fn kept(&self, facet: SegmentId) -> Decision {
        let question = Question::Kept { facet: facet.0 };
        let own = self.subject.run.cluster(facet);
        let (reason, checks) = match own {
            // The last event of its chain gave it to the background.
            None => {
                let last =
                    self.subject.run.chain(facet).pop().map(|last| &self.subject.run.steps[last].event);
                last.map_or((Reason::Passed, Vec::new()), |event| {
                    (Reason::Rule(event.rule), event.checks.clone())
                })
            }
            Some(cluster) => {
                let size_px = self.subject.run.size_px(cluster);
                let fragment =
                    check_small(size_px, &self.subject.surfaces.space, &self.subject.params.fragments);
                let too_small =
                    check_too_small(size_px, &self.subject.surfaces.space, &self.subject.params.objectness);
                let is_low =
                    |near: &&NearStep| near.miss.rule == Rule::Low && near.owners[1] == Some(cluster);
                // The height of a thing is the height of its highest cluster.
                let low = self
                    .subject
                    .run
                    .near_steps
                    .iter()
                    .filter(is_low)
                    .flat_map(|near| &near.miss.checks)
                    .copied();
                let low = low.reduce(|a, b| if b.measured > a.measured { b } else { a });
                let hypothesis = self
                    .subject
                    .run
                    .hypothesis(cluster)
                    .filter(|_| !self.subject.params.objectness.every_hypothesis);
                let unlikely =
                    hypothesis.map(|hypothesis| hypothesis.check_unlikely(&self.subject.params.objectness));
                match unlikely {
                    _ if too_small.holds() => (Reason::Size, vec![too_small]),
                    Some(unlikely) if unlikely.holds() => (Reason::Objectness, vec![unlikely]),
                    _ => {
                        let not_given = if fragment.holds() { self.spared(cluster) } else { Some(fragment) };
                        let passed = low.into_iter().chain([too_small]).chain(not_given).chain(unlikely);
                        match self.of_flat(cluster) {
                            flat if flat.is_empty() => (Reason::Passed, passed.collect()),
                            flat => {
                                let objectness = &self.subject.params.objectness;
                                let likely = hypothesis.map(|hypothesis| hypothesis.check_likely(objectness));
                                (Reason::Flat, flat.into_iter().chain(likely).collect())
                            }
                        }
                    }
                }
            }
        };
        self.decision(question, reason, checks)
    }

    /// The checks that made a cluster a flat thing; none if it is no flat thing.
    fn of_flat(&self, cluster: SegmentId) -> Vec<Check> {
        self.subject.run.flat(cluster).map_or_else(Vec::new, |flat| flat.checks.clone())
    }

    /// Whether a pixel of a structure plane belongs to an object, and why: it can only be a part of a bottom.
    pub(super) fn of_structure(&self, plane: SegmentId, pixel: [usize; 2], residual_quanta: f64) -> Decision {
        // The surface's own tolerance: the parameter, times how far the surface scatters.
        let scale = self.subject.run.structure.surfaces[plane.index()].scale;
        let limit = scale * self.subject.params.structure.tolerance_quanta;
        let off = residual_quanta.abs();
        let near = Check::new("its distance from the plane", "quanta", off, Bound::Below, limit);
        let question = Question::OfObject { pixel };
        if self.subject.run.answer(question) {
            return self.decision(question, Reason::Rule(Rule::VesselBottom), Vec::new());
        }
        let i = (pixel[1] * self.subject.run.structure.labels.width() + pixel[0]) as u32;
        if self.subject.run.structure.skirts.binary_search(&i).is_ok() {
            return self.decision(question, Reason::Skirt, Vec::new());
        }
        // A pixel farther from the plane got its label from neighbours: by straightened borders, or because a hole was filled.
        let checks = Some(near.set_by("structure.tolerance_quanta")).filter(Check::holds);
        self.decision(question, Reason::Structure, checks.into_iter().collect())
    }

    /// The failed check that kept a small cluster from being given away as a fragment.
    fn spared(&self, cluster: SegmentId) -> Option<Check> {
        let own = self.subject.run.near_steps.iter().filter(|near| near.owners[1] == Some(cluster));
        let stayed = own.filter(|near| near.miss.rule == Rule::Fragment);
        stayed.flat_map(|near| &near.miss.checks).find(|check| !check.holds()).copied()
    }

    /// The decisions of rules about the thing of a facet: first those that gave the facet away, then those that added other parts.
    pub(super) fn way(&self, facet: SegmentId) -> Vec<Decision> {
        let own = self.subject.run.chain(facet);
        let cluster = self.subject.run.cluster(facet);
        let is_part = |step: &usize| {
            cluster.is_some() && self.subject.run.steps[*step].owner == cluster && !own.contains(step)
        };
        let parts = (0..self.subject.run.steps.len()).filter(is_part).take(PARTS);
        own.iter()
            .copied()
            .chain(parts)
            .filter_map(|step| self.joined(&self.subject.run.steps[step]))
            .collect()
    }

    /// The decision that joined two clusters; `None` if the event gave something to the background.
    fn joined(&self, Step { event, facets, .. }: &Step) -> Option<Decision> {
        let question = self.question(event.from, *facets)?;
        event.into.map(|_| self.decision(question, Reason::Rule(event.rule), event.checks.clone()))
    }

    /// The question whether a source is a part of its receiver; both are named by their facets.
    fn question(&self, from: Source, [into, given]: [Option<SegmentId>; 2]) -> Option<Question> {
        Some(match from {
            Source::Cluster(_) => Question::OneThing { facets: [into?.0, given?.0] },
            Source::Patch(first) => {
                let (first, width) = (first as usize, self.subject.surfaces.disparity.width());
                Question::Bottom { facet: into?.0, patch: [first % width, first / width] }
            }
        })
    }

    /// The decision that made a pixel of the structure the bottom of an object, if there is one.
    pub(super) fn bottom(&self, pixel: usize) -> Vec<Decision> {
        self.subject.run.bottom_at(pixel).and_then(|step| self.joined(step)).into_iter().collect()
    }

    /// The joins to the thing of a facet that rules nearly made, and no rule made: at most one of the occlusion rule, one of the vessel rules and one of
    /// the rules of necks. Of each,
    /// the join that failed the fewest checks, then by the least.
    pub(super) fn near_misses(&self, facet: SegmentId) -> Vec<Decision> {
        let Some(cluster) = self.subject.run.cluster(facet) else { return Vec::new() };
        let mut found = Vec::new();
        for is_kind in [|rule| rule == Rule::Occlusion, Rule::is_of_vessels, |rule| rule == Rule::Neck] {
            let own = self.subject.run.near_steps.iter().filter(
                |NearStep { miss, owners: [into, from], facets, .. }| {
                    // A bottom that one rule refuses may be the bottom by another.
                    let question = self.question(miss.from, *facets);
                    let is_joined = question.is_some_and(|question| self.subject.run.answer(question));
                    let is_own = into != from && into.is_some() && [*into, *from].contains(&Some(cluster));
                    let is_near = |check: &Check| check.holds() || check.distance() <= NEAR;
                    is_kind(miss.rule) && is_own && !is_joined && miss.checks.iter().all(is_near)
                },
            );
            let nearest = own.min_by(|a, b| {
                let [a, b] = [a, b].map(|near| shortfall(&near.miss.checks));
                a.0.cmp(&b.0).then_with(|| a.1.total_cmp(&b.1))
            });
            found.extend(nearest);
        }
        let decide = |NearStep { miss, facets, .. }: &NearStep| {
            let question = self.question(miss.from, *facets)?;
            Some(self.decision(question, Reason::Rule(miss.rule), miss.checks.clone()))
        };
        found.into_iter().filter_map(decide).collect()
    }
}

/// The number of failing checks, and the sum of their distances.
fn shortfall(checks: &[Check]) -> (usize, f64) {
    let failed = checks.iter().filter(|check| !check.holds());
    (failed.clone().count(), failed.map(Check::distance).sum())
}
