//! The choice of the ground among surfaces, by what stands on them and by what is known of the direction up (docs/CONTEXT.md 1.1).

use glam::DVec3;

use crate::attitude::{Attitude, Knowledge};

/// Cosine of the angle between surfaces that are supports of one scene (15 degrees).
const PARALLEL: f64 = 0.966;
/// Weight of a ground for which the camera would have to be turned about its optical axis.
const TURNED_WEIGHT: f64 = 0.4;
/// Cosine of the angle between a measured up and the ground (10 degrees).
const NEAR_GRAVITY: f64 = 0.985;
/// A ground is in doubt when a surface that is turned otherwise reaches this share of its votes.
const RIVAL_SHARE: f64 = 0.5;

/// What speaks for a surface as a support.
pub(super) struct Evidence {
    pub(super) normal: DVec3,
    /// Things that touch it more than any other surface; an empty surface counts as much as its share of the image.
    pub(super) things: f64,
}

impl Evidence {
    pub(super) fn is_parallel_to(&self, other: &Self) -> bool {
        self.normal.dot(other.normal) > PARALLEL
    }
}

/// A surface taken for the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Choice {
    pub(super) surface: usize,
    /// How far the camera is turned clockwise about its optical axis beyond what was given: 0, 90, 180 or 270 degrees.
    pub(super) turned_deg: u16,
    /// Whether little speaks for another surface.
    pub(super) is_clear: bool,
    /// The votes of all surfaces parallel to it, weighted.
    votes: f64,
}

/// Chooses the ground. `None` without surfaces, or where none agrees with what is known of up.
///
/// Surfaces that are parallel vote together. Their votes count the less the farther they turn from the camera's own up to below the
/// horizon. Where the frame does not decide, what earlier frames told does. O(surfaces²).
pub(super) fn choose_ground(evidence: &[Evidence], attitude: &Attitude) -> Option<Choice> {
    let choices = rate(evidence, attitude);
    let best = most_votes(choices.iter())?;
    let leader = &evidence[best.surface];
    let rivals = choices.iter().filter(|other| !leader.is_parallel_to(&evidence[other.surface]));
    let rival_votes = most_votes(rivals).map_or(0.0, |rival| rival.votes);
    // Nothing stands on it, and it does not lie as a ground would.
    let votes = together(evidence, leader);
    let is_guessed = votes < 1.0 && best.votes < votes;
    let is_clear = rival_votes < RIVAL_SHARE * best.votes && !is_guessed;
    match attitude.earlier_up {
        Some(up) if !is_clear => {
            let alike = choices.iter().filter(|choice| evidence[choice.surface].normal.dot(up) > PARALLEL);
            most_votes(alike).map(|choice| Choice { is_clear: true, ..*choice })
        }
        _ => Some(Choice { is_clear, ..*best }),
    }
}

/// Every surface that can be the ground, with the camera held as it is known to be and, unless that was given, turned by quarters.
fn rate(evidence: &[Evidence], attitude: &Attitude) -> Vec<Choice> {
    let turns: &[u16] = match attitude.knowledge {
        Knowledge::Assumed => &[0, 90, 180, 270],
        Knowledge::Given | Knowledge::Measured => &[0],
    };
    let can_be_ground = |(_, surface): &(usize, &Evidence)| {
        attitude.knowledge != Knowledge::Measured || surface.normal.dot(attitude.up) > NEAR_GRAVITY
    };
    let rated = turns.iter().flat_map(|&turned_deg| {
        let up = turn(attitude.up, turned_deg);
        let weight = if turned_deg == 0 { 1.0 } else { TURNED_WEIGHT };
        evidence.iter().enumerate().filter(can_be_ground).map(move |(surface, leader)| {
            let votes = weight * facing(leader.normal, up) * together(evidence, leader);
            Choice { surface, turned_deg, is_clear: false, votes }
        })
    });
    rated.collect()
}

/// The one with most votes, of equal ones the first.
fn most_votes<'a>(choices: impl Iterator<Item = &'a Choice>) -> Option<&'a Choice> {
    choices.reduce(|most, choice| if choice.votes > most.votes { choice } else { most })
}

/// The votes of all surfaces that are parallel to one.
fn together(evidence: &[Evidence], leader: &Evidence) -> f64 {
    evidence.iter().filter(|other| leader.is_parallel_to(other)).map(|other| other.things).sum()
}

/// How plausible a normal is as up, from 0.05 to 1. It falls below 17 degrees above the camera's horizon, because a camera that looks
/// straight down sees the ground's normal on its horizon; and beyond a roll of 30 degrees.
fn facing(normal: DVec3, camera_up: DVec3) -> f64 {
    let pitch = (normal.dot(camera_up) + 0.2) / 0.5;
    let sideways = normal.dot(camera_up.cross(DVec3::Z).normalize_or_zero()).abs();
    let roll = (0.9 - sideways) / 0.4;
    pitch.clamp(0.05, 1.0).min(roll.clamp(0.05, 1.0))
}

/// The camera's up if the camera is turned clockwise about its optical axis by quarters.
fn turn(up: DVec3, degrees: u16) -> DVec3 {
    match degrees {
        90 => DVec3::new(up.y, -up.x, up.z),
        180 => DVec3::new(-up.x, -up.y, up.z),
        270 => DVec3::new(-up.y, up.x, up.z),
        _ => up,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: DVec3 = DVec3::new(0.0, -0.96, -0.28);
    const WALL: DVec3 = DVec3::new(0.0, 0.28, -0.96);

    fn level() -> Attitude {
        Attitude { up: DVec3::NEG_Y, knowledge: Knowledge::Assumed, earlier_up: None }
    }

    /// The ground among a floor and a wall with so many votes.
    fn ground(floor: f64, wall: f64, attitude: &Attitude) -> Option<Choice> {
        let evidence = [(FLOOR, floor), (WALL, wall)].map(|(normal, things)| Evidence { normal, things });
        choose_ground(&evidence, attitude)
    }

    #[test]
    fn a_ground_is_in_doubt_when_another_surface_has_votes_or_nothing_stands_on_a_wall() {
        let is_clear = |floor, wall| {
            let choice = ground(floor, wall, &level()).unwrap();
            (choice.surface, choice.is_clear)
        };
        assert_eq!(is_clear(3.2, 0.5), (0, true));
        assert_eq!(is_clear(0.3, 0.3), (0, true), "a wall does not lie as a ground would");
        assert!(!is_clear(3.0, 6.0).1);
        let alone = choose_ground(&[Evidence { normal: WALL, things: 0.9 }], &level()).unwrap();
        assert!(!alone.is_clear, "up comes from the camera's attitude alone");
        let empty = choose_ground(&[Evidence { normal: FLOOR, things: 0.6 }], &level()).unwrap();
        assert!(empty.is_clear);
        assert_eq!(choose_ground(&[], &level()), None);
    }

    #[test]
    fn measured_gravity_admits_only_surfaces_that_face_it() {
        let measured = |up: DVec3| Attitude { up, knowledge: Knowledge::Measured, ..level() };
        let choice = ground(0.1, 9.0, &measured(FLOOR)).unwrap();
        assert_eq!((choice.surface, choice.turned_deg, choice.is_clear), (0, 0, true));
        assert_eq!(ground(9.0, 0.1, &measured(WALL)).unwrap().surface, 1, "a camera that looks down");
        assert_eq!(ground(9.0, 9.0, &measured(DVec3::X)), None);
    }

    #[test]
    fn earlier_frames_decide_where_this_one_does_not() {
        let after = |up| Attitude { earlier_up: Some(up), ..level() };
        for (up, surface) in [(FLOOR, 0), (WALL, 1)] {
            let choice = ground(3.0, 6.0, &after(up)).unwrap();
            assert_eq!((choice.surface, choice.is_clear), (surface, true), "{up}");
        }
        // A frame that decides is believed, and a wall is no ground when up was elsewhere.
        assert_eq!(ground(4.0, 0.5, &after(WALL)).unwrap().surface, 0);
        assert_eq!(choose_ground(&[Evidence { normal: WALL, things: 0.9 }], &after(FLOOR)), None);
    }
}
