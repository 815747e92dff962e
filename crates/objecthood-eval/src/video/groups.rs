//! Which of its members a group stands for.
//!
//! While two boxes are one thing, nothing says whether the track that shows them is the left or the right one. So the group
//! takes the name of the member that its tracks go on to show, and a tracker may let either box keep the id. Ours.

use std::collections::BTreeMap;

use super::overlap::{FrameOverlap, SHOWN_IOU};

/// The sets of instances that were an object in some frame: single instances and groups.
#[derive(Debug, Default)]
pub(crate) struct Sets {
    numbers: BTreeMap<Vec<u16>, u16>,
}

impl Sets {
    /// The number of a set, which stays the same; `members` ascend. `None` beyond 65536 sets.
    pub(crate) fn number_of(&mut self, members: &[u16]) -> Option<u16> {
        if let Some(&number) = self.numbers.get(members) {
            return Some(number);
        }
        let number = u16::try_from(self.numbers.len()).ok()?;
        self.numbers.insert(members.to_vec(), number);
        Some(number)
    }

    /// The name of each set by its number: a single instance has its own, a group that of the member which shares most
    /// frames with it, counted by track; of equals the first. `frames` know objects by the number of their set.
    ///
    /// O(p + s m t) for p pairs in all frames and s groups of m members that t tracks show.
    pub(crate) fn names(&self, frames: &[FrameOverlap]) -> Vec<u16> {
        let mut shown: BTreeMap<u16, BTreeMap<u16, u64>> = BTreeMap::new();
        for frame in frames {
            for pair in frame.common.iter().filter(|pair| frame.iou(pair) >= SHOWN_IOU) {
                let set = frame.objects[pair.object].id;
                *shown.entry(set).or_default().entry(frame.tracks[pair.track].id).or_default() += 1;
            }
        }
        let none = BTreeMap::new();
        let by = |set: u16| shown.get(&set).unwrap_or(&none);
        let mut names = vec![0; self.numbers.len()];
        for (members, &number) in &self.numbers {
            let common_frames = |member: u16| -> u64 {
                let Some(&alone) = self.numbers.get(&[member][..]) else { return 0 };
                let frames = |(track, &n): (&u16, &u64)| by(alone).get(track).map_or(0, |&m| m.min(n));
                by(number).iter().map(frames).sum()
            };
            let best = members.iter().rev().max_by_key(|&&member| common_frames(member));
            names[usize::from(number)] = best.copied().unwrap_or(0);
        }
        names
    }
}
