//! The convexity of a cluster: how far it bends outwards.

use glam::{DVec3, Vec3};

use crate::clusters::scene::Scene;
use crate::surface::disparity::position;

/// A cluster with fewer pixels (px at a focal length of 525 px) has convexity 0, because its normals share their windows.
const CONVEXITY_PX: usize = 80;
/// About this many pixels, evenly spaced, measure the convexity of a cluster.
const CONVEXITY_SAMPLES: usize = 48;
/// Least squared distance (m^2) of a pair of points that measures convexity: nearer, noise turns normals more than the surface.
const CONVEXITY_APART_M2: f64 = 1e-5;

/// How far the surface of these pixels bends outwards: the mean over pairs of points of (n - m) · (x - y) / |x - y|, for points x
/// and y with normals n and m. Above 0 = convex, below 0 = concave, 0 = flat or too small. Between -2 and 2. O(1).
pub(crate) fn measure_convexity(scene: &Scene<'_>, pixels: &[u32]) -> f64 {
    if pixels.len() < scene.space.area_px(CONVEXITY_PX) {
        return 0.0;
    }
    let samples = oriented_samples(scene, pixels);
    let (mut sum, mut pairs) = (0.0, 0);
    for (k, (x, n)) in samples.iter().enumerate() {
        for (y, m) in &samples[k + 1..] {
            let apart = *x - *y;
            if apart.length_squared() >= CONVEXITY_APART_M2 {
                sum += apart.dot(*n - *m) / apart.length();
                pairs += 1;
            }
        }
    }
    if pairs == 0 { 0.0 } else { sum / f64::from(pairs) }
}

/// Points (m) and normals of some of the pixels.
fn oriented_samples(scene: &Scene<'_>, pixels: &[u32]) -> Vec<(DVec3, DVec3)> {
    let step = (pixels.len() / CONVEXITY_SAMPLES).max(1);
    let sampled = pixels.iter().map(|&i| i as usize).skip(step / 2).step_by(step);
    let oriented = |i: usize| {
        let at = position(i, scene.disparity.width());
        let point = DVec3::from(scene.space.point_m(at, f64::from(scene.disparity[i])));
        (point, Vec3::from(scene.normals[i]).as_dvec3())
    };
    sampled.filter(|&i| scene.normals[i] != [0.0; 3]).map(oriented).collect()
}

#[cfg(test)]
mod tests {
    use crate::clusters::testing::{Table, single};
    use crate::regions::SegmentId;

    #[test]
    fn a_ball_is_convex_a_bowl_concave_and_a_board_neither() {
        let round = |sign: f64| {
            Table::new((90, 90), |u, v| {
                let square = 1.0 - ((u as f64 - 45.0).powi(2) + (v as f64 - 45.0).powi(2)) / 1600.0;
                // Half a ball of 7 cm; and half a bowl of that size.
                Some(if square < 0.1 { (0, 0.0) } else { (1, 0.08 + sign * 0.07 * square.sqrt()) })
            })
        };
        let board = Table::new((90, 90), |u, _| Some((1, 0.05 + 1e-4 * u as f64)));
        let convexity = |table: &Table| {
            let scene = table.scene();
            single(&scene).convexity(SegmentId(0))
        };
        assert!(convexity(&round(1.0)) > 0.4, "{}", convexity(&round(1.0)));
        assert!(convexity(&round(-1.0)) < -0.4, "{}", convexity(&round(-1.0)));
        assert!(convexity(&board).abs() < 0.02, "{}", convexity(&board));
    }
}
