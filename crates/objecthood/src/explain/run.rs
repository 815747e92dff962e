//! One run of `context`: follows every facet through the outputs of the stages.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::clusters::cluster::find_flat;
use crate::clusters::clustering::Clustering;
use crate::clusters::history::Source;
use crate::discovery::Discovery;
use crate::explain::explanation::Question;
use crate::explain::steps::{Largest, NearStep, Step, steps};
use crate::facets::{Facets, Flat};
use crate::neighbours::four_neighbours;
use crate::objectness::hypotheses::Hypothesis;
use crate::outputs::ContextOutputs;
use crate::oversegment::structure::Structure;
use crate::regions::{RegionGraph, SegmentId};
use crate::shapes::border::BorderEvidence;
use crate::shapes::contraction::Shapes;
use crate::shapes::seams::{Seams, Shaped};

/// The fate of every facet in one run of `context`.
pub(super) struct Run {
    pub(super) discovery: Arc<Discovery>,
    /// The facets, borders and shapes before seams cut them.
    before_seams: BeforeSeams,
    pub(super) seams: Arc<Option<Seams>>,
    /// The facets after the gaps between them are filled.
    pub(super) filled: Arc<Facets>,
    /// The surfaces of the structure.
    pub(super) structure: Arc<Structure>,
    clusters: Arc<Clustering>,
    pub(super) steps: Vec<Step>,
    pub(super) near_steps: Vec<NearStep>,
    /// The hypotheses.
    candidates: Arc<Vec<Hypothesis>>,
    /// The index of its hypothesis in `candidates`, for every cluster that is large enough for one.
    hypothesis_of: BTreeMap<SegmentId, usize>,
    /// The first pixel of every facet; `None` for an empty facet.
    first: Vec<Option<usize>>,
    /// The cluster in which every shape ends; `None` = the background.
    owners: Vec<Option<SegmentId>>,
    /// The cluster of every facet that a rule gave to a cluster as its bottom.
    bottom_of: BTreeMap<SegmentId, SegmentId>,
}

/// The facets, borders and shapes before seams cut them, shared.
type BeforeSeams = (Arc<Facets>, Arc<RegionGraph<BorderEvidence>>, Arc<Shapes>);

fn shaped<'a>(seams: &'a Option<Seams>, (facets, borders, shapes): &'a BeforeSeams) -> Shaped<'a> {
    Seams::or(seams, (facets, borders, shapes))
}

impl Run {
    /// Reads the outputs of `context`; `None` when not all stages have run. O(pixels).
    pub(super) fn new(outputs: &ContextOutputs) -> Option<Self> {
        let clusters = outputs.clusters.clone()?;
        let before_seams = (outputs.facets.clone()?, outputs.borders.clone()?, outputs.shapes.clone()?);
        let seams = outputs.seams.clone()?;
        let (_, _, shapes) = shaped(&seams, &before_seams);
        let candidates = outputs.hypotheses.clone()?;
        let (structure, filled) = (outputs.structure.clone()?, outputs.filled.clone()?);
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
        let (steps, near_steps, owners) =
            steps(clusters.history().events().to_vec(), clusters.history().misses().to_vec(), largest);
        let mut run = Self {
            discovery: outputs.discovery.clone()?,
            before_seams,
            seams,
            filled,
            structure,
            clusters,
            steps,
            near_steps,
            candidates: candidates.clone(),
            hypothesis_of: BTreeMap::new(),
            first,
            owners,
            bottom_of: BTreeMap::new(),
        };
        (0..).zip(candidates.iter()).for_each(|(place, hypothesis)| run.look_up(place, hypothesis));
        Some(run)
    }

    /// The facets of stages 2 and 3, before gaps are filled, with their borders and shapes.
    pub(super) fn shaped(&self) -> Shaped<'_> {
        shaped(&self.seams, &self.before_seams)
    }

    /// Finds the cluster of a hypothesis, and the background facets that are its bottom. O(pixels).
    fn look_up(&mut self, place: usize, hypothesis: &Hypothesis) {
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
        self.hypothesis_of.insert(cluster, place);
    }

    /// The number of a facet among the facets outside the structure; `None` for structure.
    pub(super) fn free(&self, facet: SegmentId) -> Option<usize> {
        facet.index().checked_sub(self.filled.structure)
    }

    /// The shape of a facet; `None` for structure. The cluster that began as a shape has the number of the shape.
    pub(super) fn shape(&self, facet: SegmentId) -> Option<SegmentId> {
        self.shaped().2.of_facet.get(self.free(facet)?).map(|&shape| SegmentId(shape))
    }

    /// The final cluster of a facet; `None` = structure or background. A low facet that became the bottom of a vessel belongs to the
    /// vessel.
    pub(super) fn cluster(&self, facet: SegmentId) -> Option<SegmentId> {
        let own = self.owners[self.shape(facet)?.index()];
        own.or_else(|| self.bottom_of.get(&facet).copied())
    }

    /// The object of a facet; 0 = none.
    pub(super) fn object(&self, facet: SegmentId) -> u16 {
        let hypothesis = self.cluster(facet).and_then(|cluster| self.hypothesis(cluster));
        hypothesis.map_or(0, |hypothesis| self.discovery.labels[hypothesis.pixels[0]])
    }

    /// The flat thing in a cluster, if there is one.
    pub(super) fn flat(&self, cluster: SegmentId) -> Option<&Flat> {
        find_flat(&self.filled, &self.clusters.of_facet, cluster)
    }

    /// The number of pixels of a cluster; 0 if it does not remain.
    pub(super) fn size_px(&self, cluster: SegmentId) -> usize {
        self.clusters.size_px(cluster)
    }

    /// The hypothesis of a cluster, if it is large enough.
    pub(super) fn hypothesis(&self, cluster: SegmentId) -> Option<&Hypothesis> {
        self.hypothesis_of.get(&cluster).map(|&place| &self.candidates[place])
    }

    /// The hypothesis that holds a pixel.
    pub(super) fn hypothesis_at(&self, pixel: usize) -> Option<&Hypothesis> {
        let mut held = self.hypothesis_of.values().map(|&place| &self.candidates[place]);
        held.find(|hypothesis| hypothesis.pixels.binary_search(&pixel).is_ok())
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

    /// A question about facets of another run, with the numbers that they have in this run: seams may cut other facets. `None` when a
    /// facet has no pixel in common with any of this run.
    pub(super) fn translated(&self, question: Question, other: &Self) -> Option<Question> {
        let translated = |facet: u32| {
            let pixel = (*other.first.get(facet as usize)?)?;
            self.filled.segments.at(pixel).map(|facet| facet.0)
        };
        Some(match question {
            Question::OneThing { facets: [a, b] } => {
                Question::OneThing { facets: [translated(a)?, translated(b)?] }
            }
            Question::Kept { facet } => Question::Kept { facet: translated(facet)? },
            Question::OfObject { .. } => question,
            Question::Bottom { facet, patch } => Question::Bottom { facet: translated(facet)?, patch },
        })
    }

    /// Whether two facets are one thing: they belong to one shape, or to one cluster that is not background.
    pub(super) fn one_thing(&self, a: SegmentId, b: SegmentId) -> bool {
        let [of_a, of_b] = [a, b].map(|facet| self.cluster(facet));
        self.shape(a) == self.shape(b) || of_a.is_some() && of_a == of_b
    }

    /// The event that gave the patch of background with this first pixel to a vessel.
    fn bottom(&self, patch: usize) -> Option<&Step> {
        let source = Source::Patch(u32::try_from(patch).ok()?);
        self.steps.iter().find(|step| step.event.from == source)
    }

    /// The event that gave the background at a pixel to a vessel. `None` if there is none, as for small holes, which are filled without an
    /// event. O(pixels of the patch).
    pub(super) fn bottom_at(&self, pixel: usize) -> Option<&Step> {
        let hypothesis = self.hypothesis_at(pixel)?;
        let (width, height) = self.discovery.labels.size();
        // Background that belongs to a thing is a bottom, and no two patches touch.
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

    /// The places of the events that gave away the shape of a facet, one after the other. O(events).
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

    /// The event that made two facets of different shapes one thing. O(events).
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
        // Otherwise one of them is the bottom of the other.
        let bottom = |facet: SegmentId| {
            let first = self.bottom_of.contains_key(&facet).then(|| self.first[facet.index()])?;
            self.bottom_at(first?)
        };
        joins.or_else(|| [a, b].into_iter().find_map(bottom))
    }
}
