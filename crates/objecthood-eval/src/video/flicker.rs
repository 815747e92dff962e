//! Flicker: pixels that go to another track although nothing happens there.

use std::ops::AddAssign;

use super::counts::share;
use super::frame::{LabelledFrame, Place, Places, Roles};

/// Pixels of all pairs of frames that follow each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FlickerCounts {
    /// Pixels whose truth stays the same: background, or one object.
    pub same: u64,
    /// Of these the ones whose track changes, also to or from none.
    pub changed: u64,
    /// Those of `same` on objects.
    pub same_on_objects: u64,
    /// Those of `changed` on objects: borders that flicker, and ids.
    pub changed_on_objects: u64,
}

impl FlickerCounts {
    /// Share of the pixels that change; `None` without two frames.
    pub fn share(&self) -> Option<f64> {
        share(self.changed, self.same)
    }

    /// Share of the pixels of objects that change; `None` without two frames of an object.
    pub fn share_on_objects(&self) -> Option<f64> {
        share(self.changed_on_objects, self.same_on_objects)
    }
}

impl AddAssign for FlickerCounts {
    fn add_assign(&mut self, other: Self) {
        self.same += other.same;
        self.changed += other.changed;
        self.same_on_objects += other.same_on_objects;
        self.changed_on_objects += other.changed_on_objects;
    }
}

/// Takes the frames of a video one after the other and remembers the last.
#[derive(Debug, Default)]
pub struct FlickerCounter {
    counts: FlickerCounts,
    /// Track and true thing of every pixel; a thing is named by the least of its members.
    before: Vec<(u16, Option<u16>)>,
}

impl FlickerCounter {
    /// Adds the next frame, both of whose images have one size. A frame of another size than the last begins anew. O(n) for n
    /// pixels.
    pub fn add(&mut self, frame: &LabelledFrame, roles: &Roles) {
        let places = Places::of(roles);
        let thing = |instance| match places.at(instance) {
            Place::Background => Some(0),
            Place::Unpunished => None,
            Place::Object(k) => Some(places.things[k as usize][0]),
        };
        let pixels = frame.tracks.as_slice().iter().zip(frame.instances.as_slice());
        let now: Vec<_> = pixels.map(|(&track, &instance)| (track, thing(instance))).collect();
        if now.len() == self.before.len() {
            for (new, old) in now.iter().zip(&self.before) {
                if new.1.is_none() || new.1 != old.1 {
                    continue;
                }
                let (changed, on_object) = (u64::from(new.0 != old.0), u64::from(new.1 > Some(0)));
                self.counts.same += 1;
                self.counts.changed += changed;
                self.counts.same_on_objects += on_object;
                self.counts.changed_on_objects += changed * on_object;
            }
        }
        self.before = now;
    }

    /// The counts so far.
    pub fn finish(self) -> FlickerCounts {
        self.counts
    }
}
