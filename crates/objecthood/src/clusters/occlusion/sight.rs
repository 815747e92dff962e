//! Examines the gap between two pieces: is something nearer or farther than their surface?

use std::cmp::Reverse;

use super::line::Line;
use super::pieces::Piece;
use crate::clusters::cluster::Clusters;
use crate::random::Lcg;
use crate::raster::marked;
use crate::regions::SegmentId;
use crate::simd::vectorized;

/// Number of lines of sight through the gap.
const LINES: usize = 60;
/// A pixel farther than the joint surface by more than this (quanta) shows that nothing is there: it is seen through.
const SEEN_THROUGH_QUANTA: f64 = 3.0;
/// A pixel nearer than the joint surface by more than this (quanta) hides it.
const HIDDEN_QUANTA: f64 = 2.0;
/// The joint surface is seen through in less than this share of the gap.
pub(super) const SEEN_THROUGH_SHARE: f64 = 0.15;
/// The joint surface is hidden in more than this share of the gap.
pub(super) const HIDDEN_SHARE: f64 = 0.5;
/// A pair that misses a limit by more than this factor is dropped without a report.
pub(super) const HOPELESS: f64 = 2.0;
/// Pixels of a line that are compared in one vectorised loop.
const STRETCH_PX: usize = 64;
/// Where the random numbers of the lines begin: fixed, so the same frame gives the same lines.
const SEED: u32 = 777;

/// The gap between two pieces, as shares of its measured pixels.
#[derive(Debug, PartialEq)]
pub(super) struct Seen {
    pub(super) hidden_share: f64,
    pub(super) seen_through_share: f64,
    /// The facet that hides most pixels, on ties the first one.
    pub(super) hider: Option<SegmentId>,
}

/// Compares the gap with the joint surface, along lines from random pixels of one piece to random pixels of the other. Measured pixels
/// outside both pieces count. `None` as soon as the lines left cannot change that too much is seen through, or too little is
/// hidden. `surface`: the disparity (quanta) of the joint surface at a column and row. O(pixels of the lines + facets).
pub(super) fn look_into_gap(
    clusters: &Clusters<'_>,
    pieces: [&Piece; 2],
    surface: impl Fn([f64; 2]) -> f64 + Copy,
) -> Option<Seen> {
    let scene = clusters.scene;
    let width = scene.disparity.width();
    let lines = draw_lines(pieces, width);
    let (labels, disparity) = (scene.facets.segments.labels().as_slice(), scene.disparity.as_slice());
    let own = pieces.map(|piece| piece.facet.0 as i32);
    let mut left = lines.iter().map(|line| line.steps).sum::<usize>();
    let mut tally = Tally::new(clusters, pieces);
    let mut stretch = Stretch::new();
    for mut line in lines {
        left -= line.steps;
        while line.steps > 0 {
            stretch.take(&mut line, width, labels, disparity);
            let (farther, level) = stretch.compare(own, surface);
            tally.through += farther;
            tally.level += level;
            marked(&stretch.is_nearer).for_each(|k| tally.add_nearer(stretch.labels[k]));
        }
        if tally.is_hopeless(left) {
            return None;
        }
    }
    Some(tally.into_seen())
}

/// Counts pixels of the gap.
struct Tally<'a> {
    clusters: &'a Clusters<'a>,
    pieces: [&'a Piece; 2],
    /// Farther than the surface.
    through: u32,
    /// Level with the surface, or nearer but of a cluster of the pieces.
    level: u32,
    /// Nearer than the surface.
    hidden: u32,
    /// The nearer pixels of each facet.
    hidden_by: Vec<u32>,
}

impl<'a> Tally<'a> {
    fn new(clusters: &'a Clusters<'a>, pieces: [&'a Piece; 2]) -> Self {
        let hidden_by = vec![0; clusters.scene.facets.segments.count()];
        Self { clusters, pieces, through: 0, level: 0, hidden: 0, hidden_by }
    }

    /// Adds a pixel that is nearer than the surface. It counts as level if it belongs to a cluster of the pieces: nothing hides itself.
    fn add_nearer(&mut self, label: i32) {
        let facet = usize::try_from(label).ok();
        let free = facet.and_then(|facet| facet.checked_sub(self.clusters.scene.facets.structure));
        let cluster = free.and_then(|free| self.clusters.of_facet(free));
        if cluster.is_some_and(|cluster| self.pieces.iter().any(|piece| piece.cluster == cluster)) {
            self.level += 1;
        } else {
            self.hidden += 1;
            facet.into_iter().for_each(|facet| self.hidden_by[facet] += 1);
        }
    }

    /// Whether too much is seen through, or too little is hidden, even if all pixels `left` are nearer than the surface.
    fn is_hopeless(&self, left: usize) -> bool {
        let most = f64::from(self.through + self.level + self.hidden) + left as f64;
        f64::from(self.through) > HOPELESS * SEEN_THROUGH_SHARE * most
            || f64::from(self.through + self.level) > (1.0 - HIDDEN_SHARE / HOPELESS) * most
    }

    fn into_seen(self) -> Seen {
        let all = f64::from((self.through + self.level + self.hidden).max(1));
        let hider = self.hidden_by.iter().zip(0..).max_by_key(|&(&count, facet)| (count, Reverse(facet)));
        let hider = hider.filter(|(count, _)| **count > 0).map(|(_, facet)| SegmentId(facet));
        let share = |part: u32| f64::from(part) / all;
        Seen { hidden_share: share(self.hidden), seen_through_share: share(self.through), hider }
    }
}

/// Lines from random pixels of one piece to random pixels of the other.
fn draw_lines(pieces: [&Piece; 2], width: usize) -> [Line; LINES] {
    let mut random = Lcg::new(SEED);
    [(); LINES].map(|()| {
        let ends = pieces.map(|piece| piece.pixels[random.below(piece.pixels.len())] as usize);
        Line::between(ends.map(|i| [i % width, i / width].map(|x| x as i64)))
    })
}

/// Successive pixels of a line.
struct Stretch {
    /// Columns and rows.
    at: [[i32; STRETCH_PX]; 2],
    labels: [i32; STRETCH_PX],
    /// `NaN` beyond the end of the line.
    disparity: [f32; STRETCH_PX],
    /// 1 where the pixel is nearer than the surface, else 0.
    is_nearer: [i32; STRETCH_PX],
}

impl Stretch {
    fn new() -> Self {
        let none = [0; STRETCH_PX];
        Self { at: [none; 2], labels: none, disparity: [f32::NAN; STRETCH_PX], is_nearer: none }
    }

    /// Takes the next pixels of a line.
    fn take(&mut self, line: &mut Line, width: usize, labels: &[i32], disparity: &[f32]) {
        let Self { at: [columns, rows], labels: own_labels, disparity: own_disparity, .. } = self;
        let mut taken = 0;
        for (k, [u, v]) in line.take(STRETCH_PX).enumerate() {
            let i = v * width + u;
            (columns[k], rows[k]) = (u as i32, v as i32);
            (own_labels[k], own_disparity[k]) = (labels[i], disparity[i]);
            taken = k + 1;
        }
        own_disparity[taken..].fill(f32::NAN);
    }

    /// Counts the measured pixels with other labels than `own`: returns how many are farther than the surface and how many are level with
    /// it, and marks the nearer ones.
    fn compare(&mut self, own: [i32; 2], surface: impl Fn([f64; 2]) -> f64 + Copy) -> (u32, u32) {
        let Self { at: [columns, rows], labels, disparity, is_nearer } = self;
        vectorized(
            #[inline(always)]
            move || {
                let (mut farther, mut level) = (0, 0);
                for k in 0..STRETCH_PX {
                    let expected = surface([f64::from(columns[k]), f64::from(rows[k])]);
                    let d = f64::from(disparity[k]);
                    let is_other = (labels[k] != own[0]) & (labels[k] != own[1]);
                    let is_farther = d < expected - SEEN_THROUGH_QUANTA;
                    let is_level = !is_farther & (d <= expected + HIDDEN_QUANTA);
                    farther += u32::from(is_other & is_farther);
                    level += u32::from(is_other & is_level);
                    is_nearer[k] = i32::from(is_other & !is_farther & !is_level & !d.is_nan());
                }
                (farther, level)
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::pieces::find_pieces;
    use super::*;
    use crate::clusters::testing::{Table, merge, single};

    /// The reference: pixel by pixel, to the end of every line.
    fn look_to_the_end(
        clusters: &Clusters<'_>,
        [a, b]: [&Piece; 2],
        surface: impl Fn([f64; 2]) -> f64,
    ) -> Option<Seen> {
        let scene = clusters.scene;
        let segments = &scene.facets.segments;
        let (mut through, mut on, mut hidden) = (0.0, 0.0, 0.0);
        let mut before = vec![0; segments.count()];
        for [u, v] in draw_lines([a, b], scene.disparity.width()).into_iter().flatten() {
            let i = v * scene.disparity.width() + u;
            let (facet, d) = (segments.at(i), f64::from(*scene.disparity.get(u, v)?));
            if d.is_nan() || facet == Some(a.facet) || facet == Some(b.facet) {
                continue;
            }
            let above = d - surface([u as f64, v as f64]);
            let cluster = clusters.at_pixel(i);
            if above < -SEEN_THROUGH_QUANTA {
                through += 1.0;
            } else if above <= HIDDEN_QUANTA || cluster == Some(a.cluster) || cluster == Some(b.cluster) {
                on += 1.0;
            } else {
                hidden += 1.0;
                facet.into_iter().for_each(|facet| before[facet.index()] += 1);
            }
        }
        let all: f64 = through + on + hidden;
        if through > 0.3 * all || hidden < 0.25 * all {
            return None;
        }
        let most = before.iter().max().copied().filter(|most| *most > 0);
        let hider = most.and_then(|most| before.iter().position(|count| *count == most));
        let share = |part: f64| part / all.max(1.0);
        let hider = hider.map(|facet| SegmentId(facet as u32));
        Some(Seen { hidden_share: share(hidden), seen_through_share: share(through), hider })
    }

    proptest! {
        /// A gap between two parts of a plank, row by row: a hole, the table, a level thing, and bars. One bar belongs to the plank.
        #[test]
        fn lines_that_end_early_tell_what_all_of_them_would(
            rows in prop::collection::vec(prop_oneof![
                1 => Just(None), 2 => Just(Some((0, 0.0))), 1 => Just(Some((4, 0.05))), 3 => Just(Some((3, 0.15))),
                1 => Just(Some((5, 0.15))), 1 => Just(Some((6, 0.12))),
            ], 20),
            tilt in prop_oneof![2 => Just(0.0), 1 => -0.3_f64..0.3],
            wide in 6_usize..40,
        ) {
            let table = Table::new((110, 60), |u, v| match v {
                10..40 if (10..30).contains(&u) => Some((1, 0.05)),
                10..40 if (30 + wide..80).contains(&u) => Some((2, 0.05)),
                // These bars hide a part of each piece.
                10..20 if (30..30 + wide).contains(&u) => Some((3, 0.15)),
                20..40 if (30..30 + wide).contains(&u) => rows[v - 20],
                _ => Some((0, 0.0)),
            });
            let scene = table.scene();
            let mut clusters = single(&scene);
            if clusters.alive().contains(&SegmentId(4)) {
                merge(&mut clusters, Some(SegmentId(0)), SegmentId(4));
            }
            let pieces = find_pieces(&clusters);
            let [a, b] = [1, 2].map(|facet| pieces.iter().find(|piece| piece.facet == SegmentId(facet)).unwrap());
            let level = f64::from(scene.disparity[a.pixels[0] as usize]);
            let surface = |[u, _]: [f64; 2]| level + tilt * (u - 55.0);
            prop_assert_eq!(look_into_gap(&clusters, [a, b], surface), look_to_the_end(&clusters, [a, b], surface));
        }
    }
}
