//! What the tracker remembers, and the order of its steps.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use objecthood::Discovery;
use serde::{Deserialize, Serialize};

use crate::agent::{Agents, Things};
use crate::associate::{MEMORY_S, YOUNG_MEMORY_FRAMES};
use crate::bits::Bits;
use crate::camera::{CameraMotion, Place};
use crate::field::Fields;
use crate::happenings::Happenings;
use crate::ingredient::Ingredient;
use crate::knowledge::Knowledge;
use crate::output::Numbers;
use crate::pace::{Pace, Pauses};
use crate::predict::predict;
use crate::rested::Rested;
use crate::rigid::{Rigid, wide};
use crate::scene::{Key, Scene};
use crate::segment::Segment;
use crate::track::Track;
use crate::tracked::{Event, Relation, TrackNotice, Tracked};
use crate::view::View;

/// A hidden track is forgotten after this time (s).
pub(crate) const FORGET_S: f64 = 30.0;
/// A moving thing is in the air if it is this far (m) above where it rested, or if it rises or falls this
/// fast (m/s): a thing that rolls down a slope of 30 degrees does not in its first tenth of a second.
const IN_AIR_M: f64 = 0.02;
const IN_AIR_M_PER_S: f64 = 0.3;

/// What is known after a frame.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Memory {
    /// The ingredients that are left out.
    pub(crate) without: BTreeSet<Ingredient>,
    pub(crate) frame: u64,
    pub(crate) stamp_s: f64,
    pub(crate) pace: Pace,
    pub(crate) pauses: Pauses,
    pub(crate) camera: CameraMotion,
    /// The last frame in which the camera moved.
    pub(crate) camera_moved: Option<u64>,
    pub(crate) fields: Fields,
    pub(crate) scene: Scene,
    pub(crate) rested: Rested,
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
    /// The segment at every pixel, counted from 1, 0 = none. The segments of the discovery come first.
    pub(crate) labels: Vec<u16>,
    pub(crate) view: &'a View,
    pub(crate) changed: &'a Bits,
    pub(crate) place: Place,
    /// The segments, and the track that each shows.
    pub(crate) segments: Vec<Segment>,
    pub(crate) keys: Vec<Key>,
}

impl Memory {
    pub(crate) fn new(size: (usize, usize), stamp_s: f64, without: BTreeSet<Ingredient>) -> Self {
        Self {
            without,
            frame: 0,
            stamp_s,
            pace: Pace::UNKNOWN,
            pauses: Pauses::default(),
            camera: CameraMotion::new(),
            camera_moved: None,
            fields: Fields::default(),
            scene: Scene::empty(size),
            rested: Rested::empty(size),
            agents: Agents::none(size),
            tracks: BTreeMap::new(),
            next: 1,
            knowledge: Knowledge::default(),
            happenings: Happenings::default(),
            numbers: Numbers::default(),
            touched: BTreeSet::new(),
        }
    }

    /// Processes a frame: all steps of the tracker, in their order.
    pub(crate) fn update(
        &mut self,
        view: &View,
        (found, doubtful): (&Discovery, &[Vec<usize>]),
        stamp_s: f64,
        pose: Option<Rigid>,
        mut notices: Vec<TrackNotice>,
    ) -> Tracked {
        let pause_s = stamp_s - self.stamp_s;
        self.stamp_s = stamp_s;
        if self.pauses.is_gap(pause_s) {
            notices.push(TrackNotice::Gap { seconds: pause_s });
            self.tracks.values_mut().for_each(|track| track.velocity = DVec3::ZERO);
        }
        self.pace = self.pace.after(pause_s, &self.pauses);
        self.pauses.add(pause_s);

        let still = (!self.has(Ingredient::Camera)).then_some(Rigid::IDENTITY);
        let place = self.camera.follow(view, &self.agents.region, pose.or(still), wide(found.up.direction));
        if place.is_lost {
            notices.push(TrackNotice::CameraLost);
            self.lose_places(view.size);
        }
        if place.moves {
            self.camera_moved = Some(self.frame);
            self.scene.carry(&place, view);
            self.rested.carry(&place, view);
            self.tracks.values_mut().for_each(|track| track.surface.carry(&place.step));
        }
        if place.is_fast && self.agents.sure().next().is_none() {
            self.scene.rest(view);
        }
        self.scene.rest_on_planes(view, self.pace);
        let changed = self.scene.changed(view, place.moves);
        if self.has(Ingredient::Agents) {
            let keys = |is_such: &dyn Fn(&Track) -> bool| -> BTreeSet<Key> {
                self.tracks.iter().filter(|(_, track)| is_such(track)).map(|(&key, _)| key).collect()
            };
            let things = Things {
                free: keys(&|track| track.was_free(self.pace)),
                known: keys(&Track::is_known),
                arms: keys(&|track| track.is_arm && track.is_agent_part()),
            };
            self.agents.update(view, &self.scene, &changed, place.moves, self.pace, &things);
        }
        let predicted = self.expected(view, &changed);

        let look = self.identify((found, doubtful), view, &changed, place, &predicted);
        self.observe(&look);
        self.note_apart(view);
        self.agents.note_lifts(self.happenings.lifting());
        let rests = |key| {
            let track = self.tracks.get(&key);
            let is_seen = |track: &Track| track.last.frame == self.frame;
            track.is_some_and(|track| is_seen(track) && track.rests() && !track.is_doubted)
                && !self.happenings.is_handled(key)
        };
        self.rested.learn(&self.scene.seen, view, &changed, rests);
        match self.has(Ingredient::Steadying) {
            true => self.scene.steady(view, &changed),
            false => self.scene.shown.clone_from(&self.scene.seen),
        }
        self.scene.learn(view, &changed, &self.agents.region, self.pace);
        self.forget();
        let tracked = self.describe(&look, notices);
        self.frame += 1;
        tracked
    }

    /// The track that is expected at each pixel. O(n), and O(points) for each moving track.
    fn expected(&mut self, view: &View, changed: &Bits) -> Vec<Key> {
        if !self.has(Ingredient::Motion) {
            return self.scene.seen.clone();
        }
        let mut predicted = predict(&self.scene, view, changed, &mut self.tracks, self.pace.frame_s);
        let is_expected = |owner: Key| {
            self.tracks.get(&owner).is_some_and(Track::rested_alone) && !self.happenings.is_handled(owner)
        };
        // A thing does not pass before itself or what it came off.
        let passes = |key: Key, owner: Key| {
            let may_pass = self.tracks.get(&key).is_some_and(|track| !track.may_be_part_of(owner));
            may_pass && self.root(key) != owner && is_expected(owner)
        };
        self.rested.predict_again(&mut predicted, (&self.scene, view), passes);
        predicted
    }

    /// The camera is lost, so it is unknown what was seen at which pixel. The memory of places is cleared;
    /// otherwise everything that is nearer now would be an agent. Tracks are found again by their looks.
    fn lose_places(&mut self, size: (usize, usize)) {
        self.scene = Scene::empty(size);
        self.rested = Rested::empty(size);
        self.agents.lose(size);
        for track in self.tracks.values_mut() {
            track.halt();
        }
    }

    pub(crate) fn has(&self, ingredient: Ingredient) -> bool {
        !self.without.contains(&ingredient)
    }

    /// Drops tracks that will not come back.
    fn forget(&mut self) {
        let (now_s, frame_s) = (self.stamp_s, self.pace.frame_s);
        let shown = self.shown_now();
        let is_gone = |key: Key, track: &Track| {
            if shown.contains(&key) {
                return false;
            }
            let gone_s = track.gone_since.map_or(track.last.stamp_s, |(_, gone_s)| gone_s);
            let away_s = now_s - gone_s.max(track.last.stamp_s);
            match track.is_confirmed() {
                true => away_s > if track.is_covered { FORGET_S } else { MEMORY_S },
                false => away_s > YOUNG_MEMORY_FRAMES * frame_s,
            }
        };
        let gone: Vec<Key> =
            self.tracks.iter().filter(|&(&key, track)| is_gone(key, track)).map(|(&key, _)| key).collect();
        for key in gone {
            self.tracks.remove(&key);
            for part in self.tracks.values_mut().filter(|part| part.part_of == Some(key)) {
                part.part_of = None;
            }
            self.knowledge.forget(key);
            self.happenings.forget(key);
        }
    }

    pub(crate) fn finish(&mut self) -> Vec<Event> {
        for (&key, track) in self.tracks.iter_mut().filter(|(_, track)| track.part_of.is_none()) {
            self.happenings.close(key, track, self.pace);
        }
        self.tell_appearances();
        self.tell_no_lids(f64::INFINITY);
        self.tell_vessels(true);
        let told = self.happenings.take();
        self.numbers.events(told, &mut self.tracks)
    }

    /// The track that a track is part of, or the track itself.
    pub(crate) fn root(&self, key: Key) -> Key {
        let mut key = key;
        while let Some(whole) = self.tracks.get(&key).and_then(|track| track.part_of) {
            key = whole;
        }
        key
    }

    /// The relation of a track to what holds it; none while it is in the air. `is_carried`: by what holds it.
    pub(crate) fn held_by(&self, key: Key, is_carried: bool, up: DVec3) -> Option<(Option<Key>, Relation)> {
        let track = self.tracks.get(&key)?;
        let above_m = track.rest.map_or(0.0, |rest| track.last.bottom_m - rest.bottom_m);
        let is_in_air =
            track.is_moving && (above_m > IN_AIR_M || track.velocity.dot(up).abs() > IN_AIR_M_PER_S);
        let is_lifted = track.rest_s == 0.0 && self.happenings.is_lifted(key);
        if !is_carried && (is_in_air || is_lifted) { None } else { track.votes.winner() }
    }
}
