//! Hypotheses that a frame alone takes for no objects, and that show a known thing: what a hand lifts stands on nothing.

use std::collections::BTreeMap;

use objecthood::{Observer, Output, Params};

use crate::associate::{HOLDS, LEAST_IOU};
use crate::memory::Memory;
use crate::scene::Key;

/// The pixels of every hypothesis of a frame that is no object.
pub(crate) struct Doubtful<'a> {
    params: &'a Params,
    pub(crate) hypotheses: Vec<Vec<usize>>,
}

impl<'a> Doubtful<'a> {
    pub(crate) fn new(params: &'a Params) -> Self {
        Self { params, hypotheses: Vec::new() }
    }
}

impl Observer for Doubtful<'_> {
    fn observe(&mut self, output: Output<'_>) {
        let Output::Hypotheses(hypotheses) = output else { return };
        let Params { method, objectness, .. } = self.params;
        if !objectness.every_hypothesis {
            let doubtful = hypotheses.iter().filter(|hypothesis| !hypothesis.is_object(*method, objectness));
            self.hypotheses = doubtful.map(|hypothesis| hypothesis.pixels.clone()).collect();
        }
    }
}

impl Memory {
    /// Labels the hypotheses that show known things that move or are handled, counted on from `count`; gives the new count. A known thing is shown by the hypothesis that
    /// overlaps most with where the thing should be seen, unless objects cover most of that. O(n) if there are hypotheses.
    pub(crate) fn recognise(
        &self,
        hypotheses: &[Vec<usize>],
        predicted: &[Key],
        labels: &mut [u16],
        mut count: usize,
    ) -> usize {
        if hypotheses.is_empty() {
            return count;
        }
        let mut expected: BTreeMap<Key, (usize, usize)> = BTreeMap::new();
        for (&key, &label) in predicted.iter().zip(labels.iter()).filter(|&(&key, _)| key > 0) {
            let (all, covered) = expected.entry(key).or_default();
            *all += 1;
            *covered += usize::from(label > 0);
        }
        let is_open = |key: Key, &(all, covered): &(usize, usize)| {
            let track = self.tracks.get(&key);
            let is_known = track.is_some_and(|track| track.is_known() && track.is_confirmed());
            let is_away = self.happenings.is_handled(key) || track.is_some_and(|track| track.is_moving);
            is_known && is_away && (covered as f64) < HOLDS * all as f64
        };
        expected.retain(|&key, counts| is_open(key, counts));
        let mut best: BTreeMap<Key, (f64, usize)> = BTreeMap::new();
        for (k, pixels) in hypotheses.iter().enumerate() {
            let mut common: BTreeMap<Key, usize> = BTreeMap::new();
            pixels.iter().for_each(|&pixel| *common.entry(predicted[pixel]).or_default() += 1);
            for (key, common) in common {
                let Some(&(all, _)) = expected.get(&key) else { continue };
                let iou = common as f64 / (all + pixels.len() - common) as f64;
                let known = best.entry(key).or_insert((LEAST_IOU, usize::MAX));
                if iou > known.0 {
                    *known = (iou, k);
                }
            }
        }
        let mut shown: Vec<usize> =
            best.into_values().filter(|&(_, k)| k < usize::MAX).map(|(_, k)| k).collect();
        shown.sort_unstable();
        shown.dedup();
        for k in shown.into_iter().take(usize::from(u16::MAX) - count) {
            count += 1;
            for &pixel in &hypotheses[k] {
                if labels[pixel] == 0 {
                    labels[pixel] = count as u16;
                }
            }
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::segment::Segment;
    use crate::track::Track;

    /// Rows of ten pixels, four of them with the thing 1; gives the labels after a hypothesis of these columns was looked at.
    fn labels(columns: std::ops::Range<usize>, is_moving: bool, object_columns: usize) -> Vec<u16> {
        const SIZE: (usize, usize) = (10, 4);
        let mut memory = Memory::new(SIZE, 0.0, [].into());
        let sample = memory.sample(&Segment::default(), &[]);
        let mut track = Track::new(&Segment::default(), sample, true);
        track.settle();
        track.is_moving = is_moving;
        memory.tracks.insert(1, track);
        let pixels = || (0..SIZE.0 * SIZE.1).map(|pixel| pixel % SIZE.0);
        let predicted: Vec<Key> = pixels().map(|u| u32::from((2..6).contains(&u))).collect();
        let mut labels: Vec<u16> =
            pixels().map(|u| u16::from((2..2 + object_columns).contains(&u))).collect();
        let is_inside = |&pixel: &usize| columns.contains(&(pixel % SIZE.0));
        let hypothesis: Vec<usize> = (0..labels.len()).filter(is_inside).collect();
        let count = memory.recognise(&[hypothesis], &predicted, &mut labels, 1);
        assert_eq!(count, usize::from(*labels.iter().max().unwrap_or(&0)).max(1));
        labels[..SIZE.0].to_vec()
    }

    #[test]
    fn what_moves_is_recognised_where_a_frame_alone_finds_no_object() {
        assert_eq!(labels(3..7, true, 0), [0, 0, 0, 2, 2, 2, 2, 0, 0, 0]);
        assert_eq!(labels(3..7, false, 0), [0; 10], "at rest the frame decides");
        assert_eq!(labels(5..9, true, 0), [0; 10], "elsewhere");
        assert_eq!(labels(0..10, true, 1), [2, 2, 1, 2, 2, 2, 2, 2, 2, 2], "an object has a part of it");
        assert_eq!(labels(5..9, true, 3), [0, 0, 1, 1, 1, 0, 0, 0, 0, 0], "an object has most of it");
    }
}
