//! Point clouds as binary PLY: the points of a frame with colour, label and the pixel that saw them.
//!
//! Vertices have `x y z` (m, camera frame: x right, y down, z forward), `red green blue` if the frame has colour, `label`, the number of
//! the object, 0 = none, and `pixel`, the index of the pixel row by row; both as `int`, the only type of whole numbers
//! above 255 that Open3D takes. Comments name camera and size, which lead back to the image.

use objecthood::{Camera, Discovery, Frame};

/// The cloud of all points of a frame.
pub fn of_scene(frame: &Frame, discovery: &Discovery) -> Vec<u8> {
    of_points(frame, discovery, |_| true)
}

/// The cloud of the points of one object.
pub fn of_object(frame: &Frame, discovery: &Discovery, object: u16) -> Vec<u8> {
    of_points(frame, discovery, |label| label == object)
}

fn of_points(frame: &Frame, discovery: &Discovery, is_wanted: impl Fn(u16) -> bool) -> Vec<u8> {
    let labels = discovery.labels.as_slice();
    let (width, height) = frame.size();
    let pixels: Vec<usize> =
        (0..width * height).filter(|&i| frame.is_valid(i) && is_wanted(labels[i])).collect();
    let Camera { fx_px, fy_px, cx_px, cy_px } = frame.camera();
    let colors = if frame.color().is_some() {
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    } else {
        ""
    };
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\ncomment objecthood {}\ncomment camera {fx_px} {fy_px} {cx_px} {cy_px}\n\
         comment size {width} {height}\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n{colors}\
         property int label\nproperty int pixel\nend_header\n",
        env!("CARGO_PKG_VERSION"),
        pixels.len()
    )
    .into_bytes();
    for i in pixels {
        let point = frame.camera().back_project(i % width, i / width, frame.depth_m()[i]);
        point.iter().for_each(|part| bytes.extend(part.to_le_bytes()));
        if let Some(color) = frame.color() {
            bytes.extend(color[i]);
        }
        bytes.extend(i32::from(labels[i]).to_le_bytes());
        bytes.extend((i as i32).to_le_bytes());
    }
    bytes
}
