//! The tracker: the order of its steps.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use objecthood::{Discovery, Estimates, Frame, Params, Pipeline};

use crate::agent::Agents;
use crate::associate::{MEMORY_S, Overlap, YOUNG_MEMORY_FRAMES, associate};
use crate::bits::Bits;
use crate::camera::{CameraMotion, Place};
use crate::error::Result;
use crate::happening::{Happening, Happenings, Other};
use crate::knowledge::Knowledge;
use crate::output::Numbers;
use crate::pace::Pace;
use crate::predict::predict;
use crate::rigid::{Rigid, wide};
use crate::scene::{Key, Scene};
use crate::segment::{Measure, Segment, is_looked_at, labels, segments};
use crate::support::carrier;
use crate::track::{Sample, Track};
use crate::tracked::{Event, EventKind, Relation, TrackNotice, Tracked};
use crate::view::View;

/// A track that is hidden is forgotten after this (s).
const FORGET_S: f64 = 30.0;
/// An agent reaches what is this close to it (px at VGA size).
const REACH_PX: f64 = 6.0;
/// What no segment shows is held when its motion fits so well, or while it rests, so long (s).
const HELD_FIT: f64 = 0.5;
const HELD_S: f64 = 1.0;
/// Tracks touch when they are this close (px at VGA size).
const TOUCH_PX: f64 = 3.0;

/// Follows objects through a video. The only type that remembers earlier frames.
///
/// Memory: about 30 bytes a pixel and 20 kB a track; tracks that are not seen for 30 s are forgotten.
#[derive(Debug)]
pub struct Tracker {
    params: Params,
    pipeline: Pipeline,
    estimates: Option<Estimates>,
    memory: Option<Memory>,
}

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

impl Tracker {
    /// A tracker that has seen nothing; `params` are those of the discovery.
    pub fn new(params: Params) -> Self {
        Self { params, pipeline: Pipeline::default(), estimates: None, memory: None }
    }

    /// Forgets everything. Numbers begin at 1 again.
    pub fn reset(&mut self) {
        (self.memory, self.estimates) = (None, None);
    }

    /// Takes the next frame: finds its objects and follows them. `stamp_s`: when it was taken, which has to rise. `pose`: takes
    /// points of the camera to the world, if that is known; else the camera's motion is found. Estimates of noise and up are handed from
    /// frame to frame.
    ///
    /// # Errors
    /// As [`Pipeline::discover`]; [`Error::Stamp`](crate::Error::Stamp) when the stamp does not rise. The frame then counts for nothing.
    pub fn update(&mut self, frame: &Frame, stamp_s: f64, pose: Option<Rigid>) -> Result<Tracked> {
        let mut pipeline = std::mem::take(&mut self.pipeline);
        let known = frame.clone().with_estimates(self.estimates);
        let tracked = pipeline.discover(&known, &self.params).map_err(Into::into).and_then(|found| {
            self.estimates = found.estimates.or(self.estimates);
            self.update_found(frame, found, stamp_s, pose)
        });
        self.pipeline = pipeline;
        tracked
    }

    /// As [`Self::update`], with objects that were found by anyone.
    ///
    /// # Errors
    /// [`Error::Stamp`](crate::Error::Stamp) when the stamp does not rise, [`Error::Size`](crate::Error::Size) when the labels have another size than the
    /// frame.
    pub fn update_found(
        &mut self,
        frame: &Frame,
        found: &Discovery,
        stamp_s: f64,
        pose: Option<Rigid>,
    ) -> Result<Tracked> {
        crate::error::check(frame, found, stamp_s, self.memory.as_ref().map(|memory| memory.stamp_s))?;
        let noise =
            found.estimates.map_or(1.0, |estimates| estimates.noise.white.max(estimates.noise.waves()));
        let view = View::of(frame, (noise as f32).clamp(1.0, 5.0));
        let mut notices = Vec::new();
        if self.memory.as_ref().is_some_and(|memory| memory.scene.size() != view.size) {
            notices.push(TrackNotice::OtherSize);
            self.memory = None;
        }
        let memory = self.memory.get_or_insert_with(|| Memory::new(view.size, stamp_s));
        Ok(memory.update(&view, found, stamp_s, pose, notices))
    }

    /// Events that become certain when the video ends.
    pub fn finish(&mut self) -> Vec<Event> {
        self.memory.as_mut().map_or_else(Vec::new, Memory::finish)
    }
}

impl Memory {
    fn new(size: (usize, usize), stamp_s: f64) -> Self {
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
    fn update(
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

    /// Which track each segment shows; writes the tracks that are seen to the scene.
    fn identify<'a>(
        &mut self,
        found: &'a Discovery,
        view: &'a View,
        changed: &'a Bits,
        place: Place,
        predicted: &[Key],
    ) -> Look<'a> {
        let measure = Measure { view, changed, agents: &self.agents, place: &place };
        let (labels, count) = labels(found, view, &self.scene, &self.agents);
        let segments = segments(&labels, count, &measure);
        let overlap = self.overlap(&labels, view, predicted);
        let tracks_of = associate(&segments, &self.tracks, &overlap, self.stamp_s, self.pace);
        let mut keys = Vec::new();
        let mut fresh = Vec::new();
        for (k, segment) in segments.iter().enumerate() {
            let whole = tracks_of[k].or_else(|| self.fragment_of(k, segment, &overlap, &tracks_of));
            keys.push(whole.unwrap_or_else(|| {
                fresh.push((k, self.next));
                self.next += 1;
                self.next - 1
            }));
        }
        for &(k, key) in &fresh {
            let sample = self.sample(&segments[k], &[]);
            let mut track = Track::new(&segments[k], sample, self.frame == 0);
            let parent = self.came_off(k, &overlap);
            if let Some(parent) = parent {
                track.was_there_first = true;
                track.told_appeared = true;
                track.came_off = Some(parent);
            }
            self.tracks.insert(key, track);
        }
        let mut look = Look { found, labels, view, changed, place, segments, keys };
        self.write_seen(&mut look, predicted, &overlap);
        look
    }

    /// Counts the pixels that segments and predicted masks have in common.
    fn overlap(&self, labels: &[u16], view: &View, predicted: &[Key]) -> Overlap {
        let mut overlap = Overlap::default();
        let mut run: (Key, u16, usize, usize) = (0, 0, 0, 0);
        let mut flush = |(key, label, px, visible): (Key, u16, usize, usize)| {
            if key > 0 && px > 0 {
                *overlap.predicted.entry(key).or_default() += visible;
                if label > 0 {
                    *overlap.common.entry((usize::from(label) - 1, key)).or_default() += px;
                }
            }
        };
        for (pixel, (&key, &label)) in predicted.iter().zip(labels).enumerate() {
            if (key, label) != (run.0, run.1) {
                flush(run);
                run = (key, label, 0, 0);
            }
            run.2 += 1;
            // What stands before the track now hides it there.
            run.3 += usize::from(key > 0 && (label > 0 || !self.scene.is_covered(view, pixel)));
        }
        flush(run);
        overlap
    }

    /// The resting track of which a segment without a track of its own is a fragment: most of its pixels belong to it, and it
    /// shows itself elsewhere too, while an agent stands before it.
    fn fragment_of(
        &self,
        k: usize,
        segment: &Segment,
        overlap: &Overlap,
        tracks_of: &[Option<Key>],
    ) -> Option<Key> {
        const MOST_OF_IT: f64 = 0.6;
        let parts = overlap.common.range((k, 0)..=(k, Key::MAX));
        let (&(_, key), &common) =
            parts.max_by_key(|&(&(_, key), &common)| (common, std::cmp::Reverse(key)))?;
        let track = self.tracks.get(&key)?;
        let is_part = common as f64 > MOST_OF_IT * segment.px as f64 && segment.changed < 0.5;
        let is_seen = tracks_of.contains(&Some(key));
        (is_part && is_seen && track.rest.is_some() && track.rests() && self.is_reached(key)).then_some(key)
    }

    /// Whether an agent stands close to where a track was seen.
    fn is_reached(&self, key: Key) -> bool {
        self.tracks.get(&key).is_some_and(|track| track.last.reached_by.is_some())
    }

    /// The track to which most pixels of a fresh segment belonged while it rested.
    fn came_off(&self, k: usize, overlap: &Overlap) -> Option<Key> {
        let parts = overlap.common.range((k, 0)..=(k, Key::MAX));
        let (&(_, key), &common) =
            parts.max_by_key(|&(&(_, key), &common)| (common, std::cmp::Reverse(key)))?;
        let is_known =
            self.tracks.get(&key).is_some_and(|track| track.rest.is_some() && !track.is_agent_part());
        let predicted = overlap.predicted.get(&key).copied().unwrap_or(0);
        (is_known && common as f64 > 0.1 * predicted as f64).then_some(key)
    }

    /// Writes which track is seen at each pixel. A segment that holds several tracks which were seen to move apart is parted by where they
    /// should be.
    fn write_seen(&mut self, look: &mut Look<'_>, predicted: &[Key], overlap: &Overlap) {
        let mut parted: BTreeMap<usize, BTreeSet<Key>> = BTreeMap::new();
        let keys = look.keys.clone();
        for (k, &owner) in keys.iter().enumerate() {
            let is_seen = |key: Key| keys.contains(&key);
            let (apart, one) = self.knowledge.held(k, owner, overlap, &self.tracks, &self.touched, is_seen);
            if !apart.is_empty() {
                parted.insert(k, apart.into_iter().collect());
            }
            for part in one {
                self.join(owner, part, true);
            }
        }
        let mut pieces: BTreeMap<Key, Vec<usize>> = BTreeMap::new();
        let width = look.view.size.0;
        for (pixel, &label) in look.labels.iter().enumerate() {
            let Some(k) = usize::from(label).checked_sub(1) else {
                self.scene.seen[pixel] = 0;
                continue;
            };
            let mut key = keys[k];
            if let Some(others) = parted.get(&k) {
                if others.contains(&predicted[pixel]) {
                    key = predicted[pixel];
                }
                if is_looked_at(pixel, width) {
                    pieces.entry(key).or_default().push(pixel);
                }
            }
            self.scene.seen[pixel] = key;
        }
        self.hold(look, predicted, overlap, &mut pieces);
        let measure =
            Measure { view: look.view, changed: look.changed, agents: &self.agents, place: &look.place };
        for (key, pixels) in pieces.into_iter().filter(|(_, pixels)| pixels.len() > 8) {
            let segment = measure.segment(&pixels);
            match look.keys.iter().position(|&known| known == key) {
                Some(k) => look.segments[k] = segment,
                None => {
                    look.segments.push(segment);
                    look.keys.push(key);
                }
            }
        }
    }

    /// Known things that no segment shows stay where their motion, or rest, says that they are, if the depth agrees: what a hand
    /// carries has no support, so the frame alone may take it for no object.
    fn hold(
        &mut self,
        look: &Look<'_>,
        predicted: &[Key],
        overlap: &Overlap,
        pieces: &mut BTreeMap<Key, Vec<usize>>,
    ) {
        let is_held = |key: Key| {
            let Some(track) = self.tracks.get(&key) else { return false };
            let is_seen = look.keys.contains(&key);
            let moves = track.motion.as_ref().is_some_and(|motion| motion.fit > HELD_FIT);
            let rests = track.rest_s > 0.0 && track.held_frames < self.pace.frames(HELD_S);
            track.rest.is_some()
                && !track.is_agent_part()
                && track.part_of.is_none()
                && !is_seen
                && (moves || rests)
        };
        let held: BTreeSet<Key> = overlap.predicted.keys().copied().filter(|&key| is_held(key)).collect();
        if held.is_empty() {
            return;
        }
        let width = look.view.size.0;
        for (pixel, &key) in predicted.iter().enumerate() {
            if !held.contains(&key) {
                continue;
            }
            let moves = self.tracks[&key].is_moving;
            let owner = self.scene.seen[pixel];
            let is_free = owner == 0 || self.tracks.get(&owner).is_some_and(Track::is_agent_part);
            let is_there = moves || !look.changed.has(pixel) && look.view.inverse[pixel] > 0.0;
            if is_free && is_there {
                self.scene.seen[pixel] = key;
                if is_looked_at(pixel, width) {
                    pieces.entry(key).or_default().push(pixel);
                }
            }
        }
        for key in held {
            if let Some(track) = self.tracks.get_mut(&key) {
                track.held_frames += 1;
            }
        }
    }

    /// Two tracks turned out to be one: the one with more pixels goes on.
    fn join(&mut self, owner: Key, part: Key, is_event: bool) {
        let id = self.tracks[&owner].id.zip(self.tracks[&part].id);
        let (keeper, other) = match id {
            Some((a, b)) if b < a && !is_event => (part, owner),
            _ => (owner, part),
        };
        if let Some(track) = self.tracks.get_mut(&other) {
            track.part_of = Some(keeper);
        }
        if is_event {
            self.happenings.tell(Happening {
                frame: self.frame,
                time_s: self.stamp_s,
                kind: EventKind::Merged,
                object: owner,
                other: Other::Track(part),
                span: None,
                confidence: 0.9,
                evidence: "what stood before it is gone, and both parts are one surface".to_owned(),
            });
        } else if let Some(track) = self.tracks.get_mut(&keeper) {
            track.note("its parts moved as one");
        }
    }

    /// Brings every track up to date and tells what happened to it.
    fn observe(&mut self, look: &Look<'_>) {
        let reach = self.reach(look);
        for k in 0..look.keys.len() {
            let key = look.keys[k];
            if look.keys[..k].contains(&key) {
                continue;
            }
            let sample = self.sample(&look.segments[k], reach.get(&key).map_or(&[][..], Vec::as_slice));
            let frame_s = self.pace.frame_s;
            let center = look.segments[k].center_in_camera;
            if let Some(track) = self.tracks.get_mut(&key)
                && track.first.frame < self.frame
            {
                if let Some(found) = look.found.objects.get(k) {
                    (track.held_frames, track.objectness) = (0, found.objectness);
                }
                if track.rests() && !self.happenings.is_handled(key) {
                    track.drift = DVec3::ZERO;
                }
                if let Some(motion) = track.motion.as_ref().filter(|_| track.is_moving) {
                    let step = center - motion.rigid.inverse().point(center);
                    track.drift += look.place.world_from_camera.direction(step);
                }
                track.see(&look.segments[k], sample, frame_s);
            }
        }
        self.vote(look);
        self.compare(look);
        for (&key, track) in &mut self.tracks {
            if track.last.frame == self.frame {
                self.happenings.look(key, track, look.place.up, self.pace);
            }
        }
        self.tell_partings();
        self.miss(look);
        self.tell_appearances();
    }

    fn sample(&self, segment: &Segment, reached_by: &[u32]) -> Sample {
        Sample {
            frame: self.frame,
            stamp_s: self.stamp_s,
            center: segment.center,
            height_m: segment.height_m,
            bottom_m: segment.bottom_m,
            px: segment.px,
            changed: segment.changed,
            of_agent: segment.of_agent,
            at_border: segment.at_border,
            moves: false,
            reached_by: reached_by.first().copied(),
        }
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

    /// What holds each track in this frame.
    fn vote(&mut self, look: &Look<'_>) {
        let objects = look.found.objects.len();
        for k in 0..objects {
            let key = look.keys[k];
            let Some((parent, relation)) = carrier(look.found, k) else { continue };
            let parent = parent.and_then(|id| look.found.objects.iter().position(|object| object.id == id));
            let parent = parent.map(|p| self.root(look.keys[p])).filter(|&p| p != key);
            let parent = parent.filter(|p| self.tracks.get(p).is_some_and(|track| !track.is_agent_part()));
            if let Some(track) = self.tracks.get_mut(&key)
                && !track.is_moving
            {
                track.votes.add(parent, relation);
            }
        }
    }

    /// The track that a track is part of, or itself.
    pub(crate) fn root(&self, key: Key) -> Key {
        let mut key = key;
        while let Some(whole) = self.tracks.get(&key).and_then(|track| track.part_of) {
            key = whole;
        }
        key
    }

    /// Learns from tracks that touch.
    fn compare(&mut self, look: &Look<'_>) {
        let (width, height) = look.view.size;
        let reach = look.view.length_px(TOUCH_PX);
        let mut touching = BTreeSet::new();
        for v in 0..height {
            for u in 0..width {
                let pixel = v * width + u;
                let key = self.scene.seen[pixel];
                if key == 0 {
                    continue;
                }
                let right = (u + reach < width).then(|| pixel + reach);
                let below = (v + reach < height).then(|| pixel + reach * width);
                for other in [right, below].into_iter().flatten().map(|at| self.scene.seen[at]) {
                    if other > 0 && other != key {
                        touching.insert((key.min(other), key.max(other)));
                    }
                }
            }
        }
        for (a, b) in self.knowledge.learn(&touching, &self.tracks) {
            self.join(a, b, false);
        }
        self.touched = touching;
    }

    /// What came off another thing and moved against it was one with it before.
    fn tell_partings(&mut self) {
        const PARTED_M: f64 = 0.005;
        const SEEN_LATE_S: f64 = 0.2;
        let mut parted = Vec::new();
        for (&key, track) in &self.tracks {
            let Some(from) = track.came_off else { continue };
            let Some(other) = self.tracks.get(&from) else { continue };
            if track.last.frame != self.frame
                || other.last.frame != self.frame
                || !track.is_confirmed()
                || track.is_agent_part()
            {
                continue;
            }
            let moved = |track: &Track, since: DVec3| (track.last.center - since).length();
            let (own, others) = (
                moved(track, track.first.center),
                other
                    .samples
                    .iter()
                    .find(|s| s.frame >= track.first.frame)
                    .map_or(0.0, |s| moved(other, s.center)),
            );
            if own.max(others) > PARTED_M
                && (own - others).abs() > PARTED_M
                && (track.is_moving || other.is_moving || track.rests())
            {
                parted.push((key, from, own > others));
            }
        }
        for (key, from, own_moved) in parted {
            let track = &self.tracks[&key];
            // The parts may have moved for a while before the frame showed them as two.
            let rested = self.tracks.get(&from).and_then(|other| other.rest).map_or(0, |rest| rest.frame + 1);
            let early = track.first.frame.saturating_sub(self.pace.frames(SEEN_LATE_S) as u64);
            let frame = rested.clamp(early, track.first.frame);
            let time_s = track.first.stamp_s - (track.first.frame - frame) as f64 * self.pace.frame_s;
            let (object, other) = if own_moved { (key, from) } else { (from, key) };
            self.knowledge.part(key, from);
            self.happenings.tell(Happening {
                frame,
                time_s,
                kind: EventKind::Split,
                object,
                other: Other::Track(other),
                span: None,
                confidence: 0.8,
                evidence: "one moved against the other".to_owned(),
            });
            if let Some(track) = self.tracks.get_mut(&key) {
                track.came_off = None;
            }
        }
    }

    /// Tracks that are not seen: what stands before them?
    fn miss(&mut self, look: &Look<'_>) {
        let width = look.view.size.0;
        let missing: Vec<Key> = self
            .tracks
            .iter()
            .filter(|(_, track)| track.last.frame != self.frame && track.part_of.is_none())
            .map(|(&key, _)| key)
            .collect();
        for key in missing {
            let track = &self.tracks[&key];
            let since = track.hidden_since.unwrap_or(self.frame);
            // Where it was, as seen from here.
            let at = look.place.world_from_camera.inverse().point(track.last.center);
            let pixel = look.view.pixel_of(at);
            let in_front = pixel.is_some_and(|pixel| {
                let inverse = f64::from(look.view.inverse[pixel]);
                self.agents.region.has(pixel) || inverse > 0.0 && 1.0 / inverse < at.z - 0.02
            });
            let by = pixel.and_then(|pixel| {
                let agent = self
                    .agents
                    .sure()
                    .find(|agent| agent.mask.has(pixel))
                    .map(|agent| Other::Agent(agent.number));
                let key = self.scene.seen[pixel];
                debug_assert!(pixel / width < look.view.size.1);
                agent.or((key > 0).then_some(Other::Track(key)))
            });
            let frames = self.frame - since + 1;
            let is_known = track.rest.is_some() && track.rest_s > 0.0 && !track.is_agent_part();
            let tell_hidden = in_front
                && !track.told_hidden
                && is_known
                && frames as usize >= self.pace.frames(0.1)
                && !self.happenings.is_handled(key);
            let is_thing = track.was_there_first || track.rest.is_some() || track.hits >= 8;
            let left = track.last.at_border
                && !track.told_left
                && is_thing
                && !track.is_agent_part()
                && frames >= 3
                && !in_front;
            let (last, is_moving) = (track.last, track.velocity.length() > 0.02);
            if tell_hidden {
                self.happenings.tell(Happening {
                    frame: since,
                    time_s: self.stamp_s - (frames - 1) as f64 * self.pace.frame_s,
                    kind: EventKind::Occluded,
                    object: key,
                    other: by.unwrap_or(Other::Nobody),
                    span: None,
                    confidence: 0.8,
                    evidence: "something nearer stands where it was".to_owned(),
                });
            }
            let tell_left = left && is_moving;
            if tell_left {
                self.happenings.tell(Happening {
                    frame: last.frame + 1,
                    time_s: last.stamp_s + self.pace.frame_s,
                    kind: EventKind::Left,
                    object: key,
                    other: Other::Nobody,
                    span: None,
                    confidence: 0.8,
                    evidence: "it moved at the border of the image".to_owned(),
                });
            }
            let Some(track) = self.tracks.get_mut(&key) else { continue };
            track.hidden_since = Some(since);
            track.is_covered = in_front;
            track.told_hidden |= tell_hidden;
            track.told_left |= tell_left;
            track.rest_s = if in_front { track.rest_s } else { 0.0 };
            if frames == 4 {
                self.happenings.fly(key, track);
            }
        }
    }

    /// New things that are things of their own came into view.
    fn tell_appearances(&mut self) {
        for (&key, track) in &mut self.tracks {
            let is_new = !track.told_appeared
                && track.is_confirmed()
                && !track.is_agent_part()
                && track.part_of.is_none();
            let has_settled = track.rest_s > 0.25 || track.seen_to.contains(&"it flew");
            if is_new && has_settled {
                track.told_appeared = true;
                let came = track.samples.iter().take(6).any(|sample| sample.changed > 0.5);
                if came {
                    self.happenings.tell(Happening {
                        frame: track.first.frame,
                        time_s: track.first.stamp_s,
                        kind: EventKind::Appeared,
                        object: key,
                        other: Other::Nobody,
                        span: None,
                        confidence: 0.6,
                        evidence: "it was not there before, and is a thing of its own".to_owned(),
                    });
                }
            }
        }
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

    fn finish(&mut self) -> Vec<Event> {
        for (&key, track) in &mut self.tracks {
            self.happenings.close(key, track, self.pace);
        }
        let told = self.happenings.take();
        self.numbers.events(told, &mut self.tracks)
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
