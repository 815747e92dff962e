//! Regions against gravity: how high they stand, where they are in the plan view, how they are tilted.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3, Vec3};

use crate::objectness::gravity::Up;
use crate::oversegment::structure::{element_at, tangents};
use crate::raster::Raster;
use crate::regions::Segments;

/// The foot of a region is this share of its heights from below: single noisy pixels lie low anywhere.
const FOOT_SHARE: f64 = 0.02;
/// Its top is this share from below.
const TOP_SHARE: f64 = 0.98;
/// Side of a cell of the plan view (m): half the distance of contact, so that what is in contact is in neighbouring cells.
const CELL_M: f64 = 0.01;
/// The height of a cell is this share of its heights from below.
const CELL_SHARE: f64 = 0.8;
/// The outline of a region in the plan view is known in so many directions.
const DIRECTIONS: usize = 16;
/// A face whose normal has more than this along up (25 degrees from level) is a top, not a side.
const TOP_FACE: f64 = 0.9;
/// Sides of a flat thing are tilted alike up to this (sine; 9 degrees, the noise of normals of small faces).
const ALIKE: f64 = 0.15;
/// What is tilted by less (sine; 8 degrees) stands upright.
const LEAST_TILT: f64 = 0.14;
/// This share of the sides of something that leans is tilted alike: a board is, a ball is not.
const LEAST_ALIKE: f64 = 0.6;

/// Where the way along gravity is shorter than this in the image (sine; 6 degrees) its direction means nothing.
const FORESHORTENED: f64 = 0.1;

/// Takes points to heights and to the plan view, which is what is seen from straight above.
pub(crate) struct Plan {
    up: DVec3,
    across: [DVec3; 2],
}

impl Plan {
    pub(crate) fn new(up: &Up) -> Self {
        let up = Vec3::from(up.direction).as_dvec3();
        Self { up, across: tangents(up) }
    }

    /// Height along up, relative to the camera (m).
    pub(crate) fn height_m(&self, point_m: [f32; 3]) -> f64 {
        self.up.dot(Vec3::from(point_m).as_dvec3())
    }

    /// How much of a normal is upwards.
    pub(crate) fn upward(&self, normal: [f32; 3]) -> f64 {
        self.height_m(normal)
    }

    /// Place in the plan view (m).
    pub(crate) fn place_m(&self, point_m: [f32; 3]) -> DVec2 {
        let point = Vec3::from(point_m).as_dvec3();
        DVec2::from(self.across.map(|axis| axis.dot(point)))
    }

    /// The step to one of the eight neighbouring pixels that leads most nearly along gravity at a point, for square
    /// pixels; `None` where one looks along gravity (within about 6 degrees).
    pub(crate) fn step_down(&self, point_m: [f32; 3]) -> Option<[i32; 2]> {
        let [x, y, z] = point_m.map(f64::from);
        let down = DVec2::new(-self.up.x + x / z * self.up.z, -self.up.y + y / z * self.up.z);
        let down = (down.length() > FORESHORTENED).then(|| down.normalize())?;
        // sin 22.5 degrees: nearer to an axis than to a diagonal.
        Some(down.to_array().map(|along| if along.abs() > 0.38 { along.signum() as i32 } else { 0 }))
    }

    /// The point at a height above a place.
    pub(crate) fn point_m(&self, place_m: DVec2, height_m: f64) -> DVec3 {
        self.across[0] * place_m.x + self.across[1] * place_m.y + self.up * height_m
    }
}

/// A region as something that stands.
#[derive(Clone, Debug, Default)]
pub(crate) struct Body {
    /// Its first pixel; tells regions apart whatever their numbers are.
    pub(crate) first: usize,
    /// Pixels with depth.
    pub(crate) size_px: usize,
    /// Mean height (m).
    pub(crate) mean_m: f64,
    /// Height of its lowest visible part (m).
    pub(crate) foot_m: f64,
    /// Height of its highest part (m).
    pub(crate) top_m: f64,
    /// Mean place (m).
    pub(crate) middle_m: DVec2,
    /// How far it reaches in the plan view in each of [`DIRECTIONS`] (m).
    reach_m: [f64; DIRECTIONS],
    /// Which way its sides lean, if they are one flat face that is tilted.
    pub(crate) tilt: Option<Tilt>,
}

/// Something flat that is not upright.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tilt {
    /// Unit vector in the plan view from its foot to its top.
    pub(crate) toward: DVec2,
    /// Share of its sides that are tilted alike.
    pub(crate) alike: f64,
}

/// The unit vectors in which the outline of a region is known.
fn directions() -> [DVec2; DIRECTIONS] {
    std::array::from_fn(|k| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / DIRECTIONS as f64);
        DVec2::new(cos, sin)
    })
}

/// All regions as bodies. Pixels without depth do not count. O(pixels).
pub(crate) fn bodies(
    regions: &Segments,
    points_m: &Raster<[f32; 3]>,
    normals: &Raster<[f32; 3]>,
    plan: &Plan,
) -> Vec<Body> {
    let mut bodies =
        vec![Body { reach_m: [f64::NEG_INFINITY; DIRECTIONS], ..Body::default() }; regions.count()];
    let mut heights_m: Vec<Vec<f64>> = vec![Vec::new(); regions.count()];
    let mut sides: Vec<Vec<(f64, [f32; 3])>> = vec![Vec::new(); regions.count()];
    let directions = directions();
    for (i, region) in regions.members().filter(|&(i, _)| !points_m[i][2].is_nan()) {
        let (body, height_m, place_m) =
            (&mut bodies[region], plan.height_m(points_m[i]), plan.place_m(points_m[i]));
        if body.size_px == 0 {
            body.first = i;
        }
        body.size_px += 1;
        body.mean_m += height_m;
        body.middle_m += place_m;
        for (reach_m, direction) in body.reach_m.iter_mut().zip(directions) {
            *reach_m = reach_m.max(place_m.dot(direction));
        }
        heights_m[region].push(height_m);
        let upward = plan.upward(normals[i]);
        if normals[i] != [0.0; 3] && upward < TOP_FACE {
            sides[region].push((upward, normals[i]));
        }
    }
    for ((body, mut heights_m), sides) in bodies.iter_mut().zip(heights_m).zip(sides) {
        let count = body.size_px.max(1) as f64;
        body.mean_m /= count;
        body.middle_m /= count;
        body.foot_m = element_at(&mut heights_m, FOOT_SHARE);
        body.top_m = element_at(&mut heights_m, TOP_SHARE);
        body.tilt = Tilt::of(&sides, plan);
    }
    bodies
}

impl Body {
    /// Whether a place lies within the outline, or farther out by at most `beyond_m`.
    pub(crate) fn contains(&self, place_m: DVec2, beyond_m: f64) -> bool {
        directions().iter().zip(self.reach_m).all(|(d, reach_m)| place_m.dot(*d) <= reach_m + beyond_m)
    }
}

impl Tilt {
    /// Of faces that are no tops, each with what of its normal is upwards.
    fn of(sides: &[(f64, [f32; 3])], plan: &Plan) -> Option<Self> {
        let mut upward: Vec<f64> = sides.iter().map(|side| side.0).collect();
        let middle = element_at(&mut upward, 0.5);
        let alike: Vec<_> = sides.iter().filter(|side| (side.0 - middle).abs() <= ALIKE).collect();
        let share = alike.len() as f64 / sides.len().max(1) as f64;
        if middle.abs() < LEAST_TILT || share < LEAST_ALIKE {
            return None;
        }
        let outward: DVec2 = alike.iter().map(|side| plan.place_m(side.1)).sum();
        // What shows its upper side leans away from where that faces.
        Some(Self { toward: (-middle.signum() * outward).try_normalize()?, alike: share })
    }
}

/// How high regions are, place by place.
pub(crate) struct Relief {
    /// By region, then by cell; in each the height (m).
    cells: BTreeMap<(u32, [i32; 2]), f64>,
}

impl Relief {
    /// Of the regions from number `from` on. O(pixels log pixels).
    pub(crate) fn new(regions: &Segments, points_m: &Raster<[f32; 3]>, plan: &Plan, from: usize) -> Self {
        let members = regions.members().filter(|&(i, region)| region >= from && !points_m[i][2].is_nan());
        let keyed = members.map(|(i, region)| {
            ((region as u32, cell(plan.place_m(points_m[i]))), plan.height_m(points_m[i]))
        });
        let mut keyed: Vec<((u32, [i32; 2]), f64)> = keyed.collect();
        keyed.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let height_m = |of_cell: &[(_, f64)]| of_cell[(CELL_SHARE * of_cell.len() as f64) as usize].1;
        let cells = keyed.chunk_by(|a, b| a.0 == b.0).map(|of_cell| (of_cell[0].0, height_m(of_cell)));
        Self { cells: cells.collect() }
    }

    /// How high a region is at a place and in the eight cells around it (m).
    pub(crate) fn top_near_m(&self, region: usize, place_m: DVec2) -> Option<f64> {
        let [x, y] = cell(place_m);
        let around =
            (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [x.saturating_add(dx), y.saturating_add(dy)]));
        around.filter_map(|at| self.cells.get(&(region as u32, at)).copied()).reduce(f64::max)
    }

    /// The cells of a region: middle and height (m).
    pub(crate) fn of(&self, region: usize) -> impl Iterator<Item = (DVec2, f64)> + '_ {
        let all = (region as u32, [i32::MIN; 2])..=(region as u32, [i32::MAX; 2]);
        self.cells.range(all).map(|(&(_, [x, y]), &height_m)| {
            (DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5) * CELL_M, height_m)
        })
    }
}

fn cell(place_m: DVec2) -> [i32; 2] {
    (place_m / CELL_M).floor().to_array().map(|x| x as i32)
}
