//! The method `paper` from outside, on small scenes made here.

mod common;

use std::collections::HashSet;

use common::{BLUE, Maps, RED, observed, stack, two_boxes};
use objecthood::discovery::{NodeKind, UpSource};
use objecthood::{
    Camera, Discovery, Error, Frame, Method, Notice, Observer, Output, Params, Raster, Segments, discover,
    discover_observed,
};

fn paper() -> Params {
    Params { method: Method::Paper, ..Params::default() }
}

fn check_golden(name: &str, frame: &Frame) {
    for (stage, map) in common::drawn_stages(frame, &paper()) {
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
fn two_boxes_on_a_table_are_two_objects_that_stand_on_it() {
    let found = discover(&two_boxes(), &paper()).unwrap();
    assert_eq!(found.objects.len(), 2);
    assert_eq!(found.up.source, UpSource::Plane);
    for object in &found.objects {
        assert!(object.objectness > 0.95, "{object:?}");
        let table = &found.support.nodes[object.parents[0].0 as usize];
        assert_eq!(table.kind, NodeKind::Surface);
        assert!(table.p_s > 0.95 && table.size_px > 20_000, "{table:?}");
        // Every box is 0.14 m deep or wide and not larger than 0.2 m.
        let [a, b, height] = object.box_m.extents_m;
        assert!(a.max(b) > 0.1 && a.max(b) < 0.25 && height > 0.08 && height < 0.2, "{object:?}");
    }
    // Up is the table's normal: the camera is tilted by 37 degrees.
    let tilt = found.up.direction[2].asin().to_degrees();
    assert!((tilt - -37.0).abs() < 0.5, "{:?}", found.up);
}

#[test]
fn support_reaches_the_upper_box_of_a_stack() {
    let found = discover(&stack(), &paper()).unwrap();
    let seen_at = |u: usize, v: usize| {
        let label = found.labels[v * 320 + u];
        assert!(label > 0, "the box at {u}, {v} is an object");
        &found.objects[usize::from(label) - 1]
    };
    let (upper, lower) = (seen_at(160, 90), seen_at(160, 140));
    assert_eq!(upper.parents, [lower.node]);
    let [table] = lower.parents[..] else { panic!("the lower box stands on the table alone: {lower:?}") };
    let table = &found.support.nodes[table.0 as usize];
    assert_eq!(table.kind, NodeKind::Surface);
    // The lower box shows as much of its front as of its top; it carries because the table carries it.
    let p_o = upper.parts.support;
    assert!(
        found.support.nodes[lower.node.0 as usize].p_s < 0.7 && p_o > 0.9 && p_o == table.p_s,
        "{upper:?}"
    );
}

/// Looks at the frame and checks what holds for every discovery, whatever the frame.
fn checked(frame: &Frame) -> (Discovery, Maps) {
    let (found, maps) = observed(frame, &paper());
    let [_, (_, facets), (_, shapes)] = &maps.0[..] else { panic!("each stage is announced once") };
    common::check_scene(&found);
    common::check_edges(&found);
    common::check_descriptions(frame, &found);
    check_support(frame, &found, shapes);
    check_objects(frame, &found, facets, shapes);
    (found, maps)
}

/// The nodes of the support graph are the shapes.
fn check_support(frame: &Frame, found: &Discovery, shapes: &Segments) {
    let nodes = &found.support.nodes;
    assert_eq!(nodes.len(), shapes.count());
    let mut size_px = vec![0; nodes.len()];
    (0..shapes.labels().len())
        .filter(|&i| frame.is_valid(i))
        .filter_map(|i| shapes.at(i))
        .for_each(|s| size_px[s.index()] += 1);
    assert_eq!(nodes.iter().map(|node| node.size_px).collect::<Vec<_>>(), size_px);
    let objects = nodes.iter().filter(|n| n.kind != NodeKind::Surface).count();
    assert_eq!(objects, found.objects.len());
    for edge in &found.support.edges {
        let [lower, upper] = [edge.lower, edge.upper].map(|node| &nodes[node.0 as usize]);
        assert!(lower.height_m <= upper.height_m && edge.contacts > 0, "support leads upwards: {edge:?}");
    }
}

/// The objects are the shapes marked as such, made of facets.
fn check_objects(frame: &Frame, found: &Discovery, facets: &Segments, shapes: &Segments) {
    let nodes = &found.support.nodes;
    for (i, &label) in found.labels.as_slice().iter().enumerate() {
        let kind = shapes.at(i).filter(|_| frame.is_valid(i)).map(|s| nodes[s.index()].kind);
        let object = if let Some(NodeKind::Object { object }) = kind { object.0 } else { 0 };
        assert_eq!(label, object, "the objects are the shapes marked as such, where there is depth");
    }
    for object in &found.objects {
        let pixels = (0..facets.labels().len()).filter(|&i| found.labels[i] == object.id.0);
        assert_eq!(object.facets, pixels.map(|i| facets.at(i)).collect::<HashSet<_>>().len());
        assert!(object.joins.is_empty() && object.top_m.is_none());
        let p_o = nodes[object.node.0 as usize].p_o;
        assert!(object.parts.support == p_o && p_o >= paper().objectness.min_p_o, "{object:?}");
    }
}

#[test]
fn stages_only_coarsen_and_cover_every_labelled_pixel() {
    for frame in [two_boxes(), stack()] {
        let (found, maps) = checked(&frame);
        assert!(!found.objects.is_empty());
        for pair in maps.0.windows(2) {
            let (fine, coarse) = (&pair[0].1, &pair[1].1);
            let mut parent = vec![None; fine.count()];
            for i in 0..fine.labels().len() {
                assert_eq!(fine.at(i).is_some(), coarse.at(i).is_some());
                if let Some(s) = fine.at(i) {
                    let parent = &mut parent[s.index()];
                    assert!(parent.is_none() || *parent == coarse.at(i), "a segment was cut");
                    *parent = coarse.at(i);
                }
            }
        }
    }
}

#[test]
fn labels_are_the_same_on_any_number_of_threads() {
    let frame = two_boxes();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| discover(&frame, &paper()).unwrap().labels)
    };
    let one = on(1);
    assert!([1, 2, 8].into_iter().all(|threads| on(threads) == one));
}

#[test]
fn the_colour_of_what_has_no_depth_changes_nothing() {
    let mut depth = two_boxes().depth_m().clone();
    // Holes and a crop, as real sensors have.
    for (i, z) in depth.as_mut_slice().iter_mut().enumerate() {
        if i % 197 < 3 || i % 320 > 300 {
            *z = f32::NAN;
        }
    }
    let camera = two_boxes().camera();
    let with_holes = |hole: Option<[u8; 3]>| {
        let mut color = two_boxes().color().unwrap().clone();
        for (i, c) in color.as_mut_slice().iter_mut().enumerate() {
            *c = if depth[i].is_nan() { hole.unwrap_or([(i * 31) as u8, (i * 57) as u8, 9]) } else { *c };
        }
        let frame = Frame::new(depth.clone(), Some(color), camera).unwrap();
        discover(&frame, &paper()).unwrap().labels
    };
    let black = with_holes(Some([0; 3]));
    assert!(black == with_holes(None) && black == with_holes(Some([255; 3])));
}

#[test]
fn depth_alone_will_do() {
    let boxes = two_boxes();
    let frame = Frame::new(boxes.depth_m().clone(), None, boxes.camera()).unwrap();
    let found = discover(&frame, &paper()).unwrap();
    assert_eq!(found.notices, [Notice::NoColor]);
    assert_eq!(found.objects.len(), 2);
}

#[test]
fn tiny_and_odd_images_are_no_error() {
    let camera = Camera::new(1.0, 1.0, 0.0, 0.0).unwrap();
    for (width, height) in [(1, 1), (1, 2), (2, 1), (1, 7), (7, 1), (2, 2), (3, 5)] {
        let frame = Frame::new(
            Raster::filled(width, height, 1.0).unwrap(),
            Some(Raster::filled(width, height, [9; 3]).unwrap()),
            camera,
        )
        .unwrap();
        assert!(checked(&frame).0.objects.is_empty());
    }
    let one = Frame::new(Raster::filled(1, 1, 1.0).unwrap(), None, camera).unwrap();
    assert!(discover(&one, &paper()).unwrap().notices.contains(&Notice::NoPlane));
}

#[test]
fn noise_is_no_error() {
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 24) as f32
    };
    for scale in [1.0, 1e-30, 1e13] {
        let depth = (0..80 * 60).map(|_| random() * scale).collect();
        let color = (0..80 * 60).map(|_| [0, 1, 2].map(|_| (random() * 255.0) as u8)).collect();
        let frame = Frame::new(
            Raster::from_vec(80, 60, depth).unwrap(),
            Some(Raster::from_vec(80, 60, color).unwrap()),
            Camera::new(70.0, 70.0, 39.5, 29.5).unwrap(),
        )
        .unwrap();
        checked(&frame);
    }
}

#[test]
fn parameters_outside_their_range_are_refused() {
    let mut params = paper();
    params.appearance.lab_bins = 0;
    let refused = discover(&two_boxes(), &params);
    assert!(
        matches!(refused, Err(Error::BadParameter { parameter, .. }) if parameter == "appearance.lab_bins")
    );
}

/// Two boxes on a table of which every few pixels have no depth, but the colour `hole`; curvature bounds nothing.
fn superpixels_by_color(hole: impl Fn(usize) -> [u8; 3]) -> Segments {
    let boxes = two_boxes();
    let (mut depth, mut color) = (boxes.depth_m().clone(), boxes.color().expect("it has colour").clone());
    for i in (0..depth.len()).filter(|i| i % 197 < 3 || i % 320 > 300) {
        depth.as_mut_slice()[i] = f32::NAN;
        color.as_mut_slice()[i] = hole(i);
    }
    let mut params = paper();
    params.curvature.enabled = false;
    let mut maps = Maps::default();
    let frame = Frame::new(depth, Some(color), boxes.camera()).expect("the table has depth");
    discover_observed(&frame, &params, &mut maps).expect("the scene is valid");
    maps.0.swap_remove(0).1
}

#[test]
fn without_curvature_what_has_no_depth_is_told_apart_by_colour() {
    // The strip without depth at the right: of one colour, and half red, half blue.
    let at = |u: usize, v: usize| v * 320 + u;
    let plain = superpixels_by_color(|_| RED);
    let halves = superpixels_by_color(|i| if i / 320 < 120 { RED } else { BLUE });
    let (above, below) = (at(310, 60), at(310, 180));
    assert!(plain.at(above).is_some() && plain.at(above) == plain.at(below));
    assert!(halves.at(above).is_some() && halves.at(above) != halves.at(below));
}

/// The curvature of two boxes and whether the superpixels are bounded by it.
#[derive(Default)]
struct Bends(Vec<f32>, Vec<i32>);

impl Observer for Bends {
    fn observe(&mut self, output: Output<'_>) {
        match output {
            Output::Curvature(curvature) => self.0 = curvature.as_slice().to_vec(),
            Output::Superpixels(map) => self.1 = map.segments().labels().as_slice().to_vec(),
            _ => {}
        }
    }
}

#[test]
fn curvature_bounds_superpixels_where_it_is_on_and_grows_with_its_scale() {
    let bends = |enabled: bool, scale: f32| {
        let mut params = paper();
        (params.curvature.enabled, params.curvature.scale) = (enabled, scale);
        let mut bends = Bends::default();
        discover_observed(&two_boxes(), &params, &mut bends).unwrap();
        bends
    };
    let (on, off, scaled) = (bends(true, 1.0), bends(false, 1.0), bends(true, 1.1));
    assert!(on.0 == off.0 && on.1 != off.1, "without it the curvature is known, but bounds nothing");
    // The table is flat: 1 - 1/scale.
    let table = 200 * 320 + 20;
    assert!(on.0[table].abs() < 0.01 && (scaled.0[table] - (1.0 - 1.0 / 1.1)).abs() < 0.01);
    assert_ne!(on.1, scaled.1);
}
