//! Deep bottoms: background that an object encloses in the image, and that looks unlike the support around
//! the object, is its bottom (ours).
//!
//! The near wall of a deep vessel hides a part of the bottom, with a step, just as a thing in front of a
//! table hides a part of the table. And where the near wall is as thin as noise, the bottom seems to go on
//! into the table. Colour tells the two apart.

use std::ops::Range;

use glam::Vec3;

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Proposal, Rule, Source};
use crate::clusters::patches::{Owner, find_owners};
use crate::clusters::scene::sampled;
use crate::color::histogram::ColorHistogram;
use crate::color::image::LabImage;
use crate::color::{LEAST_UNLIKE_SHADOW, mean, unlike_in_light};
use crate::discovery::join::{Join, JoinEvidence, JoinedPart};
use crate::hull::{RowSpan, fill_hull, find_row_spans};
use crate::neighbours::four_neighbours;
use crate::params;
use crate::quantile::range;
use crate::raster::PixelBox;
use crate::regions::{SegmentId, connect};

/// A smaller piece (px at a focal length of 525 px) is a hole, or too small to compare its colours. The same
/// limit holds for the support around the vessel.
const LEAST_PX: usize = 100;
/// Along at least this share of the border no support goes on: the share of three sides of a square. A gap in
/// a thin wall is shorter.
const LEAST_ENCLOSED: f64 = 0.75;
/// Along at least this share of the border the vessel itself begins. The rest may be things on the bottom.
const LEAST_OF_VESSEL: f64 = 0.3;
/// The colours overlap those of the support around the vessel by at most this, as for flat things
/// (`flat.color_overlap`).
const MOST_ALIKE: f64 = 0.35;
/// The bottom is at most this share as high as the top of the vessel. The top is this quantile of the
/// vessel's heights.
const MOST_OF_TOP: f64 = 0.5;
const TOP_SHARE: f64 = 0.95;
/// The depths of the vessel reach from the first of these quantiles to the second.
const ENDS: [f64; 2] = [0.05, 0.95];
/// The support around the vessel is what lies this close to the rectangle around it (px at a focal length of
/// 525 px), as in the ring of flat things.
const AROUND_PX: usize = 20;

/// Gives to a cluster the pieces of support within its convex hull in the image that it encloses, if their
/// colours are neither those of the support around it nor those in less light. Does nothing without colour,
/// nor if bottoms are switched off. O(pixels of the clusters and of their hulls).
pub(crate) fn join_deep_bottoms(clusters: &mut Clusters<'_>, params: &params::Vessels) {
    let is_on = params.bottom_contact_share <= 1.0;
    let Some(lab) = clusters.scene.lab.filter(|_| is_on) else { return };
    let mut is_free = find_free(clusters);
    for id in clusters.alive() {
        let hull = hull(clusters, id);
        for bottom in find_pieces(clusters, (id, &hull), &is_free) {
            let around = support_around(clusters, &hull, &is_free);
            let Some(checks) = check(clusters, id, (&bottom, around), lab) else { continue };
            let mut join =
                Proposal::new(Rule::VesselBottom, Source::Patch(bottom.runs[0].start as u32), Some(id));
            let is_bottom = checks.iter().all(Check::holds);
            join.extend(checks);
            if !is_bottom {
                clusters.history.note_misses([join.refuse()]);
                continue;
            }
            let contact_share = bottom.share(bottom.touch);
            let parts = [clusters.part(id), bottom.part(clusters.scene.disparity.width())];
            let evidence = JoinEvidence::VesselBottom { contact_share };
            clusters.give(join.accept(Some((Join { parts, evidence, behind: None }, None))));
            let pixels: Vec<u32> = bottom.pixels().map(|i| i as u32).collect();
            pixels.iter().for_each(|&i| is_free[i as usize] = false);
            clusters.extend(id, &pixels);
        }
    }
}

/// A connected piece of support within the hull of a cluster.
struct Piece {
    /// In scan order.
    runs: Vec<Range<usize>>,
    /// The sides of its pixels beyond which it ends ...
    border: u32,
    /// ... of these, those where the cluster begins, and those of them without a step,
    of_vessel: u32,
    touch: u32,
    /// and those where a support or another surface goes on.
    open: u32,
}

impl Piece {
    fn pixels(&self) -> impl Iterator<Item = usize> + '_ {
        self.runs.iter().cloned().flatten()
    }

    fn share(&self, sides: u32) -> f64 {
        f64::from(sides) / f64::from(self.border.max(1))
    }

    fn part(&self, width: usize) -> JoinedPart {
        JoinedPart { size_px: self.pixels().count(), box_px: PixelBox::around(self.pixels(), width) }
    }
}

/// The pixels of the background that no cluster was given.
fn find_free(clusters: &Clusters<'_>) -> Vec<bool> {
    let owners = find_owners(clusters);
    let segments = &clusters.scene.facets.segments;
    let mut is_free = vec![false; clusters.scene.disparity.len()];
    let background = segments.runs().filter(|&(_, facet)| owners[facet] == Owner::Background);
    background.for_each(|(run, _)| is_free[run].fill(true));
    for id in clusters.alive() {
        clusters.get(id).pixels.iter().for_each(|&i| is_free[i as usize] = false);
    }
    is_free
}

/// The pieces of support within the hull of a cluster that are large enough for a bottom.
fn find_pieces(clusters: &Clusters<'_>, (id, hull): (SegmentId, &[RowSpan]), is_free: &[bool]) -> Vec<Piece> {
    let (scene, pixels) = (clusters.scene, &clusters.get(id).pixels);
    let (width, least_px) = (scene.disparity.width(), scene.space.area_px(LEAST_PX));
    let hull_px: usize = hull.iter().map(|span| (span.last + 1).saturating_sub(span.first)).sum();
    if hull_px < pixels.len() + least_px {
        return Vec::new();
    }
    let mut runs = Vec::new();
    for &RowSpan { v, first, last } in hull {
        let row: Vec<usize> = (v * width + first..=v * width + last).filter(|&i| is_free[i]).collect();
        let adjacent = row.chunk_by(|a, b| a + 1 == *b);
        runs.extend(adjacent.map(|run| (run[0]..run[run.len() - 1] + 1, 0)));
    }
    let (piece_of, count) = connect(&runs, width);
    let mut pieces: Vec<Vec<Range<usize>>> = vec![Vec::new(); count];
    runs.into_iter().zip(piece_of).for_each(|((run, _), piece)| pieces[piece as usize].push(run));
    pieces.retain(|runs| runs.iter().map(Range::len).sum::<usize>() >= least_px);
    pieces.into_iter().map(|runs| measure(clusters, id, runs)).collect()
}

/// The hull of a cluster in the image.
fn hull(clusters: &Clusters<'_>, id: SegmentId) -> Vec<RowSpan> {
    let pixels = clusters.get(id).pixels.iter().map(|&i| i as usize);
    fill_hull(&find_row_spans(pixels, clusters.scene.disparity.width()))
}

/// Counts the sides of a piece. A pixel without a facet ends it, as do the things on it.
fn measure(clusters: &Clusters<'_>, id: SegmentId, runs: Vec<Range<usize>>) -> Piece {
    let (width, height) = clusters.scene.disparity.size();
    let vessel = &clusters.get(id).pixels;
    let mut piece = Piece { runs, border: 0, of_vessel: 0, touch: 0, open: 0 };
    let is_inside = |i: usize| {
        let after = piece.runs.partition_point(|run| run.end <= i);
        piece.runs.get(after).is_some_and(|run| run.contains(&i))
    };
    let (mut border, mut of_vessel, mut touch, mut open) = (0, 0, 0, 0);
    for i in piece.pixels() {
        let mut sides = 0;
        for (j, _) in four_neighbours(i, width, height) {
            sides += 1;
            if is_inside(j) {
                continue;
            }
            border += 1;
            let facet = clusters.scene.facets.segments.at(j);
            let is_of_vessel = vessel.binary_search(&(j as u32)).is_ok();
            of_vessel += u32::from(is_of_vessel);
            touch += u32::from(is_of_vessel && clusters.scene.steps.touch(clusters.scene.disparity, i, j));
            open += u32::from(facet.is_some() && !is_of_vessel && clusters.at_pixel(j).is_none());
        }
        // Beyond the image it may go on.
        (border, open) = (border + 4 - sides, open + 4 - sides);
    }
    (piece.border, piece.of_vessel, piece.touch, piece.open) = (border, of_vessel, touch, open);
    piece
}

/// The checks of a bottom, against the support `around` the vessel. `None` if the vessel does not enclose it,
/// as with most pieces of background in a hull, or if too little of the support is seen.
fn check(
    clusters: &Clusters<'_>,
    id: SegmentId,
    (piece, around): (&Piece, impl Iterator<Item = usize>),
    lab: &LabImage,
) -> Option<Vec<Check>> {
    let share = |what, value, least| Check::new(what, "", value, Bound::AtLeast, least);
    let mut checks = vec![
        share("share of its border where no support goes on", 1.0 - piece.share(piece.open), LEAST_ENCLOSED),
        share("share of its border with the vessel", piece.share(piece.of_vessel), LEAST_OF_VESSEL),
    ];
    if !checks.iter().all(Check::holds) {
        return None;
    }
    checks.extend(check_place(clusters, id, piece)?);
    let own: Vec<[f32; 3]> = piece.pixels().map(|i| lab[i]).collect();
    let around: Vec<[f32; 3]> = around.map(|i| lab[i]).collect();
    if around.len() < clusters.scene.space.area_px(LEAST_PX) {
        return None;
    }
    let [own_colors, others] = [&own, &around].map(|colors| ColorHistogram::of(colors.iter().copied()));
    let alike = "overlap of its colours with those of the support around the vessel";
    let darker = "difference from that support in other light";
    let [own_mean, mean_around] =
        [&own, &around].map(|colors| mean(colors.iter().map(|color| Vec3::from(*color))));
    let unlike = unlike_in_light(own_mean, mean_around);
    checks.extend([
        Check::new(alike, "", own_colors.overlap(&others), Bound::AtMost, MOST_ALIKE),
        Check::new(darker, "ΔE", unlike, Bound::AtLeast, LEAST_UNLIKE_SHADOW),
    ]);
    Some(checks)
}

/// Checks that a piece lies as far away as the vessel, give or take the height of the vessel, and low in it.
/// What is seen behind a thing does not. `None` without a support below it.
fn check_place(clusters: &Clusters<'_>, id: SegmentId, piece: &Piece) -> Option<[Check; 3]> {
    let (scene, vessel) = (clusters.scene, &clusters.get(id).pixels);
    let depths_m = |pixels: &mut dyn Iterator<Item = usize>, shares| {
        let mut depths_m: Vec<f64> = pixels.map(|i| scene.point_at(i).z).collect();
        range(&mut depths_m, shares)
    };
    let [near_m, far_m] = depths_m(&mut sampled(vessel), ENDS);
    let [depth_m, _] = depths_m(&mut piece.pixels(), [0.5, 0.5]);
    let support = scene.own_support(vessel)?;
    let pixels: Vec<u32> = piece.pixels().map(|i| i as u32).collect();
    let height_m = scene.height_quantile_m(sampled(&pixels), support, 0.5);
    let top_m = scene.height_quantile_m(sampled(vessel), support, TOP_SHARE);
    if top_m <= 0.0 {
        return None;
    }
    Some([
        Check::new(
            "its depth, against the least of the vessel less its height",
            "m",
            depth_m,
            Bound::AtLeast,
            near_m - top_m,
        ),
        Check::new(
            "its depth, against the greatest of the vessel and its height",
            "m",
            depth_m,
            Bound::AtMost,
            far_m + top_m,
        ),
        Check::new(
            "its height, over that of the top of the vessel",
            "",
            height_m / top_m,
            Bound::AtMost,
            MOST_OF_TOP,
        ),
    ])
}

/// The free pixels of the background near the hull of a vessel and outside of it.
fn support_around<'a>(
    clusters: &Clusters<'_>,
    hull: &'a [RowSpan],
    is_free: &'a [bool],
) -> impl Iterator<Item = usize> + 'a {
    let scene = clusters.scene;
    let ((width, height), reach) = (scene.disparity.size(), scene.space.length_px(AROUND_PX));
    let near =
        |first: usize, last: usize, end: usize| first.saturating_sub(reach)..(last + 1 + reach).min(end);
    let (left, right) =
        hull.iter().fold((usize::MAX, 0), |(left, right), span| (left.min(span.first), right.max(span.last)));
    let [top, bottom] = [hull.first(), hull.last()].map(|span| span.map_or(0, |span| span.v));
    let columns = near(left, right, width);
    let in_row = move |row: usize| {
        let inside = row.checked_sub(top).and_then(|k| hull.get(k)).map(|span| span.first..=span.last);
        let outside = move |u: &usize| inside.as_ref().is_none_or(|inside| !inside.contains(u));
        columns.clone().filter(outside).map(move |u| row * width + u)
    };
    near(top, bottom, height).flat_map(in_row).filter(|&i| is_free[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::testing::{Table, single};

    const SIZE: (usize, usize) = (60, 50);
    const WOOD: [f32; 3] = [60.0, 10.0, 25.0];
    const BLUE: [f32; 3] = [40.0, 5.0, -40.0];

    /// The pixels that a wall 5 cm high gains, which goes round columns 15 to 44 and rows 10 to 39 but for a gap; inside of it the background lies at a
    /// height (m) and has a colour.
    fn gained(gap: Range<usize>, inside_m: f64, color: Option<[f32; 3]>) -> usize {
        let within = |u: usize, v: usize, wall: usize| {
            (15 + wall..45 - wall).contains(&u) && (10 + wall..40 - wall).contains(&v)
        };
        let mut table = Table::new(SIZE, |u, v| {
            let is_wall = within(u, v, 0) && !within(u, v, 3) && !(v > 30 && gap.contains(&u));
            Some(if is_wall { (1, 0.05) } else { (0, if within(u, v, 3) { inside_m } else { 0.0 }) })
        });
        let paint = |color: [f32; 3]| move |u: usize, v: usize| if within(u, v, 3) { color } else { WOOD };
        table.lab = color.map(|color| LabImage::drawn(SIZE, paint(color)));
        let scene = table.scene();
        let mut clusters = single(&scene);
        let before = clusters.get(SegmentId(0)).pixels.len();
        let params = params::Vessels::default();
        join_deep_bottoms(&mut clusters, &params);
        let gained = clusters.get(SegmentId(0)).pixels.len() - before;
        join_deep_bottoms(&mut clusters, &params);
        let pixels = &clusters.get(SegmentId(0)).pixels;
        assert!(pixels.is_sorted() && pixels.len() == before + gained, "a bottom is given once");
        gained
    }

    /// A regression: pans and trays of another simulator came out as rings, because the near wall hid where it meets the bottom, or was not seen.
    #[test]
    fn what_a_wall_encloses_and_looks_unlike_the_table_is_its_bottom() {
        assert_eq!(gained(0..0, 0.0, Some(BLUE)), 24 * 24);
        assert!(gained(25..35, 0.0, Some(BLUE)) >= 24 * 24, "a gap in the near wall");
        assert_eq!(gained(0..0, 0.0, Some(WOOD)), 0, "the table, seen through a ring");
        let dimmed = [0.7 * (WOOD[0] + 16.0) - 16.0, 0.7 * WOOD[1], 0.7 * WOOD[2]];
        assert_eq!(gained(0..0, 0.0, Some(dimmed)), 0, "the table in the shadow of the ring");
        let lit = [(WOOD[0] + 16.0) / 0.7 - 16.0, WOOD[1] / 0.7, WOOD[2] / 0.7];
        assert_eq!(gained(0..0, 0.0, Some(lit)), 0, "the table in the light that falls into the ring");
        assert_eq!(gained(0..0, 0.03, Some(BLUE)), 0, "too high for a bottom");
        assert_eq!(gained(15..45, 0.0, Some(BLUE)), 0, "open on one side");
        assert_eq!(gained(0..0, -0.2, Some(BLUE)), 0, "far behind");
        assert_eq!(gained(0..0, 0.0, None), 0, "without colour");
    }
}
