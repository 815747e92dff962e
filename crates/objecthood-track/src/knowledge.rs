//! What motion has proved: which parts are one thing, and which are not.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::associate::{HOLDS, Overlap};
use crate::oneness::Oneness;
use crate::pace::Pace;
use crate::scene::Key;
use crate::track::{Rest, Track};
use crate::tracked::Relation;

/// Two parts are one thing if they moved together along a path of this length (m), to and fro,
const TOGETHER_PATH_M: f64 = 0.03;
/// with less than this share of it between them at the end,
const TOGETHER_SHARE: f64 = 0.2;
/// and less than this from frame to frame (root mean square), because under noise each goes its own way,
const TOGETHER_STEP_SHARE: f64 = 0.5;
/// in at least this many frames,
const TOGETHER_FRAMES: u32 = 6;
/// in which the motions of both fit this well (share of points).
const SURE_FIT: f64 = 0.5;
/// Two tracks are apart if one moved this far (m) against the other,
const APART_M: f64 = 0.012;
/// or if one rests this far (m) from where it first rested, beside where the other first rested.
const AGAINST_M: f64 = 0.02;
/// Parts that stood apart are one if a segment holds both for this many frames.
const WHOLE_FRAMES: u32 = 3;

/// What motion has proved.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Knowledge {
    /// Pairs that moved apart; the smaller key comes first.
    apart: BTreeSet<(Key, Key)>,
    /// Pairs that have never touched, but that one segment holds both of: for how many frames.
    whole: BTreeMap<(Key, Key), u32>,
    /// Pairs that touch and rest: whether frames show them as one.
    ones: BTreeMap<(Key, Key), Oneness>,
    /// The pace of this frame.
    #[serde(skip)]
    pace: Pace,
    /// The pairs of `ones` that this frame shows as one.
    #[serde(skip)]
    shown_as_one: BTreeSet<(Key, Key)>,
    /// Pairs that touch and move.
    together: BTreeMap<(Key, Key), Together>,
}

/// How two parts moved while both motions were known.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Together {
    frames: u32,
    /// How far the point between them moved with both (m), and how far one moved against the other (m).
    path_m: f64,
    against: DVec3,
    /// Sums of the squares of both (m²).
    path_m2: f64,
    against_m2: f64,
}

pub(crate) fn pair(a: Key, b: Key) -> (Key, Key) {
    (a.min(b), a.max(b))
}

impl Knowledge {
    pub(crate) fn are_apart(&self, a: Key, b: Key) -> bool {
        self.apart.contains(&pair(a, b))
    }

    /// Whether two tracks touched while they rested and no agent reached them.
    pub(crate) fn touched_at_rest(&self, a: Key, b: Key) -> bool {
        self.ones.contains_key(&pair(a, b))
    }

    /// Forgets what is known of a track.
    pub(crate) fn forget(&mut self, key: Key) {
        let is_other = |&(a, b): &(Key, Key)| a != key && b != key;
        self.apart.retain(is_other);
        self.whole.retain(|pair, _| is_other(pair));
        self.ones.retain(|pair, _| is_other(pair));
        self.together.retain(|pair, _| is_other(pair));
    }

    /// Learns from pairs of tracks that are seen by themselves and touch. Those that moved against each other
    /// are apart; those that moved as one are one. Returns the latter.
    pub(crate) fn learn(
        &mut self,
        touching: &BTreeSet<(Key, Key)>,
        tracks: &BTreeMap<Key, Track>,
        camera_moves: bool,
    ) -> Vec<(Key, Key)> {
        let mut joined = Vec::new();
        for &(a, b) in touching {
            let (Some(one), Some(other)) = (tracks.get(&a), tracks.get(&b)) else { continue };
            let (Some(rest_a), Some(rest_b)) = (one.rest, other.rest) else { continue };
            if one.is_agent_part()
                || other.is_agent_part()
                || one.part_of.is_some()
                || other.part_of.is_some()
            {
                continue;
            }
            // A thing in a vessel moves with the vessel.
            let is_in = |track: &Track, vessel: Key| track.votes.says(Some(vessel), Relation::In);
            if is_in(one, b) || is_in(other, a) || one.was_moved_against(other, AGAINST_M) {
                continue;
            }
            let (path_a, path_b) = (one.last.center - rest_a.center, other.last.center - rest_b.center);
            let (path, against) = (path_a.length().max(path_b.length()), (path_a - path_b).length());
            let is_whole = |track: &Track, rest: Rest| {
                track.last.px * 4 > rest.px * 3 && rest.px * 4 > track.last.px * 3
            };
            let is_clear = (one.is_moving && other.rests() || other.is_moving && one.rests())
                && is_whole(one, rest_a)
                && is_whole(other, rest_b);
            let is_two = !self.shown_as_one.contains(&(a, b));
            if is_two && one.is_undisturbed() && other.is_undisturbed() {
                self.ones.entry((a, b)).or_default().count(false, self.pace);
            }
            if is_clear && against > APART_M && against > TOGETHER_SHARE * path {
                self.apart.insert((a, b));
                self.together.remove(&(a, b));
            } else if camera_moves || one.rests() && other.rests() {
                // The motion of the camera cannot be told from theirs.
                self.together.remove(&(a, b));
            } else if !self.apart.contains(&(a, b)) && self.moved_as_one(one, other, (a, b)) {
                joined.push((a, b));
                self.together.remove(&(a, b));
            }
        }
        joined
    }

    /// Adds the motions of a frame, if both are known. Returns whether the two have moved as one for long
    /// enough.
    fn moved_as_one(&mut self, one: &Track, other: &Track, pair: (Key, Key)) -> bool {
        let known =
            |track: &Track| track.motion.clone().filter(|motion| track.is_moving && motion.fit > SURE_FIT);
        let (Some(a), Some(b)) = (known(one), known(other)) else { return false };
        let between = 0.5 * (one.center_in_camera + other.center_in_camera);
        let (moved_a, moved_b) = (a.rigid.point(between) - between, b.rigid.point(between) - between);
        let sum = self.together.entry(pair).or_default();
        sum.frames += 1;
        let (step, against) = (0.5 * (moved_a + moved_b), moved_a - moved_b);
        sum.path_m += step.length();
        sum.against += against;
        sum.path_m2 += step.length_squared();
        sum.against_m2 += against.length_squared();
        sum.frames >= TOGETHER_FRAMES
            && sum.path_m > TOGETHER_PATH_M
            && sum.against.length() < TOGETHER_SHARE * sum.path_m
            && sum.against_m2 < TOGETHER_STEP_SHARE.powi(2) * sum.path_m2
    }

    /// Marks two tracks as separate things.
    pub(crate) fn part(&mut self, a: Key, b: Key) {
        self.apart.insert(pair(a, b));
    }

    /// Begins a frame.
    pub(crate) fn begin(&mut self, pace: Pace) {
        self.pace = pace;
        self.shown_as_one.clear();
    }

    /// The other tracks that a segment, which shows `owner`, holds as well. First those to be kept apart,
    /// because they were seen to move apart or touched when they were last seen. Then those that turn out to
    /// be one with the owner, because most frames show them as one.
    pub(crate) fn held(
        &mut self,
        segment: usize,
        owner: Key,
        overlap: &Overlap,
        tracks: &BTreeMap<Key, Track>,
        touched: &BTreeSet<(Key, Key)>,
        is_seen: impl Fn(Key) -> bool,
    ) -> (Vec<Key>, Vec<Key>) {
        let (mut apart, mut one) = (Vec::new(), Vec::new());
        for (&(_, key), &common) in overlap.common.range((segment, 0)..=(segment, Key::MAX)) {
            let Some(track) = tracks.get(&key) else { continue };
            let predicted = overlap.predicted.get(&key).copied().unwrap_or(0);
            let is_held = common as f64 > HOLDS * predicted as f64;
            if key == owner || is_seen(key) || !track.is_confirmed() || !is_held || track.is_agent_part() {
                continue;
            }
            let touched = touched.contains(&pair(owner, key));
            let is_part = track.part_from() == Some(owner);
            let moved_against = track.was_moved_against(&tracks[&owner], AGAINST_M);
            let is_own = touched && track.rest.is_some() && !is_part || moved_against;
            let may_be_one = touched && !is_part && !moved_against && !self.are_apart(owner, key);
            let is_untouched = [track, &tracks[&owner]].into_iter().all(|track| track.was_never_handled());
            if may_be_one && is_untouched && track.is_undisturbed() && tracks[&owner].is_undisturbed() {
                self.shown_as_one.insert(pair(owner, key));
                let oneness = self.ones.entry(pair(owner, key)).or_default();
                oneness.count(true, self.pace);
                let list = if oneness.is_proved() { &mut one } else { &mut apart };
                list.push(key);
            } else if self.are_apart(owner, key) || is_own {
                apart.push(key);
            } else if is_part {
                one.push(key);
            } else if !touched && track.rests() && tracks[&owner].rest.is_some() {
                let frames = self.whole.entry(pair(owner, key)).or_default();
                *frames += 1;
                if *frames >= WHOLE_FRAMES {
                    one.push(key);
                } else {
                    apart.push(key);
                }
            }
        }
        (apart, one)
    }
}
