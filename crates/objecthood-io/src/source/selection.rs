//! Which frames of a source are wanted.

use std::fmt;
use std::str::FromStr;

use super::FrameRef;
use crate::error::{Error, Result};

/// Frames by their number, from 0.
///
/// Written `first..end` or `first..end:step`, for example `10..200:5`; either end may be left out. A number alone is that frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameRange {
    /// The first one.
    pub first: usize,
    /// The one behind the last; `None`: all that come.
    pub end: Option<usize>,
    /// Every how many-th; not zero.
    pub step: usize,
}

/// Frames by their time.
///
/// Written `first..end` in seconds from the first frame of the source, for example `3.0..8.0`; either end may be left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeRange {
    /// The earliest time (s).
    pub first_s: f64,
    /// The time behind the latest (s); may be infinite.
    pub end_s: f64,
}

/// The frames that are in everything that is given. By default all.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Selection {
    /// By number, counted in the whole source.
    pub frames: Option<FrameRange>,
    /// By time.
    pub time: Option<TimeRange>,
}

type Frames = Box<dyn Iterator<Item = Result<FrameRef>> + Send>;

impl Selection {
    /// The selected ones of a source's frames. What numbers pass over is skipped as fast as the source can.
    pub(super) fn of(&self, frames: Frames) -> Frames {
        match (self.time, self.frames) {
            (None, None) => frames,
            (None, Some(range)) => range.of(frames),
            (Some(time), range) => {
                let timed = time.of(frames);
                match range {
                    Some(range) => Box::new(timed.filter(move |frame| range.contains(frame))),
                    None => timed,
                }
            }
        }
    }
}

impl FrameRange {
    fn of(self, frames: Frames) -> Frames {
        let Self { first, end, step } = self;
        let few = end.map_or(usize::MAX, |end| end.saturating_sub(first));
        Box::new(frames.skip(first).take(few).step_by(step))
    }

    /// Errors are in every range: they are to be told.
    fn contains(self, frame: &Result<FrameRef>) -> bool {
        frame.as_ref().ok().is_none_or(|frame| {
            let number = frame.number();
            number >= self.first
                && self.end.is_none_or(|end| number < end)
                && (number - self.first).is_multiple_of(self.step)
        })
    }
}

impl TimeRange {
    /// The frames whose time is in the range. A frame without a time is an error, and the last.
    fn of(self, frames: Frames) -> Frames {
        let judge = move |(first_ns, is_over): &mut (Option<i64>, bool), frame: Result<FrameRef>| {
            if *is_over {
                return None;
            }
            Some(frame.and_then(|frame| {
                let stamp_ns = frame.stamp_ns().ok_or_else(|| {
                    *is_over = true;
                    Error::NoStamp.at(frame.path())
                })?;
                let since_ns = stamp_ns.saturating_sub(*first_ns.get_or_insert(stamp_ns));
                Ok(self.contains(since_ns as f64 * 1e-9).then_some(frame))
            }))
        };
        Box::new(frames.scan((None, false), judge).filter_map(Result::transpose))
    }

    fn contains(self, since_s: f64) -> bool {
        (self.first_s..self.end_s).contains(&since_s)
    }
}

impl fmt::Display for FrameRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { first, end, step } = self;
        write!(f, "{first}..{}", end.map(|end| end.to_string()).unwrap_or_default())?;
        if *step == 1 { Ok(()) } else { write!(f, ":{step}") }
    }
}

impl fmt::Display for TimeRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { first_s, end_s } = self;
        if end_s.is_finite() { write!(f, "{first_s}..{end_s}") } else { write!(f, "{first_s}..") }
    }
}

impl FromStr for FrameRange {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || Error::BadFrameRange { given: text.to_owned() };
        let number = |text: &str| text.trim().parse::<usize>().map_err(|_| wrong());
        let (range, step) = match text.split_once(':') {
            Some((range, step)) => (range, number(step)?),
            None => (text, 1),
        };
        let Some((first, end)) = range.split_once("..") else {
            let first = number(text)?;
            return Ok(Self { first, end: first.checked_add(1), step: 1 });
        };
        let first = if first.trim().is_empty() { 0 } else { number(first)? };
        let end = if end.trim().is_empty() { None } else { Some(number(end)?) };
        if step == 0 || end.is_some_and(|end| end <= first) {
            Err(wrong())
        } else {
            Ok(Self { first, end, step })
        }
    }
}

impl FromStr for TimeRange {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || Error::BadTimeRange { given: text.to_owned() };
        let (first, end) = text.split_once("..").ok_or_else(wrong)?;
        let seconds = |text: &str, if_left_out: f64| match text.trim() {
            "" => Ok(if_left_out),
            number => number.parse::<f64>().map_err(|_| wrong()),
        };
        let range = Self { first_s: seconds(first, 0.0)?, end_s: seconds(end, f64::INFINITY)? };
        if range.first_s >= 0.0 && range.first_s < range.end_s { Ok(range) } else { Err(wrong()) }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::Source;

    fn frame(k: i64, has_time: bool) -> FrameRef {
        let load = Arc::new(|| Err(Error::NoFrames));
        let stamp_ns = has_time.then_some(7_000_000_000 + k * 500_000_000);
        FrameRef { stamp_ns, ..FrameRef::new("a".into(), k.to_string().into(), load) }
    }

    fn selected(frames: &str, time: &str) -> Vec<usize> {
        let given = |text: &str| (!text.is_empty()).then_some(text.to_owned());
        let selection = Selection {
            frames: given(frames).map(|text| text.parse().unwrap()),
            time: given(time).map(|text| text.parse().unwrap()),
        };
        let source = Source::listed((0..20).map(|k| frame(k, true)).collect()).select(&selection);
        source.map(|frame| frame.unwrap().number()).collect()
    }

    #[test]
    fn frames_are_selected_by_number_and_time() {
        for (frames, time, numbers) in [
            ("3..6", "", &[3, 4, 5][..]),
            ("10..:4", "", &[10, 14, 18]),
            ("..7:3", "", &[0, 3, 6]),
            ("7", "", &[7]),
            ("18..200:5", "", &[18]),
            ("30..", "", &[]),
            ("", "3.0..4.0", &[6, 7]),
            ("", "..1", &[0, 1]),
            ("", "9..", &[18, 19]),
            ("1..:3", "2..6", &[4, 7, 10]),
        ] {
            assert_eq!(selected(frames, time), numbers, "{frames} {time}");
            if !frames.is_empty() {
                let range: FrameRange = frames.parse().unwrap();
                assert_eq!(range.to_string().parse::<FrameRange>().unwrap(), range, "written as it is read");
            }
            if !time.is_empty() {
                let range: TimeRange = time.parse().unwrap();
                assert_eq!(range.to_string().parse::<TimeRange>().unwrap(), range, "written as it is read");
            }
        }
        assert_eq!(selected("", ""), (0..20).collect::<Vec<_>>());
    }

    #[test]
    fn without_times_none_are_selected_by_time() {
        let selection = Selection { frames: None, time: Some("1..".parse().unwrap()) };
        let frames = Source::listed((0..3).map(|k| frame(k, false)).collect()).select(&selection);
        let messages: Vec<String> = frames.map(|frame| frame.unwrap_err().to_string()).collect();
        assert_eq!(messages.len(), 1, "said once: {messages:?}");
        assert!(messages[0].contains("has no time"), "{messages:?}");
    }

    #[test]
    fn what_is_no_range_is_refused() {
        for text in ["", "..:0", "5..5", "6..5", "a..b", "1..2..3", "1:2", "-1..3", "1..5:x", "1.5..3"] {
            assert!(matches!(text.parse::<FrameRange>(), Err(Error::BadFrameRange { .. })), "{text}");
        }
        for text in ["", "3", "5..5", "6..5", "a..b", "-1..3", "nan..3", "1..nan"] {
            assert!(matches!(text.parse::<TimeRange>(), Err(Error::BadTimeRange { .. })), "{text}");
        }
    }
}
