//! Searches for repairs, on small scenes made here: whether what they find is true.

mod common;

use common::{RED, cut_box, stack_of, two_boxes};
use objecthood::explain::{Belonging, Explainer, Others, Pixels, Repair, RepairSearch, Value};
use objecthood::{Discovery, Error, Frame, Method, ObjectId, Params, Pipeline, discover};

/// An explainer of a frame with the default parameters.
fn explained(frame: &Frame) -> Explainer {
    Explainer::new(&Pipeline::default(), frame, &Params::default()).expect("the scene is valid")
}

/// Tries all parameters.
fn searched(explainer: &Explainer, pixels: Pixels) -> RepairSearch {
    let mut search = RepairSearch::new(explainer, pixels).expect("pixels of the image");
    while search.step(explainer) {}
    search
}

/// What is found with a repair. The kind of the sensor sets its sideways noise too, so it is left out.
fn repaired(frame: &Frame, repair: &Repair) -> Option<Discovery> {
    let params = match &repair.to {
        Value::Number(to) => Params::default().with_number(&repair.parameter, *to),
        _ if repair.parameter == "sensor.profile" => return None,
        to => Params::default().with_choice(&repair.parameter, &to.to_string()),
    };
    Some(discover(frame, &params.expect("the value is allowed")).expect("the scene is valid"))
}

/// Checks what holds of every search, and that each repair turns the answer, by running the method once more.
fn check(frame: &Frame, search: &RepairSearch, is_turned: impl Fn(&Discovery) -> bool) {
    let readers = Params::table().into_iter().filter(|info| info.first_stage(Method::Context).is_some());
    assert_eq!((search.tried, search.left.len()), (readers.count(), 0));
    assert!(search.found.windows(2).all(|pair| pair[0].rank(&pair[1]).is_lt()), "the best first");
    for repair in &search.found {
        assert!(repair.from != repair.to && repair.change > 0.0, "{repair:?}");
        assert!(repaired(frame, repair).is_none_or(|found| is_turned(&found)), "{repair:?}");
    }
}

fn at(found: &Discovery, [u, v]: [usize; 2]) -> u16 {
    *found.labels.get(u, v).expect("a pixel of the image")
}

#[test]
fn an_object_is_made_none_and_the_table_an_object() {
    let frame = two_boxes();
    let explainer = explained(&frame);
    let pixel = explainer.pixel_of(ObjectId(2)).expect("there are two objects");
    let search = searched(&explainer, Pixels { pixel, with: None });
    assert_eq!(search.now, Belonging::Object { object: 2 });
    check(&frame, &search, |found| at(found, pixel) == 0);
    let size = search.found.iter().find(|repair| repair.parameter == "objectness.min_size_px");
    assert!(size.is_some_and(|size| size.change > 1.0), "it is larger than the least size: {size:?}");
    // The boxes differ: something drops one of them alone.
    assert_eq!(search.found[0].others, Others::default());

    let pixel = [5, 235];
    let search = searched(&explainer, Pixels { pixel, with: None });
    assert_eq!(search.now, Belonging::NoObject);
    check(&frame, &search, |found| at(found, pixel) > 0);
}

/// Of one colour: what depth joins, colour parts again (docs/CONTEXT.md 2.3, 3.4), so that no single parameter joins two colours.
#[test]
fn two_objects_become_one() {
    let frame = stack_of([RED; 2]);
    let explainer = explained(&frame);
    let [a, b] = [1, 2].map(|id| explainer.pixel_of(ObjectId(id)).expect("there are two objects"));
    let search = searched(&explainer, Pixels { pixel: a, with: Some(b) });
    assert_eq!(search.now, Belonging::TwoObjects { objects: [1, 2] });
    assert!(!search.found.is_empty());
    check(&frame, &search, |found| at(found, a) > 0 && at(found, a) == at(found, b));
    assert_eq!(search, searched(&explainer, search.pixels), "the same again");
}

#[test]
fn one_object_is_parted_and_not_lost() {
    let frame = cut_box();
    let explainer = explained(&frame);
    // To the left and to the right of the pole.
    let Discovery { objects, labels, .. } = explainer.discovery();
    let joined = objects.iter().find(|object| !object.joins.is_empty()).expect("the box is one");
    let own: Vec<usize> = (0..labels.len()).filter(|&i| labels[i] == joined.id.0).collect();
    let row = own[own.len() / 2] / labels.width();
    let in_row: Vec<usize> = own.into_iter().filter(|i| i / labels.width() == row).collect();
    let inside = |i: usize| [in_row[i] % labels.width(), row];
    let [a, b] = [inside(8), inside(in_row.len() - 9)];
    let search = searched(&explainer, Pixels { pixel: a, with: Some(b) });
    assert!(matches!(search.now, Belonging::OneObject { .. }), "{:?}", search.now);
    assert!(search.found.iter().any(|repair| repair.parameter.starts_with("occlusion.")));
    check(&frame, &search, |found| at(found, a) > 0 && at(found, b) > 0 && at(found, a) != at(found, b));
}

#[test]
fn pixels_outside_the_image_are_refused() {
    let explainer = explained(&two_boxes());
    for (pixel, with) in [([320, 0], None), ([0, 0], Some([0, 240]))] {
        let refused = RepairSearch::new(&explainer, Pixels { pixel, with });
        assert!(matches!(refused, Err(Error::OutsideImage { .. })));
    }
}
