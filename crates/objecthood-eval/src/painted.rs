//! Scenes whose truth is an image of labels.

use std::path::Path;

use objecthood::{Frame, Raster};
use objecthood_io::images::{ImageFiles, source_of};
use objecthood_io::{Given, GridCamera, label_image, open_frame};

use crate::dataset::Scene;
use crate::error::{Error, Result};
use crate::mosd::{CAMERA, ROLES};
use crate::truth::Truth;

/// Depth images of these data sets are in millimetres.
const DEPTH_SCALE: f64 = 1000.0;

/// Reads the frame from a cloud, or with `color` from images, and its truth.
pub(crate) fn load(
    depth: &Path,
    color: Option<&Path>,
    truth: &Path,
    background: u16,
    camera: Option<&GridCamera>,
) -> Result<Scene> {
    let frame = match color {
        None => open_frame(depth, &Given { camera: camera.copied(), ..Given::default() })?.frame,
        Some(color) => {
            let camera = Some(camera.copied().unwrap_or(CAMERA));
            let given = Given { camera, depth_scale: Some(DEPTH_SCALE), ..Given::default() };
            let files = ImageFiles::new(Some(color.to_owned()), depth.to_owned());
            let mut captures = source_of(vec![files], &given).captures();
            captures.next().unwrap_or(Err(objecthood_io::Error::NoFrames))?.frame
        }
    };
    let read = || {
        label_image::decode_indices(
            &std::fs::read(truth).map_err(|reason| objecthood_io::Error::Read { reason })?,
        )
    };
    let labels = read().map_err(|error| error.at(truth))?;
    let object = |label: u16| label.checked_sub(background).filter(|&object| object > 0);
    let truth = truth_of(&frame, truth, &labels.map(|&label| object(label).map_or(0, u32::from)))?;
    Ok(Scene { frame, truth })
}

/// The truth of a frame from numbers of objects, 0 = none. Pixels without depth do not count, as in mOSD.
///
/// # Errors
/// [`Error::TruthSize`] when the size is another.
pub(crate) fn truth_of(frame: &Frame, path: &Path, objects: &Raster<u32>) -> Result<Truth> {
    if objects.size() != frame.size() {
        let path = path.to_owned();
        return Err(Error::TruthSize { path, truth: objects.size(), frame: frame.size() });
    }
    let mut numbers: Vec<u32> = objects.as_slice().iter().copied().filter(|&number| number > 0).collect();
    numbers.sort_unstable();
    numbers.dedup();
    let label = |(&number, &z): (&u32, &f32)| match number {
        _ if z.is_nan() => 0,
        0 => 1,
        _ => 2 + numbers.partition_point(|&other| other < number) as u32,
    };
    let labels = objects.as_slice().iter().zip(frame.depth_m().as_slice()).map(label).collect();
    let (width, height) = frame.size();
    let labels = Raster::from_vec(width, height, labels).map_err(objecthood_io::Error::from)?;
    Truth::new(labels.clone(), labels, ROLES)
}
