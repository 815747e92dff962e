//! Evidence for a flat thing: a group of cells compared with the ring around it (docs/CONTEXT.md 2.4).

use crate::check::{Bound, Check};
use crate::color::histogram::ColorHistogram;
use crate::color::{LEAST_UNLIKE_SHADOW, difference, unlike_shadow};
use crate::facets::flat::field::Field;
use crate::facets::flat::hull::{hull_of, solidity};
use crate::facets::flat::proposals::RARE;
use crate::facets::flat::surroundings::Surroundings;
use crate::params;
use crate::quantile::element_at;
use crate::surface::disparity::position;
use crate::surface::model::{Basis, Model};
use crate::surface::moments::Moments;

/// The core keeps this many cells from the outline, where cells hold both colours and depth is smeared ...
const CORE_CELLS: u8 = 3;
/// ... if this share of the cells is left; else it is all of them.
const CORE_SHARE: f64 = 0.25;
/// Cells of the ring farther than this (quanta) from the first plane do not count in the second: they are things, or edges of things.
const TRIM_QUANTA: f64 = 1.5;
/// A narrow band across the outline, in cells: in a flat thing it has most of the contrast ...
const NARROW_CELLS: [isize; 2] = [-1, 2];
/// ... of this wide band.
const WIDE_CELLS: [isize; 2] = [-3, 5];

/// The shape of a group of cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// The share of its convex hull that it fills.
    pub solid: f64,
    /// The share of its outline at which its support goes on.
    closed: f64,
}

/// What a group of cells shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown {
    pub shape: Shape,
    /// Median distance of the core before the plane of the ring (quanta).
    pub offset_quanta: f64,
    pub color: Option<ShownColor>,
}

/// What its colours show.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShownColor {
    /// The mean: L\*a\*b\*.
    pub mean: [f32; 3],
    /// Overlap with the colours of the ring.
    pub overlap: f64,
    /// The share of its colours that the support shows elsewhere.
    pub familiar: f64,
    /// The share of the contrast that lies in a narrow band along the outline.
    pub sharp: f64,
    /// Difference of its chroma from that of the ring in less light; infinite where it is not darker.
    pub unlike_shadow: f64,
}

/// Measures a group of cells, the inside of `around`; `None` if its shape is not that of a thing, as with
/// most. `own`: the colours of its support. O(cells of the upright rectangle around group and ring).
pub(super) fn measure(
    field: &Field,
    around: &Surroundings,
    cells: &[usize],
    ring: std::ops::RangeInclusive<u8>,
    own: Option<&ColorHistogram>,
) -> Option<Shown> {
    let outline = around.outline();
    let closed = outline.iter().filter(|&&(i, way)| around.cell(field, i, way, 1).is_some()).count();
    let shape = Shape {
        solid: solidity(cells.len(), &hull_of(cells, field.width)),
        closed: closed as f64 / outline.len().max(1) as f64,
    };
    if !shape.check().iter().all(Check::holds) {
        return None;
    }
    let ring: Vec<usize> = around.ring(field, ring).collect();
    let mut core: Vec<usize> = around.core(CORE_CELLS).collect();
    if (core.len() as f64) < CORE_SHARE * cells.len() as f64 {
        core = cells.to_vec();
    }
    core.retain(|&i| field.cells[i].support == around.support);
    let plane = fit_ring(field, &ring);
    let mut before: Vec<f64> = core.iter().map(|&i| distance(field, i, &plane)).collect();
    Some(Shown {
        shape,
        offset_quanta: element_at(&mut before, 0.5),
        color: own.map(|own| {
            let lab = |cells: &[usize]| ColorHistogram::of(cells.iter().map(|&i| field.cells[i].lab));
            let (of_core, [mean, of_ring]) = (lab(&core), [&core, &ring].map(|cells| mean_lab(field, cells)));
            ShownColor {
                mean,
                overlap: of_core.overlap(&lab(&ring)),
                familiar: of_core.share_in(own, RARE),
                sharp: sharpness(field, around, &outline),
                unlike_shadow: unlike_shadow(mean, of_ring),
            }
        }),
    })
}

/// How far (quanta) a cell lies before a plane of rises.
fn distance(field: &Field, i: usize, plane: &Model) -> f64 {
    f64::from(field.cells[i].rise) - plane.value(position(i, field.width))
}

/// The plane of the rises of the ring: fitted twice, the second time without what lies far from the first.
fn fit_ring(field: &Field, ring: &[usize]) -> Model {
    let fit = |counts: &dyn Fn(usize) -> bool| {
        let mut moments = Moments::about(ring.first().map_or([0.0; 2], |&i| position(i, field.width)));
        for i in ring.iter().copied().filter(|&i| counts(i)) {
            moments.add_for_plane(position(i, field.width), field.cells[i].rise.into());
        }
        moments.fit(Basis::Plane).model
    };
    let first = fit(&|_| true);
    fit(&|i| distance(field, i, &first).abs() < TRIM_QUANTA)
}

fn mean_lab(field: &Field, cells: &[usize]) -> [f32; 3] {
    let sum = |k: usize| cells.iter().map(|&i| field.cells[i].lab[k]).sum::<f32>();
    std::array::from_fn(|k| sum(k) / cells.len().max(1) as f32)
}

/// The share of the contrast across an outline that lies in a narrow band along it.
fn sharpness(field: &Field, around: &Surroundings, outline: &[(usize, [isize; 2])]) -> f64 {
    let (mut narrow, mut wide) = (0.0, 0.0);
    for &(i, way) in outline {
        // In a thing narrower than the band, as deep as it goes.
        let inner = |t: isize| (t..=0).find_map(|t| around.cell(field, i, way, t).filter(|&j| around.has(j)));
        let contrast = |[from, to]: [isize; 2]| {
            let colors = [inner(from)?, around.cell(field, i, way, to)?].map(|i| field.cells[i].lab);
            Some(difference(colors[0], colors[1]))
        };
        if let (Some(a), Some(b)) = (contrast(NARROW_CELLS), contrast(WIDE_CELLS)) {
            (narrow, wide) = (narrow + f64::from(a), wide + f64::from(b));
        }
    }
    if wide > 0.0 { narrow / wide } else { 0.0 }
}

/// Least share of the convex hull: rectangles and discs have 0.9 and more, letters, stains and grain less.
const LEAST_SOLID: f64 = 0.85;
/// Least share of the outline at which the support goes on: a thing may stand on or before the rest.
const LEAST_CLOSED: f64 = 0.75;

impl Shape {
    /// All of these must hold.
    pub(super) fn check(&self) -> [Check; 2] {
        [
            Check::new("its share of its hull", "", self.solid, Bound::AtLeast, LEAST_SOLID),
            Check::new("its outline on the support", "", self.closed, Bound::AtLeast, LEAST_CLOSED),
        ]
    }
}

impl Shown {
    /// Checks that it rises above its surroundings. `unit_quanta`: what blocks of an empty surface disagree.
    pub(super) fn check_offset(&self, unit_quanta: f64, params: &params::Flat) -> Check {
        let limit = params.offset_sigmas * unit_quanta;
        Check::new("its rise above the ring", "quanta", self.offset_quanta, Bound::AtLeast, limit)
            .set_by("flat.offset_sigmas")
    }
}

/// Least share of the contrast in the narrow band: soft shadows, patches of light and reflections have half of it.
const LEAST_SHARP: f64 = 0.6;
/// Greatest share of its colours that the support shows elsewhere.
const MOST_FAMILIAR: f64 = 0.5;
/// With this many others of its colour it is a pattern: print, tiles, stains.
const PATTERN: usize = 3;
/// With this many others whose sides run as its own do it is print: things lie as they were put.
const PRINT: usize = 2;
/// Least area (px at 525 px) without depth as proof: the outline of less cannot be told from print.
pub(super) const LEAST_PX: usize = 300;
/// Greatest second-longest side (m) without depth as proof: a sheet of A4 has 0.21 m; place mats and rugs begin at 0.3 m.
const MOST_SIDE_M: f64 = 0.25;

impl ShownColor {
    /// Checks that colour alone shows a thing: all of them must hold. `alike`: others of its colour; `parallel`: others whose sides run as
    /// its own do; `side_m`: its second-longest side.
    pub(super) fn check(
        &self,
        alike: usize,
        parallel: usize,
        side_m: f64,
        params: &params::Flat,
    ) -> Vec<Check> {
        vec![
            Check::new(
                "overlap with the ring's colours",
                "",
                self.overlap,
                Bound::AtMost,
                params.color_overlap,
            )
            .set_by("flat.color_overlap"),
            Check::new(
                "its colours elsewhere on the support",
                "",
                self.familiar,
                Bound::Below,
                MOST_FAMILIAR,
            ),
            Check::new("contrast close to its outline", "", self.sharp, Bound::AtLeast, LEAST_SHARP),
            Check::new("unlike a shadow", "ΔE", self.unlike_shadow, Bound::AtLeast, LEAST_UNLIKE_SHADOW),
            Check::new("others of its colour", "", alike as f64, Bound::Below, PATTERN as f64),
            Check::new("others parallel to it", "", parallel as f64, Bound::Below, PRINT as f64),
            Check::new("its second-longest side", "m", side_m, Bound::AtMost, MOST_SIDE_M),
        ]
    }
}
