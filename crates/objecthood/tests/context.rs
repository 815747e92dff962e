//! The method `context` from outside, on small scenes made here.

mod common;

use common::{Maps, covered_box, cut_box, observed, pole_before_two_boxes, stack, two_boxes};
use objecthood::discovery::{JoinEvidence, NodeKind, UpSource};
use objecthood::{Camera, Discovery, Frame, Method, Notice, Object, Params, Raster, discover};

fn context() -> Params {
    Params { method: Method::Context, ..Params::default() }
}

/// When a change is meant to alter them: `INSTA_UPDATE=always cargo test -p objecthood --test context`.
fn check_golden(name: &str, frame: &Frame) {
    for (stage, map) in common::drawn_stages(frame, &context()) {
        insta::assert_snapshot!(format!("{name}_{stage}"), map);
    }
}

#[test]
fn golden_two_boxes() {
    check_golden("two_boxes", &two_boxes());
}

#[test]
fn golden_stack() {
    check_golden("stack", &stack());
}

#[test]
fn golden_cut_box() {
    check_golden("cut_box", &cut_box());
}

/// Looks at the frame and checks what holds for every discovery, whatever the frame.
fn checked(frame: &Frame) -> (Discovery, Maps) {
    let (found, maps) = observed(frame, &context());
    let stages: Vec<_> = maps.0.iter().map(|(stage, _)| *stage).collect();
    assert_eq!(stages, ["structure", "superpixels", "facets", "shapes"]);
    common::check_scene(&found);
    common::check_edges(&found);
    common::check_descriptions(frame, &found);
    check_nodes(frame, &found);
    found.objects.iter().for_each(|object| check_object(&found, object));
    (found, maps)
}

/// The nodes of the support graph are first the structure planes, then the hypotheses.
fn check_nodes(frame: &Frame, found: &Discovery) {
    let (structure, objects) = found.support.nodes.split_at(found.structure_planes.len());
    let measured = (0..found.labels.len()).filter(|&i| frame.is_valid(i)).count();
    for (plane, node) in structure.iter().enumerate() {
        assert_eq!(node.kind, NodeKind::Structure { plane });
        let size_px = found.structure.as_slice().iter().filter(|&&k| usize::from(k) == plane + 1).count();
        assert_eq!(node.size_px, size_px);
        assert_eq!(found.structure_planes[plane].inlier_share, (size_px as f64 / measured as f64) as f32);
    }
    let marked = objects.iter().filter(|node| node.kind != NodeKind::Surface).count();
    assert_eq!(marked, found.objects.len(), "the others are hypotheses that were refused");
}

/// An object, its evidence and its joins.
fn check_object(found: &Discovery, object: &Object) {
    assert_eq!(object.top_m.is_some(), !found.structure_planes.is_empty());
    assert!(object.objectness >= context().objectness.threshold);
    let nodes = &found.support.nodes;
    for join in &object.joins {
        for part in join.parts {
            let (own, part_px) = (object.box_px, part.box_px);
            assert!(part.size_px > 0 && part.size_px < object.size_px, "{join:?}");
            assert!(part_px.u >= own.u && part_px.u + part_px.width <= own.u + own.width, "{join:?}");
            assert!(part_px.v >= own.v && part_px.v + part_px.height <= own.v + own.height, "{join:?}");
        }
        assert!(join.behind.is_none_or(|node| (node.0 as usize) < nodes.len() && node != object.node));
        if let JoinEvidence::Occlusion(continuation) = join.evidence {
            let shares = [continuation.hidden_share, continuation.seen_through_share];
            let shares = shares.into_iter().chain(continuation.color_overlap);
            assert!(shares.into_iter().all(|share| (0.0..=1.0).contains(&share)), "{continuation:?}");
        }
    }
}

/// The object at a pixel.
fn object_at(found: &Discovery, u: usize, v: usize) -> &Object {
    let label = *found.labels.get(u, v).expect("a pixel of the image");
    assert!(label > 0, "no object at {u}, {v}");
    &found.objects[usize::from(label) - 1]
}

#[test]
fn two_boxes_on_a_table_are_two_objects_that_stand_on_it() {
    let (found, _) = checked(&two_boxes());
    assert_eq!((found.objects.len(), found.structure_planes.len()), (2, 1));
    assert_eq!(found.up.source, UpSource::Plane);
    let tilt_deg = found.up.direction[2].asin().to_degrees();
    assert!((tilt_deg + 37.0).abs() < 0.5, "the camera is tilted by 37 degrees: {:?}", found.up);
    for (u, height_m, longest_m) in [(110, 0.12, 0.18), (200, 0.18, 0.14)] {
        let object = object_at(&found, u, 100);
        assert_eq!(found.support.nodes[object.parents[0].0 as usize].kind, NodeKind::Structure { plane: 0 });
        let top_m = object.top_m.unwrap();
        assert!((top_m - height_m).abs() < 0.005, "{object:?}");
        let [a, b, c] = object.box_m.extents_m;
        assert!((c - height_m).abs() < 0.02 && (a.max(b) - longest_m).abs() < 0.06, "{object:?}");
        assert!(object.joins.is_empty());
    }
}

#[test]
fn the_upper_box_of_a_stack_stands_on_the_lower_one() {
    let (found, _) = checked(&stack());
    assert_eq!(found.objects.len(), 2);
    let (upper, lower) = (object_at(&found, 160, 70), object_at(&found, 160, 130));
    assert_eq!(upper.parents, [lower.node]);
    assert_eq!(lower.parents.len(), 1);
    assert_eq!(found.support.nodes[lower.parents[0].0 as usize].kind, NodeKind::Structure { plane: 0 });
}

#[test]
fn a_box_cut_by_a_pole_is_one_object_of_two_parts_behind_the_pole() {
    let (found, _) = checked(&cut_box());
    assert_eq!(found.objects.len(), 2);
    let (left, right) = (object_at(&found, 130, 90), object_at(&found, 190, 90));
    let pole = object_at(&found, 160, 120);
    assert_eq!(left.id, right.id);
    assert!(pole.id != left.id && pole.joins.is_empty());
    let [join] = &left.joins[..] else { panic!("one join: {left:?}") };
    assert_eq!(join.behind, Some(pole.node));
    assert_eq!(join.parts[0].size_px + join.parts[1].size_px, left.size_px);
    assert!(join.parts[0].box_px.u + join.parts[0].box_px.width < join.parts[1].box_px.u);
    let JoinEvidence::Occlusion(continuation) = join.evidence else { panic!("{join:?}") };
    assert!(continuation.angle_deg < 1.0 && continuation.disagreement_quanta < 0.5, "{continuation:?}");
    assert!(continuation.hidden_share > 0.9 && continuation.seen_through_share < 0.05, "{continuation:?}");
    assert!(continuation.color_overlap > Some(0.9), "{continuation:?}");
}

#[test]
fn without_occlusion_joins_the_cut_box_is_two_objects() {
    let mut params = context();
    params.occlusion.enabled = false;
    let found = discover(&cut_box(), &params).unwrap();
    assert_eq!(found.objects.len(), 3);
    assert!(found.objects.iter().all(|object| object.joins.is_empty()));
}

#[test]
fn two_boxes_behind_a_pole_stay_two() {
    let (found, _) = checked(&pole_before_two_boxes());
    assert_eq!(found.objects.len(), 3);
    assert!(found.objects.iter().all(|object| object.joins.is_empty()));
    assert_ne!(object_at(&found, 120, 90).id, object_at(&found, 190, 100).id);
}

#[test]
fn facets_and_shapes_only_coarsen() {
    for frame in [two_boxes(), stack(), cut_box()] {
        let (_, maps) = checked(&frame);
        let [structure, superpixels, facets, shapes] = [0, 1, 2, 3].map(|k| &maps.0[k].1);
        for i in 0..frame.depth_m().len() {
            assert_eq!(superpixels.at(i).is_some(), frame.is_valid(i), "every measured pixel has one");
            // The structure comes first, under its own numbers.
            assert!(structure.at(i).is_none() || structure.at(i) == superpixels.at(i));
            assert_eq!(facets.at(i).is_some(), shapes.at(i).is_some());
        }
        let mut shape_of = vec![None; facets.count()];
        for (facet, shape) in (0..frame.depth_m().len()).filter_map(|i| Some((facets.at(i)?, shapes.at(i)))) {
            assert_eq!(*shape_of[facet.index()].get_or_insert(shape), shape, "a facet was cut");
        }
    }
}

#[test]
fn labels_are_the_same_on_any_number_of_threads() {
    for frame in [two_boxes(), stack(), cut_box()] {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool.install(|| discover(&frame, &context()).unwrap());
            (format!("{:?} {:?} {:?}", found.objects, found.support, found.structure_planes), found)
        };
        let (text, one) = on(1);
        for threads in [2, 8, 8] {
            let (again, found) = on(threads);
            assert!(found.labels == one.labels && found.structure == one.structure, "{threads} threads");
            assert_eq!(again, text, "{threads} threads");
        }
    }
}

#[test]
fn colour_decides_about_parts_behind_an_occluder_and_about_outlines() {
    let without_color = |frame: &Frame| Frame::new(frame.depth_m().clone(), None, frame.camera()).unwrap();
    for frame in [two_boxes(), stack(), cut_box()] {
        let (with, without) = (checked(&frame).0, checked(&without_color(&frame)).0);
        // Skirts (docs/CONTEXT.md 1.1.9) move outlines by pixels; what is an object stays.
        let objects = without.labels.as_slice().iter().filter(|&&label| label > 0).count();
        let pairs = with.labels.as_slice().iter().zip(without.labels.as_slice());
        let moved = pairs.filter(|(with, without)| with != without).count();
        assert_eq!(with.objects.len(), without.objects.len());
        assert!(50 * moved < objects, "{moved} of {objects} pixels");
    }
    // What shows right of the pole, in another colour, is no part of the same box.
    let frame = cut_box();
    let labels = checked(&frame).0.labels;
    let mut color = frame.color().unwrap().clone();
    let boxed = labels.get(190, 90);
    for (i, color) in color.as_mut_slice().iter_mut().enumerate() {
        if i % 320 > 160 && boxed == Some(&labels[i]) {
            *color = [20, 200, 230];
        }
    }
    let painted = Frame::new(frame.depth_m().clone(), Some(color), frame.camera()).unwrap();
    assert_eq!(checked(&painted).0.objects.len(), 3);
}

const SMALL: Camera = Camera { fx_px: 525.0, fy_px: 525.0, cx_px: 20.0, cy_px: 15.0 };

#[test]
fn tiny_images_are_no_error() {
    for (width, height) in [(1, 1), (1, 2), (2, 1), (1, 700), (700, 1), (2, 2), (3, 5), (7, 7), (2, 300)] {
        for f in [1.0, 60.0, 525.0, 5000.0] {
            let camera = Camera::new(f, f, 0.0, 0.0).unwrap();
            let depth_m = Raster::filled(width, height, 1.0).unwrap();
            let frame = Frame::new(depth_m, None, camera).unwrap();
            checked(&frame);
        }
    }
    let one = Frame::new(Raster::filled(1, 1, 1.0).unwrap(), None, SMALL).unwrap();
    let found = discover(&one, &context()).unwrap();
    assert!(found.objects.is_empty() && found.structure_planes.is_empty());
    assert_eq!(found.notices, [Notice::NoPlane]);
}

#[test]
fn depth_out_of_range_is_no_depth() {
    for z in [1e-30, 1e-3, 0.09, 21.0, 1e6, 1e13] {
        let frame = Frame::new(Raster::filled(40, 30, z).unwrap(), None, SMALL).unwrap();
        let (found, maps) = checked(&frame);
        assert!(found.objects.is_empty() && found.structure_planes.is_empty(), "{z} m");
        assert!(maps.0.iter().all(|(_, s)| s.labels().as_slice().iter().all(|&l| l < 0)), "{z} m");
        assert_eq!(found.notices[0], Notice::NoPlane);
    }
}

#[test]
fn a_wall_is_structure_and_no_object() {
    let camera = Camera::new(262.5, 262.5, 159.5, 119.5).unwrap();
    for z in [0.2, 0.5, 1.0, 5.0, 19.0] {
        let frame = Frame::new(Raster::filled(320, 240, z).unwrap(), None, camera).unwrap();
        let (found, _) = checked(&frame);
        let [wall] = &found.structure_planes[..] else { panic!("{z} m: {:?}", found.structure_planes) };
        assert!(found.objects.is_empty() && wall.normal[2] < -0.999, "{z} m: {wall:?}");
        assert!((wall.offset_m / z - 1.0).abs() < 1e-3 && wall.inlier_share > 0.99, "{z} m: {wall:?}");
    }
}

/// Nor does it take long: once, in small images single pixels were facets that any other could continue.
#[test]
fn noise_is_no_error() {
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 24) as f32
    };
    for (near, far, f) in [
        (0.0, 1.0, 70.0),
        (0.0, 1e-30, 70.0),
        (0.0, 1e13, 70.0),
        (0.1, 20.0, 525.0),
        (1.0, 1.01, 525.0),
        (0.5, 0.6, 1e7),
        (0.5, 0.6, 1e-3),
    ] {
        let depth = (0..80 * 60).map(|_| near + (far - near) * random()).collect();
        let color = (0..80 * 60).map(|_| [0, 1, 2].map(|_| (random() * 255.0) as u8)).collect();
        let frame = Frame::new(
            Raster::from_vec(80, 60, depth).unwrap(),
            Some(Raster::from_vec(80, 60, color).unwrap()),
            Camera::new(f, f, 39.5, 29.5).unwrap(),
        )
        .unwrap();
        checked(&frame);
    }
}

#[test]
fn parameters_at_the_ends_of_their_ranges_are_no_error() {
    let frame = cut_box();
    let mut none = context();
    none.merging.min_facet_px = 0;
    none.fragments.max_size_px = 0;
    none.objectness.min_size_px = 1;
    none.height.min_top_m = -1.0;
    none.watershed.seed_block_px = 1;
    let mut all = context();
    all.local_fit.radius_px = 50;
    all.watershed.seed_block_px = 1000;
    all.merging.min_facet_px = 1_000_000;
    all.fragments.max_size_px = 1_000_000;
    for params in [none, all] {
        discover(&frame, &params).unwrap();
    }
}

/// A level table 0.6 m straight below the camera, with things of these heights (m) by place on the table (m right, m down).
fn seen_from_above(height_m: impl Fn(f64, f64) -> f64) -> Frame {
    let camera = Camera::new(525.0, 525.0, 319.5, 239.5).expect("these are intrinsics of a camera");
    let depth_m = |i: usize| {
        let [x, y, _] = camera.ray((i % 640) as f64, (i / 640) as f64);
        (0.6 - height_m(0.6 * x, 0.6 * y)) as f32
    };
    let depth_m = Raster::from_vec(640, 480, (0..640 * 480).map(depth_m).collect());
    Frame::new(depth_m.expect("one depth a pixel"), None, camera).expect("the table has depth")
}

/// A regression: what is thinner than 2 cm in two directions was no object, however clearly it was seen.
#[test]
fn a_marker_is_an_object() {
    let is_marker = |x: f64, y: f64| (0.0..0.13).contains(&x) && (0.0..0.014).contains(&y);
    let found =
        discover(&seen_from_above(|x, y| if is_marker(x, y) { 0.014 } else { 0.0 }), &context()).unwrap();
    assert_eq!(found.objects.len(), 1);
    assert!(found.objects[0].size_px > 1200, "{:?}", found.objects[0]);
}

/// A regression: to a time of flight, which sees sides set back behind the edges of tops, most boxes were two objects.
#[test]
fn a_level_top_is_one_with_the_side_below_its_edge_and_a_board_is_not() {
    let objects = |board_m, overhang_m| {
        let found = discover(&covered_box(board_m, overhang_m), &context()).unwrap();
        found.objects.len()
    };
    assert_eq!(objects(0.002, 0.012), 1, "a lid");
    assert_eq!(objects(0.030, 0.012), 2, "a board has a side of its own");
    assert_eq!(objects(0.002, 0.060), 2, "a tray on a box is wider");
}

/// A regression: nothing was known of what carries a thing, and it lost as much as if nothing carried it.
#[test]
fn without_a_surface_that_carries_support_says_nothing() {
    let is_box = |u: usize, v: usize| {
        [100, 350].iter().any(|&left| (left..left + 100).contains(&u)) && (190..290).contains(&v)
    };
    let depth_m = |i: usize| if is_box(i % 640, i / 640) { 0.7 } else { f32::NAN };
    let depth_m = Raster::from_vec(640, 480, (0..640 * 480).map(depth_m).collect()).unwrap();
    let camera = Camera::new(525.0, 525.0, 319.5, 239.5).unwrap();
    let (found, _) = checked(&Frame::new(depth_m, None, camera).unwrap());
    assert_eq!((found.structure_planes.len(), found.objects.len()), (0, 2));
    assert!(found.objects.iter().all(|object| object.parts.support == 1.0), "{:?}", found.objects);
}

/// A regression: at a short focal length the holes of registered depth stayed, because surfaces rise by more than a quantum a pixel.
#[test]
fn a_grid_of_holes_changes_no_object() {
    let whole = two_boxes();
    let seen = |(i, &z): (usize, &f32)| if i % 320 % 5 == 2 && i / 320 % 5 == 2 { f32::NAN } else { z };
    let depth_m = whole.depth_m().as_slice().iter().enumerate().map(seen).collect();
    let depth_m = Raster::from_vec(320, 240, depth_m).unwrap();
    let holes = Frame::new(depth_m, whole.color().cloned(), whole.camera()).unwrap();
    let [whole, holes] = [&whole, &holes].map(|frame| discover(frame, &context()).unwrap());
    assert_eq!(holes.objects.len(), whole.objects.len());
    for object in &whole.objects {
        let labels = || holes.labels.as_slice().iter().zip(whole.labels.as_slice());
        let same = labels().filter(|&(&a, &b)| a == object.id.0 && a == b).count();
        assert!(same as f64 > 0.95 * 0.96 * object.size_px as f64, "{same} of {}", object.size_px);
    }
}
