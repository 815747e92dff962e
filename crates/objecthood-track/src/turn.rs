//! Guesses roughly how far a camera has turned; the search for the exact motion starts there.
//!
//! A hand-held camera turns by dozens of pixels from frame to frame. That is too far for an alignment that
//! starts where the camera was. Small blurred images look alike over such distances. Depth is not needed: a
//! turn moves near and far by the same angle.
//!
//! Source: G. Klein, D. Murray, Improving the Agility of Keyframe-Based SLAM, ECCV 2008 (small blurry
//! images). Here the turn is estimated directly, not by way of a motion in the image.

use glam::{DMat3, DVec3};
use objecthood::Camera;
use serde::{Deserialize, Serialize};

use crate::rigid::Rigid;
use crate::view::View;

/// A pixel of the small image is the mean of a square with this side (px at VGA size).
const CELL_PX: f64 = 16.0;
/// At most this many Gauss-Newton steps; they end below this turn (rad).
const STEPS: usize = 12;
const SETTLED_RAD: f64 = 1e-4;
/// Beyond this difference (levels) a cell counts less: something moves there.
const HUBER_LEVELS: f64 = 12.0;
/// At least this share of the cells is needed to estimate a turn.
const LEAST_SEEN: f64 = 0.3;
/// Cells have to differ from their neighbours by enough to determine the turn about every axis. This is the
/// least pivot (levels² a cell and square radian); a slope of half a level from cell to cell has it.
const LEAST_PIVOT: f64 = 100.0;

/// A small blurred image.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct SmallImage {
    size: (usize, usize),
    /// The intrinsics in units of its own pixels.
    camera: Camera,
    /// Grey values, 0 to 255.
    grey: Vec<f32>,
}

impl SmallImage {
    /// Makes the small image; `None` without colour. O(n).
    pub(crate) fn of(view: &View) -> Option<Self> {
        let cell = view.length_px(CELL_PX);
        let (width, height) = (view.size.0 / cell, view.size.1 / cell);
        if view.grey.is_empty() || width < 3 || height < 3 {
            return None;
        }
        let mut sums = vec![0_u32; width * height];
        for (v, row) in view.grey.chunks(view.size.0).take(height * cell).enumerate() {
            for (sum, cells) in sums[v / cell * width..].iter_mut().zip(row.chunks_exact(cell)) {
                *sum += cells.iter().map(|&grey| u32::from(grey)).sum::<u32>();
            }
        }
        let mean = sums.into_iter().map(|sum| sum as f32 / (cell * cell) as f32).collect();
        let small = |at: f64| (at + 0.5) / cell as f64 - 0.5;
        let Camera { fx_px, fy_px, cx_px, cy_px } = view.camera;
        let per_cell = |f: f64| f / cell as f64;
        let camera = Camera::new(per_cell(fx_px), per_cell(fy_px), small(cx_px), small(cy_px)).ok()?;
        let image = Self { size: (width, height), camera, grey: mean };
        Some(image.blurred())
    }

    /// Blurs: each cell with half the weight of its neighbours beside it.
    fn blurred(mut self) -> Self {
        let (width, height) = self.size;
        let at = |u: usize, v: usize| v * width + u;
        for is_along in [true, false] {
            let before = self.grey.clone();
            for v in 0..height {
                for u in 0..width {
                    let (a, b) = if is_along {
                        (at(u.saturating_sub(1), v), at((u + 1).min(width - 1), v))
                    } else {
                        (at(u, v.saturating_sub(1)), at(u, (v + 1).min(height - 1)))
                    };
                    self.grey[at(u, v)] = 0.25 * (before[a] + before[b]) + 0.5 * before[at(u, v)];
                }
            }
        }
        self
    }

    /// The grey value between cells, and its change a column and a row; `None` outside.
    fn at(&self, u: f64, v: f64) -> Option<[f64; 3]> {
        let (width, height) = self.size;
        if !(u >= 0.0 && v >= 0.0 && u < (width - 1) as f64 && v < (height - 1) as f64) {
            return None;
        }
        let (left, top) = (u as usize, v as usize);
        let (a, b) = (u - left as f64, v - top as f64);
        let corner = |right: usize, down: usize| f64::from(self.grey[(top + down) * width + left + right]);
        let [p, q, r, s] = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
        let value = (1.0 - b) * ((1.0 - a) * p + a * q) + b * ((1.0 - a) * r + a * s);
        Some([value, (1.0 - b) * (q - p) + b * (s - r), (1.0 - a) * (r - p) + a * (s - q)])
    }

    /// The turn of the camera to a later image: maps directions of this camera to that one's. `None` if the
    /// images do not determine it. O(cells).
    pub(crate) fn turn_to(&self, later: &Self) -> Option<Rigid> {
        if self.size != later.size || self.camera != later.camera {
            return None;
        }
        let Camera { fx_px, fy_px, cx_px, cy_px } = self.camera;
        let mut turn = Rigid::IDENTITY;
        // The image may have become brighter.
        let mut brighter = 0.0;
        for _ in 0..STEPS {
            let (mut h, mut g) = (DMat3::ZERO, DVec3::ZERO);
            let (mut sum, mut seen) = (0.0, 0.0);
            for (i, &was) in self.grey.iter().enumerate() {
                let (u, v) = ((i % self.size.0) as f64, (i / self.size.0) as f64);
                let ray = turn.direction(DVec3::from(self.camera.ray(u, v)));
                if ray.z <= 0.0 {
                    continue;
                }
                let (x, y) = (ray.x / ray.z, ray.y / ray.z);
                let Some([is, along, down]) = later.at(fx_px * x + cx_px, fy_px * y + cy_px) else {
                    continue;
                };
                let residual = is - f64::from(was) - brighter;
                (sum, seen) = (sum + residual, seen + 1.0);
                let slope = DVec3::new(along * fx_px, down * fy_px, -(along * fx_px * x + down * fy_px * y));
                let change = DVec3::new(x, y, 1.0).cross(slope);
                let weight = HUBER_LEVELS / residual.abs().max(HUBER_LEVELS);
                h += weight * DMat3::from_cols(change * change.x, change * change.y, change * change.z);
                g += weight * residual * change;
            }
            if seen < LEAST_SEEN * self.grey.len() as f64 {
                return None;
            }
            brighter += sum / seen;
            let least = h.determinant() / (h.x_axis.cross(h.y_axis)).length().max(f64::MIN_POSITIVE);
            if least.abs() < LEAST_PIVOT * seen {
                return None;
            }
            let step = -(h.inverse() * g);
            turn = Rigid::step(step, DVec3::ZERO, DVec3::ZERO).after(&turn);
            if step.length() < SETTLED_RAD {
                break;
            }
        }
        Some(turn)
    }
}

#[cfg(test)]
mod tests {
    use objecthood::{Frame, Raster};

    use super::*;

    const SIZE: (usize, usize) = (320, 240);

    /// What a camera sees that is turned so: a sky of smooth spots, whatever their distance.
    fn seen(turn: DVec3, gain: f64) -> SmallImage {
        let camera = Camera::new(262.0, 262.0, 159.5, 119.5).unwrap();
        let back = Rigid::step(turn, DVec3::ZERO, DVec3::ZERO).inverse();
        let spot = |pixel: usize| {
            let ray =
                back.direction(DVec3::from(camera.ray((pixel % SIZE.0) as f64, (pixel / SIZE.0) as f64)));
            let (x, y) = (ray.x / ray.z, ray.y / ray.z);
            let level = 110.0 + 50.0 * (9.0 * x + 2.0 * y).sin() + 50.0 * (7.0 * y - 4.0 * x + 1.0).sin();
            [(gain + level) as u8; 3]
        };
        let color = Raster::from_vec(SIZE.0, SIZE.1, (0..SIZE.0 * SIZE.1).map(spot).collect()).unwrap();
        let depth_m = Raster::filled(SIZE.0, SIZE.1, 1.0).unwrap();
        SmallImage::of(&View::of(&Frame::new(depth_m, Some(color), camera).unwrap(), 1.0)).unwrap()
    }

    #[test]
    fn a_turn_of_many_pixels_is_found_in_brighter_light_too() {
        for turn in [[0.0, 0.0, 0.08], [0.05, 0.0, 0.0], [-0.03, 0.06, -0.04]].map(DVec3::from) {
            let found = seen(DVec3::ZERO, 0.0).turn_to(&seen(turn, 20.0)).unwrap();
            let wrong = Rigid::step(turn, DVec3::ZERO, DVec3::ZERO).inverse().after(&found);
            assert!(wrong.angle_rad() < 0.006, "{turn}: off by {} rad", wrong.angle_rad());
        }
    }

    #[test]
    fn an_even_image_tells_no_turn() {
        let camera = Camera::new(262.0, 262.0, 159.5, 119.5).unwrap();
        let color = Raster::filled(SIZE.0, SIZE.1, [128; 3]).unwrap();
        let depth_m = Raster::filled(SIZE.0, SIZE.1, 1.0).unwrap();
        let even =
            SmallImage::of(&View::of(&Frame::new(depth_m, Some(color), camera).unwrap(), 1.0)).unwrap();
        assert!(even.turn_to(&even).is_none());
    }
}
