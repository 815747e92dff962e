//! Up and the ground, as `context` tells them from a frame alone, in scenes whose wall, shelf or bin is larger than the ground.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "what fails and what was measured is reported so"
)]

use std::collections::BTreeMap;

use glam::{DQuat, DVec3, Vec3};
use objecthood::{Discovery, Notice, Params, discover};
use objecthood_scene::{Exposure, Family, Holes, Rendered, Role, Sensor, Viewpoint, World, generate};
use rayon::prelude::*;

const FAMILIES: [Family; 3] = [Family::Room, Family::Shelf, Family::Bin];
/// The first of other scenes than those on which the rules were made.
const FIRST_SEED: u64 = 2000;
/// Up is right within this angle (degrees).
const RIGHT_DEG: f64 = 5.0;
/// Points of one level face are no farther from each other in height (m).
const LEVEL_M: f64 = 0.002;
/// Two level faces this near are one to a camera of this kind (m): three quanta of a Kinect at 1 m.
const NEAR_M: f64 = 0.01;
/// What touches a level face from above is pushed upwards: the least height of a unit normal.
const UPWARDS: f64 = 0.999;

/// What was found in a scene.
struct Seen {
    found: Discovery,
    /// Error of up (degrees).
    error_deg: f64,
    ground: Option<Ground>,
}

/// What the plane shows that was taken for the ground.
struct Ground {
    /// The kind of most of its pixels.
    kind: &'static str,
    /// The share of its pixels that show the floor, or the board on which most objects stand.
    true_share: f64,
    /// The least distance from it of a place at which an object stands on that board (m); infinite where no board carries objects.
    distance_m: f64,
}

impl Ground {
    /// Whether most of its pixels show the floor or that board.
    fn is_shown(&self) -> bool {
        self.true_share > 0.5
    }

    /// Whether it is shown, or lies so near to that board that a frame cannot tell them apart: the table under a bin of sheet metal.
    fn is_level_with(&self) -> bool {
        self.is_shown() || self.distance_m < NEAR_M
    }
}

/// A level face of a solid: instance and height (m).
type Face = (u16, f64);

fn is_same(a: Face, b: Face) -> bool {
    a.0 == b.0 && (a.1 - b.1).abs() < LEVEL_M
}

/// What was found in the scene by a camera that is turned clockwise about its axis.
fn seen(world: &World, roll_deg: f64) -> Seen {
    let Viewpoint { camera, size_px, pose } = *world.viewpoint();
    let pose = pose.turned(2, roll_deg);
    let rolled = world.with_viewpoint(Viewpoint { camera, size_px, pose }).unwrap();
    let exposure = Exposure::of(&rolled).unwrap();
    let by = |sensor| exposure.seen_by(sensor, Holes::None).unwrap();
    let found = discover(&by(Sensor::Kinect).frame, &Params::default()).unwrap();
    let up = DQuat::from_array(pose.rotation_xyzw()).inverse() * DVec3::Z;
    let error_deg = up.angle_between(Vec3::from(found.up.direction).as_dvec3()).to_degrees();
    let ground = ground_of(&found, &rolled, &by(Sensor::Ideal));
    Seen { found, error_deg, ground }
}

/// The plane whose normal up is: that which was taken for the ground. `exact`: the same picture without noise.
fn ground_of(found: &Discovery, world: &World, exact: &Rendered) -> Option<Ground> {
    let named = found.structure_planes.iter().position(|plane| plane.normal == found.up.direction)?;
    let (boards, places) = fullest_boards(world, exact);
    let Viewpoint { camera, size_px: (width, _), pose } = *world.viewpoint();
    let into_camera = DQuat::from_array(pose.rotation_xyzw()).inverse();
    let up = into_camera * DVec3::Z;
    let (mut all, mut right, mut kinds) = (0, 0, BTreeMap::<_, usize>::new());
    let pixels = found.structure.as_slice().iter().enumerate();
    for (i, _) in pixels.filter(|(_, label)| usize::from(**label) == named + 1) {
        let point = camera.back_project(i % width, i / width, exact.frame.depth_m()[i]);
        let height_m = up.dot(Vec3::from(point).as_dvec3()) + pose.origin_m()[2];
        let instance = exact.truth.instance[i];
        let Some(solid) = world.solid(instance) else { continue };
        let is_floor = solid.role() == Role::Room && height_m.abs() < LEVEL_M;
        right += usize::from(is_floor || boards.iter().any(|&board| is_same(board, (instance, height_m))));
        all += 1;
        *kinds.entry(solid.kind()).or_default() += 1;
    }
    let (kind, _) = kinds.into_iter().max_by_key(|&(_, pixels)| pixels)?;
    let plane = found.structure_planes[named];
    let distances = places.iter().map(|place| {
        let point = into_camera * (DVec3::from(*place) - DVec3::from(pose.origin_m()));
        (Vec3::from(plane.normal).as_dvec3().dot(point) + f64::from(plane.offset_m)).abs()
    });
    let distance_m = distances.fold(f64::INFINITY, f64::min);
    Some(Ground { kind, true_share: right as f64 / all as f64, distance_m })
}

/// The level faces of what is no object on which most of the objects in the picture stand, several with equally many; and a place (m)
/// of each object on them.
fn fullest_boards(world: &World, exact: &Rendered) -> (Vec<Face>, Vec<[f64; 3]>) {
    let is_object = |instance: u16| world.objects().any(|object| object == instance);
    let mut boards: Vec<(Face, Vec<[f64; 3]>)> = Vec::new();
    for contact in world.contacts() {
        let is_seen = exact.visible_fraction[usize::from(contact.upper) - 1] > 0.0;
        if is_object(contact.lower) || !is_seen || contact.normal[2] < UPWARDS {
            continue;
        }
        let face = (contact.lower, contact.point_m[2]);
        match boards.iter_mut().find(|(board, _)| is_same(*board, face)) {
            Some((_, places)) => places.push(contact.point_m),
            None => boards.push((face, vec![contact.point_m])),
        }
    }
    let most = boards.iter().map(|(_, places)| places.len()).max();
    boards.retain(|(_, places)| Some(places.len()) == most);
    let (faces, places): (Vec<_>, Vec<_>) = boards.into_iter().unzip();
    (faces, places.concat())
}

fn is_told(found: &Discovery) -> bool {
    let told = |notice: &Notice| matches!(notice, Notice::Turned { .. } | Notice::GroundInDoubt { .. });
    found.notices.iter().any(told)
}

/// Of each family as many scenes as `OBJECTHOOD_MANY` says, or so few that the test is quick. Up has to be right in 49 of 50 frames (all but one of fewer), and
/// right or announced in as many that are turned by 90 degrees. Of those turned by 180 degrees one in ten may fail: a few bins and shelves do. In every
/// room, and in a third of all frames at least, most of the plane that is taken for the ground is the floor or the board on which most objects stand. In three of
/// four it is that or lies within 1 cm of the board, as the table under a bin does.
#[test]
fn up_is_right_where_walls_shelves_and_bins_are_larger_than_the_ground() {
    let scenes: u64 = std::env::var("OBJECTHOOD_MANY").map_or(4, |text| text.parse().unwrap());
    let mut worlds: Vec<(Family, u64)> = Vec::new();
    for family in FAMILIES {
        worlds.extend((FIRST_SEED..FIRST_SEED + scenes).map(|seed| (family, seed)));
    }
    let all = worlds.len();
    let rows: Vec<[bool; 8]> = worlds
        .into_par_iter()
        .map(|(family, seed)| {
            let world = generate(family, seed);
            let upright = seen(&world, 0.0);
            let turned = |roll_deg: f64| {
                let Seen { found, error_deg, .. } = seen(&world, roll_deg);
                if error_deg > RIGHT_DEG {
                    println!(
                        "{family:?} {seed} turned by {roll_deg}: {error_deg:.1} degrees, {:?}",
                        found.notices
                    );
                }
                error_deg <= RIGHT_DEG || is_told(&found)
            };
            let Seen { found, error_deg, ground } = &upright;
            let is_right = *error_deg <= RIGHT_DEG;
            let is_ground = ground.as_ref().is_some_and(Ground::is_shown);
            if !is_right || is_told(found) || !is_ground {
                let ground = ground.as_ref().map(|Ground { kind, true_share, distance_m }| {
                    format!("{kind}, {true_share:.2} true, {distance_m:.3} m")
                });
                println!("{family:?} {seed}: {error_deg:.1} degrees, ground {ground:?}, {:?}", found.notices);
            }
            let is_floor = is_ground && family == Family::Room;
            [
                is_right,
                is_told(found),
                turned(90.0),
                turned(180.0),
                is_ground,
                is_right && is_ground,
                is_floor,
                is_right && ground.as_ref().is_some_and(Ground::is_level_with),
            ]
        })
        .collect();
    let count = |column: usize| rows.iter().filter(|row| row[column]).count();
    let [right, doubted, quarter, half, grounds, both, floors, level] = [0, 1, 2, 3, 4, 5, 6, 7].map(count);
    println!(
        "{all} frames: up is right in {right}, doubted in {doubted}; turned by 90 and 180 degrees right or announced in {quarter} and {half}"
    );
    println!("the ground is the floor or the fullest board in {grounds}, and up is right too in {both}");
    println!("it is that, or within 1 cm of the board, in {level}");
    let [few, more] = [all / 50, all / 10].map(|share| share.max(1));
    assert!(right + few >= all && quarter + few >= all && half + more >= all);
    assert!(floors as u64 == scenes && 3 * grounds >= all && 4 * level >= 3 * all);
}
