//! Load: whether a thing is seen to carry a surface of the structure, as the leg of a table does
//! (docs/CONTEXT.md 6.7.2 and 6.7.3).

use glam::DVec3;

use crate::planes::StructurePlane;
use crate::support::column::{LEAST_AIR_M, Place, STEP_M, places};
use crate::support::scene::SupportScene;

/// A surface can be carried if the component of its normal along up is at least this (within 26 degrees).
const LEVEL: f64 = 0.9;
/// Greatest thickness (m) of what lies between a thing and the surface that it carries: that of a table-top.
const THICKEST_M: f64 = 0.08;
/// A surface that hides the upper end of a thing is carried by it if it is at least this high (m) above the
/// place: the boards of a shelf are closer together.
const HIDDEN_M: f64 = 0.4;

/// A surface that the image shows at its border is assumed to go on this far (m) beyond it.
const BEYOND_M: f64 = 0.15;
/// A band along the border without depth is at most this wide (px at 525 px), as between neighbouring
/// clusters.
const BAND_PX: usize = 24;

/// A column goes up at most this far (m): no graspable thing carries a higher surface.
const HIGHEST_M: f64 = 2.0;

/// Whether a plane of the structure is level, so that it can carry or be carried.
pub(super) fn is_level(plane: &StructurePlane, up: DVec3) -> bool {
    plane.normal().dot(up) > LEVEL
}

/// The plane of a region that is a level surface of the structure.
pub(super) fn level_plane<'a>(
    scene: &SupportScene<'a>,
    up: DVec3,
    region: usize,
) -> Option<&'a StructurePlane> {
    scene.planes.get(region).filter(|plane| is_level(plane, up))
}

/// What the column above a pixel of a thing ends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Load {
    /// Air: something farther is seen there.
    Nothing,
    /// A level surface of the structure.
    Structure,
    /// A thing that is too large to be grasped, or whatever a post goes on to. What rests on the carrier does
    /// not share this doubt.
    Furniture,
}

/// What the column above pixel `i` of a thing ends on. `None` when the image does not show it.
///
/// The column goes up along gravity. It may pass through the thing itself, through up to 8 cm of other
/// things, and behind whatever is nearer to the camera.
///
/// - It ends in air if the image shows 4 cm of something farther.
/// - It ends on a level surface of the structure, if that is at least 4 cm above the pixel. If a part of the
///   column is hidden, 40 cm are needed.
/// - A column that leaves the image less than 8 cm below the surface that hides it ends on that surface.
/// - A column that leaves the image through the thing itself ends on the level surface that it meets outside,
///   if the border of the image shows that surface within 15 cm of the place.
/// - It also ends on a region that `is_furniture`, 4 cm above the pixel or more.
///
/// Unless the thing `shows_foot`, both of its ends are out of sight, which is rare in a shelf. Then 4 cm are
/// enough for a hidden column too, and a column that leaves the image anywhere below the surface that hides
/// it ends on that surface. O(steps).
pub(super) fn what_is_carried(
    scene: &SupportScene<'_>,
    up: DVec3,
    i: usize,
    thing: usize,
    shows_foot: bool,
    is_furniture: impl Fn(usize) -> bool,
) -> Option<Load> {
    let point = scene.point_at(i);
    let level = |region: Option<usize>| level_plane(scene, up, region?);
    let hidden_m = if shows_foot { HIDDEN_M } else { LEAST_AIR_M };
    let (mut air_m, mut between_m, mut is_hidden) = (0.0, 0.0, false);
    let (mut height_m, mut hidden_by, mut is_in_thing) = (0.0, None, true);
    for Place { region, farther_m, behind_m } in places(scene, i, up, HIGHEST_M) {
        height_m += STEP_M;
        let region = region.map(|region| region.index());
        // A band along the border may be without depth.
        is_in_thing = region.map_or(is_in_thing, |region| region == thing);
        if region == Some(thing) {
            continue;
        }
        if farther_m.is_nan() || farther_m < -behind_m {
            (is_hidden, hidden_by) = (true, level(region));
        } else if farther_m > behind_m {
            air_m += STEP_M;
            if air_m >= LEAST_AIR_M {
                return Some(Load::Nothing);
            }
        } else {
            let least_m = if is_hidden { hidden_m } else { LEAST_AIR_M };
            if level(region).is_some_and(|plane| plane.height_m(point) < -least_m) {
                return Some(Load::Structure);
            }
            if height_m > LEAST_AIR_M && region.is_some_and(&is_furniture) {
                return Some(Load::Furniture);
            }
            between_m += STEP_M;
            if between_m > THICKEST_M {
                return None;
            }
        }
    }
    let end_m = point + up * height_m;
    let ends_on = |plane: &StructurePlane| {
        let least_m = if shows_foot { -THICKEST_M } else { f64::NEG_INFINITY };
        plane.height_m(point) < -hidden_m && (least_m..THICKEST_M).contains(&plane.height_m(end_m))
    };
    let is_carrier = hidden_by.is_some_and(ends_on) || is_in_thing && meets_outside(scene, up, point, end_m);
    is_carrier.then_some(Load::Structure)
}

/// Whether the column above a point meets a level surface beyond `end_m`, where it left the image, and the border of the image shows that
/// surface near the place. O(planes).
fn meets_outside(scene: &SupportScene<'_>, up: DVec3, point: DVec3, end_m: DVec3) -> bool {
    let is_met = |(region, plane): (usize, &StructurePlane)| {
        let is_above = plane.height_m(point) < -LEAST_AIR_M && plane.height_m(end_m) < 0.0;
        if !is_above || !is_level(plane, up) {
            return false;
        }
        let place = end_m - up * (plane.height_m(end_m) / plane.normal().dot(up));
        let (u, v) = scene.space.camera().project(place.as_vec3().to_array());
        let Some(shown) = nearest_region(scene, [u, v]) else { return false };
        let is_same = scene.regions.at(shown).is_some_and(|seen| seen.index() == region);
        is_same && scene.point_at(shown).distance(place) < BEYOND_M
    };
    scene.planes.iter().enumerate().any(is_met)
}

/// The pixel nearest to a place outside the image, along a row, a column or a diagonal, that shows a region.
/// `None` if the border shows none within [`BAND_PX`].
fn nearest_region(scene: &SupportScene<'_>, place: [f64; 2]) -> Option<usize> {
    let (width, height) = scene.points_m.size();
    let inside = |at: f64, size: usize| at.round().clamp(0.0, size as f64 - 1.0);
    let (u, v) = (inside(place[0], width), inside(place[1], height));
    let inwards = |at: f64, inside: f64| if at.round() == inside { 0.0 } else { (inside - at).signum() };
    let (du, dv) = (inwards(place[0], u), inwards(place[1], v));
    let pixel = |k: usize| {
        let (u, v) = (u + k as f64 * du, v + k as f64 * dv);
        let is_inside = (0.0..width as f64).contains(&u) && (0.0..height as f64).contains(&v);
        is_inside.then_some(v as usize * width + u as usize)
    };
    (0..=scene.space.length_px(BAND_PX)).filter_map(pixel).find(|&i| scene.regions.at(i).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discovery::up::{Up, UpSource};
    use crate::raster::Raster;
    use crate::regions::Segments;
    use crate::support::testing::{SIZE, pixels_of, table_scene};
    use crate::testing::space;

    /// What the columns above the pixels of a thing end on, in an image that begins at this row of the scene. The table is of the structure or
    /// furniture.
    fn carried_by(thing: usize, first_row: usize, table: Load, shows_foot: bool) -> Vec<Load> {
        carried_in(0.0, [0, first_row], thing, table, shows_foot)
    }

    /// The same of a camera that looks so far down, in an image that begins at this column and row.
    fn carried_in(
        down_deg: f64,
        [first_column, first_row]: [usize; 2],
        thing: usize,
        table: Load,
        shows_foot: bool,
    ) -> Vec<Load> {
        let first = [first_column, first_row];
        let has_table = table == Load::Structure;
        table_scene(down_deg, first, has_table, |scene, up| {
            let is_furniture = |region| table == Load::Furniture && region == 1;
            let carried = |i| what_is_carried(scene, up, i, thing, shows_foot, is_furniture);
            pixels_of(scene, thing).filter_map(carried).collect()
        })
    }

    #[test]
    fn legs_carry_the_table_and_what_stands_free_or_on_it_carries_nothing() {
        for table in [Load::Structure, Load::Furniture] {
            let load = |thing: usize| {
                let carries = carried_by(thing, 0, table, true);
                assert!(carries.len() > 10, "{thing}: {}", carries.len());
                carries.iter().filter(|&&load| load == table).count() as f64 / carries.len() as f64
            };
            assert!(load(2) > 0.9 && load(3) > 0.7, "legs of {table:?}: {} {}", load(2), load(3));
            assert_eq!([load(4), load(5)], [0.0; 2], "a box on {table:?}, a post that stands free");
        }
    }

    /// A leg at the edge of the image was an object, because its upper end is outside.
    #[test]
    fn a_leg_whose_upper_end_is_just_outside_carries_the_table() {
        // The table ends in row 120 before the back leg: 2 rows are 2 cm there, 12 rows are 12 cm.
        let just_outside = carried_by(3, 122, Load::Structure, true);
        assert!(
            just_outside.len() > 10 && just_outside.iter().all(|&load| load == Load::Structure),
            "{just_outside:?}"
        );
        assert_eq!(carried_by(3, 132, Load::Structure, true), [], "the table might end outside");
    }

    /// The leg of a table at the edge of the image was an object in every second frame of a video: neither of its ends was seen.
    #[test]
    fn a_leg_of_which_no_end_is_seen_carries_the_table_before_it() {
        let unseen = carried_by(3, 132, Load::Structure, false);
        assert!(unseen.len() > 10 && unseen.iter().all(|&load| load == Load::Structure), "{unseen:?}");
        let free = carried_by(5, 0, Load::Structure, false);
        assert!(
            free.len() > 10 && free.iter().all(|&load| load == Load::Nothing),
            "nothing hides the post: {free:?}"
        );
    }

    /// The leg of a table was an object, because the columns above it left the image through the leg.
    #[test]
    fn a_leg_that_leaves_the_image_carries_the_table_beside_it() {
        // Where a camera looks down, what is upright leans to the side: the upper end of the leg is left of the image, and the table beside it in the
        // image.
        let leaves = carried_in(30.0, [118, 0], 6, Load::Structure, true);
        let carry = leaves.iter().filter(|&&load| load == Load::Structure).count();
        assert!(leaves.len() > 100 && carry > leaves.len() / 2, "{carry} of {}", leaves.len());
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
        assert_eq!(what_is_carried(&scene, DVec3::Z, 120 * SIZE.0 + 160, 1, true, |_| false), None);
    }
}
