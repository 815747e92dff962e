//! Which maps there are, and maps of single numbers.

use objecthood::{Frame, Raster};

use crate::pack::{Kind, Map};

/// The maps that can be asked for, in the order in which the page lists them.
pub(crate) const NAMES: [&str; 13] = [
    "color",
    "depth",
    "normals",
    "structure",
    "superpixels",
    "facets",
    "votes",
    "shapes",
    "clusters",
    "filled",
    "objectness",
    "objects",
    "truth",
];

/// The colour image.
pub(crate) fn color(frame: &Frame) -> Option<Map> {
    let color = frame.color()?;
    Some(map("color", Kind::Rgb, color.size(), color.as_slice().as_flattened().to_vec()))
}

/// Depth in equal steps, the farthest at the end; 0 where there is none.
pub(crate) fn depth(frame: &Frame) -> Map {
    let depth_m = frame.depth_m();
    let farthest_m = depth_m.as_slice().iter().copied().filter(|z| z.is_finite()).fold(0.0, f32::max);
    let unit_m = farthest_m / f32::from(u16::MAX);
    let step = |z: &f32| if z.is_finite() { ((z / unit_m).round() as u16).max(1) } else { 0 };
    let bytes = depth_m.as_slice().iter().flat_map(|z| step(z).to_le_bytes()).collect();
    Map { unit_m: Some(unit_m), ..map("depth", Kind::U16, depth_m.size(), bytes) }
}

/// Normals as colours: x to the right is red, y upwards green, z towards the camera blue; black where there is none.
pub(crate) fn normals(normals: &Raster<[f32; 3]>) -> Map {
    let color = |n: &[f32; 3]| match *n {
        [0.0, 0.0, 0.0] => [0; 3],
        [x, y, z] => [x, -y, -z].map(|a| ((a + 1.0) * 127.5).round() as u8),
    };
    let bytes = normals.as_slice().iter().flat_map(color).collect();
    map("normals", Kind::Rgb, normals.size(), bytes)
}

/// Labels in 16 bits; 0 = none.
pub(crate) fn labels(name: &str, labels: &Raster<u16>) -> Map {
    let bytes = labels.as_slice().iter().flat_map(|label| label.to_le_bytes()).collect();
    map(name, Kind::U16, labels.size(), bytes)
}

/// A map of bytes.
pub(crate) fn map(name: &str, kind: Kind, (width, height): (usize, usize), bytes: Vec<u8>) -> Map {
    Map { name: name.to_owned(), kind, width, height, bytes, unit_m: None }
}

#[cfg(test)]
mod tests {
    use objecthood::Camera;

    use super::*;

    #[test]
    fn depth_is_kept_to_a_small_share_and_missing_depth_is_zero() {
        let depth_m = Raster::from_vec(4, 1, vec![f32::NAN, 0.001, 1.2345, 7.5]).unwrap();
        let frame = Frame::new(depth_m, None, Camera::new(5.0, 5.0, 1.0, 0.0).unwrap()).unwrap();
        let map = depth(&frame);
        let unit_m = map.unit_m.unwrap();
        let found: Vec<f32> =
            map.bytes.chunks(2).map(|b| f32::from(u16::from_le_bytes([b[0], b[1]])) * unit_m).collect();
        assert_eq!(found[0], 0.0);
        for (found, expected) in found[1..].iter().zip([0.001, 1.2345, 7.5]) {
            assert!(*found > 0.0 && (found - expected).abs() <= unit_m / 2.0 * 1.01, "{found} {expected}");
        }
        assert!(color(&frame).is_none());
    }
}
