//! What is seen below a part: its support where the two meet, or below where the part ends
//! (docs/CONTEXT.md 4.7.1).

use glam::DVec3;

use crate::clusters::cluster::Clusters;
use crate::clusters::scene::sampled;
use crate::regions::SegmentId;

/// Lines go down in steps of this (m), at most this many.
const STEP_M: f64 = 0.002;
const MOST_STEPS: usize = 150;
/// A line that ends higher than this above the support (m), and than this many quanta, hangs there.
const UNDERSIDE_M: f64 = 0.006;
const UNDERSIDE_QUANTA: f64 = 2.5;

/// Shares of the pixels of a part by what is seen below it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Underside {
    /// The support, below where the part ends.
    pub(super) hanging: f64,
    /// The support, where the part meets it.
    pub(super) standing: f64,
}

impl Underside {
    /// Follows pixels of a part down along gravity, across holes, to the first pixel that is not its own.
    /// Below a standing thing the line leaves the outline of the thing where the thing meets the support, or
    /// lower. O(sampled pixels · steps).
    pub(super) fn of(clusters: &Clusters<'_>, part: SegmentId) -> Self {
        let scene = clusters.scene;
        let pixels = &clusters.get(part).pixels;
        let Some(support) = scene.own_support(pixels) else { return Self::default() };
        let (up, camera, size) =
            (scene.surfaces[support].normal, scene.space.camera(), scene.disparity.size());
        let ends = |from: DVec3| {
            for step in 1..=MOST_STEPS {
                let at = camera.pixel_at(from - step as f64 * STEP_M * up, size)?;
                let facet = scene.facets.segments.at(at).filter(|_| clusters.at_pixel(at) != Some(part));
                if let Some(facet) = facet {
                    return (facet.index() == support).then_some((step, at));
                }
            }
            None
        };
        let (mut hanging, mut standing, mut all) = (0, 0, 0);
        for i in sampled(pixels) {
            all += 1;
            let from = scene.point_at(i);
            let Some((step, seen)) = ends(from) else { continue };
            let least_m = UNDERSIDE_M.max(scene.space.step_m(UNDERSIDE_QUANTA, from.z));
            // A thing that lies flat on the support may count as a part of it.
            if scene.height_over_m(seen, support) > least_m {
                continue;
            }
            if scene.height_over_m(i, support) - step as f64 * STEP_M > least_m {
                hanging += 1;
            } else {
                standing += 1;
            }
        }
        let share = |count: usize| count as f64 / all.max(1) as f64;
        Self { hanging: share(hanging), standing: share(standing) }
    }
}
