//! Explanations from outside, on small scenes made here.

mod common;

use std::time::Duration;

use common::{cut_box, stack, two_boxes};
use objecthood::attitude::Attitude;
use objecthood::clusters::history::Rule;
use objecthood::explain::{Decision, Explainer, Explanation, Flip, Outcome, Question, Reason};
use objecthood::oversegment::structure::find_structure;
use objecthood::surface::surfaces::find_surfaces;
use objecthood::{Camera, Error, Frame, Method, Notice, Params, Pipeline, Raster};
use rayon::prelude::*;

/// Explains a pixel and checks what holds of every explanation.
fn checked(explainer: &Explainer, pixel: [usize; 2]) -> Explanation {
    let explanation = explainer.describe(pixel).expect("a pixel of the image");
    let Explanation { depth_m, outcome, facet, object, borders, .. } = &explanation;
    let label = *explainer.discovery().labels.get(pixel[0], pixel[1]).expect("a pixel of the image");
    assert_eq!(object.as_ref().and_then(|object| object.object).unwrap_or(0), label);
    assert_eq!(matches!(outcome, Outcome::Object { .. }), label > 0, "{outcome:?}");
    assert_eq!(depth_m.is_none(), *outcome == Outcome::NoDepth);
    assert_eq!(facet.is_none(), matches!(outcome, Outcome::NoDepth | Outcome::NoFacet));
    if let Some(facet) = facet {
        let residuals = [facet.residual_quanta, facet.mean_residual_quanta];
        assert!(residuals.iter().all(|quanta| quanta.is_finite()) && facet.size_px > 0, "{facet:?}");
    }
    for border in borders {
        let lengths = [border.gap_quanta, border.gap_mm, border.folded_mm, border.stepped_mm];
        let measured = lengths.into_iter().chain(border.mean_angle_deg).chain(border.vote_mm);
        assert!(measured.into_iter().all(f64::is_finite), "{border:?}");
        assert!(border.folded_mm >= 0.0 && border.stepped_mm >= 0.0, "{border:?}");
    }
    let is_consistent = |decision: &Decision| decision.yes == explainer.answer(decision.question);
    assert!(explanation.decisions().all(is_consistent));
    explanation
}

#[test]
fn every_pixel_of_small_scenes_is_explained() {
    let params = Params::default();
    for frame in [two_boxes(), stack(), cut_box()] {
        let explainer = Explainer::new(&Pipeline::default(), &frame, &params).expect("the scene is valid");
        let (width, height) = frame.size();
        for i in (0..width * height).step_by(97) {
            checked(&explainer, [i % width, i / width]);
        }
    }
}

/// A hole that was bridged has a facet, but belongs to nothing: it was called a part of a thing that is too small.
#[test]
fn every_pixel_of_a_scene_with_a_grid_of_holes_is_explained() {
    let whole = two_boxes();
    let (width, height) = whole.size();
    let is_hole = |i: usize| i % width % 4 == 1 && i / width % 4 == 1;
    let depths = whole.depth_m().as_slice().iter().enumerate();
    // From three times as far, surfaces rise by less than a quantum a pixel.
    let depths = depths.map(|(i, &z)| if is_hole(i) { f32::NAN } else { 3.0 * z }).collect();
    let frame = whole.with_depth_m(Raster::from_vec(width, height, depths).expect("the same size"));
    let frame = frame.expect("most depths are left");
    let explainer =
        Explainer::new(&Pipeline::default(), &frame, &Params::default()).expect("the scene is valid");
    let notices = &explainer.discovery().notices;
    assert!(notices.iter().any(|notice| matches!(notice, Notice::HoleGrid { .. })), "{notices:?}");
    let plane = explainer.discovery().structure_planes[0];
    assert!(plane.inlier_share <= 1.0, "{plane:?}");
    let holes = (0..width * height).filter(|&i| is_hole(i) && whole.is_valid(i));
    for i in holes.step_by(7) {
        assert_eq!(checked(&explainer, [i % width, i / width]).outcome, Outcome::NoDepth);
    }
}

/// The tolerance that is printed is that which decided: the parameter, times how far the surface scatters.
#[test]
fn a_pixel_of_a_plane_is_explained_by_the_tolerance_of_that_plane() {
    let (frame, params) = (two_boxes(), Params::default());
    let surfaces = find_surfaces(&frame, &params.sensor, &params.local_fit);
    let attitude = Attitude::of(&frame, &params.gravity);
    let structure = find_structure(frame.depth_m(), &surfaces, &attitude, &params.structure);
    let scale = structure.surfaces[0].scale;
    assert!((scale - 1.0).abs() > 0.1, "a surface without noise scatters less than a Kinect's");
    let explainer = Explainer::new(&Pipeline::default(), &frame, &params).expect("the scene is valid");
    let (width, height) = frame.size();
    let pixels = (0..width * height).step_by(97).map(|i| checked(&explainer, [i % width, i / width]));
    let limits: Vec<f64> = pixels
        .filter(|explanation| explanation.outcome == Outcome::Structure { plane: 1 })
        .flat_map(|explanation| explanation.kept.map_or(Vec::new(), |kept| kept.checks))
        .map(|check| check.limit)
        .collect();
    assert!(!limits.is_empty());
    let own = scale * params.structure.tolerance_quanta;
    assert!(limits.iter().all(|limit| (limit - own).abs() < 1e-12), "{limits:?}");
}

/// They waited for each other for ever where one was handed the other's work while both wanted the same tables.
#[test]
fn questions_of_many_threads_are_answered_as_those_of_one() {
    let (done, answered) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        let (frame, params) = (stack(), Params::default());
        let explainer = Explainer::new(&Pipeline::default(), &frame, &params).expect("the scene is valid");
        let objects = &explainer.discovery().objects;
        let pixels: Vec<_> = objects.iter().filter_map(|object| explainer.pixel_of(object.id)).collect();
        let explain = |&pixel: &[usize; 2]| format!("{:?}", explainer.explain(pixel));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(4).build().expect("four threads");
        let many: Vec<_> = pool.install(|| pixels.par_iter().map(explain).collect());
        let alone = Explainer::new(&Pipeline::default(), &frame, &params).expect("the scene is valid");
        let one: Vec<_> = pixels.iter().map(|&pixel| format!("{:?}", alone.explain(pixel))).collect();
        done.send((many, one)).expect("somebody waits");
    });
    let (many, one) = answered.recv_timeout(Duration::from_secs(120)).expect("no thread waits for another");
    assert!(one.len() > 1);
    assert_eq!(many, one);
}

#[test]
fn the_parts_of_a_box_behind_a_pole_are_one_by_the_rule_that_says_so() {
    let frame = cut_box();
    let params = Params::default();
    let explainer = Explainer::new(&Pipeline::default(), &frame, &params).expect("the scene is valid");
    let joined = explainer.discovery().objects.iter().find(|object| !object.joins.is_empty());
    let pixel = explainer.pixel_of(joined.expect("the box is one").id).expect("it has pixels");
    let explanation = explainer.explain(pixel).expect("a pixel of the image");
    let is_occlusion = |decision: &&Decision| decision.reason == Reason::Rule(Rule::Occlusion);
    let decision = explanation.way.iter().find(is_occlusion).expect("that is why");
    assert!(decision.yes && decision.checks.iter().all(|check| check.holds()), "{decision:?}");
    let &Flip::At { parameter, from, to, .. } = &decision.flip else { panic!("{decision:?}") };
    assert!(parameter.starts_with("occlusion.") && params.number(parameter) == Some(from));
    let other = params.with_number(parameter, to).expect("it is within its range");
    assert!(
        !Explainer::new(&Pipeline::default(), &frame, &other)
            .expect("the scene is valid")
            .answer(decision.question)
    );
}

#[test]
fn an_object_that_is_asked_for_is_explained_at_one_of_its_pixels() {
    let (frame, params) = (two_boxes(), Params::default());
    let explainer = Explainer::new(&Pipeline::default(), &frame, &params).expect("the scene is valid");
    for object in &explainer.discovery().objects {
        let [u, v] = explainer.pixel_of(object.id).expect("it has pixels");
        assert_eq!(explainer.discovery().labels.get(u, v), Some(&object.id.0));
        let kept = checked(&explainer, [u, v]).kept.expect("it is no structure");
        assert!(kept.yes && kept.reason == Reason::Passed && matches!(kept.question, Question::Kept { .. }));
    }
    assert_eq!(explainer.pixel_of(objecthood::ObjectId(9)), None);
}

#[test]
fn what_cannot_be_explained_is_refused() {
    let frame = two_boxes();
    let (width, height) = frame.size();
    let params = Params::default();
    let explainer = Explainer::new(&Pipeline::default(), &frame, &params).expect("the scene is valid");
    for pixel in [[width, 0], [0, height], [usize::MAX, usize::MAX]] {
        let refused = explainer.explain(pixel);
        assert_eq!(refused, Err(Error::OutsideImage { pixel, size: (width, height) }));
    }
    let paper = Params { method: Method::Paper, ..params };
    let refused = Explainer::new(&Pipeline::default(), &frame, &paper).err();
    assert_eq!(refused, Some(Error::OnlyContext { method: "paper".to_owned() }));
}

#[test]
fn odd_images_are_explained_without_a_panic() {
    let params = Params::default();
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 24) as f32
    };
    let camera = Camera::new(60.0, 60.0, 0.0, 0.0).expect("it is a camera");
    for (width, height) in [(1, 1), (1, 300), (300, 1), (2, 2), (7, 7), (40, 30)] {
        // A wall, noise, a few noisy levels, and depths that are out of range.
        for (near, far) in [(1.0, 1.0), (0.1, 20.0), (0.98, 1.02), (1e-3, 0.05)] {
            let depth = (0..width * height).map(|_| near + (far - near) * (random() * 4.0).floor() / 4.0);
            let depth_m = Raster::from_vec(width, height, depth.collect()).expect("one value a pixel");
            let frame = Frame::new(depth_m, None, camera).expect("some depth is valid");
            let explainer =
                Explainer::new(&Pipeline::default(), &frame, &params).expect("any frame can be looked at");
            for i in (0..width * height).step_by(11) {
                checked(&explainer, [i % width, i / width]);
            }
            assert!(explainer.explain([0, 0]).is_ok());
        }
    }
}
