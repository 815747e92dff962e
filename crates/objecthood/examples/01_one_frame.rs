//! One frame in, objects out: the whole library in one call.
//!
//! `cargo run --release -p objecthood --example 01_one_frame`

mod world;

use objecthood::{Params, discover};
use world::{Solid, snapshot};

#[expect(clippy::print_stdout, reason = "an example talks to its reader")]
pub(crate) fn main() -> objecthood::Result<()> {
    // A frame is depth in metres (NaN = none), colour registered to it, and the camera's intrinsics:
    // `Frame::new(Raster::from_vec(width, height, depth_m)?, Some(color), Camera::new(fx, fy, cx, cy)?)?`.
    let frame = snapshot(&[
        Solid { base_m: [-0.15, 0.0, 0.0], size_m: [0.18, 0.14, 0.12], yaw_deg: 25.0, color: [180, 40, 30] },
        Solid { base_m: [0.17, 0.05, 0.0], size_m: [0.14, 0.14, 0.18], yaw_deg: -30.0, color: [30, 70, 150] },
    ]);

    let found = discover(&frame, &Params::default())?;

    for object in &found.objects {
        let [x, y, z] = object.centroid_m;
        println!(
            "object {}: objectness {:.2}, {} pixels, {:.2} m right, {:.2} m below and {:.2} m before the camera",
            object.id.0, object.objectness, object.size_px, x, y, z
        );
    }
    let labelled = found.labels.as_slice().iter().filter(|&&label| label > 0).count();
    println!("{} objects on {labelled} of {} pixels", found.objects.len(), found.labels.len());
    Ok(())
}
