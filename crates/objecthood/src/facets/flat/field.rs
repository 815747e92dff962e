//! The field of the search: what lies on a support or hardly above it, at half the resolution.

use rayon::prelude::*;

use crate::facets::Facets;
use crate::oversegment::structure::Structure;
use crate::surface::disparity::position;
use crate::surface::surfaces::Surfaces;

/// Flat things rise at most this much (m) above their support: a book of 12 mm, and a millimetre or two of bent table.
const HIGHEST_M: f64 = 0.014;
/// A facet beside the structure belongs to the field when this share of its pixels does: the rest are edges.
const LOW_SHARE: f64 = 0.9;
/// Every so-many-th pixel of a row of a facet tells whether it is low.
const LOW_STEP: usize = 4;
/// A cell belongs to the field when at least this many of its four pixels do.
const LEAST_PIXELS: u32 = 2;
/// No support.
pub(super) const NO_SUPPORT: u8 = u8::MAX;

/// Four pixels, 2 x 2.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    /// The support that it lies on: its place in the list of supports.
    pub support: u8,
    /// Mean distance before the support (quanta).
    pub rise: f32,
    /// Mean colour: L\*a\*b\*.
    pub lab: [f32; 3],
}

/// The cells of an image.
pub(super) struct Field {
    pub width: usize,
    pub height: usize,
    pub cells: Vec<Cell>,
    /// For every pixel the support that it lies on.
    pub support: Vec<u8>,
}

impl Field {
    /// Collects the cells. O(pixels); parallel over rows.
    pub(super) fn new(surfaces: &Surfaces, structure: &Structure, facets: &Facets) -> Self {
        let rise = Rise { surfaces, structure };
        let is_low = low_facets(&rise, facets);
        let (full_width, full_height) = surfaces.disparity.size();
        let (width, height) = (full_width / 2, full_height / 2);
        let labels = facets.segments.labels().as_slice();
        let mut support = vec![NO_SUPPORT; full_width * full_height];
        let mut cells = vec![Cell { support: NO_SUPPORT, rise: 0.0, lab: [0.0; 3] }; width * height];
        let rows = cells.par_chunks_mut(width).zip(support.par_chunks_mut(2 * full_width));
        rows.enumerate().for_each(|(v, (cells, support))| {
            for (u, cell) in cells.iter_mut().enumerate() {
                let first = 2 * v * full_width + 2 * u;
                let pixels = [0, 1, full_width, full_width + 1].map(|k| first + k);
                let mut sum = (0, 0.0);
                for i in pixels {
                    let place = match labels[i] {
                        label if label < facets.structure as i32 => rise.place_of(label),
                        label if is_low[label as usize] => rise.nearest(i),
                        _ => None,
                    };
                    let Some(place) = place.filter(|_| !surfaces.disparity[i].is_nan()) else { continue };
                    support[i - 2 * v * full_width] = place as u8;
                    cell.support = place as u8;
                    sum = (sum.0 + 1, sum.1 + rise.quanta(i, place));
                }
                if sum.0 < LEAST_PIXELS {
                    cell.support = NO_SUPPORT;
                    continue;
                }
                cell.rise = (sum.1 / f64::from(sum.0)) as f32;
                if let Some(lab) = &surfaces.lab {
                    cell.lab = lab.cell(u, v);
                }
            }
        });
        Self { width, height, cells, support }
    }

    /// The middle of a cell (px).
    pub(super) fn middle_px(&self, i: usize) -> [f64; 2] {
        position(i, self.width).map(|x| 2.0 * x + 0.5)
    }

    /// The pixels of some cells that lie on the cells' support, in scan order. `width_px`: the width of the image.
    pub(super) fn pixels_of(&self, cells: &[usize], width_px: usize) -> Vec<u32> {
        let of_cell = |&i: &usize| {
            let first = 2 * (i / self.width) * width_px + 2 * (i % self.width);
            let support = self.cells[i].support;
            let pixels = [0, 1, width_px, width_px + 1].map(|k| first + k);
            pixels.into_iter().filter(move |&i| self.support[i] == support && support != NO_SUPPORT)
        };
        let mut pixels: Vec<u32> = cells.iter().flat_map(of_cell).map(|i| i as u32).collect();
        pixels.sort_unstable();
        pixels
    }
}

/// Distances before the supports.
struct Rise<'a> {
    surfaces: &'a Surfaces,
    structure: &'a Structure,
}

impl Rise<'_> {
    /// The place of a structure surface in the list of supports.
    fn place_of(&self, label: i32) -> Option<usize> {
        self.structure.supports.surfaces.iter().position(|&s| s as i32 == label)
    }

    /// How far (quanta) a pixel lies before a support.
    fn quanta(&self, i: usize, place: usize) -> f64 {
        let surface = &self.structure.surfaces[self.structure.supports.surfaces[place]];
        f64::from(self.surfaces.disparity[i])
            - surface.model.value(position(i, self.surfaces.disparity.width()))
    }

    /// The support before which a pixel lies by at most the height of flat things, if there is one.
    fn nearest(&self, i: usize) -> Option<usize> {
        let d = f64::from(self.surfaces.disparity[i]);
        let at = position(i, self.surfaces.disparity.width());
        let is_near = |&place: &usize| {
            let surface = &self.structure.surfaces[self.structure.supports.surfaces[place]];
            let height_m = surface.height_m(at, d, &self.surfaces.space);
            (-HIGHEST_M..HIGHEST_M).contains(&height_m)
        };
        (0..self.structure.supports.surfaces.len()).find(is_near)
    }
}

/// Whether a facet that is no structure lies on a support or hardly above it. O(pixels of facets · supports).
fn low_facets(rise: &Rise<'_>, facets: &Facets) -> Vec<bool> {
    let mut counts = vec![(0_usize, 0_usize); facets.segments.count()];
    for (run, facet) in facets.segments.runs().filter(|&(_, facet)| facet >= facets.structure) {
        let sample = || run.clone().step_by(LOW_STEP);
        let low = sample().filter(|&i| rise.nearest(i).is_some()).count();
        counts[facet] = (counts[facet].0 + low, counts[facet].1 + sample().len());
    }
    counts.into_iter().map(|(low, all)| low as f64 > LOW_SHARE * all as f64).collect()
}
