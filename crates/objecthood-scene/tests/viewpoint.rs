//! Cameras anywhere: what they see is exact, and what cannot be one is refused.
#![allow(clippy::unwrap_used, reason = "what fails is reported so")]

use objecthood::Camera;
use objecthood_scene::{Error, Family, Pose, Sensor, Viewpoint, generate, render};

const CAMERA: Camera = Camera { fx_px: 60.0, fy_px: 55.0, cx_px: 39.5, cy_px: 29.5 };

fn seen_from(eye_m: [f64; 3], target_m: [f64; 3]) -> Viewpoint {
    Viewpoint { camera: CAMERA, size_px: (80, 60), pose: Pose::looking_at(eye_m, target_m) }
}

#[test]
fn the_table_is_as_far_as_geometry_says() {
    let world = generate(Family::Single, 3);
    let table = world.solids().iter().position(|solid| solid.kind() == "table").unwrap() as u16 + 1;
    let top_m = world.solids()[usize::from(table) - 1].pose().origin_m()[2] + 0.03;
    for height_m in [0.5, 1.0, 1.7] {
        let eye_m = [0.3, 0.2, top_m + height_m];
        let above = world.with_viewpoint(seen_from(eye_m, [0.3, 0.2, 0.0])).unwrap();
        assert_eq!((above.seed(), above.solids().len()), (world.seed(), world.solids().len()));
        let seen = render(&above, Sensor::Ideal).unwrap();
        assert_eq!(seen.frame.camera(), CAMERA);
        let on_table: Vec<f32> = (0..80 * 60)
            .filter(|&i| seen.truth.instance[i] == table)
            .map(|i| seen.frame.depth_m()[i])
            .filter(|z| f64::from(*z) < height_m + 0.01)
            .collect();
        assert!(on_table.len() > 100, "{}", on_table.len());
        assert!(on_table.iter().all(|&z| (f64::from(z) - height_m).abs() < 1e-6));
    }
}

/// Sensors have square pixels, in images of any proportions.
#[test]
fn an_image_of_another_size_has_the_pixels_of_the_same_camera() {
    let world = generate(Family::Single, 3);
    let camera = world.viewpoint().camera;
    for (size_px, times) in [((640, 480), 1.0), ((1280, 720), 2.0), ((320, 320), 0.5)] {
        let seen = world.at_size(size_px).unwrap();
        let Viewpoint { camera: c, size_px: (width, height), pose } = *seen.viewpoint();
        assert_eq!(((width, height), pose), (size_px, world.viewpoint().pose));
        assert_eq!((c.fx_px, c.fy_px), (times * camera.fx_px, times * camera.fy_px), "{size_px:?}");
        // The principal point keeps its place in the image.
        let place = [(c.cx_px + 0.5) / width as f64, (c.cy_px + 0.5) / height as f64];
        assert_eq!(place, [(camera.cx_px + 0.5) / 640.0, (camera.cy_px + 0.5) / 480.0], "{size_px:?}");
    }
}

#[test]
fn every_sensor_works_from_anywhere_or_says_that_it_sees_nothing() {
    let world = generate(Family::Clutter, 1);
    let eyes = [[0.0, 0.0, 2.5], [0.0, -0.2, 0.1], [1.9, 0.0, 1.0], [0.0, 0.0, 0.9], [0.0, 0.0, -0.05]];
    for eye_m in eyes {
        for target_m in [[0.0, 0.0, 0.75], eye_m, [0.0, -50.0, 1.0], [0.0, 0.0, 90.0]] {
            let world = world.with_viewpoint(seen_from(eye_m, target_m)).unwrap();
            for sensor in Sensor::ALL {
                match render(&world, sensor) {
                    Ok(seen) => assert_eq!(seen.frame.size(), (80, 60)),
                    Err(e) => assert!(
                        matches!(e, Error::Frame(objecthood::Error::NoValidDepth { .. })),
                        "{eye_m:?} {target_m:?} {sensor}: {e}"
                    ),
                }
            }
        }
    }
}

#[test]
fn what_is_no_viewpoint_is_refused() {
    let world = generate(Family::Single, 1);
    let good = *world.viewpoint();
    for (bad, said) in [
        (Viewpoint { size_px: (0, 480), ..good }, "0 x 480"),
        (Viewpoint { size_px: (usize::MAX, 2), ..good }, "x 2 pixels"),
        (Viewpoint { camera: Camera { fx_px: 0.0, ..CAMERA }, ..good }, "focal"),
        (Viewpoint { camera: Camera { cx_px: f64::NAN, ..CAMERA }, ..good }, "focal"),
        (Viewpoint { pose: Pose::at([f64::NAN, 0.0, 0.0]), ..good }, "within 1000 m"),
        (Viewpoint { pose: Pose::at([0.0, 1e12, 0.0]), ..good }, "within 1000 m"),
    ] {
        let message = world.with_viewpoint(bad).unwrap_err().to_string();
        assert!(message.contains(said), "{bad:?}: {message}");
    }
}
