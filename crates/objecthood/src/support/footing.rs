//! Footing: whether a thing goes down to the structure, hangs in the air, lies below everything that could
//! carry it, or goes on out of sight behind the edge of a surface (docs/CONTEXT.md 6.7).
//! What lies below a thing is 6.7.1, what lies above it 6.7.2.

use std::ops::Range;

use glam::DVec3;

use crate::discovery::ids::NodeId;
use crate::discovery::object::OrientedBox;
use crate::discovery::support_graph::SupportGraph;
use crate::oriented_box::fit_oriented_box;
use crate::params;
use crate::raster::Raster;
use crate::regions::SegmentId;
use crate::support::column::{LEAST_AIR_M, Place, STEP_M, places, steps_in};
use crate::support::load::{Load, is_level, level_plane, what_is_carried};
use crate::support::post::{Post, is_hidden_beyond};
use crate::support::scene::SupportScene;

/// About this many pixels of a thing are looked at.
const COLUMNS: usize = 300;
/// A column is followed for at most this length (m) below a pixel: what hangs higher is no graspable thing's foot.
const DEEPEST_M: f64 = 0.6;
/// This share of the columns is enough: going down to the structure for footing 1, ending in the image for
/// full doubt, and ending on a load above a post for a full load.
const ENOUGH: f32 = 0.25;
/// Level surfaces at least twice this far apart (m) are two boards. By noise, the foot of a thing lies at
/// most this far (m) below its carrier.
const LOWER_M: f64 = 0.1;
/// If at least this share of the columns below a thing is cut, not counting shares that it inherits, its foot
/// is out of sight.
const FOOTLESS_CUT: f32 = 0.5;

/// A board is at least this long (m), and this many times as long as high.
const BOARD_M: f32 = 0.3;
const BOARD_SLIM: f32 = 8.0;

/// An end of a post is hidden if the first other thing in this share of its columns is nearer to the camera.
const HIDDEN_END: f32 = 0.75;
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

/// Measures the footing of every region. It is 1 for the structure. For a thing it grows with the share of
/// its columns that go down to the structure, by themselves or through the footing of what they end on.
///
/// A column goes down from a pixel along gravity. While the image shows the thing itself there, the column is
/// hidden in it. Then it ends in air if what is seen lies behind it for 4 cm. Otherwise it ends on a region.
/// Columns that end in a hole, or not within [`DEEPEST_M`], do not count. Without structure every footing
/// is 1.
///
/// Things are rated from the lowest to the highest. A column that ends on a thing not rated yet, because that
/// thing is higher, counts as if it ended on structure; it adds the share of that thing's own columns that
/// are cut.
///
/// Some doubts about a thing are not handed on to what rests on it. They are applied last: that it seems to
/// carry furniture; that it is a post of which neither end is seen; that nothing carries it in `graph` and it
/// lies below every level surface that is seen; and that it hangs, if it is a board.
///
/// O(regions · columns · steps).
///
/// Source: ours, because people, arms and furniture come in pieces, most of which hang in the air or go on below a table's edge.
pub(crate) fn measure_footing(
    scene: &SupportScene<'_>,
    graph: &SupportGraph,
    objectness: &params::Objectness,
) -> Footing {
    let regions = scene.regions.count();
    let mut found = Footing { held: vec![1.0; regions], cut: vec![0.0; regions] };
    if scene.planes.is_empty() {
        return found;
    }
    let things = Things::of(scene, objectness);
    let carriers = graph.parents();
    let ends: Vec<Vec<End>> = (0..regions).map(|thing| things.ends_below(thing)).collect();
    // What hides the foot of a thing may be higher, so nothing is handed on to it yet.
    for &thing in &things.rising {
        found.cut[thing] = things.judge(&ends[thing], &carriers[thing], &found).own_cut;
    }
    let mut free = vec![1.0_f32; regions];
    for &thing in &things.rising {
        let below = things.judge(&ends[thing], &carriers[thing], &found);
        let [structure, furniture] = things.follow_up(thing, below.own_cut < FOOTLESS_CUT);
        let held = below.held * (1.0 - structure);
        found.held[thing] = if things.is_board[thing] { 1.0 } else { held };
        found.cut[thing] = below.cut;
        free[thing] = if things.is_seen_between(thing) { 0.0 } else { held * (1.0 - furniture) };
    }
    // The board of a shelf may lie lowest, or seem to carry another: what stands on it shall not share its doubt.
    for &thing in &things.rising {
        found.held[thing] = free[thing];
        if carriers[thing].is_empty() && things.lies_below_every_surface(thing) {
            found.held[thing] = 0.0;
        }
    }
    found
}

/// What the columns below a thing tell.
struct Below {
    /// How much they say that it is held, in [0, 1].
    held: f32,
    /// The share of them that is cut, in [0, 1]; those that end on another thing count by its share.
    cut: f32,
    /// The share that is cut before it ends on another thing, in [0, 1].
    own_cut: f32,
}

/// The things of a scene, and the pixels of which columns are followed.
struct Things<'a> {
    scene: &'a SupportScene<'a>,
    up: DVec3,
    /// The pixels by region; none for the structure.
    pixels: Vec<Vec<usize>>,
    /// The mean height (m) by region; `NaN` for the structure.
    mean_m: Vec<f64>,
    /// Whether each region is too large to be grasped (docs/CONTEXT.md 6.7.3).
    is_furniture: Vec<bool>,
    /// Whether each region looks like a board of furniture (docs/CONTEXT.md 6.7.5).
    is_board: Vec<bool>,
    /// Each region as a post (docs/CONTEXT.md 6.7.4); `None` if it is none.
    posts: Vec<Option<Post>>,
    /// The things from the lowest to the highest.
    rising: Vec<usize>,
}

impl<'a> Things<'a> {
    fn of(scene: &'a SupportScene<'a>, objectness: &params::Objectness) -> Self {
        let runs = scene.regions.runs_of_each();
        let pixels: Vec<Vec<usize>> = runs.map(|region, runs| match region {
            structure if structure < scene.planes.len() => Vec::new(),
            _ => sample(runs, scene.points_m),
        });
        let up = DVec3::from(scene.up.direction.map(f64::from));
        let height_m = |&i: &usize| scene.point_at(i).dot(up);
        let mean_m = |pixels: &Vec<usize>| pixels.iter().map(height_m).sum::<f64>() / pixels.len() as f64;
        let mean_m: Vec<f64> = pixels.iter().map(mean_m).collect();
        let points = |pixels: &[usize]| pixels.iter().map(|&i| scene.points_m[i]).collect::<Vec<_>>();
        let boxes: Vec<OrientedBox> =
            pixels.iter().map(|pixels| fit_oriented_box(&points(pixels), scene.up.direction)).collect();
        let is_furniture = |around: &OrientedBox| {
            let [_, second_m, longest_m] = around.sides_m();
            longest_m > objectness.max_side_m || second_m > objectness.max_second_side_m
        };
        let is_furniture = boxes.iter().map(is_furniture).collect();
        let is_board = boxes.iter().map(is_board).collect();
        let post = |region: usize, runs: &[Range<usize>]| {
            Post::of(&points(&pixels[region]), up).filter(|_| stands_lowest(scene, up, &pixels[region]))?;
            // The sample may be in step with the rows of the image: then it has no width.
            Post::of(&points(&measured(runs, scene.points_m).collect::<Vec<_>>()), up)
        };
        let posts = runs.map(post);
        let mut rising: Vec<usize> = (0..pixels.len()).filter(|&thing| !mean_m[thing].is_nan()).collect();
        rising.sort_by(|&a, &b| mean_m[a].total_cmp(&mean_m[b]));
        Self { scene, up, pixels, mean_m, is_furniture, is_board, posts, rising }
    }

    /// How the columns below a thing end.
    fn ends_below(&self, thing: usize) -> Vec<End> {
        self.pixels[thing].iter().map(|&i| follow(self.scene, self.up, i, thing)).collect()
    }

    /// What the columns below a thing tell. `found`: footing and cut of the regions, as far as they are
    /// rated.
    fn judge(&self, ends: &[End], carriers: &[NodeId], found: &Footing) -> Below {
        let (mut held, mut own_cut, mut inherited, mut followed, mut known) =
            (0.0, 0.0, 0.0, 0.0_f32, 0.0_f32);
        for end in ends {
            match *end {
                End::Air => followed += 1.0,
                End::Region(region) => {
                    let goes_on = level_plane(self.scene, self.up, region.index()).is_some()
                        && !carriers.contains(&NodeId(region.0));
                    if goes_on {
                        own_cut += 1.0;
                    } else {
                        inherited += found.cut[region.index()];
                    }
                    held += found.held[region.index()];
                    followed += 1.0;
                }
                End::Outside => own_cut += 1.0,
                End::Unknown => continue,
            }
            known += 1.0;
        }
        let known = known.max(1.0);
        Below {
            held: rate_columns(held, followed, known),
            cut: (own_cut + inherited) / known,
            own_cut: own_cut / known,
        }
    }

    /// The shares of the columns above a thing that end on structure (docs/CONTEXT.md 6.7.2) and on furniture
    /// (6.7.3, 6.7.4) which it carries, among those that can be followed. `shows_foot`: whether its lower end
    /// is in sight.
    fn follow_up(&self, thing: usize, shows_foot: bool) -> [f32; 2] {
        // Furniture on which it stands is below it.
        let is_above = |region: usize| self.is_furniture[region] && self.mean_m[region] > self.mean_m[thing];
        let post = self.posts[thing].filter(|post| post.is_slim);
        let load = |&i: &usize| {
            let load = what_is_carried(self.scene, self.up, i, thing, shows_foot, is_above);
            let is_free = load.is_none_or(|load| load == Load::Nothing);
            let goes_on = post.is_some_and(|post| is_free && post.goes_on(self.scene, self.up, i, thing));
            if goes_on { Some(Load::Furniture) } else { load }
        };
        let ends: Vec<Load> = self.pixels[thing].iter().filter_map(load).collect();
        // A post is slim: what a quarter of it carries, it carries.
        let enough =
            if post.is_some() { ENOUGH * self.pixels[thing].len() as f32 } else { ends.len() as f32 };
        let count = |load| ends.iter().filter(|&&end| end == load).count() as f32;
        [Load::Structure, Load::Furniture].map(|load| (count(load) / enough.max(1.0)).min(1.0))
    }

    /// Whether a post is seen between two things that hide its ends, as the leg of a table through the back
    /// of a chair (docs/CONTEXT.md 6.7.4).
    fn is_seen_between(&self, thing: usize) -> bool {
        let is_hidden = |way: DVec3| {
            let hidden = |&i: &usize| is_hidden_beyond(self.scene, way, i, thing) == Some(true);
            let pixels = &self.pixels[thing];
            pixels.iter().filter(|i| hidden(i)).count() as f32 >= HIDDEN_END * pixels.len() as f32
        };
        self.posts[thing].is_some() && is_hidden(self.up) && is_hidden(-self.up)
    }

    /// Whether level surfaces are seen and a thing lies below each of them, on average
    /// (docs/CONTEXT.md 6.7.6).
    fn lies_below_every_surface(&self, thing: usize) -> bool {
        let Self { scene, up, pixels, .. } = self;
        let points = pixels[thing].iter().map(|&i| scene.point_at(i));
        let center_m = points.sum::<DVec3>() / pixels[thing].len() as f64;
        let level = scene.planes.iter().filter(|plane| is_level(plane, *up));
        let mut heights_m = level.map(|plane| plane.height_m(center_m)).peekable();
        heights_m.peek().is_some() && heights_m.all(|height_m| height_m < 0.0)
    }
}

/// The footing by sums over columns. `on_structure`: the sum of the footing of what they end on. `followed`:
/// the number that end on a region or in air, of `all` that do not end in a hole. If more than three quarters
/// leave the image, the others count less.
fn rate_columns(on_structure: f32, followed: f32, all: f32) -> f32 {
    let share = |part: f32, of: f32| (part / of.max(1.0) / ENOUGH).min(1.0);
    1.0 - share(followed, all) * (1.0 - share(on_structure, followed))
}

/// Whether a level surface is seen below the pixels, and no other far below that one. Otherwise the pixels
/// may be a thing on the board of a shelf, which is as slim as the leg of a table and as hidden above.
fn stands_lowest(scene: &SupportScene<'_>, up: DVec3, pixels: &[usize]) -> bool {
    let foot = pixels.iter().map(|&i| scene.point_at(i)).min_by(|a, b| a.dot(up).total_cmp(&b.dot(up)));
    let Some(foot) = foot else { return false };
    let level = scene.planes.iter().filter(|plane| is_level(plane, up));
    let below_m = level.map(|plane| plane.height_m(foot)).filter(|&height_m| height_m > -LOWER_M);
    let [nearest_m, deepest_m] = below_m.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height_m| {
        [low.min(height_m), high.max(height_m)]
    });
    nearest_m.is_finite() && deepest_m - nearest_m < 2.0 * LOWER_M
}

/// The pixels with depth in these runs.
fn measured<'a>(
    runs: &'a [Range<usize>],
    points_m: &'a Raster<[f32; 3]>,
) -> impl Iterator<Item = usize> + 'a {
    runs.iter().cloned().flatten().filter(|&i| !points_m[i][2].is_nan())
}

/// Whether a box is that of a board: level, long and thin. A camera below a board of a shelf sees its front
/// edge, but not what carries it (docs/CONTEXT.md 6.7.5).
fn is_board(around: &OrientedBox) -> bool {
    let [long_m, _, high_m] = around.extents_m;
    long_m >= BOARD_M.max(BOARD_SLIM * high_m)
}

/// About [`COLUMNS`] of the pixels with depth in these runs, evenly spread.
fn sample(runs: &[Range<usize>], points_m: &Raster<[f32; 3]>) -> Vec<usize> {
    let step = (runs.iter().map(Range::len).sum::<usize>() / COLUMNS).max(1);
    measured(runs, points_m).step_by(step).collect()
}

/// Follows the column below pixel `i` of a thing.
fn follow(scene: &SupportScene<'_>, up: DVec3, i: usize, thing: usize) -> End {
    let (mut air_m, mut steps) = (0.0, 0);
    for Place { region, farther_m, behind_m } in places(scene, i, -up, DEEPEST_M) {
        steps += 1;
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
    if steps < steps_in(DEEPEST_M) { End::Outside } else { End::Unknown }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discovery::support_graph::{NodeKind, SupportEdge, SupportNode};
    use crate::discovery::up::{Up, UpSource};
    use crate::planes::StructurePlane;
    use crate::regions::Segments;
    use crate::support::testing::table_scene;
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

    /// The front leg of a table that leaves the image above and below was an object.
    #[test]
    fn a_post_that_goes_on_has_no_footing() {
        let held = table_scene(0.0, [0, 160], true, |scene, _| {
            let node = SupportNode { kind: NodeKind::Surface, p_s: 0.0, p_o: 0.0, height_m: 0.0, size_px: 1 };
            let edges = (2..7).map(|upper| SupportEdge::seen(NodeId(0), NodeId(upper), 1)).collect();
            let graph = SupportGraph { nodes: vec![node; scene.regions.count()], edges };
            measure_footing(scene, &graph, &params::Objectness::default()).held
        });
        assert_eq!([held[5], held[6]], [1.0, 0.0], "a post of which the end is seen, and the leg");
    }

    /// A teddy at the lower border of the image was no object, because its arms hang over air.
    #[test]
    fn what_few_columns_show_counts_little() {
        assert_eq!(rate_columns(0.0, 300.0, 300.0), 0.0, "it hangs");
        assert_eq!(rate_columns(0.0, 75.0, 300.0), 0.0, "a quarter of the columns is enough to see it");
        assert_eq!(rate_columns(0.0, 15.0, 300.0), 0.8, "it may go on below the image");
        assert_eq!(rate_columns(0.0, 0.0, 300.0), 1.0, "nothing is seen");
    }

    /// From below only the front edge of a board is seen: what stood on it was taken to hang in the air with it.
    #[test]
    fn a_board_hangs_without_what_stands_on_it() {
        let thing = [100..120, 100..140];
        let on = |columns| footing_of(&[[columns, 140..148], thing.clone()])[2..].to_vec();
        assert_eq!(on(60..160), [0.0, 1.0], "46 cm long, 4 cm high");
        assert_eq!(on(85..135), [0.0, 0.0], "23 cm long: a part of something");
    }

    #[test]
    fn what_goes_on_unseen_is_cut() {
        let posts = [[100..120, 200..240], [200..220, 180..240], [200..220, 150..180], [20..40, 180..240]];
        let cut = footing_in(&posts, |post, _| if post == 0 { 0.9 } else { POST_M }, &[2, 5], FLOOR_M).cut;
        assert_eq!(cut[2], 1.0, "by the image");
        assert_eq!(cut[3..5], [1.0, 1.0], "by a surface that carries something else; and what stands on it");
        assert_eq!([cut[0], cut[5]], [0.0, 0.0], "the floor, and what it carries");
    }

    /// The seat of a chair that is seen from behind: its columns end behind the back, which is higher and leaves the image.
    #[test]
    fn what_is_hidden_by_what_leaves_the_image_is_cut() {
        let (seat, back) = ([100..120, 180..190], [90..130, 186..240]);
        let depth = |post, row| if post == 1 { 0.9 - 0.01 * f64::from(240 - row as i32) } else { POST_M };
        let cut = footing_in(&[seat, back], depth, &[], 0.9).cut;
        assert_eq!(cut[2..], [1.0, 1.0]);
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

    /// The legs of a table that are seen through the back of a chair were objects: neither of their ends is seen.
    #[test]
    fn a_post_between_two_things_that_hide_its_ends_has_no_footing() {
        let (back, seat) = ([90..130, 40..100], [90..130, 150..240]);
        let held = |middle: [Range<usize>; 2], hiders: &[[Range<usize>; 2]]| {
            let things: Vec<[Range<usize>; 2]> = [middle].iter().chain(hiders).cloned().collect();
            footing_at(&things, |post, _| if post == 0 { POST_M } else { 0.8 })[2]
        };
        let post = [105..113, 100..150];
        assert_eq!(held(post.clone(), &[back.clone(), seat.clone()]), 0.0);
        assert_eq!(held(post, std::slice::from_ref(&seat)), 1.0, "its upper end is seen");
        assert_eq!(held([95..125, 100..150], &[back, seat]), 1.0, "as wide as a box");
    }

    #[test]
    fn a_hole_that_was_bridged_belongs_to_its_thing() {
        let lowest = |_, row| if row == 139 { f64::NAN } else { POST_M };
        assert_eq!(footing_at(&[[100..120, 100..140]], lowest)[2], 0.0, "it hangs all the same");
    }
}
