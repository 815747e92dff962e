//! What is seen in the gap between two pieces.

use std::cmp::Reverse;

use super::HOPELESS;
use super::line::Line;
use super::pieces::Piece;
use crate::objectness::clusters::Clusters;
use crate::random::Lcg;
use crate::regions::SegmentId;

/// Lines of sight through the gap.
const LINES: usize = 60;
/// What is farther than the surface in the gap by so many quanta is seen through it; nearer by so many, hides it.
const SEEN_THROUGH_QUANTA: f64 = 3.0;
const HIDDEN_QUANTA: f64 = 2.0;
/// The surface may be seen through in less than this share of the gap, and is hidden in more than this share.
pub(super) const SEEN_THROUGH_SHARE: f64 = 0.15;
pub(super) const HIDDEN_SHARE: f64 = 0.5;

/// What lies in the gap between two pieces.
pub(super) struct Seen {
    pub(super) hidden: f64,
    pub(super) through: f64,
    /// The facet that hides most.
    pub(super) hider: Option<SegmentId>,
}

/// What is seen along lines from random pixels of one piece to random pixels of the other, as shares of the measured pixels on
/// them that are of neither piece; `None` when it is hopelessly much that is seen through, or little that is hidden, whatever
/// the lines that are left would show.
pub(super) fn look(
    clusters: &Clusters<'_>,
    [a, b]: [&Piece; 2],
    surface: impl Fn([f64; 2]) -> f64,
) -> Option<Seen> {
    let scene = clusters.scene;
    let width = scene.disparity.width();
    let (labels, disparity) = (scene.facets.segments.labels().as_slice(), scene.disparity.as_slice());
    let [own_a, own_b] = [a, b].map(|piece| piece.facet.0 as i32);
    let mut random = Lcg::new(777);
    let lines = [(); LINES].map(|()| {
        let ends = [a, b].map(|piece| piece.pixels[random.below(piece.pixels.len())] as usize);
        Line::between(ends.map(|i| [i % width, i / width].map(|x| x as i64)))
    });
    let mut left = lines.iter().map(|line| line.steps).sum::<usize>();
    let (mut through, mut on, mut hidden) = (0_u32, 0_u32, 0_u32);
    let mut before = vec![0_u32; scene.facets.segments.count()];
    for line in lines {
        left -= line.steps;
        for [u, v] in line {
            let i = v * width + u;
            let (label, d) = (labels[i], f64::from(disparity[i]));
            if (label == own_a) | (label == own_b) | d.is_nan() {
                continue;
            }
            let expected = surface([u as f64, v as f64]);
            if d < expected - SEEN_THROUGH_QUANTA {
                through += 1;
                continue;
            }
            let facet = usize::try_from(label).ok();
            let free = facet.and_then(|facet| facet.checked_sub(scene.facets.structure));
            let cluster = || free.and_then(|free| clusters.of_facet(free));
            let is_own = || cluster().is_some_and(|cluster| cluster == a.cluster || cluster == b.cluster);
            if d <= expected + HIDDEN_QUANTA || is_own() {
                on += 1;
            } else {
                hidden += 1;
                facet.into_iter().for_each(|facet| before[facet] += 1);
            }
        }
        // Were something nearer seen in all that is left.
        let most = f64::from(through + on + hidden) + left as f64;
        let too_much = f64::from(through) > HOPELESS * SEEN_THROUGH_SHARE * most;
        let too_little = f64::from(through + on) > (1.0 - HIDDEN_SHARE / HOPELESS) * most;
        if too_much || too_little {
            return None;
        }
    }
    let share = |part: u32| f64::from(part) / f64::from((through + on + hidden).max(1));
    // The first of equal ones.
    let hider = before.iter().zip(0..).max_by_key(|&(&count, facet)| (count, Reverse(facet)));
    let hider = hider.filter(|(count, _)| **count > 0).map(|(_, facet)| SegmentId(facet));
    Some(Seen { hidden: share(hidden), through: share(through), hider })
}
