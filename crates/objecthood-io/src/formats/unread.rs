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
    /// A Matroska file, as the Azure Kinect's recorder writes.
    Matroska,
}

impl Unread {
    /// What a file that begins with `head` is, if it is known.
    pub(crate) fn tell(head: &[u8]) -> Option<Self> {
        const RECORDINGS: [(&[u8], Unread); 2] = [
            (b"#ROSBAG V1", Unread::Recording("a ROS 1 bag of version 1")),
            (b"\x1a\x45\xdf\xa3", Unread::Matroska),
        ];
        if images::is_image(head) {
            return Some(Self::Image);
        }
        let recording = RECORDINGS.iter().find(|(signature, _)| head.starts_with(signature));
        recording.map(|&(_, kind)| kind)
    }
}

impl fmt::Display for Unread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Image => "an image",
            Self::Recording(name) => name,
            Self::Matroska => "a Matroska video",
        })
    }
}
