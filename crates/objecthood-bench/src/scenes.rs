//! Synthetic frames that are measured, as files. The same bytes on every machine.

use std::path::Path;

use anyhow::{Context, Result};
use objecthood::Camera;
use objecthood_scene::{Family, Sensor, Viewpoint, World, crowd, export, generate, render};

/// Columns of images of 4:3 with 0.08, 0.3, 0.9 and 2.1 megapixels.
pub const WIDTHS_PX: [usize; 4] = [320, 640, 1104, 1680];
/// How many things stand on the table.
pub const OBJECTS: [usize; 4] = [0, 5, 20, 80];
/// Scenes of each kind.
const SEEDS: std::ops::Range<u64> = 0..3;
/// Things on the table in scenes of several sizes.
const THINGS: usize = 20;

/// Writes the scenes of growing size, `size-WIDTH-SEED.pcd`, and of growing number, `objects-COUNT-SEED.pcd`.
///
/// # Errors
/// When a file cannot be written.
pub fn write_growing(folder: &Path) -> Result<()> {
    for seed in SEEDS {
        for width in WIDTHS_PX {
            let world = scaled(&crowd(THINGS, seed), width)?;
            write(&world, &folder.join(format!("size-{width}-{seed}.pcd")))?;
        }
        for objects in OBJECTS {
            write(&crowd(objects, seed), &folder.join(format!("objects-{objects}-{seed}.pcd")))?;
        }
    }
    Ok(())
}

/// Writes the frame whose instructions are counted: the scene of `objecthood demo`.
///
/// # Errors
/// When the file cannot be written.
pub fn write_demo(file: &Path) -> Result<()> {
    let world = generate(Family::Tabletop, 34);
    let frame = render(&world, Sensor::Kinect)?.frame;
    std::fs::write(file, objecthood_counted::to_bytes(&frame)?).with_context(|| format!("{}", file.display()))
}

/// The same scene through a camera with more or fewer pixels.
fn scaled(world: &World, width: usize) -> Result<World> {
    let Viewpoint { camera: c, size_px: (from, height), pose } = *world.viewpoint();
    let scale = width as f64 / from as f64;
    // Pixel centres are whole numbers, so the image begins at -0.5.
    let center = |c: f64| (c + 0.5) * scale - 0.5;
    let camera = Camera::new(c.fx_px * scale, c.fy_px * scale, center(c.cx_px), center(c.cy_px))?;
    let size_px = (width, (height as f64 * scale).round() as usize);
    Ok(world.with_viewpoint(Viewpoint { camera, size_px, pose })?)
}

fn write(world: &World, file: &Path) -> Result<()> {
    let rendered = render(world, Sensor::Kinect)?;
    std::fs::write(file, export::pcd(world, &rendered, false)).with_context(|| format!("{}", file.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scaled_camera_sees_the_same_part_of_the_scene() {
        let world = crowd(1, 0);
        for width in WIDTHS_PX {
            let small = scaled(&world, width).unwrap();
            let (was, is) = (world.viewpoint(), small.viewpoint());
            assert_eq!(is.size_px, (width, width * 3 / 4));
            // The rays of the image's own corners, not of the pixels in them.
            let end = |view: &Viewpoint| {
                let (w, h) = view.size_px;
                let [x, y, z] = view.camera.ray(w as f64 - 0.5, h as f64 - 0.5);
                [x / z, y / z]
            };
            let (was, is) = (end(was), end(is));
            assert!((was[0] - is[0]).abs() < 1e-12 && (was[1] - is[1]).abs() < 1e-12, "{was:?} {is:?}");
        }
    }
}
