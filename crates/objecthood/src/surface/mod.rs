//! What single pixels tell about the surface they lie on.
//!
//! `paper`: depth changes bound the windows ([`depth_change`]), tangents averaged over them give normals ([`normals`]),
//! and how the normals turn gives curvature ([`curvature`]).
//!
//! `context`: in [`disparity`] the noise is constant and planes are affine, so a plane is fitted around every pixel
//! ([`plane_fit`]) and the best of the windows that contain it speaks for it ([`window_choice`]). Larger surfaces are
//! fitted from their [`moments`].

pub mod curvature;
pub mod depth_change;
pub mod disparity;
pub mod model;
pub mod moments;
pub mod normals;
pub mod plane_fit;
pub mod surfaces;
pub mod window_choice;
