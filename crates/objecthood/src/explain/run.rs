//! One run of the method, and what its stages showed.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use crate::discovery::Discovery;
use crate::error::{Error, Result};
use crate::explain::explanation::Question;
use crate::facets::Facets;
use crate::frame::Frame;
use crate::objectness::history::{Event, Miss, Rule};
use crate::objectness::hypotheses::Hypothesis;
use crate::observe::{Observer, Stage};
use crate::params::Params;
use crate::regions::{RegionGraph, SegmentId};
use crate::shapes::border::BorderEvidence;
use crate::shapes::contraction::{Shapes, contract, votes};

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
    pub(super) events: Vec<Event>,
    /// Each with the number of events before it.
    pub(super) misses: Vec<(usize, Miss)>,
    sizes_px: BTreeMap<SegmentId, usize>,
    /// The hypothesis of every cluster that is large enough for one.
    hypotheses: BTreeMap<SegmentId, Hypothesis>,
    /// The largest facet of every shape, and its pixels (px).
    largest: Vec<Option<(usize, SegmentId)>>,
    /// The object of every cluster that is one.
    object: BTreeMap<SegmentId, u16>,
    /// The cluster of every facet that was given to one as its bottom.
    bottom_of: BTreeMap<SegmentId, SegmentId>,
}

impl Run {
    pub(super) fn new(frame: &Frame, params: &Params) -> Result<Self> {
        let mut record = Record::default();
        let discovery = crate::discover_observed(frame, params, &mut record)?;
        let Record { borders, filled, events, misses, sizes_px, hypotheses } = record;
        let (Some((facets, borders)), Some(filled)) = (borders, filled) else {
            return Err(Error::OnlyContext { method: params.method });
        };
        let shapes = contract(&votes(&borders, facets.structure, &params.contraction));
        let mut run = Self {
            discovery,
            facets,
            filled,
            borders,
            shapes,
            events,
            misses,
            sizes_px,
            hypotheses: BTreeMap::new(),
            largest: Vec::new(),
            object: BTreeMap::new(),
            bottom_of: BTreeMap::new(),
        };
        run.look_up();
        for hypothesis in hypotheses {
            let mut facets = hypothesis.pixels.iter().filter_map(|&i| run.filled.segments.at(i));
            if let Some(cluster) = facets.find_map(|facet| run.cluster(facet)) {
                run.hypotheses.insert(cluster, hypothesis);
            }
        }
        Ok(run)
    }

    /// Finds the largest facet of every shape, and the object of every cluster.
    fn look_up(&mut self) {
        let mut sizes = vec![0_usize; self.filled.segments.count()];
        let mut first = vec![None; sizes.len()];
        for (i, facet) in self.filled.segments.members() {
            sizes[facet] += 1;
            first[facet].get_or_insert(i);
        }
        let mut bottoms = Vec::new();
        let mut largest: Vec<Option<(usize, SegmentId)>> = vec![None; self.shapes.count];
        for (k, pixel) in first.iter().enumerate() {
            let facet = SegmentId(k as u32);
            let (Some(shape), Some(pixel)) = (self.shape(facet), pixel) else { continue };
            let best = &mut largest[shape.index()];
            if best.is_none_or(|(most, _)| most < sizes[k]) {
                *best = Some((sizes[k], facet));
            }
            let label = self.discovery.labels[*pixel];
            match self.owner(shape, 0) {
                Some(cluster) if label > 0 => drop(self.object.insert(cluster, label)),
                None if label > 0 => bottoms.push((facet, label)),
                _ => {}
            }
        }
        self.largest = largest;
        let owner = |label: u16| self.object.iter().find(|(_, object)| **object == label).map(|(id, _)| *id);
        self.bottom_of =
            bottoms.into_iter().filter_map(|(facet, label)| Some((facet, owner(label)?))).collect();
    }

    /// The number of a facet among those that are no structure.
    pub(super) fn free(&self, facet: SegmentId) -> Option<usize> {
        facet.index().checked_sub(self.filled.structure)
    }

    /// The shape of a facet that is no structure; as a cluster it has the same number.
    pub(super) fn shape(&self, facet: SegmentId) -> Option<SegmentId> {
        self.shapes.of_facet.get(self.free(facet)?).map(|&shape| SegmentId(shape))
    }

    /// What was done with a cluster that was there after so many events: the places of the events.
    fn chain_from(&self, cluster: SegmentId, after: usize) -> Vec<usize> {
        let mut own = Some(cluster);
        let mut chain = Vec::new();
        for (k, event) in self.events.iter().enumerate().skip(after) {
            if own.is_some() && event.from == own {
                own = event.into;
                chain.push(k);
            }
        }
        chain
    }

    /// What a cluster that was there after so many events was made a part of in the end; `None` = the background.
    pub(super) fn owner(&self, cluster: SegmentId, after: usize) -> Option<SegmentId> {
        let last = self.chain_from(cluster, after).pop();
        last.map_or(Some(cluster), |last| self.events[last].into)
    }

    /// The cluster in which ends what an event gave away; `None` = the background.
    pub(super) fn owner_of_event(&self, event: usize) -> Option<SegmentId> {
        self.owner(self.events[event].into?, event + 1)
    }

    /// The facet that stands for a cluster that was there after so many events: the largest.
    pub(super) fn largest_facet(&self, cluster: SegmentId, after: usize) -> Option<SegmentId> {
        let is_part = |shape: SegmentId| {
            let then = self.chain_from(shape, 0).into_iter().take_while(|k| *k < after).last();
            then.map_or(Some(shape), |last| self.events[last].into) == Some(cluster)
        };
        let shapes = (0..self.shapes.count as u32).map(SegmentId).filter(|&shape| is_part(shape));
        shapes
            .filter_map(|shape| self.largest[shape.index()])
            .max_by_key(|&(size_px, facet)| (size_px, Reverse(facet)))
            .map(|(_, facet)| facet)
    }

    /// The cluster of a facet in the end; `None` = structure or background. What lay low and then turned out to be the bottom of a
    /// vessel is of the vessel.
    pub(super) fn cluster(&self, facet: SegmentId) -> Option<SegmentId> {
        let own = self.owner(self.shape(facet)?, 0);
        own.or_else(|| self.bottom_of.get(&facet).copied())
    }

    /// The object of a facet; 0 = none.
    pub(super) fn object(&self, facet: SegmentId) -> u16 {
        self.cluster(facet).and_then(|cluster| self.object.get(&cluster)).copied().unwrap_or(0)
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
            Question::Bottom { facet } => self.has_bottom(SegmentId(facet)),
        }
    }

    /// Whether two facets are one thing: parts of one shape, or of one cluster that is not background.
    pub(super) fn one_thing(&self, a: SegmentId, b: SegmentId) -> bool {
        let [of_a, of_b] = [a, b].map(|facet| self.cluster(facet));
        self.shape(a) == self.shape(b) || of_a.is_some() && of_a == of_b
    }

    /// Whether a bottom was given to the thing of a facet.
    pub(super) fn has_bottom(&self, facet: SegmentId) -> bool {
        let cluster = self.cluster(facet);
        let mut bottoms = (0..self.events.len()).filter(|&k| self.events[k].rule == Rule::VesselBottom);
        cluster.is_some() && bottoms.any(|k| self.owner_of_event(k) == cluster)
    }

    /// What gave the shape of a facet on, one after the other.
    pub(super) fn chain(&self, facet: SegmentId) -> Vec<usize> {
        self.shape(facet).map(|shape| self.chain_from(shape, 0)).unwrap_or_default()
    }

    /// What made two facets of different shapes one: the event after which they were.
    pub(super) fn uniting(&self, a: SegmentId, b: SegmentId) -> Option<usize> {
        let mut own = [a, b].map(|facet| self.shape(facet));
        let joins = self.events.iter().position(|event| {
            let before = own;
            for own in &mut own {
                if own.is_some() && event.from == *own {
                    *own = event.into;
                }
            }
            own != before && own[0].is_some() && own[0] == own[1]
        });
        // Else one of them is the bottom of the other.
        let cluster = self.cluster(a);
        let is_bottom =
            |k: &usize| self.events[*k].rule == Rule::VesselBottom && self.owner_of_event(*k) == cluster;
        joins.or_else(|| (0..self.events.len()).find(is_bottom))
    }
}
