//! What is printed on things, and what lies under them: labels, tiles, table cloths, stains.

use super::{Albedo, Paint};
use crate::random::Field;

impl Paint {
    /// A field of ink with rows as of text, of which each has a length of its own.
    pub(super) fn label(&self, seed: u64, [u, v]: [f64; 2], half_m: [f64; 2]) -> Albedo {
        const LINE_M: f64 = 0.009;
        if u.abs() >= half_m[0] || v.abs() >= half_m[1] {
            return self.base;
        }
        let field = Field::new(seed, 0);
        let line = (v / LINE_M).floor();
        let reach = half_m[0] * (0.3 + 0.55 * field.unit(0, line as i64));
        let in_row =
            (0.25..0.7).contains(&(v / LINE_M - line)) && u.abs() < reach && v.abs() < half_m[1] * 0.8;
        let letter = (u / (LINE_M * 0.4)).floor() as i64;
        if in_row && field.unit(1 + letter, line as i64) < 0.75 { self.base } else { self.ink }
    }

    /// Joints take a thirtieth of a tile.
    pub(super) fn tiles(&self, seed: u64, place: [f64; 2], side_m: f64) -> Albedo {
        const JOINT: f64 = 1.0 / 30.0;
        let [x, y] = place.map(|m| m / side_m);
        let tile = [x.floor(), y.floor()];
        if x - tile[0] < JOINT || y - tile[1] < JOINT {
            return self.ink;
        }
        let tone = 0.85 + 0.15 * Field::new(seed, 1).unit(tile[0] as i64, tile[1] as i64);
        self.base.map(|c| c * tone)
    }

    /// Where stripes cross there is twice as much ink.
    pub(super) fn checks(&self, place: [f64; 2], period_m: f64) -> Albedo {
        let inked = place.map(|m| m / period_m).map(|phase| f64::from(u8::from(phase - phase.floor() < 0.5)));
        self.mixed((inked[0] + inked[1]) / 2.0)
    }

    pub(super) fn clouds(&self, seed: u64, [u, v]: [f64; 2], cell_m: f64) -> Albedo {
        let (coarse, fine) = (Field::new(seed, 2), Field::new(seed, 3));
        let mix = 0.5 + 0.22 * coarse.slow(u, v, cell_m) + 0.1 * fine.slow(u, v, cell_m / 5.0);
        self.mixed(mix.clamp(0.0, 1.0))
    }

    /// A stain is darkest at its border, as a dried drop is.
    pub(super) fn stains(&self, seed: u64, [u, v]: [f64; 2], side_m: f64) -> Albedo {
        let field = Field::new(seed, 4);
        let (x, y) = (u / side_m, v / side_m);
        let cell = (x.floor() as i64, y.floor() as i64);
        let own = |k: i64| field.unit(cell.0 * 4 + k, cell.1);
        let radius = 0.08 + 0.2 * own(0);
        let middle = [1, 2].map(|k| 0.3 + 0.4 * own(k));
        let wobble = 1.0 + 0.12 * field.slow(u, v, side_m * 0.15);
        let distance = libm::hypot(x - x.floor() - middle[0], y - y.floor() - middle[1]) * wobble / radius;
        self.mixed(match distance {
            0.0..0.85 => 0.6,
            0.85..1.0 => 1.0,
            _ => 0.0,
        })
    }
}
