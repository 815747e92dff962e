//! What the tracker remembers, and the order of its steps.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use objecthood::Discovery;

use crate::agent::Agents;
use crate::associate::{MEMORY_S, YOUNG_MEMORY_FRAMES};
use crate::bits::Bits;
use crate::camera::{CameraMotion, Place};
use crate::happening::Happenings;
use crate::knowledge::Knowledge;
use crate::output::Numbers;
use crate::pace::Pace;
use crate::predict::predict;
use crate::rigid::{Rigid, wide};
use crate::scene::{Key, Scene};
use crate::segment::Segment;
use crate::track::Track;
use crate::tracked::{Event, Relation, TrackNotice, Tracked};
use crate::view::View;

/// A track that is hidden is forgotten after this (s).
const FORGET_S: f64 = 30.0;

/// What is known after a frame.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    pub(crate) frame: u64,
    pub(crate) stamp_s: f64,
    pub(crate) pace: Pace,
    pub(crate) camera: CameraMotion,
    pub(crate) scene: Scene,
    pub(crate) agents: Agents,
    pub(crate) tracks: BTreeMap<Key, Track>,
    pub(crate) next: Key,
    pub(crate) knowledge: Knowledge,
    pub(crate) happenings: Happenings,
    pub(crate) numbers: Numbers,
    /// Pairs of tracks that touched in the last frame.
    pub(crate) touched: BTreeSet<(Key, Key)>,
}

/// What a frame shows.
pub(crate) struct Look<'a> {
    pub(crate) found: &'a Discovery,
    /// The segment at every pixel, counted from 1, 0 = none: first those of the discovery.
    pub(crate) labels: Vec<u16>,
    pub(crate) view: &'a View,
    pub(crate) changed: &'a Bits,
    pub(crate) place: Place,
    /// The segments, and the track that each shows.
    pub(crate) segments: Vec<Segment>,
    pub(crate) keys: Vec<Key>,
}

impl Memory {
    pub(crate) fn new(size: (usize, usize), stamp_s: f64) -> Self {
        Self {
            frame: 0,
            stamp_s,
            pace: Pace::UNKNOWN,
            camera: CameraMotion::new(),
            scene: Scene::empty(size),
            agents: Agents::none(size),
            tracks: BTreeMap::new(),
            next: 1,
            knowledge: Knowledge::default(),
            happenings: Happenings::default(),
            numbers: Numbers::default(),
            touched: BTreeSet::new(),
        }
    }

    /// The whole method.
    pub(crate) fn update(
        &mut self,
        view: &View,
        found: &Discovery,
        stamp_s: f64,
        pose: Option<Rigid>,
        mut notices: Vec<TrackNotice>,
    ) -> Tracked {
        let pause_s = stamp_s - self.stamp_s;
        self.stamp_s = stamp_s;
        if pause_s > Pace::GAP_S {
            notices.push(TrackNotice::Gap { seconds: pause_s });
            self.tracks.values_mut().for_each(|track| track.velocity = DVec3::ZERO);
        }
        self.pace = self.pace.after(pause_s);

        let place = self.camera.follow(view, pose, wide(found.up.direction));
        if place.is_lost {
            notices.push(TrackNotice::CameraLost);
        }
        if place.moves {
            self.scene.carry(&place.step, view);
        }
        let changed = self.scene.changed(view, place.moves);
        self.agents.update(view, &self.scene, place.moves, self.pace);
        let predicted = predict(&self.scene, view, &changed, &mut self.tracks, self.pace.frame_s);

        let look = self.identify(found, view, &changed, place, &predicted);
        self.observe(&look);
        self.scene.steady(view, &changed);
        self.scene.learn(view, &changed, &self.agents.region, self.pace);
        self.forget();
        let tracked = self.describe(&look, notices);
        self.frame += 1;
        tracked
    }

    /// Drops tracks that will not come back.
    fn forget(&mut self) {
        let (now_s, frame_s) = (self.stamp_s, self.pace.frame_s);
        let is_gone = |track: &Track| {
            let away_s = now_s - track.last.stamp_s;
            match track.is_confirmed() {
                true => away_s > if track.is_covered { FORGET_S } else { MEMORY_S },
                false => away_s > YOUNG_MEMORY_FRAMES * frame_s,
            }
        };
        let gone: Vec<Key> =
            self.tracks.iter().filter(|(_, track)| is_gone(track)).map(|(&key, _)| key).collect();
        for key in gone {
            self.tracks.remove(&key);
            self.knowledge.forget(key);
            self.happenings.forget(key);
        }
    }

    pub(crate) fn finish(&mut self) -> Vec<Event> {
        for (&key, track) in &mut self.tracks {
            self.happenings.close(key, track, self.pace);
        }
        let told = self.happenings.take();
        self.numbers.events(told, &mut self.tracks)
    }

    /// The track that a track is part of, or itself.
    pub(crate) fn root(&self, key: Key) -> Key {
        let mut key = key;
        while let Some(whole) = self.tracks.get(&key).and_then(|track| track.part_of) {
            key = whole;
        }
        key
    }

    /// The relation of a track to what holds it.
    pub(crate) fn held_by(&self, key: Key) -> Option<(Option<Key>, Relation)> {
        let track = self.tracks.get(&key)?;
        let is_in_air = track.is_moving
            && track.last.bottom_m > track.rest.map_or(f64::INFINITY, |rest| rest.bottom_m + 0.02);
        if is_in_air || track.rest_s == 0.0 && self.happenings.is_lifted(key) {
            return None;
        }
        track.votes.winner()
    }
}
