//! A table on a floor before a camera, its legs, and what stands around it.

use glam::{DQuat, DVec3};

use crate::discovery::up::{Up, UpSource};
use crate::planes::StructurePlane;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::support::scene::SupportScene;
use crate::testing::space;

/// Columns and rows of the whole image.
pub(super) const SIZE: (usize, usize) = (320, 240);
const FLOOR_M: f64 = 1.3;
const TABLE_M: f64 = 0.6;
/// Upright rectangles: depth, left and right, top and bottom (m). Regions 2, 3 and on.
const RECTANGLES: [(f64, [f64; 2], [f64; 2]); 5] = [
    // A front leg, a back leg that the table hides in part, a box on the table, a post that stands free, the other front leg.
    (1.0, [-0.05, 0.0], [TABLE_M, FLOOR_M]),
    (1.6, [0.2, 0.26], [TABLE_M, FLOOR_M]),
    (1.3, [0.2, 0.35], [0.4, TABLE_M]),
    (1.1, [0.6, 0.68], [0.9, FLOOR_M]),
    (1.02, [-0.36, -0.31], [TABLE_M, FLOOR_M]),
];

/// The region and the depth (m) of what a level camera sees along a ray: the floor, a table from 1 to 1.6 m, and what is upright.
fn seen([x, y, _]: [f64; 3]) -> (i32, f64) {
    let floor = (y > 0.2).then(|| (0, FLOOR_M / y));
    let table = (y > 0.2).then(|| (1, TABLE_M / y));
    let table = table.filter(|&(_, z)| (1.0..1.6).contains(&z) && (x * z).abs() < 0.4);
    let upright = RECTANGLES.iter().enumerate().filter_map(|(k, &(z, [left, right], [top, bottom]))| {
        let is_hit = (left..right).contains(&(x * z)) && (top..bottom).contains(&(y * z));
        is_hit.then_some((2 + k as i32, z))
    });
    let hits = floor.into_iter().chain(table).chain(upright);
    hits.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((-1, f64::NAN))
}

/// The scene that a camera tilted down by `down_deg` sees, cropped to begin at this column and row. Region 0 is the floor and region 1 the table. Both are
/// planes of the structure if `table_is_structure`, else the floor alone. Calls `look` with the scene and up.
pub(super) fn table_scene<T>(
    down_deg: f64,
    [first_column, first_row]: [usize; 2],
    table_is_structure: bool,
    look: impl FnOnce(&SupportScene<'_>, DVec3) -> T,
) -> T {
    let [columns, rows] = [SIZE.0 - first_column, SIZE.1 - first_row];
    let space = space([160.0; 2], [159.5 - first_column as f64, 60.0 - first_row as f64]);
    let level_from_camera = DQuat::from_rotation_x(-down_deg.to_radians());
    let up_direction = level_from_camera.inverse() * DVec3::NEG_Y;
    let rays = (0..columns * rows).map(|i| {
        let ray = space.camera().ray((i % columns) as f64, (i / columns) as f64);
        let level = level_from_camera * DVec3::from(ray);
        level / level.z
    });
    let seen: Vec<(i32, [f32; 3])> = rays
        .map(|ray| {
            let (region, z_m) = seen(ray.to_array());
            (region, (level_from_camera.inverse() * (ray * z_m)).as_vec3().to_array())
        })
        .collect();
    let labels = Raster::from_vec(columns, rows, seen.iter().map(|hit| hit.0).collect()).unwrap();
    let points_m = labels.with_data(seen.iter().map(|hit| hit.1).collect());
    let normals = points_m.map(|_| [0.0; 3]);
    let direction = up_direction.as_vec3().to_array();
    let level =
        |offset_m: f64| StructurePlane { normal: direction, offset_m: offset_m as f32, inlier_share: 0.4 };
    let up = Up { direction, source: UpSource::Plane };
    let regions = Segments::from_numbered(labels, 2 + RECTANGLES.len());
    let scene = SupportScene {
        regions: &regions,
        points_m: &points_m,
        normals: &normals,
        planes: &[level(FLOOR_M), level(TABLE_M)][..if table_is_structure { 2 } else { 1 }],
        up: &up,
        space: &space,
    };
    look(&scene, up_direction)
}

/// The pixels of a region.
pub(super) fn pixels_of(scene: &SupportScene<'_>, region: usize) -> impl Iterator<Item = usize> {
    scene.regions.members().filter(move |&(_, other)| other == region).map(|(i, _)| i)
}
