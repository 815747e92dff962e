//! One run of the method, and what its stages showed.

use std::collections::BTreeMap;

use crate::discovery::Discovery;
use crate::error::{Error, Result};
use crate::facets::Facets;
use crate::frame::Frame;
use crate::objectness::history::{Event, Miss, Rule};
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
    misses: Vec<Miss>,
    sizes_px: BTreeMap<SegmentId, usize>,
}

impl Observer for Record {
    fn observe(&mut self, stage: Stage<'_>) {
        match stage {
            Stage::Borders { facets, evidence } => self.borders = Some((facets.clone(), evidence.clone())),
            Stage::Clusters { facets, history } => {
                self.filled = Some(facets.clone());
                self.events = history.events().cloned().collect();
                self.misses = history.misses().to_vec();
                self.sizes_px = history.clusters().collect();
            }
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
    pub(super) misses: Vec<Miss>,
    sizes_px: BTreeMap<SegmentId, usize>,
    /// Where every cluster that is no more was given to.
    given: BTreeMap<SegmentId, usize>,
    /// The largest facet of every shape.
    largest: Vec<Option<SegmentId>>,
    /// The object of every cluster that is one.
    object: BTreeMap<SegmentId, u16>,
}

impl Run {
    pub(super) fn new(frame: &Frame, params: &Params) -> Result<Self> {
        let mut record = Record::default();
        let discovery = crate::discover_observed(frame, params, &mut record)?;
        let Record { borders, filled, events, misses, sizes_px } = record;
        let (Some((facets, borders)), Some(filled)) = (borders, filled) else {
            return Err(Error::OnlyContext { method: params.method });
        };
        let shapes = contract(&votes(&borders, facets.structure, &params.contraction));
        let given = events.iter().enumerate().filter_map(|(k, event)| Some((event.from?, k))).collect();
        let mut run = Self {
            discovery,
            facets,
            filled,
            borders,
            shapes,
            events,
            misses,
            sizes_px,
            given,
            largest: Vec::new(),
            object: BTreeMap::new(),
        };
        run.look_up();
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
        let mut largest: Vec<Option<SegmentId>> = vec![None; self.shapes.count];
        for (k, pixel) in first.iter().enumerate() {
            let facet = SegmentId(k as u32);
            let (Some(shape), Some(pixel)) = (self.shape(facet), pixel) else { continue };
            let best = &mut largest[shape.index()];
            if best.is_none_or(|best| sizes[best.index()] < sizes[k]) {
                *best = Some(facet);
            }
            let label = self.discovery.labels[*pixel];
            if let Some(cluster) = self.cluster(facet).filter(|_| label > 0) {
                self.object.insert(cluster, label);
            }
        }
        self.largest = largest;
    }

    /// The number of a facet among those that are no structure.
    pub(super) fn free(&self, facet: SegmentId) -> Option<usize> {
        facet.index().checked_sub(self.filled.structure)
    }

    /// The shape of a facet that is no structure; as a cluster it has the same number.
    pub(super) fn shape(&self, facet: SegmentId) -> Option<SegmentId> {
        self.shapes.of_facet.get(self.free(facet)?).map(|&shape| SegmentId(shape))
    }

    /// What a cluster was made a part of in the end; `None` = the background.
    pub(super) fn owner(&self, mut cluster: SegmentId) -> Option<SegmentId> {
        while let Some(&event) = self.given.get(&cluster) {
            cluster = self.events[event].into?;
        }
        Some(cluster)
    }

    /// The cluster of a facet in the end; `None` = structure or background.
    pub(super) fn cluster(&self, facet: SegmentId) -> Option<SegmentId> {
        self.owner(self.shape(facet)?)
    }

    /// The object of a facet; 0 = none.
    pub(super) fn object(&self, facet: SegmentId) -> u16 {
        self.cluster(facet).and_then(|cluster| self.object.get(&cluster)).copied().unwrap_or(0)
    }

    /// The pixels of a cluster (px); 0 of one that is no more.
    pub(super) fn size_px(&self, cluster: SegmentId) -> usize {
        self.sizes_px.get(&cluster).copied().unwrap_or(0)
    }

    /// The facet that stands for a shape.
    pub(super) fn largest_facet(&self, shape: SegmentId) -> Option<SegmentId> {
        *self.largest.get(shape.index())?
    }

    /// Whether two facets are one thing: parts of one shape, or of one cluster that is not background.
    pub(super) fn one_thing(&self, a: SegmentId, b: SegmentId) -> bool {
        let [of_a, of_b] = [a, b].map(|facet| self.cluster(facet));
        self.shape(a) == self.shape(b) || of_a.is_some() && of_a == of_b
    }

    /// Whether a bottom was given to the thing of a facet.
    pub(super) fn has_bottom(&self, facet: SegmentId) -> bool {
        let cluster = self.cluster(facet);
        let mut bottoms = self.events.iter().filter(|event| event.rule == Rule::VesselBottom);
        cluster.is_some() && bottoms.any(|event| event.into.and_then(|into| self.owner(into)) == cluster)
    }

    /// What gave the shape of a facet on, one after the other.
    pub(super) fn chain(&self, facet: SegmentId) -> Vec<&Event> {
        let mut chain = Vec::new();
        let mut cluster = self.shape(facet);
        while let Some(event) = cluster.and_then(|cluster| self.given.get(&cluster)) {
            let event = &self.events[*event];
            chain.push(event);
            cluster = event.into;
        }
        chain
    }

    /// What made two facets of different shapes one.
    pub(super) fn uniting(&self, a: SegmentId, b: SegmentId) -> Option<&Event> {
        let [of_a, of_b] = [a, b].map(|facet| self.chain(facet));
        let common = |event: &Event, other: &[&Event], shape: Option<SegmentId>| {
            event.into == shape || other.iter().any(|their| their.into == event.into)
        };
        let first = |own: &[&'_ Event], other: &[&Event], shape| {
            own.iter().position(|event| common(event, other, shape))
        };
        // That of a, unless b was given to what a already was.
        match first(&of_a, &of_b, self.shape(b)) {
            Some(k)
                if self.shape(a).is_none_or(|shape| of_b.iter().all(|event| event.into != Some(shape))) =>
            {
                of_a.get(k).copied()
            }
            _ => first(&of_b, &of_a, self.shape(a)).and_then(|k| of_b.get(k).copied()),
        }
    }
}
