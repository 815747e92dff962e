//! What frames tell is handed on to the next frame.
#![allow(clippy::unwrap_used, reason = "what fails is reported so")]

mod common;

use common::two_boxes;
use objecthood::discovery::{Up, UpSource};
use objecthood::{Camera, Discovery, Estimates, Frame, Noise, Params, Pipeline, Raster, discover};

fn found(frame: &Frame) -> Discovery {
    discover(frame, &Params::default()).unwrap()
}

/// A frame in which one pixel in sixteen of a wall is measured: no block of pixels is, and gaps are too wide to be bridged.
fn sparse() -> Frame {
    let camera = Camera::new(262.5, 262.5, 159.5, 119.5).unwrap();
    let depth_m = (0..320 * 240).map(|i| if i % 4 == 0 && i / 320 % 4 == 0 { 1.1 } else { f32::NAN });
    Frame::new(Raster::from_vec(320, 240, depth_m.collect()).unwrap(), None, camera).unwrap()
}

#[test]
fn a_frame_without_measurable_blocks_has_the_noise_of_those_before_it() {
    let noise = Noise { white: 1.5, blocks_quanta: [0.4, 0.6, 0.5] };
    let estimates = Estimates::of_noise(noise, 4);
    assert_eq!(found(&sparse()).estimates.unwrap().frames, 0);
    let handed_on = found(&sparse().with_estimates(estimates)).estimates.unwrap();
    assert_eq!((handed_on.noise, handed_on.frames), (noise, 4));
}

#[test]
fn a_frame_without_a_ground_has_the_up_of_those_before_it() {
    let boxes = found(&two_boxes());
    let estimates = boxes.estimates.unwrap();
    assert_eq!((boxes.up.source, estimates.up), (UpSource::Plane, Some(boxes.up.direction)));
    let after = found(&sparse().with_estimates(estimates));
    assert_eq!(after.up, Up { direction: boxes.up.direction, source: UpSource::Earlier });
    assert!(after.notices.is_empty(), "{:?}", after.notices);
    assert_eq!(after.estimates.unwrap().up, estimates.up, "and it is handed on");
}

#[test]
fn the_same_frame_and_estimates_give_the_same_result_and_others_may_not() {
    let mut pipeline = Pipeline::default();
    let params = Params::default();
    let frame = two_boxes();
    let other = Estimates::of_noise(Noise { white: 1.0, blocks_quanta: [0.9, 0.9, 0.9] }, 9);
    let mut look = |frame: &Frame| format!("{:?}", pipeline.discover(frame, &params).unwrap());
    let alone = look(&frame);
    let first = look(&frame.clone().with_estimates(other));
    assert_ne!(alone, first, "a pipeline does not take one for the other");
    assert_eq!(look(&frame.clone().with_estimates(other)), first);
    assert_eq!(look(&frame.with_estimates(None)), alone);
}
