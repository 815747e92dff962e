//! Random planes through three samples, and their votes: the number of samples near each (docs/CONTEXT.md
//! 1.1.1, step 2).

use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering::Relaxed;

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
///
/// All planes are drawn first; their votes are counted in parallel. Among planes with the most votes the first one drawn wins,
/// whatever the order of counting.
pub(super) fn find_best_plane(pool: &[Sample], random: &mut Lcg, space: &DisparitySpace) -> Option<[f64; 3]> {
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
    let voters: Vec<Voters> = pool.chunks(VOTERS).map(Voters::of).collect();
    let most = AtomicUsize::new(LEAST_VOTES);
    let count = |&plane: &[f64; 3]| {
        let votes = count_votes(&voters, pool.len(), plane, tolerance_quanta, most.load(Relaxed))?;
        most.fetch_max(votes, Relaxed);
        Some((votes, plane))
    };
    let counted: Vec<Option<(usize, [f64; 3])>> = planes.par_iter().map(count).collect();
    let first_best = |best: (usize, _), next: (usize, _)| if next.0 > best.0 { next } else { best };
    counted.into_iter().flatten().reduce(first_best).map(|(_, plane)| plane)
}

/// Counts the samples near a plane. `None` for fewer than `least`; the count stops as soon as it cannot reach `least`.
fn count_votes(
    voters: &[Voters],
    mut left: usize,
    plane: [f64; 3],
    tolerance_quanta: f64,
    least: usize,
) -> Option<usize> {
    let mut votes = 0;
    for voters in voters {
        if votes + left < least {
            return None;
        }
        votes += vectorized(
            #[inline(always)]
            || voters.count_near(plane, tolerance_quanta),
        );
        left = left.saturating_sub(VOTERS);
    }
    (votes >= least).then_some(votes)
}

/// Samples of a block, whose votes are counted together.
const VOTERS: usize = 256;

/// Column, row and disparity of a block of samples, in separate lists. Unused places never vote.
struct Voters {
    u: [f64; VOTERS],
    v: [f64; VOTERS],
    disparity: [f64; VOTERS],
}

impl Voters {
    fn of(pool: &[Sample]) -> Self {
        let mut voters = Self { u: [0.0; VOTERS], v: [0.0; VOTERS], disparity: [f64::NAN; VOTERS] };
        for (k, sample) in pool.iter().enumerate() {
            ([voters.u[k], voters.v[k]], voters.disparity[k]) = (sample.at, sample.disparity);
        }
        voters
    }

    /// Counts the samples near a plane.
    #[inline(always)]
    fn count_near(&self, [a, b, c]: [f64; 3], quanta: f64) -> usize {
        let Self { u, v, disparity } = self;
        (0..VOTERS).map(|k| u64::from((disparity[k] - (a * u[k] + b * v[k] + c)).abs() < quanta)).sum::<u64>()
            as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::disparity::position;

    #[test]
    fn votes_are_given_up_only_below_the_least() {
        let sample = |k: usize| Sample { pixel: k, at: position(k, 40), disparity: 300.0 + (k % 7) as f64 };
        let pool: Vec<Sample> = (0..3 * VOTERS + 17).map(sample).collect();
        let voters: Vec<Voters> = pool.chunks(VOTERS).map(Voters::of).collect();
        for plane in [[0.0, 0.0, 303.0], [0.1, -0.05, 300.0], [0.0, 0.0, 500.0]] {
            let near = |s: &&Sample| {
                let [u, v] = s.at;
                (s.disparity - (plane[0] * u + plane[1] * v + plane[2])).abs() < TRIAL_QUANTA
            };
            let all = pool.iter().filter(near).count();
            assert_eq!(
                count_votes(&voters, pool.len(), plane, TRIAL_QUANTA, all),
                Some(all),
                "as many as the best so far"
            );
            assert_eq!(count_votes(&voters, pool.len(), plane, TRIAL_QUANTA, 0), Some(all));
            assert_eq!(count_votes(&voters, pool.len(), plane, TRIAL_QUANTA, all + 1), None);
        }
    }
}
