//! Frames as they come by stdin.

use serde_json::{Value, json};

use super::scene::{Cloud, FOCAL_PX};

/// A frame as it is sent.
pub(crate) fn sent(header: &Value, depth: &[u8], color: &[u8]) -> Vec<u8> {
    let header = header.to_string();
    let lengths = [header.len(), depth.len(), color.len()].map(|length| (length as u32).to_le_bytes());
    [b"OHF1", lengths.as_flattened(), header.as_bytes(), depth, color].concat()
}

/// The header, depth (m) and colour of a scene.
pub(crate) fn parts(cloud: &Cloud, name: &str) -> (Value, Vec<u8>, Vec<u8>) {
    let header = json!({
        "width": cloud.width, "height": cloud.height, "depth": "float32", "color": "rgb8",
        "camera": [FOCAL_PX, FOCAL_PX, 159.5, 119.5], "name": name, "stamp_ns": 17,
    });
    let depth = cloud.points.iter().flat_map(|point| point.xyz_m[2].to_le_bytes()).collect();
    let color = cloud.points.iter().flat_map(|point| point.color).collect();
    (header, depth, color)
}

/// Two boxes, the second one aside by so much, as a frame that is sent.
pub(crate) fn good(name: &str, shift_m: f64) -> Vec<u8> {
    let (header, depth, color) = parts(&Cloud::two_boxes(shift_m), name);
    sent(&header, &depth, &color)
}
