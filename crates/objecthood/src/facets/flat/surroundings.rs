//! A group of cells with its surroundings: holes, ring, core.

use crate::facets::flat::field::Field;
use crate::neighbours::four_neighbours;

/// Cells around a group, with their place: inside, or so many steps away.
pub(super) struct Surroundings {
    /// The support that the group lies on.
    pub support: u8,
    left: usize,
    top: usize,
    width: usize,
    height: usize,
    field_width: usize,
    field_height: usize,
    /// Steps to the group; 0 = inside, `u8::MAX` = not reached.
    away: Vec<u8>,
    /// Steps to the outside for cells inside.
    deep: Vec<u8>,
}

const FAR: u8 = u8::MAX;

impl Surroundings {
    /// `reach`: the steps up to which it looks. Holes of the group become a part of it. O(cells of its upright rectangle).
    pub(super) fn new(field: &Field, cells: &[u32], reach: usize) -> Self {
        let (mut left, mut top, mut right, mut bottom) = (usize::MAX, usize::MAX, 0, 0);
        for &i in cells {
            let (u, v) = (i as usize % field.width, i as usize / field.width);
            (left, right, top, bottom) = (left.min(u), right.max(u), top.min(v), bottom.max(v));
        }
        let pad = reach + 1;
        let (left, top) = (left.saturating_sub(pad), top.saturating_sub(pad));
        let (right, bottom) = ((right + pad).min(field.width - 1), (bottom + pad).min(field.height - 1));
        let (width, height) = (right - left + 1, bottom - top + 1);
        let mut new = Self {
            support: field.cells[cells[0] as usize].support,
            left,
            top,
            width,
            height,
            field_width: field.width,
            field_height: field.height,
            away: vec![FAR; width * height],
            deep: vec![FAR; width * height],
        };
        for &i in cells {
            let k = new.local(i as usize);
            new.away[k] = 0;
        }
        new.fill_holes();
        let inside: Vec<usize> = (0..width * height).filter(|&k| new.away[k] == 0).collect();
        new.away = new.spread(&inside, reach, |_| true);
        let outside: Vec<usize> = (0..width * height).filter(|&k| new.away[k] != 0).collect();
        new.deep = new.spread(&outside, reach, |k| new.away[k] == 0);
        new
    }

    fn local(&self, i: usize) -> usize {
        (i / self.field_width - self.top) * self.width + i % self.field_width - self.left
    }

    fn global(&self, k: usize) -> usize {
        (k / self.width + self.top) * self.field_width + k % self.width + self.left
    }

    /// What the border of the rectangle does not reach is inside.
    fn fill_holes(&mut self) {
        let (width, height) = (self.width, self.height);
        let is_border = |k: usize| {
            k.is_multiple_of(width) || k % width + 1 == width || k < width || k / width + 1 == height
        };
        let border: Vec<usize> = (0..width * height).filter(|&k| is_border(k) && self.away[k] != 0).collect();
        let free = self.away.clone();
        let reached = self.spread(&border, usize::MAX, |k| free[k] != 0);
        for (away, reached) in self.away.iter_mut().zip(reached) {
            if reached == FAR {
                *away = 0;
            }
        }
    }

    /// Steps from some cells, up to `reach`.
    fn spread(&self, from: &[usize], reach: usize, may: impl Fn(usize) -> bool) -> Vec<u8> {
        let mut steps = vec![FAR; self.width * self.height];
        from.iter().for_each(|&k| steps[k] = 0);
        let mut front = from.to_vec();
        let mut step = 0_usize;
        while !front.is_empty() && step < reach {
            step += 1;
            let mut next = Vec::new();
            for k in front {
                for (j, _) in four_neighbours(k, self.width, self.height) {
                    if steps[j] == FAR && may(j) {
                        steps[j] = step.min(usize::from(FAR) - 1) as u8;
                        next.push(j);
                    }
                }
            }
            front = next;
        }
        steps
    }

    /// The cells of the group.
    pub(super) fn inside(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.away.len()).filter(|&k| self.away[k] == 0).map(|k| self.global(k))
    }

    /// The cells of the group that lie at least so many steps from the outside.
    pub(super) fn core(&self, least: u8) -> impl Iterator<Item = usize> + '_ {
        (0..self.away.len())
            .filter(move |&k| self.away[k] == 0 && self.deep[k] >= least)
            .map(|k| self.global(k))
    }

    /// The cells of the field on the same support that lie some steps from the group.
    pub(super) fn ring<'a>(
        &'a self,
        field: &'a Field,
        steps: std::ops::RangeInclusive<u8>,
    ) -> impl Iterator<Item = usize> + 'a {
        (0..self.away.len())
            .filter(move |&k| steps.contains(&self.away[k]))
            .map(|k| self.global(k))
            .filter(|&i| field.cells[i].support == self.support)
    }

    /// The outline: cells of the group, each with a direction in which the group ends.
    pub(super) fn outline(&self) -> Vec<(usize, [isize; 2])> {
        let ways = [[1, 0], [-1, 0], [0, 1], [0, -1]];
        let inside = (0..self.away.len()).filter(|&k| self.away[k] == 0 && self.deep[k] == 1);
        let sides = inside.flat_map(|k| ways.map(|way| (self.global(k), way)));
        sides.filter(|&(i, way)| self.step(i, way, 1).is_none_or(|j| !self.has(j))).collect()
    }

    /// Whether a cell belongs to the group.
    pub(super) fn has(&self, i: usize) -> bool {
        let (u, v) = (i % self.field_width, i / self.field_width);
        let columns = self.left..self.left + self.width;
        let rows = self.top..self.top + self.height;
        columns.contains(&u) && rows.contains(&v) && self.away[self.local(i)] == 0
    }

    /// The cell so many steps away in a direction, if it lies on the group's support.
    pub(super) fn cell(&self, field: &Field, i: usize, way: [isize; 2], steps: isize) -> Option<usize> {
        self.step(i, way, steps).filter(|&j| field.cells[j].support == self.support)
    }

    /// The cell so many steps away in a direction; `None` outside the image.
    fn step(&self, i: usize, [x, y]: [isize; 2], steps: isize) -> Option<usize> {
        let u = (i % self.field_width).checked_add_signed(steps * x).filter(|&u| u < self.field_width)?;
        let v = (i / self.field_width).checked_add_signed(steps * y).filter(|&v| v < self.field_height)?;
        Some(v * self.field_width + u)
    }
}
