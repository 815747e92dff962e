//! A script in the making: a table, things on it, hands that reach for them.

use std::ops::Range;

use glam::DVec3;

use super::camera::CameraPath;
use super::hand::{self, Hand, PALM_M, TIP_M};
use super::path::{Path, Posture};
use super::script::{Agent, Group, Hold, Launch, Script};
use crate::family::setting::{self, TABLE_M};
use crate::family::views::{self, Around};
use crate::light::Lighting;
use crate::place::{Layout, Region};
use crate::pose::Pose;
use crate::random::Rng;
use crate::shape::Shape;
use crate::solid::{Outline, Solid};
use crate::world::Viewpoint;

/// Where things are put that are to be reached.
pub(super) const REACH: Region = Region { center_m: [0.0, 0.0], half_m: [0.26, 0.20] };
/// Room for fingers around a thing (m).
pub(super) const FINGER_ROOM_M: f64 = 0.055;
/// How far from the middle of the table hands wait, out of sight, and shoulders are (m).
const HOME_M: f64 = 0.95;
const SHOULDER_M: f64 = 1.7;
/// How much wider than a thing the hand is when it reaches for it (m).
const OPEN_M: f64 = 0.035;
/// A hand comes and goes at least so far above what it reaches for (m).
const OVER_M: f64 = 0.11;
/// Profiles are sampled in steps of this angle where their width is looked up.
const STEP_DEG: f64 = 10.0;

/// From which side an arm reaches in, seen from the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Side {
    Left,
    Right,
    FrontLeft,
    FrontRight,
}

impl Side {
    pub(super) const ALL: [Self; 4] = [Self::Left, Self::Right, Self::FrontLeft, Self::FrontRight];

    /// To the right of the camera, and towards it.
    fn direction(self) -> [f64; 2] {
        match self {
            Self::Left => [-0.96, 0.28],
            Self::Right => [0.96, 0.28],
            Self::FrontLeft => [-0.45, 0.89],
            Self::FrontRight => [0.45, 0.89],
        }
    }
}

/// How a hand takes hold of a thing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grasp {
    pub(super) pose: Pose,
    pub(super) width_m: f64,
}

/// A script in the making.
pub(super) struct Draft {
    pub(super) layout: Layout,
    lighting: Lighting,
    pub(super) viewpoint: Viewpoint,
    agents: Vec<Agent>,
    holds: Vec<Hold>,
    pub(super) launches: Vec<Launch>,
    pub(super) groups: Vec<Group>,
    /// Durations are this times the usual.
    pub(super) pace: f64,
}

impl Draft {
    /// A table with nothing on it.
    pub(super) fn new(rng: &mut Rng) -> Self {
        let around = Around {
            target_m: [0.0, 0.0, TABLE_M + 0.06],
            distance_m: 0.90..1.20,
            elevation_deg: 30.0..52.0,
            azimuth_deg: -30.0..30.0,
        };
        Self {
            viewpoint: around.viewpoint(rng),
            layout: setting::with_table(rng, false),
            lighting: views::lighting(rng),
            agents: Vec::new(),
            holds: Vec::new(),
            launches: Vec::new(),
            groups: Vec::new(),
            pace: rng.range(0.6..1.25),
        }
    }

    /// The script with a camera on a tripod. Lasts until `after_s` past the last deed, 3 s at least.
    pub(super) fn script(self, after_s: f64) -> Script {
        const SHORTEST_S: f64 = 3.0;
        let ends = self.agents.iter().map(|agent| match agent {
            Agent::Hand(hand) => hand.path.end_s(),
            Agent::Walker(_) => 0.0,
        });
        let launched = self.launches.iter().map(|launch| launch.at_s);
        let end_s = ends.chain(launched).fold(0.0, f64::max);
        let camera = CameraPath::Still(self.viewpoint.pose);
        self.lasting((end_s + after_s).max(SHORTEST_S), camera)
    }

    /// The script, so long, with a camera that moves so.
    pub(super) fn lasting(self, duration_s: f64, camera: CameraPath) -> Script {
        let Self { layout, lighting, viewpoint, agents, holds, launches, groups, .. } = self;
        Script { layout, lighting, viewpoint, camera, agents, holds, launches, groups, duration_s }
    }

    /// A direction over the table, given to the right of the camera and towards it.
    pub(super) fn seen_direction(&self, [right, near]: [f64; 2]) -> DVec3 {
        let across = self.viewpoint.pose.rotation.col(0);
        let across = DVec3::new(across.x, across.y, 0.0).normalize_or(DVec3::X);
        across * right - DVec3::Z.cross(across) * near
    }

    /// Stands a thing somewhere with room for fingers around it.
    pub(super) fn stand(&mut self, rng: &mut Rng, solid: &Solid, region: Region) -> Option<usize> {
        let pose = self.layout.free_place(rng, solid, region, FINGER_ROOM_M)?;
        Some(self.layout.stand_on_table(solid, pose))
    }

    /// Stands a few things about that have no part in what happens.
    pub(super) fn bystanders(&mut self, rng: &mut Rng, most: usize) {
        for _ in 0..rng.below(most + 1) {
            let thing = crate::family::tables::any(rng);
            let region = Region { half_m: [0.34, 0.26], ..REACH };
            self.stand(rng, &thing, region);
        }
    }

    pub(super) fn add_agent(&mut self, agent: Agent) -> usize {
        self.agents.push(agent);
        self.agents.len() - 1
    }

    /// Adds a hand that waits out of sight, for so long. Its number.
    pub(super) fn add_hand(&mut self, rng: &mut Rng, side: Side, waits_s: Range<f64>) -> usize {
        let out = self.seen_direction(side.direction());
        let middle = DVec3::Z * TABLE_M;
        let shoulder = middle + out * SHOULDER_M + DVec3::Z * rng.range(0.40..0.60);
        let home = middle + out * HOME_M + DVec3::Z * rng.range(0.22..0.34);
        let pose = hand::from_above(home, out.cross(DVec3::Z));
        let mut hand = Hand::new(rng, shoulder, Posture { pose, opening_m: 0.06 });
        hand.path.wait(rng.range(waits_s));
        self.add_agent(Agent::Hand(hand))
    }

    /// The side from which an arm does not reach over more than half of the table to get to a thing.
    pub(super) fn near_side(&self, rng: &mut Rng, thing: usize) -> Side {
        let place = self.layout.solids[thing].pose.origin;
        let right = self.seen_direction([1.0, 0.0]).dot(place - DVec3::Z * TABLE_M);
        match (right > 0.0, rng.chance(0.5)) {
            (true, true) => Side::Right,
            (true, false) => Side::FrontRight,
            (false, true) => Side::Left,
            (false, false) => Side::FrontLeft,
        }
    }

    /// The path of a hand, to be continued.
    pub(super) fn path(&mut self, hand: usize) -> &mut Path {
        &mut self.hand(hand).path
    }

    pub(super) fn hand(&mut self, hand: usize) -> &mut Hand {
        match &mut self.agents[hand] {
            Agent::Hand(hand) => hand,
            Agent::Walker(_) => unreachable!("walkers have no hands"),
        }
    }

    /// How a thing that stands upright is taken from above.
    pub(super) fn grasp(&self, thing: usize) -> Grasp {
        let solid = &self.layout.solids[thing];
        let height = solid.form.height_m;
        let grip_z = (height - PALM_M + 0.010).max(TIP_M + 0.003);
        let (closing, width_m) = match solid.form.outline {
            Outline::Rectangle { half_m: [x, y] } if !is_round(solid) => {
                let thin = usize::from(y < x);
                (solid.pose.rotation.col(thin), 2.0 * [x, y][thin])
            }
            _ => {
                let toward = self.viewpoint.pose.origin - solid.pose.origin;
                (toward.cross(DVec3::Z), 2.0 * radius_at(solid, grip_z))
            }
        };
        // Of the two ways to close on it, the one that turns the hand least.
        let x = self.seen_direction([1.0, 0.0]);
        let closing = if closing.dot(x) < 0.0 { -closing } else { closing };
        Grasp { pose: hand::from_above(solid.pose.origin + DVec3::Z * grip_z, closing), width_m }
    }

    /// A hand comes, takes hold of a thing, and has it from then on. The time at which it has it.
    pub(super) fn take(&mut self, hand: usize, thing: usize, grasp: Grasp) -> f64 {
        let pace = self.pace;
        let path = self.path(hand);
        path.grip(0.05, grasp.width_m + OPEN_M);
        let over = Pose { origin: grasp.pose.origin + DVec3::Z * OVER_M, ..grasp.pose };
        path.go(0.75 * pace, over);
        path.go(0.35 * pace, grasp.pose);
        path.grip(0.18 * pace, grasp.width_m);
        let from_s = path.end_s();
        self.hold(hand, thing, from_s);
        from_s
    }

    /// From this time on a hand has hold of a thing.
    pub(super) fn hold(&mut self, agent: usize, solid: usize, from_s: f64) {
        self.holds.push(Hold { agent, solid, from_s, to_s: f64::INFINITY, stays: false });
    }

    /// Lifts what a hand holds, takes it to another pose of the thing, and sets it down.
    pub(super) fn bring(&mut self, hand: usize, grasp: Grasp, from: &Pose, to: &Pose, lift_m: f64) {
        let pace = self.pace;
        let end = to.after(&from.inverse().after(&grasp.pose));
        let top = grasp.pose.origin.z.max(end.origin.z) + lift_m;
        let raised = |pose: Pose| Pose { origin: DVec3::new(pose.origin.x, pose.origin.y, top), ..pose };
        let distance = (end.origin - grasp.pose.origin).length();
        let path = self.path(hand);
        path.go((0.30 + 1.2 * lift_m) * pace, raised(grasp.pose));
        path.go((0.40 + 1.3 * distance) * pace, raised(end));
        path.go((0.35 + 1.0 * lift_m) * pace, end);
    }

    /// Lets go of the last thing that was taken, at the end of what the hand has to do so far, and opens.
    pub(super) fn let_go(&mut self, hand: usize) {
        let pace = self.pace;
        let path = self.path(hand);
        path.wait(0.08);
        let to_s = path.end_s();
        let opening_m = path.end().opening_m + OPEN_M;
        path.grip(0.15 * pace, opening_m);
        self.release_at(hand, to_s);
    }

    /// Lets go of the last thing that a hand took.
    pub(super) fn release_at(&mut self, hand: usize, to_s: f64) {
        if let Some(hold) = self.last_hold(hand) {
            hold.to_s = to_s;
        }
    }

    pub(super) fn last_hold(&mut self, hand: usize) -> Option<&mut Hold> {
        self.holds.iter_mut().rev().find(|hold| hold.agent == hand)
    }

    /// The hand rises and goes back to where it came from.
    pub(super) fn withdraw(&mut self, hand: usize) {
        let pace = self.pace;
        let path = self.path(hand);
        path.shift(0.25 * pace, DVec3::Z * OVER_M);
        let home = path.at(0.0).pose;
        path.go(0.7 * pace, home);
    }

    /// A hand takes a thing to another pose and goes.
    pub(super) fn carry(&mut self, hand: usize, thing: usize, to: &Pose, lift_m: f64) {
        let (from, grasp) = (self.layout.solids[thing].pose, self.grasp(thing));
        self.take(hand, thing, grasp);
        self.bring(hand, grasp, &from, to, lift_m);
        self.let_go(hand);
        self.withdraw(hand);
    }
}

fn is_round(solid: &Solid) -> bool {
    matches!(solid.parts[0].shape, Shape::Revolved(_))
}

/// Radius of the first part of a thing, which is round, at a height over its base.
fn radius_at(solid: &Solid, z: f64) -> f64 {
    let Shape::Revolved(shape) = &solid.parts[0].shape else { return solid.form.outline.outer_radius_m() };
    let profile = shape.profile(STEP_DEG);
    let crossing = |pair: &[[f64; 2]]| {
        let [[r0, z0], [r1, z1]] = [pair[0], pair[1]];
        let is_crossed = (z0.min(z1)..=z0.max(z1)).contains(&z) && z0 != z1;
        is_crossed.then(|| r0 + (r1 - r0) * (z - z0) / (z1 - z0))
    };
    profile.windows(2).filter_map(crossing).fold(0.0, f64::max)
}
