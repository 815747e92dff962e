//! The depth camera of a recording and its colour camera: what is known of them, and how their images come together.
//!
//! Lens distortion is undone for both. Colour that is not registered is looked up for each pixel of the depth: the point of the pixel is
//! moved into the colour camera and projected by its lens. So depth stays as it was measured, without the holes and the noise of
//! a resampled image, and every pixel with depth has the colour that the other camera sees in its direction.

use std::sync::OnceLock;

use glam::DVec3;
use objecthood::{Camera, Frame, Raster};

use super::lens::{Lens, nearest};
use super::messages::{CameraInfo, transform, transforms};
use super::rigid::Rigid;
use super::topics::{Recording, View, is_registered};
use super::tree::Tree;
use crate::capture::{Pose, Said};
use crate::error::Result;
use crate::given::Given;
use crate::images::ImageError;
use crate::organize::GridCamera;

/// The cameras of a recording.
pub(super) struct Rig {
    depth: Lens,
    /// Pixels of the depth image as it was taken, for an image of a size.
    straight: OnceLock<Straight>,
    coloring: Coloring,
    /// Where the depth camera is in a world whose z axis points up.
    pub(super) pose: Option<Pose>,
    /// What the recording itself says.
    pub(super) said: Said,
}

/// The size of an image, and for each of its pixels without distortion the one that was taken.
type Straight = ((usize, usize), Vec<Option<u32>>);

/// How colours come to pixels of the depth.
enum Coloring {
    /// They stand at the same pixel.
    Registered,
    /// Another camera saw them.
    Seen {
        lens: Lens,
        color_from_depth: Rigid,
    },
    None,
}

/// An image of the recording, and its size as far as it is known.
pub(super) struct Seen<'a> {
    pub(super) view: &'a View,
    pub(super) size: Option<(usize, usize)>,
}

impl Rig {
    /// What is known of the cameras; with it why colour cannot be used, if it cannot.
    ///
    /// # Errors
    /// [`ImageError::NoCamera`] when nobody says which camera saw the depth.
    pub(super) fn of(
        recording: &Recording,
        depth: &Seen<'_>,
        color: Option<&Seen<'_>>,
        given: &Given,
    ) -> Result<(Self, Option<String>)> {
        let cameras = Cameras::of(recording);
        let own = cameras.lens(recording, depth);
        let of_color = color.map_or(Ok(None), |color| cameras.lens(recording, color));
        let is_registered = is_registered(depth.view.topic(recording));
        let said = match (&own, &of_color) {
            (Ok(Some(lens)), _) => Some(lens.clone()),
            // What is registered to colour is seen by its camera.
            (Ok(None), Ok(Some(lens))) if is_registered => Some(lens.clone()),
            _ => None,
        };
        let lens = given.camera.map(Lens::given).or_else(|| said.clone()).ok_or(ImageError::NoCamera)?;
        let (coloring, problem) = match color {
            None => (Coloring::None, None),
            Some(color) => match cameras.coloring(
                recording,
                depth,
                color,
                &lens,
                own.is_ok_and(|own| own.is_some()),
                of_color,
            ) {
                Ok(coloring) => (coloring, None),
                Err(problem) => (Coloring::None, Some(problem)),
            },
        };
        let pose = cameras.tree.upright(&depth.view.header.frame_id);
        let said = Said {
            distortion_px: said.as_ref().and_then(|lens| lens.distortion_px(depth.size.or(lens.size)?)),
            camera: said.map(|lens| GridCamera { camera: lens.camera, size: lens.size }),
            depth_scale: None,
        };
        Ok((Self { depth: lens, straight: OnceLock::new(), coloring, pose, said }, problem))
    }

    pub(super) fn has_color(&self) -> bool {
        !matches!(self.coloring, Coloring::None)
    }

    /// The frame of a depth and a colour image.
    ///
    /// # Errors
    /// [`ImageError::CameraSize`], [`Error::Frame`](crate::Error::Frame).
    pub(super) fn frame(&self, depth_m: Raster<f32>, color: Option<Raster<[u8; 3]>>) -> Result<Frame> {
        let size = depth_m.size();
        if let Some(given) = self.depth.size.filter(|&given| given != size) {
            return Err(ImageError::CameraSize { given, image: size }.into());
        }
        let depth_m = self.straightened(depth_m, f32::NAN)?;
        let color = match (&self.coloring, color) {
            (Coloring::Registered, Some(color)) if color.size() == size => {
                Some(self.straightened(color, [0; 3])?)
            }
            (Coloring::Registered, color) => color,
            (Coloring::Seen { lens, color_from_depth }, Some(color)) => {
                Some(seen_colors(&depth_m, self.depth.camera, &color, lens, *color_from_depth)?)
            }
            (Coloring::Seen { .. }, None) | (Coloring::None, _) => None,
        };
        Ok(Frame::new(depth_m, color, self.depth.camera)?)
    }

    /// An image without the distortion of the depth camera's lens; what that did not see is `nothing`.
    fn straightened<T: Copy>(&self, image: Raster<T>, nothing: T) -> Result<Raster<T>> {
        if self.depth.is_straight() {
            return Ok(image);
        }
        let size = image.size();
        let (of, from) = self.straight.get_or_init(|| (size, self.depth.straightened(size)));
        let other = (*of != size).then(|| self.depth.straightened(size));
        let from = other.as_ref().unwrap_or(from);
        let pixels = from.iter().map(|from| from.map_or(nothing, |from| image[from as usize]));
        Ok(Raster::from_vec(size.0, size.1, pixels.collect())?)
    }
}

/// For every pixel the colour that another camera sees at its point; black where there is no depth, and where that camera does not look.
fn seen_colors(
    depth_m: &Raster<f32>,
    camera: Camera,
    color: &Raster<[u8; 3]>,
    lens: &Lens,
    color_from_depth: Rigid,
) -> Result<Raster<[u8; 3]>> {
    let (width, height) = depth_m.size();
    if let Some(given) = lens.size.filter(|&given| given != color.size()) {
        return Err(ImageError::CameraSize { given, image: color.size() }.into());
    }
    let of = |(i, &z_m): (usize, &f32)| {
        if !z_m.is_finite() || z_m <= 0.0 {
            return [0; 3];
        }
        let point = camera.back_project(i % width, i / width, z_m).map(f64::from);
        let at = lens.project(color_from_depth.apply(DVec3::from(point)));
        at.and_then(|at| nearest(at, color.size())).map_or([0; 3], |pixel| color[pixel])
    };
    let colors = depth_m.as_slice().iter().enumerate().map(of).collect();
    Ok(Raster::from_vec(width, height, colors)?)
}

/// What the messages of a recording say of its cameras.
struct Cameras {
    /// With their topics.
    infos: Vec<(String, CameraInfo)>,
    tree: Tree,
}

impl Cameras {
    fn of(recording: &Recording) -> Self {
        let infos = recording.of_kind("sensor_msgs/CameraInfo").filter_map(|stream| {
            let info = CameraInfo::read(&recording.first(stream)?, stream.wire).ok()?;
            Some((stream.topic.clone(), info))
        });
        let mut tree = Tree::default();
        for stream in recording.of_kind("tf2_msgs/TFMessage") {
            for &message in &stream.messages {
                let read =
                    recording.read(message).ok().and_then(|bytes| transforms(&bytes, stream.wire).ok());
                read.into_iter().flatten().for_each(|transform| tree.add(&transform));
            }
        }
        Self { infos: infos.collect(), tree }
    }

    /// The camera of an image: of the `camera_info` beside it, or of the same frame of reference, or of the nearest name. Sizes
    /// must agree.
    ///
    /// # Errors
    /// The name of a lens model that is not known.
    fn lens(&self, recording: &Recording, seen: &Seen<'_>) -> Result<Option<Lens>, String> {
        let topic = seen.view.topic(recording);
        let fits = |info: &CameraInfo| seen.size.is_none_or(|size| info.size == size || info.size == (0, 0));
        let is_of_device = topic.starts_with("/device_");
        let best = self.infos.iter().max_by_key(|(name, info)| {
            let is_beside = name.strip_suffix("camera_info").is_some_and(|folder| topic.starts_with(folder));
            // RealSense numbers its frames of reference, and depth and colour have the same number.
            let has_frame = !is_of_device && info.header.frame_id == seen.view.header.frame_id;
            (is_beside, fits(info), has_frame, shared_parts(name, topic), std::cmp::Reverse(name))
        });
        let Some((name, info)) = best.filter(|(name, info)| fits(info) || same_folder(name, topic)) else {
            return Ok(None);
        };
        let is_own = same_folder(name, topic) || shared_parts(name, topic) > 1;
        let has_frame = info.header.frame_id == seen.view.header.frame_id;
        if !is_own && !has_frame {
            return Ok(None);
        }
        let is_rectified = topic.split('/').any(|part| part.contains("rect"));
        Lens::of(info, is_rectified)
    }

    /// How the colours of an image come to pixels of the depth.
    ///
    /// # Errors
    /// Why they cannot.
    fn coloring(
        &self,
        recording: &Recording,
        depth: &Seen<'_>,
        color: &Seen<'_>,
        lens: &Lens,
        has_own: bool,
        of_color: Result<Option<Lens>, String>,
    ) -> Result<Coloring, String> {
        let (topic, other) = (depth.view.topic(recording), color.view.topic(recording));
        let (from, to) = (&depth.view.header.frame_id, &color.view.header.frame_id);
        let is_of_device = topic.starts_with("/device_");
        let have_one_size = depth.size.is_none() || color.size.is_none() || depth.size == color.size;
        let is_one_frame = is_registered(topic) || !is_of_device && !from.is_empty() && from == to;
        if is_one_frame && have_one_size {
            return Ok(Coloring::Registered);
        }
        let shift = match (is_one_frame, is_of_device) {
            (true, _) => Some(Rigid::IDENTITY),
            (false, true) => of_device(recording, topic, other).or_else(|| self.tree.between(to, from)),
            (false, false) => self.tree.between(to, from),
        };
        let of_color =
            of_color.map_err(|model| format!("the lens of its camera is of the unknown model `{model}`"))?;
        let have_one_camera = of_color.as_ref().is_none_or(|of_color| of_color.camera == lens.camera);
        match (shift, of_color) {
            (Some(shift), _) if shift.is_none() && have_one_camera && have_one_size => Ok(Coloring::Registered),
            (Some(color_from_depth), Some(lens)) => Ok(Coloring::Seen { lens, color_from_depth }),
            // Programs that register depth keep the frame's old name, but not its camera.
            (None, of_color) if have_one_size && (of_color.is_none() || !has_own || have_one_camera) => {
                Ok(Coloring::Registered)
            }
            (Some(_), None) => Err("which camera saw it is not known".to_owned()),
            (None, _) => Err("it is not registered to the depth, and no tf_static says where the one camera is to the other".to_owned()),
        }
    }
}

/// Whether a `camera_info` stands beside an image.
fn same_folder(info: &str, topic: &str) -> bool {
    info.strip_suffix("camera_info").is_some_and(|folder| topic.starts_with(folder))
}

/// The first parts that two topics have in common.
fn shared_parts(one: &str, other: &str) -> usize {
    one.split('/').zip(other.split('/')).take_while(|(a, b)| a == b).count()
}

/// Where RealSense says that its depth camera is to its colour camera: the places of both in a common frame of reference.
fn of_device(recording: &Recording, depth: &str, color: &str) -> Option<Rigid> {
    let place = |topic: &str| {
        let (stream, _) = topic.split_once("/image/")?;
        let mut transforms = recording.of_kind("geometry_msgs/Transform");
        let stream = transforms
            .find(|tf| tf.topic.strip_prefix(stream).is_some_and(|rest| rest.starts_with("/tf/")))?;
        transform(&recording.first(stream)?, stream.wire).ok()
    };
    Some(place(color)?.after(place(depth)?.inverse()))
}
