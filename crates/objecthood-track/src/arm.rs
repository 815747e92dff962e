//! Agents that are there from the first frame on: at rest they look like things (ours).

use std::collections::BTreeSet;

use crate::agent::Agent;
use crate::memory::{Look, Memory};
use crate::scene::Key;
use crate::track::{Sample, Track, is_as_whole};

/// A thing moved with an agent from the beginning when it moved so soon (s) after the first frame in which the agent was nearer than the rested
/// scene. A hand that comes in from the border needs longer to get anywhere.
const AT_ONCE_S: f64 = 0.1;
/// It has moved by so much (m) by then,
const BEGUN_M: f64 = 0.004;
/// and by so much since it rested.
const MOVED_M: f64 = 0.015;
/// It belongs to the agent's region with this share of its pixels or more.
const OF_AGENT: f64 = 0.5;

impl Memory {
    /// An agent that has just become sure and that did not come in was there before, and what moved with it from the first was part of it.
    /// O(agents · (n + tracks)) in frames with such an agent.
    pub(crate) fn find_arms(&mut self, look: &Look<'_>) {
        let mut arms: BTreeSet<Key> = BTreeSet::new();
        for agent in self.agents.sure().filter(|agent| agent.is_new) {
            let since = self.frame.saturating_sub(agent.age as u64);
            let by = since + self.pace.frames(AT_ONCE_S) as u64;
            let was_seen = |track: &Track| track.last.frame + 1 >= since && moved_at_once(track, by);
            let moved = self.tracks.iter().filter(|(_, track)| was_seen(track)).map(|(&key, _)| key);
            arms.extend(moved.filter(|&key| self.lies_in(key, agent, look)));
        }
        for key in arms {
            self.happenings.forget(key);
            self.tracks.entry(key).and_modify(Track::become_arm);
        }
    }

    /// Whether most of what is seen of a track belongs to an agent; of what is not seen, whether its last place does.
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

/// Whether a track rested from the first frame on, nothing was done to it, and it moves since a frame or longer.
fn moved_at_once(track: &Track, by: u64) -> bool {
    let Some(rest) = track.rest.filter(|_| track.was_never_handled() && !track.is_agent_part()) else {
        return false;
    };
    // What is hidden in part has another middle, within its size.
    let moved_m = |sample: &Sample| {
        let moved_m = (sample.center - rest.center).length();
        let is_sure = is_as_whole(sample.px, rest.px) || moved_m > track.area_m2.sqrt();
        if is_sure { moved_m } else { 0.0 }
    };
    let then = track.samples.iter().rfind(|sample| sample.frame <= by);
    let had_begun = then.is_some_and(|then| then.moves || moved_m(then) > BEGUN_M);
    had_begun && track.drift.length().max(moved_m(&track.last)) > MOVED_M
}
