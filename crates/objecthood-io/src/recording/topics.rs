//! Which topics hold the frames.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use super::error::RecordingError;
use super::fields::Wire;
use super::log::{Log, Messages, Place};
use super::messages::Header;
use super::pixels::{Kind, Shows, shows};
use crate::source::Topic;
use crate::text::preview;

/// A recording in one file or several.
pub(super) struct Recording {
    files: Vec<Box<dyn Messages>>,
    /// Ordered by topic.
    pub(super) streams: Vec<Stream>,
}

/// The messages of a topic.
pub(super) struct Stream {
    pub(super) topic: String,
    /// The type as ROS 1 names it.
    pub(super) kind: String,
    pub(super) wire: Wire,
    /// How many messages there are, whether they are read or not.
    count: u64,
    /// Those that are read, in the order of their times; equal ones in that of the files.
    pub(super) messages: Vec<Message>,
}

/// Where a message lies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Message {
    pub(super) time_ns: i64,
    file: usize,
    place: Place,
}

impl Recording {
    pub(super) fn of(logs: Vec<Log>) -> Self {
        let mut streams: BTreeMap<(String, String), Stream> = BTreeMap::new();
        let mut files = Vec::new();
        for (file, Log { channels, entries, messages, .. }) in logs.into_iter().enumerate() {
            let mut lists: Vec<Vec<Message>> = channels.iter().map(|_| Vec::new()).collect();
            for entry in entries {
                lists[entry.channel].push(Message { time_ns: entry.time_ns, file, place: entry.place });
            }
            for (channel, list) in channels.into_iter().zip(lists) {
                let key = (channel.topic.clone(), channel.kind.clone());
                let (topic, kind, wire) = (channel.topic, channel.kind, channel.wire);
                let none = Stream { topic, kind, wire, count: 0, messages: Vec::new() };
                let stream = streams.entry(key).or_insert(none);
                stream.count = stream.count.saturating_add(channel.messages);
                stream.messages.extend(list);
            }
            files.push(messages);
        }
        let mut streams: Vec<Stream> = streams.into_values().collect();
        streams.iter_mut().for_each(|stream| stream.messages.sort_by_key(|message| message.time_ns));
        Self { files, streams }
    }

    /// All topics.
    pub(super) fn topics(&self) -> Vec<Topic> {
        let of = |Stream { topic, kind, count, .. }: &Stream| Topic {
            name: topic.clone(),
            kind: kind.clone(),
            messages: *count,
        };
        self.streams.iter().map(of).collect()
    }

    /// The bytes of a message.
    pub(super) fn read(&self, message: Message) -> Result<Vec<u8>, RecordingError> {
        self.files[message.file].read(message.place)
    }

    /// The first message of a stream that can be read.
    pub(super) fn first(&self, stream: &Stream) -> Option<Vec<u8>> {
        stream.messages.first().and_then(|&message| self.read(message).ok())
    }

    /// The streams of a type that have messages.
    pub(super) fn of_kind<'a>(&'a self, kind: &'a str) -> impl Iterator<Item = &'a Stream> {
        self.streams.iter().filter(move |stream| stream.kind == kind && !stream.messages.is_empty())
    }

    /// The topics with their types, the first of them, for messages.
    pub(super) fn described(&self) -> String {
        const SHOWN: usize = 4;
        let of = |stream: &Stream| {
            format!("{} ({})", preview(stream.topic.as_bytes()), preview(stream.kind.as_bytes()))
        };
        let shown: Vec<String> = self.streams.iter().take(SHOWN).map(of).collect();
        let more = self.streams.len().saturating_sub(SHOWN);
        let shown = shown.join(", ");
        if more > 0 { format!("{shown} and {more} more") } else { shown }
    }
}

/// The topics of the frames, by their places among the streams.
#[derive(Debug)]
pub(super) enum Chosen {
    Images { depth: View, color: Option<View> },
    Points(usize),
}

/// A topic of images.
#[derive(Clone, Debug)]
pub(super) struct View {
    pub(super) stream: usize,
    pub(super) kind: Kind,
    /// That of its first message.
    pub(super) header: Header,
    shows: Shows,
}

/// Chooses the topics: those that are asked for, and the rest by what their first messages show. Depth that is registered to
/// colour is preferred, then images as they were measured to compressed ones, then the topic with more of them. Images come before points.
///
/// # Errors
/// [`RecordingError::NoTopic`], [`RecordingError::NotDepth`], [`RecordingError::NoDepth`].
pub(super) fn choose(recording: &Recording, asked: &[String]) -> Result<Chosen, RecordingError> {
    let topics = || recording.described();
    for topic in asked {
        if !recording.streams.iter().any(|stream| stream.topic == *topic) {
            return Err(RecordingError::NoTopic { asked: preview(topic.as_bytes()), topics: topics() });
        }
    }
    let is_asked = |stream: usize| asked.contains(&recording.streams[stream].topic);
    let views = views(recording);
    let points = || (0..recording.streams.len()).filter(|&stream| is_points(&recording.streams[stream]));
    if let Some(stream) = points().find(|&stream| is_asked(stream)) {
        return Ok(Chosen::Points(stream));
    }
    let depth = views.iter().filter(|view| view.may_be_depth(recording, is_asked(view.stream)));
    let depth = depth.min_by_key(|view| (!is_asked(view.stream), view.rank_as_depth(recording)));
    let Some(depth) = depth else {
        return match points().next() {
            Some(stream) if asked.is_empty() => Ok(Chosen::Points(stream)),
            _ if asked.is_empty() => Err(RecordingError::NoDepth { topics: topics() }),
            _ => Err(RecordingError::NotDepth { topics: topics() }),
        };
    };
    let color = views.iter().filter(|view| view.may_be_color(recording, is_asked(view.stream)));
    let color = color.min_by_key(|view| (!is_asked(view.stream), view.rank_as_color(recording, depth)));
    let is_used =
        |view: &View| view.stream == depth.stream || color.is_some_and(|color| color.stream == view.stream);
    if !asked.is_empty() && !views.iter().any(|view| is_asked(view.stream) && is_used(view)) {
        return Err(RecordingError::NotDepth { topics: topics() });
    }
    Ok(Chosen::Images { depth: depth.clone(), color: color.cloned() })
}

fn is_points(stream: &Stream) -> bool {
    stream.kind == "sensor_msgs/PointCloud2" && !stream.messages.is_empty()
}

fn views(recording: &Recording) -> Vec<View> {
    let view = |(number, stream): (usize, &Stream)| {
        let kind = match stream.kind.as_str() {
            "sensor_msgs/Image" => Kind::Raw,
            "sensor_msgs/CompressedImage" => Kind::Compressed,
            _ => return None,
        };
        let (shows, header) = shows(kind, &recording.first(stream)?, stream.wire).ok()?;
        Some(View { stream: number, kind, header, shows })
    };
    recording.streams.iter().enumerate().filter_map(view).collect()
}

/// Whether the name of a topic says that its images are infrared.
fn is_infrared(topic: &str) -> bool {
    topic.split('/').any(|part| part == "ir" || part.to_ascii_lowercase().contains("infra"))
}

/// Whether the name of a topic says that its depth is registered to colour.
pub(super) fn is_registered(topic: &str) -> bool {
    ["aligned", "registered", "depth_to_rgb", "depth_to_color"].iter().any(|word| topic.contains(word))
}

impl View {
    pub(super) fn topic<'a>(&self, recording: &'a Recording) -> &'a str {
        &recording.streams[self.stream].topic
    }

    fn may_be_depth(&self, recording: &Recording, is_asked: bool) -> bool {
        let topic = self.topic(recording);
        match self.shows {
            Shows::Depth => true,
            Shows::Deep => is_asked || !is_infrared(topic),
            Shows::Color | Shows::Grey => false,
        }
    }

    fn may_be_color(&self, recording: &Recording, is_asked: bool) -> bool {
        matches!(self.shows, Shows::Color | Shows::Grey) && (is_asked || !is_infrared(self.topic(recording)))
    }

    fn rank_as_depth<'a>(&self, recording: &'a Recording) -> (bool, bool, bool, Reverse<usize>, &'a str) {
        let stream = &recording.streams[self.stream];
        let (is_deep, is_raw) = (self.shows == Shows::Deep, self.kind == Kind::Raw);
        (is_deep, !is_registered(&stream.topic), !is_raw, Reverse(stream.messages.len()), &stream.topic)
    }

    fn rank_as_color<'a>(
        &self,
        recording: &'a Recording,
        depth: &Self,
    ) -> (bool, bool, bool, bool, Reverse<usize>, &'a str) {
        let stream = &recording.streams[self.stream];
        let is_named =
            ["rgb", "color", "colour"].iter().any(|word| stream.topic.to_ascii_lowercase().contains(word));
        let is_beside = self.header.frame_id == depth.header.frame_id;
        let (is_grey, is_raw) = (self.shows == Shows::Grey, self.kind == Kind::Raw);
        (is_grey, !is_beside, !is_named, !is_raw, Reverse(stream.messages.len()), &stream.topic)
    }
}
