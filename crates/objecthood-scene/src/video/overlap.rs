//! How bodies lie to each other in a frame.

use glam::DVec3;
use rapier3d::parry::bounding_volume::BoundingVolume;
use rapier3d::parry::query::contact;
use rapier3d::prelude::SharedShape;

use super::Video;
use super::collider::{shape_of, to_physics};
use crate::pose::Pose;

/// Bodies that are nearer than this touch (m).
pub(super) const TOUCH_M: f64 = 0.002;

/// The forms of all things of a video; `None` for one without volume.
pub(super) struct Forms(Vec<Option<SharedShape>>);

/// Where two bodies touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    /// Negative where they overlap (m).
    pub(super) distance_m: f64,
    /// From the first to the second.
    pub(super) normal: DVec3,
}

impl Forms {
    pub(super) fn of(video: &Video) -> Self {
        Self(video.things().iter().map(shape_of).collect())
    }

    /// Where things `a` and `b` touch in a frame, deepest.
    pub(super) fn meeting(&self, video: &Video, frame: usize, a: usize, b: usize) -> Option<Meeting> {
        let states = &video.recording[frame];
        meeting((&states[a].pose, self.0[a].as_ref()?), (&states[b].pose, self.0[b].as_ref()?))
    }

    /// How deep an agent is in a thing (m); negative when it is not.
    pub(super) fn depth_of_agent(&self, video: &Video, frame: usize, agent: usize, thing: usize) -> f64 {
        let solid = video.agents()[agent].solid(video.time_s(frame));
        let met = shape_of(&solid).zip(self.0[thing].as_ref()).and_then(|(shape, thing_shape)| {
            meeting((&solid.pose, &shape), (&video.recording[frame][thing].pose, thing_shape))
        });
        met.map_or(-TOUCH_M, |met| -met.distance_m)
    }
}

fn meeting((pose_a, a): (&Pose, &SharedShape), (pose_b, b): (&Pose, &SharedShape)) -> Option<Meeting> {
    let (pose_a, pose_b) = (to_physics(pose_a), to_physics(pose_b));
    let (box_a, box_b) = (a.compute_aabb(&pose_a).loosened(TOUCH_M as f32), b.compute_aabb(&pose_b));
    let apart = box_a.maxs.cmplt(box_b.mins).any() || box_b.maxs.cmplt(box_a.mins).any();
    if apart {
        return None;
    }
    let met = contact(&pose_a, a.as_ref(), &pose_b, b.as_ref(), TOUCH_M as f32).ok().flatten()?;
    Some(Meeting { distance_m: f64::from(met.dist), normal: met.normal1.as_dvec3() })
}
