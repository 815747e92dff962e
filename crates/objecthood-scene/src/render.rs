//! From a world to what a depth camera gives of it, with the truth.

use objecthood::{Frame, Raster};

use crate::color;
use crate::error::Result;
use crate::holes::Holes;
use crate::sensor::{Measured, Sensor};
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
    /// What took depth from pixels besides the sensor.
    pub holes: Holes,
}

/// What a world shows before any sensor. Most of the time of a picture goes here, so several sensors had better share one.
pub struct Exposure<'a> {
    world: &'a World,
    view: View,
    first_hit: Truth,
    color: Raster<[u8; 3]>,
}

impl<'a> Exposure<'a> {
    /// Looks at a world from its viewpoint. About 5 µs a pixel on one thread.
    ///
    /// # Errors
    /// [`Error::Frame`](crate::Error::Frame) never in practice.
    pub fn of(world: &'a World) -> Result<Self> {
        let view = View::of(world);
        Ok(Self { first_hit: view.truth()?, color: color::picture(world, &view)?, world, view })
    }

    /// What a sensor makes of it.
    ///
    /// # Errors
    /// [`Error::Frame`](crate::Error::Frame) when the camera sees nothing within the sensor's range.
    pub fn seen_by(&self, sensor: Sensor, holes: Holes) -> Result<Rendered> {
        let Self { world, view, first_hit, color } = self;
        let (width, height) = (view.width, view.height);
        let mut measured = sensor.measure(world, view);
        for (i, pixel) in measured.iter_mut().enumerate() {
            if holes.takes(i % width, i / width) {
                *pixel = Measured::NONE;
            }
        }
        let of_source = |truth: &Raster<u16>| {
            let source = |m: &Measured| if m.depth_m.is_nan() { 0 } else { truth[m.source] };
            Raster::from_vec(width, height, measured.iter().map(source).collect())
        };
        let truth =
            Truth { instance: of_source(&first_hit.instance)?, surface: of_source(&first_hit.surface)? };
        let depth_m = Raster::from_vec(width, height, measured.iter().map(|m| m.depth_m).collect())?;
        Ok(Rendered {
            frame: Frame::new(depth_m, Some(color.clone()), world.viewpoint().camera)?,
            truth,
            first_hit: first_hit.clone(),
            visible_fraction: view.visible_fractions(),
            holes,
        })
    }
}

/// Takes a picture. The same world and sensor give the same bytes on every machine and number of threads; it runs on
/// the current rayon pool. About 5 µs a pixel on one thread.
///
/// # Errors
/// [`Error::Frame`](crate::Error::Frame) when the camera sees nothing within the sensor's range.
pub fn render(world: &World, sensor: Sensor) -> Result<Rendered> {
    Exposure::of(world)?.seen_by(sensor, Holes::None)
}
