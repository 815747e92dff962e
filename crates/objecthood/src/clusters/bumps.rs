//! Gives bumps of a wall to the background (docs/CONTEXT.md 4.3).

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Proposal, Rule, Source};
use crate::clusters::scene::{Scene, sampled};
use crate::quantile::element_at;
use crate::surface::disparity::position;

/// The rise of a cluster is this quantile of its distances from a surface.
const RISE_SHARE: f64 = 0.9;
/// A wall has bumps of at most this many quanta, for each time that the sensor's waves exceed a Kinect's: the
/// tolerance of structure on a Kinect.
const RISE_QUANTA: f64 = 2.5;

/// Gives to the background the clusters that rise no higher above a wall than the waves of the sensor. Does
/// nothing for a sensor with a Kinect's waves: for it the tolerance of structure is wide enough. Supports are
/// left to [`drop_low`](super::height::drop_low). O(clusters · walls).
pub(crate) fn drop_bumps(clusters: &mut Clusters<'_>) {
    let noise = *clusters.scene.space.noise();
    if !noise.is_wavy() {
        return;
    }
    for id in clusters.alive() {
        let Some(rise_quanta) = least_rise_quanta(clusters.scene, &clusters.get(id).pixels) else {
            continue;
        };
        let mut drop = Proposal::new(Rule::Bump, Source::Cluster(id), None);
        let is_bump = drop.check(Check::new(
            "its rise above the wall",
            "quanta",
            rise_quanta,
            Bound::Below,
            RISE_QUANTA * noise.waves(),
        ));
        if is_bump {
            clusters.give(drop.accept(None));
        } else {
            clusters.history.note_misses([drop.refuse()]);
        }
    }
}

/// The rise (quanta) of some pixels above the wall that they follow most closely; `None` without a wall.
fn least_rise_quanta(scene: &Scene<'_>, pixels: &[u32]) -> Option<f64> {
    let walls = (0..scene.surfaces.len()).filter(|wall| !scene.supports.contains(wall));
    let rise = |wall: usize| {
        let model = &scene.surfaces[wall].model;
        let off = |i: usize| {
            (f64::from(scene.disparity[i]) - model.value(position(i, scene.disparity.width()))).abs()
        };
        let mut off: Vec<f64> = sampled(pixels).map(off).collect();
        element_at(&mut off, RISE_SHARE)
    };
    walls.map(rise).min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::testing::{Table, named, single};
    use crate::noise::Noise;

    /// At 1 m a quantum is 3 mm: with three times a Kinect's waves, a wall has bumps of 7.5 quanta or 21 mm.
    #[test]
    fn what_rises_no_higher_than_the_waves_is_a_bump_of_the_wall() {
        let rows = ["____________", "_aaaa__bbbb_", "_aaaa__bbbb_", "____________"];
        let wall = Table::drawn(&rows, &[0.018, 0.025]);
        let left = |scene: &Scene<'_>| {
            let mut clusters = single(scene);
            drop_bumps(&mut clusters);
            named(&clusters)
        };
        let kinect = wall.scene().space.noise().blocks_quanta;
        let noisy = wall
            .scene()
            .space
            .with_noise(Noise { white: 1.0, blocks_quanta: [kinect[0], 3.0 * kinect[1], 3.0 * kinect[2]] });
        let seen = Scene { supports: &[], ..wall.scene() };
        assert_eq!(left(&Scene { space: &noisy, ..seen }), [None, Some(1)]);
        assert_eq!(left(&seen), [Some(0), Some(1)], "a Kinect has no such waves");
        let table = Scene { space: &noisy, ..wall.scene() };
        assert_eq!(left(&table), [Some(0), Some(1)], "on a support the height decides");
    }
}
