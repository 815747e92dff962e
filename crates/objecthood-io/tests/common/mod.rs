//! What several tests need: files made by an independent writer, and the real data.
#![allow(dead_code, reason = "each test uses a part")]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "what fails or is skipped is reported so")]

pub(crate) mod written;

use std::io::Cursor;
use std::path::{Path, PathBuf};

use objecthood_io::{Capture, Given, GridCamera, Result};
use pcd_rs::{DataKind, DynRecord, Field, Schema, ValueKind, WriterInit};

pub(crate) const ENCODINGS: [DataKind; 3] = [DataKind::Ascii, DataKind::Binary, DataKind::BinaryCompressed];

/// The frame of a file, seen by a camera if one is given.
pub(crate) fn open(path: &Path, camera: Option<&GridCamera>) -> Result<Capture> {
    objecthood_io::open_frame(path, &given(camera))
}

/// As [`open`], for the content of a file.
pub(crate) fn decode(bytes: &[u8], camera: Option<&GridCamera>) -> Result<Capture> {
    objecthood_io::decode(bytes, &given(camera))
}

fn given(camera: Option<&GridCamera>) -> Given {
    Given { camera: camera.copied(), ..Given::default() }
}

/// A PCD file written by `pcd-rs`.
pub(crate) fn pcd_file(
    (width, height): (u64, u64),
    data_kind: DataKind,
    schema: &[(&str, ValueKind, u64)],
    records: Vec<Vec<Field>>,
) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let schema = schema.iter().map(|&(name, kind, count)| (name.to_owned(), kind, count));
    let init = WriterInit {
        width,
        height,
        viewpoint: Default::default(),
        data_kind,
        schema: Some(schema.collect::<Schema>()),
        version: None,
    };
    let mut writer = init.build_from_writer::<DynRecord, _>(&mut file).unwrap();
    for record in records {
        writer.push(&DynRecord(record)).unwrap();
    }
    writer.finish().unwrap();
    file.into_inner()
}

/// A valid file of 4 x 3 points that a camera saw, with the fields of mOSD. Point 0 is missing.
pub(crate) fn small_file(encoding: DataKind) -> Vec<u8> {
    let schema = [
        ("label", ValueKind::U32, 1),
        ("x", ValueKind::F32, 1),
        ("y", ValueKind::F32, 1),
        ("z", ValueKind::F32, 1),
        ("rgba", ValueKind::U32, 1),
    ];
    let camera = objecthood::Camera::new(4.0, 4.0, 1.5, 1.0).unwrap();
    let record = |i: usize| {
        let [x, y, z] =
            if i == 0 { [f32::NAN; 3] } else { camera.back_project(i % 4, i / 4, 1.0 + i as f32 / 8.0) };
        vec![
            Field::U32(vec![i as u32]),
            Field::F32(vec![x]),
            Field::F32(vec![y]),
            Field::F32(vec![z]),
            Field::U32(vec![0xff10_2030 + i as u32]),
        ]
    };
    pcd_file((4, 3), encoding, &schema, (0..12).map(record).collect())
}

/// The points of [`small_file`] as PLY, with their colours, without the missing one, and with a face.
pub(crate) fn small_ply() -> Vec<u8> {
    let camera = objecthood::Camera::new(4.0, 4.0, 1.5, 1.0).unwrap();
    let mut file = String::from(
        "ply\nformat ascii 1.0\ncomment 11 points\nelement vertex 11\nproperty float x\nproperty float y\n\
         property double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n\
         property list uchar int vertex_indices\nend_header\n",
    );
    for i in 1..12 {
        let [x, y, z] = camera.back_project(i % 4, i / 4, 1.0 + i as f32 / 8.0);
        file += &format!("{x} {y} {z} 16 32 {}\n", 48 + i);
    }
    (file + "3 0 1 2\n").into_bytes()
}

/// The same points in binary numbers.
pub(crate) fn small_binary_ply() -> Vec<u8> {
    let camera = objecthood::Camera::new(4.0, 4.0, 1.5, 1.0).unwrap();
    let text = String::from_utf8(small_ply()).unwrap();
    let header = &text[..text.find("end_header\n").unwrap() + "end_header\n".len()];
    let mut file = header.replace("ascii", "binary_little_endian").into_bytes();
    for i in 1..12 {
        let [x, y, z] = camera.back_project(i % 4, i / 4, 1.0 + i as f32 / 8.0);
        file.extend([x.to_le_bytes(), y.to_le_bytes()].as_flattened());
        file.extend(f64::from(z).to_le_bytes());
        file.extend([16, 32, 48 + i as u8]);
    }
    file.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    file
}

/// The folder of the real data, if it is there; else says that the test is skipped.
pub(crate) fn data_folder() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("OBJECTHOOD_DATA").map_or(beside, PathBuf::from);
    if folder.join("mosd/learn").is_dir() {
        return Some(folder);
    }
    println!("skipped: no real data here, set OBJECTHOOD_DATA to the folder that holds mosd/learn");
    None
}
