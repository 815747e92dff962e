//! Tells pixels of a hand from those of the thing that it holds: a frame takes both for one segment, and
//! colour separates them (ours).

use std::collections::BTreeMap;

use crate::bits::Bits;
use crate::look::Look;
use crate::scene::Key;
use crate::segment::is_looked_at;
use crate::track::Track;
use crate::view::View;

/// Where a thing is expected, a colour is the hand's if it is at least this many times as frequent in the
/// hand as in the thing.
const EXPECTED: f32 = 4.0;

/// Where a thing is not expected, a colour is the thing's if at least this share of the thing has it (less
/// may be noise),
const OF_THING: f32 = 0.02;
/// and if at most this share of the agents had it in frames that showed everything that they handle: a thing
/// leaves a seam of pixels in their region.
const OF_AGENTS: f32 = 0.02;

/// A segment has few of the hand's colours if at most this share of it has any.
const FEW: f64 = 0.5;

/// The colours of the agents of a frame.
pub(crate) struct HandColors<'a> {
    view: &'a View,
    region: Bits,
    look: Look,
}

impl<'a> HandColors<'a> {
    /// Measures the colours of the agents' region where no known thing is expected. O(n).
    pub(crate) fn of(
        view: &'a View,
        predicted: &[Key],
        region: &Bits,
        tracks: &BTreeMap<Key, Track>,
    ) -> Self {
        let mut look = Look::default();
        let is_known = |key: Key| tracks.get(&key).is_some_and(|track| track.is_known());
        for pixel in region.pixels().filter(|&pixel| is_looked_at(pixel, view.size.0)) {
            if let Some(&color) = view.color.get(pixel)
                && !is_known(predicted[pixel])
            {
                look.add(color);
            }
        }
        look.finish();
        Self { view, region: region.clone(), look }
    }

    /// Adds its colours to what the agents look like.
    pub(crate) fn teach(&self, agents: &mut Look) {
        agents.learn(&self.look);
    }

    /// Whether a pixel of the agents' region has a colour of a thing that the agents did not have before.
    /// Never without colour, nor before any was learned.
    pub(crate) fn is_of_thing(&self, pixel: usize, track: &Track, agents: &Look) -> bool {
        let is_its_own = |&color: &[u8; 3]| {
            let [own, others] = Look::shares([&track.look, agents], color);
            own >= OF_THING && others <= OF_AGENTS
        };
        self.region.has(pixel) && !agents.is_empty() && self.view.color.get(pixel).is_some_and(is_its_own)
    }

    /// Whether a segment has few of the hand's colours and of the colours that the agents had before. The
    /// colours of a hand may differ from those of its sleeve. Never without colour.
    pub(crate) fn has_few(&self, look: &Look, agents: &Look) -> bool {
        let has_few_of = |whole: &Look| look.share_of(whole).is_some_and(|share| share <= FEW);
        has_few_of(&self.look) && (agents.is_empty() || has_few_of(agents))
    }

    /// Whether a pixel that a segment gives to a known thing belongs to the hand. `is_expected`: whether the
    /// thing should be there. Never without colour.
    pub(crate) fn is_of_hand(&self, pixel: usize, track: &Track, is_expected: bool) -> bool {
        let least = if is_expected { EXPECTED } else { 1.0 };
        let is_more_its = |&color: &[u8; 3]| {
            let [own, others] = Look::shares([&self.look, &track.look], color);
            own > least * others
        };
        self.region.has(pixel) && track.is_known() && self.view.color.get(pixel).is_some_and(is_more_its)
    }
}
