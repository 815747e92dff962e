//! Edges of depth against edges of colour.

use super::doubt::{Doubt, Mirrored};
use super::sample::grid_px;
use crate::raster::Raster;

/// Neighbours whose depths differ by more than this share are an edge.
const EDGE: f32 = 0.04;

/// Neighbours may have this much between them without depth, as a share of the width: the shadow beside an edge.
const SHADOW: f64 = 0.025;

/// A change of colour is looked for within this distance of an edge (px).
const NEAR_PX: usize = 2;

/// Changes of colour (sum of three channels) count up to this.
const MOST_CHANGE: f64 = 60.0;

/// With fewer edges nothing is said.
const FEWEST: usize = 50;

/// Mirrored, the change of colour at edges must be larger by this ..
const GAIN: f64 = 4.0;

/// .. and by this many standard errors of its mean.
const SURE: f64 = 4.0;

/// Edges that are counted for one of them is seen: those of one contour go together.
const TOGETHER: f64 = 4.0;

/// Ways of seeing the colour, the first as it is.
const WAYS: [Option<Mirrored>; 4] =
    [None, Some(Mirrored::Sideways), Some(Mirrored::UpsideDown), Some(Mirrored::Turned)];

/// Whether edges of depth fit those of the colour better if one is mirrored.
pub(super) fn doubt(depth_m: &Raster<f32>, color: &Raster<[u8; 3]>) -> Option<Doubt> {
    let edges = edges(depth_m);
    if edges.len() < FEWEST {
        return None;
    }
    let count = edges.len() as f64;
    let mut best = None;
    let mut plain = 0.0;
    let mut most = 0.0;
    for way in WAYS {
        let changes = edges.iter().map(|edge| change(color, edge.seen(way, color.size())));
        let [sum, squares] = changes.fold([0.0; 2], |[sum, squares], x| [sum + x, squares + x * x]);
        let mean = sum / count;
        let error = ((squares / count - mean * mean).max(0.0) * TOGETHER / count).sqrt();
        if way.is_none() {
            plain = mean;
        } else if mean - plain > GAIN.max(SURE * error) && mean > most {
            (best, most) = (way, mean);
        }
    }
    best.map(Doubt::ColorMirrored)
}

/// A pixel at which depth jumps: the nearer one.
#[derive(Clone, Copy)]
struct Edge {
    u: usize,
    v: usize,
    /// Whether it jumps along the row.
    along_row: bool,
}

impl Edge {
    /// The same place in an image that is seen in this way.
    fn seen(&self, way: Option<Mirrored>, (width, height): (usize, usize)) -> Self {
        let (across, down) = (width - 1 - self.u, height - 1 - self.v);
        let (u, v) = match way {
            None => (self.u, self.v),
            Some(Mirrored::Sideways) => (across, self.v),
            Some(Mirrored::UpsideDown) => (self.u, down),
            Some(Mirrored::Turned) => (across, down),
        };
        Self { u, v, along_row: self.along_row }
    }
}

/// The edges in some rows and columns.
fn edges(depth_m: &Raster<f32>) -> Vec<Edge> {
    let (width, height) = depth_m.size();
    let depths = depth_m.as_slice();
    let (grid, shadow) = (grid_px(width), (SHADOW * width as f64) as usize + 1);
    let mut edges = Vec::new();
    for v in (0..height).step_by(grid) {
        let row = &depths[v * width..][..width];
        edges_of_line(row.iter().copied(), shadow, |u| edges.push(Edge { u, v, along_row: true }));
    }
    for u in (0..width).step_by(grid) {
        let column = depths[u..].iter().step_by(width).copied();
        edges_of_line(column, shadow, |v| edges.push(Edge { u, v, along_row: false }));
    }
    edges
}

/// Calls `found` with the place of each edge in a line of depths.
fn edges_of_line(depths: impl Iterator<Item = f32>, shadow: usize, mut found: impl FnMut(usize)) {
    let mut last: Option<(usize, f32)> = None;
    for (place, z) in depths.enumerate().filter(|(_, z)| !z.is_nan()) {
        if let Some((before, z_before)) = last
            && place - before <= shadow
            && (z - z_before).abs() > EDGE * z.max(z_before)
        {
            found(if z < z_before { place } else { before });
        }
        last = Some((place, z));
    }
}

/// The greatest change of colour across an edge near it.
fn change(color: &Raster<[u8; 3]>, edge: Edge) -> f64 {
    let (width, height) = color.size();
    let (step, place, length) = if edge.along_row { (1, edge.u, width) } else { (width, edge.v, height) };
    let i = edge.v * width + edge.u;
    let from = place.saturating_sub(NEAR_PX).max(1);
    let to = (place + NEAR_PX).min(length.saturating_sub(2));
    let change_at = |at: usize| -> u16 {
        let middle = i + at * step - place * step;
        let (before, after) = (color[middle - step], color[middle + step]);
        before.iter().zip(after).map(|(&a, b)| u16::from(a.abs_diff(b))).sum()
    };
    f64::from((from..=to).map(change_at).max().unwrap_or(0)).min(MOST_CHANGE)
}
