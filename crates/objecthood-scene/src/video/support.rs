//! What stands on what, frame by frame.

use super::overlap::Forms;
use super::{Video, instance};
use crate::solid::{Outline, Role};

/// What holds another thing from below has a normal that points up at least so much there.
const UPWARD: f64 = 0.35;
/// What lies in a vessel reaches below its rim by at least this (m).
const BELOW_RIM_M: f64 = 0.003;

/// How a thing is held from below.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum SupportKind {
    /// It rests on the other.
    On,
    /// It rests in the cavity of the other.
    In,
}

/// A thing and what holds it from below.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Edge {
    /// Instance number of the thing.
    pub child: u16,
    /// Instance number of what holds it; 0 = the table, the floor or other furniture.
    pub parent: u16,
    /// How.
    pub kind: SupportKind,
}

/// What every object touches that holds it from below; of several the one that holds it most nearly upright, of equal ones
/// the first. Nothing for what no solid holds: what is carried, and what flies. O(objects · solids).
pub(super) fn support(video: &Video, forms: &Forms, frame: usize) -> Vec<Edge> {
    video.objects().filter_map(|child| held(video, forms, frame, child)).collect()
}

fn held(video: &Video, forms: &Forms, frame: usize, child: usize) -> Option<Edge> {
    if video.recording[frame][child].was_free {
        return None;
    }
    let mut best: Option<(f64, usize)> = None;
    for parent in (0..video.things().len()).filter(|&parent| parent != child) {
        let Some(met) = forms.meeting(video, frame, parent, child) else { continue };
        if met.normal.z > UPWARD && best.is_none_or(|(upward, _)| met.normal.z > upward + 1e-3) {
            best = Some((met.normal.z, parent));
        }
    }
    let (_, parent) = best?;
    let is_object = video.things()[parent].role() == Role::Object;
    let kind =
        if is_object && is_inside(video, frame, child, parent) { SupportKind::In } else { SupportKind::On };
    Some(Edge { child: instance(child), parent: if is_object { instance(parent) } else { 0 }, kind })
}

/// Whether a thing is within the outline of a vessel and below its rim.
fn is_inside(video: &Video, frame: usize, child: usize, vessel: usize) -> bool {
    let (states, form) = (&video.recording[frame], &video.things()[vessel].form);
    let center = states[vessel].pose.inverse_point(states[child].center);
    let is_within = match form.outline {
        Outline::Rectangle { half_m: [x, y] } => center.x.abs() < x && center.y.abs() < y,
        Outline::Disc { radius_m } => libm::hypot(center.x, center.y) < radius_m,
    };
    let rim = states[vessel].pose.point(glam::DVec3::Z * form.height_m).z;
    form.cavity.is_some() && is_within && video.bottom_m(frame, child) < rim - BELOW_RIM_M
}
