//! Fragments go to what they touch (METHOD 3.10).

use std::collections::BTreeMap;

use crate::objectness::clusters::Clusters;
use crate::params;
use crate::regions::SegmentId;

/// Rounds; a fragment may lie on a fragment.
const ROUNDS: usize = 3;
/// A fragment goes to what it touches along at least so many pixels (px at a focal length of 525 px).
const LEAST_TOUCH_PX: usize = 4;

/// Merges clusters of fewer than `max_size_px` pixels into the neighbour that they touch most, the background included, smaller ones
/// excluded: folds, rims and the edges of shadows leave crumbs that belong to what they touch.
/// O(rounds · clusters · neighbours).
pub(crate) fn absorb_fragments(clusters: &mut Clusters<'_>, params: &params::Fragments) {
    let space = clusters.scene.space;
    let max_size = space.area_px(params.max_size_px);
    let least_touch = space.length_px(LEAST_TOUCH_PX) as u32;
    for _ in 0..ROUNDS {
        let size = |id: SegmentId| clusters.get(id).pixels.len();
        let mut fragments: Vec<SegmentId> =
            clusters.alive().into_iter().filter(|&id| size(id) < max_size).collect();
        fragments.sort_by_key(|&id| (size(id), id));
        let mut moves: BTreeMap<SegmentId, Option<SegmentId>> = BTreeMap::new();
        for id in fragments {
            let not_smaller = |other: &Option<SegmentId>| other.is_none_or(|other| size(other) >= size(id));
            let neighbours = clusters.get(id).neighbours.iter().filter(|(other, _)| not_smaller(other));
            // The first of those touched most; the background comes first of all.
            let target = neighbours.rev().max_by_key(|(_, borders)| borders.touch);
            if let Some((&target, borders)) = target
                && borders.touch >= least_touch
                && !target.is_some_and(|target| moves.contains_key(&target))
            {
                moves.insert(id, target);
            }
        }
        if moves.is_empty() {
            break;
        }
        for (id, target) in moves {
            clusters.merge(target, id);
        }
    }
}
