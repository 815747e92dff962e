//! What single pixels tell about the surface they lie on.
//!
//! Depth changes bound the windows ([`depth_change`]), tangents averaged over them give normals ([`normals`]),
//! and how the normals turn gives curvature ([`curvature`]).

pub mod curvature;
pub mod depth_change;
pub mod integral;
pub mod normals;
