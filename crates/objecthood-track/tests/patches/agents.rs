//! What is an agent, and what is not.

use objecthood::{Params, Raster};
use objecthood_track::{Tracked, Tracker};

use crate::{Patch, SIZE, THING, follow, frame, numbers};

/// As [`follow`], with frames that find some of the patches, and the wall as a plane of structure.
fn follow_on_wall(tracker: &mut Tracker, patches: &[Patch], found: &[usize], number: u64) -> Tracked {
    let (frame, mut found) = frame(patches, found, number);
    let is_wall = |k: usize| {
        let (u, v) = ((k % SIZE.0) as i32, (k / SIZE.0) as i32);
        patches.iter().all(|patch| !patch.has(u, v))
    };
    let structure = (0..SIZE.0 * SIZE.1).map(|k| u16::from(is_wall(k))).collect();
    found.structure = Raster::from_vec(SIZE.0, SIZE.1, structure).unwrap();
    tracker.update_found(&frame, &found, number as f64 / 30.0, None).unwrap()
}

/// An arm that is there and still from the first frame on is taken for two things, until it moves.
#[test]
fn an_arm_that_was_there_first_is_an_agent_once_it_moves() {
    let mut tracker = Tracker::new(Params::default());
    let skin = [220, 170, 150];
    let mut told = Vec::new();
    for number in 0..100_i32 {
        let gone = 2 * (number - 40).clamp(0, 20);
        let hand = Patch { left: 20 + gone, top: 60, width: 18, height: 20, depth_m: 0.9, color: skin };
        let arm =
            Patch { left: 24 + gone, top: 80, width: 10, height: 40, depth_m: 0.9, color: [60, 70, 120] };
        let tracked = follow(&mut tracker, &[THING, hand, arm], number as u64);
        told.extend(tracked.events.clone());
        if number == 30 {
            assert_eq!(numbers(&tracked).len(), 3);
        }
        if number > 60 {
            assert_eq!((numbers(&tracked), tracked.agents.len()), (vec![1], 1), "frame {number}");
        }
    }
    told.extend(tracker.finish());
    assert!(told.is_empty(), "{told:?}");
}

/// A fast arm, and a finger that frames show by itself. Frames miss both when the agent becomes sure. A regression: they stayed things, and an
/// agent picked them up.
#[test]
fn a_fast_arm_and_its_finger_are_an_agent_though_frames_miss_them_for_a_while() {
    let mut tracker = Tracker::new(Params::default());
    let skin = [220, 170, 150];
    let mut told = Vec::new();
    for number in 0..80_i32 {
        let gone = 14 * (number - 40).clamp(0, 8);
        let thing = Patch { left: 110, top: 10, ..THING };
        let arm = Patch { left: 12 + gone, top: 60, width: 26, height: 60, depth_m: 0.9, color: skin };
        // Nearer than the arm, so that depth does not join the two.
        let finger = Patch { top: 46, width: 10, height: 14, depth_m: 0.84, ..arm };
        let seen: &[usize] = if (43..48).contains(&number) { &[0] } else { &[0, 1, 2] };
        let tracked = follow_on_wall(&mut tracker, &[thing, arm, finger], seen, number as u64);
        told.extend(tracked.events.clone());
        if number > 50 {
            assert_eq!((numbers(&tracked), tracked.agents.len()), (vec![1], 1), "frame {number}");
        }
    }
    told.extend(tracker.finish());
    assert!(told.is_empty(), "{told:?}");
}

/// The hand and its fingers hang on a sleeve of another colour.
#[test]
fn a_hand_of_another_colour_than_its_sleeve_goes_with_it() {
    let mut tracker = Tracker::new(Params::default());
    for number in 0..80_i32 {
        let gone = 2 * (number - 40).clamp(0, 20);
        let sleeve =
            Patch { left: 20 + gone, top: 90, width: 20, height: 30, depth_m: 0.9, color: [40, 70, 190] };
        let hand = Patch { top: 70, height: 20, depth_m: 0.84, color: [220, 170, 150], ..sleeve };
        let finger = Patch { top: 58, width: 8, height: 12, depth_m: 0.8, ..hand };
        let tracked =
            follow_on_wall(&mut tracker, &[THING, sleeve, hand, finger], &[0, 1, 2, 3], number as u64);
        if number > 65 {
            assert_eq!((numbers(&tracked), tracked.agents.len()), (vec![1], 1), "frame {number}");
        }
    }
}

/// A thing of the arm's colours that the arm touches and leaves is no finger of it.
#[test]
fn what_an_arm_leaves_behind_is_no_finger() {
    let mut tracker = Tracker::new(Params::default());
    let skin = [220, 170, 150];
    let mut last = Vec::new();
    for number in 0..80_i32 {
        let gone = 4 * (number - 40).clamp(0, 20);
        let arm = Patch { left: 20 + gone, top: 80, width: 14, height: 40, depth_m: 0.9, color: skin };
        let pushed =
            Patch { left: 20 + gone.min(4), top: 66, width: 14, height: 14, depth_m: 0.84, color: skin };
        let thing = Patch { left: 110, top: 10, ..THING };
        last = numbers(&follow_on_wall(&mut tracker, &[thing, arm, pushed], &[0, 1, 2], number as u64));
    }
    assert_eq!(last, [1, 3]);
}

/// An arm lies beside its shadow, in which the sensor measures nothing, and leaves. A regression: the strip of the wall that the shadow had
/// hidden was an agent.
#[test]
fn what_a_shadow_hid_is_no_agent() {
    let mut tracker = Tracker::new(Params::default());
    for number in 0..80_i32 {
        let gone = 6 * (number - 30).clamp(0, 20);
        let arm =
            Patch { left: 60, top: 70 + gone, width: 20, height: 60, depth_m: 0.9, color: [220, 170, 150] };
        let shadow = Patch { left: 80, width: 14, depth_m: 0.0, ..arm };
        let tracked = follow_on_wall(&mut tracker, &[arm, shadow], &[0], number as u64);
        assert!(number < 45 || tracked.agents.is_empty(), "frame {number}: {:?}", tracked.agents);
    }
}

/// A regression: a mug that rolled to the border of the image was an agent from then on.
#[test]
fn what_comes_to_the_border_by_itself_is_no_agent() {
    let mut tracker = Tracker::new(Params::default());
    for number in 0..60_i32 {
        let left = 60 + 3 * (number - 20).clamp(0, 25);
        let tracked = follow(&mut tracker, &[Patch { left, ..THING }], number as u64);
        assert!(tracked.agents.is_empty(), "frame {number}");
        assert_eq!(numbers(&tracked), [1], "frame {number}");
    }
}

/// A gripper comes from the border, lifts the thing and is then seen as a whole. A regression: it became an object.
#[test]
fn what_has_lifted_a_thing_is_an_agent_away_from_the_border_too() {
    let mut tracker = Tracker::new(Params::default());
    for number in 0..110_i32 {
        let reach = (40 - 4 * (number - 20)).clamp(0, 160);
        let up = (2 * (number - 35)).clamp(0, 20);
        let aside = (3 * (number - 58)).clamp(0, 40);
        let thing = Patch { left: THING.left - aside, top: THING.top - up, ..THING };
        let (left, top) = (thing.left + 18 + reach, thing.top + 6);
        let gripper = Patch { left, top, width: 90, height: 10, depth_m: 0.96, color: [40, 70, 190] };
        let (frame, found) = frame(&[thing, gripper], &[0], number as u64);
        let tracked = tracker.update_found(&frame, &found, f64::from(number) / 30.0, None).unwrap();
        assert!(number < 40 || tracked.agents.len() == 1, "frame {number}: {} agents", tracked.agents.len());
        assert!(numbers(&tracked).iter().all(|&track| track == 1), "frame {number}: {:?}", numbers(&tracked));
    }
}

/// A ball that came by itself goes behind a thing behind which an arm reaches too.
#[test]
fn a_ball_that_rolls_behind_the_thing_that_an_arm_reaches_behind_is_no_agent() {
    let mut tracker = Tracker::new(Params::default());
    let mut last = Vec::new();
    for number in 0..90_i32 {
        let arm_left = (170 - 3 * (number - 20)).clamp(80, 170);
        let arm =
            Patch { left: arm_left, top: 42, width: 160, height: 12, depth_m: 1.14, color: [40, 70, 190] };
        let ball_left = (2 * (number - 10)).clamp(-20, 50);
        let ball =
            Patch { left: ball_left, top: 56, width: 14, height: 14, depth_m: 1.1, color: [60, 160, 60] };
        last = numbers(&follow(&mut tracker, &[THING, arm, ball], number as u64));
    }
    assert!(last.len() == 2, "the thing and the ball: {last:?}");
}

/// A hand comes out from behind a thing that hides the wrist. A regression: the hand was a new thing.
#[test]
fn a_hand_that_comes_out_behind_a_thing_belongs_to_its_arm() {
    let mut tracker = Tracker::new(Params::default());
    for number in 0..70_i32 {
        let left = (170 - 3 * (number - 10)).clamp(20, 170);
        let hand = Patch { left, top: 46, width: 30, height: 16, depth_m: 1.14, color: [220, 170, 150] };
        let arm = Patch { left: left + 30, width: 160, color: [40, 70, 190], ..hand };
        let tracked = follow(&mut tracker, &[THING, hand, arm], number as u64);
        if left < 60 {
            assert_eq!(numbers(&tracked), [1], "frame {number}");
            assert_eq!(tracked.agents.len(), 1, "frame {number}");
        }
        if left == 20 {
            assert!(tracked.agents[0].box_px.u < 25, "frame {number}: {:?}", tracked.agents);
        }
    }
    assert!(tracker.finish().is_empty());
}

/// An arm comes from the side before nothing that the sensor measures, and there the image has a band without depth, as registered depth has.
#[test]
fn an_arm_is_an_agent_before_nothing_and_beside_a_band_without_depth() {
    const OFFICE: Patch =
        Patch { left: 0, top: 0, width: 160, height: 60, depth_m: f32::INFINITY, color: [30, 30, 30] };
    const BAND: Patch =
        Patch { left: 150, top: 0, width: 10, height: 120, depth_m: 0.0, color: [40, 70, 190] };
    const BESIDE: Patch = Patch { left: 20, ..THING };
    let mut tracker = Tracker::new(Params::default());
    for number in 0..40_i32 {
        let left = (220 - 6 * number).clamp(90, 160);
        let arm = Patch { left, top: 12, width: 160, height: 30, depth_m: 0.8, color: [40, 70, 190] };
        // A frame finds the arm too.
        let (frame, found) = frame(&[BESIDE, arm, BAND, OFFICE], &[0, 1], number as u64);
        let tracked = tracker.update_found(&frame, &found, f64::from(number) / 30.0, None).unwrap();
        assert!(tracked.agents.len() <= usize::from(left < 150), "frame {number}: {:?}", tracked.agents);
        if left <= 100 {
            assert!(tracked.agents[0].size_px > 600, "frame {number}: {:?}", tracked.agents);
            let numbered = tracked.labels.as_slice().iter().filter(|&&label| label > 1).count();
            assert_eq!(numbered, 0, "frame {number}: the arm is an object");
        }
    }
    assert!(tracker.finish().is_empty());
}
