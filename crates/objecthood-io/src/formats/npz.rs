//! NPZ: arrays of NumPy in a ZIP archive, stored or compressed.
//!
//! | array | shape | use |
//! |---|---|---|
//! | `depth` | H, W | metres if its numbers are real, else units of which a depth scale says how many make a metre |
//! | `rgb` | H, W, 3 uint8 | colour |
//! | `K` | 3, 3 | camera matrix (px) |
//! | `points` | N, 3; N, 6; H, W, 3 or H, W, 6 | points (m) as in [`npy`](super::npy), where there is no `depth` |
//! | `stamp_ns`; `position_m`, `rotation_xyzw` | 1; 3, 4 | when and where the camera was |
//!
//! Only `depth` or `points` is needed; `K`, `rgb`, stamp and pose belong to `depth`. These are the names that [`output::npz`](crate::output::npz) writes and grasp planners use; other arrays are not looked
//! at. Each array is unpacked number by number, so a small file takes no more memory than its frame.

use std::io::{Cursor, Read};

use objecthood::{Camera, Raster};
use zip::ZipArchive;
use zip::read::ZipFile;
use zip::result::ZipError;

pub use crate::npy::NpyError;

use super::npy::cloud_of;
use super::{Format, FrameFormat, organized};
use crate::capture::{Capture, Pose, Said};
use crate::error::{Error, Result};
use crate::given::Given;
use crate::images::{capture_of, check_pixels, depth_of_picture, npy};
use crate::npy::{Array, Number};
use crate::organize::GridCamera;
use crate::text::preview;

pub(super) const FORMAT: Format = Format::Frame(FrameFormat {
    extensions: &["npz"],
    is_mine: |head| head.starts_with(b"PK\x03\x04"),
    is_metric: false,
    decode,
});

/// Why bytes are no usable NPZ file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NpzError {
    /// The archive around the arrays is broken.
    #[error("not a usable ZIP archive ({reason}): copy or write it again")]
    Archive {
        /// What is wrong.
        reason: String,
    },
    /// An archive without depth and points.
    #[error(
        "the archive has no array `depth` or `points`: save it with numpy.savez(file, depth=.., rgb=.., K=..)"
    )]
    NoDepth,
    /// An array that cannot be read.
    #[error("the array `{name}`: {error}")]
    Array {
        /// Its name.
        name: &'static str,
        /// What is wrong.
        error: NpyError,
    },
    /// An array of another shape.
    #[error("the array `{name}` has the shape {found:?}, but it should have {wanted}")]
    Shape {
        /// Its name.
        name: &'static str,
        /// Its sides, at most four of them.
        found: Vec<usize>,
        /// The shape that is read.
        wanted: &'static str,
    },
    /// Colours of another kind.
    #[error("the array `rgb` should have whole numbers of 0 to 255: save it as uint8")]
    ColorKind,
}

impl From<NpzError> for Error {
    fn from(error: NpzError) -> Self {
        Self::Content(error.into())
    }
}

/// Reads the content of an NPZ file.
///
/// # Errors
/// [`Error::Content`] with [`NpzError`] or [`PointsError`](super::npy::PointsError); those of
/// [`decode_images`](crate::images::decode_images) and of [`organize`](crate::organize::organize).
pub fn decode(bytes: &[u8], given: &Given) -> Result<Capture> {
    let mut archive = Archive(ZipArchive::new(Cursor::new(bytes)).map_err(broken)?);
    if !archive.has("depth") && archive.has("points") {
        return archive.cloud(given);
    }
    let camera = archive.numbers::<9>("K", &[3, 3], "(3, 3)")?.map(|k| k.map(Number::as_f64));
    let camera = camera.map(|k| Camera::new(k[0], k[4], k[2], k[5])).transpose()?;
    let said = Said { camera: camera.map(|camera| GridCamera { camera, size: None }), ..Said::default() };
    let known = Given { camera: given.camera.or(said.camera), ..given.clone() };
    let depth = archive
        .array("depth", |array| depth_of_picture(npy::picture_of(array, given.max_pixels)?, &known))?;
    let color = archive.array("rgb", |array| color_of(array, given.max_pixels))?;
    let stamp_ns = archive.numbers::<1>("stamp_ns", &[1], "(1,)")?.map(|[stamp_ns]| stamp_ns.as_i64());
    let position_m = archive.numbers::<3>("position_m", &[3], "(3,)")?;
    let rotation_xyzw = archive.numbers::<4>("rotation_xyzw", &[4], "(4,)")?;
    let pose = position_m.zip(rotation_xyzw).map(|(position_m, rotation_xyzw)| Pose {
        position_m: position_m.map(Number::as_f64),
        rotation_xyzw: rotation_xyzw.map(Number::as_f64),
    });
    let capture = capture_of(color, depth.ok_or(NpzError::NoDepth)?, &known)?;
    Ok(Capture { said, stamp_ns, pose, ..capture })
}

struct Archive<'a>(ZipArchive<Cursor<&'a [u8]>>);

impl<'a> Archive<'a> {
    fn has(&self, name: &str) -> bool {
        self.0.index_for_name(&format!("{name}.npy")).is_some()
    }

    /// The frame of the array `points`.
    fn cloud(mut self, given: &Given) -> Result<Capture> {
        let cloud = self.array("points", |array| Ok(cloud_of(array, given.max_pixels)))?;
        organized(cloud.ok_or(NpzError::NoDepth)?, given)
    }

    /// What is read of an array, if it is there.
    fn array<T>(
        &mut self,
        name: &'static str,
        read: impl FnOnce(Array<ZipFile<'_, Cursor<&'a [u8]>>>) -> Result<T>,
    ) -> Result<Option<T>> {
        let file = match self.0.by_name(&format!("{name}.npy")) {
            Ok(file) => file,
            Err(ZipError::FileNotFound) => return Ok(None),
            Err(error) => return Err(broken(error).into()),
        };
        read(Array::open(file).map_err(named(name))?).map(Some)
    }

    /// The numbers of a small array.
    fn numbers<const N: usize>(
        &mut self,
        name: &'static str,
        sides: &[usize],
        wanted: &'static str,
    ) -> Result<Option<[Number; N]>> {
        self.array(name, |array| {
            if array.shape != sides {
                return Err(wrong_shape(name, &array.shape, wanted).into());
            }
            let mut numbers = Vec::with_capacity(N);
            array.read(|number| numbers.push(number)).map_err(named(name))?;
            numbers.try_into().map_err(|_| wrong_shape(name, sides, wanted).into())
        })
    }
}

fn color_of<R: Read>(array: Array<R>, max_pixels: usize) -> Result<Raster<[u8; 3]>> {
    let &[height, width, 3] = array.shape.as_slice() else {
        return Err(wrong_shape("rgb", &array.shape, "(rows, columns, 3)").into());
    };
    check_pixels((width, height), max_pixels)?;
    if !array.is_bytes() {
        return Err(NpzError::ColorKind.into());
    }
    let mut samples = Vec::new();
    array.read(|number| samples.push(number.as_i64() as u8)).map_err(named("rgb"))?;
    Ok(Raster::from_vec(width, height, samples.as_chunks().0.to_vec())?)
}

fn wrong_shape(name: &'static str, found: &[usize], wanted: &'static str) -> NpzError {
    NpzError::Shape { name, found: found.iter().copied().take(4).collect(), wanted }
}

fn named(name: &'static str) -> impl Fn(NpyError) -> NpzError {
    move |error| NpzError::Array { name, error }
}

#[expect(clippy::needless_pass_by_value, reason = "the shape of map_err")]
fn broken(error: ZipError) -> NpzError {
    NpzError::Archive { reason: preview(error.to_string().as_bytes()) }
}
