use glam::DVec3;

use super::surface::BEYOND_M;
use super::*;
use crate::attitude::Knowledge;
use crate::frame::Frame;
use crate::noise::{KINECT_QUANTA, Noise};
use crate::random::Lcg;
use crate::surface::bands::Bands;
use crate::surface::disparity::{DisparitySpace, position};
use crate::surface::plane_fit::fit_planes;
use crate::surface::window_choice::choose_windows;
use crate::testing::space;

const SIZE: (usize, usize) = (320, 240);

/// A camera at half the resolution of a Kinect.
fn half() -> DisparitySpace {
    space([262.5, 262.5], [159.5, 119.5])
}

/// The structure of a frame with these depths (m), rounded to whole quanta as by a Kinect.
fn seen(depth_m: impl Fn(usize) -> f64) -> Structure {
    seen_with(&params::Structure::default(), depth_m)
}

fn seen_with(params: &params::Structure, depth_m: impl Fn(usize) -> f64) -> Structure {
    let space = half();
    let quantised = |i: usize| {
        let depth = Raster::filled(1, 1, depth_m(i) as f32).unwrap();
        space.depth_m(f64::from(space.disparity(&depth)[0]).round()) as f32
    };
    let depth = Raster::from_vec(SIZE.0, SIZE.1, (0..SIZE.0 * SIZE.1).map(quantised).collect()).unwrap();
    let disparity = space.disparity(&depth);
    let fits = fit_planes(&disparity, 2);
    let orientation = choose_windows(&disparity, &fits, &space, &params::LocalFit::default());
    let frame = Frame::new(Raster::filled(SIZE.0, SIZE.1, 1.0).unwrap(), None, space.camera()).unwrap();
    let (bridged_share, sharpened_share, noise_frames) = (0.0, 0.0, 0);
    let surfaces = Surfaces {
        frame,
        space,
        lab: None,
        disparity,
        bands: Bands::default(),
        bridged_share,
        sharpened_share,
        noise_frames,
        color: params::ColorFor::All,
        fits,
        orientation,
    };
    let level = Attitude { up: DVec3::NEG_Y, knowledge: Knowledge::Assumed, earlier_up: None };
    find_structure(&depth, &surfaces, &level, params)
}

/// The depth of the plane normal · X = -offset along the ray of a pixel.
fn plane(i: usize, normal: DVec3, offset_m: f64) -> f64 {
    let [u, v] = position(i, SIZE.0);
    -offset_m / normal.dot(DVec3::from(half().camera().ray(u, v)))
}

/// A table 0.6 m below a camera that looks down by 37 degrees, and a wall behind it.
fn table_normal() -> DVec3 {
    DVec3::new(0.0, -0.8, -0.6)
}

const WALL: DVec3 = DVec3::new(0.0, 0.6, -0.8);

fn table_and_wall(i: usize) -> f64 {
    let positive = |z: f64| if z > 0.0 { z } else { f64::INFINITY };
    positive(plane(i, table_normal(), 0.6)).min(positive(plane(i, WALL, 1.0)))
}

#[test]
fn a_table_and_a_wall_are_found() {
    let found = seen(table_and_wall);
    let [first, second] = &found.surfaces[..] else { panic!("two surfaces: {:?}", found.surfaces) };
    let is_table = |s: &StructureSurface| s.normal.dot(table_normal()) > 0.9;
    let (table, wall) = if is_table(first) { (first, second) } else { (second, first) };
    assert!(table.normal.dot(table_normal()) > 0.999 && (table.offset_m - 0.6).abs() < 0.01, "{table:?}");
    assert!(wall.normal.dot(WALL) > 0.999 && (wall.offset_m - 1.0).abs() < 0.02, "{wall:?}");
    assert_eq!(found.supports.surfaces, [usize::from(!is_table(first))], "the table faces up");
    let labelled = found.labels.as_slice().iter().filter(|&&label| label >= 0).count();
    assert!(labelled as f64 > 0.97 * found.labels.len() as f64, "{labelled}");
    let top = found.labels[SIZE.0 / 2];
    assert!(std::ptr::eq(&found.surfaces[top as usize], wall), "the wall is above the table");
}

/// A regression: a wall 3 m away broke into pieces, because noise as wide as a window makes waves of 12 mm.
#[test]
fn a_far_wall_is_one_surface() {
    let quantum_per_m = params::Sensor::default().disparity_quantum_per_m;
    let waves = |i: usize| {
        let [u, v] = position(i, SIZE.0);
        1.0 / (1.0 / 3.0 + 0.5 * quantum_per_m * (libm::sin(0.9 * u) + libm::cos(0.8 * v)))
    };
    let share_on_it = |params| {
        let found = seen_with(&params, waves);
        let on_it = found.labels.as_slice().iter().filter(|&&label| label == 0).count();
        on_it as f64 / found.labels.len() as f64
    };
    let by_normals_alone = params::Structure { slope_quanta_per_px: 0.0, ..Default::default() };
    let (with_slopes, without) = (share_on_it(params::Structure::default()), share_on_it(by_normals_alone));
    assert!(with_slopes > 0.95 && without < 0.8, "{with_slopes} {without}");
}

/// A regression: tops of boxes as high as a shelf were taken for one large plane, and the boxes were lost.
#[test]
fn what_does_not_hang_together_is_no_surface() {
    let [floor_m, tops_m] = [2.0, 1.7];
    let columns = |i: usize, least: usize| (i % SIZE.0 % 80) >= least && (60..180).contains(&(i / SIZE.0));
    let level = |least: usize| move |i: usize| if columns(i, least) { tops_m } else { floor_m };
    let apart = seen(level(50));
    let touching = seen(level(0));
    let on_top = |found: &Structure| found.labels.as_slice().iter().filter(|&&label| label == 1).count();
    assert_eq!(apart.surfaces.len(), 1, "four tops of 0.19 m by 0.78 m: {:?}", apart.surfaces);
    assert_eq!((touching.surfaces.len(), on_top(&touching) > 30_000), (2, true), "one shelf");
}

/// A regression: the tops of cartons in a room were a part of the cupboard that is as high, and the cartons were lost.
#[test]
fn what_is_as_high_as_a_table_is_no_part_of_it() {
    let [floor_m, tops_m, tower_m] = [2.0, 1.7, 1.4];
    let within = |i: usize, columns: std::ops::Range<usize>, rows: std::ops::Range<usize>| {
        columns.contains(&(i % SIZE.0)) && rows.contains(&(i / SIZE.0))
    };
    let is_carton = |i: usize| within(i, 240..280, 90..140);
    let room = |has_tower: bool| {
        seen(move |i| {
            if has_tower && within(i, 140..250, 100..130) {
                tower_m
            } else if is_carton(i) || within(i, 10..150, 20..220) {
                tops_m
            } else {
                floor_m
            }
        })
    };
    let on_structure = |found: &Structure, i: usize| found.labels[i] >= 0;
    let (carton, table) = (95 * SIZE.0 + 270, 60 * SIZE.0 + 80);
    let apart = room(false);
    assert!(on_structure(&apart, table) && !on_structure(&apart, carton), "the floor is seen between them");
    assert!(on_structure(&room(true), carton), "one table, with a tower on it");
}

/// A regression: what stood on a table far from a cupboard, as far away as its front, was a part of the cupboard: below the front nothing
/// farther than it is seen, because there it would be below the floor.
#[test]
fn no_way_leads_through_what_is_below_the_floor() {
    let [front_m, wall_m] = [1.6, 3.0];
    let floor = |i: usize| {
        let z = plane(i, DVec3::NEG_Y, 0.5);
        if z > 0.0 { z } else { f64::INFINITY }
    };
    let within = |i: usize, columns: std::ops::Range<usize>, rows: std::ops::Range<usize>| {
        columns.contains(&(i % SIZE.0)) && rows.contains(&(i / SIZE.0))
    };
    let found = seen(|i| {
        // A table in front, from above the foot of the cupboard down to the border of the image.
        let is_table = within(i, 180..310, 170..240);
        let (is_front, is_thing) = (within(i, 5..130, 10..220), within(i, 230..260, 140..170));
        let behind = floor(i).min(wall_m);
        if is_table {
            behind.min(1.2)
        } else if is_front || is_thing {
            behind.min(front_m)
        } else {
            behind
        }
    });
    let [front, thing] = [100 * SIZE.0 + 60, 150 * SIZE.0 + 245].map(|i| found.labels[i]);
    assert!(front >= 0 && thing != front, "{front} {thing}");
}

/// A regression: a plane through the steps of furniture counted their distances from it as its noise, and so took in ever more of them.
#[test]
fn the_spread_of_what_lies_otherwise_is_no_noise() {
    let waves = |i: usize| {
        let [u, v] = position(i, SIZE.0);
        0.004 * (libm::sin(0.2 * u) + libm::cos(0.17 * v))
    };
    let floor = |i: usize| plane(i, table_normal(), 1.2);
    // Treads and risers of 12 cm: their edges lie on the plane of a ramp.
    let stairs = |i: usize| {
        let depths = (-20..20).flat_map(|step| {
            let [up_m, away_m] = [0.12, 0.09].map(|side_m| side_m * f64::from(step));
            let [tread, riser] = [plane(i, DVec3::NEG_Y, 0.9 - up_m), 1.4 + away_m];
            let v = (position(i, SIZE.0)[1] - 119.5) / 262.5;
            let on_tread =
                (tread > 0.0 && (1.4 + away_m - 0.09..1.4 + away_m).contains(&tread)).then_some(tread);
            let on_riser = (0.9 - up_m - 0.12..0.9 - up_m).contains(&(v * riser)).then_some(riser);
            [on_tread, on_riser]
        });
        depths.flatten().fold(5.0, f64::min)
    };
    let widest = |depth_m: &dyn Fn(usize) -> f64| {
        let waves = Noise { white: 1.0, blocks_quanta: KINECT_QUANTA.map(|quanta| 3.0 * quanta) };
        let space = half().with_noise(waves);
        let seen = (0..SIZE.0 * SIZE.1).map(|i| depth_m(i) as f32).collect();
        let depth = Raster::from_vec(SIZE.0, SIZE.1, seen).unwrap();
        let disparity = space.disparity(&depth);
        let fits = fit_planes(&disparity, 2);
        let orientation = choose_windows(&disparity, &fits, &space, &params::LocalFit::default());
        let alike =
            Alike { least_cosine: cosine(30.0), slope_squared: least_square(space.slope_per_px(0.4)) };
        let view = View { disparity: &disparity, orientation: &orientation, space: &space, grid: 3, alike };
        let found = view.find_candidates(view.sample(&fits));
        found.iter().map(|candidate| candidate.surface.scale).fold(0.0, f64::max)
    };
    let wavy = |i: usize| floor(i) + waves(i) * floor(i) * floor(i);
    assert_eq!([widest(&floor), widest(&stairs)], [1.0, 1.0]);
    assert!(widest(&wavy) > 1.4, "waves of a floor are noise");
}

/// A regression: a surface leant towards small things beside it that lay on one plane with it by chance.
#[test]
fn the_largest_piece_tells_which_surface_is_meant() {
    let quantum_per_m = params::Sensor::default().disparity_quantum_per_m;
    let at_quanta = |quanta: f64| 1.0 / (quanta * quantum_per_m);
    let [far, table] = [150.0, 200.0];
    let found = seen(|i| {
        let [u, v] = [i % SIZE.0, i / SIZE.0];
        let is_thing = (200..310).contains(&u) && (20..220).contains(&v) && u % 28 < 20 && v % 28 < 20;
        let is_table = (10..130).contains(&u) && (20..220).contains(&v);
        // The things beside the table are four quanta higher.
        at_quanta(if is_table {
            table
        } else if is_thing {
            table + 4.0
        } else {
            far
        })
    });
    let facing = found.surfaces.iter().map(|surface| surface.normal.dot(DVec3::NEG_Z));
    assert_eq!(
        facing.clone().filter(|&cosine| cosine > 0.999_99).count(),
        2,
        "{:?}",
        facing.collect::<Vec<_>>()
    );
}

#[test]
fn heights_are_above_the_surface_it_is_supported_by() {
    let found = seen(|i| plane(i, table_normal(), 0.6));
    let (space, table) = (half(), &found.surfaces[found.supports.surfaces[0]]);
    for i in [20_000, 40_000, 60_000] {
        for height_m in [0.0, 0.02, 0.1] {
            let z = plane(i, table_normal(), 0.6 - height_m);
            let d = 1.0 / (z * params::Sensor::default().disparity_quantum_per_m);
            let got = table.height_m(position(i, SIZE.0), d, &space);
            assert!((got - height_m).abs() < 0.003, "{got} {height_m}");
        }
    }
    let horizon = [160.0, -1e4];
    assert_eq!(table.height_m(horizon, 300.0, &space), BEYOND_M);
}

/// The depth of the nearer of two surfaces that are seen.
fn nearer(a: f64, b: f64) -> f64 {
    let positive = |z: f64| if z > 0.0 { z } else { f64::INFINITY };
    positive(a).min(positive(b))
}

/// A regression: a far wall was the ground because it is larger, and nothing spoke against objects many metres above it.
#[test]
fn the_ground_is_what_things_stand_on_however_large_the_wall() {
    // A wall that fills most of the image, a floor below it, and two posts of 20 cm on the floor.
    let (floor, wall) = (DVec3::new(0.0, -0.97, -0.24), DVec3::new(0.0, 0.24, -0.97));
    let empty = |i: usize| nearer(plane(i, floor, 1.0), plane(i, wall, 2.4));
    let post = |i: usize| {
        let [u, v] = position(i, SIZE.0);
        ([80.0, 200.0].iter().any(|left| (0.0..25.0).contains(&(u - left))) && (175.0..215.0).contains(&v))
            .then(|| plane(i, wall, 1.55))
    };
    let found = seen(|i| post(i).unwrap_or(empty(i)));
    let of_wall = found.labels.as_slice().iter().filter(|&&label| label == 0).count();
    assert!(of_wall > found.labels.len() / 2, "{of_wall}");
    let ground = &found.surfaces[found.supports.surfaces[0]];
    assert!(ground.normal.dot(floor) > 0.99, "{ground:?}");
    assert_eq!(found.supports.turned_deg, 0);
}

#[test]
fn a_camera_may_be_turned_by_quarters() {
    // A floor that lies right of, above or left of the image, with a box on it, and a wall.
    for (turned_deg, floor, lift) in [
        (90, DVec3::new(-0.95, 0.0, -0.31), [-1.0, 0.0]),
        (180, DVec3::new(0.0, 0.8, -0.6), [0.0, 1.0]),
        (270, DVec3::new(0.95, 0.0, -0.31), [1.0, 0.0]),
    ] {
        let on_box = |i: usize| {
            let [u, v] = position(i, SIZE.0);
            let (across, along) =
                if lift[0] == 0.0 { (u - 160.0, v - 120.0) } else { (v - 120.0, u - 160.0) };
            across.abs() < 20.0 && along.abs() < 20.0
        };
        let found = seen(|i| plane(i, floor, if on_box(i) { 0.5 } else { 0.6 }));
        assert_eq!(found.supports.turned_deg, turned_deg);
        assert!(found.surfaces[found.supports.surfaces[0]].normal.dot(floor) > 0.99);
    }
}

/// A shelf of two boards: both are supports, and a box on the upper one is measured from there.
#[test]
fn boards_that_are_parallel_are_supports() {
    let normal = table_normal();
    let is_upper = |i: usize| i / SIZE.0 < 110;
    let found = seen(|i| plane(i, normal, if is_upper(i) { 0.6 } else { 0.95 }));
    assert_eq!(found.surfaces.len(), 2, "{:?}", found.surfaces);
    let mut supports = found.supports.surfaces;
    supports.sort_unstable();
    assert_eq!(supports, [0, 1]);
}

/// A regression: an empty board with more votes than the floor was taken for the ground, then left out, and there was none at all.
#[test]
fn an_empty_board_is_no_ground() {
    let board = DVec3::new(0.0, -0.95, -0.31).normalize();
    let found = seen(|i| match i / SIZE.0 {
        0..105 => plane(i, WALL, 1.0),
        105..145 => plane(i, table_normal(), 1.0),
        _ => plane(i, board, 0.22),
    });
    let [ground] = found.supports.surfaces[..] else { panic!("{:?}", found.supports) };
    assert!(found.surfaces[ground].normal.dot(table_normal()) > 0.99, "{:?}", found.surfaces);
}

#[test]
fn nothing_is_found_in_nothing_and_in_noise() {
    let nothing = seen(|_| f64::NAN);
    assert!(nothing.surfaces.is_empty() && nothing.supports == Supports::default());
    assert!(nothing.labels.as_slice().iter().all(|&label| label == -1));
    let mut random = Lcg::new(5);
    let noise: Vec<f64> = (0..SIZE.0 * SIZE.1).map(|_| 0.5 + random.below(1000) as f64 / 500.0).collect();
    let found = seen(|i| noise[i]);
    assert!(found.surfaces.is_empty(), "{:?}", found.surfaces);
    // A plate of 10 cm is no structure.
    let plate = |i: usize| (i % SIZE.0).abs_diff(160) < 15 && (i / SIZE.0).abs_diff(120) < 15;
    assert!(seen(|i| if plate(i) { 1.0 } else { noise[i] }).surfaces.is_empty());
}

#[test]
fn a_pixel_without_a_normal_may_lie_on_a_surface() {
    // A single pixel in a hole of 9 x 9 pixels, larger than a window.
    let far = |i: usize| (i % SIZE.0).abs_diff(100).max((i / SIZE.0).abs_diff(100));
    let found = seen(|i| if (1..5).contains(&far(i)) { f64::NAN } else { plane(i, table_normal(), 0.6) });
    assert_eq!([100, 101].map(|u| found.labels[100 * SIZE.0 + u]), [0, -1]);
}

#[test]
fn a_small_plane_is_structure_when_it_holds_most_of_what_is_seen() {
    let plate = |half_px: usize| {
        move |i: usize| {
            let is_plate = (i % SIZE.0).abs_diff(160) < half_px && (i / SIZE.0).abs_diff(120) < half_px;
            if is_plate { 1.0 } else { f64::NAN }
        }
    };
    // At 1 m 60 pixels are 23 cm: 0.052 m^2; 40 pixels 15 cm: 0.023 m^2.
    assert_eq!(seen(plate(30)).surfaces.len(), 1);
    assert_eq!(seen(plate(20)).surfaces.len(), 0);
}

#[test]
fn the_structure_is_the_same_on_any_number_of_threads() {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| seen(table_and_wall));
        (found.labels.clone(), format!("{:?} {:?}", found.surfaces, found.supports))
    };
    assert!([2, 8].into_iter().all(|threads| on(threads) == on(1)));
}
