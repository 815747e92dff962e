//! Decides which segment shows which track.

use std::collections::BTreeMap;

use crate::assignment::maximize;
use crate::memory::FORGET_S;
use crate::pace::Pace;
use crate::segment::Segment;
use crate::track::{KNOWN_S, Track};

/// Least overlap (intersection over union) of a segment with the predicted mask of a track.
const LEAST_IOU: f64 = 0.25;
/// A thing that comes out of a hand has its own colours in this share of its pixels,
pub(crate) const OWN_LOOK: f64 = 0.75;
/// and counts as if it overlapped by this much with its predicted mask: more than the least overlap, less
/// than a good one.
const COMES_OUT_IOU: f64 = 0.3;
/// A segment holds a track if it covers this share of the track's predicted mask.
pub(crate) const HOLDS: f64 = 0.5;
/// Limits for finding a track again: difference of looks, logarithm of the ratio of areas.
const MOST_LOOK: f64 = 0.6;
const MOST_SIZE: f64 = 1.4;
/// Two sizes are about the same if the logarithm of the ratio of areas is below this: a third larger.
const SAME_SIZE: f64 = 0.3;
/// A thing goes on along its path if it takes a step of at least this (m), and misses where its velocity leads
/// by less than this share of the step: its velocity comes from two frames.
const LEAST_STEP_M: f64 = 0.02;
const GOES_ON_SHARE: f64 = 0.3;
/// Where a thing of about the same size was hidden, or where it goes on along its path, looks may differ by
/// this: it was turned, or shows another side.
const MOST_LOOK_OTHER: f64 = 0.8;
/// In an agent's region looks have to agree better, because much of the region belongs to the agent.
const MOST_LOOK_AT_AGENT: f64 = 0.35;
/// Reach (m): at once, and in addition for each thirtieth of a second, up to eight of them.
const REACH_M: [f64; 2] = [0.07, 0.06];
const REACH_STEPS: f64 = 8.0;
/// What came in flying, and was never seen at rest, may be as fast as this (m/s).
const THROWN_M_PER_S: f64 = 6.0;
/// for at most this long (s): two frames at 15 a second.
const THROWN_S: f64 = 0.14;
/// Of what flies, more than this share of its pixels has changed.
const FLYING: f64 = 0.9;
/// A confirmed track can be found again for this long (s), any other for this many frames.
pub(crate) const MEMORY_S: f64 = 5.0;
pub(crate) const YOUNG_MEMORY_FRAMES: f64 = 2.5;
/// A track that began at most this long (s) after another was last seen may turn out to be the other.
const NEW_S: f64 = 2.0;
/// A thing that comes out from behind something lies within this share of its size (the root of its area) of
/// where it was last seen.
const UNCOVERED_SHARE: f64 = 0.6;
/// One look is clearly nearer than another if the differences differ by this.
const CLEARLY: f64 = 0.3;
/// An unknown difference of looks counts as this.
const UNKNOWN_LOOK: f64 = 0.3;

/// Pixel counts of segments and predicted masks, and of their overlaps.
#[derive(Debug, Default)]
pub(crate) struct Overlap {
    /// By track: the pixels of its predicted mask that can be seen.
    pub(crate) predicted: BTreeMap<u32, usize>,
    /// By segment and track: the pixels that they have in common.
    pub(crate) common: BTreeMap<(usize, u32), usize>,
}

impl Overlap {
    /// Whether any segment covers most of a track's predicted mask.
    pub(crate) fn is_held(&self, key: u32) -> bool {
        self.common.keys().any(|&(segment, other)| other == key && self.is_held_by(segment, key))
    }

    /// Whether this segment covers most of it.
    pub(crate) fn is_held_by(&self, segment: usize, key: u32) -> bool {
        let predicted = self.predicted.get(&key).copied().unwrap_or(0);
        self.common.get(&(segment, key)).is_some_and(|&common| common as f64 > HOLDS * predicted as f64)
    }

    pub(crate) fn iou(&self, segment: usize, segment_px: usize, key: u32) -> f64 {
        let common = self.common.get(&(segment, key)).copied().unwrap_or(0);
        let predicted = self.predicted.get(&key).copied().unwrap_or(0);
        common as f64 / (segment_px + predicted - common).max(1) as f64
    }
}

/// The track of each segment, by overlap with predicted masks; `None` for a segment without a track. One
/// assignment, O(s² t) for s segments and t tracks.
pub(crate) fn by_overlap(
    segments: &[Segment],
    tracks: &BTreeMap<u32, Track>,
    overlap: &Overlap,
    now_s: f64,
) -> Vec<Option<u32>> {
    let mut tracks_of = vec![None; segments.len()];
    let keys: Vec<u32> = tracks.keys().copied().collect();
    let all: Vec<usize> = (0..segments.len()).collect();
    let expected = Expected { segments, tracks, overlap, now_s };
    pair(&all, &keys, |k, key| expected.value(k, key), &mut tracks_of);
    tracks_of
}

/// What segments show of the predicted masks of tracks.
struct Expected<'a> {
    segments: &'a [Segment],
    tracks: &'a BTreeMap<u32, Track>,
    overlap: &'a Overlap,
    now_s: f64,
}

impl Expected<'_> {
    /// How well a segment shows a track, in [0, 1]; 0 = not at all.
    fn value(&self, k: usize, key: u32) -> f64 {
        let iou = self.iou(k, key);
        let iou = if iou > 0.0 && self.comes_out(k, key) { iou.max(COMES_OUT_IOU) } else { iou };
        let may_be_it = iou > LEAST_IOU
            && !self.is_out_of_reach(k, key)
            && !self.is_rather_a_thing(k, key)
            && !self.is_rather_another(k, key);
        if may_be_it { iou } else { 0.0 }
    }

    fn iou(&self, k: usize, key: u32) -> f64 {
        self.overlap.iou(k, self.segments[k].px, key)
    }

    /// Whether a segment lies nearer to the camera than the thing can have come. Then it stands before the
    /// thing, like a hand near the camera.
    fn is_out_of_reach(&self, k: usize, key: u32) -> bool {
        let (segment, track) = (&self.segments[k], &self.tracks[&key]);
        let nearer_m = track.center_in_camera.length() - segment.center_in_camera.length();
        let reach_m = reach_m(self.now_s - track.last.stamp_s);
        !track.is_agent_part() && nearer_m > reach_m + track.area_m2.sqrt()
    }

    /// Whether a segment shows more of a known thing than was expected, because less of the thing is hidden
    /// now: the segment holds the thing, has its colours and is no larger. If much less is expected than was
    /// just seen, the motion was not found.
    fn comes_out(&self, k: usize, key: u32) -> bool {
        let (segment, track) = (&self.segments[k], &self.tracks[&key]);
        let looks_like_it = segment.look.share_of(&track.look).is_some_and(|share| share > OWN_LOOK);
        let may_be_it = track.is_known() && looks_like_it && segment.area_m2 <= track.area_m2;
        let expected = self.overlap.predicted.get(&key).copied().unwrap_or(0);
        may_be_it && 2 * expected > track.last.px && self.overlap.is_held_by(k, key)
    }

    /// Whether another segment lies on the predicted mask of a known thing too, and has clearly more of its
    /// look. Then the frame may have taken the thing, and something that fell on it, for one.
    fn is_rather_another(&self, k: usize, key: u32) -> bool {
        let track = &self.tracks[&key];
        let difference = |k: usize| self.segments[k].look.distance(&track.look);
        let lies_there = |other: usize| self.iou(other, key) > LEAST_IOU;
        let is_liker = |other: usize| is_clearly_less(difference(other), difference(k));
        track.is_known()
            && (0..self.segments.len()).any(|other| other != k && lies_there(other) && is_liker(other))
    }

    /// Whether a segment has more pixels of a known thing than of this part of an agent. A frame may take a
    /// finger and the thing that it holds for one, and the thing is no part of the hand.
    fn is_rather_a_thing(&self, k: usize, part: u32) -> bool {
        let common = self.overlap.common.get(&(k, part)).copied().unwrap_or(0);
        self.tracks[&part].is_agent_part() && common < self.most_of_a_thing(k)
    }

    /// The largest number of pixels that a segment has of a known thing that it holds and may show.
    fn most_of_a_thing(&self, k: usize) -> usize {
        let is_held = |key: u32| {
            let may_show = self.overlap.is_held_by(k, key) && self.iou(k, key) > LEAST_IOU;
            may_show && self.tracks.get(&key).is_some_and(Track::is_known)
        };
        let common = self.overlap.common.range((k, 0)..=(k, u32::MAX));
        common.filter(|&(&(_, key), _)| is_held(key)).map(|(_, &px)| px).max().unwrap_or(0)
    }
}

/// Finds tracks again for segments that have no track by overlap, by looks, size and reach. `inside`:
/// segments that lie inside open things; they do not show a part that was moved off one. One assignment, as
/// [`by_overlap`].
pub(crate) fn find_again(
    segments: &[Segment],
    tracks: &BTreeMap<u32, Track>,
    overlap: &Overlap,
    inside: &BTreeMap<usize, u32>,
    (now_s, pace): (f64, Pace),
    tracks_of: &mut [Option<u32>],
) {
    // A thing that an agent carries may be a known one that was hidden in the hand; a new segment may be a
    // known thing that was hidden before.
    let is_part = |key: u32| tracks[&key].is_agent_part();
    let is_new = |key: u32| now_s - tracks[&key].first.stamp_s < NEW_S;
    let is_open = |key: u32| is_part(key) || is_new(key);
    let free: Vec<usize> = (0..segments.len()).filter(|&k| tracks_of[k].is_none_or(is_open)).collect();
    let is_lost = |key: u32| !tracks_of.contains(&Some(key)) && !is_part(key) && !overlap.is_held(key);
    let lost: Vec<u32> = tracks.keys().copied().filter(|&key| is_lost(key)).collect();
    let by_overlap = tracks_of.to_vec();
    let again = |k: usize, key: u32| {
        let is_later = |known: u32| is_part(known) || tracks[&known].first.frame > tracks[&key].last.frame;
        // A frame may have taken a thing and what fell on it for one.
        let is_another = |known: u32| {
            let difference = |track: u32| segments[k].look.distance(&tracks[&track].look);
            tracks[&known].rest.is_none() && is_clearly_less(difference(key), difference(known))
        };
        let is_inside = inside.get(&k).is_some_and(|&whole| tracks[&key].moved_off == Some(whole));
        let may_be = by_overlap[k].is_none_or(|known| is_later(known) || is_another(known)) && !is_inside;
        may_be.then(|| found_again(&segments[k], &tracks[&key], now_s, pace)).flatten().unwrap_or(0.0)
    };
    pair(&free, &lost, again, tracks_of);
    // A track that lost its segment to such a track may have another segment.
    let displaced: Vec<u32> =
        by_overlap.iter().flatten().copied().filter(|key| !tracks_of.contains(&Some(*key))).collect();
    let left: Vec<usize> = (0..segments.len()).filter(|&k| tracks_of[k].is_none()).collect();
    let elsewhere = |k: usize, key: u32| found_again(&segments[k], &tracks[&key], now_s, pace).unwrap_or(0.0);
    pair(&left, &displaced, elsewhere, tracks_of);
}

/// Pairs rows and columns so that the sum of values is greatest; pairs of value 0 are left out.
fn pair(rows: &[usize], columns: &[u32], value: impl Fn(usize, u32) -> f64, tracks_of: &mut [Option<u32>]) {
    let values: Vec<f64> = rows
        .iter()
        .flat_map(|&row| columns.iter().map(move |&column| (row, column)))
        .map(|(row, column)| value(row, column))
        .collect();
    for (row, column) in maximize(&values, rows.len(), columns.len()) {
        if values[row * columns.len() + column] > 0.0 {
            tracks_of[rows[row]] = Some(columns[column]);
        }
    }
}

/// How well a segment fits a track that is not where it was: 1 minus the cost; `None` if it cannot be the
/// same.
pub(crate) fn found_again(segment: &Segment, track: &Track, now_s: f64, pace: Pace) -> Option<f64> {
    let away_s = now_s - track.last.stamp_s;
    let memory_s = match track.is_confirmed() {
        true if track.is_covered => FORGET_S,
        true => MEMORY_S,
        false => YOUNG_MEMORY_FRAMES * pace.frame_s,
    };
    if away_s > memory_s || track.part_of.is_some() {
        return None;
    }
    let look = match track.moved_off {
        // A part shows some of the colours of its thing.
        Some(_) => segment.look.share_of(&track.look).map(|share| 1.0 - share),
        None => segment.look.distance(&track.look),
    };
    let look = look.unwrap_or(UNKNOWN_LOOK);
    let is_at_agent = segment.of_agent > 0.5 && !track.is_agent_part();
    let is_known = track.moved_off.is_some() || track.rest.is_some() && track.rest_s + away_s >= KNOWN_S;
    if is_at_agent && (!is_known || look > MOST_LOOK_AT_AGENT) {
        return None;
    }
    let (step, expected) = (segment.center - track.last.center, track.velocity * away_s);
    let distance = step.length().min((step - expected).length());
    let goes_on = away_s < YOUNG_MEMORY_FRAMES * pace.frame_s
        && expected.length() > LEAST_STEP_M
        && (step - expected).length() < GOES_ON_SHARE * expected.length();
    let is_uncovered = track.is_covered && step.length() < UNCOVERED_SHARE * track.area_m2.sqrt();
    let comes_out = is_uncovered && track.rest_s > 0.0 && segment.area_m2 < track.area_m2;
    let ratio = libm::log(segment.area_m2.max(1e-9) / track.area_m2.max(1e-9)).abs();
    let size = if comes_out { 0.0 } else { ratio };
    // A thing that was turned, or was in a shadow, has another look. So has one that tumbles.
    let may_look_other = (is_uncovered || goes_on) && ratio < SAME_SIZE;
    let most_look = if may_look_other { MOST_LOOK_OTHER } else { MOST_LOOK };
    let was_thrown = !track.is_confirmed()
        && track.rest.is_none()
        && away_s < THROWN_S
        && track.last.changed.min(segment.changed) > FLYING;
    let looks_like_it = look < MOST_LOOK_AT_AGENT && ratio < SAME_SIZE;
    let reach = reach_m(away_s);
    let most = if was_thrown && looks_like_it { reach.max(THROWN_M_PER_S * away_s) } else { reach };
    if look > most_look || size > MOST_SIZE || distance > most {
        return None;
    }
    let cost = look + 0.4 * size + 0.5 * (distance / reach).min(1.0);
    (cost < 1.0).then_some(1.0 - cost)
}

/// Whether the first of two differences of looks is clearly less; false if one is unknown.
fn is_clearly_less(one: Option<f64>, other: Option<f64>) -> bool {
    one.zip(other).is_some_and(|(one, other)| one + CLEARLY < other)
}

/// How far (m) a track may be from where it was expected, after this time.
fn reach_m(away_s: f64) -> f64 {
    REACH_M[0] + REACH_M[1] * (30.0 * away_s).min(REACH_STEPS)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::look::Look;
    use crate::track::Sample;

    /// A track that rested, or a part of an agent.
    fn track(of_agent: f64) -> Track {
        let segment = Segment { of_agent, ..Segment::default() };
        let sample = Sample {
            frame: 0,
            stamp_s: 0.0,
            center: segment.center,
            height_m: 0.0,
            bottom_m: 0.0,
            top_m: 0.0,
            in_place: 0.0,
            px: 1475,
            area_m2: 0.0,
            changed: 0.0,
            of_agent,
            at_border: false,
            moves: false,
            reached_by: None,
        };
        let mut track = Track::new(&segment, sample, true);
        if of_agent == 0.0 {
            track.settle();
        }
        track
    }

    /// A regression, with the counts of frame 54 of the synthetic video `pour2`: a frame took a cup and a finger for one, and the cup became a
    /// part of the hand, because its bottom was a segment of its own.
    #[test]
    fn a_cup_in_a_hand_is_no_part_of_the_hand() {
        let [cup, finger] = [1, 17];
        let segments = [444, 1992].map(|px| Segment { px, ..Segment::default() });
        let tracks = BTreeMap::from([(cup, track(0.0)), (finger, track(1.0))]);
        let shown = |of_cup, of_finger| Overlap {
            predicted: BTreeMap::from([(cup, 1475), (finger, 700)]),
            common: BTreeMap::from([((0, cup), 393), ((1, cup), of_cup), ((1, finger), of_finger)]),
        };
        assert_eq!(by_overlap(&segments, &tracks, &shown(919, 656), 0.0), [None, Some(cup)]);
        assert_eq!(
            by_overlap(&segments, &tracks, &shown(600, 656), 0.0),
            [Some(cup), Some(finger)],
            "most is the finger's"
        );
    }

    /// A regression, after frame 79 of the synthetic video `bowl3`: of a bowl in a hand only a strip was seen, and when the hand gave way, the
    /// bowl had a new number.
    #[test]
    fn a_thing_of_which_a_strip_was_seen_is_known_when_it_comes_out() {
        let yellow = [200, 190, 30];
        let shows = |color, area_m2, seen_px| {
            let segment = Segment { px: 900, area_m2, look: look(color), ..Segment::default() };
            let mut bowl = Track { look: look(yellow), area_m2: 0.01, ..track(0.0) };
            bowl.last.px = seen_px;
            let predicted = BTreeMap::from([(1, 200)]);
            let overlap = Overlap { predicted, common: BTreeMap::from([((0, 1), 190)]) };
            by_overlap(&[segment], &BTreeMap::from([(1, bowl)]), &overlap, 0.0)
        };
        assert_eq!(shows(yellow, 0.008, 210), [Some(1)]);
        assert_eq!(shows([40, 70, 190], 0.008, 210), [None], "of other colours");
        assert_eq!(shows(yellow, 0.012, 210), [None], "larger than it");
        assert_eq!(shows(yellow, 0.008, 900), [None], "it moved, and nobody knows where to");
    }

    fn look(color: [u8; 3]) -> Look {
        let mut look = Look::default();
        look.add(color);
        look.finish();
        look
    }

    /// A regression, after frame 12 of `throw71` of another simulator: a box that tumbled had another number in each frame.
    #[test]
    fn what_goes_on_along_its_path_may_look_otherwise() {
        let (mut thrown_look, mut seen_look) = (Look::default(), Look::default());
        (0..3).for_each(|_| thrown_look.add([200, 30, 30]));
        thrown_look.add([30, 30, 200]);
        seen_look.add([30, 30, 200]);
        thrown_look.finish();
        seen_look.finish();
        let found = |x_m: f64, area_m2, m_per_s: f64| {
            let thrown = Track {
                area_m2: 0.01,
                look: thrown_look.clone(),
                velocity: m_per_s * DVec3::X,
                ..track(0.0)
            };
            let segment =
                Segment { area_m2, look: seen_look.clone(), center: x_m * DVec3::X, ..Segment::default() };
            found_again(&segment, &thrown, 0.05, Pace::default()).is_some()
        };
        assert!(found(0.15, 0.009, 3.0));
        assert!(!found(0.2, 0.009, 3.0), "beside its path");
        assert!(!found(0.15, 0.005, 3.0), "half as large");
        assert!(!found(0.0, 0.009, 0.0), "it does not move");
    }

    /// A regression, after frame 24 of `throw71`: a box that flew in at 3 m/s and 15 frames a second was a new thing in each frame.
    #[test]
    fn what_flies_in_is_found_again_far_from_where_it_was() {
        let found = |is_new: bool, color, x_m: f64, away_s: f64| {
            let mut thrown = Track { area_m2: 0.01, look: look([200, 30, 30]), hits: 1, ..track(0.0) };
            thrown.rest = thrown.rest.filter(|_| !is_new);
            (thrown.first.frame, thrown.last.changed) = (7, 1.0);
            let segment = Segment {
                area_m2: 0.01,
                look: look(color),
                changed: 1.0,
                center: x_m * DVec3::X,
                ..Segment::default()
            };
            found_again(&segment, &thrown, away_s, Pace { frame_s: 0.067 }).is_some()
        };
        assert!(found(true, [200, 30, 30], 0.25, 0.067));
        assert!(!found(true, [200, 30, 30], 0.5, 0.067), "too fast");
        assert!(!found(true, [30, 30, 200], 0.25, 0.067), "of another colour");
        assert!(!found(false, [200, 30, 30], 0.25, 0.067), "it was at rest");
        assert!(!found(true, [200, 30, 30], 0.8, 0.15), "seen too long ago");
    }

    /// A regression, after frame 28 of `pick21` of another simulator: a hand near the camera covered a box in one frame, and took over its number.
    #[test]
    fn what_stands_far_before_a_thing_is_not_the_thing() {
        let shown =
            Overlap { predicted: BTreeMap::from([(1, 900)]), common: BTreeMap::from([((0, 1), 800)]) };
        let at = |z| Segment { px: 900, center_in_camera: DVec3::new(0.0, 0.0, z), ..Segment::default() };
        let thing = Track { area_m2: 0.01, center_in_camera: DVec3::Z, ..track(0.0) };
        let tracks = BTreeMap::from([(1, thing)]);
        assert_eq!(by_overlap(&[at(0.85)], &tracks, &shown, 0.03), [Some(1)], "it was lifted");
        assert_eq!(by_overlap(&[at(0.55)], &tracks, &shown, 0.03), [None]);
    }

    /// A regression, after frame 16 of `drop31` of another simulator: a frame took a thing and what fell on it for one, and the one that fell kept the number.
    #[test]
    fn of_two_segments_where_a_thing_should_be_that_with_its_look_is_the_thing() {
        let (red, blue) = ([200, 30, 30], [30, 30, 200]);
        let segments = [blue, red].map(|color| Segment { px: 900, look: look(color), ..Segment::default() });
        let thing = Track { look: look(red), ..track(0.0) };
        let tracks = BTreeMap::from([(1, thing)]);
        let common = BTreeMap::from([((0, 1), 800), ((1, 1), 700)]);
        let shown = Overlap { predicted: BTreeMap::from([(1, 1600)]), common };
        assert_eq!(by_overlap(&segments, &tracks, &shown, 0.0), [None, Some(1)]);
        let beside = Overlap { common: BTreeMap::from([((0, 1), 800), ((1, 1), 40)]), ..shown };
        assert_eq!(
            by_overlap(&segments, &tracks, &beside, 0.0),
            [Some(1), None],
            "it was turned, beside another"
        );
    }

    /// A regression, after frame 26 of `drop21`: the thing that was struck had moved a little, and what fell on it had been given both.
    #[test]
    fn a_thing_that_was_struck_is_told_from_what_fell_on_it_by_its_look() {
        let (red, blue) = ([200, 30, 30], [30, 30, 200]);
        let struck = Segment { px: 900, look: look(red), ..Segment::default() };
        let thing = Track { look: look(red), ..track(0.0) };
        let fell = Track { rest: None, look: look(blue), ..track(0.0) };
        let tracks = BTreeMap::from([(1, thing), (2, fell)]);
        let again = |colors: &[[u8; 3]], mut tracks_of: Vec<Option<u32>>| {
            let shows = |color: &[u8; 3]| Segment { look: look(*color), ..struck.clone() };
            let segments: Vec<Segment> = colors.iter().map(shows).collect();
            let (overlap, inside) = (Overlap::default(), BTreeMap::new());
            find_again(&segments, &tracks, &overlap, &inside, (0.1, Pace::default()), &mut tracks_of);
            tracks_of
        };
        assert_eq!(again(&[red], vec![Some(2)]), [Some(1)]);
        assert_eq!(again(&[blue], vec![Some(2)]), [Some(2)], "it is what fell");
        assert_eq!(again(&[red, blue], vec![Some(2), None]), [Some(1), Some(2)], "both are seen");
    }

    #[test]
    fn what_comes_out_may_look_otherwise_if_it_has_the_size_of_what_was_hidden() {
        let (red, mixed) = (look([200, 30, 30]), |share| {
            let mut look = Look::default();
            (0..100).for_each(|k| look.add(if k < share { [200, 30, 30] } else { [30, 30, 200] }));
            look.finish();
            look
        });
        let found = |area_m2, share, is_covered| {
            let hidden = Track { area_m2: 0.01, look: red.clone(), is_covered, ..track(0.0) };
            let segment = Segment { area_m2, look: mixed(share), ..Segment::default() };
            found_again(&segment, &hidden, 0.1, Pace::default()).is_some()
        };
        assert!(found(0.009, 28, true));
        assert!(!found(0.009, 28, false), "it was not hidden");
        assert!(!found(0.005, 28, true), "half as large");
        assert!(!found(0.009, 5, true), "of other colours");
    }
}
