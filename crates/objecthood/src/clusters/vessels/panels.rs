//! Rule 5: thin upright panels of equal height that meet at corners or face each other are the walls of a box
//! (docs/CONTEXT.md 4.4.5).
//!
//! Rule 6 examines what surrounds a bottom. This rule needs no bottom: contents may hide it, and it may lie
//! above the support. A solid thing is no panel, because behind the rim of a panel the camera sees past it,
//! down into the box.

mod interior;
mod meeting;
mod panel;

use std::collections::BTreeSet;

use self::interior::Interior;
use self::meeting::{Kind, Meeting};
use self::panel::{Panel, find_panels};
use super::limits::{Limits, RIM_HEIGHT, check_walls_color};
use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Proposal, Rule, Source};
use crate::regions::SegmentId;
use crate::union_find::UnionFind;

/// From this many sides on, walls of different colours are those of one box: two things of equal height may
/// meet by chance, three seldom do.
const SIDES: usize = 3;

/// Panels make up at least this share of their clusters: a part of a bowl may look like a wall, and a wall
/// may be one cluster with a thing that leans on it.
const WALL_SHARE: f64 = 0.5;

/// Two panels that are placed like two walls of one box.
struct Pair {
    panels: [usize; 2],
    /// The clusters that they belong to.
    clusters: [SegmentId; 2],
    meeting: Meeting,
    tops: Check,
    /// Whether they share colours.
    alike: Check,
    /// Whether both clusters are mostly wall.
    are_walls: Check,
}

impl Pair {
    /// Whether they are two walls of one box, or pieces of one wall, if colours do not count.
    fn fits(&self) -> bool {
        self.meeting.check.holds() && self.tops.holds()
    }

    /// The same if colours count.
    fn fits_by_color(&self) -> bool {
        self.fits() && self.alike.holds()
    }

    /// The same for clusters that are mostly wall, if colours do not count.
    fn fits_by_place(&self) -> bool {
        self.fits() && self.are_walls.holds() && self.meeting.kind != Kind::Outside
    }

    /// Whether they are walls of one box. `sides`: whether the box has so many sides that colours do not
    /// count.
    fn is_wall(&self, sides: Check) -> bool {
        self.fits_by_color() || self.fits_by_place() && sides.holds()
    }

    /// The proposal to join their clusters.
    fn propose(&self, [into, from]: [SegmentId; 2], sides: Check) -> Proposal {
        let mut proposal = Proposal::new(Rule::BoxWalls, Source::Cluster(from), Some(into));
        proposal.extend([self.meeting.check, self.tops]);
        if self.alike.holds() || !sides.holds() {
            proposal.extend([self.alike]);
        } else {
            proposal.extend([self.are_walls, sides]);
        }
        proposal
    }
}

/// Joins the walls of every box, and its other pieces. O(pixels of upright facets + panels² + boxes ·
/// clusters).
pub(super) fn join_panels(clusters: &mut Clusters<'_>, limits: Limits<'_>) {
    let panels = find_panels(clusters, limits.support);
    let pairs = compare(clusters, limits, &panels);
    let by_place = count_sides(panels.len(), &pairs, Pair::fits_by_place);
    let by_color = count_sides(panels.len(), &pairs, Pair::fits_by_color);
    let sides = |pair: &Pair| {
        // Two boxes side by side have enough sides each.
        let has_own = |panel: usize| by_color[panel] >= SIDES;
        let are_two = pair.panels.into_iter().all(has_own);
        let count = if are_two { 0 } else { by_place[pair.panels[0]] };
        let what = "sides of the box, whose colours differ";
        Check::new(what, "", count as f64, Bound::AtLeast, SIDES as f64)
    };
    let (walls, misses): (Vec<&Pair>, Vec<&Pair>) = pairs.iter().partition(|pair| pair.is_wall(sides(pair)));
    let (box_of, count) = groups(panels.len(), walls.iter().copied());
    let mut is_box = vec![false; count];
    for pair in walls.iter().filter(|pair| pair.meeting.kind == Kind::Inside) {
        is_box[box_of[pair.panels[0]] as usize] = true;
    }
    let count = clusters.alive().last().map_or(0, |last| last.index() + 1);
    let mut joined = UnionFind::new(count);
    for pair in walls.into_iter().filter(|pair| is_box[box_of[pair.panels[0]] as usize]) {
        let [a, b] = pair.clusters.map(|id| joined.find(id.index()));
        if a != b {
            joined.link(a.min(b), a.max(b));
            let [into, from] = [a.min(b), a.max(b)].map(|root| SegmentId(root as u32));
            clusters.give(pair.propose([into, from], sides(pair)).accept(None));
        }
    }
    let misses = misses.into_iter().filter(|pair| pair.clusters[0] != pair.clusters[1]);
    clusters.history.note_misses(misses.map(|pair| pair.propose(pair.clusters, sides(pair)).refuse()));
    for (found, _) in is_box.into_iter().enumerate().filter(|(_, is_box)| *is_box) {
        let walls = panels.iter().zip(&box_of).filter(|(_, of)| **of as usize == found);
        let walls: Vec<&Panel> = walls.map(|(panel, _)| panel).collect();
        if let Some(interior) = Interior::of(&walls) {
            let into = SegmentId(joined.find(walls[0].cluster.index()) as u32);
            // The walls of a box within a box may be pieces of the outer one by now.
            if !clusters.get(into).pixels.is_empty() {
                interior.join(clusters, limits.support, into);
            }
        }
    }
}

/// The group of each panel, and the number of groups: pairs link their panels.
fn groups<'p>(panels: usize, pairs: impl Iterator<Item = &'p Pair>) -> (Vec<u32>, usize) {
    let mut sets = UnionFind::new(panels);
    for pair in pairs {
        let [a, b] = pair.panels.map(|panel| sets.find(panel));
        sets.link(a.min(b), a.max(b));
    }
    sets.groups()
}

/// For each panel, the number of sides of the box to which such pairs link it.
fn count_sides(panels: usize, pairs: &[Pair], fits: impl Fn(&Pair) -> bool) -> Vec<usize> {
    let fitting = || pairs.iter().filter(|pair| fits(pair));
    let (box_of, count) = groups(panels, fitting());
    let (side_of, _) = groups(panels, fitting().filter(|pair| pair.meeting.kind == Kind::OneWall));
    let mut sides = vec![BTreeSet::new(); count];
    for (of_box, side) in box_of.iter().zip(side_of) {
        sides[*of_box as usize].insert(side);
    }
    box_of.into_iter().map(|of_box| sides[of_box as usize].len()).collect()
}

/// The pairs of panels that are placed like two walls of one box, with their checks.
fn compare(clusters: &Clusters<'_>, limits: Limits<'_>, panels: &[Panel]) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for (b, other) in panels.iter().enumerate() {
        for (a, one) in panels[..b].iter().enumerate() {
            let Some(meeting) = Meeting::of(one, other) else { continue };
            let apart_m = (one.top_m - other.top_m).abs();
            let limit_m = limits.params.rim_height_m;
            let tops = Check::new("difference of the tops", "m", apart_m, Bound::AtMost, limit_m);
            pairs.push(Pair {
                panels: [a, b],
                clusters: [one, other].map(|panel| panel.cluster),
                meeting,
                tops: tops.set_by(RIM_HEIGHT),
                alike: check_walls_color(clusters.scene, [one, other].map(|panel| &panel.colors)),
                are_walls: Check::new(
                    "share of walls in the clusters",
                    "",
                    one.wall_share.min(other.wall_share),
                    Bound::AtLeast,
                    WALL_SHARE,
                ),
            });
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::testing::{Table, single};
    use crate::color::image::LabImage;
    use crate::params;

    const SIZE: (usize, usize) = (120, 100);

    /// The number of clusters that are left of a drawing (facet, height).
    fn left(at: impl Fn(usize, usize) -> (i32, f64)) -> usize {
        left_of(&Table::new(SIZE, |u, v| Some(at(u, v))))
    }

    /// The same if the facets have these colours.
    fn left_painted(at: impl Fn(usize, usize) -> (i32, f64), colors: [[f32; 3]; 5]) -> usize {
        let mut table = Table::new(SIZE, |u, v| Some(at(u, v)));
        table.lab = Some(LabImage::drawn(SIZE, |u, v| colors[at(u, v).0 as usize]));
        left_of(&table)
    }

    fn left_of(table: &Table) -> usize {
        let scene = table.scene();
        let mut clusters = single(&scene);
        let params = params::Vessels::default();
        join_panels(&mut clusters, Limits { support: scene.ground().unwrap(), params: &params });
        clusters.alive().len()
    }

    /// A box without its near wall, seen from above: a left, a right and a far wall, facets 1 to 3, which slope up from the bottom, facet 4, by
    /// so many metres. The bottom lies 12 mm above the table, and the rims are as high for `thick_px`.
    fn seen_box(walls_m: [f64; 3], thick_px: usize) -> impl Fn(usize, usize) -> (i32, f64) {
        move |u, v| {
            let out = [46_usize.saturating_sub(u), u.saturating_sub(73), 46_usize.saturating_sub(v)];
            let wall = (0..3).max_by_key(|&wall| out[wall]).unwrap_or(0);
            match out[wall] {
                _ if v > 73 => (0, 0.0),
                0 => (4, 0.012),
                out if out > 12 + thick_px => (0, 0.0),
                out => (1 + wall as i32, 0.012 + walls_m[wall] * out.min(12) as f64 / 12.0),
            }
        }
    }

    #[test]
    fn walls_and_a_bottom_above_the_table_are_a_box() {
        assert_eq!(left(seen_box([0.06; 3], 0)), 1);
    }

    #[test]
    fn what_lies_in_a_box_stays_apart() {
        let empty = seen_box([0.06; 3], 0);
        let is_thing = |u: usize, v: usize| (56..64).contains(&u) && (56..64).contains(&v);
        assert_eq!(left(|u, v| if is_thing(u, v) { (5, 0.04) } else { empty(u, v) }), 2);
    }

    /// A regression: balls at the wall of a tray were pieces of the wall.
    #[test]
    fn a_small_thing_at_the_wall_stays_apart_if_its_colors_do() {
        let (red, green, blue, gray) =
            ([50.0, 60.0, 40.0], [60.0, -50.0, 40.0], [30.0, 10.0, -60.0], [50.0, 0.0, 0.0]);
        let empty = seen_box([0.06; 3], 0);
        let is_thing = |u: usize, v: usize| (46..52).contains(&u) && (56..64).contains(&v);
        let at = |u, v| if is_thing(u, v) { (5, 0.06) } else { empty(u, v) };
        let left = |thing: [f32; 3]| {
            let mut table = Table::new(SIZE, |u, v| Some(at(u, v)));
            // It lies at the left wall, facet 1; a piece has the colours of any wall.
            let of_facet = [gray, red, green, green, green, thing];
            table.lab = Some(LabImage::drawn(SIZE, |u, v| of_facet[at(u, v).0 as usize]));
            left_of(&table)
        };
        assert_eq!(left(blue), 2);
        assert_eq!(left(red), 1);
    }

    /// The walls of bins with print, and of bins in a light from the side, were objects.
    #[test]
    fn walls_of_other_colors_are_a_box_from_three_sides_on() {
        let (red, green, blue, gray) =
            ([50.0, 60.0, 40.0], [60.0, -50.0, 40.0], [30.0, 10.0, -60.0], [50.0, 0.0, 0.0]);
        let (three, two) = ([0.06; 3], [0.06, 0.0, 0.06]);
        let left = |walls_m, [left, right, far]: [[f32; 3]; 3]| {
            left_painted(seen_box(walls_m, 0), [gray, left, right, far, gray])
        };
        assert_eq!(left(three, [red, green, blue]), 1);
        assert_eq!(left(two, [red, green, blue]), 4, "two things that meet by chance");
        // Light scales L* + 16, a* and b* alike.
        let [l, a, b] = red.map(|part| 0.75 * part);
        let darker = [l - 0.25 * 16.0, a, b];
        assert!(left(two, [red, red, darker]) < 4, "one paint in less light");
    }

    #[test]
    fn two_boxes_of_other_colors_side_by_side_are_two() {
        let (red, blue, gray) = ([50.0, 60.0, 40.0], [30.0, 10.0, -60.0], [50.0, 0.0, 0.0]);
        let one = seen_box([0.06; 3], 0);
        // The same box twice, 5 cm apart: facets 1 to 4, and 5 to 8.
        let both = |u: usize, v: usize| {
            let (at, first) = if u < 86 { (u + 14, 0) } else { (u - 66, 4) };
            let (facet, height_m) = one(at, v);
            (if facet == 0 { 0 } else { facet + first }, height_m)
        };
        let size = (200, 100);
        let mut table = Table::new(size, |u, v| Some(both(u, v)));
        let color = |facet| match facet {
            0 => gray,
            1..=4 => red,
            _ => blue,
        };
        table.lab = Some(LabImage::drawn(size, |u, v| color(both(u, v).0)));
        assert_eq!(left_of(&table), 2);
    }

    #[test]
    fn solid_things_around_a_pocket_are_no_walls() {
        let things = left(seen_box([0.06; 3], 20));
        assert_eq!(things, 4, "3.8 cm thick");
    }

    #[test]
    fn walls_of_a_box_are_equally_high() {
        assert_eq!(left(seen_box([0.06, 0.09, 0.12], 0)), 4);
    }
}
