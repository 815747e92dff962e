//! The method `paper` from outside, on small scenes made here.

#[path = "../examples/world/mod.rs"]
mod world;

use objecthood::objectness::gravity::UpSource;
use objecthood::objectness::support::NodeKind;
use objecthood::{
    Camera, Discovery, Error, Frame, Notice, Observer, Params, Raster, Segments, Stage, discover,
    discover_observed,
};
use world::{Solid, snapshot};

const RED: [u8; 3] = [180, 40, 30];
const BLUE: [u8; 3] = [30, 70, 150];

fn two_boxes() -> Frame {
    snapshot(&[
        Solid { base_m: [-0.15, 0.0, 0.0], size_m: [0.18, 0.14, 0.12], yaw_deg: 25.0, color: RED },
        Solid { base_m: [0.17, 0.05, 0.0], size_m: [0.14, 0.14, 0.18], yaw_deg: -30.0, color: BLUE },
    ])
}

/// A box on a box: each has its own colour, the upper one is smaller.
fn stack() -> Frame {
    snapshot(&[
        Solid { base_m: [0.0, 0.0, 0.0], size_m: [0.3, 0.25, 0.12], yaw_deg: 10.0, color: RED },
        Solid { base_m: [0.0, 0.02, 0.12], size_m: [0.14, 0.12, 0.12], yaw_deg: 30.0, color: BLUE },
    ])
}

/// Keeps the label maps of all stages.
#[derive(Default)]
struct Maps(Vec<(&'static str, Segments)>);

impl Observer for Maps {
    fn observe(&mut self, stage: Stage<'_>) {
        match stage {
            Stage::Superpixels(s) => self.0.push(("superpixels", s.clone())),
            Stage::Facets(s) => self.0.push(("facets", s.clone())),
            Stage::Shapes(s) => self.0.push(("shapes", s.clone())),
            _ => {}
        }
    }
}

/// Every fourth pixel of a label map as text: `.` = none or no depth, then 0-9, a-z by first appearance, `#` beyond;
/// and below it a hash of the whole map.
fn drawn(frame: &Frame, label: impl Fn(usize) -> i64) -> String {
    let (width, height) = frame.size();
    let mut seen = Vec::new();
    let mut text = String::new();
    for v in (0..height).step_by(4) {
        for i in (0..width).step_by(4).map(|u| v * width + u) {
            if label(i) < 0 || !frame.is_valid(i) {
                text.push('.');
                continue;
            }
            let number = seen.iter().position(|&l| l == label(i)).unwrap_or_else(|| {
                seen.push(label(i));
                seen.len() - 1
            });
            text.push(char::from_digit(number as u32, 36).unwrap_or('#'));
        }
        text.push('\n');
    }
    // FNV-1a.
    let hash = (0..width * height).fold(0xcbf2_9ce4_8422_2325_u64, |hash, i| {
        (hash ^ label(i) as u64).wrapping_mul(0x0000_0100_0000_01b3)
    });
    format!("{text}{hash:016x}")
}

fn check_golden(name: &str, frame: &Frame) {
    let mut maps = Maps::default();
    let found = discover_observed(frame, &Params::default(), &mut maps).expect("the scene is valid");
    for (stage, segments) in &maps.0 {
        let map = drawn(frame, |i| segments.labels()[i].into());
        insta::assert_snapshot!(format!("{name}_{stage}"), map);
    }
    insta::assert_snapshot!(format!("{name}_objects"), drawn(frame, |i| i64::from(found.labels[i]) - 1));
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
    let found = discover(&two_boxes(), &Params::default()).unwrap();
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
    let found = discover(&stack(), &Params::default()).unwrap();
    let blue = found.labels.as_slice()[90 * 320 + 160];
    assert!(blue > 0, "the upper box is an object");
    let upper = &found.objects[usize::from(blue) - 1];
    assert!(upper.objectness > 0.9, "{upper:?}");
}

/// What holds for every discovery, whatever the frame.
fn check_invariants(frame: &Frame, found: &Discovery) {
    let mut pixels = vec![0; found.objects.len() + 1];
    for (i, &label) in found.labels.as_slice().iter().enumerate() {
        pixels[usize::from(label)] += 1;
        assert!(label == 0 || frame.is_valid(i), "a pixel without depth belongs to an object");
    }
    let mut last = (f32::INFINITY, usize::MAX);
    for (k, object) in found.objects.iter().enumerate() {
        assert_eq!(usize::from(object.id.0), k + 1);
        assert_eq!(object.size_px, pixels[k + 1]);
        let rank = (object.objectness, object.size_px);
        assert!(rank.0 < last.0 || rank.0 == last.0 && rank.1 <= last.1, "objects are sorted");
        last = rank;
        assert!((0.0..=1.0).contains(&object.objectness));
        let numbers = [object.centroid_m, object.box_m.center_m, object.box_m.extents_m].concat();
        assert!(numbers.iter().all(|x| x.is_finite()));
        let norm: f32 = object.box_m.rotation_xyzw.iter().map(|q| q * q).sum();
        assert!((norm - 1.0).abs() < 1e-4);
        assert_eq!(found.support.nodes[object.node.0 as usize].kind, NodeKind::Object { object: object.id });
    }
    for edge in &found.support.edges {
        let [lower, upper] = [edge.lower, edge.upper].map(|n| found.support.nodes[n.0 as usize].height_m);
        assert!(lower <= upper, "support leads upwards");
    }
}

#[test]
fn stages_only_coarsen_and_cover_every_labelled_pixel() {
    for frame in [two_boxes(), stack()] {
        let mut maps = Maps::default();
        let found = discover_observed(&frame, &Params::default(), &mut maps).unwrap();
        check_invariants(&frame, &found);
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
        pool.install(|| discover(&frame, &Params::default()).unwrap().labels)
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
        discover(&frame, &Params::default()).unwrap().labels
    };
    let black = with_holes(Some([0; 3]));
    assert!(black == with_holes(None) && black == with_holes(Some([255; 3])));
}

#[test]
fn depth_alone_will_do() {
    let boxes = two_boxes();
    let frame = Frame::new(boxes.depth_m().clone(), None, boxes.camera()).unwrap();
    let found = discover(&frame, &Params::default()).unwrap();
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
        let found = discover(&frame, &Params::default()).unwrap();
        assert!(found.objects.is_empty());
        check_invariants(&frame, &found);
    }
    let one = Frame::new(Raster::filled(1, 1, 1.0).unwrap(), None, camera).unwrap();
    assert!(discover(&one, &Params::default()).unwrap().notices.contains(&Notice::NoPlane));
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
        check_invariants(&frame, &discover(&frame, &Params::default()).unwrap());
    }
}

#[test]
fn parameters_outside_their_range_are_refused() {
    let mut params = Params::default();
    params.appearance.lab_bins = 0;
    let refused = discover(&two_boxes(), &params);
    assert!(
        matches!(refused, Err(Error::BadParameter { parameter, .. }) if parameter == "appearance.lab_bins")
    );
}
