//! One scene, written by programs in Python that know nothing of objecthood, and damage to what they wrote.

use std::path::Path;
use std::process::Command;

use objecthood_io::Capture;

pub(crate) const WIDTH: usize = 80;
pub(crate) const HEIGHT: usize = 60;

/// Depth (mm) and colour of a slanted wall with a box before it and a corner without depth.
pub(crate) fn scene() -> (Vec<u16>, Vec<[u8; 3]>) {
    let pixel = |i: usize| {
        let (u, v) = (i % WIDTH, i / WIDTH);
        let is_box = (30..50).contains(&u) && (20..40).contains(&v);
        let depth = if u < 5 && v < 5 {
            0
        } else if is_box {
            700
        } else {
            1000 + 2 * u + v
        };
        (depth as u16, [u as u8 * 3, v as u8 * 4, if is_box { 200 } else { 20 }])
    };
    (0..WIDTH * HEIGHT).map(pixel).unzip()
}

/// A file of NumPy, version 1.0.
fn npy(kind: &str, shape: &str, bytes: &[u8]) -> Vec<u8> {
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}");
    header += &" ".repeat((64 - (11 + header.len()) % 64) % 64);
    header.push('\n');
    [b"\x93NUMPY\x01\0", &(header.len() as u16).to_le_bytes()[..], header.as_bytes(), bytes].concat()
}

/// The folder with what a script beside this one wrote of the scene, if there is a Python to run it.
pub(crate) fn written(script: &str) -> Option<tempfile::TempDir> {
    let Some(python) = std::env::var_os("OBJECTHOOD_PYTHON") else {
        println!("skipped: no Python in OBJECTHOOD_PYTHON runs {script}");
        return None;
    };
    let folder = tempfile::tempdir().unwrap();
    let (depth, color) = scene();
    let depth: Vec<u8> = depth.iter().flat_map(|z| z.to_le_bytes()).collect();
    std::fs::write(folder.path().join("depth.npy"), npy("<u2", &format!("{HEIGHT}, {WIDTH}"), &depth))
        .unwrap();
    let color = npy("|u1", &format!("{HEIGHT}, {WIDTH}, 3"), color.as_flattened());
    std::fs::write(folder.path().join("color.npy"), color).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(script);
    assert!(Command::new(python).arg(script).arg(folder.path()).status().unwrap().success());
    Some(folder)
}

/// Depth, bit by bit; 0 where there is none.
pub(crate) fn bits(capture: &Capture) -> Vec<u32> {
    capture.frame.depth_m().as_slice().iter().map(|z| if z.is_nan() { 0 } else { z.to_bits() }).collect()
}

/// The depth as images of whole millimetres give it.
pub(crate) fn expected() -> Vec<u32> {
    let metres = |z: u16| if z == 0 { 0 } else { ((f64::from(z) / 1000.0) as f32).to_bits() };
    scene().0.into_iter().map(metres).collect()
}

/// Damage to a file: cuts at 100 places, and single bytes or the eight bytes of a length changed at so many places.
pub(crate) struct Damage {
    pub(crate) places: usize,
    pub(crate) seed: u64,
}

impl Damage {
    /// Calls `check` with each damaged file, and what was done to it.
    pub(crate) fn of(self, good: &[u8], check: impl Fn(&[u8], &str)) {
        (0..100).for_each(|k| check(&good[..good.len() * k / 100], &format!("cut {k}")));
        // A generator of numbers that all machines repeat.
        let mut state = self.seed;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize
        };
        for k in 0..self.places {
            let mut bytes = good.to_vec();
            // Half of them among the first and last bytes, where lengths and lists are.
            let at = match k % 4 {
                0 => random() % bytes.len().min(2000),
                1 => bytes.len() - 1 - random() % bytes.len().min(2000),
                _ => random() % bytes.len(),
            };
            let end = bytes.len().min(at + 8);
            match k % 20 {
                9 => bytes[at..end].fill(0xff),
                19 => {
                    let length = 1_u64 << if k % 40 == 19 { 31 } else { 63 };
                    let of_file = if k % 80 < 40 { length.to_le_bytes() } else { length.to_be_bytes() };
                    bytes[at..end].copy_from_slice(&of_file[..end - at]);
                }
                _ => bytes[at] = random() as u8,
            }
            check(&bytes, &format!("byte {at}"));
        }
    }
}
