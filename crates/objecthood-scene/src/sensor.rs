//! Depth cameras: what each makes of the exact geometry.

mod ideal;
mod kinect;
mod stereo;
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
#[serde(rename_all = "snake_case")]
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
}

impl Sensor {
    /// Every sensor there is.
    pub const ALL: [Self; 4] = [Self::Kinect, Self::Stereo, Self::Tof, Self::Ideal];

    /// Its name, as [`FromStr`] reads it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kinect => "kinect",
            Self::Stereo => "stereo",
            Self::Tof => "tof",
            Self::Ideal => "ideal",
        }
    }

    pub(crate) fn measure(self, world: &World, view: &View) -> Vec<Measured> {
        match self {
            Self::Kinect => kinect::measure(world, view),
            Self::Stereo => stereo::measure(world, view),
            Self::Tof => tof::measure(world, view),
            Self::Ideal => ideal::measure(view),
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
    const NONE: Self = Self { depth_m: f32::NAN, source: 0 };
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

#[cfg(test)]
mod tests {
    use objecthood::Raster;

    use super::*;
    use crate::family::{Family, generate};
    use crate::pose::Pose;
    use crate::solid::{Role, Solid};
    use crate::texture::Paint;
    use crate::thing;

    /// A wall that the camera faces at `wall_m`, and, unless it is 0, a box of 0.2 m before it at `box_m`.
    fn wall_and_box(wall_m: f64, box_m: f64) -> World {
        let world = generate(Family::Single, 1);
        let facing = |size: f64, depth: f64| -> Solid {
            let pose = world.viewpoint().pose;
            let grey = Paint::plain([0.5; 3]);
            let solid = thing::block("box", Role::Object, [size, size, 0.05], grey);
            solid.at(Pose { origin: pose.point(DVec3::new(0.0, 0.0, depth)), ..pose })
        };
        let mut solids = vec![facing(5.0, wall_m)];
        if box_m > 0.0 {
            solids.push(facing(0.2, box_m));
        }
        world.with_solids(solids)
    }

    fn depths(world: &World, sensor: Sensor) -> Raster<f32> {
        let measured = sensor.measure(world, &View::of(world));
        Raster::from_vec(640, 480, measured.iter().map(|m| m.depth_m).collect()).unwrap()
    }

    fn deviation(depths: &Raster<f32>, from_m: f64) -> f64 {
        let errors: Vec<f64> =
            depths.as_slice().iter().filter(|z| !z.is_nan()).map(|&z| f64::from(z) - from_m).collect();
        assert!(errors.len() > depths.len() * 99 / 100, "{} pixels have depth", errors.len());
        (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
    }

    /// Missing pixels in the middle row, left and right of the image's middle.
    fn missing(depths: &Raster<f32>) -> [usize; 2] {
        let row = &depths.as_slice()[240 * 640..][..640];
        [&row[..320], &row[320..]].map(|half| half.iter().filter(|z| z.is_nan()).count())
    }

    #[test]
    fn names_are_read_back() {
        for sensor in Sensor::ALL {
            assert_eq!(sensor.name().parse::<Sensor>().unwrap(), sensor);
        }
        let message = "lidar".parse::<Sensor>().unwrap_err().to_string();
        assert_eq!(message, "`lidar` is not a sensor: choose kinect, stereo, tof or ideal");
    }

    #[test]
    fn noise_grows_as_each_principle_says() {
        let at = |sensor, wall_m| deviation(&depths(&wall_and_box(wall_m, 0.0), sensor), wall_m);
        assert!(at(Sensor::Ideal, 1.0) < 1e-7);
        // Triangulation: with the square of the distance. Time of flight: with the distance at most.
        for (sensor, growth, at_one_meter) in [
            (Sensor::Kinect, 3.5..4.5, 0.0025..0.004),
            (Sensor::Stereo, 3.5..4.5, 0.002..0.004),
            (Sensor::Tof, 0.8..2.2, 0.0007..0.003),
        ] {
            let (near, far) = (at(sensor, 1.0), at(sensor, 2.0));
            assert!(at_one_meter.contains(&near), "{sensor} {near}");
            assert!(growth.contains(&(far / near)), "{sensor} {near} {far}");
        }
    }

    #[test]
    fn a_kinect_resolves_steps_of_disparity() {
        let depths = depths(&generate(Family::Tabletop, 2), Sensor::Kinect);
        for z in depths.as_slice().iter().filter(|z| !z.is_nan()) {
            let half_steps = 348.0 / f64::from(*z) - 0.5;
            assert!((half_steps - half_steps.round()).abs() < 1e-3, "{z}");
        }
        let mut steps: Vec<u32> = depths.as_slice().iter().map(|z| z.to_bits()).collect();
        steps.sort_unstable();
        steps.dedup();
        assert!((100..700).contains(&steps.len()), "{} depths", steps.len());
    }

    #[test]
    fn shadows_fall_where_the_devices_are_built_so() {
        // Shadow of a point light or eye beside the camera: f b (1 / near - 1 / far).
        let world = wall_and_box(1.4, 0.7);
        let width = |beside_m: f64| 525.0 * beside_m * (1.0 / 0.7 - 1.0 / 1.4);
        let [left, right] = missing(&depths(&world, Sensor::Kinect));
        assert!((left as f64 - width(0.050)).abs() < 6.0, "{left} px left instead of {}", width(0.050));
        assert!((right as f64 - width(0.025)).abs() < 6.0, "{right} px right instead of {}", width(0.025));
        let [left, right] = missing(&depths(&world, Sensor::Stereo));
        assert!((left as f64 - width(0.065)).abs() < 8.0 && right < 3, "{left} {right}");
        assert_eq!(missing(&depths(&world, Sensor::Ideal)), [0, 0]);
        let [left, right] = missing(&depths(&world, Sensor::Tof));
        assert!(left <= 2 && right <= 2, "{left} {right}");
    }

    #[test]
    fn only_time_of_flight_sees_points_in_mid_air() {
        let world = wall_and_box(1.4, 0.7);
        let flying = |sensor| {
            let depths = depths(&world, sensor);
            depths.as_slice().iter().filter(|z| (0.75..1.3).contains(*z)).count()
        };
        assert!(flying(Sensor::Tof) > 100);
        for sensor in [Sensor::Kinect, Sensor::Stereo, Sensor::Ideal] {
            assert_eq!(flying(sensor), 0, "{sensor}");
        }
    }
}
