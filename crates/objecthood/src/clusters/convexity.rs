//! How far a cluster bends outwards.

use glam::{DVec3, Vec3};

use crate::clusters::scene::Scene;
use crate::surface::disparity::position;

/// Fewer pixels (at 525 px) tell nothing about convexity.
const CONVEXITY_PX: usize = 80;
/// Convexity looks at about so many points ...
const CONVEXITY_SAMPLES: usize = 48;
/// ... and at pairs of them whose squared distance (m^2) is at least this.
const CONVEXITY_APART_M2: f64 = 1e-5;

impl Scene<'_> {
    pub(crate) fn convexity(&self, pixels: &[u32]) -> f64 {
        if pixels.len() < self.space.area_px(CONVEXITY_PX) {
            return 0.0;
        }
        let step = (pixels.len() / CONVEXITY_SAMPLES).max(1);
        let sampled = pixels.iter().map(|&i| i as usize).skip(step / 2).step_by(step);
        let samples: Vec<(DVec3, DVec3)> = sampled
            .filter(|&i| self.normals[i] != [0.0; 3])
            .map(|i| {
                let at = position(i, self.disparity.width());
                let point = self.space.point_m(at, f64::from(self.disparity[i]));
                (point, Vec3::from(self.normals[i]).as_dvec3())
            })
            .collect();
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
