//! What goes in and out of objecthood: bytes to [`Frame`](objecthood::Frame), [`Discovery`](objecthood::Discovery) to bytes.
//!
//! In: a [`Source`] opens a file or a folder and lists its frames; each [`FrameRef`] reads a
//! [`Capture`]: frame, name, stamp, pose, and what the file says of camera and units. What the caller knows better is
//! [`Given`]. [`formats`] is the list of formats, one file each. Those of point clouds make a [`PointCloud`], which
//! [`organize`](mod@organize) puts on the pixel grid with a camera that is given or fitted. [`images`] are frames in depth
//! and colour images, with the camera of a [`camera_file`]. [`scope`] limits what is looked at.
//!
//! Out: [`label_image`] (16-bit PNG), [`point_labels`] (PCD), [`scene`] (JSON, with its schema) and [`explanation`] (JSON); [`output`] puts the bytes
//! on the disk, whole or not at all.
//!
//! Only [`output`], [`FrameRef::read`], functions called `open..` and a [`Source`] that searches a folder touch files.
//! Everything else goes from bytes to values and back; every length that a file claims is bounded by the bytes that are there, or for images by a number of pixels.
//!
//! ```no_run
//! use objecthood_io::{Given, Source, label_image, output, scene::SceneFile};
//!
//! let params = objecthood::Params::default();
//! for frame in Source::open("mosd/learn".as_ref(), &Given::default())? {
//!     let frame = frame?;
//!     let capture = frame.read()?;
//!     let discovery = objecthood::discover(&capture.frame, &params)?;
//!
//!     let labels = label_image::encode(&discovery.labels)?;
//!     let scene = SceneFile::new(&frame.path().to_string_lossy(), &capture, &params, &discovery).to_json()?;
//!     let name = frame.name().to_string_lossy();
//!     let files = [(format!("{name}.labels.png").into(), labels), (format!("{name}.json").into(), scene.into())];
//!     output::write_together(&files)?;
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod associate;
pub mod camera_file;
mod capture;
mod cloud;
pub mod doctor;
mod error;
pub mod explanation;
pub mod formats;
mod given;
pub mod images;
mod json;
pub mod label_image;
pub mod natural;
mod npy;
pub mod organize;
pub mod output;
pub mod pipe;
pub mod point_labels;
mod recording;
pub mod scene;
pub mod scope;
mod source;
mod text;

pub use capture::{Capture, Pose, Said};
pub use cloud::PointCloud;
pub use error::{Error, Result};
pub use formats::{decode, extensions};
pub use given::{DEFAULT_MAX_PIXELS, Given};
pub use organize::{CameraFit, GridCamera, PointList};
pub use recording::RecordingError;
pub use source::{FrameRange, FrameRef, Notice, Selection, Source, TimeRange, Topic, open_frame, sha256};
