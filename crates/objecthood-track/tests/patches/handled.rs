//! What is told of a thing that a hand pushes, lifts, takes and sets down.

use objecthood::Params;
use objecthood_track::{EventKind, Tracker};

use crate::{Patch, THING, frame};

/// What is told of a thing that a hand reaches: `at` says where the thing is in a frame, and the hand.
fn told_of_handled(at: impl Fn(i32) -> [Patch; 2]) -> Vec<(EventKind, u64)> {
    let mut tracker = Tracker::new(Params::default());
    let mut events = Vec::new();
    for number in 0..140_i32 {
        let (frame, found) = frame(&at(number), &[0], number as u64);
        events.extend(tracker.update_found(&frame, &found, f64::from(number) / 30.0, None).unwrap().events);
    }
    events.extend(tracker.finish());
    events.iter().map(|event| (event.kind, event.frame)).collect()
}

/// A hand before the lower part of a thing pushes it. A regression: what was seen of it was higher than before, so it was lifted.
#[test]
fn what_is_pushed_by_a_hand_before_its_lower_part_is_not_lifted() {
    let told = told_of_handled(|number| {
        let reach = (200 - 5 * number).max(0) + (5 * (number - 80)).max(0);
        let thing = Patch { left: THING.left - (2 * (number - 50)).clamp(0, 20), ..THING };
        let (left, top) = (thing.left + reach, thing.top + 23);
        [thing, Patch { left, top, width: 200, height: 8, depth_m: 0.96, color: [40, 70, 190] }]
    });
    let [(EventKind::Pushed, begun)] = told[..] else { panic!("{told:?}") };
    assert!((44..=56).contains(&begun), "{told:?}");
}

/// A hand lifts a thing by its lower part, and hides that. A regression: less than half of what the lowest point that is seen rose by was motion, so
/// nothing was lifted.
#[test]
fn what_rises_with_a_hand_before_its_lower_part_is_lifted() {
    let told = told_of_handled(|number| {
        let reach = (200 - 5 * number).max(0) + (5 * (number - 105)).max(0);
        let up = (number - 50).clamp(0, 5) - (number - 80).clamp(0, 5);
        let thing = Patch { top: THING.top - up, ..THING };
        let (left, top) = (thing.left + reach, thing.top + 12);
        [thing, Patch { left, top, width: 200, height: 20, depth_m: 0.96, color: [40, 70, 190] }]
    });
    let [(EventKind::PickedUp, taken), ..] = told[..] else { panic!("{told:?}") };
    assert!((48..=56).contains(&taken), "{told:?}");
}

/// A hand still hides an edge of what it set down. A regression: it was set down when the hand was gone, because the middle of what was seen moved then.
#[test]
fn what_is_set_down_is_down_before_the_hand_leaves_it() {
    let told = told_of_handled(|number| {
        let reach = (160 - 5 * number).max(0) + (5 * (number - 105)).max(0);
        let up = (2 * (number - 35)).clamp(0, 20) - (2 * (number - 70)).clamp(0, 20);
        let thing =
            Patch { left: THING.left - (3 * (number - 48)).clamp(0, 30), top: THING.top - up, ..THING };
        let (left, top) = (thing.left + 28 + reach, thing.top - 3);
        [thing, Patch { left, top, width: 200, height: 36, depth_m: 0.96, color: [40, 70, 190] }]
    });
    let [(EventKind::PickedUp, _), (EventKind::PlacedOn, down)] = told[..] else { panic!("{told:?}") };
    assert!((78..=84).contains(&down), "{told:?}");
}

/// What is told when a hand hides the whole thing, from frame 44 on. `carried`: how far right and down the thing is in a frame, and how far the hand
/// has withdrawn from it, in pixels.
fn told_when_hidden(carried: impl Fn(i32) -> (i32, i32, i32)) -> Vec<(EventKind, u64)> {
    told_of_handled(|number| {
        let (right, down, withdrawn) = carried(number);
        let thing = Patch { left: THING.left + right, top: THING.top + down, ..THING };
        let reach = 160 - (5 * (number - 12)).clamp(0, 160) + withdrawn;
        let (left, top) = (thing.left - 3 + reach, thing.top - 3);
        [thing, Patch { left, top, width: 200, height: 36, depth_m: 0.94, color: [40, 70, 190] }]
    })
}

/// A regression: it was picked up when the hand hid it.
#[test]
fn what_a_hand_hides_and_takes_is_picked_up_before_its_place_is_bare() {
    let told =
        told_when_hidden(|number| (0, (3 * (number - 60)).clamp(0, 45), (5 * (number - 85)).clamp(0, 160)));
    let [(EventKind::Occluded, 44), (EventKind::PickedUp, taken), (EventKind::PlacedOn, _)] = told[..] else {
        panic!("{told:?}")
    };
    assert!((50..62).contains(&taken), "half of its place is bare in frame 66: {told:?}");
}

/// A regression: nothing was told of it.
#[test]
fn what_a_hand_takes_away_is_picked_up() {
    let told = told_when_hidden(|number| ((4 * (number - 60)).clamp(0, 160), 0, 0));
    let [(EventKind::Occluded, 44), (EventKind::PickedUp, taken)] = told[..] else { panic!("{told:?}") };
    assert!((50..62).contains(&taken), "half of its place is bare in frame 65: {told:?}");
}

/// An arm lifts a thing and sets it down in a tray. Meanwhile no frame shows the thing as an object of its own, nor what holds it.
#[test]
fn what_is_set_down_in_a_tray_is_in_it_while_the_hand_is_there() {
    const TRAY: Patch =
        Patch { left: 5, top: 10, width: 50, height: 60, depth_m: 1.02, color: [40, 150, 60] };
    let mut tracker = Tracker::new(Params::default());
    let mut told = Vec::new();
    for number in 0..110_i32 {
        let reach = (40 - 4 * (number - 20)).clamp(0, 160);
        let up = (2 * (number - 35)).clamp(0, 20) - (2 * (number - 80)).clamp(0, 10);
        let aside = (3 * (number - 58)).clamp(0, 45);
        let thing = Patch { left: THING.left - aside, top: THING.top - up, ..THING };
        let (left, top) = (thing.left + 18 + reach, thing.top + 6);
        let arm = Patch { left, top, width: 160, height: 10, depth_m: 0.96, color: [40, 70, 190] };
        let seen: &[usize] = if number >= 33 { &[0] } else { &[0, 1] };
        let (frame, found) = frame(&[TRAY, thing, arm], seen, number as u64);
        told.extend(tracker.update_found(&frame, &found, f64::from(number) / 30.0, None).unwrap().events);
    }
    told.extend(tracker.finish());
    let put_in = told.iter().find(|event| event.kind == EventKind::PutIn);
    let put_in = put_in.unwrap_or_else(|| panic!("{told:#?}"));
    assert!(put_in.object.0 == 2 && format!("{:?}", put_in.other).contains('1'), "{put_in:?}");
    assert!((82..=90).contains(&put_in.frame), "{put_in:?}");
}
