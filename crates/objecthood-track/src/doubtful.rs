//! Refused hypotheses that show a known thing: a thing in a hand stands on nothing, so a frame alone takes it
//! for no object.

use std::collections::{BTreeMap, BTreeSet};

use objecthood::{Observer, Output, Params};

use crate::associate::{HOLDS, Overlap};
use crate::memory::Memory;
use crate::scene::Key;
use crate::segment::is_looked_at;
use crate::track::Track;

/// Least overlap (intersection over union) of a hypothesis with the predicted mask of a thing. It is higher
/// than for objects, because a ball in a cup is a part of the cup's predicted mask.
const RECOGNISED_IOU: f64 = 0.5;

/// Collects the pixels of each hypothesis that is not an object.
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
    /// Labels the hypotheses that show known things which move or are handled. Labels continue from `count`;
    /// returns the new count. A thing is shown by the hypothesis that overlaps most with its predicted mask,
    /// unless objects cover most of that mask. O(n) if anything moves.
    pub(crate) fn recognise(
        &self,
        hypotheses: &[Vec<usize>],
        predicted: &[Key],
        labels: &mut [u16],
        mut count: usize,
    ) -> usize {
        let is_away = |key: Key, track: &Track| self.happenings.is_handled(key) || track.is_moving;
        let may_be =
            |key: Key, track: &Track| track.is_known() && track.is_confirmed() && is_away(key, track);
        let open = self.tracks.iter().filter(|&(&key, track)| may_be(key, track));
        let mut expected: BTreeMap<Key, (usize, usize)> = open.map(|(&key, _)| (key, (0, 0))).collect();
        if hypotheses.is_empty() || expected.is_empty() {
            return count;
        }
        for (key, &label) in predicted.iter().zip(labels.iter()) {
            if let Some((all, covered)) = expected.get_mut(key) {
                *all += 1;
                *covered += usize::from(label > 0);
            }
        }
        expected.retain(|_, (all, covered)| (*covered as f64) < HOLDS * *all as f64);
        let predicted_px = expected.iter().map(|(&key, &(all, _))| (key, all)).collect();
        let mut overlap = Overlap { predicted: predicted_px, ..Overlap::default() };
        for (k, pixels) in hypotheses.iter().enumerate() {
            for key in pixels.iter().map(|&pixel| predicted[pixel]).filter(|key| expected.contains_key(key)) {
                *overlap.common.entry((k, key)).or_default() += 1;
            }
        }
        let mut best: BTreeMap<Key, (f64, usize)> = BTreeMap::new();
        for &(k, key) in overlap.common.keys() {
            let iou = overlap.iou(k, hypotheses[k].len(), key);
            if iou > RECOGNISED_IOU && best.get(&key).is_none_or(|&(known, _)| iou > known) {
                best.insert(key, (iou, k));
            }
        }
        let shown: BTreeSet<usize> = best.values().map(|&(_, k)| k).collect();
        let width = self.scene.size().0;
        for k in shown.into_iter().take(usize::from(u16::MAX) - count) {
            // Pixels that are predicted to show another thing are not taken from it.
            let is_its_own = |key: Key| {
                let is_part = self.tracks.get(&key).is_none_or(Track::is_agent_part);
                is_part || best.get(&key).is_some_and(|&(_, other)| other == k)
            };
            let is_free = |&pixel: &usize| labels[pixel] == 0 && is_its_own(predicted[pixel]);
            let free: Vec<usize> = hypotheses[k].iter().copied().filter(is_free).collect();
            if free.iter().any(|&pixel| is_looked_at(pixel, width)) {
                count += 1;
                free.into_iter().for_each(|pixel| labels[pixel] = count as u16);
            }
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::segment::Segment;

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
        assert_eq!(labels(1..7, true, 1), [0, 2, 1, 2, 2, 2, 2, 0, 0, 0], "an object has a part of it");
        assert_eq!(labels(5..9, true, 3), [0, 0, 1, 1, 1, 0, 0, 0, 0, 0], "an object has most of it");
    }
}
