//! Decides which track each segment shows, and which segments show new tracks.

use std::collections::BTreeMap;

use objecthood::Discovery;

use crate::associate::{OWN_LOOK, Overlap, by_overlap, find_again};
use crate::bits::Bits;
use crate::camera::Place;
use crate::face::unite;
use crate::ingredient::Ingredient;
use crate::memory::{Look, Memory};
use crate::moved_part::BELONGED;
use crate::rested::Beside;
use crate::scene::Key;
use crate::segment::{Measure, Segment, labels, pixels_by_label, segments};
use crate::surface::Surface;
use crate::track::Track;
use crate::view::View;

/// A segment that has always been there shows the rested scene in this share of its pixels.
const IN_PLACE: f64 = 0.8;
/// A segment was there from the beginning if it is first separated from its surroundings within this time (s)
/// and rested there before.
const BEGINNING_S: f64 = 0.5;
/// An agent is beside a thing if it is this close (px at VGA size).
const BESIDE_PX: f64 = 16.0;
/// A part that came off a thing has the colours of the thing in this share of its pixels.
const LEAST_OF_ITS_COLORS: f64 = 0.5;

impl Memory {
    /// Decides which track each segment shows, and writes the tracks that are seen to the scene. `doubtful`:
    /// the pixels of refused hypotheses.
    pub(crate) fn identify<'a>(
        &mut self,
        (found, doubtful): (&'a Discovery, &[Vec<usize>]),
        view: &'a View,
        changed: &'a Bits,
        place: Place,
        predicted: &[Key],
    ) -> Look<'a> {
        let measure = Measure { view, changed, scene: &self.scene, agents: &self.agents, place: &place };
        let (mut labels, count) = labels(found, view, &self.scene, &self.agents);
        let finds = self.has(Ingredient::Finding);
        let count = if finds { self.recognise(doubtful, predicted, &mut labels, count) } else { count };
        let mut segments = segments(&labels, count, &measure);
        let mut overlap = self.overlap(&labels, view, predicted);
        let (mut cut, mut moved, mut inside) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
        if finds {
            self.part_uncovered(&mut labels, &mut segments, &overlap, predicted, &measure);
            cut = self.part_opened(&mut labels, &mut segments, &overlap, &measure);
            if !cut.is_empty() {
                overlap = self.overlap(&labels, view, predicted);
            }
        }
        let mut tracks_of = by_overlap(&segments, &self.tracks, &overlap, self.stamp_s);
        if finds {
            let beside = self.beside_rest(&segments, &labels, view);
            inside = self.inside(&beside);
            let expected = tracks_of.clone();
            find_again(&segments, &self.tracks, &overlap, &inside, (self.stamp_s, self.pace), &mut tracks_of);
            let found = tracks_of.iter().filter(|key| !expected.contains(key));
            for key in found.flatten() {
                // It is not where its surface was expected.
                self.tracks.entry(*key).and_modify(|track| track.surface = Surface::default());
            }
            moved = self.stay_with_the_rest(&segments, &overlap, &beside, &mut tracks_of);
        }
        self.take_over(&segments, &tracks_of, &overlap);
        let is_part = |k: usize| cut.contains_key(&k) || moved.contains_key(&k) || inside.contains_key(&k);
        let is_open = |&k: &usize| finds && tracks_of[k].is_none() && !is_part(k);
        let open: Vec<usize> = (0..segments.len()).filter(is_open).collect();
        let pixels = match open.is_empty() {
            true => Vec::new(),
            false => pixels_by_label(&labels, view.size, segments.len()),
        };
        let faces = self.other_faces(&open, &segments, (&labels, &pixels), (view, predicted), &tracks_of);
        let resting = self.as_they_rested(&open, &pixels, view, &tracks_of);
        let mut keys = Vec::new();
        let mut fresh = Vec::new();
        for (k, segment) in segments.iter().enumerate() {
            let face = || faces.get(&k).and_then(|&known| tracks_of[known]);
            let rested = || resting.get(&k).copied();
            let fragment = || self.fragment_of(k, segment, &overlap, &tracks_of);
            let whole = tracks_of[k].or_else(face).or_else(rested).or_else(fragment);
            keys.push(whole.unwrap_or_else(|| {
                fresh.push((k, self.next));
                self.next += 1;
                self.next - 1
            }));
        }
        self.vote_on_wholes(&segments, &keys, &fresh, &overlap);
        self.begin_tracks(&fresh, (&segments, &labels), &inside, &overlap, view);
        // A part that was cut off may show a hand that is known.
        cut.retain(|k, _| fresh.iter().any(|(known, _)| known == k));
        for (k, whole) in cut.into_iter().chain(moved) {
            self.move_off(keys[k], whole);
        }
        let measure = Measure { view, changed, scene: &self.scene, agents: &self.agents, place: &place };
        unite(&faces, (&mut labels, &mut segments, &mut overlap), &measure);
        let mut look = Look { found, labels, view, changed, place, segments, keys };
        self.settle_doubts(&look);
        self.write_seen(&mut look, predicted, &overlap);
        look
    }

    /// Makes a track for each fresh segment. `inside`: segments that lie inside an open thing.
    fn begin_tracks(
        &mut self,
        fresh: &[(usize, Key)],
        (segments, labels): (&[Segment], &[u16]),
        inside: &BTreeMap<usize, Key>,
        overlap: &Overlap,
        view: &View,
    ) {
        for &(k, key) in fresh {
            let sample = self.sample(&segments[k], &[]);
            // Parts of an arm may be separated later.
            let begins = self.frame <= self.pace.frames(BEGINNING_S) as u64;
            let was_in_view = self.frame == 0 || begins && segments[k].in_place > IN_PLACE;
            let mut track = Track::new(&segments[k], sample, was_in_view);
            track.is_doubted = self.was_no_thing(k, &segments[k], labels, view);
            track.was_doubted = track.is_doubted && !self.agents.all.is_empty();
            track.inside_of = inside.get(&k).copied();
            track.came_off =
                if track.inside_of.is_none() { self.came_off(k, &segments[k], overlap) } else { None };
            let is_at_agent = segments[k].of_agent > 0.5;
            if is_at_agent && track.came_off.is_some_and(|thing| self.was_of(k, &segments[k], thing, overlap))
            {
                (track.is_off_thing, track.agent_score) = (true, 0);
            }
            if track.inside_of.or(track.came_off).is_some() {
                (track.was_there_first, track.told_appeared) = (true, true);
            }
            self.tracks.insert(key, track);
        }
    }

    /// Updates which things are doubted. A doubt lasts while an agent is beside the thing and the thing stays
    /// where it is: the leg of a table looks like a thing while an arm hides where it meets the table. O(n)
    /// if there are doubts.
    fn settle_doubts(&mut self, look: &Look<'_>) {
        let doubted: Vec<usize> =
            (0..look.keys.len()).filter(|&k| self.tracks[&look.keys[k]].is_doubted).collect();
        if doubted.is_empty() {
            return;
        }
        let beside = self.agents.region.dilated(look.view.length_px(BESIDE_PX));
        let pixels = pixels_by_label(&look.labels, look.view.size, look.segments.len());
        for k in doubted {
            let is_beside = pixels[k].iter().any(|&pixel| beside.has(pixel));
            let is_in_place = look.segments[k].in_place > IN_PLACE;
            self.tracks.entry(look.keys[k]).and_modify(|track| {
                track.is_doubted = is_beside && is_in_place && !track.is_moving;
            });
        }
    }

    /// A track shows a part of a known thing that was moved.
    fn move_off(&mut self, part: Key, whole: Key) {
        let Some(mut known) = self.tracks.remove(&whole) else { return };
        if let Some(track) = self.tracks.get_mut(&part).filter(|track| track.moved_off.is_none()) {
            track.move_off(whole, &mut known);
        }
        self.tracks.insert(whole, known);
    }

    /// A younger track showed a segment that now turns out to show an older one: the two were one all along.
    fn take_over(&mut self, segments: &[Segment], tracks_of: &[Option<Key>], overlap: &Overlap) {
        for (k, owner) in tracks_of.iter().enumerate() {
            let Some(owner) = *owner else { continue };
            let parts = overlap.common.range((k, 0)..=(k, Key::MAX));
            let Some((&(_, young), &common)) = parts.max_by_key(|&(_, &common)| common) else { continue };
            let was_seen_later = match (self.tracks.get(&young), self.tracks.get(&owner)) {
                (Some(young), Some(old)) => young.first.frame > old.last.frame && young.part_of.is_none(),
                _ => false,
            };
            if was_seen_later && 2 * common > segments[k].px && !tracks_of.contains(&Some(young)) {
                self.join(owner, young);
            }
        }
    }

    /// Counts the pixels that segments and predicted masks have in common.
    fn overlap(&self, labels: &[u16], view: &View, predicted: &[Key]) -> Overlap {
        let mut overlap = Overlap::default();
        let mut run: (Key, u16, usize, usize) = (0, 0, 0, 0);
        let mut flush = |(key, label, px, visible): (Key, u16, usize, usize)| {
            if key > 0 && px > 0 {
                *overlap.predicted.entry(key).or_default() += visible;
                if label > 0 {
                    *overlap.common.entry((usize::from(label) - 1, key)).or_default() += px;
                }
            }
        };
        for (pixel, (&key, &label)) in predicted.iter().zip(labels).enumerate() {
            // Behind a hand nothing is expected. A flying thing may be far from where it was.
            let is_behind = self.agents.region.has(pixel) && self.scene.is_behind(view, pixel);
            let key = if is_behind { 0 } else { key };
            if (key, label) != (run.0, run.1) {
                flush(run);
                run = (key, label, 0, 0);
            }
            run.2 += 1;
            // What stands before the track now hides it there.
            run.3 += usize::from(key > 0 && (label > 0 || !self.scene.is_covered(view, pixel)));
        }
        flush(run);
        overlap
    }

    /// Whether a fresh segment shows something that was there before, where no thing rested. O(n) if it does
    /// not move.
    fn was_no_thing(&self, k: usize, segment: &Segment, labels: &[u16], view: &View) -> bool {
        if segment.in_place <= IN_PLACE {
            return false;
        }
        let own = |&pixel: &usize| usize::from(labels[pixel]) == k + 1;
        let is_known = |&pixel: &usize| matches!(self.rested.at(pixel, view), Some((_, Beside::There)));
        let known = (0..labels.len()).filter(own).filter(is_known).count();
        (known as f64) < (1.0 - IN_PLACE) * segment.px as f64
    }

    /// Whether most of a fresh segment was part of a known thing that nobody holds in the air, and has the
    /// colours of that thing (unlike a hand at the thing). Of a carried thing, fingers show pieces.
    fn was_of(&self, k: usize, segment: &Segment, thing: Key, overlap: &Overlap) -> bool {
        let common = overlap.common.get(&(k, thing)).copied().unwrap_or(0);
        let looks_like_it = segment.look.share_of(&self.tracks[&thing].look);
        let is_of_it = common as f64 > BELONGED * segment.px as f64;
        is_of_it && !self.happenings.is_lifted(thing) && looks_like_it.is_some_and(|share| share > OWN_LOOK)
    }

    /// The track to which most pixels of a fresh segment belonged while it rested. A segment of other colours
    /// stands before the track, as a hand does.
    pub(crate) fn came_off(&self, k: usize, segment: &Segment, overlap: &Overlap) -> Option<Key> {
        let parts = overlap.common.range((k, 0)..=(k, Key::MAX));
        let (&(_, key), &common) =
            parts.max_by_key(|&(&(_, key), &common)| (common, std::cmp::Reverse(key)))?;
        let track = self.tracks.get(&key)?;
        let looks_like_it =
            segment.look.share_of(&track.look).is_none_or(|share| share >= LEAST_OF_ITS_COLORS);
        let is_known = track.rest.is_some() && !track.is_agent_part() && looks_like_it;
        let predicted = overlap.predicted.get(&key).copied().unwrap_or(0);
        (is_known && common as f64 > 0.1 * predicted as f64).then_some(key)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use objecthood::{Camera, Frame, Raster};

    use super::*;

    const YELLOW: [u8; 3] = [200, 190, 30];
    const GREY: [u8; 3] = [110, 110, 115];

    fn shows(px: usize, of_agent: f64, color: [u8; 3]) -> Segment {
        let mut segment = Segment { px, of_agent, ..Segment::default() };
        segment.look.add(color);
        segment.look.finish();
        segment
    }

    /// What becomes of 2048 pixels of this colour in an agent's region that are seen by themselves, of which so many belonged to a known yellow thing.
    fn fresh(common: usize, color: [u8; 3]) -> Memory {
        const SIZE: (usize, usize) = (4, 3);
        let depth_m = Raster::filled(SIZE.0, SIZE.1, 1.0).unwrap();
        let camera = Camera::new(4.0, 4.0, 1.5, 1.0).unwrap();
        let view = View::of(&Frame::new(depth_m, None, camera).unwrap(), 1.0);
        let mut memory = Memory::new(SIZE, 0.0, [].into());
        let thing = shows(6300, 0.0, YELLOW);
        let mut pair = Track::new(&thing, memory.sample(&thing, &[]), true);
        pair.settle();
        memory.tracks.insert(1, pair);
        let overlap =
            Overlap { predicted: BTreeMap::from([(1, 6333)]), common: BTreeMap::from([((0, 1), common)]) };
        let labels = [0; SIZE.0 * SIZE.1];
        memory.begin_tracks(
            &[(0, 2)],
            (&[shows(2048, 0.97, color)], &labels),
            &BTreeMap::new(),
            &overlap,
            &view,
        );
        memory
    }

    /// A regression, with the counts of frame 69 of a video of another simulator: a box that a gripper pushed slowly off its twin became a part of the
    /// gripper, and neither the push nor the split was told.
    #[test]
    fn what_comes_off_a_thing_in_an_agents_region_is_a_thing() {
        let mut memory = fresh(1720, YELLOW);
        assert!(memory.tracks[&2].is_known() && memory.tracks[&2].came_off == Some(1));
        let moved = |memory: &mut Memory, by_m: f64, px: usize| {
            memory.tracks.entry(2).and_modify(|track| {
                track.hits = 10;
                track.last.center = track.first.center + by_m * DVec3::X;
                track.last.px = px;
            });
            memory.tell_partings();
            memory.tracks[&2].came_off.is_none()
        };
        assert!(!moved(&mut memory, 0.008, 2048), "noise");
        assert!(!moved(&mut memory, 0.02, 3200), "a hand that uncovers it shifts its middle");
        assert!(moved(&mut memory, 0.02, 2300), "told");
    }

    #[test]
    fn a_hand_with_some_pixels_of_a_thing_is_part_of_the_agent() {
        assert!(fresh(900, YELLOW).tracks[&2].is_agent_part());
        assert!(fresh(1720, GREY).tracks[&2].is_agent_part());
    }
}
