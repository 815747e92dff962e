//! What a hand holds keeps its number.

use objecthood::Params;
use objecthood_track::Tracker;

use crate::{Patch, SIZE, THING, frame};

/// An arm takes the thing up, holds it still and takes it aside. Meanwhile no frame shows the thing as an object of its own.
#[test]
fn what_a_hand_holds_keeps_its_number() {
    let mut tracker = Tracker::new(Params::default());
    for number in 0..75_i32 {
        let reach = (40 - 4 * (number - 20)).clamp(0, 160);
        let up = (2 * (number - 35)).clamp(0, 20);
        let aside = (3 * (number - 58)).clamp(0, 30);
        let thing = Patch { left: THING.left - aside, top: THING.top - up, ..THING };
        let (left, top) = (thing.left + 18 + reach, thing.top + 6);
        let arm = Patch { left, top, width: 160, height: 10, depth_m: 0.96, color: [40, 70, 190] };
        let is_held = number >= 33;
        let seen: &[usize] = if is_held { &[] } else { &[0] };
        let (frame, found) = frame(&[thing, arm], seen, number as u64);
        let tracked = tracker.update_found(&frame, &found, f64::from(number) / 30.0, None).unwrap();
        let free = |u: i32, v: i32| thing.has(u, v) && !arm.has(u, v);
        let places = (0..SIZE.1 as i32).flat_map(|v| (0..SIZE.0 as i32).map(move |u| (u, v)));
        let visible = places.filter(|&(u, v)| free(u, v)).map(|(u, v)| v as usize * SIZE.0 + u as usize);
        let (mut own, mut all) = (0, 0);
        for pixel in visible {
            all += 1;
            own += usize::from(tracked.labels.as_slice()[pixel] == 1);
        }
        assert!(4 * own > 3 * all, "frame {number}: {own} of {all} pixels");
        let others = tracked.labels.as_slice().iter().filter(|&&label| label > 1).count();
        assert_eq!(others, 0, "frame {number}");
    }
}

/// A hand closes over a thing, and opens a little when it is elsewhere: the share of what is seen of the thing then that has its number, in the worst
/// frame, and the most pixels that have its number elsewhere. `sleeve`: a second person of this colour comes meanwhile.
fn between_fingers(sleeve: Option<[u8; 3]>) -> (f64, usize) {
    let mut tracker = Tracker::new(Params::default());
    let mut worst = (1.0_f64, 0);
    for number in 0..75_i32 {
        let reach = (40 - 4 * (number - 20)).clamp(0, 160);
        let up = (2 * (number - 35)).clamp(0, 20);
        let aside = (5 * (number - 48)).clamp(0, 45);
        let thing = Patch { left: THING.left - aside, top: THING.top - up, ..THING };
        let (left, top) = (thing.left + 18 + reach, thing.top + 6);
        let arm = Patch { left, top, width: 160, height: 10, depth_m: 0.96, color: [40, 70, 190] };
        let shown = if (46..60).contains(&number) { 0 } else { 14 };
        let (left, top) = (thing.left + shown, thing.top - 3);
        let hand = Patch { left, top, width: 40 - shown, height: 36, ..arm };
        let mut patches = if number < 46 { vec![thing, arm] } else { vec![thing, arm, hand] };
        let width = (4 * (number - 46)).clamp(0, 60);
        let other = |color| Patch { left: 0, top: 90, width, height: 24, depth_m: 0.9, color };
        patches.extend(sleeve.map(other).filter(|_| width > 0));
        let seen: &[usize] = if number < 33 { &[0] } else { &[] };
        let (frame, found) = frame(&patches, seen, number as u64);
        let tracked = tracker.update_found(&frame, &found, f64::from(number) / 30.0, None).unwrap();
        if number >= 62 {
            let is_strip = |u: i32, v: i32| thing.has(u, v) && (thing.left..thing.left + shown).contains(&u);
            let (mut own, mut elsewhere) = (0, 0);
            for (pixel, _) in tracked.labels.as_slice().iter().enumerate().filter(|(_, label)| **label == 1) {
                let (u, v) = ((pixel % SIZE.0) as i32, (pixel / SIZE.0) as i32);
                if is_strip(u, v) { own += 1 } else { elsewhere += 1 }
            }
            let share = f64::from(own) / f64::from(shown * thing.height);
            worst = (worst.0.min(share), worst.1.max(elsewhere));
        }
    }
    worst
}

/// A regression: what a hand hid while it carried it was lost until a frame showed it as an object.
#[test]
fn what_comes_out_between_fingers_elsewhere_keeps_its_number() {
    for sleeve in [None, Some([40, 160, 60]), Some(THING.color)] {
        let (own, elsewhere) = between_fingers(sleeve);
        assert!(own > 0.75 && elsewhere < 20, "sleeve {sleeve:?}: {own:.2} of it, {elsewhere} px elsewhere");
    }
}

/// An arm of two colours takes up a thing that is nearly as pale as the bare hand, and frames show the hand as an object. A regression: the hand had
/// none of the sleeve's colours, and was taken for another face of the thing.
#[test]
fn a_bare_hand_beside_a_sleeve_is_no_face_of_what_it_holds() {
    let mut tracker = Tracker::new(Params::default());
    for number in 0..75_i32 {
        let reach = (40 - 4 * (number - 20)).clamp(0, 160);
        let up = (2 * (number - 35)).clamp(0, 20);
        let thing = Patch { top: THING.top - up, color: [225, 190, 150], ..THING };
        let (left, top) = (thing.left + 18 + reach, thing.top + 4);
        let hand = Patch { left, top, width: 26, height: 16, depth_m: 0.96, color: [220, 180, 150] };
        let sleeve = Patch { left: left + 26, width: 140, color: [40, 70, 190], ..hand };
        let seen: &[usize] = if number < 50 { &[0] } else { &[0, 1] };
        let (frame, found) = frame(&[thing, hand, sleeve], seen, number as u64);
        let tracked = tracker.update_found(&frame, &found, f64::from(number) / 30.0, None).unwrap();
        let labels = tracked.labels.as_slice().iter().enumerate();
        let is_of_hand = |pixel: usize| hand.has((pixel % SIZE.0) as i32, (pixel / SIZE.0) as i32);
        let wrong = labels.filter(|&(pixel, &label)| label == 1 && is_of_hand(pixel)).count();
        assert!(wrong < 26 * 16 / 4, "frame {number}: {wrong} pixels of the hand");
    }
}
