//! Why a frame could not be processed.

use objecthood::{Discovery, Frame};

/// Why a frame could not be processed. The tracker stays as it was before.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The objects of the frame could not be found.
    #[error(transparent)]
    Discover(#[from] objecthood::Error),
    /// The stamp is not later than the last one.
    #[error(
        "the stamp {stamp_s} s is not after that of the last frame, {last_s} s: give frames in the order in which they were taken"
    )]
    Stamp {
        /// The stamp of this frame (s).
        stamp_s: f64,
        /// The stamp of the last frame (s).
        last_s: f64,
    },
    /// The labels have another size than the frame.
    #[error("the labels have {}x{} pixels, the frame {}x{}: give the discovery of this frame", labels.0, labels.1, frame.0, frame.1)]
    Size {
        /// Columns and rows of the labels.
        labels: (usize, usize),
        /// Columns and rows of the frame.
        frame: (usize, usize),
    },
    /// A label names no object.
    #[error(
        "label {label} names no object of the discovery: object k has to have the label k, counted from 1"
    )]
    Label {
        /// The label.
        label: u16,
    },
    /// The state of a tracker could not be written.
    #[error("the tracker's state cannot be saved: {reason}")]
    Save {
        /// Why.
        reason: String,
    },
    /// The bytes are not a state of a tracker.
    #[error(
        "the saved state of the tracker cannot be used: {reason}; the video is to be followed from its first frame"
    )]
    State {
        /// Why.
        reason: String,
    },
}

/// The tracker's result.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Refuses a stamp that is not later than the last one.
pub(crate) fn check_stamp(stamp_s: f64, last_s: Option<f64>) -> Result<()> {
    let last_s = last_s.unwrap_or(f64::NEG_INFINITY);
    if stamp_s.is_finite() && stamp_s > last_s { Ok(()) } else { Err(Error::Stamp { stamp_s, last_s }) }
}

/// Refuses labels of another size, and labels that name no object.
pub(crate) fn check_labels(frame: &Frame, found: &Discovery) -> Result<()> {
    if found.labels.size() != frame.size() {
        return Err(Error::Size { labels: found.labels.size(), frame: frame.size() });
    }
    let is_misplaced = |&(k, object): &(usize, &objecthood::Object)| usize::from(object.id.0) != k + 1;
    if let Some((_, object)) = found.objects.iter().enumerate().find(is_misplaced) {
        return Err(Error::Label { label: object.id.0 });
    }
    match found.labels.as_slice().iter().find(|&&label| usize::from(label) > found.objects.len()) {
        Some(&label) => Err(Error::Label { label }),
        None => Ok(()),
    }
}
