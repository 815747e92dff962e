//! Scenes of boxes seen from the front and above, and scenes of pure noise.

use std::collections::BTreeMap;

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::discovery::up::{Up, UpSource};
use crate::params::Params;
use crate::planes::StructurePlane;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::surface::disparity::DisparitySpace;
use crate::testing::{raster, small_size, space};

const SIZE: (usize, usize) = (320, 240);
/// The table, 0.6 m below a camera that looks down by 37 degrees.
const UP: DVec3 = DVec3::new(0.0, -0.8, -0.6);
const BELOW_M: f64 = 0.6;

/// A box in the frame of the table (right, away, up): its centre, half its sides, and its tilt about the right axis.
#[derive(Clone, Copy)]
struct Block {
    middle_m: [f64; 3],
    half_m: [f64; 3],
    tilt_deg: f64,
}

fn block(middle_m: [f64; 3], half_m: [f64; 3]) -> Block {
    Block { middle_m, half_m, tilt_deg: 0.0 }
}

/// Right, away and up of the table in the camera frame.
fn axes() -> [DVec3; 3] {
    [DVec3::X, UP.cross(DVec3::X), UP]
}

fn plane() -> StructurePlane {
    StructurePlane { normal: UP.as_vec3().to_array(), offset_m: BELOW_M as f32, inlier_share: 0.5 }
}

/// The camera of the pictures: 4 px of contact are 8 px at 525 px.
fn camera() -> DisparitySpace {
    space([262.5, 262.5], [159.5, 119.5])
}

fn params() -> Params {
    let mut params = Params::default();
    params.contact.reach_px = 8;
    params
}

fn build(scene: &SupportScene<'_>, params: &Params) -> SupportGraph {
    build_forest(scene, &params.contact, &params.objectness)
}

fn up() -> Up {
    Up { direction: UP.as_vec3().to_array(), source: UpSource::Plane }
}

/// Label, point and normal of a picture of blocks (1, 2, ..) on the table (0).
struct Picture {
    labels: Raster<i32>,
    points_m: Raster<[f32; 3]>,
    normals: Raster<[f32; 3]>,
}

impl Picture {
    fn of(blocks: &[Block]) -> Self {
        let [right, away, up] = axes();
        // The point where the optical axis meets the table.
        let origin = DVec3::new(0.0, 0.0, BELOW_M / 0.6);
        let hit = |i: usize| {
            let [u, v] = [(i % SIZE.0) as f64 - 159.5, (i / SIZE.0) as f64 - 119.5];
            let ray = DVec3::new(u / 262.5, v / 262.5, 1.0);
            let mut first = (0, -BELOW_M / UP.dot(ray), UP);
            for (k, block) in blocks.iter().enumerate() {
                let (sin, cos) = libm::sincos(block.tilt_deg.to_radians());
                let own = [right, away * cos - up * sin, up * cos + away * sin];
                let middle =
                    origin + right * block.middle_m[0] + away * block.middle_m[1] + up * block.middle_m[2];
                let (mut enter, mut leave, mut normal) = (f64::NEG_INFINITY, f64::INFINITY, DVec3::ZERO);
                for (axis, half_m) in own.into_iter().zip(block.half_m) {
                    let (along, offset) = (axis.dot(ray), axis.dot(middle));
                    let [a, b] = [-half_m, half_m].map(|side| (offset + side) / along);
                    if a.min(b) > enter {
                        (enter, normal) = (a.min(b), -along.signum() * axis);
                    }
                    leave = leave.min(a.max(b));
                }
                if enter < leave && enter < first.1 {
                    first = (k as i32 + 1, enter, normal);
                }
            }
            (first.0, (ray * first.1).as_vec3().to_array(), first.2.as_vec3().to_array())
        };
        let hits: Raster<_> = raster_of(hit);
        Self { labels: hits.map(|h| h.0), points_m: hits.map(|h| h.1), normals: hits.map(|h| h.2) }
    }

    fn forest(&self, regions: usize) -> SupportGraph {
        self.forest_of(regions, &plane(), &params())
    }

    fn forest_of(&self, regions: usize, plane: &StructurePlane, params: &Params) -> SupportGraph {
        let segments = Segments::from_numbered(self.labels.clone(), regions);
        self.forest_among(&segments, &[*plane], params)
    }

    fn forest_among(&self, regions: &Segments, planes: &[StructurePlane], params: &Params) -> SupportGraph {
        let (up, space) = (&up(), &camera());
        let Self { points_m, normals, .. } = self;
        build(&SupportScene { regions, points_m, normals, planes, up, space }, params)
    }
}

fn raster_of<T>(value: impl FnMut(usize) -> T) -> Raster<T> {
    Raster::from_vec(SIZE.0, SIZE.1, (0..SIZE.0 * SIZE.1).map(value).collect()).unwrap()
}

/// (lower, upper, kind, hidden) of every edge.
fn edges(graph: &SupportGraph) -> Vec<(u32, u32, SupportKind, bool)> {
    graph.edges.iter().map(|e| (e.lower.0, e.upper.0, e.kind, e.hidden)).collect()
}

use SupportKind::{In, Leans, On};

#[test]
fn a_box_on_a_box_stands_on_that_alone() {
    let lower = block([0.0, 0.0, 0.05], [0.12, 0.09, 0.05]);
    for half_m in [0.04, 0.09, 0.15] {
        // First a small upper box, then one that hangs over the edges of the lower one.
        let graph = Picture::of(&[lower, block([0.0, 0.0, 0.14], [half_m, 0.05, 0.04])]).forest(3);
        assert_eq!(edges(&graph), [(0, 1, On, false), (1, 2, On, false)], "{half_m}");
        assert!(graph.edges.iter().all(|e| e.confidence > 0.6 && e.contacts > 50), "{:?}", graph.edges);
        assert!(graph.nodes[2].p_o > 0.999 && graph.nodes[0].p_o == 0.0, "{:?}", graph.nodes);
        assert_eq!(graph.nodes[0].kind, NodeKind::Structure { plane: 0 });
    }
}

/// A regression: at the edge of the seat of a chair some pixels of the floor had the depth of the seat, and the floor carried it.
#[test]
fn pixels_of_a_plane_that_lie_far_from_it_carry_nothing() {
    let shelf = |foot_m: f64| {
        let mut picture = Picture::of(&[block([0.0, 0.0, foot_m + 0.01], [0.15, 0.1, 0.01])]);
        // The lowest rows of the thing have the label of the table.
        let lowest = (0..SIZE.0 * SIZE.1).filter(|&i| picture.labels[i] == 1).max().unwrap_or(0) / SIZE.0;
        for i in (lowest - 3) * SIZE.0..(lowest + 1) * SIZE.0 {
            picture.labels.as_mut_slice()[i] = 0;
        }
        edges(&picture.forest(2))
    };
    assert_eq!(shelf(0.02), [(0, 1, On, false)], "as high as bumps of a floor");
    assert_eq!(shelf(0.25), [(0, 1, On, true)], "its contact is not seen");
}

#[test]
fn boxes_side_by_side_or_one_behind_the_other_do_not_carry_each_other() {
    let left = block([-0.06, 0.0, 0.06], [0.06, 0.05, 0.06]);
    let right = block([0.05, 0.0, 0.04], [0.05, 0.05, 0.04]);
    let graph = Picture::of(&[left, right]).forest(3);
    assert_eq!(edges(&graph), [(0, 1, On, false), (0, 2, On, false)]);
    // The front box hides the lower part of the box behind it, whose face seems to stand on the front box's top.
    let before = block([0.0, -0.05, 0.03], [0.10, 0.05, 0.03]);
    let behind = block([0.0, 0.04, 0.07], [0.05, 0.04, 0.07]);
    let graph = Picture::of(&[before, behind]).forest(3);
    assert_eq!(edges(&graph), [(0, 1, On, false), (0, 2, On, true)]);
    let hidden = graph.edges[1];
    assert!(hidden.confidence > 0.4 && hidden.confidence <= 0.5 && hidden.contacts == 0, "{hidden:?}");
}

#[test]
fn a_board_against_a_box_leans_on_it_and_stands_on_the_table() {
    let wall = block([0.0, 0.1, 0.08], [0.09, 0.04, 0.08]);
    let board = |tilt_deg: f64, half_m: [f64; 3]| {
        let (sin, cos) = libm::sincos(tilt_deg.to_radians());
        // Its upper far edge touches the front of the box, its lower far edge the table.
        let away = 0.06 - half_m[1] * cos - half_m[2] * sin;
        Block { middle_m: [0.0, away, half_m[1] * sin + half_m[2] * cos], half_m, tilt_deg }
    };
    let graph = Picture::of(&[wall, board(20.0, [0.05, 0.008, 0.06])]).forest(3);
    assert_eq!(edges(&graph), [(0, 1, On, false), (0, 2, On, false), (1, 2, Leans, false)]);
    // An upright board touches the box, too; thin or short things do not lean.
    for (tilt_deg, half_m) in
        [(0.0, [0.05, 0.008, 0.06]), (20.0, [0.012, 0.008, 0.06]), (20.0, [0.06, 0.008, 0.025])]
    {
        let graph = Picture::of(&[wall, board(tilt_deg, half_m)]).forest(3);
        assert_eq!(edges(&graph), [(0, 1, On, false), (0, 2, On, false)], "{half_m:?}");
    }
}

/// One region with a bottom and four walls of this height, around a block.
fn framed(rim_m: f64, within: Block) -> Picture {
    let half_m = rim_m / 2.0;
    let far = block([0.0, 0.1, half_m], [0.11, 0.01, half_m]);
    let left = block([-0.1, 0.0, half_m], [0.01, 0.1, half_m]);
    let mirrored = |wall: Block| Block { middle_m: [-wall.middle_m[0], -wall.middle_m[1], half_m], ..wall };
    let bottom = block([0.0, 0.0, 0.005], [0.1, 0.1, 0.005]);
    let mut picture = Picture::of(&[bottom, far, left, mirrored(far), mirrored(left), within]);
    picture.labels = picture.labels.map(|&l| [0, 1, 1, 1, 1, 1, 2][l as usize]);
    picture
}

#[test]
fn what_stands_within_a_frame_lies_in_it() {
    let within = block([0.0, 0.0, 0.05], [0.03, 0.03, 0.04]);
    assert_eq!(edges(&framed(0.06, within).forest(3)), [(0, 1, On, false), (1, 2, In, false)]);
    // With two of the walls gone it is not enclosed.
    let bottom = block([0.0, 0.0, 0.005], [0.1, 0.1, 0.005]);
    let far = block([0.0, 0.1, 0.03], [0.11, 0.01, 0.03]);
    let left = block([-0.1, 0.0, 0.03], [0.01, 0.1, 0.03]);
    let mut picture = Picture::of(&[bottom, far, left, within]);
    picture.labels = picture.labels.map(|&l| [0, 1, 1, 1, 2][l as usize]);
    assert_eq!(edges(&picture.forest(3)), [(0, 1, On, false), (1, 2, On, false)]);
}

/// A regression: of 32 things on plates 14 stood on them, because the lowest that is seen of a ball is as high as the rim.
#[test]
fn what_is_seen_from_the_height_of_the_rim_on_lies_in_its_plate() {
    let above_the_floor = block([0.0, 0.0, 0.033], [0.02, 0.012, 0.015]);
    assert_eq!(edges(&framed(0.024, above_the_floor).forest(3)), [(0, 1, On, false), (1, 2, In, false)]);
}

#[test]
fn waves_are_no_rim_and_a_table_is_no_vessel() {
    let within = block([0.0, 0.0, 0.05], [0.03, 0.03, 0.04]);
    // 8 mm above the bottom.
    assert_eq!(edges(&framed(0.018, within).forest(3)), [(0, 1, On, false), (1, 2, On, false)]);
    let mut small = params();
    small.objectness.max_side_m = 0.2;
    let graph = framed(0.06, within).forest_of(3, &plane(), &small);
    assert!(graph.edges.iter().all(|e| e.kind == On), "{:?}", graph.edges);
}

#[test]
fn what_lies_in_something_unseen_to_touch_it_is_half_as_sure() {
    let floating = block([0.0, 0.0, 0.09], [0.03, 0.03, 0.03]);
    let graph = framed(0.12, floating).forest(3);
    assert_eq!(edges(&graph), [(0, 1, On, false), (1, 2, In, true)]);
    let confidence = graph.edges[1].confidence;
    assert!(confidence > 0.3 && confidence <= 0.5, "{:?}", graph.edges);
}

#[test]
fn far_away_heights_are_the_same_up_to_what_the_sensor_resolves() {
    // The table is seen only beside the box; its plane lies 15 mm above the lower end of the box.
    for (scale, expected) in [(1.0, vec![]), (3.0, vec![(0, 1, On, true)])] {
        let mut picture = Picture::of(&[block([0.0, 0.0, 0.05], [0.05, 0.05, 0.05])]);
        picture.points_m = picture.points_m.map(|p| p.map(|x| x * scale));
        let beside = picture.labels.as_slice().iter().enumerate();
        let labels = beside.map(|(i, &l)| if l == 0 && i >= 20 * SIZE.0 { -1 } else { l }).collect();
        picture.labels = picture.labels.with_data(labels);
        let plane = StructurePlane { offset_m: BELOW_M as f32 * scale - 0.015, ..plane() };
        assert_eq!(edges(&picture.forest_of(2, &plane, &params())), expected, "{scale}");
    }
}

#[test]
fn a_ring_around_a_coin_is_the_same_whatever_their_numbers() {
    let far = block([0.0, 0.035, 0.004], [0.045, 0.01, 0.004]);
    let left = block([-0.035, 0.0, 0.004], [0.01, 0.025, 0.004]);
    let mirrored = |wall: Block| Block { middle_m: [-wall.middle_m[0], -wall.middle_m[1], 0.004], ..wall };
    let coin = block([0.0, 0.0, 0.004], [0.02, 0.02, 0.004]);
    let picture = Picture::of(&[far, left, mirrored(far), mirrored(left), coin]);
    let numbered = |ring: i32, coin: i32| {
        let labels = picture.labels.map(|&l| [0, ring, ring, ring, ring, coin][l as usize]);
        let graph = Picture { labels, points_m: picture.points_m.clone(), normals: picture.normals.clone() }
            .forest(3);
        let name = |node: NodeId| {
            if node.0 == 0 {
                "table"
            } else if node.0 as i32 == ring {
                "ring"
            } else {
                "coin"
            }
        };
        let mut edges: Vec<_> =
            graph.edges.iter().map(|e| (name(e.lower), name(e.upper), e.kind, e.contacts)).collect();
        edges.sort();
        edges
    };
    let edges = numbered(1, 2);
    assert!(edges.len() >= 2, "{edges:?}");
    assert_eq!(numbered(2, 1), edges);
}

#[test]
fn a_hidden_foot_goes_on_to_what_is_below() {
    let lower = block([0.0, 0.05, 0.03], [0.14, 0.09, 0.03]);
    let upper = block([0.0, 0.05, 0.10], [0.05, 0.03, 0.04]);
    // The front thing hides the contact of the other two and the whole front of the lower one.
    let screen = block([0.0, -0.13, 0.10], [0.08, 0.01, 0.10]);
    let graph = Picture::of(&[lower, upper, screen]).forest(4);
    let of_upper: Vec<_> = edges(&graph).into_iter().filter(|e| e.1 == 2).collect();
    assert_eq!(of_upper, [(1, 2, On, true)], "{:?}", graph.edges);
    // Alone it stands on the table; the confidence of a floating thing is 0.
    let floating = block([0.0, 0.0, 0.2], [0.05, 0.03, 0.04]);
    let graph = Picture::of(&[floating]).forest(2);
    assert_eq!(edges(&graph), [(0, 1, On, true)]);
    assert!(graph.edges[0].confidence < 0.05, "{:?}", graph.edges);
}

#[test]
fn nothing_stands_on_a_wall_or_on_nothing() {
    let picture = Picture::of(&[block([0.0, 0.0, 0.05], [0.05, 0.05, 0.05])]);
    let segments = Segments::from_numbered(picture.labels.clone(), 2);
    let wall = StructurePlane { normal: [0.0, 0.6, -0.8], ..plane() };
    let forest_of =
        |segments: &Segments, planes: &[StructurePlane]| picture.forest_among(segments, planes, &params());
    assert_eq!(forest_of(&segments, &[wall]).edges, []);
    let alone = Segments::from_numbered(picture.labels.map(|&l| l - 1), 1);
    assert_eq!(forest_of(&alone, &[]).edges, []);
    let nothing = Segments::from_numbered(picture.labels.map(|_| -1), 0);
    assert_eq!(forest_of(&nothing, &[]), SupportGraph::default());
}

#[test]
fn two_that_carry_each_other_are_one_edge_and_eq_8_is_carried_along() {
    let edge = |lower, upper| SupportEdge::seen(NodeId(lower), NodeId(upper), 1);
    let mut edges = Acyclic::new(4);
    let added: Vec<bool> =
        [(0, 1), (1, 2), (2, 0), (2, 2), (1, 0), (3, 2)].map(|(l, u)| edges.add(edge(l, u))).into();
    assert_eq!(added, [true, true, false, false, false, true]);
    assert_eq!(edges.hand_up(&[0.4, 0.1, 0.9, 0.6]), [0.0, 0.4, 0.6, 0.0]);
}

/// A label map of up to five regions, the first of which are planes, on random points.
fn anything() -> impl Strategy<Value = (Raster<i32>, Raster<[f32; 3]>, Raster<[f32; 3]>)> {
    let coordinate = || prop_oneof![-0.05_f32..0.05, prop::sample::select(vec![0.0, 0.02, -3.0])];
    let point = (coordinate(), coordinate(), prop_oneof![4 => 0.5_f32..0.6, 1 => Just(f32::NAN)]);
    let point = point.prop_map(|(x, y, z)| if z.is_nan() { [f32::NAN; 3] } else { [x, y, z] });
    let normal =
        prop::array::uniform3(-1.0_f32..1.0).prop_map(|n| Vec3::from(n).normalize_or_zero().to_array());
    small_size().prop_flat_map(move |size| {
        (raster(size, -1_i32..5), raster(size, point.clone()), raster(size, normal.clone()))
    })
}

proptest! {
    #[test]
    fn any_regions_make_a_forest(
        (labels, points_m, normals) in anything(),
        planes in prop::collection::vec((prop::array::uniform3(-1.0_f32..1.0), 0.0_f32..1.0), 0..3),
        turn in 0_usize..24,
    ) {
        let planes: Vec<StructurePlane> = planes.into_iter().map(|(n, offset_m)| {
            StructurePlane { normal: Vec3::from(n).normalize_or(Vec3::NEG_Y).to_array(), offset_m, inlier_share: 0.1 }
        }).collect();
        let segments = Segments::from_numbered(labels.clone(), 5);
        let (up, space) = (&up(), &camera());
        let scene = SupportScene { regions: &segments, points_m: &points_m, normals: &normals, planes: &planes, up, space };
        let graph = build(&scene, &params());

        // There are no cycles: nodes without carriers can be removed one after the other.
        let mut left = graph.edges.clone();
        while !left.is_empty() {
            let before = left.len();
            let carried: Vec<NodeId> = left.iter().map(|e| e.upper).collect();
            left.retain(|e| carried.contains(&e.lower));
            prop_assert!(left.len() < before, "a cycle: {left:?}");
        }
        prop_assert!(graph.edges.iter().all(|e| (0.0..=1.0).contains(&e.confidence) && e.upper.0 as usize >= planes.len()));
        prop_assert!(graph.edges.is_sorted_by_key(|e| (e.lower, e.upper)));
        let parents = graph.parents();
        let mut p_o = vec![0.0_f32; 5];
        for e in &graph.edges {
            let lower = &graph.nodes[e.lower.0 as usize];
            p_o[e.upper.0 as usize] = p_o[e.upper.0 as usize].max(lower.p_s).max(lower.p_o);
        }
        prop_assert_eq!(graph.nodes.iter().map(|n| n.p_o).collect::<Vec<_>>(), p_o);

        // A visible plane that faces up and lies below carries every thing without another carrier.
        for thing in planes.len()..5 {
            let own: Vec<DVec3> = segments.members().filter(|m| m.1 == thing && !points_m[m.0][2].is_nan())
                .map(|m| Vec3::from(points_m[m.0]).as_dvec3()).collect();
            let middle = own.iter().sum::<DVec3>() / own.len().max(1) as f64;
            let lowest = own.iter().map(|p| p.dot(UP)).fold(f64::INFINITY, f64::min);
            let is_below = |(k, plane): (usize, &StructurePlane)| {
                let normal = Vec3::from(plane.normal).as_dvec3();
                let above = (normal.dot(middle) + f64::from(plane.offset_m)) / normal.dot(UP);
                let is_seen = segments.members().any(|m| m.1 == k && !points_m[m.0][2].is_nan());
                is_seen && normal.dot(UP) > 0.31 && middle.dot(UP) - above < lowest
            };
            if !own.is_empty() && planes.iter().enumerate().any(is_below) {
                prop_assert!(!parents.get(thing).is_none_or(Vec::is_empty), "{thing} floats");
            }
        }

        // The same forest with other region numbers.
        let movable = 5 - planes.len();
        let moved: Vec<usize> = (0..5).map(|r| if r < planes.len() { r } else { planes.len() + (5 - 1 - r + turn) % movable }).collect();
        let renumbered = labels.map(|&l| if l < 0 { l } else { moved[l as usize] as i32 });
        let regions = &Segments::from_numbered(renumbered, 5);
        let again = build(&SupportScene { regions, ..scene }, &params());
        let named: BTreeMap<_, _> = graph.edges.iter().map(|e| {
            let [lower, upper] = [e.lower, e.upper].map(|n| moved[n.0 as usize] as u32);
            ((lower, upper), (e.kind, e.confidence.to_bits(), e.hidden, e.contacts))
        }).collect();
        let found: BTreeMap<_, _> = again.edges.iter()
            .map(|e| ((e.lower.0, e.upper.0), (e.kind, e.confidence.to_bits(), e.hidden, e.contacts))).collect();
        prop_assert_eq!(found, named);
        for (region, &at) in moved.iter().enumerate() {
            prop_assert_eq!(&again.nodes[at], &graph.nodes[region]);
        }
    }
}
