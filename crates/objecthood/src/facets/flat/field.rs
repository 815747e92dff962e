//! The field of the search: cells on a support or hardly above one, at half the resolution.

use rayon::prelude::*;

use crate::facets::Facets;
use crate::oversegment::structure::Structure;
use crate::oversegment::structure::StructureSurface;
use crate::raster::Raster;
use crate::simd::vectorized;
use crate::surface::disparity::{DisparitySpace, position};
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
        let rise = Rise::new(surfaces, structure);
        let place_of_facet = places(&rise, structure, &surfaces.disparity, facets);
        let (full_width, full_height) = surfaces.disparity.size();
        let (width, height) = (full_width / 2, full_height / 2);
        facets.segments.find_runs();
        let mut support = vec![NO_SUPPORT; full_width * full_height];
        let mut cells = vec![Cell { support: NO_SUPPORT, rise: 0.0, lab: [0.0; 3] }; width * height];
        let rows = cells.par_chunks_mut(width).zip(support.par_chunks_mut(2 * full_width));
        let rises = || vec![0.0; 2 * full_width];
        rows.enumerate().for_each_init(rises, |rises, (v, (cells, support))| {
            for (run, facet) in facets.segments.runs_in(2 * v..2 * v + 2) {
                let own = run.start - 2 * v * full_width..run.end - 2 * v * full_width;
                let (at, seen) = (position(run.start, full_width), &surfaces.disparity.as_slice()[run]);
                rise.measure(place_of_facet[facet], at, seen, &mut support[own.clone()], &mut rises[own]);
            }
            for (u, cell) in cells.iter_mut().enumerate() {
                let mut sum = (0, 0.0);
                for k in [0, 1, full_width, full_width + 1].map(|k| 2 * u + k) {
                    if support[k] != NO_SUPPORT {
                        cell.support = support[k];
                        sum = (sum.0 + 1, sum.1 + rises[k]);
                    }
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
    space: &'a DisparitySpace,
    supports: Vec<&'a StructureSurface>,
}

/// Where the pixels of a facet lie.
#[derive(Clone, Copy)]
enum Place {
    /// On this one of the supports, of which the facet is a surface.
    On(u8),
    /// On a support or hardly above one; which support is decided pixel by pixel.
    Low,
    Elsewhere,
}

impl<'a> Rise<'a> {
    fn new(surfaces: &'a Surfaces, structure: &'a Structure) -> Self {
        let supports = structure.supports.surfaces.iter().map(|&surface| &structure.surfaces[surface]);
        Self { space: &surfaces.space, supports: supports.collect() }
    }

    /// The support of each pixel of a facet in a row, the first of them at (u, v), and how far (quanta) the pixel lies before it.
    fn measure(&self, facet: Place, [u, v]: [f64; 2], seen: &[f32], support: &mut [u8], rises: &mut [f64]) {
        match facet {
            Place::On(place) => {
                let model = self.supports[usize::from(place)].model;
                vectorized(
                    #[inline(always)]
                    || {
                        let own = |d: &f32| if d.is_nan() { NO_SUPPORT } else { place };
                        support.iter_mut().zip(seen).for_each(|(support, d)| *support = own(d));
                        for (k, (rise, d)) in (0_i32..).zip(rises.iter_mut().zip(seen)) {
                            *rise = f64::from(*d) - model.value([u + f64::from(k), v]);
                        }
                    },
                );
            }
            Place::Low => {
                for (k, ((support, rise), d)) in (0_i32..).zip(support.iter_mut().zip(rises).zip(seen)) {
                    let at = [u + f64::from(k), v];
                    *support = self.nearest(at, *d);
                    if *support != NO_SUPPORT {
                        *rise = self.quanta(at, *d, *support);
                    }
                }
            }
            Place::Elsewhere => {}
        }
    }

    /// How far (quanta) a disparity lies before a support.
    fn quanta(&self, at: [f64; 2], d: f32, place: u8) -> f64 {
        f64::from(d) - self.supports[usize::from(place)].model.value(at)
    }

    /// The support before which a disparity lies by at most the height of flat things, or [`NO_SUPPORT`].
    fn nearest(&self, at: [f64; 2], d: f32) -> u8 {
        let is_near = |surface: &&StructureSurface| {
            (-HIGHEST_M..HIGHEST_M).contains(&surface.height_m(at, d.into(), self.space))
        };
        self.supports.iter().position(is_near).map_or(NO_SUPPORT, |place| place as u8)
    }
}

/// Where each facet lies. O(pixels of facets · supports).
fn places(rise: &Rise<'_>, structure: &Structure, disparity: &Raster<f32>, facets: &Facets) -> Vec<Place> {
    let mut counts = vec![(0_usize, 0_usize); facets.segments.count()];
    for (run, facet) in facets.segments.runs().filter(|&(_, facet)| facet >= facets.structure) {
        let sample = || run.clone().step_by(LOW_STEP);
        let is_low = |&i: &usize| rise.nearest(position(i, disparity.width()), disparity[i]) != NO_SUPPORT;
        let low = sample().filter(is_low).count();
        counts[facet] = (counts[facet].0 + low, counts[facet].1 + sample().len());
    }
    let is_low = |(low, all): (usize, usize)| low as f64 > LOW_SHARE * all as f64;
    let mut places: Vec<Place> =
        counts.into_iter().map(|count| if is_low(count) { Place::Low } else { Place::Elsewhere }).collect();
    // A label map that was made elsewhere may have fewer facets than the structure has surfaces.
    let surfaces = facets.structure.min(places.len());
    for (place, &surface) in structure.supports.surfaces.iter().enumerate() {
        if let Some(of_surface) = places[..surfaces].get_mut(surface) {
            *of_surface = Place::On(place as u8);
        }
    }
    places
}
