//! MCAP recordings of ROS 2 messages, as `ros2 bag`, Foxglove and the MCAP libraries read them.
//!
//! What was found goes on two topics, beside the camera: `/objecthood/labels` (`sensor_msgs/msg/Image`, 16UC1, 0 = no object),
//! `/objecthood/objects` (`foxglove_msgs/msg/SceneUpdate`, the boxes) and `/objecthood/camera_info`. Messages have the stamp of the frame.
//! A frame itself goes on topics as a RealSense camera has them whose depth is registered to its colour.

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions, Writer};
use objecthood::{Discovery, Frame};

use super::depth::WholeUnits;
use super::instances::Instance;
pub use super::ros2::Message;
use super::ros2::{Pixels, camera_info, definition, image, scene_update, transform};
use super::{Growing, cannot_write};
use crate::capture::Capture;
use crate::error::{Error, Result};

/// Units of depth that make a metre in an image of kind 16UC1 (REP 118).
const MILLIMETRES: f64 = 1000.0;

/// What was found in a frame as messages.
pub fn found_messages(
    stamp_ns: i64,
    frame: &Frame,
    discovery: &Discovery,
    found: &[Instance],
) -> Vec<Message> {
    let labels: Vec<u8> = discovery.labels.as_slice().iter().flat_map(|label| label.to_le_bytes()).collect();
    let pixels = Pixels { size: frame.size(), encoding: "16UC1", bytes: &labels };
    vec![
        image("/objecthood/labels", stamp_ns, pixels),
        camera_info("/objecthood/camera_info", stamp_ns, frame.size(), frame.camera()),
        scene_update("/objecthood/objects", stamp_ns, found),
    ]
}

/// A frame as messages: colour (rgb8), depth (16UC1 if it is whole millimetres, else 32FC1 in metres) and the camera of both; on `/tf` its pose,
/// if it is known. No depth is lost or changed.
pub fn frame_messages(stamp_ns: i64, capture: &Capture) -> Vec<Message> {
    let frame = &capture.frame;
    let (size, camera) = (frame.size(), frame.camera());
    let whole = WholeUnits::of(frame.depth_m(), MILLIMETRES);
    let (encoding, bytes): (_, Vec<u8>) = if whole.is_exact() {
        ("16UC1", whole.units.iter().flat_map(|unit| unit.to_le_bytes()).collect())
    } else {
        ("32FC1", frame.depth_m().as_slice().iter().flat_map(|z| z.to_le_bytes()).collect())
    };
    let depth = Pixels { size, encoding, bytes: &bytes };
    let mut messages = vec![
        camera_info("/camera/aligned_depth_to_color/camera_info", stamp_ns, size, camera),
        image("/camera/aligned_depth_to_color/image_raw", stamp_ns, depth),
    ];
    if let Some(color) = frame.color() {
        let pixels = Pixels { size, encoding: "rgb8", bytes: color.as_slice().as_flattened() };
        messages.push(camera_info("/camera/color/camera_info", stamp_ns, size, camera));
        messages.push(image("/camera/color/image_raw", stamp_ns, pixels));
    }
    messages.extend(capture.pose.map(|pose| transform(stamp_ns, pose)));
    messages
}

/// A recording, which grows message by message.
pub struct McapFile {
    writer: Writer<Growing>,
    path: PathBuf,
    /// Number of a topic in the file, and messages on it.
    topics: BTreeMap<&'static str, (u16, u32)>,
}

impl McapFile {
    /// Begins the recording that is to be at `path`.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn create(path: &Path) -> Result<Self> {
        let library = concat!("objecthood ", env!("CARGO_PKG_VERSION"));
        let options = WriteOptions::new().compression(None).profile("ros2").library(library);
        let writer = options.create(Growing::create(path)?).map_err(|e| said_of(path, e))?;
        Ok(Self { writer, path: path.to_owned(), topics: BTreeMap::new() })
    }

    /// Appends messages.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn add(&mut self, messages: &[Message]) -> Result<()> {
        messages.iter().try_for_each(|message| self.append(message)).map_err(|e| said_of(&self.path, e))
    }

    fn append(&mut self, message: &Message) -> Result<(), McapError> {
        let (channel_id, sequence) = match self.topics.get(message.topic) {
            Some(&(channel_id, sequence)) => (channel_id, sequence),
            None => {
                let schema =
                    self.writer.add_schema(message.kind, "ros2msg", definition(message.kind).as_bytes())?;
                (self.writer.add_channel(schema, message.topic, "cdr", &BTreeMap::new())?, 0)
            }
        };
        self.topics.insert(message.topic, (channel_id, sequence.wrapping_add(1)));
        let time = message.stamp_ns.max(0) as u64;
        self.writer.write_to_known_channel(
            &MessageHeader { channel_id, sequence, log_time: time, publish_time: time },
            &message.data,
        )
    }

    /// Ends the recording, which takes its name.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn finish(mut self) -> Result<()> {
        self.writer.finish().map_err(|e| said_of(&self.path, e))?;
        self.writer.into_inner().finish()
    }
}

impl fmt::Debug for McapFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("McapFile").field("path", &self.path).finish_non_exhaustive()
    }
}

fn said_of(path: &Path, error: McapError) -> Error {
    match error {
        McapError::Io(reason) => cannot_write(path, reason),
        other => cannot_write(path, std::io::Error::other(other)),
    }
}
