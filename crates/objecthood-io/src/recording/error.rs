//! What can be wrong with a recording.

/// Why a recording, or a message of it, cannot be used: one line that says what is wrong, and what to do about the file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The system does not let bytes be read.
    #[error("cannot be read ({reason}): check the file and its disk")]
    Read {
        /// What the system says.
        reason: String,
    },
    /// The file ends too early.
    #[error(
        "the recording ends in the middle, at byte {at}: copy it again, or repair it with its recorder's tool"
    )]
    Cut {
        /// Where it ends.
        at: u64,
    },
    /// Bytes that break the format.
    #[error(
        "the {format} recording is damaged at byte {at}: {problem}; copy it again, or repair it with its recorder's tool"
    )]
    Damaged {
        /// Name of the format.
        format: &'static str,
        /// Where.
        at: u64,
        /// What is wrong there.
        problem: String,
    },
    /// A compression that is not read.
    #[error("the recording is compressed as `{found}`: save it with zstd or lz4, or without compression")]
    Compression {
        /// Its name, or the beginning of it.
        found: String,
    },
    /// More bytes at a time than are unpacked.
    #[error("{bytes} bytes are packed together, at most {most} are read: record with smaller chunks")]
    TooLarge {
        /// Bytes.
        bytes: u64,
        /// What is allowed.
        most: u64,
    },
    /// A recording without frames.
    #[error("no depth image and no point cloud is in the recording{}", listed(topics))]
    NoDepth {
        /// What is in it: topics with their types, or the first of them.
        topics: String,
    },
    /// A topic that is asked for and is not there.
    #[error("the recording has no topic `{asked}`{}", listed(topics))]
    NoTopic {
        /// What was asked for, or the beginning of it.
        asked: String,
        /// What is there: topics with their types, or the first of them.
        topics: String,
    },
    /// Topics that do not make frames.
    #[error(
        "the topics that are asked for hold no depth and no points: name one that does{}",
        listed(topics)
    )]
    NotDepth {
        /// What is there: topics with their types, or the first of them.
        topics: String,
    },
    /// A message that does not have the form of its type.
    #[error("a message of {topic} is damaged: {problem}; record it again")]
    Message {
        /// Its topic.
        topic: String,
        /// What is wrong.
        problem: String,
    },
    /// A kind of pixel that is not read.
    #[error("the images of {topic} are `{encoding}`, which is not read: record {wanted}")]
    Encoding {
        /// Their topic.
        topic: String,
        /// Their encoding, or the beginning of it.
        encoding: String,
        /// What would be read.
        wanted: &'static str,
    },
    /// Depth without a partner in time.
    #[error(
        "none of its {color} colour and {depth} depth images were taken within {max_apart_ms} ms of each other: check the clocks of the cameras"
    )]
    NoPairs {
        /// Colour images.
        color: usize,
        /// Depth images.
        depth: usize,
        /// How far apart two images of a frame may be taken (ms).
        max_apart_ms: i64,
    },
    /// A bag whose newest messages lie beside it.
    #[error(
        "its newest messages are still in the file beside it that ends in -wal: close the recorder, or copy both files and run `sqlite3 FILE 'pragma wal_checkpoint'`"
    )]
    Unfinished,
}

fn listed(topics: &str) -> String {
    if topics.is_empty() { ": it is empty".to_owned() } else { format!("; it has {topics}") }
}
