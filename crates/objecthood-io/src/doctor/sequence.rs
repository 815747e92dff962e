//! Frames beside each other: their stamps, their numbers, and whether they differ.

use std::hash::{DefaultHasher, Hash, Hasher};

use objecthood::Frame;

use super::{Cause, Certainty, Finding};

/// A gap between two frames is one when it is longer than this many usual ones.
const GAP_TIMES: f64 = 1.7;

/// Gaps are dropped frames when this share of all is one; fewer are hiccups of any camera.
const MANY_GAPS: f64 = 0.02;

/// What the frames that were looked at showed.
#[derive(Debug, Default)]
pub(super) struct Sequence {
    /// A number for the content of each frame.
    contents: Vec<u64>,
    /// When each frame was measured by its own clock (ns), where it says so.
    measured_ns: Vec<i64>,
}

impl Sequence {
    pub(super) fn look(&mut self, frame: &Frame, stamp_ns: Option<i64>) {
        self.measured_ns.extend(stamp_ns);
        let mut hasher = DefaultHasher::new();
        frame.depth_m().as_slice().iter().for_each(|z| z.to_bits().hash(&mut hasher));
        self.contents.push(hasher.finish());
    }

    /// What is wrong with the frames together.
    pub(super) fn findings(&self, names: &[String], stamps_ns: &[Option<i64>]) -> Option<Finding> {
        let found = |certainty, reason| Some(Finding::new(certainty, Cause::Sequence, reason));
        let repeated = self.contents.windows(2).filter(|pair| pair[0] == pair[1]).count();
        if repeated > 0 && repeated + 1 == self.contents.len() {
            let reason = "all frames that were looked at have the same depth, to the last bit: the recording stands still";
            return found(Certainty::Sure, reason.to_owned());
        }
        // The list of a recording has the clock of the recorder, in whose order it is; the clock of the camera is in the frames.
        if self.measured_ns.windows(2).any(|pair| pair[1] < pair[0]) {
            let reason = "frames say that they were measured before others that come earlier: they are out of order, or a clock was set back";
            return found(Certainty::Sure, reason.to_owned());
        }
        let stamps: Option<Vec<i64>> = stamps_ns.iter().copied().collect();
        let Some(stamps) = stamps.filter(|stamps| stamps.len() > 2) else {
            return missing_numbers(names).and_then(|reason| found(Certainty::Suspect, reason));
        };
        let steps: Vec<i64> = stamps.windows(2).map(|pair| pair[1].saturating_sub(pair[0])).collect();
        let backward = steps.iter().filter(|&&step| step <= 0).count();
        if backward > 0 {
            let reason = format!(
                "{backward} of {} frames are not later than the one before: they are out of order",
                stamps.len()
            );
            return found(Certainty::Sure, reason);
        }
        let usual_ns = usual(&steps)?;
        let gaps: Vec<i64> =
            steps.iter().copied().filter(|&step| step as f64 > GAP_TIMES * usual_ns).collect();
        let missing: f64 = gaps.iter().map(|&gap| (gap as f64 / usual_ns).round() - 1.0).sum();
        let longest_ms = *gaps.iter().max()? as f64 / 1e6;
        let is_many = gaps.len() as f64 > MANY_GAPS * steps.len() as f64;
        let reason = format!(
            "about {missing:.0} frames are missing: {} gaps, the longest of {longest_ms:.0} ms, where frames are usually {:.0} ms apart",
            gaps.len(),
            usual_ns / 1e6
        );
        if is_many { found(Certainty::Suspect, reason) } else { None }
    }
}

/// Frames in a second: by the usual step.
pub(super) fn rate_hz(stamps_ns: &[Option<i64>]) -> Option<f64> {
    let stamps: Vec<i64> = stamps_ns.iter().copied().collect::<Option<_>>()?;
    let steps: Vec<i64> = stamps.windows(2).map(|pair| pair[1].saturating_sub(pair[0])).collect();
    usual(&steps).map(|step_ns| 1e9 / step_ns)
}

/// The step in the middle (ns), if it is one forward.
fn usual(steps: &[i64]) -> Option<f64> {
    let mut sorted = steps.to_vec();
    sorted.sort_unstable();
    sorted.get(sorted.len() / 2).map(|&step| step as f64).filter(|&step| step > 0.0)
}

/// Numbers that are left out where frames are called by numbers that count up by one.
fn missing_numbers(names: &[String]) -> Option<String> {
    let number = |name: &String| -> Option<u64> {
        let digits = name.trim_start_matches(|c: char| !c.is_ascii_digit());
        digits.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
    };
    let numbers: Vec<u64> = names.iter().map(number).collect::<Option<_>>()?;
    let steps: Vec<u64> = numbers.windows(2).map(|pair| pair[1].saturating_sub(pair[0])).collect();
    let single = steps.iter().filter(|&&step| step == 1).count();
    // Where most count by one, the others are gaps.
    let is_counted = single * 4 >= steps.len() * 3 && steps.iter().all(|&step| step > 0);
    let missing: u64 = steps.iter().map(|step| step.saturating_sub(1)).sum();
    (is_counted && missing > 0).then(|| {
        let at = steps.iter().position(|&step| step > 1).unwrap_or(0);
        format!(
            "{missing} numbers are left out in the names of the frames, the first between {} and {}",
            names[at],
            names[at + 1]
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reason(names: &[&str], stamps_ms: &[i64]) -> Option<String> {
        let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
        let stamps: Vec<_> = stamps_ms.iter().map(|&ms| Some(ms * 1_000_000)).collect();
        Sequence::default().findings(&names, &stamps).map(|finding| finding.reason)
    }

    #[test]
    fn gaps_and_disorder_are_told() {
        let even: Vec<i64> = (0..20).map(|k| 33 * k).collect();
        assert_eq!(reason(&[], &even), None);
        let dropped: Vec<i64> = even.iter().copied().filter(|ms| !(200..300).contains(ms)).collect();
        assert!(reason(&[], &dropped).unwrap().starts_with("about 3 frames are missing: 1 gaps"));
        let mut swapped = even;
        swapped.swap(4, 5);
        assert!(reason(&[], &swapped).unwrap().starts_with("1 of 20 frames are not later"));
    }

    #[test]
    fn a_clock_that_goes_back_is_told() {
        let even: Vec<_> = (0..8).map(|k| Some(33_000_000 * k)).collect();
        let sequence = |measured_ns| Sequence { measured_ns, ..Sequence::default() };
        assert_eq!(sequence(vec![10, 20, 30]).findings(&[], &even), None);
        let finding = sequence(vec![10, 20, 15]).findings(&[], &even).unwrap();
        assert_eq!((finding.certainty, finding.cause), (Certainty::Sure, Cause::Sequence));
    }

    #[test]
    fn numbers_that_are_left_out_are_told_where_names_count() {
        assert_eq!(reason(&["a1", "a2", "a3", "a4"], &[]), None);
        let told = reason(&["a1", "a2", "a3", "a5", "a6"], &[]).unwrap();
        assert_eq!(told, "1 numbers are left out in the names of the frames, the first between a3 and a5");
        assert_eq!(reason(&["000001", "000017", "000033"], &[]), None);
        assert_eq!(reason(&["left", "right"], &[]), None);
    }
}
