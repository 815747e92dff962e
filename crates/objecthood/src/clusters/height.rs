//! Gives clusters that hardly rise above the support to the background (docs/CONTEXT.md 4.3).

use rayon::prelude::*;

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Proposal, Rule, Source};
use crate::params;
use crate::regions::SegmentId;
use crate::surface::disparity::DisparitySpace;

/// `min_top_m` holds where noise is less than this (m), the default; farther away the limit grows with the noise.
const NEAR_M: f64 = 0.010;
/// Heights below this many quanta of a Kinect are noise where a cluster has few pixels: six standard deviations of a depth.
const NOISE_QUANTA: f64 = 6.0;
/// Noise of pixels averages out over a large cluster, and what is left are waves: the tolerance of structure on a Kinect, in proportion more
/// with a sensor of larger waves.
const WAVE_QUANTA: f64 = 2.5;
/// A cluster of this many pixels (at 525 px), the largest fragment, is small. Pixels average out with the root of their number.
const SMALL_PX: usize = 250;

/// Gives clusters whose top is less than `min_top_m` above the support surface to the background. They are remains of the table, or
/// small pieces at the edge of the view. Flat things have other evidence and stay. Does nothing without a support surface. O(pixels of clusters).
pub(crate) fn drop_low(clusters: &mut Clusters<'_>, params: &params::Height) {
    let alive: Vec<SegmentId> =
        clusters.alive().into_iter().filter(|&id| clusters.flat(id).is_none()).collect();
    let before = &*clusters;
    // Giving a cluster away changes no other cluster's top.
    let top_and_limit = |&id: &SegmentId| Some((before.own_top_m(id)?, least_top_m(before, id, params)));
    let tops_m: Vec<Option<(f64, f64)>> = alive.par_iter().map(top_and_limit).collect();
    for (id, top_m) in alive.into_iter().zip(tops_m) {
        let Some((top_m, least_m)) = top_m else { continue };
        let mut drop = Proposal::new(Rule::Low, Source::Cluster(id), None);
        let is_low = drop.check(
            Check::new("its top above the support", "m", top_m, Bound::Below, least_m)
                .set_by("height.min_top_m"),
        );
        if is_low {
            clusters.give(drop.accept(None));
        } else {
            clusters.history.note_misses([drop.refuse()]);
        }
    }
}

/// The lowest top of a thing (m): `min_top_m`, in proportion less with a better sensor than a Kinect, and more where noise alone makes
/// such heights.
fn least_top_m(clusters: &Clusters<'_>, id: SegmentId, params: &params::Height) -> f64 {
    let (space, normal) = (clusters.scene.space, clusters.scene.ground().map(|ground| ground.normal));
    let pixels = &clusters.get(id).pixels;
    let middle = pixels[pixels.len() / 2] as usize;
    let point = clusters.scene.point_at(middle);
    let along = normal.map_or(0.0, |normal| normal.dot(point / point.z).abs());
    let growth = (along * space.step_m(least_quanta(pixels.len(), space), point.z) / NEAR_M).max(1.0);
    space.noise().step_scale() * growth * params.min_top_m
}

/// How high (quanta) noise and waves make a cluster of so many pixels.
fn least_quanta(size_px: usize, space: &DisparitySpace) -> f64 {
    let waves = (WAVE_QUANTA * space.noise().waves().max(1.0)).min(NOISE_QUANTA);
    let small = (space.area_px(SMALL_PX) as f64 / size_px as f64).sqrt().min(1.0);
    waves + (NOISE_QUANTA - waves) * small
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::scene::Scene;
    use crate::clusters::testing::{Table, named, single};
    use crate::noise::Noise;

    #[test]
    fn what_is_low_is_a_part_of_the_table() {
        let rows = ["____________", "_aaaa__bbbb_", "_aaaa__bbbb_", "____________"];
        let table = Table::drawn(&rows, &[0.016, 0.018]);
        let dropped = |scene: &Scene<'_>| {
            let mut clusters = single(scene);
            drop_low(&mut clusters, &params::Height { min_top_m: 0.010 });
            let (named, clusters) = (named(&clusters), clusters.finish());
            (named, clusters.remains.len(), clusters.clusters.len())
        };
        assert_eq!(dropped(&table.scene()), (vec![None, Some(1)], 8, 1));
        let unsupported = Scene { supports: &[], ..table.scene() };
        assert_eq!(dropped(&unsupported), (vec![Some(0), Some(1)], 0, 2));
    }

    /// At 1 m, seen from straight above, six quanta are 17 mm; a sensor with less noise resolves less.
    #[test]
    fn the_lowest_top_follows_the_sensor() {
        let table = Table::drawn(&["____________", "_aaaa_______"], &[0.012]);
        let is_kept = |scene: &Scene<'_>| {
            let mut clusters = single(scene);
            drop_low(&mut clusters, &params::Height { min_top_m: 0.010 });
            !clusters.alive().is_empty()
        };
        let better = table.scene().space.with_noise(Noise { white: 0.1, blocks_quanta: [0.01; 3] });
        assert!(!is_kept(&table.scene()));
        assert!(is_kept(&Scene { space: &better, ..table.scene() }));
    }

    /// A regression: the limit was six quanta for any cluster, 68 mm at 2 m.
    #[test]
    fn what_is_large_is_kept_where_noise_of_few_pixels_is_as_high() {
        let space = crate::testing::kinect();
        let least_m = |size_px: usize, z_m: f64| space.step_m(least_quanta(size_px, &space), z_m);
        assert!(least_m(100, 2.0) > 0.06 && least_m(100, 2.0) == least_m(250, 2.0));
        assert!(least_m(4000, 2.0) < 0.04);
        assert!(least_m(1_000_000, 1.0) < 0.0075);
        let stereo = space.with_noise(Noise { white: 2.0, blocks_quanta: [0.6, 0.6, 0.5] });
        assert_eq!(least_quanta(1_000_000, &stereo), 6.0, "its waves are as high");
    }

    #[test]
    fn the_top_is_nearly_the_highest_pixel() {
        // 400 pixels at 5 mm with some noise: 1 % of high pixels does not change the top, 5 % do.
        for (noisy, is_kept) in [(4, false), (20, true)] {
            let table = Table::new((20, 20), |u, v| Some((1, if 20 * v + u < noisy { 0.05 } else { 0.005 })));
            let scene = table.scene();
            let mut clusters = single(&scene);
            drop_low(&mut clusters, &params::Height { min_top_m: 0.010 });
            assert_eq!(clusters.alive().len(), usize::from(is_kept), "{noisy}");
        }
    }
}
