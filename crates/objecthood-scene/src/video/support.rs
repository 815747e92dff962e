//! What stands on what, frame by frame.

use super::overlap::{Forms, Meeting};
use super::{Video, instance};
use crate::solid::{Outline, Role};

/// What holds another thing from below has a normal that points up at least so much there.
const UPWARD: f64 = 0.35;
/// Distances that differ by less are the same (m).
const ALIKE_M: f64 = 0.0005;
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

/// What every object touches that holds it from below; of several the nearest, of equally near ones that which holds it
/// most nearly upright, then the first. Nothing for what no solid holds: what is carried, and what flies. O(objects · solids).
pub(super) fn support(video: &Video, forms: &Forms, frame: usize) -> Vec<Edge> {
    video.objects().filter_map(|child| held(video, forms, frame, child)).collect()
}

fn held(video: &Video, forms: &Forms, frame: usize, child: usize) -> Option<Edge> {
    if video.recording[frame][child].was_free {
        return None;
    }
    let parents = (0..video.things().len()).filter(|&parent| parent != child);
    let below: Vec<(usize, Meeting)> = parents
        .filter_map(|parent| Some((parent, forms.meeting(video, frame, parent, child)?)))
        .filter(|(_, met)| met.normal.z > UPWARD)
        .collect();
    // The floor of a vessel may be nearer to the table than what counts as touch.
    let nearest = below.iter().map(|(_, met)| met.distance_m).fold(f64::INFINITY, f64::min);
    let touching = below.iter().filter(|(_, met)| met.distance_m <= nearest + ALIKE_M);
    let order = |a: &(usize, Meeting), b: &(usize, Meeting)| {
        a.1.normal.z.total_cmp(&b.1.normal.z).then_with(|| b.0.cmp(&a.0))
    };
    let &(parent, _) = touching.max_by(|a, b| order(a, b))?;
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
