//! The history of the clusters: the events of each rule, and its refusals.

use serde::Serialize;

use crate::check::Check;
use crate::discovery::join::Join;
use crate::regions::SegmentId;

/// A rule that joins clusters or gives them to the background.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    /// A small cluster is given to the neighbour that it touches most (docs/CONTEXT.md 4.2).
    Fragment,
    /// A cluster that hardly rises above the support is a part of it (docs/CONTEXT.md 4.3).
    Low,
    /// A cluster that rises no higher above a wall than the sensor's waves is a part of it (docs/CONTEXT.md 4.3).
    Bump,
    /// Two pieces of the inside of a vessel are joined (docs/CONTEXT.md 4.4.1).
    VesselInside,
    /// The inside of a vessel and the wall in front of it are joined (docs/CONTEXT.md 4.4.2).
    VesselWall,
    /// A cluster within the circle of a vessel's rim is a part of it (docs/CONTEXT.md 4.4.2).
    VesselRim,
    /// A small cluster that touches hardly anything but a vessel is a part of it (docs/CONTEXT.md 4.4.3).
    VesselRemainder,
    /// Pieces of one surface of revolution about up are one vessel (docs/CONTEXT.md 4.4.4).
    VesselTurned,
    /// Upright walls around a patch of background are an open box (docs/CONTEXT.md 4.4.6).
    OpenBox,
    /// Thin upright panels of one height that meet at their ends are the walls of a box (docs/CONTEXT.md 4.4.5).
    BoxWalls,
    /// Background, or a flat cluster, that a vessel encloses is its bottom (docs/CONTEXT.md 4.5, 4.4.1).
    VesselBottom,
    /// A surface goes on behind something nearer (docs/CONTEXT.md 4.6).
    Occlusion,
    /// The convex parts of one body are joined across a neck or fold (docs/CONTEXT.md 4.7).
    Neck,
}

impl Rule {
    /// Whether it joins parts of vessels or boxes (docs/CONTEXT.md 4.4, 4.5).
    pub fn is_of_vessels(self) -> bool {
        matches!(
            self,
            Self::VesselInside
                | Self::VesselWall
                | Self::VesselRim
                | Self::VesselRemainder
                | Self::VesselTurned
                | Self::OpenBox
                | Self::BoxWalls
                | Self::VesselBottom
        )
    }
}

/// The cluster or patch that a rule gives away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A cluster.
    Cluster(SegmentId),
    /// A patch of the background, named by its first pixel (its index in scan order).
    Patch(u32),
}

impl Source {
    /// The cluster, if it is one.
    pub fn cluster(self) -> Option<SegmentId> {
        match self {
            Self::Cluster(cluster) => Some(cluster),
            Self::Patch(_) => None,
        }
    }
}

/// A rule gave something to a cluster or to the background. The number of a cluster is the number of the shape from which it grew.
#[derive(Clone, Debug)]
pub struct Event {
    /// The rule.
    pub rule: Rule,
    /// The cluster or patch given away.
    pub from: Source,
    /// The receiving cluster; `None` = the background.
    pub into: Option<SegmentId>,
    /// The checks of the rule; all of them hold.
    pub checks: Vec<Check>,
    /// For parts that do not touch as one surface: the evidence for the join, and the facet that hides the gap, if one does.
    pub(crate) join: Option<(Join, Option<SegmentId>)>,
}

/// Something that a rule examined and refused.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Miss {
    /// The rule.
    pub rule: Rule,
    /// The cluster or patch that the rule would have given away.
    pub from: Source,
    /// The cluster that would have received it; `None` = the background.
    pub into: Option<SegmentId>,
    /// The checks that were made. One of them fails, except for a fragment: all its checks hold if the neighbour that would receive it
    /// is given away in the same round.
    pub checks: Vec<Check>,
}

/// Something that a rule may give away, with the checks made so far.
#[derive(Clone)]
pub(crate) struct Proposal {
    rule: Rule,
    from: Source,
    into: Option<SegmentId>,
    checks: Vec<Check>,
}

impl Proposal {
    pub(crate) fn new(rule: Rule, from: Source, into: Option<SegmentId>) -> Self {
        Self { rule, from, into, checks: Vec::new() }
    }

    /// Records a check and returns whether it holds.
    pub(crate) fn check(&mut self, check: Check) -> bool {
        self.checks.push(check);
        check.holds()
    }

    /// The same proposal for something else.
    pub(crate) fn of(self, from: Source) -> Self {
        Self { from, ..self }
    }

    /// Records checks that were made elsewhere.
    pub(crate) fn extend(&mut self, checks: impl IntoIterator<Item = Check>) {
        self.checks.extend(checks);
    }

    /// The clusters that it would join; `None` when one of the two is the background or a patch of it.
    pub(crate) fn clusters(&self) -> Option<[SegmentId; 2]> {
        Some([self.into?, self.from.cluster()?])
    }

    /// The event that it becomes. `join`: see [`Event::join`].
    pub(crate) fn accept(self, join: Option<(Join, Option<SegmentId>)>) -> Event {
        let Self { rule, from, into, checks } = self;
        Event { rule, from, into, checks, join }
    }

    /// The miss that it becomes.
    pub(crate) fn refuse(self) -> Miss {
        let Self { rule, from, into, checks } = self;
        Miss { rule, from, into, checks }
    }
}

/// The events of the rules on the clusters of a frame, and their refusals.
#[derive(Clone, Debug, Default)]
pub struct History {
    events: Vec<Event>,
    misses: Vec<(usize, Miss)>,
}

impl History {
    /// Records an event and returns its place among the events.
    pub(crate) fn note(&mut self, event: Event) -> usize {
        self.events.push(event);
        self.events.len() - 1
    }

    /// Records the refusals of a rule.
    pub(crate) fn note_misses(&mut self, misses: impl IntoIterator<Item = Miss>) {
        let events = self.events.len();
        self.misses.extend(misses.into_iter().map(|miss| (events, miss)));
    }

    /// The events in order. A cluster that was given away exists again when a later event gives something to it.
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// The refusals, rule by rule, each with the number of events before it.
    pub fn misses(&self) -> &[(usize, Miss)] {
        &self.misses
    }
}
