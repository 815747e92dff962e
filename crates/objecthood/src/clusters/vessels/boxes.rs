//! Rule 6: upright walls around a patch of background are an open box, and the patch is its bottom
//! (docs/CONTEXT.md 4.4.6).
//!
//! Where the camera looks down over a wall into a box, it would see the top of anything solid of the same
//! height. So walls show no tops.

use glam::DVec3;

use super::limits::{Limits, RIM_HEIGHT, check_walls_color};
use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::colors::Colors;
use crate::clusters::history::{Miss, Proposal, Rule, Source};
use crate::clusters::patches::{Patch, Shared, find_patches};
use crate::clusters::scene::sampled;
use crate::discovery::join::{Join, JoinEvidence};
use crate::hull::Hull;
use crate::oriented_box::fit_oriented_box;
use crate::regions::SegmentId;

/// Least number of pixels of the bottom (px at a focal length of 525 px).
const BOTTOM_PX: usize = 100;
/// A wall bounds at least this share of the bottom.
const WALL_SHARE: f64 = 0.05;
/// The walls and what lies in the box bound at least this share of the bottom; the rest is shadow.
const ENCLOSED_SHARE: f64 = 0.6;
/// The walls bound at least this share of the bottom's border that nothing in the box bounds.
const WALLED_SHARE: f64 = 0.45;
/// The bottom touches its walls along at least this share of its border, and goes on behind them along at least this share: the camera sees
/// the far walls from within, and the near ones from outside.
const SEEN_SHARE: f64 = 0.1;
/// Less than this share of a wall faces up.
const UP_SHARE: f64 = 1.0 / 3.0;
/// Least share of the bottom within the convex hull of the walls in the image.
const WITHIN_SHARE: f64 = 0.9;
/// The walls are at most this long (m): the boards and sides of a shelf are furniture, whatever stands
/// between them.
const LONGEST_M: f64 = 0.8;
/// A pixel faces up if its normal has at least this cosine with up: 45 degrees.
const UP_COSINE: f64 = 0.7;

/// What stands around a patch of background: the walls of a box, and what lies in it.
struct Around {
    /// Upright clusters of equal height, in the order of their numbers.
    walls: Vec<SegmentId>,
    /// The greatest difference of a wall's top from that of the wall with the longest border (m).
    apart_m: f64,
    /// What the walls share with the patch.
    shared: Shared,
    /// The length of the patch's border without what lies in the box.
    border: u32,
}

impl Around {
    /// `None` if the patch is not enclosed (most patches are not, so this is tested first), or if nothing
    /// beside it is upright. The wall with the longest border sets the height of all.
    fn of(clusters: &Clusters<'_>, patch: &Patch, limits: Limits<'_>) -> Option<Self> {
        let is_beside = |shared: Shared| patch.share_of_border(shared.sides()) >= WALL_SHARE;
        let all = patch.shared.iter().map(|(&id, &shared)| (id, shared));
        let beside: Vec<(SegmentId, Shared)> = all.filter(|&(_, shared)| is_beside(shared)).collect();
        let enclosing: Shared = beside.iter().map(|&(_, shared)| shared).sum();
        if patch.share_of_border(enclosing.sides()) < ENCLOSED_SHARE {
            return None;
        }
        let (upright, mut contents): (Vec<_>, Vec<_>) =
            beside.into_iter().partition(|&(id, _)| up_share(clusters, limits, id) < UP_SHARE);
        // On ties the wall with the smallest number wins.
        let longest = upright.iter().rev().max_by_key(|(_, shared)| shared.sides())?;
        let top_m = limits.top_m(clusters, longest.0);
        let apart_m = |id| (limits.top_m(clusters, id) - top_m).abs();
        let (walls, lower): (Vec<_>, Vec<_>) =
            upright.iter().partition(|&&(id, _)| apart_m(id) <= limits.params.rim_height_m);
        contents.extend(lower);
        Some(Self {
            apart_m: walls.iter().map(|&(id, _)| apart_m(id)).fold(0.0, f64::max),
            shared: walls.iter().map(|&(_, shared)| shared).sum(),
            border: patch.border_without(contents.into_iter().map(|(_, shared)| shared).sum()),
            walls: walls.into_iter().map(|(id, _)| id).collect(),
        })
    }

    fn share(&self, sides: u32) -> f64 {
        f64::from(sides) / f64::from(self.border)
    }

    fn enclosed_share(&self) -> f64 {
        self.share(self.shared.sides())
    }

    /// The pixels of the walls, in scan order.
    fn pixels(&self, clusters: &Clusters<'_>) -> Vec<u32> {
        let mut pixels: Vec<u32> =
            self.walls.iter().flat_map(|&wall| &clusters.get(wall).pixels).copied().collect();
        pixels.sort_unstable();
        pixels
    }

    /// Checks that the walls share their colours with the largest one: tall things around a pocket of the table do not.
    fn check_colors<'a>(
        &'a self,
        clusters: &'a Clusters<'_>,
        largest: SegmentId,
    ) -> impl Iterator<Item = Check> + 'a {
        let colors = |id: SegmentId| Colors::of(clusters.scene, &clusters.get(id).pixels);
        let (others, own) = (self.walls.iter().filter(move |&&wall| wall != largest), colors(largest));
        others.map(move |&wall| check_walls_color(clusters.scene, [&own, &colors(wall)]))
    }

    /// The checks on heights and shares. The check on heights always holds: a cluster of another height is no
    /// wall.
    fn checks(&self, limits: Limits<'_>) -> [Check; 4] {
        let (apart_m, limit_m) = (self.apart_m, limits.params.rim_height_m);
        let at_least = |what, share, least| Check::new(what, "", share, Bound::AtLeast, least);
        let walled = "share of its border with the walls, but for what lies in the box";
        let touched = "share of its border without a step, but for what lies in the box";
        let hidden = "share of its border behind walls, but for what lies in the box";
        [
            Check::new("difference of the tops", "m", apart_m, Bound::AtMost, limit_m).set_by(RIM_HEIGHT),
            at_least(walled, self.enclosed_share(), WALLED_SHARE),
            at_least(touched, self.share(self.shared.touch), SEEN_SHARE),
            at_least(hidden, self.share(self.shared.hidden), SEEN_SHARE),
        ]
    }
}

/// Joins the walls of the first open box that it finds, and its bottom, and returns whether it found one.
pub(super) fn join_box(clusters: &mut Clusters<'_>, limits: Limits<'_>, misses: &mut Vec<Miss>) -> bool {
    let least_px = clusters.scene.space.area_px(BOTTOM_PX);
    for patch in find_patches(clusters).into_iter().filter(|patch| patch.size_px() >= least_px) {
        let Some(around) = Around::of(clusters, &patch, limits) else { continue };
        // On ties the wall with the smallest number wins.
        let sizes = around.walls.iter().rev().map(|&wall| (clusters.get(wall).pixels.len(), wall));
        let Some((_, largest)) = sizes.max_by_key(|&(size_px, _)| size_px) else { continue };
        let mut join = Proposal::new(Rule::OpenBox, Source::Patch(patch.first()), Some(largest));
        let walls = around.pixels(clusters);
        let is_box = around.checks(limits).into_iter().all(|check| join.check(check))
            && join.check(check_within(&patch, &walls, clusters.scene.disparity.width()))
            && join.check(check_length(clusters, limits, &walls))
            && around.check_colors(clusters, largest).all(|check| join.check(check));
        if is_box {
            join_all(clusters, &patch, &around, largest, &join);
            return true;
        }
        misses.push(join.refuse());
    }
    false
}

/// Gives the other walls and the patch to one of the walls, on the evidence of the proposal.
fn join_all(clusters: &mut Clusters<'_>, patch: &Patch, around: &Around, into: SegmentId, found: &Proposal) {
    let evidence = JoinEvidence::OpenBox { enclosed_share: around.enclosed_share() };
    for &wall in around.walls.iter().filter(|&&wall| wall != into) {
        clusters.join(found.clone().of(Source::Cluster(wall)), evidence);
    }
    let parts = [clusters.part(into), patch.part(clusters.scene.disparity.width())];
    clusters.give(found.clone().accept(Some((Join { parts, evidence, behind: None }, None))));
    let pixels: Vec<u32> = patch.runs.iter().cloned().flatten().map(|i| i as u32).collect();
    clusters.extend(into, &pixels);
}

/// Checks that the walls surround the patch. Beside standing walls, the surface that they stand on continues.
fn check_within(patch: &Patch, walls: &[u32], width: usize) -> Check {
    let outline = Hull::of(walls, width);
    let within = patch.runs.iter().cloned().flatten().filter(|&i| outline.contains(i)).count();
    let share = within as f64 / patch.size_px() as f64;
    Check::new("share within the outline of the walls", "", share, Bound::AtLeast, WITHIN_SHARE)
}

fn check_length(clusters: &Clusters<'_>, limits: Limits<'_>, walls: &[u32]) -> Check {
    let points_m: Vec<[f32; 3]> = sampled(walls).map(|i| clusters.scene.points_m[i]).collect();
    let up = limits.support.normal.as_vec3().to_array();
    let [_, _, longest_m] = fit_oriented_box(&points_m, up).sides_m();
    Check::new("longest side of the walls", "m", longest_m.into(), Bound::AtMost, LONGEST_M)
}

/// The share of a cluster that faces up, not counting a bottom that it was given.
fn up_share(clusters: &Clusters<'_>, limits: Limits<'_>, id: SegmentId) -> f64 {
    let is_own = |&i: &usize| clusters.at_pixel(i) == Some(id);
    let (up, all) = sampled(&clusters.get(id).pixels).filter(is_own).fold((0, 0), |(up, all), i| {
        let cosine = DVec3::from(clusters.scene.normals[i].map(f64::from)).dot(limits.support.normal);
        (up + u32::from(cosine > UP_COSINE), all + 1)
    });
    f64::from(up) / f64::from(all.max(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::testing::{Table, single};
    use crate::color::image::LabImage;
    use crate::params;

    /// Sizes of the clusters that are left of an image of 60 x 60 px (facet, height).
    fn left(at: impl Fn(usize, usize) -> (i32, f64)) -> Vec<usize> {
        sizes(&Table::new((60, 60), |u, v| Some(at(u, v))))
    }

    /// Sizes of the clusters that are left.
    fn sizes(table: &Table) -> Vec<usize> {
        let scene = table.scene();
        let mut clusters = single(&scene);
        let params = params::Vessels::default();
        let limits = Limits { support: scene.ground().unwrap(), params: &params };
        let mut misses = Vec::new();
        while join_box(&mut clusters, limits, &mut misses) {}
        clusters.alive().into_iter().map(|id| clusters.get(id).pixels.len()).collect()
    }

    /// A box 12 cm deep in the image, seen from above: its bottom is table, walls slope up to 6 cm around it. The thing before it, facet
    /// `near`, is as high as `near_m` says by its row.
    fn seen_box(near: i32, near_m: impl Fn(usize) -> f64) -> impl Fn(usize, usize) -> (i32, f64) {
        move |u, v| {
            let is_box = (10..50).contains(&u) && (10..52).contains(&v);
            let out = [22_usize.saturating_sub(u), u.saturating_sub(37), 22_usize.saturating_sub(v)];
            let out = out.into_iter().max().unwrap_or(0);
            match v {
                _ if !is_box || v < 40 && out == 0 => (0, 0.0),
                40.. => (near, near_m(v)),
                _ => (1, 0.06 * out as f64 / 12.0),
            }
        }
    }

    /// The height of a near wall by its row.
    fn near_wall_m(v: usize) -> f64 {
        0.06 * (52 - v) as f64 / 12.0
    }

    #[test]
    fn walls_around_a_patch_of_table_are_a_box_with_its_bottom() {
        assert_eq!(left(seen_box(2, near_wall_m)), [40 * 42]);
        assert_eq!(left(seen_box(1, near_wall_m)), [40 * 42], "joined by another rule");
    }

    #[test]
    fn what_shows_its_top_or_is_lower_is_no_wall() {
        assert_eq!(left(seen_box(2, |_| 0.06)).len(), 2, "a solid thing before an inside");
        assert_eq!(left(seen_box(2, |v| near_wall_m(v) / 2.0)).len(), 2, "something lower");
    }

    #[test]
    fn what_lies_in_a_box_stays_apart() {
        let empty = seen_box(2, near_wall_m);
        let is_thing = |u: usize, v: usize| (22..30).contains(&u) && (22..40).contains(&v);
        let at = |u, v| if is_thing(u, v) { (3, 0.05) } else { empty(u, v) };
        assert_eq!(left(at), [40 * 42 - 8 * 18, 8 * 18]);
    }

    /// A regression: the bottom of a plate beside a cup went to the cup.
    #[test]
    fn what_goes_on_beside_a_wall_is_no_bottom() {
        let at = |u: usize, v: usize| match (u, v) {
            (20..40, 20..40) => (0, 0.0),
            (8..20, 20..30) => (1, 0.06 * (20 - u) as f64 / 12.0),
            (8..20, 30..40) => (1, 0.06 * (u - 7) as f64 / 12.0),
            _ => (2, 0.005),
        };
        assert_eq!(left(at), [240, 3600 - 240 - 400]);
    }

    #[test]
    fn a_shadow_at_the_wall_hides_it_not() {
        let empty = seen_box(2, near_wall_m);
        let table = Table::new((60, 60), |u, v| (v != 39 || !(10..50).contains(&u)).then(|| empty(u, v)));
        assert_eq!(sizes(&table), [40 * 42 - 40]);
    }

    /// A regression: tall things around a pocket of the table became a box in heaps.
    #[test]
    fn walls_of_other_colors_are_other_things() {
        let seen = seen_box(2, near_wall_m);
        let mut table = Table::new((60, 60), |u, v| Some(seen(u, v)));
        let (red, blue) = ([50.0, 60.0, 40.0], [30.0, 20.0, -60.0]);
        table.lab = Some(LabImage::drawn((60, 60), |_, v| if v < 40 { red } else { blue }));
        assert_eq!(sizes(&table).len(), 2);
    }
}
