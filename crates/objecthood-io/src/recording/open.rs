//! From the files of a recording to a source of frames.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use objecthood::Raster;

use super::bytes::{Bytes, OnDisk};
use super::cloud;
use super::error::RecordingError;
use super::fields::Fields;
use super::log::Log;
use super::pixels::Reading;
use super::rig::{Rig, Seen};
use super::topics::{Chosen, Message, Recording, Stream, View, choose};
use crate::associate::associate;
use crate::capture::{Capture, Said};
use crate::error::{Error, Result};
use crate::given::Given;
use crate::images::check_unit;
use crate::organize::organize;
use crate::source::{FrameRef, Notice, Source};
use crate::text::preview;

/// Lists the messages of a file of one format.
pub(crate) type Opener = fn(Box<dyn Bytes>) -> Result<Log, RecordingError>;

/// What belongs together was recorded at most this apart (ms): a hand that moves a metre a second is then within 4 cm. Cameras of
/// 15 images a second that are not synchronized are up to 33 ms apart.
const MAX_APART_MS: i64 = 40;

/// Units of whole-number depth in a metre: millimetres, by REP 118.
const DEPTH_SCALE: f64 = 1000.0;

impl From<RecordingError> for Error {
    fn from(error: RecordingError) -> Self {
        Self::Content(Box::new(error))
    }
}

/// The frames of a recording at `path`, which lies in one file or in several that follow each other.
///
/// # Errors
/// [`Error::Content`] with a [`RecordingError`]; [`Error::Image`] without a camera. They do not name the path.
pub(crate) fn open(path: &Path, files: &[(PathBuf, Opener)], given: &Given) -> Result<Source> {
    let mut logs = Vec::new();
    let mut notices = Vec::new();
    for (file, opener) in files {
        let log = open_log(file, *opener)?;
        if let Some(at) = log.cut_at {
            notices.push(Notice::Cut { file: file.clone(), at });
        }
        logs.push(log);
    }
    let recording = Recording::of(logs);
    let topics = recording.topics();
    let name = Named { path: path.to_owned(), stem: stem_of(path) };
    let frames = match choose(&recording, &given.topics)? {
        Chosen::Points(stream) => points(recording, stream, &name, given),
        Chosen::Images { depth, color } => {
            images(recording, &depth, color.as_ref(), &name, given, &mut notices)?
        }
    };
    Ok(Source::listed(frames).with_notices(notices).with_topics(topics))
}

fn open_log(file: &Path, opener: Opener) -> Result<Log, RecordingError> {
    let mut beside = file.as_os_str().to_owned();
    beside.push("-wal");
    if std::fs::metadata(&beside).is_ok_and(|beside| beside.len() > 0) {
        return Err(RecordingError::Unfinished);
    }
    opener(Box::new(OnDisk::open(file)?))
}

/// The name of a file or folder without its ending; of `.`, which has none, that of the folder in which the user is.
fn stem_of(path: &Path) -> OsString {
    let named = path.file_stem().map(ToOwned::to_owned);
    let real = || path.canonicalize().ok()?.file_stem().map(ToOwned::to_owned);
    named.or_else(real).unwrap_or_else(|| "recording".into())
}

/// What frames are called.
struct Named {
    path: PathBuf,
    stem: OsString,
}

impl Named {
    fn frame(
        &self,
        number: usize,
        stamp_ns: i64,
        load: impl Fn() -> Result<Capture> + Send + Sync + 'static,
    ) -> FrameRef {
        let mut name = self.stem.clone();
        name.push(format!("-{number:06}"));
        FrameRef { stamp_ns: Some(stamp_ns), ..FrameRef::new(self.path.clone(), name, Arc::new(load)) }
    }
}

/// Frames of point clouds.
fn points(recording: Recording, stream: usize, name: &Named, given: &Given) -> Vec<FrameRef> {
    let shared = Arc::new((recording, given.clone(), name.path.clone()));
    let (recording, ..) = &*shared;
    let frame = |(number, &message): (usize, &Message)| {
        let shared = Arc::clone(&shared);
        name.frame(number, message.time_ns, move || {
            let (recording, given, path) = &*shared;
            read_points(recording, &recording.streams[stream], message, given).map_err(|e| e.at(path))
        })
    };
    recording.streams[stream].messages.iter().enumerate().map(frame).collect()
}

fn read_points(recording: &Recording, stream: &Stream, message: Message, given: &Given) -> Result<Capture> {
    let topic = || preview(stream.topic.as_bytes());
    let (cloud, header) = cloud::decode(&recording.read(message)?, stream.wire)
        .map_err(|problem| RecordingError::Message { topic: topic(), problem })?;
    let capture = organize(cloud, given)?;
    Ok(Capture { stamp_ns: stamp(header.stamp_ns), ..capture })
}

/// A time that was said.
fn stamp(stamp_ns: i64) -> Option<i64> {
    (stamp_ns != 0).then_some(stamp_ns)
}

/// What all frames of images share.
struct Camera {
    recording: Recording,
    depth: View,
    color: Option<View>,
    rig: Rig,
    /// Units of a metre that hold, and those of the recording.
    depth_scale: f64,
    said_scale: f64,
    max_pixels: usize,
    path: PathBuf,
}

/// Frames of depth images and the colour images that belong to them.
fn images(
    recording: Recording,
    depth: &View,
    color: Option<&View>,
    name: &Named,
    given: &Given,
    notices: &mut Vec<Notice>,
) -> Result<Vec<FrameRef>> {
    let said_scale = units_a_metre(&recording, depth.topic(&recording)).unwrap_or(DEPTH_SCALE);
    let size_of_depth =
        first(&recording, depth, |reading, bytes| Ok(reading.depth(bytes, said_scale)?.0.size()), given);
    let size_of_color = color
        .and_then(|view| first(&recording, view, |reading, bytes| Ok(reading.color(bytes)?.size()), given));
    let seen = Seen { view: depth, size: size_of_depth };
    let beside = color.map(|view| Seen { view, size: size_of_color });
    let (rig, problem) = Rig::of(&recording, &seen, beside.as_ref(), given)?;
    notices.extend(problem.map(|reason| Notice::WithoutColor { file: name.path.clone(), reason }));
    let color = color.filter(|_| rig.has_color());
    let pairs = pairs(&recording, depth, color, name, notices)?;
    let camera = Arc::new(Camera {
        depth: depth.clone(),
        color: color.cloned(),
        rig,
        depth_scale: given.depth_scale.unwrap_or(said_scale),
        said_scale,
        max_pixels: given.max_pixels,
        path: name.path.clone(),
        recording,
    });
    let frame = |(number, (depth, color)): (usize, (Message, Option<Message>))| {
        let shared = Arc::clone(&camera);
        let frame = name.frame(number, depth.time_ns, move || {
            shared.read(depth, color).map_err(|error| error.at(&shared.path))
        });
        FrameRef { pose: camera.rig.pose, is_metric: false, ..frame }
    };
    Ok(pairs.into_iter().enumerate().map(frame).collect())
}

/// What `read` makes of the first message of a topic; `None` when that is damaged.
fn first<T>(
    recording: &Recording,
    view: &View,
    read: impl Fn(&Reading<'_>, &[u8]) -> Result<T>,
    given: &Given,
) -> Option<T> {
    let stream = &recording.streams[view.stream];
    read(&reading(stream, view, given.max_pixels), &recording.first(stream)?).ok()
}

fn reading<'a>(stream: &'a Stream, view: &View, max_pixels: usize) -> Reading<'a> {
    Reading { topic: &stream.topic, kind: view.kind, wire: stream.wire, max_pixels }
}

/// The depth images and the colour image of each. Those without a partner are left out, which is said.
fn pairs(
    recording: &Recording,
    depth: &View,
    color: Option<&View>,
    name: &Named,
    notices: &mut Vec<Notice>,
) -> Result<Vec<(Message, Option<Message>)>> {
    let depth = &recording.streams[depth.stream].messages;
    let Some(color) = color else { return Ok(depth.iter().map(|&depth| (depth, None)).collect()) };
    let color = &recording.streams[color.stream].messages;
    let times_us =
        |messages: &[Message]| messages.iter().map(|message| message.time_ns / 1000).collect::<Vec<_>>();
    let pairs = associate(&times_us(depth), &times_us(color), 1000 * MAX_APART_MS);
    let (depth_alone, color_alone) = (depth.len() - pairs.len(), color.len() - pairs.len());
    if pairs.is_empty() {
        let alone =
            RecordingError::NoPairs { color: color_alone, depth: depth_alone, max_apart_ms: MAX_APART_MS };
        return Err(alone.into());
    }
    if depth_alone > 0 {
        notices.push(Notice::WithoutPartner {
            folder: name.path.clone(),
            frames: pairs.len(),
            color: color_alone,
            depth: depth_alone,
            max_apart_ms: MAX_APART_MS,
        });
    }
    Ok(pairs.into_iter().map(|(d, c)| (depth[d], Some(color[c]))).collect())
}

/// Units of depth in a metre as RealSense records them: the option `Depth_Units` of the sensor, in metres a unit.
fn units_a_metre(recording: &Recording, topic: &str) -> Option<f64> {
    let (stream, _) = topic.split_once("/image/")?;
    let (sensor, _) = stream.rsplit_once('/')?;
    let option = format!("{sensor}/option/Depth_Units/value");
    let stream = recording.streams.iter().find(|stream| stream.topic == option)?;
    let message = recording.first(stream)?;
    let fields = &mut Fields::of(&message, stream.wire).ok()?;
    let metres: f32 = match stream.kind.as_str() {
        "std_msgs/Float32" => fields.f32().ok()?,
        _ => str::from_utf8(fields.text().ok()?).ok()?.trim().parse().ok()?,
    };
    let scale = 1.0 / f64::from(metres);
    // A float of 0.001 is no millimetre to the last digit; a whole number of units is meant where one gives this float.
    let is_whole = (1.0 / scale.round()) as f32 == metres;
    Some(if is_whole { scale.round() } else { scale }).filter(|scale| scale.is_finite() && *scale > 0.0)
}

impl Camera {
    fn read(&self, depth: Message, color: Option<Message>) -> Result<Capture> {
        let stream = &self.recording.streams[self.depth.stream];
        let bytes = self.recording.read(depth)?;
        let (depth_m, header) =
            reading(stream, &self.depth, self.max_pixels).depth(&bytes, self.depth_scale)?;
        drop(bytes);
        check_unit(depth_m.as_slice(), self.depth_scale)?;
        let color: Option<Raster<[u8; 3]>> = match (&self.color, color) {
            (Some(view), Some(message)) => {
                let stream = &self.recording.streams[view.stream];
                Some(reading(stream, view, self.max_pixels).color(&self.recording.read(message)?)?)
            }
            _ => None,
        };
        let said = Said { depth_scale: Some(self.said_scale), ..self.rig.said };
        let frame = self.rig.frame(depth_m, color)?;
        Ok(Capture { stamp_ns: stamp(header.stamp_ns), said, ..Capture::new(frame) })
    }
}
