//! What a frame should cost at most, and what it does cost.

use super::figures::Figures;

/// What two series should be to each other.
pub(crate) struct Target {
    /// In words.
    pub(crate) what: &'static str,
    /// The series above the line.
    pub(crate) ours: &'static str,
    /// The series below the line; empty: the figure itself is what counts.
    pub(crate) theirs: &'static str,
    pub(crate) target: f64,
    pub(crate) stretch: Option<f64>,
    /// Whether more is better.
    pub(crate) at_least: bool,
    pub(crate) unit: &'static str,
}

const fn at_most(
    what: &'static str,
    ours: &'static str,
    theirs: &'static str,
    target: f64,
    stretch: Option<f64>,
) -> Target {
    Target { what, ours, theirs, target, stretch, at_least: false, unit: " x" }
}

/// Time of PCL's whole chain without reading the file.
const LCCP: &str = "lccp/TOTAL without load/cpu_ms";
const OPENCV: &str = "opencv graph/cpu_ms";

pub(crate) const TARGETS: [Target; 18] = [
    at_most("`context`, 1 thread, against tuned PCL LCCP", "context/alone/1/cpu_ms", LCCP, 0.40, Some(0.20)),
    at_most(
        "`context`, 1 thread, against OpenCV's graph segmentation alone",
        "context/1/total/cpu_ms",
        OPENCV,
        0.10,
        Some(0.05),
    ),
    at_most(
        "`context`, one frame on 2 threads, wall against 1 thread: one frame after the other",
        "context/alone/2/wall_ms",
        "context/alone/1/wall_ms",
        0.75,
        Some(0.6),
    ),
    at_most(
        "the same in turns with others, which let the second core fall asleep",
        "context/2/total/wall_ms",
        "context/1/total/wall_ms",
        0.75,
        Some(0.6),
    ),
    Target {
        what: "stream of frames by `context` on 2 threads, throughput against 1",
        ours: "stream/context/1/wall_ms",
        theirs: "stream/context/2/wall_ms",
        target: 1.7,
        stretch: Some(1.9),
        at_least: true,
        unit: " x",
    },
    at_most(
        "`paper`, 1 thread, all stages, against OpenCV's graph segmentation of the colour image alone",
        "paper/1/total/cpu_ms",
        OPENCV,
        0.45,
        Some(0.25),
    ),
    at_most("graph segmentation alone, against OpenCV's", "graph/cpu_ms", OPENCV, 0.20, Some(0.12)),
    at_most(
        "graph segmentation alone, against scikit-image's",
        "graph/cpu_ms",
        "skimage graph/cpu_ms",
        0.05,
        Some(0.03),
    ),
    at_most(
        "integral-image normals, against PCL's average 3D gradient: time",
        "integral-image normals/cpu_ms",
        "pcl_normals/AVERAGE_3D_GRADIENT/cpu_ms",
        0.15,
        Some(0.08),
    ),
    at_most(
        "the same: median angle to the table's plane",
        "integral-image normals/angle_deg",
        "pcl_normals/deg to table AVERAGE_3D_GRADIENT/wall_ms",
        1.0,
        None,
    ),
    Target {
        what: "peak memory of `segment` on one VGA frame by `context`",
        ours: "context/peak/mb",
        theirs: "",
        target: 80.0,
        stretch: Some(40.0),
        at_least: false,
        unit: " MB",
    },
    Target {
        what: "peak memory of `segment` on one VGA frame by `paper`",
        ours: "paper/peak/mb",
        theirs: "",
        target: 80.0,
        stretch: Some(40.0),
        at_least: false,
        unit: " MB",
    },
    at_most(
        "resident memory of `context` after all frames against that after 100 (2 % for the allocator)",
        "context/resident end/mb",
        "context/resident warm/mb",
        1.02,
        None,
    ),
    at_most("the same of `paper`", "paper/resident end/mb", "paper/resident warm/mb", 1.02, None),
    at_most(
        "from a PCD file to labels, against `context` alone",
        "reading/pcd/both/cpu_ms",
        "reading/pcd/alone/cpu_ms",
        1.8,
        None,
    ),
    at_most("from two PNG files", "reading/png/both/cpu_ms", "reading/png/alone/cpu_ms", 1.6, None),
    at_most(
        "from raw images in an MCAP file",
        "reading/mcap/both/cpu_ms",
        "reading/mcap/alone/cpu_ms",
        1.25,
        None,
    ),
    Target {
        what: "reading raw VGA frames of an MCAP file: 200 a second",
        ours: "reading/mcap/read/cpu_ms",
        theirs: "",
        target: 5.0,
        stretch: None,
        at_least: false,
        unit: " ms",
    },
];

impl Target {
    /// What was measured: the ratio of the medians, or the median.
    pub(crate) fn measured(&self, figures: &Figures) -> Option<f64> {
        let ours = figures.median(self.ours)?;
        Some(if self.theirs.is_empty() { ours } else { ours / figures.median(self.theirs)? })
    }

    /// What is to be said of a measured value.
    pub(crate) fn verdict(&self, measured: Option<f64>) -> &'static str {
        let reaches = |value: f64, limit: f64| if self.at_least { value >= limit } else { value <= limit };
        match measured {
            None => "not measured",
            Some(value) if !reaches(value, self.target) => "**missed**",
            Some(value) if self.stretch.is_some_and(|limit| reaches(value, limit)) => "met, stretch too",
            Some(_) => "met",
        }
    }

    /// A limit in words.
    pub(crate) fn limit(&self, limit: f64) -> String {
        format!("{} {limit}{}", if self.at_least { "≥" } else { "≤" }, self.unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_kept_reached_and_missed() {
        let [lccp, _, _, _, stream, ..] = &TARGETS;
        let said = |target: &Target, values: [f64; 3]| values.map(|value| target.verdict(Some(value)));
        assert_eq!(said(lccp, [0.2, 0.4, 0.41]), ["met, stretch too", "met", "**missed**"]);
        assert_eq!(said(stream, [1.9, 1.7, 1.69]), ["met, stretch too", "met", "**missed**"]);
        assert_eq!(lccp.verdict(None), "not measured");
    }

    #[test]
    fn a_ratio_is_that_of_the_medians() {
        let mut figures = Figures::default();
        for value in [1.0, 2.0, 90.0] {
            figures.add(TARGETS[0].ours, value);
            figures.add(TARGETS[0].theirs, 10.0 * value);
        }
        figures.add("context/peak/mb", 70.0);
        assert_eq!(TARGETS[0].measured(&figures), Some(0.1));
        assert_eq!(TARGETS[10].measured(&figures), Some(70.0));
        assert_eq!(TARGETS[1].measured(&figures), None);
    }
}
