//! Reading a recording takes no more memory the longer it is. Alone in its program, because the counter counts all threads.
#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

use std::path::Path;

use objecthood::{Camera, Frame, Raster};
use objecthood_io::output::mcap::{McapFile, frame_messages};
use objecthood_io::{Capture, Given, Source};
use peak_alloc::PeakAlloc;

#[global_allocator]
static PEAK: PeakAlloc = PeakAlloc;

const SIZE: (usize, usize) = (160, 120);
const LONG: usize = 600;
/// What the list of frames and the index of chunks may take a frame (bytes); a frame's depth and colour take 130 kB.
const LIST_BYTES: usize = 2000;

fn pixels<T>(value: impl Fn(usize, usize) -> T) -> Raster<T> {
    let (width, height) = SIZE;
    Raster::from_vec(width, height, (0..width * height).map(|i| value(i % width, i / width)).collect())
        .unwrap()
}

/// A recording of [`LONG`] frames of a surface that moves away.
fn recording(path: &Path) {
    let mut file = McapFile::create(path).unwrap();
    for k in 0..LONG {
        let depth_m = pixels(|u, v| (1000 + k + u + v) as f32 / 1000.0);
        let color = pixels(|u, v| [u as u8, v as u8, k as u8]);
        let camera = Camera { fx_px: 130.0, fy_px: 130.0, cx_px: 79.5, cy_px: 59.5 };
        let capture = Capture::new(Frame::new(depth_m, Some(color), camera).unwrap());
        file.add(&frame_messages(k as i64 * 33_000_000, &capture)).unwrap();
    }
    file.finish().unwrap();
}

/// Bytes that reading the first `frames` takes at most at any time.
fn peak_bytes(path: &Path, frames: usize) -> usize {
    PEAK.reset_peak_usage();
    let before = PEAK.current_usage();
    let source = Source::open(path, &Given::default()).unwrap();
    let read = source.captures().take(frames).filter(|capture| capture.is_ok()).count();
    assert_eq!(read, frames);
    PEAK.peak_usage() - before
}

#[test]
fn memory_does_not_grow_with_the_frames_that_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.mcap");
    recording(&path);
    let length = std::fs::metadata(&path).unwrap().len() as usize;
    let [few, many] = [20, LONG].map(|frames| peak_bytes(&path, frames));
    assert!(many < few + LIST_BYTES * LONG, "{few} bytes for 20 frames, {many} for {LONG}");
    assert!(many < length / 4, "{many} of the {length} bytes of the file");
}
