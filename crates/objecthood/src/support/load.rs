//! Load: whether a thing is seen to carry a surface of the structure, as the leg of a table does (docs/CONTEXT.md 6.7).

use glam::DVec3;

use crate::support::column::{LEAST_AIR_M, Place, STEP_M, places};
use crate::support::scene::SupportScene;

/// A surface whose normal has this component along up, within 26 degrees, can be carried.
pub(super) const LEVEL: f64 = 0.9;
/// Most height (m) of what lies between a thing and the surface that it carries: the thickness of a table-top.
const THICKEST_M: f64 = 0.08;
/// A surface that hides the upper end of a thing is carried by it if it is this high (m) above the place: boards of a shelf are closer.
const HIDDEN_M: f64 = 0.4;

/// A column is followed up for at most this length (m): higher surfaces are carried by no thing that might be grasped.
const HIGHEST_M: f64 = 2.0;

/// Whether the column above pixel `i` of a thing ends on a level surface of the structure. `None` when the image does not show it.
///
/// The column goes up along gravity. It may pass through the thing itself, through up to 8 cm of other things, and behind whatever is
/// nearer to the camera. It ends in air if the image shows 4 cm of something farther. A surface less than 4 cm above the pixel, or 40 cm
/// where a part of the column is hidden, does not count. O(steps).
pub(super) fn carries_structure(scene: &SupportScene<'_>, up: DVec3, i: usize, thing: usize) -> Option<bool> {
    let point = DVec3::from(scene.points_m[i].map(f64::from));
    let (mut air_m, mut between_m, mut is_hidden) = (0.0, 0.0, false);
    for Place { region, farther_m, behind_m } in places(scene, i, up, HIGHEST_M) {
        let region = region.map(|region| region.index());
        if region == Some(thing) {
            continue;
        }
        if farther_m.is_nan() || farther_m < -behind_m {
            is_hidden = true;
        } else if farther_m > behind_m {
            air_m += STEP_M;
            if air_m >= LEAST_AIR_M {
                return Some(false);
            }
        } else {
            let least_m = if is_hidden { HIDDEN_M } else { LEAST_AIR_M };
            let plane = region.and_then(|region| scene.planes.get(region));
            if plane.is_some_and(|plane| plane.normal().dot(up) > LEVEL && plane.height_m(point) < -least_m) {
                return Some(true);
            }
            between_m += STEP_M;
            if between_m > THICKEST_M {
                return None;
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discovery::up::{Up, UpSource};
    use crate::planes::StructurePlane;
    use crate::raster::Raster;
    use crate::regions::Segments;
    use crate::testing::space;

    const SIZE: (usize, usize) = (320, 240);
    const FLOOR_M: f64 = 1.3;
    const TABLE_M: f64 = 0.6;
    /// Upright rectangles: depth, left and right, top and bottom (m). Regions 2, 3 and on.
    const UPRIGHT: [(f64, [f64; 2], [f64; 2]); 4] = [
        // A front leg, a back leg that the table hides in part, a box on the table, a post that stands free.
        (1.0, [-0.05, 0.0], [TABLE_M, FLOOR_M]),
        (1.6, [0.2, 0.26], [TABLE_M, FLOOR_M]),
        (1.3, [0.2, 0.35], [0.4, TABLE_M]),
        (1.1, [0.6, 0.68], [0.9, FLOOR_M]),
    ];

    /// The region and the depth (m) of what a level camera sees along a ray: the floor, a table from 1 to 1.6 m, and what is upright.
    fn seen([x, y, _]: [f64; 3]) -> (i32, f64) {
        let floor = (y > 0.2).then(|| (0, FLOOR_M / y));
        let table = (y > 0.2).then(|| (1, TABLE_M / y));
        let table = table.filter(|&(_, z)| (1.0..1.6).contains(&z) && (x * z).abs() < 0.4);
        let upright = UPRIGHT.iter().enumerate().filter_map(|(k, &(z, [left, right], [top, bottom]))| {
            let is_hit = (left..right).contains(&(x * z)) && (top..bottom).contains(&(y * z));
            is_hit.then_some((2 + k as i32, z))
        });
        let hits = floor.into_iter().chain(table).chain(upright);
        hits.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((-1, f64::NAN))
    }

    #[test]
    fn legs_carry_the_table_and_what_stands_free_or_on_it_carries_nothing() {
        let space = space([160.0; 2], [159.5, 60.0]);
        let rays: Vec<[f64; 3]> = (0..SIZE.0 * SIZE.1)
            .map(|i| space.camera().ray((i % SIZE.0) as f64, (i / SIZE.0) as f64))
            .collect();
        let seen: Vec<(i32, f64)> = rays.iter().map(|&ray| seen(ray)).collect();
        let labels = Raster::from_vec(SIZE.0, SIZE.1, seen.iter().map(|hit| hit.0).collect()).unwrap();
        let points = rays.iter().zip(&seen).map(|(ray, hit)| ray.map(|part| (part * hit.1) as f32));
        let points_m = labels.with_data(points.collect());
        let normals = points_m.map(|_| [0.0; 3]);
        let level = |offset_m: f64| StructurePlane {
            normal: [0.0, -1.0, 0.0],
            offset_m: offset_m as f32,
            inlier_share: 0.4,
        };
        let up = Up { direction: [0.0, -1.0, 0.0], source: UpSource::Plane };
        let regions = Segments::from_numbered(labels, 2 + UPRIGHT.len());
        let scene = SupportScene {
            regions: &regions,
            points_m: &points_m,
            normals: &normals,
            planes: &[level(FLOOR_M), level(TABLE_M)],
            up: &up,
            space: &space,
        };
        let load = |thing: usize| {
            let pixels = (0..seen.len()).filter(|&i| seen[i].0 == thing as i32);
            let carries: Vec<bool> =
                pixels.filter_map(|i| carries_structure(&scene, DVec3::NEG_Y, i, thing)).collect();
            assert!(carries.len() > 10, "{thing}: {}", carries.len());
            carries.iter().filter(|&&carries| carries).count() as f64 / carries.len() as f64
        };
        assert!(load(2) > 0.9 && load(3) > 0.7, "legs: {} {}", load(2), load(3));
        assert_eq!([load(4), load(5)], [0.0; 2], "a box on the table, a post that stands free");
    }

    /// The column had no end: its places come ever nearer to one pixel.
    #[test]
    fn a_column_along_the_line_of_sight_ends() {
        let space = space([160.0; 2], [159.5, 119.5]);
        let labels = Raster::filled(SIZE.0, SIZE.1, 0).unwrap();
        let points_m = labels.map(|_| [0.0, 0.0, 1.0]);
        let normals = points_m.map(|_| [0.0; 3]);
        let scene = SupportScene {
            regions: &Segments::from_numbered(labels, 2),
            points_m: &points_m,
            normals: &normals,
            planes: &[],
            up: &Up { direction: [0.0, 0.0, 1.0], source: UpSource::Camera },
            space: &space,
        };
        assert_eq!(carries_structure(&scene, DVec3::Z, 120 * SIZE.0 + 160, 1), None);
    }
}
