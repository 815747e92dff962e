//! The other objects of a frame that a change of parameters changes.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use crate::explain::belonging::Pixels;
use crate::raster::Raster;

/// An object stays if it and another one overlap with at least this IoU,
const SAME: f64 = 0.5;
/// and it is unchanged if the IoU is at least this: the flicker of a border is no change.
const UNALTERED: f64 = 0.9;

/// How many objects come, go and change, not counting those at the pixels of the question.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Others {
    /// Objects that were not there before.
    pub came: usize,
    /// Objects that are there no longer.
    pub went: usize,
    /// Objects that stay, but with an IoU below nine tenths.
    pub altered: usize,
}

impl Others {
    /// All that change.
    pub fn count(self) -> usize {
        self.came + self.went + self.altered
    }
}

/// Compares two label images of one size. An object stays if it and one of the other image have an IoU of at
/// least one half, as on the live page. It is changed if the IoU is below nine tenths. O(pixels · log
/// objects).
pub(super) fn changes(before: &Raster<u16>, after: &Raster<u16>, pixels: Pixels) -> Others {
    let mut sizes: [BTreeMap<u16, usize>; 2] = Default::default();
    let mut common: BTreeMap<[u16; 2], usize> = BTreeMap::new();
    let pairs: Vec<[u16; 2]> =
        before.as_slice().iter().zip(after.as_slice()).map(|(&a, &b)| [a, b]).collect();
    // Labels come in runs of pixels.
    for run in pairs.chunk_by(|a, b| a == b) {
        let pair = run[0];
        for (sizes, label) in sizes.iter_mut().zip(pair).filter(|(_, label)| *label > 0) {
            *sizes.entry(label).or_default() += run.len();
        }
        if pair[0] > 0 && pair[1] > 0 {
            *common.entry(pair).or_default() += run.len();
        }
    }
    let share = |(pair, shared): ([u16; 2], usize)| {
        let union = sizes[0][&pair[0]] + sizes[1][&pair[1]] - shared;
        (pair, shared as f64 / union as f64)
    };
    let same: Vec<([u16; 2], f64)> =
        common.into_iter().map(share).filter(|&(_, share)| share >= SAME).collect();
    let kept = [0, 1].map(|side| same.iter().map(|(pair, _)| pair[side]).collect::<BTreeSet<u16>>());
    let asked = [before, after].map(|labels| -> Vec<u16> {
        let asked = [Some(pixels.pixel), pixels.with].into_iter().flatten();
        asked.filter_map(|[u, v]| labels.get(u, v).copied()).collect()
    });
    let [went, came] = [0, 1].map(|side| {
        let is_other = |label: &&u16| !asked[side].contains(label) && !kept[side].contains(label);
        sizes[side].keys().filter(is_other).count()
    });
    let is_altered = |&&([was, is], share): &&([u16; 2], f64)| {
        share < UNALTERED && !asked[0].contains(&was) && !asked[1].contains(&is)
    };
    let altered = same.iter().filter(is_altered).count();
    Others { came, went, altered }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_others_count_and_numbers_do_not_matter() {
        let raster = |labels: [u16; 12]| Raster::from_vec(12, 1, labels.to_vec()).unwrap();
        let before = raster([1, 1, 2, 2, 0, 3, 3, 3, 4, 0, 0, 0]);
        // 1 and 2 became 5; 3 is 1 now and lost a pixel; 4 went; something came.
        let after = raster([5, 5, 5, 5, 0, 1, 1, 0, 0, 0, 2, 2]);
        let of = |u: usize, with: Option<usize>| {
            changes(&before, &after, Pixels { pixel: [u, 0], with: with.map(|u| [u, 0]) })
        };
        assert_eq!(of(0, Some(2)), Others { came: 1, went: 1, altered: 1 }, "3 lost a pixel of three");
        assert_eq!(of(8, None), Others { came: 1, went: 0, altered: 3 }, "1 and 2 share half with 5 each");
        assert_eq!(of(10, None), Others { came: 0, went: 1, altered: 3 });
        assert_eq!(changes(&before, &before, Pixels { pixel: [0, 0], with: None }), Others::default());
    }
}
