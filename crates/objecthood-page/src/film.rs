//! What is told of a video: what happened, how long each track was seen, and where it was.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};
use objecthood_track::{Event, Rigid, Tracked};
use serde::Serialize;

/// Of a path so many points are kept, the last ones, and so many are shown.
const KEPT_POINTS: usize = 4000;
const SHOWN_POINTS: usize = 300;

/// A video, as far as it was followed.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Film {
    /// When each frame that can be shown was taken (s).
    stamps_s: Vec<f64>,
    happenings: Vec<Happening>,
    lives: BTreeMap<u16, Life>,
    /// Where each track was (m, in the world), and how many frames could be shown before.
    #[serde(skip)]
    paths: BTreeMap<u16, Vec<(usize, DVec3)>>,
    /// The camera of each frame that can be shown, and the tracks that it sees.
    #[serde(skip)]
    views: Vec<(Rigid, Vec<u16>)>,
}

/// Something that happened to a track.
#[derive(Clone, Debug, Serialize)]
struct Happening {
    time_s: f64,
    track: u16,
    /// A sentence.
    text: String,
}

/// When a track was seen for the first and for the last time.
#[derive(Clone, Copy, Debug, Serialize)]
struct Life {
    first_s: f64,
    last_s: f64,
}

/// A track, and where it was (m, in a camera).
pub(crate) type Path = (u16, Vec<[f32; 3]>);

impl Film {
    /// Takes in what is said of the next frame. O(tracks).
    pub fn take(&mut self, tracked: &Tracked) {
        for object in &tracked.objects {
            let Some(track) = object.track.map(|track| track.0) else { continue };
            let path = self.paths.entry(track).or_default();
            let center_m = Vec3::from(object.center_m).as_dvec3();
            path.push((self.views.len(), tracked.world_from_camera.point(center_m)));
            path.drain(..path.len().saturating_sub(KEPT_POINTS));
            let seen = Life { first_s: tracked.stamp_s, last_s: tracked.stamp_s };
            self.lives.entry(track).or_insert(seen).last_s = tracked.stamp_s;
        }
        tracked.events.iter().for_each(|event| self.tell(event));
    }

    /// Takes in an event: one that became certain when the video ended.
    pub fn tell(&mut self, event: &Event) {
        let happening = Happening { time_s: event.time, track: event.object.0, text: event.to_string() };
        let place = self.happenings.partition_point(|other| other.time_s <= happening.time_s);
        self.happenings.insert(place, happening);
    }

    /// Adds the frame that was taken in last to those that can be shown.
    pub fn show(&mut self, tracked: &Tracked) {
        self.stamps_s.push(tracked.stamp_s);
        let seen = tracked.objects.iter().filter_map(|object| object.track).map(|track| track.0);
        self.views.push((tracked.world_from_camera, seen.collect()));
    }

    /// Adds a frame of which nothing is said: it shows no track.
    pub(crate) fn skip(&mut self) {
        self.stamps_s.push(self.stamps_s.last().copied().unwrap_or(0.0));
        self.views.push((Rigid::IDENTITY, Vec::new()));
    }

    /// Where each track that a shown frame sees was until then, in its camera; nothing of a frame that is not there.
    pub(crate) fn paths(&self, frame: usize) -> Vec<Path> {
        let Some((world_from_camera, seen)) = self.views.get(frame) else { return Vec::new() };
        let camera_from_world = world_from_camera.inverse();
        let path = |&track: &u16| {
            let known = self.paths.get(&track)?;
            let known = &known[..known.partition_point(|&(number, _)| number <= frame)];
            let last = &known[known.len().saturating_sub(SHOWN_POINTS)..];
            Some((
                track,
                last.iter()
                    .map(|&(_, point_m)| camera_from_world.point(point_m).as_vec3().to_array())
                    .collect(),
            ))
        };
        seen.iter().filter_map(path).collect()
    }

    /// Frames that can be shown.
    pub fn frames(&self) -> usize {
        self.stamps_s.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_happened_is_in_the_order_of_time() {
        let event = |time: f64| Event {
            frame: 0,
            time,
            kind: objecthood_track::EventKind::Appeared,
            object: objecthood_track::TrackId(3),
            other: None,
            by_agent: false,
            start: None,
            end: None,
            confidence: 1.0,
            evidence: String::new(),
        };
        let mut film = Film::default();
        [0.5, 0.2, 0.9].into_iter().for_each(|time| film.tell(&event(time)));
        let times: Vec<f64> = film.happenings.iter().map(|happening| happening.time_s).collect();
        assert_eq!(times, [0.2, 0.5, 0.9]);
        assert_eq!(film.happenings[0].text, "Object 3 appears.");
    }
}
