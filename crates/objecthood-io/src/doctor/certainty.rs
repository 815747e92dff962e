//! How sure the doubts of the core are.

use objecthood::Frame;
use objecthood::plausibility::Doubt;

use super::{Cause, Certainty, Finding};

/// Units are off by this factor before that is sure: things of twice the size exist.
const SURE_TIMES: f64 = 8.0;

/// A depth camera that sees more than this across (degrees) is rare.
const WIDE_DEG: f64 = 95.0;

/// The doubts of a frame as findings; and a camera that would see rarely much.
pub(super) fn of_doubts(doubts: &[Doubt], frame: &Frame) -> Vec<Finding> {
    let mut findings: Vec<_> =
        doubts.iter().map(|doubt| Finding::new(certainty(doubt), cause(doubt), doubt.to_string())).collect();
    let is_of_camera = |finding: &Finding| matches!(finding.cause, Cause::Camera(_));
    if !findings.iter().any(is_of_camera) {
        findings.extend(too_wide(frame));
    }
    findings
}

fn too_wide(frame: &Frame) -> Option<Finding> {
    let (width, height) = frame.size();
    let (camera, longer) = (frame.camera(), width.max(height) as f64);
    let degrees = 2.0 * (longer / (2.0 * camera.fx_px)).atan().to_degrees();
    let reason = || {
        format!(
            "the camera would see {degrees:.0} degrees across, which few depth cameras do: is fx = {:.1} px that of this image, or of one of half its size?",
            camera.fx_px
        )
    };
    (degrees > WIDE_DEG).then(|| Finding::new(Certainty::Suspect, Cause::Camera(None), reason()))
}

fn certainty(doubt: &Doubt) -> Certainty {
    match doubt {
        Doubt::TooFar { times, .. } | Doubt::TooNear { times, .. } if *times < SURE_TIMES => {
            Certainty::Suspect
        }
        Doubt::CenterOff { .. } | Doubt::FocalLengths { .. } => Certainty::Suspect,
        _ => Certainty::Sure,
    }
}

fn cause(doubt: &Doubt) -> Cause {
    match *doubt {
        Doubt::TooFar { times, .. } => Cause::TooFar(times),
        Doubt::TooNear { times, .. } => Cause::TooNear(times),
        Doubt::CameraNormalized { likely } | Doubt::CameraOfOtherSize { likely, .. } => {
            Cause::Camera(Some(likely))
        }
        Doubt::CameraNotInPixels { likely, .. } => Cause::Camera(likely),
        Doubt::CenterSwapped { .. }
        | Doubt::CenterOff { .. }
        | Doubt::FieldOfView { .. }
        | Doubt::FocalLengths { .. } => Cause::Camera(None),
        Doubt::ColorMirrored(_) => Cause::Registration,
        _ => Cause::NotDepth,
    }
}
