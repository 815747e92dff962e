//! Videos: how well things are found, followed and understood over time.
//!
//! 1. [`clip`]: a clip with truth is read from its folder, and what a tracker says of it from another.
//! 2. [`OverlapCounter`] takes the frames one after the other and counts the pixels that tracks and objects share.
//! 3. From these tables come [`HotaCounts`], [`IdentityCounts`], [`ClearCounts`] and [`CloseSum`], and which track shows which
//!    object when.
//! 4. [`EventCounts`], [`AirborneCounts`], support edges and [`KeptCounts`] ask what was understood.
//! 5. [`ClipScore`] is all of that for a clip, and its sum over clips; [`VideoReport`] prints it.
//!
//! Files say instances, tracks say ids; both are 16-bit numbers, and 0 is none. Every count can be summed over clips.

mod airborne;
mod clear;
pub mod clip;
mod close;
mod counts;
mod edges;
mod events;
mod flicker;
mod frame;
mod groups;
mod hota;
mod identity;
mod kept;
mod overlap;
mod report;
mod score;
mod shows;
#[cfg(test)]
mod tests;

pub use airborne::AirborneCounts;
pub use clear::ClearCounts;
pub use clip::{Edge, Event, Group, Joint, Said, TrueClip, TrueFrame};
pub use close::CloseSum;
pub use counts::{Cases, Counts};
pub use events::EventCounts;
pub use flicker::{FlickerCounter, FlickerCounts};
pub use frame::{LabelledFrame, Roles};
pub use hota::{Hota, HotaCounts};
pub use identity::IdentityCounts;
pub use kept::KeptCounts;
pub use overlap::{OverlapCounter, Overlaps};
pub use report::{NamedFigures, VideoReport};
pub use score::{ClipScore, VideoFigures};
