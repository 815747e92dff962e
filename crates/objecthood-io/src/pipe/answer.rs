//! What is answered to a frame.

use objecthood::Raster;
use serde::Serialize;

use crate::error::Result;
use crate::json;
use crate::scene::SceneFile;

/// What is answered to a frame: a line of JSON. Either `scene` and `labels` or `error` is there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// Which frame of the stream it is, from 0; those that were dropped count.
    pub number: usize,
    /// What the frame is called, if it said so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// When it was measured (ns), if it said so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stamp_ns: Option<i64>,
    /// Frames of the stream that were dropped until now because a newer one was there.
    pub dropped: usize,
    /// What was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<SceneFile>,
    /// The label image; see [`label_runs`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub labels: Option<Vec<LabelRun>>,
    /// Why nothing could be looked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

impl Answer {
    /// The line, with its end.
    ///
    /// # Errors
    /// [`Error::NotFinite`](crate::Error::NotFinite), [`Error::NoJson`](crate::Error::NoJson); neither happens to what
    /// [`objecthood::discover`] found.
    pub fn to_line(&self) -> Result<String> {
        json::line(self)
    }
}

/// So many pixels in a row of one label: label, pixels.
pub type LabelRun = (u16, u32);

/// A label image as runs of equal labels, row by row from the top, across the ends of rows.
pub fn label_runs(labels: &Raster<u16>) -> Vec<LabelRun> {
    let runs = labels.as_slice().chunk_by(|a, b| a == b);
    runs.map(|run| (run[0], run.len() as u32)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_go_on_across_rows() {
        let labels = Raster::from_vec(3, 2, vec![0, 2, 2, 2, 0, 1]).unwrap();
        assert_eq!(label_runs(&labels), [(0, 1), (2, 3), (0, 1), (1, 1)]);
    }
}
