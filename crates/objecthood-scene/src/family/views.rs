//! Who looks at a scene, and its light.

use std::ops::Range;

use glam::DVec3;
use objecthood::Camera;

use super::setting::TABLE_M;
use crate::light::Lighting;
use crate::pose::Pose;
use crate::random::Rng;
use crate::world::Viewpoint;

/// Where a camera may be: around what it looks at.
pub(crate) struct Around {
    /// What it looks at (m), to 4 cm sideways.
    pub(crate) target_m: [f64; 3],
    pub(crate) distance_m: Range<f64>,
    /// Over the horizon.
    pub(crate) elevation_deg: Range<f64>,
    /// From the front, to the right.
    pub(crate) azimuth_deg: Range<f64>,
}

impl Around {
    /// One of these places; the camera is rolled by up to 4 degrees.
    pub(crate) fn viewpoint(self, rng: &mut Rng) -> Viewpoint {
        let (distance, elevation) = (rng.range(self.distance_m), rng.range(self.elevation_deg).to_radians());
        let azimuth = rng.range(self.azimuth_deg).to_radians();
        let ((sin_e, cos_e), (sin_a, cos_a)) = (libm::sincos(elevation), libm::sincos(azimuth));
        let aside = DVec3::new(rng.range(-0.04..0.04), rng.range(-0.04..0.04), 0.0);
        let target = DVec3::from(self.target_m) + aside;
        let eye = target + DVec3::new(sin_a * cos_e, -cos_a * cos_e, sin_e) * distance;
        let pose = Pose::looking_at(eye.into(), target.into());
        kinect_at(pose.turned(2, rng.range(-4.0..4.0)))
    }
}

/// Someone who stands or sits at the table: 0.78 to 1.1 m from its middle, 28 to 52 degrees above.
pub(crate) fn at_table(rng: &mut Rng) -> Viewpoint {
    let around = Around {
        target_m: [0.0, 0.0, TABLE_M + 0.03],
        distance_m: 0.78..1.1,
        elevation_deg: 28.0..52.0,
        azimuth_deg: -35.0..35.0,
    };
    around.viewpoint(rng)
}

/// A camera with the nominal intrinsics of a Kinect v1, which mOSD has too.
pub(crate) fn kinect_at(pose: Pose) -> Viewpoint {
    let camera = Camera { fx_px: 525.0, fy_px: 525.0, cx_px: 319.5, cy_px: 239.5 };
    Viewpoint { camera, size_px: (640, 480), pose }
}

/// The same, but every second lamp is coloured: a warm bulb, the blue of a window, the green of old tubes.
pub(crate) fn mixed_lighting(rng: &mut Rng) -> Lighting {
    let lighting = lighting(rng);
    if rng.chance(0.5) {
        return lighting;
    }
    let (warmth, green) = (rng.range(-0.35..0.45), rng.range(-0.08..0.15));
    let tint = [1.0 + warmth, 1.0 + green, 1.0 - warmth];
    let lamp = [0, 1, 2].map(|k| lighting.lamp[1] * tint[k]);
    Lighting { lamp, ..lighting }
}

/// A lamp between warm and cold, above and to one side, and the light of the room.
pub(crate) fn lighting(rng: &mut Rng) -> Lighting {
    let warmth = rng.range(-0.12..0.12);
    let tint = [1.0 + warmth, 1.0, 1.0 - warmth];
    let height = rng.range(1.2..1.9);
    let (lamp, sky) = (rng.range(0.35..0.65) * height * height, rng.range(0.4..0.6));
    Lighting {
        lamp_m: DVec3::new(rng.range(-1.0..1.0), rng.range(-0.8..0.6), TABLE_M + height),
        lamp_radius_m: rng.range(0.12..0.45),
        lamp: tint.map(|c| c * lamp),
        sky: tint.map(|c| sky * (2.0 - c)),
    }
}
