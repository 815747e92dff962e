//! The method `context` on synthetic scenes of which the truth is known.
#![allow(clippy::unwrap_used, reason = "what fails is reported so")]

use objecthood::discovery::JoinEvidence;
use objecthood::{Camera, Discovery, Method, Notice, Params, Raster, discover};
use objecthood_scene::{Family, Rendered, Sensor, Viewpoint, World, generate, render};

fn default() -> Params {
    Params { method: Method::Context, ..Params::default() }
}

fn context(seen: &Rendered, params: &Params) -> Discovery {
    discover(&seen.frame, params).unwrap()
}

/// The same scene seen by a camera with these focal lengths in an image of this size.
fn seen_by(
    world: &World,
    [fx_px, fy_px]: [f64; 2],
    (width, height): (usize, usize),
    sensor: Sensor,
) -> Rendered {
    let camera = Camera { fx_px, fy_px, cx_px: width as f64 / 2.0 - 0.5, cy_px: height as f64 / 2.0 - 0.5 };
    let viewpoint = Viewpoint { camera, size_px: (width, height), pose: world.viewpoint().pose };
    render(&world.with_viewpoint(viewpoint).unwrap(), sensor).unwrap()
}

/// The best intersection over union of any found object with every object that is seen.
fn overlaps(world: &World, truth: &Raster<u16>, found: &Discovery) -> Vec<(u16, f64)> {
    let count = |test: &dyn Fn(u16, u16) -> bool| {
        truth.as_slice().iter().zip(found.labels.as_slice()).filter(|(t, l)| test(**t, **l)).count() as f64
    };
    let seen = world.objects().filter(|&k| count(&|t, _| t == k) > 0.0);
    let best = |k: u16| {
        let iou = |id: u16| count(&|t, l| t == k && l == id) / count(&|t, l| t == k || l == id);
        found.objects.iter().map(|object| iou(object.id.0)).fold(0.0, f64::max)
    };
    seen.map(|k| (k, best(k))).collect()
}

/// Worlds in which nothing is at the edge of a decision: things of all kinds, some hidden, some vessels.
fn worlds() -> [World; 3] {
    [(Family::Tabletop, 6), (Family::Occluded, 3), (Family::Vessels, 2)]
        .map(|(family, seed)| generate(family, seed))
}

/// Parameters in pixels hold at a focal length of 525 px and scale with it.
#[test]
fn the_same_scene_gives_the_same_objects_in_any_resolution() {
    for world in worlds() {
        let half = ([262.5; 2], (320, 240));
        let same = ([525.0; 2], (640, 480));
        let double = ([1050.0; 2], (1280, 960));
        let oblong = ([600.0, 450.0], (732, 412));
        let mut counts = Vec::new();
        for (focal_px, size_px) in [half, same, double, oblong] {
            let seen = seen_by(&world, focal_px, size_px, Sensor::Ideal);
            let found = context(&seen, &default());
            for (object, iou) in overlaps(&world, &seen.truth.instance, &found) {
                assert!(iou > 0.95, "{} {object}: {iou} at {focal_px:?}", world.seed());
            }
            counts.push((found.objects.len(), found.structure_planes.len()));
        }
        assert!(counts.iter().all(|count| *count == counts[0]), "{counts:?}");
    }
}

#[test]
fn a_vessel_is_one_object_of_inside_and_wall() {
    let world = generate(Family::Vessels, 2);
    let seen = render(&world, Sensor::Ideal).unwrap();
    let found = context(&seen, &default());
    let vessels = overlaps(&world, &seen.truth.instance, &found);
    let kinds: Vec<_> = vessels.iter().map(|(k, _)| world.solid(*k).unwrap().kind()).collect();
    assert_eq!(kinds, ["bowl", "cup", "mug", "bowl", "cup"]);
    assert_eq!(found.objects.len(), vessels.len());
    assert!(vessels.iter().all(|(_, iou)| *iou > 0.95), "{vessels:?}");
    for object in &found.objects {
        let walls =
            object.joins.iter().filter(|join| matches!(join.evidence, JoinEvidence::VesselWall { .. }));
        assert_eq!(walls.count(), 1, "{object:?}");
    }

    // Without the rules for vessels inside and wall are two.
    let mut params = default();
    params.vessels.concavity = 0.0;
    params.necks.enabled = false;
    let parted = context(&seen, &params);
    assert!(parted.objects.len() >= 2 * vessels.len(), "{}", parted.objects.len());
    assert!(parted.objects.iter().all(|object| object.joins.is_empty()));
}

/// The same scene by a camera that is rolled clockwise.
fn rolled(world: &World, roll_deg: f64) -> Rendered {
    let Viewpoint { camera, size_px, pose } = *world.viewpoint();
    let pose = pose.turned(2, roll_deg);
    render(&world.with_viewpoint(Viewpoint { camera, size_px, pose }).unwrap(), Sensor::Ideal).unwrap()
}

#[test]
fn a_rolled_camera_sees_the_same_objects_on_the_same_table() {
    let world = generate(Family::Tabletop, 1);
    // The camera's up in its own frame, from the truth.
    let up_of = |roll_deg: f64| {
        let params = objecthood::params::Gravity { roll_deg, ..Default::default() };
        params.camera_up()
    };
    let level = context(&rolled(&world, 0.0), &default());
    for roll_deg in [180.0, 90.0, -90.0] {
        let seen = rolled(&world, roll_deg);
        let mut params = default();
        params.gravity.roll_deg = roll_deg;
        let found = context(&seen, &params);
        let dot = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
        assert!(dot(found.up.direction, up_of(roll_deg)) > 0.3, "{roll_deg}: {:?}", found.up);
        // As high as before: the table is what they stand on, and not a wall or the floor.
        assert_eq!(found.objects.len(), level.objects.len(), "{roll_deg}");
        for (object, iou) in overlaps(&world, &seen.truth.instance, &found) {
            assert!(iou > 0.95, "{roll_deg} {object}: {iou}");
        }
        let mut unaware = default();
        unaware.gravity.up_from = objecthood::params::UpFrom::Camera;
        let up = context(&seen, &unaware).up.direction;
        assert_eq!(up, [0.0, -1.0, 0.0], "{roll_deg}: held to be level");
    }
}

#[test]
fn upside_down_the_table_is_found_when_that_is_given_and_else_doubted() {
    // From where the room's wall fills more of the image than the table.
    let world = generate(Family::Single, 3);
    let mut viewpoint = *world.viewpoint();
    viewpoint.pose = objecthood_scene::Pose::looking_at([0.0, -1.1, 1.25], [0.0, 0.3, 0.95]).turned(2, 180.0);
    let seen = render(&world.with_viewpoint(viewpoint).unwrap(), Sensor::Ideal).unwrap();
    let with_roll = |roll_deg: f64| {
        let mut params = default();
        params.gravity.roll_deg = roll_deg;
        context(&seen, &params)
    };
    // Upside down the camera's y points up.
    let (given, found) = (with_roll(180.0), with_roll(0.0));
    assert!(given.up.direction[1] > 0.8, "{:?}", given.up);
    assert!(given.notices.is_empty(), "{:?}", given.notices);
    // One thing stands on the table, and the wall is large: whatever was found is in doubt, and that is said.
    assert!(matches!(found.notices[..], [.., Notice::GroundInDoubt { .. }]), "{:?}", found.notices);
}

/// Phones smooth their depth; the flying pixels of time of flight are no ramps.
#[test]
fn smeared_edges_are_recognised_by_sensor_and_become_steps() {
    let smeared = |sensor: Sensor| {
        worlds().map(|world| {
            let seen = render(&world, sensor).unwrap();
            let found = context(&seen, &default());
            found.notices.iter().any(|notice| matches!(notice, Notice::Smeared { .. }))
        })
    };
    assert_eq!([Sensor::Ideal, Sensor::Kinect, Sensor::Tof].map(smeared), [[false; 3]; 3]);
    assert_eq!(smeared(Sensor::Phone), [true; 3]);

    // Most things come out with their outlines.
    let world = generate(Family::Tabletop, 6);
    let seen = render(&world, Sensor::Phone).unwrap();
    let overlaps = overlaps(&world, &seen.truth.instance, &context(&seen, &default()));
    let good = overlaps.iter().filter(|(_, iou)| *iou > 0.8).count();
    assert!(2 * good > overlaps.len(), "{overlaps:?}");
}
