//! NPZ: arrays for NumPy in an uncompressed ZIP archive, one NPY file each, little-endian, row by row.
//!
//! `rgb`, `depth`, `K` and `segmap` are called as grasp planners expect them (`contact_graspnet`). Missing depth is NaN.

use std::io::{Cursor, Write};

use objecthood::discovery::NodeKind;
use objecthood::{Camera, Discovery, Object};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::capture::Capture;

/// An archive in the making.
struct Archive(ZipWriter<Cursor<Vec<u8>>>);

/// A kind of number: how NumPy calls it, and its bytes.
trait Number: Copy {
    const KIND: &'static str;
    fn put(self, bytes: &mut Vec<u8>);
}

macro_rules! number {
    ($($kind:ty: $name:literal),*) => {$(
        impl Number for $kind {
            const KIND: &'static str = $name;
            fn put(self, bytes: &mut Vec<u8>) {
                bytes.extend(self.to_le_bytes());
            }
        }
    )*};
}
number!(u8: "|u1", u16: "<u2", i32: "<i4", i64: "<i8", f32: "<f4", f64: "<f8");

impl Archive {
    /// Adds an array. Writing to memory does not fail, and archives of 4 GB and more are marked as such.
    fn put<T: Number>(&mut self, name: &str, shape: &[usize], numbers: &[T]) {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .large_file(size_of_val(numbers) as u64 >= u64::from(u32::MAX) - 1024);
        let mut bytes = npy_header(T::KIND, shape);
        bytes.reserve(size_of_val(numbers));
        numbers.iter().for_each(|number| number.put(&mut bytes));
        let started = self.0.start_file(format!("{name}.npy"), options);
        started
            .map_err(std::io::Error::from)
            .and_then(|()| self.0.write_all(&bytes))
            .expect("memory takes what is written");
    }
}

/// What stands before the numbers: version 1.0 of the format, padded to 64 bytes.
fn npy_header(kind: &str, shape: &[usize]) -> Vec<u8> {
    let sides: String = shape.iter().map(|side| format!("{side}, ")).collect();
    let sides =
        if shape.len() == 1 { sides.trim_end().to_owned() } else { sides.trim_end_matches(", ").to_owned() };
    let dictionary = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({sides}), }}");
    const PREFIX: usize = 10;
    let length = (PREFIX + dictionary.len() + 1).next_multiple_of(64) - PREFIX;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{dictionary:<width$}\n", width = length - 1).into_bytes());
    bytes
}

/// The archive of a frame: `depth` (H, W) in metres, `rgb` (H, W, 3) if there is colour, `K` (3, 3); `stamp_ns` (1), `position_m` (3) and
/// `rotation_xyzw` (4) of the camera in its world where they are known.
pub fn of_capture(capture: &Capture) -> Vec<u8> {
    finish(with_capture(capture))
}

/// The archive of a frame and what was found in it: that of [`of_capture`] and, for N objects,
///
/// * `segmap` and `structure` (H, W): the object and the large plane of every pixel, 0 = none;
/// * `objectness` (N), `box_px` (N, 4) column, row, width, height; `centroid_m`, `box_center_m` and `box_extents_m` (N, 3),
///   `box_rotation_xyzw` (N, 4);
/// * `parents` (E, 3): an object, the object that carries it, the plane of `structure` that carries it; 0 where it is none;
/// * `up` (3), `planes` (P, 4): unit normal and offset (m).
pub fn of_discovery(capture: &Capture, discovery: &Discovery) -> Vec<u8> {
    let mut archive = with_capture(capture);
    let (width, height) = discovery.labels.size();
    archive.put("segmap", &[height, width], discovery.labels.as_slice());
    archive.put("structure", &[height, width], discovery.structure.as_slice());
    let objects = &discovery.objects;
    archive.put("objectness", &[objects.len()], &rows(objects, |object| [object.objectness]));
    let rectangle = |object: &Object| {
        let area = object.box_px;
        [area.u, area.v, area.width, area.height].map(|side| side as i32)
    };
    archive.put("box_px", &[objects.len(), 4], &rows(objects, rectangle));
    archive.put("centroid_m", &[objects.len(), 3], &rows(objects, |object| object.centroid_m));
    archive.put("box_center_m", &[objects.len(), 3], &rows(objects, |object| object.box_m.center_m));
    archive.put("box_extents_m", &[objects.len(), 3], &rows(objects, |object| object.box_m.extents_m));
    archive.put(
        "box_rotation_xyzw",
        &[objects.len(), 4],
        &rows(objects, |object| object.box_m.rotation_xyzw),
    );
    let parents = parents(discovery);
    archive.put("parents", &[parents.len() / 3, 3], &parents);
    archive.put("up", &[3], &discovery.up.direction);
    let planes: Vec<f32> = discovery
        .structure_planes
        .iter()
        .flat_map(|plane| plane.normal.into_iter().chain([plane.offset_m]))
        .collect();
    archive.put("planes", &[planes.len() / 4, 4], &planes);
    finish(archive)
}

fn with_capture(capture: &Capture) -> Archive {
    let mut archive = Archive(ZipWriter::new(Cursor::new(Vec::new())));
    let (width, height) = capture.frame.size();
    if let Some(color) = capture.frame.color() {
        archive.put("rgb", &[height, width, 3], color.as_slice().as_flattened());
    }
    archive.put("depth", &[height, width], capture.frame.depth_m().as_slice());
    let Camera { fx_px, fy_px, cx_px, cy_px } = capture.frame.camera();
    archive.put("K", &[3, 3], &[fx_px, 0.0, cx_px, 0.0, fy_px, cy_px, 0.0, 0.0, 1.0]);
    if let Some(stamp_ns) = capture.stamp_ns {
        archive.put("stamp_ns", &[1], &[stamp_ns]);
    }
    if let Some(pose) = capture.pose {
        archive.put("position_m", &[3], &pose.position_m);
        archive.put("rotation_xyzw", &[4], &pose.rotation_xyzw);
    }
    archive
}

fn finish(archive: Archive) -> Vec<u8> {
    archive.0.finish().expect("memory takes what is written").into_inner()
}

fn rows<T, const N: usize>(objects: &[Object], row: impl Fn(&Object) -> [T; N]) -> Vec<T> {
    objects.iter().flat_map(row).collect()
}

/// Of every object what carries it: the object and the plane, 0 = none.
fn parents(discovery: &Discovery) -> Vec<i32> {
    let mut rows = Vec::new();
    for object in &discovery.objects {
        for parent in &object.parents {
            let kind = discovery.support.nodes.get(parent.0 as usize).map(|node| node.kind);
            let (carrier, plane) = match kind {
                Some(NodeKind::Object { object }) => (i32::from(object.0), 0),
                Some(NodeKind::Structure { plane }) => (0, plane as i32 + 1),
                Some(NodeKind::Surface) | None => (0, 0),
            };
            rows.extend([i32::from(object.id.0), carrier, plane]);
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_those_of_numpy() {
        for (shape, text) in [(&[2, 3][..], "(2, 3)"), (&[7], "(7,)"), (&[0, 4], "(0, 4)")] {
            let header = npy_header("<f4", shape);
            assert_eq!(header.len() % 64, 0);
            let text = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {text}, }}");
            assert!(header[10..].starts_with(text.as_bytes()) && header.ends_with(b"\n"));
        }
    }
}
