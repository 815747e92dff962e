//! The direction against gravity.

/// The direction against gravity, and its source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Up {
    /// Unit vector in the camera frame.
    pub direction: [f32; 3],
    /// The source of the direction.
    pub source: UpSource,
}

/// The source of the direction up. The first that can tell is taken, in this order: measured gravity, the plane, earlier frames, the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpSource {
    /// The normal of the ground: in `context` the surface on which most things stand, in `paper` the dominant plane.
    Plane,
    /// Measured gravity, by [`Frame::with_up`](crate::Frame::with_up): no surface is asked.
    Measured,
    /// What earlier frames told, because this one shows no ground.
    Earlier,
    /// The camera's own up, by its tilt and roll: requested by `up_from`, or because there is no plane.
    Camera,
}
