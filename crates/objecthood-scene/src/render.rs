//! From a world to what a depth camera gives of it, with the truth.

use objecthood::{Frame, Raster};

use crate::color;
use crate::error::Result;
use crate::sensor::Sensor;
use crate::truth::Truth;
use crate::view::View;
use crate::world::World;

/// A picture of a world and the truth about it.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// What the sensor gives.
    pub frame: Frame,
    /// What each depth was measured on; 0 where there is none. At borders a sensor may take its neighbour's depth.
    pub truth: Truth,
    /// What the ray through the middle of each pixel meets first, whether there is depth or not.
    pub first_hit: Truth,
    /// For each solid of the world: its pixels in `first_hit` over the pixels it would have if it were alone in the
    /// image; 0 outside the image.
    pub visible_fraction: Vec<f64>,
}

/// Takes a picture. The same world and sensor give the same bytes on every machine and number of threads; it runs on
/// the current rayon pool. About 5 µs a pixel on one thread.
///
/// # Errors
/// [`Error::Frame`](crate::Error::Frame) when the camera sees nothing within the sensor's range.
pub fn render(world: &World, sensor: Sensor) -> Result<Rendered> {
    let view = View::of(world);
    let measured = sensor.measure(world, &view);
    let first_hit = view.truth()?;

    let of_source = |truth: &Raster<u16>| {
        let values = measured.iter().map(|m| if m.depth_m.is_nan() { 0 } else { truth[m.source] }).collect();
        Raster::from_vec(view.width, view.height, values)
    };
    let truth = Truth { instance: of_source(&first_hit.instance)?, surface: of_source(&first_hit.surface)? };
    let depth_m = Raster::from_vec(view.width, view.height, measured.iter().map(|m| m.depth_m).collect())?;
    let color = color::picture(world, &view)?;
    Ok(Rendered {
        frame: Frame::new(depth_m, Some(color), world.viewpoint().camera)?,
        truth,
        first_hit,
        visible_fraction: view.visible_fractions(),
    })
}
