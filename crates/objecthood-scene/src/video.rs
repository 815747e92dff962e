//! Videos with exact truth: a [`World`] whose things and camera move.
//!
//! ```
//! use objecthood_scene::{Sensor, video::{Clip, film}};
//!
//! let video = film(Clip::Pick, 1, 30.0)?;
//! for event in &video.truth().events {
//!     println!("frame {}: {} of {}", event.frame, event.kind, event.object);
//! }
//! let first = video.at_quarter_size().render(0, Sensor::Kinect)?;
//! assert_eq!(first.frame.size(), (160, 120));
//! # Ok::<(), objecthood_scene::Error>(())
//! ```
//!
//! A script says what hands do and what is thrown; `rapier3d` moves what is free; hands, and what they hold, follow smooth
//! paths. What happened is read from the motion that came out, not from the script: `docs/VIDEO_TRUTH.md` defines it. The same
//! kind, seed and frame rate give the same bytes on any number of threads.

mod camera;
mod clip;
mod collider;
mod draft;
mod dynamics;
mod events;
mod hand;
mod kinds;
mod overlap;
mod path;
mod script;
mod sight;
mod support;
#[cfg(test)]
mod tests;
mod truth;
mod typical;
mod walker;

use glam::DVec3;

pub use clip::Clip;
pub use events::{Event, EventKind};
pub use script::Joint;
pub use support::{Edge, SupportKind};
pub use truth::{ClipTruth, FrameTruth, Group, Motion};

use crate::color;
use crate::error::{Error, Result};
use crate::holes::Holes;
use crate::pose::Pose;
use crate::random::Rng;
use crate::render::{Exposure, Rendered};
use crate::sensor::Sensor;
use crate::solid::{Role, Solid};
use crate::world::{Viewpoint, World};
use dynamics::{Recording, simulate};
use script::{Agent, Script};

/// Frame rates there are (Hz).
pub const FPS: std::ops::RangeInclusive<f64> = 5.0..=120.0;
/// Scripts that miss what their kind is about are drawn anew, this often at most.
const DRAWS: u64 = 60;
/// Streams of random numbers of videos begin here; those of still scenes end before.
const STREAM: u64 = 1 << 32;

/// A scene in which things happen.
pub struct Video {
    clip: Clip,
    seed: u64,
    fps: f64,
    script: Script,
    recording: Recording,
    viewpoint: Viewpoint,
    /// How long every frame is exposed: as one that lets the first one be seen well.
    exposure: f64,
    truth: ClipTruth,
}

/// The video of a kind with this seed, so many frames a second. About a second of work.
///
/// # Errors
/// [`Error::FrameRate`] outside [`FPS`]; [`Error::NoClip`] when the kind finds no room for what it wants to do.
pub fn film(clip: Clip, seed: u64, fps: f64) -> Result<Video> {
    if !FPS.contains(&fps) {
        return Err(Error::FrameRate { fps, least: *FPS.start(), most: *FPS.end() });
    }
    for attempt in 0..DRAWS {
        let mut rng = Rng::new(seed, STREAM + clip as u64 * 1000 + attempt);
        let Some(script) = kinds::draw(clip, &mut rng) else { continue };
        let video = Video::of(clip, seed, fps, script)?;
        if typical::is_typical(&video) {
            return Ok(video);
        }
    }
    Err(Error::NoClip { clip, seed })
}

impl Video {
    fn of(clip: Clip, seed: u64, fps: f64, script: Script) -> Result<Self> {
        let frames = (script.duration_s * fps).round() as usize;
        let recording = simulate(&script, fps, frames);
        let viewpoint = script.viewpoint;
        let mut video = Self {
            clip,
            seed,
            fps,
            script,
            recording,
            viewpoint,
            exposure: 0.0,
            truth: ClipTruth::default(),
        };
        video.exposure = color::exposure_of(&video.world(0).at_quarter_size());
        video.truth = truth::of(&video);
        Ok(video)
    }

    /// What happens in it.
    pub fn clip(&self) -> Clip {
        self.clip
    }

    /// What it was made from.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Frames a second.
    pub fn fps(&self) -> f64 {
        self.fps
    }

    /// How many frames it has.
    pub fn frames(&self) -> usize {
        self.recording.len()
    }

    /// When a frame was taken (s).
    pub fn time_s(&self, frame: usize) -> f64 {
        frame as f64 / self.fps
    }

    /// What is true of every frame, and what happened.
    pub fn truth(&self) -> &ClipTruth {
        &self.truth
    }

    /// The same video in a quarter of the columns and rows.
    #[must_use]
    pub fn at_quarter_size(self) -> Self {
        let viewpoint = *self.world(0).at_quarter_size().viewpoint();
        Self { viewpoint, ..self }
    }

    /// The same video in images of so many columns and rows; the camera sees the same part of the scene.
    ///
    /// # Errors
    /// [`Error::Frame`] when there is no such image.
    pub fn at_size(self, size_px: (usize, usize)) -> Result<Self> {
        let viewpoint = *self.world(0).at_size(size_px)?.viewpoint();
        Ok(Self { viewpoint, ..self })
    }

    /// The scene at the time of a frame; after the last frame, that of the last. Its contacts are those of
    /// [`FrameTruth::support`].
    pub fn world(&self, frame: usize) -> World {
        let frame = frame.min(self.frames() - 1);
        let time_s = self.time_s(frame);
        let viewpoint = Viewpoint { pose: self.script.camera.at(time_s), ..self.viewpoint };
        let noise = Rng::new(self.seed, STREAM * 2 + frame as u64).bits();
        let solids = self.solids(frame);
        World::new(self.seed, solids, Vec::new(), self.script.lighting.clone(), viewpoint)
            .exposed(self.exposure, noise)
    }

    /// Things first, in the order in which they were placed, then agents.
    fn solids(&self, frame: usize) -> Vec<Solid> {
        let states = self.recording[frame].iter();
        let things = self.script.layout.solids.iter().zip(states);
        let time_s = self.time_s(frame);
        let agents = self.script.agents.iter().map(|agent| agent.solid(time_s));
        things.map(|(solid, state)| solid.clone().at(state.pose)).chain(agents).collect()
    }

    /// Takes the picture of a frame. The sensor's noise is another one in every frame.
    ///
    /// # Errors
    /// [`Error::Frame`] when the camera sees nothing within the sensor's range.
    pub fn render(&self, frame: usize, sensor: Sensor) -> Result<Rendered> {
        Exposure::of(&self.world(frame))?.seen_by(sensor, Holes::None)
    }

    /// Things without agents.
    fn things(&self) -> &[Solid] {
        &self.script.layout.solids
    }

    /// Indices of what can be grasped and moved.
    fn objects(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.things().len()).filter(|&k| self.things()[k].role() == Role::Object)
    }

    /// Instance number of an agent.
    fn agent_instance(&self, agent: usize) -> u16 {
        instance(self.things().len() + agent)
    }

    fn agents(&self) -> &[Agent] {
        &self.script.agents
    }

    /// Height of the lowest point of a thing in a frame (m).
    fn bottom_m(&self, frame: usize, thing: usize) -> f64 {
        let solid = &self.things()[thing];
        let down = self.recording[frame][thing].pose.own_direction(DVec3::NEG_Z);
        let own = Solid { pose: Pose::at([0.0; 3]), ..solid.clone() };
        self.recording[frame][thing].pose.origin.z - own.support(down)
    }
}

/// Instance number of the solid with this index.
fn instance(index: usize) -> u16 {
    index as u16 + 1
}
