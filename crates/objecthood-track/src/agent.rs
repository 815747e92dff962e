//! Agents (hands, people): regions that are nearer than the rested scene and stay connected to the border of
//! the image, possibly behind a thing (ours, after the design note).

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use crate::behind::{Before, Region};
use crate::bits::Bits;
use crate::look::Look;
use crate::pace::Pace;
use crate::scene::{Key, Scene};
use crate::view::View;

/// Least size of a region that may be an agent (px at VGA size).
const LEAST_PX: f64 = 300.0;
/// Least number of its pixels on the border of the image (px at VGA size).
const LEAST_BORDER_PX: f64 = 8.0;
/// Least share of its pixels that are measured nearer, or changed, in frames that count: a shining floor only
/// loses its depth.
const LEAST_MEASURED: f64 = 0.25;
/// A region is scene that came late into the sensor's reach if more than the first share of it stands before
/// nothing, and less than the second share of it has changed, for this long (s).
const MOST_BEFORE_NOTHING: f64 = 0.5;
const LEAST_ALIVE: f64 = 0.02;
const SCENE_S: f64 = 5.0;
/// It has to be seen for this long (s).
const LEAST_S: f64 = 0.2;
/// It is new for this long (s) after it became sure: frames may miss a fast arm for a while.
const NEW_S: f64 = 0.2;
/// It may be away from the border for this long (s), once it was there twice as long as it has to be: a thing
/// that flies in is soon away. An agent that has lifted a thing may be away for any time.
const PATIENCE_S: f64 = 0.1;

/// A hand with its arm, a person.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Agent {
    /// Numbers begin at 1.
    pub(crate) number: u32,
    pub(crate) mask: Bits,
    frames: usize,
    /// Frames since it was first seen, and for which it has been sure.
    pub(crate) age: usize,
    sure_frames: usize,
    away: usize,
    /// Whether it has lifted a thing: then it may leave the border, like a gripper without an arm.
    has_lifted: bool,
    /// Frames for which it has not changed, if it stands before places where nothing was in reach of the
    /// sensor.
    still: usize,
}

/// The tracks of things that help to tell things from agents.
pub(crate) struct Things {
    /// Tracks that were seen by themselves, away from the border.
    pub(crate) free: BTreeSet<Key>,
    /// Tracks that are known.
    pub(crate) known: BTreeSet<Key>,
    /// Arms that were there from the first frame on: where they still are, nothing is nearer than what rested
    /// there.
    pub(crate) arms: BTreeSet<Key>,
}

impl Agent {
    /// Whether it became sure a short while ago.
    pub(crate) fn is_new(&self, pace: Pace) -> bool {
        self.sure_frames <= pace.frames(NEW_S)
    }

    /// Whether it has become sure in this frame.
    pub(crate) fn is_newly_sure(&self) -> bool {
        self.sure_frames == 1
    }
}

/// All agents of a frame.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Agents {
    pub(crate) all: Vec<Agent>,
    /// The pixels of all of them, with the things that they carry.
    pub(crate) region: Bits,
    /// The parts of agents that come out behind a thing.
    behind: Bits,
    /// Other regions that are nearer than the rested scene: the pixels of each thing.
    pub(crate) free: Vec<Vec<usize>>,
    /// What they look like without the things that they carry.
    pub(crate) look: Look,
    next: u32,
}

impl Agents {
    pub(crate) fn none(size: (usize, usize)) -> Self {
        let (region, behind) = (Bits::none(size), Bits::none(size));
        Self { all: Vec::new(), region, behind, free: Vec::new(), look: Look::default(), next: 1 }
    }

    /// Forgets where the agents are, but not what they look like. Agents found later get new numbers.
    pub(crate) fn lose(&mut self, size: (usize, usize)) {
        *self = Self { next: self.next, look: std::mem::take(&mut self.look), ..Self::none(size) };
    }

    /// Finds the agents in a frame. A free thing that comes to the border is no agent, nor is a thing that an
    /// agent lets go. O(n).
    pub(crate) fn update(
        &mut self,
        view: &View,
        scene: &Scene,
        changed: &Bits,
        camera_moves: bool,
        pace: Pace,
        things: &Things,
    ) {
        let open = view.length_px(if camera_moves { 2.0 } else { 1.0 });
        let close = view.length_px(5.0);
        let mut front = scene.in_front(view).eroded(open).dilated(open);
        if !things.arms.is_empty() {
            front.unite(&Bits::of(view.size, |pixel| things.arms.contains(&scene.seen[pixel])));
        }
        let front = front.dilated(close).eroded(close);
        let mut old = std::mem::take(&mut self.all);
        // Where a surface at the end of the sensor's reach loses its depth, nothing has come. Without colour this
        // cannot be told from a dark sleeve.
        let has_come = |pixel: usize| scene.is_in_front(view, pixel) || changed.has(pixel);
        let may_have_come = |pixel: usize| view.color.is_empty() || has_come(pixel);
        let (least_px, least_border) = (view.px(LEAST_PX), view.length_px(LEAST_BORDER_PX));
        self.free.clear();
        let components = front.components().into_iter().filter(|component| component.len() >= least_px);
        let is_known = |pixel: usize| old.iter().any(|agent| agent.number > 0 && agent.mask.has(pixel));
        let region = |pixels: Vec<usize>| {
            let on_border = pixels.iter().filter(|&&pixel| view.is_border(pixel));
            let came = on_border.filter(|&&pixel| may_have_come(pixel) || is_known(pixel)).count();
            Region { is_at_border: came >= least_border, pixels }
        };
        let mut regions: Vec<Region> = components.map(region).collect();
        let joined = std::mem::replace(&mut self.behind, Bits::none(view.size));
        // While the camera moves, edges of the resampled scene seem to be in front.
        if !camera_moves {
            let before = Before { scene, things, agents: &old, joined: &joined, changed };
            (regions, self.behind) = before.join(regions, view);
        }
        // Neither a splinter of an arm nor a thing that it let go takes its number.
        regions.sort_by_key(|region| std::cmp::Reverse((region.is_at_border, region.pixels.len())));
        for Region { is_at_border, pixels: component } in regions {
            let mut mask = Bits::none(view.size);
            component.iter().for_each(|&pixel| mask.insert(pixel));
            let same = old.iter().enumerate().map(|(k, agent)| (agent.mask.common(&mask), k)).max();
            let before = same.filter(|&(common, _)| common > 0).map(|(_, k)| old.swap_remove(k));
            let away =
                if is_at_border { 0 } else { before.as_ref().map_or(usize::MAX, |agent| agent.away + 1) };
            let is_old = before.as_ref().is_some_and(|agent| agent.frames >= 2 * pace.frames(LEAST_S));
            let is_agent = before.as_ref().is_some_and(|agent| agent.number > 0);
            let count =
                |holds: &dyn Fn(usize) -> bool| component.iter().filter(|&&pixel| holds(pixel)).count();
            let is_free =
                !is_agent && 2 * count(&|pixel| things.free.contains(&scene.seen[pixel])) > component.len();
            let has_lifted = before.as_ref().is_some_and(|agent| agent.has_lifted);
            let may_be_away =
                match has_lifted && count(&|pixel| !things.known.contains(&scene.seen[pixel])) >= least_px {
                    true => usize::MAX,
                    false if is_old => pace.frames(PATIENCE_S),
                    false => 0,
                };
            if is_free || away > may_be_away {
                if !camera_moves {
                    self.free.push(component);
                }
                continue;
            }
            let share = |holds: &dyn Fn(usize) -> bool| {
                component.iter().filter(|&&pixel| holds(pixel)).count() as f64 / component.len() as f64
            };
            let is_measured = share(&has_come) >= LEAST_MEASURED;
            let is_still = share(&|pixel| scene.is_before_nothing(pixel)) > MOST_BEFORE_NOTHING
                && share(&|pixel| changed.has(pixel)) < LEAST_ALIVE;
            let still = if is_still { before.as_ref().map_or(0, |agent| agent.still + 1) } else { 0 };
            let (number, frames, age, sure_frames) = before
                .map_or((0, 0, 0, 0), |agent| (agent.number, agent.frames, agent.age + 1, agent.sure_frames));
            let frames = frames + usize::from(is_measured);
            self.all.push(Agent { number, mask, frames, age, sure_frames, away, has_lifted, still });
        }
        let least = pace.frames(LEAST_S);
        self.region = Bits::none(view.size);
        let most_still = pace.frames(SCENE_S);
        let is_agent = |agent: &&mut Agent| agent.frames >= least && agent.still < most_still;
        for agent in self.all.iter_mut().filter(is_agent) {
            if agent.number == 0 {
                agent.number = self.next;
                self.next += 1;
            }
            agent.sure_frames += 1;
            self.region.unite(&agent.mask);
        }
    }

    /// Notes that these agents hold something in the air.
    pub(crate) fn note_lifts(&mut self, numbers: impl Iterator<Item = u32>) {
        for number in numbers {
            self.all
                .iter_mut()
                .filter(|agent| agent.number == number)
                .for_each(|agent| agent.has_lifted = true);
        }
    }

    /// The agents that have been there long enough.
    pub(crate) fn sure(&self) -> impl Iterator<Item = &Agent> {
        self.all.iter().filter(|agent| agent.number > 0 && self.region.common(&agent.mask) > 0)
    }
}
