//! The objects of a frame, as the tracker needs them.

use glam::DVec3;
use objecthood::Discovery;

use crate::agent::Agents;
use crate::bits::Bits;
use crate::camera::Place;
use crate::look::Look;
use crate::scene::{BESIDE_BACKGROUND_PER_M, Scene};
use crate::view::View;

/// Columns and rows are sampled at this distance.
pub(crate) const STRIDE_PX: usize = 2;
/// Least size of a thing that is detected only because it stands before the rested scene (px at VGA size).
const LEAST_THING_PX: f64 = 200.0;

/// A segment: an object of one frame, or a piece of it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Segment {
    /// Its pixels.
    pub(crate) px: usize,
    /// Mean visible point (m), in the world, and in the camera.
    pub(crate) center: DVec3,
    pub(crate) center_in_camera: DVec3,
    /// Heights (m): of the mean visible point, of the lowest point without the lowest twentieth, and of the
    /// highest point, likewise.
    pub(crate) height_m: f64,
    pub(crate) bottom_m: f64,
    pub(crate) top_m: f64,
    /// Share of its pixels that show what rested there before.
    pub(crate) in_place: f64,
    pub(crate) look: Look,
    /// Visible area, as if it faced the camera (m²).
    pub(crate) area_m2: f64,
    /// Share of its pixels that changed, and that belong to the region of an agent.
    pub(crate) changed: f64,
    pub(crate) of_agent: f64,
    pub(crate) at_border: bool,
}

/// What is needed to measure segments.
pub(crate) struct Measure<'a> {
    pub(crate) view: &'a View,
    pub(crate) changed: &'a Bits,
    pub(crate) scene: &'a Scene,
    pub(crate) agents: &'a Agents,
    pub(crate) place: &'a Place,
}

/// Whether a pixel is sampled.
pub(crate) fn is_looked_at(pixel: usize, width: usize) -> bool {
    (pixel % width).is_multiple_of(STRIDE_PX) && (pixel / width).is_multiple_of(STRIDE_PX)
}

/// The sampled pixels of each of `count` labels, which begin at 1. O(n).
pub(crate) fn pixels_by_label(labels: &[u16], size: (usize, usize), count: usize) -> Vec<Vec<usize>> {
    let mut pixels = vec![Vec::new(); count];
    for v in (0..size.1).step_by(STRIDE_PX) {
        for pixel in (v * size.0..(v + 1) * size.0).step_by(STRIDE_PX) {
            let label = usize::from(labels[pixel]);
            if label > 0 && label <= count {
                pixels[label - 1].push(pixel);
            }
        }
    }
    pixels
}

/// Measures the segments of a label image; segment k has the label k + 1. O(n).
pub(crate) fn segments(labels: &[u16], count: usize, with: &Measure<'_>) -> Vec<Segment> {
    let pixels = pixels_by_label(labels, with.view.size, count);
    pixels.iter().map(|pixels| with.segment(pixels)).collect()
}

/// The labels of a frame's objects, and further labels for regions that stand before the rested scene where
/// no object was found. (A thing in the air has no support, so a frame alone may take it for no object.) Also
/// the number of labels. O(n).
pub(crate) fn labels(found: &Discovery, view: &View, scene: &Scene, agents: &Agents) -> (Vec<u16>, usize) {
    let objects = found.labels.as_slice();
    let (mut labels, mut count) = (objects.to_vec(), found.objects.len());
    let is_unfound = |pixel: &&usize| objects[**pixel] == 0;
    // The rest of a thing that was found is its rim.
    let is_thing = |thing: &Vec<usize>| {
        let free = thing.iter().filter(is_unfound).count();
        free >= view.px(LEAST_THING_PX) && 4 * free > 3 * thing.len()
    };
    // What a thing hid from the sensor may be the table.
    let is_new = |pixel: &&usize| scene.is_in_front(view, **pixel) && !view.is_structure(**pixel);
    for component in agents.free.iter().filter(|component| component.len() >= view.px(LEAST_THING_PX)) {
        let new: Vec<usize> = component.iter().filter(is_new).copied().collect();
        let things = match is_thing(&new) {
            true => vec![new],
            // It may fly in front of another thing.
            false => by_depth(&new, view).into_iter().filter(is_thing).collect(),
        };
        for thing in things {
            if count == usize::from(u16::MAX) {
                return (labels, count);
            }
            count += 1;
            for &pixel in thing.iter().filter(is_unfound) {
                labels[pixel] = count as u16;
            }
        }
    }
    (labels, count)
}

/// Divides a set of pixels into parts between which depth jumps. O(n).
fn by_depth(pixels: &[usize], view: &View) -> Vec<Vec<usize>> {
    let mut mask = Bits::none(view.size);
    pixels.iter().for_each(|&pixel| mask.insert(pixel));
    mask.joined(view)
}

impl Bits {
    /// Its parts, divided where depth jumps. O(n).
    pub(crate) fn joined(&self, view: &View) -> Vec<Vec<usize>> {
        let jump = BESIDE_BACKGROUND_PER_M * view.noise;
        self.components_where(|a, b| (view.inverse[a] - view.inverse[b]).abs() < jump)
    }
}

impl Measure<'_> {
    /// Measures a segment, given every second of its columns and rows. O(pixels).
    pub(crate) fn segment(&self, pixels: &[usize]) -> Segment {
        let width = self.view.size.0;
        let mut segment = Segment { px: pixels.len() * STRIDE_PX * STRIDE_PX, ..Segment::default() };
        let (mut sum, mut squares) = (DVec3::ZERO, 0.0);
        let mut heights = Vec::with_capacity(pixels.len());
        for &pixel in pixels {
            let (u, v) = (pixel % width, pixel / width);
            segment.at_border |= self.view.field.is_border(u, v, STRIDE_PX - 1);
            segment.changed += f64::from(u8::from(self.changed.has(pixel)));
            segment.in_place += f64::from(u8::from(self.scene.is_in_place(self.view, pixel)));
            segment.of_agent += f64::from(u8::from(self.agents.region.has(pixel)));
            if let Some(&color) = self.view.color.get(pixel) {
                segment.look.add(color);
            }
            if let Some(point) = self.view.point(pixel) {
                sum += point;
                squares += point.z * point.z;
                heights.push(self.place.height_m(point));
            }
        }
        segment.look.finish();
        let (all, measured) = (pixels.len().max(1) as f64, heights.len().max(1) as f64);
        segment.changed /= all;
        segment.of_agent /= all;
        segment.in_place /= all;
        segment.center_in_camera = sum / measured;
        segment.center = self.place.world(segment.center_in_camera);
        segment.height_m = segment.center.dot(self.place.up);
        let per_px = self.view.camera.fx_px * self.view.camera.fy_px;
        segment.area_m2 = segment.px as f64 * (squares / measured) / per_px;
        let low = heights.len() / 20;
        if low < heights.len() {
            segment.bottom_m = *heights.select_nth_unstable_by(low, f64::total_cmp).1;
            let high = heights.len() - 1 - low;
            segment.top_m = *heights.select_nth_unstable_by(high, f64::total_cmp).1;
        }
        segment
    }
}
