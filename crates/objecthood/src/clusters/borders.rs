//! How clusters lie to each other in the image.

use std::ops::{AddAssign, Range};

use rayon::prelude::*;

use crate::clusters::scene::{Scene, Steps};
use crate::facets::Facets;
use crate::regions::{RegionGraph, SegmentId};
use crate::shapes::contraction::Shapes;

/// How two clusters lie to each other in the image: pairs of neighbouring pixels, also across a gap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Borders {
    /// Next to each other without a step in depth.
    pub touch: u32,
    /// The same across a gap.
    pub level: u32,
    /// This one before the other.
    pub in_front: u32,
    /// The other before this one.
    pub behind: u32,
}

/// Pixels farther apart in a row or column (px at a focal length of 525 px) are no neighbours.
pub(crate) const REACH_PX: usize = 24;
impl AddAssign for Borders {
    fn add_assign(&mut self, other: Self) {
        self.touch += other.touch;
        self.level += other.level;
        self.in_front += other.in_front;
        self.behind += other.behind;
    }
}

impl Borders {
    /// As the other cluster sees it.
    pub(crate) fn mirrored(self) -> Self {
        Self { in_front: self.behind, behind: self.in_front, ..self }
    }
}

/// How any two clusters lie to each other; region 0 is the background, region k + 1 is cluster k. Neighbours in a row or column
/// are those with nothing but holes between them. O(pixels + border pixels · log of them).
pub(crate) fn lie_of_clusters(scene: &Scene<'_>, shapes: &Shapes) -> RegionGraph<Borders> {
    let width = scene.facets.segments.labels().width();
    // A strip for each thread: pairs are counted, so it does not matter which comes first.
    let columns = width.div_ceil(rayon::current_num_threads());
    let strips: Vec<Range<usize>> =
        (0..width).step_by(columns).map(|left| left..width.min(left + columns)).collect();
    let met: Vec<Vec<Meeting>> = strips.into_par_iter().map(|strip| meetings(scene, shapes, strip)).collect();
    let add = |sum: &mut Borders, borders| *sum += borders;
    RegionGraph::gather(shapes.count + 1, met.into_iter().flatten(), add)
}

/// How two regions lie to each other at some pairs of pixels.
type Meeting = (SegmentId, SegmentId, Borders);

/// Where regions meet above each other in these columns, or side by side, the right one in these columns.
fn meetings(scene: &Scene<'_>, shapes: &Shapes, strip: Range<usize>) -> Vec<Meeting> {
    /// What was seen last in a row or column: the region, and where.
    #[derive(Clone, Copy)]
    struct Last {
        region: u32,
        pixel: usize,
    }
    let Facets { segments, structure, .. } = scene.facets;
    let width = segments.labels().width();
    let Steps { touch_quanta, level_quanta } = scene.steps;
    let reach = scene.space.length_px(REACH_PX);
    let region = |facet: usize| facet.checked_sub(*structure).map_or(0, |shape| shapes.of_facet[shape] + 1);
    let mut met: Vec<Meeting> = Vec::new();
    // Two regions that meet at pixels so many steps apart.
    let mut meet = |a: Last, b: Last, apart: usize| {
        if a.region == b.region || apart > reach {
            return;
        }
        let [d_a, d_b] = [a, b].map(|last| scene.disparity[last.pixel]);
        let rise = if a.region < b.region { d_a - d_b } else { d_b - d_a };
        let borders = match (rise.abs(), apart) {
            (step, 1) if step <= touch_quanta => Borders { touch: 1, ..Default::default() },
            (step, _) if step <= level_quanta => Borders { level: 1, ..Default::default() },
            _ if rise > 0.0 => Borders { in_front: 1, ..Default::default() },
            _ => Borders { behind: 1, ..Default::default() },
        };
        let [a, b] = [a, b].map(|last| SegmentId(last.region));
        // Along a row the same two often meet again, and then are sorted once.
        match met.last_mut() {
            Some((last_a, last_b, sum)) if (*last_a, *last_b) == (a, b) => *sum += borders,
            _ => met.push((a, b, borders)),
        }
    };
    let mut left: Option<Last> = None;
    // Column by column of the strip: the region, and the row.
    let mut above: Vec<u32> = vec![NOTHING; strip.len()];
    let mut row_of_above = vec![0; strip.len()];
    for (run, facet) in segments.runs() {
        let (own, v) = (region(facet), run.start / width);
        let at = |pixel: usize| Last { region: own, pixel };
        let (first, end) = (run.start - v * width, run.end - v * width);
        if let Some(left) = left.filter(|left| left.pixel / width == v && strip.contains(&first)) {
            meet(left, at(run.start), run.start - left.pixel);
        }
        left = Some(at(run.end - 1));
        let (first, end) = (first.max(strip.start), end.min(strip.end));
        if first >= end {
            continue;
        }
        let lanes = first - strip.start..end - strip.start;
        let seen = above[lanes.clone()].iter().zip(&row_of_above[lanes.clone()]);
        for (u, (&region, &row)) in (first..end).zip(seen) {
            if region != own && region != NOTHING {
                meet(Last { region, pixel: row * width + u }, at(v * width + u), v - row);
            }
        }
        above[lanes.clone()].fill(own);
        row_of_above[lanes].fill(v);
    }
    met
}

/// Of no region.
const NOTHING: u32 = u32::MAX;

#[cfg(test)]
mod tests {
    use crate::clusters::testing::{Table, single};
    use crate::regions::SegmentId;

    #[test]
    fn borders_are_counted_alike_on_any_number_of_threads() {
        // Wider than there are threads, with holes that strips cut.
        let rows = ["aaaa..bbbb_cc", "aa..bb.bb__cc", "d.........ccc", "dddd__aaa_a_a"];
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let table = Table::drawn(&rows, &[0.1, 0.11, 0.3, 0.2]);
                let scene = table.scene();
                let clusters = single(&scene);
                let neighbours = |id: SegmentId| clusters.get(id).neighbours.clone();
                clusters.alive().into_iter().map(neighbours).collect::<Vec<_>>()
            })
        };
        assert!([2, 3, 5, 16].into_iter().all(|threads| on(threads) == on(1)));
    }

    #[test]
    fn what_lies_far_apart_is_no_neighbour() {
        for (holes, is_near) in [(0, true), (23, true), (24, false)] {
            let row = format!("a{}b", ".".repeat(holes));
            let table = Table::drawn(&[&row], &[0.1, 0.1]);
            let scene = table.scene();
            let borders = single(&scene).borders(SegmentId(0), SegmentId(1));
            assert_eq!(borders.touch + borders.level, u32::from(is_near), "{holes} holes");
        }
    }
}
