//! The report of `track`: frames with their tracks, where each track was, and what happened.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Result;
use glam::{DQuat, DVec3};
use objecthood::{Params, Pipeline};
use objecthood_io::Capture;
use objecthood_io::output::Growing;
use objecthood_page::{Film, Followed, Happening, Life, Page, Report, Shown};
use objecthood_track::{Event, Rigid, Tracked};

use super::summary::sentence;
use crate::shell::words_of_frames;
use crate::watch::{Laps, Watch};

/// A report has at most so many frames of a video, evenly spread; all events are in it.
const MOST_FRAMES: usize = 100;
/// Of a path so many points are kept, the last ones.
const MOST_POINTS: usize = 300;

/// A report that is written while the video is followed.
pub(super) struct Filming {
    report: Report,
    /// Looks at the frames again, for the layers of the stages.
    pipeline: Pipeline,
    /// Every so many frames one is shown.
    step: usize,
    film: Film,
    /// Where each track was (m, in the world).
    paths: BTreeMap<u32, Vec<DVec3>>,
    lives: BTreeMap<u32, Life>,
}

impl Filming {
    /// Begins the report of a video of so many frames.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(super) fn begin(path: &Path, params: &Params, frames: usize) -> Result<Self> {
        Ok(Self {
            report: Report::begin(Growing::create(path)?, words_of_frames("track"), params)?,
            pipeline: Pipeline::default(),
            step: frames.div_ceil(MOST_FRAMES).max(1),
            film: Film::default(),
            paths: BTreeMap::new(),
            lives: BTreeMap::new(),
        })
    }

    /// Takes in the `number`th of so many frames, and shows it if it is one of those that are shown.
    ///
    /// # Errors
    /// As the method; when the file cannot be written.
    pub(super) fn frame(
        &mut self,
        (number, frames): (usize, usize),
        name: &str,
        params: &Params,
        capture: &Capture,
        tracked: &Tracked,
    ) -> Result<()> {
        let pose = Pose::of(&tracked.world_from_camera);
        for object in &tracked.objects {
            let Some(track) = object.track.map(|track| u32::from(track.0)) else { continue };
            let path = self.paths.entry(track).or_default();
            path.push(pose.to_world(object.center_m));
            path.drain(..path.len().saturating_sub(MOST_POINTS));
            let seen = Life { track, first_s: tracked.stamp_s, last_s: tracked.stamp_s };
            self.lives.entry(track).or_insert(seen).last_s = tracked.stamp_s;
        }
        if number % self.step > 0 {
            return Ok(());
        }
        let shown_tracks =
            tracked.objects.iter().filter_map(|object| object.track).map(|track| u32::from(track.0));
        let path = |track: u32| {
            Some((track, self.paths.get(&track)?.iter().map(|&point| pose.to_camera(point)).collect()))
        };
        let followed =
            Followed { labels: tracked.labels.clone(), paths: shown_tracks.filter_map(path).collect() };
        let mut laps = Laps::start();
        let mut watch = Watch { laps: &mut laps, next: &mut () };
        self.pipeline.discover_observed(&capture.frame, params, &mut watch)?;
        let laps = laps.ended_ms();
        let shown = Shown {
            name,
            capture,
            number: self.film.stamps_s.len(),
            frames: frames.div_ceil(self.step),
            laps: &laps,
            followed: Some(&followed),
        };
        self.report.add(&Page::new(&mut self.pipeline, params, &shown)?)?;
        self.film.stamps_s.push(tracked.stamp_s);
        Ok(())
    }

    /// Ends the report, with all that happened.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(super) fn finish(mut self, events: &[Event]) -> Result<()> {
        let happening = |event: &Event| Happening {
            time_s: event.time,
            track: u32::from(event.object.0),
            text: sentence(event),
        };
        self.film.happenings = events.iter().map(happening).collect();
        self.film.happenings.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        self.film.lives = self.lives.into_values().collect();
        self.report.film(self.film);
        Ok(self.report.finish()?)
    }
}

/// Where the camera is in the world.
struct Pose {
    turn: DQuat,
    shift_m: DVec3,
}

impl Pose {
    fn of(world_from_camera: &Rigid) -> Self {
        Self {
            turn: DQuat::from_array(world_from_camera.rotation_xyzw()),
            shift_m: DVec3::from(world_from_camera.translation_m()),
        }
    }

    fn to_world(&self, point_m: [f32; 3]) -> DVec3 {
        self.turn * glam::Vec3::from(point_m).as_dvec3() + self.shift_m
    }

    fn to_camera(&self, point_m: DVec3) -> [f32; 3] {
        (self.turn.inverse() * (point_m - self.shift_m)).as_vec3().to_array()
    }
}
