//! Agents that are in the image from the first frame on: while at rest they look like things (ours).

use std::collections::BTreeSet;

use glam::DVec3;

use crate::agent::Agent;
use crate::bits::Bits;
use crate::knowledge::pair;
use crate::memory::{Look, Memory};
use crate::scene::Key;
use crate::track::{Sample, Track, is_as_whole};
use crate::view::View;

/// A thing moved with an agent from the beginning if it moved within this time (s) after the first frame in
/// which the agent was nearer than the rested scene. A hand that comes in from the border needs longer to
/// reach anything.
const AT_ONCE_S: f64 = 0.1;
/// It has moved by at least this (m) by then,
const BEGUN_M: f64 = 0.004;
/// and by at least this since it rested.
const MOVED_M: f64 = 0.015;
/// It belongs to the agent's region with at least this share of its pixels.
const OF_AGENT: f64 = 0.5;
/// A finger has the colours of the arm in this share of its pixels,
const OF_ITS_COLORS: f64 = 0.5;
/// or has moved as the arm has, with less than this share of the way between them.
const ALIKE_SHARE: f64 = 0.25;
/// By the sum of the motions that were found, less than this share: that of a sleeve, which slides through the
/// border of the image, is known roughly.
const ROUGHLY_ALIKE_SHARE: f64 = 0.6;

impl Memory {
    /// Handles agents that became sure a short while ago but did not come in from the border: they were there
    /// before, and what moved with them from the first was a part of them. O(agents · tracks · n) in frames
    /// with such an agent.
    pub(crate) fn find_arms(&mut self, look: &Look<'_>) {
        let new = self.agents.sure().filter(|agent| agent.is_new(self.pace));
        let arms: BTreeSet<Key> = new.flat_map(|agent| self.arm_of(agent, look)).collect();
        for key in arms {
            self.happenings.forget(key);
            self.tracks.entry(key).and_modify(Track::become_arm);
        }
    }

    /// The things that are parts of an agent: those that were joined to the border in the first frame, and
    /// their fingers.
    fn arm_of(&self, agent: &Agent, look: &Look<'_>) -> Vec<Key> {
        let since = self.frame.saturating_sub(agent.age as u64);
        let by = since + self.pace.frames(AT_ONCE_S) as u64;
        let moved = self.tracks.iter().filter(|(_, track)| {
            track.last.frame + 1 >= since && may_be_arm(track) && begun_at_once(track, by)
        });
        let keys = moved.map(|(&key, _)| key);
        let (mut apart, mut arm): (Vec<Key>, Vec<Key>) = keys.partition(|key| self.tracks[key].was_apart);
        // Later than in its first frame, the agent may have come to where a thing was last seen.
        let is_placed = |key: Key| agent.is_newly_sure() || self.tracks[&key].last.frame == self.frame;
        arm.retain(|&key| has_moved(&self.tracks[&key]) && is_placed(key) && self.lies_in(key, agent, look));
        // Frames may miss a finger. One that is seen has gone with the agent.
        let goes_along =
            |key: Key| self.tracks[&key].last.frame < self.frame || self.lies_in(key, agent, look);
        apart.retain(|&key| !arm.is_empty() && goes_along(key));
        // A finger may hang on another part that stood apart.
        loop {
            let is_next = |key: &Key| arm.iter().any(|&part| self.is_finger(*key, part, by));
            let (fingers, others): (Vec<Key>, Vec<Key>) = apart.into_iter().partition(is_next);
            if fingers.is_empty() {
                return arm;
            }
            arm.extend(fingers);
            apart = others;
        }
    }

    /// Whether a thing that began to move at once is a finger of an arm: it touched the arm at rest, and is a
    /// smaller thing of the arm's colours or moved as the arm did. `by`: the frame in which both had begun.
    fn is_finger(&self, key: Key, arm: Key, by: u64) -> bool {
        let [track, arm_track] = [key, arm].map(|key| &self.tracks[&key]);
        let looks_like_it = track.look.share_of(&arm_track.look).is_some_and(|share| share >= OF_ITS_COLORS);
        let is_alike = |own: DVec3, arms: DVec3, share: f64| {
            arms.length() > MOVED_M && (own - arms).length() < share * arms.length()
        };
        // The middle of what is seen of an arm does not move as the arm does.
        let moves_alike = is_alike(shift_by(track, by), shift_by(arm_track, by), ALIKE_SHARE)
            || is_alike(track.drift, arm_track.drift, ROUGHLY_ALIKE_SHARE);
        // Of a part that never rested, no touch at rest is known. What a hand came to push does touch it now.
        let never_rested = track.rest.is_none() || arm_track.rest.is_none();
        let touches = never_rested && self.touched.contains(&pair(key, arm))
            || self.knowledge.touched_at_rest(key, arm);
        touches && (moves_alike || looks_like_it && track.area_m2 < arm_track.area_m2)
    }

    /// Notes which things of the first frame are joined to the border of the image by structure alone: these
    /// are no parts of an arm, unless they are its fingers. Without structure nothing is noted. O(n).
    pub(crate) fn note_apart(&mut self, view: &View) {
        if self.frame > 0 || view.structure.is_empty() {
            return;
        }
        let is_other = |pixel: usize| view.inverse[pixel] > 0.0 && !view.is_structure(pixel);
        let components = Bits::of(view.size, is_other).joined(view);
        let at_border =
            components.iter().filter(|component| component.iter().any(|&pixel| view.is_border(pixel)));
        let joined: BTreeSet<Key> = at_border.flatten().map(|&pixel| self.scene.seen[pixel]).collect();
        for (key, track) in &mut self.tracks {
            track.was_apart = !joined.contains(key);
        }
    }

    /// Whether most of the pixels of a track belong to an agent; for a track that is not seen, most of its
    /// last place.
    fn lies_in(&self, key: Key, agent: &Agent, look: &Look<'_>) -> bool {
        let last = self.tracks[&key].last;
        if last.frame < self.frame {
            let at = look.place.world_from_camera.inverse().point(last.center);
            return look.view.pixel_of(at).is_some_and(|pixel| agent.mask.has(pixel));
        }
        let (mut all, mut own) = (0_usize, 0_usize);
        for (pixel, _) in self.scene.seen.iter().enumerate().filter(|&(_, &seen)| seen == key) {
            all += 1;
            own += usize::from(agent.mask.has(pixel));
        }
        own as f64 > OF_AGENT * all as f64
    }
}

/// Whether a track was there from the first frame on, and nothing was done to it. Frames may show a hand in
/// changing pieces, so that it never rests.
fn may_be_arm(track: &Track) -> bool {
    (track.rest.is_some() || track.first.frame == 0) && track.was_never_handled() && !track.is_agent_part()
}

/// The track as it was last seen by this frame.
fn seen_by(track: &Track, by: u64) -> Option<&Sample> {
    track.samples.iter().rfind(|sample| sample.frame <= by)
}

/// Whether a track that may be an arm had begun to move by this frame.
fn begun_at_once(track: &Track, by: u64) -> bool {
    seen_by(track, by).is_some_and(|then| then.moves || moved_m(track, then) > BEGUN_M)
}

/// How far and where to (m) a track was from where it rested, or was at first, when it was last seen by this
/// frame.
fn shift_by(track: &Track, by: u64) -> DVec3 {
    seen_by(track, by).map_or(DVec3::ZERO, |then| then.center - at_first(track).0)
}

/// Where the middle of a track was when it rested, or else at first, and how many pixels it had then.
fn at_first(track: &Track) -> (DVec3, usize) {
    track.rest.map_or((track.first.center, track.first.px), |rest| (rest.center, rest.px))
}

/// Whether a track that may be an arm has moved far enough, by its motions or by where it is seen.
fn has_moved(track: &Track) -> bool {
    track.drift.length().max(moved_m(track, &track.last)) > MOVED_M
}

/// How far (m) from where it rested, or was at first, a track was; 0 if that cannot be told. If a part of a
/// thing is hidden, its middle shifts, but within its size.
fn moved_m(track: &Track, sample: &Sample) -> f64 {
    let (center, px) = at_first(track);
    let moved_m = (sample.center - center).length();
    let is_sure = is_as_whole(sample.px, px) || moved_m > track.area_m2.sqrt();
    if is_sure { moved_m } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use objecthood::{Camera, Frame, Raster};

    use super::*;
    use crate::segment::Segment;

    /// A regression: a fruit that rolled from the first frame on, so that it never rested, was a part of the hand that pushed it.
    #[test]
    fn what_stands_apart_in_the_first_frame_is_no_part_of_an_agent() {
        const SIZE: (usize, usize) = (8, 5);
        let depth_m = Raster::filled(SIZE.0, SIZE.1, 1.0).unwrap();
        let camera = Camera::new(8.0, 8.0, 3.5, 2.0).unwrap();
        let view = View::of(&Frame::new(depth_m, None, camera).unwrap(), 1.0);
        // A table with a thing (1), and an arm of two parts (2, 3) that comes from the right.
        let rows = ["00000000", "01100000", "01100322", "00000000", "00000000"];
        let seen: Vec<Key> = rows.concat().chars().filter_map(|c| c.to_digit(10)).collect();
        let structure: Vec<u16> = seen.iter().map(|&key| u16::from(key == 0)).collect();
        let of_agent = |px| Segment { px, of_agent: 0.9, ..Segment::default() };
        let is_part = |structure: &[u16]| {
            let mut memory = Memory::new(SIZE, 0.0, [].into());
            memory.scene.seen.clone_from(&seen);
            let alone = Segment { of_agent: 0.0, ..of_agent(100) };
            for key in 1..4 {
                let sample = memory.sample(&alone, &[]);
                memory.tracks.insert(key, Track::new(&alone, sample, true));
            }
            memory.note_apart(&View { structure: structure.to_vec(), ..view.clone() });
            [1, 2, 3].map(|key| {
                let sample = memory.sample(&of_agent(100), &[]);
                let track = memory.tracks.get_mut(&key).unwrap();
                (0..4).for_each(|_| track.see(&of_agent(100), sample, 0.03, 0.001));
                track.is_agent_part()
            })
        };
        assert_eq!(is_part(&structure), [false, true, true]);
        assert_eq!(is_part(&[]), [true; 3], "nothing is known of structure");
    }
}
