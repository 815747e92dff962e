//! The support below a cluster, above which its height is measured (docs/CONTEXT.md 4.1).

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

    /// A quantile of the heights (m) of some pixels above their own support; 0 without a support. O(1).
    pub(crate) fn own_height_m(&self, pixels: &[u32], share: f64) -> f64 {
        let support = self.own_support(pixels);
        support.map_or(0.0, |support| self.height_quantile_m(sampled(pixels), support, share))
    }

    /// Height (m) of a pixel above a support. Other supports than the ground may be far away and small: there a plane goes on, and a
    /// quadratic bends off.
    pub(crate) fn height_over_m(&self, i: usize, support: usize) -> f64 {
        if self.supports.first() == Some(&support) {
            return self.height_m(i, &self.surfaces[support]);
        }
        self.planes[support].height_m(self.point_at(i))
    }

    /// Whether a support goes on below most of some pixels. Dropped onto it, they lie on it, behind something
    /// nearer, in a hole or outside the image.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::testing::Table;
    use crate::oversegment::structure::StructureSurface;
    use crate::planes::StructurePlane;

    const SIZE: (usize, usize) = (120, 30);
    /// Height of the board above the table (m); facet 1.
    const BOARD_M: f64 = 0.3;

    /// Facet 2 at these columns, from this height (m) on one centimetre higher in each, in a scene with a board in columns 20 to 60; the
    /// support that is its own.
    fn own_support(columns: std::ops::Range<usize>, height_m: f64, supports: &[usize]) -> Option<usize> {
        let table = Table::new(SIZE, |u, v| {
            Some(match u {
                u if columns.contains(&u) && (10..20).contains(&v) => {
                    (2, height_m + 0.01 * (u - columns.start) as f64)
                }
                20..60 => (1, BOARD_M),
                _ => (0, 0.0),
            })
        });
        let level = |distance_m: f64| StructurePlane {
            normal: [0.0, 0.0, -1.0],
            offset_m: distance_m as f32,
            inlier_share: 0.5,
        };
        let planes = [level(1.0), level(1.0 - BOARD_M)];
        let plain = table.scene();
        let surface = |k: usize| StructureSurface {
            model: table.facets.models[k],
            offset_m: f64::from(planes[k].offset_m),
            ..plain.surfaces[0].clone()
        };
        let surfaces = [surface(0), surface(1)];
        let scene = Scene { surfaces: &surfaces, planes: &planes, supports, ..plain };
        let segments = &scene.facets.segments;
        let pixels: Vec<u32> = segments.members().filter(|m| m.1 == 2).map(|m| m.0 as u32).collect();
        scene.own_support(&pixels)
    }

    #[test]
    fn a_thing_has_the_highest_support_below_its_foot() {
        assert_eq!(own_support(30..40, 0.4, &[0, 1]), Some(1), "on the board");
        assert_eq!(own_support(30..40, 0.4, &[1, 0]), Some(1), "whichever comes first");
        assert_eq!(own_support(80..90, 0.1, &[0, 1]), Some(0), "lower than the board");
        assert_eq!(own_support(30..40, 0.285, &[0, 1]), Some(1), "a foot may lie a little below its support");
        assert_eq!(own_support(30..40, 0.265, &[0, 1]), Some(0), "but not by more than that");
    }

    #[test]
    fn a_support_has_to_go_on_below_it() {
        // As high as if on the board, and beside it: what lies below is the table.
        assert_eq!(own_support(104..112, 0.4, &[0, 1]), Some(0));
    }

    #[test]
    fn with_one_support_it_is_that_and_without_there_is_none() {
        assert_eq!(own_support(30..40, 0.4, &[0]), Some(0));
        assert_eq!(own_support(30..40, 0.4, &[]), None);
    }
}
