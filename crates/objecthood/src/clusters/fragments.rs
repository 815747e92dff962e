//! Gives fragments to the neighbour that they touch most (docs/CONTEXT.md 4.2).
//!
//! Folds, rims and the edges of shadows leave small clusters that belong to the surface beside them.

use std::collections::BTreeMap;

use crate::check::{Bound, Check};
use crate::clusters::borders::BorderCounts;
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Event, Miss, Proposal, Rule, Source};
use crate::params;
use crate::regions::SegmentId;
use crate::surface::disparity::DisparitySpace;

/// Rounds of absorption: fragments may lie on fragments.
const ROUNDS: usize = 3;
/// Touching pixel pairs that a fragment needs to be absorbed by a neighbour (px at a focal length of 525 px).
const LEAST_TOUCH_PX: usize = 4;
/// A fragment of at least this many pixels (px at 525 px), the default of `objectness.min_size_px`, may be a thing ...
const LEAST_THING_PX: usize = 200;
/// ... if at this share of its border it is in front by a step: an upright thing touches its support only with its foot.
const IN_FRONT_SHARE: f64 = 0.6;

/// Merges clusters of fewer than `max_size_px` pixels, except flat things, into the neighbour that they touch
/// most. The neighbour may be the background, but not a smaller cluster. A fragment does not go to the
/// background if it is large enough for a thing and mostly in front of its surroundings. O(rounds · clusters
/// · neighbours).
pub(crate) fn absorb_fragments(clusters: &mut Clusters<'_>, params: &params::Fragments) {
    for round in 1..=ROUNDS {
        let (moves, stays) = find_moves(clusters, params);
        let is_last = moves.is_empty() || round == ROUNDS;
        moves.into_iter().for_each(|event| clusters.give(event));
        if is_last {
            clusters.history.note_misses(stays);
            break;
        }
    }
}

/// The fragments that move in a round, by ascending number, and the fragments that stay. The smallest are decided first. None moves
/// to a fragment whose own move was decided before it, so that two of equal size cannot move into each other.
fn find_moves(clusters: &Clusters<'_>, params: &params::Fragments) -> (Vec<Event>, Vec<Miss>) {
    let space = clusters.scene.space;
    let least_touch = space.length_px(LEAST_TOUCH_PX) as f64;
    let least_thing = space.area_px(LEAST_THING_PX);
    let size = |id: SegmentId| clusters.get(id).pixels.len();
    let is_small =
        |id: SegmentId| check_small(size(id), space, params).holds() && clusters.flat(id).is_none();
    let mut fragments: Vec<SegmentId> = clusters.alive().into_iter().filter(|&id| is_small(id)).collect();
    fragments.sort_by_key(|&id| (size(id), id));
    let mut moves: BTreeMap<SegmentId, Event> = BTreeMap::new();
    let mut stays = Vec::new();
    for id in fragments {
        let not_smaller = |other: &Option<SegmentId>| other.is_none_or(|other| size(other) >= size(id));
        let neighbours = clusters.get(id).neighbours.iter().filter(|(other, _)| not_smaller(other));
        // On ties the first neighbour wins: the background, else the cluster with the smallest number.
        let most_touched = neighbours.rev().max_by_key(|(_, borders)| borders.touch);
        let Some((&into, borders)) = most_touched else { continue };
        let touch = f64::from(borders.touch);
        let mut merge = Proposal::new(Rule::Fragment, Source::Cluster(id), into);
        let moves_on = merge.check(check_small(size(id), space, params))
            && merge.check(Check::new("touches it along", "px", touch, Bound::AtLeast, least_touch))
            && (into.is_some()
                || size(id) < least_thing
                || merge.check(check_not_in_front(&clusters.get(id).neighbours)))
            && !into.is_some_and(|into| moves.contains_key(&into));
        if moves_on {
            moves.insert(id, merge.accept(None));
        } else {
            stays.push(merge.refuse());
        }
    }
    (moves.into_values().collect(), stays)
}

/// Checks that a cluster of `size_px` pixels is small enough to be a fragment.
pub(crate) fn check_small(size_px: usize, space: &DisparitySpace, params: &params::Fragments) -> Check {
    let limit = space.area_px(params.max_size_px) as f64;
    Check::new("its pixels", "px", size_px as f64, Bound::Below, limit).set_by("fragments.max_size_px")
}

/// Checks that a fragment is in front of what is around it at too little of its border for a thing of its own.
fn check_not_in_front(neighbours: &BTreeMap<Option<SegmentId>, BorderCounts>) -> Check {
    let count = |of: fn(&BorderCounts) -> u32| neighbours.values().map(of).sum::<u32>();
    let share = f64::from(count(|border| border.in_front)) / f64::from(count(BorderCounts::all).max(1));
    Check::new("share of its border that stands out in front", "", share, Bound::Below, IN_FRONT_SHARE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::testing::{Table, named, single};

    /// The final cluster of each of the facets a, b, ..
    fn absorbed(rows: &[&str], heights_m: &[f64], max_size_px: usize) -> Vec<Option<u32>> {
        let table = Table::drawn(rows, heights_m);
        let scene = table.scene();
        let mut clusters = single(&scene);
        absorb_fragments(&mut clusters, &params::Fragments { max_size_px });
        named(&clusters)
    }

    #[test]
    fn a_fragment_goes_to_what_it_touches_most() {
        let rows = [
            "____________________", //
            "_aaaaaaaacccccbbbb__",
            "_aaaaaaaacccccbbbb__",
            "_aaaaaaaacccccbbbb__",
            "_aaaaaaaacccccbbbb__",
            "_aaaaaaaacccccbbbb__",
            "_aaaaaaaabbbbbbbbb__",
            "_aaaaaaaabbbbbbbbb__",
            "____________________",
        ];
        assert_eq!(absorbed(&rows, &[0.1, 0.1, 0.1], 30), [Some(0), Some(1), Some(1)]);
        // With b on another level, c touches only a.
        assert_eq!(absorbed(&rows, &[0.1, 0.2, 0.1], 30), [Some(0), Some(1), Some(0)]);
        // Alone on its level it touches nothing.
        assert_eq!(absorbed(&rows, &[0.1, 0.1, 0.2], 30), [Some(0), Some(1), Some(2)]);
        // A large cluster stays.
        assert_eq!(absorbed(&rows, &[0.1, 0.1, 0.1], 25), [Some(0), Some(1), Some(2)]);
    }

    #[test]
    fn ties_go_to_the_first() {
        let rows = ["aaaaaaaaaa", "aaaaaaaaaa", "cccccccc..", "bbbbbbbbbb", "bbbbbbbbbb"];
        assert_eq!(absorbed(&rows, &[0.1, 0.1, 0.1], 10), [Some(0), Some(1), Some(0)]);
        // Of two fragments of equal size the first moves and the second stays.
        assert_eq!(absorbed(&["aaaa", "bbbb"], &[0.1, 0.1], 10), [Some(1), Some(1)]);
    }

    #[test]
    fn a_crumb_on_the_table_is_a_part_of_it() {
        let rows = ["________", "__aaaa__", "__aaaa__", "________"];
        assert_eq!(absorbed(&rows, &[0.002], 30), [None]);
        // Four touching pairs suffice, three do not.
        assert_eq!(absorbed(&["aaaa", "____"], &[0.002], 30), [None]);
        assert_eq!(absorbed(&["aaa.", "____"], &[0.002], 30), [Some(0)]);
    }

    /// Bottles at the far side of a table were lost: 280 px in front of the wall, and a foot that touches the table.
    #[test]
    fn what_touches_the_table_with_its_foot_alone_is_no_crumb() {
        // 20 x `rows` pixels that rise to the right from the table, on which they begin.
        let alone = |rows: usize, rise_m: f64| {
            let inside = |u: usize, v: usize| (10..30).contains(&u) && (10..10 + rows).contains(&v);
            let at = |u, v| Some(if inside(u, v) { (1, (u - 9) as f64 * rise_m) } else { (0, 0.0) });
            let table = Table::new((40, 40), at);
            let scene = table.scene();
            let mut clusters = single(&scene);
            absorb_fragments(&mut clusters, &params::Fragments { max_size_px: 300 });
            named(&clusters)
        };
        assert_eq!(alone(12, 0.005), [Some(0)]);
        assert_eq!(alone(12, 0.0002), [None], "it lies flat");
        assert_eq!(alone(9, 0.005), [None], "180 px are too few for a thing");
    }

    #[test]
    fn no_fragment_goes_to_a_smaller_one_but_smaller_ones_may_come_along() {
        // c touches only b, b touches a and c.
        let rows = ["aaaaaaaa", "aaaaaaaa", "bbbbbb..", "cccc...."];
        assert_eq!(absorbed(&rows, &[0.1, 0.1, 0.1], 10), [Some(0), Some(0), Some(0)]);
        let rows = ["aaaaaa", "aaaaaa", "bbbbb."];
        assert_eq!(absorbed(&rows, &[0.1, 0.1], 100), [Some(0), Some(0)], "the larger one stays");
    }
}
