//! A video as the files of a folder in the layout of the TUM RGB-D benchmark, with the truth beside them.

use std::fmt::Write;

use serde::Serialize;

use super::json::{PoseFile, camera_json, to_json};
use super::{color_png, depth_png};
use crate::error::{Error, Result};
use crate::render::Rendered;
use crate::sensor::Sensor;
use crate::solid::Role;
use crate::video::{Clip, Group, Motion, SupportKind, Video};
use crate::world::World;
use objecthood_io::label_image;

/// A path below the folder of a clip, and what is in that file.
type File = (String, Vec<u8>);

/// What the files of a frame are called: its time in seconds. `objecthood segment` calls it so too.
fn stem(video: &Video, frame: usize) -> String {
    format!("{:.6}", video.time_s(frame))
}

/// The images of a frame: `color/<stem>.png`, `depth/<stem>.png` and `truth/<stem>.png`, the instance that the ray through the
/// middle of each pixel meets first, agents among them, whether there is depth or not.
///
/// # Errors
/// [`Error::Png`], [`Error::Write`] when the image is larger than a PNG can be.
pub fn video_frame(video: &Video, frame: usize, rendered: &Rendered) -> Result<Vec<File>> {
    let stem = stem(video, frame);
    let truth = label_image::encode(&rendered.first_hit.instance)?;
    Ok(vec![
        (format!("color/{stem}.png"), color_png(&rendered.frame)?),
        (format!("depth/{stem}.png"), depth_png(&rendered.frame)?),
        (format!("truth/{stem}.png"), truth),
    ])
}

#[derive(Serialize)]
struct ClipFile<'a> {
    schema_version: u32,
    clip: Clip,
    seed: u64,
    fps: f64,
    frames: usize,
    sensor: Sensor,
    agents: &'a [u16],
    groups: &'a [Group],
    solids: Vec<SolidFile>,
}

#[derive(Serialize)]
struct SolidFile {
    instance: u16,
    kind: &'static str,
    role: Role,
    /// In the first frame.
    pose: PoseFile,
    bounds_m: [[f64; 3]; 2],
}

#[derive(Serialize)]
struct FrameLine {
    frame: usize,
    time: f64,
    camera_pose: PoseFile,
    solids: Vec<MotionFile>,
}

#[derive(Serialize)]
struct MotionFile {
    instance: u16,
    pose: PoseFile,
    center_m: [f64; 3],
    velocity_m_per_s: [f64; 3],
    spin_rad_per_s: [f64; 3],
    held_by: Option<u16>,
    airborne: bool,
    visible_fraction: f64,
}

#[derive(Serialize)]
struct SupportLine {
    frame: usize,
    child: u16,
    parent: u16,
    kind: SupportKind,
}

/// Everything of a clip but the images. World frame: z up, metres.
///
/// * `rgb.txt`, `depth.txt`, `groundtruth.txt` (pose of the camera), `camera.json`: as `objecthood` reads them.
/// * `clip.json`: what it was made from; `solids` with instance, kind, role, pose in the first frame and bounds; `agents`;
///   `groups` that count as one, and the frame from which on they do not.
/// * `truth.jsonl`, a line a frame: the pose of the camera, and of every object and agent pose, centre of mass, velocity,
///   who holds it, whether it flies and how much of it is seen.
/// * `events.jsonl`, a line an event, and `support.jsonl`, a line for each object in each frame in which something holds it.
///
/// # Errors
/// [`Error::Json`] never in practice.
pub fn video_lists(video: &Video, sensor: Sensor) -> Result<Vec<File>> {
    let first = video.world(0);
    let mut texts = vec![
        ("camera.json", camera_json(&first)?),
        ("clip.json", clip_json(video, sensor, &first)?),
        ("rgb.txt", image_list(video, "color")),
        ("depth.txt", image_list(video, "depth")),
        ("groundtruth.txt", camera_poses(video)),
        ("truth.jsonl", lines((0..video.frames()).map(|frame| frame_line(video, &first, frame)))?),
        ("events.jsonl", lines(&video.truth().events)?),
    ];
    let frames = video.truth().frames.iter().enumerate();
    let edges = frames.flat_map(|(frame, truth)| {
        truth.support.iter().map(move |edge| SupportLine {
            frame,
            child: edge.child,
            parent: edge.parent,
            kind: edge.kind,
        })
    });
    texts.push(("support.jsonl", lines(edges)?));
    Ok(texts.into_iter().map(|(name, text)| (name.to_owned(), text.into_bytes())).collect())
}

fn clip_json(video: &Video, sensor: Sensor, first: &World) -> Result<String> {
    let solid = |(k, solid): (usize, &crate::Solid)| SolidFile {
        instance: k as u16 + 1,
        kind: solid.kind(),
        role: solid.role(),
        pose: PoseFile::new(solid.pose()),
        bounds_m: solid.bounds_m(),
    };
    to_json(&ClipFile {
        schema_version: 1,
        clip: video.clip(),
        seed: video.seed(),
        fps: video.fps(),
        frames: video.frames(),
        sensor,
        agents: &video.truth().agents,
        groups: &video.truth().groups,
        solids: first.solids().iter().enumerate().map(solid).collect(),
    })
}

fn image_list(video: &Video, folder: &str) -> String {
    let mut list = "# time (s), file\n".to_owned();
    for frame in 0..video.frames() {
        let stem = stem(video, frame);
        // Writing to a string cannot fail.
        let _ = writeln!(list, "{stem} {folder}/{stem}.png");
    }
    list
}

fn camera_poses(video: &Video) -> String {
    let mut list =
        "# time (s), position x y z (m), rotation as quaternion x y z w: camera to world\n".to_owned();
    for frame in 0..video.frames() {
        let pose = video.world(frame).viewpoint().pose;
        let numbers: Vec<String> =
            pose.origin_m().into_iter().chain(pose.rotation_xyzw()).map(|x| format!("{x:.6}")).collect();
        let _ = writeln!(list, "{} {}", stem(video, frame), numbers.join(" "));
    }
    list
}

fn frame_line(video: &Video, first: &World, frame: usize) -> FrameLine {
    let moving = |&(k, _): &(usize, &Motion)| matches!(first.solids()[k].role(), Role::Object | Role::Agent);
    let motions = video.truth().frames[frame].motions.iter().enumerate();
    let solid = |(k, motion): (usize, &Motion)| MotionFile {
        instance: k as u16 + 1,
        pose: PoseFile::new(&motion.pose),
        center_m: motion.center_m,
        velocity_m_per_s: motion.velocity_m_per_s,
        spin_rad_per_s: motion.spin_rad_per_s,
        held_by: motion.held_by,
        airborne: motion.is_airborne,
        visible_fraction: motion.visible_fraction,
    };
    FrameLine {
        frame,
        time: video.time_s(frame),
        camera_pose: PoseFile::new(&video.world(frame).viewpoint().pose),
        solids: motions.filter(moving).map(solid).collect(),
    }
}

fn lines<T: Serialize>(values: impl IntoIterator<Item = T>) -> Result<String> {
    let mut text = String::new();
    for value in values {
        text += &serde_json::to_string(&value).map_err(|reason| Error::Json { reason })?;
        text.push('\n');
    }
    Ok(text)
}
