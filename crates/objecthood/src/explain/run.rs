//! One run of the method, and what its stages showed.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use crate::discovery::Discovery;
use crate::error::{Error, Result};
use crate::explain::explanation::Question;
use crate::explain::steps::{Largest, NearStep, Step, steps};
use crate::facets::Facets;
use crate::frame::Frame;
use crate::neighbours::four_neighbours;
use crate::objectness::history::{Event, Miss, Source};
use crate::objectness::hypotheses::Hypothesis;
use crate::observe::{Observer, Stage};
use crate::params::{Method, Params};
use crate::regions::{RegionGraph, SegmentId};
use crate::shapes::border::BorderEvidence;
use crate::shapes::contraction::{Shapes, contract, sum_votes};

/// What the observer sees.
#[derive(Default)]
struct Record {
    borders: Option<(Facets, RegionGraph<BorderEvidence>)>,
    filled: Option<Facets>,
    events: Vec<Event>,
    misses: Vec<(usize, Miss)>,
    sizes_px: BTreeMap<SegmentId, usize>,
    hypotheses: Vec<Hypothesis>,
}

impl Observer for Record {
    fn observe(&mut self, stage: Stage<'_>) {
        match stage {
            Stage::Borders { facets, evidence } => self.borders = Some((facets.clone(), evidence.clone())),
            Stage::Clusters { facets, history } => {
                self.filled = Some(facets.clone());
                self.events = history.events().into_iter().cloned().collect();
                self.misses = history.misses().to_vec();
                self.sizes_px = history.clusters().collect();
            }
            Stage::Hypotheses(hypotheses) => self.hypotheses = hypotheses.to_vec(),
            _ => {}
        }
    }
}

/// What became of every facet in one run of `context`.
pub(super) struct Run {
    pub(super) discovery: Discovery,
    /// The facets as their borders were looked at.
    pub(super) facets: Facets,
    /// And with what was missing between them filled.
    pub(super) filled: Facets,
    pub(super) borders: RegionGraph<BorderEvidence>,
    pub(super) shapes: Shapes,
    pub(super) steps: Vec<Step>,
    pub(super) near_steps: Vec<NearStep>,
    sizes_px: BTreeMap<SegmentId, usize>,
    /// The hypothesis of every cluster that is large enough for one.
    hypotheses: BTreeMap<SegmentId, Hypothesis>,
    /// The first pixel of every facet, if it has any.
    first: Vec<Option<usize>>,
    /// The cluster in which every shape ends; `None` = the background.
    owners: Vec<Option<SegmentId>>,
    /// The cluster of every facet that was given to one as its bottom.
    bottom_of: BTreeMap<SegmentId, SegmentId>,
}

impl Run {
    /// # Errors
    /// As [`discover`](crate::discover); [`Error::OnlyContext`] with another method, before anything is looked at.
    pub(super) fn new(frame: &Frame, params: &Params) -> Result<Self> {
        let refused = || Error::OnlyContext { method: params.method };
        if params.method != Method::Context {
            return Err(refused());
        }
        let mut record = Record::default();
        let discovery = crate::discover_observed(frame, params, &mut record)?;
        let Record { borders, filled, events, misses, sizes_px, hypotheses } = record;
        let (Some((facets, borders)), Some(filled)) = (borders, filled) else { return Err(refused()) };
        let shapes = contract(&sum_votes(&borders, facets.structure, &params.contraction));

        let mut sizes = vec![0_usize; filled.segments.count()];
        let mut first = vec![None; sizes.len()];
        for (i, facet) in filled.segments.members() {
            sizes[facet] += 1;
            first[facet].get_or_insert(i);
        }
        let mut largest: Vec<Largest> = vec![None; shapes.count];
        for (&shape, k) in shapes.of_facet.iter().zip(filled.structure..) {
            let largest = &mut largest[shape as usize];
            *largest = (*largest).max(Some((sizes[k], Reverse(SegmentId(k as u32)))));
        }
        let (steps, near_steps, owners) = steps(events, misses, largest);
        let mut run = Self {
            discovery,
            facets,
            filled,
            borders,
            shapes,
            steps,
            near_steps,
            sizes_px,
            hypotheses: BTreeMap::new(),
            first,
            owners,
            bottom_of: BTreeMap::new(),
        };
        hypotheses.into_iter().for_each(|hypothesis| run.look_up(hypothesis));
        Ok(run)
    }

    /// Finds the cluster of a hypothesis, and what was background and is its bottom. O(pixels).
    fn look_up(&mut self, hypothesis: Hypothesis) {
        let facet_at = |i: &usize| self.filled.segments.at(*i);
        let owner = |facet| self.owners[self.shape(facet)?.index()];
        let Some(cluster) = hypothesis.pixels.iter().filter_map(facet_at).find_map(owner) else { return };
        let starts = hypothesis.pixels.iter().filter_map(|i| Some((*i, facet_at(i)?)));
        let starts = starts.filter(|&(i, facet)| self.first[facet.index()] == Some(i));
        let bottoms: Vec<SegmentId> = starts
            .map(|(_, facet)| facet)
            .filter(|&facet| self.free(facet).is_some() && owner(facet).is_none())
            .collect();
        self.bottom_of.extend(bottoms.into_iter().map(|facet| (facet, cluster)));
        self.hypotheses.insert(cluster, hypothesis);
    }

    /// The number of a facet among those that are no structure.
    pub(super) fn free(&self, facet: SegmentId) -> Option<usize> {
        facet.index().checked_sub(self.filled.structure)
    }

    /// The shape of a facet that is no structure; as a cluster it has the same number.
    pub(super) fn shape(&self, facet: SegmentId) -> Option<SegmentId> {
        self.shapes.of_facet.get(self.free(facet)?).map(|&shape| SegmentId(shape))
    }

    /// The cluster of a facet in the end; `None` = structure or background. What lay low and then turned out to be the bottom of a
    /// vessel is of the vessel.
    pub(super) fn cluster(&self, facet: SegmentId) -> Option<SegmentId> {
        let own = self.owners[self.shape(facet)?.index()];
        own.or_else(|| self.bottom_of.get(&facet).copied())
    }

    /// The object of a facet; 0 = none.
    pub(super) fn object(&self, facet: SegmentId) -> u16 {
        let hypothesis = self.cluster(facet).and_then(|cluster| self.hypothesis(cluster));
        hypothesis.map_or(0, |hypothesis| self.discovery.labels[hypothesis.pixels[0]])
    }

    /// The pixels of a cluster (px); 0 of one that is no more.
    pub(super) fn size_px(&self, cluster: SegmentId) -> usize {
        self.sizes_px.get(&cluster).copied().unwrap_or(0)
    }

    /// How much speaks for a cluster, if it is large enough.
    pub(super) fn hypothesis(&self, cluster: SegmentId) -> Option<&Hypothesis> {
        self.hypotheses.get(&cluster)
    }

    /// The hypothesis that holds a pixel.
    pub(super) fn hypothesis_at(&self, pixel: usize) -> Option<&Hypothesis> {
        self.hypotheses.values().find(|hypothesis| hypothesis.pixels.binary_search(&pixel).is_ok())
    }

    /// The answer to a question.
    pub(super) fn answer(&self, question: Question) -> bool {
        match question {
            Question::OneThing { facets: [a, b] } => self.one_thing(SegmentId(a), SegmentId(b)),
            Question::Kept { facet } => self.object(SegmentId(facet)) > 0,
            Question::OfObject { pixel: [u, v] } => {
                self.discovery.labels.get(u, v).is_some_and(|label| *label > 0)
            }
            Question::Bottom { facet, patch: [u, v] } => {
                let patch = v * self.discovery.labels.width() + u;
                let cluster = self.cluster(SegmentId(facet));
                cluster.is_some() && self.bottom(patch).is_some_and(|step| step.owner == cluster)
            }
        }
    }

    /// Whether two facets are one thing: parts of one shape, or of one cluster that is not background.
    pub(super) fn one_thing(&self, a: SegmentId, b: SegmentId) -> bool {
        let [of_a, of_b] = [a, b].map(|facet| self.cluster(facet));
        self.shape(a) == self.shape(b) || of_a.is_some() && of_a == of_b
    }

    /// What gave the patch of the background that begins at a pixel to a vessel.
    fn bottom(&self, patch: usize) -> Option<&Step> {
        let source = Source::Patch(u32::try_from(patch).ok()?);
        self.steps.iter().find(|step| step.event.from == source)
    }

    /// What gave the background at a pixel to a vessel, if anything did: a small hole in a surface is filled without a word.
    /// O(pixels of the patch).
    pub(super) fn bottom_at(&self, pixel: usize) -> Option<&Step> {
        let hypothesis = self.hypothesis_at(pixel)?;
        let (width, height) = self.discovery.labels.size();
        // Background that is of a thing is a bottom, and no two patches touch.
        let is_bottom = |i: usize| {
            let facet = self.filled.segments.at(i);
            let owner =
                facet.and_then(|facet| self.shape(facet)).and_then(|shape| self.owners[shape.index()]);
            owner.is_none() && hypothesis.pixels.binary_search(&i).is_ok()
        };
        let mut patch: BTreeSet<usize> = [pixel].into_iter().filter(|&i| is_bottom(i)).collect();
        let mut open: Vec<usize> = patch.iter().copied().collect();
        while let Some(i) = open.pop() {
            for (j, _) in four_neighbours(i, width, height) {
                if is_bottom(j) && patch.insert(j) {
                    open.push(j);
                }
            }
        }
        self.bottom(*patch.first()?)
    }

    /// What gave the shape of a facet on, one after the other: their places. O(events).
    pub(super) fn chain(&self, facet: SegmentId) -> Vec<usize> {
        let mut own = self.shape(facet);
        let mut chain = Vec::new();
        for (k, Step { event, .. }) in self.steps.iter().enumerate() {
            if own.is_some() && event.from.cluster() == own {
                own = event.into;
                chain.push(k);
            }
        }
        chain
    }

    /// What made two facets of different shapes one: the event after which they were. O(events).
    pub(super) fn uniting(&self, a: SegmentId, b: SegmentId) -> Option<&Step> {
        let mut own = [a, b].map(|facet| self.shape(facet));
        let joins = self.steps.iter().find(|Step { event, .. }| {
            let before = own;
            for own in &mut own {
                if own.is_some() && event.from.cluster() == *own {
                    *own = event.into;
                }
            }
            own != before && own[0].is_some() && own[0] == own[1]
        });
        // Else one of them is the bottom of the other.
        let bottom = |facet: SegmentId| {
            let first = self.bottom_of.contains_key(&facet).then(|| self.first[facet.index()])?;
            self.bottom_at(first?)
        };
        joins.or_else(|| [a, b].into_iter().find_map(bottom))
    }
}
