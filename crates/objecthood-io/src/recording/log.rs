//! What a recording holds, whatever its format: channels, and where their messages lie.

use super::error::RecordingError;
use super::fields::Wire;

/// A recording that was listed; no message is kept.
pub(crate) struct Log {
    pub(crate) channels: Vec<Channel>,
    /// Messages of channels that are read, in the order of the file.
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
    /// Whether frames are made of its messages.
    pub(crate) is_read: bool,
    /// How many messages it has.
    pub(crate) messages: u64,
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
        let (topic, kind) = (text(topic), text(kind).replace("/msg/", "/"));
        let is_read = match kind.as_str() {
            "sensor_msgs/Image"
            | "sensor_msgs/CompressedImage"
            | "sensor_msgs/CameraInfo"
            | "sensor_msgs/PointCloud2"
            | "geometry_msgs/Transform" => true,
            "tf2_msgs/TFMessage" => topic.ends_with("tf_static"),
            "std_msgs/Float32" | "std_msgs/String" => topic.ends_with("/option/Depth_Units/value"),
            _ => false,
        };
        Self { topic, kind, wire, is_read, messages: 0 }
    }
}

/// A recording while it is listed.
#[derive(Default)]
pub(crate) struct Listing {
    channels: Vec<Channel>,
    entries: Vec<Entry>,
}

impl Listing {
    /// Adds a channel; its place in the list.
    pub(crate) fn channel(&mut self, channel: Channel) -> usize {
        self.channels.push(channel);
        self.channels.len() - 1
    }

    /// Whether frames are made of the messages of a channel.
    pub(crate) fn is_read(&self, channel: usize) -> bool {
        self.channels[channel].is_read
    }

    /// Adds a message of a channel: counts it, and keeps where it is if it is read.
    pub(crate) fn message(&mut self, channel: usize, time_ns: i64, place: Place) {
        self.count(channel, 1);
        if self.is_read(channel) {
            self.entries.push(Entry { time_ns, channel, place });
        }
    }

    /// Counts messages of a channel that is not read.
    pub(crate) fn count(&mut self, channel: usize, messages: u64) {
        let count = &mut self.channels[channel].messages;
        *count = count.saturating_add(messages);
    }

    /// The recording as it was listed.
    pub(crate) fn finish(self, cut_at: Option<u64>, messages: Box<dyn Messages>) -> Log {
        Log { channels: self.channels, entries: self.entries, cut_at, messages }
    }
}
