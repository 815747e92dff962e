//! Who was in the video: how long each object was seen, whether it moved, and how many agents there were.

use std::collections::BTreeMap;

use objecthood_track::{TrackId, TrackNotice, Tracked};
use serde::{Deserialize, Serialize};

/// What was seen for less (s), and did not move, may be a piece of an arm that looked like an object for some frames. In a video of less than
/// twice that, it is half of the frames.
const LASTING_S: f64 = 1.0;

/// What was seen to move so far (m) from where it was first has moved; less is what an arm before it does to the middle of what is seen.
const FAR_M: f32 = 0.1;

/// All that was seen so far.
#[derive(Clone, Default, Serialize, Deserialize)]
pub(super) struct Cast {
    frames: usize,
    /// Times of the first and the last frame (s).
    span_s: Option<(f64, f64)>,
    objects: BTreeMap<TrackId, Role>,
    /// In so many frames each agent was seen.
    agents: BTreeMap<TrackId, usize>,
}

/// What is known of an object.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct Role {
    /// In so many frames it was seen, and in which the last time, counted from 1.
    frames: usize,
    last: usize,
    /// Where it was seen first (m), in the world.
    first_m: [f32; 3],
    has_moved: bool,
    /// It was seen, and at once neither seen nor missed: it turned out to be a part of an agent or of another object.
    is_no_object: bool,
}

/// How many there were.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Count {
    pub(super) resting: usize,
    pub(super) moving: usize,
    pub(super) agents: usize,
}

impl Count {
    pub(super) fn objects(self) -> usize {
        self.resting + self.moving
    }
}

impl Cast {
    /// Takes in a frame.
    pub(super) fn see(&mut self, tracked: &Tracked) {
        self.frames += 1;
        let first_s = self.span_s.map_or(tracked.stamp_s, |(first_s, _)| first_s);
        self.span_s = Some((first_s, tracked.stamp_s));
        for agent in &tracked.agents {
            *self.agents.entry(agent.id).or_default() += 1;
        }
        for object in &tracked.objects {
            let Some(track) = object.track else { continue };
            let now_m = object.pose.translation_m().map(|coordinate| coordinate as f32);
            let new = Role { frames: 0, last: 0, first_m: now_m, has_moved: false, is_no_object: false };
            let role = self.objects.entry(track).or_insert(new);
            role.frames += 1;
            role.last = self.frames;
            role.has_moved |= object.motion.is_some() && distance_m(role.first_m, now_m) > FAR_M;
            role.is_no_object = false;
        }
        // Frames of another size begin anew: nothing is said of what was seen before.
        if !tracked.notices.contains(&TrackNotice::OtherSize) {
            self.take_back(tracked);
        }
    }

    /// Frames that were seen.
    pub(super) fn frames(&self) -> usize {
        self.frames
    }

    /// Notes what was an object in the frame before and is none now.
    fn take_back(&mut self, tracked: &Tracked) {
        let seen_before = self.objects.iter_mut().filter(|(_, role)| role.last + 1 == self.frames);
        for (track, role) in seen_before {
            role.is_no_object = !tracked.lost.iter().any(|lost| lost.track == *track);
        }
        // For a frame it may be neither: a hand hides what is seen of it.
        for lost in &tracked.lost {
            self.objects.entry(lost.track).and_modify(|role| role.is_no_object = false);
        }
    }

    /// The same with the numbers that tracks have in the end.
    pub(super) fn renumbered(self, whole_of: impl Fn(TrackId) -> TrackId) -> Self {
        let mut objects = BTreeMap::<TrackId, Role>::new();
        for (track, role) in self.objects {
            let known = objects.entry(whole_of(track)).or_insert(Role { frames: 0, ..role });
            known.frames = (known.frames + role.frames).min(self.frames);
            known.last = known.last.max(role.last);
            known.has_moved |= role.has_moved;
            known.is_no_object &= role.is_no_object;
        }
        Self { objects, ..self }
    }

    /// The agents that lasted, and the objects that lasted or moved and were not taken back.
    pub(super) fn count(&self) -> Count {
        let is_object = |role: &&Role| !role.is_no_object && (role.has_moved || self.is_lasting(role.frames));
        let objects = self.objects.values().filter(is_object);
        let (moving, resting): (Vec<&Role>, Vec<&Role>) = objects.partition(|role| role.has_moved);
        let agents = self.agents.values().filter(|&&frames| self.is_lasting(frames)).count();
        Count { resting: resting.len(), moving: moving.len(), agents }
    }

    fn is_lasting(&self, frames: usize) -> bool {
        let whole_s = self.span_s.map_or(0.0, |(first_s, last_s)| last_s - first_s);
        let share = frames as f64 / self.frames as f64;
        share >= 0.5 || share * whole_s >= LASTING_S
    }
}

fn distance_m(a: [f32; 3], b: [f32; 3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f32>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A piece of an arm that was an object for some frames was counted.
    #[test]
    fn only_objects_that_lasted_are_counted() {
        let role = |frames: usize, is_no_object: bool, has_moved: bool| Role {
            frames,
            last: frames,
            first_m: [0.0; 3],
            has_moved,
            is_no_object,
        };
        let cast = |seconds: f64, roles: &[Role]| Cast {
            frames: 100,
            span_s: Some((3.0, 3.0 + seconds)),
            objects: (1..).map(TrackId).zip(roles.iter().copied()).collect(),
            agents: [(TrackId(8), 90), (TrackId(9), 10)].into(),
        };
        let roles =
            [role(100, false, false), role(100, false, true), role(20, false, false), role(90, true, false)];
        assert_eq!(cast(3.0, &roles).count(), Count { resting: 1, moving: 1, agents: 1 });
        assert_eq!(cast(6.0, &roles).count().objects(), 3, "20 frames are more than a second now");
        assert_eq!(
            cast(3.0, &[role(20, false, true)]).count().objects(),
            1,
            "it was thrown through the image"
        );
        assert_eq!(cast(0.5, &[role(50, false, false)]).count().objects(), 1, "a short video");
        let joined = cast(3.0, &roles).renumbered(|track| TrackId(track.0.min(3)));
        assert_eq!(joined.count().objects(), 3, "the part is the third object now, and lasted");
    }
}
