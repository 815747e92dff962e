//! What is to happen in a clip: a scene, who acts in it and when.

use glam::DVec3;

use super::camera::CameraPath;
use super::hand::Hand;
use super::walker::Walker;
use crate::light::Lighting;
use crate::place::Layout;
use crate::pose::Pose;
use crate::solid::Solid;
use crate::world::Viewpoint;

/// Everything from which a clip follows.
pub(super) struct Script {
    pub(super) layout: Layout,
    pub(super) lighting: Lighting,
    pub(super) viewpoint: Viewpoint,
    pub(super) camera: CameraPath,
    pub(super) agents: Vec<Agent>,
    pub(super) holds: Vec<Hold>,
    pub(super) launches: Vec<Launch>,
    pub(super) groups: Vec<Group>,
    pub(super) duration_s: f64,
}

/// Who moves things.
#[derive(Clone, Debug)]
pub(super) enum Agent {
    Hand(Hand),
    Walker(Walker),
}

/// A hand has hold of a thing, which moves with it as one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hold {
    pub(super) agent: usize,
    /// Index of the thing.
    pub(super) solid: usize,
    pub(super) from_s: f64,
    pub(super) to_s: f64,
    /// Whether the thing stays where it was let go, as a drawer does; else it is free.
    pub(super) stays: bool,
}

/// A thing that waits in its place and is then thrown by someone who is not seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Launch {
    pub(super) solid: usize,
    pub(super) at_s: f64,
    pub(super) velocity: DVec3,
    /// Angular velocity (rad/s).
    pub(super) spin: DVec3,
}

/// Things that count as one until one of them moves.
#[derive(Clone, Debug)]
pub(super) struct Group {
    pub(super) members: Vec<usize>,
    pub(super) joint: Joint,
}

/// Why things count as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Joint {
    /// Their faces go on in each other.
    Flush,
    /// One closes the other: a lid, a drawer.
    Closed,
}

impl Agent {
    pub(super) fn solid(&self, time_s: f64) -> Solid {
        match self {
            Self::Hand(hand) => hand.solid(time_s),
            Self::Walker(walker) => walker.solid(time_s),
        }
    }

    pub(super) fn pose(&self, time_s: f64) -> Pose {
        match self {
            Self::Hand(hand) => hand.path.at(time_s).pose,
            Self::Walker(walker) => walker.pose(time_s),
        }
    }
}
