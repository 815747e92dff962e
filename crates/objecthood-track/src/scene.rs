//! What the tracker remembers about every pixel.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::bits::Bits;
use crate::camera::Place;
use crate::pace::Pace;
use crate::view::{View, block};

/// Inverse depth changed by more than this (1/m): four standard deviations of a Kinect's disparity; with a moving camera
/// about twice as much, because the memory was resampled.
const CHANGED_PER_M: [f32; 2] = [0.0042, 0.009];
/// A channel changed by more than this (levels); with a moving camera more, because edges were resampled.
const CHANGED_LEVELS: [i16; 2] = [26, 60];
/// Nearer or farther than the rested background by this inverse depth (1/m).
pub(crate) const BESIDE_BACKGROUND_PER_M: f32 = 0.007;
/// The background where nothing is in reach of the sensor: practically infinitely far (1/m).
const NOTHING_PER_M: f32 = 1e-6;
/// A surface is at a place if the depth is within this (m).
pub(crate) const THERE_M: f32 = 0.02;
/// A surface is far behind another by this (m).
const BEHIND_M: f32 = 0.05;
/// The running mean of inverse depth covers this many frames.
const MEAN_FRAMES: u8 = 12;
/// What is farther than the background for this long (s) is the background.
const FARTHER_S: f64 = 0.1;
/// Where nothing was ever measured for this long (s), nothing is in reach; if something was in reach, after
/// this long without a change.
const NOTHING_S: [f64; 2] = [0.1, 2.0];
/// What is nearer and unchanged for this long (s) has joined the background.
const JOINED_S: f64 = 0.5;
/// A plane of structure rests if more than this share of its pixels shows what rested there before: of a
/// person who comes in, no pixel does.
const RESTING_PLANE: f64 = 0.5;
/// A label at rest changes after this many frames of disagreement.
const MOST_SURE: u8 = 8;
/// Labels closer than this to a change follow the frame (px at VGA size).
const NEAR_CHANGE_PX: f64 = 7.0;

/// A number of a track, 0 = none.
pub(crate) type Key = u32;

/// The memory of pixels.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Scene {
    size: (usize, usize),
    /// Running mean of inverse depth (1/m), 0 = unknown, and over how many frames.
    depth: Vec<f32>,
    frames: Vec<u8>,
    color: Vec<[u8; 3]>,
    /// Inverse depth (1/m) of what rested there before anything came nearer; 0 = unknown,
    /// [`NOTHING_PER_M`] = nothing was in reach.
    background: Vec<f32>,
    /// The number of frames in which it was farther than the background, or without depth; the number in
    /// which something nearer rested.
    farther: Vec<u8>,
    nearer: Vec<u8>,
    /// The track that the last frame showed.
    pub(crate) seen: Vec<Key>,
    /// The track that is shown, kept steady, and how sure that is.
    pub(crate) shown: Vec<Key>,
    sure: Vec<u8>,
}

/// Where a pixel is seen after a step of the camera, and its inverse depth (1/m) there.
pub(crate) struct Placed {
    pub(crate) from: usize,
    u: f32,
    v: f32,
    pub(crate) inverse: f32,
}

/// Where the pixels of a remembered image of inverse depths (1/m, 0 = unknown) are after a step, if they stay
/// in view. O(n).
pub(crate) fn placed(inverse: &[f32], place: &Place, view: &View) -> Vec<Placed> {
    let (matrix, shift) = (place.step.matrix(), place.step.point(glam::DVec3::ZERO));
    let at = |from: usize, inverse: f32| {
        let (u, v) = ((from % view.size.0) as f64, (from / view.size.0) as f64);
        // The point times its inverse depth: its direction is what counts.
        let ray = matrix * glam::DVec3::from(place.remembered.ray(u, v)) + shift * f64::from(inverse);
        let z_m = ray.z / f64::from(inverse);
        let (u, v) = view.project(ray * (z_m / ray.z))?;
        Some(Placed { from, u: u as f32, v: v as f32, inverse: (1.0 / z_m) as f32 })
    };
    (0..inverse.len())
        .filter(|&from| inverse[from] > 0.0)
        .filter_map(|from| at(from, inverse[from]))
        .collect()
}

/// Moves pixels with the camera: each goes first to the nearest pixel, then to those around it that are still
/// empty. If the nearest surface won everywhere, all surfaces would creep towards the camera.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Reach {
    Nearest,
    Around,
}

impl Reach {
    pub(crate) fn pixels(self, at: &Placed, size: (usize, usize)) -> impl Iterator<Item = usize> {
        let (shift, count) = match self {
            Self::Nearest => (0.5, 1),
            Self::Around => (0.0, 4),
        };
        block(((at.u + shift) as usize, (at.v + shift) as usize), size).take(count)
    }

    /// Whether the value that a pixel already has (1/m, 0 = nothing) stays.
    pub(crate) fn keeps(self, has: f32, inverse: f32) -> bool {
        match self {
            Self::Nearest => inverse <= has,
            Self::Around => has > 0.0,
        }
    }
}

impl Scene {
    pub(crate) fn empty(size: (usize, usize)) -> Self {
        let n = size.0 * size.1;
        Self {
            size,
            depth: vec![0.0; n],
            frames: vec![0; n],
            color: vec![[0; 3]; n],
            background: vec![0.0; n],
            farther: vec![0; n],
            nearer: vec![0; n],
            seen: vec![0; n],
            shown: vec![0; n],
            sure: vec![0; n],
        }
    }

    pub(crate) fn size(&self) -> (usize, usize) {
        self.size
    }

    /// Moves the remembered scene with the camera. O(n).
    pub(crate) fn carry(&mut self, place: &Place, view: &View) {
        let old = std::mem::replace(self, Self::empty(self.size));
        let (surface, rested) = (placed(&old.depth, place, view), placed(&old.background, place, view));
        for reach in [Reach::Nearest, Reach::Around] {
            for at in &surface {
                for to in reach.pixels(at, self.size) {
                    if reach.keeps(self.depth[to], at.inverse) {
                        continue;
                    }
                    self.depth[to] = at.inverse;
                    self.frames[to] = old.frames[at.from];
                    self.color[to] = old.color[at.from];
                    self.seen[to] = old.seen[at.from];
                    self.shown[to] = old.shown[at.from];
                    self.sure[to] = old.sure[at.from];
                }
            }
            for at in &rested {
                for to in reach.pixels(at, self.size) {
                    if reach.keeps(self.background[to], at.inverse) {
                        continue;
                    }
                    let was_nothing = old.background[at.from] <= NOTHING_PER_M;
                    self.background[to] = if was_nothing { NOTHING_PER_M } else { at.inverse };
                    self.farther[to] = old.farther[at.from];
                    self.nearer[to] = old.nearer[at.from];
                }
            }
        }
    }

    /// Takes what is seen as the rested scene. O(n).
    pub(crate) fn rest(&mut self, view: &View) {
        let seen = self.background.iter_mut().zip(&view.inverse).filter(|(_, inverse)| **inverse > 0.0);
        seen.for_each(|(background, &inverse)| *background = inverse);
    }

    /// Makes what is seen of a plane of structure the rested scene where nothing was in reach, if most of the
    /// plane rests: a thing threw a shadow of the sensor's light there, and is gone. O(n log planes).
    pub(crate) fn rest_on_planes(&mut self, view: &View, pace: Pace) {
        let structure = &view.structure;
        let mut planes: BTreeMap<u16, (usize, usize)> = BTreeMap::new();
        let mut bare = Vec::new();
        for pixel in (0..structure.len()).filter(|&k| structure[k] > 0 && view.inverse[k] > 0.0) {
            let (all, resting) = planes.entry(structure[pixel]).or_default();
            *all += 1;
            *resting += usize::from(self.is_in_place(view, pixel));
            let is_measured = usize::from(self.frames[pixel]) >= pace.frames(FARTHER_S);
            if is_measured && self.background[pixel] > 0.0 && self.is_before_nothing(pixel) {
                bare.push(pixel);
            }
        }
        for pixel in bare {
            let (all, resting) = planes[&structure[pixel]];
            if resting as f64 > RESTING_PLANE * all as f64 {
                self.background[pixel] = view.inverse[pixel];
            }
        }
    }

    /// The pixels whose depth or colour has changed. O(n).
    pub(crate) fn changed(&self, view: &View, camera_moves: bool) -> Bits {
        let limit = CHANGED_PER_M[usize::from(camera_moves)] * view.noise;
        let levels = CHANGED_LEVELS[usize::from(camera_moves)];
        let gain = self.gain(view);
        let single = Bits::of(self.size, |pixel| {
            let (was, is) = (self.depth[pixel], view.inverse[pixel]);
            if was == 0.0 {
                return false;
            }
            let is_moved = is > 0.0 && (is - was).abs() > limit;
            is_moved
                || view.color.get(pixel).is_some_and(|&color| {
                    let before = self.color[pixel];
                    (0..3).any(|k| (i16::from(color[k]) - i16::from(before[k]) - gain).abs() > levels)
                })
        });
        let radius = view.length_px(2.0);
        single.eroded(radius).dilated(radius).dilated(radius)
    }

    /// By how much the whole image has become brighter (levels), from a grid of pixels.
    fn gain(&self, view: &View) -> i16 {
        if view.color.is_empty() {
            return 0;
        }
        let grid = (0..self.depth.len()).step_by(397).filter(|&pixel| self.depth[pixel] > 0.0);
        let mut differences: Vec<i16> =
            grid.map(|pixel| i16::from(view.color[pixel][1]) - i16::from(self.color[pixel][1])).collect();
        if differences.is_empty() {
            return 0;
        }
        let middle = differences.len() / 2;
        *differences.select_nth_unstable(middle).1
    }

    /// The pixels that are nearer than the rested background, or have no depth where the background had one.
    /// O(n).
    pub(crate) fn in_front(&self, view: &View) -> Bits {
        let is_hidden = |pixel: usize| self.background[pixel] > NOTHING_PER_M && view.inverse[pixel] == 0.0;
        Bits::of(self.size, |pixel| is_hidden(pixel) || self.is_in_front(view, pixel))
    }

    /// Whether a pixel shows something nearer than the rested background.
    pub(crate) fn is_in_front(&self, view: &View, pixel: usize) -> bool {
        let rested = self.background[pixel];
        rested > 0.0 && view.inverse[pixel] - rested > BESIDE_BACKGROUND_PER_M * view.noise
    }

    /// Whether what is remembered at a pixel is nearer than this inverse depth (1/m).
    pub(crate) fn was_nearer(&self, view: &View, pixel: usize, inverse: f32) -> bool {
        self.depth[pixel] - inverse > BESIDE_BACKGROUND_PER_M * view.noise
    }

    /// Whether nothing was in reach of the sensor at a pixel before.
    pub(crate) fn is_before_nothing(&self, pixel: usize) -> bool {
        self.background[pixel] <= NOTHING_PER_M
    }

    /// Whether a pixel shows the rested background, including things that rest.
    pub(crate) fn is_in_place(&self, view: &View, pixel: usize) -> bool {
        let (rested, is) = (self.background[pixel], view.inverse[pixel]);
        rested > 0.0 && is > 0.0 && (is - rested).abs() < BESIDE_BACKGROUND_PER_M * view.noise
    }

    /// Whether something nearer than what was there stands at a pixel now.
    pub(crate) fn is_covered(&self, view: &View, pixel: usize) -> bool {
        view.inverse[pixel] > self.depth[pixel] + CHANGED_PER_M[1] * view.noise
    }

    /// Whether the remembered surface at a pixel is far behind what is seen there.
    pub(crate) fn is_behind(&self, view: &View, pixel: usize) -> bool {
        let (was, is) = (self.depth[pixel], view.inverse[pixel]);
        was > 0.0 && is > 0.0 && 1.0 / was - 1.0 / is > BEHIND_M
    }

    /// Whether the remembered surface at a pixel is still there.
    pub(crate) fn is_as_before(&self, view: &View, pixel: usize) -> bool {
        let (was, is) = (self.depth[pixel], view.inverse[pixel]);
        was > 0.0 && is > 0.0 && (1.0 / is - 1.0 / was).abs() < THERE_M
    }

    /// Decides which track is shown. Near changes it is the track of the frame; elsewhere it is the one shown
    /// before, unless several frames disagree. O(n).
    pub(crate) fn steady(&mut self, view: &View, changed: &Bits) {
        let follows = changed.dilated(view.length_px(NEAR_CHANGE_PX));
        for pixel in 0..self.seen.len() {
            let label = self.seen[pixel];
            if self.shown[pixel] == label {
                self.sure[pixel] = (self.sure[pixel] + 1).min(MOST_SURE);
            } else if self.sure[pixel] > 1 && !follows.has(pixel) {
                self.sure[pixel] -= 1;
            } else {
                self.shown[pixel] = label;
                self.sure[pixel] = 1;
            }
        }
    }

    /// Learns from a frame. O(n).
    pub(crate) fn learn(&mut self, view: &View, changed: &Bits, agents: &Bits, pace: Pace) {
        let limit = BESIDE_BACKGROUND_PER_M * view.noise;
        let most = |seconds: f64| pace.frames(seconds).min(usize::from(u8::MAX)) as u8;
        let (farther, joined) = (most(FARTHER_S), most(JOINED_S));
        let nothing = NOTHING_S.map(most);
        for pixel in 0..self.depth.len() {
            let (is, has_changed) = (view.inverse[pixel], changed.has(pixel));
            if let Some(&color) = view.color.get(pixel) {
                let mean = &mut self.color[pixel];
                let is_new = has_changed || self.frames[pixel] == 0;
                *mean = if is_new { color } else { std::array::from_fn(|k| mixed(mean[k], color[k])) };
            }
            if is == 0.0 {
                if has_changed {
                    (self.depth[pixel], self.frames[pixel]) = (0.0, 0);
                }
                let was_known = self.background[pixel] > 0.0;
                let is_other = was_known && has_changed;
                self.farther[pixel] = if is_other { 0 } else { self.farther[pixel].saturating_add(1) };
                // Outside the field nothing is ever measured, which has no meaning.
                let is_seen = view.field.has(pixel % self.size.0, pixel / self.size.0);
                if is_seen && self.farther[pixel] >= nothing[usize::from(was_known)] {
                    (self.background[pixel], self.farther[pixel]) = (NOTHING_PER_M, 0);
                }
                continue;
            }
            if has_changed || self.depth[pixel] == 0.0 {
                (self.depth[pixel], self.frames[pixel]) = (is, 1);
            } else {
                self.frames[pixel] = (self.frames[pixel] + 1).min(MEAN_FRAMES);
                self.depth[pixel] += (is - self.depth[pixel]) / f32::from(self.frames[pixel]);
            }
            let beside = is - self.background[pixel];
            if self.background[pixel] == 0.0 {
                (self.background[pixel], self.farther[pixel]) = (is, 0);
            } else if beside < -limit {
                self.nearer[pixel] = 0;
                self.farther[pixel] = self.farther[pixel].saturating_add(1);
                if self.farther[pixel] >= farther {
                    (self.background[pixel], self.farther[pixel]) = (is, 0);
                }
            } else if beside > limit {
                self.farther[pixel] = 0;
                let rests = !has_changed && !agents.has(pixel);
                self.nearer[pixel] = if rests { self.nearer[pixel].saturating_add(1) } else { 0 };
                if self.nearer[pixel] >= joined {
                    (self.background[pixel], self.nearer[pixel]) = (is, 0);
                }
            } else {
                (self.farther[pixel], self.nearer[pixel]) = (0, 0);
                self.background[pixel] += beside / f32::from(MEAN_FRAMES);
            }
        }
    }
}

/// A step of a running mean over eight frames.
fn mixed(mean: u8, value: u8) -> u8 {
    ((7 * u16::from(mean) + u16::from(value) + 4) / 8) as u8
}

impl Scene {
    /// The surface that is remembered at a pixel, in the camera of this frame.
    pub(crate) fn point(&self, view: &View, pixel: usize) -> Option<crate::align::SurfacePoint> {
        view.point_at(pixel, self.depth[pixel]).map(|at| {
            let grey = (!view.grey.is_empty()).then(|| {
                let [r, g, b] = self.color[pixel].map(f64::from);
                (77.0 * r + 150.0 * g + 29.0 * b) / 256.0
            });
            crate::align::SurfacePoint { at, grey }
        })
    }
}
