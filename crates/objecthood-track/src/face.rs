//! Another face of a thing in a hand. A frame shows it as a segment of its own while a finger crosses the
//! thing, or while the thing turns.

use std::collections::BTreeMap;

use crate::associate::Overlap;
use crate::bits::Bits;
use crate::hand::HandColors;
use crate::memory::Memory;
use crate::scene::Key;
use crate::segment::{Measure, Segment, is_looked_at};
use crate::view::View;

/// Another view of a thing is larger by at most this factor: a cube may show its diagonal.
pub(crate) const OTHER_FACE: f64 = 1.73;
/// The middles of two of its faces are at most this far apart, in sizes (the root of its visible area): it
/// may be four times as long as wide.
pub(crate) const BESIDE_IT: f64 = 2.0;
/// A thing is in a hand if more than this share of it belongs to the agents' region.
const IN_HAND: f64 = 0.5;

impl Memory {
    /// Finds, among the `open` segments (those that show no track), the ones that show another face of a
    /// thing that an agent carries. Returns for each of them the segment that shows the thing. They lie in
    /// the agent's region, do not have the hand's colours, and are beside that segment. All together they are
    /// not much larger than the thing. `pixels`: the sampled pixels of each segment. None without colour.
    /// O(n) if there may be any.
    pub(crate) fn other_faces(
        &self,
        open: &[usize],
        segments: &[Segment],
        (labels, pixels): (&[u16], &[Vec<usize>]),
        (view, predicted): (&View, &[Key]),
        tracks_of: &[Option<Key>],
    ) -> BTreeMap<usize, usize> {
        let mut faces = BTreeMap::new();
        let shown = |key: Key| tracks_of.iter().position(|&known| known == Some(key));
        let carried = self.happenings.carried();
        let carried: Vec<(Key, u32, usize)> =
            carried.filter_map(|(key, agent)| Some((key, agent, shown(key)?))).collect();
        let unknown: Vec<usize> = open.iter().copied().filter(|&k| segments[k].of_agent > IN_HAND).collect();
        if carried.is_empty() || unknown.is_empty() {
            return faces;
        }
        let is_unknown =
            |pixel: usize| usize::from(labels[pixel]).checked_sub(1).is_some_and(|k| unknown.contains(&k));
        let mut hand = self.agents.region.clone();
        hand.remove(&Bits::of(view.size, is_unknown));
        let hand = HandColors::of(view, predicted, &hand, &self.tracks);
        for (key, number, known) in carried {
            let track = self.tracks.get(&key).zip(self.agents.sure().find(|agent| agent.number == number));
            let Some((track, agent)) = track else { continue };
            let mut area_m2 = segments[known].area_m2;
            for &k in &unknown {
                let (segment, middle) = (&segments[k], segments[known].center);
                let is_beside = (segment.center - middle).length() < BESIDE_IT * track.area_m2.sqrt();
                let fits = area_m2 + segment.area_m2 <= OTHER_FACE * track.area_m2;
                let of_agent = pixels[k].iter().filter(|&&pixel| agent.mask.has(pixel)).count();
                let is_in_hand = of_agent as f64 > IN_HAND * pixels[k].len() as f64;
                if is_in_hand
                    && is_beside
                    && fits
                    && hand.has_few(&segment.look, &self.agents.look)
                    && !faces.contains_key(&k)
                {
                    area_m2 += segment.area_m2;
                    faces.insert(k, known);
                }
            }
        }
        faces
    }
}

/// Merges faces with the segment that shows their thing: the first of them gets all pixels, and the others
/// none. O(n) if there are any.
pub(crate) fn unite(
    faces: &BTreeMap<usize, usize>,
    (labels, segments, overlap): (&mut [u16], &mut [Segment], &mut Overlap),
    with: &Measure<'_>,
) {
    let mut firsts: BTreeMap<usize, usize> = BTreeMap::new();
    for (&face, &known) in faces {
        let first = firsts.entry(known).or_insert(known);
        *first = face.min(*first);
    }
    let first_of: BTreeMap<usize, usize> = faces
        .iter()
        .map(|(&face, known)| (face, firsts[known]))
        .chain(firsts.iter().map(|(&known, &first)| (known, first)))
        .collect();
    let mut pixels: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    if first_of.is_empty() {
        return;
    }
    for (pixel, label) in labels.iter_mut().enumerate().filter(|(_, label)| **label > 0) {
        if let Some(&first) = first_of.get(&(usize::from(*label) - 1)) {
            *label = first as u16 + 1;
            if is_looked_at(pixel, with.view.size.0) {
                pixels.entry(first).or_default().push(pixel);
            }
        }
    }
    for (&k, &first) in first_of.iter().filter(|(k, first)| k != first) {
        let of_it: Vec<_> =
            overlap.common.range((k, 0)..=(k, Key::MAX)).map(|(&(_, key), &px)| (key, px)).collect();
        for (key, px) in of_it {
            overlap.common.remove(&(k, key));
            *overlap.common.entry((first, key)).or_default() += px;
        }
    }
    for (&k, &first) in &first_of {
        let own = if k == first { pixels.get(&k) } else { None };
        segments[k] = own.map_or_else(Segment::default, |pixels| with.segment(pixels));
    }
}
