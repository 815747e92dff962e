//! What videos promise.

use super::events::EventKind;
use super::*;
use crate::Sensor;

/// Kinds whose making takes little time.
const QUICK: [Clip; 4] = [Clip::Pick, Clip::Throw, Clip::PushFlush, Clip::Empty];

fn kinds(video: &Video) -> Vec<EventKind> {
    video.truth().events.iter().map(|event| event.kind).collect()
}

#[test]
fn clips_have_the_events_of_their_kind() {
    let of = |clip| kinds(&film(clip, 1, 30.0).unwrap());
    assert_eq!(of(Clip::Empty), []);
    assert_eq!(of(Clip::Pick), [EventKind::PickedUp, EventKind::PlacedOn]);
    let flush = of(Clip::PushFlush);
    assert!(flush.contains(&EventKind::Pushed) && flush.contains(&EventKind::Split), "{flush:?}");
    let thrown = of(Clip::Throw);
    assert!(thrown.contains(&EventKind::Appeared) && thrown.contains(&EventKind::Airborne), "{thrown:?}");
}

#[test]
fn the_same_seed_gives_the_same_truth() {
    for clip in QUICK {
        let [a, b] = [(); 2].map(|()| film(clip, 2, 15.0).unwrap());
        assert_eq!(format!("{:?}", a.truth()), format!("{:?}", b.truth()), "{clip}");
        assert_ne!(
            format!("{:?}", a.truth()),
            format!("{:?}", film(clip, 3, 15.0).unwrap().truth()),
            "{clip}"
        );
    }
}

#[test]
fn a_slower_camera_sees_the_same_things_happen() {
    for clip in QUICK {
        let [slow, fast] = [15.0, 60.0].map(|fps| film(clip, 1, fps).unwrap());
        assert!(
            fast.frames().abs_diff(4 * slow.frames()) <= 8,
            "{clip}: {} and {}",
            slow.frames(),
            fast.frames()
        );
        let named =
            |kind: &EventKind| !matches!(kind, EventKind::Airborne | EventKind::Landed | EventKind::Fell);
        let told = |video: &Video| kinds(video).into_iter().filter(|kind| named(kind)).collect::<Vec<_>>();
        assert_eq!(told(&slow), told(&fast), "{clip}");
        for (a, b) in
            slow.truth().events.iter().zip(&fast.truth().events).filter(|_| told(&slow) == kinds(&fast))
        {
            let [a, b] = [slow.time_s(a.frame), fast.time_s(b.frame)];
            assert!((a - b).abs() < 0.15, "{clip}: {a} s and {b} s");
        }
    }
}

#[test]
fn flush_boxes_count_as_one_until_one_is_pushed() {
    let video = film(Clip::PushFlush, 1, 30.0).unwrap();
    let [group] = video.truth().groups.as_slice() else { panic!("{:?}", video.truth().groups) };
    let apart_from = group.apart_from.unwrap();
    let split = video.truth().events.iter().find(|event| event.kind == EventKind::Split).unwrap();
    assert_eq!(split.frame, apart_from);
    assert!(group.members.contains(&split.object));
    let displacement = |frame: usize| {
        let [a, b] =
            [0, 1].map(|k| video.truth().frames[frame].motions[usize::from(group.members[k]) - 1].center_m);
        let start =
            [0, 1].map(|k| video.truth().frames[0].motions[usize::from(group.members[k]) - 1].center_m);
        (0..3).map(|i| ((a[i] - start[0][i]) - (b[i] - start[1][i])).powi(2)).sum::<f64>().sqrt()
    };
    assert!(displacement(apart_from / 2) < 0.002, "{}", displacement(apart_from / 2));
    assert!(displacement(video.frames() - 1) > 0.02, "{}", displacement(video.frames() - 1));
}

#[test]
fn what_flies_falls_as_gravity_says() {
    let video = film(Clip::Throw, 1, 60.0).unwrap();
    let flights: Vec<_> =
        video.truth().events.iter().filter(|event| event.kind == EventKind::Airborne).collect();
    assert!(!flights.is_empty());
    for flight in flights {
        let (first, last) = (flight.start.unwrap(), flight.end.unwrap());
        assert!(last - first >= 4, "{first} to {last}");
        let height =
            |frame: usize| video.truth().frames[frame].motions[usize::from(flight.object) - 1].center_m[2];
        for frame in first + 1..last {
            let acceleration = (height(frame + 1) - 2.0 * height(frame) + height(frame - 1)) * 60.0 * 60.0;
            assert!((acceleration + 9.81).abs() < 0.8, "frame {frame}: {acceleration} m/s²");
        }
    }
}

#[test]
fn truth_and_picture_agree() {
    let video = film(Clip::Pick, 1, 30.0).and_then(|video| video.at_size((160, 120))).unwrap();
    for frame in [0, video.frames() / 2] {
        let seen = video.render(frame, Sensor::Kinect).unwrap();
        let labels = seen.truth.instance.as_slice();
        for k in video.objects() {
            let count = labels.iter().filter(|&&label| label == instance(k)).count();
            let share = video.truth().frames[frame].motions[k].visible_fraction;
            assert_eq!(count > 0, share > 0.0, "frame {frame}, thing {k}: {count} px of a share {share}");
        }
    }
}

#[test]
fn a_frame_rate_that_no_camera_has_is_refused() {
    for fps in [0.0, -30.0, f64::NAN, f64::INFINITY] {
        assert!(film(Clip::Empty, 1, fps).is_err(), "{fps}");
    }
}
