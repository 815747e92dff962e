//! Applies what motion proves about a video to its earlier frames.

use std::collections::{BTreeMap, VecDeque};

use objecthood::Raster;

use crate::tracked::{Event, EventKind, TrackId, Tracked};

/// Two things that come apart were still together in an earlier frame if their common mask stayed this much
/// the same (intersection over union) from frame to frame.
const LEAST_IOU: f64 = 0.7;

/// What a whole video has proved: which tracks are one, and which were taken for one until they came apart.
///
/// First it learns from all frames, in their order. Then it rewrites their label images, from the last to the
/// first. Source: ours, because a tracker says about a frame only what is known by then.
#[derive(Clone, Debug, Default)]
pub struct Hindsight {
    /// By part.
    wholes: BTreeMap<TrackId, TrackId>,
    first: BTreeMap<TrackId, u64>,
    partings: Vec<Parting>,
}

/// Two tracks that came apart, and where the last rewritten frame shows them.
#[derive(Clone, Debug)]
struct Parting {
    /// The track that had the number of both, and the one that got a new number.
    old: TrackId,
    new: TrackId,
    /// Pixels of each.
    shown: [Vec<usize>; 2],
}

impl Hindsight {
    /// Learns from the next frame.
    pub fn learn(&mut self, tracked: &Tracked) {
        for object in &tracked.objects {
            let Some(track) = object.track else { continue };
            self.first.entry(track).or_insert(tracked.frame);
            self.wholes.extend(object.parts.iter().map(|&part| (part, track)));
        }
        self.learn_events(&tracked.events);
    }

    /// Learns from events, such as the last ones of the video.
    pub fn learn_events(&mut self, events: &[Event]) {
        for event in events.iter().filter(|event| event.kind == EventKind::Split) {
            let Some(other) = event.other.map(TrackId) else { continue };
            let first = |track: TrackId| (self.first.get(&track).copied().unwrap_or(u64::MAX), track);
            let [old, new] = [event.object, other].map(first);
            let (old, new) = (old.min(new).1, old.max(new).1);
            self.partings.push(Parting { old, new, shown: [Vec::new(), Vec::new()] });
        }
    }

    /// The number that a track has in the end.
    pub fn whole_of(&self, track: TrackId) -> TrackId {
        let mut whole = track;
        // Numbers that name each other in a circle cannot arise; a bound costs nothing.
        for _ in 0..self.wholes.len() {
            match self.wholes.get(&whole) {
                Some(&next) => whole = next,
                None => break,
            }
        }
        whole
    }

    /// Rewrites the labels of a frame. `frame`: as in [`Tracked`]; frames go from the last to the first.
    /// Returns the tracks whose number the frame did not have, each with the track that had their pixels.
    /// O(n) for each parting.
    pub fn rewrite(&mut self, frame: u64, labels: &mut Raster<u16>) -> Vec<(TrackId, TrackId)> {
        for label in labels.as_mut_slice() {
            if *label > 0 {
                *label = self.whole_of(TrackId(*label)).0;
            }
        }
        let mut parted = Vec::new();
        let Self { first, partings, .. } = self;
        for parting in partings.iter_mut().rev() {
            let began = first.get(&parting.new).copied().unwrap_or(u64::MAX);
            let pixels = |labels: &Raster<u16>, track: TrackId| -> Vec<usize> {
                let labels = labels.as_slice();
                (0..labels.len()).filter(|&pixel| labels[pixel] == track.0).collect()
            };
            if frame >= began {
                let shown = [parting.old, parting.new].map(|track| pixels(labels, track));
                if shown.iter().all(|pixels| !pixels.is_empty()) {
                    parting.shown = shown;
                }
                continue;
            }
            let both = pixels(labels, parting.old);
            // If a frame shows them elsewhere, or shows only one of them, it stays as it is.
            if let Some(shown) = part(&both, &parting.shown, labels.size()) {
                shown[1].iter().for_each(|&pixel| labels.as_mut_slice()[pixel] = parting.new.0);
                parted.push((parting.new, parting.old));
                parting.shown = shown;
            }
        }
        parted
    }
}

/// Divides the pixels of two tracks by where a later frame shows each: every pixel goes to the nearer one.
/// `None` if the later frame shows them elsewhere. O(n).
fn part(both: &[usize], shown: &[Vec<usize>; 2], (width, height): (usize, usize)) -> Option<[Vec<usize>; 2]> {
    const NOBODY: u8 = 2;
    let mut owner = vec![NOBODY; width * height];
    let mut is_open = vec![false; width * height];
    both.iter().for_each(|&pixel| is_open[pixel] = true);
    let mut common = 0;
    let mut next: VecDeque<usize> = VecDeque::new();
    for (k, pixels) in (0..).zip(shown) {
        for &pixel in pixels.iter().filter(|&&pixel| is_open[pixel]) {
            owner[pixel] = k;
            common += 1;
            next.push_back(pixel);
        }
    }
    let all = both.len() + shown[0].len() + shown[1].len() - common;
    if shown.iter().any(Vec::is_empty) || (common as f64) < LEAST_IOU * all as f64 {
        return None;
    }
    while let Some(pixel) = next.pop_front() {
        let (u, v) = (pixel % width, pixel / width);
        let beside = [(u > 0, pixel.wrapping_sub(1)), (u + 1 < width, pixel + 1)];
        let above = [(v > 0, pixel.wrapping_sub(width)), (v + 1 < height, pixel + width)];
        for (_, to) in beside.into_iter().chain(above).filter(|(is_inside, _)| *is_inside) {
            if is_open[to] && owner[to] == NOBODY {
                owner[to] = owner[pixel];
                next.push_back(to);
            }
        }
    }
    let of = |k: u8| both.iter().copied().filter(|&pixel| owner[pixel] == k).collect();
    Some([of(0), of(1)])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(rows: [&str; 2]) -> Raster<u16> {
        let digits = rows.iter().flat_map(|row| row.bytes().map(|digit| u16::from(digit - b'0')));
        Raster::from_vec(rows[0].len(), 2, digits.collect()).unwrap()
    }

    fn split(object: u16, other: u16) -> Event {
        Event {
            frame: 2,
            time: 0.1,
            kind: EventKind::Split,
            object: TrackId(object),
            other: Some(other),
            by_agent: false,
            start: None,
            end: None,
            confidence: 1.0,
            evidence: String::new(),
        }
    }

    #[test]
    fn what_came_apart_was_two_all_along() {
        let mut hindsight =
            Hindsight { first: [(TrackId(1), 0), (TrackId(4), 2)].into(), ..Hindsight::default() };
        hindsight.learn_events(&[split(4, 1)]);
        let frames = [
            image(["0000001111", "0000001111"]),
            image(["0111111110", "0111111110"]),
            image(["0111104444", "0111104444"]),
        ];
        let mut rewritten = frames.clone();
        let parted: Vec<usize> =
            (0..3).rev().map(|k| hindsight.rewrite(k as u64, &mut rewritten[k]).len()).collect();
        assert_eq!(rewritten[1], image(["0111114440", "0111114440"]));
        assert_eq!(rewritten[0], frames[0], "it was elsewhere");
        assert_eq!(parted, [0, 1, 0]);
    }

    #[test]
    fn what_turned_out_to_be_one_was_one_all_along() {
        let wholes = [(TrackId(2), TrackId(1)), (TrackId(3), TrackId(2))].into();
        let mut hindsight = Hindsight { wholes, ..Hindsight::default() };
        let mut labels = image(["0122330400", "0000000000"]);
        assert!(hindsight.rewrite(0, &mut labels).is_empty());
        assert_eq!(labels, image(["0111110400", "0000000000"]));
    }
}
