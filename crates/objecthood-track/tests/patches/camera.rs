//! Noise, a moving camera and a knocked one move nothing.

use objecthood::{Camera, Frame, Params};
use objecthood_track::{Rigid, TrackNotice, Tracker};

use crate::{Patch, THING, follow, frame, numbers};

#[test]
fn noise_moves_nothing() {
    let mut tracker = Tracker::new(Params::default());
    for number in 0..40 {
        let tracked = follow(&mut tracker, &[THING], number);
        assert_eq!(tracked.objects.len(), 1);
        let object = &tracked.objects[0];
        assert!(object.track.is_some_and(|track| track.0 == 1), "frame {number}: {:?}", object.track);
        assert!(number < 6 || object.motion.is_none(), "frame {number} moves: {:?}", object.motion);
        assert!(tracked.events.is_empty(), "{:?}", tracked.events);
    }
    assert!(tracker.finish().is_empty());
}

/// A regression: a camera whose given poses moved it by less than noise from frame to frame stood still for the tracker, and the scene moved.
#[test]
fn a_slow_given_motion_of_the_camera_moves_nothing() {
    let mut tracker = Tracker::new(Params::default());
    for number in 0..150_u32 {
        let right_m = 0.0003 * f64::from(number);
        let thing = Patch { left: 60 - (131.0 * right_m).round() as i32, ..THING };
        let (frame, found) = frame(&[thing], &[0], u64::from(number));
        let pose = Rigid::new([0.0, 0.0, 0.0, 1.0], [right_m, 0.0, 0.0]);
        let tracked = tracker.update_found(&frame, &found, f64::from(number) / 30.0, pose).unwrap();
        assert_eq!(numbers(&tracked), [1], "frame {number}");
        assert!(number < 6 || tracked.objects[0].motion.is_none(), "frame {number} moves");
        assert!(tracked.events.is_empty(), "{:?}", tracked.events);
    }
}

/// A crop slides over a still image of twins: its principal point moves with it, and nothing else does. Each twin is now where the other was.
#[test]
fn other_intrinsics_move_nothing() {
    let mut tracker = Tracker::new(Params::default());
    for number in 0..40_i32 {
        let slid = if number < 20 { 0 } else { 40 };
        let twins = [20, 60, 100].map(|left| Patch { left: left - slid, ..THING });
        let (frame, found) = frame(&twins, &[0, 1, 2], number as u64);
        let camera = Camera::new(131.0, 131.0, 79.5 - f64::from(slid), 59.5).unwrap();
        let frame = Frame::new(frame.depth_m().clone(), frame.color().cloned(), camera).unwrap();
        let tracked = tracker.update_found(&frame, &found, f64::from(number) / 30.0, None).unwrap();
        assert_eq!(numbers(&tracked), [1, 2, 3], "frame {number}");
        assert!(tracked.events.is_empty(), "frame {number}: {:?}", tracked.events);
    }
}

/// A regression: when the camera was knocked towards the scene, all that was nearer than before was an agent for good.
#[test]
fn a_knock_makes_no_agent() {
    let mut tracker = Tracker::new(Params::default());
    let mut notices = Vec::new();
    for number in 0..90 {
        let nearer_m = if number < 30 { 0.0 } else { 0.1 };
        let all = Patch {
            left: 0,
            top: 0,
            width: 160,
            height: 120,
            depth_m: 1.2 - nearer_m,
            color: [180, 180, 175],
        };
        let thing = Patch { depth_m: THING.depth_m - nearer_m, ..THING };
        let (frame, found) = frame(&[thing, all], &[0], number);
        let tracked = tracker.update_found(&frame, &found, number as f64 / 30.0, None).unwrap();
        assert!(tracked.agents.is_empty(), "frame {number}");
        assert!(number < 4 || numbers(&tracked) == [1], "frame {number}: {:?}", numbers(&tracked));
        notices.extend(tracked.notices);
    }
    assert_eq!(notices, [TrackNotice::CameraLost]);
}
