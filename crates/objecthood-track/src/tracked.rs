//! What the tracker reports about a frame.

use std::fmt;

use objecthood::{OrientedBox, PixelBox, Raster};
use serde::{Deserialize, Serialize};

use crate::rigid::Rigid;

/// The lasting number of an object: its value in label images. Numbers begin at 1 and have no gaps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct TrackId(pub u16);

/// The state of a track in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum TrackState {
    /// Seen in too few frames to be sure.
    Tentative,
    /// Seen in this frame.
    Confirmed,
    /// Not seen because something stands before it.
    Occluded,
    /// Not seen, for an unknown reason.
    Lost,
}

/// An object of a frame.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct TrackedObject {
    /// Its number; `None` while it is tentative.
    pub track: Option<TrackId>,
    /// Its state.
    pub state: TrackState,
    /// Index among the objects that the discovery found; `None` if only motion shows it.
    pub found: Option<usize>,
    /// Mean visible point (m), in the frame of the camera.
    pub center_m: [f32; 3],
    /// Where that point is in the world, and how the object is turned against its first orientation, as far
    /// as its motions were found.
    pub pose: Rigid,
    /// Velocity of its mean visible point (m/s), in the world.
    pub velocity_m_per_s: [f64; 3],
    /// The numbers of tracks that turned out to be parts of it.
    pub parts: Vec<TrackId>,
    /// Motion since the last frame, in the frame of the camera, without the camera's own motion. `None` if
    /// the object rests, or if no motion could be found.
    pub motion: Option<MotionEstimate>,
    /// The number of its pixels, in the steadied label image.
    pub size_px: usize,
    /// The smallest box that holds its pixels.
    pub box_px: PixelBox,
    /// Its box in metres, as in the discovery, if the discovery found the object.
    pub box_m: Option<OrientedBox>,
    /// Objectness (1): that of the last frame that found it, raised by what was seen of it since: it moved as
    /// one, flew, was put down.
    pub objectness: f32,
    /// Why it is higher than that of the frame.
    pub seen_to: Vec<&'static str>,
}

/// A rigid motion and its uncertainty.
#[derive(Clone, Copy, Debug)]
pub struct MotionEstimate {
    /// From the last frame to this one.
    pub rigid: Rigid,
    /// Covariance of shift (m), then turn (rad), about the centre of its visible points.
    pub covariance: [[f64; 6]; 6],
    /// Share of its points that lie and look as the motion predicts, in [0, 1].
    pub fit: f64,
}

/// A track that is not seen.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LostTrack {
    /// Its number.
    pub track: TrackId,
    /// Occluded or lost.
    pub state: TrackState,
    /// Where its mean visible point should be (m), in the frame of the camera: moved with what carries it,
    /// moved on along its path for a quarter of a second, or where it was last seen.
    pub center_m: [f64; 3],
    /// The same in the world, with its turn as in [`TrackedObject::pose`].
    pub pose: Rigid,
    /// For how long it has not been seen (s).
    pub for_s: f64,
}

/// An agent: a hand with its arm, or a person.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct SeenAgent {
    /// Its number, from the same sequence as the numbers of objects.
    pub id: TrackId,
    /// The number of its pixels, including what it carries.
    pub size_px: usize,
    /// The smallest box that holds them.
    pub box_px: PixelBox,
}

/// What holds what.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct SupportRelation {
    /// The object that is held.
    pub child: TrackId,
    /// What holds it: an object, or the agent that carries it; `None` = the table, the floor, furniture.
    pub parent: Option<TrackId>,
    /// How.
    pub kind: Relation,
}

/// How something is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Relation {
    /// It stands on the other.
    On,
    /// It lies in the other.
    In,
    /// It leans on the other.
    Leans,
    /// An agent carries it.
    Held,
}

/// The kind of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum EventKind {
    /// It came into view.
    Appeared,
    /// It left the image.
    Left,
    /// An agent lifted it.
    PickedUp,
    /// It was set down on something.
    PlacedOn,
    /// It was put into something.
    PutIn,
    /// It was taken out of something.
    TakenOut,
    /// An agent displaced it without lifting it.
    Pushed,
    /// It flew: from `start` to `end`.
    Airborne,
    /// Its flight ended.
    Landed,
    /// It fell off something or out of a hand.
    Fell,
    /// It went behind something.
    Occluded,
    /// It came apart from something with which it was one.
    Split,
    /// Two parts turned out to be one, or a thing that was cut into pieces is seen whole.
    Merged,
    /// A lid or a drawer was moved off what it closes.
    Opened,
}

impl EventKind {
    /// Its name in `events.jsonl`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Appeared => "appeared",
            Self::Left => "left",
            Self::PickedUp => "picked_up",
            Self::PlacedOn => "placed_on",
            Self::PutIn => "put_in",
            Self::TakenOut => "taken_out",
            Self::Pushed => "pushed",
            Self::Airborne => "airborne",
            Self::Landed => "landed",
            Self::Fell => "fell",
            Self::Occluded => "occluded",
            Self::Split => "split",
            Self::Merged => "merged",
            Self::Opened => "opened",
        }
    }
}

impl fmt::Display for EventKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Something that happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// The frame that it is about, counted from 0; it may be reported some frames later.
    pub frame: u64,
    /// The time of that frame (s).
    pub time: f64,
    /// What happened.
    #[serde(rename = "type")]
    pub kind: EventKind,
    /// The object that it happened to.
    pub object: TrackId,
    /// Who or what else took part in it; 0 = the table, the floor, furniture.
    pub other: Option<u16>,
    /// Whether that is an agent.
    pub by_agent: bool,
    /// First frame of an event that lasts.
    pub start: Option<u64>,
    /// Last frame of an event that lasts.
    pub end: Option<u64>,
    /// How sure it is, in [0, 1].
    pub confidence: f32,
    /// The evidence for it, in words with figures.
    pub evidence: String,
}

/// The event as a sentence.
impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let object = self.object.0;
        let other = |nobody: &str| match self.other {
            None => nobody.to_owned(),
            Some(0) => "the table".to_owned(),
            Some(other) => format!("{} {other}", if self.by_agent { "agent" } else { "object" }),
        };
        let agent = self.other.map_or_else(|| "Someone".to_owned(), |agent| format!("Agent {agent}"));
        match self.kind {
            EventKind::Appeared => write!(f, "Object {object} appears."),
            EventKind::Left => write!(f, "Object {object} leaves the view."),
            EventKind::PickedUp => write!(f, "{agent} picks up object {object}."),
            EventKind::PlacedOn => write!(f, "Object {object} is put down on {}.", other("something")),
            EventKind::PutIn => write!(f, "Object {object} is put into {}.", other("something")),
            EventKind::TakenOut => write!(f, "Object {object} is taken out of {}.", other("something")),
            EventKind::Pushed => write!(f, "{agent} pushes object {object}."),
            EventKind::Airborne => {
                let frames = self.start.zip(self.end).map_or(0, |(start, end)| end + 1 - start);
                write!(f, "Object {object} flies for {frames} frames.")
            }
            EventKind::Landed => write!(f, "Object {object} lands."),
            EventKind::Fell => write!(f, "Object {object} falls."),
            EventKind::Occluded => write!(f, "Object {object} goes behind {}.", other("something")),
            EventKind::Split => {
                write!(f, "Object {object} comes apart from {}.", other("what it was one with"))
            }
            EventKind::Merged if self.other.is_none() => {
                write!(f, "What cut object {object} in pieces is gone, and it is seen whole.")
            }
            EventKind::Merged => {
                write!(f, "Object {object} and {} turn out to be one.", other("another part"))
            }
            EventKind::Opened if self.other.is_none() => write!(f, "Object {object} is opened."),
            EventKind::Opened => write!(f, "Object {object} opens {}.", other("something")),
        }
    }
}

/// Something that the user should know about a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum TrackNotice {
    /// The time between this frame and the last is much longer than usual.
    Gap {
        /// The length of that time (s).
        seconds: f64,
    },
    /// The camera moved so far that its motion could not be found. Things are found again by their looks.
    CameraLost,
    /// The frame has another size: the tracker starts over, and numbers go on.
    OtherSize,
    /// There are more objects than 65535.
    TooMany,
}

impl fmt::Display for TrackNotice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gap { seconds } => write!(f, "{seconds:.1} s without a frame: things are found again by their looks"),
            Self::CameraLost => f.write_str(
                "the camera was knocked, or moved too far since the last frame to say how: things are found again by their looks",
            ),
            Self::OtherSize => f.write_str("the frame has another size than the last: tracking begins anew"),
            Self::TooMany => f.write_str("more than 65535 objects: new ones get no number"),
        }
    }
}

/// What the tracker reports about a frame.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Tracked {
    /// Number of the frame, from 0.
    pub frame: u64,
    /// When it was taken (s).
    pub stamp_s: f64,
    /// The track at every pixel, 0 = none.
    pub labels: Raster<u16>,
    /// The objects.
    pub objects: Vec<TrackedObject>,
    /// Tracks that are not seen.
    pub lost: Vec<LostTrack>,
    /// Hands and people.
    pub agents: Vec<SeenAgent>,
    /// What holds each object.
    pub support: Vec<SupportRelation>,
    /// The events that became certain with this frame.
    pub events: Vec<Event>,
    /// Maps points of this frame's camera to the world, which is the first frame's camera or that of the
    /// given poses.
    pub world_from_camera: Rigid,
    /// Covariance of the camera's last step: shift (m), then turn (rad); 0 if the camera stands still or its
    /// pose is given.
    pub camera_covariance: [[f64; 6]; 6],
    /// What the user should know.
    pub notices: Vec<TrackNotice>,
}
