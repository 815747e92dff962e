//! The events and misses of clusters, with the facets involved at the time and the clusters in the end.

use std::cmp::Reverse;

use crate::clusters::history::{Event, Miss, Source};
use crate::regions::SegmentId;

/// An event, with the facets that it was about and its result.
pub(super) struct Step {
    pub(super) event: Event,
    /// The largest facets of the receiver and of the gift, before the event.
    pub(super) facets: Pair,
    /// The final cluster of the gift; `None` = the background.
    pub(super) owner: Option<SegmentId>,
}

/// A miss, with the facets that it was about and their results.
pub(super) struct NearStep {
    pub(super) miss: Miss,
    pub(super) facets: Pair,
    /// The final clusters of both.
    pub(super) owners: Pair,
}

/// One entry for the receiver, one for the gift.
type Pair = [Option<SegmentId>; 2];

/// The number of pixels of the largest facet, and the facet; on ties the first one.
pub(super) type Largest = Option<(usize, Reverse<SegmentId>)>;

/// Describes all events and misses, and finds the final cluster of every shape: once forwards and once backwards through the events,
/// O(events + misses + shapes).
///
/// `largest`: the largest facet of every shape. `misses`: in the order of the events.
pub(super) fn steps(
    events: Vec<Event>,
    misses: Vec<(usize, Miss)>,
    mut largest: Vec<Largest>,
) -> (Vec<Step>, Vec<NearStep>, Vec<Option<SegmentId>>) {
    let mut owners: Vec<Option<SegmentId>> = (0..largest.len() as u32).map(|k| Some(SegmentId(k))).collect();
    let mut near_steps: Vec<NearStep> = Vec::with_capacity(misses.len());
    let mut steps: Vec<Step> = Vec::with_capacity(events.len());
    let afters: Vec<usize> = misses.iter().map(|(after, _)| *after).collect();
    let mut misses = misses.into_iter().peekable();
    let mut events = events.into_iter();
    loop {
        let facet = |cluster: Option<SegmentId>| {
            cluster.and_then(|cluster| largest[cluster.index()]).map(|(_, Reverse(facet))| facet)
        };
        while let Some((_, miss)) = misses.next_if(|(after, _)| *after <= steps.len()) {
            let facets = [miss.into, miss.from.cluster()].map(facet);
            near_steps.push(NearStep { miss, facets, owners: [None; 2] });
        }
        let Some(event) = events.next() else { break };
        let [into, from] = [event.into, event.from.cluster()];
        let facets = [into, from].map(facet);
        let given = from.and_then(|from| largest[from.index()].take());
        if let Some(into) = into {
            let largest = &mut largest[into.index()];
            *largest = (*largest).max(given);
        }
        steps.push(Step { event, facets, owner: None });
    }

    let mut left = near_steps.iter_mut().zip(afters).rev().peekable();
    for k in (0..=steps.len()).rev() {
        let owner = |cluster: Option<SegmentId>| cluster.and_then(|cluster| owners[cluster.index()]);
        while let Some((near, _)) = left.next_if(|(_, after)| *after >= k) {
            near.owners = [near.miss.into, near.miss.from.cluster()].map(owner);
        }
        let Some(before) = k.checked_sub(1) else { break };
        let Step { event, owner: of_step, .. } = &mut steps[before];
        *of_step = owner(event.into);
        if let Source::Cluster(from) = event.from {
            owners[from.index()] = *of_step;
        }
    }
    (steps, near_steps, owners)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::clusters::history::Rule;

    const CLUSTERS: u32 = 6;

    /// The final cluster of a cluster that exists after `after` events, found event by event.
    fn owner(events: &[Event], mut own: Option<SegmentId>, after: usize) -> Option<SegmentId> {
        for event in &events[after..] {
            if own.is_some() && event.from.cluster() == own {
                own = event.into;
            }
        }
        own
    }

    /// The largest facet of a cluster after `after` events. Facet 10 + k is the only facet of shape k.
    fn largest(
        events: &[Event],
        sizes: &[usize],
        cluster: Option<SegmentId>,
        after: usize,
    ) -> Option<SegmentId> {
        let is_part = |shape: &u32| owner(&events[..after], Some(SegmentId(*shape)), 0) == cluster;
        let shapes = (0..CLUSTERS).filter(|shape| cluster.is_some() && is_part(shape));
        let shape = shapes.max_by_key(|&shape| (sizes[shape as usize], Reverse(shape)));
        shape.map(|shape| SegmentId(10 + shape))
    }

    fn event((from, into): (u32, u32)) -> Event {
        // The number after the last cluster stands for the background.
        let cluster = |k: u32| (k < CLUSTERS).then_some(SegmentId(k));
        let from = cluster(from).map_or(Source::Patch(from), Source::Cluster);
        Event { rule: Rule::Fragment, from, into: cluster(into), checks: Vec::new(), join: None }
    }

    proptest! {
        #[test]
        fn one_pass_each_way_says_what_following_every_event_does(
            pairs in prop::collection::vec((0..=CLUSTERS, 0..=CLUSTERS), 0..12),
            missed in prop::collection::vec((0..13_usize, 0..=CLUSTERS, 0..=CLUSTERS), 0..12),
            sizes in prop::collection::vec(1..4_usize, CLUSTERS as usize),
        ) {
            let events: Vec<Event> =
                pairs.into_iter().filter(|(from, into)| from != into).map(event).collect();
            let mut misses: Vec<(usize, Miss)> = missed
                .into_iter()
                .map(|(after, from, into)| {
                    let Event { rule, from, into, checks, .. } = event((from, into));
                    (after.min(events.len()), Miss { rule, from, into, checks })
                })
                .collect();
            misses.sort_by_key(|(after, _)| *after);
            let facets = (0..CLUSTERS).map(|k| Some((sizes[k as usize], Reverse(SegmentId(10 + k)))));
            let (steps, near_steps, owners) = steps(events.clone(), misses.clone(), facets.collect());

            for (k, own) in owners.into_iter().enumerate() {
                prop_assert_eq!(own, owner(&events, Some(SegmentId(k as u32)), 0));
            }
            for (k, step) in steps.iter().enumerate() {
                let about = [step.event.into, step.event.from.cluster()];
                prop_assert_eq!(step.owner, owner(&events, step.event.into, k + 1));
                prop_assert_eq!(step.facets, about.map(|cluster| largest(&events, &sizes, cluster, k)));
            }
            prop_assert_eq!(near_steps.len(), misses.len());
            for (near, (after, miss)) in near_steps.iter().zip(&misses) {
                let about = [miss.into, miss.from.cluster()];
                prop_assert_eq!(near.owners, about.map(|cluster| owner(&events, cluster, *after)));
                prop_assert_eq!(near.facets, about.map(|cluster| largest(&events, &sizes, cluster, *after)));
            }
        }
    }
}
