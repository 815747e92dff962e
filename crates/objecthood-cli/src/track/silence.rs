//! Frames of which nothing can be said, though they can be read.

use crate::inputs::Input;

/// Why nothing is said of a frame.
pub(super) struct Silence {
    pub(super) why: String,
    /// When it was taken, if that is known.
    pub(super) time_s: Option<f64>,
    /// Its columns and rows, if they are known.
    pub(super) size: Option<(usize, usize)>,
}

impl Silence {
    /// `None` when the frame failed: it cannot be read, or the method refuses it.
    pub(super) fn of(error: &anyhow::Error, input: &Input) -> Option<Self> {
        error
            .chain()
            .find_map(|cause| Self::blank(cause.downcast_ref()?, input))
            .or_else(|| error.chain().find_map(|cause| Self::late(cause.downcast_ref()?)))
    }

    /// The sensor measured nothing, or nothing that is to be looked at.
    fn blank(error: &objecthood_io::Error, input: &Input) -> Option<Self> {
        let size = error.blank_size()?;
        // A recording tells when a frame was recorded, which may be another clock.
        let stamp_ns = input.stamp_ns().filter(|_| !input.is_of_recording());
        let time_s = stamp_ns.map(|stamp_ns| stamp_ns as f64 * 1e-9);
        let why = match error {
            objecthood_io::Error::NothingInScope { .. } => error.to_string(),
            _ => "no pixel has depth".to_owned(),
        };
        Some(Self { why, time_s, size: Some(size) })
    }

    /// It was taken when the last frame was, or before it.
    fn late(error: &objecthood_track::Error) -> Option<Self> {
        match error {
            objecthood_track::Error::Stamp { stamp_s, .. } => {
                Some(Self { why: error.to_string(), time_s: Some(*stamp_s), size: None })
            }
            _ => None,
        }
    }
}
