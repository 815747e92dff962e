//! Unsupervised object discovery from one RGB-D image: finds the things in it that can be grasped and moved.
//!
//! It needs no training and no known classes. The method `paper` is published in "Unsupervised Object
//! Exploration Using Context" (RO-MAN 2014). It over-segments a frame on colour, depth and curvature, groups
//! superpixels into facets, and joins facets across convex edges into shapes. A shape is an object if it has
//! a graspable size and something carries it.
//!
//! The method `context`, the default, has the same four stages. It fits surfaces in disparity, lets whole
//! borders vote, and uses the surroundings: vessels, bottoms, parts behind an occluder.
//!
//! ```
//! use objecthood::{Camera, Frame, Params, Raster, discover};
//!
//! let depth_m = Raster::filled(64, 48, 1.2)?; // a wall; NaN where there is no depth
//! let camera = Camera::new(52.5, 52.5, 31.5, 23.5)?;
//! let frame = Frame::new(depth_m, None, camera)?;
//! let found = discover(&frame, &Params::default())?;
//! assert!(found.objects.is_empty());
//! # Ok::<(), objecthood::Error>(())
//! ```
//!
//! [`discover`] is the one call that most users need. Every stage is a public function that can be called
//! alone: see the examples of the modules below. You may also supply your own superpixels, structure, facets
//! or shapes, as in `examples/02_own_superpixels.rs`. The outputs of later stages
//! ([`Clustering`](clusters::clustering::Clustering), [`Standing`](support::standing::Standing)) are made by
//! their functions only. A [`Pipeline`] keeps the outputs of the stages, and repeats only the stages that a
//! change of parameters affects. The file `method.rs` shows the order of the stages, one screen for each
//! method. The modules:
//!
//! | module | task | paper |
//! |---|---|---|
//! | [`frame`], [`camera`], [`raster`] | the input: units, missing depth, the camera frame | |
//! | [`noise`], [`estimates`], [`attitude`] | what is known before a frame is processed: the sensor's noise, estimates of earlier frames, up (`context`) | |
//! | [`color`] | colours as they are compared | |
//! | [`surface`] | normals and curvature of single pixels | III-A, eq. 2 |
//! | [`oversegment`] | superpixels | III-A, eq. 1 |
//! | [`facets`] | faces of convex shapes | III-B, eq. 3 |
//! | [`shapes`] | convex shapes | III-C, eq. 4 and 5 |
//! | [`clusters`] | shapes that are one thing, joined by their surroundings (`context`) | |
//! | [`support`] | the direction up, and the support graph | III-D, eq. 6 to 8 |
//! | [`objectness`] | the score, and which regions are objects | III-D |
//! | [`discovery`] | the result: objects, joins, the support graph, up, notices | |
//! | [`regions`] | label maps and region graphs, passed from stage to stage | |
//! | [`planes`], [`oriented_box`] | planes and boxes fitted to points | |
//! | [`params`] | every parameter with unit, default and source | |
//! | [`plausibility`] | what cannot be right in a frame: units, cameras, images that do not belong together | |
//! | [`observe`] | the hook that shows intermediate results | |
//! | [`check`] | a measured value against its limit: rules decide by checks, explanations show them | |
//! | [`error`] | why a call failed, and how to fix the input | |
//! | [`explain`] | the decisions behind a pixel's label, and the parameter changes that turn them | |
//!
//! The crate is pure: no files, no clock, no printing. The same frame gives the same labels on any number of
//! threads; functions that use more than one run on the current rayon pool.

pub mod attitude;
mod buffers;
pub mod camera;
pub mod check;
pub mod clusters;
pub mod color;
pub mod discovery;
pub mod error;
pub mod estimates;
pub mod explain;
pub mod facets;
pub mod frame;
mod hull;
mod linear;
mod method;
mod neighbours;
pub mod noise;
pub mod objectness;
pub mod observe;
pub mod oriented_box;
mod outputs;
pub mod oversegment;
pub mod params;
mod pipeline;
pub mod planes;
pub mod plausibility;
mod quantile;
mod random;
pub mod raster;
pub mod regions;
pub mod shapes;
mod simd;
mod stage;
pub mod support;
pub mod surface;
mod tangents;
#[cfg(test)]
mod testing;
mod union_find;

pub use camera::Camera;
pub use discovery::{Discovery, Noise, Notice, Object, ObjectId, ObjectnessParts, OrientedBox};
pub use error::{Error, Result};
pub use estimates::Estimates;
pub use frame::Frame;
pub use observe::{LabelMap, Observer, Output};
pub use params::{Method, ParameterInfo, Params, Reader};
pub use pipeline::Pipeline;
pub use raster::{PixelBox, Raster};
pub use regions::{RegionEdge, RegionGraph, SegmentId, Segments};
pub use stage::Stage;

/// Finds the objects of a frame that can be grasped and moved. For a stream of frames a [`Pipeline`] is faster.
///
/// Lengths are metres in the camera frame, see [`Frame`]. The label images have the size of the frame. A frame without
/// objects is no error: the discovery is empty. O(n log n) time and O(n) memory for n pixels, as long as there are far fewer
/// regions than pixels; parameters that are radii or window sizes multiply the time.
///
/// # Errors
/// [`Error::BadParameter`] when a parameter is outside its range, [`Error::TooManyObjects`] beyond 65535 objects.
pub fn discover(frame: &Frame, params: &Params) -> Result<Discovery> {
    discover_observed(frame, params, &mut ())
}

/// As [`discover`]; also shows every intermediate result to `observer`.
///
/// # Errors
/// As [`discover`].
pub fn discover_observed(frame: &Frame, params: &Params, observer: &mut dyn Observer) -> Result<Discovery> {
    Pipeline::default().discover_observed(frame, params, observer).cloned()
}
