//! Which track is seen at each pixel.

use std::collections::{BTreeMap, BTreeSet};

use crate::associate::Overlap;
use crate::hand::HandColors;
use crate::ingredient::Ingredient;
use crate::knowledge::pair;
use crate::memory::{Look, Memory};
use crate::scene::Key;
use crate::segment::{Measure, is_looked_at};
use crate::track::Track;

/// A track that no segment shows is held if its motion fits this well, or while it rests, for this long (s).
const HELD_FIT: f64 = 0.5;
const HELD_S: f64 = 1.0;
/// Little of a resting thing is this share of its pixels. Of what is left of it, at least this share stands
/// before the rested scene.
const LITTLE: f64 = 0.25;
const LEAST_IN_FRONT: f64 = 0.3;
/// A piece has at least this many of the sampled pixels.
const LEAST_PIECE: usize = 9;

/// Whether these sampled pixels are enough for a piece.
pub(crate) fn is_piece(pixels: &[usize]) -> bool {
    pixels.len() >= LEAST_PIECE
}

impl Memory {
    /// Writes which track is seen at each pixel. A segment that holds several tracks which were seen to move
    /// apart is divided by where they should be.
    pub(crate) fn write_seen(&mut self, look: &mut Look<'_>, predicted: &[Key], overlap: &Overlap) {
        let parted = self.parted(&look.keys, overlap);
        let mut pieces: BTreeMap<Key, Vec<usize>> = BTreeMap::new();
        let width = look.view.size.0;
        let hand = HandColors::of(look.view, predicted, &self.agents.region, &self.tracks);
        for (pixel, &label) in look.labels.iter().enumerate() {
            let Some(k) = usize::from(label).checked_sub(1) else {
                self.scene.seen[pixel] = 0;
                continue;
            };
            let mut key = look.keys[k];
            if parted.get(&k).is_some_and(|others| others.contains(&predicted[pixel])) {
                key = predicted[pixel];
            }
            if self
                .tracks
                .get(&key)
                .is_some_and(|track| hand.is_of_hand(pixel, track, predicted[pixel] == key))
            {
                self.scene.seen[pixel] = 0;
                continue;
            }
            if parted.contains_key(&k) && is_looked_at(pixel, width) {
                pieces.entry(key).or_default().push(pixel);
            }
            self.scene.seen[pixel] = key;
        }
        if self.has(Ingredient::Holding) {
            self.hold(look, predicted, overlap, &hand, &mut pieces);
        }
        if self.has(Ingredient::Finding) {
            self.find_in_hands(look, &hand, &mut pieces);
        }
        self.learn_surfaces(look.view, &hand);
        self.measure_pieces(look, pieces);
    }

    /// The other tracks that each segment holds and that are to be kept apart. Joins those that turn out to
    /// be one with the track of the segment.
    fn parted(&mut self, keys: &[Key], overlap: &Overlap) -> BTreeMap<usize, BTreeSet<Key>> {
        let mut parted = BTreeMap::new();
        if !self.has(Ingredient::Knowledge) {
            return parted;
        }
        self.knowledge.begin(self.pace);
        for (k, &owner) in keys.iter().enumerate() {
            let is_seen = |key: Key| keys.contains(&key);
            let (tracks, touched) = (&self.tracks, &self.touched);
            let (apart, one) = self.knowledge.held(k, owner, overlap, tracks, touched, is_seen);
            if !apart.is_empty() {
                parted.insert(k, apart.into_iter().collect());
            }
            for part in one {
                let touched = self.touched.contains(&pair(owner, part));
                if touched || self.tracks[&part].part_from() == Some(owner) {
                    self.join(owner, part);
                } else {
                    self.merge(owner, part);
                }
            }
        }
        parted
    }

    /// Makes segments of their own from pieces of segments and from tracks that are held without a segment.
    fn measure_pieces(&self, look: &mut Look<'_>, pieces: BTreeMap<Key, Vec<usize>>) {
        let measure = Measure {
            view: look.view,
            changed: look.changed,
            scene: &self.scene,
            agents: &self.agents,
            place: &look.place,
        };
        for (key, pixels) in pieces.into_iter().filter(|(_, pixels)| is_piece(pixels)) {
            let segment = measure.segment(&pixels);
            match look.keys.iter().position(|&known| known == key) {
                Some(k) => look.segments[k] = segment,
                None => {
                    look.segments.push(segment);
                    look.keys.push(key);
                }
            }
        }
    }

    /// Keeps known things that no segment shows where their motion, or their rest, places them, if the depth
    /// agrees. A thing that a hand carries has no support, so the frame alone may take it for no object.
    fn hold(
        &mut self,
        look: &Look<'_>,
        predicted: &[Key],
        overlap: &Overlap,
        hand: &HandColors<'_>,
        pieces: &mut BTreeMap<Key, Vec<usize>>,
    ) {
        let is_held = |key: Key| {
            let Some(track) = self.tracks.get(&key) else { return false };
            let is_seen = look.keys.contains(&key);
            let moves = track.motion.as_ref().is_some_and(|motion| motion.fit > HELD_FIT);
            let rests = track.rest_s > 0.0 && track.held_frames < self.pace.frames(HELD_S);
            let is_handled = self.happenings.is_handled(key);
            track.rest.is_some()
                && !track.is_agent_part()
                && track.part_of.is_none()
                && !is_seen
                && (moves || rests || is_handled)
        };
        let held: BTreeSet<Key> = overlap.predicted.keys().copied().filter(|&key| is_held(key)).collect();
        if held.is_empty() {
            return;
        }
        let mut shown: BTreeMap<Key, Vec<usize>> = BTreeMap::new();
        for (pixel, &key) in predicted.iter().enumerate().filter(|(_, key)| held.contains(key)) {
            let is_there = self.tracks[&key].is_moving || self.scene.is_as_before(look.view, pixel);
            if self.is_free(pixel) && is_there && !hand.is_of_hand(pixel, &self.tracks[&key], true) {
                shown.entry(key).or_default().push(pixel);
            }
        }
        for (key, pixels) in shown {
            if !self.is_shadow(key, &pixels, look) {
                self.show(key, &pixels, pieces);
            }
        }
        for key in held {
            if let Some(track) = self.tracks.get_mut(&key) {
                track.held_frames += 1;
            }
        }
    }

    /// Whether no thing is seen at a pixel.
    pub(crate) fn is_free(&self, pixel: usize) -> bool {
        let owner = self.scene.seen[pixel];
        owner == 0 || self.tracks.get(&owner).is_some_and(Track::is_agent_part)
    }

    /// Shows a track at pixels that no segment gives it, as a piece of its own.
    pub(crate) fn show(&mut self, key: Key, pixels: &[usize], pieces: &mut BTreeMap<Key, Vec<usize>>) {
        let width = self.scene.size().0;
        for &pixel in pixels {
            self.scene.seen[pixel] = key;
            if is_looked_at(pixel, width) {
                pieces.entry(key).or_default().push(pixel);
            }
        }
    }

    /// Whether what seems to be left of a thing that was taken away is a shadow that moves with the hand:
    /// little is left, and most of it does not stand before the rested scene.
    fn is_shadow(&self, key: Key, pixels: &[usize], look: &Look<'_>) -> bool {
        let track = &self.tracks[&key];
        let in_front = pixels.iter().filter(|&&pixel| self.scene.is_in_front(look.view, pixel)).count();
        let is_little = track.rest.is_some_and(|rest| (pixels.len() as f64) < LITTLE * rest.px as f64);
        track.is_away() && is_little && (in_front as f64) < LEAST_IN_FRONT * pixels.len() as f64
    }
}
