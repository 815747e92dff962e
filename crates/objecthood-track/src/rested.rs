//! The surface of every thing as it last rested: how much of it is hidden now, and whether the thing was
//! opened.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::bits::Bits;
use crate::camera::Place;
use crate::memory::Look;
use crate::scene::{BESIDE_BACKGROUND_PER_M, Key, Reach, Scene, THERE_M, placed};
use crate::view::View;

/// A place is hidden if something nearer by this (m) stands before it.
const BEFORE_M: f32 = 0.02;

/// The inside of a thing lies higher than the lowest part of its surface by this (m), not counting this
/// fraction of the surface: a bottom is as thick as a board.
const LOWEST: usize = 50;
const FLOOR_M: f64 = 0.005;

/// Which thing rested at every pixel, and where its surface was.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Rested {
    size: (usize, usize),
    owner: Vec<Key>,
    /// Inverse depth (1/m), 0 = nothing rested there.
    surface: Vec<f32>,
}

/// Where a surface lies that is seen where a thing rested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Beside {
    /// Where its surface was.
    There,
    /// Nearer than the thing's surface.
    Before,
    /// Farther: it may be the inside of the thing.
    Behind,
}

/// What is seen now where a thing rested, in pixels.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Remains {
    pub(crate) all: usize,
    /// Pixels behind something nearer.
    pub(crate) hidden: usize,
    /// Pixels at which something farther is seen, which stood behind the thing.
    pub(crate) bare: usize,
    /// Pixels at which its surface stayed.
    pub(crate) stays: usize,
    /// Pixels at which its surface is gone and something behind it is seen, while its surface stayed on three
    /// of the four sides.
    pub(crate) hollow: usize,
}

/// The first and last row or column in which the surface of a thing stayed, for each column or row.
#[derive(Default)]
struct Extents(BTreeMap<(Key, usize), (usize, usize)>);

impl Extents {
    fn add(&mut self, key: Key, line: usize, at: usize) {
        let extent = self.0.entry((key, line)).or_insert((at, at));
        *extent = (extent.0.min(at), extent.1.max(at));
    }

    /// On how many sides of a place in a line the surface stayed.
    fn sides(&self, key: Key, line: usize, at: usize) -> usize {
        self.0.get(&(key, line)).map_or(0, |&(first, last)| usize::from(first < at) + usize::from(at < last))
    }
}

impl Rested {
    pub(crate) fn empty(size: (usize, usize)) -> Self {
        let n = size.0 * size.1;
        Self { size, owner: vec![0; n], surface: vec![0.0; n] }
    }

    /// Moves the remembered surfaces with the camera. O(n).
    pub(crate) fn carry(&mut self, place: &Place, view: &View) {
        let old = std::mem::replace(self, Self::empty(self.size));
        let places = placed(&old.surface, place, view);
        for reach in [Reach::Nearest, Reach::Around] {
            for at in &places {
                for to in reach.pixels(at, self.size) {
                    if !reach.keeps(self.surface[to], at.inverse) {
                        (self.owner[to], self.surface[to]) = (old.owner[at.from], at.inverse);
                    }
                }
            }
        }
    }

    /// Updates the remembered surfaces from a frame. `seen`: the track at each pixel. `rests`: whether a
    /// track is seen and rests, and nobody handles it. O(n).
    pub(crate) fn learn(&mut self, seen: &[Key], view: &View, changed: &Bits, rests: impl Fn(Key) -> bool) {
        let mut last = (0, false);
        let mut known = |key: Key| {
            if key != last.0 {
                last = (key, key > 0 && rests(key));
            }
            last.1
        };
        for (pixel, &key) in seen.iter().enumerate() {
            let (is, was, owner) = (view.inverse[pixel], self.surface[pixel], self.owner[pixel]);
            if is == 0.0 {
                continue;
            }
            if key > 0 && known(key) && !changed.has(pixel) {
                (self.owner[pixel], self.surface[pixel]) = (key, is);
            } else if owner > 0 && owner != key && 1.0 / is - 1.0 / was > THERE_M && known(owner) {
                (self.owner[pixel], self.surface[pixel]) = (0, 0.0);
            }
        }
    }

    /// The thing that rested at a pixel, and where the surface seen there now lies. `None` where nothing
    /// rested or nothing is measured.
    pub(crate) fn at(&self, pixel: usize, view: &View) -> Option<(Key, Beside)> {
        let (key, is, was) = (self.owner[pixel], view.inverse[pixel], self.surface[pixel]);
        if key == 0 || is == 0.0 {
            return None;
        }
        let limit = BESIDE_BACKGROUND_PER_M * view.noise;
        let beside = match is - was {
            shift if shift.abs() < limit => Some(Beside::There),
            shift if shift > 0.0 => Some(Beside::Before),
            _ => (1.0 / is - 1.0 / was > THERE_M).then_some(Beside::Behind),
        };
        Some(key).zip(beside)
    }

    /// Predicts things again where they rested, if what passed before them is gone: a thing that passes in a
    /// hand may be too fast for its motion to be found, and is then predicted where it was. `passes`: whether
    /// the first of two tracks can pass before the second. O(n).
    pub(crate) fn predict_again(
        &self,
        predicted: &mut [Key],
        (scene, view): (&Scene, &View),
        passes: impl Fn(Key, Key) -> bool,
    ) {
        for (pixel, key) in predicted.iter_mut().enumerate().filter(|(_, key)| **key > 0) {
            if let Some((owner, Beside::There)) = self.at(pixel, view)
                && owner != *key
                && scene.was_nearer(view, pixel, self.surface[pixel])
                && passes(*key, owner)
            {
                *key = owner;
            }
        }
    }

    /// The thing that rested at a pixel, and the point (m) of its surface there, in the camera.
    pub(crate) fn surface(&self, pixel: usize, view: &View) -> Option<(Key, DVec3)> {
        let point = view.point_at(pixel, self.surface[pixel])?;
        Some((self.owner[pixel], point)).filter(|&(key, _)| key > 0)
    }

    /// Counts what is seen now where things rested. What belongs to `agents` hides the place. `openable`: the
    /// things whose inside is searched. O(n).
    pub(crate) fn remains(
        &self,
        look: &Look<'_>,
        agents: &Bits,
        openable: &BTreeSet<Key>,
    ) -> BTreeMap<Key, Remains> {
        let floors = self.floors(look, openable);
        let mut remains: BTreeMap<Key, Remains> = BTreeMap::new();
        let (mut rows, mut columns) = (Extents::default(), Extents::default());
        let mut behind = Vec::new();
        for (pixel, &key) in self.owner.iter().enumerate().filter(|&(_, &key)| key > 0) {
            let of = remains.entry(key).or_default();
            of.all += 1;
            let is = look.view.inverse[pixel];
            let depth = 1.0 / is - 1.0 / self.surface[pixel];
            if agents.has(pixel) || is > 0.0 && depth < -BEFORE_M {
                of.hidden += 1;
                continue;
            }
            let beside = self.at(pixel, look.view).map(|(_, beside)| beside);
            of.bare += usize::from(beside == Some(Beside::Behind));
            if let (Some(&floor), Some(point)) = (floors.get(&key), look.view.point(pixel))
                && look.place.height_m(point) > floor
            {
                let (u, v) = (pixel % self.size.0, pixel / self.size.0);
                // A thing that is pushed away from the camera is also behind where it was, but it moves.
                match beside.filter(|_| !look.changed.has(pixel)) {
                    Some(Beside::There) => {
                        of.stays += 1;
                        rows.add(key, v, u);
                        columns.add(key, u, v);
                    }
                    Some(Beside::Behind) => behind.push((key, u, v)),
                    _ => {}
                }
            }
        }
        for (key, u, v) in behind {
            let is_enclosed = rows.sides(key, v, u) + columns.sides(key, u, v) >= 3;
            remains.entry(key).or_default().hollow += usize::from(is_enclosed);
        }
        remains
    }

    /// The height (m) above which the inside of each thing lies. O(n).
    fn floors(&self, look: &Look<'_>, openable: &BTreeSet<Key>) -> BTreeMap<Key, f64> {
        let mut heights: BTreeMap<Key, Vec<f64>> = BTreeMap::new();
        for (pixel, &key) in self.owner.iter().enumerate().filter(|(_, key)| openable.contains(key)) {
            let (u, v) = (pixel % self.size.0, pixel / self.size.0);
            let point =
                DVec3::from(look.view.camera.ray(u as f64, v as f64)) / f64::from(self.surface[pixel]);
            heights.entry(key).or_default().push(look.place.height_m(point));
        }
        let floor = |heights: &mut Vec<f64>| {
            let low = heights.len() / LOWEST;
            *heights.select_nth_unstable_by(low, f64::total_cmp).1 + FLOOR_M
        };
        heights.iter_mut().map(|(&key, heights)| (key, floor(heights))).collect()
    }
}
