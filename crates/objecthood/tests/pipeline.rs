//! A pipeline that is used again: nothing of it is seen in what is found, and nothing is asked of the system.

mod common;

use std::alloc::System;
use std::sync::Mutex;

use common::{cut_box, stack, two_boxes};
use objecthood::{Camera, Frame, Method, Observer, Output, Params, Pipeline, Raster, discover};
use rayon::ThreadPoolBuilder;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// The allocator counts what all threads ask for, so that one test runs after the other.
static ALONE: Mutex<()> = Mutex::new(());

/// A frame of another size.
fn wall() -> objecthood::Result<Frame> {
    Frame::new(Raster::filled(90, 70, 1.1)?, None, Camera::new(80.0, 80.0, 44.5, 34.5)?)
}

#[test]
fn what_was_looked_at_before_is_not_seen() {
    let _alone = ALONE.lock();
    let mut pipeline = Pipeline::default();
    let wall = wall().unwrap();
    let frames = [two_boxes(), wall.clone(), stack(), wall, cut_box(), two_boxes()];
    for (k, frame) in frames.iter().enumerate() {
        for method in [Method::Context, Method::Paper] {
            let params = Params { method, ..Params::default() };
            let again = pipeline.discover(frame, &params).unwrap();
            let fresh = discover(frame, &params).unwrap();
            assert_eq!(format!("{again:?}"), format!("{fresh:?}"), "frame {k}, {method}");
        }
    }
}

/// How many times memory was asked for until the first stage was done.
struct ToNormals<'a> {
    region: Region<'a, System>,
    asked: usize,
}

impl Observer for ToNormals<'_> {
    fn observe(&mut self, output: Output<'_>) {
        if let Output::Normals(_) = output {
            let change = self.region.change();
            self.asked = change.allocations + change.reallocations;
        }
    }
}

#[test]
fn a_frame_that_was_forgotten_is_looked_at_anew() {
    let _alone = ALONE.lock();
    let pool = ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let (frame, params) = (two_boxes(), Params::default());
    let mut pipeline = Pipeline::default();
    let mut look = |forgets: bool| {
        if forgets {
            pipeline.forget();
        }
        let mut to_normals = ToNormals { region: Region::new(ALLOCATOR), asked: 0 };
        let found =
            pool.install(|| pipeline.discover_observed(&frame, &params, &mut to_normals).unwrap().clone());
        (format!("{found:?}"), to_normals.asked)
    };
    let [first, kept, anew] = [false, false, true].map(&mut look);
    assert!(first.0 == kept.0 && first.0 == anew.0, "the same is found");
    assert!(
        kept.1 < anew.1 && anew.1 < first.1,
        "anew, but in the same memory: {} {} {}",
        first.1,
        kept.1,
        anew.1
    );
}

#[test]
fn what_looks_at_every_pixel_asks_for_no_memory_once_its_images_are_there() {
    let _alone = ALONE.lock();
    let pool = ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let (frames, params) = ([two_boxes(), stack(), cut_box(), two_boxes()], Params::default());
    let mut pipeline = Pipeline::default();
    let asked = frames.each_ref().map(|frame| {
        pool.install(|| {
            let mut to_normals = ToNormals { region: Region::new(ALLOCATOR), asked: 0 };
            pipeline.discover_observed(frame, &params, &mut to_normals).unwrap();
            to_normals.asked
        })
    });
    assert!(asked[0] > 4, "the first frame asks for its images: {asked:?}");
    // The second still asks for room to note the images that the first gave back; every one for the handle of its output.
    assert_eq!(asked[2..], [1; 2], "{asked:?}");
}
