//! The choice of the ground among surfaces, by what stands on them and by what is known about the direction
//! up (docs/CONTEXT.md 1.1.4 to 1.1.7).

use glam::DVec3;

use crate::attitude::{Attitude, Knowledge};

/// Cosine of the angle between surfaces that are supports of one scene (15 degrees).
const PARALLEL: f64 = 0.966;
/// Cosine of the angle between a measured up and the ground (10 degrees).
const NEAR_GRAVITY: f64 = 0.985;
/// The plausibility of a normal as up falls from this far above the camera's horizon on (sine; 30 degrees)
/// ...
const PITCH_FROM: f64 = 0.5;
/// ... over this range, with its third power, because a camera that looks straight down sees the ground's
/// normal on its horizon, ...
const PITCH_OVER: f64 = 0.7;
/// ... but not below this, before the power is taken.
const LEAST_PITCH: f64 = 0.1;
/// A normal that lies farther to the side than this (sine; 64 degrees) is least plausible ...
const ROLL_END: f64 = 0.9;
/// ... and one that lies less far by this is fully plausible (sine; to 30 degrees).
const ROLL_OVER: f64 = 0.4;
/// Least plausibility of a normal that lies to the side.
const LEAST_ROLL: f64 = 0.05;
/// A surface whose normal lies less than this above the horizon (sine; 17 degrees) is seen from straight above, or is a wall.
pub(super) const FACED: f64 = 0.3;
/// A turned camera sees its ground at an angle: the normal is this far above its horizon (sine; 30 degrees).
const OBLIQUE: f64 = 0.5;
/// This far (sine; 14 degrees) is enough for a surface on which most things rest.
const SOMEWHAT_OBLIQUE: f64 = 0.25;
/// A normal that lies to the side of a turned camera by more than 45 degrees belongs to another turn: least
/// plausibility.
const OWN_TURN: f64 = 0.5;
/// A camera is taken for turned if at least this many things rest on the ground that it would then have, ...
const LEAST_RESTING: f64 = 2.0;
/// ... more than this many times the number on the ground of the upright camera, ...
const TURNED_TIMES: f64 = 2.0;
/// ... and if its votes, times this, exceed those of the upright ground;
const TURNED_WEIGHT: f64 = 0.4;
/// or if at least this share of all things rests on it, and none on the upright ground;
const HALF_SHARE: f64 = 0.5;
/// or if at least this share does, ...
const MOST_SHARE: f64 = 0.6;
/// ... and more than this many times the number on the upright ground.
const MOST_TIMES: f64 = 2.5;
/// A ground is in doubt if a surface of another direction has more than this share of its votes ...
const RIVAL_SHARE: f64 = 0.5;
/// ... or if at least this share as many things rest on a surface that would be the ground of a turned
/// camera.
const TURNED_RIVAL_SHARE: f64 = 0.34;

/// The evidence for a surface as a support.
pub(super) struct Evidence {
    pub(super) normal: DVec3,
    /// Things that touch it more than any other surface.
    pub(super) things: f64,
    /// Things that surely are things and end at the surface.
    pub(super) resting: f64,
    /// Its share of the image.
    pub(super) share: f64,
    /// Whether it may be the ground, apart from its votes.
    pub(super) may_be_ground: bool,
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
    /// Whether there is little evidence for another surface.
    pub(super) is_clear: bool,
}

/// Chooses the ground. `things`: the number of things that could rest on a surface. `None` without surfaces,
/// or if none agrees with what is known about up.
///
/// Parallel surfaces vote together. Their votes weigh less the farther their normal is from the camera's own
/// up, down to below the horizon. If the frame does not decide, the up of earlier frames does. O(surfaces²).
pub(super) fn choose_ground(evidence: &[Evidence], things: f64, attitude: &Attitude) -> Option<Choice> {
    let rate = |leader| Rated::new(evidence, leader, things, attitude);
    let rated: Vec<Rated> = (0..evidence.len()).map(rate).filter(|rated| rated.can_be_ground).collect();
    let upright = most(rated.iter(), |r| r.upright)?;
    let others =
        || rated.iter().filter(|other| !evidence[upright.surface].is_parallel_to(&evidence[other.surface]));
    let turned = most(others().filter(|other| other.is_turned_ground(upright)), |r| r.turned);
    let choice = match turned {
        Some(r) => Choice { surface: r.surface, turned_deg: r.turned_deg, is_clear: upright.resting < 1.0 },
        None => Choice {
            surface: upright.surface,
            turned_deg: upright.own_turn_deg(OBLIQUE),
            is_clear: upright.is_clear(others()),
        },
    };
    match attitude.earlier_up {
        // A camera is not turned between two frames.
        Some(up) if !choice.is_clear || choice.turned_deg != 0 => {
            let alike = rated.iter().filter(|r| evidence[r.surface].normal.dot(up) > PARALLEL);
            most(alike, |r| r.upright.max(TURNED_WEIGHT * r.turned)).map(|r| Choice {
                surface: r.surface,
                turned_deg: r.own_turn_deg(SOMEWHAT_OBLIQUE),
                is_clear: true,
            })
        }
        _ => Some(choice),
    }
}

/// The angle (degrees) between a measured up, which no surface faces, and the normal of the surface with most
/// votes.
pub(super) fn missed_gravity_deg(evidence: &[Evidence], attitude: &Attitude) -> Option<f32> {
    let rate = |leader| Rated::new(evidence, leader, 0.0, attitude);
    let rated: Vec<Rated> = (0..evidence.len()).map(rate).collect();
    if attitude.knowledge != Knowledge::Measured || rated.iter().any(|r| r.can_be_ground) {
        return None;
    }
    most(rated.iter(), |r| r.votes).map(|r| libm::acos(r.above.clamp(-1.0, 1.0)).to_degrees() as f32)
}

/// The one with the greatest number, of equal ones the first.
fn most<'a>(rated: impl Iterator<Item = &'a Rated>, number: impl Fn(&Rated) -> f64) -> Option<&'a Rated> {
    rated.reduce(|most, r| if number(r) > number(most) { r } else { most })
}

/// The evidence for a surface, with all parallel ones, as the ground.
struct Rated {
    surface: usize,
    /// Whether it agrees with a measured up (docs/CONTEXT.md 1.1.6).
    can_be_ground: bool,
    /// How far its normal is above the camera's horizon (sine).
    above: f64,
    /// The same for the turn (of a quarter, a half or three quarters) for which it is greatest; -1 if the
    /// camera cannot be turned.
    above_if_turned: f64,
    /// That turn.
    turned_deg: u16,
    /// Things that rest on it.
    resting: f64,
    /// The share of all things that rests on it.
    share_of_things: f64,
    /// Things that rest on it, and its share of the image.
    votes: f64,
    /// Votes, times how plausible its normal is as up.
    upright: f64,
    /// The same for the turned camera.
    turned: f64,
}

impl Rated {
    fn new(evidence: &[Evidence], surface: usize, things: f64, attitude: &Attitude) -> Self {
        let leader = &evidence[surface];
        let together = || evidence.iter().filter(|other| leader.is_parallel_to(other));
        let resting: f64 = together().map(|other| other.resting).sum();
        let votes = resting + together().map(|other| other.share).sum::<f64>();
        let (normal, up) = (leader.normal, attitude.up);
        let turns: &[u16] = if attitude.knowledge == Knowledge::Assumed { &[90, 180, 270] } else { &[] };
        let seen = turns.iter().map(|&degrees| (turn(up, degrees), degrees));
        let own = seen
            .filter(|&(up, _)| level(normal, up) >= OWN_TURN)
            .map(|(up, degrees)| (normal.dot(up), degrees));
        let (above_if_turned, turned_deg) =
            own.reduce(|most, other| if other.0 > most.0 { other } else { most }).unwrap_or((-1.0, 0));
        Self {
            surface,
            can_be_ground: leader.may_be_ground
                && (attitude.knowledge != Knowledge::Measured || normal.dot(up) > NEAR_GRAVITY),
            above: normal.dot(up),
            above_if_turned,
            turned_deg,
            resting,
            share_of_things: resting / things.max(1.0),
            votes,
            upright: votes * facing(normal, up),
            turned: if turned_deg == 0 { 0.0 } else { votes * facing(normal, turn(up, turned_deg)) },
        }
    }

    /// How far the camera is turned if this is the ground. 0 unless the ground is then seen at this angle
    /// (sine), and is hardly plausible upright.
    fn own_turn_deg(&self, least_above: f64) -> u16 {
        let is_turned = self.above_if_turned > least_above && TURNED_WEIGHT * self.turned > self.upright;
        if is_turned { self.turned_deg } else { 0 }
    }

    /// Whether this is the ground of a turned camera, rather than another surface the ground of an upright
    /// one (docs/CONTEXT.md 1.1.5).
    fn is_turned_ground(&self, upright: &Self) -> bool {
        let times = |k: f64| self.resting > k * upright.resting;
        let is_enough = self.resting >= LEAST_RESTING;
        let is_oblique = self.above_if_turned > OBLIQUE
            && times(TURNED_TIMES)
            && TURNED_WEIGHT * self.votes > upright.upright;
        let bears_most = (self.share_of_things >= HALF_SHARE && upright.resting < 1.0)
            || (self.share_of_things >= MOST_SHARE && times(MOST_TIMES));
        is_enough && (is_oblique || (self.above_if_turned > SOMEWHAT_OBLIQUE && bears_most))
    }

    /// Whether there is little evidence for other surfaces than this ground of an upright camera
    /// (docs/CONTEXT.md 1.1.7).
    fn is_clear<'a>(&self, mut others: impl Iterator<Item = &'a Self>) -> bool {
        let is_empty = self.resting < 1.0;
        // A wall, or a surface seen from straight above: a camera that faces a shelf sees its back like this.
        let is_faced = self.above < FACED;
        // Nothing stands on it, and it does not lie as a ground would.
        let is_guessed = self.votes < 1.0 && (is_faced || self.upright < RIVAL_SHARE * self.votes);
        let is_rival = |other: &Self| {
            let is_turned = other.above_if_turned > OBLIQUE;
            let bears = other.resting >= 1.0 && other.resting >= TURNED_RIVAL_SHARE * self.resting;
            let is_as_large = other.votes > RIVAL_SHARE * self.votes;
            other.upright > RIVAL_SHARE * self.upright
                || (is_empty && (other.resting >= LEAST_RESTING || (is_turned && is_as_large)))
                || (is_turned && (bears || (is_faced && self.share_of_things < MOST_SHARE)))
        };
        !is_guessed && !others.any(is_rival)
    }
}

/// How plausible a normal is as up, at most 1.
fn facing(normal: DVec3, up: DVec3) -> f64 {
    let pitch = ((normal.dot(up) - PITCH_FROM) / PITCH_OVER + 1.0).clamp(LEAST_PITCH, 1.0);
    (pitch * pitch * pitch).min(level(normal, up))
}

/// How little a normal lies to the side, from 0.05 to 1: it falls beyond a roll of 30 degrees.
fn level(normal: DVec3, up: DVec3) -> f64 {
    let sideways = normal.dot(up.cross(DVec3::Z).normalize_or_zero()).abs();
    ((ROLL_END - sideways) / ROLL_OVER).clamp(LEAST_ROLL, 1.0)
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
    /// The side of a shelf, or the floor of a camera that is turned.
    const SIDE: DVec3 = DVec3::new(-0.96, 0.0, -0.28);

    fn level() -> Attitude {
        Attitude { up: DVec3::NEG_Y, knowledge: Knowledge::Assumed, earlier_up: None }
    }

    /// The ground among surfaces on which so many of ten things rest; the part after the point is the share of the image.
    fn choose<const N: usize>(surfaces: [(DVec3, f64); N], attitude: &Attitude) -> Option<Choice> {
        let evidence = surfaces.map(|(normal, votes)| Evidence {
            normal,
            things: votes.trunc(),
            resting: votes.trunc(),
            share: votes.fract(),
            may_be_ground: true,
        });
        choose_ground(&evidence, 10.0, attitude)
    }

    fn ground(floor: f64, wall: f64, attitude: &Attitude) -> Option<Choice> {
        choose([(FLOOR, floor), (WALL, wall)], attitude)
    }

    #[test]
    fn the_back_of_a_shelf_is_no_ground_of_a_turned_camera() {
        // A camera that looks down on a shelf sees the back as one that hangs upside down would see a floor.
        for (board, back) in [(3.1, 2.6), (2.1, 4.6), (1.1, 4.6), (0.1, 2.6)] {
            let choice = ground(board, back, &level()).unwrap();
            assert_eq!((choice.surface, choice.turned_deg), (0, 0), "{board} {back}");
        }
        assert!(!ground(0.1, 2.6, &level()).unwrap().is_clear, "nothing rests on the board");
        assert!(ground(3.1, 2.6, &level()).unwrap().is_clear);
    }

    #[test]
    fn a_camera_is_turned_when_what_it_sees_at_an_angle_bears_the_things() {
        let turned = |surfaces| {
            let choice: Choice = choose(surfaces, &level()).unwrap();
            (choice.surface, choice.turned_deg)
        };
        assert_eq!(turned([(FLOOR, 0.2), (SIDE, 4.3)]), (1, 90));
        assert_eq!(turned([(FLOOR, 1.2), (SIDE, 4.3)]), (1, 90));
        assert_eq!(turned([(FLOOR, 2.2), (SIDE, 4.3)]), (0, 0), "two rest on the floor");
        assert_eq!(turned([(FLOOR, 0.2), (SIDE, 1.3)]), (0, 0), "one thing leans on the side");
        // A box with things, seen upside down: nearly all rests on the floor, at which the camera looks steeply.
        let bin = DVec3::new(0.0, 0.4, -0.917);
        assert_eq!(turned([(DVec3::NEG_Y, 0.1), (bin, 8.6)]), (1, 180));
        let given = Attitude { knowledge: Knowledge::Given, ..level() };
        assert_eq!(choose([(FLOOR, 0.2), (SIDE, 9.3)], &given).unwrap().turned_deg, 0);
    }

    #[test]
    fn a_ground_is_in_doubt_when_another_surface_has_votes_or_nothing_stands_on_a_wall() {
        let is_clear = |floor, wall| {
            let choice = ground(floor, wall, &level()).unwrap();
            (choice.surface, choice.is_clear)
        };
        assert_eq!(is_clear(3.2, 0.5), (0, true));
        assert_eq!(is_clear(0.3, 0.3), (0, true), "a wall does not lie as a ground would");
        let aside = |floor, side| choose([(FLOOR, floor), (SIDE, side)], &level()).unwrap().is_clear;
        assert!(aside(5.2, 1.3) && !aside(3.2, 2.3), "things rest on what is the ground of a turned camera");
        let alone = choose([(WALL, 0.9)], &level()).unwrap();
        assert!(!alone.is_clear, "up comes from the camera's attitude alone");
        assert!(choose([(FLOOR, 0.6)], &level()).unwrap().is_clear, "empty");
        let above = |side| choose([(DVec3::NEG_Z, 5.6), (SIDE, side)], &level()).unwrap();
        assert_eq!(
            (above(0.1).surface, above(0.1).is_clear),
            (0, false),
            "the back of a shelf and its side, or a box seen from above"
        );
        assert_eq!(choose([], &level()), None);
    }

    #[test]
    fn measured_gravity_admits_only_surfaces_that_face_it() {
        let measured = |up: DVec3| Attitude { up, knowledge: Knowledge::Measured, ..level() };
        let choice = ground(0.1, 9.0, &measured(FLOOR)).unwrap();
        assert_eq!((choice.surface, choice.turned_deg, choice.is_clear), (0, 0, true));
        assert_eq!(ground(9.0, 0.1, &measured(WALL)).unwrap().surface, 1, "a camera that looks down");
        assert_eq!(ground(9.0, 9.0, &measured(DVec3::X)), None);
        let missed = |up: DVec3| {
            let stand = |(normal, resting): (DVec3, f64)| Evidence {
                normal,
                things: resting,
                resting,
                share: 0.3,
                may_be_ground: true,
            };
            missed_gravity_deg(&[(FLOOR, 4.0), (WALL, 1.0)].map(stand), &measured(up))
        };
        assert_eq!(missed(FLOOR.normalize()), None);
        assert!((missed(-FLOOR.normalize()).unwrap() - 180.0).abs() < 1.0, "the sign is exchanged");
        assert!((missed(DVec3::X).unwrap() - 90.0).abs() < 1.0);
    }

    #[test]
    fn earlier_frames_decide_where_this_one_does_not() {
        let after = |up| Attitude { earlier_up: Some(up), ..level() };
        for (up, surface) in [(FLOOR, 0), (WALL, 1)] {
            let choice = ground(0.1, 4.6, &after(up)).unwrap();
            assert_eq!((choice.surface, choice.is_clear), (surface, true), "{up}");
        }
        // A frame that decides is believed, and a wall is no ground when up was elsewhere.
        assert_eq!(ground(4.0, 0.5, &after(WALL)).unwrap().surface, 0);
        assert_eq!(choose([(WALL, 0.9)], &after(FLOOR)), None);
    }
}
