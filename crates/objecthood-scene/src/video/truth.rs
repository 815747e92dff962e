//! What is true of a video.

use rayon::prelude::*;

use super::events::{self, Event};
use super::overlap::Forms;
use super::script::Joint;
use super::sight::{Seen, seen};
use super::support::{Edge, support};
use super::{Video, instance};
use crate::pose::Pose;
use crate::world::World;

/// What is true of a whole clip.
#[derive(Clone, Debug, Default)]
pub struct ClipTruth {
    /// A frame each.
    pub frames: Vec<FrameTruth>,
    /// What happened, by frame.
    pub events: Vec<Event>,
    /// Things that count as one until they move apart.
    pub groups: Vec<Group>,
    /// Instance numbers of hands and people.
    pub agents: Vec<u16>,
    pub(super) seen: Vec<Vec<Seen>>,
}

/// What is true at the time of a frame.
#[derive(Clone, Debug)]
pub struct FrameTruth {
    /// Of every solid; number k has the instance k + 1.
    pub motions: Vec<Motion>,
    /// What holds every object from below; nothing for one that is carried or flies.
    pub support: Vec<Edge>,
}

/// How a solid is and moves.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// Takes its own frame to the world.
    pub pose: Pose,
    /// Its centre of mass, for an agent its origin (m).
    pub center_m: [f64; 3],
    /// That one's velocity (m/s).
    pub velocity_m_per_s: [f64; 3],
    /// Angular velocity (rad/s), 0 for agents.
    pub spin_rad_per_s: [f64; 3],
    /// Instance number of the agent that holds it.
    pub held_by: Option<u16>,
    /// Whether nothing but gravity acts on it.
    pub is_airborne: bool,
    /// Share of what is in the image that is seen, to a quarter of the columns and rows; 0 outside.
    pub visible_fraction: f64,
}

/// Things that count as one until they move apart.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Group {
    /// Their instance numbers.
    pub members: Vec<u16>,
    /// Why they count as one.
    pub joint: Joint,
    /// First frame in which they have moved apart; `None` when they never do.
    pub apart_from: Option<usize>,
}

/// Looks at every frame. About 5 ms a frame on one thread.
pub(super) fn of(video: &Video) -> ClipTruth {
    let forms = Forms::of(video);
    let frame = |k: usize| {
        let seen = seen(&video.world(k));
        let truth = FrameTruth { motions: motions(video, k, &seen), support: support(video, &forms, k) };
        (truth, seen)
    };
    let (frames, seen): (Vec<FrameTruth>, Vec<Vec<Seen>>) =
        (0..video.frames()).into_par_iter().map(frame).unzip();
    let mut truth = ClipTruth { frames, seen, ..ClipTruth::default() };
    truth.agents = (0..video.agents().len()).map(|k| video.agent_instance(k)).collect();
    truth.groups = events::groups(video);
    truth.events = events::events(video, &truth);
    truth
}

fn motions(video: &Video, frame: usize, seen: &[Seen]) -> Vec<Motion> {
    let states = &video.recording[frame];
    let is_airborne =
        |k: usize| states[k].was_free && video.recording.get(frame + 1).is_none_or(|next| next[k].was_free);
    let things = states.iter().enumerate().map(|(k, state)| Motion {
        pose: state.pose,
        center_m: state.center.into(),
        velocity_m_per_s: state.velocity.into(),
        spin_rad_per_s: state.spin.into(),
        held_by: state.holder.map(|agent| video.agent_instance(agent)),
        is_airborne: is_airborne(k),
        visible_fraction: seen[k].share(),
    });
    let agents = video.agents().iter().enumerate().map(|(k, agent)| {
        const STEP_S: f64 = 1e-4;
        let time_s = video.time_s(frame);
        let [pose, next] = [time_s, time_s + STEP_S].map(|t| agent.pose(t));
        Motion {
            pose,
            center_m: pose.origin_m(),
            velocity_m_per_s: ((next.origin - pose.origin) / STEP_S).into(),
            spin_rad_per_s: [0.0; 3],
            held_by: None,
            is_airborne: false,
            visible_fraction: seen[states.len() + k].share(),
        }
    });
    things.chain(agents).collect()
}

impl ClipTruth {
    /// What is seen of a thing in a frame.
    pub(super) fn seen(&self, frame: usize, thing: usize) -> Seen {
        self.seen[frame][thing]
    }

    /// What holds a thing in a frame.
    pub(super) fn edge(&self, frame: usize, thing: usize) -> Option<Edge> {
        self.frames[frame].support.iter().copied().find(|edge| edge.child == instance(thing))
    }
}

impl World {
    /// The instance numbers of hands and people, ascending.
    pub fn agents(&self) -> impl Iterator<Item = u16> + '_ {
        let agents = self.solids().iter().enumerate();
        agents.filter(|(_, solid)| solid.role() == crate::Role::Agent).map(|(k, _)| k as u16 + 1)
    }
}
