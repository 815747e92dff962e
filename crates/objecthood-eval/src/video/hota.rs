//! HOTA: how well things are found and followed, in one number.
//!
//! J. Luiten, A. Osep, P. Dendorfer, P. Torr, A. Geiger, L. Leal-Taixe, B. Leibe, "HOTA: A Higher Order Metric for Evaluating
//! Multi-Object Tracking", IJCV 129, 2021. OWTA: Y. Liu et al., "Opening up Open-World Tracking", CVPR 2022. The numbers are
//! those of `TrackEval`.
//!
//! 1. Over the whole video, each pair of object and track is given its alignment: the share of their frames in which they go
//!    together, a frame weighted by how much better they fit each other than others there.
//! 2. In each frame objects and tracks are paired so that the sum of alignment times `IoU` is greatest. For each of the 19
//!    thresholds 0.05 .. 0.95 the pairs of at least that `IoU` are matches.
//! 3. `DetA` is matches / (matches + missed + false). `AssA` is the mean over matches of A: the frames in which object and track
//!    are matched, over the frames in which either is there. HOTA is the geometric mean of both, and OWTA has the recall in
//!    place of `DetA`, so that a thing without a label is not punished. Each is the mean over the thresholds.

use std::collections::BTreeMap;
use std::ops::AddAssign;

use serde::Serialize;

use super::overlap::{FrameOverlap, Overlaps};
use crate::assignment::maximize;

const THRESHOLDS: usize = 19;

/// What HOTA is made of, for each threshold. Sums over clips are those of `TrackEval`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HotaCounts {
    /// Pairs that fit.
    matched: [u64; THRESHOLDS],
    /// Objects without a match.
    missed: [u64; THRESHOLDS],
    /// Tracks without a match.
    wrong: [u64; THRESHOLDS],
    /// The sum over matches of A.
    association: [f64; THRESHOLDS],
}

/// The figures, each in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Hota {
    /// Finding and following together.
    pub hota: f64,
    /// Finding: detection accuracy.
    pub det_a: f64,
    /// Following: association accuracy.
    pub ass_a: f64,
    /// As HOTA, but what is found beside the objects is not punished; `None` without objects.
    pub owta: Option<f64>,
}

impl HotaCounts {
    /// Counts. O(p) and one assignment a frame, O(r² c) for its r objects and c tracks, for p pairs in all frames.
    pub fn of(overlaps: &Overlaps) -> Self {
        let alignment = Alignment::of(overlaps);
        let mut counts = Self::default();
        let mut together: BTreeMap<(u16, u16), [u32; THRESHOLDS]> = BTreeMap::new();
        for frame in &overlaps.frames {
            let iou = frame.matrix(|pair| frame.iou(pair));
            let value = frame.matrix(|pair| alignment.of_pair(frame.ids(pair)) * frame.iou(pair));
            let (rows, columns) = (frame.objects.len(), frame.tracks.len());
            let mut matched = [0; THRESHOLDS];
            for (row, column) in maximize(&value, rows, columns) {
                let ids = (frame.objects[row].id, frame.tracks[column].id);
                let fit = iou[row * columns + column];
                for k in (0..THRESHOLDS).filter(|&k| fit >= threshold(k) - f64::EPSILON) {
                    matched[k] += 1;
                    together.entry(ids).or_default()[k] += 1;
                }
            }
            for (k, &n) in matched.iter().enumerate() {
                counts.matched[k] += n;
                counts.missed[k] += rows as u64 - n;
                counts.wrong[k] += columns as u64 - n;
            }
        }
        for (&ids, times) in &together {
            let either = alignment.frames_of_either(ids);
            for (sum, &n) in counts.association.iter_mut().zip(times) {
                let n = f64::from(n);
                *sum += n * n / (either - n).max(1.0);
            }
        }
        counts
    }

    /// The figures; `None` when there is neither an object nor a track.
    pub fn figures(&self) -> Option<Hota> {
        let there = self.matched[0] + self.missed[0];
        if there + self.wrong[0] == 0 {
            return None;
        }
        let mut sums = [0.0; 4];
        for k in 0..THRESHOLDS {
            let (matched, all) = (self.matched[k] as f64, (there + self.wrong[k]) as f64);
            let (det_a, ass_a) = (matched / all, self.association[k] / matched.max(1.0));
            let recall = matched / (there.max(1)) as f64;
            let values = [(det_a * ass_a).sqrt(), det_a, ass_a, (recall * ass_a).sqrt()];
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += value;
            }
        }
        let [hota, det_a, ass_a, owta] = sums.map(|sum| sum / THRESHOLDS as f64);
        Some(Hota { hota, det_a, ass_a, owta: (there > 0).then_some(owta) })
    }
}

/// As `numpy.arange(0.05, 0.99, 0.05)`.
fn threshold(k: usize) -> f64 {
    0.05 + k as f64 * 0.05
}

impl AddAssign for HotaCounts {
    fn add_assign(&mut self, other: Self) {
        for k in 0..THRESHOLDS {
            self.matched[k] += other.matched[k];
            self.missed[k] += other.missed[k];
            self.wrong[k] += other.wrong[k];
            self.association[k] += other.association[k];
        }
    }
}

/// How well pairs of object and track go together over the whole video.
struct Alignment {
    together: BTreeMap<(u16, u16), f64>,
    frames_of_object: BTreeMap<u16, f64>,
    frames_of_track: BTreeMap<u16, f64>,
}

impl Alignment {
    fn of(overlaps: &Overlaps) -> Self {
        let mut alignment = Self {
            together: BTreeMap::new(),
            frames_of_object: BTreeMap::new(),
            frames_of_track: BTreeMap::new(),
        };
        for frame in &overlaps.frames {
            for seen in &frame.objects {
                *alignment.frames_of_object.entry(seen.id).or_default() += 1.0;
            }
            for seen in &frame.tracks {
                *alignment.frames_of_track.entry(seen.id).or_default() += 1.0;
            }
            alignment.add_pairs(frame);
        }
        alignment
    }

    fn add_pairs(&mut self, frame: &FrameOverlap) {
        let mut of_object = vec![0.0; frame.objects.len()];
        let mut of_track = vec![0.0; frame.tracks.len()];
        for pair in &frame.common {
            of_object[pair.object] += frame.iou(pair);
            of_track[pair.track] += frame.iou(pair);
        }
        for pair in &frame.common {
            let iou = frame.iou(pair);
            let either = of_object[pair.object] + of_track[pair.track] - iou;
            *self.together.entry(frame.ids(pair)).or_default() += iou / either;
        }
    }

    /// Frames of the object plus frames of the track.
    fn frames_of_either(&self, (object, track): (u16, u16)) -> f64 {
        let frames = |of: &BTreeMap<u16, f64>, id| of.get(&id).copied().unwrap_or(0.0);
        frames(&self.frames_of_object, object) + frames(&self.frames_of_track, track)
    }

    fn of_pair(&self, ids: (u16, u16)) -> f64 {
        let together = self.together.get(&ids).copied().unwrap_or(0.0);
        together / (self.frames_of_either(ids) - together)
    }
}
