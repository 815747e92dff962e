//! Follows objects through RGB-D video: lasting identities, motion as evidence, and events.
//!
//! ```
//! use objecthood::{Camera, Frame, Params, Raster};
//! use objecthood_track::Tracker;
//!
//! let mut tracker = Tracker::new(Params::default());
//! for k in 0..3 {
//!     let depth_m = Raster::filled(64, 48, 1.2)?;
//!     let frame = Frame::new(depth_m, None, Camera::new(52.5, 52.5, 31.5, 23.5)?)?;
//!     let tracked = tracker.update(&frame, f64::from(k) / 30.0, None)?;
//!     assert!(tracked.objects.is_empty() && tracked.events.is_empty());
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`Tracker`] is the only type of objecthood that remembers earlier frames. `memory.rs` shows the order of
//! its steps on one screen. The files, roughly in that order:
//!
//! | file | task |
//! |---|---|
//! | `camera.rs`, `align.rs` | the camera's motion; `align` finds rigid motions of camera and objects |
//! | `turn.rs` | a rough guess of the camera's turn, from which `align` starts |
//! | `scene.rs` | the memory of every pixel: where the frame changed, labels kept steady at rest |
//! | `pace.rs` | the time between frames, and which pauses are gaps |
//! | `field.rs` | where the sensor measures depth |
//! | `agent.rs` | hands and people: what is nearer than the rested scene and stays connected to the border of the image, possibly behind a thing |
//! | `behind.rs` | arms that reach behind a thing, which divides what is seen of them |
//! | `arm.rs` | agents that are in the image from the first frame on |
//! | `predict.rs`, `surface.rs` | the motion of every object, and where it should be seen; the surface of moved things |
//! | `identify.rs`, `associate.rs` | which segment shows which track: by overlap, then by looks, size and reach |
//! | `doubtful.rs` | refused hypotheses that show known things |
//! | `uncover.rs` | things that come out from behind a hand beside a known thing, so that a frame takes both for one |
//! | `fragment.rs` | segments that show a piece of a known thing |
//! | `moved_part.rs` | the part of a thing that is moved, such as a lid, and what stays |
//! | `face.rs` | another face of a thing in a hand |
//! | `in_hand.rs` | things in a hand that no segment shows, found by their colours |
//! | `hand.rs` | pixels of a hand rather than of the thing that it holds, by colour |
//! | `seen.rs` | which track is seen at each pixel; known things that no segment shows are held |
//! | `observe.rs`, `missing.rs` | tracks that are seen, and tracks that are not |
//! | `parts.rs`, `knowledge.rs` | what motion proved: which parts are one thing, and which are not |
//! | `oneness.rs` | whether most frames show a resting thing as one segment |
//! | `rested.rs`, `opened.rs` | the surface of things as they last rested: what is hidden, what is expected again, what was opened |
//! | `whole.rs` | things that were cut into pieces, and are seen whole |
//! | `support.rs` | what holds what, over time |
//! | `flight.rs` | free flight: a pure function of where a thing was |
//! | `happenings.rs`, `happening.rs` | what happened to a thing, derived from where it was, how it moved and who reached it; an event |
//! | `taken.rs`, `put_down.rs` | when a thing that a hand hid was taken; when, and on what, it was put down |
//! | `vessel.rs` | things that go into a vessel, or out of it, without being handled |
//! | `hindsight.rs` | what the whole video proved, applied to earlier frames |
//! | `numbering.rs` | the numbers of frames, including those that were passed over |
//! | `state.rs`, `ingredient.rs` | saving a tracker; leaving out ingredients |
//! | `output.rs` | the output: numbers, labels and states |

mod agent;
mod align;
mod arm;
pub mod assignment;
mod associate;
mod behind;
mod bits;
mod camera;
mod doubtful;
mod error;
mod face;
mod field;
mod flight;
mod fragment;
mod hand;
mod happening;
mod happenings;
mod hindsight;
mod identify;
mod in_hand;
mod ingredient;
mod knowledge;
mod look;
mod memory;
mod missing;
mod moved_part;
mod numbering;
mod observe;
mod oneness;
mod opened;
mod output;
mod pace;
mod parts;
mod predict;
mod put_down;
mod rested;
mod rigid;
mod scene;
mod seen;
mod segment;
mod state;
mod support;
mod surface;
mod taken;
mod track;
mod tracked;
mod tracker;
mod turn;
mod uncover;
mod vessel;
mod view;
mod whole;

pub use error::{Error, Result};
pub use hindsight::Hindsight;
pub use ingredient::Ingredient;
pub use rigid::Rigid;
pub use tracked::{
    Event, EventKind, LostTrack, MotionEstimate, Relation, SeenAgent, SupportRelation, TrackId, TrackNotice,
    TrackState, Tracked, TrackedObject,
};
pub use tracker::Tracker;
