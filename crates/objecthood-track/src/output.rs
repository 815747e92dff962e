//! Converts what the tracker knows to its output: numbers, labels, states.

use std::collections::BTreeMap;

use glam::DVec3;
use objecthood::{PixelBox, Raster};
use serde::{Deserialize, Serialize};

use crate::bits::Bits;
use crate::happening::{Happening, Other};
use crate::memory::{Look, Memory};
use crate::rigid::Rigid;
use crate::scene::Key;
use crate::track::Track;
use crate::tracked::{
    Event, EventKind, LostTrack, MotionEstimate, Relation, SeenAgent, SupportRelation, TrackId, TrackNotice,
    TrackState, Tracked, TrackedObject,
};

/// A thing that moved when it was last seen is predicted to go on for this long (s).
const ALONG_S: f64 = 0.25;
/// A track is shown if it has this many pixels (at VGA size).
const SHOWN_PX: f64 = 100.0;

/// Assigns numbers.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Numbers {
    given: u16,
    agents: BTreeMap<u32, TrackId>,
}

impl Numbers {
    /// Agents are found again, and get new numbers.
    pub(crate) fn without_agents(mut self) -> Self {
        self.agents.clear();
        self
    }

    fn next(&mut self) -> Option<TrackId> {
        self.given = self.given.checked_add(1)?;
        Some(TrackId(self.given))
    }

    fn agent(&mut self, number: u32) -> Option<TrackId> {
        if let Some(&id) = self.agents.get(&number) {
            return Some(id);
        }
        let id = self.next()?;
        self.agents.insert(number, id);
        Some(id)
    }

    fn known_agent(&self, number: u32) -> Option<TrackId> {
        self.agents.get(&number).copied()
    }

    /// The events of tracks that have numbers; events of other tracks are dropped.
    pub(crate) fn events(&mut self, told: Vec<Happening>, tracks: &mut BTreeMap<Key, Track>) -> Vec<Event> {
        let mut events = Vec::new();
        for happening in told {
            let id_of = |key: Key| {
                let mut key = key;
                while let Some(whole) = tracks.get(&key)?.part_of {
                    key = whole;
                }
                tracks.get(&key)?.id
            };
            let Some(object) = id_of(happening.object) else { continue };
            let other = match happening.other {
                Other::Nobody => None,
                Other::Ground => Some(0),
                Other::Track(key) => {
                    let own = tracks.get(&key).and_then(|track| track.id);
                    // A part that has become one with the object keeps the name that it had before.
                    let named = if happening.kind == EventKind::Merged { own } else { id_of(key).or(own) };
                    if named == Some(object) {
                        continue;
                    }
                    // A track that is too small for a number, or was not seen for long enough, gets none.
                    named.map(|id| id.0)
                }
                Other::Agent(number) => self.agent(number).map(|id| id.0),
            };
            let by_agent = other.is_some() && matches!(happening.other, Other::Agent(_));
            let Happening { frame, time_s: time, kind, span, confidence, evidence, .. } = happening;
            let (start, end) = (span.map(|span| span.0), span.map(|span| span.1));
            events.push(Event {
                frame,
                time,
                kind,
                object,
                other,
                by_agent,
                start,
                end,
                confidence,
                evidence,
            });
        }
        events
    }
}

impl Memory {
    /// Describes the frame.
    pub(crate) fn describe(&mut self, look: &Look<'_>, mut notices: Vec<TrackNotice>) -> Tracked {
        let places = self.places(look);
        let least_px = look.view.px(SHOWN_PX);
        for (&key, place) in &places {
            let is_object = self.tracks.get(&key).is_some_and(|track| {
                track.id.is_none()
                    && track.is_confirmed()
                    && !track.is_agent_part()
                    && track.part_of.is_none()
            });
            if is_object && place.0 >= least_px {
                let id = self.numbers.next();
                if id.is_none() && !notices.contains(&TrackNotice::TooMany) {
                    notices.push(TrackNotice::TooMany);
                }
                if let Some(track) = self.tracks.get_mut(&key) {
                    track.id = id;
                }
            }
        }
        let id_of = |key: Key| {
            self.tracks.get(&key).filter(|track| !track.is_agent_part()).and_then(|track| track.id)
        };
        let mut shown: BTreeMap<Key, u16> = BTreeMap::new();
        for &key in places.keys() {
            shown.insert(key, id_of(key).map_or(0, |id| id.0));
        }
        let roots: BTreeMap<Key, Key> = self.tracks.keys().map(|&key| (key, self.root(key))).collect();
        let mut labels = vec![0_u16; self.scene.shown.len()];
        let mut last = (0, 0);
        for (label, &key) in labels.iter_mut().zip(&self.scene.shown) {
            if key > 0 {
                if key != last.0 {
                    last = (key, roots.get(&key).and_then(|root| shown.get(root)).copied().unwrap_or(0));
                }
                *label = last.1;
            }
        }
        let labels = Raster::from_vec(look.view.size.0, look.view.size.1, labels);
        let objects = self.objects(look, &places);
        let lost = self.lost(look);
        let agents = self.seen_agents(look);
        let support = self.relations(&objects, look);
        let told = self.happenings.take();
        let events = self.numbers.events(told, &mut self.tracks);
        Tracked {
            frame: self.frame,
            stamp_s: self.stamp_s,
            labels: labels.unwrap_or_else(|_| look.found.labels.clone()),
            objects: objects.into_iter().map(|(_, object)| object).collect(),
            lost,
            agents,
            support,
            events,
            world_from_camera: look.place.world_from_camera,
            camera_covariance: look.place.covariance,
            notices,
        }
    }

    /// Pixels and box of every track that is shown; parts count for the track that they are part of.
    fn places(&self, look: &Look<'_>) -> BTreeMap<Key, (usize, [usize; 4])> {
        let width = look.view.size.0;
        let mut places: BTreeMap<Key, (usize, [usize; 4])> = BTreeMap::new();
        let shown = &self.scene.shown;
        let mut pixel = 0;
        while pixel < shown.len() {
            let (key, v) = (shown[pixel], pixel / width);
            let end = (v + 1) * width;
            let mut last = pixel;
            while last + 1 < end && shown[last + 1] == key {
                last += 1;
            }
            if key > 0 {
                let (u0, u1) = (pixel % width, last % width);
                let place = places.entry(key).or_insert((0, [u0, v, u1, v]));
                place.0 += last + 1 - pixel;
                let area = &mut place.1;
                *area = [area[0].min(u0), area[1].min(v), area[2].max(u1), area[3].max(v)];
            }
            pixel = last + 1;
        }
        let mut wholes: BTreeMap<Key, (usize, [usize; 4])> = BTreeMap::new();
        for (key, (px, area)) in places {
            let whole = wholes.entry(self.root(key)).or_insert((0, area));
            whole.0 += px;
            let all = &mut whole.1;
            *all = [all[0].min(area[0]), all[1].min(area[1]), all[2].max(area[2]), all[3].max(area[3])];
        }
        wholes
    }

    fn objects(
        &self,
        look: &Look<'_>,
        places: &BTreeMap<Key, (usize, [usize; 4])>,
    ) -> Vec<(Key, TrackedObject)> {
        let mut objects = Vec::new();
        for (k, key) in look.keys.iter().enumerate() {
            let key = self.root(*key);
            let Some(track) = self.tracks.get(&key) else { continue };
            let found = look.found.objects.get(k);
            let is_known = objects.iter().any(|(known, _)| *known == key);
            if is_known || track.is_agent_part() {
                continue;
            }
            let Some(&(size_px, area)) = places.get(&key) else { continue };
            let motion = track.motion.as_ref().filter(|_| track.is_moving);
            let proof = 1.0 - 0.5_f32.powi(track.seen_to.len() as i32);
            objects.push((
                key,
                TrackedObject {
                    track: track.id,
                    state: if track.id.is_some() { TrackState::Confirmed } else { TrackState::Tentative },
                    found: found.map(|_| k),
                    center_m: look.segments[k].center_in_camera.as_vec3().to_array(),
                    pose: Rigid::of(track.turn, track.last.center),
                    parts: track.parts.clone(),
                    velocity_m_per_s: if track.is_moving { track.velocity.to_array() } else { [0.0; 3] },
                    motion: motion.map(|motion| MotionEstimate {
                        rigid: motion.rigid,
                        covariance: motion.covariance,
                        fit: motion.fit,
                    }),
                    size_px,
                    box_px: pixel_box(area),
                    box_m: found.map(|found| found.box_m),
                    objectness: track.objectness + (1.0 - track.objectness) * proof,
                    seen_to: track.seen_to.iter().map(|deed| deed.in_words()).collect(),
                },
            ));
        }
        objects.sort_by_key(|(key, object)| (object.track, *key));
        objects
    }

    fn lost(&self, look: &Look<'_>) -> Vec<LostTrack> {
        let shown = self.shown_now();
        let from_world = look.place.world_from_camera.inverse();
        let mut lost: Vec<LostTrack> = self
            .tracks
            .iter()
            .filter(|(key, track)| !shown.contains(key) && track.part_of.is_none() && !track.is_agent_part())
            .filter_map(|(_, track)| {
                let for_s = self.stamp_s - track.last.stamp_s;
                let state = if track.is_covered { TrackState::Occluded } else { TrackState::Lost };
                let center = self.expected_center(track);
                Some(LostTrack {
                    track: track.id?,
                    state,
                    center_m: from_world.point(center).to_array(),
                    pose: Rigid::of(track.turn, center),
                    for_s,
                })
            })
            .collect();
        lost.sort_by_key(|lost| lost.track);
        lost
    }

    /// The predicted mean point (m), in the world, of a track that is not seen.
    fn expected_center(&self, track: &Track) -> DVec3 {
        let carrier = track.votes.winner().and_then(|(below, _)| self.tracks.get(&self.root(below?)));
        let went_along = carrier.map(|carrier| {
            let then = carrier.samples.iter().rfind(|sample| sample.frame <= track.last.frame);
            then.map_or(DVec3::ZERO, |then| carrier.last.center - then.center)
        });
        let along_s = if track.last.moves { (self.stamp_s - track.last.stamp_s).min(ALONG_S) } else { 0.0 };
        track.last.center + went_along.unwrap_or(track.velocity * along_s)
    }

    fn seen_agents(&mut self, look: &Look<'_>) -> Vec<SeenAgent> {
        let agents: Vec<(u32, Bits)> =
            self.agents.sure().map(|agent| (agent.number, agent.mask.clone())).collect();
        let width = look.view.size.0;
        let seen = agents.into_iter().filter_map(|(number, mask)| {
            let id = self.numbers.agent(number)?;
            let area = mask.pixels().fold([usize::MAX, usize::MAX, 0, 0], |[a, b, c, d], pixel| {
                let (u, v) = (pixel % width, pixel / width);
                [a.min(u), b.min(v), c.max(u), d.max(v)]
            });
            Some(SeenAgent { id, size_px: mask.count(), box_px: pixel_box(area) })
        });
        seen.collect()
    }

    fn relations(&self, objects: &[(Key, TrackedObject)], look: &Look<'_>) -> Vec<SupportRelation> {
        let (carried, shown) = (self.carried(), self.shown_now());
        let carriers: BTreeMap<Key, u32> = self.happenings.carried().collect();
        let held = objects.iter().filter_map(|(key, object)| {
            let parent = self.numbers.known_agent(*carriers.get(key)?);
            Some(SupportRelation { child: object.track?, parent: Some(parent?), kind: Relation::Held })
        });
        let relation = |(key, object): &(Key, TrackedObject)| {
            let child = object.track?;
            let (parent, kind) = self.held_by(*key, carried.contains(key), look.place.up)?;
            let parent = parent.map(|key| self.root(key)).filter(|key| shown.contains(key));
            let parent = parent.and_then(|key| self.tracks.get(&key)).filter(|track| !track.is_agent_part());
            Some(SupportRelation {
                child,
                parent: parent.and_then(|track| track.id).filter(|&id| id != child),
                kind,
            })
        };
        objects.iter().filter_map(relation).chain(held).collect()
    }
}

/// A box from its first and last column and row.
fn pixel_box([u0, v0, u1, v1]: [usize; 4]) -> PixelBox {
    PixelBox { u: u0, v: v0, width: u1 + 1 - u0, height: v1 + 1 - v0 }
}
