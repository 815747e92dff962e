//! A track: a thing that is followed.

use std::collections::VecDeque;

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use crate::align::Motion;
use crate::flight::{Flight, LEAST_FRAMES as FLIGHT_FRAMES, flights};
use crate::look::Look;
use crate::oneness::Oneness;
use crate::pace::Pace;
use crate::segment::Segment;
use crate::support::Votes;
use crate::surface::Surface;
use crate::tracked::TrackId;
use crate::vessel::Lay;
use crate::whole::Sight;

/// This many samples are kept: 3 s at 60 frames a second.
const MOST_SAMPLES: usize = 180;
/// This many hits confirm a track.
pub(crate) const CONFIRMING_HITS: u32 = 2;
/// A thing rests if less than this share of it changes,
pub(crate) const RESTING_CHANGE: f64 = 0.10;
/// if less than this share of it belongs to an agent's region,
const RESTING_OF_AGENT: f64 = 0.3;
/// and if it moves by less than this (m) from frame to frame.
const RESTING_STEP_M: f64 = 0.005;
/// A thing moves if it is displaced against where it was within this time (s), by this many standard
/// deviations of depth.
const DISPLACED_S: f64 = 0.15;
const DISPLACED_NOISES: f64 = 3.5;
/// A thing is still while its mean visible point stays within this (m), or within this share of its size,
/// because outlines flicker.
const STILL_M: f64 = 0.01;
const STILL_SHARE: f64 = 0.05;
/// A thing is elsewhere if its mean visible point is this far (m) from where it rested.
const AWAY_M: f64 = 0.02;
/// A thing is free of an agent if less than this share of it lies in the agent's region.
const FREE_OF_AGENT: f64 = 0.15;
/// A thing was free of the border once it was seen away from the border, and from agents, for this long (s).
const FREE_S: f64 = 0.2;
/// A thing is known once it has rested for this long (s).
pub(crate) const KNOWN_S: f64 = 0.2;
/// Positions are compared only if at least this share of the pixels of the thing is seen.
pub(crate) const AS_WHOLE: f64 = 0.75;

/// Evidence that a track is an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Deed {
    Lifted,
    PutDown,
    Pushed,
    Flew,
    PartsMovedAsOne,
}

impl Deed {
    pub(crate) fn in_words(self) -> &'static str {
        match self {
            Self::Lifted => "it was lifted and stayed whole",
            Self::PutDown => "it was put down and stayed whole",
            Self::Pushed => "it was pushed and stayed whole",
            Self::Flew => "it flew",
            Self::PartsMovedAsOne => "its parts moved as one",
        }
    }
}

/// A track in one frame.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Sample {
    pub(crate) frame: u64,
    pub(crate) stamp_s: f64,
    /// Mean visible point (m), in the world.
    pub(crate) center: DVec3,
    /// Heights (m) of its mean visible point and of its ends.
    pub(crate) height_m: f64,
    pub(crate) bottom_m: f64,
    pub(crate) top_m: f64,
    /// Share of its pixels that show what rested there before.
    pub(crate) in_place: f64,
    pub(crate) px: usize,
    /// Visible area, as if it faced the camera (m²).
    pub(crate) area_m2: f64,
    pub(crate) changed: f64,
    pub(crate) of_agent: f64,
    pub(crate) at_border: bool,
    /// Whether its motion was found and is more than noise.
    pub(crate) moves: bool,
    /// Number of the agent that reaches it.
    pub(crate) reached_by: Option<u32>,
}

impl Sample {
    /// Its frame and time (s).
    pub(crate) fn when(&self) -> (u64, f64) {
        (self.frame, self.stamp_s)
    }
}

/// The state of a thing when it last rested.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Rest {
    pub(crate) frame: u64,
    pub(crate) center: DVec3,
    pub(crate) height_m: f64,
    pub(crate) bottom_m: f64,
    pub(crate) top_m: f64,
    pub(crate) px: usize,
}

/// A track: a thing that is followed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Track {
    pub(crate) id: Option<TrackId>,
    pub(crate) hits: u32,
    pub(crate) first: Sample,
    pub(crate) last: Sample,
    pub(crate) samples: VecDeque<Sample>,
    pub(crate) look: Look,
    pub(crate) area_m2: f64,
    pub(crate) surface: Surface,
    /// Mean visible point (m), in the camera that saw it last.
    pub(crate) center_in_camera: DVec3,
    /// Velocity (m/s), in the world.
    pub(crate) velocity: DVec3,
    /// Its motion in the last frame, in the camera.
    pub(crate) motion: Option<Motion>,
    pub(crate) is_moving: bool,
    /// For how long it has rested (s).
    pub(crate) rest_s: f64,
    pub(crate) rest: Option<Rest>,
    pub(crate) first_rest: Option<Rest>,
    /// Where it lay when it last rested for a while.
    pub(crate) lay: Option<Lay>,
    /// How it is turned against its first orientation, as far as its motions were found, in the world.
    pub(crate) turn: DQuat,
    /// Length of its path since it was last at rest, and in all (m).
    pub(crate) path_m: f64,
    /// The sum of its motions since it last rested (m), in the world.
    pub(crate) drift: DVec3,
    /// A part of an agent if this is above 3.
    pub(crate) agent_score: i32,
    /// Whether it is an arm that was in the image from the first frame on.
    pub(crate) is_arm: bool,
    /// The number of frames in which, as a part of an agent, it was outside of the agent's region.
    pub(crate) free_frames: u32,
    pub(crate) votes: Votes,
    /// Whether frames show it as one while it rests.
    pub(crate) oneness: Oneness,
    /// The track that it turned out to be part of.
    pub(crate) part_of: Option<u32>,
    /// The numbers of tracks that turned out to be parts of it.
    pub(crate) parts: Vec<TrackId>,
    /// Evidence that it is an object.
    pub(crate) seen_to: Vec<Deed>,
    /// Why it is not seen, if it is not.
    pub(crate) is_covered: bool,
    pub(crate) hidden_since: Option<u64>,
    /// Frame and time (s) since which something has hidden where it rested.
    pub(crate) covered_since: Option<(u64, f64)>,
    pub(crate) told_hidden: bool,
    /// Frame and time (s) when its place was first found bare while it was not seen. Kept until it rests
    /// again.
    pub(crate) gone_since: Option<(u64, f64)>,
    /// Frame and time (s) since which its inside has been seen.
    pub(crate) ajar_since: Option<(u64, f64)>,
    pub(crate) told_opened: bool,
    pub(crate) was_there_first: bool,
    /// Whether, in the first frame, nothing but structure joined it to the border of the image.
    pub(crate) was_apart: bool,
    pub(crate) told_appeared: bool,
    pub(crate) told_left: bool,
    pub(crate) analysed_to: u64,
    /// Whether it was in view before but was no thing, and is one only since an agent hides what is beside
    /// it.
    pub(crate) is_doubted: bool,
    /// Whether it was first seen as something that was in view before but was no thing, while an agent, or a
    /// possible agent, was in view.
    pub(crate) was_doubted: bool,
    /// The track with which it was one until it was first seen.
    pub(crate) came_off: Option<u32>,
    /// Whether most of it belonged to a known thing when it was first seen, in an agent's region: then it is
    /// no part of the agent that pushes it.
    pub(crate) is_off_thing: bool,
    /// Whether it has been seen whole.
    pub(crate) sight: Sight,
    /// Whether a part of it was moved.
    pub(crate) lost_part: bool,
    /// The thing from which it is a part that was moved.
    pub(crate) moved_off: Option<u32>,
    /// The open thing in which it came into view.
    pub(crate) inside_of: Option<u32>,
    /// Objectness in the last frame that found it (1).
    pub(crate) objectness: f32,
    /// The number of frames for which it has been held where no segment shows it.
    pub(crate) held_frames: usize,
}

impl Track {
    pub(crate) fn new(segment: &Segment, sample: Sample, was_there_first: bool) -> Self {
        Self {
            id: None,
            hits: 1,
            first: sample,
            last: sample,
            samples: VecDeque::from([sample]),
            look: segment.look.clone(),
            area_m2: segment.area_m2,
            surface: Surface::default(),
            center_in_camera: segment.center_in_camera,
            velocity: DVec3::ZERO,
            motion: None,
            is_moving: false,
            rest_s: 0.0,
            rest: None,
            first_rest: None,
            lay: None,
            turn: DQuat::IDENTITY,
            path_m: 0.0,
            drift: DVec3::ZERO,
            agent_score: if segment.of_agent > 0.5 { 4 } else { 0 },
            is_arm: false,
            free_frames: 0,
            votes: Votes::default(),
            oneness: Oneness::default(),
            part_of: None,
            parts: Vec::new(),
            seen_to: Vec::new(),
            is_covered: false,
            hidden_since: None,
            covered_since: None,
            told_hidden: false,
            gone_since: None,
            ajar_since: None,
            told_opened: false,
            was_there_first,
            was_apart: false,
            told_appeared: was_there_first,
            told_left: false,
            analysed_to: sample.frame,
            is_doubted: false,
            was_doubted: false,
            came_off: None,
            is_off_thing: false,
            sight: Sight::NEW,
            lost_part: false,
            moved_off: None,
            inside_of: None,
            objectness: 0.5,
            held_frames: 0,
        }
    }

    /// Updates the track from a frame in which it is seen.
    pub(crate) fn see(&mut self, segment: &Segment, sample: Sample, frame_s: f64, noise_m: f64) {
        self.is_moving &= self.is_displaced(&sample, noise_m);
        self.hits += 1;
        self.center_in_camera = segment.center_in_camera;
        let pause_s = (sample.stamp_s - self.last.stamp_s).max(1e-6);
        let step = sample.center - self.last.center;
        let was_seen_just_now = pause_s < 2.5 * frame_s;
        self.velocity = if was_seen_just_now { step / pause_s } else { DVec3::ZERO };
        let is_whole = sample.px * 4 > self.last.px * 3 && self.last.px * 4 > sample.px * 3;
        self.path_m += if is_whole { step.length() } else { 0.0 };
        if segment.of_agent < RESTING_OF_AGENT || self.samples.len() < 3 {
            self.look.learn(&segment.look);
            // An agent may hide some of it, and a frame may take both for one.
            let grows = (self.area_m2..self.area_m2 / AS_WHOLE).contains(&segment.area_m2);
            if sample.reached_by.is_none() || grows {
                self.area_m2 += 0.1 * (segment.area_m2 - self.area_m2);
            }
        }
        let rests = segment.changed < RESTING_CHANGE
            && !self.is_moving
            && segment.of_agent < RESTING_OF_AGENT
            && (step.length() < RESTING_STEP_M || !is_whole || sample.px < 200);
        self.rest_s = if rests { self.rest_s + pause_s.min(frame_s * 2.0) } else { 0.0 };
        (self.is_covered, self.hidden_since, self.covered_since) = (false, None, None);
        (self.told_hidden, self.told_left) = (false, false);
        let sample = Sample { moves: self.is_moving, ..sample };
        self.last = sample;
        self.samples.push_back(sample);
        if self.samples.len() > MOST_SAMPLES {
            self.samples.pop_front();
        }
        self.judge_agent(segment);
    }

    /// Whether it was elsewhere a short while ago. Noise alone turns and shifts small things from frame to
    /// frame, back and forth. If a part of the thing is hidden, this cannot be decided; then its estimated
    /// motion counts.
    fn is_displaced(&self, sample: &Sample, noise_m: f64) -> bool {
        let recent = self.samples.iter().rev();
        let mut recent = recent.take_while(|earlier| sample.stamp_s - earlier.stamp_s <= DISPLACED_S);
        recent.any(|earlier| {
            let is_whole = sample.px * 4 > earlier.px * 3 && earlier.px * 4 > sample.px * 3;
            !is_whole || (sample.center - earlier.center).length() > DISPLACED_NOISES * noise_m
        })
    }

    /// Decides whether it is a part of an agent: what comes with an agent and never rested is, until it is
    /// let go.
    fn judge_agent(&mut self, segment: &Segment) {
        let is_part = self.is_agent_part();
        if segment.of_agent > 0.5 && !self.was_thing() {
            self.agent_score = (self.agent_score + 2).min(6);
        }
        if is_part && segment.of_agent < FREE_OF_AGENT {
            self.free_frames += 1;
            if self.free_frames >= 3 {
                (self.agent_score, self.free_frames) = (0, 0);
            }
        } else {
            self.free_frames = 0;
        }
    }

    pub(crate) fn is_agent_part(&self) -> bool {
        self.agent_score > 3
    }

    pub(crate) fn is_confirmed(&self) -> bool {
        !self.is_doubted && (self.hits >= CONFIRMING_HITS || self.first.frame == 0)
    }

    pub(crate) fn rests(&self) -> bool {
        self.rest_s >= KNOWN_S
    }

    /// Whether it rested in the last frame, and no agent reached it.
    pub(crate) fn is_left_alone(&self) -> bool {
        self.rest_s > 0.0 && self.last.reached_by.is_none()
    }

    /// Whether its surface was in view before it was a track, and nothing was seen to happen to it. Then it
    /// is probably a part of the room.
    pub(crate) fn is_scenery(&self) -> bool {
        self.was_doubted && self.seen_to.is_empty()
    }

    /// Whether it rests, and no agent reaches it.
    pub(crate) fn is_undisturbed(&self) -> bool {
        self.rests() && self.is_left_alone()
    }

    /// Whether it is elsewhere than where it last rested.
    pub(crate) fn is_away(&self) -> bool {
        self.rest.is_some_and(|rest| (self.last.center - rest.center).length() > AWAY_M)
    }

    /// Whether its motions since it last rested sum up to as much. Unlike its place, they are known of a thing
    /// that is hidden in part.
    pub(crate) fn has_drifted(&self) -> bool {
        self.drift.length() > AWAY_M
    }

    /// Whether it was moved by more than this (m) against another track since both first rested.
    pub(crate) fn was_moved_against(&self, other: &Self, least_m: f64) -> bool {
        let moved = |track: &Self| Some(track.rest?.center - track.first_rest?.center);
        moved(self).zip(moved(other)).is_some_and(|(own, others)| (own - others).length() > least_m)
    }

    /// Whether it was seen for some time (s), no motion was found, and it is where it was. (If a thing slides
    /// along its own plain face, no motion is found.)
    pub(crate) fn is_still_for(&self, seconds: f64, frame_s: f64) -> bool {
        let since_s = self.last.stamp_s - seconds;
        let mut recent = self.samples.iter().rev().take_while(|sample| sample.stamp_s > since_s);
        let least = (0.6 * seconds / frame_s) as usize;
        let still_m = STILL_M.max(STILL_SHARE * self.area_m2.sqrt());
        let is_there = |sample: &Sample| {
            !are_alike(sample.px, self.last.px) || (sample.center - self.last.center).length() < still_m
        };
        recent.all(|sample| !sample.moves && is_there(sample))
            && self.samples.iter().filter(|sample| sample.stamp_s > since_s).count() >= least
    }

    /// Whether it was seen by itself, away from the border, and never in an agent's region. An arm is not.
    pub(crate) fn was_free(&self, pace: Pace) -> bool {
        let is_free = |sample: &&Sample| !sample.at_border && sample.of_agent < FREE_OF_AGENT;
        let was_agents = self.samples.iter().any(|sample| sample.of_agent > 0.5);
        let free = self.samples.iter().filter(is_free).count();
        self.is_confirmed() && !was_agents && free >= pace.frames(FREE_S)
    }

    /// Whether it was there from the beginning, and nothing was done to it.
    pub(crate) fn was_never_handled(&self) -> bool {
        self.was_there_first && self.seen_to.iter().all(|&deed| deed == Deed::PartsMovedAsOne)
    }

    /// The agent that reached it last, within this time (s).
    pub(crate) fn reached_within(&self, seconds: f64) -> Option<u32> {
        let since_s = self.last.stamp_s - seconds;
        let recent = self.samples.iter().rev().take_while(|sample| sample.stamp_s >= since_s);
        recent.filter_map(|sample| sample.reached_by).next()
    }

    /// The agent that took it, if its place was found bare: the one that reached it within this time (s)
    /// before it was last seen there.
    pub(crate) fn taken_by(&self, seconds: f64) -> Option<u32> {
        let (gone, _) = self.gone_since?;
        let mut before = self.samples.iter().rev().skip_while(|sample| sample.frame >= gone).peekable();
        let since_s = before.peek()?.stamp_s - seconds;
        before.take_while(|sample| sample.stamp_s >= since_s).find_map(|sample| sample.reached_by)
    }

    /// Whether samples that were not analysed will soon be dropped, and the last ones are not in the middle
    /// of a flight.
    pub(crate) fn forgets_soon(&self) -> bool {
        let is_amid_flight = || {
            let last: Vec<Sample> = self.samples.iter().rev().take(FLIGHT_FRAMES).rev().copied().collect();
            !flights(&last, self.first.frame).is_empty()
        };
        self.since(self.analysed_to).count() > MOST_SAMPLES / 2 && !is_amid_flight()
    }

    /// Whether it has been in flight since a frame, as far as it was analysed.
    pub(crate) fn flew_since(&self, frame: u64) -> bool {
        !self.flights_since(frame).is_empty()
    }

    /// Its flights since a frame.
    pub(crate) fn flights_since(&self, frame: u64) -> Vec<Flight> {
        let samples: Vec<Sample> = self.since(frame).copied().collect();
        flights(&samples, self.first.frame)
    }

    /// The samples since a frame.
    pub(crate) fn since(&self, frame: u64) -> impl DoubleEndedIterator<Item = &Sample> {
        self.samples.iter().filter(move |sample| sample.frame >= frame)
    }

    /// The thing of which it may be a part: a moved part, or the inside.
    pub(crate) fn part_from(&self) -> Option<u32> {
        self.moved_off.or(self.inside_of)
    }

    /// Whether it rested, and is a part neither of another track nor of an agent.
    pub(crate) fn rested_alone(&self) -> bool {
        self.rest.is_some() && self.part_of.is_none() && !self.is_agent_part()
    }

    /// Whether it may be a part of another track, or was seen as one with it before.
    pub(crate) fn may_be_part_of(&self, whole: u32) -> bool {
        self.part_from() == Some(whole) || self.came_off == Some(whole)
    }

    /// Whether it rested as a thing, or was one, before any agent could bring it; or is a part of such a
    /// thing.
    fn was_thing(&self) -> bool {
        self.rest.is_some() || self.was_apart || self.part_from().is_some() || self.is_off_thing
    }

    /// Whether it is known to be a thing, or a part of one, and not a part of an agent.
    pub(crate) fn is_known(&self) -> bool {
        self.was_thing() && !self.is_agent_part()
    }

    /// Whether it is open.
    pub(crate) fn is_open(&self) -> bool {
        self.lost_part || self.told_opened
    }

    /// Marks it as a part of a known thing that was moved. So it is no part of an agent, and it did not
    /// appear. Its other faces look like the rest of the thing.
    pub(crate) fn move_off(&mut self, whole: u32, known: &mut Self) {
        known.lost_part = true;
        self.look = known.look.clone();
        (self.moved_off, self.agent_score) = (Some(whole), 0);
        self.came_off = (!known.told_opened).then_some(whole);
        (self.was_there_first, self.told_appeared) = (true, true);
    }

    /// What seemed to be its motion was that of a part.
    pub(crate) fn halt(&mut self) {
        (self.is_moving, self.motion, self.velocity) = (false, None, DVec3::ZERO);
        self.surface = Surface::default();
    }

    /// It belongs to an agent, and never was a thing.
    pub(crate) fn become_arm(&mut self) {
        self.is_arm = true;
        (self.rest, self.first_rest, self.lay, self.agent_score) = (None, None, None, 6);
        (self.came_off, self.is_off_thing, self.was_apart) = (None, false, false);
    }

    /// Notes that it rests as it was just seen.
    pub(crate) fn settle(&mut self) {
        let Sample { frame, center, height_m, bottom_m, top_m, px, .. } = self.last;
        self.gone_since = None;
        self.rest = Some(Rest { frame, center, height_m, bottom_m, top_m, px });
        self.first_rest = self.first_rest.or(self.rest);
    }

    pub(crate) fn note(&mut self, what: Deed) {
        if !self.seen_to.contains(&what) {
            self.seen_to.push(what);
        }
    }
}

/// Whether two sizes are those of a thing that both times is seen nearly as a whole.
pub(crate) fn are_alike(a: usize, b: usize) -> bool {
    is_as_whole(a, b) && is_as_whole(b, a)
}

/// Whether a thing of this size is seen nearly as much as when it had the size `before`.
pub(crate) fn is_as_whole(px: usize, before: usize) -> bool {
    px as f64 >= AS_WHOLE * before as f64
}
