//! Random planes through three samples, and their votes: the number of samples near each (docs/CONTEXT.md
//! 1.1.1, step 2).
//!
//! Most planes are far from most samples. Bounds tell so for samples that lie side by side, and only the others are looked at.

use std::cmp::Reverse;

use rayon::prelude::*;

use super::sample::Sample;
use crate::random::Lcg;
use crate::simd::vectorized;
use crate::surface::disparity::DisparitySpace;

/// Random planes tried in a round.
const TRIALS: usize = 300;
/// Twice the least area of the triangle of a trial (px^2 at 525 px).
const LEAST_TRIANGLE_PX: usize = 400;
/// A sample nearer than this (quanta of a Kinect) votes for a plane.
const TRIAL_QUANTA: f64 = 2.0;
/// Least number of votes of a plane.
const LEAST_VOTES: usize = 100;

/// Finds the plane a u + b v + c through three random samples with the most votes; `None` when no plane has a hundred.
/// `grid`: distance (px) of the samples. O(planes · samples); the bounds of the planes in parallel.
pub(super) fn find_best_plane(
    pool: &[Sample],
    random: &mut Lcg,
    space: &DisparitySpace,
    grid: usize,
) -> Option<[f64; 3]> {
    let tolerance_quanta = space.noise().pixel_scale() * TRIAL_QUANTA;
    let least_triangle = space.area_px(LEAST_TRIANGLE_PX) as f64;
    let mut trial = |_| {
        let [p, q, r] = std::array::from_fn(|_| &pool[random.below(pool.len())]);
        let ([x1, y1], [x2, y2]) = ([0, 1].map(|k| q.at[k] - p.at[k]), [0, 1].map(|k| r.at[k] - p.at[k]));
        let triangle = x1 * y2 - x2 * y1;
        if triangle.abs() < least_triangle {
            return None;
        }
        let (d1, d2) = (q.disparity - p.disparity, r.disparity - p.disparity);
        let a = (d1 * y2 - d2 * y1) / triangle;
        let b = (x1 * d2 - x2 * d1) / triangle;
        let c = p.disparity - a * p.at[0] - b * p.at[1];
        Some([a, b, c])
    };
    let planes: Vec<[f64; 3]> = (0..TRIALS).filter_map(&mut trial).collect();
    Some(planes[find_best(&planes, &Groups::of(pool, grid), tolerance_quanta)?])
}

/// The plane that most samples are near to, the first of equals; `None` when none has a hundred.
///
/// Each plane first gets an upper bound of its votes. Then votes are counted, from the highest bound down, until the next bound is
/// below the best count. Few planes are counted, so this is not done in parallel.
fn find_best(planes: &[[f64; 3]], groups: &Groups, quanta: f64) -> Option<usize> {
    let most_votes = |plane: &[f64; 3]| groups.most_votes(*plane, quanta);
    let mut open: Vec<(usize, usize)> = planes.par_iter().map(most_votes).zip(0..planes.len()).collect();
    open.sort_unstable_by_key(|&(votes, k)| (Reverse(votes), k));
    let mut best: Option<(usize, Reverse<usize>)> = None;
    for (possible, k) in open {
        let least = best.map_or(LEAST_VOTES, |best| best.0);
        if possible < least {
            break;
        }
        let votes = groups.count_votes(planes[k], quanta, possible, least);
        best = best.max(votes.map(|votes| (votes, Reverse(k))));
    }
    best.map(|(_, Reverse(k))| k)
}

/// A group has at most this many samples: it spans so many steps of the grid along a row.
const GROUP_SAMPLES: usize = 16;
/// Values of a plane are rounded by less than this share of the sum of their terms.
const ROUNDING: f64 = 1e-12;

/// The samples in groups of neighbours in a row.
struct Groups {
    samples: Vec<Group>,
    /// Of each group, the column in the middle of where its samples can lie, ...
    u: Vec<f64>,
    /// ... its row, ...
    v: Vec<f64>,
    /// ... the middle of the range of its disparities, ...
    disparity: Vec<f64>,
    /// ... half of that range, ...
    half_range: Vec<f64>,
    /// ... and the number of its samples.
    size: Vec<i32>,
    /// Half the width of a group (px).
    half_width: f64,
    /// The greatest column and row.
    last: [f64; 2],
}

impl Groups {
    /// The samples, which are in scan order and at least `grid` columns apart, in groups. O(samples).
    fn of(pool: &[Sample], grid: usize) -> Self {
        let width = (GROUP_SAMPLES * grid) as f64;
        let place = |s: &Sample| ((s.at[0] / width) as usize, s.at[1]);
        let groups: Vec<&[Sample]> = pool.chunk_by(|a, b| place(a) == place(b)).collect();
        let limits = |group: &&[Sample]| {
            let all = group.iter().map(|s| s.disparity);
            all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], d| [low.min(d), high.max(d)])
        };
        let limits: Vec<[f64; 2]> = groups.iter().map(limits).collect();
        Self {
            samples: groups.iter().map(|group| Group::of(group)).collect(),
            u: groups.iter().map(|group| (place(&group[0]).0 as f64 + 0.5) * width).collect(),
            v: groups.iter().map(|group| group[0].at[1]).collect(),
            disparity: limits.iter().map(|[low, high]| 0.5 * (low + high)).collect(),
            half_range: limits.iter().map(|[low, high]| 0.5 * (high - low)).collect(),
            size: groups.iter().map(|group| group.len() as i32).collect(),
            half_width: 0.5 * width,
            last: [0, 1].map(|k| pool.iter().map(|s| s.at[k]).fold(0.0, f64::max)),
        }
    }

    /// Counts the samples near a plane, which has at most so many `possible` votes. `None` for fewer than `least`; the count stops as soon
    /// as it cannot reach `least`.
    fn count_votes(&self, plane: [f64; 3], quanta: f64, mut possible: usize, least: usize) -> Option<usize> {
        let is_near = self.is_near(plane, quanta);
        for group in (0..self.samples.len()).filter(|&group| is_near(group)) {
            if possible < least {
                return None;
            }
            let votes = vectorized(
                #[inline(always)]
                || self.samples[group].count_votes_in_row(self.v[group], plane, quanta),
            );
            possible -= self.size[group] as usize - votes;
        }
        (possible >= least).then_some(possible)
    }

    /// The number of samples in groups of which some may lie near a plane.
    fn most_votes(&self, plane: [f64; 3], quanta: f64) -> usize {
        vectorized(
            #[inline(always)]
            || {
                let is_near = self.is_near(plane, quanta);
                let votes = (0..self.size.len()).map(|group| -i32::from(is_near(group)) & self.size[group]);
                votes.sum::<i32>() as usize
            },
        )
    }

    /// Whether some samples of a group may lie near a plane.
    #[inline(always)]
    fn is_near(&self, [a, b, c]: [f64; 3], quanta: f64) -> impl Fn(usize) -> bool {
        let terms = a.abs() * (self.last[0] + self.half_width) + b.abs() * self.last[1] + c.abs();
        let reach = quanta + a.abs() * self.half_width + ROUNDING * terms;
        // As slices of one length, so that the loop over them checks no bounds.
        let [u, v, d, half_range] =
            [&self.u, &self.v, &self.disparity, &self.half_range].map(|of| &of[..self.size.len()]);
        move |k| (d[k] - (a * u[k] + b * v[k] + c)).abs() <= half_range[k] + reach
    }
}

/// Column and disparity of the samples of a group, in separate lists. Unused places are near no plane.
struct Group {
    u: [f64; GROUP_SAMPLES],
    disparity: [f64; GROUP_SAMPLES],
}

impl Group {
    fn of(group: &[Sample]) -> Self {
        let mut samples = Self { u: [0.0; GROUP_SAMPLES], disparity: [f64::NAN; GROUP_SAMPLES] };
        for (k, sample) in group.iter().enumerate() {
            (samples.u[k], samples.disparity[k]) = (sample.at[0], sample.disparity);
        }
        samples
    }

    /// Counts the samples near a plane. `v`: their row.
    #[inline(always)]
    fn count_votes_in_row(&self, v: f64, [a, b, c]: [f64; 3], quanta: f64) -> usize {
        let Self { u, disparity } = self;
        (0..GROUP_SAMPLES)
            .map(|k| u64::from((disparity[k] - (a * u[k] + b * v + c)).abs() < quanta))
            .sum::<u64>() as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::disparity::position;

    #[test]
    fn votes_are_given_up_only_below_the_least() {
        let sample = |k: usize| Sample { pixel: k, at: position(k, 40), disparity: 300.0 + (k % 7) as f64 };
        let pool: Vec<Sample> = (0..700).filter(|k| k % 11 != 0).map(sample).collect();
        let groups = Groups::of(&pool, 1);
        for plane in [[0.0, 0.0, 303.0], [0.1, -0.05, 300.0], [1.0, 0.0, 290.0], [0.0, 0.0, 500.0]] {
            let near = |s: &&Sample| {
                let [u, v] = s.at;
                (s.disparity - (plane[0] * u + plane[1] * v + plane[2])).abs() < TRIAL_QUANTA
            };
            let all = pool.iter().filter(near).count();
            let possible = groups.most_votes(plane, TRIAL_QUANTA);
            assert!(possible >= all);
            let count = |least: usize| groups.count_votes(plane, TRIAL_QUANTA, possible, least);
            assert_eq!(count(all), Some(all), "as many as the best so far");
            assert_eq!(count(0), Some(all));
            assert_eq!(count(all + 1), None);
        }
    }

    /// Groups of several widths, with gaps and equal planes, against all samples one by one.
    #[test]
    fn the_best_plane_is_the_first_with_the_most_votes() {
        let mut random = Lcg::new(3);
        for grid in [1, 3, 6] {
            let mut pool = Vec::new();
            for v in 0..40 {
                for u in 0..40 {
                    if random.below(5) > 0 {
                        let at = [(u * grid + grid / 3) as f64, (v * grid) as f64];
                        let disparity = 300.0 + 0.02 * at[0] + random.below(9) as f64;
                        pool.push(Sample { pixel: 0, at, disparity });
                    }
                }
            }
            let plane = |k: usize| [0.01 * (k % 4) as f64, 0.0, 299.0 + (k % 6) as f64];
            let planes: Vec<[f64; 3]> = (0..40).map(plane).collect();
            let votes = |[a, b, c]: &[f64; 3]| {
                let near = |s: &&Sample| (s.disparity - (a * s.at[0] + b * s.at[1] + c)).abs() < TRIAL_QUANTA;
                pool.iter().filter(near).count()
            };
            let all: Vec<usize> = planes.iter().map(votes).collect();
            let most = *all.iter().max().expect("planes");
            let groups = Groups::of(&pool, grid);
            assert!(most > LEAST_VOTES && all.iter().any(|&votes| votes < most / 2));
            assert_eq!(
                find_best(&planes, &groups, TRIAL_QUANTA),
                all.iter().position(|&votes| votes == most)
            );
            assert_eq!(find_best(&[[0.0, 0.0, 900.0]], &groups, TRIAL_QUANTA), None);
        }
    }
}
