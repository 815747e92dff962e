//! Things that were cut into pieces by what stood before them, and are finally seen whole (ours).

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::bits::Bits;
use crate::happening::{Happening, Other};
use crate::memory::{Look, Memory};
use crate::scene::Key;
use crate::segment::STRIDE_PX;
use crate::tracked::EventKind;

/// A piece is at least this share of what is seen of a thing.
const LEAST_PIECE: f64 = 0.1;
/// A thing is cut if it was seen in pieces for this long (s) within its first time (s).
const CUT_S: f64 = 0.1;
const FIRST_S: f64 = 0.5;
/// It is whole once it has been seen in one piece for this long (s), and is this many times as large as ever
/// before.
const WHOLE_S: f64 = 0.3;
const LARGER: f64 = 1.1;

/// Whether a thing has been seen whole.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Sight {
    /// It was cut into pieces in this many frames; the most of it that was seen (m², as if it faced the
    /// camera).
    Cut { frames: usize, most_m2: f64 },
    /// It was cut, and has been in one piece since this frame and time (s).
    InOne { most_m2: f64, frame: u64, time_s: f64 },
    /// It was seen whole, or it moves.
    Whole,
}

impl Sight {
    /// Before anything is seen.
    pub(crate) const NEW: Self = Self::Cut { frames: 0, most_m2: 0.0 };

    /// The state after a frame that shows a thing in this many pieces. `cut_frames`: the number of frames in
    /// which it has to be cut.
    fn after(self, pieces: usize, seen_m2: f64, (frame, time_s): (u64, f64), cut_frames: usize) -> Self {
        let is_larger = |most_m2: f64| seen_m2 > LARGER * most_m2;
        match self {
            // A thing of which a hand hides a piece is also in one piece, but less of it is seen.
            Self::Cut { frames, most_m2 } if pieces == 1 && frames >= cut_frames && is_larger(most_m2) => {
                Self::InOne { most_m2, frame, time_s }
            }
            // What cuts it may move to its end, and show more and more of it.
            Self::Cut { frames, most_m2 } if pieces > 1 || frames < cut_frames => {
                Self::Cut { frames: frames + usize::from(pieces > 1), most_m2: most_m2.max(seen_m2) }
            }
            Self::InOne { most_m2, .. } if pieces > 1 => {
                Self::Cut { frames: cut_frames, most_m2: most_m2.max(seen_m2) }
            }
            Self::InOne { most_m2, .. } if !is_larger(most_m2) => Self::Cut { frames: cut_frames, most_m2 },
            known => known,
        }
    }

    fn is_cut(self, cut_frames: usize) -> bool {
        match self {
            Self::Cut { frames, .. } => frames >= cut_frames,
            Self::InOne { .. } => true,
            Self::Whole => false,
        }
    }
}

impl Memory {
    /// Reports things that were cut from the first frame on and are seen whole. O(n).
    pub(crate) fn tell_wholes(&mut self, look: &Look<'_>) {
        let now = (self.frame, self.stamp_s);
        let (cut_frames, whole_frames) = (self.pace.frames(CUT_S), self.pace.frames(WHOLE_S) as u64);
        let mut area_m2: BTreeMap<Key, f64> = BTreeMap::new();
        for (&key, segment) in look.keys.iter().zip(&look.segments) {
            *area_m2.entry(self.root(key)).or_default() += segment.area_m2;
        }
        for (key, shown) in self.shown_of_open(look.view.size) {
            let least = LEAST_PIECE * shown.count() as f64;
            let pieces = shown.components().iter().filter(|piece| piece.len() as f64 > least).count();
            let seen_m2 = area_m2.get(&key).copied().unwrap_or(0.0);
            let Some(track) = self.tracks.get_mut(&key) else { continue };
            track.sight = track.sight.after(pieces, seen_m2, now, cut_frames);
            let is_first = self.stamp_s - track.first.stamp_s < FIRST_S;
            if track.is_moving
                || self.happenings.is_lifted(key)
                || !is_first && !track.sight.is_cut(cut_frames)
            {
                track.sight = Sight::Whole;
            }
            let Sight::InOne { most_m2, frame, time_s } = track.sight else { continue };
            if self.frame - frame >= whole_frames {
                track.sight = Sight::Whole;
                let [was, is] = [most_m2, seen_m2].map(|area_m2| 1e4 * area_m2);
                let evidence = format!("it was cut in pieces of {was:.0} cm², and is one of {is:.0} cm²");
                self.happenings.tell(Happening {
                    frame,
                    time_s,
                    kind: EventKind::Merged,
                    object: key,
                    other: Other::Nobody,
                    span: None,
                    confidence: 0.9,
                    evidence,
                });
            }
        }
    }

    /// Where each thing is seen that is still waiting to be seen whole, on every second column and row. O(n).
    fn shown_of_open(&self, size: (usize, usize)) -> BTreeMap<Key, Bits> {
        let is_open = |key: Key| {
            self.tracks.get(&key).is_some_and(|track| {
                track.last.frame == self.frame && !track.is_agent_part() && track.sight != Sight::Whole
            })
        };
        let keys = self.tracks.keys().copied();
        let owners: BTreeMap<Key, Key> =
            keys.map(|key| (key, self.root(key))).filter(|&(_, whole)| is_open(whole)).collect();
        let mut shown = BTreeMap::new();
        if owners.is_empty() {
            return shown;
        }
        let half = (size.0.div_ceil(STRIDE_PX), size.1.div_ceil(STRIDE_PX));
        for v in 0..half.1 {
            for u in 0..half.0 {
                let key = self.scene.seen[STRIDE_PX * (v * size.0 + u)];
                if key > 0
                    && let Some(&whole) = owners.get(&key)
                {
                    shown.entry(whole).or_insert_with(|| Bits::none(half)).insert(v * half.0 + u);
                }
            }
        }
        shown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The state after frames with these numbers of pieces and areas (m²).
    fn after(frames: &[(usize, f64)]) -> Sight {
        (0..).zip(frames).fold(Sight::NEW, |sight, (frame, &(pieces, seen_m2))| {
            sight.after(pieces, seen_m2, (frame, 0.0), 3)
        })
    }

    #[test]
    fn what_was_cut_is_whole_when_more_of_it_is_seen_in_one() {
        let cut = [(1, 0.300), (2, 0.500), (2, 0.510), (2, 0.505)];
        let then = |frames: &[(usize, f64)]| after(&[&cut, frames].concat());
        assert_eq!(then(&[]), Sight::Cut { frames: 3, most_m2: 0.510 });
        assert_eq!(then(&[(1, 0.800)]), Sight::InOne { most_m2: 0.510, frame: 4, time_s: 0.0 });
        assert_eq!(then(&[(1, 0.300)]), Sight::Cut { frames: 3, most_m2: 0.510 }, "a hand hides a piece");
        assert_eq!(then(&[(1, 0.800), (2, 0.600)]), Sight::Cut { frames: 3, most_m2: 0.600 });
    }

    #[test]
    fn a_hand_that_passes_before_a_thing_does_not_make_it_whole() {
        let sight = after(&[(1, 0.800), (2, 0.500), (2, 0.500), (2, 0.500), (1, 0.800)]);
        assert_eq!(sight, Sight::Cut { frames: 3, most_m2: 0.800 });
    }
}
