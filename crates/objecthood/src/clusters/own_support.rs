//! The support below a cluster, over which its height is measured (docs/CONTEXT.md 4.1).

use crate::clusters::scene::{Scene, sampled};
use crate::quantile::element_at;

/// The foot of a cluster is this quantile of its heights.
const FOOT_SHARE: f64 = 0.1;
/// A foot may lie this much (m) below its support: noise, and rounded edges.
const SLACK_M: f64 = 0.02;

impl<'a> Scene<'a> {
    /// The highest support below the foot of some pixels that goes on below them; without one, the ground. O(1).
    pub(crate) fn own_support(&self, pixels: &[u32]) -> Option<usize> {
        let (ground, others) = self.supports.split_first()?;
        if others.is_empty() {
            return Some(*ground);
        }
        let sample: Vec<usize> = sampled(pixels).collect();
        let foot_m = |support: usize| self.height_quantile_m(sample.iter().copied(), support, FOOT_SHARE);
        let below = self.supports.iter().filter_map(|&k| {
            let foot_m = foot_m(k);
            (foot_m > -SLACK_M && self.goes_on_below(&sample, k)).then_some((foot_m, k))
        });
        Some(below.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(*ground, |(_, k)| k))
    }

    /// The height (m) above a support below which this share of some pixels lies. O(pixels).
    pub(crate) fn height_quantile_m(
        &self,
        pixels: impl Iterator<Item = usize>,
        support: usize,
        share: f64,
    ) -> f64 {
        let mut heights: Vec<f64> = pixels.map(|i| self.height_over_m(i, support)).collect();
        element_at(&mut heights, share)
    }

    /// Height (m) of a pixel above a support. Other supports than the ground may be far away and small: there a plane goes on, and a
    /// quadratic bends off.
    pub(crate) fn height_over_m(&self, i: usize, support: usize) -> f64 {
        if self.supports.first() == Some(&support) {
            return self.height_m(i, &self.surfaces[support]);
        }
        self.planes[support].height_m(self.point_at(i))
    }

    /// Whether a support goes on below most of some pixels: dropped onto it, they lie on it, behind something nearer, on a hole or
    /// outside the image.
    fn goes_on_below(&self, sample: &[usize], support: usize) -> bool {
        let (surface, camera) = (&self.surfaces[support], self.space.camera());
        let is_over = |&&i: &&usize| {
            let foot = self.point_at(i) - self.height_over_m(i, support) * surface.normal;
            let Some(at) = camera.pixel_at(foot, self.disparity.size()) else { return true };
            let seen_m = self.space.depth_m(self.disparity[at].into());
            let is_it = self.facets.segments.at(at).is_some_and(|facet| facet.index() == support);
            is_it || seen_m.is_nan() || seen_m < foot.z
        };
        2 * sample.iter().filter(is_over).count() >= sample.len()
    }
}
