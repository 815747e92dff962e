//! What a recording holds, whatever its format: channels, and where their messages lie.

use super::error::RecordingError;
use super::fields::Wire;

/// A recording that was listed; no message is kept.
pub(crate) struct Log {
    pub(crate) channels: Vec<Channel>,
    /// Messages of channels that [are read](Channel::is_read), in the order of the file.
    pub(crate) entries: Vec<Entry>,
    /// Where the file ends too early, if it does.
    pub(crate) cut_at: Option<u64>,
    pub(crate) messages: Box<dyn Messages>,
}

/// Messages of one type under one name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Channel {
    pub(crate) topic: String,
    /// The type as ROS 1 names it: `sensor_msgs/Image`.
    pub(crate) kind: String,
    pub(crate) wire: Wire,
}

/// One message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Entry {
    /// When it was recorded (ns).
    pub(crate) time_ns: i64,
    /// Its place in the list of channels.
    pub(crate) channel: usize,
    pub(crate) place: Place,
}

/// Where a message lies: two numbers that its format understands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place(pub(crate) u64, pub(crate) u64);

/// Reads messages, on any thread.
pub(crate) trait Messages: Send + Sync {
    /// The bytes of a message. Memory is bounded by the bytes of the file, and of its largest chunk.
    ///
    /// # Errors
    /// [`RecordingError`]: what is wrong with the file there.
    fn read(&self, place: Place) -> Result<Vec<u8>, RecordingError>;
}

impl Channel {
    pub(crate) fn new(topic: &[u8], kind: &[u8], wire: Wire) -> Self {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        Self { topic: text(topic), kind: text(kind).replace("/msg/", "/"), wire }
    }

    /// Whether frames are made of its messages.
    pub(crate) fn is_read(&self) -> bool {
        match self.kind.as_str() {
            "sensor_msgs/Image"
            | "sensor_msgs/CompressedImage"
            | "sensor_msgs/CameraInfo"
            | "sensor_msgs/PointCloud2"
            | "geometry_msgs/Transform" => true,
            "tf2_msgs/TFMessage" => self.topic.ends_with("tf_static"),
            "std_msgs/Float32" | "std_msgs/String" => self.topic.ends_with("/option/Depth_Units/value"),
            _ => false,
        }
    }
}
