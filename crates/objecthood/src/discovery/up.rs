//! The direction against gravity.

/// The direction against gravity and where it was taken from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Up {
    /// Unit vector in the camera frame.
    pub direction: [f32; 3],
    /// Where it was taken from.
    pub source: UpSource,
}

/// Where the direction up was taken from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpSource {
    /// The normal of the dominant plane.
    Plane,
    /// The camera's own up, by its tilt and roll: asked for, or there is no plane.
    Camera,
}
