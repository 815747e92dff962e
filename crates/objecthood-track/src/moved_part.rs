//! Lids and drawers: if a part of a thing is moved, the rest keeps the number of the thing and the part gets
//! a number of its own (ours).

use std::collections::{BTreeMap, BTreeSet};

use crate::associate::Overlap;
use crate::memory::Memory;
use crate::opened::may_open;
use crate::rested::Beside;
use crate::scene::Key;
use crate::segment::{Measure, STRIDE_PX, Segment, is_looked_at};
use crate::track::Track;
use crate::view::View;

/// A segment lies on, or behind, the place where a thing rested if at least the first share of its pixels
/// does. It does not if less than the second share does.
const MOST: f64 = 0.6;
const FEW: f64 = 0.3;
/// A moved part belonged to its thing with at least this share of its pixels, and at least this share stands
/// before where the thing rested.
pub(crate) const BELONGED: f64 = 0.7;
const BEFORE: f64 = 0.5;
/// At least this share of a part has colours of its thing.
const LEAST_LOOK: f64 = 0.6;
/// The rest belongs to an agent's region with less than this share: a hand may lie where a thing rested.
const OF_AGENT: f64 = 0.3;
/// A part that is cut off an open thing has at least this share of the pixels that are left, and at least
/// this many pixels (at VGA size).
const LEAST_SHARE: f64 = 0.1;
const LEAST_PX: f64 = 100.0;

/// The shares of a segment that lie where a thing rested: on its surface, before it and behind it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shares {
    there: f64,
    before: f64,
    behind: f64,
}

/// By segment and thing.
pub(crate) type BesideRest = BTreeMap<(usize, Key), Shares>;

impl Memory {
    /// How segments lie relative to the places where things rested, for things that are open or that an agent
    /// reaches. O(n) while there are any.
    pub(crate) fn beside_rest(&self, segments: &[Segment], labels: &[u16], view: &View) -> BesideRest {
        let mut shares = BesideRest::new();
        let matters = |(_, track): &(&Key, &Track)| track.is_open() || may_open(track);
        let things: BTreeSet<Key> = self.tracks.iter().filter(matters).map(|(&key, _)| key).collect();
        if things.is_empty() {
            return shares;
        }
        for (pixel, &label) in labels.iter().enumerate().filter(|(_, label)| **label > 0) {
            if is_looked_at(pixel, view.size.0)
                && let Some((key, beside)) = self.rested.at(pixel, view)
                && things.contains(&key)
            {
                let of = shares.entry((usize::from(label) - 1, key)).or_default();
                match beside {
                    Beside::There => of.there += 1.0,
                    Beside::Before => of.before += 1.0,
                    Beside::Behind => of.behind += 1.0,
                }
            }
        }
        for (&(k, _), of) in &mut shares {
            let per_px = (STRIDE_PX * STRIDE_PX) as f64 / segments[k].px.max(1) as f64;
            *of = Shares { there: of.there * per_px, before: of.before * per_px, behind: of.behind * per_px };
        }
        shares
    }

    /// The segments that lie inside open things, each with its thing.
    pub(crate) fn inside(&self, beside: &BesideRest) -> BTreeMap<usize, Key> {
        let is_inside =
            |&(&(_, key), of): &(&(usize, Key), &Shares)| of.behind > MOST && self.tracks[&key].is_open();
        beside.iter().filter(is_inside).map(|(&pair, _)| pair).collect()
    }

    /// For a thing that an agent reaches: the segment of the part that stays shows the thing's track, not the
    /// segment of the part that was moved. Returns the segments of moved parts, each with its thing. O(s t)
    /// for s segments and t tracks.
    pub(crate) fn stay_with_the_rest(
        &mut self,
        segments: &[Segment],
        overlap: &Overlap,
        beside: &BesideRest,
        tracks_of: &mut [Option<Key>],
    ) -> BTreeMap<usize, Key> {
        let mut moved = BTreeMap::new();
        let of = |k: usize, key: Key| beside.get(&(k, key)).copied().unwrap_or_default();
        let things: BTreeSet<Key> = beside.keys().map(|&(_, key)| key).collect();
        for key in things {
            let Some(shown) = tracks_of.iter().position(|&known| known == Some(key)) else { continue };
            let look = &self.tracks[&key].look;
            let looks_like =
                |k: usize| segments[k].look.share_of(look).is_some_and(|share| share > LEAST_LOOK);
            let is_rest = |&k: &usize| {
                tracks_of[k].is_none_or(|known| self.tracks[&known].rest.is_none())
                    && of(k, key).there > MOST
                    && segments[k].of_agent < OF_AGENT
                    && looks_like(k)
            };
            let rest = (0..segments.len()).find(is_rest).filter(|_| of(shown, key).there < FEW);
            let predicted = |k: usize| overlap.common.get(&(k, key)).copied().unwrap_or(0) as f64;
            let is_part = |&k: &usize| {
                tracks_of[k].is_none()
                    && of(k, key).before > BEFORE
                    && predicted(k) > BELONGED * segments[k].px as f64
                    && looks_like(k)
            };
            if of(shown, key).there > MOST {
                moved.extend((0..segments.len()).filter(is_part).map(|k| (k, key)));
            }
            if let Some(rest) = rest {
                (tracks_of[shown], tracks_of[rest]) = (tracks_of[rest], Some(key));
                moved.insert(shown, key);
                self.tracks.entry(key).and_modify(Track::halt);
                self.happenings.forget(key);
            }
        }
        moved
    }

    /// If the frame takes both parts of an open thing for one segment, the part that stands before the
    /// thing's resting place gets a segment of its own. Returns these segments, each with its thing. O(n).
    pub(crate) fn part_opened(
        &self,
        labels: &mut [u16],
        segments: &mut Vec<Segment>,
        overlap: &Overlap,
        measure: &Measure<'_>,
    ) -> BTreeMap<usize, Key> {
        let (mut parts, mut moved) = (BTreeMap::new(), BTreeMap::new());
        let width = measure.view.size.0;
        for (&key, track) in self.tracks.iter().filter(|(_, track)| track.is_open()) {
            let holds = (0..segments.len()).find(|&k| overlap.is_held_by(k, key));
            if let Some(k) = holds.filter(|_| track.rest.is_some()) {
                parts.insert(k, (key, Vec::new(), Vec::new()));
            }
        }
        if parts.is_empty() {
            return moved;
        }
        for (pixel, &label) in labels.iter().enumerate() {
            if let Some(k) = usize::from(label).checked_sub(1)
                && let Some((_, part, rest)) = parts.get_mut(&k)
            {
                let is_part = self.scene.is_in_front(measure.view, pixel);
                if is_part { part.push(pixel) } else { rest.push(pixel) }
            }
        }
        for (k, (key, part, rest)) in parts {
            let Ok(own) = u16::try_from(segments.len() + 1) else { break };
            let least = measure.view.px(LEAST_PX).max((LEAST_SHARE * rest.len() as f64) as usize);
            if part.len() < least || rest.is_empty() {
                continue;
            }
            let looked_at = |pixels: &[usize]| -> Vec<usize> {
                pixels.iter().copied().filter(|&pixel| is_looked_at(pixel, width)).collect()
            };
            segments[k] = measure.segment(&looked_at(&rest));
            moved.insert(segments.len(), key);
            segments.push(measure.segment(&looked_at(&part)));
            part.iter().for_each(|&pixel| labels[pixel] = own);
        }
        moved
    }
}
