//! A frame that has been found but not read.

use std::ffi::{OsStr, OsString};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::capture::{Capture, Pose};
use crate::error::Result;

/// A frame that has been found but not read. It can be read on any thread, and more than once.
#[derive(Clone)]
pub struct FrameRef {
    /// See [`FrameRef::path`].
    pub(crate) path: PathBuf,
    /// See [`FrameRef::name`].
    pub(crate) name: OsString,
    /// See [`FrameRef::number`].
    pub(crate) number: usize,
    /// The colour image, where it is a file of its own.
    pub(crate) color: Option<PathBuf>,
    /// See [`FrameRef::stamp_ns`].
    pub(crate) stamp_ns: Option<i64>,
    /// Where the camera was.
    pub(crate) pose: Option<Pose>,
    /// See [`FrameRef::is_metric`].
    pub(crate) is_metric: bool,
    /// Reads everything else. Its errors name the file.
    pub(crate) load: Arc<dyn Fn() -> Result<Capture> + Send + Sync>,
}

impl FrameRef {
    /// A frame of which only the file tells more; it is in metres.
    pub(crate) fn new(
        path: PathBuf,
        name: OsString,
        load: Arc<dyn Fn() -> Result<Capture> + Send + Sync>,
    ) -> Self {
        Self { path, name, number: 0, color: None, stamp_ns: None, pose: None, is_metric: true, load }
    }

    /// The file by which a user knows the frame: of a depth and a colour image that of the depth.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What the frame is called, as in [`Capture::name`].
    pub fn name(&self) -> &OsStr {
        &self.name
    }

    /// Its place in the source as it was opened, from 0, whatever is selected of it.
    pub fn number(&self) -> usize {
        self.number
    }

    /// The files of this frame alone.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.color.as_deref().into_iter().chain([self.path.as_path()])
    }

    /// When the depth was measured, as far as that is known before the frame is read: of recordings it is when the frame was
    /// recorded, and [`Capture::stamp_ns`] is more exact.
    pub fn stamp_ns(&self) -> Option<i64> {
        self.stamp_ns
    }

    /// Whether the depth is in metres by its format, so that no [`depth_scale`](crate::Given::depth_scale) acts on it.
    pub fn is_metric(&self) -> bool {
        self.is_metric
    }

    /// Reads the frame.
    ///
    /// # Errors
    /// [`Error::At`](crate::Error::At) the file that is wrong: it cannot be read, or what is wrong with its content.
    pub fn read(&self) -> Result<Capture> {
        let capture = (self.load)()?;
        // The folder knows the pose; a message knows its own time better than the recording.
        let (stamp_ns, pose) = (capture.stamp_ns.or(self.stamp_ns), self.pose.or(capture.pose));
        Ok(Capture { name: self.name.clone(), stamp_ns, pose, ..capture })
    }
}

impl fmt::Debug for FrameRef {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FrameRef").field("path", &self.path).field("name", &self.name).finish_non_exhaustive()
    }
}
