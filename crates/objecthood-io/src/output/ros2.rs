//! Messages of ROS 2: their bytes (CDR) and the definitions that a reader needs.

mod cdr;
mod definitions;
mod messages;

pub(super) use definitions::definition;
pub use messages::Message;
pub(crate) use messages::{Pixels, camera_info, image, scene_update, transform};
