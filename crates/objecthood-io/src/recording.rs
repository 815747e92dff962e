//! Recordings of many frames: messages of ROS in files of several formats.
//!
//! A format lists the messages of a file ([`Log`]) and reads any of them. The rest is the same for all: which topics hold depth, colour
//! and points ([`topics`]), which images belong together, where the cameras are ([`rig`]), and from messages to frames
//! ([`pixels`], [`cloud`]). A frame is read when it is asked for, so memory does not grow with the length of a recording but by
//! some ten bytes a message.

mod bytes;
mod chunk;
mod cloud;
mod error;
mod fields;
mod lens;
mod log;
mod messages;
mod open;
mod pixels;
mod rig;
mod rigid;
mod rvl;
mod topics;
mod tree;
mod unpack;

pub(crate) use bytes::{Bytes, Window, read};
pub(crate) use chunk::{Chunked, Records, each_record, place_in};
pub use error::RecordingError;
pub(crate) use fields::{Fields, Problem, Wire};
pub(crate) use log::{Channel, Listing, Log, Messages, Place};
pub(crate) use open::{Opener, open};
pub(crate) use unpack::Packed;
