//! Split, opened: what counted as one until it moved.

use glam::DVec3;

use super::{Event, EventKind, Tape};
use crate::video::script::Joint;
use crate::video::truth::Group;
use crate::video::{Video, instance};

/// Things have parted when a corner of one moved by more than this against the other (m).
const APART_M: f64 = 0.005;

/// What counts as one in a video, and until when.
pub(in crate::video) fn groups(video: &Video) -> Vec<Group> {
    let group = |group: &crate::video::script::Group| Group {
        members: group.members.iter().map(|&k| instance(k)).collect(),
        joint: group.joint,
        apart_from: (0..video.frames()).find(|&frame| {
            group.members.iter().any(|&k| shift_m(video, frame, group.members[0], k) > APART_M)
        }),
    };
    video.script.groups.iter().map(group).collect()
}

pub(super) fn events(tape: &Tape<'_>) -> Vec<Event> {
    let mut events = Vec::new();
    for (group, known) in tape.video.script.groups.iter().zip(&tape.truth.groups) {
        let Some(frame) = known.apart_from else { continue };
        let [one, other] = [group.members[0], group.members[1]];
        let (kind, object, rest) = match group.joint {
            // What closes the other comes behind it.
            Joint::Closed => (EventKind::Opened, other, one),
            Joint::Flush if tape.moved_m(one, 0, frame) > tape.moved_m(other, 0, frame) => {
                (EventKind::Split, one, other)
            }
            Joint::Flush => (EventKind::Split, other, one),
        };
        events.push(tape.event(kind, frame, object, Some(instance(rest))));
    }
    events
}

/// How far the corner of `thing` that moved most has moved since the first frame, seen from `base` (m).
fn shift_m(video: &Video, frame: usize, base: usize, thing: usize) -> f64 {
    let [low, high] = video.things()[thing].bounds_m().map(DVec3::from);
    let seen = |frame: usize, corner: DVec3| {
        let states = &video.recording[frame];
        states[base].pose.inverse_point(states[thing].pose.point(corner))
    };
    let corners = (0..8).map(|k| {
        let pick = |axis: usize| if k >> axis & 1 == 0 { low[axis] } else { high[axis] };
        DVec3::new(pick(0), pick(1), pick(2))
    });
    corners.map(|corner| (seen(frame, corner) - seen(0, corner)).length()).fold(0.0, f64::max)
}
