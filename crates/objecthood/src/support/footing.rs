//! Footing: whether a thing goes down to the structure, is seen to hang in the air, lies below all that could carry it, or goes on behind
//! the edge of a surface (docs/CONTEXT.md 6.7).

use std::ops::Range;

use glam::DVec3;

use crate::discovery::ids::NodeId;
use crate::discovery::support_graph::SupportGraph;
use crate::objectness::size::is_too_large;
use crate::oriented_box::fit_oriented_box;
use crate::params;
use crate::raster::Raster;
use crate::regions::SegmentId;
use crate::support::column::{LEAST_AIR_M, Place, STEP_M, places};
use crate::support::load::{LEVEL, Load, what_is_carried};
use crate::support::scene::SupportScene;

/// About this many pixels of a thing are looked at.
const COLUMNS: usize = 300;
/// A column is followed for at most this length (m) below a pixel: what hangs higher is no graspable thing's foot.
const DEEPEST_M: f64 = 0.6;
/// From this share of columns on that go down to the structure, the footing is 1: a thing may overhang with the rest.
const ENOUGH: f32 = 0.25;

/// How a column below a pixel ends.
enum End {
    /// Something farther is seen through it.
    Air,
    /// On a region, or behind it.
    Region(SegmentId),
    /// It leaves the image.
    Outside,
    /// In a hole, or not within its greatest length.
    Unknown,
}

/// What the columns below the regions tell.
#[derive(Clone, Debug)]
pub(crate) struct Footing {
    /// The footing of every region, in [0, 1].
    pub held: Vec<f32>,
    /// The share of its columns, in [0, 1], that leave the image or end on a level surface that does not carry it: there it goes on
    /// unseen. A column that ends on another thing counts by that thing's share.
    pub cut: Vec<f32>,
}

/// Measures the footing of every region: 1 for the structure; for a thing, the share of its columns that go down to the structure, by
/// themselves or through the footing of what they end on.
///
/// A column goes down from a pixel along gravity. While the image shows the thing itself there, the column is hidden in it. It then ends in
/// air if what is seen lies behind it for 4 cm. Columns that cannot be followed do not count. Things are rated from the lowest to the
/// highest; something higher than a thing counts as structure for it. A thing that nothing carries in `graph` and
/// that lies below every level surface that is seen has no footing. Without structure every footing is 1. O(regions · columns · steps).
///
/// Source: ours, because people, arms and furniture come in pieces, most of which hang in the air or go on below a table's edge.
pub(crate) fn measure_footing(
    scene: &SupportScene<'_>,
    graph: &SupportGraph,
    objectness: &params::Objectness,
) -> Footing {
    let mut footing = vec![1.0_f32; scene.regions.count()];
    let mut cut = vec![0.0_f32; scene.regions.count()];
    if scene.planes.is_empty() {
        return Footing { held: footing, cut };
    }
    let pixels: Vec<Vec<usize>> = scene.regions.runs_of_each().map(|region, runs| match region {
        structure if structure < scene.planes.len() => Vec::new(),
        _ => sample(runs, scene.points_m),
    });
    let up = DVec3::from(scene.up.direction.map(f64::from));
    let height_m = |i: usize| DVec3::from(scene.points_m[i].map(f64::from)).dot(up);
    let mut things: Vec<(f64, usize)> = (scene.planes.len()..pixels.len())
        .map(|thing| {
            (pixels[thing].iter().map(|&i| height_m(i)).sum::<f64>() / pixels[thing].len() as f64, thing)
        })
        .filter(|(mean_m, _)| !mean_m.is_nan())
        .collect();
    things.sort_by(|a, b| a.0.total_cmp(&b.0));
    let is_furniture: Vec<bool> = pixels
        .iter()
        .map(|pixels| {
            let points: Vec<[f32; 3]> = pixels.iter().map(|&i| scene.points_m[i]).collect();
            !points.is_empty() && is_too_large(&fit_oriented_box(&points, scene.up.direction), objectness)
        })
        .collect();
    let carriers = graph.parents();
    let is_level = |region: SegmentId| {
        scene.planes.get(region.index()).is_some_and(|plane| plane.normal().dot(up) > LEVEL)
    };
    let mut mean_m = vec![f64::NEG_INFINITY; pixels.len()];
    things.iter().for_each(|&(height_m, thing)| mean_m[thing] = height_m);
    let mut free = vec![1.0_f32; pixels.len()];
    for &(_, thing) in &things {
        let (mut held, mut followed, mut gone_on, mut outside) = (0.0, 0.0_f32, 0.0, 0.0_f32);
        for &i in &pixels[thing] {
            let share = match follow(scene, up, i, thing) {
                End::Air => 0.0,
                End::Region(region) => {
                    let carries = carriers[thing].contains(&NodeId(region.0));
                    gone_on += if is_level(region) && !carries { 1.0 } else { cut[region.index()] };
                    footing[region.index()]
                }
                End::Outside => {
                    outside += 1.0;
                    continue;
                }
                End::Unknown => continue,
            };
            (held, followed) = (held + share, followed + 1.0);
        }
        if followed + outside > 0.0 {
            cut[thing] = (gone_on + outside) / (followed + outside);
        }
        if followed > 0.0 {
            footing[thing] = (held / followed / ENOUGH).min(1.0);
        }
        // Furniture on which it stands is below it.
        let is_above = |region: usize| is_furniture[region] && mean_m[region] > mean_m[thing];
        let [structure, furniture] = loads(scene, up, &pixels[thing], thing, is_above);
        footing[thing] *= 1.0 - structure;
        free[thing] = 1.0 - furniture;
    }
    // Last, because the board of a shelf may lie lowest, or seem to carry another, and what stands on it shall not share its doubt.
    for &(_, thing) in &things {
        footing[thing] *= free[thing];
        if carriers[thing].is_empty() && lies_below_every_surface(scene, up, &pixels[thing]) {
            footing[thing] = 0.0;
        }
    }
    Footing { held: footing, cut }
}

/// About [`COLUMNS`] of the pixels with depth in these runs, evenly spread.
fn sample(runs: &[Range<usize>], points_m: &Raster<[f32; 3]>) -> Vec<usize> {
    let measured = || runs.iter().cloned().flatten().filter(|&i| !points_m[i][2].is_nan());
    let step = (runs.iter().map(Range::len).sum::<usize>() / COLUMNS).max(1);
    measured().step_by(step).collect()
}

/// The shares of the columns above these pixels of a thing that end on structure and on furniture which it carries, among those that can be
/// followed.
fn loads(
    scene: &SupportScene<'_>,
    up: DVec3,
    pixels: &[usize],
    thing: usize,
    is_furniture: impl Fn(usize) -> bool,
) -> [f32; 2] {
    let ends: Vec<Load> =
        pixels.iter().filter_map(|&i| what_is_carried(scene, up, i, thing, &is_furniture)).collect();
    let share = |load| ends.iter().filter(|&&end| end == load).count() as f32 / ends.len().max(1) as f32;
    [Load::Structure, Load::Furniture].map(share)
}

/// Whether level surfaces are seen and these pixels of a thing lie below each of them, on average.
fn lies_below_every_surface(scene: &SupportScene<'_>, up: DVec3, pixels: &[usize]) -> bool {
    let center_m = pixels.iter().map(|&i| DVec3::from(scene.points_m[i].map(f64::from))).sum::<DVec3>()
        / pixels.len() as f64;
    let mut heights_m = scene
        .planes
        .iter()
        .filter(|plane| plane.normal().dot(up) > LEVEL)
        .map(|plane| plane.height_m(center_m))
        .peekable();
    heights_m.peek().is_some() && heights_m.all(|height_m| height_m < 0.0)
}

/// Follows the column below pixel `i` of a thing.
fn follow(scene: &SupportScene<'_>, up: DVec3, i: usize, thing: usize) -> End {
    let (mut air_m, mut length_m) = (0.0, 0.0);
    for Place { region, farther_m, behind_m } in places(scene, i, -up, DEEPEST_M) {
        length_m += STEP_M;
        // Asked before the depth: a hole that was bridged is a part of the thing too.
        if region.is_some_and(|region| region.index() == thing) {
            continue;
        }
        if farther_m.is_nan() {
            return if air_m > 0.0 { End::Air } else { End::Unknown };
        }
        if farther_m <= behind_m {
            return region.map_or(End::Unknown, End::Region);
        }
        air_m += STEP_M;
        if air_m >= LEAST_AIR_M {
            return End::Air;
        }
    }
    if length_m < DEEPEST_M - STEP_M { End::Outside } else { End::Unknown }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discovery::support_graph::{NodeKind, SupportEdge, SupportNode};
    use crate::discovery::up::{Up, UpSource};
    use crate::planes::StructurePlane;
    use crate::regions::Segments;
    use crate::surface::disparity::position;
    use crate::testing::space;

    const SIZE: (usize, usize) = (320, 240);
    const FOCAL_PX: f64 = 262.5;
    const FLOOR_M: f64 = 0.5;
    const WALL_M: f64 = 3.0;
    const POST_M: f64 = 1.2;

    /// The footing of posts 1.2 m before a level camera, each in these columns and rows, between a floor and a wall.
    fn footing_of(posts: &[[Range<usize>; 2]]) -> Vec<f32> {
        footing_at(posts, |_, _| POST_M)
    }

    /// The same of posts with a depth (m) by their number and row. The floor carries all of them.
    fn footing_at(posts: &[[Range<usize>; 2]], post_m: impl Fn(usize, usize) -> f64) -> Vec<f32> {
        let carried: Vec<usize> = (2..2 + posts.len()).collect();
        footing_in(posts, post_m, &carried, FLOOR_M).held
    }

    /// All that the columns tell where only these regions are carried, and the level surface is so far below the camera (m).
    fn footing_in(
        posts: &[[Range<usize>; 2]],
        post_m: impl Fn(usize, usize) -> f64,
        carried: &[usize],
        level_m: f64,
    ) -> Footing {
        let space = space([FOCAL_PX; 2], [159.5, 119.5]);
        let seen = |i: usize| {
            let [_, v] = position(i, SIZE.0);
            let floor_m = FLOOR_M * FOCAL_PX / (v - 119.5);
            let behind = if (0.0..WALL_M).contains(&floor_m) { (0, floor_m) } else { (1, WALL_M) };
            let [u, v] = [i % SIZE.0, i / SIZE.0];
            let post = posts.iter().position(|[columns, rows]| columns.contains(&u) && rows.contains(&v));
            // The floor hides what is below it.
            let post = post.map(|post| (2 + post as i32, post_m(post, v)));
            post.filter(|post| post.1.is_nan() || behind.1 >= post.1).unwrap_or(behind)
        };
        let pixels: Vec<(i32, f64)> = (0..SIZE.0 * SIZE.1).map(seen).collect();
        let labels = Raster::from_vec(SIZE.0, SIZE.1, pixels.iter().map(|p| p.0).collect()).unwrap();
        let points_m = labels.with_data(
            (0..pixels.len())
                .map(|i| {
                    let ray = space.camera().ray((i % SIZE.0) as f64, (i / SIZE.0) as f64);
                    ray.map(|x| (x * pixels[i].1) as f32)
                })
                .collect(),
        );
        let normals = points_m.map(|_| [0.0; 3]);
        let planes = [
            StructurePlane { normal: [0.0, -1.0, 0.0], offset_m: level_m as f32, inlier_share: 0.4 },
            StructurePlane { normal: [0.0, 0.0, -1.0], offset_m: WALL_M as f32, inlier_share: 0.4 },
        ];
        let up = Up { direction: [0.0, -1.0, 0.0], source: UpSource::Plane };
        let regions = Segments::from_numbered(labels, 2 + posts.len());
        let scene = SupportScene {
            regions: &regions,
            points_m: &points_m,
            normals: &normals,
            planes: &planes,
            up: &up,
            space: &space,
        };
        let node = SupportNode { kind: NodeKind::Surface, p_s: 0.0, p_o: 0.0, height_m: 0.0, size_px: 1 };
        let edge = |&upper: &usize| SupportEdge::seen(NodeId(0), NodeId(upper as u32), 1);
        let edges = carried.iter().map(edge).collect();
        measure_footing(
            &scene,
            &SupportGraph { nodes: vec![node; regions.count()], edges },
            &params::Objectness::default(),
        )
    }

    #[test]
    fn what_lies_below_every_surface_has_no_footing_and_what_it_carries_has() {
        let posts = [[100..120, 180..240], [100..120, 150..180], [200..220, 180..240]];
        let of = |level_m| footing_in(&posts, |_, _| POST_M, &[3, 4], level_m).held;
        assert_eq!(of(0.2)[2..], [0.0, 1.0, 1.0], "a table 20 cm below the camera, which carries the third");
        assert_eq!(of(FLOOR_M)[2..], [1.0, 1.0, 1.0], "above the floor it is only not known what carries it");
    }

    #[test]
    fn what_stands_on_the_floor_has_a_footing_and_what_hangs_has_none() {
        let footing = footing_of(&[[100..120, 180..240], [200..220, 100..140]]);
        assert_eq!(footing, [1.0, 1.0, 1.0, 0.0], "the floor, the wall, a post on the floor, one in the air");
    }

    #[test]
    fn what_rests_on_something_shares_its_footing() {
        // The lower parts hang in the air or stand; the upper parts rest on them.
        let hanging = footing_of(&[[100..120, 110..140], [100..120, 80..110]]);
        assert_eq!(hanging[2..], [0.0, 0.0]);
        let standing = footing_of(&[[100..120, 170..240], [100..120, 140..170]]);
        assert_eq!(standing[2..], [1.0, 1.0]);
    }

    #[test]
    fn what_is_cut_by_the_image_is_not_seen_to_hang() {
        let cut = footing_of(&[[100..120, 225..240]]);
        assert_eq!(cut[2], 1.0);
    }

    #[test]
    fn what_goes_on_unseen_is_cut() {
        let posts = [[100..120, 200..240], [200..220, 180..240], [200..220, 150..180], [20..40, 180..240]];
        let cut = footing_in(&posts, |post, _| if post == 0 { 0.9 } else { POST_M }, &[2, 5], FLOOR_M).cut;
        assert_eq!(cut[2], 1.0, "by the image");
        assert_eq!(cut[3..5], [1.0, 1.0], "by a surface that carries something else; and what stands on it");
        assert_eq!([cut[0], cut[5]], [0.0, 0.0], "the floor, and what it carries");
    }

    #[test]
    fn a_thing_may_overhang_with_half_of_it() {
        let overhanging = footing_of(&[[100..120, 180..240], [90..130, 150..180]]);
        assert_eq!(overhanging[3], 1.0);
    }

    #[test]
    fn what_is_hidden_below_is_not_seen_to_hang() {
        let (post, screen) = ([100..120, 100..140], [90..130, 130..240]);
        let hidden = footing_at(&[post.clone(), screen], |post, _| if post == 0 { POST_M } else { 0.8 });
        assert_eq!(hidden[2], 1.0, "a nearer thing before its lower end");
        assert_eq!(footing_of(&[post])[2], 0.0);
    }

    #[test]
    fn a_hole_that_was_bridged_belongs_to_its_thing() {
        let lowest = |_, row| if row == 139 { f64::NAN } else { POST_M };
        assert_eq!(footing_at(&[[100..120, 100..140]], lowest)[2], 0.0, "it hangs all the same");
    }
}
