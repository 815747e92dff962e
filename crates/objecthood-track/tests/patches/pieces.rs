//! Things that frames show in pieces, and whose pieces come out one after the other.

use std::collections::BTreeSet;

use objecthood::Params;
use objecthood_track::{EventKind, Tracked, Tracker};

use crate::{Patch, SIZE, THING, follow, follow_found, frame, numbers};

/// [`THING`], or its left and its right half as two.
fn in_pieces(pieces: bool) -> Vec<Patch> {
    let half = Patch { width: 18, ..THING };
    if pieces { vec![half, Patch { left: 78, ..half }] } else { vec![THING] }
}

/// A regression: one frame that showed a resting thing in pieces gave it a second number, which it kept.
#[test]
fn most_frames_decide_whether_a_resting_thing_is_one() {
    let mut tracker = Tracker::new(Params::default());
    for number in 0..60 {
        let tracked = follow(&mut tracker, &in_pieces(number > 8 && number % 3 == 0), number);
        assert!(numbers(&tracked).iter().all(|&track| track == 1), "frame {number}: {:?}", numbers(&tracked));
    }
    let mut tracker = Tracker::new(Params::default());
    let tracked: Vec<Tracked> =
        (0..60).map(|number| follow(&mut tracker, &in_pieces(number > 20), number)).collect();
    assert_eq!(numbers(&tracked[20]), [1]);
    assert_eq!(numbers(&tracked[59]).len(), 2, "it came apart for good");
}

/// A regression: two tracks that touched when they were last seen stayed two, although every later frame showed them as one.
#[test]
fn two_that_most_frames_show_as_one_are_one_unless_they_were_clearly_two() {
    let seen_after = |pieces_until: u64| {
        let mut tracker = Tracker::new(Params::default());
        let mut last = Vec::new();
        for number in 0..pieces_until + 60 {
            if number == pieces_until + 10 {
                tracker = Tracker::restore(Params::default(), &tracker.save().unwrap()).unwrap();
            }
            last = numbers(&follow(&mut tracker, &in_pieces(number < pieces_until), number));
        }
        last.sort_unstable();
        last
    };
    assert_eq!(seen_after(8), [1]);
    assert_eq!(seen_after(60), [1, 2]);
}

/// A regression: of two tracks that turned out to be one the one that was seen no more went on; after 5 s it was forgotten, and the thing had
/// another number.
#[test]
fn two_that_are_one_keep_the_lower_number() {
    let mut tracker = Tracker::new(Params::default());
    let left = Patch { width: 12, ..THING };
    // The right part is larger: a segment that shows both shows its track.
    let parts = [left, Patch { left: 72, width: 24, ..THING }];
    for number in 0..240 {
        let tracked = if number < 8 {
            follow(&mut tracker, &parts, number)
        } else {
            follow(&mut tracker, &[THING], number)
        };
        assert!(number < 40 || numbers(&tracked) == [1], "frame {number}: {:?}", numbers(&tracked));
        if number == 239 {
            assert_eq!(tracked.objects[0].parts.iter().map(|part| part.0).collect::<Vec<_>>(), [2]);
            assert!(tracked.lost.is_empty(), "{:?}", tracked.lost);
        }
    }
}

/// A screen slides over the thing and, a second later, off it: what comes out first is a narrow strip.
#[test]
fn what_comes_out_in_pieces_keeps_its_number() {
    let mut tracker = Tracker::new(Params::default());
    let mut last = None;
    for number in 0..110_i32 {
        let slid = match number {
            0..15 => 0,
            15..45 => 4 * (number - 15),
            45..75 => 120,
            _ => (120 - 4 * (number - 75)).max(0),
        };
        let screen =
            Patch { left: -70 + slid, top: 10, width: 70, height: 110, depth_m: 0.8, color: [40, 70, 190] };
        last = Some(follow(&mut tracker, &[THING, screen], number as u64));
    }
    let labels = last.unwrap().labels;
    let shown: BTreeSet<u16> = labels.as_slice().iter().copied().filter(|&label| label > 0).collect();
    assert_eq!(shown, BTreeSet::from([1]));
    assert_eq!(labels.as_slice().iter().filter(|&&label| label == 1).count(), 36 * 30);
}

/// A screen passes before a bar that rests, and uncovers one end first. A regression: the piece is too small for its size, and too far from the middle of
/// the bar, to be known by its looks, and got a number of its own.
#[test]
fn what_comes_out_at_one_end_keeps_its_number() {
    const BAR: Patch = Patch { left: 30, top: 50, width: 100, height: 12, ..THING };
    let mut tracker = Tracker::new(Params::default());
    for number in 0..90_i32 {
        let left = -110 + 4 * (number - 12).max(0);
        let screen = Patch { left, top: 10, width: 110, height: 110, depth_m: 0.8, color: [40, 70, 190] };
        let (frame, found) = frame(&[BAR, screen], &[0], number as u64);
        let tracked = tracker.update_found(&frame, &found, f64::from(number) / 30.0, None).unwrap();
        let shown: BTreeSet<u16> =
            tracked.labels.as_slice().iter().copied().filter(|&label| label > 0).collect();
        assert!(shown.iter().all(|&label| label == 1), "frame {number}: {shown:?}");
        assert!(!(52..80).contains(&number) || shown.len() == 1, "frame {number}: nothing is seen");
    }
}

/// As before, but frames show the end as a segment of its own from then on. A regression: the end kept the number, and the rest got one of its own when
/// it came out.
#[test]
fn what_comes_out_later_and_is_more_keeps_the_number() {
    const BAR: Patch = Patch { left: 30, top: 50, width: 100, height: 12, ..THING };
    let (end, rest) = (Patch { width: 16, ..BAR }, Patch { left: 46, width: 84, ..BAR });
    let mut tracker = Tracker::new(Params::default());
    let mut numbers_of_rest = BTreeSet::new();
    for number in 0..100_i32 {
        let left = -110 + 4 * (number - 12).max(0);
        let screen = Patch { left, top: 10, width: 110, height: 110, depth_m: 0.8, color: [40, 70, 190] };
        let (frame, found) = match number {
            0..30 => frame(&[BAR, screen], &[0], number as u64),
            // Of the rest a frame makes a segment once it sees more than the end.
            _ if left < rest.left + 20 => frame(&[end, rest, screen], &[0], number as u64),
            _ => frame(&[end, rest, screen], &[0, 1], number as u64),
        };
        let tracked = tracker.update_found(&frame, &found, f64::from(number) / 30.0, None).unwrap();
        let is_false = |kind: EventKind| matches!(kind, EventKind::Split | EventKind::Pushed);
        assert!(!tracked.events.iter().any(|event| is_false(event.kind)), "{:?}", tracked.events);
        numbers_of_rest.insert(tracked.labels.as_slice()[55 * SIZE.0 + 120]);
    }
    assert_eq!(numbers_of_rest, BTreeSet::from([0, 1]));
}

/// A pole stands before a bar, and is carried away.
#[test]
fn what_was_cut_in_two_is_told_to_be_whole() {
    let mut tracker = Tracker::new(Params::default());
    let bar = Patch { left: 40, top: 50, width: 70, height: 16, ..THING };
    let mut told = Vec::new();
    for number in 0..60_i32 {
        let aside = (3 * (number - 20)).clamp(0, 80);
        let pole =
            Patch { left: 66 + aside, top: 30, width: 14, height: 60, depth_m: 0.9, color: [60, 160, 90] };
        let (frame, found) = frame(&[bar, pole], &[0, 1], number as u64);
        let tracked = tracker.update_found(&frame, &found, f64::from(number) / 30.0, None).unwrap();
        told.extend(tracked.events);
    }
    let merged: Vec<u64> =
        told.iter().filter(|event| event.kind == EventKind::Merged).map(|event| event.frame).collect();
    assert!(matches!(merged[..], [31..=36]), "{told:?}");
}

/// The larger part of a thing is lifted off by an arm. What stays keeps the number, and the part gets one of its own.
#[test]
fn what_stays_of_a_thing_keeps_its_number() {
    const PART_PX: i32 = 18;
    let mut tracker = Tracker::new(Params::default());
    let shown = |tracked: &Tracked, patch: &Patch, u: i32, v: i32| {
        tracked.labels.as_slice()[(patch.top + v) as usize * SIZE.0 + (patch.left + u) as usize]
    };
    for number in 0..60_i32 {
        let reach = (120 - 6 * number).clamp(0, 120);
        let up = (2 * (number - 30)).clamp(0, 24);
        let nearer = 0.003 * up as f32;
        let part = Patch { top: THING.top - up, height: PART_PX, depth_m: THING.depth_m - nearer, ..THING };
        let rest = Patch { top: THING.top + PART_PX, height: THING.height - PART_PX, ..THING };
        let (left, top) = (THING.left + 24 + reach, part.top + 4);
        let arm = Patch { left, top, width: 160, height: 8, depth_m: 0.9, color: [40, 70, 190] };
        let (patches, found): (&[Patch], &[usize]) =
            if up == 0 { (&[THING, arm], &[0]) } else { (&[rest, part, arm], &[0, 1]) };
        let (frame, found) = frame(patches, found, number as u64);
        let tracked = tracker.update_found(&frame, &found, f64::from(number) / 30.0, None).unwrap();
        assert_eq!(shown(&tracked, &rest, 6, 6), 1, "frame {number}: the rest");
        if up > 12 {
            assert!(shown(&tracked, &part, 6, 6) > 1, "frame {number}: the part");
        }
    }
}

/// What flies before another thing that the scene had not before is a thing, though no frame alone finds it. A regression: of the two, which are one
/// region in the image, the found one was more.
#[test]
fn what_flies_before_another_thing_is_a_thing() {
    let mut tracker = Tracker::new(Params::default());
    for number in 0..28_i32 {
        let ball = Patch {
            left: 62 + 3 * (number - 20),
            top: 48,
            width: 12,
            height: 12,
            depth_m: 0.7,
            color: [30, 150, 60],
        };
        let patches: &[Patch] = match number {
            0..10 => &[],
            10..20 => &[THING],
            _ => &[THING, ball],
        };
        let (frame, found) = frame(patches, &[0], number as u64);
        let tracked = tracker.update_found(&frame, &found, f64::from(number) / 30.0, None).unwrap();
        if number > 23 {
            assert_eq!(numbers(&tracked), [1, 2], "frame {number}");
        }
    }
}

/// A thing passes before another, too fast for its motion to be found, and is seen no more. A regression: it stayed where it had last been seen,
/// on the surface of the other.
#[test]
fn what_passed_before_a_thing_is_not_there_any_more() {
    let mut tracker = Tracker::new(Params::default());
    let cup = Patch { left: 4, width: 20, height: 24, depth_m: 0.8, color: [60, 90, 190], ..THING };
    let at = |left| Patch { left, ..cup };
    for number in 0..40 {
        // Each frame shows the thing in two pieces from when the cup has passed.
        let patches = match number {
            0..20 => vec![THING, at(4)],
            20 => vec![THING, at(34)],
            21 => vec![THING, at(70)],
            _ => in_pieces(true),
        };
        let tracked = follow(&mut tracker, &patches, number);
        if number > 21 {
            let shown = numbers(&tracked);
            let is_alone = !shown.is_empty() && shown.iter().all(|&track| track == 1);
            assert!(is_alone, "frame {number}: {shown:?}");
        }
    }
}

/// A hand hides most of a thing, and all of another that looks like it. A regression: what the hand uncovered of the first was taken for the
/// other, which was still hidden.
#[test]
fn what_rested_where_a_hand_was_is_seen_there_again() {
    let mut tracker = Tracker::new(Params::default());
    let other = Patch { left: 110, ..THING };
    for number in 0..60_i32 {
        // The hand comes from the right, and stays on the other.
        let left = match number {
            0..20 => 170,
            20..30 => 170 - 10 * (number - 19),
            30..40 => 70,
            _ => 104,
        };
        let hand = Patch { left, top: 34, width: 100, height: 44, depth_m: 0.9, color: [220, 170, 150] };
        let tracked = follow_found(&mut tracker, &[THING, other, hand], &[0, 1], number as u64);
        let own = tracked.labels.as_slice()[50 * SIZE.0 + 62];
        assert_eq!(own, 1, "frame {number}: beside the hand");
        if number >= 45 {
            assert_eq!(tracked.labels.as_slice()[50 * SIZE.0 + 90], 1, "frame {number}");
        }
    }
}
