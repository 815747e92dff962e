//! Whether a part is a ball that would roll off the other part, as a head would off a body (docs/CONTEXT.md
//! 4.7.2).

use glam::DVec3;

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::necks::limits::{AROUND_M, FOOT_M, SIDES, SMALLER_SHARE};
use crate::clusters::necks::slopes::{check_level, sliding_share};
use crate::clusters::scene::sampled;
use crate::linear::solve;
use crate::quantile::{element_at, reach_m};
use crate::regions::SegmentId;

/// A part is a ball if at least this share of it faces away from one centre, to within this many degrees.
const ROUND_SHARE: f64 = 0.7;
const ROUND_DEG: f64 = 25.0;
/// A larger ball (m) cannot be grasped, so it is no head.
const RADIUS_M: f64 = 0.15;
/// At least this share of its width is seen: any bent face is a small piece of some large ball.
const SEEN_SHARE: f64 = 0.7;
/// The centre is found from all points, then this many times more from those that face away from it.
const REFITS: usize = 3;
/// The ball touches what is this near (m).
const TOUCH_M: f64 = 0.015;
/// The ball lies on a part that touches it at least this far below its centre, over the radius.
const BELOW: f64 = 0.3;
/// If at least this share of the pixels there is neither level nor steep, the ball would roll off.
const SLIDING_SHARE: f64 = 0.2;
/// Otherwise it may lie on a neck. The joint is what is this near (m) to the ball, ...
const JOINT_M: f64 = 0.012;
/// ... its width over that of the ball lies between these (a narrower joint is hidden in part), ...
const NECK_WIDTHS: [f64; 2] = [0.25, 0.55];
/// ... and it is at most this share of the width of the other part.
const JOINT_SHARE: f64 = 0.6;

/// A part that is a ball.
pub(super) struct Ball {
    centre: DVec3,
    radius_m: f64,
    /// The share of it that faces away from the centre.
    round_share: f64,
}

impl Ball {
    /// `None` for a part that is no ball. O(sampled pixels).
    pub(super) fn of(clusters: &Clusters<'_>, up: DVec3, id: SegmentId) -> Option<Self> {
        let scene = clusters.scene;
        let normal = |i: usize| DVec3::from(scene.normals[i].map(f64::from));
        let oriented = sampled(&clusters.get(id).pixels).filter(|&i| scene.normals[i] != [0.0; 3]);
        let all: Vec<(DVec3, DVec3)> = oriented.map(|i| (scene.point_at(i), normal(i))).collect();
        let mut centre = common_point(all.iter());
        let cosine = libm::cos(ROUND_DEG.to_radians());
        let faces_away = |centre: DVec3, (point, normal): &(DVec3, DVec3)| {
            normal.dot(*point - centre) > cosine * point.distance(centre)
        };
        for _ in 0..REFITS {
            centre = common_point(all.iter().filter(|at| faces_away(centre, at)));
        }
        let round: Vec<DVec3> = all.iter().filter(|at| faces_away(centre, at)).map(|at| at.0).collect();
        let round_share = round.len() as f64 / all.len().max(1) as f64;
        let mut distances: Vec<f64> = round.iter().map(|point| point.distance(centre)).collect();
        let radius_m = element_at(&mut distances, 0.5);
        let aside = across(up, centre);
        let [from_m, to_m] = reach_m(round, aside, SIDES);
        let is_seen = to_m - from_m >= SEEN_SHARE * 2.0 * radius_m;
        (round_share >= ROUND_SHARE && radius_m < RADIUS_M && is_seen).then_some(Self {
            centre,
            radius_m,
            round_share,
        })
    }

    /// The distance (m) of a point from its surface.
    fn distance_m(&self, point: DVec3) -> f64 {
        (point.distance(self.centre) - self.radius_m).abs()
    }

    /// Height (m) of its lowest point above the support below it; `None` without a support. O(1).
    fn foot_m(&self, clusters: &Clusters<'_>, part: SegmentId) -> Option<f64> {
        let scene = clusters.scene;
        let pixels = &clusters.get(part).pixels;
        let support = scene.own_support(pixels)?;
        let normal = scene.surfaces[support].normal;
        let seen = *pixels.first()? as usize;
        let below = self.centre - normal * self.radius_m - scene.point_at(seen);
        Some(scene.height_over_m(seen, support) + normal.dot(below))
    }

    /// Whether a third cluster touches it. A cluster that is not small may hold the ball, or lie on it.
    fn touches_others(&self, clusters: &Clusters<'_>, [part, body]: [SegmentId; 2]) -> bool {
        let ball = clusters.get(part);
        let least_px = SMALLER_SHARE * ball.pixels.len() as f64;
        let others = ball.neighbours.keys().filter_map(|&other| other).filter(|&other| other != body);
        let mut large =
            others.map(|other| &clusters.get(other).pixels).filter(|pixels| pixels.len() as f64 > least_px);
        large.any(|pixels| {
            pixels.iter().any(|&i| self.distance_m(clusters.scene.point_at(i as usize)) < TOUCH_M)
        })
    }
}

/// The level direction across the line of sight to a point; any level one for a point straight below the camera.
fn across(up: DVec3, point: DVec3) -> DVec3 {
    up.cross(point).try_normalize().unwrap_or_else(|| up.any_orthonormal_vector())
}

/// The point nearest to the lines through points along their normals.
fn common_point<'a>(lines: impl Iterator<Item = &'a (DVec3, DVec3)>) -> DVec3 {
    let (mut matrix, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    for (point, normal) in lines {
        let across = |vector: DVec3| vector - *normal * normal.dot(vector);
        let (rows, moved) = (DVec3::AXES.map(across), across(*point).to_array());
        for k in 0..3 {
            right[k] += moved[k];
            for (entry, part) in matrix[k].iter_mut().zip(rows[k].to_array()) {
                *entry += part;
            }
        }
    }
    DVec3::from(solve(matrix, right))
}

/// The checks by which a ball lies on the other part alone and would roll off it, because it lies on a slope
/// or on a neck. `None` if one fails. O(pixels of the other part and of everything beside the ball).
pub(super) fn checks(
    clusters: &Clusters<'_>,
    up: DVec3,
    ball: &Ball,
    [part, body]: [SegmentId; 2],
) -> Option<Vec<Check>> {
    let check = |name, unit, value, bound, limit| Check::new(name, unit, value, bound, limit);
    let foot_m = ball.foot_m(clusters, part)?;
    let bends = clusters.convexity(body);
    let mut checks = vec![
        check("share of the part that is round", "", ball.round_share, Bound::AtLeast, ROUND_SHARE),
        check("lowest point of that ball above its support", "m", foot_m, Bound::Above, FOOT_M),
        check("how far the other bends outwards", "", bends, Bound::Above, 0.0),
    ];
    if !checks.iter().all(Check::holds) || ball.touches_others(clusters, [part, body]) {
        return None;
    }
    let place = Place::of(clusters, up, ball, body);
    checks.extend([
        check("distance of the other from the ball", "m", place.distance_m, Bound::Below, TOUCH_M),
        check("how far below the centre it is, over the radius", "", place.below, Bound::Above, BELOW),
    ]);
    let sliding = "share of the other around the ball from which it would roll off";
    let slope = vec![
        check(sliding, "", sliding_share(clusters.scene, up, &place.around), Bound::AtLeast, SLIDING_SHARE),
        check_level(clusters, up, &place.around, true),
    ];
    let (over_ball, over_body) =
        ("width of the joint, over that of the ball", "width of the joint, over that of the other");
    let neck = vec![
        check(over_ball, "", place.joint_m / (2.0 * ball.radius_m), Bound::AtLeast, NECK_WIDTHS[0]),
        check(over_ball, "", place.joint_m / (2.0 * ball.radius_m), Bound::AtMost, NECK_WIDTHS[1]),
        check(over_body, "", place.joint_m / place.width_m, Bound::AtMost, JOINT_SHARE),
    ];
    checks.extend([slope, neck].into_iter().find(|checks| checks.iter().all(Check::holds))?);
    checks.iter().all(Check::holds).then_some(checks)
}

/// Where a ball lies on another part.
struct Place {
    /// The distance (m) of the part from the ball.
    distance_m: f64,
    /// How far the nearest point lies below the centre, over the radius.
    below: f64,
    /// The pixels of the part around the ball.
    around: Vec<u32>,
    /// The width (m) of the joint, and of the other part.
    joint_m: f64,
    width_m: f64,
}

impl Place {
    /// O(pixels of the part).
    fn of(clusters: &Clusters<'_>, up: DVec3, ball: &Ball, body: SegmentId) -> Self {
        let scene = clusters.scene;
        let aside = across(up, ball.centre);
        let (mut nearest, mut distance_m) = (DVec3::ZERO, f64::INFINITY);
        let (mut all, mut joint, mut around) = (Vec::new(), Vec::new(), Vec::new());
        for &i in &clusters.get(body).pixels {
            let point = scene.point_at(i as usize);
            let away_m = ball.distance_m(point);
            if away_m < distance_m {
                (nearest, distance_m) = (point, away_m);
            }
            if away_m < AROUND_M {
                around.push(i);
            }
            if away_m < JOINT_M {
                joint.push(point);
            }
            all.push(point);
        }
        let width_m = |points| {
            let [from_m, to_m] = reach_m(points, aside, SIDES);
            to_m - from_m
        };
        Self {
            distance_m,
            below: up.dot(ball.centre - nearest) / ball.radius_m,
            around,
            joint_m: width_m(joint),
            width_m: width_m(all),
        }
    }
}
