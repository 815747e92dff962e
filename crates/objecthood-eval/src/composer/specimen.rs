//! Objects of a data set of which all is seen that a camera can see: they can be put elsewhere.

use std::ops::Range;

use glam::{DVec2, DVec3, Vec3};
use objecthood::Raster;
use objecthood::surface::disparity::DisparitySpace;

use super::polygon::Polygon;
use super::table::{Table, position};
use crate::dataset::Scene;
use crate::truth::Truth;

/// Objects whose lowest point is higher (m) stand on something else, which hides their foot.
const FOOT_M: f64 = 0.04;
/// A part with a smaller share of the object does not count as one.
const PART: f64 = 0.05;
/// An object is hidden where more than this share of its border has something nearer ..
const HIDDEN: f64 = 0.1;
/// .. by so much (1/m) ..
const NEARER_PER_M: f64 = 0.03;
/// .. within so many pixels.
const NEAR_PX: usize = 7;
/// Points so little below the top belong to it (m).
const TOP_M: f64 = 0.012;
/// A top that carries has at least this share of the points ..
const TOP_SHARE: f64 = 0.3;
/// .. and these sides (m).
const TOP_SIDES_M: [f64; 2] = [0.08, 0.06];

/// An object as its camera saw it. Points and footprint are counted from the middle of its footprint.
pub(super) struct Specimen {
    /// Each pixel's point: right, away, up (m).
    pub(super) points_m: Vec<Vec3>,
    /// Each pixel's colour.
    pub(super) colors: Vec<[u8; 3]>,
    /// Where it stood (m).
    pub(super) home: DVec2,
    pub(super) footprint: Polygon,
    /// How high it is (m), but for its highest hundredth.
    pub(super) height_m: f64,
    /// What can stand on it, if anything can.
    pub(super) top: Option<Top>,
    /// Whether its inside shows: seen from elsewhere it would look different sooner.
    pub(super) is_vessel: bool,
}

/// A flat top.
pub(super) struct Top {
    /// Its middle (m).
    pub(super) center: DVec2,
    /// How high it is (m).
    pub(super) height_m: f64,
}

/// The objects of a scene that are seen whole; `vessels` says whether they are open.
pub(super) fn specimens(
    scene: &Scene,
    disparity: &Raster<f32>,
    space: &DisparitySpace,
    table: &Table,
    vessels: bool,
) -> Vec<Specimen> {
    let mut pixels: Vec<(u32, usize)> = (0..disparity.len())
        .filter(|&i| disparity[i] > 0.0)
        .filter_map(|i| Some((scene.truth.object_at(i)?, i)))
        .collect();
    pixels.sort_unstable();
    let objects = pixels.chunk_by(|a, b| a.0 == b.0);
    let whole = objects.filter(|object| {
        let pixels = object.iter().map(|&(_, i)| i);
        // The inside of a vessel is a part of its own.
        (vessels || !is_cut(pixels.clone(), object.len(), &scene.truth))
            && !is_hidden(pixels, disparity, space, &scene.truth)
    });
    whole
        .filter_map(|object| {
            let point = |&(_, i): &(u32, usize)| {
                let at = position(i, disparity.width());
                table.ground.ground_point(space.point_m(at, f64::from(disparity[i])).into())
            };
            let color = |&(_, i): &(u32, usize)| scene.frame.color().map_or([128; 3], |color| color[i]);
            Specimen::new(object.iter().map(point).collect(), object.iter().map(color).collect(), vessels)
        })
        .collect()
}

/// Whether at least two visible parts count.
fn is_cut(pixels: impl Iterator<Item = usize>, size_px: usize, truth: &Truth) -> bool {
    let mut parts: Vec<u32> = pixels.map(|i| truth.parts()[i]).collect();
    parts.sort_unstable();
    parts.chunk_by(|a, b| a == b).filter(|part| part.len() as f64 >= PART * size_px as f64).count() > 1
}

/// Whether the image's border cuts an object, or another object before it.
fn is_hidden(
    pixels: impl Iterator<Item = usize>,
    disparity: &Raster<f32>,
    space: &DisparitySpace,
    truth: &Truth,
) -> bool {
    let (width, height) = disparity.size();
    let window = |i: usize, radius: usize| {
        let columns = near(i % width, radius, width);
        near(i / width, radius, height).flat_map(move |v| columns.clone().map(move |u| v * width + u))
    };
    let (mut border_px, mut hidden_px) = (0, 0);
    for i in pixels {
        let own = truth.object_at(i);
        let mut around = window(i, 1);
        if around.clone().count() < 9 {
            return true;
        }
        if around.any(|j| truth.object_at(j) != own) {
            border_px += 1;
            let per_m = |j: usize| 1.0 / space.depth_m(f64::from(disparity[j]));
            let is_before = |j: usize| {
                truth.object_at(j).is_some_and(|other| Some(other) != own)
                    && per_m(j) > per_m(i) + NEARER_PER_M
            };
            hidden_px += i32::from(window(i, NEAR_PX).any(is_before));
        }
    }
    f64::from(hidden_px) > HIDDEN * f64::from(border_px)
}

/// What is at most `radius` from `x` in 0..size.
fn near(x: usize, radius: usize, size: usize) -> Range<usize> {
    x.saturating_sub(radius)..(x + radius + 1).min(size)
}

impl Specimen {
    /// `None` of what does not stand on the table or has no width.
    fn new(points: Vec<DVec3>, colors: Vec<[u8; 3]>, is_vessel: bool) -> Option<Self> {
        let home = points.iter().sum::<DVec3>().truncate() / points.len() as f64;
        let points: Vec<DVec3> = points.into_iter().map(|p| p - home.extend(0.0)).collect();
        let mut heights: Vec<f64> = points.iter().map(|p| p.z).collect();
        heights.sort_unstable_by(f64::total_cmp);
        if *heights.first()? > FOOT_M {
            return None;
        }
        let height_m = heights[(heights.len() - 1) * 99 / 100];
        Some(Self {
            footprint: Polygon::hull(points.iter().map(|p| p.truncate()).collect())?,
            top: if is_vessel { None } else { Top::of(&points, height_m) },
            points_m: points.iter().map(|p| p.as_vec3()).collect(),
            colors,
            home,
            height_m,
            is_vessel,
        })
    }
}

impl Top {
    fn of(points: &[DVec3], height_m: f64) -> Option<Self> {
        let mut top: Vec<DVec3> = points.iter().copied().filter(|p| p.z > height_m - TOP_M).collect();
        let (low, high) = top
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
        let sides = high - low;
        let is_flat = top.len() as f64 > TOP_SHARE * points.len() as f64
            && sides.x > TOP_SIDES_M[0]
            && sides.y > TOP_SIDES_M[1];
        if !is_flat {
            return None;
        }
        let middle = top.len() / 2;
        let (_, median, _) = top.select_nth_unstable_by(middle, |a, b| a.z.total_cmp(&b.z));
        let height_m = median.z;
        Some(Self { center: top.iter().sum::<DVec3>().truncate() / top.len() as f64, height_m })
    }
}
