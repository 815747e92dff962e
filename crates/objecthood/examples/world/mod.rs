//! Boxes on a table, seen by an ideal depth camera that only rounds disparity as a Kinect does.

use objecthood::{Camera, Frame, Raster};

/// A box on or above the table. World frame: x right, y away from the camera, z up, the table is z = 0, metres.
pub(crate) struct Solid {
    /// Middle of its underside.
    pub(crate) base_m: [f64; 3],
    /// Width, depth and height.
    pub(crate) size_m: [f64; 3],
    /// How far it is turned about the vertical.
    pub(crate) yaw_deg: f64,
    /// The colour of its sides; its top is brighter.
    pub(crate) color: [u8; 3],
}

const WIDTH: usize = 320;
const HEIGHT: usize = 240;
const TABLE_COLOR: [u8; 3] = [150, 140, 130];
/// The camera looks down at the table from this height (m), this far in front of the world's origin (m).
const CAMERA_HEIGHT_M: f64 = 0.6;
const CAMERA_DISTANCE_M: f64 = 0.8;
const CAMERA_TILT_DEG: f64 = 37.0;
/// Nothing is measured beyond.
const RANGE_M: f64 = 1.5;
/// What a Kinect resolves of inverse depth (1/m).
const QUANTUM_PER_M: f64 = 0.00285;

/// The frame that the camera takes.
pub(crate) fn snapshot(solids: &[Solid]) -> Frame {
    let camera = Camera::new(262.5, 262.5, 159.5, 119.5).expect("these are intrinsics of a camera");
    let (sin, cos) = libm::sincos(CAMERA_TILT_DEG.to_radians());
    let eye = [0.0, -CAMERA_DISTANCE_M, CAMERA_HEIGHT_M];
    let mut depth_m = Vec::with_capacity(WIDTH * HEIGHT);
    let mut color = Vec::with_capacity(WIDTH * HEIGHT);
    for i in 0..WIDTH * HEIGHT {
        let [x, y, _] = camera.ray((i % WIDTH) as f64, (i / WIDTH) as f64);
        // The ray in the world; one step along it is one metre of depth.
        let ray = [x, cos - y * sin, -sin - y * cos];
        let table = (eye[2] / -ray[2], TABLE_COLOR);
        let hits = solids.iter().filter_map(|s| hit(s, eye, ray)).chain([table]);
        let (z, seen) = hits.filter(|h| h.0 > 0.0).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or(table);
        let quanta = (1.0 / (z * QUANTUM_PER_M)).round();
        depth_m.push(if (0.0..RANGE_M).contains(&z) {
            (1.0 / (quanta * QUANTUM_PER_M)) as f32
        } else {
            f32::NAN
        });
        color.push(seen);
    }
    let raster = |data| Raster::from_vec(WIDTH, HEIGHT, data).expect("one depth a pixel");
    let color = Raster::from_vec(WIDTH, HEIGHT, color).expect("one colour a pixel");
    Frame::new(raster(depth_m), Some(color), camera).expect("the table has depth")
}

/// Where the ray enters the solid: its depth (m) and the colour there.
fn hit(solid: &Solid, eye: [f64; 3], ray: [f64; 3]) -> Option<(f64, [u8; 3])> {
    let (sin, cos) = libm::sincos(solid.yaw_deg.to_radians());
    let turned = |[x, y, z]: [f64; 3]| [x * cos + y * sin, y * cos - x * sin, z];
    let origin = turned([0, 1, 2].map(|k| eye[k] - solid.base_m[k]));
    let ray = turned(ray);
    let low = [-solid.size_m[0] / 2.0, -solid.size_m[1] / 2.0, 0.0];
    let (mut enter, mut leave, mut face) = (0.0, f64::INFINITY, 0);
    for k in 0..3 {
        let at = |bound: f64| (bound - origin[k]) / ray[k];
        let (a, b) = (at(low[k]), at(low[k] + solid.size_m[k]));
        if a.min(b) > enter {
            (enter, face) = (a.min(b), k);
        }
        leave = leave.min(a.max(b));
    }
    let shade = |c: u8| [c, c / 4 * 3, c.saturating_add(c / 3)][face];
    (enter > 0.0 && enter < leave).then(|| (enter, solid.color.map(shade)))
}
