//! IDF1: for how much of the video the right id is on the right thing.
//!
//! E. Ristani, F. Solera, R. Zou, R. Cucchiara, C. Tomasi, "Performance Measures and a Data Set for Multi-Target, Multi-Camera
//! Tracking", ECCV Workshops 2016. The numbers are those of `TrackEval`: an `IoU` of 0.5 shows an object.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::AddAssign;

use super::counts::share;
use super::overlap::{Overlaps, SHOWN_IOU};
use crate::assignment::maximize;
use crate::error::{Error, Result};

/// Frames of objects and tracks once each object has at most one track for the whole video, and each track one object, so that
/// most frames are right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IdentityCounts {
    /// Frames in which the track of an object shows it.
    right: u64,
    /// Frames of objects, all together.
    of_objects: u64,
    /// Frames of tracks, all together.
    of_tracks: u64,
}

impl IdentityCounts {
    /// Largest table of objects and tracks: 2^24 values of 8 bytes.
    const MAX_CELLS: usize = 1 << 24;

    /// Counts. O(p) for p pairs in all frames, and one assignment, O(r² c) for r objects and c tracks that show one.
    ///
    /// # Errors
    /// [`Error::TooManyRegions`] when there are more pairs than memory should hold.
    pub fn of(overlaps: &Overlaps) -> Result<Self> {
        let mut counts = Self::default();
        let mut shown: BTreeMap<(u16, u16), u32> = BTreeMap::new();
        for frame in &overlaps.frames {
            counts.of_objects += frame.objects.len() as u64;
            counts.of_tracks += frame.tracks.len() as u64;
            for pair in frame.common.iter().filter(|pair| frame.iou(pair) >= SHOWN_IOU) {
                *shown.entry(frame.ids(pair)).or_default() += 1;
            }
        }
        let objects: Vec<u16> = unique(shown.keys().map(|ids| ids.0));
        let tracks: Vec<u16> = unique(shown.keys().map(|ids| ids.1));
        let (rows, columns) = (objects.len(), tracks.len());
        if rows.saturating_mul(columns) > Self::MAX_CELLS {
            return Err(Error::TooManyRegions { rows, columns });
        }
        let mut frames = vec![0.0; rows * columns];
        for (ids, &n) in &shown {
            if let (Ok(row), Ok(column)) = (objects.binary_search(&ids.0), tracks.binary_search(&ids.1)) {
                frames[row * columns + column] = f64::from(n);
            }
        }
        let pairs = maximize(&frames, rows, columns);
        counts.right = pairs.into_iter().map(|(row, column)| frames[row * columns + column] as u64).sum();
        Ok(counts)
    }

    /// Harmonic mean of the shares of the frames of objects and of tracks that are right; `None` when there are neither.
    pub fn f1(&self) -> Option<f64> {
        share(2 * self.right, self.of_objects + self.of_tracks)
    }
}

fn unique(ids: impl Iterator<Item = u16>) -> Vec<u16> {
    ids.collect::<BTreeSet<_>>().into_iter().collect()
}

impl AddAssign for IdentityCounts {
    fn add_assign(&mut self, other: Self) {
        self.right += other.right;
        self.of_objects += other.of_objects;
        self.of_tracks += other.of_tracks;
    }
}
