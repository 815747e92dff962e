//! What physics makes of a script.
//!
//! Free things are simulated by `rapier3d` with `enhanced-determinism`, in steps of about a millisecond. What a hand holds
//! moves with the hand. Steps are short, so that a ball at 3 m/s is at most 3 mm deep in the table before it is turned back.

use glam::DVec3;
use rapier3d::prelude::{
    CoefficientCombineRule, Collider, ColliderBuilder, ColliderHandle, PhysicsWorld, RigidBody,
    RigidBodyBuilder, RigidBodyHandle, RigidBodyType, Vector,
};

use super::collider::{from_physics, shape_of, to_physics};
use super::script::{Agent, Hold, Script};
use crate::pose::Pose;
use crate::solid::{Role, Solid};

/// Acceleration of free fall (m/s²).
pub(crate) const GRAVITY: f64 = 9.81;
/// Steps a second, at least.
const STEP_HZ: f64 = 960.0;
/// Things are of about this size (m): tolerances of the solver are shares of it.
const LENGTH_M: f32 = 0.05;
/// kg/m³; only ratios matter, and all things are of one stuff.
const DENSITY: f32 = 400.0;
const FRICTION: f32 = 0.5;
/// Share of its speed that a thing keeps when it meets something hard.
const BOUNCE: f32 = 0.15;
const BALL_BOUNCE: f32 = 0.72;
/// What slows a rolling thing (1/s): of all there is only this, so that flight is that of a stone.
const ROLLING_DAMPING: f32 = 0.6;
/// A thing is free when its acceleration is that of free fall up to this (m/s²).
const FREE_WITHIN: f64 = 0.3;

/// How a thing is at the time of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    pub(super) pose: Pose,
    /// Its centre of mass (m), and that one's velocity (m/s).
    pub(super) center: DVec3,
    pub(super) velocity: DVec3,
    /// Angular velocity (rad/s).
    pub(super) spin: DVec3,
    /// Who holds it.
    pub(super) holder: Option<usize>,
    /// Who pushes it, through other things too.
    pub(super) pusher: Option<usize>,
    /// Whether nothing but gravity acted on it in any step since the last frame.
    pub(super) was_free: bool,
}

/// The states of all things in every frame.
pub(super) type Recording = Vec<Vec<State>>;

/// Runs a script: so many frames, `fps` a second. About 20 µs a step.
pub(super) fn simulate(script: &Script, fps: f64, frames: usize) -> Recording {
    let mut stage = Stage::new(script, fps);
    let mut recording = vec![stage.states()];
    for frame in 1..frames {
        stage.run_to(frame);
        recording.push(stage.states());
    }
    recording
}

struct Stage<'a> {
    script: &'a Script,
    physics: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
    colliders: Vec<ColliderHandle>,
    /// Of the agents that push.
    pushers: Vec<(usize, RigidBodyHandle, ColliderHandle)>,
    /// Where each hand had hold of its thing: the thing in the frame of the hand.
    grips: Vec<Option<Pose>>,
    was_free: Vec<bool>,
    steps_per_frame: usize,
    step_s: f64,
    steps: usize,
}

impl<'a> Stage<'a> {
    fn new(script: &'a Script, fps: f64) -> Self {
        let steps_per_frame = (STEP_HZ / fps).ceil() as usize;
        let step_s = 1.0 / (fps * steps_per_frame as f64);
        let mut physics = PhysicsWorld { gravity: Vector::Z * -(GRAVITY as f32), ..PhysicsWorld::default() };
        physics.integration_parameters.dt = step_s as f32;
        physics.integration_parameters.length_unit = LENGTH_M;
        let (mut bodies, mut colliders) = (Vec::new(), Vec::new());
        for (k, solid) in script.layout.solids.iter().enumerate() {
            let waits = script.launches.iter().any(|launch| launch.solid == k)
                || script.holds.iter().any(|hold| hold.solid == k && hold.stays);
            let (body, collider) = physics.insert(body_of(solid, waits), collider_of(solid, k));
            bodies.push(body);
            colliders.push(collider);
        }
        let mut pushers = Vec::new();
        for (k, agent) in script.agents.iter().enumerate() {
            if let Agent::Hand(hand) = agent
                && hand.pushes
            {
                let solid = hand.blunt();
                let builder = RigidBodyBuilder::kinematic_position_based().pose(to_physics(&solid.pose));
                let (body, collider) = physics.insert(builder, collider_of(&solid, bodies.len() + k));
                pushers.push((k, body, collider));
            }
        }
        let was_free = vec![false; bodies.len()];
        let grips = vec![None; script.holds.len()];
        Self {
            script,
            physics,
            bodies,
            colliders,
            pushers,
            grips,
            was_free,
            steps_per_frame,
            step_s,
            steps: 0,
        }
    }

    fn run_to(&mut self, frame: usize) {
        self.was_free.fill(true);
        while self.steps < frame * self.steps_per_frame {
            self.step();
        }
    }

    fn step(&mut self) {
        let (now_s, next_s) = (self.time_s(self.steps), self.time_s(self.steps + 1));
        self.take_and_let_go(now_s, next_s);
        for &(agent, body, _) in &self.pushers {
            let pose = to_physics(&self.script.agents[agent].pose(next_s));
            self.physics.bodies[body].set_next_kinematic_position(pose);
        }
        let velocity =
            |physics: &PhysicsWorld, body: RigidBodyHandle| physics.bodies[body].linvel().as_dvec3();
        let before: Vec<DVec3> = self.bodies.iter().map(|&body| velocity(&self.physics, body)).collect();
        self.physics.step();
        for (k, &body) in self.bodies.iter().enumerate() {
            let gained = (velocity(&self.physics, body) - before[k]) / self.step_s;
            let is_free = (gained + DVec3::Z * GRAVITY).length() < FREE_WITHIN;
            self.was_free[k] &= is_free && self.physics.bodies[body].is_dynamic();
        }
        self.steps += 1;
    }

    fn time_s(&self, steps: usize) -> f64 {
        steps as f64 * self.step_s
    }

    /// Moves what is held, takes hold and lets go of what is due, throws what is due.
    fn take_and_let_go(&mut self, now_s: f64, next_s: f64) {
        for (k, hold) in self.script.holds.iter().enumerate() {
            let agent = &self.script.agents[hold.agent];
            let body = &mut self.physics.bodies[self.bodies[hold.solid]];
            if (hold.from_s..hold.to_s).contains(&now_s) {
                let own = from_physics(body.position());
                let grip = *self.grips[k].get_or_insert_with(|| agent.pose(now_s).inverse().after(&own));
                body.set_body_type(RigidBodyType::KinematicPositionBased, true);
                body.set_next_kinematic_position(to_physics(&agent.pose(next_s).after(&grip)));
            } else if let Some(grip) = self.grips[k].take()
                && !hold.stays
            {
                release(body, agent, hold, &grip);
            }
        }
        for launch in &self.script.launches {
            let body = &mut self.physics.bodies[self.bodies[launch.solid]];
            if launch.at_s <= now_s && launch.at_s > now_s - self.step_s {
                body.set_body_type(RigidBodyType::Dynamic, true);
                body.set_linvel(launch.velocity.as_vec3(), true);
                body.set_angvel(launch.spin.as_vec3(), true);
            }
        }
    }

    fn states(&self) -> Vec<State> {
        let time_s = self.time_s(self.steps);
        let pushers = self.pushed_by();
        let state = |(k, &body): (usize, &RigidBodyHandle)| {
            let body = &self.physics.bodies[body];
            let start = self.script.layout.solids[k].pose;
            // Single precision must not move what rests.
            let has_moved = *body.position() != to_physics(&start);
            let holds = |hold: &&Hold| hold.solid == k && (hold.from_s..hold.to_s).contains(&time_s);
            State {
                pose: if has_moved { from_physics(body.position()) } else { start },
                center: body.center_of_mass().as_dvec3(),
                velocity: body.linvel().as_dvec3(),
                spin: body.angvel().as_dvec3(),
                holder: self.script.holds.iter().find(holds).map(|hold| hold.agent),
                pusher: pushers[k],
                was_free: self.was_free[k],
            }
        };
        self.bodies.iter().enumerate().map(state).collect()
    }

    /// Which agent touches each thing, itself or through others that are no furniture.
    fn pushed_by(&self) -> Vec<Option<usize>> {
        let mut by = vec![None; self.bodies.len()];
        let narrow = &self.physics.narrow_phase;
        for &(agent, _, collider) in &self.pushers {
            let mut open = vec![collider];
            while let Some(collider) = open.pop() {
                for pair in narrow.contact_pairs_with(collider).filter(|pair| pair.has_any_active_contact()) {
                    let other = if pair.collider1 == collider { pair.collider2 } else { pair.collider1 };
                    let Some(k) = self.colliders.iter().position(|&known| known == other) else { continue };
                    if by[k].is_none() && self.physics.bodies[self.bodies[k]].is_dynamic() {
                        by[k] = Some(agent);
                        open.push(other);
                    }
                }
            }
        }
        by
    }
}

/// Lets a body go with the velocity of the hand that held it.
fn release(body: &mut RigidBody, agent: &Agent, hold: &Hold, grip: &Pose) {
    const STEP_S: f64 = 1e-4;
    let [before, after] = [hold.to_s - STEP_S, hold.to_s].map(|t| agent.pose(t).after(grip));
    let turn = after.rotation * before.rotation.transpose();
    let spin = DVec3::new(
        turn.y_axis.z - turn.z_axis.y,
        turn.z_axis.x - turn.x_axis.z,
        turn.x_axis.y - turn.y_axis.x,
    ) / (2.0 * STEP_S);
    let center = after.inverse().point(body.center_of_mass().as_dvec3());
    let velocity = (after.point(center) - before.point(center)) / STEP_S;
    body.set_body_type(RigidBodyType::Dynamic, true);
    body.set_linvel(velocity.as_vec3(), true);
    body.set_angvel(spin.as_vec3(), true);
}

fn body_of(solid: &Solid, waits: bool) -> RigidBodyBuilder {
    let builder = match solid.role {
        Role::Object if waits => RigidBodyBuilder::kinematic_position_based(),
        // Things rest exactly as they were placed until something touches them.
        Role::Object => RigidBodyBuilder::dynamic().sleeping(true).angular_damping(ROLLING_DAMPING),
        _ => RigidBodyBuilder::fixed(),
    };
    builder.pose(to_physics(&solid.pose))
}

fn collider_of(solid: &Solid, index: usize) -> Collider {
    let bounce = if solid.kind == "ball" { BALL_BOUNCE } else { BOUNCE };
    // Furniture leaves it to the thing how far it bounces.
    let restitution = if solid.role == Role::Object { bounce } else { 1.0 };
    let shape = shape_of(solid).map(ColliderBuilder::new);
    // A part without volume has no hull; a point stands for it.
    let builder = shape.unwrap_or_else(|| ColliderBuilder::ball(f32::MIN_POSITIVE));
    builder
        .density(DENSITY)
        .friction(FRICTION)
        .restitution(restitution)
        .restitution_combine_rule(CoefficientCombineRule::Min)
        .user_data(index as u128)
        .build()
}
