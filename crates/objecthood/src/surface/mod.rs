//! The surface at single pixels.
//!
//! `paper`: depth changes bound the windows ([`depth_change`]), tangents averaged over them give normals ([`normals`]),
//! and the angles between normals give curvature ([`curvature`]).
//!
//! `context`: in [`disparity`] the noise is constant and planes are affine, so a plane is fitted to the window around every pixel
//! ([`plane_fit`]). Each pixel takes its orientation from the best window that contains it ([`window_choice`]). Larger surfaces
//! are fitted from their [`moments`].
//!
//! On a box of 10 cm, seen from above:
//!
//! ```
//! use objecthood::surface::curvature::measure_curvature;
//! use objecthood::surface::normals::measure_normals;
//! use objecthood::surface::surfaces::find_surfaces;
//!
//! # use objecthood::{Camera, Frame, Params, Raster};
//! # let seen_m = |i: usize| if (60..100).contains(&(i % 160)) && (40..80).contains(&(i / 160)) { 0.9 } else { 1.0 };
//! # let depth_m = Raster::from_vec(160, 120, (0..160 * 120).map(seen_m).collect())?;
//! # let frame = Frame::new(depth_m, None, Camera::new(131.0, 131.0, 79.5, 59.5)?)?;
//! let params = Params::default();
//! let surfaces = find_surfaces(&frame, &params.sensor, &params.local_fit);
//! assert_eq!(surfaces.orientation.normal[0], [0.0, 0.0, -1.0]); // towards the camera
//!
//! let normals = measure_normals(&frame.points_m(), &params.normals); // of `paper`
//! assert!(measure_curvature(&normals, &params.curvature)[60 * 160 + 80] < params.curvature.threshold);
//! # Ok::<(), objecthood::Error>(())
//! ```

pub mod bands;
pub mod blocks;
mod bridges;
pub mod curvature;
pub mod depth_change;
pub mod disparity;
pub mod model;
pub mod moments;
mod noise_choice;
pub mod normals;
pub mod plane_fit;
mod ramps;
mod sharpen;
pub mod surfaces;
pub mod window_choice;
