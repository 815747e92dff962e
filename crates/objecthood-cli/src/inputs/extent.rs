//! How much an input has: what a user needs to know who selected nothing of it.

use std::fmt;
use std::path::Path;

use objecthood_io::{Given, Selection, Source};

use crate::words::counted;

/// How much an input has.
#[derive(Clone, Copy, Default)]
pub(super) struct Extent {
    pub(super) frames: usize,
    /// From the first frame to the last; 0 without times.
    pub(super) seconds: f64,
}

impl Extent {
    /// Of the input at a path; nothing where it cannot be opened.
    pub(super) fn at(path: &Path, given: &Given) -> Self {
        Source::open(path, given).map(Self::of).unwrap_or_default()
    }

    fn of(source: Source) -> Self {
        let (mut frames, mut first_ns, mut since_ns) = (0, None, 0);
        for frame in source {
            frames += 1;
            if let Some(stamp_ns) = frame.ok().and_then(|frame| frame.stamp_ns()) {
                since_ns = since_ns.max(stamp_ns.saturating_sub(*first_ns.get_or_insert(stamp_ns)));
            }
        }
        Self { frames, seconds: since_ns as f64 * 1e-9 }
    }

    /// What the longest input has, as far as it bears on what was asked for.
    pub(super) fn of_longest(extents: &[Self], selection: &Selection) -> String {
        let most = extents.iter().map(|extent| extent.frames).max().unwrap_or(0);
        let longest = extents
            .iter()
            .copied()
            .max_by(|a, b| a.seconds.total_cmp(&b.seconds).then(a.frames.cmp(&b.frames)));
        match longest.filter(|_| selection.time.is_some()) {
            Some(longest) => format!("the longest input has {longest}"),
            None => format!("no input has more than {}, numbered from 0", counted(most, "frame")),
        }
    }
}

impl fmt::Display for Extent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, numbered from 0", counted(self.frames, "frame"))?;
        if self.seconds > 0.0 {
            write!(f, ", at times from 0 to {:.3} s", self.seconds)?;
        }
        Ok(())
    }
}
