//! The borders between clusters in the image.

use std::ops::{AddAssign, Range};

use rayon::prelude::*;

use crate::clusters::scene::Scene;
use crate::facets::Facets;
use crate::regions::{RegionGraph, SegmentId};
use crate::shapes::contraction::Shapes;

/// The border of one cluster with another: numbers of pairs of neighbouring pixels, one pixel of each cluster.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct BorderCounts {
    /// Side by side without a step in depth.
    pub touch: u32,
    /// Across a gap without depth, and without a step.
    pub level: u32,
    /// This cluster in front of the other, by a step.
    pub in_front: u32,
    /// This cluster behind the other, by a step.
    pub behind: u32,
}

/// Pixels farther apart in a row or column (px at a focal length of 525 px) are no neighbours.
pub(crate) const REACH_PX: usize = 24;

impl AddAssign for BorderCounts {
    fn add_assign(&mut self, other: Self) {
        self.touch += other.touch;
        self.level += other.level;
        self.in_front += other.in_front;
        self.behind += other.behind;
    }
}

impl BorderCounts {
    /// All pairs.
    pub(crate) fn all(&self) -> u32 {
        self.touch + self.level + self.in_front + self.behind
    }

    /// The same border, seen from the other cluster.
    pub(crate) fn mirrored(self) -> Self {
        Self { in_front: self.behind, behind: self.in_front, ..self }
    }
}

/// Counts the border between any two clusters. Region 0 is the background, region k + 1 is cluster k. Two pixels of a row or column
/// are neighbours when only pixels without a facet lie between them, and not too many. O(pixels + border pixels · log(border
/// pixels)); parallel over strips of columns.
pub(crate) fn count_borders(scene: &Scene<'_>, shapes: &Shapes) -> RegionGraph<BorderCounts> {
    let width = scene.facets.segments.labels().width();
    // One strip per thread; the sums of counts do not depend on the order.
    let columns = width.div_ceil(rayon::current_num_threads());
    let strips: Vec<Range<usize>> =
        (0..width).step_by(columns).map(|left| left..width.min(left + columns)).collect();
    let pairs: Vec<Vec<PairCounts>> =
        strips.into_par_iter().map(|strip| Strip::new(scene, strip).count(shapes)).collect();
    let add = |sum: &mut BorderCounts, counts| *sum += counts;
    RegionGraph::gather(shapes.count + 1, pairs.into_iter().flatten(), add)
}

/// Two regions and the border of the first with the second.
type PairCounts = (SegmentId, SegmentId, BorderCounts);

/// Marks a column in which no region was seen yet.
const NOTHING: u32 = u32::MAX;

/// A pixel and its region.
#[derive(Clone, Copy)]
struct Place {
    region: u32,
    pixel: usize,
}

/// Some columns of the image. A strip counts the vertical pairs of its columns, and the horizontal pairs whose right pixel is in it.
struct Strip<'a> {
    columns: Range<usize>,
    counter: PairCounter<'a>,
    /// For each column the last region above, and the index of the first pixel of its row (`row_of_above`).
    above: Vec<u32>,
    row_of_above: Vec<usize>,
}

impl<'a> Strip<'a> {
    fn new(scene: &'a Scene<'a>, columns: Range<usize>) -> Self {
        let counter = PairCounter { scene, reach: scene.space.length_px(REACH_PX), pairs: Vec::new() };
        let (above, row_of_above) = (vec![NOTHING; columns.len()], vec![0; columns.len()]);
        Self { columns, counter, above, row_of_above }
    }

    fn count(mut self, shapes: &Shapes) -> Vec<PairCounts> {
        let Facets { segments, structure, .. } = self.counter.scene.facets;
        let width = segments.labels().width();
        let region =
            |facet: usize| facet.checked_sub(*structure).map_or(0, |shape| shapes.of_facet[shape] + 1);
        let mut left: Option<Place> = None;
        for (run, facet) in segments.runs() {
            let (own, v) = (region(facet), run.start / width);
            let at = |pixel: usize| Place { region: own, pixel };
            let (first, end) = (run.start - v * width, run.end - v * width);
            if let Some(left) = left.filter(|left| left.pixel / width == v && self.columns.contains(&first)) {
                self.counter.add(left, at(run.start), run.start - left.pixel);
            }
            left = Some(at(run.end - 1));
            self.count_above(own, v * width, first.max(self.columns.start)..end.min(self.columns.end));
        }
        self.counter.pairs
    }

    /// Counts pairs of pixels of one region with the last pixels above them. `row`: the index of the first pixel of the row.
    #[inline(always)]
    fn count_above(&mut self, own: u32, row: usize, columns: Range<usize>) {
        if columns.is_empty() {
            return;
        }
        let lanes = columns.start - self.columns.start..columns.end - self.columns.start;
        let (above, row_of_above) = (&mut self.above[lanes.clone()], &mut self.row_of_above[lanes]);
        for (u, (&region, &row_above)) in columns.zip(above.iter().zip(row_of_above.iter())) {
            if region != own && region != NOTHING {
                let width = self.counter.scene.disparity.width();
                let above = Place { region, pixel: row_above + u };
                self.counter.add(above, Place { region: own, pixel: row + u }, (row - row_above) / width);
            }
        }
        above.fill(own);
        row_of_above.fill(row);
    }
}

/// Counts pairs of pixels for each pair of regions.
struct PairCounter<'a> {
    scene: &'a Scene<'a>,
    reach: usize,
    pairs: Vec<PairCounts>,
}

impl PairCounter<'_> {
    /// Adds a pair of pixels `apart` steps apart.
    fn add(&mut self, a: Place, b: Place, apart: usize) {
        if a.region == b.region || apart > self.reach {
            return;
        }
        let Scene { disparity, steps, .. } = self.scene;
        let [d_a, d_b] = [a, b].map(|place| disparity[place.pixel]);
        let rise = if a.region < b.region { d_a - d_b } else { d_b - d_a };
        let counts = match (rise.abs(), apart) {
            (step, 1) if step <= steps.touch_quanta => BorderCounts { touch: 1, ..Default::default() },
            (step, _) if step <= steps.level_quanta => BorderCounts { level: 1, ..Default::default() },
            _ if rise > 0.0 => BorderCounts { in_front: 1, ..Default::default() },
            _ => BorderCounts { behind: 1, ..Default::default() },
        };
        let [a, b] = [a, b].map(|place| SegmentId(place.region));
        // Successive pairs often belong to the same two regions; these are summed before sorting.
        match self.pairs.last_mut() {
            Some((last_a, last_b, sum)) if (*last_a, *last_b) == (a, b) => *sum += counts,
            _ => self.pairs.push((a, b, counts)),
        }
    }
}

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
