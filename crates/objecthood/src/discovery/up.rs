//! The direction against gravity.

/// The direction against gravity, and its source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Up {
    /// Unit vector in the camera frame.
    pub direction: [f32; 3],
    /// The source of the direction.
    pub source: UpSource,
}

/// The source of the direction up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpSource {
    /// The normal of the dominant plane.
    Plane,
    /// Measured gravity, by [`Frame::with_up`](crate::Frame::with_up).
    Measured,
    /// What earlier frames told, because this one shows no ground.
    Earlier,
    /// The camera's own up, by its tilt and roll: requested by `up_from`, or because there is no plane.
    Camera,
}
