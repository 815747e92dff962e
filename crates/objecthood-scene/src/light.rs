//! Light: a lamp of some size, which gives soft shadows, and the sky of the room.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::random::Field;
use crate::world::{Sight, World};

/// How a scene is lit. Intensities are linear; 1 is white.
#[derive(Clone, Debug)]
pub(crate) struct Lighting {
    /// Middle of the lamp, a disc that faces down (m).
    pub(crate) lamp_m: DVec3,
    pub(crate) lamp_radius_m: f64,
    /// What a white surface below the lamp returns of its light at a distance of 1 m.
    pub(crate) lamp: [f64; 3],
    /// What a white surface returns of the light from above where nothing shades it.
    pub(crate) sky: [f64; 3],
}

/// Rays to the lamp on each side of a square; all are cast only where the corners disagree.
const LAMP_RAYS: i64 = 4;
/// Rays that ask how much of the sky is shaded, and how far they look (m).
const SKY_RAYS: i64 = 8;
const SKY_REACH_M: f64 = 0.2;

impl World {
    /// The light that comes from a surface, linear; `pixel` addresses the random choice of rays.
    pub(crate) fn shade(&self, sight: &Sight, pixel: (i64, i64)) -> [f64; 3] {
        let Lighting { lamp_m, lamp, sky, .. } = self.lighting;
        let toward = lamp_m - sight.point;
        let square = toward.length_squared();
        let facing = sight.normal.dot(toward).max(0.0) / square.sqrt();
        let lit = if facing > 0.0 { self.lamp_share(sight, pixel) * facing / square } else { 0.0 };
        let open = self.sky_share(sight, pixel) * (0.65 + 0.35 * sight.normal.z);
        let albedo = self.albedo(sight);
        let gloss = self.paint(sight).gloss;
        let spot = if gloss > 0.0 { gloss * lit * self.mirrored(sight, toward) } else { 0.0 };
        [0, 1, 2].map(|k| albedo[k] * (lamp[k] * lit + sky[k] * open) + lamp[k] * spot)
    }

    /// How nearly a surface mirrors the lamp into the camera, 0..1 (Blinn 1977).
    fn mirrored(&self, sight: &Sight, toward_lamp: DVec3) -> f64 {
        const SHARPNESS: f64 = 60.0;
        let toward_camera = self.viewpoint().pose.origin - sight.point;
        let halfway =
            (toward_lamp.normalize_or_zero() + toward_camera.normalize_or_zero()).normalize_or_zero();
        libm::pow(halfway.dot(sight.normal).max(0.0), SHARPNESS)
    }

    /// How much of the lamp is seen from there.
    fn lamp_share(&self, sight: &Sight, (u, v): (i64, i64)) -> f64 {
        let field = Field::new(self.seed(), 11);
        let last = LAMP_RAYS - 1;
        let sees = |i: i64, j: i64| {
            let k = i * LAMP_RAYS + j;
            let (a, b) = (field.unit(u * 32 + k, v), field.unit(u * 32 + 16 + k, v));
            let (x, y) = (
                (i as f64 + a) / LAMP_RAYS as f64 * 2.0 - 1.0,
                (j as f64 + b) / LAMP_RAYS as f64 * 2.0 - 1.0,
            );
            let on_lamp = DVec3::new(x, y, 0.0) * self.lighting.lamp_radius_m;
            self.sees(sight.point, sight.normal, self.lighting.lamp_m + on_lamp)
        };
        let corners = [(0, 0), (0, last), (last, 0), (last, last)].map(|(i, j)| sees(i, j));
        if corners.iter().all(|&seen| seen == corners[0]) {
            return f64::from(u8::from(corners[0]));
        }
        let all = (0..LAMP_RAYS).flat_map(|i| (0..LAMP_RAYS).map(move |j| (i, j)));
        all.filter(|&(i, j)| sees(i, j)).count() as f64 / (LAMP_RAYS * LAMP_RAYS) as f64
    }

    /// How much of the sky is open, cosine-weighted.
    fn sky_share(&self, sight: &Sight, (u, v): (i64, i64)) -> f64 {
        let field = Field::new(self.seed(), 12);
        let (a, b) = sight.normal.any_orthonormal_pair();
        let open = (0..SKY_RAYS).filter(|&k| {
            let radius = ((k as f64 + field.unit(u * 32 + k, v)) / SKY_RAYS as f64).sqrt();
            let (sin, cos) = libm::sincos(TAU * field.unit(u * 32 + 16 + k, v));
            let up = (1.0 - radius * radius).sqrt();
            let direction = a * (radius * cos) + b * (radius * sin) + sight.normal * up;
            self.sees(sight.point, sight.normal, sight.point + direction * SKY_REACH_M)
        });
        (0.4 * SKY_RAYS as f64 + 0.6 * open.count() as f64) / SKY_RAYS as f64
    }
}
