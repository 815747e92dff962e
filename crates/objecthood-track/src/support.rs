//! What holds a thing, over time.

use objecthood::discovery::{NodeKind, SupportKind};
use objecthood::{Discovery, ObjectId};
use serde::{Deserialize, Serialize};

use crate::pace::Pace;
use crate::tracked::Relation;

/// Earlier frames are forgotten with this time constant (s).
const VOTES_S: f64 = 0.32;

/// What holds a thing: a track, or something that is not followed.
pub(crate) type Parent = Option<u32>;

/// Votes of frames for what holds a thing.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Votes {
    candidates: Vec<(Parent, Relation, f32)>,
}

impl Votes {
    pub(crate) fn add(&mut self, parent: Parent, relation: Relation, pace: Pace) {
        let earlier = libm::exp(-pace.frame_s / VOTES_S) as f32;
        self.candidates.iter_mut().for_each(|candidate| candidate.2 *= earlier);
        match self.candidates.iter_mut().find(|candidate| (candidate.0, candidate.1) == (parent, relation)) {
            Some(candidate) => candidate.2 += 1.0,
            None => self.candidates.push((parent, relation, 1.0)),
        }
        self.candidates.retain(|candidate| candidate.2 > 0.05);
    }

    pub(crate) fn clear(&mut self) {
        self.candidates.clear();
    }

    /// Whether any frame that still counts voted for it.
    pub(crate) fn says(&self, parent: Parent, relation: Relation) -> bool {
        self.candidates.iter().any(|candidate| (candidate.0, candidate.1) == (parent, relation))
    }

    /// The one with the most votes; of equals the one that got a vote first.
    pub(crate) fn winner(&self) -> Option<(Parent, Relation)> {
        let mut best: Option<&(Parent, Relation, f32)> = None;
        for candidate in &self.candidates {
            if best.is_none_or(|best| candidate.2 > best.2) {
                best = Some(candidate);
            }
        }
        best.map(|&(parent, relation, _)| (parent, relation))
    }
}

/// What holds an object in a frame, and how: another of its objects, or structure. The surest edge counts.
pub(crate) fn carrier(found: &Discovery, object: usize) -> Option<(Option<ObjectId>, Relation)> {
    let node = found.objects[object].node;
    let below = found.support.edges.iter().filter(|edge| edge.upper == node);
    let mut best = None;
    for edge in below {
        if best.is_none_or(|best: &objecthood::discovery::SupportEdge| edge.confidence > best.confidence) {
            best = Some(edge);
        }
    }
    let edge = best?;
    let parent = match found.support.nodes.get(edge.lower.0 as usize)?.kind {
        NodeKind::Object { object } => Some(object),
        NodeKind::Surface | NodeKind::Structure { .. } => None,
    };
    let relation = match edge.kind {
        SupportKind::On => Relation::On,
        SupportKind::In => Relation::In,
        SupportKind::Leans => Relation::Leans,
    };
    Some((parent, relation))
}
