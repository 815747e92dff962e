//! The messages that are written.

use objecthood::{Camera, OrientedBox};

use super::cdr::Cdr;
use crate::capture::Pose;
use crate::output::instances::Instance;

/// The frame of the camera in messages: x right, y down, z forward (REP 103).
const CAMERA_FRAME: &str = "camera_optical_frame";

/// The frame in which poses are.
const WORLD_FRAME: &str = "world";

/// Deletes what stands from earlier messages, in `foxglove_msgs/SceneEntityDeletion`.
const DELETE_ALL: u8 = 1;

/// Colours of boxes (red, green, blue), by the number of the object.
const COLORS: [[f64; 3]; 6] =
    [[0.9, 0.3, 0.2], [0.2, 0.6, 0.9], [0.3, 0.8, 0.3], [0.9, 0.7, 0.1], [0.7, 0.4, 0.9], [0.1, 0.8, 0.8]];
const OPACITY: f64 = 0.35;

/// Height of the number above a box (m).
const TEXT_HEIGHT_M: f64 = 0.03;

/// A message, and on which topic it goes.
#[derive(Clone, Debug)]
pub struct Message {
    /// The topic.
    pub topic: &'static str,
    /// Its type, `package/msg/Type`.
    pub kind: &'static str,
    /// When what it tells was measured (ns); times before 1970 count as 1970.
    pub stamp_ns: i64,
    /// The message as CDR.
    pub data: Vec<u8>,
}

/// The pixels of an image message.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pixels<'a> {
    /// Columns and rows.
    pub(crate) size: (usize, usize),
    /// Their kind, as `sensor_msgs/image_encodings` names it: `16UC1`, `32FC1`, `rgb8`.
    pub(crate) encoding: &'static str,
    /// Row by row, little-endian.
    pub(crate) bytes: &'a [u8],
}

/// `sensor_msgs/msg/Image`.
pub(crate) fn image(topic: &'static str, stamp_ns: i64, pixels: Pixels<'_>) -> Message {
    let Pixels { size: (width, height), encoding, bytes } = pixels;
    let mut cdr = Cdr::new();
    header(&mut cdr, stamp_ns, CAMERA_FRAME);
    cdr.u32(height as u32);
    cdr.u32(width as u32);
    cdr.string(encoding);
    cdr.u8(0);
    cdr.u32((bytes.len() / height.max(1)) as u32);
    cdr.bytes(bytes);
    Message { topic, kind: "sensor_msgs/msg/Image", stamp_ns, data: cdr.finish() }
}

/// `sensor_msgs/msg/CameraInfo` of a camera without distortion.
pub(crate) fn camera_info(
    topic: &'static str,
    stamp_ns: i64,
    (width, height): (usize, usize),
    camera: Camera,
) -> Message {
    let Camera { fx_px, fy_px, cx_px, cy_px } = camera;
    let mut cdr = Cdr::new();
    header(&mut cdr, stamp_ns, CAMERA_FRAME);
    cdr.u32(height as u32);
    cdr.u32(width as u32);
    cdr.string("plumb_bob");
    cdr.count(5);
    cdr.f64s(&[0.0; 5]);
    cdr.f64s(&[fx_px, 0.0, cx_px, 0.0, fy_px, cy_px, 0.0, 0.0, 1.0]);
    cdr.f64s(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    cdr.f64s(&[fx_px, 0.0, cx_px, 0.0, 0.0, fy_px, cy_px, 0.0, 0.0, 0.0, 1.0, 0.0]);
    // Neither binned nor cut out.
    [0; 6].into_iter().for_each(|zero| cdr.u32(zero));
    cdr.bool(false);
    Message { topic, kind: "sensor_msgs/msg/CameraInfo", stamp_ns, data: cdr.finish() }
}

/// `tf2_msgs/msg/TFMessage`: where the camera is.
pub(crate) fn transform(stamp_ns: i64, pose: Pose) -> Message {
    let mut cdr = Cdr::new();
    cdr.count(1);
    header(&mut cdr, stamp_ns, WORLD_FRAME);
    cdr.string(CAMERA_FRAME);
    cdr.f64s(&pose.position_m);
    cdr.f64s(&pose.rotation_xyzw);
    Message { topic: "/tf", kind: "tf2_msgs/msg/TFMessage", stamp_ns, data: cdr.finish() }
}

/// `foxglove_msgs/msg/SceneUpdate`: the boxes of the objects with their numbers, in place of all earlier ones.
pub(crate) fn scene_update(topic: &'static str, stamp_ns: i64, found: &[Instance]) -> Message {
    let mut cdr = Cdr::new();
    cdr.count(1);
    time(&mut cdr, stamp_ns);
    cdr.u8(DELETE_ALL);
    cdr.string("");
    cdr.count(found.len());
    for instance in found {
        entity(&mut cdr, stamp_ns, instance);
    }
    Message { topic, kind: "foxglove_msgs/msg/SceneUpdate", stamp_ns, data: cdr.finish() }
}

/// `foxglove_msgs/msg/SceneEntity`.
fn entity(cdr: &mut Cdr, stamp_ns: i64, instance: &Instance) {
    time(cdr, stamp_ns);
    cdr.string(CAMERA_FRAME);
    cdr.string(&instance.id.to_string());
    // It stays until the next update.
    time(cdr, 0);
    cdr.bool(true);
    let told = [("objectness", instance.score.to_string()), ("size_px", instance.area_px.to_string())];
    cdr.count(told.len());
    for (key, value) in told {
        cdr.string(key);
        cdr.string(&value);
    }
    let OrientedBox { center_m, rotation_xyzw, extents_m } = instance.box_m;
    let [r, g, b] = COLORS[usize::from(instance.id) % COLORS.len()];
    let none = |cdr: &mut Cdr, kinds: usize| (0..kinds).for_each(|_| cdr.count(0));
    none(cdr, 1); // arrows
    cdr.count(1);
    cdr.f64s(&center_m.map(f64::from));
    cdr.f64s(&rotation_xyzw.map(f64::from));
    cdr.f64s(&extents_m.map(f64::from));
    cdr.f64s(&[r, g, b, OPACITY]);
    none(cdr, 4); // spheres, cylinders, lines, triangles
    cdr.count(1);
    cdr.f64s(&center_m.map(f64::from));
    cdr.f64s(&[0.0, 0.0, 0.0, 1.0]);
    cdr.bool(true);
    cdr.f64s(&[TEXT_HEIGHT_M]);
    cdr.bool(false);
    cdr.f64s(&[1.0; 4]);
    cdr.string(&format!("{}: {:.2}", instance.id, instance.score));
    none(cdr, 1); // models
}

fn header(cdr: &mut Cdr, stamp_ns: i64, frame_id: &str) {
    time(cdr, stamp_ns);
    cdr.string(frame_id);
}

/// `builtin_interfaces/Time` and `Duration`.
fn time(cdr: &mut Cdr, ns: i64) {
    const NS_PER_S: i64 = 1_000_000_000;
    // A message has 32 bits for the seconds.
    cdr.i32(ns.div_euclid(NS_PER_S).clamp(i32::MIN.into(), i32::MAX.into()) as i32);
    cdr.u32(ns.rem_euclid(NS_PER_S) as u32);
}
