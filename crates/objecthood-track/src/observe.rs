//! Updates every track that is seen.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use crate::bits::Bits;
use crate::memory::{Look, Memory};
use crate::scene::Key;
use crate::segment::Segment;
use crate::support::carrier;
use crate::taken::CARRIED_M;
use crate::track::{Sample, Track};
use crate::tracked::Relation;

/// An agent reaches a thing if it is this close (px at VGA size).
const REACH_PX: f64 = 6.0;
/// A thing goes along with its carrier if it moved at most this much (m) farther.
const WITH_IT_M: f64 = 0.015;
/// The foot of a thing is at a surface if it is this close (m).
const AT_FOOT_M: f64 = 0.03;
/// A thing lies in another if the other rises above its foot by this (m).
const RIM_M: f64 = 0.01;

impl Memory {
    /// Updates every track and reports what happened to it.
    pub(crate) fn observe(&mut self, look: &Look<'_>) {
        let reach = self.reach(look);
        for k in 0..look.keys.len() {
            let key = look.keys[k];
            if look.keys[..k].contains(&key) {
                continue;
            }
            let sample = self.sample(&look.segments[k], reach.get(&key).map_or(&[][..], Vec::as_slice));
            let frame_s = self.pace.frame_s;
            let center = look.segments[k].center_in_camera;
            let Some(track) = self.tracks.get_mut(&key) else { continue };
            if let Some(found) = look.found.objects.get(k) {
                (track.held_frames, track.objectness) = (0, found.objectness);
            }
            if track.first.frame < self.frame {
                if track.rests() && !self.happenings.is_handled(key) {
                    track.drift = DVec3::ZERO;
                }
                if let Some(motion) = track.motion.as_ref().filter(|_| track.is_moving) {
                    let step = center - motion.rigid.inverse().point(center);
                    let world = look.place.world_from_camera;
                    track.drift += world.direction(step);
                    track.turn = motion.rigid.turn_seen_from(&world) * track.turn;
                }
                let noise_m = look.view.sigma_m(center.z);
                track.see(&look.segments[k], sample, frame_s, noise_m);
            }
        }
        self.vote(look);
        self.compare(look);
        self.find_arms(look);
        let carried = self.carried();
        for (&key, track) in &mut self.tracks {
            if track.last.frame == self.frame && track.part_of.is_none() {
                self.happenings.look(key, track, carried.contains(&key), look.place.up, self.pace);
            }
        }
        let remains = self.remains(look);
        self.tell_partings();
        self.tell_wholes(look);
        self.tell_openings(look, &remains);
        self.tell_drawers();
        self.join_drawers();
        self.tell_no_lids(self.stamp_s);
        self.tell_vessels(false);
        self.miss(look, &remains);
        self.tell_appearances();
    }

    pub(crate) fn sample(&self, segment: &Segment, reached_by: &[u32]) -> Sample {
        Sample {
            frame: self.frame,
            stamp_s: self.stamp_s,
            center: segment.center,
            height_m: segment.height_m,
            bottom_m: segment.bottom_m,
            top_m: segment.top_m,
            in_place: segment.in_place,
            px: segment.px,
            area_m2: segment.area_m2,
            changed: segment.changed,
            of_agent: segment.of_agent,
            at_border: segment.at_border,
            moves: false,
            reached_by: reached_by.first().copied(),
        }
    }

    /// The things that lie in or stand on another thing, which was moved as far as they were: they go along
    /// with it.
    pub(crate) fn carried(&self) -> BTreeSet<Key> {
        let moved_m =
            |track: &Track| track.rest.map_or(0.0, |rest| (track.last.center - rest.center).length());
        let goes_with = |track: &Track, below: &Track| moved_m(track) < moved_m(below) + WITH_IT_M;
        let is_carried = |track: &Track| match track.votes.winner() {
            Some((Some(below), _)) => self.tracks.get(&below).is_some_and(|carrier| {
                // A thing that was hidden in its carrier when the carrier was moved went along.
                let then = carrier.since(track.last.frame).next();
                let went_m = then.map_or(0.0, |then| (carrier.last.center - then.center).length());
                let moves = carrier.is_moving || self.happenings.is_handled(below);
                (moves || went_m > CARRIED_M) && goes_with(track, carrier)
            }),
            _ => false,
        };
        self.tracks.iter().filter(|(_, track)| is_carried(track)).map(|(&key, _)| key).collect()
    }

    /// The agents that reach each track: they touch it with pixels that belong to no known object.
    fn reach(&self, look: &Look<'_>) -> BTreeMap<Key, Vec<u32>> {
        let mut reach: BTreeMap<Key, Vec<u32>> = BTreeMap::new();
        for agent in self.agents.sure() {
            let is_object = |pixel: usize| {
                let key = self.scene.seen[pixel];
                key > 0
                    && self
                        .tracks
                        .get(&key)
                        .is_some_and(|track| track.rest.is_some() && !track.is_agent_part())
            };
            let mut own = agent.mask.clone();
            own.remove(&Bits::of(look.view.size, is_object));
            let near = own.dilated(look.view.length_px(REACH_PX));
            for pixel in near.pixels() {
                let key = self.scene.seen[pixel];
                if key > 0 && !own.has(pixel) {
                    let agents = reach.entry(key).or_default();
                    if !agents.contains(&agent.number) {
                        agents.push(agent.number);
                    }
                }
            }
        }
        reach
    }

    /// What holds each track: the thing on which it stands by this frame, else a thing that rested below it,
    /// else structure.
    fn vote(&mut self, look: &Look<'_>) {
        for (k, &key) in look.keys.iter().enumerate() {
            let told = (k < look.found.objects.len()).then(|| carrier(look.found, k)).flatten();
            let thing = |id| look.found.objects.iter().position(|object| object.id == id);
            let parent = told.and_then(|(parent, _)| parent).and_then(thing).map(|p| self.root(look.keys[p]));
            let parent = parent
                .filter(|p| *p != key && self.tracks.get(p).is_some_and(|track| !track.is_agent_part()));
            let rested = if parent.is_none() { self.rests_on(k, look) } else { None };
            let vote = rested.map(|(below, relation)| (Some(below), relation));
            let vote = vote.or(told.map(|(_, relation)| (parent, relation)));
            if let Some((parent, relation)) = vote
                && let Some(track) = self.tracks.get_mut(&key)
                && !track.is_moving
            {
                track.votes.add(parent, relation, self.pace);
            }
        }
    }

    /// What a thing stands on, or in, if a hand hides that: the foot of the thing is where the surface of
    /// another thing was when the other last rested.
    fn rests_on(&self, k: usize, look: &Look<'_>) -> Option<(Key, Relation)> {
        let segment = &look.segments[k];
        let foot = segment.center + (segment.bottom_m - segment.height_m) * look.place.up;
        let in_camera = look.place.world_from_camera.inverse().point(foot);
        let (key, at) = self.rested.surface(look.view.pixel_of(in_camera)?, look.view)?;
        let below = self.root(key);
        let carrier = self.tracks.get(&below)?;
        let at = look.place.world(at);
        // A thing that was pushed away leaves its surface behind.
        let is_its_own = (at - carrier.last.center).length() < carrier.area_m2.sqrt();
        let is_there = (at - foot).length() < AT_FOOT_M && !carrier.is_moving && is_its_own;
        if !is_there || below == self.root(look.keys[k]) {
            return None;
        }
        let is_in = carrier.rest?.top_m > segment.bottom_m + RIM_M;
        Some((below, if is_in { Relation::In } else { Relation::On }))
    }
}
