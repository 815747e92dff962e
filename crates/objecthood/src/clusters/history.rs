//! The history of the clusters: what each rule did, and what it refused.

use serde::Serialize;

use crate::clusters::check::Check;
use crate::discovery::join::Join;
use crate::regions::SegmentId;

/// A rule that joins clusters or gives them to the background.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    /// A small cluster goes to what it touches (docs/CONTEXT.md 4.2).
    Fragment,
    /// A cluster that hardly rises above the support is a part of it (docs/CONTEXT.md 4.3).
    Low,
    /// Two pieces of the inside of a vessel are joined (docs/CONTEXT.md 4.4.1).
    VesselInside,
    /// The inside of a vessel and the wall in front of it are joined (docs/CONTEXT.md 4.4.2).
    VesselWall,
    /// What stands within the circle of a vessel's rim is a part of it (docs/CONTEXT.md 4.4.2).
    VesselRim,
    /// What touches hardly anything but a vessel is a part of it (docs/CONTEXT.md 4.4.3).
    VesselRemainder,
    /// Background that a vessel encloses is its bottom (ours).
    VesselBottom,
    /// A surface goes on behind something nearer (docs/CONTEXT.md 4.6).
    Occlusion,
}

/// What a rule gives away.
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

/// Something was given to a cluster or to the background. The number of a cluster is that of the shape that it began as.
#[derive(Clone, Debug)]
pub struct Event {
    /// The rule.
    pub rule: Rule,
    /// What was given.
    pub from: Source,
    /// What it was given to; `None` = the background.
    pub into: Option<SegmentId>,
    /// The checks of the rule; all of them hold.
    pub checks: Vec<Check>,
    /// For parts that do not touch as one surface: why they are one, and the facet that hides the gap, if one does.
    pub(crate) join: Option<(Join, Option<SegmentId>)>,
}

/// Something that a rule looked at and refused.
#[derive(Clone, Debug)]
pub struct Miss {
    /// The rule.
    pub rule: Rule,
    /// What it would have given away.
    pub from: Source,
    /// What it would have been given to; `None` = the background.
    pub into: Option<SegmentId>,
    /// The checks up to the first that fails. All hold if the two were one already.
    pub checks: Vec<Check>,
}

/// Something that a rule may give away, with the checks so far.
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

    /// Notes a check and says whether it holds.
    pub(crate) fn check(&mut self, check: Check) -> bool {
        self.checks.push(check);
        check.holds()
    }

    /// Notes checks that were made elsewhere.
    pub(crate) fn extend(&mut self, checks: impl IntoIterator<Item = Check>) {
        self.checks.extend(checks);
    }

    /// The clusters that it would join; `None` when one is the background or a patch of it.
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

/// What the rules did with the clusters of a frame, and what they refused.
#[derive(Clone, Debug, Default)]
pub struct History {
    events: Vec<Event>,
    misses: Vec<(usize, Miss)>,
}

impl History {
    /// Notes an event and returns its place among the events.
    pub(crate) fn note(&mut self, event: Event) -> usize {
        self.events.push(event);
        self.events.len() - 1
    }

    /// Notes what a rule refused.
    pub(crate) fn note_misses(&mut self, misses: impl IntoIterator<Item = Miss>) {
        let events = self.events.len();
        self.misses.extend(misses.into_iter().map(|miss| (events, miss)));
    }

    /// What was given to what, in order. A cluster that was given away may be there again later, when something is given to it.
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// What rules refused, rule by rule, each with the number of events before it.
    pub fn misses(&self) -> &[(usize, Miss)] {
        &self.misses
    }
}
