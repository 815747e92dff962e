//! The messages of ROS that frames are made of. Their fields stand in the order of `sensor_msgs`, `geometry_msgs` and
//! `tf2_msgs`, which is the same in ROS 1 and 2.

use super::fields::{Fields, Problem, Wire};
use super::rigid::Rigid;

/// When and where something was measured.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    /// Nanoseconds since 1970; 0 where nobody said.
    pub(super) stamp_ns: i64,
    pub(super) frame_id: Vec<u8>,
}

impl Header {
    pub(super) fn read(fields: &mut Fields<'_>, wire: Wire) -> Result<Self, Problem> {
        if wire == Wire::Ros1 {
            fields.u32()?;
        }
        let (seconds, nanoseconds) = (fields.u32()?, fields.u32()?);
        let stamp_ns = i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds);
        Ok(Self { stamp_ns, frame_id: fields.text()?.to_vec() })
    }
}

/// `sensor_msgs/Image`.
pub(super) struct Image<'a> {
    pub(super) header: Header,
    /// Columns and rows.
    pub(super) size: (usize, usize),
    pub(super) encoding: &'a [u8],
    pub(super) is_big_endian: bool,
    /// Bytes of a row.
    pub(super) step: usize,
    pub(super) data: &'a [u8],
}

impl<'a> Image<'a> {
    pub(super) fn read(message: &'a [u8], wire: Wire) -> Result<Self, Problem> {
        let fields = &mut Fields::of(message, wire)?;
        let header = Header::read(fields, wire)?;
        let (height, width) = (fields.length()?, fields.length()?);
        let encoding = fields.text()?;
        let is_big_endian = fields.u8()? != 0;
        let step = fields.length()?;
        Ok(Self { header, size: (width, height), encoding, is_big_endian, step, data: fields.bytes()? })
    }
}

/// `sensor_msgs/CompressedImage`.
pub(super) struct CompressedImage<'a> {
    pub(super) header: Header,
    /// What `image_transport` calls it: `16UC1; compressedDepth png`.
    pub(super) format: &'a [u8],
    pub(super) data: &'a [u8],
}

impl<'a> CompressedImage<'a> {
    pub(super) fn read(message: &'a [u8], wire: Wire) -> Result<Self, Problem> {
        let fields = &mut Fields::of(message, wire)?;
        let header = Header::read(fields, wire)?;
        Ok(Self { header, format: fields.text()?, data: fields.bytes()? })
    }
}

/// `sensor_msgs/CameraInfo`, as far as it is used.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CameraInfo {
    pub(super) header: Header,
    /// Columns and rows; 0 where nobody said.
    pub(super) size: (usize, usize),
    pub(super) distortion_model: Vec<u8>,
    pub(super) d: Vec<f64>,
    /// Of the image as it was taken, row by row.
    pub(super) k: [f64; 9],
    /// Of the rectified image, row by row.
    pub(super) p: [f64; 12],
    /// Pixels that were joined to one, in x and y; 0 as 1.
    pub(super) binning: (u32, u32),
    /// First column and row of the part of the sensor that was read.
    pub(super) offset: (u32, u32),
}

impl CameraInfo {
    pub(super) fn read(message: &[u8], wire: Wire) -> Result<Self, Problem> {
        let fields = &mut Fields::of(message, wire)?;
        let header = Header::read(fields, wire)?;
        let (height, width) = (fields.length()?, fields.length()?);
        let distortion_model = fields.text()?.to_vec();
        let d = (0..fields.length()?).map(|_| fields.f64()).collect::<Result<_, _>>()?;
        let k = fields.f64s()?;
        fields.f64s::<9>()?;
        let p = fields.f64s()?;
        let (binning, offset) = ((fields.u32()?, fields.u32()?), (fields.u32()?, fields.u32()?));
        Ok(Self { header, size: (width, height), distortion_model, d, k, p, binning, offset })
    }
}

/// Where a frame lies in another: one of the list of `tf2_msgs/TFMessage`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Transform {
    pub(super) parent: Vec<u8>,
    pub(super) child: Vec<u8>,
    pub(super) parent_from_child: Rigid,
}

/// The transforms of a `tf2_msgs/TFMessage`.
pub(super) fn transforms(message: &[u8], wire: Wire) -> Result<Vec<Transform>, Problem> {
    let fields = &mut Fields::of(message, wire)?;
    let mut transforms = Vec::new();
    for _ in 0..fields.length()? {
        let parent = Header::read(fields, wire)?.frame_id;
        let child = fields.text()?.to_vec();
        let parent_from_child = rigid(fields)?;
        transforms.push(Transform { parent, child, parent_from_child });
    }
    Ok(transforms)
}

/// A `geometry_msgs/Transform`.
pub(super) fn transform(message: &[u8], wire: Wire) -> Result<Rigid, Problem> {
    rigid(&mut Fields::of(message, wire)?)
}

fn rigid(fields: &mut Fields<'_>) -> Result<Rigid, Problem> {
    let (translation_m, rotation_xyzw) = (fields.f64s()?, fields.f64s()?);
    Rigid::new(translation_m, rotation_xyzw).ok_or_else(|| "a rotation is no unit quaternion".to_owned())
}
