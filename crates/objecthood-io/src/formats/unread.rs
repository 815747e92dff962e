//! Files that users try and that no format on the list reads: they get better advice when they are recognised.

use std::fmt;

use crate::images;

/// A kind of file that is recognised but not read as a source of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Unread {
    /// An image, which does not say whether it shows depth or colour.
    Image,
    /// A recording of many frames, with the name of its format and its article: `a ROS 1 bag`.
    Recording(&'static str),
}

impl Unread {
    /// What a file that begins with `head` is, if it is known.
    pub(crate) fn tell(head: &[u8]) -> Option<Self> {
        const RECORDINGS: [(&[u8], &str); 4] = [
            (b"#ROSBAG V", "a ROS 1 bag"),
            (b"\x89MCAP0\r\n", "an MCAP recording"),
            (b"SQLite format 3\0", "a ROS 2 bag (SQLite)"),
            (b"\x1a\x45\xdf\xa3", "a Matroska video"),
        ];
        if images::is_image(head) {
            return Some(Self::Image);
        }
        let recording = RECORDINGS.iter().find(|(signature, _)| head.starts_with(signature));
        recording.map(|&(_, name)| Self::Recording(name))
    }
}

impl fmt::Display for Unread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Image => "an image",
            Self::Recording(name) => name,
        })
    }
}
