//! The surface at single pixels.
//!
//! `paper`: depth changes bound the windows ([`depth_change`]), tangents averaged over them give normals ([`normals`]),
//! and the angles between normals give curvature ([`curvature`]).
//!
//! `context`: in [`disparity`] the noise is constant and planes are affine, so a plane is fitted to the window around every pixel
//! ([`plane_fit`]). Each pixel takes its orientation from the best window that contains it ([`window_choice`]). Larger surfaces
//! are fitted from their [`moments`].

pub mod curvature;
pub mod depth_change;
pub mod disparity;
pub mod model;
pub mod moments;
pub mod normals;
pub mod plane_fit;
pub mod surfaces;
pub mod window_choice;
