//! Explanations from outside, on small scenes made here.

mod common;

use std::time::Duration;

use common::{cut_box, stack, two_boxes};
use objecthood::clusters::history::Rule;
use objecthood::explain::{Decision, Explainer, Explanation, Flip, Outcome, Question, Reason};
use objecthood::{Camera, Error, Frame, Method, Params, Pipeline, Raster};
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
