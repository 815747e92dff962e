//! The circle of a vessel's rim (docs/CONTEXT.md 4.4.2).

use std::f64::consts::{PI, TAU};

use glam::Vec3;

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::scene::Scene;
use crate::discovery::join::RimCircle;
use crate::linear::length;
use crate::oversegment::structure::StructureSurface;
use crate::regions::SegmentId;
use crate::tangents::tangents;

/// The rim of a vessel: all points within this height (m) of the top.
const BAND_M: f64 = 0.012;
/// Least number of points that a circle is fitted to.
const LEAST_POINTS: usize = 20;
/// Least determinant (m^4) of the second moments of the rim's points: below it they lie in a line and give no circle.
const LEAST_SPREAD: f64 = 1e-12;
/// Radius of the rims of vessels that a hand can hold (m).
const RADIUS_M: std::ops::Range<f64> = 0.02..0.2;
/// Root mean square distance (m) of a rim's points from its circle, at most; or this share of the radius if that is more.
const RESIDUAL_M: f64 = 0.006;
const RESIDUAL_SHARE: f64 = 0.12;
/// Number of sectors into which a circle is divided.
const SECTORS: usize = 12;
/// Least number of sectors that must hold points.
const LEAST_SECTORS: usize = 7;
/// A sector holds points when it has this many, or one in `POINTS_PER_HOLD` of all points if that is more.
const LEAST_HOLD: usize = 2;
const POINTS_PER_HOLD: usize = 200;
/// A vessel may bulge beyond the circle of its rim by this much (m), or by this share of the radius if that is more.
const BULGE_M: f64 = 0.012;
const BULGE_SHARE: f64 = 0.12;

/// The foot of a point: its projection onto the support plane, as coordinates (m) along the plane's tangents.
fn foot_m(scene: &Scene<'_>, i: u32, support: &StructureSurface) -> [f64; 2] {
    let point = Vec3::from(scene.points_m[i as usize]).as_dvec3();
    tangents(support.normal).map(|t| t.dot(point))
}

/// Fits a circle to the feet of some clusters' points near the height `top_m` (algebraic fit, Kåsa 1976). O(pixels).
///
/// # Errors
/// The checks made, when one of them fails: the circle is no rim of a vessel.
pub(crate) fn fit_rim_circle(
    clusters: &Clusters<'_>,
    ids: &[SegmentId],
    top_m: f64,
    support: &StructureSurface,
) -> Result<RimCircle, Vec<Check>> {
    let scene = clusters.scene;
    let pixels = ids.iter().flat_map(|&id| &clusters.get(id).pixels);
    let on_rim = pixels.filter(|&&i| (scene.height_m(i as usize, support) - top_m).abs() < BAND_M);
    let feet_m: Vec<[f64; 2]> = on_rim.map(|&i| foot_m(scene, i, support)).collect();
    let count = feet_m.len() as f64;
    let points = Check::new("points of the rim", "px", count, Bound::AtLeast, LEAST_POINTS as f64);
    if !points.holds() {
        return Err(vec![points]);
    }
    let moments = FeetMoments::of(&feet_m);
    let spread = moments.determinant();
    let spread = Check::new("spread of the rim's points", "m^4", spread, Bound::AtLeast, LEAST_SPREAD);
    if !spread.holds() {
        return Err(vec![points, spread]);
    }
    let circle = moments.fit_circle(&feet_m);
    let checks = check_circle(&circle);
    if checks.iter().all(Check::holds) {
        Ok(circle)
    } else {
        Err([points, spread].into_iter().chain(checks).collect())
    }
}

/// The mean of some feet, and sums of products of their coordinates about it. r is the squared distance from the mean.
struct FeetMoments {
    mean: [f64; 2],
    xx: f64,
    xy: f64,
    yy: f64,
    xr: f64,
    yr: f64,
}

impl FeetMoments {
    fn of(feet_m: &[[f64; 2]]) -> Self {
        let n = feet_m.len() as f64;
        let mean = [0, 1].map(|k| feet_m.iter().map(|foot| foot[k]).sum::<f64>() / n);
        let mut moments = Self { mean, xx: 0.0, xy: 0.0, yy: 0.0, xr: 0.0, yr: 0.0 };
        for [x, y] in moments.about_mean(feet_m) {
            let squared = x * x + y * y;
            moments.xx += x * x;
            moments.xy += x * y;
            moments.yy += y * y;
            moments.xr += x * squared;
            moments.yr += y * squared;
        }
        moments
    }

    fn about_mean<'a>(&self, feet_m: &'a [[f64; 2]]) -> impl Iterator<Item = [f64; 2]> + use<'a> {
        let mean = self.mean;
        feet_m.iter().map(move |foot| [foot[0] - mean[0], foot[1] - mean[1]])
    }

    fn determinant(&self) -> f64 {
        self.xx * self.yy - self.xy * self.xy
    }

    /// The circle that fits best, with the distance of the feet from it and the share of it that they cover.
    fn fit_circle(&self, feet_m: &[[f64; 2]]) -> RimCircle {
        let &Self { mean, xx, xy, yy, xr, yr } = self;
        let n = feet_m.len() as f64;
        let determinant = self.determinant();
        let x_center = (xr * yy - yr * xy) / (2.0 * determinant);
        let y_center = (yr * xx - xr * xy) / (2.0 * determinant);
        let radius_m = (x_center * x_center + y_center * y_center + (xx + yy) / n).sqrt();

        let from_center = || self.about_mean(feet_m).map(|[x, y]| [x - x_center, y - y_center]);
        let squared_error: f64 = from_center().map(|offset| (length(offset) - radius_m).powi(2)).sum();
        RimCircle {
            center_m: [mean[0] + x_center, mean[1] + y_center],
            radius_m,
            residual_m: (squared_error / n).sqrt(),
            covered: measure_covered(from_center()),
        }
    }
}

/// The share of a circle's sectors that hold points; `from_center`: the points, from its centre (m). O(points).
pub(crate) fn measure_covered(from_center: impl Iterator<Item = [f64; 2]>) -> f64 {
    let mut held = [0_usize; SECTORS];
    let mut count = 0;
    for [x, y] in from_center {
        let turn = (libm::atan2(y, x) + PI) / TAU;
        held[((turn * SECTORS as f64) as usize).min(SECTORS - 1)] += 1;
        count += 1;
    }
    let least_hold = LEAST_HOLD.max(count / POINTS_PER_HOLD);
    held.iter().filter(|&&points| points >= least_hold).count() as f64 / SECTORS as f64
}

/// Checks that a circle can be the rim of a vessel.
pub(crate) fn check_circle(circle: &RimCircle) -> [Check; 4] {
    let &RimCircle { radius_m, residual_m, covered, .. } = circle;
    let [low, high] = check_radius("radius of the rim", radius_m);
    let residual_limit_m = RESIDUAL_M.max(RESIDUAL_SHARE * radius_m);
    let residual =
        Check::new("distance of the rim from a circle", "m", residual_m, Bound::Below, residual_limit_m);
    [low, high, residual, check_covered(covered)]
}

/// Checks that a radius is that of a vessel that a hand can hold.
pub(crate) fn check_radius(what: &'static str, radius_m: f64) -> [Check; 2] {
    let radius = |bound, limit_m| Check::new(what, "m", radius_m, bound, limit_m);
    [radius(Bound::AtLeast, RADIUS_M.start), radius(Bound::Below, RADIUS_M.end)]
}

/// Checks that more than half of a circle is seen: from outside, a camera sees less of a solid thing.
pub(crate) fn check_covered(covered: f64) -> Check {
    let least = LEAST_SECTORS as f64 / SECTORS as f64;
    Check::new("share of the circle that is seen", "", covered, Bound::AtLeast, least)
}

/// The share of a cluster's pixels that stand within the circle or hardly outside it, from every third pixel.
pub(crate) fn measure_share_within(
    clusters: &Clusters<'_>,
    id: SegmentId,
    rim: &RimCircle,
    support: &StructureSurface,
) -> f64 {
    let limit_m = rim.radius_m + BULGE_M.max(BULGE_SHARE * rim.radius_m);
    let (mut within, mut all) = (0, 0);
    for &i in clusters.get(id).pixels.iter().step_by(3) {
        let [x, y] = foot_m(clusters.scene, i, support);
        let (x, y) = (x - rim.center_m[0], y - rim.center_m[1]);
        all += 1;
        within += usize::from(x * x + y * y <= limit_m * limit_m);
    }
    within as f64 / all.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::testing::{Table, single};

    /// Position of the ring (m right of and below the camera), and its height.
    const MIDDLE_M: [f64; 2] = [0.012, -0.007];
    const TOP_M: f64 = 0.08;

    /// An image of a ring, of which the part at angle `turn` (0 to 1) exists or not. Facet 2 stands inside it and is lower.
    fn ring(radius_m: f64, is_there: impl Fn(f64) -> bool) -> Table {
        Table::new((160, 140), |u, v| {
            // Metres at the height of the rim.
            let [x, y] = [u as f64 - 79.5, v as f64 - 69.5].map(|px| px * (1.0 - TOP_M) / 525.0);
            let [x, y] = [x - MIDDLE_M[0], y - MIDDLE_M[1]];
            let off_m = x.hypot(y) - radius_m;
            let turn = libm::atan2(y, x) / std::f64::consts::TAU + 0.5;
            match off_m {
                off if off.abs() < 0.003 && is_there(turn) => Some((1, TOP_M)),
                off if off < -0.01 => Some((2, 0.03)),
                _ => Some((0, 0.0)),
            }
        })
    }

    fn circle(table: &Table) -> Option<RimCircle> {
        let scene = table.scene();
        fit_rim_circle(&single(&scene), &[SegmentId(0)], TOP_M, scene.ground().unwrap()).ok()
    }

    #[test]
    fn the_circle_of_a_rim_is_recovered() {
        for radius_m in [0.03, 0.05, 0.09] {
            let table = ring(radius_m, |_| true);
            let rim = circle(&table).unwrap();
            assert!((rim.radius_m - radius_m).abs() < 0.001 && rim.residual_m < 0.003, "{radius_m}: {rim:?}");
            assert_eq!(rim.covered, 1.0);
            let scene = table.scene();
            let middle =
                tangents(scene.ground().unwrap().normal).map(|t| t.x * MIDDLE_M[0] + t.y * MIDDLE_M[1]);
            let off = [0, 1].map(|k| rim.center_m[k] - middle[k]);
            assert!(off[0].hypot(off[1]) < 0.001, "{radius_m}: {rim:?}");
        }
    }

    #[test]
    fn an_arc_is_a_rim_when_it_is_long_enough() {
        let arc = circle(&ring(0.06, |turn| turn < 0.66)).unwrap();
        assert!((arc.radius_m - 0.06).abs() < 0.002, "{arc:?}");
        assert!((0.6..0.8).contains(&arc.covered), "{arc:?}");
        assert_eq!(circle(&ring(0.06, |turn| turn < 0.45)), None);
        // The same length in two pieces covers more of the circle.
        assert!(circle(&ring(0.06, |turn| turn % 0.5 < 0.25)).is_none());
        assert!(circle(&ring(0.06, |turn| turn % 0.25 < 0.17)).is_some());
    }

    #[test]
    fn what_is_no_rim_has_no_circle() {
        assert_eq!(circle(&ring(0.015, |_| true)), None, "too small for a vessel");
        let bar = Table::new((160, 140), |u, v| Some((i32::from(v == 70 && u > 20 && u < 140), TOP_M)));
        assert_eq!(circle(&bar), None, "points in a line");
        let disc = Table::new((160, 140), |u, v| {
            Some((i32::from((u as f64 - 80.0).hypot(v as f64 - 70.0) < 50.0), TOP_M))
        });
        assert_eq!(circle(&disc), None, "not a line but an area");
    }

    #[test]
    fn what_stands_within_the_circle_is_told_from_what_does_not() {
        let table = ring(0.05, |_| true);
        let scene = table.scene();
        let clusters = single(&scene);
        let support = scene.ground().unwrap();
        let rim = circle(&table).unwrap();
        let within =
            |rim: &RimCircle| [0, 1].map(|k| measure_share_within(&clusters, SegmentId(k), rim, support));
        assert_eq!(within(&rim), [1.0, 1.0]);
        let elsewhere = RimCircle { center_m: rim.center_m.map(|x| x + 0.2), ..rim };
        assert_eq!(within(&elsewhere), [0.0, 0.0]);
        let half = RimCircle { radius_m: 0.03, ..rim };
        let [ring, inner] = within(&half);
        assert!(ring == 0.0 && inner > 0.9, "a bulge of 12 mm is allowed: {ring} {inner}");
    }
}
