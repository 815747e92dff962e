//! Folders in the layout of the TUM RGB-D benchmark: `rgb.txt` and `depth.txt` list images with the times at which they
//! were taken, a line each: seconds, blank, path below the folder. Lines that begin with `#` are comments.
//!
//! The two cameras have clocks of their own, so colour and depth are joined by time ([`associate`]).
//!
//! Source: Sturm et al., *A benchmark for the evaluation of RGB-D SLAM systems*, IROS 2012, and its `associate.py`.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// The file in the folder that tells the camera, as a [`camera_file`](crate::camera_file); ours, the layout has none.
pub const CAMERA: &str = "camera.json";

/// Units of depth that make a metre, by convention of the layout.
pub const DEPTH_SCALE: f64 = 5000.0;

/// Colour and depth are joined when they were taken at most this apart (µs).
pub const MAX_APART_US: i64 = 20_000;

/// An image and its time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// When it was taken (µs).
    pub time_us: i64,
    /// Path below the folder.
    pub file: PathBuf,
}

/// What a folder holds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TumFolder {
    /// Colour and depth image of every frame, in the order of their times.
    pub pairs: Vec<(PathBuf, PathBuf)>,
    /// Colour images without a depth image at their time.
    pub color_alone: usize,
    /// Depth images without a colour image at their time.
    pub depth_alone: usize,
}

/// Whether a folder has this layout.
pub fn is_tum(folder: &Path) -> bool {
    ["rgb.txt", "depth.txt"].iter().all(|list| folder.join(list).is_file())
}

/// The frames of a folder. No image is opened.
///
/// # Errors
/// [`Error::At`] one of the two lists: it cannot be read, or those of [`parse_list`].
pub fn open_folder(folder: &Path) -> Result<TumFolder> {
    let open = |name: &str| {
        let path = folder.join(name);
        let bytes = std::fs::read(&path).map_err(|reason| Error::Read { reason });
        bytes.and_then(|bytes| parse_list(&bytes)).map_err(|error| error.at(&path))
    };
    let (color, depth) = (open("rgb.txt")?, open("depth.txt")?);
    let times = |entries: &[Entry]| -> Vec<i64> { entries.iter().map(|entry| entry.time_us).collect() };
    let pairs: Vec<_> = associate(&times(&color), &times(&depth), MAX_APART_US)
        .into_iter()
        .map(|(c, d)| (folder.join(&color[c].file), folder.join(&depth[d].file)))
        .collect();
    let (color_alone, depth_alone) = (color.len() - pairs.len(), depth.len() - pairs.len());
    Ok(TumFolder { pairs, color_alone, depth_alone })
}

/// Reads the content of a list, in the order of its times.
///
/// # Errors
/// [`Error::BadListLine`].
pub fn parse_list(bytes: &[u8]) -> Result<Vec<Entry>> {
    let text = String::from_utf8_lossy(bytes);
    let mut entries = Vec::new();
    for (k, line) in text.lines().map(str::trim).enumerate() {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let wrong = || Error::BadListLine { line: k + 1, text: line.chars().take(60).collect() };
        let (time, file) = line.split_once(char::is_whitespace).ok_or_else(wrong)?;
        let time_s = time.parse::<f64>().ok().filter(|time_s| time_s.abs() < 1e12).ok_or_else(wrong)?;
        // Microseconds since 1970 are far below 2^53, so that nothing is lost.
        entries.push(Entry { time_us: (time_s * 1e6).round() as i64, file: file.trim_start().into() });
    }
    entries.sort_by_key(|entry| entry.time_us);
    Ok(entries)
}

/// Joins two ascending lists of times: the two that are nearest to each other are a pair, then the nearest two of the
/// rest, and so on up to `max_apart_us`. Every time is in one pair at most.
///
/// Returns the indices of each pair, in the order of the first list. O(n log n): the two that are nearest are
/// neighbours when both lists are merged, and when they are taken out their neighbours become neighbours.
pub fn associate(first: &[i64], second: &[i64], max_apart_us: i64) -> Vec<(usize, usize)> {
    let of = |list: bool, times: &[i64]| -> Vec<(i64, bool, usize)> {
        times.iter().enumerate().map(|(k, &time)| (time, list, k)).collect()
    };
    let mut merged = of(false, first);
    merged.extend(of(true, second));
    merged.sort_unstable();

    let end = merged.len();
    let mut before: Vec<usize> = (0..end).map(|m| m.wrapping_sub(1)).collect();
    let mut after: Vec<usize> = (1..=end).collect();
    let mut taken = vec![false; end];
    // Neighbours of different lists that are near enough, the nearest on top.
    let mut candidates = BinaryHeap::new();
    let consider = |candidates: &mut BinaryHeap<_>, a: usize, b: usize| {
        let (Some(left), Some(right)) = (merged.get(a), merged.get(b)) else { return };
        let apart = right.0.saturating_sub(left.0);
        if left.1 != right.1 && apart <= max_apart_us {
            candidates.push(Reverse((apart, a, b)));
        }
    };
    (1..end).for_each(|m| consider(&mut candidates, m - 1, m));

    let mut pairs = Vec::new();
    while let Some(Reverse((_, a, b))) = candidates.pop() {
        if taken[a] || taken[b] {
            continue;
        }
        (taken[a], taken[b]) = (true, true);
        let (one, other) = (merged[a], merged[b]);
        pairs.push(if one.1 { (other.2, one.2) } else { (one.2, other.2) });
        let (left, right) = (before[a], after[b]);
        if let Some(after) = after.get_mut(left) {
            *after = right;
        }
        if let Some(before) = before.get_mut(right) {
            *before = left;
        }
        consider(&mut candidates, left, right);
    }
    pairs.sort_unstable();
    pairs
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// As `associate.py` does it: all pairs that are near enough, sorted, each taken if both are free.
    fn naive(first: &[i64], second: &[i64], max_apart_us: i64) -> Vec<(usize, usize)> {
        let mut all: Vec<(i64, usize, usize)> = Vec::new();
        for (a, x) in first.iter().enumerate() {
            for (b, y) in second.iter().enumerate() {
                all.push(((x - y).abs(), a, b));
            }
        }
        all.sort_unstable();
        let (mut used_a, mut used_b) = (vec![false; first.len()], vec![false; second.len()]);
        let mut pairs = Vec::new();
        for (apart, a, b) in all {
            if apart <= max_apart_us && !used_a[a] && !used_b[b] {
                (used_a[a], used_b[b]) = (true, true);
                pairs.push((a, b));
            }
        }
        pairs.sort_unstable();
        pairs
    }

    proptest! {
        /// Where all distances differ, as they do among times as random as these, there is one answer.
        #[test]
        fn it_is_the_greedy_association(
            mut first in prop::collection::vec(0_i64..1_000_000_000_000, 0..40),
            mut second in prop::collection::vec(0_i64..1_000_000_000_000, 0..40),
            max_apart in 0_i64..100_000_000_000,
        ) {
            first.sort_unstable();
            second.sort_unstable();
            prop_assert_eq!(associate(&first, &second, max_apart), naive(&first, &second, max_apart));
        }

        #[test]
        fn no_time_is_used_twice(
            mut first in prop::collection::vec(0_i64..50, 0..40),
            mut second in prop::collection::vec(0_i64..50, 0..40),
        ) {
            first.sort_unstable();
            second.sort_unstable();
            let pairs = associate(&first, &second, 3);
            for (k, &(a, b)) in pairs.iter().enumerate() {
                prop_assert!((first[a] - second[b]).abs() <= 3);
                prop_assert!(pairs[..k].iter().all(|other| other.0 != a && other.1 != b));
            }
            prop_assert_eq!(pairs.is_empty(), naive(&first, &second, 3).is_empty());
        }
    }

    #[test]
    fn times_at_the_limit() {
        assert_eq!(associate(&[0, 100_000], &[20_000, 79_999], MAX_APART_US), [(0, 0)]);
        assert_eq!(associate(&[0, 30], &[20, 35], 100), [(0, 0), (1, 1)]);
        assert_eq!(associate(&[i64::MIN], &[i64::MAX], 100), []);
    }

    #[test]
    fn many_equal_times_take_no_quadratic_time() {
        let times = vec![7; 200_000];
        assert_eq!(associate(&times, &times, MAX_APART_US).len(), times.len());
    }

    #[test]
    fn lists_are_read() {
        let list = b"# a comment\r\n1305031232.904183 depth/b c.png\r\n\n 1305031232.868557\tdepth/a.png\n";
        let entries = parse_list(list).unwrap();
        let entry = |time_us, file: &str| Entry { time_us, file: file.into() };
        assert_eq!(
            entries,
            [entry(1_305_031_232_868_557, "depth/a.png"), entry(1_305_031_232_904_183, "depth/b c.png")]
        );
        for (list, line) in
            [("1.0", 1), ("# x\nyesterday a.png", 2), ("nan a", 1), ("1e300 a", 1), ("\n\n-", 3)]
        {
            let message = parse_list(list.as_bytes()).unwrap_err().to_string();
            assert!(message.starts_with(&format!("line {line}: ")), "{message}");
        }
        assert_eq!(parse_list(b"").unwrap(), []);
    }
}
