//! Clusters that are surfaces of revolution by themselves, as pieces of round vessels are.

use super::limits::PART_PX;
use super::revolution::{Revolution, mean_m};
use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::rim::check_radius;
use crate::clusters::scene::sampled;
use crate::linear::length;
use crate::oversegment::structure::StructureSurface;
use crate::quantile::{element_at, range};
use crate::regions::SegmentId;
use crate::tangents::tangents;

/// Greatest root mean square distance of a piece from the surface (m), because walls are a few millimetres
/// thick,
const DISTANCE_M: f64 = 0.005;
/// or this share of the radius, because a profile is no exact parabola,
const DISTANCE_SHARE: f64 = 0.06;
/// or this many quanta, for each time that the sensor's waves exceed a Kinect's,
const NOISE_QUANTA: f64 = 1.0;
/// but never more than this share of the radius: where noise is as large as a thing, everything looks round.
const MOST_SHARE: f64 = 0.12;
/// The radius of a surface is this quantile of the distances of its points from the axis.
const RADIUS_SHARE: f64 = 0.95;
/// Heights reach from the first to the second of these quantiles.
const HEIGHT_QUANTILES: [f64; 2] = [0.05, 0.95];
/// The middles of two pieces of one vessel are at most this far apart in the plan view (m): the diameter of the largest.
const APART_M: f64 = 0.4;
/// If fewer points of another cluster lie in the range of heights of a piece, they do not show where the
/// other lies.
const LEAST_COMMON: usize = 30;

/// A cluster that may be a piece of a round vessel: it is a surface of revolution by itself.
pub(super) struct Piece {
    pub id: SegmentId,
    /// A sample of its points: along the two tangents of the support, and the height above it (m).
    pub points_m: Vec<[f64; 3]>,
    /// The middle of these points in the plan view (m).
    middle_m: [f64; 2],
    /// The range of its heights (m).
    heights_m: [f64; 2],
    /// The noise of its points (m).
    pub noise_m: f64,
    /// The surface that fits it alone.
    surface: Revolution,
    /// The radius of that surface (m).
    radius_m: f64,
}

impl Piece {
    /// `None` for a cluster that is too small, flat, or no surface of revolution by itself.
    pub(super) fn of(clusters: &Clusters<'_>, support: &StructureSurface, id: SegmentId) -> Option<Self> {
        let (scene, pixels) = (clusters.scene, &clusters.get(id).pixels);
        if pixels.len() < scene.space.area_px(PART_PX) || clusters.flat(id).is_some() {
            return None;
        }
        let points_m = points_of(clusters, support, id);
        let mut heights_m: Vec<f64> = points_m.iter().map(|point| point[2]).collect();
        let heights_m = range(&mut heights_m, HEIGHT_QUANTILES);
        let mut depths_m: Vec<f64> = scene.sampled_points(pixels).map(|point| point.z).collect();
        let depth_m = element_at(&mut depths_m, 0.5);
        let noise_m = scene.space.step_m(NOISE_QUANTA * scene.space.noise().waves().max(1.0), depth_m);
        let [x, y, _] = mean_m(&points_m);
        let surface = Revolution::fit(&points_m);
        let radius_m = radius_m(&surface, &points_m);
        let piece = Self { id, points_m, middle_m: [x, y], heights_m, noise_m, surface, radius_m };
        let [_, is_small] = check_radius("radius of the surface", radius_m);
        (is_small.holds() && surface.distance_m(&piece.points_m) < piece.most_m(radius_m)).then_some(piece)
    }

    /// The greatest distance (m) from a surface of this radius at which it still belongs to the surface.
    pub(super) fn most_m(&self, radius_m: f64) -> f64 {
        (DISTANCE_SHARE * radius_m).max(DISTANCE_M).max(self.noise_m).min(MOST_SHARE * radius_m)
    }

    pub(super) fn is_near(&self, other: &Self) -> bool {
        length([0, 1].map(|k| self.middle_m[k] - other.middle_m[k])) < APART_M
    }

    /// How far (m) another cluster lies beyond the surface of this one, seen from the axis, at heights that
    /// both have; below 0 if it lies within. Nested bowls have one axis and similar convexities, but lie a
    /// rim apart. `None` if too little of the other lies at these heights.
    pub(super) fn beyond_m(
        &self,
        clusters: &Clusters<'_>,
        support: &StructureSurface,
        other: SegmentId,
    ) -> Option<f64> {
        let [low_m, high_m] = self.heights_m;
        let points_m = points_of(clusters, support, other).into_iter();
        let common = points_m.filter(|point| (low_m..=high_m).contains(&point[2]));
        let mut beyond_m: Vec<f64> = common.map(|point| self.surface.beyond_m(point)).collect();
        (beyond_m.len() >= LEAST_COMMON).then(|| element_at(&mut beyond_m, 0.5))
    }

    /// How far (m) another cluster may lie from its surface and still belong to the same vessel.
    pub(super) fn most_beyond_m(&self) -> f64 {
        self.most_m(self.radius_m)
    }

    /// The share of the range of heights of the less tall piece that both pieces have.
    pub(super) fn level_share(&self, other: &Self) -> f64 {
        let [[low, high], [other_low, other_high]] = [self.heights_m, other.heights_m];
        let common_m = high.min(other_high) - low.max(other_low);
        common_m / (high - low).min(other_high - other_low).max(f64::MIN_POSITIVE)
    }
}

/// Checks that the smaller of two insides lies on the surface of the larger one. `None` if the larger one is
/// no surface of revolution, or if the two have no heights in common.
pub(in crate::clusters) fn check_on(
    clusters: &Clusters<'_>,
    support: &StructureSurface,
    large: SegmentId,
    small: SegmentId,
) -> Option<Check> {
    let large = Piece::of(clusters, support, large)?;
    let off_m = large.beyond_m(clusters, support, small)?.abs();
    let what = "distance of the smaller piece from the surface of revolution of the larger one";
    Some(Check::new(what, "m", off_m, Bound::Below, large.most_beyond_m()))
}

/// About 200 points of a cluster: along the two tangents of the support, and the height above it (m).
fn points_of(clusters: &Clusters<'_>, support: &StructureSurface, id: SegmentId) -> Vec<[f64; 3]> {
    let (scene, sideways) = (clusters.scene, tangents(support.normal));
    let point = |i: usize| {
        let [x, y] = sideways.map(|tangent| tangent.dot(scene.point_at(i)));
        [x, y, scene.height_m(i, support)]
    };
    sampled(&clusters.get(id).pixels).map(point).collect()
}

/// The distance of the outermost points of a surface from its axis (m).
pub(super) fn radius_m(surface: &Revolution, points_m: &[[f64; 3]]) -> f64 {
    let mut distances_m: Vec<f64> = points_m.iter().map(|&point| length(surface.about_axis(point))).collect();
    element_at(&mut distances_m, RADIUS_SHARE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::testing::{Table, single};

    /// A bowl in an image of (facet, height): seen from above, 5 cm deep at this radius (px).
    fn bowl_m(r: f64, radius_px: f64) -> f64 {
        0.01 + (r / radius_px).powi(2) * 0.05
    }

    /// Whether what lies within 30 px is of one surface with what lies beyond.
    fn is_one(inner_m: impl Fn(f64) -> f64) -> bool {
        let table = Table::new((160, 120), |u, v| {
            Some(match (u as f64 - 80.0).hypot(v as f64 - 60.0) {
                r if r < 30.0 => (1, inner_m(r)),
                r if r < 50.0 => (2, bowl_m(r, 50.0)),
                _ => (0, 0.0),
            })
        });
        let scene = table.scene();
        let clusters = single(&scene);
        check_on(&clusters, scene.ground().unwrap(), SegmentId(1), SegmentId(0))
            .is_none_or(|check| check.holds())
    }

    /// The inner one had the number of the outer one.
    #[test]
    fn a_bowl_in_a_bowl_is_none_of_its_pieces() {
        assert!(is_one(|r| bowl_m(r, 50.0)));
        assert!(!is_one(|r| bowl_m(r, 32.0)));
    }
}
