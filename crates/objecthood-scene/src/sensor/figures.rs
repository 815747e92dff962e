//! The figures of every sensor, measured on simple scenes and held against what is published.

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
    assert_eq!(
        message,
        "`lidar` is not a sensor: choose kinect, stereo, tof, ideal, phone or structured-light"
    );
}

/// At three distances (m), between these figures (m) times a power of the distance.
#[test]
fn noise_is_as_published() {
    for (sensor, low, high, power) in [
        // Khoshelham and Elberink 2012: 1.4 mm at 1 m; the raw steps and the warp of the whole image add to it.
        (Sensor::Kinect, 0.0014, 0.0042, 2),
        // Grunnet-Jepsen et al. 2018: 0.05 to 0.1 px of a D435.
        (Sensor::Stereo, 0.0026, 0.0052, 2),
        // The specification of the Azure Kinect: deviation of 17 mm at most; Tölgyessy et al. 2021: some mm.
        (Sensor::Tof, 0.0007, 0.004, 1),
        // Luetzenburg, Kroon and Bjørk 2021: 1 cm, as far as 3 m.
        (Sensor::Phone, 0.001, 0.0033, 1),
        // Data sheet of the PhoXi M: 0.1 mm at 0.65 m.
        (Sensor::StructuredLight, 0.000_2, 0.000_3, 2),
    ] {
        for wall_m in [0.8, 1.5, 3.0] {
            let scale = f64::powi(wall_m, power);
            let noise = deviation(&depths(&wall_and_box(wall_m, 0.0), sensor), wall_m) / scale;
            assert!((low..high).contains(&noise), "{sensor} at {wall_m} m: {noise}");
        }
    }
    assert!(deviation(&depths(&wall_and_box(1.0, 0.0), Sensor::Ideal), 1.0) < 1e-7);
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
    let [left, right] = missing(&depths(&world, Sensor::StructuredLight));
    assert!((left as f64 - width(0.12)).abs() < 6.0 && right <= 3, "{left} {right}");
}

#[test]
fn only_time_of_flight_sees_points_in_mid_air() {
    let world = wall_and_box(1.4, 0.7);
    let flying = |sensor| {
        let depths = depths(&world, sensor);
        depths.as_slice().iter().filter(|z| (0.75..1.3).contains(*z)).count()
    };
    assert!(flying(Sensor::Tof) > 100);
    for sensor in [Sensor::Kinect, Sensor::Stereo, Sensor::Ideal, Sensor::StructuredLight] {
        assert_eq!(flying(sensor), 0, "{sensor}");
    }
}

/// Of the middle 40 rows, how many pixels of the right half each has for which this holds, on average.
fn a_row(depths: &Raster<f32>, holds: impl Fn(f32) -> bool) -> f64 {
    let right = (220..260).flat_map(|v| (v * 640 + 320..(v + 1) * 640).map(move |i| depths[i]));
    right.filter(|&z| holds(z)).count() as f64 / 40.0
}

#[test]
fn near_surfaces_grow_before_a_stereo_camera() {
    let world = wall_and_box(1.4, 0.7);
    let near = |sensor| a_row(&depths(&world, sensor), |z| z < 1.0);
    let grown = near(Sensor::Stereo) - near(Sensor::Ideal);
    assert!((1.0..4.0).contains(&grown), "{grown} px");
    assert!((near(Sensor::Kinect) - near(Sensor::Ideal)).abs() < 1.0);
    assert!((near(Sensor::StructuredLight) - near(Sensor::Ideal)).abs() <= 1.0);
}

#[test]
fn a_phone_has_ramps_and_no_holes() {
    let depths = depths(&wall_and_box(1.4, 0.7), Sensor::Phone);
    assert!(depths.as_slice().iter().all(|z| z.is_finite()));
    let ramp = a_row(&depths, |z| (0.77..1.33).contains(&z));
    assert!((6.0..8.0).contains(&ramp), "{ramp} px from a tenth to nine tenths of the step");
}

#[test]
fn dark_surfaces_are_noisy_for_time_of_flight() {
    let noise = |albedo: f64| {
        let mut world = wall_and_box(1.0, 0.0);
        let mut wall = world.solids()[0].clone();
        wall.parts[0].paints = vec![Paint::plain([albedo; 3])];
        world = world.with_solids(vec![wall]);
        let depths = depths(&world, Sensor::Tof);
        let row = &depths.as_slice()[240 * 640 + 220..][..200];
        let mean = row.iter().sum::<f32>() / 200.0;
        (row.iter().map(|z| f64::from((z - mean) * (z - mean))).sum::<f64>() / 200.0).sqrt()
    };
    let ratio = noise(0.05) / noise(0.8);
    assert!((2.5..5.0).contains(&ratio), "{ratio}");
}

#[test]
fn light_over_two_walls_rounds_the_corner_between_them() {
    let world = wall_and_box(1.0, 0.0);
    let pose = world.viewpoint().pose;
    let walls = [-1.0, 1.0].map(|side| {
        let grey = Paint::plain([0.6; 3]);
        // They meet at a right angle 1.5 m before the camera.
        let aside = std::f64::consts::FRAC_1_SQRT_2;
        let origin = pose.point(DVec3::new(side * aside, 0.0, 1.5 - aside));
        let solid = thing::block("wall", Role::Room, [2.0, 2.0, 0.02], grey);
        solid.at(Pose { origin, ..pose }.turned(1, side * 45.0))
    });
    let world = world.with_solids(walls.into());
    let (measured, exact) = (depths(&world, Sensor::Tof), depths(&world, Sensor::Ideal));
    assert!((f64::from(exact[240 * 640 + 320]) - 1.5).abs() < 0.01, "{}", exact[240 * 640 + 320]);
    let error_mm = |columns: std::ops::Range<usize>| {
        let pixels = (200..280).flat_map(|v| columns.clone().map(move |u| v * 640 + u));
        let errors: Vec<f64> = pixels.map(|i| 1000.0 * f64::from(measured[i] - exact[i])).collect();
        errors.iter().filter(|e| !e.is_nan()).sum::<f64>() / errors.len() as f64
    };
    let (corner, aside) = (error_mm(300..340), error_mm(330..400));
    assert!((3.0..60.0).contains(&corner) && (3.0..60.0).contains(&aside), "{corner} mm, {aside} mm");
}
