//! Where frames come from: a file, a recording, a folder or images.

mod file;
mod fingerprint;
mod folder;
mod frame_ref;
mod selection;

use std::fmt;
use std::path::{Path, PathBuf};

pub use fingerprint::sha256;
pub use frame_ref::FrameRef;
pub use selection::{FrameRange, Selection, TimeRange};

use crate::capture::Capture;
use crate::error::{Error, Result};
use crate::formats::tell_folder;
use crate::given::Given;

/// Frames in their order: an iterator of frames that are found but not read.
///
/// * Streamed: [`FrameRef::read`] reads a frame, so there are no more in memory than the caller keeps, and several
///   threads can read at a time. [`Source::captures`] reads one after the other.
/// * Seekable: of what `nth`, `skip` and `step_by` pass over, at most the head of the file is read.
/// * Countable: [`Source::frame_count`], where the format tells without reading everything.
///
/// An error is that of one frame or file; the others still come.
pub struct Source {
    frames: Box<dyn Iterator<Item = Result<FrameRef>> + Send>,
    shared_files: Vec<PathBuf>,
    notices: Vec<Notice>,
    topics: Vec<Topic>,
}

/// A topic of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topic {
    /// Its name.
    pub name: String,
    /// The type of its messages, as ROS 1 names it: `sensor_msgs/Image`.
    pub kind: String,
    /// How many messages it has, whether frames are made of them or not.
    pub messages: u64,
}

impl Source {
    /// Opens what lies at `path`: a file of any format that is read, a folder with a layout that is read, or else a
    /// folder that is searched, with those below, for files with one of the [`extensions`](crate::formats::extensions), in
    /// natural order (`learn2` before `learn10`). Links to folders are not followed: they may lead in circles.
    ///
    /// A folder with a layout is listed at once, O(frames); another folder is listed while its frames are asked for. Of a file the
    /// head is read, of a pipe everything, because it can be read only once.
    ///
    /// # Errors
    /// [`Error::At`] the path: it cannot be read, [`Error::Empty`], [`Error::UnknownFormat`], [`Error::NoFrames`], or
    /// what is wrong with the folder.
    pub fn open(path: &Path, given: &Given) -> Result<Self> {
        if !path.is_dir() {
            return file::open(path, given);
        }
        if let Some(format) = tell_folder(path) {
            return (format.open)(path, given);
        }
        let mut found = folder::search(path, given).peekable();
        if found.peek().is_none() {
            return Err(Error::NoFrames.at(path));
        }
        Ok(Self::of(found))
    }

    /// A list of frames.
    pub(crate) fn listed(frames: Vec<FrameRef>) -> Self {
        Self::of(frames.into_iter().map(Ok))
    }

    /// A source of which nothing can be read.
    pub(crate) fn failed(error: Error) -> Self {
        Self::of(std::iter::once(Err(error)))
    }

    /// Frames in their order; each gets its number.
    fn of(frames: impl Iterator<Item = Result<FrameRef>> + Send + 'static) -> Self {
        let numbered =
            |(number, frame): (usize, Result<FrameRef>)| frame.map(|frame| FrameRef { number, ..frame });
        Self {
            frames: Box::new(frames.enumerate().map(numbered)),
            shared_files: Vec::new(),
            notices: Vec::new(),
            topics: Vec::new(),
        }
    }

    /// The frames of it that are selected.
    #[must_use]
    pub fn select(self, selection: &Selection) -> Self {
        Self { frames: selection.of(self.frames), ..self }
    }

    /// The same source, and the files that all its frames share.
    pub(crate) fn with_shared_files(self, shared_files: Vec<PathBuf>) -> Self {
        Self { shared_files, ..self }
    }

    /// The same source, and what is to be said of it.
    pub(crate) fn with_notices(self, notices: Vec<Notice>) -> Self {
        Self { notices, ..self }
    }

    /// The same source, a recording with these topics.
    pub(crate) fn with_topics(self, topics: Vec<Topic>) -> Self {
        Self { topics, ..self }
    }

    /// The topics of a recording, by name; none of any other source.
    pub fn topics(&self) -> &[Topic] {
        &self.topics
    }

    /// How many frames are still to come, where that is known without reading everything.
    pub fn frame_count(&self) -> Option<usize> {
        let (least, most) = self.frames.size_hint();
        most.filter(|&most| most == least)
    }

    /// Files that all frames share, such as that of their camera.
    pub fn shared_files(&self) -> &[PathBuf] {
        &self.shared_files
    }

    /// What the user should know of the source although its frames can be read.
    pub fn notices(&self) -> &[Notice] {
        &self.notices
    }

    /// Reads the frames one after the other.
    pub fn captures(self) -> impl Iterator<Item = Result<Capture>> + Send {
        self.frames.map(|frame| frame.and_then(|frame| frame.read()))
    }
}

impl Iterator for Source {
    type Item = Result<FrameRef>;

    fn next(&mut self) -> Option<Self::Item> {
        self.frames.next()
    }

    fn nth(&mut self, skipped: usize) -> Option<Self::Item> {
        self.frames.nth(skipped)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.frames.size_hint()
    }
}

impl fmt::Debug for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Source").field("frame_count", &self.frame_count()).finish_non_exhaustive()
    }
}

/// Opens what lies at `path` and reads its first frame: of a file that holds one frame, all there is.
///
/// # Errors
/// As [`Source::open`] and [`FrameRef::read`].
pub fn open_frame(path: &Path, given: &Given) -> Result<Capture> {
    let mut captures = Source::open(path, given)?.captures();
    captures.next().unwrap_or_else(|| Err(Error::NoFrames.at(path)))
}

/// What the user should know of a source although its frames can be read.
#[derive(Debug)]
#[non_exhaustive]
pub enum Notice {
    /// Images of a folder that have no partner.
    WithoutPartner {
        /// The folder.
        folder: PathBuf,
        /// Frames, of two images each.
        frames: usize,
        /// Colour images without a depth image.
        color: usize,
        /// Depth images without a colour image.
        depth: usize,
        /// How far apart two images of a frame may be taken (ms).
        max_apart_ms: i64,
    },
    /// A recording whose colour images cannot be used; the frames have depth alone.
    WithoutColor {
        /// The file.
        file: PathBuf,
        /// Why.
        reason: String,
    },
    /// A recording that ends in the middle; the frames before are whole.
    Cut {
        /// The file.
        file: PathBuf,
        /// Where it ends (bytes).
        at: u64,
    },
    /// A file of poses that cannot be used; the frames have none.
    NoPoses(Error),
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WithoutPartner { folder, frames, color, depth, max_apart_ms } => write!(
                f,
                "{}: {frames} frames; {color} colour and {depth} depth images have no partner within {max_apart_ms} ms",
                folder.display()
            ),
            Self::WithoutColor { file, reason } => {
                write!(f, "{}: its colour is left out: {reason}", file.display())
            }
            Self::Cut { file, at } => write!(
                f,
                "{}: the recording ends in the middle, at byte {at}; the frames before are read",
                file.display()
            ),
            Self::NoPoses(error) => write!(f, "{error}; the frames have no poses"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::images;

    const ONE_POINT: &str =
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n0 0 1\n";

    fn open_frame(path: &Path) -> Result<Capture> {
        super::open_frame(path, &Given { max_pixels: 100, ..Given::default() })
    }

    /// A folder of files with this content.
    fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in files {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, content).unwrap();
        }
        folder
    }

    fn names(frames: impl Iterator<Item = Result<FrameRef>>) -> Vec<String> {
        frames.map(|frame| frame.unwrap().name().to_str().unwrap().to_owned()).collect()
    }

    #[test]
    fn the_path_is_said_once() {
        let folder = tempfile::tempdir().unwrap();
        for (name, content, said) in [
            ("empty.pcd", &b""[..], "the file is empty"),
            ("noise.pcd", &[0xff, 0x00, 0x13, 0x37], "not a file that objecthood reads"),
            ("cut.pcd", b"# .PCD v0.7\nVERSION 0.7\n", "without a DATA line"),
            ("nan.pcd", ONE_POINT.replace("0 0 1", "0 0 nan").as_bytes(), "no pixel has a valid depth"),
        ] {
            let path = folder.path().join(name);
            std::fs::write(&path, content).unwrap();
            let message = open_frame(&path).unwrap_err().to_string();
            assert!(message.contains(said), "{message}");
            assert_eq!(message.matches(name).count(), 1, "{message}");
            assert!(!message.contains('\n'), "{message}");
        }
    }

    #[test]
    fn what_cannot_be_read_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let message = open_frame(folder.path()).unwrap_err().to_string();
        assert!(message.contains("no point cloud (.pcd"), "{message}");
        let missing = folder.path().join("missing.pcd");
        assert!(open_frame(&missing).unwrap_err().to_string().contains("cannot be read"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_without_end_is_not_loaded() {
        let message = open_frame(Path::new("/dev/zero")).unwrap_err().to_string();
        assert!(message.contains("not a file that objecthood reads"), "{message}");
    }

    /// A pipe was read twice: once to tell its format, and then nothing was left.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_pipe_is_read_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        let writer = {
            let path = path.clone();
            std::thread::spawn(move || std::fs::write(path, ONE_POINT))
        };
        let frame = Source::open(&path, &Given::default()).unwrap().next().unwrap().unwrap();
        writer.join().unwrap().unwrap();
        assert_eq!(frame.read().unwrap().frame.depth_m().as_slice(), [1.0]);
        assert_eq!(frame.read().unwrap().frame.depth_m().as_slice(), [1.0], "and as often as one likes");
    }

    #[test]
    fn a_file_longer_than_its_head_is_read_whole() {
        let long = format!("# {}\n{ONE_POINT}", "x".repeat(2000));
        let folder = folder(&[("long.pcd", &long)]);
        assert_eq!(open_frame(&folder.path().join("long.pcd")).unwrap().frame.depth_m().as_slice(), [1.0]);
    }

    #[test]
    fn a_folder_is_searched_below_and_in_natural_order() {
        let cloud = |name| (name, ONE_POINT);
        let folder = folder(&[
            cloud("b10.pcd"),
            cloud("b9.PCD"),
            cloud("a/deep/x.pcd"),
            cloud("c/y.pcd"),
            ("notes.txt", "nothing"),
        ]);
        let source = Source::open(folder.path(), &Given::default()).unwrap();
        assert_eq!(names(source), ["x", "b9", "b10", "y"]);
    }

    #[test]
    fn a_bad_file_is_an_error_among_the_frames_and_the_others_still_come() {
        let folder = folder(&[("a.pcd", ONE_POINT), ("b.pcd", "noise"), ("c.pcd", ONE_POINT)]);
        let source = Source::open(folder.path(), &Given::default()).unwrap();
        assert_eq!(source.captures().map(|capture| capture.is_ok()).collect::<Vec<_>>(), [true, false, true]);
    }

    #[test]
    fn a_list_is_counted_and_what_is_skipped_is_not_read() {
        let images = (0..10).map(|k| images::ImageFiles::new(None, format!("{k}.png").into())).collect();
        let mut source = images::source_of(images, &Given::default());
        assert_eq!(source.frame_count(), Some(10));
        // None of these files is there.
        assert_eq!(source.nth(4).unwrap().unwrap().name(), "4");
        assert_eq!(source.frame_count(), Some(5));
        assert_eq!(names(source.step_by(2)), ["5", "7", "9"]);
    }
}
