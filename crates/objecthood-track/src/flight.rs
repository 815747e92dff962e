//! Free flight: only gravity acts. A pure function of where a thing was.

use crate::track::Sample;

/// Acceleration of free fall (m/s²).
const GRAVITY: f64 = 9.81;
/// A flight is seen in at least the first number of frames, or in the second if the thing flies into the
/// image and has flown before it was seen as a whole.
pub(crate) const LEAST_FRAMES: usize = 5;
const LEAST_FRAMES_IF_CAME: usize = 4;
/// The heights deviate from the parabola by at most this: root mean square, largest deviation, deviation at
/// the ends (m).
const RMS_M: f64 = 0.010;
const LARGEST_M: f64 = 0.022;
const ENDS_M: f64 = 0.010;
/// Sideways the motion deviates from a straight line by at most this (m, root mean square).
const SIDEWAYS_M: f64 = 0.016;
/// The acceleration fitted to the heights differs from gravity by at most this share, or this many standard
/// deviations: sliding down a slope of 30 degrees is no flight.
const SHARE: f64 = 0.22;
const SIGMAS: f64 = 2.5;
/// The standard deviation of this acceleration is at most this share of gravity.
const MOST_UNSURE: f64 = 1.0 / 6.0;
/// Fewer frames than [`LEAST_FRAMES`] tell less. Then nobody may reach the thing, its heights keep to the
/// parabola within their noise, and these are the limits of their acceleration. At 60 frames a second four
/// frames are too short a time for them.
const SHARE_IF_CAME: f64 = 0.35;
const MOST_UNSURE_IF_CAME: f64 = 1.0 / 3.0;
/// Standard deviation of a height (m).
const HEIGHT_SIGMA_M: f64 = 0.003;
/// A flying thing moves, or more than this share of its pixels changes.
const LEAST_CHANGED: f64 = 0.35;
/// No hand reaches it in at least the first number of frames. The second, at the end, is enough if its
/// heights keep to the parabola within their noise.
const LEAST_FREE: usize = 3;
const LEAST_FREE_IF_EXACT: usize = 2;
/// No hand reaches a thing if less than this share of it belongs to an agent's region.
const MOST_OF_AGENT: f64 = 0.5;
/// It covers at least this distance (m), so that rest is no flight.
const LEAST_PATH_M: f64 = 0.03;
/// Its visible area (m²) stays within this ratio. Otherwise something comes before it and shifts its mean
/// point.
const MOST_AREAS: f64 = 2.0;

/// An interval of free flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Flight {
    pub(crate) first: u64,
    pub(crate) last: u64,
    pub(crate) start_s: f64,
    /// Heights (m) at both ends, and the greatest between.
    pub(crate) from_m: f64,
    pub(crate) to_m: f64,
    pub(crate) highest_m: f64,
    /// Measured acceleration downwards (m/s²).
    pub(crate) acceleration: f64,
    pub(crate) rms_m: f64,
}

/// The flights among the samples of a thing that was first seen in frame `seen_from`, in order of time.
/// O(samples²).
pub(crate) fn flights(samples: &[Sample], seen_from: u64) -> Vec<Flight> {
    let moves = |sample: &Sample| sample.moves || sample.changed > LEAST_CHANGED;
    // At the top of its path it hardly moves.
    let may_fly = |k: usize| {
        let around = &samples[k.saturating_sub(1)..(k + 2).min(samples.len())];
        around.iter().any(moves) && !samples[k].at_border
    };
    let mut flights = Vec::new();
    let mut start = 0;
    while start + LEAST_FRAMES_IF_CAME <= samples.len() {
        // It was not seen before, or only at the border.
        let came = samples[start].frame == seen_from || (start > 0 && samples[start - 1].at_border);
        let least = if came { LEAST_FRAMES_IF_CAME } else { LEAST_FRAMES };
        let run = (start..samples.len()).take_while(|&k| may_fly(k)).count();
        let run = samples[start..start + run].iter().rposition(moves).map_or(0, |last| last + 1);
        let longest = (least..=run).rev().find_map(|n| fits(&samples[start..start + n]));
        match longest {
            Some(flight) => {
                // A start some frames later may fit better, when the first frames still belong to a hand.
                let later = (start + 1..start + 4).filter_map(|k| {
                    let n = (LEAST_FRAMES..=run.saturating_sub(k - start))
                        .rev()
                        .find_map(|n| fits(samples.get(k..k + n)?))?;
                    Some(n)
                });
                let length = |flight: &Flight| flight.last - flight.first;
                let best = later.fold(flight, |best, other| {
                    let is_long = 5 * length(&other) >= 3 * length(&best) && other.last >= best.last;
                    if is_long && best.rms_m > HEIGHT_SIGMA_M && other.rms_m < 0.5 * best.rms_m {
                        other
                    } else {
                        best
                    }
                });
                flights.push(best);
                start = samples.iter().position(|sample| sample.frame > best.last).unwrap_or(samples.len());
            }
            None => start += 1,
        }
    }
    flights
}

/// Whether samples are a flight.
fn fits(samples: &[Sample]) -> Option<Flight> {
    let (first, last) = (samples.first()?, samples.last()?);
    let areas = || samples.iter().map(|sample| sample.area_m2);
    let is_whole = areas().fold(0.0, f64::max) <= MOST_AREAS * areas().fold(f64::INFINITY, f64::min);
    // It may begin near a hand, or end there.
    let is_free = |sample: &&Sample| sample.reached_by.is_none() && sample.of_agent < MOST_OF_AGENT;
    if !is_whole {
        return None;
    }
    let n = samples.len() as f64;
    let mean_s = samples.iter().map(|sample| sample.stamp_s).sum::<f64>() / n;
    let times: Vec<f64> = samples.iter().map(|sample| sample.stamp_s - mean_s).collect();
    let spread: f64 = times.iter().map(|t| t * t).sum();
    let line = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / n;
        let slope = times.iter().zip(values).map(|(t, y)| t * y).sum::<f64>() / spread;
        times.iter().zip(values).map(|(t, y)| y - mean - slope * t).collect::<Vec<f64>>()
    };
    let rms = |residuals: &[f64]| (residuals.iter().map(|r| r * r).sum::<f64>() / n).sqrt();
    let heights: Vec<f64> = samples.iter().map(|sample| sample.height_m).collect();
    let lifted: Vec<f64> = times.iter().zip(&heights).map(|(t, h)| h + 0.5 * GRAVITY * t * t).collect();
    let residuals = line(&lifted);
    let largest = residuals.iter().fold(0.0_f64, |most, r| most.max(r.abs()));
    let ends = residuals[0].abs().max(residuals[residuals.len() - 1].abs());
    let is_exact = rms(&residuals) < HEIGHT_SIGMA_M;
    let is_short = samples.len() < LEAST_FRAMES;
    let free = samples.iter().filter(is_free).count();
    let free_at_end = samples.iter().rev().take_while(is_free).count();
    if free < LEAST_FREE && !(is_exact && free_at_end >= LEAST_FREE_IF_EXACT) {
        return None;
    }
    if is_short && !(is_exact && free == samples.len()) {
        return None;
    }
    if rms(&residuals) > RMS_M || largest > LARGEST_M || ends > ENDS_M {
        return None;
    }
    // The heights' own acceleration: from the square of time, without its mean and slope.
    let squares = line(&times.iter().map(|t| t * t).collect::<Vec<f64>>());
    let power: f64 = squares.iter().map(|q| q * q).sum();
    let bend = squares.iter().zip(&heights).map(|(q, h)| q * h).sum::<f64>() / power;
    let (acceleration, sigma) = (-2.0 * bend, 2.0 * HEIGHT_SIGMA_M / power.sqrt());
    let (most, most_unsure) = match is_short {
        true => (SHARE_IF_CAME * GRAVITY, MOST_UNSURE_IF_CAME * GRAVITY),
        false => ((SHARE * GRAVITY).max(SIGMAS * sigma), MOST_UNSURE * GRAVITY),
    };
    if (acceleration - GRAVITY).abs() > most || sigma > most_unsure {
        return None;
    }
    let axis = |k: usize| line(&samples.iter().map(|sample| sample.center[k]).collect::<Vec<f64>>());
    // Heights are along up; the residual of all three axes includes the parabola, which is subtracted.
    let sideways: f64 = (0..3).map(|k| axis(k).iter().map(|r| r * r).sum::<f64>()).sum();
    let vertical: f64 = line(&heights).iter().map(|r| r * r).sum();
    if ((sideways - vertical).max(0.0) / n).sqrt() > SIDEWAYS_M {
        return None;
    }
    let highest_m = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest_m = heights.iter().copied().fold(f64::INFINITY, f64::min);
    ((last.center - first.center).length().max(highest_m - lowest_m) > LEAST_PATH_M).then(|| Flight {
        first: first.frame,
        last: last.frame,
        start_s: first.stamp_s,
        from_m: first.height_m,
        to_m: last.height_m,
        highest_m,
        acceleration,
        rms_m: rms(&residuals),
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// The flights of a thing whose first frame is the first of these.
    fn from_first(samples: &[Sample]) -> Vec<Flight> {
        flights(samples, samples[0].frame)
    }

    fn samples(n: usize, fps: f64, height: impl Fn(f64) -> f64) -> Vec<Sample> {
        (0..n)
            .map(|k| {
                let t = k as f64 / fps;
                let height_m = height(t);
                Sample {
                    frame: k as u64,
                    stamp_s: t,
                    center: DVec3::new(0.8 * t, 0.1, height_m),
                    height_m,
                    bottom_m: height_m - 0.03,
                    top_m: height_m + 0.03,
                    in_place: 0.0,
                    px: 900,
                    area_m2: 0.0036,
                    changed: 0.9,
                    of_agent: 0.0,
                    at_border: false,
                    moves: true,
                    reached_by: None,
                }
            })
            .collect()
    }

    #[test]
    fn a_throw_is_a_flight_and_a_carry_is_none() {
        for fps in [15.0, 30.0, 60.0] {
            let n = (0.6 * fps) as usize;
            let thrown = from_first(&samples(n, fps, |t| 0.5 + 2.0 * t - 0.5 * 9.81 * t * t));
            assert_eq!(thrown.len(), 1, "{fps}");
            assert_eq!((thrown[0].first, thrown[0].last), (0, n as u64 - 1));
            assert!((thrown[0].acceleration - 9.81).abs() < 0.01);
            assert_eq!(from_first(&samples(n, fps, |t| 0.5 + 0.4 * t)), []);
            assert_eq!(from_first(&samples(n, fps, |t| 0.5 - 0.5 * 5.0 * t * t)), []);
        }
    }

    #[test]
    fn what_flies_away_from_the_camera_seems_smaller_and_is_not() {
        let mut thrown = samples(6, 30.0, |t| 0.5 + 1.0 * t - 0.5 * 9.81 * t * t);
        for (k, sample) in thrown.iter_mut().enumerate() {
            sample.px = 4600 / (k + 1);
        }
        assert_eq!(from_first(&thrown).len(), 1);
        thrown[5].area_m2 /= 2.5;
        assert_eq!(from_first(&thrown)[0].last, 4, "hidden by something");
    }

    #[test]
    fn four_frames_tell_a_flight_of_what_came_in_flying() {
        let falling = |t: f64| 0.5 - 1.5 * t - 0.5 * 9.81 * t * t;
        let came = samples(4, 30.0, falling);
        assert_eq!(from_first(&came).len(), 1);
        let mut reached = came;
        reached[1].reached_by = Some(1);
        assert_eq!(from_first(&reached), [], "a hand has it");
        assert_eq!(from_first(&samples(4, 60.0, falling)), [], "too short a time");
        let slid: Vec<Sample> = samples(4, 30.0, |t| 0.5 - 0.5 * 5.0 * t * t);
        assert_eq!(from_first(&slid), []);
        // The same four frames of what was seen as a whole before.
        let mut seen = samples(7, 30.0, |t| if t < 0.09 { 0.5 } else { falling(t - 0.1) });
        seen[..3].iter_mut().for_each(|sample| (sample.moves, sample.changed) = (false, 0.0));
        assert_eq!(from_first(&seen), []);
        assert_eq!(flights(&seen[3..], 0), [], "its earlier frames were looked at before");
        // And of what was at the border.
        seen[2].at_border = true;
        assert_eq!(from_first(&seen).len(), 1);
    }

    #[test]
    fn a_flight_may_begin_in_a_hand() {
        let mut fall = samples(8, 30.0, |t| 0.5 - 0.5 * 9.81 * t * t);
        for sample in &mut fall[..4] {
            (sample.of_agent, sample.reached_by) = (1.0, Some(1));
        }
        assert_eq!(from_first(&fall).len(), 1);
        for sample in &mut fall {
            (sample.of_agent, sample.reached_by) = (1.0, Some(1));
        }
        assert_eq!(from_first(&fall), [], "nobody lets it go");
    }

    #[test]
    fn a_flight_goes_on_at_its_top_where_hardly_anything_moves() {
        let mut thrown = samples(12, 30.0, |t| 1.8 * t - 0.5 * 9.81 * t * t);
        for sample in &mut thrown[5..7] {
            (sample.moves, sample.changed) = (false, 0.1);
        }
        let found = from_first(&thrown);
        assert_eq!(found.iter().map(|flight| (flight.first, flight.last)).collect::<Vec<_>>(), [(0, 11)]);
    }

    #[test]
    fn bounces_are_flights_of_their_own() {
        let bouncing = |t: f64| {
            let s = t % 0.3;
            1.4715 * s - 0.5 * 9.81 * s * s
        };
        let found = from_first(&samples(27, 30.0, bouncing));
        let spans: Vec<(u64, u64)> = found.iter().map(|flight| (flight.first, flight.last)).collect();
        assert_eq!(spans.len(), 3, "{spans:?}");
        for (k, (first, last)) in spans.into_iter().enumerate() {
            assert!(
                first.abs_diff(9 * k as u64) <= 1 && last.abs_diff(9 * k as u64 + 8) <= 1,
                "{k}: {first} to {last}"
            );
        }
    }
}
