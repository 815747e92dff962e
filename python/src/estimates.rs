//! What frames tell, for the next frame.

use pyo3::prelude::*;

/// What frames tell of their sensor and of up, for the next frame of the same camera. It never changes.
#[pyclass(frozen, eq, module = "objecthood")]
#[derive(PartialEq)]
pub(crate) struct Estimates {
    pub(crate) inner: objecthood::Estimates,
}

#[pymethods]
impl Estimates {
    /// Standard deviation of single pixels, relative to a Kinect v1.
    #[getter]
    fn white_noise(&self) -> f64 {
        self.inner.noise.white
    }

    /// Noise of 16 to 40 px in length, relative to a Kinect v1.
    #[getter]
    fn waves(&self) -> f64 {
        self.inner.noise.waves()
    }

    /// Disagreement (quanta) of neighbouring blocks of 8, 16 and 32 px at a focal length of 525 px.
    #[getter]
    fn blocks_quanta(&self) -> (f64, f64, f64) {
        self.inner.noise.blocks_quanta.into()
    }

    /// The frames in the mean that the noise is, at most 10; 0 when no frame told of it.
    #[getter]
    fn frames(&self) -> u32 {
        self.inner.frames
    }

    /// The direction against gravity, a unit vector in the camera frame; `None` when no frame told it clearly.
    #[getter]
    fn up(&self) -> Option<(f32, f32, f32)> {
        self.inner.up.map(Into::into)
    }

    fn __repr__(&self) -> String {
        let (white, waves, frames) = (self.white_noise(), self.waves(), self.frames());
        let plural = if frames == 1 { "" } else { "s" };
        let up = self.inner.up.map(|[x, y, z]| format!("up ({x:.2}, {y:.2}, {z:.2})"));
        let up = up.unwrap_or_else(|| "up unknown".into());
        format!(
            "<objecthood.Estimates of {frames} frame{plural}: white noise {white:.2} and waves {waves:.2} times a Kinect's, {up}>"
        )
    }
}
