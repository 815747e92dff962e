//! Boxes on a table, seen by a camera that looks down on them, as point clouds with truth.

use std::fmt::Write;

/// What a pixel sees.
#[derive(Clone, Copy)]
pub(crate) struct Point {
    pub(crate) xyz_m: [f32; 3],
    pub(crate) color: [u8; 3],
    /// As in mOSD: 1 table, 20 first object, 30 second object, ..
    pub(crate) label: u32,
}

/// The points of an image, row by row.
#[derive(Clone)]
pub(crate) struct Cloud {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) points: Vec<Point>,
}

/// An upright box on the table.
struct Block {
    min_m: [f64; 3],
    max_m: [f64; 3],
    color: [u8; 3],
}

pub(crate) const FOCAL_PX: f64 = 262.5;

impl Cloud {
    /// A table with two boxes, 320 x 240 pixels; `shift_m` moves the boxes to the right, so that scenes differ.
    pub(crate) fn two_boxes(shift_m: f64) -> Self {
        let block = |x: f64, y: f64, half: f64, height: f64, color| Block {
            min_m: [x - half, y - half, 0.0],
            max_m: [x + half, y + half, height],
            color,
        };
        let blocks = [
            block(-0.12 + shift_m, 0.0, 0.06, 0.12, [200, 40, 40]),
            block(0.12 + shift_m, 0.05, 0.05, 0.08, [40, 60, 200]),
        ];
        Self::seen(320, 240, &blocks)
    }

    /// Casts a ray through every pixel.
    fn seen(width: usize, height: usize, blocks: &[Block]) -> Self {
        let (sin, cos) = 40_f64.to_radians().sin_cos();
        let camera_m = [0.0, -0.75, 0.65];
        let mut points = Vec::new();
        for v in 0..height {
            for u in 0..width {
                let x = (u as f64 - (width as f64 - 1.0) / 2.0) / FOCAL_PX;
                let y = (v as f64 - (height as f64 - 1.0) / 2.0) / FOCAL_PX;
                // The camera's right, down and forward in a world whose z is up.
                let ray = [x, cos - sin * y, -sin - cos * y];
                let table = (-camera_m[2] / ray[2], [150, 140, 120], 1);
                let nearest = blocks
                    .iter()
                    .enumerate()
                    .filter_map(|(k, block)| {
                        Some((block.hit(camera_m, ray)?, block.color, 20 + 10 * k as u32))
                    })
                    .fold(table, |a, b| if b.0 < a.0 { b } else { a });
                points.push(match nearest {
                    (z, color, label) if z < 1.4 => {
                        Point { xyz_m: [x * z, y * z, z].map(|c| c as f32), color, label }
                    }
                    _ => Point { xyz_m: [f32::NAN; 3], color: [0; 3], label: 0 },
                });
            }
        }
        Self { width, height, points }
    }

    /// The cloud with every point changed.
    pub(crate) fn map(mut self, change: impl Fn(&mut Point)) -> Self {
        self.points.iter_mut().for_each(change);
        self
    }

    /// As a PCD file, `DATA ascii`.
    pub(crate) fn to_pcd(&self) -> Vec<u8> {
        let (width, height) = (self.width, self.height);
        let mut text = header(width, height, "ascii");
        for Point { xyz_m: [x, y, z], color: [r, g, b], label } in &self.points {
            let rgba = u32::from_be_bytes([0, *r, *g, *b]);
            writeln!(text, "{x} {y} {z} {rgba} {label}").unwrap();
        }
        text.into_bytes()
    }

    /// As a PCD file, `DATA binary`.
    pub(crate) fn to_binary_pcd(&self) -> Vec<u8> {
        let mut bytes = header(self.width, self.height, "binary").into_bytes();
        for Point { xyz_m, color: [r, g, b], label } in &self.points {
            bytes.extend(xyz_m.iter().flat_map(|c| c.to_le_bytes()));
            bytes.extend([*b, *g, *r, 0]);
            bytes.extend(label.to_le_bytes());
        }
        bytes
    }
}

/// The header of a PCD file with x, y, z, rgba and label.
pub(crate) fn header(width: usize, height: usize, data: &str) -> String {
    format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgba label\nSIZE 4 4 4 4 4\n\
         TYPE F F F U U\nCOUNT 1 1 1 1 1\nWIDTH {width}\nHEIGHT {height}\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA {data}\n",
        width.saturating_mul(height)
    )
}

impl Block {
    /// How far along the ray it is entered, if it is.
    fn hit(&self, from: [f64; 3], ray: [f64; 3]) -> Option<f64> {
        let (mut enter, mut leave) = (0_f64, f64::INFINITY);
        for axis in 0..3 {
            let (a, b) =
                ((self.min_m[axis] - from[axis]) / ray[axis], (self.max_m[axis] - from[axis]) / ray[axis]);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        (enter < leave).then_some(enter)
    }
}
