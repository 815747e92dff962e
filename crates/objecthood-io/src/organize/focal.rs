//! The focal length of a camera that looks at points without pixels: as sharp as the points are dense.

use objecthood::Camera;

use super::{GridCamera, is_valid, nearest};
use crate::capture::Pose;

/// Most pixels of a virtual image: those of the sharpest usual depth cameras, 1920x1080.
const MOST_PIXELS: usize = 1920 * 1080;
/// Most pixels for each point with which the search begins: even if the points fill only a twentieth of the image, it then begins
/// with too many pixels and not with too few.
const PIXELS_PER_POINT: usize = 20;
/// Each trial has a focal length smaller by this factor; a tenth costs a tenth of the resolution at most.
const FACTOR: f64 = 0.9;
/// Most neighbours of pixels with a point that may have none. Points in no order leave 0.08 where 2.5 fall on a pixel;
/// such single holes are bridged by the method.
const MAX_EMPTY_SHARE: f64 = 0.08;
/// Share of the points, on each side, that may lie outside the image: stray ones.
const STRAY_SHARE: f64 = 0.001;
/// The image is larger than the others need by this factor, so that no border is cut off.
const MARGIN: f64 = 1.02;
/// Farthest from the axis that is shown, as a share of the depth: the tangent of 60 degrees.
const WIDEST: f64 = 1.733;
/// Least half width of what is seen, as a share of its depth: of points all in one direction.
const NARROWEST: f64 = 1e-3;

/// The most pixels of an image for points.
pub(super) fn most_pixels(max_pixels: usize) -> usize {
    MOST_PIXELS.min(max_pixels)
}

/// The camera at `pose` with nearly the greatest focal length at which the points leave few holes. At the greatest, pixels and
/// points that stand on a grid of their own still beat, which leaves lines of holes; so the next smaller is taken. O(points), for
/// each trial.
pub(super) fn choose(points_m: &[[f32; 3]], pose: Pose, max_pixels: usize) -> GridCamera {
    let half = [0, 1].map(|axis| half_field(points_m, pose, axis));
    let most = most_pixels(max_pixels).min(points_m.len().saturating_mul(PIXELS_PER_POINT)).max(1);
    let mut focal_px = (most as f64 / (4.0 * half[0] * half[1])).sqrt();
    loop {
        let grid = with_focal(focal_px, half);
        let is_within = grid.size.is_some_and(|(width, height)| width * height <= most);
        let is_least = grid.size.is_some_and(|(width, height)| width * height <= 1);
        if is_least || is_within && empty_share(points_m, pose, &grid) <= MAX_EMPTY_SHARE {
            return if is_least { grid } else { with_focal(FACTOR * focal_px, half) };
        }
        focal_px *= FACTOR;
    }
}

/// A camera with square pixels and the principal point in the middle.
fn with_focal(focal_px: f64, half: [f64; 2]) -> GridCamera {
    let side = |half: f64| (2.0 * half * focal_px).floor() as usize + 1;
    let (width, height) = (side(half[0]), side(half[1]));
    let middle = |side: usize| (side as f64 - 1.0) / 2.0;
    let camera = Camera { fx_px: focal_px, fy_px: focal_px, cx_px: middle(width), cy_px: middle(height) };
    GridCamera { camera, size: Some((width, height)) }
}

/// How far beside the axis points lie, as a share of their depth, but for stray ones.
fn half_field(points_m: &[[f32; 3]], pose: Pose, axis: usize) -> f64 {
    let points = points_m.iter().map(|&point| pose.to_camera(point)).filter(|&point| is_valid(point));
    let mut slopes: Vec<f64> = points
        .map(|point| f64::from((point[axis] / point[2]).abs()))
        .filter(|&slope| slope <= WIDEST)
        .collect();
    if slopes.is_empty() {
        return NARROWEST;
    }
    let place = slopes.len() - 1 - (STRAY_SHARE * slopes.len() as f64) as usize;
    let slope = *slopes.select_nth_unstable_by(place, f64::total_cmp).1;
    (slope * MARGIN).clamp(NARROWEST, WIDEST)
}

/// Of the neighbours of pixels with a point, above, below and beside, the share of those without.
pub(super) fn empty_share(points_m: &[[f32; 3]], pose: Pose, grid: &GridCamera) -> f64 {
    let Some((width, height)) = grid.size else { return 1.0 };
    let mut filled = vec![false; width * height];
    for point in points_m.iter().map(|&point| pose.to_camera(point)).filter(|&point| is_valid(point)) {
        let (u, v) = grid.camera.project(point);
        if let (Some(u), Some(v)) = (nearest(u, width), nearest(v, height)) {
            filled[v * width + u] = true;
        }
    }
    let (mut neighbours, mut empty) = (0_usize, 0_usize);
    let mut count = |a: bool, b: bool| {
        neighbours += usize::from(a) + usize::from(b);
        empty += usize::from(a != b);
    };
    for row in filled.chunks_exact(width) {
        row.windows(2).for_each(|pair| count(pair[0], pair[1]));
    }
    filled.iter().zip(filled.iter().skip(width)).for_each(|(&above, &below)| count(above, below));
    empty as f64 / neighbours.max(1) as f64
}
