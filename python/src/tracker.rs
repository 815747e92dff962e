//! Objects through a video.

use std::sync::{Mutex, PoisonError};

use numpy::PyArray2;
use objecthood::{OrientedBox, PixelBox};
use objecthood_track::{Rigid, TrackedObject};
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::arrays::image;
use crate::capture::Capture;
use crate::errors::InputError;
use crate::parameters::parse;
use crate::run::Threads;

/// Follows objects through a video.
#[pyclass(frozen, module = "objecthood._native")]
pub(crate) struct Tracker {
    state: Mutex<(objecthood_track::Tracker, Threads)>,
}

/// What the tracker says of a frame.
#[pyclass(frozen, module = "objecthood._native")]
pub(crate) struct Tracked {
    inner: objecthood_track::Tracked,
}

#[pymethods]
impl Tracker {
    /// With parameters in JSON, on so many threads.
    #[new]
    #[pyo3(signature = (params, threads))]
    fn new(params: &str, threads: Option<usize>) -> PyResult<Self> {
        let tracker = objecthood_track::Tracker::new(parse(params)?);
        Ok(Self { state: Mutex::new((tracker, Threads::new(threads)?)) })
    }

    /// Takes the next frame. Ctrl-C is heard when the frame is done.
    #[pyo3(signature = (capture, stamp_s, pose))]
    fn update(
        &self,
        py: Python<'_>,
        capture: &Capture,
        stamp_s: f64,
        pose: Option<([f64; 3], [f64; 4])>,
    ) -> PyResult<Tracked> {
        let rigid = |(position_m, rotation_xyzw)| {
            Rigid::new(rotation_xyzw, position_m).ok_or_else(|| {
                InputError::new_err(
                    "the pose is none: give a position and a quaternion x, y, z, w that is not 0",
                )
            })
        };
        let pose = pose.map(rigid).transpose()?;
        py.detach(|| {
            let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            let (tracker, threads) = &mut *state;
            let tracked = threads.run(|_| tracker.update(&capture.inner.frame, stamp_s, pose))?;
            let inner = tracked.map_err(|error| InputError::new_err(error.to_string()))?;
            Ok(Tracked { inner })
        })
    }

    /// Events that become certain when the video ends, as JSON.
    fn finish(&self, py: Python<'_>) -> String {
        py.detach(|| {
            let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            json!(state.0.finish()).to_string()
        })
    }

    /// Passes over a frame of which nothing is known.
    fn skip(&self, py: Python<'_>) {
        py.detach(|| self.state.lock().unwrap_or_else(PoisonError::into_inner).0.skip());
    }

    /// Forgets everything.
    fn reset(&self, py: Python<'_>) {
        py.detach(|| self.state.lock().unwrap_or_else(PoisonError::into_inner).0.reset());
    }
}

#[pymethods]
impl Tracked {
    /// The track at every pixel, 0 = none.
    fn labels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u16>>> {
        image(py, &self.inner.labels)
    }

    /// Everything but the labels, as JSON.
    fn data(&self) -> String {
        let tracked = &self.inner;
        let lost = tracked.lost.iter().map(|lost| {
            json!({
                "track": lost.track,
                "state": lost.state,
                "center_m": lost.center_m,
                "pose": pose(&lost.pose),
                "for_s": lost.for_s,
            })
        });
        let agents = tracked
            .agents
            .iter()
            .map(|agent| json!({ "id": agent.id, "size_px": agent.size_px, "xyxy": corners(agent.box_px) }));
        json!({
            "frame": tracked.frame,
            "stamp_s": tracked.stamp_s,
            "objects": tracked.objects.iter().map(object).collect::<Vec<_>>(),
            "lost": lost.collect::<Vec<_>>(),
            "agents": agents.collect::<Vec<_>>(),
            "support": tracked.support,
            "events": tracked.events,
            "world_from_camera": pose(&tracked.world_from_camera),
            "notices": tracked.notices.iter().map(ToString::to_string).collect::<Vec<_>>(),
        })
        .to_string()
    }
}

fn object(object: &TrackedObject) -> Value {
    let box_m = object.box_m.map(|OrientedBox { center_m, rotation_xyzw, extents_m }| {
        json!({ "center_m": center_m, "rotation_xyzw": rotation_xyzw, "extents_m": extents_m })
    });
    json!({
        "track": object.track,
        "state": object.state,
        "center_m": object.center_m,
        "pose": pose(&object.pose),
        "parts": object.parts,
        "velocity_m_per_s": object.velocity_m_per_s,
        "motion": object.motion.as_ref().map(|motion| pose(&motion.rigid)),
        "size_px": object.size_px,
        "xyxy": corners(object.box_px),
        "box_m": box_m,
        "objectness": object.objectness,
        "seen_to": object.seen_to,
    })
}

fn pose(rigid: &Rigid) -> Value {
    json!({ "position_m": rigid.translation_m(), "rotation_xyzw": rigid.rotation_xyzw() })
}

fn corners(PixelBox { u, v, width, height }: PixelBox) -> [usize; 4] {
    [u, v, u + width, v + height]
}
