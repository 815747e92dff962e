//! Nothing is doubted about frames of any kind that are as they should be.

#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

use objecthood::plausibility::find_doubts;
use objecthood_scene::{Family, Sensor, generate, render};

#[test]
fn nothing_is_doubted_about_synthetic_frames() {
    for family in Family::ALL {
        let world = generate(family, 31).at_size((320, 240)).unwrap();
        for sensor in Sensor::ALL {
            let frame = render(&world, sensor).unwrap().frame;
            assert_eq!(find_doubts(&frame), [], "{} {}", family.name(), sensor.name());
        }
    }
}
