//! Every format of frames, damaged in every way: cut at 100 places, 1000 bytes or lengths changed, small files that unpack to much. What comes out is
//! an error of one line or whole frames, and never more than 256 MB. Alone in its program, because the counter counts all threads.
//! The recordings of the RealSense library lie in the data folder; they are large, so that fewer of their bytes are changed.
//!
//! Files of cameras and lists of folders, which are text, are in `hostile.rs`.
//!
//! Files of other programs need a Python in `OBJECTHOOD_PYTHON`, with the packages of `xtask/requirements.txt`; without it, it says that it
//! skips them.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "what fails or is skipped is reported so")]

mod common;

use std::path::Path;

use common::written::{Damage, written};
use common::{ENCODINGS, data_folder, small_binary_ply, small_file, small_ply};
use objecthood_io::images::decode_images;
use objecthood_io::{Capture, Given, Result, Source};
use peak_alloc::PeakAlloc;

#[global_allocator]
static PEAK: PeakAlloc = PeakAlloc;

/// The most that a file may take: the frames here are small.
const MOST_BYTES: usize = 256 << 20;
/// The longest message, with the names of some topics.
const MOST_LETTERS: usize = 700;
/// Bytes or lengths changed in a small file.
const PLACES: usize = 1000;
/// The same in a recording of eight VGA frames, of which each reading takes some hundredths of a second.
const PLACES_OF_LARGE: usize = 200;

/// How a file is read.
#[derive(Clone, Copy, Debug)]
enum How {
    /// As a frame.
    Frame,
    /// As a depth image.
    Depth,
    /// As the colour image of a depth image.
    Color,
    /// As a recording, which is read from the disk.
    Recording,
}

/// Units of a metre in files of whole millimetres; the others are in metres.
const MILLIMETRES: Option<f64> = Some(1000.0);

/// The files of `files.py` and `bombs.py`, one of each format and of each way in which it packs.
const FILES: [(How, Option<f64>, &[&str]); 6] = [
    (
        How::Frame,
        None,
        &["text.ply", "little.ply", "big.ply", "organized.ply", "colored.npy", "points.npz", "stored.npz"],
    ),
    (How::Frame, MILLIMETRES, &["compressed.npz"]),
    (How::Depth, None, &["metres.npy", "zip.exr", "piz.exr", "rle.exr", "none.exr", "strips.tif"]),
    (How::Depth, MILLIMETRES, &["depth.npy", "depth.png", "depth.tif", "packed.tif", "tiles.tif"]),
    (How::Color, MILLIMETRES, &["color.png", "color.jpg", "color.tif"]),
    (
        How::Recording,
        None,
        &[
            "unchunked.mcap",
            "lz4.mcap",
            "zstd.mcap",
            "plain.bag",
            "bz2.bag",
            "lz4.bag",
            "raw_db3/raw_db3.db3",
            "compressed_mcap/compressed_mcap.mcap",
            "points_mcap/points_mcap.mcap",
            "rvl.mcap",
            "bent.mcap",
        ],
    ),
];

/// Small files that unpack to much.
const BOMBS: [(How, &[&str]); 3] = [
    (How::Frame, &["bomb.npz", "points-bomb.npz"]),
    (How::Depth, &["bomb.exr", "bomb.png", "bomb.tif"]),
    (
        How::Recording,
        &[
            "bomb-zstd.mcap",
            "bomb-lz4.mcap",
            "bomb-bz2.bag",
            "bomb-lz4.bag",
            "large-zstd.mcap",
            "large-lz4.bag",
        ],
    ),
];

/// Reads files, the damaged recordings from a place of its own.
struct Reader<'a> {
    known: Given,
    /// A depth image, for colour to lie on.
    depth: Vec<u8>,
    place: &'a Path,
}

impl Reader<'_> {
    /// What reading says, and how many bytes it takes at most.
    fn read(&self, how: How, bytes: &[u8]) -> (Vec<String>, usize) {
        let said = |capture: Result<Capture>| capture.err().map(|error| error.to_string());
        if let How::Recording = how {
            std::fs::write(self.place, bytes).unwrap();
        }
        PEAK.reset_peak_usage();
        let before = PEAK.current_usage();
        let messages: Vec<String> = match how {
            How::Frame => said(objecthood_io::decode(bytes, &self.known)).into_iter().collect(),
            How::Depth => said(decode_images(None, bytes, &self.known)).into_iter().collect(),
            How::Color => said(decode_images(Some(bytes), &self.depth, &self.known)).into_iter().collect(),
            How::Recording => match Source::open(self.place, &Given::default()) {
                Ok(source) => source.captures().filter_map(said).collect(),
                Err(error) => vec![error.to_string()],
            },
        };
        (messages, PEAK.peak_usage() - before)
    }

    fn assert_survives(&self, how: How, name: &str, good: &[u8], places: usize) {
        let (messages, _) = self.read(how, good);
        assert!(messages.is_empty(), "{name}: {messages:?}");
        Damage { places, seed: 7 }.of(good, |bytes, what| {
            let (messages, peak) = self.read(how, bytes);
            assert!(peak <= MOST_BYTES, "{name} {what}: {peak} bytes");
            for message in messages {
                let is_line = !message.contains('\n') && message.len() < MOST_LETTERS;
                assert!(is_line, "{name} {what}: {message}");
            }
        });
    }
}

#[test]
fn damaged_files_are_told_and_take_no_memory() {
    let elsewhere = tempfile::tempdir().unwrap();
    let place = elsewhere.path().join("damaged");
    let mut reader = Reader { known: Given::default(), depth: Vec::new(), place: &place };
    for encoding in ENCODINGS {
        reader.assert_survives(How::Frame, &format!("{encoding:?}.pcd"), &small_file(encoding), PLACES);
    }
    reader.assert_survives(How::Frame, "small.ply", &small_ply(), PLACES);
    reader.assert_survives(How::Frame, "binary.ply", &small_binary_ply(), PLACES);
    if let Some(data) = data_folder() {
        for name in ["realsense-softdevice.bag", "realsense-softdevice.db3"] {
            let good = std::fs::read(data.join("containers").join(name)).unwrap();
            reader.assert_survives(How::Recording, name, &good, PLACES_OF_LARGE);
        }
    }

    let Some((files, recordings)) = written("files.py").zip(written("bombs.py")) else { return };
    let content = |how: How, name: &str| {
        let folder = if let How::Recording = how { &recordings } else { &files };
        std::fs::read(folder.path().join(name)).unwrap()
    };
    reader.known = Given { camera: Some("80,80,39.5,29.5,80,60".parse().unwrap()), ..Given::default() };
    reader.depth = content(How::Depth, "depth.png");
    for (how, depth_scale, names) in FILES {
        reader.known.depth_scale = depth_scale;
        names.iter().for_each(|name| reader.assert_survives(how, name, &content(how, name), PLACES));
    }
    for (how, names) in BOMBS {
        for name in names {
            let (messages, peak) = reader.read(how, &content(how, name));
            assert!(!messages.is_empty(), "{name} is read");
            assert!(peak <= MOST_BYTES, "{name}: {peak} bytes, {messages:?}");
        }
    }
}
