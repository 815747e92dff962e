//! What the tracker remembers: numbers, a bounded state, a state that is saved and restored.

use objecthood::{Camera, Discovery, Frame, Params, Raster};
use objecthood_track::{Error, TrackNotice, Tracker};

use crate::{Patch, SIZE, THING, follow, frame, numbers};

/// Every second column and row of a frame, and of its labels.
fn halved((frame, found): &(Frame, Discovery)) -> (Frame, Discovery) {
    fn half<T: Copy>(raster: &Raster<T>) -> Raster<T> {
        let pixels = (0..SIZE.1).step_by(2).flat_map(|v| (0..SIZE.0).step_by(2).map(move |u| v * SIZE.0 + u));
        let values = pixels.map(|pixel| raster.as_slice()[pixel]).collect();
        Raster::from_vec(SIZE.0 / 2, SIZE.1 / 2, values).unwrap()
    }
    let camera = Camera::new(65.5, 65.5, 39.5, 29.5).unwrap();
    let small = Frame::new(half(frame.depth_m()), frame.color().map(half), camera).unwrap();
    (small, Discovery::new(found.objects.clone(), half(&found.labels)))
}

#[test]
fn frames_are_counted_as_they_are_given_and_numbers_are_used_once() {
    let mut tracker = Tracker::new(Params::default());
    tracker.skip();
    let mut told = Vec::new();
    for number in 1..20_u64 {
        let frame = frame(&[THING], &[0], number);
        let (frame, found) = if number < 10 { frame } else { halved(&frame) };
        let tracked = tracker.update_found(&frame, &found, number as f64 / 30.0, None).unwrap();
        assert_eq!(tracked.frame, number);
        told.push(numbers(&tracked));
        if number == 9 {
            tracker = Tracker::restore(Params::default(), &tracker.save().unwrap()).unwrap();
        }
    }
    assert_eq!((&told[8][..], &told[18][..]), (&[1][..], &[2][..]));
}

/// A regression: the noise of the refused frame was taken into the mean.
#[test]
fn a_stamp_that_does_not_rise_changes_nothing() {
    let mut tracker = Tracker::new(Params::default());
    let (first, second) = (frame(&[THING], &[], 0).0, frame(&[THING], &[], 1).0);
    tracker.update(&first, 1.0, None).unwrap();
    let before = tracker.save().unwrap();
    for stamp_s in [1.0, 0.5] {
        assert!(matches!(tracker.update(&second, stamp_s, None), Err(Error::Stamp { .. })));
    }
    assert!(tracker.save().unwrap() == before);
}

/// A thing that goes round, beside one that rests.
fn round(number: u64) -> [Patch; 2] {
    let left = 40 + (number % 60).min(60 - number % 60) as i32;
    [Patch { left, ..THING }, Patch { left: 10, width: 20, color: [40, 90, 200], ..THING }]
}

#[test]
fn what_is_remembered_does_not_grow() {
    let mut tracker = Tracker::new(Params::default());
    let mut sizes = Vec::new();
    for number in 0..900 {
        follow(&mut tracker, &round(number), number);
        if number % 300 == 299 {
            sizes.push(tracker.save().unwrap().len());
        }
    }
    assert!(sizes[2] < sizes[0] + sizes[0] / 50, "{sizes:?}");
}

#[test]
fn a_restored_tracker_goes_on_as_the_saved_one() {
    let mut tracker = Tracker::new(Params::default());
    for number in 0..40 {
        follow(&mut tracker, &round(number), number);
    }
    let saved = tracker.save().unwrap();
    let mut again = Tracker::restore(Params::default(), &saved).unwrap();
    for number in 40..80 {
        let (one, other) =
            (follow(&mut tracker, &round(number), number), follow(&mut again, &round(number), number));
        assert_eq!(format!("{one:?}"), format!("{other:?}"), "frame {number}");
    }
    assert!(tracker.save().unwrap() == again.save().unwrap());
    for cut in [0, 10, 40, saved.len() - 1] {
        let refused = Tracker::restore(Params::default(), &saved[..cut]).unwrap_err();
        assert!(refused.to_string().contains("from its first frame"), "{refused}");
    }
}

/// A regression: of a source of less than 3.3 frames a second every frame had a notice of a gap, and what came later was forgotten between two
/// frames.
#[test]
fn of_a_slow_source_only_real_gaps_are_told() {
    let mut tracker = Tracker::new(Params::default());
    let comes = Patch { left: 10, color: [40, 60, 200], ..THING };
    let (mut stamp_s, mut gaps) = (0.0, Vec::new());
    for number in 0..14 {
        stamp_s += if number == 12 { 2.5 } else { 0.5 };
        let patches = if number < 6 { &[THING][..] } else { &[THING, comes] };
        let (frame, found) = frame(patches, &[0, 1], number);
        let tracked = tracker.update_found(&frame, &found, stamp_s, None).unwrap();
        gaps.extend(tracked.notices.iter().map(|notice| (number, *notice)));
        assert!(number < 9 || numbers(&tracked) == [1, 2], "frame {number}: {:?}", numbers(&tracked));
    }
    assert_eq!(gaps, [(12, TrackNotice::Gap { seconds: 2.5 })]);
}
