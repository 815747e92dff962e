//! What goes in and out of objecthood: bytes to [`Frame`](objecthood::Frame), [`Discovery`](objecthood::Discovery) to bytes.
//!
//! In: [`open`] probes the list of formats (one so far, [`pcd`]) and yields a [`Capture`]. A point cloud carries no
//! camera, so [`organize`] fits one to the points or takes the caller's. [`images`] makes a [`Capture`] of a depth and a
//! colour image with the camera of a [`camera_file`]; [`tum`] lists the pairs of a folder. [`scope`] limits what is
//! looked at.
//!
//! Out: [`label_image`] (16-bit PNG), [`scene`] (JSON, with its schema) and [`explanation`] (JSON); [`output`] puts the bytes
//! on the disk, whole or not at all.
//!
//! Only [`output`] and functions called `open..` touch files; everything else goes from bytes to values and back, and
//! bounds every length that a file claims by the bytes that are there, or for images by a number of pixels.
//!
//! ```no_run
//! use objecthood_io::{label_image, output, scene::SceneFile};
//!
//! let input = std::path::Path::new("learn0.pcd");
//! let capture = objecthood_io::open(input, None, objecthood_io::images::DEFAULT_MAX_PIXELS)?;
//! let params = objecthood::Params::default();
//! let discovery = objecthood::discover(&capture.frame, &params)?;
//!
//! let labels = label_image::encode(&discovery.labels)?;
//! let scene = SceneFile::new("learn0.pcd", &capture, &params, &discovery);
//! output::write_together(&[("learn0.labels.png".into(), labels), ("learn0.json".into(), scene.to_json()?.into())])?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod camera_file;
mod error;
pub mod explanation;
mod formats;
pub mod images;
pub mod label_image;
pub mod organize;
pub mod output;
pub mod pcd;
pub mod scene;
pub mod scope;
pub mod tum;

pub use error::{Error, Result};
pub use formats::{EXTENSIONS, decode, open};
pub use organize::{CameraFit, Capture, GridCamera};
