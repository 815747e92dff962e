//! Folders in the layout of the TUM RGB-D benchmark.
//!
//! `rgb.txt` and `depth.txt` list images with the times at which they were taken, a line each: seconds, blank, path
//! below the folder. `groundtruth.txt`, if it is there, lists poses of the camera in the same way: seconds, position (m),
//! quaternion (x, y, z, w). Lines that begin with `#` are comments.
//!
//! * The two cameras have clocks of their own, so a frame is a colour and a depth image taken at most 20 ms apart. Its
//!   stamp is that of the depth; its pose is the nearest one within 20 ms of that.
//! * The layout names no camera. Ours is a [`camera_file`] called `camera.json` in the folder. Depth has 5000 units a
//!   metre unless that file says otherwise.
//!
//! Source: Sturm et al., *A benchmark for the evaluation of RGB-D SLAM systems*, IROS 2012.

mod lists;

use std::path::Path;

use self::lists::{Timed, parse_images, parse_poses};
use super::{FolderFormat, Format};
use crate::associate::associate;
use crate::camera_file::{self, CameraFile};
use crate::capture::{Pose, Said};
use crate::error::{Error, Result};
use crate::given::Given;
use crate::images::{ImageFiles, frame_of};
use crate::source::{FrameRef, Notice, Source};

pub(super) const FORMAT: Format = Format::Folder(FolderFormat { is_mine: is_tum, open });

const COLOR_LIST: &str = "rgb.txt";
const DEPTH_LIST: &str = "depth.txt";
const POSE_LIST: &str = "groundtruth.txt";
const CAMERA: &str = "camera.json";

/// Units of depth that make a metre, by convention of the layout.
const DEPTH_SCALE: f64 = 5000.0;

/// What belongs together was taken at most this apart (ms): as in the benchmark's `associate.py`.
const MAX_APART_MS: i64 = 20;

fn is_tum(folder: &Path) -> bool {
    [COLOR_LIST, DEPTH_LIST].iter().all(|list| folder.join(list).is_file())
}

/// Lists the frames of a folder.
///
/// # Errors
/// * [`Error::At`] a list or the camera's file: it cannot be read, [`Error::BadListLine`], or what is wrong with it;
/// * [`Error::At`] the folder: [`Error::NoCameraFile`] when no camera is given either, [`Error::NoPairs`].
fn open(folder: &Path, given: &Given) -> Result<Source> {
    let camera_path = folder.join(CAMERA);
    let own = camera_path.is_file().then(|| camera_file::open(&camera_path)).transpose()?;
    let said = Said {
        camera: own.map(|file| file.camera),
        depth_scale: Some(own.and_then(|CameraFile { depth_scale, .. }| depth_scale).unwrap_or(DEPTH_SCALE)),
        ..Said::default()
    };
    if given.camera.or(said.camera).is_none() {
        return Err(Error::NoCameraFile { name: CAMERA }.at(folder));
    }
    let color = open_list(&folder.join(COLOR_LIST), parse_images)?;
    let depth = open_list(&folder.join(DEPTH_LIST), parse_images)?;
    let pairs = associate(&times_us(&color), &times_us(&depth), 1000 * MAX_APART_MS);
    let (color_alone, depth_alone) = (color.len() - pairs.len(), depth.len() - pairs.len());
    if pairs.is_empty() {
        let alone = Error::NoPairs { color: color_alone, depth: depth_alone, max_apart_ms: MAX_APART_MS };
        return Err(alone.at(folder));
    }

    let mut notices = Vec::new();
    if color_alone + depth_alone > 0 {
        notices.push(Notice::WithoutPartner {
            folder: folder.to_owned(),
            frames: pairs.len(),
            color: color_alone,
            depth: depth_alone,
            max_apart_ms: MAX_APART_MS,
        });
    }
    // Frames are of use without poses too, and other data sets have files of this name with other columns.
    let pose_path = folder.join(POSE_LIST);
    let poses = if pose_path.is_file() { open_list(&pose_path, parse_poses) } else { Ok(Vec::new()) };
    let poses = poses.unwrap_or_else(|error| {
        notices.push(Notice::NoPoses(error));
        Vec::new()
    });

    let frame = |(c, d): (usize, usize)| {
        let (color, depth): (&Timed<_>, &Timed<_>) = (&color[c], &depth[d]);
        let files = ImageFiles::new(Some(folder.join(&color.what)), folder.join(&depth.what));
        let pose = pose_at(&poses, depth.time_us);
        FrameRef { stamp_ns: Some(1000 * depth.time_us), pose, ..frame_of(files, given, said) }
    };
    let frames = pairs.into_iter().map(frame).collect();
    Ok(Source::listed(frames).with_shared_files(vec![camera_path]).with_notices(notices))
}

fn open_list<T>(path: &Path, parse: impl Fn(&[u8]) -> Result<Vec<Timed<T>>>) -> Result<Vec<Timed<T>>> {
    let bytes = std::fs::read(path).map_err(|reason| Error::Read { reason });
    bytes.and_then(|bytes| parse(&bytes)).map_err(|error| error.at(path))
}

fn times_us<T>(entries: &[Timed<T>]) -> Vec<i64> {
    entries.iter().map(|entry| entry.time_us).collect()
}

/// The pose nearest in time, of two equally near the earlier one, if it is near enough. `poses` ascend. O(log n).
fn pose_at(poses: &[Timed<Pose>], time_us: i64) -> Option<Pose> {
    let after = poses.partition_point(|pose| pose.time_us < time_us);
    let neighbours = &poses[after.saturating_sub(1)..poses.len().min(after + 1)];
    let nearest = neighbours.iter().min_by_key(|pose| pose.time_us.abs_diff(time_us))?;
    (nearest.time_us.abs_diff(time_us) <= 1000 * MAX_APART_MS as u64).then_some(nearest.what)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_has_the_nearest_pose() {
        let pose = |x| Pose { position_m: [x, 0.0, 0.0], rotation_xyzw: [0.0, 0.0, 0.0, 1.0] };
        let poses = [0_i64, 10_000, 50_000].map(|time_us| Timed { time_us, what: pose(time_us as f64) });
        for (time_us, found) in [
            (-20_001, None),
            (-20_000, Some(0.0)),
            (4_999, Some(0.0)),
            (5_000, Some(0.0)),
            (5_001, Some(10_000.0)),
            (10_000, Some(10_000.0)),
            (30_000, Some(10_000.0)),
            (30_001, Some(50_000.0)),
            (70_000, Some(50_000.0)),
            (70_001, None),
        ] {
            assert_eq!(pose_at(&poses, time_us), found.map(pose), "{time_us}");
        }
        assert_eq!(pose_at(&[], 0), None);
    }
}
