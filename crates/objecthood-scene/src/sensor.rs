//! Depth cameras: what each makes of the exact geometry.

#[cfg(test)]
mod figures;
mod ideal;
mod kinect;
mod phone;
mod stereo;
mod structured_light;
mod tof;

use std::fmt;
use std::str::FromStr;

use glam::DVec3;

use crate::error::{Error, choices};
use crate::ray::Ray;
use crate::view::View;
use crate::world::{Sight, World};

/// A kind of depth camera. Its model and the sources of its figures stand in the module of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Sensor {
    /// Kinect v1, Xtion, `PrimeSense` Carmine: structured light.
    Kinect,
    /// RealSense D4xx-like: active stereo.
    Stereo,
    /// Kinect v2 or Azure Kinect-like: time of flight.
    Tof,
    /// No error but rounding to f32.
    Ideal,
    /// Phone: few measurements, made dense and smooth.
    Phone,
    /// Scanner for industry: dense structured light.
    StructuredLight,
}

impl Sensor {
    /// Every sensor there is.
    pub const ALL: [Self; 6] =
        [Self::Kinect, Self::Stereo, Self::Tof, Self::Ideal, Self::Phone, Self::StructuredLight];

    /// Its name, as [`FromStr`] reads it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kinect => "kinect",
            Self::Stereo => "stereo",
            Self::Tof => "tof",
            Self::Ideal => "ideal",
            Self::Phone => "phone",
            Self::StructuredLight => "structured-light",
        }
    }

    pub(crate) fn measure(self, world: &World, view: &View) -> Vec<Measured> {
        match self {
            Self::Kinect => kinect::measure(world, view),
            Self::Stereo => stereo::measure(world, view),
            Self::Tof => tof::measure(world, view),
            Self::Ideal => ideal::measure(view),
            Self::Phone => phone::measure(world, view),
            Self::StructuredLight => structured_light::measure(world, view),
        }
    }
}

impl fmt::Display for Sensor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Sensor {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        Self::ALL
            .into_iter()
            .find(|sensor| sensor.name() == name)
            .ok_or_else(|| Error::UnknownSensor { name: name.to_owned(), known: choices(Self::ALL) })
    }
}

/// What a sensor says of a pixel.
#[derive(Clone, Copy)]
pub(crate) struct Measured {
    /// Depth (m); `NaN` = none.
    pub(crate) depth_m: f32,
    /// Index of the pixel whose surface was measured; meaningless without depth.
    pub(crate) source: usize,
}

impl Measured {
    pub(crate) const NONE: Self = Self { depth_m: f32::NAN, source: 0 };
}

/// Cosine of the angle between the line of sight and the normal.
fn facing(world: &World, sight: &Sight) -> f64 {
    let toward = world.viewpoint().pose.origin - sight.point;
    sight.normal.dot(toward).max(0.0) / toward.length()
}

/// The depth at which a pixel's ray meets the tangent plane of what another pixel sees; that pixel's own depth when
/// the plane is too steep to be continued.
fn continued_depth(ray: Ray, sight: &Sight) -> f64 {
    const STEEPEST: f64 = 0.2;
    const FARTHEST: f64 = 0.02;
    let slope = ray.direction.dot(sight.normal);
    let depth = (sight.point - ray.origin).dot(sight.normal) / slope;
    let is_usable =
        slope < -STEEPEST * ray.direction.length() && (depth - sight.t).abs() < FARTHEST * sight.t;
    if is_usable { depth } else { sight.t }
}

/// Whether a projector or second camera beside the camera sees the surface; `beside_m` to the camera's right.
fn seen_from(world: &World, sight: &Sight, beside_m: f64) -> bool {
    let place = world.viewpoint().pose.point(DVec3::new(beside_m, 0.0, 0.0));
    world.sees(sight.point, sight.normal, place)
}

/// The pixels of the square of half size `radius` around (u, v), inside the image.
fn window(view: &View, u: usize, v: usize, radius: usize) -> impl Iterator<Item = usize> + use<> {
    let width = view.width;
    let columns = u.saturating_sub(radius)..(u + radius + 1).min(width);
    let rows = v.saturating_sub(radius)..(v + radius + 1).min(view.height);
    rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
}

/// The pixel nearest to (u + du, v + dv) in the image.
fn displaced(view: &View, (u, v): (usize, usize), (du, dv): (f64, f64)) -> (usize, usize) {
    let moved = |at: usize, by: f64, size: usize| ((at as f64 + by).round().max(0.0) as usize).min(size - 1);
    (moved(u, du, view.width), moved(v, dv, view.height))
}
