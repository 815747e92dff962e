//! Why? What a pixel belongs to, which borders and rules made it so, and what it would take to decide otherwise.
//!
//! An [`Explainer`] looks at a frame as [`discover`](crate::discover) does and keeps what the stages show; [`Explainer::explain`]
//! answers for one pixel with an [`Explanation`], which is plain data. It speaks of the method `context`.
//!
//! The algorithms know nothing of this room. What it says of rules are the [`Check`](crate::objectness::check::Check)s by which
//! they decided; what it says of parameters is found by deciding again: see [`Flip`].

mod explanation;
mod flip;
mod run;
mod sweep;

pub use explanation::{
    BorderReport, Decision, Explanation, FacetReport, Flip, ObjectReport, Outcome, Part, Question, Reason,
};

use std::sync::OnceLock;

use std::collections::BTreeSet;

use crate::discovery::{Discovery, ObjectId, ObjectnessParts};
use crate::error::{Error, Result};
use crate::explain::flip::Search;
use crate::explain::run::Run;
use crate::explain::sweep::Sweep;
use crate::frame::Frame;
use crate::objectness::check::{Bound, Check};
use crate::objectness::history::{Event, Miss, Rule};
use crate::objectness::hypotheses::Hypothesis;
use crate::objectness::join::JoinEvidence;
use crate::objectness::small;
use crate::params::Params;
use crate::raster::Raster;
use crate::regions::{RegionEdge, SegmentId, Segments};
use crate::shapes::border::BorderEvidence;
use crate::surface::disparity::{DisparitySpace, position};

/// So many parts of an object are named at most, beside those on the way of the pixel's own.
const PARTS: usize = 6;
/// A check that fails by more of its limit than this was not near to hold.
const NEAR: f64 = 0.5;

/// A frame that was looked at, ready for questions.
pub struct Explainer<'a> {
    frame: &'a Frame,
    params: &'a Params,
    space: DisparitySpace,
    disparity: Raster<f32>,
    run: Run,
    /// What votes would do with other parameters, once it was asked for.
    sweep: OnceLock<Sweep>,
}

impl<'a> Explainer<'a> {
    /// Looks at a frame.
    ///
    /// # Errors
    /// As [`discover`](crate::discover); [`Error::OnlyContext`] with another method.
    pub fn new(frame: &'a Frame, params: &'a Params) -> Result<Self> {
        let run = Run::new(frame, params)?;
        let space = DisparitySpace::new(frame.camera(), &params.sensor);
        Ok(Self {
            frame,
            params,
            disparity: space.disparity(frame.depth_m()),
            space,
            run,
            sweep: OnceLock::new(),
        })
    }

    /// What was found in the frame.
    pub fn discovery(&self) -> &Discovery {
        &self.run.discovery
    }

    /// The facets, and what was missing between them filled. Those of the structure come first.
    pub fn facets(&self) -> &Segments {
        &self.run.filled.segments
    }

    /// A pixel (column, row) that stands for an object: of its largest facet the one nearest to that facet's middle.
    pub fn pixel_of(&self, id: ObjectId) -> Option<[usize; 2]> {
        let mut pixels: Vec<Vec<usize>> = vec![Vec::new(); self.facets().count()];
        let labels = &self.discovery().labels;
        self.facets().members().filter(|&(i, _)| labels[i] == id.0).for_each(|(i, f)| pixels[f].push(i));
        let largest =
            pixels.iter().rev().max_by_key(|pixels| pixels.len()).filter(|pixels| !pixels.is_empty())?;
        let at = |i: usize| position(i, labels.width());
        let middle = [0, 1].map(|k| largest.iter().map(|&i| at(i)[k]).sum::<f64>() / largest.len() as f64);
        let off = |i: usize| [0, 1].map(|k| (at(i)[k] - middle[k]).powi(2)).iter().sum::<f64>();
        let nearest = largest.iter().copied().min_by(|&i, &j| off(i).total_cmp(&off(j)))?;
        Some([nearest % labels.width(), nearest / labels.width()])
    }

    /// Why the pixel in column `u` and row `v` is what it is, and what it would take to decide otherwise. O(pixels), and up to 40
    /// looks at the frame with single parameters changed.
    ///
    /// # Errors
    /// [`Error::OutsideImage`].
    pub fn explain(&self, pixel: [usize; 2]) -> Result<Explanation> {
        let mut explanation = self.describe(pixel)?;
        let mut search = self.search();
        explanation.decisions_mut().for_each(|decision| decision.flip = search.flip(decision));
        Ok(explanation)
    }

    /// What it would take to decide otherwise: up to 40 looks at the frame.
    pub fn flip(&self, decision: &Decision) -> Flip {
        self.search().flip(decision)
    }

    /// The answer to a question about facets of this frame. Facets keep their numbers as long as no parameter of the first two stages
    /// changes.
    pub fn answer(&self, question: Question) -> bool {
        self.run.answer(question)
    }

    fn search(&self) -> Search<'_> {
        Search::new(self.frame, self.params, &self.run, &self.sweep)
    }

    /// As [`Self::explain`], but no flip is looked for: every one is [`Flip::NotSought`]. O(pixels).
    ///
    /// # Errors
    /// [`Error::OutsideImage`].
    pub fn describe(&self, [u, v]: [usize; 2]) -> Result<Explanation> {
        let (width, height) = self.frame.size();
        if u >= width || v >= height {
            return Err(Error::OutsideImage { pixel: [u, v], size: (width, height) });
        }
        let i = v * width + u;
        let depth_m = self.frame.is_valid(i).then(|| self.frame.depth_m()[i]);
        let mut explanation = Explanation {
            pixel: [u, v],
            depth_m,
            outcome: if depth_m.is_some() { Outcome::NoFacet } else { Outcome::NoDepth },
            facet: None,
            kept: None,
            borders: Vec::new(),
            way: Vec::new(),
            near_misses: Vec::new(),
            object: None,
        };
        let Some(facet) = self.facets().at(i) else { return Ok(explanation) };

        explanation.facet = Some(self.facet(facet, i));
        explanation.object = self.run.hypothesis_at(i).map(|hypothesis| self.object(hypothesis));
        explanation.outcome = self.outcome(facet, i);
        match self.run.free(facet) {
            Some(_) => {
                explanation.kept = Some(self.kept(facet));
                explanation.way = self.way(facet);
                explanation.near_misses = self.near_misses(facet);
            }
            None => explanation.way = self.bottom(i),
        }
        explanation.borders = self.borders(facet);
        Ok(explanation)
    }

    fn facet(&self, facet: SegmentId, pixel: usize) -> FacetReport {
        let width = self.disparity.width();
        let model = &self.run.filled.models[facet.index()];
        let residual = |i: usize| f64::from(self.disparity[i]) - model.value(position(i, width));
        let own = self.facets().members().filter(|&(_, f)| f == facet.index());
        let (mut squared, mut size_px) = (0.0, 0);
        for (i, _) in own {
            squared += residual(i).powi(2);
            size_px += 1;
        }
        FacetReport {
            facet: facet.0,
            size_px,
            residual_quanta: residual(pixel),
            mean_residual_quanta: (squared / size_px as f64).sqrt(),
            structure_plane: self.plane(facet),
        }
    }

    /// The number of a structure plane in the label image of the structure, if the facet is one.
    fn plane(&self, facet: SegmentId) -> Option<u32> {
        (facet.index() < self.run.filled.structure).then_some(facet.0 + 1)
    }

    fn outcome(&self, facet: SegmentId, pixel: usize) -> Outcome {
        let label = self.discovery().labels[pixel];
        let in_structure = self.discovery().structure[pixel];
        match (label, self.plane(facet)) {
            (0, Some(plane)) => Outcome::Structure { plane },
            (0, None) if self.run.cluster(facet).is_none() => Outcome::Background { plane: in_structure },
            (0, None) if self.run.hypothesis_at(pixel).is_some() => Outcome::Unlikely,
            (0, None) => Outcome::TooSmall,
            (object, _) => Outcome::Object { object },
        }
    }

    fn object(&self, hypothesis: &Hypothesis) -> ObjectReport {
        let own = hypothesis.pixels.iter().filter_map(|&i| self.facets().at(i));
        let facets: BTreeSet<u32> = own.map(|facet| facet.0).collect();
        let label = self.discovery().labels[hypothesis.pixels[0]];
        ObjectReport {
            object: (label > 0).then_some(label),
            objectness: hypothesis.objectness,
            parts: parts(&hypothesis.parts),
            size_px: hypothesis.pixels.len(),
            facets: facets.into_iter().collect(),
        }
    }

    /// What was decided, without what it would take to decide otherwise.
    fn decision(&self, question: Question, reason: Reason, checks: Vec<Check>) -> Decision {
        Decision { question, yes: self.run.answer(question), reason, checks, flip: Flip::NotSought }
    }

    /// Whether the thing that a facet belongs to is an object, and why.
    fn kept(&self, facet: SegmentId) -> Decision {
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
    fn way(&self, facet: SegmentId) -> Vec<Decision> {
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
    fn bottom(&self, pixel: usize) -> Vec<Decision> {
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

    /// What rules nearly joined to the thing of a facet, if anything: of vessels and of occluded parts the one that failed the fewest checks, by
    /// the least.
    fn near_misses(&self, facet: SegmentId) -> Vec<Decision> {
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

    /// The borders of a facet, the longest first.
    fn borders(&self, facet: SegmentId) -> Vec<BorderReport> {
        let own = |edge: &&RegionEdge<BorderEvidence>| edge.a == facet || edge.b == facet;
        let mut edges: Vec<&RegionEdge<BorderEvidence>> =
            self.run.borders.edges().iter().filter(own).collect();
        let length_m = |edge: &RegionEdge<BorderEvidence>| edge.evidence.gaps.length_m;
        edges.sort_by(|a, b| length_m(b).total_cmp(&length_m(a)));
        edges.into_iter().map(|edge| self.border(facet, edge)).collect()
    }

    fn border(&self, facet: SegmentId, edge: &RegionEdge<BorderEvidence>) -> BorderReport {
        let evidence = &edge.evidence;
        let (other, sign) = if edge.a == facet { (edge.b, 1.0) } else { (edge.a, -1.0) };
        let fold_m = evidence.fold_m();
        let turn = evidence.folds.iter().map(|fold| fold.angle_deg * fold.length_m).sum::<f64>();
        let gaps = &evidence.gaps;
        let has_vote = self.run.free(facet).is_some() && self.run.free(other).is_some();
        let vote_m = has_vote.then(|| evidence.vote_m(&self.params.contraction));
        BorderReport {
            facet: other.0,
            structure_plane: self.plane(other),
            mean_angle_deg: (fold_m > 0.0).then(|| turn / fold_m),
            gap_quanta: sign * gaps.quanta_m / gaps.length_m,
            gap_mm: sign * 1e3 * gaps.depth_m2 / gaps.length_m,
            folded_mm: 1e3 * fold_m,
            stepped_mm: 1e3 * evidence.step_m,
            vote_mm: vote_m.map(|vote_m| 1e3 * vote_m),
            decision: vote_m.map(|vote_m| self.vote(facet, other, evidence, vote_m)),
        }
    }

    /// Whether two facets that share a border are one thing, and why.
    fn vote(&self, a: SegmentId, b: SegmentId, evidence: &BorderEvidence, vote_m: f64) -> Decision {
        let question = Question::OneThing { facets: [a.0, b.0] };
        let one_shape = self.run.shape(a) == self.run.shape(b);
        if !one_shape && self.run.one_thing(a, b) {
            let event = self.run.uniting(a, b).map(|place| &self.run.events[place]);
            // A small hole in a surface is filled without a word.
            let (rule, checks) =
                event.map_or((Rule::VesselBottom, Vec::new()), |event| (event.rule, event.checks.clone()));
            return self.decision(question, Reason::Rule(rule), checks);
        }
        let steps_m = self.params.contraction.occlusion_weight * evidence.step_m;
        let reason = match (one_shape, vote_m > 0.0) {
            (true, true) => Reason::Folds,
            (false, false) if evidence.step_m > 0.0 && steps_m >= -(vote_m + steps_m) => Reason::Steps,
            (false, false) => Reason::Folds,
            _ => Reason::OtherBorders,
        };
        self.decision(question, reason, Vec::new())
    }
}

/// How many checks fail, and by how much of their limits together.
fn shortfall(checks: &[Check]) -> (usize, f64) {
    let failed = checks.iter().filter(|check| !check.holds());
    (failed.clone().count(), failed.map(Check::distance).sum())
}

/// What an objectness is made of.
fn parts(parts: &ObjectnessParts) -> Vec<Part> {
    let &ObjectnessParts { size, support, compactness, separation, visibility } = parts;
    let named = [
        ("size", size),
        ("support", support),
        ("compactness", compactness),
        ("separation", separation),
        ("visibility", visibility),
    ];
    named.map(|(name, value)| Part { name, value: f64::from(value) }).into()
}
